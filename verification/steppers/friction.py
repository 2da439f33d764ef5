"""The friction chain (5) from event to event: Taylor steps that end at the earliest event.

A site is in exactly one mode: stick (ẏ = v_d exactly), slip backwards (ẏ < v_d, s = -1), or slip
forwards (ẏ > v_d, s = +1). Within a step no mode changes. The step ends at the first of

* slip: w = ẏ - v_d reaches 0. Stick begins if the static force G = 2ξv_d + y + c(…) is within
  ±μ_st; if it is beyond on the far side the site slips on with the other sign (reversal);
* stick: G leaves [-μ_st, μ_st]; the site is released with ẇ = 0 and slips against G.

Both are first roots of polynomials, found to round-off. All roots within a few units of round-off
of the first are taken together; whether a site sticks depends on positions alone, so their order
does not matter. All quantities are dimensionless.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from verification.execution.compiled import njit
from verification.steppers.friction_series import (
    MU_ST,
    V0,
    V_D,
    XI,
    C,
    allowed_remainder,
    coefficients,
    first_root,
    horner,
    resolved,
    site_value,
)
from verification.steppers.rows import put
from verification.steppers.stop_code import StopCode

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

STICK_BEGINS, STICK_ENDS, REVERSAL = 0, 1, 2
"""Kinds of events."""

REACHED, TOO_SHORT, NOT_FINITE, BUDGET, CONDITION = (
    int(StopCode.REACHED),
    int(StopCode.STEP_TOO_SHORT),
    int(StopCode.NOT_FINITE),
    int(StopCode.BUDGET_SPENT),
    int(StopCode.CONDITION),
)

LO, HI, SAMPLED, STEPS, SITE_STEPS, LOGGED, STANDING = 0, 1, 2, 3, 4, 5, 6
"""Places in ``counters``; the number of events of each kind follows from ``KINDS`` on."""

KINDS = 7
MARGIN = 8
_TOGETHER = 8.9e-16
_LEVELS = 3


@njit(cache=True)
def _static_force(y: FloatArray, n: int, parameters: FloatArray, free: bool) -> float:
    """Return G of site n: the friction force that would hold it on the belt."""
    last = y.size - 1
    own = 2.0
    near = 0.0
    if n > 0 and n < last:
        near = y[n - 1] + y[n + 1]
    elif last == 0:
        own = 0.0 if free else 2.0
    else:
        own = 1.0 if free else 2.0
        near = y[1] if n == 0 else y[last - 1]
    bend = own * y[n] - near
    return float(2.0 * parameters[XI] * parameters[V_D] + y[n] + parameters[C] * bend)


@njit(cache=True)
def initial_modes(y: FloatArray, w: FloatArray, parameters: FloatArray, free: bool) -> IntArray:
    """Return the mode of every site; with w = 0 it sticks if it can be held."""
    modes = np.zeros(y.size, dtype=np.int64)
    for n in range(y.size):
        if w[n] != 0.0:
            modes[n] = 1 if w[n] > 0.0 else -1
        else:
            force = _static_force(y, n, parameters, free)
            if abs(force) > parameters[MU_ST]:
                modes[n] = -1 if force > 0.0 else 1
    return modes


@njit(cache=True)
def _step_length(
    Y: FloatArray, W: FloatArray, order: int, tolerance: float, lo: int, hi: int
) -> float:
    """Return h at which the last two terms of y and w are within the tolerance; nan if not finite.

    See :func:`friction_series.resolved` for what the last two terms cannot see.
    """
    h = math.inf
    for k in (order - 1, order):
        term = 0.0
        for n in range(lo, hi):
            size = abs(W[k, n]) + abs(Y[k, n])
            if not math.isfinite(size):
                return math.nan
            term = max(term, size)
        if term > 0.0:
            h = min(h, (tolerance / term) ** (1.0 / k))
    return h


@njit(cache=True)
def _shortened(
    W: FloatArray, modes: IntArray, order: int, h: float, lo: int, hi: int, row: FloatArray
) -> float:
    """Return a time up to h by which some site has surely left slip, if one is easily seen."""
    for level in range(_LEVELS + 1):
        trial = h * 0.5 ** (_LEVELS - level)
        horner(W, order, trial, lo, hi, row)
        for n in range(lo, hi):
            if modes[n] != 0 and modes[n] * row[n] < 0.0:
                return trial
    return h


@njit(cache=True)
def together(first: float, t: float) -> float:
    """Return up to when, after t, events count as simultaneous with one a time ``first`` after."""
    return first + _TOGETHER * max(first, abs(t))


@njit(cache=True)
def _event_times(
    Y: FloatArray,
    W: FloatArray,
    modes: IntArray,
    order: int,
    h: float,
    lo: int,
    hi: int,
    parameters: FloatArray,
    free: bool,
    f: FloatArray,
    work: FloatArray,
    binomial: FloatArray,
    t: float,
    out: FloatArray,
) -> float:
    """Put the first event of each site before the earliest so far into out; return the earliest.

    Each is looked for a few units of round-off beyond the earliest, so that none of those that
    belong together is missed.
    """
    limit, c = parameters[MU_ST], parameters[C]
    last = modes.size - 1
    first = h
    for n in range(lo, hi):
        out[n] = math.inf
        until = together(first, t)
        if modes[n] != 0:
            size = 0.0
            for k in range(order, 0, -1):
                size = (size + abs(W[k, n])) * until
            if size < abs(W[0, n]):
                continue
            s = float(modes[n])
            for k in range(order + 1):
                f[k] = s * W[k, n]
            out[n] = first_root(f, order, until, work, binomial)
        else:
            own = 2.0 if (0 < n < last or not free) else (1.0 if last > 0 else 0.0)
            for side in (1.0, -1.0):
                for k in range(order + 1):
                    near = (Y[k, n - 1] if n > 0 else 0.0) + (Y[k, n + 1] if n < last else 0.0)
                    f[k] = -side * (Y[k, n] + c * (own * Y[k, n] - near))
                f[0] += limit - side * 2.0 * parameters[XI] * parameters[V_D]
                out[n] = min(out[n], first_root(f, order, until, work, binomial))
        first = min(first, out[n])
    return first


@njit(cache=True)
def _extreme(Y: FloatArray, W: FloatArray, order: int, h: float, n: int, v_d: float) -> float:
    """Return y where ẏ = 0 within the step, by bisection; ẏ has other signs at its ends."""
    rising = W[0, n] + v_d > 0.0
    low, high = 0.0, h
    for _ in range(40):
        middle = 0.5 * (low + high)
        if (site_value(W, order, middle, n) + v_d > 0.0) == rising:
            low = middle
        else:
            high = middle
    return site_value(Y, order, high, n)


@njit(cache=True)
def _wider(
    y: FloatArray, w: FloatArray, rest: float, y0: float, v_d: float, lo: int, hi: int
) -> tuple[int, int]:
    """Return the window widened so that MARGIN sites at rest lie inside it on either side."""
    new_lo, new_hi = lo, hi
    for n in range(lo, min(hi, lo + MARGIN)):
        if abs(y[n] - y0) > rest or abs(w[n] + v_d) > rest:
            new_lo = max(0, n - MARGIN)
            break
    for n in range(hi - 1, max(lo, hi - MARGIN) - 1, -1):
        if abs(y[n] - y0) > rest or abs(w[n] + v_d) > rest:
            new_hi = min(y.size, n + MARGIN + 1)
            break
    return min(lo, new_lo), max(hi, new_hi)


class Task(NamedTuple):
    """What :func:`advance` has to do; it does not change.

    Attributes
    ----------
    parameters : ndarray, shape (6,)
        μ_st, μ_d, v₀, ξ, v_d, c.
    free : bool
        Free ends; else the missing neighbours are zero.
    tolerance, order
        Local error, absolute, and order of the series.
    binomial : ndarray
        ``friction_series.binomials(order)``.
    rest, sliding : float
        Sites within ``rest`` of steady sliding at y = ``sliding``, at the ends of the window
        LO … HI, are not stepped; negative for all sites always.
    watched : ndarray of bool, shape (N,)
        Sites whose arrivals are counted.
    times : ndarray, shape (M,)
        Where samples are required, ascending.
    """

    parameters: FloatArray
    free: bool
    tolerance: float
    order: int
    binomial: FloatArray
    rest: float
    sliding: float
    watched: npt.NDArray[np.bool_]
    times: FloatArray


class Run(NamedTuple):
    """What :func:`advance` changes; all in place.

    Attributes
    ----------
    y, w, modes : ndarray, shape (N,)
        Position, ẏ - v_d, mode.
    released : ndarray of bool, shape (N,)
        Sites that have been released at this very time.
    clock : ndarray, shape (1,)
        Time.
    counters : ndarray of int, shape (10,)
        See ``LO`` and the names after it.
    arrivals : ndarray, shape (N,)
        Time of the first stick; nan before.
    extremes : ndarray, shape (2, N)
        Last maximum and last minimum of y; nan before the first.
    samples : ndarray, shape (M, 3, N)
        (y, w, half of the last maximum minus the last minimum); filled as times are passed.
    log : ndarray, shape (K, 3)
        Time, site, kind of the first K events.
    """

    y: FloatArray
    w: FloatArray
    modes: IntArray
    released: npt.NDArray[np.bool_]
    clock: FloatArray
    counters: IntArray
    arrivals: FloatArray
    extremes: FloatArray
    samples: FloatArray
    log: FloatArray


@njit(cache=True)
def advance(task: Task, run: Run, stop: float, required: int, max_steps: int) -> int:
    """Step until ``stop``; return a ``StopCode``.

    Parameters
    ----------
    task, run
        What to do, and the state.
    stop : float
        Time to reach.
    required : int
        Watched arrivals at which to end; 0 for never.
    max_steps : int
        Steps after which to return. A run that goes on from there is the same to the last bit.
    """
    parameters, free, tolerance, order = task.parameters, task.free, task.tolerance, task.order
    binomial, rest, sliding = task.binomial, task.rest, task.sliding
    watched, times = task.watched, task.times
    y, w, modes, released = run.y, run.w, run.modes, run.released
    clock, counters, arrivals, extremes = run.clock, run.counters, run.arrivals, run.extremes
    samples, log = run.samples, run.log
    sites = y.size
    v_d = parameters[V_D]
    lo, hi = counters[LO], counters[HI]
    Y, W = np.zeros((order + 1, sites)), np.zeros((order + 1, sites))
    E, D = np.zeros((order + 1, sites)), np.zeros((order + 1, sites))
    room = np.zeros((5, sites))
    lap, signs, row = room[0], room[1:4], room[4]
    event = np.full(sites, np.inf)
    f, work = np.zeros(order + 1), np.zeros((50, order + 1))
    put(y, Y[0])
    put(w, W[0])
    ended, steps = REACHED, 0
    allowed = allowed_remainder(order, tolerance)
    arrived = 0
    for n in range(sites):
        if modes[n] == 0 and math.isnan(arrivals[n]):
            arrivals[n] = clock[0]
        if watched[n] and not math.isnan(arrivals[n]):
            arrived += 1
    while clock[0] < stop:
        if 0 < required <= arrived:
            ended = CONDITION
            break
        if steps >= max_steps:
            ended = BUDGET
            break
        for n in range(lo, hi):
            Y[0, n] = y[n]
            W[0, n] = w[n]
        coefficients(Y, W, E, D, lap, modes, released, signs, parameters, free, order, lo, hi)
        h = _step_length(Y, W, order, tolerance, lo, hi)
        if math.isnan(h):
            ended = NOT_FINITE
            break
        t = clock[0]
        h = min(h, stop - t)
        for n in range(lo, hi):
            if modes[n] != 0:
                h = resolved(W, order, h, n, float(modes[n]), parameters[V0], allowed)
        if t + h == t:
            ended = TOO_SHORT
            break
        shorter = _shortened(W, modes, order, h, lo, hi, row)
        first = _event_times(
            Y, W, modes, order, shorter, lo, hi, parameters, free, f, work, binomial, t, event
        )
        happens = first < h
        h = first if happens else h
        while counters[SAMPLED] < times.size and times[counters[SAMPLED]] <= t + h:
            sample = samples[counters[SAMPLED]]
            for n in range(sites):
                sample[0, n] = y[n]
                sample[1, n] = w[n]
                sample[2, n] = 0.5 * abs(extremes[0, n] - extremes[1, n])
            horner(Y, order, times[counters[SAMPLED]] - t, lo, hi, sample[0])
            horner(W, order, times[counters[SAMPLED]] - t, lo, hi, sample[1])
            counters[SAMPLED] += 1
        if h > 0.0:
            horner(Y, order, h, lo, hi, y)
            horner(W, order, h, lo, hi, w)
            for n in range(lo, hi):
                if modes[n] == -1 and (W[0, n] + v_d > 0.0) != (w[n] + v_d > 0.0):
                    kind = 0 if W[0, n] + v_d > 0.0 else 1
                    extremes[kind, n] = _extreme(Y, W, order, h, n, v_d)
                released[n] = False
            counters[STANDING] = 0
        else:
            counters[STANDING] += 1
            if counters[STANDING] > 4 * sites + 16:
                ended = TOO_SHORT
                break
        clock[0] = stop if t + h >= stop and not happens else t + h
        steps += 1
        counters[STEPS] += 1
        counters[SITE_STEPS] += hi - lo
        if happens:
            until = together(first, t)
            for n in range(lo, hi):
                if event[n] <= until:
                    kind = _switch(n, y, w, modes, released, parameters, free)
                    if kind < 0:
                        continue
                    counters[KINDS + kind] += 1
                    if counters[LOGGED] < log.shape[0]:
                        log[counters[LOGGED], 0] = clock[0]
                        log[counters[LOGGED], 1] = n
                        log[counters[LOGGED], 2] = kind
                        counters[LOGGED] += 1
                    if kind == STICK_BEGINS and math.isnan(arrivals[n]):
                        arrivals[n] = clock[0]
                        arrived += 1 if watched[n] else 0
        if rest >= 0.0 and (lo > 0 or hi < sites):
            lo, hi = _wider(y, w, rest, sliding, v_d, lo, hi)
            counters[LO], counters[HI] = lo, hi
            for n in range(lo, hi):
                Y[0, n] = y[n]
    return ended


@njit(cache=True)
def _switch(
    n: int,
    y: FloatArray,
    w: FloatArray,
    modes: IntArray,
    released: npt.NDArray[np.bool_],
    parameters: FloatArray,
    free: bool,
) -> int:
    """Give site n its new mode at an event; return the kind of event, -1 for a graze."""
    force = _static_force(y, n, parameters, free)
    w[n] = 0.0
    if modes[n] == 0:
        modes[n] = -1 if force > 0.0 else 1
        released[n] = True
        return STICK_ENDS
    if abs(force) <= parameters[MU_ST]:
        modes[n] = 0
        return STICK_BEGINS
    if (force > 0.0) == (modes[n] == 1):
        modes[n] = -modes[n]
        return REVERSAL
    released[n] = True
    return -1


def new_run(y: FloatArray, w: FloatArray, modes: IntArray, samples: int, logged: int) -> Run:
    """Return the state of a run that begins, with fresh arrays for its bookkeeping."""
    sites = y.size
    return Run(
        y,
        w,
        modes,
        np.zeros(sites, dtype=bool),
        np.zeros(1),
        np.zeros(KINDS + 3, dtype=np.int64),
        np.full(sites, np.nan),
        np.full((2, sites), np.nan),
        np.zeros((samples, 3, sites)),
        np.zeros((logged, 3)),
    )
