"""The plain rule: points on the real axis, no root subtracted; see ``theory.piecewise.sums.rules``.

The module contains the integrand, for numbers, for arrays and for compiled loops over many values,
the number of points, and the error bounds.
"""

from __future__ import annotations

import math
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from theory.piecewise.dispersion import root_free_strip
from theory.piecewise.sums.arithmetic import cosine_and_sine, quotient

if TYPE_CHECKING:
    from theory.arrays import ComplexArray, FloatArray, IntArray

EPS = 2.0**-52
SLOWEST = 0.08
"""Velocity below which no root lies near a path of integration."""
STEEPEST = 3.0
"""Largest c/v for which the path is the real axis."""
MAX_PLAIN = 400
"""Largest number of points for which the plain rule is used.

Up to here, evaluating points costs less than finding the roots that would make some of them
unnecessary.
"""
BLOCK = 256
"""Number of values in one compiled loop, whose rows then stay in the processor's first cache."""
_PIECE = 4096
"""Number of values planned at once: NumPy's results of each operation fit the processor's cache."""
_LARGEST_EXPONENT = 700.0
"""Largest exponent of a double."""
SLOPE_SHARE = 10.0
"""Upper bound of the truncation error of ∂Σ/∂ln v and ∂Σ/∂ln c, divided by that of Σ, where roots
are subtracted."""


def plain_points(v: Any, c: Any, tolerance: float) -> tuple[Any, Any]:
    """Return the number N of points of the plain rule, and the proven bound of its error.

    N is a multiple of 4; it is rounded up by as much as an eighth so that few different N occur.

    Let Im k = σ < s, c sinh s + vs = ½, and w = 1 + 2c sinh σ sin Re k. Then 2 Re A = w, Re(a ± ik)
    = (w ∓ 2vσ)/2v > 0, and S is the mean of coth((a ± ik)/2), of which the moduli are at most 1 +
    2/Re(a ± ik). Hence |G| = |S/2A| ≤ (1 + 2v/(w - 2vσ) + 2v/(w + 2vσ))/w. The mean M of this over
    Re k, see `_line`, bounds the Fourier coefficients, |G_n| ≤ M e^{-|n|σ}, and the error of the
    rule, 2M/(e^{Nσ} - 1).

    Parameters
    ----------
    v, c : float, or ndarray of float, shape (n,)
        Front velocity v̂ and coupling, both numbers or both arrays.
    tolerance : float
        Required truncation error.
    """
    xp, maximum = (np, np.maximum) if isinstance(v, np.ndarray) else (math, max)
    # M grows like (s - σ)^{-1/2}, so that N is smallest near this σ.
    sigma = (1.0 - 0.5 / (math.log(2.0 / tolerance) + 3.0)) * root_free_strip(v, c, 2)
    M = _line(v, c, sigma)[0]
    required = xp.log1p(2.0 * M / tolerance) / sigma
    increment = 4.0 * xp.exp2(maximum(xp.ceil(xp.log2(required / 64.0)), 0.0))
    count = maximum(increment * xp.ceil(required / increment), 8.0)
    return count, 2.0 * M / xp.expm1(count * sigma)


def plan(v: FloatArray, c: FloatArray, tolerance: float) -> tuple[IntArray, FloatArray]:
    """Return the result of `plain_points`, but 0 points where another rule is used."""
    points, truncation = np.zeros(v.size, dtype=np.int64), np.zeros(v.size)
    # All others need more than MAX_PLAIN points, since s ≤ ½/(c + v) and M ≥ 1.
    few_points = c + v <= 0.5 * MAX_PLAIN / math.log(2.0 / tolerance)
    candidates = None if few_points.all() else np.flatnonzero(few_points)
    for first in range(0, v.size if candidates is None else candidates.size, _PIECE):
        piece = slice(first, first + _PIECE)
        index = piece if candidates is None else candidates[piece]
        count, truncation[index] = plain_points(v[index], c[index], tolerance)
        points[index] = np.where(is_plain(v[index], c[index], count), count, 0.0)
    return points, truncation


def _line(v: Any, c: Any, sigma: Any) -> tuple[Any, Any, Any, Any]:
    """Return M, q = 2c sinh σ, 1 - 2vσ and 1 + 2vσ for the line Im k = σ, see `plain_points`.

    The means of 1/(p + q sin x) and 1/(p + q sin x)² over x are (p² - q²)^{-1/2} and
    p (p² - q²)^{-3/2}.
    """
    xp, two_v_sigma = np if isinstance(v, np.ndarray) else math, 2.0 * v * sigma
    q, p, r = 2.0 * c * xp.sinh(sigma), 1.0 - two_v_sigma, 1.0 + two_v_sigma
    M = 1.0 / xp.sqrt(1.0 - q * q)
    M = M + (1.0 / xp.sqrt((p - q) * (p + q)) - 1.0 / xp.sqrt((r - q) * (r + q))) / sigma
    return M, q, p, r


