"""Common parts of pictures of front velocity: branches of (54), thresholds, runs of the chain.

Matplotlib and the theory are imported on first use, as in ``verification.pictures.figures``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from verification.pictures.figures import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from theory.piecewise.kinetic_relation import KineticRelation


@dataclass(frozen=True)
class PlottedSolutions:
    """Solutions of (54) as points: abscissae x, velocities, and whether they are admissible."""

    x: tuple[float, ...]
    v: tuple[float, ...]
    admissible: tuple[bool, ...]

    def part(self, admissible: bool) -> tuple[list[float], list[float]]:
        """Return the abscissae and velocities of the admissible, or of the other, solutions."""
        chosen = [
            (x, v)
            for x, v, kind in zip(self.x, self.v, self.admissible, strict=True)
            if kind is admissible
        ]
        return [x for x, _ in chosen], [v for _, v in chosen]

    def columns(self, x_name: str) -> dict[str, ArrayLike]:
        """Return the columns for the CSV file of the picture."""
        kinds = ["yes" if kind else "no" for kind in self.admissible]
        return {x_name: self.x, "v": self.v, "admissible": kinds}


def curve_of(answers: Sequence[KineticRelation], over: Literal["c", "eta"]) -> PlottedSolutions:
    """Return every solution over c or η; one that was not judged counts as inadmissible."""
    rows = [
        (float(getattr(answer, over)), branch.v, branch.admissible is True)
        for answer in answers
        for branch in answer.branches
    ]
    x, v, kinds = zip(*rows, strict=True)
    return PlottedSolutions(x, v, kinds)


def draw_curve(axes: Axes, curve: PlottedSolutions) -> None:
    """Draw admissible solutions with filled marks, the others with hollow ones."""
    blue, red = COLOURS["blue"], COLOURS["vermilion"]
    axes.plot(*curve.part(True), "o", ms=1.8, color=blue, label="admissible")
    axes.plot(*curve.part(False), "o", ms=1.8, color=red, mfc="none", label="not admissible")


def draw_thresholds(axes: Axes, values: Mapping[str, float | None], symbol: str) -> None:
    """Draw a vertical line at each existing threshold.

    It is dashed for the fold, dotted for the limit of stability, and solid for all others.
    """
    for name, value in values.items():
        if value is not None:
            axes.axvline(
                value,
                color="0.5",
                lw=0.8,
                ls={"fold": "--", "stable": ":"}.get(name, "-"),
                label=rf"${symbol}_\mathrm{{{name}}}$ = {value:.4g}",
            )


def draw_runs(axes: Axes, x: Sequence[float], v: ArrayLike, marker: str, label: str) -> None:
    """Draw the velocities of runs of the chain, zero for a pinned one; None is not drawn."""
    colour = COLOURS["purple" if marker == "x" else "black"]
    axes.plot(x, v, marker, ms=4.5, mfc="none", color=colour, label=label)
