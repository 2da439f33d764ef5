"""Boundaries of a map of labels: bisection along the grid lines between neighbouring points.

If two neighbouring points of the grid have different labels, the line between them is bisected
until the position of the change is known to a tolerance. If a cheaper task predicts this position,
as the averaged chain does for (8), it is tried first. The grid itself is not refined.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from theory.parameters import Range, within
from verification.execution.columns import Scalar
from verification.execution.points import Point
from verification.execution.sweep import Task
from verification.execution.table import Table

TOLERANCES = Range(1e-9, 1.0)
"""Widths of a bracket, as fractions of its line."""
NOTHING = "nothing"
"""What lies between the two labels if they are adjacent."""
_PREDICTED = 1.0 / 8.0
"""Width of the predictor's bracket relative to that of the task's."""
_ROUNDING_FACTOR = 1.0 + 1e-9
"""Allowance for rounding at the ends of a bracket, so that rounding requires no further run."""
_FIRST_DISTANCE = 0.999
"""Distance of the first two values tried, relative to the width; below 1 to allow for rounding."""


@dataclass(frozen=True)
class Bisection:
    """A task for ``verification.execution.sweep``: the position on one line where a label changes.

    Attributes
    ----------
    task : Task
        Computes the label at a point.
    tolerance : float
        Width of the bracket as a fraction of the line, from 1e-9 to 1.
    label : str
        Name of the result that contains the label.
    predictor : Task, optional
        A cheaper task with nearly the same labels. Its boundary is found first, and the search
        begins there: if the two agree within the tolerance, two calls of the task suffice.

    Notes
    -----
    A point represents a line: its first end under the names of the coordinates, ``along`` the name
    of the coordinate that changes, ``until`` its value at the other end, ``label_low`` and
    ``label_high`` the labels at the ends. The results are:

    low, high
        Values of that coordinate at which the task itself gives ``label_low`` and ``label_high``.
        They differ by at most the tolerance, unless there is a third label between.
    at
        Their mean.
    between
        The third label next to ``low``, or ``NOTHING``.
    runs
        Number of calls of the task.
    """

    task: Task
    tolerance: float
    label: str = "label"
    predictor: Task | None = None

    def __post_init__(self) -> None:
        within("tolerance of the boundary", self.tolerance, *TOLERANCES)

    def __call__(self, point: Point) -> dict[str, Scalar]:
        """Bisect one line."""
        known = {
            point.number(str(point["along"])): str(point["label_low"]),
            point.number("until"): str(point["label_high"]),
        }
        first, last = known
        width = self.tolerance * (last - first)

        def label_at(value: float) -> str:
            if value not in known:
                known[value] = str(self.task(_at(point, value))[self.label])
            return known[value]

        starts = self._predicted(point)
        low, upper = _bracketed(
            lambda x: label_at(x) == point["label_low"], (first, last), width, starts[0]
        )
        high, between = upper, NOTHING
        if known[upper] != point["label_high"]:
            # The change away from label_low need not be the one to label_high, so there is a second
            # search, which starts from the nearest point known to have label_high.
            between = known[upper]
            _, high = _bracketed(
                lambda x: label_at(x) != point["label_high"], (upper, last), width, starts[1]
            )
        return {
            "low": low,
            "high": high,
            "at": 0.5 * (low + high),
            "between": between,
            "runs": len(known) - 2,
        }

    def _predicted(self, point: Point) -> tuple[float | None, float | None]:
        """Return the predictor's positions of both changes, if it agrees on the end labels."""
        if self.predictor is None:
            return None, None
        ends = (point.number(str(point["along"])), point.number("until"))
        labels = [str(self.predictor(_at(point, end))[self.label]) for end in ends]
        if labels != [point["label_low"], point["label_high"]]:
            return None, None
        finer = max(TOLERANCES.low, _PREDICTED * self.tolerance)
        found = Bisection(self.predictor, finer, self.label)(point)
        names = ("at", "at") if found["between"] == NOTHING else ("low", "high")
        return float(found[names[0]]), float(found[names[1]])


