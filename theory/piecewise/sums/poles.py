"""Roots of (50) near a path, and the effect of each on the trapezoidal rule along it.

See ``theory.piecewise.sums.rules``. The variable p is the wave number measured from the beginning
of the path, and a root p obeys q + iψ - iρ(1 - cos p) - ip = 0 with q = 1/2v and ρ = c/v. With ψ =
0 this is L(p)/v = 0.
"""

from __future__ import annotations

import cmath
import math

from theory.piecewise.sums.arithmetic import modulus, quotient, square_root

TURN = 2.0 * math.pi
MAX_STEPS = 12
_OVERFLOW = 600.0
_FARTHEST = -2.33, math.sin(-2.33), math.cos(-2.33)
"""k, sin k and cos k of the expansion point for the resonant pair far from resonance."""


def step_to_root(
    p: complex, sine: complex, cosine: complex, q: float, psi: float, rho: float
) -> tuple[complex, float]:
    """Return Euler's step of third order, which tolerates two roots close together, and |slope|.

    ``sine`` and ``cosine`` are sin(p/2) and cos(p/2).
    """
    square = 2.0 * rho * sine * sine
    value = q + 1j * (psi - square - p)
    first, second = -1j * (1.0 + 2.0 * rho * sine * cosine), 1j * (square - rho)
    root = square_root(first * first - 2.0 * value * second)
    alignment = root.real * first.real + root.imag * first.imag
    return quotient(-2.0 * value, first + (root if alignment >= 0.0 else -root)), modulus(first)


def has_converged(p: complex, step: complex, abs_slope: float, rho: float) -> bool:
    """Return whether p, reached by ``step``, is a root to within rounding; False for NaN."""
    size = modulus(step)
    return size * size * size * rho <= 1e-18 * abs_slope * modulus(p)


def root_near(start: complex, q: float, psi: float, rho: float) -> tuple[complex, complex, complex]:
    """Return the root p near ``start``, sin(p/2) and cos(p/2)."""
    p = start
    sine, cosine = cmath.sin(0.5 * p), cmath.cos(0.5 * p)
    for _ in range(MAX_STEPS):
        step, abs_slope = step_to_root(p, sine, cosine, q, psi, rho)
        p += step
        if has_converged(p, step, abs_slope, rho):
            half_step = 0.5 * step
            cos_step = 1.0 - 0.5 * half_step * half_step
            sin_step = half_step - half_step * half_step * half_step / 6.0
            return p, sine * cos_step + cosine * sin_step, cosine * cos_step - sine * sin_step
        sine, cosine = cmath.sin(0.5 * p), cmath.cos(0.5 * p)
    return p, sine, cosine


def pair_of_the_parabola(q: float, psi: float, rho: float) -> tuple[complex, complex, bool]:
    """Return approximations of the two roots nearest 0, the smaller first.

    The equation is q + iψ = 2iρs² + 2i arcsin s with s = sin(p/2). Here arcsin s is replaced by s,
    and then p = 2 arcsin s is evaluated by its series. The third result says whether the two roots
    are so close that the expansion in `two_roots_near` is more accurate.
    """
    w = 1.0 / rho
    square = w * w + 2.0 * w * (psi - 1j * q)
    larger = -w - square_root(square)
    smaller = quotient(2j * w * (q + 1j * psi), larger)
    return twice_arcsine(smaller), twice_arcsine(larger), modulus(square) < 0.2 * w * w


def twice_arcsine(p: complex) -> complex:
    """Return 2 arcsin(p/2) to order 7."""
    w = 0.25 * p * p
    return p * (1.0 + w * (1.0 / 6.0 + w * (0.075 + w * (15.0 / 336.0))))


def two_roots_near(q: float, psi: float, rho: float) -> tuple[complex, complex]:
    """Return starting points for the two roots nearest p = 0.

    They are those of `pair_of_the_parabola` or, where the two roots nearly meet (resonance with a
    linear wave), those of the second-order expansion about the point between them at which the
    slope vanishes.
    """
    smaller, larger, nearly_double = pair_of_the_parabola(q, psi, rho)
    if not nearly_double:
        return smaller, larger
    k = -math.asin(1.0 / rho)
    value = q + 1j * (psi - rho * (1.0 - math.cos(k)) - k)
    separation = cmath.sqrt(-2j * value / (rho * math.cos(k)))
    return k + separation, k - separation


