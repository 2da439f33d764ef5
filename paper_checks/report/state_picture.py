"""The picture of a state map in the style of the paper: a mark per point, boundaries as lines."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from verification.pictures.figures import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from verification.execution.table import Table

MARKS: Mapping[str, tuple[str, str]] = {
    "front": ("^", COLOURS["blue"]),
    "breather": ("o", COLOURS["vermilion"]),
    "fixed point": ("s", COLOURS["green"]),
    "undecided": ("x", "0.45"),
}
"""Mark and colour of each label; the shape alone is sufficient to distinguish them."""


def draw_states(
    axes: Axes,
    states: Table,
    across: str,
    up: str,
    boundary: Table | None,
    *,
    names: Mapping[str, str] = MappingProxyType({}),
    lines: str = "boundary, bisected",
) -> dict[str, Mapping[str, Any]]:
    """Draw a map, with the boundaries between the labels as contours; return the data drawn.

    Parameters
    ----------
    axes : Axes
        Axes to draw on.
    states : Table
        The map, with a column ``label``.
    across, up : str
        Names of the columns on the two axes.
    boundary : Table or None
        Boundaries from ``verification.maps.boundary.Bisection`` over the same map.
    names : mapping of str to str, optional
        Names in the legend for labels that are renamed there.
    lines : str, optional
        Name of the boundaries in the legend.

    Returns
    -------
    dict
        The columns of the states and of the contours, for `data_table.long_table`; each piece of a
        contour ends in an empty row.
    """
    labels = states["label"]
    for label, (mark, colour) in MARKS.items():
        chosen = labels == label
        if chosen.any():
            face: dict[str, Any] = {} if mark == "x" else {"mec": "none"}
            axes.plot(
                states[across][chosen],
                states[up][chosen],
                mark,
                ms=4.0,
                color=colour,
                label=f"{names.get(label, label)} ({int(chosen.sum())})",
                clip_on=False,
                **face,
            )
    points = {name: cells for name, cells in states.arrays.items() if cells.ndim == 1}
    drawn: dict[str, Mapping[str, Any]] = {"states": points}
    if boundary is not None and len(boundary):
        contours = _contours(states, across, up, boundary)
        axes.plot(*contours.T, color="0.1", lw=0.9, label=lines)
        axes.set_xlim(*_rim(states, across))
        axes.set_ylim(*_rim(states, up))
        drawn["boundary"] = dict(zip((across, up), contours.T, strict=True))
    return drawn


def _contours(states: Table, across: str, up: str, boundary: Table) -> np.ndarray:
    """Join the points at which the label changes, cell by cell of the grid, to contours.

    Two changes on the edges of a cell are joined directly; three or four, where three regions meet,
    are each joined to their mean. After each piece there is a row of NaN, at which Matplotlib
    interrupts the line.
    """
    x, y = np.unique(states[across]), np.unique(states[up])
    cells: dict[tuple[int, int], list[tuple[float, float]]] = {}
    for row in boundary.rows():
        at = float(row["at"])
        if row["along"] == up:
            i, j = int(np.argmin(np.abs(x - float(row[across])))), _before(y, at)
            point, sides = (float(x[i]), at), [(i - 1, j), (i, j)]
        else:
            i, j = _before(x, at), int(np.argmin(np.abs(y - float(row[up]))))
            point, sides = (at, float(y[j])), [(i, j - 1), (i, j)]
        for side in sides:
            cells.setdefault(side, []).append(point)
    lifted, rows = (np.nan, np.nan), []
    for points in cells.values():
        if len(points) == 2:
            rows += [*points, lifted]
        elif len(points) > 2:
            middle = tuple(np.mean(points, axis=0))
            rows += [row for end in points for row in (end, middle, lifted)]
    return np.array(rows).reshape(-1, 2)


def _before(ticks: np.ndarray, value: float) -> int:
    """Return the index of the last tick at or below a value."""
    return int(np.clip(np.searchsorted(ticks, value, side="right") - 1, 0, max(ticks.size - 2, 0)))


def _rim(states: Table, name: str) -> tuple[float, float]:
    """Return limits just wide enough for the marks at the edge of the grid, and not below zero."""
    low, high = float(states[name].min()), float(states[name].max())
    beyond = 0.03 * (high - low) or 0.05 * abs(high) or 1.0
    return max(low - beyond, min(low, 0.0)), high + beyond
