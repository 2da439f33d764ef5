"""The right sides of (8) and of its averaged form (43), compiled.

The state is a row of length 2m (``active``): (y, ẏ), or (Re φ, Im φ) in slow time T = εt; all
quantities are dimensionless.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from verification.compiled import njit
from verification.integrators.active import add_coupling

FloatArray = npt.NDArray[np.float64]

FULL, ENVELOPE = 0, 1
"""Codes of the two equations."""


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def full_slope(
    x: FloatArray, parameters: FloatArray, left: int, right: int, out: FloatArray
) -> None:
    """Put (ẏ, ÿ) of (8) into out.

    Parameters
    ----------
    x, out : ndarray, shape (2m,)
        (y, ẏ) and its derivative.
    parameters : ndarray, shape (4,)
        a, b, c, ε.
    left, right : int
        What is beyond the ends (``active``).
    """
    a, b, c, eps = parameters[0], parameters[1], parameters[2], parameters[3]
    m = x.size // 2
    y, w, speed, force = x[:m], x[m:], out[:m], out[m:]
    for n in range(m):
        square = y[n] * y[n]
        speed[n] = w[n]
        force[n] = -y[n] - eps * w[n] * (1.0 + square * (b * square - a))
    add_coupling(force, y, -eps * c, left, right, w[0])


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def envelope_slope(
    x: FloatArray, parameters: FloatArray, left: int, right: int, out: FloatArray
) -> None:
    """Put φ' of (43) into out: φ' = (ic/2)(2φ - φ₋ - φ₊) - φ(1 - a|φ|²/4 + b|φ|⁴/8)/2.

    Parameters and shapes as in :func:`full_slope`.
    """
    a, b, c = parameters[0], parameters[1], parameters[2]
    m = x.size // 2
    u, v, next_u, next_v = x[:m], x[m:], out[:m], out[m:]
    for n in range(m):
        square = u[n] * u[n] + v[n] * v[n]
        half = 0.5 * (1.0 + square * (0.125 * b * square - 0.25 * a))
        next_u[n] = -half * u[n]
        next_v[n] = -half * v[n]
    add_coupling(next_u, v, -0.5 * c, left, right, u[0])
    add_coupling(next_v, u, 0.5 * c, left, right, -v[0])


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def slope(
    model: int, x: FloatArray, parameters: FloatArray, left: int, right: int, out: FloatArray
) -> None:
    """Put the right side of FULL or ENVELOPE into out."""
    if model == FULL:
        full_slope(x, parameters, left, right, out)
    else:
        envelope_slope(x, parameters, left, right, out)
