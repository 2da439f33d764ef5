"""Substitution and change of variables: rules, branches, scaled quantities, moving frames."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import sympy as sp
from sympy.core.function import AppliedUndef

from derivations.algebra.equations import equation, left_minus_right, on_sides, parts_of
from derivations.algebra.operations import Operation, OperationError, in_words, inline, listed
from derivations.algebra.solution import SolveFor

HALF = sp.Rational(1, 2)


@dataclass(frozen=True)
class Substitute(Operation):
    """Insert values into an equation: the given ones, and each further source read left to right.

    Derivatives are carried out, integrals are not. An equivalence of two inequalities states where
    a step function switches.

    Attributes
    ----------
    values : mapping of Expr to Expr
        The value inserted for each symbol or field, all simultaneously.
    index : Symbol or None
        Index for which the further sources hold in general; None if they hold as they stand.
    at : tuple of Expr
        Values of the index for which they are used.
    meaning : str
        Meaning of the values, if it is more than assigning a value.
    """

    values: Mapping[sp.Basic, sp.Expr | int] = field(default_factory=dict)
    index: sp.Symbol | None = None
    at: tuple[sp.Expr | int, ...] = ()
    meaning: str = ""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the first source with everything inserted."""
        rules = {old: sp.sympify(value) for old, value in self.values.items()}
        for rule in (part for source in sources[1:] for part in parts_of(source)):
            rules |= _step_rule(rule) if isinstance(rule, sp.Equivalent) else self._instances(rule)
        return on_sides(sources[0], lambda side: side.xreplace(rules).doit(integrals=False))

    def _instances(self, rule: sp.Basic) -> dict[sp.Basic, sp.Basic]:
        if not isinstance(rule, sp.Equality):
            raise OperationError(f"{rule} is not a substitution")
        if self.index is None:
            return {rule.lhs: rule.rhs}
        return {
            rule.lhs.xreplace({self.index: sp.sympify(place)}): rule.rhs.subs(self.index, place)
            for place in self.at
        }

    def words(self, labels: Sequence[str]) -> str:
        """State which equations and values are inserted into which."""
        done = []
        if labels[1:]:
            done.append(f"substitute {listed(labels[1:])}{self._where()} into {labels[0]}")
        if self.values:
            meaning = f"{self.meaning}: " if self.meaning else ""
            done.append(f"{meaning}set {in_words(self.values)} in {'it' if done else labels[0]}")
        return " and ".join(done)

    def _where(self) -> str:
        if self.index is None:
            return ""
        places = [sp.sympify(place) for place in self.at]
        shown = listed([inline(place) for place in places])
        relative = any(place.has(self.index) for place in places)
        return f" at the sites {shown}" if relative else f" at {inline(self.index)} = {shown}"


def _step_rule(rule: sp.Equivalent) -> dict[sp.Basic, sp.Basic]:
    """Read ``p > q if and only if z < z_0``: where the step function of ``p - q`` switches."""
    relations = {isinstance(part, sp.Gt): part for part in rule.args}
    threshold_relation, position_relation = relations[True], relations[False]
    if not isinstance(position_relation, sp.Lt):
        raise OperationError(f"{rule} does not say where the threshold is passed")
    step = sp.Heaviside(threshold_relation.lhs - threshold_relation.rhs, HALF)
    return {step: sp.Heaviside(position_relation.rhs - position_relation.lhs, HALF)}


def mirrored(field: sp.FunctionClass, time: sp.Symbol, reach: int) -> Substitute:
    """Return the substitution that makes a field even in the site, as far as springs reach."""
    values = {field(-at, time): field(at, time) for at in range(1, reach + 1)}
    return Substitute(values, meaning="mirror symmetry")


def alike(field: sp.FunctionClass, index: sp.Symbol, time: sp.Symbol, reach: int) -> Substitute:
    """Return the substitution that makes all sites coupled by springs move alike."""
    others = [field(index + sign * at, time) for at in range(1, reach + 1) for sign in (1, -1)]
    return Substitute(dict.fromkeys(others, field(index, time)), meaning="all sites alike")


