"""Explicit Runge-Kutta steps for (8) and (43), compiled: DOP853, and the classical one of order 4.

The state is a row of length 2m (``active``); all quantities are dimensionless. The stages are
written out, a loop each: one pass a term, over a tableau, takes twice as long.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from scipy.integrate import DOP853

from verification.execution.compiled import njit
from verification.steppers.active import end_codes
from verification.steppers.rows import finite, largest, put
from verification.steppers.slopes import slope

FloatArray = npt.NDArray[np.float64]

STAGES = DOP853.n_stages
_A, _B, _E5, _E3 = (np.array(row) for row in (DOP853.A, DOP853.B, DOP853.E5, DOP853.E3))


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def take_step(
    model: int,
    x: FloatArray,
    parameters: FloatArray,
    left: int,
    right: int,
    h: float,
    K: FloatArray,
    out: FloatArray,
) -> None:
    """Put the state after one step of DOP853 of length h into out; the slopes stay in K.

    Parameters
    ----------
    model : int
        FULL or ENVELOPE (``slopes``).
    x, out : ndarray, shape (2m,)
        State; ``out`` is also room for the stages and must not be ``x``.
    K : ndarray, shape (STAGES, 2m)
        Room.
    """
    size = x.size
    k0, k1, k2, k3, k4, k5 = K[0], K[1], K[2], K[3], K[4], K[5]
    k6, k7, k8, k9, k10, k11 = K[6], K[7], K[8], K[9], K[10], K[11]
    slope(model, x, parameters, left, right, k0)
    a = _A[1]
    for n in range(size):
        out[n] = x[n] + h * (a[0] * k0[n])
    slope(model, out, parameters, left, right, k1)
    a = _A[2]
    for n in range(size):
        out[n] = x[n] + h * (a[0] * k0[n] + a[1] * k1[n])
    slope(model, out, parameters, left, right, k2)
    a = _A[3]
    for n in range(size):
        out[n] = x[n] + h * (a[0] * k0[n] + a[2] * k2[n])
    slope(model, out, parameters, left, right, k3)
    a = _A[4]
    for n in range(size):
        out[n] = x[n] + h * (a[0] * k0[n] + a[2] * k2[n] + a[3] * k3[n])
    slope(model, out, parameters, left, right, k4)
    a = _A[5]
    for n in range(size):
        out[n] = x[n] + h * (a[0] * k0[n] + a[3] * k3[n] + a[4] * k4[n])
    slope(model, out, parameters, left, right, k5)
    a = _A[6]
    for n in range(size):
        out[n] = x[n] + h * (a[0] * k0[n] + a[3] * k3[n] + a[4] * k4[n] + a[5] * k5[n])
    slope(model, out, parameters, left, right, k6)
    a = _A[7]
    for n in range(size):
        out[n] = x[n] + h * (
            a[0] * k0[n] + a[3] * k3[n] + a[4] * k4[n] + a[5] * k5[n] + a[6] * k6[n]
        )
    slope(model, out, parameters, left, right, k7)
    a = _A[8]
    for n in range(size):
        out[n] = x[n] + h * (
            a[0] * k0[n] + a[3] * k3[n] + a[4] * k4[n] + a[5] * k5[n] + a[6] * k6[n] + a[7] * k7[n]
        )
    slope(model, out, parameters, left, right, k8)
    a = _A[9]
    for n in range(size):
        out[n] = x[n] + h * (
            a[0] * k0[n]
            + a[3] * k3[n]
            + a[4] * k4[n]
            + a[5] * k5[n]
            + a[6] * k6[n]
            + a[7] * k7[n]
            + a[8] * k8[n]
        )
    slope(model, out, parameters, left, right, k9)
    a = _A[10]
    for n in range(size):
        out[n] = x[n] + h * (
            a[0] * k0[n]
            + a[3] * k3[n]
            + a[4] * k4[n]
            + a[5] * k5[n]
            + a[6] * k6[n]
            + a[7] * k7[n]
            + a[8] * k8[n]
            + a[9] * k9[n]
        )
    slope(model, out, parameters, left, right, k10)
    a = _A[11]
    for n in range(size):
        out[n] = x[n] + h * (
            a[0] * k0[n]
            + a[3] * k3[n]
            + a[4] * k4[n]
            + a[5] * k5[n]
            + a[6] * k6[n]
            + a[7] * k7[n]
            + a[8] * k8[n]
            + a[9] * k9[n]
            + a[10] * k10[n]
        )
    slope(model, out, parameters, left, right, k11)
    for n in range(size):
        out[n] = x[n] + h * (
            _B[0] * k0[n]
            + _B[5] * k5[n]
            + _B[6] * k6[n]
            + _B[7] * k7[n]
            + _B[8] * k8[n]
            + _B[9] * k9[n]
            + _B[10] * k10[n]
            + _B[11] * k11[n]
        )


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def step_error(K: FloatArray, h: float, room: FloatArray, size: float) -> float:
    """Return DOP853's estimate of the local error, the largest over sites, relative to ``size``.

    It is e5²/√(e5² + e3²/100) and vanishes where e3 alone is huge, so that a step that explodes
    would pass: where e3 is as large as the state, the estimate is infinite. ``room`` has the shape
    (2, 2m).
    """
    five, three = room[0], room[1]
    k0, k5, k6, k7, k8, k9, k10, k11 = K[0], K[5], K[6], K[7], K[8], K[9], K[10], K[11]
    for n in range(five.size):
        five[n] = (
            _E5[0] * k0[n]
            + _E5[5] * k5[n]
            + _E5[6] * k6[n]
            + _E5[7] * k7[n]
            + _E5[8] * k8[n]
            + _E5[9] * k9[n]
            + _E5[10] * k10[n]
            + _E5[11] * k11[n]
        )
    for n in range(three.size):
        three[n] = (
            _E3[0] * k0[n]
            + _E3[5] * k5[n]
            + _E3[6] * k6[n]
            + _E3[7] * k7[n]
            + _E3[8] * k8[n]
            + _E3[9] * k9[n]
            + _E3[10] * k10[n]
            + _E3[11] * k11[n]
        )
    e5, e3 = h * largest(five), h * largest(three)
    if not (finite(five) and finite(three)) or e3 >= size > 0.0:
        return math.inf
    if e5 == 0.0:
        return 0.0
    return e5 / size * (e5 / math.sqrt(e5 * e5 + 0.01 * e3 * e3))


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def take_classical_step(
    model: int,
    x: FloatArray,
    parameters: FloatArray,
    left: int,
    right: int,
    h: float,
    K: FloatArray,
    out: FloatArray,
) -> None:
    """Put the state after one classical step of order 4 into out; as :func:`take_step`."""
    size, half, whole = x.size, 0.5 * h, h / 6.0
    k0, k1, k2, k3 = K[0], K[1], K[2], K[3]
    slope(model, x, parameters, left, right, k0)
    for n in range(size):
        out[n] = x[n] + half * k0[n]
    slope(model, out, parameters, left, right, k1)
    for n in range(size):
        out[n] = x[n] + half * k1[n]
    slope(model, out, parameters, left, right, k2)
    for n in range(size):
        out[n] = x[n] + h * k2[n]
    slope(model, out, parameters, left, right, k3)
    for n in range(size):
        out[n] = x[n] + whole * (k0[n] + 2.0 * (k1[n] + k2[n]) + k3[n])


@njit(cache=True, error_model="numpy")
def fixed_steps(
    model: int,
    state: FloatArray,
    parameters: FloatArray,
    first: int,
    h: float,
    steps: int,
    order: int,
) -> None:
    """Advance a state of shape (2, N) by steps of length h, all sites; for tests and benchmarks.

    ``order`` is 8, or 4 for the classical step.
    """
    sites = state.shape[1]
    left, right = end_codes(0, sites, sites, first, False)
    x = state.copy().reshape(2 * sites)
    out = np.zeros(2 * sites)
    K = np.zeros((STAGES, 2 * sites))
    for _ in range(steps):
        if order == 8:
            take_step(model, x, parameters, left, right, h, K, out)
        else:
            take_classical_step(model, x, parameters, left, right, h, K, out)
        put(out, x)
    put(x[:sites], state[0])
    put(x[sites:], state[1])
