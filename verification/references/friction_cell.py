"""The isolated friction cell of Model I, (5) and (6) at c = 0, by scipy.

Slip below the belt, y' < v_d:   y'' = -2ξ y' - y + μ(v_d - y'),
stick:                           y' = v_d until y + 2ξ v_d = μ_st.

It shares no code with the integrator of the chain, so that each can check the other.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from theory.arrays import FloatArray
from theory.cells.friction import FrictionCell
from verification.references.equations import dynamic_friction
from verification.references.passages import passage_velocity

CELL = FrictionCell()
"""Parameters (7)."""


def slip_rate(belt: float) -> Callable[[float, FloatArray], list[float]]:
    """Return the right-hand side of the slip equation."""

    def rate(_: float, state: FloatArray) -> list[float]:
        y, w = state
        return [w, -2.0 * CELL.xi * w - y + float(dynamic_friction(abs(belt - w), CELL))]

    return rate


class _Event:
    """An event at which a function of the state passes zero in one direction; it ends the run."""

    terminal = True

    def __init__(self, height: Callable[[FloatArray], float], direction: float) -> None:
        self._height = height
        self.direction = direction

    def __call__(self, _: float, state: FloatArray) -> float:
        return float(self._height(state))


def highest_after_slip(belt: float) -> float:
    """Return the largest y' - v_d in the slip phase that follows the end of stick.

    Zero if the cell sticks again, negative if y' does not reach the velocity of the belt again.
    """
    rate = slip_rate(belt)
    events = (
        _Event(lambda state: state[1] - belt, 1.0),
        _Event(lambda state: rate(0.0, state)[1], -1.0),
    )
    start = [CELL.mu_st - 2.0 * CELL.xi * belt, belt - 1e-12]
    run = solve_ivp(
        rate, (0.0, 50.0), start, method="DOP853", events=events, rtol=1e-11, atol=1e-13
    )
    return float(run.y[1, -1] - belt)


def averaged_damping(belt: float) -> tuple[FloatArray, FloatArray]:
    """Return amplitudes R and the rate D(R) of R' = -D(R), for one cell averaged over a cycle.

    D(R) = ξR - (1/2π)∮ F cos θ dθ at y' = R cos θ, with F of (6); F changes sign where the cell
    overtakes the belt. This is of first order in the friction force.
    """
    nodes, weights = np.polynomial.legendre.leggauss(100)
    amplitudes = np.linspace(0.0, 2.2 * belt, 3000)[:, None]
    overtakes = np.arccos(np.clip(belt / np.maximum(amplitudes, 1e-12), -1.0, 1.0))
    total = np.zeros(amplitudes.shape[0])
    for low, high, sign in ((0.0, overtakes, -1.0), (overtakes, np.pi, 1.0)):
        angles = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        slip = np.abs(belt - amplitudes * np.cos(angles))
        force = sign * dynamic_friction(slip, CELL)
        total += (0.5 * (high - low) * weights * force * np.cos(angles)).sum(axis=1)
    return amplitudes[:, 0], CELL.xi * amplitudes[:, 0] - total / np.pi


def averaged_front(belt: float, sites: int = 200) -> float:
    """Return front velocity over c of r_n' = (c/2)(r_{n-1} - r_{n+1}) - D(r_n) at c = 1, by scipy.

    This is the averaged chain of Model I with quarter-turn phase steps, per unit of τ. If c is
    large compared with D'(0) the velocity is c + κ(c/6)^{1/3}, so that the ratio exceeds one if κ >
    0.

    Raises
    ------
    ValueError
        If D does not have two zeros R > 0, those of the unstable and of the stable cycle.
    """
    amplitudes, damping = averaged_damping(belt)
    level, cycle = amplitudes[1:-1][np.diff(np.sign(damping[1:])) != 0.0]

    def rate(_: float, r: FloatArray) -> FloatArray:
        padded = np.concatenate([[cycle], r, [0.0]])
        drag = np.sign(r) * np.interp(np.abs(r), amplitudes, damping)
        out: FloatArray = 0.5 * (padded[:-2] - padded[2:]) - drag
        return out

    start = np.where(np.arange(sites) < sites // 4, cycle, 0.0)
    run = solve_ivp(rate, (0.0, 1.3 * sites), start, method="DOP853", rtol=1e-8, atol=1e-9,
                    dense_output=True)  # fmt: skip
    return passage_velocity(run, range(3 * sites // 4, sites - 10), level)
