"""Operations on the slow equations of a cell: stationary amplitudes, branches, decay rates."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp
from sympy.core.function import AppliedUndef

from derivations.algebra.equations import equation, left_minus_right, on_sides, parts_of
from derivations.algebra.operations import Operation, OperationError, listed


def probe_values(symbols: set[sp.Symbol], least: float = 0.0) -> list[dict[sp.Symbol, float]]:
    """Return a few sets of positive numbers for symbols, for choices that cannot depend on them."""
    named = sorted(symbols, key=str)
    return [
        {symbol: least + scale * (1 + (2 * place % 5) / 3) for place, symbol in enumerate(named)}
        for scale in (0.1, 0.4, 1.3, 4.0)
    ]


@dataclass(frozen=True)
class StationaryAmplitudes(Operation):
    """Find the amplitudes at which a cell neither gains nor loses: two cycles, by size.

    Attributes
    ----------
    amplitude : Expr
        The amplitude, a function of time.
    names : tuple of Expr
        What the inner and the outer amplitude are called.
    """

    amplitude: sp.Expr
    names: tuple[sp.Expr, sp.Expr]

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name² = value`` for the inner and the outer cycle."""
        (source,) = sources
        square = sp.Dummy("s", positive=True)
        size = sp.Dummy("r", positive=True)
        rate = sp.cancel(source.rhs.subs(self.amplitude, size) / size)
        plain = sp.expand(rate).subs(size, sp.sqrt(square))
        found = sp.solve(sp.numer(sp.together(plain)), square)
        kept = _two_by_size(found, plain.free_symbols - {square})
        return sp.Tuple(
            *(equation(name**2, root) for name, root in zip(self.names, kept, strict=True))
        )

    def words(self, labels: Sequence[str]) -> str:
        """Name the two."""
        return f"let the rate in {listed(labels)} vanish: the inner and the outer cycle"


def _two_by_size(found: list[sp.Expr], symbols: set[sp.Symbol]) -> list[sp.Expr]:
    """Return the two positive roots, the smaller first, wherever there are two."""
    orders = set()
    for values in _grid(symbols):
        numbers = [complex(root.subs(values).evalf()) for root in found]
        positive = [(q.real, place) for place, q in enumerate(numbers)
                    if abs(q.imag) < 1e-12 and q.real > 0]  # fmt: skip
        if len(positive) == 2:
            orders.add(tuple(place for _, place in sorted(positive)))
    if len(orders) != 1:
        raise OperationError("not two cycles in closed form, one inside the other")
    return [found[place] for place in orders.pop()]


def _grid(symbols: set[sp.Symbol]) -> list[dict[sp.Symbol, float]]:
    """Return numbers for symbols on a coarse grid: some of them give two cycles."""
    grids: list[dict[sp.Symbol, float]] = [{}]
    for symbol in sorted(symbols, key=str):
        grids = [{**grid, symbol: value} for grid in grids for value in (0.1, 0.5, 1.7, 5.0)]
    return grids


@dataclass(frozen=True)
class DecayAtRoot(Operation):
    """Linearise a rate about a stationary amplitude.

    The sources are the rate and the squares of the stationary amplitudes.

    Attributes
    ----------
    amplitude : Expr
        The amplitude, a function of time.
    place : int
        Which of the stationary amplitudes, from 0.
    name : Symbol
        What the rate of decay is called.
    """

    amplitude: sp.Expr
    place: int
    name: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = -d(rate)/d(amplitude)`` there."""
        rate, amplitudes = sources
        size = sp.Dummy("r", positive=True)
        slope = sp.expand(sp.diff(rate.rhs.subs(self.amplitude, size), size))
        square = parts_of(amplitudes)[self.place].rhs
        return equation(self.name, sp.factor(sp.simplify(-slope.subs(size, sp.sqrt(square)))))

    def words(self, labels: Sequence[str]) -> str:
        """Name the cycle."""
        which = ("inner", "outer")[self.place]
        return f"linearise {labels[0]} about the {which} cycle of {listed(labels[1:])}"


@dataclass(frozen=True)
class RatioOfAmplitudes(Operation):
    """Divide the inner by the outer amplitude.

    Attributes
    ----------
    factor : int
        What the ratio is multiplied by on both sides.
    """

    factor: int = 1

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``factor inner / outer = factor sqrt(ratio of squares)``."""
        (source,) = sources
        inner, outer = parts_of(source)
        named = inner.lhs.base / outer.lhs.base
        value = sp.sqrt(sp.cancel(sp.together(inner.rhs / outer.rhs)))
        return equation(self.factor * named, self.factor * value)

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"divide the inner by the outer amplitude of {listed(labels)}"


