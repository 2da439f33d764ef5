"""Operations that locate the roots of an entire function: parts on a line, and the argument."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp

from derivations.algebra.equations import equation, parts_of
from derivations.algebra.operations import Operation, OperationError, listed, spoken


@dataclass(frozen=True)
class PartsOnLine(Operation):
    """Real and imaginary part of the right side on a line of the complex plane.

    Attributes
    ----------
    values : mapping of Symbol to Expr
        The variable on the line, by real symbols, and what else is known there.
    names : tuple of Symbol
        What the two parts are called.
    """

    values: Mapping[sp.Symbol, sp.Expr] = field(hash=False)
    names: tuple[sp.Symbol, sp.Symbol]

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``real part = ...`` and ``imaginary part = ...``."""
        (source,) = sources
        plain = sp.expand(source.rhs.subs(self.values, simultaneous=True), trig=True, complex=True)
        real, imaginary = (sp.expand(sp.simplify(q)) for q in plain.as_real_imag())
        return sp.Tuple(*map(equation, self.names, (real, imaginary)))

    def words(self, labels: Sequence[str]) -> str:
        """Name the line."""
        pairs = [f"{spoken(own)} = {spoken(value)}" for own, value in self.values.items()]
        return f"take real and imaginary part of {listed(labels)} on {listed(pairs)}"


@dataclass(frozen=True)
class CountAbove(Operation):
    """Count roots in a half-infinite strip of the upper half-plane by the argument principle.

    The sources are the function, and its parts on the real axis and on the sides of the strip. On
    these the real part must be positive: along them the argument stays within a quarter turn of
    zero. Far up the growing exponential decides: its argument turns by the width of the strip.

    Attributes
    ----------
    wavenumber : Symbol
        The variable.
    left : int
        Left side of the strip, in units of pi; the right side is pi further on.
    name : Symbol
        What the number is called.
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
        growing = sp.expand(function.rhs.rewrite(sp.exp)).coeff(wave)
        ends = [sp.arg(growing.subs(_ones(growing)) * sp.exp(-sp.I * sp.pi * q))
                for q in (self.left, self.left + 1)]  # fmt: skip
        width = sp.pi
        return equation(self.name, sp.simplify((width + ends[1] - ends[0]) / (2 * sp.pi)))

    def words(self, labels: Sequence[str]) -> str:
        """Name the strip."""
        return (
            f"count the roots of {labels[0]} with {self.left}π < Re {spoken(self.wavenumber)} < "
            f"{self.left + 1}π above the axis: by {listed(labels[1:])} only the far end turns the "
            "argument"
        )


def _ones(expression: sp.Expr) -> dict[sp.Symbol, int]:
    """Return one for each positive symbol: the argument does not depend on them."""
    return {q: 1 for q in expression.free_symbols if q.is_positive}
