"""Averages of a cell over a cycle y = A sin θ, ẏ = ωA cos θ, as exact polynomials in s = A².

For ψ = ẏ/ω + iy = φe^{iωt} and ÿ = -ω²y - εh(y, ẏ)ẏ - r(y) the average of φ' over a cycle is

    φ' = φ[-(ε/2)H(s) + iεD(s) + iR(s)/ω],   H = 2<h cos²θ>,  D = <h sin θ cos θ>,  R = <r sin θ>/A

with s = |φ|² (first order of averaging; Guckenheimer and Holmes, 1983).
"""

from __future__ import annotations

import math
from fractions import Fraction

from theory.cells.polynomial import Monomial, Polynomial

FREQUENCY = "_w"
"""Name of ω in the averages; names of a cell's parameters never begin with ``_``."""


def mean_of_powers(i: int, j: int) -> Fraction:
    """Return the mean of sinⁱθ cosʲθ: (i-1)!!(j-1)!!/(i+j)!! if i and j are even, otherwise 0.

    Examples
    --------
    >>> mean_of_powers(2, 2), mean_of_powers(1, 2)
    (Fraction(1, 8), Fraction(0, 1))
    """
    if i % 2 or j % 2:
        return Fraction(0)
    product = math.prod(range(i - 1, 0, -2)) * math.prod(range(j - 1, 0, -2))
    return Fraction(product, math.prod(range(i + j, 0, -2)))


def mean_damping(damping: Polynomial) -> Polynomial:
    """Return H of a damping h(y, v) as a polynomial in s, which is denoted by ``y``, and in ω.

    Examples
    --------
    >>> from theory.cells.polynomial import read_polynomial
    >>> mean_damping(read_polynomial("v**2 - 1")).source()
    '(-1.0) + y*(0.75*_w*_w)'
    """
    return _averaged(damping, sine=0, cosine=2, factor=2)


def mean_shift_of_damping(damping: Polynomial) -> Polynomial:
    """Return D of a damping h(y, v), the frequency shift by its part odd in both y and v."""
    return _averaged(damping, sine=1, cosine=1, factor=1)


def mean_shift_of_stiffness(stiffness: Polynomial) -> Polynomial:
    """Return R of a stiffness; a linear term contributes half its coefficient.

    Examples
    --------
    >>> from theory.cells.polynomial import read_polynomial
    >>> mean_shift_of_stiffness(read_polynomial("k*y**3")).source()
    'y*(0.375*k)'
    """
    return _averaged(stiffness, sine=1, cosine=0, factor=1, less=1)


def _averaged(
    given: Polynomial, *, sine: int, cosine: int, factor: int, less: int = 0
) -> Polynomial:
    """Return the mean of given × sinᵐθ cosⁿθ × factor / Aˡ, m = sine, n = cosine, l = less."""
    found: dict[Monomial, Fraction] = {}
    for monomial, coefficient in given.terms.items():
        powers = dict(monomial)
        i, j = powers.pop("y", 0), powers.pop("v", 0)
        mean = factor * coefficient * mean_of_powers(i + sine, j + cosine)
        if not mean:
            continue
        powers |= {"y": (i + j - less) // 2, FREQUENCY: j}
        key = tuple(sorted((name, power) for name, power in powers.items() if power))
        found[key] = found.get(key, Fraction(0)) + mean
    return Polynomial({key: value for key, value in sorted(found.items()) if value})
