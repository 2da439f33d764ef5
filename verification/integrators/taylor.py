"""Taylor series in time for (8) and (43), compiled: any order, dense output.

Both right sides are polynomials, so the Taylor coefficients of the solution follow one another by
convolutions (Cauchy products):

    full      s = y², q = s², g = 1 - a s + b q, ẇ = -y - εc(2y - y₋ - y₊) - ε g w, ẏ = w
    envelope  s = |φ|², q = s², g = 1 - as/4 + bq/8, φ' = (ic/2)(2φ - φ₋ - φ₊) - g φ/2

The step is chosen from the last two coefficients and from nothing else; none is ever rejected.
The state is an array of shape (2, N): (y, ẏ), or (Re φ, Im φ); all quantities are dimensionless.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from numba import njit

FloatArray = npt.NDArray[np.float64]


def taylor_order(tolerance: float) -> int:
    """Return the order that costs least for a tolerance, found by measurement.

    Examples
    --------
    >>> taylor_order(1e-6), taylor_order(1e-12)
    (11, 18)
    """
    return math.ceil(4.0 - 0.5 * math.log(tolerance))


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _square(out: FloatArray, A: FloatArray, i: int, k: int, lo: int, hi: int) -> None:
    """Put coefficient k of the square of A[:, i] into out[lo:hi]."""
    target = out[lo:hi]
    if k % 2 == 0:
        u = A[k // 2, i, lo:hi]
        for n in range(hi - lo):
            target[n] = u[n] * u[n]
    else:
        target[:] = 0.0
    for j in range((k + 1) // 2):
        u = A[j, i, lo:hi]
        v = A[k - j, i, lo:hi]
        for n in range(hi - lo):
            target[n] += 2.0 * u[n] * v[n]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _product(
    out: FloatArray, A: FloatArray, i: int, B: FloatArray, j: int, k: int, lo: int, hi: int
) -> None:
    """Put coefficient k of A[:, i] B[:, j] into out[lo:hi]."""
    target = out[lo:hi]
    target[:] = 0.0
    for m in range(k + 1):
        u = A[m, i, lo:hi]
        v = B[k - m, j, lo:hi]
        for n in range(hi - lo):
            target[n] += u[n] * v[n]


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _add_coupling(
    out: FloatArray, row: FloatArray, factor: float, periodic: bool, lo: int, hi: int
) -> None:
    """Add factor (2u_n - u_{n-1} - u_{n+1}) to out; beyond a free end u continues unchanged."""
    last = row.size - 1
    first, beyond = max(lo, 1), min(hi, last)
    target, here = out[first:beyond], row[first:beyond]
    left, right = row[first - 1 : beyond - 1], row[first + 1 : beyond + 1]
    for n in range(beyond - first):
        target[n] += factor * (2.0 * here[n] - left[n] - right[n])
    if lo == 0:
        end = row[last] if periodic else row[0]
        out[0] += factor * (2.0 * row[0] - end - row[1])
    if hi == last + 1:
        end = row[0] if periodic else row[last]
        out[last] += factor * (2.0 * row[last] - row[last - 1] - end)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def full_coefficients(
    C: FloatArray,
    work: FloatArray,
    order: int,
    parameters: FloatArray,
    periodic: bool,
    lo: int,
    hi: int,
    following: bool,
) -> None:
    """Fill C[k, :, lo:hi], k = 1 … order, from C[0], for (8).

    Parameters
    ----------
    C : ndarray, shape (order + 1, 2, N)
        Taylor coefficients of (y, ẏ).
    work : ndarray, shape (order + 1, 3, N)
        Room for s, q and g.
    order : int
        Highest coefficient.
    parameters : ndarray, shape (4,)
        a, b, c, ε.
    periodic : bool
        Whether site 0 is coupled to site N - 1; only with lo = 0, hi = N.
    lo, hi : int
        Active sites; the others are held at rest.
    following : bool
        Site lo - 1 is not at rest but continues the wave, φ_{lo-1} = iφ_lo.
    """
    a, b, c, eps = parameters[0], parameters[1], parameters[2], parameters[3]
    for k in range(order):
        _square(work[k, 0], C, 0, k, lo, hi)
        _square(work[k, 1], work, 0, k, lo, hi)
        s, q, g = work[k, 0, lo:hi], work[k, 1, lo:hi], work[k, 2, lo:hi]
        one = 1.0 if k == 0 else 0.0
        for n in range(hi - lo):
            g[n] = one - a * s[n] + b * q[n]
        _product(C[k + 1, 1], work, 2, C, 1, k, lo, hi)
        factor = 1.0 / (k + 1)
        y, w = C[k, 0, lo:hi], C[k, 1, lo:hi]
        next_y, next_w = C[k + 1, 0, lo:hi], C[k + 1, 1, lo:hi]
        for n in range(hi - lo):
            next_y[n] = factor * w[n]
            next_w[n] = -factor * (eps * next_w[n] + y[n])
        if following:
            C[k, 0, lo - 1] = C[k, 1, lo]
        _add_coupling(C[k + 1, 1], C[k, 0], -factor * eps * c, periodic, lo, hi)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def envelope_coefficients(
    C: FloatArray,
    work: FloatArray,
    order: int,
    parameters: FloatArray,
    periodic: bool,
    lo: int,
    hi: int,
    following: bool,
) -> None:
    """Fill C[k, :, lo:hi], k = 1 … order, from C[0], for (43) in slow time.

    Parameters and shapes as in :func:`full_coefficients`; C holds (Re φ, Im φ).
    """
    a, b, c = parameters[0], parameters[1], parameters[2]
    for k in range(order):
        _square(work[k, 0], C, 0, k, lo, hi)
        _square(work[k, 2], C, 1, k, lo, hi)
        s, q, g = work[k, 0, lo:hi], work[k, 1, lo:hi], work[k, 2, lo:hi]
        for n in range(hi - lo):
            s[n] += g[n]
        _square(work[k, 1], work, 0, k, lo, hi)
        one = 1.0 if k == 0 else 0.0
        for n in range(hi - lo):
            g[n] = one - 0.25 * a * s[n] + 0.125 * b * q[n]
        half = 0.5 / (k + 1)
        for i in range(2):
            _product(C[k + 1, i], work, 2, C, i, k, lo, hi)
            following_row = C[k + 1, i, lo:hi]
            for n in range(hi - lo):
                following_row[n] *= -half
        if following:
            C[k, 0, lo - 1] = -C[k, 1, lo]
            C[k, 1, lo - 1] = C[k, 0, lo]
        _add_coupling(C[k + 1, 0], C[k, 1], -half * c, periodic, lo, hi)
        _add_coupling(C[k + 1, 1], C[k, 0], half * c, periodic, lo, hi)


@njit(cache=True)
def largest(row: FloatArray, lo: int, hi: int) -> float:
    """Return the largest modulus in row[:, lo:hi]; not a number if one is not."""
    largest = 0.0
    for i in range(2):
        for n in range(lo, hi):
            size = abs(row[i, n])
            if not size <= largest:
                largest = size
    return largest


@njit(cache=True)
def step_length(C: FloatArray, order: int, tolerance: float, lo: int, hi: int) -> float:
    """Return h at which the last two terms are within tolerance times the largest value."""
    size = tolerance * largest(C[0], lo, hi)
    h = math.inf
    for k in (order - 1, order):
        term = largest(C[k], lo, hi)
        if not math.isfinite(term):
            return math.nan
        if term > 0.0:
            h = min(h, (size / term) ** (1.0 / k))
    return h


@njit(cache=True, fastmath={"contract"})
def evaluate(C: FloatArray, order: int, h: float, lo: int, hi: int, out: FloatArray) -> None:
    """Put the state a time h after the expansion point into out[:, lo:hi] (Horner)."""
    for i in range(2):
        target = out[i, lo:hi]
        target[:] = C[order, i, lo:hi]
        for k in range(order - 1, -1, -1):
            row = C[k, i, lo:hi]
            for n in range(hi - lo):
                target[n] = target[n] * h + row[n]
