"""The friction cell of Model I alone, (5) and (6) at c = 0, by scipy and by fixed steps.

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


def slip_from_stick(belt: float, band: float = 0.0) -> tuple[float, float, float]:
    """Follow one slip phase from where stick ends.

    Returns
    -------
    highest, duration, landing : float
        The largest y' after the first minimum, less v_d: zero if it sticks again, negative if it
        does not come back to the belt's speed. Then the time of slip and y where it ends. With a
        band, stick begins where y' is that far below v_d.
    """
    from scipy.integrate import solve_ivp

    rate = slip_rate(belt)
    events = (
        _Event(lambda state: state[1] - belt + band, 1.0),
        _Event(lambda state: rate(0.0, state)[1], -1.0),
    )
    start = [MU_ST - 2.0 * XI * belt, belt - max(1e-12, band)]
    run = solve_ivp(
        rate, (0.0, 50.0), start, method="DOP853", events=events, rtol=1e-11, atol=1e-13
    )
    return float(run.y[1, -1] - belt), float(run.t[-1]), float(run.y[0, -1])


def slip_by_steps(belt: float, step: float = 1e-3) -> float:
    """Return the first of `slip_from_stick` by the classical Runge-Kutta method."""
    rate = slip_rate(belt)
    state = np.array([MU_ST - 2.0 * XI * belt, belt - 1e-12])
    before, rising = belt, False
    for _ in range(round(50.0 / step)):
        a = np.array(rate(0.0, state))
        b = np.array(rate(0.0, state + 0.5 * step * a))
        c = np.array(rate(0.0, state + 0.5 * step * b))
        d = np.array(rate(0.0, state + step * c))
        state = state + step / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        w = float(state[1])
        if w >= belt:
            return 0.0
        if rising and w < before:
            return before - belt
        before, rising = w, w > before
    return -belt
