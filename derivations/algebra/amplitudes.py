"""Operations that carry multiple scales and averaging to second order, and read off cycles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp
from sympy.core.function import AppliedUndef

from derivations.algebra.equations import equation, left_minus_right
from derivations.algebra.harmonics import Coefficient, HarmonicRing, Harmonics, chain_ring
from derivations.algebra.modulation import (
    Force,
    Modulation,
    by_averaging,
    by_multiple_scales,
    fundamental_shift,
    in_scales_amplitude,
)
from derivations.algebra.operations import Operation, OperationError, listed
from derivations.algebra.oscillation import complex_parts


def _site_of(motion: sp.Basic) -> tuple[sp.Expr, sp.Symbol]:
    """Return index and time of the site that a modulation or motion is written for."""
    (own,) = {q.expr for q in left_minus_right(motion).atoms(sp.Derivative)}
    index, time = own.args
    return index, time


def _as_fields(
    ring: HarmonicRing, value: Coefficient, function: sp.FunctionClass, index: sp.Expr,
    time: sp.Symbol,
) -> sp.Expr:  # fmt: skip
    """Write a ring element with ``function(index + offset, time)`` for the amplitudes."""
    names = {symbol: function(index + offset, time)
             for offset, symbol in enumerate(ring.amplitudes, start=-ring.reach)}  # fmt: skip
    return ring.as_expr(value).xreplace(names)


def _from_fields(
    expression: sp.Expr, function: sp.FunctionClass, index: sp.Expr, small: sp.Symbol, powers: int
) -> tuple[HarmonicRing, list[Coefficient]]:
    """Return a ring and the coefficients of ``small**0 …`` of an expression in a field."""
    found = {q: int(q.args[0] - index) for q in expression.atoms(AppliedUndef)
             if q.func == function}  # fmt: skip
    reach = max((abs(offset) for offset in found.values()), default=0)
    parameters = sorted(expression.free_symbols - {small, *index.free_symbols}, key=str)
    times = {q.args[1] for q in found}
    ring = chain_ring("z", [q for q in parameters if q not in times], reach)
    names: dict[sp.Basic, sp.Symbol] = {}
    for field, offset in found.items():
        names[sp.conjugate(field)] = ring.conjugates[offset + reach]
        names[field] = ring.amplitudes[offset + reach]
    polynomial = sp.Poly(sp.expand(expression.xreplace(names)), small)
    return ring, [ring.element(polynomial.coeff_monomial(small**m)) for m in range(powers + 1)]


@dataclass(frozen=True)
class ScalesToSecondOrder(Operation):
    """Multiple scales to second order: secular terms are removed at both orders.

    Attributes
    ----------
    small : Symbol
        The small parameter.
    amplitude : function class
        Of ``y_n = A_n e^{it} + c.c. + eps y_n^{(1)}``.
    order : int
        1 or 2.
    """

    small: sp.Symbol
    amplitude: sp.FunctionClass
    order: int = 2

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation of dA_n/dt."""
        (motion,) = sources
        index, time = _site_of(motion)
        found = by_multiple_scales(Force.read(motion, self.small), self.order)
        right = _total(found, self.small, self.amplitude, index, time)
        return equation(self.amplitude(index, time).diff(time), right)

    def words(self, labels: Sequence[str]) -> str:
        """Name the expansion."""
        return (
            f"put y = A e^(it) + c.c. + εy⁽¹⁾ with the times T₀, T₁ and T₂ into {listed(labels)}, "
            "solve for y⁽¹⁾, and remove secular terms at both orders"
        )