def resonant_pair(q: float, rho: float) -> tuple[complex, complex]:
    """Return starting points for the roots above and below the axis that meet at resonance."""
    if q > 1.0:  # fixed-point iteration of cos p = 1 + (p + iq)/ρ, on a branch for each root
        above, below = -1.8 + 2j, -3.5 - 1.5j
        for _ in range(2):
            above = -cmath.acos(1.0 + (above + 1j * q) / rho)
        for _ in range(3):
            z = 1.0 + (below + 1j * q) / rho
            below = cmath.acos(z) - TURN if z.imag > 0.0 else -cmath.acos(z)
        return above, below
    k, sine, cosine = _FARTHEST
    if rho >= 1.5:  # where the slope vanishes
        sine = -1.0 / rho
        k, cosine = -math.pi - math.asin(sine), -math.sqrt(1.0 - sine * sine)
    value = q - 1j * (rho * (1.0 - cosine) + k)
    first, inverse = -1j * (1.0 + rho * sine), 1j / (rho * cosine)
    root = square_root(first * first + 2j * rho * cosine * value)
    one, other = k + (root - first) * inverse, k - (root + first) * inverse
    if one.imag > other.imag:
        return one, other
    return other, one


def side_of(height: float) -> float:
    """Return 1 for roots above the path, -1 below."""
    return 1.0 if height > 0.0 else -1.0


def bounded_exp(z: complex) -> complex:
    """Return e^z, with Re z limited so that it does not overflow."""
    return cmath.exp(complex(min(z.real, _OVERFLOW), z.imag))


def pole_correction(
    root: tuple[complex, complex, complex], wave: complex, v: float, c: float,
    power: complex, turn: complex, sign: float,
) -> tuple[complex, complex, complex, float, float]:  # fmt: skip
    """Return tW, t = 1/(wave L_k), W = 1/(sign e^z - 1), its derivatives, and two error factors.

    Parameters
    ----------
    root : tuple of complex
        A root p, measured from the beginning of its path, sin(p/2) and cos(p/2).
    wave : complex
        The same root, measured from k = 0; equal to p if the path begins there.
    power, turn : complex
        e^z, and the derivative of z by p.
    sign : float
        1 if a node lies at the beginning of the path, -1 if the first node lies half a step away.

    Returns
    -------
    value, by_v, by_c : complex
        tW, and its derivatives by v and c at fixed nodes.
    shift, gain : float
        A relative error δ of the terms of L changes the value by at most ``shift`` δ, and the
        derivatives by ln v and ln c by at most ``gain`` δ.
    """
    p, half, cos_half = root
    sine = 2.0 * half * cos_half
    slope = v + c * sine
    t = quotient(1j, wave * slope)
    weight = quotient(1.0 + 0j, sign * power - 1.0)
    value, value_by_p = t * weight, -t * weight * (1.0 + weight) * turn
    onsite = 2.0 * half * half if wave == p else -2.0 * cos_half * cos_half  # i∂L/∂c
    cosine = 1.0 - 2.0 * half * half
    abs_slope, size, abs_wave = modulus(slope), modulus(value), modulus(wave)
    # the largest displacement of p, and relative change of t with p, for δ = 1
    dp = (0.5 + abs_wave * v + c * modulus(onsite)) / abs_slope
    log_slope = 1.0 / abs_wave + c * modulus(cosine) / abs_slope
    shift = (
        size * (dp * log_slope + (v + c * modulus(sine)) / abs_slope)
        + 2.0 * modulus(value_by_p) * dp
    )
    p_v, p_c = quotient(-wave, slope), quotient(-onsite, slope)
    inverse_slope = quotient(1.0 + 0j, slope)
    inverse_wave = quotient(1.0 + 0j, wave)
    value_v = value_by_p * p_v - value * (
        p_v * inverse_wave + (1.0 + c * cosine * p_v) * inverse_slope
    )
    value_c = value_by_p * p_c - value * (
        p_c * inverse_wave + (sine + c * cosine * p_c) * inverse_slope
    )
    gain = 2.0 * shift * (1.0 + dp * (log_slope + modulus(turn) * (1.0 + 2.0 * modulus(weight))))
    return value, value_v, value_c, shift, gain
