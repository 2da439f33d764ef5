"""Draw the diagrams again from the stored records: ``python -m benchmarks.redraw``."""

from __future__ import annotations

import json

from benchmarks.diagram import draw
from benchmarks.growth_diagram import draw_growth
from benchmarks.record import read_record
from benchmarks.registry import all_benchmarks
from benchmarks.work_precision import RESULTS


def redraw() -> None:
    """Draw every diagram for which there is a record, without measuring anything."""
    for benchmark in all_benchmarks():
        path = RESULTS / f"{benchmark.name}.json"
        if path.is_file():
            draw(benchmark.name, read_record(path).points, benchmark.style, RESULTS)
    growth = RESULTS / "growth.json"
    if growth.is_file():
        draw_growth(json.loads(growth.read_text(encoding="utf-8"))["lines"], RESULTS)


if __name__ == "__main__":
    redraw()
