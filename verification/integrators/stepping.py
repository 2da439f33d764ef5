"""The loop over steps of Model II, compiled: window, samples, arrivals; one method or another.

A method gives a step from the present state and the state at any time inside the step. Which step
is taken depends on the state and on ``clock`` only, so that where a run is divided changes nothing.

RUNGE_KUTTA  (8) by DOP853's stages and error estimate
TAYLOR       (8) by its Taylor series
ENVELOPE     (43) by its Taylor series
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from verification.integrators.runge_kutta import step_error, take_step
from verification.integrators.taylor import (
    envelope_coefficients,
    evaluate,
    full_coefficients,
    largest,
    step_length,
)

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

RUNGE_KUTTA, TAYLOR, ENVELOPE = 0, 1, 2
"""Codes of the methods."""

REACHED, TOO_SHORT, NOT_FINITE, BUDGET = 0, 1, 2, 3
"""How :func:`advance` ended: at the stop, at a step below ``shortest``, at a number that is not
finite, or after ``most_steps``."""

MARGIN = 8
"""Sites kept beyond the last one that is above the rest level."""

_FIRST = 0.05
_SAFETY, _SHRINK, _GROW = 0.9, 0.3, 2.0
_LAZY = 0.25
_REVIEW = 6.5
"""The Runge-Kutta step grows only so often: errors of equal steps cancel over a period."""


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
    method: int,
    parameters: FloatArray,
    periodic: bool,
    state: FloatArray,
    clock: FloatArray,
    counters: IntArray,
    stop: float,
    tolerance: float,
    order: int,
    A: FloatArray,
    weights: FloatArray,
    E5: FloatArray,
    E3: FloatArray,
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

    The last step goes beyond ``stop``.

    Parameters
    ----------
    method : int
        RUNGE_KUTTA, TAYLOR or ENVELOPE.
    parameters : ndarray, shape (4,)
        a, b, c, ε.
    periodic : bool
        Whether the chain is a ring.
    state : ndarray, shape (2, N)
        In: at ``clock[0]``. Out: at the new ``clock[0]``.
    clock : ndarray, shape (4,)
        Time; for Runge-Kutta the next step (0 before the first), the largest error over the
        tolerance since the last review of the step, and the time of the next review.
    counters : ndarray of int, shape (5,)
        First active site, last active site + 1, samples taken, steps, sites times steps.
    stop : float
        Time to reach.
    tolerance : float
        Local error relative to the largest value.
    order : int
        Of the Taylor series.
    A, weights, E5, E3
        Runge-Kutta method and its error estimate.
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
    series = method != RUNGE_KUTTA
    C = np.zeros((order + 1 if series else 1, 2, sites))
    work = np.zeros((order + 1 if series else 1, 3, sites))
    K = np.zeros((1 if series else weights.size, 2, sites))
    new = np.zeros((2, sites))
    inside = np.zeros((2, sites))
    ended = REACHED
    steps = 0
    while clock[0] < stop:
        if steps >= most_steps:
            ended = BUDGET
            break
        t = clock[0]
        following = behind > 0 and lo > 0
        if series:
            C[0, :, lo:hi] = state[:, lo:hi]
            if method == TAYLOR:
                full_coefficients(C, work, order, parameters, periodic, lo, hi, following)
            else:
                envelope_coefficients(C, work, order, parameters, periodic, lo, hi, following)
            h = step_length(C, order, tolerance, lo, hi)
            h = min(h, max(stop - t, 1.0)) if math.isinf(h) else h
        else:
            size = tolerance * largest(state, lo, hi)
            h = clock[1] if clock[1] > 0.0 else _FIRST
            while h >= shortest:
                take_step(state, parameters, periodic, h, A, weights, K, lo, hi, following, new)
                ratio = step_error(K, h, E5, E3, lo, hi) / size if size > 0.0 else 0.0
                if not math.isfinite(ratio):
                    h *= _SHRINK
                    continue
                if ratio > 1.0:
                    h *= max(_SHRINK, _SAFETY * ratio ** (-0.125))
                    continue
                clock[2] = max(clock[2], ratio)
                break
            clock[1] = h
        if math.isnan(h) or not math.isfinite(largest(state, lo, hi)):
            ended = NOT_FINITE
            break
        if h < shortest:
            clock[1] = 0.0
            ended = TOO_SHORT
            break
        while counters[2] < times.size and times[counters[2]] <= t + h:
            sample = samples[counters[2]]
            sample[:] = state
            part = times[counters[2]] - t
            if series:
                evaluate(C, order, part, lo, hi, sample)
            elif part > 0.0:
                take_step(
                    state, parameters, periodic, part, A, weights, K, lo, hi, following, inside
                )
                sample[:, lo:hi] = inside[:, lo:hi]
            counters[2] += 1
        if series:
            evaluate(C, order, h, lo, hi, new)
        foremost = -1
        for n in range(lo, hi):
            if math.isnan(arrivals[n]) and new[0, n] ** 2 + new[1, n] ** 2 >= level * level:
                low, high = 0.0, h
                while high - low > 1e-15 * max(1.0, t):
                    middle = 0.5 * (low + high)
                    if series:
                        evaluate(C, order, middle, n, n + 1, inside)
                    else:
                        take_step(
                            state, parameters, periodic, middle, A, weights, K, lo, hi,
                            following, inside,
                        )  # fmt: skip
                    if inside[0, n] ** 2 + inside[1, n] ** 2 >= level * level:
                        high = middle
                    else:
                        low = middle
                arrivals[n] = t + high
                foremost = n
        state[:, lo:hi] = new[:, lo:hi]
        clock[0] = t + h
        if not series and clock[0] >= clock[3]:
            clock[3] = clock[0] + _REVIEW
            if clock[2] < _LAZY:
                clock[1] = h * min(_GROW, _SAFETY * max(clock[2], 1e-8) ** (-0.125))
            clock[2] = 0.0
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
