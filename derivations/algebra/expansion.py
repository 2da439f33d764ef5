"""Operations of perturbation theory: time scales, expansion in a small parameter, linearisation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import sympy as sp
from sympy.core.function import AppliedUndef

from derivations.algebra.equations import equation, left_minus_right, on_sides, parts_of
from derivations.algebra.operations import Operation, OperationError, listed, spoken


def taylor(expression: sp.Expr, small: sp.Symbol, order: int) -> list[sp.Expr]:
    """Return the coefficients of ``small**0 … small**order``."""
    found, current = [], expression
    for power in range(order + 1):
        found.append(current.subs(small, 0).doit() / sp.factorial(power))
        if power < order:
            current = sp.diff(current, small).doit()
    return found


def _with_expanded_bases(expression: sp.Expr) -> sp.Expr:
    """Expand what is squared, so that terms that cancel there disappear."""
    return expression.replace(
        lambda q: q.is_Pow and q.base.is_Add and q.exp.is_Integer,
        lambda q: sp.expand(q.base) ** q.exp,
    )


@dataclass(frozen=True)
class DifferentiateInScales(Operation):
    """Time derivatives by the chain rule, from the definition of the time scales.

    Attributes
    ----------
    function : Expr
        The motion as a function of time, as in ``y(0, t)``.
    scaled : Expr
        The same as a function of the scales.
    time : Symbol
        The time.
    order : int
        Highest derivative.
    """

    function: sp.Expr
    scaled: sp.Expr
    time: sp.Symbol
    order: int = 2

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``d/dt`` and the higher derivatives of the motion, one part each."""
        (scales,) = sources
        speeds = {part.lhs: sp.diff(part.rhs, self.time) for part in parts_of(scales)}
        current, out = self.scaled, []
        for power in range(1, self.order + 1):
            current = sp.expand(
                sum((speed * current.diff(scale) for scale, speed in speeds.items()), sp.S.Zero)
            )
            out.append(equation(self.function.diff((self.time, power)), current))
        return sp.Tuple(*out)

    def words(self, labels: Sequence[str]) -> str:
        """Name the motion."""
        return f"differentiate by the chain rule in the time scales {listed(labels)}"


@dataclass(frozen=True)
class RescaleTime(Operation):
    """Write an equation in the time scales.

    The sources are the equation, the definition of the scales (the fast one first), and, where
    there are any, the time derivatives in them.

    Attributes
    ----------
    function, scaled : Expr
        The motion as a function of time, and of the scales.
    time : Symbol
        The time, which must not remain.
    """

    function: sp.Expr
    scaled: sp.Expr
    time: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation in the scales."""
        target, scales, *derivatives = sources
        rules = {part.lhs: part.rhs for source in derivatives for part in parts_of(source)}
        rules[self.function] = self.scaled
        fast = parts_of(scales)[0]
        speed = sp.diff(fast.rhs, self.time)

        def rescaled(side: sp.Expr) -> sp.Expr:
            known = side.xreplace(rules)
            left = [q for q in known.atoms(AppliedUndef) if self.time in q.args]
            if left:
                raise OperationError(f"{left[0]} is a function of {self.time} without scales")
            return known.subs(self.time, fast.lhs / speed)

        return on_sides(target, rescaled)

    def words(self, labels: Sequence[str]) -> str:
        """Name the equations."""
        return f"write {labels[0]} in the time scales by {listed(labels[1:])}"


@dataclass(frozen=True)
class Truncate(Operation):
    """Expand in a small parameter and omit what is beyond an order.

    Attributes
    ----------
    small : Symbol
        The small parameter.
    order : int
        The last power that is kept.
    """

    small: sp.Symbol
    order: int

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the truncated expansion of both sides."""
        (source,) = sources

        def truncated(side: sp.Expr) -> sp.Expr:
            terms = taylor(side, self.small, self.order)
            return sum(
                (_with_expanded_bases(term) * self.small**m for m, term in enumerate(terms)),
                sp.S.Zero,
            )

        return on_sides(source, truncated)

    def words(self, labels: Sequence[str]) -> str:
        """Name the parameter and the order."""
        name = spoken(self.small)
        power = self.order + 1
        return f"expand {listed(labels)} in {name} and omit O({name}{_raised(power)})"


