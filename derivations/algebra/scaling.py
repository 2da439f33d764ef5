"""Operations on scales and laws: change of variables, unit coefficients, branches of a law."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational

from derivations.algebra.equations import equation, left_minus_right, on_sides, parts_of, system
from derivations.algebra.expansion import taylor
from derivations.algebra.operations import Operation, OperationError, SolveFor, listed, spoken


@dataclass(frozen=True)
class ChangeVariables(Operation):
    """Put scaled fields and a scaled time into an equation.

    The second source holds the scales: ``y(n, t) = y_0 x(n, tau)`` for a field, read for every
    index, ``tau = omega t`` for the time, and ``F = F_0 f`` for other quantities.

    Attributes
    ----------
    time, scaled_time : Symbol
        The time before and after.
    """

    time: sp.Symbol
    scaled_time: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation in the new variables; derivatives follow by the chain rule."""
        target, scales = sources
        rules = {part.lhs: part.rhs for part in parts_of(scales)}
        clock = rules.pop(self.scaled_time)
        (before,) = sp.solve(sp.Eq(self.scaled_time, clock), self.time)
        fields = {own: new for own, new in rules.items() if isinstance(own, AppliedUndef)}
        plain = {own: new for own, new in rules.items() if own not in fields}

        def changed(side: sp.Expr) -> sp.Expr:
            for own, new in fields.items():
                side = side.replace(own.func, _scaled_field(own, new, self.scaled_time, clock))
            return side.doit().subs(self.time, before).doit().xreplace(plain)

        return on_sides(target, changed)

    def words(self, labels: Sequence[str]) -> str:
        """Name the scales."""
        return f"change variables in {labels[0]} by {listed(labels[1:])}"


def _scaled_field(
    own: sp.Expr, new: sp.Expr, scaled_time: sp.Symbol, clock: sp.Expr
) -> Callable[..., sp.Expr]:
    """Return what replaces a field at any index."""
    indices = own.args[:-1]

    def scaled(*arguments: sp.Expr) -> sp.Expr:
        places = dict(zip(indices, arguments[:-1], strict=True))
        return new.subs(places).subs(scaled_time, clock)

    return scaled


@dataclass(frozen=True)
class PrescribeCoefficients(Operation):
    """Demand values for coefficients of a linear left side, and solve for the scales.

    Attributes
    ----------
    demands : tuple of (tuple of Expr, Expr)
        Terms, and what their coefficients add to.
    unknowns : tuple of Symbol
        What is solved for, in the order in which it is written.
    """

    demands: tuple[tuple[tuple[sp.Expr, ...], sp.Expr], ...]
    unknowns: tuple[sp.Symbol, ...]

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return one equation for each unknown."""
        (source,) = sources
        left = sp.expand(source.lhs)
        rest = [sum((left.coeff(term) for term in terms), sp.S.Zero) - value
                for terms, value in self.demands]  # fmt: skip
        found = [self._one_by_one(rest)]
        if not found[0]:
            found = self._together(rest)
        if len(found) != 1 or set(found[0]) != set(self.unknowns):
            raise OperationError("these coefficients do not determine the scales")
        return sp.Tuple(*(equation(own, sp.simplify(found[0][own])) for own in self.unknowns))

    def _together(self, rest: list[sp.Expr]) -> list[dict[sp.Basic, sp.Expr]]:
        """Solve all demands at once; only where a square occurs is the sign of a scale used."""
        stand_in = {own: sp.Dummy(own.name) for own in self.unknowns
                    if all(sp.diff(demand, own, 2) == 0 for demand in rest)}  # fmt: skip
        back = {dummy: own for own, dummy in stand_in.items()}
        plain = [demand.xreplace(stand_in) for demand in rest]
        wanted = [stand_in.get(own, own) for own in self.unknowns]
        return [{back.get(own, own): value for own, value in found.items()}
                for found in sp.solve(plain, wanted, dict=True)]  # fmt: skip

    def _one_by_one(self, rest: list[sp.Expr]) -> dict[sp.Basic, sp.Expr]:
        """Solve the demands in their order for the unknowns in theirs; nothing if they mix."""
        known: dict[sp.Basic, sp.Expr] = {}
        for place, (demand, unknown) in enumerate(zip(rest, self.unknowns, strict=True)):
            if demand.has(*self.unknowns[place + 1 :]):
                return {}
            roots = [root for root in sp.solve(demand.subs(known), unknown)
                     if not (unknown.is_positive and root.is_positive is False)]  # fmt: skip
            if len(roots) != 1:
                return {}
            known[unknown] = roots[0]
        return known

    def words(self, labels: Sequence[str]) -> str:
        """Name the demands."""
        values = listed([spoken(value) for _, value in self.demands])
        names = listed([spoken(own) for own in self.unknowns])
        return f"demand the coefficients {values} in {listed(labels)} and solve for {names}"


@dataclass(frozen=True)
class ExpressIn(Operation):
    """Write an equation in newly defined quantities.

    The second source holds the definitions. Those that contain a symbol to be eliminated are
    solved for it; the others are put in from left to right.

    Attributes
    ----------
    eliminated : tuple of Symbol
        The symbols that go.
    """

    eliminated: tuple[sp.Symbol, ...]

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation in the new quantities."""
        target, definitions = sources
        rules: dict[sp.Basic, sp.Basic] = {}
        for part in parts_of(definitions):
            gone = [own for own in self.eliminated if part.rhs.has(own)]
            solved = SolveFor(gone[0])(part) if gone else part
            rules[solved.lhs] = solved.rhs

        def written(side: sp.Expr) -> sp.Expr:
            for _ in rules:  # the solution for one symbol may contain another
                side = side.subs(rules)
            return sp.expand(sp.simplify(side))

        return on_sides(target, written)

    def words(self, labels: Sequence[str]) -> str:
        """Name the definitions."""
        names = listed([spoken(own) for own in self.eliminated])
        return f"express {labels[0]} in the quantities of {listed(labels[1:])}: {names} drop out"


