"""Σ(v, c) by two trapezoidal rules whose cost depends on neither v nor c; one value at a time.

With X = sin²(k/2), A = ½ - 2icX, a = A/v, Σ = -1 + (1/2π)∫G dk over a period, G = S/2A,
S = sinh a/(cosh a - cos k) (mathematics of ``theory.piecewise.sums.integral``). Where the roots of
(50) lie near a path, their effect on the trapezoidal rule is known exactly: a pole u_p above a path
with nodes (j + δ)h changes the rule by 2πi Res/(e^{2πi(δ - u_p/h)} - 1), which is taken away. The
number of points is then what the next poles ask for. With ρ = c/v:

* ρ ≤ 3: N points midway between multiples of 2π/N on the real axis. Of the roots, that nearest
  k = -i/2v is taken away, and from ρ = 1 the pair that meets where the front is in resonance with
  a linear wave. What is left, G̃, has |G̃| ≤ M/(1 + c) on the lines |Im k| = σ(ρ),
  M = 1 with the pair taken away and 2.5 without.
* ρ > 3: the path is bent to where A grows. With X = iY, Y = u²v/2c ≥ 0, A = ½ + vu² is real, and
  S - 1 falls like e^{-u²}; k runs from 0 to π/2 + i∞. From there it returns to π along X = 1 - iȲ,
  where S is the same function but for a phase ψ = 2c/v - π of e^{-a}. The 1 that was subtracted
  from S gives 1/√(1 - 4ic). Four roots at most lie near each of the two legs; with them taken away,
  the integral of what is left along |Im u| = 1.6 is below `_leg_size`.

The bounds of what is left were found by sampling it over the whole range (a test repeats that);
given them, the error bounds follow by the theorem on the trapezoidal rule in a strip. Below
v = 0.08 no root is near, and on the real axis the bound is proved (`plain_points`).

Everything here is plain Python on numbers and compiles as it stands
(``theory.piecewise.sums.compiled``); neither needs the other.

References
----------
Trefethen, L. N. & Weideman, J. A. C. (2014), The exponentially convergent trapezoidal rule.
McNamee, J. (1964), Error-bounds for the evaluation of integrals by the Euler-Maclaurin formula and
by Gauss-type formulae.
"""

from __future__ import annotations

import cmath
import math
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import numpy.typing as npt

    from theory.piecewise.dispersion import ComplexArray, FloatArray

    IntArray = npt.NDArray[np.int64]

_TURN = 2.0 * math.pi
_EPS = 2.0**-52
_EIGHTH = cmath.exp(0.25j * math.pi)
SLOWEST = 0.08
"""Below this velocity no root is near a path."""
STEEPEST = 3.0
"""Largest c/v on the real axis."""
_PAIR_FROM = 1.0
MAX_PLAIN = 400
"""Points that are computed sooner than the roots that would save some of them."""
_MAX_POINTS = 2.0**40
"""Of the plain rule, in a compiled integer; so many are never taken."""
_DEPTH = 1.6
_BLOCK = 256
_PI = (math.floor(math.pi * 2.0**28) / 2.0**28, math.pi % 2.0**-28, math.sin(math.pi))
"""π in three parts; n times the first has no rounding for n up to 2²³."""
_SINE = tuple((-1) ** n / math.factorial(2 * n + 1) for n in range(8))
_COSINE = tuple((-1) ** n / math.factorial(2 * n) for n in range(9))
SLOPE_SHARE = 10.0
"""Truncation of the derivatives by ln v and ln c, over that of Σ, at most."""


def root_near(start: complex, q: float, psi: float, rho: float) -> tuple[complex, complex, complex]:
    """Return p with q + iψ - iρ(1 - cos p) - ip = 0 near ``start``, sin(p/2) and cos(p/2).

    Euler's iteration of third order, which bears two roots close together. q = 1/2v; with ψ = 0
    this is L(p)/v = 0.
    """
    p = start
    sine, cosine = cmath.sin(0.5 * p), cmath.cos(0.5 * p)
    for _ in range(12):
        square = 2.0 * rho * sine * sine
        value = q + 1j * (psi - square - p)
        first, second = -1j * (1.0 + 2.0 * rho * sine * cosine), 1j * (square - rho)
        root = cmath.sqrt(first * first - 2.0 * value * second)
        if (root * first.conjugate()).real < 0.0:
            root = -root
        step = -2.0 * value / (first + root)
        p += step
        size = abs(step)
        if size * size * size * rho <= 1e-18 * abs(first) * abs(p):
            turn = 0.5 * step
            near, far = 1.0 - 0.5 * turn * turn, turn - turn * turn * turn / 6.0
            return p, sine * near + cosine * far, cosine * near - sine * far
        sine, cosine = cmath.sin(0.5 * p), cmath.cos(0.5 * p)
    return p, sine, cosine


