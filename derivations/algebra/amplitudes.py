"""Operations that carry multiple scales and averaging to second order, and extract cycles."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import ClassVar

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
    """Return index and time of the site for which a modulation or motion is written."""
    (field,) = {q.expr for q in left_minus_right(motion).atoms(sp.Derivative)}
    index, time = field.args
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
    """Return a ring, and the coefficients of ``small**0 …`` of an expression in a field."""
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


class Route(Enum):
    """Route by which a modulation equation is found; the value describes it in words."""

    MULTIPLE_SCALES = (
        "insert y = A e^(it) + c.c. + εy⁽¹⁾ with the times T₀, T₁ and T₂ into {}, solve for y⁽¹⁾, "
        "and remove secular terms at both orders"
    )
    AVERAGING = (
        "insert y′ + iy = φ e^(it) into {} and average, with the oscillating part of φ removed by "
        "a near-identity change of variable"
    )


@dataclass(frozen=True)
class FindModulation(Operation):
    """Find the slow equation of the complex amplitude of an oscillation, to first or second order.

    Attributes
    ----------
    route : Route
        By multiple scales for A of ``y_n = A_n e^{it} + c.c. + eps y_n^{(1)}``, or by averaging
        for the mean of phi in ``y' + i y = phi e^{it}``.
    small : Symbol
        The small parameter.
    amplitude : function class
        The complex amplitude.
    order : int
        1 or 2.
    """

    route: Route
    small: sp.Symbol
    amplitude: sp.FunctionClass
    order: int

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``rate of the amplitude = ...``."""
        (motion,) = sources
        index, time = _site_of(motion)
        find = by_multiple_scales if self.route is Route.MULTIPLE_SCALES else by_averaging
        found = find(Force.read(motion, self.small), self.order)
        right = self.small * _as_fields(found.ring, found.first, self.amplitude, index, time)
        if found.second is not None:
            second = _as_fields(found.ring, found.second, self.amplitude, index, time)
            right += self.small**2 * second
        return equation(self.amplitude(index, time).diff(time), right)

    def words(self, labels: Sequence[str]) -> str:
        """Name the route."""
        return self.route.value.format(listed(labels))


@dataclass(frozen=True)
class FundamentalOfAverage(Operation):
    """Express the fundamental of y by the mean of phi, including the oscillating part of phi.

    Attributes
    ----------
    small : Symbol
        The small parameter.
    envelope : function class
        The mean of phi.
    name : Symbol
        Name of the fundamental.
    """

    phrase: ClassVar[str] = "take the coefficient of e^(it) in the displacement of {sources}"
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

    phrase: ClassVar[str] = "rewrite {first} for the fundamental of the displacement by {others}"
    small: sp.Symbol
    envelope: sp.FunctionClass
    amplitude: sp.FunctionClass

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation of the fundamental."""
        averaged, fundamental = sources
        index, time = _site_of(averaged)
        scaled = sp.expand(fundamental.rhs * 2 * sp.I)
        # As one expression, both share a ring; a high power of the small parameter marks the shift.
        tagged = averaged.rhs + self.small**3 * scaled
        ring, parts = _from_fields(sp.expand(tagged), self.envelope, index, self.small, 4)
        _, first, second, leading, shift = parts
        if leading != ring.amplitude(0):
            raise OperationError("the fundamental is not -(i/2) φ to leading order")
        modulation = Modulation(ring, ring.reach // 2, first, second, Harmonics(ring, {}))
        first, second = in_scales_amplitude(modulation, shift)
        right = sum((self.small**m * _as_fields(ring, part, self.amplitude, index, time)
                     for m, part in ((1, first), (2, second))), sp.S.Zero)  # fmt: skip
        return equation(self.amplitude(index, time).diff(time), right)


@dataclass(frozen=True)
class NextHarmonics(Operation):
    """Find the first correction of the displacement: all harmonics but the fundamental.

    Attributes
    ----------
    small : Symbol
        The small parameter.
    amplitude : function class
        The complex amplitude.
    name : Symbol
        Name of the correction.
    turn : Symbol
        ``e^{it}``.
    """

    phrase: ClassVar[str] = "solve {sources} at order ε for the non-resonant terms"
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


@dataclass(frozen=True)
class SeekCycles(Operation):
    """Find the cycles of a cell to second order: constant amplitudes of its modulation.

    Attributes
    ----------
    small : Symbol
        The small parameter.
    amplitude : function class
        The complex amplitude A of ``e^{it}``.
    square : Symbol
        Square of the amplitude of y to first order, ``4 |A|²``.
    frequency, size : Symbol
        Names of the frequency and of ``|A|`` to second order.
    """

    phrase: ClassVar[str] = (
        "seek constant amplitudes of {sources}: where the damping vanishes, and their frequency "
        "and size"
    )
    small: sp.Symbol
    amplitude: sp.FunctionClass
    square: sp.Symbol
    frequency: sp.Symbol
    size: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``damping of the mean = 0``, and frequency and size as functions of the square."""
        (modulation,) = sources
        (growth_1, frequency_1), (growth_2, frequency_2) = self._rates(modulation)
        square_shift = (
            sp.S.Zero if growth_2 == 0 else sp.cancel(-growth_2 / sp.diff(growth_1, self.square))
        )
        frequency_shift = sp.diff(frequency_1, self.square) * square_shift
        root = sp.sqrt(self.square)
        return sp.Tuple(
            equation(-2 * growth_1),
            equation(
                self.frequency,
                1 + self.small * frequency_1 + self.small**2 * (frequency_2 + frequency_shift),
            ),
            equation(self.size, root / 2 + self.small * square_shift / (4 * root)),
        )

    def _rates(self, modulation: sp.Basic) -> list[tuple[sp.Expr, sp.Expr]]:
        """Return the parts of A'/A at each order from the first, as functions of the square."""
        field = modulation.lhs.expr
        steady = sp.expand(modulation.rhs.subs(field, sp.sqrt(self.square) / 2).doit())
        relative = sp.Poly(sp.expand(steady * 2 / sp.sqrt(self.square)), self.small)
        return [complex_parts(relative.coeff_monomial(self.small**m)) for m in (1, 2)]
