"""Explicit Runge-Kutta steps for (8), compiled: the twelve stages of DOP853, or any tableau.

The state is an array of shape (2, N): (y, ẏ); all quantities are dimensionless.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import numpy.typing as npt
from numba import njit

FloatArray = npt.NDArray[np.float64]


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def full_force(
    y: FloatArray,
    w: FloatArray,
    parameters: FloatArray,
    periodic: bool,
    lo: int,
    hi: int,
    following: bool,
    out: FloatArray,
) -> None:
    """Put ÿ of (8) into out[lo:hi].

    Parameters
    ----------
    y, w : ndarray, shape (N,)
        Displacement and velocity.
    parameters : ndarray, shape (4,)
        a, b, c, ε.
    periodic : bool
        Whether site 0 is coupled to site N - 1; only with lo = 0, hi = N.
    lo, hi : int
        Active sites; the others are at rest.
    following : bool
        Site lo - 1 is not at rest but continues the wave, φ_{lo-1} = iφ_lo: y_{lo-1} = ẏ_lo.
    out : ndarray, shape (N,)
        Filled between lo and hi.
    """
    a, b, c, eps = parameters[0], parameters[1], parameters[2], parameters[3]
    last = y.size - 1
    if following:
        y[lo - 1] = w[lo]
    here, speed, target = y[lo:hi], w[lo:hi], out[lo:hi]
    for n in range(hi - lo):
        square = here[n] * here[n]
        target[n] = -here[n] - eps * speed[n] * (1.0 + square * (b * square - a))
    first, beyond = max(lo, 1), min(hi, last)
    target, here = out[first:beyond], y[first:beyond]
    left, right = y[first - 1 : beyond - 1], y[first + 1 : beyond + 1]
    for n in range(beyond - first):
        target[n] -= eps * c * (2.0 * here[n] - left[n] - right[n])
    if lo == 0:
        end = y[last] if periodic else y[0]
        out[0] -= eps * c * (2.0 * y[0] - end - y[1])
    if hi == last + 1:
        end = y[0] if periodic else y[last]
        out[last] -= eps * c * (2.0 * y[last] - y[last - 1] - end)


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def take_step(
    state: FloatArray,
    parameters: FloatArray,
    periodic: bool,
    h: float,
    A: FloatArray,
    weights: FloatArray,
    K: FloatArray,
    lo: int,
    hi: int,
    following: bool,
    out: FloatArray,
) -> None:
    """Put the state after one step of length h into out[:, lo:hi]; the slopes stay in K.

    Parameters
    ----------
    state, out : ndarray, shape (2, N)
        (y, ẏ); ``out`` is also used as room for the stages and must not be ``state``.
    A : ndarray, shape (s, s); weights : ndarray, shape (s,)
        The method (:func:`tableau`).
    K : ndarray, shape (s, 2, N)
        Room; at rest outside lo:hi.
    """
    stages = weights.size
    for i in range(stages + 1):
        row = A[i] if i < stages else weights
        y, w = out[0, lo:hi], out[1, lo:hi]
        y[:] = state[0, lo:hi]
        w[:] = state[1, lo:hi]
        for j in range(i):
            factor = h * row[j]
            if factor != 0.0:
                dy, dw = K[j, 0, lo:hi], K[j, 1, lo:hi]
                for n in range(hi - lo):
                    y[n] += factor * dy[n]
                    w[n] += factor * dw[n]
        if i < stages:
            K[i, 0, lo:hi] = w
            full_force(out[0], out[1], parameters, periodic, lo, hi, following, K[i, 1])


@njit(cache=True, error_model="numpy")
def step_error(K: FloatArray, h: float, E5: FloatArray, E3: FloatArray, lo: int, hi: int) -> float:
    """Return DOP853's estimate of the local error, the largest over sites."""
    largest5 = largest3 = 0.0
    for part in range(2):
        five, three = np.zeros(hi - lo), np.zeros(hi - lo)
        for j in range(E5.size):
            slope = K[j, part, lo:hi]
            for n in range(hi - lo):
                five[n] += E5[j] * slope[n]
                three[n] += E3[j] * slope[n]
        for n in range(hi - lo):
            largest5 = max(largest5, abs(five[n]))
            largest3 = max(largest3, abs(three[n]))
    size = largest5 * largest5 + 0.01 * largest3 * largest3
    return h * largest5 * largest5 / np.sqrt(size) if size > 0.0 else size


@njit(cache=True, error_model="numpy")
def fixed_steps(
    state: FloatArray,
    parameters: FloatArray,
    periodic: bool,
    h: float,
    steps: int,
    A: FloatArray,
    weights: FloatArray,
) -> None:
    """Advance the state by ``steps`` steps of length h, all sites; for tests and benchmarks."""
    K = np.zeros((weights.size, *state.shape))
    out = np.zeros_like(state)
    for _ in range(steps):
        take_step(state, parameters, periodic, h, A, weights, K, 0, state.shape[1], False, out)
        state[:] = out


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