def two_roots_near(q: float, psi: float, rho: float) -> tuple[complex, complex]:
    """Return starting points for the two roots of q + iψ - iρ(1 - cos p) - ip = 0 nearest p = 0.

    Those of its second-order expansion, about 0, or where the two nearly meet (resonance with a
    linear wave) about the point between them, where the slope vanishes; the smaller one first.
    """
    w = 1.0 / rho
    square = w * w + 2.0 * w * (psi - 1j * q)
    if abs(square) < 0.2 * w * w:
        k = -math.asin(w)
        value = q + 1j * (psi - rho * (1.0 - math.cos(k)) - k)
        apart = cmath.sqrt(-2j * value / (rho * math.cos(k)))
        return k + apart, k - apart
    root = cmath.sqrt(square)
    far = -w - root if root.real >= 0.0 else -w + root
    return 2j * w * (q + 1j * psi) / far, far


def resonant_pair(q: float, rho: float) -> tuple[complex, complex]:
    """Return starting points for the roots above and below the axis that meet in resonance."""
    if q > 1.0:  # cos p = 1 + (p + iq)/ρ, a fixed point on the branch of each
        above, below = -1.8 + 2j, -3.5 - 1.5j
        for _ in range(2):
            above = -cmath.acos(1.0 + (above + 1j * q) / rho)
        for _ in range(3):
            z = 1.0 + (below + 1j * q) / rho
            below = cmath.acos(z) - _TURN if z.imag > 0.0 else -cmath.acos(z)
        return above, below
    k = -2.33 if rho < 1.5 else math.asin(1.0 / rho) - math.pi
    value = q - 1j * (rho * (1.0 - math.cos(k)) + k)
    first, second = -1j * (1.0 + rho * math.sin(k)), -1j * rho * math.cos(k)
    root = cmath.sqrt(first * first - 2.0 * value * second)
    one, other = k + (root - first) / second, k - (root + first) / second
    if one.imag > other.imag:
        return one, other
    return other, one


def effect_of_root(
    root: tuple[complex, complex, complex], wave: complex, v: float, c: float,
    z: complex, turn: complex, sign: float, slopes: bool,
) -> tuple[complex, complex, complex, float, float]:  # fmt: skip
    """Return tW, t = 1/(wave L_k), W = 1/(sign e^z - 1), its derivatives, and two roundings.

    Parameters
    ----------
    root : tuple of complex
        A root p from where its path begins, sin(p/2) and cos(p/2).
    wave : complex
        The same root from k = 0, where it is p itself on the path that begins there.
    z, turn : complex
        Exponent, and its derivative by p.

    Returns
    -------
    value, by_v, by_c : complex
        And the derivatives by v and c at fixed nodes.
    shift, gain : float
        A relative error δ of the terms of L changes the value by at most ``shift`` δ, and the
        derivatives by ln v and ln c by at most ``gain`` δ.
    """
    p, half, cos_half = root
    sine = 2.0 * half * cos_half
    slope = v + c * sine
    t = 1j / (wave * slope)
    weight = 1.0 / (sign * cmath.exp(z) - 1.0) if z.real < 600.0 else 0j
    value, turned = t * weight, -t * weight * (1.0 + weight) * turn
    onsite = 2.0 * half * half if wave == p else -2.0 * cos_half * cos_half  # i∂L/∂c
    cosine = 1.0 - 2.0 * half * half
    steep = abs(slope)
    move = (0.5 + abs(wave) * v + c * abs(onsite)) / steep
    along = 1.0 / abs(wave) + c * abs(cosine) / steep
    size = abs(value)
    shift = size * (move * along + (v + c * abs(sine)) / steep) + 2.0 * abs(turned) * move
    if not slopes or size < 1e-17:
        return value, 0j, 0j, shift, 0.0
    p_v, p_c = -wave / slope, -onsite / slope
    value_v = turned * p_v - value * (p_v / wave + (1.0 + c * cosine * p_v) / slope)
    value_c = turned * p_c - value * (p_c / wave + (sine + c * cosine * p_c) / slope)
    gain = 2.0 * shift * (1.0 + move * (along + abs(turn) * (1.0 + 2.0 * abs(weight))))
    return value, value_v, value_c, shift, gain


