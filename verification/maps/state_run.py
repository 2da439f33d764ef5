"""A run of a smooth chain that stops as soon as the state of the chain can be determined.

The loop is that of every smooth chain (``verification.steppers.smooth``); this module contains its
stop condition. All sites are stepped, the ends are free, and times are kernel times.
"""

from __future__ import annotations

import math
from time import perf_counter

import numpy as np
import numpy.typing as npt

from theory.arrays import FloatArray
from theory.chains.chain import SmoothChain
from verification.execution.compiled import UNCOUNTED, inner, outer
from verification.maps.state import FoundState, Reason, State
from verification.runs.smooth_integration import SmoothIntegration
from verification.steppers.active import FREE
from verification.steppers.rows import put
from verification.steppers.runge_kutta import Step

_FRONT, _BREATHER, _FIXED_POINT = 1, 2, 3
_STATES = State.UNDECIDED, State.FRONT, State.BREATHER, State.FIXED_POINT
"""States by the return value of the stop condition."""

SAMPLES = 16
"""Number of samples in each window."""

SHORTEST = 1e-9
"""Kernel time below which a step ends the run."""

LONGEST = 1.5
"""Longest step of an oscillation: less than half a period, so that no crossing of y = 0 is
missed."""

_LEVEL, _REST_BOUND, _STIFFNESS, _HOLD, _WINDOW, _SETTLED, _OSCILLATES = 0, 1, 2, 3, 4, 5, 6
_FILLED, _LASTING, _FIRST, _BEGIN, _NEXT, _COUNT, _ABOVE, _SITES = 7, 8, 9, 10, 11, 12, 13, 14
"""Indices into the memory of the stop condition; from ``_SITES`` on it contains the lowest, then
the highest amplitude of each site in the present window."""

_ROUNDING = 1e-14
"""Relative change of a square that exceeds any effect of rounding."""


