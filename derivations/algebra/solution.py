"""Solving: equations for symbols and angles, stated limits and prescribed coefficients."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import sympy as sp
from sympy.core.function import AppliedUndef

from derivations.algebra.equations import equation, left_minus_right, parts_of, system
from derivations.algebra.operations import Operation, OperationError, in_words, inline, listed


@dataclass(frozen=True)
class SolveFor(Operation):
    """Solve an equation for a symbol; several solutions are returned as a system.

    An angle that occurs under cosines only is found with every branch. The factor of a field may be
    named by a second source.

    Attributes
    ----------
    unknown : Expr, or tuple of Expr
        The unknown; one for each part of a system.
    """

    unknown: sp.Basic | tuple[sp.Basic, ...]

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``unknown = solution``, once for each solution."""
        source, *named = sources
        if isinstance(self.unknown, tuple):
            pairs = zip(self.unknown, parts_of(source), strict=True)
            return sp.Tuple(*(SolveFor(unknown)(part) for unknown, part in pairs))
        stand_in = sp.Dummy(real=True) if self.unknown.is_real else sp.Dummy()
        difference = left_minus_right(source).xreplace({self.unknown: stand_in})
        if difference.has(sp.cos(stand_in)):
            found = self._angles(difference, stand_in)
        elif sp.diff(difference, stand_in).has(stand_in):
            found = sp.solve(difference, stand_in)
        else:
            found = [-difference.subs(stand_in, 0) / self._factor(difference, stand_in, *named)]
        if not found:
            raise OperationError(f"{source} has no solution for {self.unknown}")
        return system(tuple(equation(self.unknown, solution) for solution in found))

    def _factor(self, difference: sp.Expr, stand_in: sp.Symbol, *named: sp.Basic) -> sp.Expr:
        """Return the factor of the unknown, or its name."""
        slope = sp.diff(difference, stand_in)
        if sp.expand(slope) == 0:
            raise OperationError(f"the equation does not contain {self.unknown}")
        for name in named:
            if sp.simplify((slope - name.rhs).rewrite(sp.exp)) != 0:
                raise OperationError(f"{name.lhs} is not the factor of {self.unknown}")
            return name.lhs
        return slope

    def _angles(self, difference: sp.Expr, angle: sp.Symbol) -> list[sp.Expr]:
        """Return ``±arccos(root)`` for each root, the negative sign first."""
        cosine = sp.Dummy("cosine")
        whole = sp.expand(difference)
        whole = whole.replace(lambda q: isinstance(q, sp.cos) and q.has(angle), sp.expand_trig)
        polynomial = sp.Poly(sp.expand(whole).xreplace({sp.cos(angle): cosine}), cosine)
        if polynomial.has(angle):
            raise OperationError(f"not only cosines of {self.unknown} occur")
        if polynomial.degree() == 1:
            linear, constant = polynomial.all_coeffs()
            roots = [sp.simplify(-constant / linear)]
        elif polynomial.degree() == 2:
            # First the root that stays finite when the leading coefficient vanishes.
            quadratic, linear, constant = polynomial.all_coeffs()
            root_of_discriminant = sp.sqrt(linear**2 - 4 * quadratic * constant)
            roots = [
                -2 * constant / (linear + root_of_discriminant),
                -(linear + root_of_discriminant) / (2 * quadratic),
            ]
        else:
            raise OperationError(
                f"it is of degree {polynomial.degree()} in cos {inline(self.unknown)}"
            )
        return [sign * sp.acos(root) for root in roots for sign in (-1, 1)]

    def words(self, labels: Sequence[str]) -> str:
        """Name the unknown, and the source that names its factor."""
        named = f", its factor by the name of {listed(labels[1:])}" if labels[1:] else ""
        return f"solve {labels[0]} for {in_words(self.unknown)}{named}"


@dataclass(frozen=True)
class SelectRoot(Operation):
    """Keep the one of several solutions that satisfies a rule at all test values.

    Attributes
    ----------
    rule : str
        The rule in words.
    accepts : callable
        Whether a numerical value satisfies it.
    values : mapping of Symbol to tuple of float
        Values at which it is tested.
    """

    phrase: ClassVar[str] = "keep the solution of {sources} with {rule}"
    rule: str
    accepts: Callable[[complex], bool]
    values: Mapping[sp.Symbol, tuple[float, ...]]

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


