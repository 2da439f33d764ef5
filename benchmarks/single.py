"""What the benchmarks of one scene share: the command line, the record, ratios at equal error."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from benchmarks.chain_diagram import Style
    from benchmarks.record import Record, WorkPoint

RESULTS = Path(__file__).resolve().parent / "results"


def main(
    description: str | None,
    measure: Callable[[bool, Callable[[str], None]], Record],
    style: Callable[[], Style],
    name: str,
    arguments: Sequence[str] | None,
) -> int:
    """Run ``python -m benchmarks.NAME`` and return its exit code: 0 done, 2 bad input."""
    for limit in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(limit, "1")  # one core for everyone, before NumPy is imported
    parser = argparse.ArgumentParser(prog=f"python -m benchmarks.{name}", description=description)
    parser.add_argument("--quick", action="store_true", help="fewer settings, nothing written")
    parser.add_argument("--out", type=Path, help="folder of the record and the picture")
    options = parser.parse_args(arguments)
    if options.out is not None and not options.out.is_dir():
        print(f"benchmarks: the folder {options.out} does not exist.", file=sys.stderr)
        return 2
    folder = options.out or (None if options.quick else RESULTS)
    run = measure(options.quick, lambda text: print(text, file=sys.stderr, flush=True))
    from benchmarks.tables import as_text

    print(as_text(run))
    if folder is not None:
        from benchmarks.chain_diagram import draw
        from benchmarks.record import write_record

        write_record(run, folder / f"{name}.json")
        draw(run.points, style(), folder)
        print(f"written: {name}.json and its diagram, as SVG and PNG")
    return 0


def least_factor(
    ours: Sequence[WorkPoint], peers: Sequence[WorkPoint], low: float, high: float
) -> tuple[float, WorkPoint] | None:
    """Return the least factor by which ours beat the peers at equal error, and where.

    Each peer with an error from ``low`` to ``high`` is compared with the fastest of ours that is
    at least as exact; None if no pair can be compared.
    """
    factors = []
    for peer in peers:
        if low <= peer.error <= high:
            equal = [point.seconds for point in ours if point.error <= peer.error]
            if equal:
                factors.append((peer.seconds / min(equal), peer))
    return min(factors, default=None, key=lambda row: row[0])