@dataclass(frozen=True)
class DivideByPositive(Operation):
    """Divide each relation of a system by a positive factor; conditions lose what is positive.

    Attributes
    ----------
    factor : Expr
        What both sides of equations and bounds are divided by.
    """

    factor: sp.Expr

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the system with smaller terms."""
        (source,) = sources
        if not self.factor.is_positive:
            raise OperationError(f"{self.factor} is not known to be positive")
        return system(tuple(map(self._divided, parts_of(source))))

    def _divided(self, part: Relational) -> Relational:
        if part.rhs == 0:
            kept = [q for q in sp.Mul.make_args(part.lhs) if not q.is_positive]
            return part.func(sp.Mul(*kept), 0, evaluate=False)
        left, right = (sp.expand(side / self.factor) for side in part.args)
        return part.func(left, right, evaluate=False)

    def words(self, labels: Sequence[str]) -> str:
        """Name the factor."""
        return f"divide {listed(labels)} by {spoken(self.factor)} > 0"


@dataclass(frozen=True)
class TakeNegativeBranch(Operation):
    """Restrict a law with a modulus and a sign to negative arguments: ``|v| = -v, sgn v = -1``.

    Attributes
    ----------
    variable : Symbol
        What is negative.
    """

    variable: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source without modulus and sign of the variable."""
        (source,) = sources
        negative = sp.Dummy("negative", negative=True)
        found = on_sides(source, lambda side: side.xreplace({self.variable: negative}).doit())
        if found.has(sp.Abs, sp.sign):
            raise OperationError(f"a modulus or a sign is left for {self.variable} < 0")
        return found.xreplace({negative: self.variable})

    def words(self, labels: Sequence[str]) -> str:
        """Name the branch."""
        return f"take the branch {spoken(self.variable)} < 0 of {listed(labels)}"


@dataclass(frozen=True)
class SolveLimits(Operation):
    """Find the constants of a law from its stated limits.

    The first source is the law, the second the limits: ``f(0) = ...`` and ``f(oo) = ...``.

    Attributes
    ----------
    variable : Symbol
        The argument of the law.
    constants : tuple of Symbol
        What is solved for and put in.
    """

    variable: sp.Symbol
    constants: tuple[sp.Symbol, ...]

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the law with its constants."""
        law, limits = sources
        positive = sp.Dummy("positive", positive=True)
        side = law.rhs.xreplace({self.variable: positive})
        rest = [sp.limit(side, positive, part.lhs.args[0]) - part.rhs for part in parts_of(limits)]
        found = sp.solve(rest, self.constants, dict=True)
        if len(found) != 1:
            raise OperationError("the limits do not determine the constants")
        return equation(law.lhs, law.rhs.subs(found[0]))

    def words(self, labels: Sequence[str]) -> str:
        """Name the constants."""
        names = listed([spoken(own) for own in self.constants])
        return f"find {names} of {labels[0]} from {listed(labels[1:])}"


@dataclass(frozen=True)
class RestUniformly(Operation):
    """Let a field be the same constant at every site and time."""

    field: sp.FunctionClass
    value: sp.Expr

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation of the constant."""
        (source,) = sources
        return on_sides(source, lambda side: side.replace(self.field, lambda *_: self.value).doit())

    def words(self, labels: Sequence[str]) -> str:
        """Name the constant."""
        return f"seek a uniform rest state {spoken(self.value)} of {listed(labels)}"


