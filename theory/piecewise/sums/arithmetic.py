"""Complex arithmetic of the rules for Σ: the operations of Python, and versions that vectorise.

The compiler vectorises a loop over many values only if its body neither branches nor calls a
library. ``theory.piecewise.sums.compiled`` therefore replaces each function by the function
``…_without_branches`` that follows it. The two differ by rounding and in range: the latter requires
that squared moduli neither overflow nor underflow.
"""

from __future__ import annotations

import cmath
import math
from typing import Any

import numpy as np

_PI = (math.floor(math.pi * 2.0**28) / 2.0**28, math.pi % 2.0**-28, math.sin(math.pi))
"""π in three parts; the product of n and the first part is exact for n up to 2²³."""
_SINE = tuple((-1) ** n / math.factorial(2 * n + 1) for n in range(12))
_COSINE = tuple((-1) ** n / math.factorial(2 * n) for n in range(13))
_LN2 = 6.93147180369123816490e-01, 1.90821492927058770002e-10
"""ln 2 in two parts; the product of n and the first part is exact for n up to 2²⁰."""
_EXPONENTIAL = tuple(1.0 / math.factorial(n) for n in range(14))
_LOGARITHM = tuple(2.0 / (2 * n + 1) for n in range(11))
_FRACTION, _BIAS = 52, 1023
"""Number of bits of the fraction of a double, and the stored exponent of 1."""
_UNIT = _BIAS << _FRACTION
_LARGEST_EXPONENT = 700.0
NEAR = 1.7
"""Largest modulus for which `sine_and_cosine_near` is exact up to rounding."""


def quotient(x: Any, y: Any) -> Any:
    """Return x/y; the compiled version avoids the branches of a complex division."""
    return x / y


def quotient_without_branches(x: complex, y: complex) -> complex:
    """Return x/y, provided that |y|² neither overflows nor underflows."""
    return x * y.conjugate() * (1.0 / (y.real * y.real + y.imag * y.imag))


def modulus(z: complex) -> float:
    """Return |z|."""
    return abs(z)


def modulus_without_branches(z: complex) -> float:
    """Return |z|, provided that |z|² neither overflows nor underflows."""
    return math.sqrt(z.real * z.real + z.imag * z.imag)


def size_of(z: complex) -> float:
    """Return |Re z| + |Im z|, an upper bound of |z| that needs no square root."""
    return abs(z.real) + abs(z.imag)


def over_root(x: complex, y: complex, Y: float) -> complex:
    """Return x/(y √(1 - iY)) for Y ≥ 0, with one division."""
    size = 1.0 + math.sqrt(1.0 + Y * Y)  # √(1 - iY) = (size - iY)/√(2 size)
    found: complex = quotient(math.sqrt(2.0 * size) * x, y * complex(size, -Y))
    return found


def square_root(z: complex) -> complex:
    """Return √z, Re √z ≥ 0."""
    return cmath.sqrt(z)


def square_root_without_branches(z: complex) -> complex:
    """Return √z, Re √z ≥ 0, provided that |z|² neither overflows nor underflows."""
    size = math.sqrt(z.real * z.real + z.imag * z.imag)
    larger = math.sqrt(0.5 * (size + abs(z.real)))
    smaller = 0.5 * abs(z.imag) / (larger + 1e-300)
    re = larger if z.real >= 0.0 else smaller
    im = smaller if z.real >= 0.0 else larger
    return complex(re, im if z.imag >= 0.0 else -im)


def exponential(x: float) -> float:
    """Return e^x."""
    return math.exp(x)


