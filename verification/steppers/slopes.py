"""The right sides of (8) and of its averaged form (43), compiled.

The state is a row of length 2m (``active``): (y, ẏ), or (Re φ, Im φ) in slow time T = εt; all
quantities are dimensionless. The two neighbours of a site are added first, so that a
mirror-symmetric state stays so to the last bit; one loop does all, since a pass costs as much as
its arithmetic. Sums are written so that products can be fused with them in one way only, as
otherwise the two ends may be rounded differently.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from verification.execution.compiled import njit
from verification.steppers.active import neighbours_of_ends

FloatArray = npt.NDArray[np.float64]

FULL, ENVELOPE = 0, 1
"""Codes of the two equations."""


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def acceleration(
    y: float, w: float, neighbours: float, a: float, b: float, c: float, eps: float
) -> float:
    """Return ÿ of a site of (8) from y, ẏ and the sum of its two neighbours."""
    square = y * y
    damped = -y - eps * w * (1.0 + square * (b * square - a))
    return damped - eps * c * (2.0 * y - neighbours)


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
    end = x.size // 2 - 1
    y, w, speed, force = x[: end + 1], x[end + 1 :], out[: end + 1], out[end + 1 :]
    first, last = neighbours_of_ends(y, left, right, w[0])
    force[0] = acceleration(y[0], w[0], first, a, b, c, eps)
    force[end] = acceleration(y[end], w[end], last, a, b, c, eps)
    for n in range(1, end):
        force[n] = acceleration(y[n], w[n], y[n - 1] + y[n + 1], a, b, c, eps)
    for n in range(end + 1):
        speed[n] = w[n]


@njit(cache=True)
def _square(u: float, v: float) -> float:
    return u * u + v * v  # nothing fused


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def envelope_velocity(
    u: float, v: float, u_near: float, v_near: float, a: float, b: float, c: float
) -> tuple[float, float]:
    """Return φ' of a site of (43) from φ = u + iv and the sums over its two neighbours.

    φ' = (ic/2)(2φ - φ₋ - φ₊) - φ(1 - a|φ|²/4 + b|φ|⁴/8)/2.
    """
    square = _square(u, v)
    less = square * (0.25 * a - 0.125 * b * square)
    return (
        0.5 * (u * less - u - c * (2.0 * v - v_near)),
        0.5 * (v * less - v + c * (2.0 * u - u_near)),
    )


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def envelope_slope(
    x: FloatArray, parameters: FloatArray, left: int, right: int, out: FloatArray
) -> None:
    """Put φ' of (43) into out. Parameters and shapes as in :func:`full_slope`."""
    a, b, c = parameters[0], parameters[1], parameters[2]
    end = x.size // 2 - 1
    u, v, next_u, next_v = x[: end + 1], x[end + 1 :], out[: end + 1], out[end + 1 :]
    u_first, u_last = neighbours_of_ends(u, left, right, -v[0])
    v_first, v_last = neighbours_of_ends(v, left, right, u[0])
    next_u[0], next_v[0] = envelope_velocity(u[0], v[0], u_first, v_first, a, b, c)
    next_u[end], next_v[end] = envelope_velocity(u[end], v[end], u_last, v_last, a, b, c)
    for n in range(1, end):
        next_u[n], next_v[n] = envelope_velocity(
            u[n], v[n], u[n - 1] + u[n + 1], v[n - 1] + v[n + 1], a, b, c
        )


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def slope(
    model: int, x: FloatArray, parameters: FloatArray, left: int, right: int, out: FloatArray
) -> None:
    """Put the right side of FULL or ENVELOPE into out."""
    if model == FULL:
        full_slope(x, parameters, left, right, out)
    else:
        envelope_slope(x, parameters, left, right, out)