@dataclass(frozen=True)
class SelectSign(Operation):
    """Keep the one of several solutions that is a negative multiple of an expression.

    The expression is left minus right of the second source.

    Attributes
    ----------
    rule : str
        What this means.
    """

    phrase: ClassVar[str] = (
        "keep the solution of {first} that is positive where {others} is negative: {rule}"
    )
    rule: str

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the part that is kept."""
        solutions, expression = sources
        whole = left_minus_right(expression)
        kept = [q for q in parts_of(solutions) if sp.cancel(q.rhs / whole).is_negative]
        if len(kept) != 1:
            raise OperationError(
                f"{len(kept)} of the solutions are a negative multiple of {inline(whole)}"
            )
        return kept[0]


@dataclass(frozen=True)
class SolveOscillator(Operation):
    """Return the general real solution of ``u'' + Ω² u = 0`` in the fast time, with slow amplitude.

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
            inline(self.amplitude)
        )


@dataclass(frozen=True)
class PrescribeCoefficients(Operation):
    """Prescribe coefficients of a linear left side, and solve for the scales.

    Attributes
    ----------
    demands : tuple of (tuple of Expr, Expr)
        Terms, and the required sum of their coefficients.
    unknowns : tuple of Symbol
        The unknowns, in the order in which the result is written.
    """

    demands: tuple[tuple[tuple[sp.Expr, ...], sp.Expr], ...]
    unknowns: tuple[sp.Symbol, ...]

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return one equation for each unknown."""
        (source,) = sources
        left = sp.expand(source.lhs)
        demands = [sum((left.coeff(term) for term in terms), sp.S.Zero) - value
                for terms, value in self.demands]  # fmt: skip
        known: dict[sp.Basic, sp.Expr] = {}
        while len(known) < len(self.unknowns):
            unknown, demand = self._of_one_unknown([each.subs(known) for each in demands])
            # The sign of a positive unknown is used only if its square occurs.
            own = unknown if sp.diff(demand, unknown, 2) != 0 else sp.Dummy()
            roots = sp.solve(demand.xreplace({unknown: own}), own)
            if len(roots) != 1:
                raise OperationError(f"{len(roots)} values of {unknown} satisfy one demand")
            known[unknown] = roots[0]
        if any(sp.simplify(each.subs(known)) != 0 for each in demands):
            raise OperationError("these coefficients contradict one another")
        return sp.Tuple(*(equation(own, sp.simplify(known[own])) for own in self.unknowns))

    def _of_one_unknown(self, demands: list[sp.Expr]) -> tuple[sp.Symbol, sp.Expr]:
        """Return a demand that contains a single unknown, preceded by that unknown."""
        for demand in demands:
            contained = [unknown for unknown in self.unknowns if demand.has(unknown)]
            if len(contained) == 1:
                return contained[0], demand
        raise OperationError("these coefficients do not determine the scales")

    def words(self, labels: Sequence[str]) -> str:
        """Name the demands."""
        values = listed([inline(value) for _, value in self.demands])
        names = listed([inline(own) for own in self.unknowns])
        return f"demand the coefficients {values} in {listed(labels)} and solve for {names}"


@dataclass(frozen=True)
class SolveLimits(Operation):
    """Determine the constants of a law from its stated limits.

    The first source is the law, the second the limits: ``f(0) = ...`` and ``f(oo) = ...``.

    Attributes
    ----------
    variable : Symbol
        The argument of the law.
    constants : tuple of Symbol
        The constants that are solved for and inserted.
    """

    phrase: ClassVar[str] = "find {constants} of {first} from {others}"
    variable: sp.Symbol
    constants: tuple[sp.Symbol, ...]

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the law with its constants inserted."""
        law, limits = sources
        rest = [sp.limit(law.rhs, self.variable, part.lhs.args[0]) - part.rhs
                for part in parts_of(limits)]  # fmt: skip
        found = sp.solve(rest, self.constants, dict=True)
        if len(found) != 1:
            raise OperationError("the limits do not determine the constants")
        return equation(law.lhs, law.rhs.subs(found[0]))
