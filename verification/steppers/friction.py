"""The friction chain (5) from event to event, with a separate Taylor series for each site.

A site is always in exactly one mode: stick (ẏ = v_d exactly), slip backwards (ẏ < v_d, s = -1), or
slip forwards (ẏ > v_d, s = +1). Its mode changes at events:

* slip: w = ẏ - v_d reaches 0. Stick begins if the static force G = 2ξv_d + y + c(…) is within
  ±μ_st; if it is beyond the limit on the far side, the site continues to slip with the opposite
  sign (reversal);
* stick: G leaves [-μ_st, μ_st]; the site is released with ẇ = 0 and slips against G.

Both are first roots of polynomials, found to within round-off. All events within a few units of
round-off of the first one are processed together; since only positions decide whether a site
sticks, their order does not matter. All quantities are dimensionless.

Time is divided into frames. At the beginning of a frame every site gets a new series. When a site
changes its mode, or its series expires before the end of the frame, new series are made for it and
for d neighbours on either side. All other sites keep their series, which enter the new ones shifted
in time.

The error of this truncation is bounded as follows. Let the series of site 0 be replaced, and let τ
be the time left in the frame. Until its end, the acceleration of site 0 differs from that of its
old series by at most J, which is obtained from the coefficients of both series. As long as no mode
changes, the difference δ of the other sites from their old series grows no faster than the solution
z of

    z̈_m = Lż_m + (1 + 2c)z_m + c(z_{m-1} + z_{m+1}) + Jδ_{m0},   z = ż = 0 at first,

with L the Lipschitz constant of friction and damping, since all terms of this equation are
positive. With q = s² - Ls - (1 + 2c) its Laplace transform is (J/s) Σ_k C(m + 2k, k) c^{m+2k} /
q^{m+2k+1}, and the inverse transform of 1/(s q^j) is at most e^{λτ} τ^{2j}/(2j)!, where λ is the
positive root of q. The sum over k is at most cosh(cτ²) times its first term, so that

    |δ_m| ≤ J e^{λτ} cosh(cτ²) c^m τ^{2m+2}/(2m + 2)!

New series are made for sites up to distance d. The computed motion is therefore an exact solution
of (5) with an additional force of at most c|δ_d| at site d + 1, and d is the smallest number for
which this force is below a hundredth of the tolerance. If no d up to the order is sufficient, the
frame ends at the event and all sites get new series.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from theory.arrays import FloatArray, IntArray
from verification.steppers.friction_series import (
    ARRIVAL,
    BEYOND,
    CLOCK,
    DRAG,
    DUE,
    END,
    EVENT,
    FIRST,
    KEPT,
    LAST_MAXIMUM,
    LAST_MINIMUM,
    LAST_TERM,
    MODE,
    MU_ST,
    OWN,
    POLYNOMIAL,
    RELEASED,
    REST,
    ROWS,
    SLIDING,
    START,
    STEEPEST,
    STEP,
    SUM,
    TERM,
    TOLERANCE,
    V0,
    V_D,
    XI,
    C,
    Law,
    W,
    Y,
    absolute_sums,
    expand,
    first_root,
    friction_inner,
    friction_outer,
    new_work,
    one_way,
    resolved,
    shift,
    site_value,
    site_values,
    term_length,
    term_size,
)
from verification.steppers.stop_code import StopCode

STICK_BEGINS, STICK_ENDS, REVERSAL = 0, 1, 2
"""Kinds of events."""

REACHED, TOO_SHORT, NOT_FINITE, BUDGET = (
    int(StopCode.REACHED),
    int(StopCode.STEP_TOO_SHORT),
    int(StopCode.NOT_FINITE),
    int(StopCode.BUDGET_SPENT),
)

LO, HI, SAMPLED, FRAMES, SITE_FRAMES, LOGGED, STANDING, LOCAL = 0, 1, 2, 3, 4, 5, 6, 7
"""Indices into ``counters``; the number of events of each kind follows from ``KINDS`` on.

