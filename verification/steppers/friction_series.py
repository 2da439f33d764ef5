"""Taylor coefficients in time of the friction chain (5), and the first root of a polynomial.

As long as no site changes its mode, (5) is smooth. E, which decreases with speed, is a third
unknown:

    w = ẏ - v_d,  ẏ = w + v_d,  s = sgn(w) fixed;   in stick ẇ = 0;   in slip
    ẇ = -s(μ_d + ΔE) - κw - 2ξ(w + v_d) - y - c(…),
    E = e^{-sw/v₀},  Ė = -(s/v₀) ẇ E   or, under Stribeck's law,   E = e^{-q/v_s²},  q = w².

Δ is μ_st - μ_d; under Coulomb's law it is 0, and ẇ jumps by s(μ_st - μ_d) at the end of stick.

The variable integrated is w and not ẏ, so that it retains all its digits near stick. All quantities
are dimensionless.

Compiled functions receive few arrays of many rows, since numba's compile time grows with the number
of arrays passed. Site n, from 1 to N, is column n; columns 0 and N + 1 stand for the missing
neighbours of the end sites and remain zero.

Stribeck's law is recognised by type when functions are compiled, so that it costs nothing under the
other laws: ``law`` is () or (v_s,).

``numbers``, shape (14,)
    Parameters and other scalars, at the indices ``MU_ST`` and following.
``series``, shape (3 + len(law), order + 1, N + 2)
    Taylor coefficients of y and w, and work space for those of E and q.
``site``, shape (11, N + 2)
    Rows with the indices ``Y`` and following.
``mode``, shape (6, N + 2)
    Whole numbers, in rows with the indices ``MODE`` and following.
``work``, shape (order + 54, order + 1)
    Work space: a polynomial, two columns that are kept, a table of binomial coefficients, work
    rows.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba.cpython.unsafe.tuple import tuple_setitem

from theory.arrays import FloatArray, IntArray
from theory.cells.friction import FrictionCell
from theory.cells.friction_law import FrictionLaw
from verification.execution import compiled

MU_ST, MU_D, V0, XI, V_D, C = 0, 1, 2, 3, 4, 5
"""Indices into ``numbers``: the parameters of (5)."""

TOLERANCE, REST, SLIDING, CLOCK = 6, 7, 8, 9
"""Local error; distance from steady sliding within which a site is at rest; y of steady sliding;
time."""

DROP, DRAG, STEEPEST, JUMP = 10, 11, 12, 13
"""Δ; 2ξ + κ; the largest slope of ΔE; the sudden decrease of friction at the end of stick."""

Y, W, E, Q = 0, 1, 2, 3
"""Quantities in ``series``; the first two are also rows of ``site``."""

OWN, SIGN, BEND, START, END, EVENT, ARRIVAL = 2, 3, 4, 5, 6, 7, 8
"""Rows of ``site``: number of coupled neighbours; direction of slip and coupling term (work space);
within the frame, the times from which and until which its series holds, and of its next event; time
of the first stick."""

LAST_MAXIMUM, LAST_MINIMUM = 9, 10
"""Rows of ``site``: last maximum and minimum of y."""

STEP, SUM = 11, 12
"""Rows of ``site``, work space: a time after the beginning of the series; a bound on the change of
w while the series is valid, or the values at that time."""

TERM, LAST_TERM = 13, 14
"""Rows of ``site``, work space: the last two coefficients, |y_k| + |w_k|."""

ROWS = 15
"""Number of rows of ``site``."""

MODE, RELEASED, DUE, FIRST, BEYOND = 0, 1, 2, 3, 4
"""Rows of ``mode``: 0 in stick, otherwise the sign of w; whether stick has ended at this very time;
work space for the sites that are due and for ranges of sites."""

POLYNOMIAL, KEPT, BINOMIALS = 0, 1, 3
"""Rows of ``work``; the work rows follow the binomial coefficients."""

ABREAST = 8
"""Number of columns whose E is computed together, if there are so many."""
_ZEROS = (0.0,) * ABREAST
_with_item: Any = tuple_setitem

_DEPTH = 48
_SAMPLES = 16


friction_inner = compiled.inner(error_model="numpy", **compiled.UNCOUNTED)
"""Decorator for functions that are called by compiled functions only."""

vectorised = compiled.inner(error_model="numpy", fastmath={"contract"}, **compiled.UNCOUNTED)
"""Decorator like ``friction_inner``, with products and sums contracted."""


friction_outer = compiled.outer(
    unrolled=False, cache=True, error_model="numpy", **compiled.UNCOUNTED
)
"""Decorator for functions that are called from Python."""


Law = tuple[float, ...]


def law_of(cell: FrictionCell) -> Law:
    """Return (v_s,) under Stribeck's law, otherwise ()."""
    return (cell.v_s,) if cell.law is FrictionLaw.STRIBECK else ()