def _at(line: Point, value: float) -> Point:
    """Return the point of a line at a given value of the coordinate that changes."""
    line_names = ("along", "until", "label_low", "label_high")
    coordinates = {name: each for name, each in line.items() if name not in line_names}
    return Point({**coordinates, str(line["along"]): value})


def _bracketed(
    is_low: Callable[[float], bool],
    ends: tuple[float, float],
    width: float,
    start: float | None,
) -> tuple[float, float]:
    """Return two values no further apart than ``width``, of which only the first is low.

    If a starting value is given, two values are tried first, half of this distance below and above
    it: if the boundary lies between them, no other is needed. As long as both are on the same side,
    further ones follow at distances that double each time. After that, or if no starting value is
    given, the bracket is bisected.
    """
    low, high = ends
    if start is not None and low < start < high:
        step = _FIRST_DISTANCE * width
        trial = start - 0.5 * step
        upwards = trial <= low or is_low(trial)
        if upwards:
            low = max(low, trial)
        else:
            high = trial
        while low < (trial := low + step if upwards else high - step) < high:
            if is_low(trial):
                low = trial
            else:
                high = trial
            if (high == trial) == upwards:
                break
            step *= 2.0
    while high - low > _ROUNDING_FACTOR * width and low < 0.5 * (low + high) < high:
        middle = 0.5 * (low + high)
        if is_low(middle):
            low = middle
        else:
            high = middle
    return low, high


def boundary_lines(table: Table, axes: Sequence[str]) -> tuple[Point, ...]:
    """Return the lines between neighbours of a grid whose labels differ, as points to bisect.

    Parameters
    ----------
    table : Table
        A map over a full rectangular grid, in any order.
    axes : sequence of str
        Names of its coordinates.

    Raises
    ------
    ValueError
        If a point of the grid is missing.

    Examples
    --------
    >>> from verification.execution.sweep import sweep
    >>> disc = lambda p: {"label": "in" if p["x"] ** 2 + p["y"] ** 2 < 2.5 else "out"}
    >>> table = sweep(disc, {"x": [0.0, 1.0, 2.0], "y": [0.0, 1.0]}, workers=1)
    >>> lines = boundary_lines(table, ["x", "y"])
    >>> [(line["along"], line["x"], line["y"]) for line in lines]
    [('x', 1.0, 0.0), ('x', 1.0, 1.0)]
    >>> edge = sweep(Bisection(disc, tolerance=1e-8), lines, workers=1)
    >>> [round(at, 5) for at in edge["at"].tolist()]
    [1.58114, 1.22474]
    """
    found = [np.unique(table[name], return_inverse=True) for name in axes]
    ticks = [values.tolist() for values, _ in found]
    rows = np.full([len(values) for values in ticks], -1)
    rows[tuple(inverse for _, inverse in found)] = np.arange(len(table))
    if (rows < 0).any():
        missing = np.argwhere(rows < 0)[0].tolist()
        coordinates = tuple(values[i] for values, i in zip(ticks, missing, strict=True))
        raise ValueError(f"the point {coordinates} of the grid is not in the table.")
    names, codes = np.unique(table["label"], return_inverse=True)
    labels = codes[rows]
    changes = [
        (*place, -number)  # in this order: along the last axis first
        for number in range(len(axes))
        for place in np.argwhere(np.diff(labels, axis=number)).tolist()
    ]
    lines = []
    for *place, number in sorted(changes):
        along, next_place = -number, list(place)
        next_place[along] += 1
        lines.append(
            Point(
                {name: values[i] for name, values, i in zip(axes, ticks, place, strict=True)},
                along=axes[along],
                until=ticks[along][next_place[along]],
                label_low=names[labels[tuple(place)]],
                label_high=names[labels[tuple(next_place)]],
            )
        )
    return tuple(lines)