def slope_truncation(v: Any, c: Any, count: Any) -> Any:
    """Return a proven bound of the truncation errors of ∂Σ/∂ln v and ∂Σ/∂ln c by the plain rule.

    As in `plain_points`, since |∂S/∂a| is at most the sum of 1/Re²(a ± ik), ∂G/∂ln v =
    -(∂S/∂a)/2v and ∂G/∂ln c = ((A - ½)/A)((∂S/∂a)/2v - G), where |A - ½| ≤ c (1 + cosh σ).
    """
    xp, maximum, minimum = (
        (np, np.maximum, np.minimum) if isinstance(v, np.ndarray) else (math, max, min)
    )
    s = root_free_strip(v, c, 2)
    sigma = s * (1.0 - maximum(2e-3, 1.5 / (count * s + 1.5)))
    M, q, p, r = _line(v, c, sigma)
    M_v = 2.0 * v * (p * ((p - q) * (p + q)) ** -1.5 + r * ((r - q) * (r + q)) ** -1.5)
    factor = minimum(1.0 + 1.0 / (1.0 - q), 2.0 * c * (1.0 + xp.cosh(sigma)) / (1.0 - q))
    return (
        2.0 * maximum(M_v, factor * (M + M_v)) / xp.expm1(minimum(count * sigma, _LARGEST_EXPONENT))
    )


def is_plain(v: Any, c: Any, count: Any) -> Any:
    """Return whether the plain rule is the fastest one, or the only one."""
    return (count <= MAX_PLAIN) | ((v < SLOWEST) & (c <= STEEPEST * v))