def exponential_without_branches(x: float) -> float:
    """Return e^x to 3e-16 of its value for |x| ≤ 700; 0 below, and e^{700} above this range."""
    limited = min(max(x, -_LARGEST_EXPONENT), _LARGEST_EXPONENT)
    n = np.rint(limited * (1.0 / math.log(2.0)))
    r = (limited - n * _LN2[0]) - n * _LN2[1]
    polynomial = _EXPONENTIAL[12] + r * _EXPONENTIAL[13]
    polynomial = _EXPONENTIAL[11] + r * polynomial
    polynomial = _EXPONENTIAL[10] + r * polynomial
    polynomial = _EXPONENTIAL[9] + r * polynomial
    polynomial = _EXPONENTIAL[8] + r * polynomial
    polynomial = _EXPONENTIAL[7] + r * polynomial
    polynomial = _EXPONENTIAL[6] + r * polynomial
    polynomial = _EXPONENTIAL[5] + r * polynomial
    polynomial = _EXPONENTIAL[4] + r * polynomial
    polynomial = _EXPONENTIAL[3] + r * polynomial
    polynomial = _EXPONENTIAL[2] + r * polynomial
    power = np.int64((np.int64(n) + _BIAS) << _FRACTION).view(np.float64)
    found: float = (
        (1.0 + r * (1.0 + r * polynomial)) * power * (1.0 if x >= -_LARGEST_EXPONENT else 0.0)
    )
    return found


def logarithm(x: float) -> float:
    """Return ln x."""
    return math.log(x)


def logarithm_without_branches(x: float) -> float:
    """Return ln x to 1e-15 of its value, for finite x ≥ 1."""
    bits = np.float64(x).view(np.int64)
    mantissa = np.int64((bits & ((1 << _FRACTION) - 1)) | _UNIT).view(np.float64)  # from 1 to 2
    halved = 1.0 if mantissa > math.sqrt(2.0) else 0.0
    n = float((bits >> _FRACTION) - _BIAS) + halved
    m = mantissa * (1.0 - 0.5 * halved)
    t = (m - 1.0) / (m + 1.0)  # ln m = 2 artanh t
    w = t * t
    polynomial = _LOGARITHM[9] + w * _LOGARITHM[10]
    polynomial = _LOGARITHM[8] + w * polynomial
    polynomial = _LOGARITHM[7] + w * polynomial
    polynomial = _LOGARITHM[6] + w * polynomial
    polynomial = _LOGARITHM[5] + w * polynomial
    polynomial = _LOGARITHM[4] + w * polynomial
    polynomial = _LOGARITHM[3] + w * polynomial
    polynomial = _LOGARITHM[2] + w * polynomial
    polynomial = _LOGARITHM[1] + w * polynomial
    found: float = n * _LN2[0] + (n * _LN2[1] + t * (2.0 + w * polynomial))
    return found


def remainder(x: float, y: float) -> float:
    """Return x mod y."""
    return x % y


def remainder_without_branches(x: float, y: float) -> float:
    """Return x mod y for x ≥ 0, to the rounding error of x."""
    found: float = min(max(x - y * np.floor(x * (1.0 / y)), 0.0), y)
    return found


def cosine_and_sine(theta: float) -> tuple[float, float]:
    """Return cos θ and sin θ for |θ| < 2²³, to 2e-16 apart from the rounding of θ.

    Larger θ occur on an axis with few points only if v < 1e-4, where e^{-a} is zero.
    The Taylor series is evaluated at half of θ - nπ, without branches, so that loops vectorise.
    """
    n = np.rint(theta * (1.0 / math.pi))
    h = 0.5 * (((theta - n * _PI[0]) - n * _PI[1]) - n * _PI[2])
    s = h * h
    sine, cosine = _SINE[7], _COSINE[8]
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


def sine_and_cosine_near(z: complex) -> tuple[complex, complex]:
    """Return sin z and cos z for |z| ≤ ``NEAR``, by their Taylor series."""
    w = z * z
    sine, cosine = w * _SINE[11] + _SINE[10], w * _COSINE[12] + _COSINE[11]
    sine, cosine = w * sine + _SINE[9], w * cosine + _COSINE[10]
    sine, cosine = w * sine + _SINE[8], w * cosine + _COSINE[9]
    sine, cosine = w * sine + _SINE[7], w * cosine + _COSINE[8]
    sine, cosine = w * sine + _SINE[6], w * cosine + _COSINE[7]
    sine, cosine = w * sine + _SINE[5], w * cosine + _COSINE[6]
    sine, cosine = w * sine + _SINE[4], w * cosine + _COSINE[5]
    sine, cosine = w * sine + _SINE[3], w * cosine + _COSINE[4]
    sine, cosine = w * sine + _SINE[2], w * cosine + _COSINE[3]
    sine, cosine = w * sine + _SINE[1], w * cosine + _COSINE[2]
    return z + z * (w * sine), 1.0 + w * (w * cosine - 0.5)
