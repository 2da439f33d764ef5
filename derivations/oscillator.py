"""The oscillator that is averaged: polynomial damping, polynomial stiffness, linear coupling."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import sympy as sp

from derivations.algebra.harmonics import HarmonicRing, Harmonics


@dataclass(frozen=True)
class Oscillator:
    """``y_n'' + y_n + eps [y_n' h(y_n) + g(y_n) + c (2 y_n - y_{n-1} - y_{n+1})] = 0``.

    Everything is dimensionless; the linear frequency is 1.

    Parameters
    ----------
    damping : mapping of int to Expr
        Coefficient of each power of y in h.
    stiffness : mapping of int to Expr
        Coefficient of each power of y in g; empty for none.
    coupling : Expr
        The coupling c; 0 for an isolated cell.
    """

    damping: Mapping[int, sp.Expr]
    stiffness: Mapping[int, sp.Expr] = field(default_factory=dict)
    coupling: sp.Expr = sp.S.Zero

    @property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """The symbols of the coefficients, sorted by name."""
        values = [*self.damping.values(), *self.stiffness.values(), self.coupling]
        found = set().union(*(sp.sympify(value).free_symbols for value in values))
        return tuple(sorted(found, key=lambda symbol: symbol.name))

    @property
    def is_chain(self) -> bool:
        """Whether neighbours are coupled."""
        return bool(self.coupling != 0)

    def force(self, ring: HarmonicRing, y: Harmonics, rate: Harmonics) -> Harmonics:
        """``y' h(y) + g(y)`` of one site, without the coupling."""
        return rate * _polynomial(ring, self.damping, y) + _polynomial(ring, self.stiffness, y)

    def force_change(
        self, ring: HarmonicRing, y: Harmonics, rate: Harmonics, dy: Harmonics, drate: Harmonics
    ) -> Harmonics:
        """Return the first-order change of ``force`` under ``y + dy``, ``rate + drate``."""
        slope = rate * _polynomial(ring, _derivative(self.damping), y)
        slope = slope + _polynomial(ring, _derivative(self.stiffness), y)
        return drate * _polynomial(ring, self.damping, y) + dy * slope

    def coupling_force(self, ring: HarmonicRing, y: Harmonics) -> Harmonics:
        """``c (2 y_n - y_{n-1} - y_{n+1})`` for a field given at the middle site."""
        if not self.is_chain:
            return Harmonics(ring, {})
        differences = y.scaled(2) - y.shifted(-1) - y.shifted(1)
        return differences.scaled(ring.element(self.coupling))


def van_der_pol(coupled: bool) -> Oscillator:
    """Return the cell of Eq. (8), ``h = 1 - a y^2 + b y^4``, isolated or in the chain."""
    a, b, c = sp.symbols("a b c", positive=True)
    return Oscillator({0: sp.Integer(1), 2: -a, 4: b}, {}, c if coupled else sp.Integer(0))


def _polynomial(ring: HarmonicRing, powers: Mapping[int, sp.Expr], y: Harmonics) -> Harmonics:
    total = Harmonics(ring, {})
    power = Harmonics(ring, {0: ring.ring.one})
    for exponent in range(max(powers, default=-1) + 1):
        if powers.get(exponent, 0) != 0:
            total = total + power.scaled(ring.element(powers[exponent]))
        power = power * y
    return total


def _derivative(powers: Mapping[int, sp.Expr]) -> dict[int, sp.Expr]:
    return {exponent - 1: exponent * value for exponent, value in powers.items() if exponent}
