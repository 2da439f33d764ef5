"""``python -m benchmarks``: measure, print tables, write a record and pictures."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from benchmarks.record import Record

RESULTS = Path(__file__).resolve().parent / "results"
EXAMPLE = """examples:
  python -m benchmarks                      everything, into benchmarks/results
  python -m benchmarks --quick              within a minute, nothing written
  python -m benchmarks --scene ordinary --out results

python -m benchmarks.derivation measures the derivations, apart from this."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code: 0 done, 2 bad input."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # one core for everyone, before NumPy is imported
    from benchmarks.piecewise_sum import SCENES

    parser = argparse.ArgumentParser(
        prog="python -m benchmarks",
        description="Error against run time beside peers, and the speeds that were promised.",
        epilog=EXAMPLE,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--quick", action="store_true", help="fewer settings and repeats")
    parser.add_argument("--list", action="store_true", help="list scenes, methods and settings")
    parser.add_argument("--scene", action="append", choices=SCENES, help="only this scene")
    parser.add_argument("--out", type=Path, help="folder of the record and the pictures")
    options = parser.parse_args(arguments)
    if options.list:
        return _list(SCENES)
    folder = options.out or (None if options.quick or options.scene else RESULTS)
    if options.out is not None and not options.out.is_dir():
        print(f"benchmarks: the folder {options.out} does not exist.", file=sys.stderr)
        return 2
    command = "python -m benchmarks" + " --quick" * options.quick
    command += "".join(f" --scene {name}" for name in options.scene or ())
    return _measure(command, options.quick, tuple(options.scene or SCENES), folder)


def _list(scenes: Sequence[str]) -> int:
    from benchmarks.piecewise_suite import methods
    from verification.scenes import scene_named

    print("scenes")
    for name in scenes:
        scene = scene_named(name)
        print(f"  {name:10} v = {scene.v:g}, c = {scene.c:g}")
    print("methods and settings")
    for line in methods():
        print(f"  {line}")
    return 0


def _measure(command: str, quick: bool, scenes: tuple[str, ...], folder: Path | None) -> int:
    from benchmarks import record, tables
    from benchmarks.piecewise_suite import measure

    def tell(text: str) -> None:
        print(f"measuring {text} ...", file=sys.stderr, flush=True)

    found = measure(quick, scenes, tell)
    run = record.Record(
        command,
        record.now(),
        record.this_machine(),
        record.these_versions(),
        found.agreement,
        found.points,
        found.failures,
        found.targets,
    )
    print(tables.as_text(run))
    if folder is not None:
        _write(run, scenes, folder)
    return 0


def _write(run: Record, scenes: tuple[str, ...], folder: Path) -> None:
    from benchmarks.piecewise_diagram import draw_scene
    from benchmarks.record import write_record
    from verification.scenes import scene_named

    folder.mkdir(exist_ok=True)
    write_record(run, folder / "piecewise.json")
    for name in scenes:
        scene = scene_named(name)
        draw_scene(name, scene.v, scene.c, run.points, folder)
    print(f"written: piecewise.json and {len(scenes)} diagrams, as SVG and PNG")


if __name__ == "__main__":
    sys.exit(main())