Sites LO … HI - 1 are stepped. SAMPLED and LOGGED are numbers of rows filled; SITE_FRAMES and LOCAL
count series started with a frame and within one; STANDING counts how often time did not advance."""

KINDS = 8
MARGIN = 8
_TOGETHER = 8.9e-16
_SLOW_SHARE = 16
_NEGLECTED = 0.01


class Run(NamedTuple):
    """A run of (5) in progress; it is changed in place and is consistent between frames.

    Attributes
    ----------
    numbers, law, site, mode, series, work
        See ``friction_series``; ``series`` and ``work`` contain nothing of use between frames.
    counters : ndarray of int, shape (11,)
        See ``LO`` and the names following it.
    queue : ndarray, shape (2 P,)
        Tournament tree: leaf P + n holds the time at which site n is due, because of an event or
        because its series expires before the frame ends; each node holds the earlier of its two
        children.
    times : ndarray, shape (M,)
        Times at which samples are required, ascending.
    samples : ndarray, shape (M, 3, N)
        (y, w, half of the last maximum minus the last minimum); filled as times are passed.
    log : ndarray, shape (K, 3)
        Time, site and kind of the first K events.
    """

    numbers: FloatArray
    law: Law
    site: FloatArray
    mode: IntArray
    series: FloatArray
    work: FloatArray
    counters: IntArray
    queue: FloatArray
    times: FloatArray
    samples: FloatArray
    log: FloatArray


def new_run(
    numbers: FloatArray,
    law: Law,
    start: FloatArray,
    own: FloatArray,
    *,
    times: FloatArray,
    logged: int,
    order: int,
) -> Run:
    """Return a new run; a site with w = 0 sticks if static friction can hold it.

    Parameters
    ----------
    numbers : ndarray
        ``friction_series.new_numbers``.
    law : tuple
        ``friction_series.law_of``.
    start : ndarray, shape (2, N)
        y and ẏ.
    own : ndarray, shape (N,)
        Number of neighbours to which a site is coupled: 2, or 1 or 0 at free ends.
    times : ndarray, shape (M,)
        Times at which samples are required, ascending.
    logged : int
        Number of events that are recorded.
    order : int
        Order of the series.
    """  # fmt: skip
    sites = own.size
    site, mode = (
        np.zeros((ROWS, sites + 2)),
        np.zeros((BEYOND + 1, sites + 2), dtype=np.int64),
    )
    site[Y, 1:-1], site[W, 1:-1], site[OWN, 1:-1] = start[0], start[1] - numbers[V_D], own
    site[[ARRIVAL, LAST_MAXIMUM, LAST_MINIMUM]], site[END] = np.nan, np.inf
    y, w = site[Y], site[W, 1:-1]
    bend = own * y[1:-1] - (y[:-2] + y[2:])
    force = 2.0 * numbers[XI] * numbers[V_D] + y[1:-1] + numbers[C] * bend
    slipping = np.where(np.abs(force) > numbers[MU_ST], -np.sign(force), 0.0)
    mode[MODE, 1:-1] = np.where(w != 0.0, np.sign(w), slipping)
    counters = np.zeros(KINDS + 3, dtype=np.int64)
    counters[LO], counters[HI] = 1, sites + 1
    return Run(
        numbers=numbers,
        law=law,
        site=site,
        mode=mode,
        series=np.zeros((3 + len(law), order + 1, sites + 2)),
        work=new_work(order),
        counters=counters,
        queue=np.full(2 << (sites + 1).bit_length(), np.inf),
        times=times,
        samples=np.zeros((times.size, 3, sites)),
        log=np.zeros((logged, 3)),
    )


def advance(run: Run, stop: float, max_steps: int) -> int:
    """Advance until ``stop``; return a ``StopCode``.

    Parameters
    ----------
    run : Run
        The run.
    stop : float
        Time to reach.
    max_steps : int
        Number of frames after which to return. A run continued from there is the same to the last
        bit.
    """
    arrival = run.site[ARRIVAL, 1:-1]
    arrival[(run.mode[MODE, 1:-1] == 0) & np.isnan(arrival)] = run.numbers[CLOCK]
    run.series[Y, 0] = run.site[Y]
    # An integer argument would make numba compile everything once more, which takes four seconds.
    return int(_advance(run, float(stop), max_steps))


@friction_outer
def _advance(run: Run, stop: float, max_steps: int) -> int:
    """Take frames until ``stop`` or until there is a reason to return; return a ``StopCode``."""
    counters, numbers = run.counters, run.numbers
    last = counters[FRAMES] + max_steps
    while True:
        if numbers[CLOCK] >= stop:
            return REACHED
        if counters[FRAMES] >= last:
            return BUDGET
        longest = stop - numbers[CLOCK]
        end = _frame(run, longest)
        if not end >= 0.0:
            return TOO_SHORT if end < 0.0 else NOT_FINITE
        _finish(run, end)
        reached = numbers[CLOCK] + end
        numbers[CLOCK] = stop if end == longest or reached > stop else reached
        counters[FRAMES] += 1
        if numbers[REST] >= 0.0:
            _widen(run.site, numbers, counters)


@friction_inner
def _frame(run: Run, longest: float) -> float:
    """Give all sites new series and process the events; return the time at which the frame ends.

    The result is -1 if time does not advance, nan if a series is not finite.
    """
    numbers, counters, queue, mode = run.numbers, run.counters, run.queue, run.mode
    queue[:] = math.inf
    mode[FIRST, 0], mode[BEYOND, 0] = counters[LO], counters[HI]
    counters[SITE_FRAMES] += counters[HI] - counters[LO]
    length, now, ranges, due, change = -longest, 0.0, 1, 0, 0.0
    while True:
        for i in range(ranges):
            length = _renew(run, mode[FIRST, i], mode[BEYOND, i], now, length)
            if not length > 0.0:
                return -1.0 if length == 0.0 else math.nan
        needed = change
        for i in range(due):
            needed = max(needed, 2.0 * _rate(run.series[W], mode[DUE, i], length - now))
        if needed > change:  # the new series requires more neighbours
            change = 2.0 * needed
        else:
            following = queue[1]
            if not following <= length:
                if length > now:
                    counters[STANDING] = 0
                return length
            counters[STANDING] = 0 if following > now else counters[STANDING] + 1
            if counters[STANDING] > 4 * run.site.shape[1] + 16:
                return -1.0
            now = following
            due, change = _switched(run, now, length)
        radius = _reach(numbers, run.series.shape[1] - 1, change, length - now)
        if radius < 0:
            return float(now)
        ranges = _ranges(run, due, radius)


@friction_inner
def _frame_length(
    site: FloatArray, lo: int, hi: int, order: int, p: FloatArray, most: float
) -> float:
    """Return a frame length before which at most a sixteenth of the series expire."""
    first, last, tolerance = 0.0, 0.0, p[TOLERANCE]
    for n in range(lo, hi):
        first, last = max(first, site[TERM, n]), max(last, site[LAST_TERM, n])
    length = min(most, term_length(first, last, order, tolerance))
    while 0.0 < length < most:
        longer, short = math.sqrt(2.0) * length, 0
        before = longer ** (order - 1)
        for n in range(lo, hi):
            holds = site[TERM, n] * before <= tolerance
            holds = holds and site[LAST_TERM, n] * before * longer <= tolerance
            short += 0 if holds else 1
        if _SLOW_SHARE * short > hi - lo:
            break
        length = longer
    return float(min(length, most))


@friction_inner
def _expanded(run: Run, lo: int, hi: int) -> bool:
    """Make series of sites lo … hi - 1 from their states; return whether all are finite.

    TERM and LAST_TERM are set to the sizes of its last two coefficients.
    """
    series, site = run.series, run.site
    for n in range(lo, hi):
        series[Y, 0, n] = site[Y, n]
        series[W, 0, n] = site[W, n]
    expand(series, site, run.mode, run.numbers, run.law, lo, hi)
    order, total = series.shape[1] - 1, 0.0
    for n in range(lo, hi):
        site[TERM, n] = term_size(series, order - 1, n)
        site[LAST_TERM, n] = term_size(series, order, n)
        total += site[TERM, n] + site[LAST_TERM, n]
    return math.isfinite(total)


@friction_inner
def _found(run: Run, lo: int, hi: int, now: float, length: float) -> bool:
    """Set the validity of new series and find their events; return whether time advances.

    When a site in stick is released depends on the series of its neighbours, and a site next to one
    that has kept its series is computed from that series; neither is valid for longer than those.
    """
    site, mode, series, numbers = run.site, run.mode, run.series, run.numbers
    order, tolerance, left = series.shape[1] - 1, run.numbers[TOLERANCE], length - now
    before, goes_on = left ** (order - 1), True
    for n in range(lo, hi):
        first, last = site[TERM, n], site[LAST_TERM, n]
        site[STEP, n] = left
        if max(first, last * left) * before > 0.999 * tolerance:
            site[STEP, n] = min(left, term_length(first, last, order, tolerance))
    absolute_sums(series[W], site, lo, hi, left)
    for n in range(lo, hi):
        h = site[STEP, n]
        if mode[MODE, n] != 0 and not (len(run.law) == 0 and site[SUM, n] <= numbers[V0]):
            h = resolved(series, numbers, run.law, n, float(mode[MODE, n]), h)
        time = numbers[CLOCK] + now
        goes_on = goes_on and (h >= length - now or time + h > time)
        site[START, n] = now
        site[END, n] = min(length, now + h)
    for n in range(lo, hi):
        end = site[END, n]
        for m in (n - 1, n + 1):
            if m < lo or m >= hi or (mode[MODE, n] == 0 and mode[MODE, m] != 0):
                end = min(end, max(now, site[END, m]))
        site[END, n] = end
    for n in range(lo, hi):
        site[EVENT, n] = math.inf
        if not site[SUM, n] < mode[MODE, n] * series[W, 0, n]:  # as ``first_root`` requires
            first = _first_event(
                series, site, run.work, numbers, n, mode[MODE, n], site[END, n] - now
            )
            site[EVENT, n] = now + first
        expires = site[END, n] if site[END, n] < length else math.inf
        run.queue[run.queue.size // 2 + n] = min(site[EVENT, n], expires)
    return goes_on


@friction_inner
def _first_event(
    series: FloatArray,
    site: FloatArray,
    work: FloatArray,
    p: FloatArray,
    n: int,
    mode: int,
    h: float,
) -> float:
    """Return the time from the start of its series to the first event of site n; inf if beyond h.

    A site in slip has one function of time to be monitored, a site in stick one for each limit.
    """
    f, order = work[POLYNOMIAL], series.shape[1] - 1
    if mode != 0:
        for k in range(order + 1):
            f[k] = float(mode) * series[W, k, n]
        return first_root(work, order, h)
    first = math.inf
    for side in (1.0, -1.0):
        for k in range(order + 1):
            y = series[Y, k]
            bend = site[OWN, n] * y[n] - (y[n - 1] + y[n + 1])
            f[k] = -side * (y[n] + p[C] * bend)
        f[0] += p[MU_ST] - side * 2.0 * p[XI] * p[V_D]
        first = min(first, first_root(work, order, h))
    return first


@friction_inner
def _next_due(queue: FloatArray, n: int, until: float) -> int:
    """Return the first site from n on that is due by a given time; -1 if there is none."""
    leaves = queue.size // 2
    node = leaves + n
    while not queue[node] <= until:
        while node % 2 == 1:  # the right child: continue to the right of both
            node //= 2
        if node == 0:
            return -1
        node += 1
    while node < leaves:
        node = 2 * node if queue[2 * node] <= until else 2 * node + 1
    return node - leaves


@friction_inner
def _rate(w: FloatArray, n: int, h: float) -> float:
    """Return a bound on |ẇ| of site n up to a time h after the beginning of its series."""
    rate = 0.0
    for k in range(w.shape[0] - 1, 0, -1):
        rate = rate * h + k * abs(w[k, n])
    return rate


@friction_inner
def _reach(p: FloatArray, order: int, change: float, h: float) -> int:
    """Return the d of the module docstring for J = ``change`` and τ = h; -1 if there is none."""
    growth = p[DRAG] + p[STEEPEST]
    growth = 0.5 * growth + math.sqrt(0.25 * growth * growth + 1.0 + 2.0 * p[C])
    x = p[C] * h * h
    if growth * h > 300.0 or x > 300.0:
        return -1
    force = change * math.exp(growth * h) * math.cosh(x)
    for d in range(order + 1):
        force *= x / ((2 * d + 2) * (2 * d + 1))
        if force <= _NEGLECTED * p[TOLERANCE]:
            return max(d, 1)
    return -1


@friction_inner
def _switched(run: Run, now: float, length: float) -> tuple[int, float]:
    """Give new modes to the sites that have an event now; return how many sites are due, and J.

    DUE lists the sites that are due because of an event or because their series expires. J includes
    the old series and the immediate part of the new ones: a change of the friction force.
    """
    site, due = run.site, run.mode[DUE]
    until = now + _TOGETHER * max(now, abs(run.numbers[CLOCK]))
    count, change = 0, 4.0 * run.numbers[MU_ST]
    n = _next_due(run.queue, run.counters[LO], until)
    while n >= 0:
        due[count] = n
        count += 1
        change = max(change, 2.0 * _rate(run.series[W], n, length - site[START, n]))
        n = _next_due(run.queue, n + 1, until)
    for i in range(count):
        for m in range(max(due[i] - 1, run.counters[LO]), min(due[i] + 2, run.counters[HI])):
            if site[START, m] < now:
                _bring(run, m, now)
    for i in range(count):
        if site[EVENT, due[i]] <= until:
            _switch(run, due[i], run.numbers[CLOCK] + now)
            site[EVENT, due[i]] = math.inf
    return count, change


@friction_inner
def _switch(run: Run, n: int, time: float) -> None:
    """Give site n its new mode at an event, and count the event; grazing is not an event."""
    site, mode, p, counters = run.site, run.mode, run.numbers, run.counters
    bend = site[OWN, n] * site[Y, n] - (site[Y, n - 1] + site[Y, n + 1])
    force = 2.0 * p[XI] * p[V_D] + site[Y, n] + p[C] * bend
    site[W, n] = 0.0
    if mode[MODE, n] == 0:
        kind = STICK_ENDS
        mode[MODE, n] = -1 if force > 0.0 else 1
        mode[RELEASED, n] = 1
    elif abs(force) <= p[MU_ST]:
        kind = STICK_BEGINS
        mode[MODE, n] = 0
    elif (force > 0.0) == (mode[MODE, n] == 1):
        kind = REVERSAL
        mode[MODE, n] = -mode[MODE, n]
    else:
        mode[RELEASED, n] = 1
        return
    counters[KINDS + kind] += 1
    if counters[LOGGED] < run.log.shape[0]:
        row = counters[LOGGED]
        run.log[row, 0], run.log[row, 1], run.log[row, 2] = time, float(n), float(kind)
        counters[LOGGED] += 1
    if kind == STICK_BEGINS and math.isnan(site[ARRIVAL, n]):
        site[ARRIVAL, n] = time


@friction_inner
def _ranges(run: Run, due: int, radius: int) -> int:
    """Put the ranges within a radius of the due sites into FIRST and BEYOND; return their number.

    Touching ranges are merged; between two ranges there is a site that keeps its series, so that
    the order of the ranges does not matter.
    """
    mode, count = run.mode, 0
    for i in range(due):
        lo = max(run.counters[LO], mode[DUE, i] - radius)
        hi = min(run.counters[HI], mode[DUE, i] + radius + 1)
        if count > 0 and mode[BEYOND, count - 1] >= lo:
            count -= 1
            lo = mode[FIRST, count]
        mode[FIRST, count], mode[BEYOND, count] = lo, hi
        count += 1
    for i in range(count):
        run.counters[LOCAL] += mode[BEYOND, i] - mode[FIRST, i]
    return count


@friction_inner
def _renew(run: Run, lo: int, hi: int, now: float, length: float) -> float:
    """Give sites lo … hi - 1 new series now, using the series of the sites beside them.

    Returns the length of the frame; 0 if time does not advance, nan if a series is not finite. With
    a negative ``length``, the frame length is determined here and is at most its absolute value.
    """
    y, site, work, queue = run.series[Y], run.site, run.work, run.queue
    for n in range(lo, hi):
        if site[START, n] < now:
            _bring(run, n, now)
    for side in range(2):
        beside = lo - 1 if side == 0 else hi
        if site[START, beside] == now:
            continue
        for k in range(y.shape[0]):
            work[KEPT + side, k] = y[k, beside]
        shift(y, beside, now - site[START, beside], work[POLYNOMIAL])
        for k in range(y.shape[0]):
            y[k, beside] = work[POLYNOMIAL, k]
    if not _expanded(run, lo, hi):
        return math.nan
    if length < 0.0:
        length = _frame_length(site, lo, hi, y.shape[0] - 1, run.numbers, -length)
    goes_on = length > 0.0 and _found(run, lo, hi, now, length)
    for side in range(2):
        beside = lo - 1 if side == 0 else hi
        for k in range(y.shape[0] if site[START, beside] != now else 0):
            y[k, beside] = work[KEPT + side, k]
    first, last = (queue.size // 2 + lo) // 2, (queue.size // 2 + hi - 1) // 2
    while first >= 1:
        for node in range(first, last + 1):
            queue[node] = min(queue[2 * node], queue[2 * node + 1])
        first //= 2
        last //= 2
    return length if goes_on else 0.0


@friction_inner
def _bring(run: Run, n: int, now: float) -> None:
    """Advance the state of site n and what is sampled of it to a given time; its series is kept."""
    site, series = run.site, run.series
    h = now - site[START, n]
    _watch(run, n, h)
    site[Y, n] = site_value(series[Y], n, h)
    site[W, n] = site_value(series[W], n, h)
    run.mode[RELEASED, n] = 0
    site[START, n] = now


@friction_inner
def _watch(run: Run, n: int, h: float) -> None:
    """Record the turning points and samples of site n up to a time h after its series begins."""
    site, start, v_d = run.site, run.site[START, n], run.numbers[V_D]
    passed, turn = 0.0, 0.0
    sampled = run.counters[SAMPLED] < run.times.size
    if run.mode[MODE, n] != -1 or site[SUM, n] < abs(run.series[W, 0, n] + v_d):
        turn = math.inf
    while turn <= h:
        turn, kind = _turning_point(run.series[W], run.work, v_d, n, passed, h)
        if turn <= h:
            if sampled:
                _sample(run, n, start + passed, start + turn)
            site[LAST_MAXIMUM + kind, n] = site_value(run.series[Y], n, turn)
            passed = turn
            shift(run.series[W], n, 0.0, run.work[POLYNOMIAL])
            if one_way(run.work[POLYNOMIAL], run.series.shape[1] - 1, h, run.work[KEPT]):
                turn = math.inf  # its velocity is monotonic, so it turns once only
    if sampled:
        _sample(run, n, start + passed, start + h)


@friction_inner
def _turning_point(
    w: FloatArray, work: FloatArray, v_d: float, n: int, after: float, h: float
) -> tuple[float, int]:
    """Return the time in (after, h] at which y of site n next turns, and 0 for a maximum or 1.

    Times are measured from the beginning of the series. A site that starts at rest does not turn
    there.
    """
    f = work[POLYNOMIAL]
    shift(w, n, after, f)
    f[0] = f[0] + v_d if after == 0.0 else 0.0
    if f[0] == 0.0 and f[1] == 0.0:
        return math.inf, 0
    rising = f[0] > 0.0 or (f[0] == 0.0 and f[1] > 0.0)
    if not rising:
        for k in range(w.shape[0]):
            f[k] = -f[k]
    return after + first_root(work, w.shape[0] - 1, h - after), 0 if rising else 1


@friction_inner
def _sample(run: Run, n: int, begin: float, end: float) -> None:
    """Sample site n at the required times from begin to end."""
    site, series, times = run.site, run.series, run.times
    i = run.counters[SAMPLED]
    while i < times.size:
        at = max(0.0, times[i] - run.numbers[CLOCK])
        if at > end:
            return
        if at >= begin:
            row = run.samples[i]
            row[0, n - 1] = site_value(series[Y], n, at - site[START, n])
            row[1, n - 1] = site_value(series[W], n, at - site[START, n])
            row[2, n - 1] = 0.5 * abs(site[LAST_MAXIMUM, n] - site[LAST_MINIMUM, n])
        i += 1


@friction_inner
def _finish(run: Run, end: float) -> None:
    """Advance all sites to the end of the frame; those that are sampled or may turn are watched."""
    site, mode, times, lo, hi = run.site, run.mode, run.times, run.counters[LO], run.counters[HI]
    series, i = run.series, run.counters[SAMPLED]
    sampled = i < times.size and not max(0.0, times[i] - run.numbers[CLOCK]) > end
    for n in range(lo, hi):
        site[STEP, n] = end - site[START, n]
    for n in range(lo, hi):
        if site[STEP, n] > 0.0:
            still = site[SUM, n] < abs(series[W, 0, n] + run.numbers[V_D])
            if sampled or (mode[MODE, n] == -1 and not still):
                _watch(run, n, site[STEP, n])
            mode[RELEASED, n] = 0
        elif sampled:
            _sample(run, n, end, end)
        site[START, n] = 0.0
    for row in (Y, W):
        site_values(series[row], site, lo, hi)
        for n in range(lo, hi):
            if site[STEP, n] > 0.0:
                site[row, n] = site[SUM, n]
    while run.counters[SAMPLED] < times.size:
        i = run.counters[SAMPLED]
        if max(0.0, times[i] - run.numbers[CLOCK]) > end:
            return
        for n in range(1, site.shape[1] - 1):
            if n < lo or n >= hi:
                run.samples[i, 0, n - 1] = site[Y, n]
                run.samples[i, 1, n - 1] = site[W, n]
        run.counters[SAMPLED] += 1


@friction_inner
def _widen(site: FloatArray, numbers: FloatArray, counters: IntArray) -> None:
    """Widen the window so that MARGIN sites at rest lie inside it on either side."""
    lo, hi = counters[LO], counters[HI]
    for n in range(lo, hi):
        away = max(abs(site[Y, n] - numbers[SLIDING]), abs(site[W, n] + numbers[V_D]))
        if away > numbers[REST]:
            if n < lo + MARGIN:
                counters[LO] = min(counters[LO], max(1, n - MARGIN))
            if n >= hi - MARGIN:
                counters[HI] = max(counters[HI], min(site.shape[1] - 1, n + MARGIN + 1))
