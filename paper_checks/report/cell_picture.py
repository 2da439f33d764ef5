"""The bifurcation diagram of the friction cell, for the report and for ``fronts cell``."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from verification.pictures.figures import COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from verification.cells.diagram import Bifurcation


def draw_bifurcation(axes: Axes, diagram: Bifurcation) -> None:
    """Draw the turning points of both cycles, and steady sliding, against the belt velocity."""
    hopf, stable = diagram.hopf_velocity, diagram.sliding_stable
    blue, vermilion, black = COLOURS["blue"], COLOURS["vermilion"], COLOURS["black"]
    for side in (0, 1):
        axes.plot(
            diagram.v_d, diagram.stable[:, side], color=blue,
            label="stick-slip cycle" if side == 0 else None,
        )  # fmt: skip
        axes.plot(
            diagram.v_d, diagram.unstable[:, side], "--", color=vermilion,
            label="unstable cycle" if side == 0 else None,
        )  # fmt: skip
    for chosen, line, label in (
        (stable, "-", "steady sliding, stable"),
        (~stable, ":", "steady sliding, unstable"),
    ):
        if chosen.any():
            sliding = np.where(chosen, diagram.sliding, np.nan)  # a gap in between
            axes.plot(diagram.v_d, sliding, line, color=black, label=label)
    grazing = diagram.cycle_end_velocity
    for name, velocity, line in (("Hopf", hopf, "-"), ("grazing", grazing, "-.")):
        if diagram.v_d[0] < velocity < diagram.v_d[-1]:
            axes.axvline(
                velocity, color="0.5", lw=0.6, ls=line, label=f"{name}, $v_d$ = {velocity:.5g}"
            )
    axes.set(xlabel=r"belt velocity $v_d$", ylabel="turning points of y")
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