@dataclass(frozen=True)
class FactorRadicals(Operation):
    """Write each radicand as a product, and take squares out of roots."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source with simpler roots."""
        (source,) = sources

        def shorter(side: sp.Expr) -> sp.Expr:
            out = side.replace(
                lambda q: q.is_Pow and q.exp == sp.Rational(1, 2),
                lambda q: sp.sqrt(sp.factor(q.base)),
            )
            return out.replace(
                lambda q: q.is_Pow and q.exp == sp.Rational(1, 2),
                lambda q: sp.sqrt(sp.cancel(q.base)),
            )

        return on_sides(source, shorter)

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"take squares out of the roots of {listed(labels)}"


@dataclass(frozen=True)
class SelectRoot(Operation):
    """Keep the one of several solutions that satisfies a rule wherever it is tried.

    Attributes
    ----------
    rule : str
        The rule in words.
    accepts : callable
        Whether a numerical value satisfies it.
    values : mapping of Symbol to tuple of float
        Where it is tried.
    """

    rule: str
    accepts: Callable[[complex], bool]
    values: Mapping[sp.Symbol, tuple[float, ...]] = field(hash=False)

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the part that is kept."""
        (source,) = sources
        trials: list[dict[sp.Symbol, float]] = [{}]
        for symbol, numbers in self.values.items():
            trials = [{**trial, symbol: number} for trial in trials for number in numbers]
        kept = [
            part
            for part in parts_of(source)
            if all(self.accepts(complex(part.rhs.subs(trial).evalf())) for trial in trials)
        ]
        if len(kept) != 1:
            raise OperationError(f"{len(kept)} of the solutions satisfy: {self.rule}")
        return kept[0]

    def words(self, labels: Sequence[str]) -> str:
        """Give the rule."""
        return f"keep the solution of {listed(labels)} with {self.rule}"


@dataclass(frozen=True)
class TakeBranch(Operation):
    """Take one branch of a piecewise right side.

    Attributes
    ----------
    place : int
        Which branch, from 0.
    """

    place: int

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation on that branch."""
        (source,) = sources
        (pieces,) = source.rhs.atoms(sp.Piecewise)
        return equation(source.lhs, source.rhs.xreplace({pieces: pieces.args[self.place][0]}))

    def words(self, labels: Sequence[str]) -> str:
        """Name the branch."""
        return f"take the {('lower', 'upper')[self.place]} branch of {listed(labels)}"


@dataclass(frozen=True)
class MoveUniformly(Operation):
    """Let all sites move alike.

    Attributes
    ----------
    field : function class
        The field.
    site : Symbol
        The index that all others become.
    """

    field: sp.FunctionClass
    site: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation without differences between sites."""
        (source,) = sources

        def same(_: sp.Expr, *when: sp.Expr) -> sp.Expr:
            return self.field(self.site, *when)

        return on_sides(source, lambda side: sp.expand(side.replace(self.field, same).doit()))

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"let all sites of {listed(labels)} move alike: the springs are not stretched"


@dataclass(frozen=True)
class LineariseAtRest(Operation):
    """Keep the part of first order in a complex field.

    Attributes
    ----------
    field : function class
        The field, called with site and time.
    """

    field: sp.FunctionClass

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the linear equation."""
        (source,) = sources
        size = sp.Dummy("s", positive=True)
        found = left_minus_right(source).replace(
            lambda q: isinstance(q, AppliedUndef) and q.func == self.field, lambda q: size * q
        )
        return equation(sp.expand(sp.expand(found.doit()).coeff(size, 1)))

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"linearise {listed(labels)} about rest"