@dataclass(frozen=True)
class Eliminate(Operation):
    """Eliminate symbols or terms from the first source by solving the second one for them.

    Parts of the second source that contain none of them are read from left to right. Powers of a
    term are recognised: with ``exp(x)`` also ``exp(2 x)`` is eliminated.

    Attributes
    ----------
    unknowns : tuple of Expr
        The quantities that are eliminated.
    where : mapping of Expr to Expr
        Values that hold in the second source where it is used.
    """

    unknowns: tuple[sp.Basic, ...]
    where: Mapping[sp.Basic, sp.Expr | int] = field(default_factory=dict)

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the first source without the unknowns."""
        target, others = sources[0], Substitute(self.where)(sources[1])
        rules: dict[sp.Basic, sp.Basic] = {}
        for part in parts_of(others):
            contained = [unknown for unknown in self.unknowns if part.rhs.has(unknown)]
            solved = SolveFor(contained[0])(part) if contained else part
            if len(parts_of(solved)) != 1:
                raise OperationError(f"{part} has several solutions for {contained[0]}")
            rules[solved.lhs] = solved.rhs

        def eliminated(side: sp.Expr) -> sp.Expr:
            for _ in rules:  # the solution for one symbol may contain another
                side = side.subs(rules)
            return side.doit()

        return on_sides(target, eliminated)

    def words(self, labels: Sequence[str]) -> str:
        """Name the unknowns."""
        where = f" with {in_words(self.where)}" if self.where else ""
        return (
            f"eliminate {in_words(self.unknowns)} from {labels[0]} by {listed(labels[1:])}{where}"
        )


@dataclass(frozen=True)
class EliminatePowers(Operation):
    """Reduce the powers of a symbol by a polynomial equation that it satisfies."""

    phrase: ClassVar[str] = "lower the powers of {symbol} in {first} by {others}"
    symbol: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the first source with its right side replaced by the remainder."""
        target, relation = sources
        if not target.rhs.is_polynomial(self.symbol):
            return target
        polynomial = sp.Poly(left_minus_right(relation), self.symbol)
        remainder = sp.rem(sp.Poly(sp.expand(target.rhs), self.symbol), polynomial)
        return equation(target.lhs, sp.collect(sp.expand(remainder.as_expr()), self.symbol))


@dataclass(frozen=True)
class TakeBranch(Operation):
    """Restrict an equation to where a condition holds.

    A piecewise expression keeps the branch with that condition; for a negative variable a modulus
    and a sign are resolved, ``|v| = -v, sgn v = -1``.

    Attributes
    ----------
    condition : relation
        The condition, as written beside the branch.
    """

    phrase: ClassVar[str] = "take the branch {condition} of {sources}"
    condition: sp.core.relational.Relational

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source on that branch."""
        (source,) = sources
        pieces = {q: self._branch(q) for q in source.atoms(sp.Piecewise)}
        found = source.xreplace(pieces)
        if isinstance(self.condition, sp.Lt) and self.condition.lts.is_Symbol:
            if self.condition.gts != 0:
                raise OperationError(f"a modulus or sign changes at zero, not at {self.condition}")
            variable, negative = self.condition.lts, sp.Dummy("negative", negative=True)
            found = on_sides(found, lambda side: side.xreplace({variable: negative}).doit())
            found = found.xreplace({negative: variable})
            if found.has(sp.Abs(variable), sp.sign(variable)):
                raise OperationError(f"a modulus or a sign is left for {variable} < 0")
        if found == source:
            raise OperationError(f"{source} has no branch {self.condition}")
        return found

    def _branch(self, pieces: sp.Piecewise) -> sp.Expr:
        for value, condition in pieces.args:
            if condition == self.condition:
                return value
        raise OperationError(f"no branch {self.condition}")


@dataclass(frozen=True)
class WriteWithStep(Operation):
    """Write a right side of two branches in one quantity with a step function.

    Attributes
    ----------
    name : Symbol
        Name of the right side.
    """

    phrase: ClassVar[str] = "write the right side of {sources} with a step function"
    name: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = below + (above - below) theta(quantity - threshold)``."""
        (source,) = sources
        (pieces,) = source.rhs.atoms(sp.Piecewise)
        (low, below), (high, above) = pieces.args
        if not (isinstance(below, sp.Lt) and isinstance(above, sp.Gt)) or below.args != above.args:
            raise OperationError("the two branches do not meet at one threshold")
        stepped = low + sp.expand(high - low) * sp.Heaviside(below.lhs - below.rhs, HALF)
        return equation(self.name, sp.expand(source.rhs.xreplace({pieces: stepped})))