@dataclass(frozen=True)
class CollectPower(Operation):
    """Collect one power of a small parameter.

    Attributes
    ----------
    small : Symbol
        The small parameter.
    power : int
        The power whose coefficient is taken.
    unknown : Expr or None
        The function to be found: its terms stay on the left, the others go to the right.
    """

    small: sp.Symbol
    power: int
    unknown: sp.Expr | None = None

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation at that order."""
        (source,) = sources
        whole = sp.expand(taylor(left_minus_right(source), self.small, self.power)[self.power])
        if self.unknown is None:
            return equation(whole)
        kept = sum((q for q in sp.Add.make_args(whole) if q.has(self.unknown)), sp.S.Zero)
        return equation(kept, kept - whole)

    def words(self, labels: Sequence[str]) -> str:
        """Name the order."""
        name = spoken(self.small)
        order = "1" if self.power == 0 else f"{name}{_raised(self.power)}"
        return f"collect the terms of order {order} of {listed(labels)}"


@dataclass(frozen=True)
class SteadyState(Operation):
    """Let slow functions be constant.

    Attributes
    ----------
    constants : mapping of function to Symbol
        The constant value of each.
    """

    constants: Mapping[sp.Expr, sp.Expr] = field(hash=False)

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation with vanishing derivatives."""
        (source,) = sources
        return on_sides(source, lambda side: side.subs(self.constants).doit())

    def words(self, labels: Sequence[str]) -> str:
        """Name what is constant."""
        names = listed([spoken(constant) for constant in self.constants.values()])
        return f"seek a steady state of {listed(labels)}: constant {names}"


@dataclass(frozen=True)
class Limit(Operation):
    """Let a parameter go to a value.

    Attributes
    ----------
    parameter : Symbol
        What goes there.
    value : Expr
        The value.
    """

    parameter: sp.Symbol
    value: sp.Expr | int = 0

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the limit of both sides."""
        (source,) = sources

        def limited(side: sp.Expr) -> sp.Expr:
            plain = side.subs(self.parameter, self.value)
            if plain.has(sp.nan, sp.zoo):
                plain = sp.cancel(sp.together(side)).subs(self.parameter, self.value)
            if plain.is_finite is False or plain.has(sp.nan, sp.zoo, sp.oo):
                plain = sp.limit(side, self.parameter, self.value)
            return plain

        return on_sides(source, limited)

    def words(self, labels: Sequence[str]) -> str:
        """Name the limit."""
        goal = spoken(sp.sympify(self.value))
        return f"take the limit {spoken(self.parameter)} → {goal} of {listed(labels)}"


@dataclass(frozen=True)
class Detune(Operation):
    """Let a quantity differ by a small unknown from a value that was found for it.

    Attributes
    ----------
    detuning : Symbol
        The small difference.
    """

    detuning: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``quantity = value + detuning``."""
        (source,) = sources
        return equation(source.lhs, source.rhs + self.detuning)

    def words(self, labels: Sequence[str]) -> str:
        """Name the difference."""
        return f"allow a small difference {spoken(self.detuning)} from {listed(labels)}"


@dataclass(frozen=True)
class Linearise(Operation):
    """Perturb a solution and keep what is of first order in the perturbation.

    Attributes
    ----------
    perturbed : mapping of Expr to Expr
        The perturbation that is added to each variable.
    """

    perturbed: Mapping[sp.Expr, sp.Expr] = field(hash=False)

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the part of first order of both sides."""
        (source,) = sources
        small = sp.Dummy("s")
        rules = {own: own + small * change for own, change in self.perturbed.items()}

        def first(side: sp.Basic) -> sp.Basic:
            moved = side.xreplace(rules)
            if isinstance(moved, sp.MatrixBase):
                return sp.ImmutableMatrix(moved).applyfunc(lambda q: taylor(q, small, 1)[1])
            return taylor(moved.doit(), small, 1)[1]

        return on_sides(source, first)

    def words(self, labels: Sequence[str]) -> str:
        """Say what is kept."""
        return f"perturb the solution of {listed(labels)} and keep the first order"


@dataclass(frozen=True)
class SolveOscillator(Operation):
    """General real solution of ``u'' + Ω² u = 0`` in the fast time, with a slow amplitude.

    Attributes
    ----------
    fast : Symbol
        The fast time.
    amplitude : Expr
        The complex amplitude, a function of the slow time or a constant.
    """

    fast: sp.Symbol
    amplitude: sp.Expr

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``u = A e^{iΩt} + A* e^{-iΩt}`` with Ω from the characteristic polynomial."""
        (source,) = sources
        whole = left_minus_right(source)
        (unknown,) = (q for q in whole.atoms(AppliedUndef) if self.fast in q.args)
        rate = sp.Dummy("rate")
        trial = sp.exp(rate * self.fast)
        characteristic = sp.cancel(whole.subs(unknown, trial).doit() / trial)
        roots = sp.roots(sp.Poly(characteristic, rate))
        upper = [root for root in roots if sp.im(root).is_positive and sp.re(root) == 0]
        if len(upper) != 1 or sum(roots.values()) != 2:
            raise OperationError(f"{source} is not the equation of an undamped oscillator")
        wave = self.amplitude * sp.exp(upper[0] * self.fast)
        return equation(unknown, wave + sp.conjugate(wave))

    def words(self, labels: Sequence[str]) -> str:
        """Name the amplitude."""
        return f"solve {listed(labels)} by its characteristic polynomial, with slow amplitude " + (
            spoken(self.amplitude)
        )


def _raised(power: int) -> str:
    return "" if power == 1 else "".join("⁰¹²³⁴⁵⁶⁷⁸⁹"[int(digit)] for digit in str(power))
