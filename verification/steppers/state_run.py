"""One compiled run of (8) or (43) that stops as soon as it can name the state of the chain.

The state is a row of length 2N (``active``), all sites, free ends. The clock is t, or T = εt.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from verification.execution.compiled import njit
from verification.steppers.active import FREE
from verification.steppers.rows import finite, largest, put
from verification.steppers.runge_kutta import STAGES, step_error, take_step
from verification.steppers.slopes import ENVELOPE, FULL

FloatArray = npt.NDArray[np.float64]

UNDECIDED, FRONT, BREATHER, FIXED_POINT, BROKEN = 0, 1, 2, 3, 4
"""How a run ended; BROKEN if a step became too short or a number was not finite."""

SAMPLES = 16
"""Samples in each window."""

SHORTEST = 1e-9
"""A step below this ends the run as BROKEN."""


@njit(cache=True)
def at_rest_for_ever(model: int, p: FloatArray, state: FloatArray, quiet: float) -> bool:
    """Tell whether the chain is certain to go to rest: its norm or energy is below ``quiet``.

    Envelope: (Σ|φ|²)' = -Σ|φ|²(1 - a|φ|²/4 + b|φ|⁴/8). Where Σ|φ|² is below the square of the
    unstable cycle, so is every |φ_n|², all terms are negative, and it stays so.

    Full: E = ½Σ(ẏ² + y²) + ½εcΣ(y_n - y_{n+1})² has E' = -εΣẏ²(1 - ay² + by⁴). Where 2E is below
    the smaller root y² of 1 - ay² + by⁴, so is every y_n², and E cannot grow; the only orbit on
    which it is constant is rest.

    ``quiet`` is that square or root; infinite where there is none, as damping is then positive
    everywhere.
    """
    total = 0.0
    for value in state:
        total += value * value
    if model == FULL:
        for n in range(1, state.size // 2):
            total += p[2] * p[3] * (state[n] - state[n - 1]) ** 2
    return total < quiet


@njit(cache=True, error_model="numpy")
def to_section(
    p: FloatArray,
    state: FloatArray,
    h: float,
    K: FloatArray,
    out: FloatArray,
) -> None:
    """Put into ``out`` the state of (8) where the last site has y = 0, within h after ``state``.

    Shorter steps are taken from the same point (Hénon), by the Illinois rule; y has opposite
    signs at 0 and h.
    """
    last = state.size // 2 - 1
    low, high = 0.0, h
    at_low = state[last]
    take_step(FULL, state, p, FREE, FREE, h, K, out)
    at_high = out[last]
    for _ in range(30):
        middle = low - at_low * (high - low) / (at_high - at_low)
        take_step(FULL, state, p, FREE, FREE, middle, K, out)
        value = out[last]
        if abs(value) <= 1e-12 or high - low < 1e-14:
            return
        if (value < 0.0) == (at_low < 0.0):
            low, at_low, at_high = middle, value, 0.5 * at_high
        else:
            high, at_high, at_low = middle, value, 0.5 * at_low


@njit(cache=True, error_model="numpy")
def run_to_label(
    model: int,
    p: FloatArray,
    start: FloatArray,
    level: float,
    quiet: float,
    end: float,
    hold: float,
    window: float,
    still: float,
    tolerance: float,
) -> tuple[int, float, int, int]:
    """Step until a label is certain; return it, the time, sites above the level, and steps.

    Parameters
    ----------
    model : int
        FULL or ENVELOPE.
    p : ndarray, shape (4,)
        a, b, c, ε.
    start : ndarray, shape (2N,)
        State at time zero; the first site is the far end, the last one is displaced.
    level : float
        Amplitude of the unstable cycle; infinite if there is none.
    quiet : float
        See :func:`at_rest_for_ever`.
    end : float
        Time at which the run is given up as UNDECIDED.
    hold : float
        FRONT once the far end has been above the level for this long.
    window, still : float
        BREATHER once, in every window of this length from some time to twice that time, each
        site's amplitude varied by at most ``still``, without meeting the level, and not the far
        end but some site was above it. For (8) amplitudes are taken where the last site has
        y = 0 and rises, since within a period they ripple.
    tolerance : float
        Local error of a step, relative to the largest value.
    """
    sites = start.size // 2
    state, trial, sample = start.copy(), start.copy(), start.copy()
    K = np.zeros((STAGES, start.size))
    room = np.zeros((2, start.size))
    lowest, highest = np.zeros(sites), np.zeros(sites)
    t, h, steps, above = 0.0, 0.01, 0, 0
    arrived = first_still = -1.0
    window_begin = next_sample = 0.0
    samples = 0
    while t < end:
        if at_rest_for_ever(model, p, state, quiet):
            return FIXED_POINT, t, 0, steps
        take_step(model, state, p, FREE, FREE, h, K, trial)
        error = step_error(K, h, room, largest(state)) / tolerance
        if h < SHORTEST or not finite(state):
            return BROKEN, t, above, steps
        if not error <= 1.0:
            h *= max(0.2, 0.9 * error ** (-1.0 / 8.0)) if math.isfinite(error) else 0.2
            continue
        rises = state[sites - 1] < 0.0 and trial[sites - 1] >= 0.0
        if t >= next_sample and (model == ENVELOPE or rises):
            if model == FULL:
                to_section(p, state, h, K, sample)
            else:
                put(state, sample)
            above = 0
            for n in range(sites):
                amplitude = math.hypot(sample[n], sample[sites + n])
                above += amplitude > level
                if samples == 0:
                    lowest[n] = highest[n] = amplitude
                lowest[n] = min(lowest[n], amplitude)
                highest[n] = max(highest[n], amplitude)
            samples += 1
            next_sample += window / SAMPLES
        t += h
        h *= min(5.0, 0.9 * max(error, 1e-12) ** (-1.0 / 8.0))
        if model == FULL:
            h = min(h, 1.5)  # less than half a period, so that no passage of y = 0 is missed
        state, trial = trial, state
        steps += 1
        if math.hypot(state[0], state[sites]) > level:
            if arrived < 0.0:
                arrived = t
            elif t - arrived >= hold:
                return FRONT, t, above, steps
        else:
            arrived = -1.0
        if t - window_begin >= window and samples >= SAMPLES // 2:
            is_still = above > 0 and arrived < 0.0
            for n in range(sites):
                crosses = lowest[n] <= level <= highest[n]
                is_still = is_still and highest[n] - lowest[n] <= still and not crosses
            if not is_still:
                first_still = -1.0
            elif first_still < 0.0:
                first_still = t
            elif t >= 2.0 * first_still:
                return BREATHER, t, above, steps
            window_begin, samples = t, 0
            next_sample = t
    return UNDECIDED, t, above, steps
