"""Equations with one thing changed: a sign, a factor, an exponent or an index."""

from collections.abc import Iterator
from functools import cache

import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational

from derivations.algebra.equations import equation
from derivations.algebra.steps import Step
from derivations.algebra.sums import SumOver

Changed = tuple[str, sp.Basic, sp.Basic]
"""What kind of change it is, of which part, and the expression with it."""

MAX_OF_A_KIND = 3
"""Perturbations of each kind a step; long equations are sampled evenly to keep the run short."""
FACTOR = sp.Rational(101, 100)
COARSE = frozenset(
    {
        # Places of a row at which an inequality holds.
        "one passage",
        # Terms of higher order, found as a small part of what is measured.
        "strong sum",
        "averaging in the amplitude of multiple scales, chain",
        "chain in quarter turns to second order",
        "modulation by multiple scales, chain",
        "next harmonics of the cell",
    }
)
"""Steps whose checks tell a factor 2 from 1, but not in each term a hundredth."""
EVEN = (sp.Abs, sp.cos, sp.cosh)
SCALE_FREE = (sp.sign, sp.Heaviside)


def perturbed(expression: sp.Basic, by: sp.Expr = FACTOR) -> Iterator[Changed]:
    """The expression with one thing changed, a factor by `by`, and what was changed."""
    if isinstance(expression, (AppliedUndef, sp.Derivative)) or not expression.args:
        return
    for place, part in enumerate(expression.args):
        if isinstance(expression, (SumOver, sp.Integral, sp.Sum)) and place:
            continue  # limits and names of sets

        def rebuilt(new: sp.Basic, place: int = place) -> sp.Basic:
            return rebuild(expression, place, new)

        factors = factors_for(expression, place, by)
        for name, factor in factors:
            yield name, part, rebuilt(factor * part)
        if isinstance(expression, sp.Pow) and place == 1 and part.is_Integer and part > 1:
            yield "exponent", part, rebuilt(part + 1)
        if isinstance(expression, sp.Equality) and (place, part) == (1, 0):
            named = expression.args[0].is_Symbol
            yield from [("zero", part, rebuilt(sp.Integer(1)))] if named else []
        for name, of, inner in perturbed(part, by):
            yield name, of, rebuilt(inner)
    if isinstance(expression, (sp.Equality, sp.Tuple)):
        yield from misplaced(expression)


def tautology(expression: sp.Basic) -> sp.Basic:
    """The same with each left side on the right as well: true, and it says nothing."""
    if isinstance(expression, sp.Equality):
        return equation(expression.lhs, expression.lhs)
    if isinstance(expression, sp.Tuple):
        return sp.Tuple(*map(tautology, expression))
    return expression


def misshapen(expression: sp.Basic) -> Iterator[tuple[str, sp.Basic]]:
    """An equation of nothing that is there, no equation, and a system without its last part."""
    yield "shape: another", equation(sp.Symbol("another"), 1)
    yield "shape: none", sp.Tuple()
    if isinstance(expression, sp.Tuple):
        yield "shape: one part fewer", sp.Tuple(*expression[:-1])


def factors_for(expression: sp.Basic, place: int, by: sp.Expr) -> list[tuple[str, sp.Expr]]:
    """Factors that change the value of ``expression`` when put on its argument."""
    both = [("sign", sp.S.NegativeOne), ("factor", by)]
    part = expression.args[place]
    if part == 0 or not isinstance(part, sp.Expr):
        return []
    if isinstance(expression, sp.Add):
        return both
    if isinstance(expression, sp.Function):
        if isinstance(expression, (sp.re, sp.im)):
            return both[:1]  # only compared with zero
        if isinstance(expression, sp.conjugate) or (len(expression.args) > 1 and place):
            return []
        if isinstance(expression, EVEN):
            return both[1:]
        return both[:1] if isinstance(expression, SCALE_FREE) else both
    if isinstance(expression, SumOver):
        return both
    if isinstance(expression, Relational):
        other = expression.args[1 - place]
        if other == 0:
            return [] if isinstance(expression, sp.Equality) else both[:1]
        return both
    return []


def rebuild(expression: sp.Basic, place: int, new: sp.Basic) -> sp.Basic:
    arguments = list(expression.args)
    arguments[place] = new
    if isinstance(expression, sp.Equality):
        return equation(*arguments)
    if isinstance(expression, (Relational, sp.Contains, sp.Equivalent)):
        return expression.func(*arguments, evaluate=False)
    return expression.func(*arguments)


def misplaced(expression: sp.Basic) -> Iterator[Changed]:
    """A right neighbour written for a left one."""
    for own in sorted(expression.atoms(AppliedUndef), key=str):
        place = own.args[0]
        if not place.is_Add or place.args[0] != 1:
            continue
        twin = own.func(place - 2, *own.args[1:])
        if expression.has(twin):
            yield "index", own, expression.xreplace({own: twin})


@cache
def sampled(step: Step) -> list[tuple[str, sp.Basic]]:
    by = sp.Integer(2) if step.name in COARSE else FACTOR
    says_nothing = tautology(step.result)
    kept = [("tautology", says_nothing)] if says_nothing != step.result else []
    kept += misshapen(step.result)
    kinds: dict[str, list[Changed]] = {}
    for changed in perturbed(step.result, by):
        if changed[-1] != step.result:
            kinds.setdefault(changed[0], []).append(changed)
    for found in kinds.values():
        stride = max(1, -(-len(found) // MAX_OF_A_KIND))
        kept += [(f"{kind} of {part}", new) for kind, part, new in found[::stride]]
    return kept
