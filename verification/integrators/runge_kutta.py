"""Explicit Runge-Kutta steps for (8) and (43), compiled: the stages of DOP853, or any tableau.

The state is a row of length 2m (``active``); all quantities are dimensionless.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from verification.compiled import njit
from verification.integrators.active import end_codes, finite, largest
from verification.integrators.slopes import slope

FloatArray = npt.NDArray[np.float64]


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def take_step(
    model: int,
    x: FloatArray,
    parameters: FloatArray,
    left: int,
    right: int,
    h: float,
    A: FloatArray,
    weights: FloatArray,
    K: FloatArray,
    out: FloatArray,
) -> None:
    """Put the state after one step of length h into out; the slopes stay in K.

    Parameters
    ----------
    model : int
        FULL or ENVELOPE (``slopes``).
    x, out : ndarray, shape (2m,)
        State; ``out`` is also room for the stages and must not be ``x``.
    A : ndarray, shape (s, s); weights : ndarray, shape (s,)
        The method (:func:`tableau`).
    K : ndarray, shape (s, 2m)
        Room.
    """
    stages = weights.size
    for i in range(stages + 1):
        row = A[i] if i < stages else weights
        factor, known = (h * row[0], K[0]) if i > 0 else (0.0, x)
        for n in range(x.size):
            out[n] = x[n] + factor * known[n]
        for j in range(1, i):
            factor = h * row[j]
            if factor != 0.0:
                known = K[j]
                for n in range(x.size):
                    out[n] += factor * known[n]
        if i < stages:
            slope(model, out, parameters, left, right, K[i])


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def step_error(
    K: FloatArray, h: float, E5: FloatArray, E3: FloatArray, room: FloatArray, size: float
) -> float:
    """Return DOP853's estimate of the local error, the largest over sites, relative to ``size``.

    It is e5²/√(e5² + e3²/100) and vanishes where e3 alone is huge, so that a step that explodes
    would pass: where e3 is as large as the state, the estimate is infinite. ``room`` has the shape
    (2, 2m).
    """
    five, three = room[0], room[1]
    five[:] = 0.0
    three[:] = 0.0
    for j in range(E5.size):
        known, of_five, of_three = K[j], E5[j], E3[j]
        if of_five == 0.0 and of_three == 0.0:
            continue
        for n in range(five.size):
            five[n] += of_five * known[n]
            three[n] += of_three * known[n]
    e5, e3 = h * largest(five), h * largest(three)
    if not (finite(five) and finite(three)) or e3 >= size > 0.0:
        return math.inf
    if e5 == 0.0:
        return 0.0
    return e5 / size * (e5 / math.sqrt(e5 * e5 + 0.01 * e3 * e3))


@njit(cache=True, error_model="numpy")
def fixed_steps(
    model: int,
    state: FloatArray,
    parameters: FloatArray,
    first: int,
    h: float,
    steps: int,
    A: FloatArray,
    weights: FloatArray,
) -> None:
    """Advance a state of shape (2, N) by steps of length h, all sites; for tests and benchmarks."""
    sites = state.shape[1]
    left, right = end_codes(0, sites, sites, first, False)
    x = state.copy().reshape(2 * sites)
    out = np.zeros(2 * sites)
    K = np.zeros((weights.size, 2 * sites))
    for _ in range(steps):
        take_step(model, x, parameters, left, right, h, A, weights, K, out)
        x[:] = out
    state[0], state[1] = x[:sites], x[sites:]


@lru_cache(maxsize=2)
def tableau(order: int) -> tuple[FloatArray, FloatArray]:
    """Return A and the weights of the method of order 4 (classical) or 8 (DOP853).

    Examples
    --------
    >>> A, weights = tableau(8)
    >>> A.shape, round(float(weights.sum()), 12)
    ((12, 12), 1.0)
    """
    if order == 4:
        A = np.zeros((4, 4))
        A[1, 0] = A[2, 1] = 0.5
        A[3, 2] = 1.0
        return A, np.array([1.0, 2.0, 2.0, 1.0]) / 6.0
    if order == 8:
        from scipy.integrate import DOP853

        stages = DOP853.n_stages
        return np.array(DOP853.A[:stages, :stages]), np.array(DOP853.B)
    raise ValueError(f"there is no tableau of order {order} here: choose 4 or 8.")


@lru_cache(maxsize=1)
def error_weights() -> tuple[FloatArray, FloatArray]:
    """Return the two rows of DOP853 that estimate its error, E5 and E3."""
    from scipy.integrate import DOP853

    stages = DOP853.n_stages
    return np.array(DOP853.E5[:stages]), np.array(DOP853.E3[:stages])