@outer(cache=True, **UNCOUNTED)
def at_rest_for_ever(state: FloatArray, stiffness: float, rest_bound: float) -> bool:
    """Return whether the chain is certain to go to rest: its norm or energy is below a bound.

    Envelope: (Σ|φ|²)' = -Σ|φ|²(1 - a|φ|²/4 + b|φ|⁴/8). If Σ|φ|² is below the square of the unstable
    cycle, so is every |φ_n|²; then all terms are negative, and this remains so.

    Full: E = ½Σ(ẏ² + y²) + ½εcΣ(y_n - y_{n+1})² has E' = -εΣẏ²(1 - ay² + by⁴). If 2E is below the
    smaller root y² of 1 - ay² + by⁴, so is every y_n², and E cannot grow; the only orbit on which
    it is constant is rest.

    ``rest_bound`` is that square or root; ``stiffness`` is 0 and εc respectively.
    """
    total = 0.0
    for value in state:
        total += value * value
        if total >= rest_bound:  # no term is negative, so for a moving chain a few sites suffice
            return False
    for n in range(1, state.size // 2):
        total += stiffness * (state[n] - state[n - 1]) ** 2
    return total < rest_bound


@inner(error_model="numpy", **UNCOUNTED)
def _to_section(  # noqa: PLR0917  (one kind each)
    take_step: Step, p: FloatArray, state: FloatArray, h: float, K: FloatArray, out: FloatArray
) -> None:
    """Put into ``out`` the state where the last site has y = 0, within h after ``state``.

    Shorter steps are taken from the same point (Hénon) by the Illinois rule: the secant method, in
    which the value at an end that is kept twice is halved; y has opposite signs at 0 and h.
    """
    last = state.size // 2 - 1
    low, high, replaced = 0.0, h, 0
    at_low = state[last]
    take_step(state, p, FREE, FREE, h, K, out)
    at_high = out[last]
    for _ in range(30):
        middle = low - at_low * (high - low) / (at_high - at_low)
        take_step(state, p, FREE, FREE, middle, K, out)
        value = out[last]
        if abs(value) <= 1e-12 or high - low < 1e-14:
            return
        if (value < 0.0) == (at_low < 0.0):
            low, at_low = middle, value
            at_high *= 0.5 if replaced < 0 else 1.0
            replaced = -1
        else:
            high, at_high = middle, value
            at_low *= 0.5 if replaced > 0 else 1.0
            replaced = 1


@inner(**UNCOUNTED)
def _take_sample(sample: FloatArray, memory: FloatArray) -> None:
    """Record the amplitudes of a sample."""
    sites = sample.size // 2
    above = 0
    for n in range(sites):
        amplitude = math.hypot(sample[n], sample[sites + n])
        above += amplitude > memory[_LEVEL]
        low, high = _SITES + n, _SITES + sites + n
        if memory[_COUNT] == 0.0:
            memory[low] = memory[high] = amplitude
        memory[low] = min(memory[low], amplitude)
        memory[high] = max(memory[high], amplitude)
    memory[_ABOVE] = above
    memory[_COUNT] += 1.0
    memory[_NEXT] += memory[_WINDOW] / SAMPLES


@inner(**UNCOUNTED)
def _settled(sites: int, memory: FloatArray) -> bool:
    """Return whether no amplitude changed in the window, and some sites are above the level."""
    if memory[_ABOVE] == 0.0 or memory[_ABOVE] == sites:
        return False
    for n in range(sites):
        low, high = memory[_SITES + n], memory[_SITES + sites + n]
        if high - low > memory[_SETTLED] or low <= memory[_LEVEL] <= high:
            return False
    return True


@outer(cache=True, **UNCOUNTED)
def sites_above(state: FloatArray, level: float) -> int:
    """Return the number of sites at which √(y² + w²) is above a level.

    Squares are compared, several sites at a time, and the root only where rounding could matter.

    Examples
    --------
    >>> sites_above(np.array([3.0, 0.0, 4.0, 5.0]), math.nextafter(5.0, 0.0))
    2
    >>> sites_above(np.array([3.0, 0.0, 4.0, 5.0]), 5.0)
    0
    """
    sites = state.size // 2
    lower, upper = (1.0 - _ROUNDING) * level * level, (1.0 + _ROUNDING) * level * level
    certain = possible = 0
    for n in range(sites):
        square = state[n] * state[n] + state[sites + n] * state[sites + n]
        certain += square > upper
        possible += square >= lower
    if certain == possible:
        return certain
    above = 0
    for n in range(sites):
        above += math.hypot(state[n], state[sites + n]) > level
    return above


@inner(**UNCOUNTED)
def _filled(t: float, state: FloatArray, memory: FloatArray) -> bool:
    """Record since when the chain has been filled; return whether it has been long enough."""
    sites, above = state.size // 2, sites_above(state, memory[_LEVEL])
    if 2 * above < sites:
        memory[_LASTING] = -1.0
    if above < sites:
        memory[_FILLED] = -1.0
        return False
    if memory[_LASTING] < 0.0:
        memory[_LASTING] = t
    if memory[_FILLED] < 0.0:
        memory[_FILLED] = t
    return bool(t >= max(2.0 * memory[_FILLED], memory[_FILLED] + memory[_HOLD]))


@inner(**UNCOUNTED)
def _stays(t: float, sites: int, memory: FloatArray) -> bool:
    """Start a new window at the end of one; return whether windows were settled long enough."""
    if t - memory[_BEGIN] < memory[_WINDOW] or memory[_COUNT] < SAMPLES // 2:
        return False
    if not _settled(sites, memory):
        memory[_FIRST] = -1.0
    elif memory[_FIRST] < 0.0:
        memory[_FIRST] = t
    elif t >= 2.0 * memory[_FIRST]:
        return True
    memory[_BEGIN], memory[_COUNT] = t, 0.0
    memory[_NEXT] = t
    return False


@outer(error_model="numpy", **UNCOUNTED)
def named_state(  # noqa: PLR0917  (as a Condition)
    take_step: Step,
    t: float,
    h: float,
    before: FloatArray,
    after: FloatArray,
    parameters: FloatArray,
    K: FloatArray,
    work: FloatArray,
    memory: FloatArray,
) -> int:
    """Return the index in `_STATES`; ``_LEVEL`` to ``_SITES`` are indices into ``memory``."""
    sites = after.size // 2
    oscillates = memory[_OSCILLATES] > 0.0
    rises = before[sites - 1] < 0.0 and after[sites - 1] >= 0.0
    if t >= memory[_NEXT] and (rises or not oscillates):
        if oscillates:
            _to_section(take_step, parameters, before, h, K, work)
        else:
            put(before, work)
        _take_sample(work, memory)
    t += h
    if _filled(t, after, memory):
        return _FRONT
    if _stays(t, sites, memory):
        return _BREATHER
    if at_rest_for_ever(after, memory[_STIFFNESS], memory[_REST_BOUND]):
        memory[_ABOVE] = 0.0
        return _FIXED_POINT
    return 0


def run_to_state(  # noqa: PLR0913  (six of them are the criteria)
    chain: SmoothChain,
    start: npt.ArrayLike,
    *,
    level: float,
    rest_bound: float,
    stiffness: float,
    hold: float,
    window: float,
    settled: float,
    end: float,
    tolerance: float,
) -> FoundState:
    """Step until the state of the chain is certain.

    The time of the result is in units of the chain's `time_unit`; its ``above`` refers to the last
    sample. Times that are given are kernel times.

    Parameters
    ----------
    chain : SmoothChain
        A chain with free ends.
    start : array_like
        State at time zero; the amplitudes of oscillating sites are sampled by the phase of the last
        site.
    level : float
        Amplitude of the unstable cycle; infinite if there is none.
    rest_bound, stiffness : float
        The chain is certain to go to rest if Σ(y² + w²) + κΣ(y_n - y_{n-1})², where κ is the
        stiffness, is below this value (:func:`at_rest_for_ever`); infinite where the damping is
        positive everywhere.
    hold : float
        FRONT if all sites have been above the level without interruption from some time until twice
        that time, and for at least this long. At the end of the run also FRONT if all were above it
        at once by half of that time, and never fewer than half of them since then.
    window, settled : float
        BREATHER if, in every window of this length from some time until twice that time, each
        site's amplitude varied by at most ``settled`` without crossing the level, and some sites,
        but not all, were above it. Where sites oscillate, amplitudes have a ripple within a period,
        so they are taken when the last site passes y = 0 upwards.
    end : float
        Time at which the run ends.
    tolerance : float
        Local error of a step, relative to the largest value.

    Raises
    ------
    RunError
        If a step becomes too short or a number is not finite.
    """
    begin, sites = perf_counter(), chain.sites
    memory = np.zeros(_SITES + 2 * sites)
    memory[: _OSCILLATES + 1] = (
        level, rest_bound, stiffness, hold, window, settled, chain.oscillates,
    )  # fmt: skip
    memory[[_FILLED, _LASTING, _FIRST]] = -1.0
    run = SmoothIntegration(
        chain,
        start,
        [end / chain.kernel_rate],
        tolerance=tolerance,
        level=math.inf,
        active_window=False,
        shortest_step=SHORTEST,
        longest_step=LONGEST if chain.oscillates else math.inf,
        watch=named_state,
        memory=memory,
    )
    if at_rest_for_ever(np.ravel(run.state), stiffness, rest_bound):
        state = State.FIXED_POINT
    else:
        run.finish()
        state = _STATES[run.outcome]
        if state is State.UNDECIDED and 0.0 <= 2.0 * memory[_LASTING] <= end:
            state = State.FRONT
    return FoundState(
        state=state,
        reason=Reason.END_TIME if state is State.UNDECIDED else Reason.DECIDED,
        time=run.time / chain.time_unit,
        above=int(memory[_ABOVE]),
        steps=run.counts["steps"],
        amplitude=run.amplitude,
        seconds=perf_counter() - begin,
    )