def _points_for(bound: float, tolerance: float, depth: float) -> int:
    """Return the even N with 2 bound/(e^{N depth} - 1) ≤ tolerance."""
    return max(6, 2 * math.ceil(0.5 * math.log1p(2.0 * bound / tolerance) / depth))


def plain_points(v: float, c: float, tolerance: float) -> tuple[int, float]:
    """Return N with no root taken away, at most some 10¹², and the bound, proved.

    N is a multiple of 4, and up to an eighth larger than it need be so that few different N occur.

    On |Im k| ≤ σ < s, c sinh s + vs = ½, both Re A ≥ ½ - c sinh σ and Re(a ± ik) ≥ d/v with
    d = ½ - c sinh σ - vσ > 0, and S is the mean of coth((a ± ik)/2). So |G| ≤
    coth(d/2v)/(1 - 2c sinh σ).
    """
    strip = 0.5 / (c + v)
    if strip < 0.1:  # s is smaller by less than 0.2 per cent
        strip *= 0.88
        sinh = strip * (1.0 + 0.2 * strip * strip)
    else:
        strip = min(strip, math.log1p(1.0 / c))
        for _ in range(3):  # from above, to within 0.5 per cent
            grown = math.exp(strip)
            back = 1.0 / grown
            strip -= (c * (grown - back) + 2.0 * v * strip - 1.0) / (c * (grown + back) + 2.0 * v)
        strip *= 0.88
        grown = math.exp(strip)
        sinh = 0.5 * (grown - 1.0 / grown)
    gap = 0.5 - c * sinh
    lost = -math.expm1(strip - gap / v)
    peak = (2.0 - lost) / (lost * 2.0 * gap)
    wanted = min(math.log(1.0 + 2.0 * peak / tolerance) / strip, _MAX_POINTS)
    unit = 4.0
    while wanted > 16.0 * unit:
        unit *= 2.0
    count = max(8, int(unit * math.ceil(wanted / unit)))
    return count, 2.0 * peak / math.expm1(count * strip)


def is_plain(v: Any, c: Any, count: Any) -> Any:
    """Return whether points on the real axis alone are the fastest rule, or the only one."""
    return (count <= MAX_PLAIN) | ((v < SLOWEST) & (c <= STEEPEST * v))


def quotient(x: Any, y: Any) -> Any:
    """Return x/y; compiled without the branches of a complex division."""
    return x / y


def quotient_without_branches(x: complex, y: complex) -> complex:
    """Return x/y where |y|² is neither too large nor too small for a number."""
    return x * y.conjugate() * (1.0 / (y.real * y.real + y.imag * y.imag))


def integrand(E: Any, a: Any, X4: Any) -> Any:
    """Return S/a = 2vG, E = e^{-a} and X4 = 4 sin²(k/2): of numbers, arrays, or compiled."""
    F = 1.0 - E
    return quotient(F + E * F, (F * F + X4 * E) * a)


def integrand_and_slopes(E: Any, a: Any, X4: Any) -> tuple[Any, Any, Any]:
    """Return S/a, S_a = -2v² ∂G/∂v, and (S_a - S/a) X4/a = 4iv² ∂G/∂c; see `integrand`."""
    F = 1.0 - E
    D = F * F + X4 * E
    inverse = quotient(1.0, D * a)
    g, over_D = (F + E * F) * inverse, a * inverse
    S_a = E * (X4 * (1.0 + E * E) - 2.0 * F * F) * over_D * over_D
    return g, S_a, (S_a - g) * X4 * (D * inverse)


