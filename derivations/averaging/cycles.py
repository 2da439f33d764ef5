"""Limit cycles of an averaged cell: amplitudes, growth rates of perturbations, and their ratio."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import gcd
from typing import ClassVar

import sympy as sp

from derivations.algebra.equations import equation, parts_of
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.operations import Operation, OperationError
from derivations.averaging.symbols import radius, ratio, square
from derivations.symbols import epsilon


@dataclass(frozen=True, kw_only=True)
class LimitCycle:
    """A cycle of the averaged cell.

    Attributes
    ----------
    amplitude : Expr
        Amplitude of y (dimensionless).
    exponent : Expr
        Growth rate of a small change of the amplitude, per unit of ``eps t``.
    stability : str or None
        ``stable``, ``unstable`` or ``half-stable``; None if it depends on symbols.
    multiplicity : int
        Multiplicity of the root; if above 1, the cycle lies on a fold.
    """

    amplitude: sp.Expr
    exponent: sp.Expr
    stability: str | None
    multiplicity: int = 1


def damping_mean(amplitude: sp.Basic) -> sp.Expr:
    """Return H(s) of an amplitude equation ``r' = -(eps r/2) H(r^2)``."""
    return sp.expand(-2 * amplitude.rhs / (epsilon * radius)).subs(radius, sp.sqrt(square))


@lru_cache(maxsize=32)
def limit_cycles(damping_mean: sp.Expr) -> tuple[LimitCycle, ...]:
    """Return all limit cycles from the inner to the outer, with their stability.

    Parameters
    ----------
    damping_mean : Expr
        H(s) of ``r' = -(r/2) H(r^2)``.

    Raises
    ------
    DerivationInputError
        If the coefficients are symbols and the roots have no closed form.
    """
    if damping_mean.free_symbols - {square}:
        return _symbolic_cycles(damping_mean)
    polynomial = sp.Poly(damping_mean, square)
    roots = [(root, int(times)) for root, times in polynomial.real_roots(multiple=False)
             if root.is_positive]  # fmt: skip
    found = []
    for place, (root, times) in enumerate(roots):
        low = roots[place - 1][0] if place else sp.Integer(0)
        high = roots[place + 1][0] if place + 1 < len(roots) else 2 * root + 1
        before, after = (_sign_between(polynomial, *ends) for ends in ((low, root), (root, high)))
        kind = {(-1, 1): "stable", (1, -1): "unstable"}.get((before, after), "half-stable")
        found.append(LimitCycle(amplitude=sp.sqrt(root), exponent=_exponent(damping_mean, root),
                                stability=kind, multiplicity=times))  # fmt: skip
    return tuple(found)


def _symbolic_cycles(damping_mean: sp.Expr) -> tuple[LimitCycle, ...]:
    polynomial, power = _in_lowest_powers(damping_mean)
    if polynomial.degree() > 2:
        raise DerivationInputError(
            "averaged damping", damping_mean, "of degree at most 2 in s, or in a power of s, with "
            "letters in it", "give numbers for the letters, as in --value a=4",
        )  # fmt: skip
    if polynomial.degree() == 2:
        top, middle, low = polynomial.all_coeffs()
        # For a positive leading coefficient the minus sign belongs to the inner cycle.
        spread = sp.sqrt(sp.factor(middle**2 - 4 * top * low))
        roots = [(-middle + sign * spread) / (2 * top) for sign in (-1, 1)]
    else:
        roots = list(sp.roots(polynomial))
    squares = [sp.root(root, power) for root in map(sp.simplify, roots) if not root.is_nonpositive]
    return tuple(
        LimitCycle(amplitude=sp.sqrt(root), stability=None,
                   exponent=sp.simplify(_exponent(damping_mean, root)))
        for root in squares
    )  # fmt: skip


def _in_lowest_powers(damping_mean: sp.Expr) -> tuple[sp.Poly, int]:
    """Return H as a polynomial in the power of s for which its degree is lowest, and that power."""
    powers = [power for (power,) in sp.Poly(damping_mean, square).monoms()]
    common = gcd(*powers) or 1
    return sp.Poly(damping_mean.subs(square, sp.root(square, common)), square), common


def _exponent(damping_mean: sp.Expr, root: sp.Expr) -> sp.Expr:
    return -root * sp.diff(damping_mean, square).subs(square, root)


def _sign_between(polynomial: sp.Poly, low: sp.Expr, high: sp.Expr) -> int:
    """Return the sign of the polynomial between two neighbouring roots."""
    digits = 30
    while True:
        middle = sp.Rational(str(((low + high) / 2).evalf(digits)))
        if low < middle < high:
            return int(sp.sign(polynomial.eval(middle)))
        digits *= 2


def why_not_bistable(damping_mean: sp.Expr, cycles: tuple[LimitCycle, ...]) -> str | None:
    """Return why a cell lacks two cycles, the inner one unstable, around a stable rest state."""
    if len(cycles) != 2:
        return f"this one has {len(cycles)} limit cycle{'s' * (len(cycles) != 1)}"
    if cycles[0].stability is None:
        top, middle, low = _in_lowest_powers(damping_mean)[0].all_coeffs()
        allowed = top.is_positive and middle.is_negative and low.is_positive
        return None if allowed else "the signs of its terms do not allow two cycles"
    stable = [cycle.stability for cycle in cycles] == ["unstable", "stable"]
    if not damping_mean.subs(square, 0) > 0 or not stable:
        return "its rest state or its outer cycle is not stable"
    return None


