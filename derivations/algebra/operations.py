"""The vocabulary of a derivation: operations that make an equation of equations.

An operation is a small frozen object: its fields are its parameters (a symbol, an order), calling
it with the source equations returns the result, and `Operation.words` says in the field's words
what was done. None of them knows which equation of the paper it is used for.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp
from sympy.core.function import AppliedUndef

from derivations.algebra.equations import (
    equation,
    left_minus_right,
    on_sides,
    parts_of,
    system,
)
from derivations.algebra.notation import Script, displayed


class OperationError(ArithmeticError):
    """An operation cannot be carried out on the equations that it was given."""


class Operation(ABC):
    """Something done to equations.

    To write a new one: a frozen dataclass whose fields are the parameters; ``__call__`` computes
    the result from the sources and from nothing else, and raises `OperationError` where it cannot
    be carried out; ``words`` is an imperative clause without a full stop.
    """

    @abstractmethod
    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the result of the operation on the source equations."""

    @abstractmethod
    def words(self, labels: Sequence[str]) -> str:
        """Say what is done, given how the sources are called."""


def spoken(expression: sp.Basic) -> str:
    """Return a short expression on one line, with Greek letters.

    Examples
    --------
    >>> spoken(4 * sp.Symbol("omega_1") ** 2)
    '4 ω₁²'
    >>> spoken(sp.exp(sp.I * sp.Symbol("theta")))
    'exp(i θ)'
    """
    shown = displayed(sp.sympify(expression), Script.UNICODE)
    text = str(sp.pretty(shown, use_unicode=True, wrap_line=False))
    if "\n" not in text:
        return text
    letters = {q: sp.Symbol(str(sp.pretty(q, use_unicode=True))) for q in shown.atoms(sp.Symbol)}
    text = _POWER.sub(_raised, str(sp.sstr(shown.xreplace(letters))))
    return _UNIT.sub("i", text.replace("*", " "))


_POWER = re.compile(r"\*\*(\d+)")
_UNIT = re.compile(r"\bI\b")


def _raised(power: re.Match[str]) -> str:
    return "".join("⁰¹²³⁴⁵⁶⁷⁸⁹"[int(digit)] for digit in power[1])


def listed(labels: Sequence[str]) -> str:
    """Return ``a``, ``a and b``, or ``a, b and c``."""
    if len(labels) < 2:
        return "".join(labels)
    return ", ".join(labels[:-1]) + " and " + labels[-1]


@dataclass(frozen=True)
class Substitute(Operation):
    """Put rules into an equation: the first source, with each further one read left to right.

    Attributes
    ----------
    index : Symbol or None
        Index for which the rules hold generally; None if they hold as they stand.
    at : tuple of Expr
        Values of the index at which the rules are used.
    """

    index: sp.Symbol | None = None
    at: tuple[sp.Expr | int, ...] = ()

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the first source with the rules put in and derivatives carried out."""
        rules: dict[sp.Basic, sp.Basic] = {}
        for rule in (part for source in sources[1:] for part in parts_of(source)):
            if not isinstance(rule, sp.Equality):
                raise OperationError(f"{rule} is not a rule that can be put in")
            rules |= self._instances(rule)
        return on_sides(sources[0], lambda side: side.xreplace(rules).doit())

    def _instances(self, rule: sp.Equality) -> dict[sp.Basic, sp.Basic]:
        if self.index is None:
            return {rule.lhs: rule.rhs}
        return {
            rule.lhs.xreplace({self.index: sp.sympify(place)}): rule.rhs.subs(self.index, place)
            for place in self.at
        }

    def words(self, labels: Sequence[str]) -> str:
        """Say which equations are put into which."""
        where = ""
        if self.index is not None:
            places = [sp.sympify(place) for place in self.at]
            said = listed([spoken(place) for place in places])
            moved = any(place.has(self.index) for place in places)
            where = f" at the sites {said}" if moved else f" at {spoken(self.index)} = {said}"
        return f"substitute {listed(labels[1:])}{where} into {labels[0]}"


@dataclass(frozen=True)
class Specialise(Operation):
    """Give symbols particular values.

    Attributes
    ----------
    values : mapping of Symbol to Expr
        What is put for each.
    """

    values: Mapping[sp.Basic, sp.Expr | int] = field(hash=False)

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source with the values put in."""
        (source,) = sources
        put = {symbol: sp.sympify(given) for symbol, given in self.values.items()}
        return on_sides(source, lambda side: side.subs(put, simultaneous=True).doit())

    def words(self, labels: Sequence[str]) -> str:
        """Name the values."""
        pairs = [f"{spoken(one)} = {spoken(sp.sympify(q))}" for one, q in self.values.items()]
        return f"set {listed(pairs)} in {listed(labels)}"


