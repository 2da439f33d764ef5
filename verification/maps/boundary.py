"""Boundaries of a map of labels: bisection along the lines of its grid, between neighbours.

Where two neighbouring points of the grid have different labels, the line between them is halved
until the change is known to a tolerance. The grid itself is not made finer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from theory.parameters import within
from verification.execution.sweep import Task
from verification.execution.table import Point, Scalar, Table

NOTHING = "nothing"
"""What lies between the two labels where they meet."""


@dataclass(frozen=True)
class Bisection:
    """A task for ``verification.execution.sweep``: where on one line a label changes.

    Attributes
    ----------
    task : Task
        Gives the label at a point.
    tolerance : float
        Width of the bracket as a fraction of the line, from 1e-9 to 1.
    label : str
        Name of the result that is the label.

    Notes
    -----
    A point is one line: its first end under the names of the coordinates, ``along`` the name of
    the coordinate that changes, ``until`` its value at the other end, ``label_low`` and
    ``label_high`` the labels at the ends. The results are:

    low, high
        Values of that coordinate where the labels are known to be ``label_low`` and
        ``label_high``. They are as close as the tolerance, unless there is a third label between.
    at
        Their middle.
    between
        The third label next to ``low``, or ``NOTHING``.
    runs
        Times the task was called.
    """

    task: Task
    tolerance: float = 1.0 / 16.0
    label: str = "label"

    def __post_init__(self) -> None:
        within("tolerance of the boundary", self.tolerance, 1e-9, 1.0)

    def __call__(self, point: Point) -> dict[str, Scalar]:
        """Bisect one line."""
        along = str(point["along"])
        place = {
            name: value
            for name, value in point.items()
            if name not in ("along", "until", "label_low", "label_high")
        }
        known: dict[float, str] = {
            point.number(along): str(point["label_low"]),
            point.number("until"): str(point["label_high"]),
        }
        ends = len(known)
        width = self.tolerance * (point.number("until") - point.number(along))

        def label_at(value: float) -> str:
            if value not in known:
                result = self.task(Point({**place, along: value}))
                known[value] = str(result[self.label])
            return known[value]

        low, other = point.number(along), point.number("until")
        while other - low > width and low < 0.5 * (low + other) < other:
            middle = 0.5 * (low + other)
            if label_at(middle) == point["label_low"]:
                low = middle
            else:
                other = middle
        high = point.number("until")
        between = known[other] if known[other] != point["label_high"] else NOTHING
        # The change away from label_low need not be the one to label_high: another search, from
        # the nearest point that is known to have label_high. Without a third label it ends at once.
        first = other
        if between == NOTHING:
            high = other
        while between != NOTHING and high - first > width and first < 0.5 * (first + high) < high:
            middle = 0.5 * (first + high)
            if label_at(middle) == point["label_high"]:
                high = middle
            else:
                first = middle
        return {
            "low": low,
            "high": high,
            "at": 0.5 * (low + high),
            "between": between,
            "runs": len(known) - ends,
        }


def boundary_lines(table: Table, axes: Sequence[str], label: str = "label") -> tuple[Point, ...]:
    """Return the lines between neighbours of a grid whose labels differ, as points to bisect.

    Parameters
    ----------
    table : Table
        A map over a full rectangular grid, in any order.
    axes : sequence of str
        Names of its coordinates.
    label : str, optional
        Name of the column of labels.

    Raises
    ------
    ValueError
        If a point of the grid is missing.

    Examples
    --------
    >>> from verification.execution.sweep import sweep
    >>> from verification.execution.table import grid
    >>> disc = lambda p: {"label": "in" if p["x"] ** 2 + p["y"] ** 2 < 2.5 else "out"}
    >>> table = sweep(disc, grid(x=[0.0, 1.0, 2.0], y=[0.0, 1.0]), workers=1)
    >>> lines = boundary_lines(table, ["x", "y"])
    >>> [(line["along"], line["x"], line["y"]) for line in lines]
    [('x', 1.0, 0.0), ('x', 1.0, 1.0)]
    >>> edge = sweep(Bisection(disc, tolerance=1e-8), lines, workers=1)
    >>> [round(at, 5) for at in edge["at"].tolist()]
    [1.58114, 1.22474]
    """
    ticks = [np.unique(table[name]) for name in axes]
    labels = {
        tuple(place): word
        for *place, word in zip(*(table[name].tolist() for name in (*axes, label)), strict=True)
    }
    lines = []
    for index in np.ndindex(*(tick.size for tick in ticks)):
        here = tuple(tick[i].item() for tick, i in zip(ticks, index, strict=True))
        if here not in labels:
            raise ValueError(f"the point {here} of the grid is not in the table.")
        for number in reversed(range(len(axes))):
            if index[number] + 1 == ticks[number].size:
                continue
            until = ticks[number][index[number] + 1].item()
            there = (*here[:number], until, *here[number + 1 :])
            if labels.get(there, labels[here]) != labels[here]:
                lines.append(
                    Point(
                        dict(zip(axes, here, strict=True)),
                        along=axes[number],
                        until=until,
                        label_low=labels[here],
                        label_high=labels[there],
                    )
                )
    return tuple(lines)