def taylor_order(tolerance: float) -> int:
    """Return the cheapest order for a tolerance, as determined by measurement.

    Examples
    --------
    >>> taylor_order(1e-6), taylor_order(1e-12)
    (11, 18)
    """
    return math.ceil(4.0 - 0.5 * math.log(tolerance))


def new_numbers(cell: FrictionCell, c: float, tolerance: float) -> FloatArray:
    """Return ``numbers`` for a chain of such cells."""
    curve = cell.curve
    v0 = cell.v0 if cell.law is FrictionLaw.EXPONENTIAL else math.inf
    own = [cell.mu_st, cell.mu_d, v0, cell.xi, cell.v_d, c]
    derived = [curve.drop, 2.0 * cell.xi + cell.viscous, curve.steepest]
    jump = cell.mu_st - cell.mu_d - curve.drop
    return np.array([*own, tolerance, -1.0, cell.steady_sliding, 0.0, *derived, jump])


def new_work(order: int) -> FloatArray:
    """Return ``work`` for series of an order."""
    work = np.zeros((BINOMIALS + order + 1 + _DEPTH + 2, order + 1))
    for n in range(order + 1):
        work[BINOMIALS + n] = [math.comb(n, k) for k in range(order + 1)]
    return work


@vectorised
def expand(
    series: FloatArray,
    site: FloatArray,
    mode: IntArray,
    numbers: FloatArray,
    law: Law,
    lo: int,
    hi: int,
) -> None:
    """Fill the coefficients 1 … order of the sites lo … hi - 1 from those of order 0.

    The columns beside them must contain the series of the neighbours about the same time. The sum
    of both neighbours is formed first, which keeps a mirror-symmetric chain symmetric.
    """
    order, c, drag = series.shape[1] - 1, numbers[C], numbers[DRAG]
    drop, v0 = numbers[DROP], numbers[V0]
    own, sign, bend = site[OWN, lo:hi], site[SIGN, lo:hi], site[BEND, lo:hi]
    for n in range(hi - lo):
        sign[n] = float(mode[MODE, lo + n])
        speed = sign[n] * series[W, 0, lo + n] / v0
        if len(law) == 1:
            speed = (series[W, 0, lo + n] / law[0]) ** 2
        falling = math.exp(-speed) if sign[n] != 0.0 else 0.0
        series[E, 0, lo + n] = falling if falling > 1e-300 else 0.0
    for k in range(order):
        factor = 1.0 / (k + 1)
        y, w, e = series[Y, k, lo:hi], series[W, k, lo:hi], series[E, k, lo:hi]
        left, right = series[Y, k, lo - 1 : hi - 1], series[Y, k, lo + 1 : hi + 1]
        next_y, next_w = series[Y, k + 1, lo:hi], series[W, k + 1, lo:hi]
        for n in range(hi - lo):
            next_y[n] = factor * w[n]
            bend[n] = own[n] * y[n] - (left[n] + right[n])
            pull = -(sign[n] * drop) * e[n] - drag * w[n] - y[n] - c * bend[n]
            next_w[n] = (sign[n] * sign[n]) * factor * pull
        if k == 0:
            belt = 2.0 * numbers[XI] * numbers[V_D]
            for n in range(hi - lo):
                next_y[n] += numbers[V_D]
                next_w[n] -= sign[n] * numbers[MU_D] + (sign[n] * sign[n]) * belt
                if mode[RELEASED, lo + n] != 0:
                    next_w[n] = sign[n] * numbers[JUMP] + 0.0
        if len(law) == 1:
            _expand_gaussian(series, lo, hi, k, law[0])
            continue
        if series.shape[2] >= ABREAST:
            for n in range(lo, hi, ABREAST):
                first = min(n, series.shape[2] - ABREAST)
                _expand_abreast(series[W], series[E], site[SIGN], k, first, -(factor / v0))
            continue
        next_e = series[E, k + 1, lo:hi]
        for n in range(hi - lo):
            next_e[n] = 0.0
        for j in range(k + 1):
            u, f, times = series[W, j + 1, lo:hi], series[E, k - j, lo:hi], j + 1.0
            for n in range(hi - lo):
                next_e[n] += (times * u[n]) * f[n]
        for n in range(hi - lo):
            next_e[n] *= -(factor / v0) * sign[n]


