"""The loop over steps of Model II, compiled: window, samples, arrivals; (8) or (43) by DOP853.

Which step is taken depends on the state and on ``clock`` only, so that where a run is divided
changes nothing.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from verification.execution.compiled import njit
from verification.steppers.active import end_codes
from verification.steppers.rows import finite, largest, put
from verification.steppers.runge_kutta import STAGES, step_error, take_step
from verification.steppers.slopes import FULL

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

REACHED, TOO_SHORT, NOT_FINITE, BUDGET = 0, 1, 2, 3
"""How :func:`advance` ended: at the stop, at a step below ``shortest``, at a number that is not
finite, or after ``most_steps``."""

_FIRST = 0.5
"""First step at tolerance one; it follows the tolerance, so that two runs never share steps."""

_SAFETY, _SHRINK, _GROW = 0.9, 0.3, 2.0
_LAZY = 0.25
_LOOKS, _MET = 60, 0.01
_REVIEW = 6.5
"""The Runge-Kutta step of (8) grows only so often: errors of equal steps cancel over a period."""


@njit(cache=True)
def _widened(
    x: FloatArray, rest: float, margin: int, lo: int, hi: int, sites: int
) -> tuple[int, int]:
    """Return lo and hi moved outwards so that ``margin`` sites at rest lie within either end."""
    m = hi - lo
    square = rest * rest
    new_lo, new_hi = lo, hi
    for n in range(min(m, margin)):
        if x[n] ** 2 + x[m + n] ** 2 > square:
            new_lo = max(0, lo + n - margin)
            break
    for n in range(m - 1, max(0, m - margin) - 1, -1):
        if x[n] ** 2 + x[m + n] ** 2 > square:
            new_hi = min(sites, lo + n + margin + 1)
            break
    return min(lo, new_lo), max(hi, new_hi)


@njit(cache=True)
def advance(
    model: int,
    parameters: FloatArray,
    first: int,
    state: FloatArray,
    clock: FloatArray,
    counters: IntArray,
    stop: float,
    tolerance: float,
    rest: float,
    margin: int,
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
    model : int
        FULL or ENVELOPE (``slopes``).
    parameters : ndarray, shape (4,)
        a, b, c, ε.
    first : int
        What is beyond the first site (``active``).
    state : ndarray, shape (2, N)
        In: at ``clock[0]``. Out: at the new ``clock[0]``.
    clock : ndarray, shape (5,)
        Time; for Runge-Kutta the next step (0 before the first), the largest error over the
        tolerance since the last review of the step, and the time of the next review; what the sum
        of the steps has lost by rounding, which grows like their number where steps are equal.
    counters : ndarray of int, shape (5,)
        First active site, last active site + 1, samples taken, steps, sites times steps.
    stop : float
        Time to reach.
    tolerance : float
        Local error relative to the largest value.
    rest : float
        Sites at the ends are left out until one within ``margin`` of them exceeds this amplitude;
        negative for all sites always.
    margin : int
        Sites at rest that are kept.
    level : float
        Amplitude that counts as an arrival.
    behind : int
        Sites kept behind the foremost arrival, which must move to larger n; 0 keeps all.
    arrivals : ndarray, shape (N,)
        Time of the first passage of ``level`` upwards; nan before.
    times, samples : ndarray, shapes (M,), (M, 2, N)
        Where the state is wanted, ascending; filled as they are passed.
    shortest : float
        Positive; a step below this ends the call with TOO_SHORT, nothing advanced.
    most_steps : int
        Steps after which to return with BUDGET.
    """
    sites = state.shape[1]
    packed_lo = packed_hi = -1
    square, met = level * level, max(1e-15, _MET * tolerance)
    review = _REVIEW if model == FULL else 0.0
    ended = REACHED
    steps = 0
    while clock[0] < stop:
        if steps >= most_steps:
            ended = BUDGET
            break
        lo, hi = counters[0], counters[1]
        if lo != packed_lo or hi != packed_hi:
            m = hi - lo
            x, new, inside = np.zeros(2 * m), np.zeros(2 * m), np.zeros(2 * m)
            K = np.zeros((STAGES, 2 * m))
            room = np.zeros((2, 2 * m))
            put(state[0, lo:hi], x[:m])
            put(state[1, lo:hi], x[m:])
            packed_lo, packed_hi = lo, hi
            left, right = end_codes(lo, hi, sites, first, behind > 0)
        if not finite(x):
            ended = NOT_FINITE
            break
        t = clock[0]
        size = largest(x)
        h = clock[1] if clock[1] > 0.0 else _FIRST * tolerance**0.125
        while h >= shortest:
            take_step(model, x, parameters, left, right, h, K, new)
            ratio = step_error(K, h, room, size) / tolerance
            if ratio <= 1.0:
                clock[2] = max(clock[2], ratio)
                break
            h *= max(_SHRINK, _SAFETY * ratio ** (-0.125)) if math.isfinite(ratio) else _SHRINK
        clock[1] = h
        if h < shortest:
            clock[1] = 0.0
            ended = TOO_SHORT
            break
        while counters[2] < times.size and times[counters[2]] <= t + h:
            part = times[counters[2]] - t - clock[4]
            take_step(model, x, parameters, left, right, part, K, inside)
            sample = samples[counters[2]]
            put(state[0], sample[0])
            put(state[1], sample[1])
            put(inside[:m], sample[0, lo:hi])
            put(inside[m:], sample[1, lo:hi])
            counters[2] += 1
        foremost = -1
        for n in range(m):
            above = new[n] ** 2 + new[m + n] ** 2 - square
            if above < 0.0 or not math.isnan(arrivals[lo + n]):
                continue
            # The Illinois rule: the secant, with the value of an end that stays halved.
            low, high = 0.0, h
            below = x[n] ** 2 + x[m + n] ** 2 - square
            for _ in range(_LOOKS):
                part = low + below / (below - above) * (high - low)
                take_step(model, x, parameters, left, right, part, K, inside)
                value = inside[n] ** 2 + inside[m + n] ** 2 - square
                if abs(value) <= met * square or high - low <= met * h:
                    break
                if value < 0.0:
                    low, below, above = part, value, 0.5 * above
                else:
                    high, above, below = part, value, 0.5 * below
            arrivals[lo + n] = t + part
            foremost = lo + n
        put(new, x)
        whole = h + clock[4]
        clock[0] = t + whole
        clock[4] = whole - (clock[0] - t)
        if clock[0] >= clock[3]:
            clock[3] = clock[0] + review
            if clock[2] < _LAZY:
                clock[1] = h * min(_GROW, _SAFETY * max(clock[2], 1e-8) ** (-0.125))
            clock[2] = 0.0
        steps += 1
        counters[3] += 1
        counters[4] += m
        wider_lo, wider_hi = lo, hi
        if rest >= 0.0 and (lo > 0 or hi < sites):
            wider_lo, wider_hi = _widened(x, rest, margin, lo, hi, sites)
            if behind > 0:
                wider_lo = lo
        if behind > 0 and foremost - behind > lo:
            wider_lo = foremost - behind
        if wider_lo != lo or wider_hi != hi:
            put(x[:m], state[0, lo:hi])
            put(x[m:], state[1, lo:hi])
            counters[0], counters[1] = wider_lo, wider_hi
    if packed_hi > packed_lo and counters[0] == packed_lo and counters[1] == packed_hi:
        put(x[:m], state[0, packed_lo:packed_hi])
        put(x[m:], state[1, packed_lo:packed_hi])
    return ended