def ratio_of_cycles(
    damping_mean: sp.Expr, cycles: tuple[LimitCycle, ...], damping: Mapping[int, sp.Expr]
) -> sp.Expr:
    """Return |phi_us| / |phi_s| of a cell with exactly two cycles, the inner one unstable.

    Parameters
    ----------
    damping_mean : Expr
        H(s).
    cycles : tuple of LimitCycle
        Its zeros.
    damping : mapping of int to Expr
        h(y), for the error message.

    Raises
    ------
    DerivationInputError
        If the cell is not of this kind.
    """
    why = why_not_bistable(damping_mean, cycles)
    if why is not None:
        raise DerivationInputError(
            "damping", shown(damping), "that of a cell with exactly two cycles around a stable "
            "rest state", f"{why}, so the simplified model of the front does not apply",
        )  # fmt: skip
    if cycles[0].stability is None:
        polynomial, power = _in_lowest_powers(damping_mean)
        top, middle, low = polynomial.all_coeffs()
        spread = sp.sqrt(sp.factor(1 - 4 * top * low / middle**2))
        return sp.sqrt(sp.root((1 - spread) / (1 + spread), power))
    return sp.simplify(cycles[0].amplitude / cycles[1].amplitude)


def shown(powers: Mapping[int, sp.Expr]) -> str:
    """Return a polynomial in y, given by its coefficients, as text."""
    y = sp.Symbol("y")
    return str(sum((value * y**power for power, value in powers.items()), sp.Integer(0)))


@dataclass(frozen=True)
class FindCycles(Operation):
    """Find all nonzero amplitudes at which the amplitude of a cell stays constant.

    Attributes
    ----------
    names : tuple of Expr
        Names of the unstable and the stable one of two cycles, for whose squares the result is
        written; empty for any number of cycles, ``r_1``, ``r_2``, …
    """

    phrase: ClassVar[str] = (
        "solve {sources} for constant amplitudes other than zero: the limit cycles"
    )
    names: tuple[sp.Expr, ...] = ()

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``r_1 = …``, or ``name² = …``, from the inner to the outer cycle."""
        (amplitude,) = sources
        mean = damping_mean(amplitude)
        cycles = limit_cycles(mean)
        if not self.names:
            return sp.Tuple(*(equation(sp.Symbol(f"r_{place}"), cycle.amplitude)
                              for place, cycle in enumerate(cycles, start=1)))  # fmt: skip
        why = why_not_bistable(mean, cycles)
        if why is not None:
            raise OperationError(f"not two cycles around a stable rest state: {why}")
        return sp.Tuple(*(equation(name**2, sp.simplify(cycle.amplitude**2))
                          for name, cycle in zip(self.names, cycles, strict=True)))  # fmt: skip


@dataclass(frozen=True)
class GrowthRates(Operation):
    """Find the growth rate of a small change of the amplitude of each cycle.

    The sources are the rate of the amplitude, and the cycles, given by amplitudes or their squares.

    Attributes
    ----------
    unit : Expr
        Unit of the rates.
    names : tuple of Expr
        Names of the rates; empty for ``lambda_1``, ``lambda_2``, …
    """

    phrase: ClassVar[str] = "linearise {first} about {others}"
    unit: sp.Expr = sp.S.One
    names: tuple[sp.Expr, ...] = ()

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = rate`` for the cycles of the second source."""
        amplitude, cycles = sources
        slope = sp.diff(amplitude.rhs.subs(radius, square) / self.unit, square)
        sizes = [sp.root(part.rhs, part.lhs.as_base_exp()[1]) for part in parts_of(cycles)]
        names = self.names or [sp.Symbol(f"lambda_{place + 1}") for place in range(len(sizes))]
        return sp.Tuple(*(equation(name, sp.simplify(slope.subs(square, size)))
                          for name, size in zip(names, sizes, strict=True)))  # fmt: skip


@dataclass(frozen=True)
class RatioOfCycles(Operation):
    """Divide the unstable by the stable cycle of a cell that has two cycles."""

    phrase: ClassVar[str] = "divide the unstable by the stable cycle of {sources}"

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``|phi_us|/|phi_s| = …``."""
        (amplitude,) = sources
        mean = damping_mean(amplitude)
        return equation(ratio, ratio_of_cycles(mean, limit_cycles(mean), {}))


@dataclass(frozen=True)
class RatioOfAmplitudes(Operation):
    """Divide the inner by the outer amplitude.

    Attributes
    ----------
    factor : int
        Factor by which both sides are multiplied.
    """

    phrase: ClassVar[str] = "divide the inner by the outer amplitude of {sources}"
    factor: int

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``factor inner / outer = factor sqrt(ratio of squares)``."""
        (source,) = sources
        inner, outer = parts_of(source)
        named = inner.lhs.base / outer.lhs.base
        value = sp.sqrt(sp.cancel(sp.together(inner.rhs / outer.rhs)))
        return equation(self.factor * named, self.factor * value)
