"""Taylor series in time for (8) and (43), compiled: any order, dense output, an active window.

Both right sides are polynomials, so the Taylor coefficients of the solution follow one another by
convolutions (Cauchy products):

    full      s = y², q = s², g = 1 - a s + b q, ẇ = -y - εc(2y - y₋ - y₊) - ε g w, ẏ = w
    envelope  s = |φ|², q = s², g = 1 - as/4 + bq/8, φ' = (ic/2)(2φ - φ₋ - φ₊) - g φ/2

The step is chosen from the last two coefficients and from nothing else: no step is ever rejected,
and a run that goes on from a stored state takes the very steps it would have taken.

All quantities are dimensionless. The state is an array of shape (2, N): (y, ẏ), or (Re φ, Im φ).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt
from numba import njit

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

FULL, ENVELOPE = 0, 1
"""Codes of the two models."""

REACHED, TOO_SHORT, NOT_FINITE, BUDGET = 0, 1, 2, 3
"""How :func:`advance` ended: at the stop, at a step below ``shortest``, at a number that is not
finite, or after ``most_steps``."""

MARGIN = 8
"""Sites kept beyond the last one that is above the rest level."""


def taylor_order(tolerance: float) -> int:
    """Return the order that costs least for a tolerance: work p²/h, h ~ tolerance^{1/p}.

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
def _largest(row: FloatArray, lo: int, hi: int) -> float:
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
    size = tolerance * _largest(C[0], lo, hi)
    h = math.inf
    for k in (order - 1, order):
        term = _largest(C[k], lo, hi)
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


@njit(cache=True, fastmath={"contract"})
def square_at(C: FloatArray, order: int, h: float, n: int) -> float:
    """Return the squared amplitude y² + ẏ² (or |φ|²) of site n a time h after the expansion."""
    total = 0.0
    for i in range(2):
        value = C[order, i, n]
        for k in range(order - 1, -1, -1):
            value = value * h + C[k, i, n]
        total += value * value
    return total


@njit(cache=True)
def _crossing(C: FloatArray, order: int, h: float, n: int, level: float) -> float:
    """Return when in the step site n passes the level, by bisection to rounding."""
    low, high = 0.0, h
    for _ in range(60):
        middle = 0.5 * (low + high)
        if square_at(C, order, middle, n) >= level * level:
            high = middle
        else:
            low = middle
    return high


@njit(cache=True)
def _window(state: FloatArray, rest: float, lo: int, hi: int) -> tuple[int, int]:
    """Return the window widened so that MARGIN sites at rest lie inside it on either side."""
    sites = state.shape[1]
    square = rest * rest
    new_lo, new_hi = lo, hi
    for n in range(lo, min(hi, lo + MARGIN)):
        if state[0, n] ** 2 + state[1, n] ** 2 > square:
            new_lo = max(0, n - MARGIN)
            break
    for n in range(hi - 1, max(lo, hi - MARGIN) - 1, -1):
        if state[0, n] ** 2 + state[1, n] ** 2 > square:
            new_hi = min(sites, n + MARGIN + 1)
            break
    return min(lo, new_lo), max(hi, new_hi)


@njit(cache=True)
def advance(
    model: int,
    parameters: FloatArray,
    periodic: bool,
    state: FloatArray,
    clock: FloatArray,
    counters: IntArray,
    stop: float,
    tolerance: float,
    order: int,
    rest: float,
    level: float,
    behind: int,
    arrivals: FloatArray,
    times: FloatArray,
    samples: FloatArray,
    shortest: float,
    most_steps: int,
) -> int:
    """Step until the first step that reaches ``stop``; return how it ended.

    The last step goes beyond ``stop``, so that where a run is divided does not change its steps.

    Parameters
    ----------
    model : int
        FULL or ENVELOPE.
    parameters, periodic
        As in :func:`full_coefficients`.
    state : ndarray, shape (2, N)
        In: at ``clock[0]``. Out: at the new ``clock[0]``.
    clock : ndarray, shape (1,)
        Time.
    counters : ndarray of int, shape (5,)
        First active site, last active site + 1, samples taken, steps, sites times steps.
    stop : float
        Time to reach.
    tolerance, order
        Local error relative to the largest value, and the order of the series.
    rest : float
        Sites are active from MARGIN sites before their neighbours exceed this amplitude; negative
        for all sites always.
    level : float
        Amplitude that counts as an arrival.
    behind : int
        Sites kept behind the foremost arrival, which must move to larger n; 0 keeps all.
    arrivals : ndarray, shape (N,)
        Time of the first passage of ``level`` upwards; nan before.
    times, samples : ndarray, shapes (M,), (M, 2, N)
        Where the state is wanted, ascending; filled as they are passed.
    shortest : float
        A step below this ends the call with TOO_SHORT, nothing advanced.
    most_steps : int
        Steps after which to return with BUDGET.
    """
    sites = state.shape[1]
    lo, hi = counters[0], counters[1]
    C = np.zeros((order + 1, 2, sites))
    work = np.zeros((order + 1, 3, sites))
    ended = REACHED
    steps = 0
    while clock[0] < stop:
        if steps >= most_steps:
            ended = BUDGET
            break
        following = behind > 0 and lo > 0
        for i in range(2):
            for n in range(lo, hi):
                C[0, i, n] = state[i, n]
        if model == FULL:
            full_coefficients(C, work, order, parameters, periodic, lo, hi, following)
        else:
            envelope_coefficients(C, work, order, parameters, periodic, lo, hi, following)
        h = step_length(C, order, tolerance, lo, hi)
        if math.isnan(h):
            ended = NOT_FINITE
            break
        if h < shortest:
            ended = TOO_SHORT
            break
        h = min(h, max(stop - clock[0], 1.0)) if math.isinf(h) else h
        t = clock[0]
        while counters[2] < times.size and times[counters[2]] <= t + h:
            sample = samples[counters[2]]
            for i in range(2):
                for n in range(sites):
                    sample[i, n] = state[i, n]
            evaluate(C, order, times[counters[2]] - t, lo, hi, sample)
            counters[2] += 1
        evaluate(C, order, h, lo, hi, state)
        foremost = -1
        for n in range(lo, hi):
            if math.isnan(arrivals[n]):
                square = state[0, n] ** 2 + state[1, n] ** 2
                if square >= level * level:
                    arrivals[n] = t + _crossing(C, order, h, n, level)
                    foremost = n
        clock[0] = t + h
        steps += 1
        counters[3] += 1
        counters[4] += hi - lo
        if rest >= 0.0 and (lo > 0 or hi < sites):
            wider_lo, wider_hi = _window(state, rest, lo, hi)
            if behind > 0:
                wider_lo = lo
            lo, hi = wider_lo, wider_hi
        if behind > 0 and foremost - behind > lo:
            lo = foremost - behind
        counters[0], counters[1] = lo, hi
    return ended


def allocate(sites: int) -> dict[str, Any]:
    """Return a fresh clock, counters and arrivals for :func:`advance`."""
    return {
        "clock": np.zeros(1),
        "counters": np.zeros(5, dtype=np.int64),
        "arrivals": np.full(sites, np.nan),
    }
