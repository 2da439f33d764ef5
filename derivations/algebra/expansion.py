"""Perturbation theory: time scales, expansion in a small parameter, limits, linearisation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from typing import ClassVar

import sympy as sp

from derivations.algebra.equations import equation, left_minus_right, on_sides, parts_of
from derivations.algebra.notation import raised
from derivations.algebra.operations import Operation, OperationError, inline, listed


def taylor(expression: sp.Expr, small: sp.Symbol, order: int) -> list[sp.Expr]:
    """Return the coefficients of ``small**0 … small**order``."""
    derivatives = enumerate(islice(_derivatives(expression, small), order + 1))
    return [_coefficient(current, small, power) for power, current in derivatives]


def taylor_coefficient(expression: sp.Expr, small: sp.Symbol, power: int) -> sp.Expr:
    """Return the coefficient of ``small**power`` alone."""
    derivative = next(islice(_derivatives(expression, small), power, None))
    return _coefficient(derivative, small, power)


def _derivatives(expression: sp.Expr, small: sp.Symbol) -> Iterator[sp.Expr]:
    """Yield an expression and its derivatives, one after another."""
    while True:
        yield expression
        expression = sp.diff(expression, small).doit()


def _coefficient(derivative: sp.Expr, small: sp.Symbol, power: int) -> sp.Expr:
    return derivative.subs(small, 0).doit() / sp.factorial(power)


def _with_expanded_bases(expression: sp.Expr) -> sp.Expr:
    """Expand squared terms, so that terms that cancel there disappear."""
    return expression.replace(
        lambda q: q.is_Pow and q.exp.is_Integer,
        lambda q: sp.expand(q.base) ** q.exp,
    )


@dataclass(frozen=True)
class DifferentiateInScales(Operation):
    """Write time derivatives by the chain rule, from the definition of the time scales.

    Attributes
    ----------
    function : Expr
        The motion as a function of time, as in ``y(0, t)``.
    scaled : Expr
        The same motion as a function of the scales.
    time : Symbol
        The time.
    order : int
        Highest derivative.
    """

    phrase: ClassVar[str] = "differentiate by the chain rule in the time scales {sources}"
    function: sp.Expr
    scaled: sp.Expr
    time: sp.Symbol
    order: int = 2

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``d/dt`` and the higher derivatives of the motion, one part each."""
        (scales,) = sources
        rates = {part.lhs: sp.diff(part.rhs, self.time) for part in parts_of(scales)}
        current, derivatives = self.scaled, []
        for power in range(1, self.order + 1):
            current = sp.expand(
                sum((rate * current.diff(scale) for scale, rate in rates.items()), sp.S.Zero)
            )
            derivatives.append(equation(self.function.diff((self.time, power)), current))
        return sp.Tuple(*derivatives)


