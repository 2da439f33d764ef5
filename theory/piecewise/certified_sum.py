"""Σ(v, c) and its derivatives in ball arithmetic, with proven radii; needs python-flint.

The integrand is that of ``theory.piecewise.sums.integral``. With X = sin²(k/2), A = ½ - 2icX,
a = A/v and q± = 1/(1 - e^{-a ± ik}), so that ∂q/∂a = q(1 - q),

    Σ + 1 = mean over a period of G,       G = S/(2A),       S = q₊ + q₋ - 1,
    G_v = -S_a/(2v²),   G_vv = S_a/v³ + S_aa A/(2v⁴),   G_c = iX S/A² - iX S_a/(A v).

Since a occurs only once in q±, these stay narrow where v and c are balls.

Path. On the real axis e^{-a} oscillates with the phase c(1 - cos k)/v. Where c/v is large, its mean
is much smaller than its modulus, and balls of velocities or couplings lead to balls that are far
too wide. On the path

    z(k) = k + iτ sin k,   Re A = ½ + c sin k sinh(τ sin k),

e^{-a} decays away from k = 0 and π instead. G is even, and the mean of G(z(k)) z'(k) over real k
equals that of G if G has no pole between the axis and the path. There is none where
Re A > v |Im z|, and for |sin k| = s and all τ' ≤ τ, ½ + cs sinh(τ's) - vτ's ≥ ½ - v²τ/(4c).

Truncation. Let |Im k| ≤ σ, and z = κ + iψ. There |ψ| ≤ Ψ = σ + τ cosh σ, |z'| ≤ 1 + τ cosh σ, and

    Re A = ½ + c sin κ sinh ψ ≥ g,   Re(a ± iz) ≥ 2p,   |A| ≤ ½ + c(1 + cosh Ψ),

on the axis (τ = 0) with g = ½ - c sinh σ and 2p = (g - vσ)/v, on the path with g = ½ - cm = 2pv,
where -m is the minimum of sin κ sinh ψ - |ψ| ρ, ρ ≥ v/c. As Re A is harmonic and |ψ| subharmonic,
it lies on Im k = ±σ. Near k = 0 it is -(1 + τ²)²σ²/(4τ), so that the width of the strip scales like
c^{-1/2}, while on the axis it scales only like 1/c. If g and p are positive,
S = ½[coth((a + iz)/2) + coth((a - iz)/2)], |coth w| ≤ coth Re w and |csch w| ≤ 1/sinh Re w bound
|S| by coth p, |S_a| by ½ csch² p and |S_aa| by ½ csch² p coth p. If |G z'| ≤ M in this strip, N
equispaced points give its mean to within 2M/(e^{Nσ} - 1) (Trefethen & Weideman 2014). Everything,
the bound included, is evaluated in balls, so that v and c may be balls themselves: the result then
holds for every v and c in them.

Where the strip is so narrow that N would be many thousands, the integral over half a period is
computed by the adaptive Gauss-Legendre rule of Arb, whose bound is also proven (Johansson 2018).

References
----------
Trefethen, L. N. & Weideman, J. A. C. (2014), The exponentially convergent trapezoidal rule.
Johansson, F. (2017), Arb: efficient arbitrary-precision midpoint-radius interval arithmetic.
Johansson, F. (2018), Numerical integration in arbitrary-precision ball arithmetic.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from time import perf_counter
from typing import Any

import mpmath as mp
import numpy as np

from theory.parameters import count_within, with_ranges
from theory.piecewise.certified_roots import ball_arithmetic
from theory.piecewise.dispersion import root_free_strip
from theory.piecewise.roots import PARAMETERS, checked_velocity_and_coupling
from theory.piecewise.sums.result import DIGITS, DOUBLE, KineticSum, PrecisionError, stated

MAX_POINTS = 2000
"""Largest number of equispaced points; where more would be needed, the adaptive rule is used."""
MAX_EVALUATIONS = 150_000
"""Largest number of values of the integrand in the adaptive rule: a few seconds."""
_STRIP_FRACTIONS = (0.6, 0.75, 0.88, 0.95)  # of the strip, on which G is bounded
_GUARD_BITS = 32
_TAU = 0.5625
"""τ of the path: close to 1/√3, at which the strip is widest, and exact as a binary number."""
_INTERVALS = 1024
_PARTIALS = (1, 3, 4)
"""Number of the quantities Σ, ∂Σ/∂v, ∂Σ/∂c and ∂²Σ/∂v² that are computed at order 0, 1 and 2."""


@dataclass(frozen=True)
class BallSum:
    """Σ and those of its derivatives that were requested, each a ball of python-flint.

    Attributes
    ----------
    value : acb
        Σ(v, c).
    by_v, by_c, by_vv : acb or None
        Its derivatives, or None if they were not requested.
    points : int
        Number of points at which the integrand was evaluated.
    """

    value: Any
    by_v: Any
    by_c: Any
    by_vv: Any
    points: int


@dataclass(frozen=True, kw_only=True)
class Strip:
    """The strip |Im k| ≤ σ in which the integrand is bounded.

    Attributes
    ----------
    half_width : float
        Its half-width σ.
    ratio : float or None
        The parameter ρ ≥ v/c of the curved path; None for the real axis.
    """

    half_width: float
    ratio: float | None = None


@with_ranges(parameters=PARAMETERS, digits=DIGITS)
def certified_sum(v: float | str, c: float | str, digits: int) -> KineticSum:
    """Return Σ(v, c) of Eq. (53) with a proven radius.

    Parameters
    ----------
    v, c : float or str
        Front velocity v̂ and coupling, dimensionless, {parameters}; a float is the exact
        binary number, a string is read as a decimal, digit for digit.
    digits : int
        Required digits after the point, {digits}.

    Returns
    -------
    KineticSum
        ``error`` is the radius of a ball that provably contains Σ, rounding of ``value`` included.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    MissingPackageError
        If python-flint is not installed.
    PrecisionError
        If the radius could not be reached with 150 000 values of the integrand.

    Examples
    --------
    >>> found = certified_sum("0.3", "0.5", 30)
    >>> print(mp.nstr(found.value, 15), found.error < 1e-30)
    (-0.288796756190252 + 0.452268758749395j) True
    """
    start = perf_counter()
    digits = count_within("digits", digits, *DIGITS)
    v_float, c_float = checked_velocity_and_coupling(float(v), float(c))
    flint = ball_arithmetic("a certified sum")
    # Digits are lost by arguments of the exponential as large as c/v, and differences down to 1/v.
    lost_bits = math.log2(1.0 + c_float / v_float) + 2.0 * math.log2(1.0 + v_float + 1.0 / c_float)
    bits = math.ceil(3.33 * max(digits, DOUBLE)) + math.ceil(lost_bits) + _GUARD_BITS
    with flint.ctx.workprec(bits):
        v_, c_ = (flint.arb(flint.fmpq(*Fraction(each).as_integer_ratio())) for each in (v, c))
        found = _any_strip(flint, v_, c_, 10.0 ** -min(digits + 1, 300), digits)
        radius = max(_upper(found.value.real.rad()), _upper(found.value.imag.rad()))
    if not radius <= mp.mpf(10) ** -digits:
        raise PrecisionError(
            f"Sum at v = {v}, c = {c} could not be proven to {digits} digits with "
            f"{MAX_EVALUATIONS} values of the integrand; ask for fewer digits or take the "
            "method series."
        )
    middle = mp.make_mpc((found.value.real.mid()._mpf_, found.value.imag.mid()._mpf_))
    value: Any = middle
    error = radius * mp.sqrt(2)
    if digits <= DOUBLE:
        value = complex(middle)
        error = float(error) * (1 + 1e-15) + abs(value) * 2.3e-16
    return KineticSum(
        value=value,
        error=stated(error),
        terms=found.points,
        method="certified",
        seconds=perf_counter() - start,
        digits=digits,
    )


def _upper(ball: Any) -> Any:
    """Return an upper bound of a ball as an mpmath number."""
    return mp.make_mpf(ball.upper()._mpf_)


def _any_strip(flint: Any, v: Any, c: Any, tolerance: float, digits: int) -> BallSum:
    """Return Σ by its limit at v = 0, by equispaced points, or by the adaptive rule."""
    e = (-1 / (2 * v)).exp()
    distance = (2 * e / (1 - e)).upper()  # theory.piecewise.limits.static_sum_distance
    if distance < flint.arb(10) ** (-digits - 1):
        ball = flint.arb(0, distance)
        return BallSum(ball_static_sum(flint, c) + flint.acb(ball, ball), None, None, None, 0)
    # Beyond 300 digits the tolerance underflows as a float; points then grow in proportion to
    # digits.
    scale = max(1.0, digits / 300.0)
    points, strip = needed_points(float(v), float(c), tolerance)
    if points * scale <= MAX_POINTS * max(1.0, digits / DOUBLE):
        count = 2 * math.ceil(0.5 * points * scale * (1.0 + 0.02 * (scale > 1.0)))
        return ball_sum(flint, v, c, count, strip)
    return _adaptive(flint, v, c, flint.arb(10) ** (-digits - 5))


def ball_static_sum(flint: Any, c: Any) -> Any:
    """Return Σ(0⁺, c) = 4ic/(q (1 + q)), q = √(1 - 4ic), as a ball."""
    q = flint.acb(1, -4 * c).sqrt()
    return flint.acb(0, 4 * c) / (q * (1 + q))


def _adaptive(flint: Any, v: Any, c: Any, tolerance: Any) -> BallSum:
    """Return Σ by the adaptive Gauss-Legendre rule on half a period, G as a sum of two coth."""
    evaluated = 0

    def integrand(k: Any, _analytic: bool) -> Any:
        nonlocal evaluated
        evaluated += 1
        A = flint.acb(0.5) - flint.acb(0, 2) * c * (k / 2).sin() ** 2
        a, ik = A / v, flint.acb(0, 1) * k
        return (((a + ik) / 2).coth() + ((a - ik) / 2).coth()) / (4 * A)

    pi = flint.arb.pi()
    integral = flint.acb.integral(
        integrand, 0, pi, rel_tol=tolerance, abs_tol=tolerance, eval_limit=MAX_EVALUATIONS
    )
    return BallSum(integral / pi - 1, None, None, None, evaluated)


def needed_points(
    v: float, c: float, tolerance: float, order: int = 0, smallest_c: float | None = None
) -> tuple[int, Strip]:
    """Return an even number of points for a truncation error near ``tolerance``, and the strip.

    The number is an estimate in floating point, rounded up so that few different numbers occur; the
    truncation error that it leads to is proven afterwards.

    Parameters
    ----------
    v, c : float
        The largest velocity and coupling in question.
    tolerance : float
        Required absolute error.
    order : int
        0 for Σ alone, 1 to include first derivatives, 2 to include ∂²Σ/∂v² too.
    smallest_c : float, optional
        The smallest coupling in question, by default c.

    Returns
    -------
    points, strip : int, Strip
        Even number of points, and the strip on which the integrand is bounded.
    """
    ratio = v / (c if smallest_c is None else smallest_c)
    digits = math.ceil(-2.0 * math.log10(tolerance))
    return _points_and_strip(_up(v, 8), _up(c, 8), 10.0 ** (-0.5 * digits), order, _up(ratio, 4))


def _up(x: float, steps: int) -> float:
    """Return x rounded up to the next of a geometric sequence with ``steps`` numbers per octave."""
    return math.pow(2.0, math.ceil(steps * math.log2(x) + 1e-9) / steps)


@lru_cache(maxsize=4096)
def _points_and_strip(
    v: float, c: float, tolerance: float, order: int, ratio: float
) -> tuple[int, Strip]:
    width = root_free_strip(v, c)
    strips = [Strip(half_width=fraction * width) for fraction in _STRIP_FRACTIONS]
    if ratio < 1.0:  # else e^{-a} hardly oscillates
        widest = math.floor(4.0 * math.log2(min(1.0, c**-0.5)))
        widths = (2.0 ** ((widest - i) / 4.0) for i in range(12))
        strips += [Strip(half_width=each, ratio=ratio) for each in widths]
    best = (math.inf, strips[0])
    for strip in strips:
        sigma, (m, side, stretch) = strip.half_width, _geometry(strip)
        gap = 0.5 - c * m
        p = 0.5 * (gap - (v * sigma if strip.ratio is None else 0.0)) / v
        if gap > 0.0 < p:
            coth, square = 1.0 / math.tanh(p), math.sinh(min(p, 300.0)) ** -2
            bounds = _bounds_in_strip(v, c, gap, coth=coth, square=square, side=side)
            bound = stretch * max(bounds[: _PARTIALS[order]])
            count = math.log1p(2.0 * bound / tolerance) / sigma
            best = min(best, (count, strip), key=lambda each: each[0])
    count, strip = best
    octave = 2.0 ** math.floor(math.log2(max(count, 8.0)))
    return max(8, 2 * math.ceil(0.5 * octave * math.ceil(8.0 * count / octave) / 8.0)), strip


def _geometry(strip: Strip) -> tuple[float, float, float]:
    """Return m, 1 + cosh Ψ and the bound on |z'| as floats; on the axis m = sinh σ."""
    sigma = strip.half_width
    if strip.ratio is None:
        return math.sinh(sigma), 1.0 + math.cosh(sigma), 1.0
    stretch = _TAU * math.cosh(sigma)
    return _bound_of_m(sigma, strip.ratio), 1.0 + math.cosh(sigma + stretch), 1.0 + stretch


