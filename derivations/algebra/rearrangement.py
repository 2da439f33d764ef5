"""Rearranging equations: systems, factors and terms, forms, powers, derivatives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import ClassVar

import sympy as sp

from derivations.algebra.equations import equation, left_minus_right, on_sides, parts_of, system
from derivations.algebra.operations import Operation, OperationError, in_words, inline, listed


@dataclass(frozen=True)
class Join(Operation):
    """Write several equations as one system."""

    phrase: ClassVar[str] = "take {sources} together"

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return all parts of all sources."""
        return sp.Tuple(*(part for source in sources for part in parts_of(source)))


@dataclass(frozen=True)
class Take(Operation):
    """Take one equation of a system, or one of several solutions.

    Attributes
    ----------
    place : int
        Its index, from 0.
    rule : str
        For solutions: why this one is taken, and where it holds.
    """

    place: int
    rule: str = ""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return that equation."""
        (source,) = sources
        return parts_of(source)[self.place]

    def words(self, labels: Sequence[str]) -> str:
        """Name the place, or the rule."""
        if self.rule:
            return f"keep the branch of {listed(labels)} with {self.rule}"
        ordinal = ("first", "second", "third", "fourth")[self.place]
        return f"take the {ordinal} equation of {listed(labels)}"


@dataclass(frozen=True)
class Divide(Operation):
    """Divide both sides by a factor that does not vanish.

    Attributes
    ----------
    factor : Expr, tuple of Expr or None
        The factor, or one for each relation of a system; None for the left side itself.
        Inequalities are divided only by positive factors.
    """

    factor: sp.Expr | tuple[sp.Expr, ...] | None = None

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source with each side divided and expanded."""
        (source,) = sources
        if self.factor is None:
            terms = sp.Add.make_args(source.rhs)
            return equation(1, sum((term / source.lhs for term in terms), sp.S.Zero))
        parts = parts_of(source)
        factors = self.factor if isinstance(self.factor, tuple) else (self.factor,) * len(parts)
        return system(tuple(map(self._divided, parts, factors)))

    @staticmethod
    def _divided(part: sp.Basic, factor: sp.Expr) -> sp.Basic:
        if not isinstance(part, sp.Equality | sp.Unequality) and not factor.is_positive:
            raise OperationError(f"{factor} is not known to be positive")
        return on_sides(part, lambda side: sp.expand(side / factor))

    def words(self, labels: Sequence[str]) -> str:
        """Name the factor."""
        if self.factor is None:
            return f"divide {listed(labels)} by its left side"
        if isinstance(self.factor, tuple):
            factors = listed([inline(factor) for factor in self.factor])
            return f"divide the relations of {listed(labels)} by {factors}"
        return f"divide {listed(labels)} by {inline(self.factor)}"


@dataclass(frozen=True)
class Isolate(Operation):
    """Bring the terms with a variable to the left, and divide by the factor of one of them.

    A system is treated part by part, with one target each. If the target is the only such term,
    this solves for it.

    Attributes
    ----------
    variables : tuple of Expr
        Variables of which the terms on the left contain at least one.
    targets : tuple of Expr
        One per part, by whose factor the part is divided; empty for no division.
    """

    variables: tuple[sp.Basic, ...]
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
        constant_terms, variable_terms = whole.as_independent(*self.variables, as_Add=True)
        if target is None:
            return equation(variable_terms, -constant_terms)
        stand_in = sp.Dummy()
        factor = sp.expand(variable_terms.xreplace({target: stand_in})).coeff(stand_in, 1)
        if factor == 0:
            raise OperationError(f"there is no term with {target}")
        others = sp.expand(variable_terms - factor * target)
        common = sp.factor_terms(factor)
        return equation(
            target + sp.factor_terms(others) / common, -sp.factor_terms(constant_terms) / common
        )

    def words(self, labels: Sequence[str]) -> str:
        """Name the variable and the targets."""
        divided = f" and divide by the factor of {in_words(self.targets)}" if self.targets else ""
        variables = in_words(self.variables)
        return f"bring the terms with {variables} of {listed(labels)} to the left{divided}"


@dataclass(frozen=True)
class Subtract(Operation):
    """Subtract the second equation from the first."""

    phrase: ClassVar[str] = "subtract {others} from {first}"

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the difference of the two, everything on the left."""
        one, other = sources
        return equation(sp.factor(left_minus_right(one) - left_minus_right(other)))


MAX_TERMS = 4


def _cancelled(side: sp.Expr) -> sp.Expr:
    """Cancel common factors of numerator and denominator.

    A side whose numerator is a sum of more than `MAX_TERMS` terms is left unchanged, since factors
    would hide its form.
    """
    numerator, denominator = sp.fraction(sp.together(side))
    if denominator == 1:
        return side
    numerator = sp.expand(numerator)
    if len(sp.Add.make_args(numerator)) > MAX_TERMS:
        return side
    return sp.factor(numerator) / sp.factor(denominator)


def _with_short_roots(side: sp.Expr) -> sp.Expr:
    """Write each radicand as a product, and take squares out of roots."""
    for rewrite in (sp.factor, sp.cancel):
        side = side.replace(
            lambda q: q.is_Pow and q.exp == sp.Rational(1, 2),
            lambda q, rewritten=rewrite: sp.sqrt(rewritten(q.base)),
        )
    return side


def _expanded(side: sp.Expr) -> sp.Expr:
    """Multiply out products of sums, but not under integrals."""
    return sp.Add(*(sp.expand(term, deep=False) for term in sp.Add.make_args(side)))


class Form(Enum):
    """Forms of an equation; the value describes what is done."""

    EXPANDED = "expand {}"
    SIMPLIFIED = "simplify {}"
    CANCELLED = "cancel common factors in {}"
    SHORT_ROOTS = "take squares out of the roots of {}"
    ON_THE_LEFT = "bring everything in {} to the left"
    EXCHANGED = "exchange the sides of {}"


_OF_SIDES: dict[Form, Callable[[sp.Expr], sp.Expr]] = {
    Form.EXPANDED: _expanded,
    Form.SIMPLIFIED: lambda side: sp.expand(sp.simplify(side)),
    Form.CANCELLED: _cancelled,
    Form.SHORT_ROOTS: _with_short_roots,
}


@dataclass(frozen=True)
class Rewrite(Operation):
    """Write an equation in another, equivalent form."""

    form: Form

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source in that form."""
        (source,) = sources
        if self.form is Form.ON_THE_LEFT:
            return equation(sp.expand(left_minus_right(source)))
        if self.form is Form.EXCHANGED:
            return equation(source.rhs, source.lhs)
        return on_sides(source, _OF_SIDES[self.form])

    def words(self, labels: Sequence[str]) -> str:
        """Name the form."""
        return self.form.value.format(listed(labels))


