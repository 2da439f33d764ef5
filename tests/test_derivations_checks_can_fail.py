"""Every check notices a wrong sign, a wrong factor, a wrong exponent or a wrong index."""

from collections.abc import Iterator
from functools import lru_cache

import pytest
import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational

from derivations import catalogue
from derivations.cell.steps import derive as derive_cell
from derivations.derivation import Derivation, Step, equation
from derivations.cell.envelope import derive_envelope
from derivations.algebra.errors import CheckFailedError
from derivations.front_symbols import SumOver

MOST_OF_A_KIND = 12
"""Perturbations of each kind a step; long equations are sampled evenly to keep the run short."""

EVEN = (sp.Abs, sp.cos, sp.cosh)
SCALE_FREE = (sp.sign, sp.Heaviside)
EQUIVALENT = {
    # A sum over all m of an even function of k + 2 pi m: both signs say the same.
    "Sum the integrand over all periods, for any A with Re A > 0": {"sign of k", "sign of 2*pi*m"},
}
CELLS = {
    "bistable": ("1 - a*y**2 + b*y**4", None),
    "detuned": ("y**2 - 1", "k2*y**2 + k3*y**3"),
}


def perturbed(expression: sp.Basic) -> Iterator[tuple[str, sp.Basic]]:
    """The expression with one thing changed, and what was changed."""
    if isinstance(expression, (AppliedUndef, sp.Derivative)) or not expression.args:
        return
    for place, part in enumerate(expression.args):
        if isinstance(expression, (SumOver, sp.Integral, sp.Sum)) and place:
            continue  # limits and names of sets

        def rebuilt(new: sp.Basic, place: int = place) -> sp.Basic:
            return rebuild(expression, place, new)

        factors = factors_for(expression, place)
        for name, factor in factors:
            yield f"{name} of {part}", rebuilt(factor * part)
        if isinstance(expression, sp.Pow) and place == 1 and part.is_Integer and part > 1:
            yield f"exponent {part}", rebuilt(part + 1)
        if isinstance(expression, sp.Equality) and (place, part) == (1, 0):
            named = expression.args[0].is_Symbol
            yield from [("zero", rebuilt(sp.Integer(1)))] if named else []
        for name, inner in perturbed(part):
            yield name, rebuilt(inner)
    if isinstance(expression, (sp.Equality, sp.Tuple)):
        yield from misplaced(expression)


def factors_for(expression: sp.Basic, place: int) -> list[tuple[str, int]]:
    """Factors that change the value of ``expression`` when put on its argument."""
    both = [("sign", -1), ("factor", 2)]
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


def misplaced(expression: sp.Basic) -> Iterator[tuple[str, sp.Basic]]:
    """A right neighbour written for a left one."""
    for atom in sorted(expression.atoms(sp.Symbol, AppliedUndef), key=str):
        name = str(atom.func) if isinstance(atom, AppliedUndef) else atom.name
        if "n+1}" not in name:
            continue
        other = name.replace("n+1}", "n-1}")
        if isinstance(atom, AppliedUndef):
            twin = sp.Function(other, real=True)(*atom.args)
            known = [q for q in expression.atoms(AppliedUndef) if str(q) == str(twin)]
        else:
            known = [q for q in expression.atoms(sp.Symbol) if q.name == other]
        for twin in known:
            yield f"index of {name}", expression.xreplace({atom: twin})


@lru_cache(maxsize=16)
def derivation(key: str) -> Derivation:
    if key in CELLS:
        damping, stiffness = CELLS[key]
        return derive_cell(derive_envelope(damping, stiffness))
    return catalogue.load(key)


def all_steps() -> Iterator[tuple[str, int]]:
    for key in (*catalogue.LISTING, *CELLS):
        yield from ((key, place) for place in range(len(derivation(key).steps)))


def sampled(step: Step) -> list[tuple[str, sp.Basic]]:
    kinds: dict[str, list[tuple[str, sp.Basic]]] = {}
    for name, changed in perturbed(step.equation):
        if changed != step.equation:
            kinds.setdefault(name.split()[0], []).append((name, changed))
    kept = []
    for found in kinds.values():
        stride = max(1, -(-len(found) // MOST_OF_A_KIND))
        kept += found[::stride]
    return kept


@pytest.mark.parametrize(("key", "place"), list(all_steps()))
def test_a_perturbed_equation_is_noticed(key, place):
    step = derivation(key).steps[place]
    evidence = step.verify()
    assert evidence.holds, evidence.statement
    changes = sampled(step)
    if not isinstance(step.equation, sp.Equality) or step.number != 39:
        assert changes, "no way was found to perturb this equation"
    same = EQUIVALENT.get(step.operation, set())
    missed = [name for name, changed in changes if name not in same and step.verify(changed).holds]
    assert not missed, f"{step.operation}: not noticed: {missed}"


def test_a_derivation_whose_check_fails_says_so_and_stops():
    from dataclasses import replace

    from derivations.rendering import records, text

    good = derivation("multiple-scales")
    wrong = replace(good.steps[13], equation=equation(good.steps[13].equation.lhs * 2, 1))
    broken = replace(good, steps=(*good.steps[:13], wrong, *good.steps[14:]))
    with pytest.raises(CheckFailedError, match="step 14"):
        broken.verify()
    shown = text(broken)
    assert "CHECK FAILED" in shown
    assert "Stopped at step 14 of" in shown
    assert "15. " not in shown
    assert records(broken)["complete"] is False
