"""Common parts of Figs. 7-11: their parameters, and an integration of (8) by scipy alone."""

from __future__ import annotations

import numpy as np

from theory.arrays import FloatArray

A, B, EPS = 2.5, 0.5, 0.01
"""Parameters of Figs. 7-11."""


def flow(state: FloatArray, c: float, duration: float, tolerance: float = 1e-11) -> FloatArray:
    """Integrate (8) with free ends by DOP853; (2N,) or (2N, M) for M runs at once."""
    from theory.chains.vdp import VdpChain
    from verification.references.equations import full_rate
    from verification.references.pace import last_state

    start = np.asarray(state, dtype=float)
    rate = full_rate(VdpChain(a=A, b=B, c=c, eps=EPS, sites=start.shape[0] // 2))
    return last_state(rate, duration, start.ravel(), tolerance, tolerance).reshape(start.shape)


def monodromy_by_differences(state: FloatArray, c: float, period: float) -> FloatArray:
    """Return the derivative of scipy's flow by central differences."""
    size, step = len(state), 1e-6
    moved = np.column_stack(
        [state[:, None] + step * np.eye(size), state[:, None] - step * np.eye(size)]
    )
    ends = flow(moved, c, period, 1e-12)
    return (ends[:, :size] - ends[:, size:]) / (2.0 * step)