@lru_cache(maxsize=256)
def _nodes(count: int) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Return X4 and -X4 i/2 at half of ``count`` points, the others being mirrored; and weights."""
    half = (np.arange(count // 2) + 0.5) * (math.pi / count)
    X4 = 4.0 * np.sin(half) ** 2 + 0j
    return X4, -0.5j * X4, np.full(count // 2, 2.0 / count + 0j)


def axis_means(v: Any, c: Any, count: int, slopes: bool) -> tuple[Any, Any, Any, Any, Any]:
    """Return the mean of G, ∂G/∂v, ∂G/∂c over the points, and rms of |G| and |∂G/∂ ln v|.

    v and c are numbers, or arrays whose last axis has length one, and is summed over.
    """
    X4, turn, weights = _nodes(count)
    single = isinstance(v, float)
    dot = np.vdot if single else np.vecdot  # without threads
    a = turn * (c / v) + 0.5 / v
    E = np.exp(-a)
    q = 0.5 / (v if single else v[..., 0])
    if not slopes:
        g = integrand(E, a, X4)
        return dot(weights, g) * q, 0j, 0j, (dot(g, g).real * (2.0 / count)) ** 0.5 * q, 0.0
    g, S_a, h = integrand_and_slopes(E, a, X4)
    return (
        dot(weights, g) * q,
        dot(weights, S_a) * (-2.0 * q * q),
        dot(weights, h) * (-1j * q * q),
        (dot(g, g).real * (2.0 / count)) ** 0.5 * q,
        (dot(S_a, S_a).real * (2.0 / count)) ** 0.5 * (2.0 * q),
    )


def axis_means_of_one(
    v: float, c: float, count: int, slopes: bool
) -> tuple[complex, complex, complex, float, float]:
    """Return what `axis_means` does, for numbers, as a loop: what the compiled rules call."""
    by_v, by_c, total, squares, steep = 0j, 0j, 0j, 0.0, 0.0
    q = 0.5 / v
    for j in range(count // 2):
        half = math.sin((j + 0.5) * (math.pi / count))
        X4 = 4.0 * half * half
        a = complex(q, -X4 * q * c)
        E = cmath.exp(-a)
        if slopes:
            g, S_a, h = integrand_and_slopes(E, a, X4)
            by_v += S_a
            by_c += h
            steep += S_a.real * S_a.real + S_a.imag * S_a.imag
        else:
            g = integrand(E, a, X4)
        total += g
        squares += g.real * g.real + g.imag * g.imag
    weight = 2.0 / count
    return (
        total * (weight * q),
        by_v * (-2.0 * weight * q * q),
        by_c * (-1j * weight * q * q),
        math.sqrt(weight * squares) * q,
        math.sqrt(weight * steep) * (2.0 * q),
    )


def _cosine_and_sine(theta: float) -> tuple[float, float]:
    """Return both for 0 ≤ θ < 2²³, to 2e-16 beside the rounding of θ.

    Points on the axis are few for larger θ only where v < 1e-4, and e^{-a} is zero.
    Taylor's series of half of what is left of θ beside nπ, without branches: loops vectorise.
    """
    n = np.rint(theta * (1.0 / math.pi))
    h = 0.5 * (((theta - n * _PI[0]) - n * _PI[1]) - n * _PI[2])
    s = h * h
    sine, cosine = _SINE[-1], _COSINE[-1]
    sine = _SINE[6] + s * sine
    sine = _SINE[5] + s * sine
    sine = _SINE[4] + s * sine
    sine = _SINE[3] + s * sine
    sine = _SINE[2] + s * sine
    sine = _SINE[1] + s * sine
    sine = h + h * (s * sine)
    cosine = _COSINE[7] + s * cosine
    cosine = _COSINE[6] + s * cosine
    cosine = _COSINE[5] + s * cosine
    cosine = _COSINE[4] + s * cosine
    cosine = _COSINE[3] + s * cosine
    cosine = _COSINE[2] + s * cosine
    cosine = 1.0 + s * (s * cosine - 0.5)
    sign = 1.0 - 2.0 * abs(n - 2.0 * np.rint(0.5 * n))
    return sign * (1.0 - 2.0 * sine * sine), sign * (2.0 * sine * cosine)


def _add_values(X: float, at: FloatArray, sums: FloatArray) -> None:
    """Add Re and Im of S/a, and its |.|², at X and at 1 - X; ``at`` are rows from `_prepared`."""
    q, turn, decay, P_re, P_im = at[0], at[1], at[2], at[3], at[4]
    re, im, squares = sums[0], sums[1], sums[2]
    for i in range(turn.size):
        theta = turn[i] * X
        x, y = _cosine_and_sine(theta)
        E = complex(decay[i] * x, decay[i] * y)
        g = integrand(E, complex(q[i], -theta), 4.0 * X)
        E = complex(P_re[i] * x + P_im[i] * y, P_im[i] * x - P_re[i] * y)
        h = integrand(E, complex(q[i], theta - turn[i]), 4.0 - 4.0 * X)
        re[i] += g.real + h.real
        im[i] += g.imag + h.imag
        squares[i] += g.real * g.real + g.imag * g.imag + h.real * h.real + h.imag * h.imag


def _slopes_at(X: float, q: float, turn: float, decay: float) -> tuple[complex, complex]:
    """Return the last two that `integrand_and_slopes` returns, at X."""
    theta = turn * X
    x, y = _cosine_and_sine(theta)
    E = complex(decay * x, decay * y)
    _, S_a, h = integrand_and_slopes(E, complex(q, -theta), 4.0 * X)
    return S_a, h


def _add_slopes(X: float, at: FloatArray, sums: FloatArray) -> None:
    """Add Re and Im of S_a, |S_a|², and Re and Im of the derivative by c, at X."""
    q, turn, decay = at[0], at[1], at[2]
    for i in range(turn.size):  # two loops: one that writes both is not vectorised
        S_a, _ = _slopes_at(X, q[i], turn[i], decay[i])
        sums[0, i] += S_a.real
        sums[1, i] += S_a.imag
        sums[2, i] += S_a.real * S_a.real + S_a.imag * S_a.imag
    for i in range(turn.size):
        _, h = _slopes_at(X, q[i], turn[i], decay[i])
        sums[3, i] += h.real
        sums[4, i] += h.imag


def _prepared(v: FloatArray, c: FloatArray) -> FloatArray:
    """Return 1/2v, 2c/v, d = e^{-1/2v}, and Re and Im of d e^{2ic/v}, as rows."""
    at = np.empty((5, v.size))
    for i in range(v.size):
        q = 0.5 / v[i]
        turn, decay = 4.0 * q * c[i], math.exp(-q)
        at[0, i], at[1, i], at[2, i] = q, turn, decay
        at[3, i], at[4, i] = decay * math.cos(turn), decay * math.sin(turn)
    return at


def block_values(v: FloatArray, c: FloatArray, count: int) -> FloatArray:
    """Return the means of Re and Im of S/a and of its |.|² as rows.

    For compilation: the loop over values is the inner one. ``count`` must be a multiple of 4.
    """
    means = np.empty((3, v.size))
    for first in range(0, v.size, _BLOCK):
        at = _prepared(v[first : first + _BLOCK], c[first : first + _BLOCK])
        sums = np.zeros((3, at.shape[1]))
        for j in range(count // 4):
            half = math.sin((j + 0.5) * (math.pi / count))
            _add_values(half * half, at, sums)
        for i in range(at.shape[1]):
            for row in range(3):
                means[row, first + i] = sums[row, i] * (2.0 / count)
    return means


def block_slopes(v: FloatArray, c: FloatArray, count: int) -> FloatArray:
    """Return the means of Re, Im and |.|² of S_a, and of Re and Im of (S_a - S/a) X4/a, as rows.

    As `block_values`.
    """
    means = np.empty((5, v.size))
    for first in range(0, v.size, _BLOCK):
        at = _prepared(v[first : first + _BLOCK], c[first : first + _BLOCK])
        sums = np.zeros((5, at.shape[1]))
        for j in range(count // 2):
            half = math.sin((j + 0.5) * (math.pi / count))
            _add_slopes(half * half, at, sums)
        for i in range(at.shape[1]):
            for row in range(5):
                means[row, first + i] = sums[row, i] * (2.0 / count)
    return means


def plan(v: FloatArray, c: FloatArray, tolerance: float) -> tuple[IntArray, FloatArray]:
    """Return what `plain_points` does for arrays, but 0 points where another rule is taken."""
    strip = np.minimum(0.5 / (c + v), np.log1p(1.0 / c))
    for _ in range(3):
        strip -= (c * np.sinh(strip) + v * strip - 0.5) / (c * np.cosh(strip) + v)
    strip *= 0.88
    gap = 0.5 - c * np.sinh(strip)
    lost = -np.expm1(strip - gap / v)
    peak = (2.0 - lost) / (lost * 2.0 * gap)
    wanted = np.minimum(np.log1p(2.0 * peak / tolerance) / strip, _MAX_POINTS)
    unit = 4.0 * np.exp2(np.maximum(np.ceil(np.log2(wanted / 64.0)), 0.0))
    counts = np.maximum(unit * np.ceil(wanted / unit), 8.0)
    truncation = 2.0 * peak / np.expm1(counts * strip)
    return np.where(is_plain(v, c, counts), counts, 0.0).astype(np.int64), truncation


def plain_errors(
    v: Any, c: Any, truncation: Any, size: Any, steep: Any
) -> tuple[Any, Any]:  # fmt: skip
    """Return bounds of the rounding of Σ, and of the errors of v ∂Σ/∂v and c ∂Σ/∂c."""
    phase = 1.0 + np.exp(-0.5 / v) * c / v  # of e^{-a}, which loses digits in it
    rounding = 8.0 * _EPS * (size + 1.0) * phase
    return rounding, SLOPE_SHARE * truncation + 8.0 * _EPS * (1.0 + steep) * phase


def _plain(
    v: float, c: float, count: int, truncation: float, slopes: bool
) -> tuple[complex, complex, complex, float, float, float, int]:
    """Return Σ by points on the real axis, no root taken away; see `sum_at`."""
    value, by_v, by_c, size, steep = axis_means(v, c, count, slopes)
    rounding, rough = plain_errors(v, c, truncation, size, steep)
    return complex(value - 1.0), by_v, by_c, truncation, float(rounding), rough, count // 2


def _real_axis(
    v: float, c: float, tolerance: float, slopes: bool
) -> tuple[complex, complex, complex, float, float, float, int]:
    """Return Σ by points on the real axis and the roots beside it; see `sum_at`."""
    rho, q = c / v, 0.5 / v
    near = root_near(two_roots_near(q, 0.0, rho)[0], q, 0.0, rho)
    paired = rho > _PAIR_FROM
    depth = math.acosh(9.0 / rho - 1.0) - 0.25 if paired else math.acosh(1.7 / rho)
    bound = (1.0 if paired else 2.5) / (1.0 + c)
    count = _points_for(bound, tolerance, depth)
    above, below = near, near
    if paired:
        first, second = resonant_pair(q, rho)
        above, below = root_near(first, q, 0.0, rho), root_near(second, q, 0.0, rho)
        for _ in range(4):
            if _at_a_point(above[0], count) or _at_a_point(-below[0], count):
                count += 2
    value, by_v, by_c, size, steep = axis_means(v, c, count, slopes)
    value -= 1.0
    shifts, gains = 0.0, 0.0
    for i in range(3 if paired else 1):
        root = near if i == 0 else above if i == 1 else below
        side = 1.0 if root[0].imag > 0.0 else -1.0
        turn = -1j * side * count
        found = effect_of_root(root, root[0], v, c, turn * root[0], turn, -1.0, slopes)
        value -= side * found[0]
        by_v -= side * found[1]
        by_c -= side * found[2]
        shifts += found[3]
        gains += found[4]
    truncation = 2.0 * bound / math.expm1(count * depth)
    rounding = 8.0 * _EPS * (size + 1.0 + shifts)
    rough = SLOPE_SHARE * truncation + 8.0 * _EPS * (1.0 + steep + gains)
    return value, by_v, by_c, truncation, rounding, rough, count // 2


def _at_a_point(k: complex, count: int) -> bool:
    """Return whether a root k above the axis is so near a point of the rule that digits go."""
    return k.imag * count < 3.0 and abs(1.0 + cmath.exp(-1j * count * k)) < 0.5


def _leg_size(rho: float, far: float, second: bool) -> float:
    """Bound (1/π) ∫|g̃| du along Im u = 1.6, where ``far`` is |2A| at u = 0."""
    return (3.0 if not second else 6.0 if rho > 6.3 else 130.0) / (math.sqrt(rho) * far)


def _leg_nodes(
    tolerance: float, v: float, rho: float, far: float, second: bool
) -> tuple[float, int, float]:
    """Return the step, the number of nodes, and the bound of the error, both ends included.

    Beyond u = U ≥ √3 the terms are below 2.7 (1 + 2Y) e^{-q - u²} √m/|A|.
    """
    size = _leg_size(rho, far, second)
    wanted = math.log1p(1.5 * size / tolerance)
    step = _TURN * _DEPTH / wanted
    m, q = 0.5 / rho, 0.5 / v
    U = math.sqrt(max(3.0, math.log1p(4.0 / (math.sqrt(rho) * far * tolerance)) - q))
    count = math.ceil(U / step)
    U = count * step
    rest = 2.7 * math.sqrt(m) * (1.0 + 2.0 * m * U * U) * math.exp(-q - U * U) / math.pi
    rest *= step / (-math.expm1(-2.0 * U * step) * max(0.5 * far, v * U * U))
    return step, count, size / math.expm1(wanted) + rest


def _on_a_leg(
    v: float, c: float, psi: float, A_0: complex, nodes: tuple[float, int, float], slopes: bool
) -> tuple[complex, complex, complex, float, float]:
    """Return (1/π)∫g du over the nodes of one leg, derivatives, and sums of moduli.

    ``nodes`` are the step, their number and the place of the first one in steps, ½ or 0.
    g = (S - 1)/(2A) dk/du, with k from where the leg begins.
    """
    step, count, offset = nodes
    m = 0.5 * v / c
    phase = math.exp(-0.5 / v) * cmath.exp(-1j * psi)
    A_c0 = 2j if psi != 0.0 else 0j
    total, by_v, by_c, size, steep = 0j, 0j, 0j, 0.0, 0.0
    for j in range(count):
        u = (j + offset) * step
        square = u * u
        Y = m * square
        E = phase * math.exp(-square)
        F = 1.0 - E
        D = F * F + 4j * Y * E
        A = A_0 + v * square
        measure = (0.5 if u == 0.0 else 1.0) / (A * cmath.sqrt(1.0 - 1j * Y))
        g = E * (F - 2j * Y) / D * measure
        total += g
        size += abs(g)
        if slopes:
            S_a = E * (2j * Y * (1.0 + E * E) - F * F) / (D * D) * measure
            A_c = A_c0 + 2.0 * Y
            by_v += S_a * A
            by_c += (S_a / v - g / A) * A_c
            steep += abs(S_a * A)
    weight = 2.0 * _EIGHTH * math.sqrt(m) * step / math.pi
    width = abs(weight)
    return (
        weight * total,
        -weight / (v * v) * by_v,
        weight * by_c,
        width * size,
        width * steep / v,
    )


def _roots_on_a_leg(
    v: float, c: float, psi: float, step: float, offset: float, slopes: bool
) -> tuple[complex, complex, complex, float, float, float]:
    """Return the effect of the roots beside one leg, to be taken away, and its derivatives.

    Last come the two roundings, and how near a root comes to a node: small where digits are lost.
    """
    rho, q = c / v, 0.5 / v
    scale = math.sqrt(0.5 / rho) * _EIGHTH
    sign = 1.0 if offset == 0.0 else -1.0
    value, by_v, by_c, shifts, gains, clearance = 0j, 0j, 0j, 0.0, 0.0, 1.0
    for j in range(4 if psi != 0.0 else 2):
        psi_j = psi if j < 2 else psi - math.copysign(_TURN, psi)
        root = root_near(two_roots_near(q, psi_j, rho)[j % 2], q, psi_j, rho)
        p = root[0]
        wave = p + (2.0 * rho - psi_j) if psi != 0.0 else p
        side = 1.0 if p.imag > 0.0 else -1.0
        unit = -1j * _TURN * side / (step * scale)
        z = unit * root[1]
        found = effect_of_root(root, wave, v, c, z, 0.5 * unit * root[2], sign, slopes)
        if z.real < 3.0:
            clearance = min(clearance, abs(sign * cmath.exp(z) - 1.0))
        value += side * found[0]
        by_v += side * found[1]
        by_c += side * found[2]
        shifts += found[3]
        gains += found[4]
    return value, by_v, by_c, shifts, gains, clearance


def _leg(
    v: float, c: float, psi: float, tolerance: float, slopes: bool
) -> tuple[complex, complex, complex, float, float, float, float, int]:
    """Return one leg's part of Σ, slopes, error bounds, step and number; ψ = 0 for the first."""
    A_0 = complex(0.5, 2.0 * c if psi != 0.0 else 0.0)
    # the phase of the second leg, and with it what is left out, turns by 2c/v as v or c goes to ev
    speed = 1.0 + c / v if psi != 0.0 else 1.0
    if slopes:
        tolerance /= speed
    step, count, truncation = _leg_nodes(tolerance, v, c / v, 2.0 * abs(A_0), psi != 0.0)
    offset = 0.5
    taken = (0j, 0j, 0j, 0.0, 0.0, 1.0)
    if v >= SLOWEST:
        taken = _roots_on_a_leg(v, c, psi, step, offset, slopes)
        if psi != 0.0 and taken[5] < 0.5:
            other = _roots_on_a_leg(v, c, psi, step, 0.0, slopes)
            if other[5] > taken[5]:
                offset, taken = 0.0, other
    value, by_v, by_c, size, steep = _on_a_leg(v, c, psi, A_0, (step, count, offset), slopes)
    phase = 1.0 + 2.0 * c / v if psi != 0.0 else 1.0
    rounding = 8.0 * _EPS * (size * phase + taken[3])
    rough = SLOPE_SHARE * speed * truncation + 8.0 * _EPS * (steep * phase + taken[4])
    return (
        value - taken[0], by_v - taken[1], by_c - taken[2], truncation, rounding, rough, step,
        count,
    )  # fmt: skip