@vectorised
def _expand_abreast(
    w: FloatArray, e: FloatArray, sign: FloatArray, k: int, first: int, factor: float
) -> None:
    """Compute coefficient k + 1 of E in ``ABREAST`` columns from ``first`` on.

    E is work space, so columns beyond those required may be overwritten. The sums are a tuple,
    which the compiler keeps in registers; sums in an array would be stored and loaded at each term.
    Indices are unsigned, since a check for negative ones would hide from the compiler that the
    columns are adjacent.
    """
    a, one, last = np.uintp(first), np.uintp(1), np.uintp(k)
    sums, times = _ZEROS, 0.0
    for j in range(last + one):
        u, f = j + one, last - j
        times += 1.0
        for i in range(ABREAST):
            n = a + np.uintp(i)
            sums = _with_item(sums, i, sums[i] + (times * w[u, n]) * e[f, n])
    for i in range(ABREAST):
        n = a + np.uintp(i)
        e[last + one, n] = sums[i] * (factor * sign[n])


@vectorised
def _expand_gaussian(series: FloatArray, lo: int, hi: int, k: int, v_s: float) -> None:
    """Fill coefficient k + 1 of q = w² and of E = e^{-q/v_s²}, for which Ė = -q̇E/v_s²."""
    next_q, next_e = series[Q, k + 1, lo:hi], series[E, k + 1, lo:hi]
    for n in range(hi - lo):
        next_q[n] = 0.0
        next_e[n] = 0.0
    for j in range(k + 2):
        u, f = series[W, j, lo:hi], series[W, k + 1 - j, lo:hi]
        for n in range(hi - lo):
            next_q[n] += u[n] * f[n]
    for j in range(k + 1):
        u, f, times = series[Q, j + 1, lo:hi], series[E, k - j, lo:hi], j + 1.0
        for n in range(hi - lo):
            next_e[n] += (times * u[n]) * f[n]
    for n in range(hi - lo):
        next_e[n] *= -1.0 / ((k + 1) * v_s * v_s)


@friction_inner
def shift(P: FloatArray, column: int, x: float, out: FloatArray) -> None:
    """Put the coefficients of a series about a time later by x into out: a Taylor shift."""
    order = P.shape[0] - 1
    for k in range(order + 1):
        out[k] = P[k, column]
    if x != 0.0:
        for k in range(order - 1, -1, -1):
            rest = out[k:]
            for i in range(order - k):  # ascending, so that the loop can be vectorised
                rest[i] += x * rest[i + 1]


@friction_inner
def site_value(P: FloatArray, n: int, h: float) -> float:
    """Return the value of site n at a time h after the beginning of its series."""
    value = P[P.shape[0] - 1, n]
    for k in range(P.shape[0] - 2, -1, -1):
        value = value * h + P[k, n]
    return float(value)


@friction_inner
def site_values(P: FloatArray, site: FloatArray, lo: int, hi: int) -> None:
    """Put the values of the sites lo … hi - 1 at their own times STEP into SUM, vectorised."""
    h, value = site[STEP, lo:hi], site[SUM, lo:hi]
    for n in range(hi - lo):
        value[n] = P[P.shape[0] - 1, lo + n]
    for k in range(P.shape[0] - 2, -1, -1):
        p = P[k, lo:hi]
        for n in range(hi - lo):
            value[n] = value[n] * h[n] + p[n]


@friction_inner
def value_at(f: FloatArray, degree: int, h: float) -> float:
    """Return Σ f_k h^k."""
    value = f[degree]
    for k in range(degree - 1, -1, -1):
        value = value * h + f[k]
    return float(value)


@friction_inner
def term_size(series: FloatArray, k: int, n: int) -> float:
    """Return |y_k| + |w_k| of site n."""
    return float(abs(series[W, k, n]) + abs(series[Y, k, n]))