@lru_cache(maxsize=4096)
def _bound_of_m(sigma: float, ratio: float) -> float:
    """Return an upper bound of m, which is minus the minimum of sin κ sinh ψ - |ψ| ρ in |Im k| ≤ σ.

    By the symmetries k → -k and k → π - k it suffices to consider Im k = σ and Re k from -π/2 to
    π/2. The values at the midpoints of pieces are lowered by the largest change within the pieces
    that the first and second derivatives allow.
    """
    half = 0.5 * math.pi / _INTERVALS
    k = (np.arange(_INTERVALS) + 0.5) * 2.0 * half - 0.5 * math.pi + 1j * sigma
    z, rate = k + 1j * _TAU * np.sin(k), 1.0 + 1j * _TAU * np.cos(k)
    stretch = _TAU * math.cosh(sigma)
    second = math.cosh(sigma + stretch) * ((1.0 + stretch) ** 2 + stretch)
    lower_bounds = (1j * np.cos(z)).real - np.abs((1j * np.sin(z) * rate).real) * half
    lower_bounds -= 0.5 * second * half**2 + ratio * (np.abs(z.imag) + stretch * half)
    return max(1e-12 - float(lower_bounds.min()), 0.25 * _TAU * ratio**2) * (1.0 + 1e-12)


