"""Operations on square roots of complex numbers, and on limits of strong coupling."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp

from derivations.algebra.equations import equation, on_sides, parts_of
from derivations.algebra.operations import Operation, OperationError, listed, spoken
from derivations.algebra.sums import SumOver


@dataclass(frozen=True)
class Expand(Operation):
    """Multiply products of sums out, but not under integrals."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the expanded source."""
        (source,) = sources
        return on_sides(source, lambda side: sp.expand(side, deep=False))

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"expand {listed(labels)}"


@dataclass(frozen=True)
class ParametriseRadical(Operation):
    """Write the square root of ``1 - i x`` as ``p - i sqrt(p² - 1)``, and x by p.

    Attributes
    ----------
    parameter : Symbol
        p, above one for x > 0.
    variable : Symbol
        What is solved for.
    """

    parameter: sp.Symbol
    variable: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the square root and the variable, both by the parameter."""
        (source,) = sources
        roots = [q for q in source.rhs.atoms(sp.Pow) if abs(q.exp) == sp.Rational(1, 2)]
        if len(roots) != 1:
            raise OperationError("not one square root")
        radicand = sp.expand(roots[0].base)
        real, imaginary = radicand.as_real_imag()
        if real.has(self.variable) or not (-imaginary).is_positive:
            raise OperationError("the radicand is not a constant minus i times what is positive")
        partner = sp.sqrt(self.parameter**2 - real)
        (value,) = sp.solve(imaginary + 2 * self.parameter * partner, self.variable)
        return sp.Tuple(
            equation(sp.sqrt(roots[0].base), self.parameter - sp.I * partner),
            equation(self.variable, value),
        )

    def words(self, labels: Sequence[str]) -> str:
        """Name the parameter."""
        return (
            f"write the square root in {listed(labels)} by its real part {spoken(self.parameter)}"
        )


@dataclass(frozen=True)
class SquareModulus(Operation):
    """Put a parametrised root into ``|z| = size`` and square: ``z z* = size²``.

    The first source is the relation and the value of z, the second the parametrisation, whose first
    part is the root.

    Attributes
    ----------
    parameter : Symbol
        A real parameter.
    """

    parameter: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return a rational equation of the parameter."""
        system, parametrised = sources
        relation, value = parts_of(system)
        root = parts_of(parametrised)[0]
        if relation.lhs != sp.Abs(value.lhs):
            raise OperationError(f"{relation.lhs} is not the modulus of {value.lhs}")
        partner = sp.Dummy("q", real=True)
        (power,) = (q for q in root.rhs.atoms(sp.Pow) if q.exp == sp.Rational(1, 2))
        inside = value.rhs.subs(root.lhs, root.rhs.subs(power, partner))
        square = sp.cancel(sp.together(sp.expand(inside * sp.conjugate(inside))))
        top, bottom = (sp.expand(q).subs(partner**2, power.base)
                       for q in (sp.numer(square), sp.denom(square)))  # fmt: skip
        reduced = sp.cancel(top / bottom)
        if reduced.has(partner) or reduced.has(sp.I):
            raise OperationError("the modulus is not rational in the parameter")
        return equation(reduced, relation.rhs**2)

    def words(self, labels: Sequence[str]) -> str:
        """Name the sources."""
        return f"put {listed(labels[1:])} into {labels[0]} and square"


@dataclass(frozen=True)
class VanishingDenominator(Operation):
    """Find where the right side grows without bound: its denominator vanishes."""

    unknown: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``unknown = positive root of the denominator``."""
        (source,) = sources
        bottom = sp.denom(sp.together(source.rhs))
        roots = [root for root in sp.solve(bottom, self.unknown) if root.is_positive]
        if len(roots) != 1:
            raise OperationError("not one positive zero of the denominator")
        return equation(self.unknown, roots[0])

    def words(self, labels: Sequence[str]) -> str:
        """Name the unknown."""
        return (
            f"let the denominator in {listed(labels)} vanish and solve for {spoken(self.unknown)}"
        )


@dataclass(frozen=True)
class ScaledLimit(Operation):
    """Scale variables with a parameter and let it go to infinity.

    Attributes
    ----------
    scales : mapping of Symbol to Expr
        What is put for each variable.
    parameter : Symbol
        What goes to infinity.
    name : Expr
        What the limit of the right side is called.
    """

    scales: Mapping[sp.Symbol, sp.Expr] = field(hash=False)
    parameter: sp.Symbol
    name: sp.Expr

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = limit``."""
        (source,) = sources
        put = source.rhs.subs(self.scales, simultaneous=True)
        # Cosines of a vanishing argument: the series in 1/sqrt(parameter) has few terms.
        small = sp.Dummy("s", positive=True)
        near = put.subs(self.parameter, small**-2)
        found = sp.series(near, small, 0, 1).removeO()
        if found.has(small):
            raise OperationError("the right side has no limit")
        return equation(self.name, sp.expand(found))

    def words(self, labels: Sequence[str]) -> str:
        """Name the scales."""
        pairs = [f"{spoken(own)} = {spoken(new)}" for own, new in self.scales.items()]
        return f"put {listed(pairs)} into {listed(labels)} and let {spoken(self.parameter)} → ∞"


@dataclass(frozen=True)
class RootTerm(Operation):
    """Evaluate ``1/(k dL/dk)`` at a root of L: one term of the sum over roots.

    The first source is L, the second the root.

    Attributes
    ----------
    name : Symbol
        What the term is called.
    """

    name: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = term``."""
        function, root = sources
        term = 1 / (root.lhs * sp.diff(function.rhs, root.lhs))
        return equation(self.name, 1 / sp.factor(sp.expand(1 / term.subs(root.lhs, root.rhs))))

    def words(self, labels: Sequence[str]) -> str:
        """Name the sources."""
        return f"evaluate the term of the sum of {labels[0]} at {listed(labels[1:])}"


@dataclass(frozen=True)
class AddHalfPlanes(Operation):
    """Write ``a = f(b)`` as ``a + b = constant``."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation with both unknowns on the left."""
        (source,) = sources
        moved = sp.expand(source.lhs - source.rhs)
        constant, kept = moved.as_independent(SumOver, as_Add=True)
        return equation(kept, -constant)

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"bring both sums of {listed(labels)} to the left"


@dataclass(frozen=True)
class EquateRatio(Operation):
    """Give a short name to a quotient of which twice is on the left side."""

    name: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = half of the right side``."""
        (source,) = sources
        number, _ = source.lhs.as_coeff_Mul()
        return equation(self.name, source.rhs / number)

    def words(self, labels: Sequence[str]) -> str:
        """Name it."""
        return f"call the quotient of {listed(labels)} {spoken(self.name)}"


@dataclass(frozen=True)
class SquareSides(Operation):
    """Square both sides."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``left² = right²``."""
        (source,) = sources
        return on_sides(source, lambda side: sp.cancel(side**2))

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"square {listed(labels)}"


@dataclass(frozen=True)
class PutZero(Operation):
    """Let the named left side vanish."""

    name: sp.Basic

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``0 = right side``."""
        (source,) = sources
        if source.lhs != self.name:
            raise OperationError(f"{source.lhs} is not {self.name}")
        return equation(source.rhs, 0)

    def words(self, labels: Sequence[str]) -> str:
        """Name what vanishes."""
        return f"let {spoken(self.name)} of {listed(labels)} vanish"