@friction_inner
def term_length(before: float, last: float, order: int, tolerance: float) -> float:
    """Return h at which terms with the last two coefficients equal the tolerance.

    See :func:`resolved` for what the last two terms do not show.
    """
    h = math.inf
    if before > 0.0:
        h = (tolerance / before) ** (1.0 / (order - 1))
    if last > 0.0:
        h = min(h, (tolerance / last) ** (1.0 / order))
    return h


@friction_inner
def resolved(
    series: FloatArray, numbers: FloatArray, law: Law, n: int, s: float, h: float
) -> float:
    """Return h, halved until the series of a slipping site resolves the growth of E.

    Far from stick E is too small to affect the coefficients, yet it can be of order one at the end
    of the step. The remainder of its series is therefore kept below the tolerance. With x =
    (approach of w to stick)/v₀ and u = (smallest distance of w from stick)/v₀, it is e^{-u}
    x^order/order!; under Stribeck's law, with v_s for v₀, it is at most 1.09 e^{-u²/2} (√2
    x)^order/√order! by Cramér's bound on Hermite polynomials (Abramowitz and Stegun 1964,
    22.14.17).

    Parameters
    ----------
    series, numbers, law
        As in the module docstring.
    n : int
        Site.
    s : float
        Its direction of slip.
    h : float
        Proposed step.
    """
    w, order = series[W], series.shape[1] - 1
    if len(law) == 0 and absolute_sum(w, n, h) <= numbers[V0]:
        return h
    start = s * w[0, n]
    allowed = math.log(numbers[TOLERANCE]) + math.lgamma(order + 1.0)
    while h > 0.0:
        nearest = max(0.0, start - absolute_sum(w, n, h))
        if _seen(numbers, law, order, nearest, start, allowed):
            return h
        nearest = start
        for i in range(1, _SAMPLES + 1):
            nearest = min(nearest, s * site_value(w, n, h * i / _SAMPLES))
        nearest -= 0.125 * (h / _SAMPLES) ** 2 * _largest_bend(w, n, h)  # between two samples
        if _seen(numbers, law, order, max(0.0, nearest), start, allowed):
            return h
        h *= 0.5
    return h


@friction_inner
def absolute_sum(P: FloatArray, n: int, h: float) -> float:
    """Return Σ_{k≥1} |P_k| h^k, a bound on the change of the polynomial up to h."""
    size = 0.0
    for k in range(P.shape[0] - 1, 0, -1):
        size = (size + abs(P[k, n])) * h
    return size


@friction_inner
def _largest_bend(P: FloatArray, n: int, h: float) -> float:
    """Return Σ k (k - 1) |P_k| h^(k-2), a bound on the second derivative up to h."""
    size = 0.0
    for k in range(P.shape[0] - 1, 1, -1):
        size = size * h + k * (k - 1) * abs(P[k, n])
    return size


@friction_inner
def absolute_sums(P: FloatArray, site: FloatArray, lo: int, hi: int, h: float) -> None:
    """Put ``absolute_sum`` of the sites lo … hi - 1 at one time h into SUM, vectorised.

    For most sites these sums prove that they slip far from stick; computed one by one they took a
    third of the time of a frame.
    """
    size, power = site[SUM, lo:hi], 1.0
    for n in range(hi - lo):
        size[n] = 0.0
    for k in range(1, P.shape[0]):
        p = P[k, lo:hi]
        power *= h
        for n in range(hi - lo):
            size[n] += abs(p[n]) * power


@friction_inner
def _seen(
    numbers: FloatArray, law: Law, order: int, nearest: float, start: float, allowed: float
) -> bool:
    """Whether the remainder of the series of E is small between these distances from stick."""
    if len(law) == 1:
        x, u = (start - nearest) / law[0], nearest / law[0]
        if x <= 0.0:
            return True
        hermite = 0.09 + 0.5 * (order * math.log(2.0) + math.lgamma(order + 1.0))
        return bool(hermite + order * math.log(x) - 0.5 * u * u <= allowed)
    v0 = numbers[V0]
    if start - nearest <= v0:
        return True
    return bool(order * math.log((start - nearest) / v0) - nearest / v0 <= allowed)


@friction_inner
def _polish(f: FloatArray, degree: int, low: float, high: float) -> float:
    """Return the root between low, where f > 0, and high, where f <= 0, by safeguarded Newton."""
    x = 0.5 * (low + high)
    for _ in range(100):
        value, slope = f[degree], 0.0
        for k in range(degree - 1, -1, -1):
            slope = slope * x + value
            value = value * x + f[k]
        if value > 0.0:
            low = x
        else:
            high = x
        step = value / slope if slope != 0.0 else math.inf
        following = x - step
        if abs(step) <= 4e-16 * abs(x):  # checked first: round-off may leave the bracket
            return float(following)
        if not low < following < high:
            following = 0.5 * (low + high)
            if following in (low, high):
                return float(following)
        x = following
    return float(x)


