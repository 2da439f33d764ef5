"""Σ(v, c) as the printed series over the roots (53), with its tail summed instead of truncated.

With the label ν as a real variable, k(ν) = ±i w + 2πν with 2cosh w = q = αk + β, α = 2v/c,
β = 2 + i/c, and S = √(q² - 4) = 2 sinh w. A term of the series is then

    t(ν) = 1/(k L_k) = ±2/[c k (S ∓ iα)] = ±k'(ν)/(π c k S)

(upper sign above the axis). Its integral is elementary in u = e^w, with u₁,₂ the roots of
u² - βu + 1: ∫ dk/(kS) = ln[(u - u₁)/(u - u₂)]/(u₁ - u₂). Above the axis Im q > Im β, which keeps
the argument of the logarithm off its cut. The Euler–Maclaurin formula adds derivatives of t at the
last root summed; they follow from a Taylor recurrence for k(ν). S must be continued in ν, rather
than e^{-ik}, since the two agree at integers only.

The error of the Euler–Maclaurin formula at a label is about e^{-2πρ}, where ρ is the distance of
the label from the singularities of t(ν): k = 0, S = 0, S = ±iα. This determines how many roots are
summed one by one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from operator import mul
from time import perf_counter
from typing import Any

import mpmath as mp
import numpy as np

from theory.parameters import count_within, with_ranges
from theory.piecewise.precise_roots import exact, precise_roots
from theory.piecewise.roots import MAX_ROOTS, checked_velocity_and_coupling, labelled_roots
from theory.piecewise.sums.result import DIGITS, DOUBLE, KineticSum, PrecisionError, stated

_MAX_PRECISE_ROOTS = 20_000

Fixed = tuple[int, int]
"""Real and imaginary part in units of a power of two."""


@dataclass(frozen=True)
class RootSeries:
    """The series over the roots of one half-plane, at the current precision.

    Attributes
    ----------
    v, c : mpf
        Front velocity v̂ and coupling, dimensionless.
    sign : int
        1 above the real axis, -1 below.
    """

    v: Any
    c: Any
    sign: int

    @property
    def alpha(self) -> Any:
        """2v/c."""
        return 2 * self.v / self.c

    @property
    def beta(self) -> Any:
        """2 + i/c."""
        return mp.mpc(2, 1 / self.c)


@with_ranges(digits=DIGITS)
def sum_by_roots(
    v: float | str, c: float | str, digits: int = DOUBLE, upper: bool = True
) -> KineticSum:
    """Return Σ over the roots of one half-plane of 1/(k L_k) (Eq. 53 for the upper one).

    Parameters
    ----------
    v, c : float or str
        Front velocity v̂ and coupling, dimensionless. A string is read as a decimal at full
        precision, a float is the exact binary number.
    digits : int
        Required digits after the point, {digits}. Up to 15 digits, the roots that are summed
        one by one are computed in double precision.
    upper : bool
        Sum over M⁺ if true, over M⁻ if false. The two sums add up to -2.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    PrecisionError
        If more than a million roots (20 000 beyond 15 digits) would have to be summed one by one.

    Examples
    --------
    >>> total = sum_by_roots("0.3", "0.5", digits=30)
    >>> print(mp.nstr(total.value.real, 25), total.terms < 60)
    -0.2887967561902519894582199 True
    """
    start = perf_counter()
    digits = count_within("digits", digits, *DIGITS)
    checked_velocity_and_coupling(v, c)
    # e^{-2πρ} is somewhat below 10^{-digits}; at smaller ρ the smallest term does not measure the
    # error.
    distance = max(digits, 10) / 2.7 + 2.0
    for _ in range(6):
        with mp.workdps(max(digits, DOUBLE) + 15):
            series = RootSeries(exact(v), exact(c), 1 if upper else -1)
            first, last = _summed_labels(series, distance)
            value, rounding = _summed_terms(series, first, last, digits)
            tail_bound = mp.mpf(0)
            for label, side in ((first, -1), (last, 1)):
                tail, bound = tail_sum(series, label, side, math.ceil(3.2 * distance))
                value, tail_bound = value + tail, tail_bound + bound
        if tail_bound <= mp.mpf(10) ** (-digits):
            break
        distance *= 1.3
    value = complex(value) if digits <= DOUBLE else value
    terms = last - first + 1
    return KineticSum(
        value=value,
        error=stated(rounding + tail_bound),
        terms=terms,
        method="series",
        seconds=perf_counter() - start,
        digits=digits,
    )


def _summed_labels(series: RootSeries, distance: float) -> tuple[int, int]:
    """Return the labels at which the tails begin, ``distance`` from every singularity of t."""
    first, last = -2.0, 2.0
    for nu in _singularities(series):
        if abs(nu.imag) < distance:
            reach = math.sqrt(distance**2 - nu.imag**2)
            first, last = min(first, nu.real - reach), max(last, nu.real + reach)
    largest = MAX_ROOTS if mp.mp.dps <= DOUBLE + 15 else _MAX_PRECISE_ROOTS
    if last - first > largest:
        raise PrecisionError(
            f"the series at v = {mp.nstr(series.v, 6)}, c = {mp.nstr(series.c, 6)} needs "
            f"{last - first:.3g} roots one by one, more than {largest}; use the method integral."
        )
    return math.floor(first), math.ceil(last)


def _singularities(series: RootSeries) -> Iterator[complex]:
    """Yield the points ν at which t(ν) is singular: k = 0, S = 0, S = ±iα."""
    i, sign = mp.mpc(0, 1), series.sign
    q_turn = mp.sqrt(4 - series.alpha**2)
    for q in (series.beta, mp.mpf(2), mp.mpf(-2), q_turn, -q_turn):
        k = (q - series.beta) / series.alpha
        w = mp.acosh(q / 2)
        for image in (w, -w, w + 2j * mp.pi, w - 2j * mp.pi):
            yield complex((k - sign * i * image) / (2 * mp.pi))


def _summed_terms(series: RootSeries, first: int, last: int, digits: int) -> tuple[Any, Any]:
    """Return the sum of t over the labels, the first and last counted half, and its error."""
    labels, upper = np.arange(first, last + 1), series.sign > 0
    if digits <= DOUBLE:
        v, c = float(series.v), float(series.c)
        roots = labelled_roots(v, c, labels, upper)
        slope = -1j * (v + c * np.sin(roots.k))
        terms = 1.0 / (roots.k * slope)
        terms[[0, -1]] *= 0.5
        # Shifting a root by its radius changes 1/(k L_k) by |dt/dk| radius; |L_kk| ≤ c cosh(Im k).
        relative = 1.0 / np.abs(roots.k) + c * np.cosh(roots.k.imag) / np.abs(slope)
        error = float(np.sum(np.abs(terms) * (relative * roots.radius + 1e-15)))
        return mp.mpc(math.fsum(terms.real), math.fsum(terms.imag)), error
    total = mp.mpc(0)
    size = mp.mpf(0)
    for label, k in zip(
        labels, precise_roots(series.v, series.c, labels, upper, mp.mp.dps), strict=True
    ):
        term = 1 / (k * -1j * (series.v + series.c * mp.sin(k)))
        total += term / 2 if label in (first, last) else term
        size += abs(term)
    return total, size * mp.mpf(10) ** (8 - mp.mp.dps)


def tail_sum(series: RootSeries, label: int, side: int, max_terms: int) -> tuple[Any, Any]:
    """Return the sum of t beyond ``label`` on one side, plus half of t there, and its error.

    Euler–Maclaurin: ∫ t dν ∓ Σ_j B_{2j}/(2j) t_{2j-1}, t_j the Taylor coefficients at the label.
    The series is truncated at its smallest term, and thirty times this term is stated as the error.
    That is a bound if ``label`` keeps the distance from the singularities that
    :func:`sum_by_roots` requires, and may fail at smaller distances.
    """
    (k,) = precise_roots(series.v, series.c, np.array([label]), series.sign > 0, mp.mp.dps)
    u = mp.exp(-series.sign * 1j * k)
    half = mp.sqrt(series.beta**2 - 4) / 2
    u1, u2 = series.beta / 2 + half, series.beta / 2 - half
    if abs(u1) < abs(u2):
        u1, u2 = u2, u1
    integral = -mp.log((u - u1) / (u - u2)) / (u1 - u2) / (mp.pi * series.c)
    total = side * series.sign * integral
    smallest = mp.inf
    radius = min(abs(nu - label) for nu in _singularities(series))
    taylor = _taylor(series, k, u - 1 / u, radius, 2 * max_terms)
    for j in range(1, max_terms + 1):
        term = -side * mp.bernoulli(2 * j) / (2 * j) * taylor[2 * j - 1]
        size = abs(term)
        if size > smallest and size > 0:
            break
        total += term
        smallest = size
        if size < mp.mpf(10) ** (-mp.mp.dps):
            break
    return total, 30 * smallest


def _taylor(series: RootSeries, k0: Any, S0: Any, radius: float, order: int) -> list[Any]:
    """Return the Taylor coefficients of t(ν) about a root, from k'(S ∓ iα) = 2πS, S² = q² - 4.

    They are computed in integer arithmetic, which is ten times as fast as mpmath. The units are
    ``k0`` for k and its derivative, ``S0`` for S and q, their first coefficients for d = k(S ∓ iα)
    and t, and the ``radius`` of convergence for ν, so that no coefficient is very large or small.
    """
    shift = -series.sign * 1j * series.alpha / S0
    alpha, start = series.alpha * k0 / S0, (series.alpha * k0 + series.beta) / S0
    largest = max(float(abs(x)) for x in (mp.mpf(1), shift, alpha, start))
    bits = mp.mp.prec + 30 + math.ceil(math.log2(largest)) + 2 * order.bit_length()
    rate = _fixed(2 * mp.pi * radius / (k0 * (1 + shift)), bits)
    inverse, alpha, fixed_shift = (_fixed(x, bits) for x in (1 / (1 + shift), alpha, shift))
    k, S, d, t = ([(1 << bits, 0)] for _ in range(4))
    slope, q = [(0, 0)], [_fixed(start, bits)]
    for m in range(1, order + 1):
        x, y = _times(rate, S[-1], bits), _times(inverse, _dot(slope[1:], S[:0:-1], bits), bits)
        slope.append((x[0] - y[0], x[1] - y[1]))
        k.append((slope[m][0] // m, slope[m][1] // m))
        q.append(_times(alpha, k[m], bits))
        x, y = _dot(q, q[::-1], bits), _dot(S[1:], S[:0:-1], bits)
        S.append(((x[0] - y[0]) // 2, (x[1] - y[1]) // 2))
        x, y = _dot(k, S[::-1], bits), _times(fixed_shift, k[m], bits)
        d.append(_times(inverse, (x[0] + y[0], x[1] + y[1]), bits))
        x = _dot(d[1:], t[::-1], bits)
        t.append((-x[0], -x[1]))
    unit = series.sign * 2 / (series.c * k0 * S0 * (1 + shift))
    found = []
    for re, im in t:
        found.append(unit * mp.mpc(mp.ldexp(re, -bits), mp.ldexp(im, -bits)))
        unit /= radius
    return found


def _fixed(z: Any, bits: int) -> Fixed:
    """Return the integers nearest to Re z and Im z in units of 2^-bits."""
    with mp.workprec(mp.mp.prec + bits):
        return int(mp.nint(mp.ldexp(z.real, bits))), int(mp.nint(mp.ldexp(z.imag, bits)))


def _times(x: Fixed, y: Fixed, bits: int) -> Fixed:
    """Return xy."""
    return _dot([x], [y], bits)


def _dot(x: list[Fixed], y: list[Fixed], bits: int) -> Fixed:
    """Return the sum of the products of the elements of two lists, rounded once."""
    if not x:
        return 0, 0
    (x_re, x_im), (y_re, y_im) = zip(*x, strict=True), zip(*y, strict=True)
    re = sum(map(mul, x_re, y_re)) - sum(map(mul, x_im, y_im))
    im = sum(map(mul, x_re, y_im)) + sum(map(mul, x_im, y_re))
    return re >> bits, im >> bits
