"""Roots of (50) beside a path, and what each does to the trapezoidal rule along it.

See ``theory.piecewise.sums.rules``. A root p is counted from where its path begins; there
p = 0, and q + iψ - iρ(1 - cos p) - ip = 0 with q = 1/2v and ρ = c/v. With ψ = 0 this is
L(p)/v = 0.
"""

from __future__ import annotations

import cmath
import math

from theory.piecewise.sums.arithmetic import modulus, quotient, square_root

TURN = 2.0 * math.pi
MAX_STEPS = 12
_OVERFLOW = 600.0
_FARTHEST = -2.33, math.sin(-2.33), math.cos(-2.33)
"""k, sin k and cos k about which the resonant pair is sought where it is far from resonance."""


def step_to_root(
    p: complex, sine: complex, cosine: complex, q: float, psi: float, rho: float
) -> tuple[complex, float]:
    """Return Euler's step of third order, which bears two roots close together, and |slope|.

    ``sine`` and ``cosine`` are those of p/2.
    """
    square = 2.0 * rho * sine * sine
    value = q + 1j * (psi - square - p)
    first, second = -1j * (1.0 + 2.0 * rho * sine * cosine), 1j * (square - rho)
    root = square_root(first * first - 2.0 * value * second)
    toward = root.real * first.real + root.imag * first.imag
    return quotient(-2.0 * value, first + (root if toward >= 0.0 else -root)), modulus(first)


def is_settled(p: complex, step: complex, steep: float, rho: float) -> bool:
    """Return whether p is a root to rounding after the step to it; false of what is no number."""
    size = modulus(step)
    return size * size * size * rho <= 1e-18 * steep * modulus(p)


def root_near(start: complex, q: float, psi: float, rho: float) -> tuple[complex, complex, complex]:
    """Return the root p near ``start``, sin(p/2) and cos(p/2)."""
    p = start
    sine, cosine = cmath.sin(0.5 * p), cmath.cos(0.5 * p)
    for _ in range(MAX_STEPS):
        step, steep = step_to_root(p, sine, cosine, q, psi, rho)
        p += step
        if is_settled(p, step, steep, rho):
            turn = 0.5 * step
            near, far = 1.0 - 0.5 * turn * turn, turn - turn * turn * turn / 6.0
            return p, sine * near + cosine * far, cosine * near - sine * far
        sine, cosine = cmath.sin(0.5 * p), cmath.cos(0.5 * p)
    return p, sine, cosine


def pair_of_the_parabola(q: float, psi: float, rho: float) -> tuple[complex, complex, bool]:
    """Return approximations of the two roots nearest 0, the smaller first.

    The equation is q + iψ = 2iρs² + 2i arcsin s with s = sin(p/2). Arcsin s is replaced by s, and
    p is 2 arcsin s by its series. Last comes whether the two are so near each other that
    `two_roots_near` knows better.
    """
    w = 1.0 / rho
    square = w * w + 2.0 * w * (psi - 1j * q)
    far = -w - square_root(square)
    near = quotient(2j * w * (q + 1j * psi), far)
    return twice_arcsine(near), twice_arcsine(far), modulus(square) < 0.2 * w * w


def twice_arcsine(p: complex) -> complex:
    """Return 2 arcsin(p/2) to order 7."""
    w = 0.25 * p * p
    return p * (1.0 + w * (1.0 / 6.0 + w * (0.075 + w * (15.0 / 336.0))))


def two_roots_near(q: float, psi: float, rho: float) -> tuple[complex, complex]:
    """Return starting points for the two roots nearest p = 0.

    Those of `pair_of_the_parabola`, or where the two nearly meet (resonance with a
    linear wave) those of the second-order expansion about the point between them, where the slope
    vanishes.
    """
    near, far, meet = pair_of_the_parabola(q, psi, rho)
    if not meet:
        return near, far
    k = -math.asin(1.0 / rho)
    value = q + 1j * (psi - rho * (1.0 - math.cos(k)) - k)
    apart = cmath.sqrt(-2j * value / (rho * math.cos(k)))
    return k + apart, k - apart


def resonant_pair(q: float, rho: float) -> tuple[complex, complex]:
    """Return starting points for the roots above and below the axis that meet in resonance."""
    if q > 1.0:  # cos p = 1 + (p + iq)/ρ, a fixed point on the branch of each
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


def grown(z: complex) -> complex:
    """Return e^z, less where it would overflow."""
    return cmath.exp(complex(min(z.real, _OVERFLOW), z.imag))


def effect_of_root(
    root: tuple[complex, complex, complex], wave: complex, v: float, c: float,
    power: complex, turn: complex, sign: float,
) -> tuple[complex, complex, complex, float, float]:  # fmt: skip
    """Return tW, t = 1/(wave L_k), W = 1/(sign e^z - 1), its derivatives, and two roundings.

    Parameters
    ----------
    root : tuple of complex
        A root p from where its path begins, sin(p/2) and cos(p/2).
    wave : complex
        The same root from k = 0, where it is p itself on the path that begins there.
    power, turn : complex
        e^z, and the derivative of z by p.

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
    t = quotient(1j, wave * slope)
    weight = quotient(1.0 + 0j, sign * power - 1.0)
    value, turned = t * weight, -t * weight * (1.0 + weight) * turn
    onsite = 2.0 * half * half if wave == p else -2.0 * cos_half * cos_half  # i∂L/∂c
    cosine = 1.0 - 2.0 * half * half
    steep, size, far = modulus(slope), modulus(value), modulus(wave)
    move = (0.5 + far * v + c * modulus(onsite)) / steep
    along = 1.0 / far + c * modulus(cosine) / steep
    shift = size * (move * along + (v + c * modulus(sine)) / steep) + 2.0 * modulus(turned) * move
    p_v, p_c = quotient(-wave, slope), quotient(-onsite, slope)
    bend = quotient(1.0 + 0j, slope)
    near = quotient(1.0 + 0j, wave)
    value_v = turned * p_v - value * (p_v * near + (1.0 + c * cosine * p_v) * bend)
    value_c = turned * p_c - value * (p_c * near + (sine + c * cosine * p_c) * bend)
    gain = 2.0 * shift * (1.0 + move * (along + modulus(turn) * (1.0 + 2.0 * modulus(weight))))
    return value, value_v, value_c, shift, gain