@dataclass(frozen=True)
class ImposeMirrorSymmetry(Operation):
    """Replace the sites left of site 0 by their mirror images: ``y_{-j} = y_j``.

    Attributes
    ----------
    function : function class
        The field, called as ``function(site, time)``.
    """

    function: sp.FunctionClass

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source with sites of negative number replaced."""
        (source,) = sources

        def mirrored(side: sp.Expr) -> sp.Expr:
            found = {
                own: own.func(-own.args[0], *own.args[1:])
                for own in side.atoms(AppliedUndef)
                if own.func == self.function and own.args[0].is_negative
            }
            return side.xreplace(found)

        return on_sides(source, mirrored)

    def words(self, labels: Sequence[str]) -> str:
        """Name the symmetry."""
        name = self.function.__name__
        return f"impose the mirror symmetry {name}_(-j) = {name}_j on {listed(labels)}"


@dataclass(frozen=True)
class Divide(Operation):
    """Divide both sides by a factor that does not vanish."""

    factor: sp.Expr

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source with each side divided and expanded."""
        (source,) = sources
        return on_sides(source, lambda side: sp.expand(side / self.factor))

    def words(self, labels: Sequence[str]) -> str:
        """Name the factor."""
        return f"divide {listed(labels)} by {spoken(self.factor)}"


@dataclass(frozen=True)
class DivideByLeftSide(Operation):
    """Divide both sides by the left side, where it does not vanish."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``1 = right / left``."""
        (source,) = sources
        return equation(1, sum((q / source.lhs for q in sp.Add.make_args(source.rhs)), sp.S.Zero))

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"divide {listed(labels)} by its left side"


@dataclass(frozen=True)
class Multiply(Operation):
    """Multiply both sides by a factor that does not vanish."""

    factor: sp.Expr

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source with each side multiplied and expanded."""
        (source,) = sources
        return on_sides(source, lambda side: sp.expand(side * self.factor))

    def words(self, labels: Sequence[str]) -> str:
        """Name the factor."""
        return f"multiply {listed(labels)} by {spoken(self.factor)}"


@dataclass(frozen=True)
class SolveFor(Operation):
    """Solve an equation for a symbol; all solutions are returned, as a system if several."""

    unknown: sp.Basic

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``unknown = solution``, once for each solution."""
        (source,) = sources
        stand_in = sp.Dummy(real=True) if self.unknown.is_real else sp.Dummy()
        rest = left_minus_right(source).xreplace({self.unknown: stand_in})
        slope = sp.diff(rest, stand_in)
        if not slope.has(stand_in):
            if sp.expand(slope) == 0:
                raise OperationError(f"{source} does not contain {self.unknown}")
            found = [-rest.subs(stand_in, 0) / slope]
        else:
            found = sp.solve(rest, stand_in)
        if not found:
            raise OperationError(f"{source} has no solution for {self.unknown}")
        return system(tuple(equation(self.unknown, solution) for solution in found))

    def words(self, labels: Sequence[str]) -> str:
        """Name the unknown."""
        return f"solve {listed(labels)} for {spoken(self.unknown)}"


@dataclass(frozen=True)
class Eliminate(Operation):
    """Solve the second source for a symbol or term and put the solution into the first.

    Powers of a term are recognised: with ``exp(x)`` also ``exp(2 x)`` is eliminated.
    """

    unknown: sp.Basic

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the first source without the unknown."""
        target, other = sources
        solved = SolveFor(self.unknown)(other)
        if len(parts_of(solved)) != 1:
            raise OperationError(f"{other} has several solutions for {self.unknown}")
        return on_sides(target, lambda side: side.subs(self.unknown, solved.rhs).doit())

    def words(self, labels: Sequence[str]) -> str:
        """Name the unknown."""
        return f"eliminate {spoken(self.unknown)} from {labels[0]} by {listed(labels[1:])}"


@dataclass(frozen=True)
class Isolate(Operation):
    """Bring the terms with a variable to the left and divide by the factor of one of them.

    Of a system, part by part, with one target each. Where the target is the only such term this
    solves for it.

    Attributes
    ----------
    variable : Symbol
        What the terms on the left contain.
    targets : tuple of Expr
        One a part; its factor is divided by. Empty: nothing is divided.
    """

    variable: sp.Basic
    targets: tuple[sp.Expr, ...] = ()

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``terms with the variable = the rest``."""
        (source,) = sources
        parts = parts_of(source)
        targets = self.targets or (None,) * len(parts)
        if len(targets) != len(parts):
            raise OperationError(f"{len(parts)} equations, but {len(targets)} terms to isolate")
        return system(tuple(map(self._isolated, parts, targets)))

    def _isolated(self, part: sp.Basic, target: sp.Expr | None) -> sp.Basic:
        whole = sp.expand(left_minus_right(part))
        rest, kept = whole.as_independent(self.variable, as_Add=True)
        if target is None:
            return equation(kept, -rest)
        stand_in = sp.Dummy()
        factor = sp.expand(kept.xreplace({target: stand_in})).coeff(stand_in, 1)
        if factor == 0:
            raise OperationError(f"there is no term with {target}")
        others = sp.expand(kept - factor * target)
        common = sp.factor_terms(factor)
        return equation(target + sp.factor_terms(others) / common, -sp.factor_terms(rest) / common)

    def words(self, labels: Sequence[str]) -> str:
        """Name the variable and the targets."""
        said = f"bring the terms with {spoken(self.variable)} of {listed(labels)} to the left"
        if self.targets:
            said += f" and divide by the factor of {listed([spoken(q) for q in self.targets])}"
        return said


