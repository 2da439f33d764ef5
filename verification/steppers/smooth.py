"""The compiled loop over steps of a smooth chain: window, samples, arrivals, stop condition.

The length of each step depends only on the state and on ``clock``, so that dividing a run into
calls changes nothing. The loop is compiled once; the step of a chain and the stop condition are
compiled separately for each chain and passed as arguments (:func:`loop`). Calling them costs about
30 ns.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numba import types

from theory.arrays import FloatArray, IntArray
from theory.chains.chain import SmoothChain
from verification.execution.compiled import COUNTED, UNCOUNTED, inner, outer
from verification.steppers.active import end_codes
from verification.steppers.kernel import slope_mark, slope_of
from verification.steppers.rows import finite, largest, put
from verification.steppers.runge_kutta import STAGES, STEP_SIGNATURE, Step, dop853_step, step_error
from verification.steppers.specialise import pointer, source_mark
from verification.steppers.stop_code import StopCode

REACHED, TOO_SHORT, NOT_FINITE, BUDGET, CONDITION, MOVED = (
    int(StopCode.REACHED),
    int(StopCode.STEP_TOO_SHORT),
    int(StopCode.NOT_FINITE),
    int(StopCode.BUDGET_SPENT),
    int(StopCode.CONDITION),
    int(StopCode.WINDOW_MOVED),
)

LO, HI, SAMPLED, STEPS, SITE_STEPS, STIFF_STEPS, OUTCOME = 0, 1, 2, 3, 4, 5, 6
"""Indices into ``counters``."""

_FIRST = 0.5
"""First step for a tolerance of one; it scales with the tolerance, so that no two runs share
steps."""

_SAFETY, _SHRINK, _GROW = 0.9, 0.3, 2.0
LAZY = 0.25
"""A step grows if its error is below this fraction of the tolerance."""
_PARTS = 0.5 - 0.5 * np.cos(np.pi * np.arange(9) / 8)
"""Fractions of a step at which states are interpolated; the polynomial is of the order of the
method."""


class LoopTask(NamedTuple):
    """The constant description of a task for the loop.

    Attributes
    ----------
    parameters, drift : ndarray, shape (P,)
        Parameters of the kernel at time 0, and their rates of change; within a step they have their
        values at its midpoint.
    first : int
        What lies beyond the first site (``active``).
    end : float
        Kernel time to be reached; the last step extends beyond it.
    tolerance : float
        Local error relative to the largest value; 0 for equal steps of length ``longest``.
    shortest, longest : float
        A step below ``shortest`` ends the call without advancing; no step exceeds ``longest``.
    review : float
        A step may grow only at this interval: in an oscillation, the errors of equal steps cancel
        over a period.
    rest : float
        Sites at the ends are not stepped until one within ``margin`` of them exceeds this
        amplitude; negative to step all sites always.
    margin : int
        Number of sites at rest that are stepped.
    level : float
        Amplitude that counts as an arrival.
    trailing : int
        Number of sites stepped behind the foremost arrival, which must move to larger n; 0 for all.
    times : ndarray, shape (M,)
        Kernel times of the samples, ascending.
    clock_place : int
        Index of the time among the parameters; -1 if the kernel does not depend on time.
    least_size : float
        Errors are relative to the largest value of the state, or to this value if it is larger.
    """

    parameters: FloatArray
    drift: FloatArray
    first: int
    end: float
    tolerance: float
    shortest: float
    longest: float
    review: float
    rest: float
    margin: int
    level: float
    trailing: int
    times: FloatArray
    clock_place: int
    least_size: float


class LoopState(NamedTuple):
    """The state of a loop; everything is changed in place.

    Attributes
    ----------
    state : ndarray, shape (2, N)
        (y, w) at ``clock[0]``.
    clock : ndarray, shape (5,)
        Time; the next step (0 before the first); the largest error over the tolerance since the
        last review of the step; the time of the next review; and the accumulated rounding of the
        sum of the steps, which would otherwise grow like their number if the steps are equal.
    counters : ndarray of int, shape (7,)
        See ``LO`` and the names following it; the last one is the return value of the stop
        condition.
    arrivals : ndarray, shape (N,)
        Time at which the level was first passed upwards; nan before.
    samples : ndarray, shape (M, 2, N)
        The state at the times of the samples; filled as they are passed.
    memory : ndarray, shape (L,)
        Memory of the stop condition.
    """

    state: FloatArray
    clock: FloatArray
    counters: IntArray
    arrivals: FloatArray
    samples: FloatArray
    memory: FloatArray


class Rows(NamedTuple):
    """The sites of the window as rows (``active``), and work space.

    Attributes
    ----------
    x, new, inside : ndarray, shape (2m,)
        State before and after the step, and at a time within it.
    K : ndarray, shape (STAGES, 2m)
        Slopes.
    work : ndarray, shape (2, 2m)
        Work space of ``step_error``; then 1 where a site may arrive within the step
        (``_arriving``), otherwise 0.
    p : ndarray, shape (P,)
        Parameters of the kernel in the present step.
    """

    x: FloatArray
    new: FloatArray
    inside: FloatArray
    K: FloatArray
    work: FloatArray
    p: FloatArray


Pair = tuple[FloatArray, FloatArray]
"""Values of y and of w, at the sites of the window."""

Ends = tuple[int, int]
"""Codes of what lies beyond the left and the right end of the window."""

Condition = Callable[..., int]
"""Function of (step, t, h, before, after, parameters, K, work, memory): 0 to continue, else a code.