@dataclass(frozen=True)
class Truncate(Operation):
    """Expand in a small parameter and omit all terms beyond an order.

    Attributes
    ----------
    small : Symbol
        The small parameter.
    order : int
        The highest power that is kept.
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
        name = inline(self.small)
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
        The function to be found: its terms remain on the left, the others go to the right.
    """

    small: sp.Symbol
    power: int
    unknown: sp.Expr | None = None

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation at that order."""
        (source,) = sources
        whole = sp.expand(taylor_coefficient(left_minus_right(source), self.small, self.power))
        if self.unknown is None:
            return equation(whole)
        left = sum((q for q in sp.Add.make_args(whole) if q.has(self.unknown)), sp.S.Zero)
        return equation(left, left - whole)

    def words(self, labels: Sequence[str]) -> str:
        """Name the order."""
        name = inline(self.small)
        order = "1" if self.power == 0 else f"{name}{_raised(self.power)}"
        return f"collect the terms of order {order} of {listed(labels)}"


@dataclass(frozen=True)
class Limit(Operation):
    """Let a parameter approach a value.

    For an integral over a period of hyperbolic functions of ``A / parameter`` the limit is taken
    under the integral: the real part of A is positive, so that the limit is the same as for a
    positive A.

    Attributes
    ----------
    parameter : Symbol
        The parameter.
    value : Expr
        Its limit.
    side : int
        From which side, 1 or -1; 0 if this makes no difference.
    """

    parameter: sp.Symbol
    value: sp.Expr | int
    side: int = 0

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the limit of both sides."""
        (source,) = sources
        return on_sides(source, self._limited)

    def _limited(self, side: sp.Expr) -> sp.Expr:
        if side.has(sp.Integral):
            if self.value != 0:
                raise OperationError("under an integral only the limit to zero is taken")
            (integral,) = side.atoms(sp.Integral)
            return side.xreplace({integral: self._under(integral)})
        plain = side.subs(self.parameter, self.value)
        if plain.has(sp.nan, sp.zoo):
            plain = sp.cancel(sp.together(side)).subs(self.parameter, self.value)
        if plain.has(sp.nan, sp.zoo, sp.oo):
            plain = sp.limit(side, self.parameter, self.value)
        return plain

    def _under(self, integral: sp.Integral) -> sp.Integral:
        k, *bounds = integral.limits[0]
        positive = sp.Dummy("A")
        (hyperbolic,) = integral.function.atoms(sp.sinh)
        periodic = sp.expand(hyperbolic.args[0] * self.parameter)
        plain = integral.function.subs(periodic, positive)
        if self.side == 0 or not plain.has(positive):
            raise OperationError("the integrand has no limit")
        ratio = sp.Dummy("s")  # e^{-A/|v|}
        in_ratio = plain.subs(self.parameter, -self.side * positive / sp.log(ratio)).rewrite(sp.exp)
        limit = sp.limit(sp.simplify(in_ratio), ratio, 0)
        if limit.has(ratio):
            raise OperationError("the integrand has no limit")
        return sp.Integral(limit.xreplace({positive: periodic}), (k, *bounds))

    def words(self, labels: Sequence[str]) -> str:
        """Name the limit."""
        goal = inline(sp.sympify(self.value)) + {1: "⁺", -1: "⁻", 0: ""}[self.side]
        return f"take the limit {inline(self.parameter)} → {goal} of {listed(labels)}"


@dataclass(frozen=True)
class Linearise(Operation):
    """Perturb a state and keep the terms of first order in the perturbation.

    Attributes
    ----------
    changes : mapping of Symbol or function class to the same
        The perturbed quantities, with their perturbations. A field is perturbed at all places and
        times.
    rate : Symbol or None
        Name of the left side of a first-order system for the perturbation.
    at_rest : bool
        Whether the state is zero. Otherwise it is the value given by a second source or, for
        symbols, arbitrary.
    """

    changes: Mapping[sp.Basic, sp.Basic]
    rate: sp.Symbol | None = None
    at_rest: bool = False

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the linear equation of the perturbation."""
        target, *state = sources
        delta = sp.Dummy("s")

        def first_order(side: sp.Expr) -> sp.Expr:
            for quantity, perturbation in self.changes.items():
                side = self._perturbed(side, quantity, perturbation, delta, *state)
            return sp.expand(taylor_coefficient(side.doit(), delta, 1))

        if self.rate is None:
            return equation(first_order(left_minus_right(target)))
        return equation(self.rate, sp.ImmutableMatrix([first_order(row) for row in target.rhs]))

    def _perturbed(
        self,
        side: sp.Expr,
        quantity: sp.Basic,
        perturbation: sp.Basic,
        delta: sp.Symbol,
        *state: sp.Basic,
    ) -> sp.Expr:
        if not isinstance(quantity, sp.FunctionClass):
            return side.xreplace({quantity: quantity + delta * perturbation})
        state_value = sp.S.Zero if self.at_rest else state[0].rhs
        return side.replace(quantity, lambda *at: state_value + delta * perturbation(*at))

    def words(self, labels: Sequence[str]) -> str:
        """Name the state."""
        about = "rest" if self.at_rest else listed(labels[1:]) or "a solution"
        return f"linearise {labels[0]} about {about}"


def _raised(power: int) -> str:
    return "" if power == 1 else raised(power)