@friction_inner
def first_root(work: FloatArray, degree: int, h: float) -> float:
    """Return the first time in [0, h] at which f turns from positive to negative; inf if none.

    f(0) <= 0 counts as zero: the sign just after is then that of the first nonzero coefficient, and
    if it is negative, 0 is returned. A root of even order is a crossing only at h or where [0, h]
    is halved. Bernstein coefficients: no change of sign, no root; one, one root; else, bisection.

    Parameters
    ----------
    work : ndarray
        ``new_work``; its first row contains the coefficients of f and is overwritten.
    degree : int
        Degree.
    h : float
        End of the interval.
    """
    f, binomial = work[POLYNOMIAL], work[BINOMIALS : BINOMIALS + work.shape[1]]
    intervals = work[BINOMIALS + work.shape[1] :]
    while f[0] <= 0.0:
        if degree == 0 or f[1] < 0.0:
            return 0.0 if degree > 0 else math.inf
        for k in range(degree):
            f[k] = f[k + 1]
        degree -= 1
    if _stays_positive(f, degree, h):
        return math.inf
    if one_way(f, degree, h, intervals[0]):
        crosses = f[1] < 0.0 and value_at(f, degree, h) <= 0.0
        return _polish(f, degree, 0.0, h) if crosses else math.inf
    power = 1.0
    top, falling = intervals[0, : degree + 1], intervals[1, : degree + 1]
    for k in range(degree + 1):
        falling[degree - k] = f[k] * power / binomial[degree, k]
        power *= h
    for k in range(degree, 0, -1):  # in place: differences back to Bernstein coefficients
        for i in range(k):
            falling[i] += falling[i + 1]
    for k in range(degree + 1):
        top[k] = falling[degree - k]
    depth, width = 0, 1.0
    left = 0.0
    # intervals[depth] is the present one, intervals[:depth] those to its right, each twice as wide.
    while depth >= 0:
        b = intervals[depth]
        changes = 0
        for i in range(degree):
            if (b[i] > 0.0) != (b[i + 1] > 0.0):
                changes += 1
        if changes == 1 and b[0] > 0.0:
            return _polish(f, degree, left * h, (left + width) * h)
        if changes > 1 and depth < _DEPTH:
            following = intervals[depth + 1]
            for i in range(degree + 1):
                following[i] = b[0]
                for j in range(degree - i):
                    b[j] = 0.5 * (b[j] + b[j + 1])
            # b[0] is now the value at the midpoint; b is the right half.
            depth += 1
            width *= 0.5
            continue
        left += width
        depth -= 1
        # The interval to the right is at least as wide as its sibling, which has just been
        # finished.
        width = _width_of(left)
    return math.inf


@friction_inner
def one_way(f: FloatArray, degree: int, h: float, slope: FloatArray) -> bool:
    """Whether f is proved to be monotonic on [0, h]; ``slope`` is work space."""
    sign = math.copysign(1.0, f[1])
    for k in range(1, degree + 1):
        slope[k - 1] = sign * k * f[k]
    return _stays_positive(slope, degree - 1, h)


@friction_inner
def _stays_positive(f: FloatArray, degree: int, h: float) -> bool:
    """Whether f is proved to be positive on [0, h]: its first three terms outweigh all others."""
    size, power = 0.0, h * h
    slope = f[1] * h if degree > 0 else 0.0
    bend = f[2] * power if degree > 1 else 0.0
    for k in range(3, degree + 1):
        power *= h
        size += abs(f[k]) * power
    least = f[0] + min(0.0, slope + bend)
    if slope < 0.0 < 2.0 * bend + slope:  # the parabola turns on the way
        least = f[0] - 0.25 * slope * slope / bend
    return bool(least > size + 1e-14 * (f[0] + abs(slope) + abs(bend)))


@friction_inner
def _width_of(left: float) -> float:
    """Return the width of the dyadic interval beginning at ``left``, after its left neighbour."""
    width = 1.0
    while left % width != 0.0:
        width *= 0.5
    return width
