"""The friction cell of Model I alone, (5) and (6) at c = 0, by scipy.

Slip below the belt, y' < v_d:   y'' = -2ξ y' - y + μ(v_d - y'),
stick:                           y' = v_d until y + 2ξ v_d = μ_st.

It knows nothing of the chain's integrator, so that either can be held against the other.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

MU_ST, MU_D, V_0, XI = 1.0, 0.5, 0.5, 0.05
"""Parameters (7)."""

Real = NDArray[np.float64]


def friction(speed: float) -> float:
    """Return μ of (2), corrected, at a relative speed."""
    return MU_D + (MU_ST - MU_D) * math.exp(-abs(speed) / V_0)


def hopf_speed() -> float:
    """Return v_d = v_0 ln[(μ_st - μ_d)/(2ξ v_0)], above which steady sliding is stable."""
    return V_0 * math.log((MU_ST - MU_D) / (2.0 * XI * V_0))


def slip_rate(belt: float) -> Callable[[float, Real], list[float]]:
    """Return the right side of the slip equation."""

    def rate(_: float, state: Real) -> list[float]:
        y, w = state
        return [w, -2.0 * XI * w - y + friction(belt - w)]

    return rate


class _Event:
    """Where a function of the state passes zero in one direction; it ends the run."""

    terminal = True

    def __init__(self, height: Callable[[Real], float], direction: float) -> None:
        self._height = height
        self.direction = direction

    def __call__(self, _: float, state: Real) -> float:
        return float(self._height(state))


def highest_after_slip(belt: float) -> float:
    """Return y' - v_d where it is largest after one slip phase from where stick ends.

    Zero if the cell sticks again, negative if y' does not come back to the belt's speed.
    """
    from scipy.integrate import solve_ivp

    rate = slip_rate(belt)
    events = (
        _Event(lambda state: state[1] - belt, 1.0),
        _Event(lambda state: rate(0.0, state)[1], -1.0),
    )
    start = [MU_ST - 2.0 * XI * belt, belt - 1e-12]
    run = solve_ivp(
        rate, (0.0, 50.0), start, method="DOP853", events=events, rtol=1e-11, atol=1e-13
    )
    return float(run.y[1, -1] - belt)
