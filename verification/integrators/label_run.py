"""One compiled run of (8) or (43) that stops as soon as it can name the state of the chain.

Steps are those of Dormand and Prince's 8(5,3) pair, whose tableau scipy publishes as attributes of
``scipy.integrate.DOP853``. A run of the map needs no dense output and no long chain, so that this
is cheaper here than ``verification.integrators.taylor``: at N = 16 by more than four times.

The state is an array of shape (2, N): (y, ẏ), or (Re φ, Im φ). The clock is t, or T = εt.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from numba import njit
from scipy.integrate import DOP853

FloatArray = npt.NDArray[np.float64]

FULL, ENVELOPE = 0, 1
"""Codes of the two models."""

UNDECIDED, FRONT, BREATHER, FIXED_POINT, BROKEN = 0, 1, 2, 3, 4
"""How a run ended; BROKEN if a step became too short or a number was not finite."""

A = np.ascontiguousarray(DOP853.A)
B = np.ascontiguousarray(DOP853.B)
E3 = np.ascontiguousarray(DOP853.E3)
E5 = np.ascontiguousarray(DOP853.E5)
STAGES = 12

SAMPLES = 16
"""Samples in each window."""

SHORTEST = 1e-9
"""A step below this ends the run as BROKEN."""


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def slope(model: int, p: FloatArray, state: FloatArray, out: FloatArray) -> None:
    """Put the right side of (8) or (43), free ends, into ``out``; p = (a, b, c, ε)."""
    a, b, c, eps = p[0], p[1], p[2], p[3]
    last = state.shape[1] - 1
    if model == FULL:
        pull = eps * c
        for n in range(1, last):
            out[1, n] = -pull * (2.0 * state[0, n] - state[0, n - 1] - state[0, n + 1])
        out[1, 0] = -pull * (state[0, 0] - state[0, 1])
        out[1, last] = -pull * (state[0, last] - state[0, last - 1])
        for n in range(last + 1):
            y, w = state[0, n], state[1, n]
            s = y * y
            out[0, n] = w
            out[1, n] -= y + eps * w * (1.0 - a * s + b * s * s)
        return
    pull = 0.5 * c
    for n in range(1, last):
        out[0, n] = -pull * (2.0 * state[1, n] - state[1, n - 1] - state[1, n + 1])
        out[1, n] = pull * (2.0 * state[0, n] - state[0, n - 1] - state[0, n + 1])
    for n, inner in ((0, 1), (last, last - 1)):
        out[0, n] = -pull * (state[1, n] - state[1, inner])
        out[1, n] = pull * (state[0, n] - state[0, inner])
    for n in range(last + 1):
        re, im = state[0, n], state[1, n]
        s = re * re + im * im
        g = 0.5 - 0.125 * a * s + 0.0625 * b * s * s
        out[0, n] -= g * re
        out[1, n] -= g * im


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def step(
    model: int,
    p: FloatArray,
    state: FloatArray,
    h: float,
    K: FloatArray,
    trial: FloatArray,
    tolerance: float,
) -> float:
    """Put the state a time h on into ``trial``; return the error over what is allowed.

    K[0] must hold the slope at ``state``; the error is measured against the largest value.
    """
    flat, target = state.reshape(-1), trial.reshape(-1)
    k = K.reshape((STAGES, -1))
    for s in range(1, STAGES):
        for n in range(flat.size):
            target[n] = flat[n]
        for j in range(s):
            weight = h * A[s, j]
            if weight != 0.0:
                for n in range(flat.size):
                    target[n] += weight * k[j, n]
        slope(model, p, trial, K[s])
    size = third = fifth = 0.0
    for n in range(flat.size):
        # Stages 1 to 4 have no weight in the result or in either estimate.
        total = B[0] * k[0, n]
        three = E3[0] * k[0, n]
        five = E5[0] * k[0, n]
        for j in range(5, STAGES):
            total += B[j] * k[j, n]
            three += E3[j] * k[j, n]
            five += E5[j] * k[j, n]
        target[n] = flat[n] + h * total
        size = max(size, abs(flat[n]))
        third = max(third, abs(three))
        fifth = max(fifth, abs(five))
    if not math.isfinite(third + fifth):
        return math.nan
    if fifth == 0.0:
        return 0.0
    error: float = h * fifth * fifth / math.hypot(fifth, 0.1 * third)
    return error / (tolerance * max(size, 1e-300))


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
    for n in range(state.shape[1]):
        total += state[0, n] ** 2 + state[1, n] ** 2
        if model == FULL and n > 0:
            total += p[2] * p[3] * (state[0, n] - state[0, n - 1]) ** 2
    return total < quiet


@njit(cache=True, error_model="numpy")
def to_section(
    model: int, p: FloatArray, state: FloatArray, h: float, K: FloatArray, out: FloatArray
) -> None:
    """Put into ``out`` the state where the last site has y = 0, within h after ``state``.

    Shorter steps are taken from the same point (Hénon), by the Illinois rule; y has opposite
    signs at 0 and h.
    """
    last = state.shape[1] - 1
    low, high = 0.0, h
    at_low = state[0, last]
    step(model, p, state, h, K, out, 1.0)
    at_high = out[0, last]
    for _ in range(30):
        middle = low - at_low * (high - low) / (at_high - at_low)
        step(model, p, state, middle, K, out, 1.0)
        value = out[0, last]
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
    start : ndarray, shape (2, N)
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
    sites = start.shape[1]
    state, trial, sample = start.copy(), start.copy(), start.copy()
    K = np.zeros((STAGES, 2, sites))
    lowest, highest = np.zeros(sites), np.zeros(sites)
    t, h, steps, above = 0.0, 0.01, 0, 0
    arrived = first_still = -1.0
    window_begin = next_sample = 0.0
    samples = 0
    slope(model, p, state, K[0])
    while t < end:
        if at_rest_for_ever(model, p, state, quiet):
            return FIXED_POINT, t, 0, steps
        error = step(model, p, state, h, K, trial, tolerance)
        if not math.isfinite(error) or h < SHORTEST:
            return BROKEN, t, above, steps
        if error > 1.0:
            h *= max(0.2, 0.9 * error ** (-1.0 / 8.0))
            continue
        rises = state[0, sites - 1] < 0.0 and trial[0, sites - 1] >= 0.0
        if t >= next_sample and (model == ENVELOPE or rises):
            if model == FULL:
                to_section(model, p, state, h, K, sample)
            else:
                sample[:] = state
            above = 0
            for n in range(sites):
                amplitude = math.hypot(sample[0, n], sample[1, n])
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
        slope(model, p, state, K[0])
        if math.hypot(state[0, 0], state[1, 0]) > level:
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
