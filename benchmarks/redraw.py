"""Draw the diagrams again from the stored records: ``python -m benchmarks.redraw``."""

from __future__ import annotations

import json
from pathlib import Path

from benchmarks.diagram import draw
from benchmarks.growth_diagram import draw_growth
from benchmarks.record import read_record
from benchmarks.registry import all_benchmarks
from benchmarks.work_precision import RESULTS


def redraw(folder: Path = RESULTS) -> None:
    """Draw every diagram for which there is a record in a folder; nothing is measured."""
    for benchmark in all_benchmarks():
        path = folder / f"{benchmark.name}.json"
        if path.is_file():
            draw(benchmark.name, read_record(path).points, benchmark.style, folder)
    growth = folder / "growth.json"
    if growth.is_file():
        draw_growth(json.loads(growth.read_text(encoding="utf-8"))["lines"], folder)


if __name__ == "__main__":
    redraw()
