"""Σ(v, c) and its derivatives in ball arithmetic: proven radii (optional: python-flint).

The integrand is that of ``theory.piecewise.sums.integral``. With X = sin²(k/2), A = ½ - 2icX,
a = A/v, E = e^{-a}, F = 1 - E and D = F² + 4XE,

    Σ + 1 = mean over a period of G,       G = S/(2A),           S = F (2 - F)/D,
    ∂S/∂a = 2E [2X(1 + E²) - F²]/D²,       ∂²S/∂a² = 2E (1 - E²)[F² - 2X(1 + E²) - 8X(1 - X)E]/D³,
    G_v = -S_a/(2v²),   G_vv = S_a/v³ + S_aa A/(2v⁴),   G_c = iX S/A² - iX S_a/(A v).

Truncation. Let c sinh σ + vσ < ½ and |Im k| ≤ σ. There

    Re A ≥ g = ½ - c sinh σ > 0,   Re(a ± ik) ≥ 2p = (g - vσ)/v > 0,   |A| ≤ ½ + c(1 + cosh σ),

and S = ½[coth((a + ik)/2) + coth((a - ik)/2)], so that |coth z| ≤ coth Re z and
|csch z| ≤ 1/sinh Re z bound |S| by coth p, |S_a| by ½ csch² p and |S_aa| by ½ csch² p coth p.
If |G| ≤ M in this strip, N equispaced points give its mean to within 2M/(e^{Nσ} - 1) (Trefethen &
Weideman 2014). All of it, the bound too, is evaluated in balls, so v and c may be balls themselves:
the result then holds for every v and c in them.

Where the strip is so narrow that N would be many thousands, the integral over half a period is
taken by the adaptive Gauss-Legendre rule of Arb, whose bound is proven as well (Johansson 2018).

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
from time import perf_counter
from typing import Any

import mpmath as mp

from theory.parameters import count_within
from theory.piecewise.certified_roots import ball_arithmetic
from theory.piecewise.dispersion import root_free_strip
from theory.piecewise.roots import checked_velocity_and_coupling
from theory.piecewise.sums.result import DOUBLE, MAX_DIGITS, KineticSum, PrecisionError, stated

MAX_POINTS = 2000
"""Equispaced points up to which they are taken; beyond, the adaptive rule."""
MAX_EVALUATIONS = 150_000
"""Values of the integrand in the adaptive rule, at most: a few seconds."""
_PARTS = (0.6, 0.75, 0.88, 0.95)  # of the strip, on which G is bounded
_GUARD_BITS = 32
_PARTIALS = (1, 3, 4)
"""How many of Σ, ∂Σ/∂v, ∂Σ/∂c and ∂²Σ/∂v² are computed, by order."""


@dataclass(frozen=True)
class BallSum:
    """Σ and those of its derivatives that were asked for, each a ball of flint.

    Attributes
    ----------
    value : acb
        Σ(v, c).
    by_v, by_c, by_vv : acb or None
        Derivatives.
    points : int
        Points at which the integrand was evaluated.
    """

    value: Any
    by_v: Any
    by_c: Any
    by_vv: Any
    points: int


def certified_sum(v: float | str, c: float | str, digits: int = DOUBLE) -> KineticSum:
    """Return Σ(v, c) of Eq. (53) with a proven radius.

    Parameters
    ----------
    v, c : float or str
        Front velocity v̂ and coupling, dimensionless, from 1e-12 to 1e12; a float is the exact
        binary number, a string is read as a decimal, digit for digit.
    digits : int
        Required digits after the point, from 1 to 2000.

    Returns
    -------
    KineticSum
        ``error`` is the radius of a ball that provably holds Σ, the rounding of ``value`` included.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    MissingPackageError
        If python-flint is not installed.
    PrecisionError
        If the radius could not be reached with some 10⁵ values of the integrand.

    Examples
    --------
    >>> found = certified_sum("0.3", "0.5", 30)
    >>> print(mp.nstr(found.value, 15), found.error < 1e-30)
    (-0.288796756190252 + 0.452268758749395j) True
    """
    start = perf_counter()
    digits = count_within("digits", digits, 1, MAX_DIGITS)
    v_float, c_float = checked_velocity_and_coupling(float(v), float(c))
    flint = ball_arithmetic("a certified sum")
    # Arguments of the exponential as large as c/v, and differences as small as 1/v.
    lost = math.log2(1.0 + c_float / v_float) + 2.0 * math.log2(1.0 + v_float + 1.0 / c_float)
    bits = math.ceil(3.33 * max(digits, DOUBLE)) + math.ceil(lost) + _GUARD_BITS
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
    """Return an upper bound of a ball as a number of mpmath."""
    return mp.make_mpf(ball.upper()._mpf_)


def _any_strip(flint: Any, v: Any, c: Any, tolerance: float, digits: int) -> BallSum:
    """Return Σ by its limit at v = 0, by equispaced points, or by the adaptive rule."""
    away = (-1 / (2 * v)).exp()
    distance = (2 * away / (1 - away)).upper()  # theory.piecewise.limits.static_sum_distance
    if distance < flint.arb(10) ** (-digits - 1):
        ball = flint.arb(0, distance)
        return BallSum(ball_static_sum(flint, c) + flint.acb(ball, ball), None, None, None, 0)
    # Beyond 300 digits the tolerance is no float; digits and points are then in proportion.
    scale = max(1.0, digits / 300.0)
    points, part = needed_points(float(v), float(c), tolerance)
    if points * scale <= MAX_POINTS * max(1.0, digits / DOUBLE):
        count = 2 * math.ceil(0.5 * points * scale * (1.0 + 0.02 * (scale > 1.0)))
        return ball_sum(flint, v, c, count, part)
    return _adaptive(flint, v, c, flint.arb(10) ** (-digits - 5))


def ball_static_sum(flint: Any, c: Any) -> Any:
    """Return Σ(0⁺, c) = 4ic/(q (1 + q)), q = √(1 - 4ic), as a ball."""
    q = flint.acb(1, -4 * c).sqrt()
    return flint.acb(0, 4 * c) / (q * (1 + q))


def _adaptive(flint: Any, v: Any, c: Any, goal: Any) -> BallSum:
    """Return Σ by the adaptive Gauss-Legendre rule on half a period, with G of the two coth."""
    evaluated = 0

    def integrand(k: Any, _analytic: bool) -> Any:
        nonlocal evaluated
        evaluated += 1
        A = flint.acb(0.5) - flint.acb(0, 2) * c * (k / 2).sin() ** 2
        a, ik = A / v, flint.acb(0, 1) * k
        return (((a + ik) / 2).coth() + ((a - ik) / 2).coth()) / (4 * A)

    pi = flint.arb.pi()
    integral = flint.acb.integral(
        integrand, 0, pi, rel_tol=goal, abs_tol=goal, eval_limit=MAX_EVALUATIONS
    )
    return BallSum(integral / pi - 1, None, None, None, evaluated)


def needed_points(v: float, c: float, tolerance: float, order: int = 0) -> tuple[int, float]:
    """Return an even number of points for a truncation error near ``tolerance``, and the strip.

    A guess in floating point, rounded up to a few sizes: what the points give is proven after.

    Parameters
    ----------
    v, c : float
        The largest velocity and coupling meant.
    tolerance : float
        Required absolute error.
    order : int
        0 for Σ alone, 1 with first derivatives, 2 with ∂²Σ/∂v².

    Returns
    -------
    points, half_width : int, float
        Even number of points, and half-width of the strip on which the integrand is bounded.
    """
    strip = root_free_strip(v, c)
    best = (math.inf, 0.0)
    for part in _PARTS:
        sigma = part * strip
        gap = 0.5 - c * math.sinh(sigma)
        p = 0.5 * (gap - v * sigma) / v
        coth, square = 1.0 / math.tanh(p), math.sinh(min(p, 300.0)) ** -2
        side = 1.0 + math.cosh(sigma)
        peaks = _peaks(v, c, gap, coth=coth, square=square, side=side)
        peak = max(peaks[: _PARTIALS[order]])
        best = min(best, (math.log1p(2.0 * peak / tolerance) / sigma, sigma))
    count, sigma = best
    octave = 2.0 ** math.floor(math.log2(max(count, 8.0)))
    return max(8, 2 * math.ceil(0.5 * octave * math.ceil(8.0 * count / octave) / 8.0)), sigma


def ball_sum(flint: Any, v: Any, c: Any, points: int, sigma: float, *, order: int = 0) -> BallSum:
    """Return Σ and its derivatives by the trapezoidal rule, the truncation in each radius.

    Parameters
    ----------
    flint : module
        python-flint; its working precision is the caller's.
    v, c : arb
        Balls of positive velocities and couplings.
    points : int
        Even number of points over the period.
    sigma : float
        Half-width of a strip without roots for every v and c in the balls. If it is not, the result
        is a ball without bounds.
    order : int
        0 for Σ alone, 1 with ∂Σ/∂v and ∂Σ/∂c, 2 with ∂²Σ/∂v² also.
    """
    totals = [flint.acb(0)] * _PARTIALS[order]
    for j in range(points // 2 + 1):
        X = flint.arb.sin_pi_fmpq(flint.fmpq(j, points)) ** 2
        values = _integrand(flint, v, c, X, order)
        if j in (0, points // 2):
            values = [value / 2 for value in values]
        totals = [total + value for total, value in zip(totals, values, strict=True)]
    means = [
        2 * total / points + flint.acb(flint.arb(0, bound), flint.arb(0, bound))
        for total, bound in zip(
            totals, _truncation(flint, v, c, points, sigma, order=order), strict=True
        )
    ]
    means += [None] * (4 - len(means))
    return BallSum(means[0] - 1, means[1], means[2], means[3], points // 2 + 1)


def _integrand(flint: Any, v: Any, c: Any, X: Any, order: int) -> list[Any]:
    """Return G and, by order, ∂G/∂v and ∂G/∂c, and ∂²G/∂v²."""
    A = flint.acb(0.5, -2 * c * X)
    F = -(-A / v).expm1()
    E = 1 - F
    D = F * F + 4 * X * E
    S = F * (2 - F) / D
    G = S / (2 * A)
    if order == 0:
        return [G]
    EE = 1 + E * E
    turn = 2 * X * EE - F * F
    S_a = 2 * E * turn / (D * D)
    rate = S_a / v
    iX = flint.acb(0, X)
    found = [G, -rate / (2 * v), iX * (S / A - rate) / A]
    if order > 1:
        S_aa = -2 * E * (F * (2 - F)) * (turn + 8 * X * (1 - X) * E) / (D * D * D)
        found.append((rate + S_aa * A / (2 * v * v)) / (v * v))
    return found


def _truncation(flint: Any, v: Any, c: Any, points: int, sigma: float, *, order: int) -> list[Any]:
    """Return the proven truncation errors, as balls whose upper ends count."""
    s = flint.arb(sigma)
    grown = (points * s).expm1()
    gap = flint.arb(0.5) - c * s.sinh()
    p = (gap - v * s) / (2 * v)
    if not p > 0:
        return [flint.arb.pos_inf()] * _PARTIALS[order]
    bounds = _peaks(v, c, gap, coth=p.coth(), square=p.sinh() ** -2, side=1 + s.cosh())
    return [(2 * bound / grown).upper() for bound in bounds[: _PARTIALS[order]]]


def _peaks(v: Any, c: Any, gap: Any, *, coth: Any, square: Any, side: Any) -> list[Any]:
    """Return the bounds of |G|, |G_v|, |G_c| and |G_vv| in a strip, of floats or of balls.

    ``gap`` is g, ``coth`` and ``square`` are coth p and csch² p, ``side`` bounds 2|X|.
    """
    return [
        coth / (2 * gap),
        square / (4 * v * v),
        side * (coth / (2 * gap * gap) + square / (4 * gap * v)),
        square * (0.5 + coth * (0.5 + c * side) / (4 * v)) / v**3,
    ]
