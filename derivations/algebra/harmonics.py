"""A single algebra of harmonics for multiple scales and for averaging.

An element is a Laurent polynomial in ``e^{i T0}`` with coefficients in a polynomial ring over the
Gaussian rationals. The generators are the complex amplitudes of a few neighbouring sites, their
conjugates, and real parameters. All arithmetic is exact; nothing is simplified.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import sympy as sp
from sympy.polys.domains import QQ_I
from sympy.polys.rings import PolyRing

Coefficient = Any
"""An element of the coefficient ring (``sympy.polys.rings.PolyElement``)."""


@dataclass(frozen=True)
class HarmonicRing:
    """The ring of coefficients, with its conjugation and its shift along the chain.

    Parameters
    ----------
    amplitudes : tuple of Symbol
        Complex amplitudes, ordered by site from left to right.
    parameters : tuple of Symbol
        Real parameters.

    Examples
    --------
    >>> A, a = sp.symbols("A a")
    >>> ring = HarmonicRing((A,), (a,))
    >>> wave = ring.real_wave(0)
    >>> ring.as_expr((wave**2 * wave.fast_derivative()).coefficient(1))
    I*A**2*conjugate(A)
    """

    amplitudes: tuple[sp.Symbol, ...]
    parameters: tuple[sp.Symbol, ...] = ()
    conjugates: tuple[sp.Symbol, ...] = field(init=False)
    ring: PolyRing = field(init=False, repr=False)

    def __post_init__(self) -> None:
        conjugates = tuple(sp.Symbol(rf"\bar{{{s.name}}}") for s in self.amplitudes)
        object.__setattr__(self, "conjugates", conjugates)
        generators = self.amplitudes + conjugates + self.parameters
        object.__setattr__(self, "ring", PolyRing(generators, QQ_I, sp.polys.orderings.lex))

    @property
    def reach(self) -> int:
        """Number of sites on either side of the middle one."""
        return len(self.amplitudes) // 2

    def amplitude(self, offset: int) -> Coefficient:
        """Return the amplitude of the site ``offset`` places from the middle."""
        return self.ring.gens[self._position(offset)]

    def element(self, value: sp.Expr | int) -> Coefficient:
        """Return a polynomial in the generators, as an element of the ring."""
        return self.ring.from_expr(sp.sympify(value))

    def constant(self, value: complex) -> Coefficient:
        """Return a Gaussian integer as an element of the ring."""
        return self.ring.ground_new(QQ_I(int(value.real), int(value.imag)))

    def real_wave(self, offset: int) -> Harmonics:
        """Return ``A e^{i T0} + conjugate``, the solution of the linear oscillator (Eq. 20)."""
        amplitude = self.amplitude(offset)
        return Harmonics(self, {1: amplitude, -1: self.conjugate(amplitude)})

    def conjugate(self, value: Coefficient) -> Coefficient:
        """Return the complex conjugate of a coefficient."""
        count = len(self.amplitudes)
        terms = {}
        for powers, number in value.items():
            swapped = powers[count : 2 * count] + powers[:count] + powers[2 * count :]
            terms[swapped] = QQ_I(number.x, -number.y)
        return self.ring.from_dict(terms)

    def shift(self, value: Coefficient, places: int) -> Coefficient:
        """Return the same coefficient written for the site ``places`` further on.

        Raises
        ------
        IndexError
            If an amplitude would leave the sites contained in the ring.
        """
        count = len(self.amplitudes)
        terms = {}
        for powers, number in value.items():
            shifted = [0] * (2 * count) + list(powers[2 * count :])
            for site in range(count):
                for block in (0, count):
                    if powers[block + site]:
                        position = self._position(site - self.reach + places)
                        shifted[block + position] = powers[block + site]
            terms[tuple(shifted)] = number
        return self.ring.from_dict(terms)

    def along(
        self, value: Coefficient, flow: Mapping[int, Coefficient],
        conjugates: Mapping[int, Coefficient] | None = None,
    ) -> Coefficient:  # fmt: skip
        """Return the derivative of a coefficient along ``d A_j = flow[j]`` for each offset j.

        ``conjugates`` are the changes of the conjugates of A_j, if they are others than those of
        ``flow``.
        """
        count = len(self.amplitudes)
        total = self.ring.zero
        for offset, rate in flow.items():
            position = self._position(offset)
            total += value.diff(self.ring.gens[position]) * rate
            conjugate_rate = self.conjugate(rate) if conjugates is None else conjugates[offset]
            total += value.diff(self.ring.gens[count + position]) * conjugate_rate
        return total

    def flow(self, rate: Coefficient, reach: int) -> dict[int, Coefficient]:
        """Return the rate of the middle site, written for every site within ``reach``."""
        return {offset: self.shift(rate, offset) for offset in range(-reach, reach + 1)}

    def as_expr(self, value: Coefficient) -> sp.Expr:
        """Return a SymPy expression, with ``conjugate(A)`` for the conjugate amplitudes."""
        names = dict(zip(self.conjugates, map(sp.conjugate, self.amplitudes), strict=True))
        return value.as_expr().xreplace(names)

    def _position(self, offset: int) -> int:
        position = offset + self.reach
        if not 0 <= position < len(self.amplitudes):
            raise IndexError("the ring holds too few sites")
        return position


@dataclass(frozen=True)
class Harmonics:
    """A Laurent polynomial in ``e^{i T0}``: ``terms[m]`` multiplies ``e^{i m T0}``."""

    ring: HarmonicRing
    terms: Mapping[int, Coefficient]

    def __post_init__(self) -> None:
        nonzero = {m: value for m, value in self.terms.items() if value}
        object.__setattr__(self, "terms", nonzero)

    def coefficient(self, harmonic: int) -> Coefficient:
        """Return the coefficient of ``e^{i harmonic T0}``."""
        return self.terms.get(harmonic, self.ring.ring.zero)

    def __add__(self, other: Harmonics) -> Harmonics:
        terms = dict(self.terms)
        for m, value in other.terms.items():
            terms[m] = terms[m] + value if m in terms else value
        return Harmonics(self.ring, terms)

    def __sub__(self, other: Harmonics) -> Harmonics:
        return self + other.scaled(-1)

    def __mul__(self, other: Harmonics) -> Harmonics:
        terms: dict[int, Coefficient] = {}
        for m, left in self.terms.items():
            for n, right in other.terms.items():
                product = left * right
                terms[m + n] = terms[m + n] + product if m + n in terms else product
        return Harmonics(self.ring, terms)

    def __pow__(self, exponent: int) -> Harmonics:
        result = Harmonics(self.ring, {0: self.ring.ring.one})
        for _ in range(exponent):
            result = result * self
        return result

    def scaled(self, factor: Coefficient) -> Harmonics:
        """Return the element with every coefficient multiplied by ``factor``."""
        return Harmonics(self.ring, {m: value * factor for m, value in self.terms.items()})

    def turned(self, harmonics: int) -> Harmonics:
        """Return the element times ``e^{i harmonics T0}``."""
        return Harmonics(self.ring, {m + harmonics: value for m, value in self.terms.items()})

    def conjugate(self) -> Harmonics:
        """Return the complex conjugate."""
        return Harmonics(
            self.ring, {-m: self.ring.conjugate(value) for m, value in self.terms.items()}
        )

    def fast_derivative(self) -> Harmonics:
        """Return ``d/dT0`` at frozen amplitudes."""
        i = self.ring.constant(1j)
        return Harmonics(self.ring, {m: value * i * m for m, value in self.terms.items()})

    def oscillation(self) -> Harmonics:
        """Return the antiderivative in T0 with zero mean of everything but the mean."""
        terms = {m: value * QQ_I(0, sp.QQ(-1, m)) for m, value in self.terms.items() if m}
        return Harmonics(self.ring, terms)

    def response(self) -> Harmonics:
        """Solve ``u'' + u = self`` for u without ``e^{±i T0}``, omitting resonant terms.

        The secular condition must already have made the resonant coefficients vanish.
        """
        terms = {
            m: value * QQ_I(sp.QQ(1, 1 - m * m), 0)
            for m, value in self.terms.items()
            if abs(m) != 1
        }
        return Harmonics(self.ring, terms)

    def shifted(self, places: int) -> Harmonics:
        """Return the same element written for the site ``places`` further on."""
        return Harmonics(self.ring, {m: self.ring.shift(v, places) for m, v in self.terms.items()})

    def along(self, flow: Mapping[int, Coefficient]) -> Harmonics:
        """Return the slow derivative: along ``d A_j = flow[j]``."""
        return Harmonics(self.ring, {m: self.ring.along(v, flow) for m, v in self.terms.items()})


def chain_ring(name: str, parameters: Sequence[sp.Symbol], reach: int) -> HarmonicRing:
    """Return a ring with ``name_{n-reach} … name_{n+reach}``; with one site if reach is 0."""
    if reach == 0:
        return HarmonicRing((sp.Symbol(name),), tuple(parameters))
    symbols = tuple(site_symbol(name, offset) for offset in range(-reach, reach + 1))
    return HarmonicRing(symbols, tuple(parameters))


def site_symbol(name: str, offset: int) -> sp.Symbol:
    """Return the symbol of the site ``offset`` places from site n.

    Examples
    --------
    >>> site_symbol("A", -1), site_symbol("A", 0), site_symbol("A", 2)
    (A_{n-1}, A_{n}, A_{n+2})
    """
    place = "n" if offset == 0 else f"n{offset:+d}"
    return sp.Symbol(f"{name}_{{{place}}}")