@dataclass(frozen=True)
class AverageToSecondOrder(Operation):
    """Averaging to second order: a near-identity change removes what oscillates.

    Attributes
    ----------
    small : Symbol
        The small parameter.
    envelope : function class
        Of ``y' + i y = phi e^{it}``.
    order : int
        1 or 2.
    """

    small: sp.Symbol
    envelope: sp.FunctionClass
    order: int = 2

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation of the mean of phi."""
        (motion,) = sources
        index, time = _site_of(motion)
        found = by_averaging(Force.read(motion, self.small), self.order)
        right = _total(found, self.small, self.envelope, index, time)
        return equation(self.envelope(index, time).diff(time), right)

    def words(self, labels: Sequence[str]) -> str:
        """Name the change of variable."""
        return (
            f"put y′ + iy = φ e^(it) into {listed(labels)} and average, with the oscillating part "
            "of φ removed by a near-identity change of variable"
        )


def _total(
    found: Modulation, small: sp.Symbol, function: sp.FunctionClass, index: sp.Expr,
    time: sp.Symbol,
) -> sp.Expr:  # fmt: skip
    right = small * _as_fields(found.ring, found.first, function, index, time)
    if found.second is not None:
        right += small**2 * _as_fields(found.ring, found.second, function, index, time)
    return right


@dataclass(frozen=True)
class FundamentalOfAverage(Operation):
    """Fundamental of y in the mean of phi: what oscillates in phi contributes to it.

    Attributes
    ----------
    small : Symbol
        The small parameter.
    envelope : function class
        The mean of phi.
    name : Symbol
        What the fundamental is called.
    """

    small: sp.Symbol
    envelope: sp.FunctionClass
    name: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = -(i/2)(phi + eps W)``."""
        (motion,) = sources
        index, time = _site_of(motion)
        found = by_averaging(Force.read(motion, self.small), 1)
        shift = _as_fields(found.ring, fundamental_shift(found), self.envelope, index, time)
        return equation(self.name, -sp.I / 2 * (self.envelope(index, time) + self.small * shift))

    def words(self, labels: Sequence[str]) -> str:
        """Name the harmonic."""
        return f"take the coefficient of e^(it) in the displacement of {listed(labels)}"


@dataclass(frozen=True)
class ChangeAmplitude(Operation):
    """Rewrite an averaged equation for the fundamental of the displacement.

    The sources are the averaged equation and the fundamental in terms of its variable.

    Attributes
    ----------
    small : Symbol
        The small parameter.
    envelope, amplitude : function classes
        The variable before and after.
    """

    small: sp.Symbol
    envelope: sp.FunctionClass
    amplitude: sp.FunctionClass

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation of the fundamental."""
        averaged, fundamental = sources
        index, time = _site_of(averaged)
        scaled = sp.expand(fundamental.rhs * 2 * sp.I)
        # One expression, so that both share a ring: the shift is tagged with a high power.
        tagged = averaged.rhs + self.small**3 * scaled
        ring, parts = _from_fields(sp.expand(tagged), self.envelope, index, self.small, 4)
        _, first, second, own, shift = parts
        if own != ring.amplitude(0):
            raise OperationError("the fundamental is not -(i/2) φ to leading order")
        modulation = Modulation(ring, ring.reach // 2, first, second, Harmonics(ring, {}))
        first, second = in_scales_amplitude(modulation, shift)
        right = sum((self.small**m * _as_fields(ring, part, self.amplitude, index, time)
                     for m, part in ((1, first), (2, second))), sp.S.Zero)  # fmt: skip
        return equation(self.amplitude(index, time).diff(time), right)

    def words(self, labels: Sequence[str]) -> str:
        """Name the change."""
        return f"rewrite {labels[0]} for the fundamental of the displacement by {labels[1]}"


@dataclass(frozen=True)
class NextHarmonics(Operation):
    """The first correction of the displacement: all harmonics but the fundamental.

    Attributes
    ----------
    small : Symbol
        The small parameter.
    amplitude : function class
        The complex amplitude.
    name : Symbol
        What the correction is called.
    turn : Symbol
        ``e^{it}``.
    """

    small: sp.Symbol
    amplitude: sp.FunctionClass
    name: sp.Symbol
    turn: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = sum of coefficients times powers of e^{it}``."""
        (motion,) = sources
        index, time = _site_of(motion)
        found = by_multiple_scales(Force.read(motion, self.small), 1)
        wave = sum((_as_fields(found.ring, value, self.amplitude, index, time) * self.turn**m
                    for m, value in sorted(found.correction.terms.items())), sp.S.Zero)  # fmt: skip
        return equation(self.name, wave)

    def words(self, labels: Sequence[str]) -> str:
        """Name the order."""
        return f"solve {listed(labels)} at order ε for what is not resonant"