``before`` and ``after`` are the rows (``active``) at t and at t + h; ``K`` and ``work`` may be
overwritten, and shorter steps may be taken from ``before``."""


def _never(
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
    """Go on."""
    return 0


@inner()
def _beyond(row: FloatArray, n: int, square: float) -> float:
    """Return the excess of the squared amplitude of a site of a row over a square."""
    y, w = row[n], row[row.size // 2 + n]
    return float(y * y + w * w - square)


@inner()
def _widened(
    x: FloatArray, rest: float, margin: int, lo: int, hi: int, sites: int
) -> tuple[int, int]:
    """Return lo and hi moved outwards so that ``margin`` sites at rest lie inside either end."""
    m = hi - lo
    square = rest * rest
    new_lo, new_hi = lo, hi
    for n in range(min(m, margin)):
        if _beyond(x, n, square) > 0.0:
            new_lo = max(0, lo + n - margin)
            break
    for n in range(m - 1, max(0, m - margin) - 1, -1):
        if _beyond(x, n, square) > 0.0:
            new_hi = min(sites, lo + n + margin + 1)
            break
    return min(lo, new_lo), max(hi, new_hi)


@inner()
def _try_steps(take_step: Step, task: LoopTask, clock: FloatArray, rows: Rows, ends: Ends) -> float:
    """Put the state after a step within the tolerance into ``rows.new``; return the step length.

    The returned length is below ``task.shortest`` if no such step is found.
    """
    p, size = rows.p, max(largest(rows.x), task.least_size)
    h = clock[1] if clock[1] > 0.0 else _FIRST * task.tolerance**0.125
    h = task.longest if task.tolerance == 0.0 else min(h, task.longest)
    drifting = False
    for i in range(p.size):
        drifting |= task.drift[i] != 0.0
    while h >= task.shortest:
        if drifting:
            for i in range(p.size):
                p[i] = task.parameters[i] + task.drift[i] * (clock[0] + clock[4] + 0.5 * h)
        if task.clock_place >= 0:
            p[task.clock_place] = clock[0] + clock[4]
        take_step(rows.x, p, ends[0], ends[1], h, rows.K, rows.new)
        if task.tolerance == 0.0:
            break
        ratio = step_error(rows.K, h, rows.work, size) / task.tolerance
        if ratio <= 1.0:
            clock[2] = max(clock[2], ratio)
            break
        h *= max(_SHRINK, _SAFETY * ratio ** (-0.125)) if math.isfinite(ratio) else _SHRINK
    return h


@inner()
def _sample_is_due(task: LoopTask, run: LoopState, h: float) -> bool:
    """Return whether the next sample lies within the step, whose end is that of `_pass_time`."""
    place = run.counters[SAMPLED]
    end = run.clock[0] + (h + run.clock[4])
    return bool(place < task.times.size and task.times[place] <= end)


@inner()
def _take_samples(
    take_step: Step, task: LoopTask, run: LoopState, rows: Rows, ends: Ends, h: float
) -> None:
    """Take the samples that lie within the step, by shorter steps from its beginning."""
    clock, counters = run.clock, run.counters
    lo, hi = counters[LO], counters[HI]
    m = hi - lo
    while _sample_is_due(task, run, h):
        part = task.times[counters[SAMPLED]] - clock[0] - clock[4]
        take_step(rows.x, rows.p, ends[0], ends[1], part, rows.K, rows.inside)
        sample = run.samples[counters[SAMPLED]]
        put(run.state[0], sample[0])
        put(run.state[1], sample[1])
        put(rows.inside[:m], sample[0, lo:hi])
        put(rows.inside[m:], sample[1, lo:hi])
        counters[SAMPLED] += 1


@inner()
def _interpolated(values: FloatArray, part: float) -> float:
    """Return the polynomial through values at the fractions ``_PARTS`` (barycentric formula)."""
    above = below = 0.0
    last = _PARTS.size - 1
    for j in range(last + 1):
        away = part - _PARTS[j]
        if away == 0.0:
            return float(values[j])
        weight = (1.0 if j % 2 == 0 else -1.0) / away
        if j in (0, last):
            weight *= 0.5
        above += weight * values[j]
        below += weight
    return float(above / below)


@inner(**COUNTED)
def _note_arrivals(
    take_step: Step, task: LoopTask, run: LoopState, rows: Rows, ends: Ends, h: float
) -> int:
    """Find the arrivals of the marked sites within the step; return the foremost of them.

    They are found by interpolation between the states at a few times within the step; a site that
    is beyond the level at none of these times has not arrived.
    """
    x, new, lo = rows.x, rows.new, run.counters[LO]
    m, square, last = x.size // 2, task.level * task.level, _PARTS.size - 1
    values = np.empty((last + 1, m))
    for j in range(last + 1):
        row = x if j == 0 else new if j == last else rows.inside
        if 0 < j < last:
            take_step(x, rows.p, ends[0], ends[1], _PARTS[j] * h, rows.K, row)
        for n in range(m):
            values[j, n] = _beyond(row, n, square)
    foremost = -1
    for n in range(m):
        reached = 0 if rows.work[0, n] > 0.0 else last + 1
        while reached <= last and values[reached, n] < 0.0:
            reached += 1
        if reached > last:
            continue
        low, high = (_PARTS[reached - 1] if reached > 0 else 0.0), _PARTS[reached]
        for _ in range(52):  # bisection, to the last bit of the fraction
            middle = 0.5 * (low + high)
            if _interpolated(values[:, n], middle) < 0.0:
                low = middle
            else:
                high = middle
        time = run.clock[0] + high * h
        if time <= task.end:  # the last step extends beyond the end
            run.arrivals[lo + n] = time
            foremost = lo + n
    return foremost


@inner(forceinline=True)
def _highest(before: float, rise: float, after: float, fall: float) -> float:
    """Return a bound on a value within a step, from its values and slopes at both ends.

    The value is approximated by the cubic through these data (slopes times the step). No cubic
    exceeds its end values by more than 4/27 of the slopes that lead above them.
    """
    top = after if after > before else before
    top += 0.25 * rise if rise > 0.0 else 0.0
    top -= 0.25 * fall if fall < 0.0 else 0.0
    return top


# One line of arithmetic, the same for all sites, so that the processor handles several at once.
@inner(error_model="numpy", fastmath={"contract"})
def _mark_arriving(
    old: Pair, new: Pair, slopes: Pair, last: Pair, waiting: FloatArray, mark: FloatArray,
    h: float, square: float,
) -> int:  # fmt: skip
    """Mark sites that may pass the level within the step by 1, others by 0; return their number.

    ``waiting`` is nan at sites that have not arrived.
    """
    (y, w), (new_y, new_w), (dy, dw), (last_dy, last_dw) = old, new, slopes, last
    found = 0
    for n in range(mark.size):
        before, after = y[n] * y[n] + w[n] * w[n], new_y[n] * new_y[n] + new_w[n] * new_w[n]
        rise = 2.0 * h * (y[n] * dy[n] + w[n] * dw[n])
        fall = 2.0 * h * (new_y[n] * last_dy[n] + new_w[n] * last_dw[n])
        passes = (_highest(before, rise, after, fall) >= square) & (waiting[n] != waiting[n])
        mark[n] = 1.0 if passes else 0.0
        found += 1 if passes else 0
    return found


@inner()
def _arriving(task: LoopTask, run: LoopState, rows: Rows, h: float) -> bool:
    """Return whether any site may pass the level within the step; mark such sites in ``rows.work``.

    The last slopes are those at the end of the step, to the accuracy of the stages.
    """
    x, new, first, last = rows.x, rows.new, rows.K[0], rows.K[STAGES - 1]
    m, lo = x.size // 2, run.counters[LO]
    found = _mark_arriving(
        (x[:m], x[m:]), (new[:m], new[m:]), (first[:m], first[m:]), (last[:m], last[m:]),
        run.arrivals[lo : lo + m], rows.work[0, :m], h, task.level * task.level,
    )  # fmt: skip
    return found > 0


@inner()
def _pass_time(task: LoopTask, clock: FloatArray, h: float) -> None:
    """Add the step to the time; at a review, let the next step grow if the errors permit."""
    t, increment = clock[0], h + clock[4]
    clock[0] = t + increment
    clock[4] = increment - (clock[0] - t)
    if clock[0] >= clock[3]:
        clock[3] = clock[0] + task.review
        if clock[2] < LAZY:
            clock[1] = h * min(_GROW, _SAFETY * max(clock[2], 1e-8) ** (-0.125))
        clock[2] = 0.0


@inner()
def _moved_window(task: LoopTask, run: LoopState, x: FloatArray, foremost: int) -> tuple[int, int]:
    """Return the window for the next step."""
    lo, hi, sites = run.counters[LO], run.counters[HI], run.state.shape[1]
    wider_lo, wider_hi = lo, hi
    if task.rest >= 0.0 and (lo > 0 or hi < sites):
        wider_lo, wider_hi = _widened(x, task.rest, task.margin, lo, hi, sites)
        if task.trailing > 0:
            wider_lo = lo
    if task.trailing > 0 and foremost - task.trailing > lo:
        wider_lo = foremost - task.trailing
    return wider_lo, wider_hi


def _rows_of(task: LoopTask, run: LoopState) -> Rows:
    """Return the rows for the sites of the window, with their state, and work space."""
    window = slice(run.counters[LO], run.counters[HI])
    x = run.state[:, window].flatten()
    K, work = np.empty((STAGES, x.size)), np.empty((2, x.size))
    return Rows(x, np.empty(x.size), np.empty(x.size), K, work, task.parameters.copy())


@outer(cache=True, **UNCOUNTED)
def _advance(
    take_step: Step, stop: Condition, task: LoopTask, run: LoopState, rows: Rows, max_steps: int
) -> int:
    """Step until the end, or until the window moves; return a ``StopCode``."""
    clock, counters, sites = run.clock, run.counters, run.state.shape[1]
    lo, hi = counters[LO], counters[HI]
    ends = end_codes(lo, hi, sites, task.first, task.trailing > 0)
    for _ in range(max_steps):
        if clock[0] >= task.end:
            return REACHED
        if not finite(rows.x):
            return NOT_FINITE
        h = _try_steps(take_step, task, clock, rows, ends)
        clock[1] = h
        if h < task.shortest:
            clock[1] = 0.0
            return TOO_SHORT
        foremost, arriving = -1, _arriving(task, run, rows, h)
        if _sample_is_due(task, run, h):
            _take_samples(take_step, task, run, rows, ends, h)
        if arriving:
            foremost = _note_arrivals(take_step, task, run, rows, ends, h)
        found = stop(
            take_step, clock[0], h, rows.x, rows.new, rows.p, rows.K, rows.inside, run.memory
        )
        put(rows.new, rows.x)
        _pass_time(task, clock, h)
        counters[STEPS] += 1
        counters[SITE_STEPS] += hi - lo
        if found != 0:
            counters[OUTCOME] = found
            return CONDITION
        counters[LO], counters[HI] = _moved_window(task, run, rows.x, foremost)
        if counters[LO] != lo or counters[HI] != hi:
            return MOVED
    return BUDGET if clock[0] < task.end else REACHED


def _advance_windows(
    take_step: Any, stop: Any, task: LoopTask, run: LoopState, max_steps: int
) -> int:
    """Step until a step passes the end; return a ``StopCode``."""
    ended, last = MOVED, run.counters[STEPS] + max_steps
    while ended == MOVED:
        window = slice(run.counters[LO], run.counters[HI])
        rows = _rows_of(task, run)
        ended = _advance(take_step, stop, task, run, rows, last - run.counters[STEPS])
        run.state[:, window] = rows.x.reshape(2, -1)
    return ended


Loop = Callable[[LoopTask, LoopState, int], int]
_ROW, _TABLE = types.float64[::1], types.float64[:, ::1]
_TIME = types.float64
_STOP = types.int64(
    types.FunctionType(STEP_SIGNATURE), _TIME, _TIME, _ROW, _ROW, _ROW, _TABLE, _ROW, _ROW
)  # fmt: skip


def clock_place(chain: SmoothChain) -> int:
    """Return the index of the time in the kernel's parameters; -1 if it does not depend on time."""
    count = len(chain.forces)
    return chain.kernel_layout[0] - 3 * count - 1 if count else -1


def loop(chain: SmoothChain, watch: Condition | None) -> Loop:
    """Return the loop of a chain and a stop condition, reusing compiled code on disk.

    Parameters
    ----------
    chain : SmoothChain
        Only its kernel, the layout of its parameters and the phase step of its fronts matter.
    watch : callable, optional
        The stop condition, a function in a module; by default the run continues to its end.
    """
    watch = watch or _never
    stop = pointer(watch, _STOP, source_mark(watch))
    return partial(_advance_windows, compiled_step(chain), stop)


def compiled_step(chain: SmoothChain) -> Any:
    """Return the compiled step of a chain, reusing compiled code on disk."""
    place, forces = clock_place(chain), len(chain.forces)
    step = dop853_step(slope_of(chain), (place, forces))
    return pointer(step, STEP_SIGNATURE, f"{slope_mark(chain)}-{place}-{forces}")