def integrand(E: Any, a: Any, X4: Any) -> Any:
    """Return S/a = 2vG from E = e^{-a}, a and X4 = 4 sin²(k/2), numbers or arrays."""
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
    """Return X4, -X4 i/2 and the weights at half of the points; the others are mirror images."""
    half = (np.arange(count // 2) + 0.5) * (math.pi / count)
    X4 = 4.0 * np.sin(half) ** 2 + 0j
    return X4, -0.5j * X4, np.full(count // 2, 2.0 / count + 0j)


def axis_means(v: Any, c: Any, count: int, slopes: bool) -> tuple[Any, Any, Any, Any, Any]:
    """Return the means of G, ∂G/∂v, ∂G/∂c over the points, and the rms of |G| and |∂G/∂ ln v|.

    v and c are numbers, or arrays with a last axis of length one, along which the points are laid
    out and summed.
    """
    X4, minus_2iX, weights = _nodes(count)
    single = isinstance(v, float)
    dot = np.vdot if single else np.vecdot  # neither starts threads
    mean = weights.dot if single else partial(np.vecdot, weights)
    a = minus_2iX * (c / v) + 0.5 / v
    E = np.exp(-a)
    q = 0.5 / (v if single else v[..., 0])
    if not slopes:
        g = integrand(E, a, X4)
        return mean(g) * q, 0j, 0j, (dot(g, g).real * (2.0 / count)) ** 0.5 * q, 0.0
    g, S_a, h = integrand_and_slopes(E, a, X4)
    return (
        mean(g) * q,
        mean(S_a) * (-2.0 * q * q),
        mean(h) * (-1j * q * q),
        (dot(g, g).real * (2.0 / count)) ** 0.5 * q,
        (dot(S_a, S_a).real * (2.0 / count)) ** 0.5 * (2.0 * q),
    )


def _add_values(X: float, table: FloatArray, sums: FloatArray) -> None:
    """Add Re and Im of S/a, and |S/a|², at X and at 1 - X; ``table`` is that of `_prepared`."""
    q, phase, decay, P_re, P_im, x, y = (
        table[0], table[1], table[2], table[3], table[4], table[5], table[6],
    )  # fmt: skip
    re, im, squares = sums[0], sums[1], sums[2]
    for i in range(phase.size):  # in a loop of its own, with which both are a fifth faster
        x[i], y[i] = cosine_and_sine(phase[i] * X)
    for i in range(phase.size):
        E = complex(decay[i] * x[i], decay[i] * y[i])
        g = integrand(E, complex(q[i], -phase[i] * X), 4.0 * X)
        E = complex(P_re[i] * x[i] + P_im[i] * y[i], P_im[i] * x[i] - P_re[i] * y[i])
        h = integrand(E, complex(q[i], phase[i] * X - phase[i]), 4.0 - 4.0 * X)
        re[i] += g.real + h.real
        im[i] += g.imag + h.imag
        squares[i] += g.real * g.real + g.imag * g.imag + h.real * h.real + h.imag * h.imag


def _add_slopes(X: float, table: FloatArray, sums: FloatArray) -> None:
    """Add Re and Im of S_a, |S_a|², and Re and Im of the derivative by c, at X and at 1 - X."""
    q, phase, decay, P_re, P_im, x, y = (
        table[0], table[1], table[2], table[3], table[4], table[5], table[6],
    )  # fmt: skip
    re, im, squares, re_c, im_c = sums[0], sums[1], sums[2], sums[3], sums[4]
    for i in range(phase.size):
        x[i], y[i] = cosine_and_sine(phase[i] * X)
    for i in range(phase.size):
        E = complex(decay[i] * x[i], decay[i] * y[i])
        _, g, g_c = integrand_and_slopes(E, complex(q[i], -phase[i] * X), 4.0 * X)
        E = complex(P_re[i] * x[i] + P_im[i] * y[i], P_im[i] * x[i] - P_re[i] * y[i])
        _, h, h_c = integrand_and_slopes(E, complex(q[i], phase[i] * X - phase[i]), 4.0 - 4.0 * X)
        re[i] += g.real + h.real
        im[i] += g.imag + h.imag
        squares[i] += g.real * g.real + g.imag * g.imag + h.real * h.real + h.imag * h.imag
        re_c[i] += g_c.real + h_c.real
        im_c[i] += g_c.imag + h_c.imag


def _prepared(v: FloatArray, c: FloatArray) -> FloatArray:
    """Return the rows 1/2v, 2c/v, d = e^{-1/2v}, Re and Im of d e^{2ic/v}, and two to be filled."""
    table = np.empty((7, v.size))
    for i in range(v.size):
        table[0, i] = 0.5 / v[i]
        table[1, i] = 4.0 * table[0, i] * c[i]
        table[2, i] = math.exp(-table[0, i])
    for i in range(v.size):
        x, y = cosine_and_sine(table[1, i])
        table[3, i], table[4, i] = table[2, i] * x, table[2, i] * y
    return table


def block_values(v: FloatArray, c: FloatArray, count: int) -> FloatArray:
    """Return the means of Re and Im of S/a and of |S/a|² as rows.

    Written for compilation: the loop over values is the innermost one. ``count`` must be a multiple
    of 4.
    """
    means = np.empty((3, v.size))
    for first in range(0, v.size, BLOCK):
        table = _prepared(v[first : first + BLOCK], c[first : first + BLOCK])
        sums = np.zeros((3, table.shape[1]))
        for j in range(count // 4):
            half = math.sin((j + 0.5) * (math.pi / count))
            _add_values(half * half, table, sums)
        for i in range(table.shape[1]):
            for row in range(3):
                means[row, first + i] = sums[row, i] * (2.0 / count)
    return means


def block_slopes(v: FloatArray, c: FloatArray, count: int) -> FloatArray:
    """Return the means of Re, Im and |.|² of S_a, and of Re and Im of (S_a - S/a) X4/a, as rows.

    See `block_values`.
    """
    means = np.empty((5, v.size))
    for first in range(0, v.size, BLOCK):
        table = _prepared(v[first : first + BLOCK], c[first : first + BLOCK])
        sums = np.zeros((5, table.shape[1]))
        for j in range(count // 4):
            half = math.sin((j + 0.5) * (math.pi / count))
            _add_slopes(half * half, table, sums)
        for i in range(table.shape[1]):
            for row in range(5):
                means[row, first + i] = sums[row, i] * (2.0 / count)
    return means


def plain_errors(v: Any, c: Any, size: Any, slope_size: Any) -> tuple[Any, Any]:
    """Return bounds of the rounding errors of Σ, and of v ∂Σ/∂v and c ∂Σ/∂c."""
    phase_factor = 1.0 + np.exp(-0.5 / v) * c / v  # e^{-a} loses digits because its phase is large
    return 8.0 * EPS * (size + 1.0) * phase_factor, 8.0 * EPS * (1.0 + slope_size) * phase_factor
