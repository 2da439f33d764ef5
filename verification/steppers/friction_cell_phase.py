"""One slip phase of one cell (Eq. 5 at c = 0), from a given state to a turning point or a touch.

The phase is continued smoothly beyond ẏ = v_d (the exponential keeps growing), so that "the
largest velocity after release" is a smooth function of the parameters even where the cycle ends.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from verification.execution.compiled import njit
from verification.steppers.friction_series import (
    V0,
    V_D,
    allowed_remainder,
    coefficients,
    first_root,
    resolved,
    value_at,
)

FloatArray = npt.NDArray[np.float64]

HIGHEST, LOWEST, TOUCH, FASTEST, SLOWEST = 0, 1, 2, 3, 4
"""Where a phase ends: ẏ falls through 0; ẏ rises through 0; ẏ rises to v_d; ẏ stops rising; ẏ
stops falling. With y, w and v_d reversed in sign it is a phase of slip forwards."""

FAILED = -1.0
"""Time returned if the end is not reached."""


@njit(cache=True)
def phase(
    parameters: FloatArray,
    y: float,
    w: float,
    released: bool,
    end: int,
    tolerance: float,
    order: int,
    binomial: FloatArray,
    longest: float,
) -> tuple[float, float, float]:
    """Return τ, y and w = ẏ - v_d where a backward slip phase first fulfils ``end``.

    Parameters
    ----------
    parameters : ndarray, shape (6,)
        μ_st, μ_d, v₀, ξ, v_d, 0.
    y, w : float
        State at τ = 0, which does not count as an end itself.
    released : bool
        Whether stick ends there: ẇ = 0.
    end : int
        HIGHEST, LOWEST, TOUCH, FASTEST or SLOWEST.
    tolerance, order
        Local error, absolute, and order of the series.
    binomial : ndarray
        ``friction_series.binomials(order)``.
    longest : float
        Time at which to give up.
    """
    Y, W = np.zeros((order + 1, 1)), np.zeros((order + 1, 1))
    E, D = np.zeros((order + 1, 1)), np.zeros((order + 1, 1))
    lap, signs = np.zeros(1), np.zeros((3, 1))
    modes = np.full(1, -1, dtype=np.int64)
    fresh = np.full(1, released)
    f, work = np.zeros(order + 1), np.zeros((50, order + 1))
    allowed = allowed_remainder(order, tolerance)
    t = 0.0
    sign = -1.0 if end in (LOWEST, TOUCH, SLOWEST) else 1.0  # f goes from positive to negative
    armed = False  # f has been positive, or is positive just after the start
    while t < longest:
        Y[0, 0], W[0, 0] = y, w
        coefficients(Y, W, E, D, lap, modes, fresh, signs, parameters, True, order, 0, 1)
        fresh[0] = False
        h = 0.5
        for k in (order - 1, order):
            term = max(abs(W[k, 0]), abs(Y[k, 0]))
            if not math.isfinite(term):
                return FAILED, y, w
            if term > 0.0:
                h = min(h, (tolerance / term) ** (1.0 / k))
        h = resolved(W, order, h, 0, -1.0, parameters[V0], allowed)
        if t + h == t:
            return FAILED, y, w
        degree = order
        for k in range(order + 1):
            f[k] = sign * W[k, 0]
        if end in (HIGHEST, LOWEST):
            f[0] += sign * parameters[V_D]
        if end in (FASTEST, SLOWEST):
            degree = order - 1
            for k in range(order):
                f[k] = sign * (k + 1) * W[k + 1, 0]
        if t == 0.0:
            for k in range(degree + 1):
                if f[k] != 0.0:
                    armed = f[k] > 0.0
                    break
        after = value_at(f, degree, h)
        if armed or f[0] > 0.0:
            root = first_root(f, degree, h, work, binomial)
            if root <= h:
                return t + root, value_at(Y[:, 0], order, root), value_at(W[:, 0], order, root)
        armed = armed or after > 0.0
        y, w = value_at(Y[:, 0], order, h), value_at(W[:, 0], order, h)
        t += h
    return FAILED, y, w
