"""Oscillators on any network, written a second time for scipy: plain functions and a matrix L.

ÿ + g(y) + ε h(y, ẏ) ẏ + εc L (y + d ẏ) = F(t)
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from theory.arrays import FloatArray
from verification.references.equations import Rate

Force = Callable[[FloatArray], FloatArray]
Damping = Callable[[FloatArray, FloatArray], FloatArray]


def undriven(_: float) -> float:
    """Return F = 0."""
    return 0.0


def oscillator_rate(
    g: Force,
    h: Damping,
    matrix: Any,
    *,
    c: float,
    eps: float,
    d: float = 0.0,
    force: Callable[[float], Any] = undriven,
) -> Rate:
    """Return the right-hand side for a flat state (y, ẏ).

    Examples
    --------
    >>> rate = oscillator_rate(lambda y: y, lambda y, v: y**2, np.zeros((1, 1)), c=1.0, eps=0.1)
    >>> rate(0.0, np.array([2.0, 1.0])).tolist()
    [1.0, -2.4]
    """
    sites = matrix.shape[0]

    def rate(t: float, state: FloatArray) -> FloatArray:
        y, v = state[:sites], state[sites:]
        restoring = g(y) + eps * (h(y, v) * v + c * (matrix @ (y + d * v)))
        return np.concatenate([v, force(t) - restoring])

    return rate