@dataclass(frozen=True)
class _OfCycle(Operation):
    """Common to what is read off the modulation of a cell.

    Attributes
    ----------
    small : Symbol
        The small parameter.
    amplitude : function class
        The complex amplitude A of ``e^{it}``.
    square : Symbol
        Square of the amplitude of y, ``4 |A|²``.
    """

    small: sp.Symbol
    amplitude: sp.FunctionClass
    square: sp.Symbol

    def _rates(self, modulation: sp.Basic) -> list[tuple[sp.Expr, sp.Expr]]:
        """Real and imaginary part of A'/A at each order from the first, in the square."""
        field = modulation.lhs.expr
        steady = sp.expand(modulation.rhs.subs(field, sp.sqrt(self.square) / 2).doit())
        relative = sp.Poly(sp.expand(steady * 2 / sp.sqrt(self.square)), self.small)
        return [complex_parts(relative.coeff_monomial(self.small**m)) for m in (1, 2)]

    def _shift(self, rates: list[tuple[sp.Expr, sp.Expr]]) -> sp.Expr:
        """Return what the second order adds to the square of the amplitude of a cycle."""
        (first, _), (second, _) = rates
        if second == 0:
            return sp.S.Zero
        return sp.cancel(-second / sp.diff(first, self.square))


@dataclass(frozen=True)
class CycleAmplitude(_OfCycle):
    """Amplitudes at which a cell neither gains nor loses energy, to first order."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``damping of the mean = 0`` in the square of the amplitude."""
        (modulation,) = sources
        return equation(-2 * self._rates(modulation)[0][0])

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"seek constant amplitudes of {listed(labels)} to first order"


@dataclass(frozen=True)
class CycleFrequency(_OfCycle):
    """Frequency of a cycle of a cell to second order.

    Attributes
    ----------
    name : Symbol
        What the frequency is called.
    """

    name: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = 1 + …`` in the square of the amplitude to first order."""
        (modulation,) = sources
        rates = self._rates(modulation)
        (_, first), (_, second) = rates
        moved = sp.diff(first, self.square) * self._shift(rates)
        return equation(self.name, 1 + self.small * first + self.small**2 * (second + moved))

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"take the turning of the amplitude of {listed(labels)} on a cycle"


@dataclass(frozen=True)
class CycleFundamental(_OfCycle):
    """Amplitude of the fundamental of a cycle of a cell, with its first correction.

    Attributes
    ----------
    name : Symbol
        What ``|A|`` is called.
    """

    name: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``|A| = √s/2 + eps …``."""
        (modulation,) = sources
        shift = self._shift(self._rates(modulation))
        root = sp.sqrt(self.square)
        return equation(self.name, root / 2 + self.small * shift / (4 * root))

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"seek constant amplitudes of {listed(labels)} to second order"


@dataclass(frozen=True)
class EliminatePowers(Operation):
    """Lower the powers of a symbol by a polynomial equation that it satisfies.

    Attributes
    ----------
    symbol : Symbol
        The symbol.
    """

    symbol: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the first source with the remainder of its right side."""
        target, relation = sources
        if not target.rhs.is_polynomial(self.symbol):
            return target
        own = sp.Poly(left_minus_right(relation), self.symbol)
        rest = sp.rem(sp.Poly(sp.expand(target.rhs), self.symbol), own)
        terms = sp.collect(sp.expand(rest.as_expr()), self.symbol)
        return equation(target.lhs, terms)

    def words(self, labels: Sequence[str]) -> str:
        """Name the relation."""
        return f"lower the powers in {labels[0]} by {labels[1]}"