@dataclass(frozen=True)
class SelectBranch(Operation):
    """Keep one of several solutions.

    Attributes
    ----------
    place : int
        Which, from 0.
    rule : str
        Why this one: where it holds.
    """

    place: int
    rule: str

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the part that is kept."""
        (source,) = sources
        return parts_of(source)[self.place]

    def words(self, labels: Sequence[str]) -> str:
        """Give the rule."""
        return f"keep the branch of {listed(labels)} with {self.rule}"


@dataclass(frozen=True)
class SwapSides(Operation):
    """Write an equation the other way round."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``right = left``."""
        (source,) = sources
        return system(tuple(equation(part.rhs, part.lhs) for part in parts_of(source)))

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"exchange the sides of {listed(labels)}"


@dataclass(frozen=True)
class DividedDifference(Operation):
    """Divided difference of left minus right over values of a variable.

    If the equation held at all the values, it would vanish.

    Attributes
    ----------
    variable : Symbol
        What differs between the places.
    values : tuple of Symbol
        Its values there.
    name : Symbol
        What the divided difference is called.
    """

    variable: sp.Symbol
    values: tuple[sp.Symbol, ...]
    name: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = divided difference``."""
        (source,) = sources
        whole = left_minus_right(source)
        table = [whole.subs(self.variable, value) for value in self.values]
        for width in range(1, len(self.values)):
            table = [
                sp.cancel((table[at + 1] - table[at]) / (self.values[at + width] - self.values[at]))
                for at in range(len(table) - 1)
            ]
        return equation(self.name, table[0])

    def words(self, labels: Sequence[str]) -> str:
        """Name the values."""
        places = listed([spoken(value) for value in self.values])
        return f"take the divided difference of {listed(labels)} over {places}"


@dataclass(frozen=True)
class Join(Operation):
    """Write several equations as one system."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return all parts of all sources."""
        return sp.Tuple(*(part for source in sources for part in parts_of(source)))

    def words(self, labels: Sequence[str]) -> str:
        """Name the equations."""
        return f"take {listed(labels)} together"


@dataclass(frozen=True)
class Take(Operation):
    """Take one equation out of a system.

    Attributes
    ----------
    place : int
        Which, from 0.
    """

    place: int

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return that equation."""
        (source,) = sources
        return parts_of(source)[self.place]

    def words(self, labels: Sequence[str]) -> str:
        """Name the place."""
        ordinal = ("first", "second", "third", "fourth")[self.place]
        return f"take the {ordinal} equation of {listed(labels)}"


@dataclass(frozen=True)
class Subtract(Operation):
    """Subtract the second equation from the first."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the difference of the two, everything on the left."""
        one, other = sources
        return equation(sp.factor(left_minus_right(one) - left_minus_right(other)))

    def words(self, labels: Sequence[str]) -> str:
        """Name the two."""
        return f"subtract {labels[1]} from {labels[0]}"


@dataclass(frozen=True)
class Differentiate(Operation):
    """Differentiate both sides with respect to a symbol."""

    variable: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the differentiated equation."""
        (source,) = sources
        return on_sides(source, lambda side: sp.diff(side, self.variable).doit())

    def words(self, labels: Sequence[str]) -> str:
        """Name the variable."""
        return f"differentiate {listed(labels)} with respect to {spoken(self.variable)}"


@dataclass(frozen=True)
class Factorise(Operation):
    """Write each side as a product."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source with factored sides."""
        (source,) = sources
        return on_sides(source, sp.factor)

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"factor {listed(labels)}"


@dataclass(frozen=True)
class CancelCommonFactors(Operation):
    """Cancel what numerator and denominator of a side have in common.

    Attributes
    ----------
    max_terms : int
        Sides whose numerator is a longer sum are left as they are: factors would hide its form.
    """

    max_terms: int = 4

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source with shorter fractions."""
        (source,) = sources

        def shortened(side: sp.Expr) -> sp.Expr:
            above, below = sp.fraction(sp.together(side))
            if below == 1 or len(sp.Add.make_args(above)) > 2 * self.max_terms:
                return side
            above = sp.expand(above)
            if len(sp.Add.make_args(above)) > self.max_terms:
                return side
            return sp.factor(above) / sp.factor(below)

        return on_sides(source, shortened)

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"cancel common factors in {listed(labels)}"


@dataclass(frozen=True)
class CollectTerms(Operation):
    """Collect each side in some symbols; nothing but its form changes."""

    symbols: tuple[sp.Basic, ...]

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source in the collected form."""
        (source,) = sources
        return on_sides(source, lambda side: sp.collect(sp.expand(side), list(self.symbols)))

    def words(self, labels: Sequence[str]) -> str:
        """Name the symbols."""
        return f"collect {listed(labels)} in {listed([spoken(q) for q in self.symbols])}"