@dataclass(frozen=True)
class InsertRightSide(Operation):
    """Give the first equation the right side of the second."""

    phrase: ClassVar[str] = "replace the right side of {first} by that of {others}"

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``left of the first = right of the second``."""
        first, second = sources
        return equation(first.lhs, second.rhs)


@dataclass(frozen=True)
class ChangeVariables(Operation):
    """Insert scaled fields and a scaled time into an equation.

    The second source contains the scales: ``y(n, t) = y_0 x(n, tau)`` for a field, valid for every
    index, ``tau = omega t`` for the time, and ``F = F_0 f`` for other quantities.

    Attributes
    ----------
    time, scaled_time : Symbol
        The time before and after.
    """

    phrase: ClassVar[str] = "change variables in {first} by {others}"
    time: sp.Symbol
    scaled_time: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation in the new variables; derivatives follow by the chain rule."""
        target, scales = sources
        rules = {part.lhs: part.rhs for part in parts_of(scales)}
        new_time = rules.pop(self.scaled_time)
        (old_time,) = sp.solve(self.scaled_time - new_time, self.time)
        fields = {old: new for old, new in rules.items() if isinstance(old, AppliedUndef)}
        others = {old: new for old, new in rules.items() if old not in fields}

        def changed(side: sp.Expr) -> sp.Expr:
            for old, new in fields.items():
                side = side.replace(old.func, _scaled_field(old, new, self.scaled_time, new_time))
            return side.doit().subs(self.time, old_time).doit().xreplace(others)

        return on_sides(target, changed)


def _scaled_field(
    old: sp.Expr, new: sp.Expr, scaled_time: sp.Symbol, new_time: sp.Expr
) -> Callable[..., sp.Expr]:
    """Return the function that replaces a field at any index and time."""

    def scaled(*arguments: sp.Expr) -> sp.Expr:
        return new.subs(scaled_time, new_time).subs(dict(zip(old.args, arguments, strict=True)))

    return scaled


@dataclass(frozen=True)
class RescaleTime(Operation):
    """Write an equation in terms of the time scales.

    The sources are the equation, the definition of the scales (the fast one first) and, if there
    are any, the time derivatives in terms of them.

    Attributes
    ----------
    function, scaled : Expr
        The motion as a function of time, and of the scales.
    time : Symbol
        The time, which must not remain.
    """

    phrase: ClassVar[str] = "write {first} in the time scales by {others}"
    function: sp.Expr
    scaled: sp.Expr
    time: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation in the scales."""
        target, scales, *derivatives = sources
        rules = {part.lhs: part.rhs for source in derivatives for part in parts_of(source)}
        rules[self.function] = self.scaled
        fast = parts_of(scales)[0]
        rate = sp.diff(fast.rhs, self.time)

        def rescaled(side: sp.Expr) -> sp.Expr:
            known = side.xreplace(rules)
            remaining = [q for q in known.atoms(AppliedUndef) if self.time in q.args]
            if remaining:
                raise OperationError(f"{remaining[0]} is a function of {self.time} without scales")
            return known.subs(self.time, fast.lhs / rate)

        return on_sides(target, rescaled)


@dataclass(frozen=True)
class EnterMovingFrame(Operation):
    """Insert a travelling wave into a lattice equation.

    The second source has a part ``field(n, t) = profile(n - v t)``, valid for every n, and a part
    ``profile(n - v t) = profile(zeta)``, which names the coordinate.

    Attributes
    ----------
    site, time : Symbol
        n and t.
    """

    phrase: ClassVar[str] = "insert the travelling wave {others} into {first}"
    site: sp.Symbol
    time: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation of the profile; derivatives follow by the chain rule."""
        target, wave = sources
        parts = parts_of(wave)
        (moving,) = (q for q in parts if q.lhs.args == (self.site, self.time))
        (definition,) = (q for q in parts if q.lhs == moving.rhs)
        (position,) = sp.solve(definition.lhs.args[0] - definition.rhs.args[0], self.site)
        field, profile = moving.lhs.func, moving.rhs.func

        def insert(site: sp.Expr, *time: sp.Expr) -> sp.Expr:
            return moving.rhs.subs(self.site, site) if time else field(site)  # a profile stays

        def in_frame(side: sp.Expr) -> sp.Expr:
            found = side.replace(field, insert).doit().subs(self.site, position).doit()
            return found.replace(profile, lambda at: profile(sp.expand(at))).doit()

        result = on_sides(target, in_frame)
        if result.has(self.time):  # a function of the site has become one of both
            raise OperationError(f"{self.site} or {self.time} is left: not a travelling wave")
        return result
