"""Compiled Taylor series in time for (8) with free ends, slower than DOP853, independent of it.

The right-hand side is a polynomial, so the Taylor coefficients of the solution follow from one
another by convolutions (Cauchy products):

    s = y², q = s², g = 1 - a s + b q, ẇ = -y - εc(2y - y₋ - y₊) - ε g w, ẏ = w

The step length is chosen from the last two coefficients only; no step is rejected. The coefficients
of each factor are in an array of shape (order + 1, N); all quantities are dimensionless.
"""

from __future__ import annotations

import math

import numpy as np

from theory.arrays import FloatArray
from verification.execution.compiled import inner, outer
from verification.steppers.rows import finite, largest, put

Series = tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]
"""Coefficients of y, ẏ, s, q, g."""


@inner()
def series_room(order: int, m: int) -> Series:
    """Return arrays for the coefficients of m sites, each of shape (order + 1, m)."""
    shape = (order + 1, m)
    return np.zeros(shape), np.zeros(shape), np.zeros(shape), np.zeros(shape), np.zeros(shape)


@inner(fastmath={"contract"}, error_model="numpy")
def _square(target: FloatArray, A: FloatArray, k: int) -> None:
    """Store coefficient k of the square of A in ``target``."""
    if k % 2 == 0:
        u = A[k // 2]
        for n in range(target.size):
            target[n] = u[n] * u[n]
    else:
        target[:] = 0.0
    for j in range((k + 1) // 2):
        u = A[j]
        v = A[k - j]
        for n in range(target.size):
            target[n] += 2.0 * u[n] * v[n]


@inner(fastmath={"contract"}, error_model="numpy")
def _product(target: FloatArray, A: FloatArray, B: FloatArray, k: int) -> None:
    """Store coefficient k of the product A B in ``target``."""
    target[:] = 0.0
    for j in range(k + 1):
        u = A[j]
        v = B[k - j]
        for n in range(target.size):
            target[n] += u[n] * v[n]


@inner(fastmath={"contract"}, error_model="numpy")
def coefficients(series: Series, order: int, parameters: FloatArray) -> None:
    """Compute the coefficients k = 1 … order from the state, k = 0.

    Parameters
    ----------
    series : tuple of five ndarray, shape (order + 1, m)
        Coefficients of y, ẏ, s, q and g.
    order : int
        Highest coefficient.
    parameters : ndarray, shape (4,)
        a, b, c, ε.
    """
    a, b, c, eps = parameters[0], parameters[1], parameters[2], parameters[3]
    Y, W, S, Q, G = series
    for k in range(order):
        _square(S[k], Y, k)
        _square(Q[k], S, k)
        s, q, g = S[k], Q[k], G[k]
        one = 1.0 if k == 0 else 0.0
        for n in range(g.size):
            g[n] = one - a * s[n] + b * q[n]
        _product(W[k + 1], G, W, k)
        factor = 1.0 / (k + 1)
        y, w, next_y, next_w = Y[k], W[k], Y[k + 1], W[k + 1]
        for n in range(g.size):
            next_y[n] = factor * w[n]
            next_w[n] = -factor * (eps * next_w[n] + y[n])
        spring, last = factor * eps * c, g.size - 1
        if last > 0:
            next_w[0] -= spring * (y[0] - y[1])
            next_w[last] -= spring * (y[last] - y[last - 1])
        for n in range(1, last):
            next_w[n] -= spring * (2.0 * y[n] - (y[n - 1] + y[n + 1]))


@inner()
def step_length(series: Series, order: int, tolerance: float) -> float:
    """Return the h for which the last two terms are within tolerance times the largest value."""
    u, v = series[0], series[1]
    size = tolerance * max(largest(u[0]), largest(v[0]))
    h = math.inf
    for k in (order - 1, order):
        if not (finite(u[k]) and finite(v[k])):
            return math.nan
        term = max(largest(u[k]), largest(v[k]))
        if term > 0.0:
            h = min(h, (size / term) ** (1.0 / k))
    return h


@inner(fastmath={"contract"})
def evaluate(series: Series, order: int, h: float, out: FloatArray) -> None:
    """Store the state at a time h after the expansion point in out, shape (2m,) (Horner)."""
    m = out.size // 2
    for i in range(2):
        C = series[0] if i == 0 else series[1]
        target = out[i * m : (i + 1) * m]
        put(C[order], target)
        for k in range(order - 1, -1, -1):
            row = C[k]
            for n in range(m):
                target[n] = target[n] * h + row[n]


@outer(cache=True, error_model="numpy")
def taylor_steps(
    state: FloatArray,
    parameters: FloatArray,
    end: float,
    tolerance: float,
    order: int,
) -> int:
    """Advance a state (y, ẏ), shape (2, N), to ``end``.

    Return the number of steps, or -1 if a value is not finite.
    """
    sites = state.shape[1]
    series = series_room(order, sites)
    x = state.copy().reshape(2 * sites)
    t, steps = 0.0, 0
    while t < end:
        put(x[:sites], series[0][0])
        put(x[sites:], series[1][0])
        coefficients(series, order, parameters)
        h = step_length(series, order, tolerance)
        if math.isnan(h):
            return -1
        h = min(h, end - t)
        evaluate(series, order, h, x)
        t = end if h == end - t else t + h
        steps += 1
    put(x[:sites], state[0])
    put(x[sites:], state[1])
    return steps
