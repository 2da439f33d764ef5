"""The picture of a state map in the paper's style: one mark a point, boundaries as lines."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np

from paper_checks.pictures import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from verification.execution.table import Table

MARKS: Mapping[str, tuple[str, str]] = {
    "front": ("^", COLOURS["blue"]),
    "breather": ("o", COLOURS["vermilion"]),
    "fixed point": ("s", COLOURS["green"]),
    "undecided": ("x", "0.45"),
}
"""Mark and colour of each label; the shape alone tells them apart."""


def draw_states(
    axes: Axes,
    states: Table,
    across: str,
    up: str,
    boundary: Table | None = None,
    names: Mapping[str, str] = MappingProxyType({}),
) -> None:
    """Draw a map, and on every line that was bisected a dash across it where the label changes.

    Parameters
    ----------
    axes : Axes
        Where to draw.
    states : Table
        With a column ``label``.
    across, up : str
        Names of the columns on the two axes.
    boundary : Table, optional
        Of ``verification.maps.boundary.Bisection`` over the same map.
    names : mapping of str to str, optional
        Labels that the legend calls otherwise.
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
    if boundary is not None and len(boundary):
        _draw_boundary(axes, states, across, up, boundary)


def _draw_boundary(axes: Axes, states: Table, across: str, up: str, boundary: Table) -> None:
    """Draw a dash as long as the spacing of the grid through every change of label.

    A change along ``up`` is known on one line of constant ``across``: the dash is horizontal.
    """
    half = {name: 0.5 * _spacing(states, name) for name in (across, up)}
    for row in boundary.rows():
        x, y, at = float(row[across]), float(row[up]), float(row["at"])
        low, high = float(row["low"]), float(row["high"])
        if row["along"] == up:
            axes.plot([x - half[across], x + half[across]], [at, at], color="0.1", lw=0.8)
            axes.plot([x, x], [low, high], color="0.6", lw=2.5, solid_capstyle="butt", zorder=1.5)
        else:
            axes.plot([at, at], [y - half[up], y + half[up]], color="0.1", lw=0.8)
            axes.plot([low, high], [y, y], color="0.6", lw=2.5, solid_capstyle="butt", zorder=1.5)
    axes.plot([], [], color="0.1", lw=0.8, label="change of label, bisected")
    axes.plot([], [], color="0.6", lw=2.5, label="another label between")
    # A dash at the rim reaches half a cell beyond the grid, where nothing was run.
    axes.set_xlim(*_rim(states, across))
    axes.set_ylim(*_rim(states, up))


def _rim(states: Table, name: str) -> tuple[float, float]:
    """Return limits just wide enough for marks at the rim of the grid, and not below zero."""
    low, high = float(states[name].min()), float(states[name].max())
    beyond = 0.03 * (high - low) or 0.05 * abs(high) or 1.0
    return max(low - beyond, min(low, 0.0)), high + beyond


def _spacing(states: Table, name: str) -> float:
    ticks = np.unique(states[name])
    return float(np.diff(ticks).min()) if ticks.size > 1 else 0.0
