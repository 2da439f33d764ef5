"""What Figs. 7-11 share: their parameters, and an integration of (8) by scipy alone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

A, B, EPS = 2.5, 0.5, 0.01
"""Parameters of Figs. 7-11."""

Real = NDArray[np.float64]


def flow(state: Real, c: float, duration: float, tolerance: float = 1e-11) -> Real:
    """Integrate (8) with free ends by DOP853; (2N,) or (2N, M) for M runs at once."""
    from scipy.integrate import solve_ivp

    start = np.asarray(state, dtype=float)
    sites, shape = start.shape[0] // 2, start.shape

    def rate(_: float, flat: Real) -> Real:
        x = flat.reshape(shape)
        y, v = x[:sites], x[sites:]
        pull = np.zeros_like(y)
        pull[1:] += y[1:] - y[:-1]
        pull[:-1] += y[:-1] - y[1:]
        force = -y - EPS * (c * pull + v * (1.0 - A * y**2 + B * y**4))
        out: Real = np.concatenate([v, force]).ravel()
        return out

    run = solve_ivp(
        rate, (0.0, duration), start.ravel(), method="DOP853", rtol=tolerance, atol=tolerance
    )
    return np.asarray(run.y[:, -1], dtype=float).reshape(shape)


def monodromy_by_differences(state: Real, c: float, period: float, step: float = 1e-6) -> Real:
    """Differentiate the flow of scipy by central differences."""
    size = len(state)
    moved = np.column_stack(
        [state[:, None] + step * np.eye(size), state[:, None] - step * np.eye(size)]
    )
    ends = flow(moved, c, period, 1e-12)
    matrix: Real = (ends[:, :size] - ends[:, size:]) / (2.0 * step)
    return matrix
