"""The overhead of a sweep in addition to the work at its points: ``python -m benchmarks.sweep``.

A map of 10⁵ points of the averaged chain is computed by two workers and written to a file, as by
`fronts map`. It is compared with a bare loop: the same task, called for every `LOOP_STRIDE`-th of
the same points in one process, without keeping the results. Times are seconds of processor time of
this process and its workers; memory is the growth of this process's largest resident size from the
end of a small map to the end of the large one. The sweep's own time per point is measured with a
task that returns immediately, with the same columns.
"""

from __future__ import annotations

import argparse
import math
import os
import resource
import sys
import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from verification.execution.columns import Cell
from verification.execution.metadata import Code, Metadata
from verification.execution.points import Grid, Point
from verification.execution.record import Record
from verification.execution.sweep import sweep
from verification.execution.table import Table
from verification.maps.task import StateTask
from verification.maps.vdp_rules import FIGURE_15

POINTS = 100_000
WORKERS = 2
LOOP_STRIDE = 20
"""The bare loop takes one of this number of points."""
RECORD = Path(__file__).parent / "results" / "sweep.json"
TASK = StateTask(chain=FIGURE_15.averaged(), perturbation=0.0)
_UNIT = 1024 if sys.platform != "darwin" else 1
"""Bytes in the unit of ``ru_maxrss``."""


@dataclass(frozen=True, kw_only=True)
class SweepCost:
    """The measured cost of a map per point.

    Attributes
    ----------
    points, workers : int
        Numbers of points and of workers of the map.
    loop_us : float
        Time of the bare loop per point, in microseconds.
    map_us : float
        Time of the map per point, of all processes, in microseconds.
    own_us : float
        The sweep's own time per point, of all processes, in microseconds, measured with the task
        that returns immediately.
    growth : float
        Growth of this process's memory per point, in bytes.
    wall_seconds : float
        Wall-clock time of the map.
    different : int
        Number of points of the bare loop whose row differs from that of the map.
    """

    points: int
    workers: int
    loop_us: float
    map_us: float
    own_us: float
    growth: float
    wall_seconds: float
    different: int


def row_without_work(point: Point) -> dict[str, Cell]:
    """Return a row like that of a map, without computing anything."""
    label = "front" if point["c"] > point["eta"] else "breather"  # type: ignore[operator]
    return {"label": label, "why": "decided", "time": point["c"], "above": 3, "steps": 7}


def grid_of_figure_15(points: int) -> Grid:
    """Return a grid of about this number of points in the plane of Fig. 15.

    Examples
    --------
    >>> len(grid_of_figure_15(100_000))
    100000
    """
    etas = max(math.isqrt(round(0.4 * points)), 1)
    couplings = np.linspace(0.05, 1.0, round(points / etas)).tolist()
    return Grid({"eta": np.linspace(0.01, 0.14, etas).tolist(), "c": couplings})


def measure(points: int, workers: int = WORKERS) -> SweepCost:
    """Measure a map of about this number of points.

    Examples
    --------
    >>> measure(40, workers=1).different
    0
    """
    grid = grid_of_figure_15(points)
    TASK(grid[0])  # compiles
    _timed_sweep(
        TASK, grid_of_figure_15(min(points, 500)), workers
    )  # loads all that is loaded once
    before, begin = _peak_memory(), perf_counter()
    table, seconds = _timed_sweep(TASK, grid, workers)
    wall, growth = perf_counter() - begin, _peak_memory() - before
    _, own = _timed_sweep(row_without_work, grid, workers)
    looped, rows = _bare_loop(grid)
    return SweepCost(
        points=len(grid),
        workers=workers,
        loop_us=1e6 * looped / len(rows),
        map_us=1e6 * seconds / len(grid),
        own_us=1e6 * own / len(grid),
        growth=growth / len(grid),
        wall_seconds=wall,
        different=_rows_that_differ(table, rows),
    )


def _timed_sweep(task: object, grid: Grid, workers: int) -> tuple[Table, float]:
    """Return the table and the processor time of all processes, after the workers have ended."""
    with tempfile.TemporaryDirectory() as folder:
        begin = _processor_seconds()
        table = sweep(task, grid, workers=workers, out=Path(folder, "map.csv"))  # type: ignore[arg-type]
        return table, _processor_seconds() - begin


def _bare_loop(grid: Grid) -> tuple[float, dict[int, dict[str, Cell]]]:
    indices = range(0, len(grid), LOOP_STRIDE)
    begin = process_time()
    rows = {index: TASK(grid[index]) for index in indices}
    return process_time() - begin, rows


def _rows_that_differ(table: Table, rows: dict[int, dict[str, Cell]]) -> int:
    return sum(
        any(table[name][index] != cell for name, cell in row.items()) for index, row in rows.items()
    )


def _processor_seconds() -> float:
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def _peak_memory() -> int:
    return _UNIT * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def in_words(cost: SweepCost) -> str:
    """Return the measurement in words."""
    return (
        f"{cost.points} points on {cost.workers} workers: {cost.map_us:.0f} µs per point, "
        f"{cost.loop_us:.0f} µs in a bare loop, {cost.own_us:.0f} µs of the sweep itself; "
        f"memory {cost.growth:.0f} bytes per point; {cost.different} rows differ; "
        f"{cost.wall_seconds:.0f} s."
    )


def main() -> None:
    """Measure, print the result, and store it if requested."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--points", type=int, default=POINTS)
    parser.add_argument("--workers", type=int, default=WORKERS)
    parser.add_argument("--record", action="store_true", help=f"into {RECORD.name}")
    options = parser.parse_args()
    cost = measure(options.points, options.workers)
    print(in_words(cost))
    if options.record:
        metadata = Metadata(
            command="python -m benchmarks.sweep", code=Code.of(("verification.execution.sweep",))
        )
        Record(kind="sweep", content={"sweep": asdict(cost)}, metadata=metadata).save(RECORD)


if __name__ == "__main__":
    main()