def ball_sum(flint: Any, v: Any, c: Any, points: int, strip: Strip, *, order: int = 0) -> BallSum:
    """Return Σ and its derivatives by the trapezoidal rule; the radii include the truncation error.

    Parameters
    ----------
    flint : module
        python-flint; its working precision is the caller's.
    v, c : arb
        Balls of positive velocities and couplings.
    points : int
        Even number of points over the period.
    strip : Strip
        A strip without roots for every v and c in the balls. If it contains roots, the result is
        an unbounded ball.
    order : int
        0 for Σ alone, 1 to include ∂Σ/∂v and ∂Σ/∂c, 2 to include ∂²Σ/∂v² too.
    """
    totals = [flint.acb(0)] * _PARTIALS[order]
    for node in _nodes(flint, points, strip.ratio is not None, flint.ctx.prec):
        values = _integrand(flint, v, c, node, order)
        totals = [total + node.weight * each for total, each in zip(totals, values, strict=True)]
    means = [
        2 * total / points + flint.acb(flint.arb(0, bound), flint.arb(0, bound))
        for total, bound in zip(
            totals, _truncation(flint, v, c, points, strip, order=order), strict=True
        )
    ]
    means += [None] * (4 - len(means))
    return BallSum(means[0] - 1, means[1], means[2], means[3], points // 2 + 1)


@dataclass(frozen=True, kw_only=True)
class _Node:
    """A point z of the path: X, the pairs (e^{±iz}, 1 - e^{±iz}), and the weight z'."""

    X: Any
    phases: tuple[tuple[Any, Any], ...]
    weight: Any


@lru_cache(maxsize=64)
def _nodes(flint: Any, points: int, curved: bool, _precision: int) -> list[_Node]:
    """Return the points of half a period; the two end points have half the weight."""
    found = []
    for j in range(points // 2 + 1):
        half_turns, tau = flint.fmpq(2 * j, points), flint.arb(_TAU if curved else 0.0)
        k = flint.arb.pi() * 2 * j / points
        z = flint.acb(k, tau * flint.arb.sin_pi_fmpq(half_turns))
        weight = flint.acb(1, tau * flint.arb.cos_pi_fmpq(half_turns))
        ends = 2 if j in (0, points // 2) else 1
        phases = tuple((w.exp(), -w.expm1()) for w in (flint.acb(0, 1) * z, flint.acb(0, -1) * z))
        found.append(_Node(X=(z / 2).sin() ** 2, phases=phases, weight=weight / ends))
    return found


def _integrand(flint: Any, v: Any, c: Any, node: _Node, order: int) -> list[Any]:
    """Return G and, by order, ∂G/∂v and ∂G/∂c, and ∂²G/∂v²."""
    iX = flint.acb(0, 1) * node.X
    A = 0.5 - 2 * c * iX
    F = -(-A / v).expm1()
    q = [1 / (complement + F * phase) for phase, complement in node.phases]
    S = q[0] + q[1] - 1
    G = S / (2 * A)
    if order == 0:
        return [G]
    by_a = [each * (1 - each) for each in q]
    S_a_over_v = (by_a[0] + by_a[1]) / v
    found = [G, -S_a_over_v / (2 * v), iX * (S / A - S_a_over_v) / A]
    if order > 1:
        S_aa = sum(by * (1 - 2 * each) for by, each in zip(by_a, q, strict=True))
        found.append((S_a_over_v + S_aa * A / (2 * v * v)) / (v * v))
    return found


def _truncation(flint: Any, v: Any, c: Any, points: int, strip: Strip, *, order: int) -> list[Any]:
    """Return proven bounds of the truncation errors, namely the upper ends of balls."""
    s = flint.arb(strip.half_width)
    growth = (points * s).expm1()
    if strip.ratio is None:
        gap, side, stretch = flint.arb(0.5) - c * s.sinh(), 1 + s.cosh(), 1
        p = (gap - v * s) / (2 * v)
    else:
        gap = flint.arb(0.5) - c * flint.arb(_bound_of_m(strip.half_width, strip.ratio))
        stretch = 1 + flint.arb(_TAU) * s.cosh()
        side = 1 + (s + stretch - 1).cosh()
        p = gap / (2 * v) if flint.arb(strip.ratio) * c >= v else flint.arb(-1)
    if not p > 0:
        return [flint.arb.pos_inf()] * _PARTIALS[order]
    bounds = _bounds_in_strip(v, c, gap, coth=p.coth(), square=p.sinh() ** -2, side=side)
    return [(2 * stretch * bound / growth).upper() for bound in bounds[: _PARTIALS[order]]]


def _bounds_in_strip(v: Any, c: Any, gap: Any, *, coth: Any, square: Any, side: Any) -> list[Any]:
    """Return bounds on |G|, |G_v|, |G_c| and |G_vv| in a strip, from floats or from balls.

    ``gap`` is g, ``coth`` and ``square`` are coth p and csch² p, ``side`` bounds 2|X|.
    """
    return [
        coth / (2 * gap),
        square / (4 * v * v),
        side * (coth / (2 * gap * gap) + square / (4 * gap * v)),
        square * (0.5 + coth * (0.5 + c * side) / (4 * v)) / v**3,
    ]