def _arch(
    v: float, c: float, tolerance: float, slopes: bool
) -> tuple[complex, complex, complex, float, float, float, int]:
    """Return Σ by the two legs; see `sum_at`."""
    psi = 2.0 * c / v % _TURN - math.pi
    first = _leg(v, c, 0.0, 0.4 * tolerance, slopes)
    second = _leg(v, c, psi if psi != 0.0 else 1e-300, 0.4 * tolerance, slopes)
    still = 1.0 / cmath.sqrt(1.0 - 4j * c)
    pole = math.pi / (first[6] * math.sqrt(2.0 * v))  # that of -1/2A, at u = i/√(2v)
    share = math.tanh(pole)
    # at fixed nodes the place of the pole goes like c^{-1/2} and does not depend on v
    by_c = still * (2j * still * still * share - 0.5 * pole / c * (1.0 - share * share))
    return (
        share * still - 1.0 + first[0] + second[0].conjugate(),
        first[1] + second[1].conjugate(),
        by_c + first[2] + second[2].conjugate(),
        first[3] + second[3],
        8.0 * _EPS + first[4] + second[4],
        8.0 * _EPS + first[5] + second[5],
        first[7] + second[7],
    )


def sum_at(
    v: float, c: float, tolerance: float, slopes: bool
) -> tuple[complex, complex, complex, float, float, float, int]:
    """Return Σ, ∂Σ/∂v, ∂Σ/∂c, three bounds, and the number of points.

    The bounds are those of the truncation of Σ, of its rounding, and of the errors of v ∂Σ/∂v and
    c ∂Σ/∂c.

    Parameters
    ----------
    v, c : float
        Front velocity v̂ and coupling, positive, dimensionless.
    tolerance : float
        Truncation error wanted of Σ.
    slopes : bool
        Whether the derivatives are wanted.
    """
    count, truncation = plain_points(v, c, tolerance)
    if is_plain(v, c, count):
        return _plain(v, c, count, truncation, slopes)
    return beside_roots(v, c, tolerance, slopes)


def beside_roots(
    v: float, c: float, tolerance: float, slopes: bool
) -> tuple[complex, complex, complex, float, float, float, int]:
    """Return what `sum_at` does, where roots are taken away."""
    if c > STEEPEST * v:
        return _arch(v, c, tolerance, slopes)
    return _real_axis(v, c, tolerance, slopes)


def fill(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, values: ComplexArray,
    errors: FloatArray, points: npt.NDArray[np.int64],
) -> None:  # fmt: skip
    """Write Σ, ∂Σ/∂v, ∂Σ/∂c into ``values``, their error bounds into ``errors``, shapes (3, n)."""
    for i in range(v.size):
        found = sum_at(float(v[i]), float(c[i]), tolerance, slopes)
        values[0, i], values[1, i], values[2, i] = found[0], found[1], found[2]
        errors[0, i] = found[3] + found[4]
        errors[1, i], errors[2, i] = found[5] / v[i], found[5] / c[i]
        points[i] = found[6]
