"""Operations on roots of an entire function, their terms, and square roots of complex numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import sympy as sp

from derivations.algebra.equations import equation, parts_of
from derivations.algebra.operations import Operation, OperationError, inline, listed


@dataclass(frozen=True)
class CountAbove(Operation):
    """Count roots in a half-infinite strip of the upper half-plane by the argument principle.

    The sources are the function, and its values on the real axis and on the sides of the strip.
    There the real part must be positive, so that the argument stays within a quarter turn of zero.
    Far up, the growing exponential dominates, and its argument changes by the width of the strip.

    Attributes
    ----------
    wavenumber : Symbol
        The variable.
    left : int
        Left side of the strip, in units of pi; the right side is further on by pi.
    name : Symbol
        Name of the number.
    """

    wavenumber: sp.Symbol
    left: int
    name: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = number``."""
        function, axis, sides = sources
        for lines in (axis, sides):
            real = parts_of(lines)[0].rhs
            heights = {q: sp.Dummy("y", nonnegative=True) for q in real.free_symbols
                       if not q.is_positive}  # fmt: skip
            if not real.subs(heights).is_positive:
                raise OperationError(f"the real part {real} may vanish on the boundary")
        wave = sp.exp(-sp.I * self.wavenumber)
        dominant = sp.expand(function.rhs.rewrite(sp.exp)).coeff(wave)
        ends = [sp.arg(dominant.subs(_ones(dominant)) * sp.exp(-sp.I * sp.pi * q))
                for q in (self.left, self.left + 1)]  # fmt: skip
        width = sp.pi
        return equation(self.name, sp.simplify((width + ends[1] - ends[0]) / (2 * sp.pi)))

    def words(self, labels: Sequence[str]) -> str:
        """Name the strip."""
        left, right = (inline(edge * sp.pi) for edge in (self.left, self.left + 1))
        return (
            f"count the roots of {labels[0]} with {left} < Re {inline(self.wavenumber)} < {right} "
            f"above the axis: by {listed(labels[1:])} only the far end changes the argument"
        )


def _ones(expression: sp.Expr) -> dict[sp.Symbol, int]:
    """Return the value one for each positive symbol, on which the argument does not depend."""
    return {q: 1 for q in expression.free_symbols if q.is_positive}


@dataclass(frozen=True)
class RootTerm(Operation):
    """Evaluate ``1/(k dL/dk)`` at a root of L, one term of the sum over roots.

    The first source is L, the second the root.

    Attributes
    ----------
    name : Symbol
        Name of the term.
    """

    phrase: ClassVar[str] = "evaluate the term of the sum of {first} at {others}"
    name: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = term``."""
        function, root = sources
        term = 1 / (root.lhs * sp.diff(function.rhs, root.lhs))
        return equation(self.name, 1 / sp.factor(sp.expand(1 / term.subs(root.lhs, root.rhs))))


@dataclass(frozen=True)
class ParametriseRadical(Operation):
    """Write the square root of ``1 - i x`` as ``p - i sqrt(p² - 1)``, and x in terms of p.

    Attributes
    ----------
    parameter : Symbol
        p, above one for x > 0.
    variable : Symbol
        The quantity that is solved for.
    """

    phrase: ClassVar[str] = "write the square root in {sources} by its real part {parameter}"
    parameter: sp.Symbol
    variable: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the square root and the variable in terms of the parameter."""
        (source,) = sources
        roots = [q for q in source.rhs.atoms(sp.Pow) if abs(q.exp) == sp.Rational(1, 2)]
        if len(roots) != 1:
            raise OperationError("not one square root")
        radicand = sp.expand(roots[0].base)
        real, imaginary = radicand.as_real_imag()
        if real.has(self.variable) or not (-imaginary).is_positive:
            raise OperationError("the radicand is not a constant minus i times a positive term")
        partner = sp.sqrt(self.parameter**2 - real)
        (value,) = sp.solve(imaginary + 2 * self.parameter * partner, self.variable)
        return sp.Tuple(
            equation(sp.sqrt(roots[0].base), self.parameter - sp.I * partner),
            equation(self.variable, value),
        )


@dataclass(frozen=True)
class SquareModulus(Operation):
    """Insert a parametrised root into ``|z| = size`` and square: ``z z* = size²``.

    The first source is the relation and the value of z, the second the parametrisation, whose first
    part is the root.

    Attributes
    ----------
    parameter : Symbol
        A real parameter.
    """

    phrase: ClassVar[str] = "insert {others} into {first} and square"
    parameter: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return a rational equation for the parameter."""
        system, parametrised = sources
        relation, value = parts_of(system)
        root = parts_of(parametrised)[0]
        if relation.lhs != sp.Abs(value.lhs):
            raise OperationError(f"{relation.lhs} is not the modulus of {value.lhs}")
        partner = sp.Dummy("q", real=True)
        (power,) = (q for q in root.rhs.atoms(sp.Pow) if q.exp == sp.Rational(1, 2))
        z_value = value.rhs.subs(root.lhs, root.rhs.subs(power, partner))
        square = sp.cancel(sp.together(sp.expand(z_value * sp.conjugate(z_value))))
        numerator, denominator = (sp.expand(q).subs(partner**2, power.base)
                       for q in (sp.numer(square), sp.denom(square)))  # fmt: skip
        reduced = sp.cancel(numerator / denominator)
        if reduced.has(partner):
            raise OperationError("the modulus is not rational in the parameter")
        return equation(reduced, relation.rhs**2)
