"""What a sweep costs beside its points: ``python -m benchmarks.sweep``.

A map of 10⁵ points of the averaged chain, on two workers and into a file, as `fronts map` makes it.
Held against a bare loop: the same task, called at every so many of the same points, in one process,
with nothing kept. Seconds are those of the processor, of this process and of its workers; memory is
the growth of this process's largest resident size, from the end of a small map to the end of the
large one. What the sweep itself takes for a point is measured with a task that returns at once, of
the same columns.
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
from verification.maps.state_map import StateTask
from verification.maps.vdp_rules import FIGURE_15

POINTS = 100_000
WORKERS = 2
LOOP_STRIDE = 20
"""The bare loop goes through one point in so many."""
RECORD = Path(__file__).parent / "results" / "sweep.json"
TASK = StateTask(chain=FIGURE_15.averaged(), perturbation=0.0)
_UNIT = 1024 if sys.platform != "darwin" else 1
"""Bytes in the unit of ``ru_maxrss``."""


@dataclass(frozen=True, kw_only=True)
class SweepCost:
    """What was measured, over the number of points.

    Attributes
    ----------
    points, workers : int
        Of the map.
    loop_us : float
        Microseconds of the bare loop for a point.
    map_us : float
        Microseconds of the map for a point, of all processes.
    own_us : float
        Microseconds of the sweep itself for a point, of all processes, by the task that returns at
        once.
    growth : float
        Bytes of memory for a point by which this process grew.
    wall_seconds : float
        Of the map.
    different : int
        Points of the bare loop at which the map has another row.
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
    """Return a row like that of a map, of no work."""
    label = "front" if point["c"] > point["eta"] else "breather"  # type: ignore[operator]
    return {"label": label, "why": "decided", "time": point["c"], "above": 3, "steps": 7}


def grid_of_figure_15(points: int) -> Grid:
    """Return so many points, nearly, of the plane of Fig. 15.

    Examples
    --------
    >>> len(grid_of_figure_15(100_000))
    100000
    """
    etas = max(math.isqrt(round(0.4 * points)), 1)
    couplings = np.linspace(0.05, 1.0, round(points / etas)).tolist()
    return Grid({"eta": np.linspace(0.01, 0.14, etas).tolist(), "c": couplings})


def measure(points: int = POINTS, workers: int = WORKERS) -> SweepCost:
    """Measure a map of so many points.

    Examples
    --------
    >>> measure(40, workers=1).different
    0
    """
    grid = grid_of_figure_15(points)
    TASK(grid[0])  # compiled
    _timed_sweep(
        TASK, grid_of_figure_15(min(points, 500)), workers
    )  # whatever is loaded once is there
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
    """Return the table and the seconds of all processes; the workers have ended by then."""
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
        f"{cost.points} points on {cost.workers} workers: {cost.map_us:.0f} µs a point, "
        f"{cost.loop_us:.0f} µs in a bare loop, {cost.own_us:.0f} µs of the sweep itself; "
        f"memory {cost.growth:.0f} bytes a point; {cost.different} rows differ; "
        f"{cost.wall_seconds:.0f} s."
    )


def main() -> None:
    """Measure, say it, and store it if asked to."""
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
