"""Robustness: thousands of points of every computation, counted by outcome."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

import numpy as np

from theory.parameters import count_within, random_seed
from theory.result import Result
from verification.execution.points import Point
from verification.execution.progress import ProgressCallback
from verification.execution.sweep import sweep
from verification.execution.table import Table
from verification.quantities.judging import BAD, PointOutcome, RobustnessTask
from verification.quantities.quantity import Computation
from verification.quantities.registry import chosen

MIN_POINTS = 12
"""Smallest number of points of a computation."""


@dataclass(frozen=True, kw_only=True)
class RobustnessRow:
    """One row of the robustness table.

    Attributes
    ----------
    quantity : str
        Name of the quantity.
    points, random : int
        Number of points tested, and number of random ones among them; the others are test problems
        and corners.
    counts : dict
        Number of points with each outcome.
    tightest : float
        Largest distance, relative to the allowed one, among the points that are right; at most one.
    slowest : float
        Processor time in seconds of the slowest value.
    """

    quantity: str
    points: int
    random: int
    counts: dict[str, int]
    tightest: float
    slowest: float


_OF_A_ROW = ("quantity", "points", "random", "tightest", "slowest")


@dataclass(frozen=True, kw_only=True)
class Robustness(Result):
    """The robustness table, with all failures.

    Attributes
    ----------
    lines : tuple of RobustnessRow
        One row per quantity.
    bad : tuple of dict
        The points that exceeded their error, gave NaN, crashed or were slow, with all that is known
        about them.
    table : Table
        The table of all points.
    seconds : float
        Wall-clock time.
    """

    lines: tuple[RobustnessRow, ...]
    bad: tuple[dict[str, object], ...]
    table: Table = field(metadata={"json": None})
    seconds: float

    derived = ("counts",)

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row per quantity: points, number with each outcome, tightest, slowest."""
        of = {name: [getattr(line, name) for line in self.lines] for name in _OF_A_ROW}
        of |= {o.value: [line.counts[o.value] for line in self.lines] for o in PointOutcome}
        return {name: np.array(values) for name, values in of.items()}

    @property
    def counts(self) -> dict[str, int]:
        """Number of points by outcome, over all quantities."""
        return {o.value: sum(line.counts[o.value] for line in self.lines) for o in PointOutcome}


def points_of(names: Sequence[str], points: int) -> tuple[Point, ...]:
    """Return points for the quantities named (all if none), distributed according to their shares.

    The points of each quantity are spread evenly over the sequence, so that the first tenth takes
    as long as any other, and the remaining time can be estimated from it.

    Examples
    --------
    >>> len(points_of(["c-pin"], 40))
    40
    """
    count_within("number of points", points, 1, 1_000_000)
    computations = chosen(names)
    total = sum(computation.share for computation in computations)
    spread = (
        ((number + 0.5) / count, place, Point(quantity=computation.name, number=number))
        for place, computation in enumerate(computations)
        for count in [max(min(MIN_POINTS, points), round(points * computation.share / total))]
        for number in range(count)
    )
    return tuple(point for _, _, point in sorted(spread, key=lambda each: each[:2]))


def robustness(
    names: Sequence[str],
    points: int,
    seed: int,
    *,
    out: Path | None = None,
    resume: bool = False,
    workers: int | None,
    progress: ProgressCallback | None = None,
) -> Robustness:
    """Test the quantities named, or all, and classify the outcome of each point.

    Parameters
    ----------
    names : sequence of str
        Quantities; all if empty.
    points : int
        Total number; every quantity gets its share, of which half are test problems and corners as
        long as there are any, and the rest are random.
    seed : int
        Seed of the random points.
    out, resume, workers, progress
        As in `verification.execution.sweep.sweep`.

    Raises
    ------
    ParameterError
        If a quantity is unknown or a number is not allowed.

    Examples
    --------
    >>> found = robustness(["c-pin"], 40, 0, workers=1)
    >>> found.bad, found.counts["exceeded"]
    ((), 0)
    """
    begin = perf_counter()
    random_seed(seed)
    table = sweep(
        RobustnessTask(seed),
        points_of(names, points),
        out=out,
        resume=resume,
        workers=workers,
        progress=progress,
    )
    lines = tuple(_line(computation, table) for computation in chosen(names))
    bad = {outcome.value for outcome in BAD}
    wrong = tuple(dict[str, object](row) for row in table.rows() if row["outcome"] in bad)
    return Robustness(lines=lines, bad=wrong, table=table, seconds=perf_counter() - begin)


def _line(computation: Computation, table: Table) -> RobustnessRow:
    mine = table["quantity"] == computation.name
    outcome = table["outcome"][mine]
    counts = {o.value: int(np.count_nonzero(outcome == o.value)) for o in PointOutcome}
    right = outcome == PointOutcome.RIGHT.value
    allowed = table["stated"][mine] + table["uncertainty"][mine]
    ratio = table["distance"][mine][right] / np.where(allowed > 0, allowed, math.inf)[right]
    seconds = table["seconds"][mine]
    return RobustnessRow(
        quantity=computation.name,
        points=int(mine.sum()),
        random=sum(computation.is_random(int(number)) for number in table["number"][mine]),
        counts=counts,
        tightest=float(ratio.max(initial=0.0)),
        slowest=float(seconds.max(initial=0.0)),
    )