@dataclass(frozen=True)
class PerturbField(Operation):
    """Put a constant state plus a small field into an equation and keep the first order.

    Attributes
    ----------
    field, small_field : function class
        The field, and the perturbation with the same arguments.
    """

    field: sp.FunctionClass
    small_field: sp.FunctionClass

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the linear equation of the perturbation."""
        target, state = sources
        size = sp.Dummy("s")
        moved = left_minus_right(target).replace(
            self.field, lambda *at: state.rhs + size * self.small_field(*at)
        )
        return equation(sp.expand(taylor(moved.doit(), size, 1)[1]))

    def words(self, labels: Sequence[str]) -> str:
        """Name the state."""
        return f"linearise {labels[0]} about {listed(labels[1:])}"


@dataclass(frozen=True)
class InsertPlaneWave(Operation):
    """Put ``e^{rate time + i wavenumber n}`` into a linear lattice equation and divide by it.

    Attributes
    ----------
    field : function class
        The field, with arguments site and time.
    rate : Expr
        What multiplies the time in the exponent.
    wavenumber : Symbol
        What multiplies the site.
    """

    field: sp.FunctionClass
    rate: sp.Expr
    wavenumber: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the characteristic equation, in cosines of the wavenumber."""
        (source,) = sources
        whole = left_minus_right(source)
        here = next(iter(sorted(whole.atoms(AppliedUndef), key=str)))
        site, time = (next(iter(here.args[place].free_symbols)) for place in (0, 1))

        def wave(place: sp.Expr, when: sp.Expr) -> sp.Expr:
            return sp.exp(self.rate * when + sp.I * self.wavenumber * place)

        found = whole.replace(self.field, wave).doit() / wave(site, time)
        found = sp.powsimp(sp.expand(found, power_exp=False), combine="exp")
        return equation(sp.expand(found.replace(sp.exp, self._turning)))

    def _turning(self, exponent: sp.Expr) -> sp.Expr:
        """Write a phase factor of the wavenumber as cosine and sine; leave what is real."""
        angle = sp.expand(exponent / sp.I)
        if not angle.has(self.wavenumber):
            return sp.exp(exponent)
        return sp.cos(angle) + sp.I * sp.sin(angle)

    def words(self, labels: Sequence[str]) -> str:
        """Name the wave."""
        wave = f"e^({spoken(self.rate)} t + i {spoken(self.wavenumber)} n)"
        return f"insert the plane wave {wave} into {listed(labels)}"


@dataclass(frozen=True)
class TakeCoefficient(Operation):
    """Equate the coefficient of a term of the left side to zero."""

    term: sp.Expr

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``coefficient = 0``."""
        (source,) = sources
        return equation(sp.expand(left_minus_right(source)).coeff(self.term))

    def words(self, labels: Sequence[str]) -> str:
        """Name the term."""
        return f"let the coefficient of {spoken(self.term)} in {listed(labels)} vanish"


@dataclass(frozen=True)
class Rename(Operation):
    """Give a symbol the name of its particular value.

    Attributes
    ----------
    old, new : Symbol
        The two names.
    """

    old: sp.Symbol
    new: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source with the new name."""
        (source,) = sources
        return source.xreplace({self.old: self.new})

    def words(self, labels: Sequence[str]) -> str:
        """Name both."""
        return f"call this value of {spoken(self.old)} {spoken(self.new)}"


@dataclass(frozen=True)
class RenameField(Operation):
    """Let another field obey the same equation, solved for its rate.

    Attributes
    ----------
    old, new : Expr
        The two fields, functions of the time and perhaps of more.
    time : Symbol
        The time.
    """

    old: sp.Expr
    new: sp.Expr
    time: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the rate of the new field."""
        (source,) = sources
        if source.lhs != self.old.diff(self.time):
            raise OperationError(f"{source} is not solved for the rate of {self.old}")
        return equation(self.new.diff(self.time), source.rhs.xreplace({self.old: self.new}))

    def words(self, labels: Sequence[str]) -> str:
        """Name both."""
        return f"let {spoken(self.new)} obey {listed(labels)} at each place"


@dataclass(frozen=True)
class OnOneSide(Operation):
    """Bring everything to the left."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``left minus right = 0``, expanded."""
        (source,) = sources
        return equation(sp.expand(left_minus_right(source)))

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"bring everything in {listed(labels)} to the left"


@dataclass(frozen=True)
class PutEqual(Operation):
    """Let one quantity reach another; integrals stay as they are.

    Attributes
    ----------
    quantity, other : Symbol
        The two.
    """

    quantity: sp.Symbol
    other: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the source with the other in the place of the quantity."""
        (source,) = sources
        return source.xreplace({self.quantity: self.other})

    def words(self, labels: Sequence[str]) -> str:
        """Name both."""
        return f"let {spoken(self.quantity)} = {spoken(self.other)} in {listed(labels)}"