class Function(Enum):
    """Functions that may be applied to both sides; the value is their name."""

    MODULUS = "take absolute values of {}"
    SQUARE = "square {}"
    RECIPROCAL = "take the reciprocal of {}"
    SQUARE_ROOT = "take the square root of {}, with both signs"


@dataclass(frozen=True)
class Apply(Operation):
    """Apply a function to both sides; for a square root both signs are kept."""

    function: Function

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the function of both sides, or the branches ``√left = ±√right``."""
        (source,) = sources
        if self.function is Function.SQUARE_ROOT:
            left, right = (_root(side) for side in source.args)
            return sp.Tuple(equation(left, right), equation(left, -right))
        functions = {
            Function.MODULUS: sp.Abs,
            Function.SQUARE: lambda side: sp.cancel(side**2),
            Function.RECIPROCAL: lambda side: sp.cancel(1 / side),
        }
        return on_sides(source, functions[self.function])

    def words(self, labels: Sequence[str]) -> str:
        """Name the function."""
        return self.function.value.format(listed(labels))


def _root(side: sp.Expr) -> sp.Expr:
    return sp.sqrt(sp.factor(side)).replace(sp.Abs, lambda inner: inner)


@dataclass(frozen=True)
class TakeCoefficient(Operation):
    """Take the coefficient of a term of left minus right, and name it or equate it to zero.

    Attributes
    ----------
    term : Expr
        The term.
    name : Expr or None
        Name of its coefficient; None if it has to vanish.
    """

    term: sp.Expr
    name: sp.Expr | None = None

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``coefficient = 0`` or ``name = coefficient``, with phase factors as cosines."""
        (source,) = sources
        factor = with_cosines(sp.expand(left_minus_right(source)).coeff(self.term))
        return equation(factor) if self.name is None else equation(self.name, factor)

    def words(self, labels: Sequence[str]) -> str:
        """Name the term."""
        coefficient = f"the coefficient of {inline(self.term)} in {listed(labels)}"
        return (
            f"set {coefficient} to zero"
            if self.name is None
            else f"call {coefficient} {inline(self.name)}"
        )


def with_cosines(expression: sp.Expr) -> sp.Expr:
    """Return the expanded expression with ``e^{iz}`` written by cosine and sine of z."""

    def by_cosine(exponent: sp.Expr) -> sp.Expr:
        angle = sp.expand(exponent).as_coefficient(sp.I)
        return sp.exp(exponent) if angle is None else sp.cos(angle) + sp.I * sp.sin(angle)

    return sp.expand(expression.replace(sp.exp, by_cosine))


@dataclass(frozen=True)
class Differentiate(Operation):
    """Differentiate a quantity defined by an equation, implicitly if it is not isolated.

    Attributes
    ----------
    quantity : Expr
        The quantity: a symbol, or a function of the variable.
    variable : Symbol
        The variable.
    names : tuple of Symbol
        Names of the first and the higher derivatives.
    """

    phrase: ClassVar[str] = "differentiate {sources} with respect to {variable}: {names}"
    quantity: sp.Expr
    variable: sp.Symbol
    names: tuple[sp.Symbol, ...]

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = derivative`` in the variable, the quantity and lower derivatives."""
        (source,) = sources
        function = sp.Function("held")(self.variable)
        current = left_minus_right(source).subs(self.quantity, function)
        known: dict[sp.Basic, sp.Basic] = {}
        derivatives = []
        for order, name in enumerate(self.names, start=1):
            current = current.diff(self.variable)
            known = {function.diff((self.variable, order)): name, **known}  # the highest first
            relation = current.subs(known).subs(function, self.quantity)
            # The relation is linear in the highest derivative.
            found = -relation.subs(name, 0) / relation.diff(name)
            derivatives.append(equation(name, sp.expand(found)))
        return system(tuple(derivatives))


@dataclass(frozen=True)
class DividedDifference(Operation):
    """Take the divided difference of left minus right over values of a variable.

    It would vanish if the equation held at all these values.

    Attributes
    ----------
    variable : Symbol
        The quantity that differs between the places.
    values : tuple of Symbol
        Its values there.
    name : Symbol
        Name of the divided difference.
    """

    phrase: ClassVar[str] = "take the divided difference of {sources} over {values}"
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
