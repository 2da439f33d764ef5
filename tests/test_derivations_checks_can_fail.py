"""Every check notices a wrong sign, a wrong factor, a wrong exponent or a wrong index."""

from collections import Counter
from collections.abc import Iterator
from functools import lru_cache

import pytest
import sympy as sp
from sympy.core.function import AppliedUndef
from sympy.core.relational import Relational

from derivations import catalogue
from derivations.algebra.equations import equation, left_minus_right
from derivations.algebra.errors import CheckFailedError
from derivations.algebra.rendering import records, text
from derivations.algebra.steps import Derivation, Given, Step
from derivations.algebra.sums import SumOver
from derivations.cell.envelope import derive_envelope
from derivations.cell.steps import derive as derive_cell
from derivations.multiple_scales.symbols import Y
from derivations.symbols import epsilon, omega, t_hat, tau

MOST_OF_A_KIND = 3
"""Perturbations of each kind a step; long equations are sampled evenly to keep the run short."""
PARTS = 12
"""Tests a derivation; nothing is derived before they run."""

EVEN = (sp.Abs, sp.cos, sp.cosh)
SCALE_FREE = (sp.sign, sp.Heaviside)
EQUIVALENT = {
    # A velocity differs from zero with either sign.
    "friction law": Counter(["sign of v_rel"]),
    "dimensionless law": Counter([r"sign of \tilde{v}_{rel}"]),
    # The second branch is asked only where the first does not hold.
    "two lines": Counter(["sign of Abs(varphi_us)", "factor of varphi(n, t)"]),
    # A modulus.
    "kinetic relation": Counter(["sign of 1/(L_k*k)"]),
    "relation by the ratio": Counter(["sign of 1/(L_k*k)"]),
}
"""Changes that say the same, each once."""
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


def tautology(expression: sp.Basic) -> sp.Basic:
    """The same with each left side on the right as well: true, and it says nothing."""
    if isinstance(expression, sp.Equality):
        return equation(expression.lhs, expression.lhs)
    if isinstance(expression, sp.Tuple):
        return sp.Tuple(*map(tautology, expression))
    return expression


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
    for own in sorted(expression.atoms(AppliedUndef), key=str):
        place = own.args[0]
        if not place.is_Add or place.args[0] != 1:
            continue
        twin = own.func(place - 2, *own.args[1:])
        if expression.has(twin):
            yield f"index of {own}", expression.xreplace({own: twin})


@lru_cache(maxsize=16)
def derivation(key: str) -> Derivation:
    if key in CELLS:
        damping, stiffness = CELLS[key]
        return derive_cell(derive_envelope(damping, stiffness).model)
    return catalogue.load(key)


def sampled(step: Step) -> list[tuple[str, sp.Basic]]:
    kinds: dict[str, list[tuple[str, sp.Basic]]] = {}
    kinds["tautology"] = [("tautology", tautology(step.result))]
    kinds["tautology"] *= kinds["tautology"][0][1] != step.result
    for name, changed in perturbed(step.result):
        if changed != step.result:
            kinds.setdefault(name.split()[0], []).append((name, changed))
    kept = []
    for found in kinds.values():
        stride = max(1, -(-len(found) // MOST_OF_A_KIND))
        kept += found[::stride]
    return kept


@pytest.mark.parametrize("part", range(PARTS))
@pytest.mark.parametrize("key", [*catalogue.LISTING, *CELLS])
def test_a_perturbed_equation_is_noticed(key, part):
    for step in derivation(key).steps[part::PARTS]:
        evidence = step.verify()
        assert evidence.holds, f"{step.name}: {evidence.statement}"
        missed = Counter(name for name, changed in sampled(step) if step.verify(changed).holds)
        missed -= EQUIVALENT.get(step.name, Counter())
        assert not missed, f"{step.name}: not noticed: {missed}"


def test_every_step_can_be_perturbed():
    without = [step.name for key in catalogue.LISTING for step in derivation(key).steps
               if not sampled(step)]  # fmt: skip
    # A vector of names, and equations that say that something is zero, have no sign or factor.
    assert set(without) <= UNPERTURBED, set(without) - UNPERTURBED


UNPERTURBED = {"state", "kept at rest", "phase of the cell", "rest"}


def test_a_dropped_omega_in_15_is_noticed():
    step = derivation("multiple-scales").numbered(15)
    left = step.result.lhs
    dropped = left.subs(omega * Y.diff(t_hat), Y.diff(t_hat))
    assert sp.expand(dropped - left) != 0
    assert not step.verify(equation(dropped)).holds


def test_a_second_order_term_added_to_15_is_noticed():
    step = derivation("multiple-scales").numbered(15)
    for extra in (3 * epsilon**2 * Y.diff(tau, 2), epsilon**2 * Y, epsilon**3):
        assert not step.verify(equation(step.result.lhs + extra)).holds


def test_displacements_and_velocities_exchanged_in_39_are_noticed():
    step = derivation("linearisation").numbered(39)
    matrix = step.result.rhs
    half = matrix.rows // 2
    exchanged = sp.ImmutableMatrix([*matrix[half:], *matrix[:half]])
    assert not step.verify(equation(step.result.lhs, exchanged)).holds


def test_a_switch_of_44_below_the_unstable_cycle_is_noticed():
    step = derivation("piecewise-front").numbered(44)
    (threshold,) = {q for q in step.result.atoms(sp.Abs) if "us" in str(q)}
    for share in (sp.Rational(97, 100), sp.Rational(101, 100)):
        moved = step.result.replace(lambda q: q == threshold, lambda q, s=share: s * q)
        assert not step.verify(moved).holds, share


def test_a_half_plane_that_begins_above_the_axis_is_noticed():
    step = derivation("piecewise-front").numbered(52)
    raised = []
    for part in step.result.args:
        k, condition, _ = part.rhs.args
        moved = [q if isinstance(q, sp.Equality) else q.func(q.lhs, 1, evaluate=False)
                 for q in condition.args]  # fmt: skip
        above = sp.ConditionSet(k, sp.And(*moved, evaluate=False), sp.S.Complexes)
        raised.append(equation(part.lhs, above))
    evidence = step.verify(sp.Tuple(*raised))
    assert not evidence.holds
    assert evidence.statement.startswith("wrong about numbers")


def test_a_contour_integral_over_the_coordinate_is_noticed():
    step = derivation("piecewise-front").named("front as a contour integral")
    (integral,) = step.result.atoms(sp.Integral)
    (zeta,) = step.result.lhs.args
    other = sp.Integral(integral.function, zeta)
    assert not step.verify(step.result.xreplace({integral: other})).holds


@pytest.mark.parametrize("name", ["pinning coupling", "retreat coupling"])
def test_a_threshold_without_a_name_of_its_own_is_noticed(name):
    step = derivation("piecewise-front").named(name)
    assert step.verify().holds
    assert not step.verify(equation(sp.Symbol("c", positive=True), step.result.rhs)).holds


def test_springs_left_stretched_in_the_slipping_cell_are_noticed():
    step = derivation("friction").named("slipping cell")
    own = next(q for q in step.result.atoms(AppliedUndef))
    site, time = own.args
    stretched = step.result.lhs + own.func(site + 2, time) - own
    assert not step.verify(equation(stretched, step.result.rhs)).holds


def test_another_friction_coefficient_than_that_of_the_caption_is_noticed():
    step = derivation("friction").numbered(7)
    first, *rest = step.result.args
    assert not step.verify(sp.Tuple(equation(first.lhs, 2 * first.rhs), *rest)).holds


def test_a_derivation_whose_check_fails_says_so_and_stops():
    good = derivation("multiple-scales")
    old = good.steps[13]
    wrong = Given(name=old.name, given_as=good.steps[0].kind, words="a wrong claim",
                  equation=equation(left_minus_right(old.result) * 2, 1),
                  check=old.check)  # fmt: skip
    broken = Derivation(good.key, good.title, (*good.steps[:13], wrong, *good.steps[14:]))
    with pytest.raises(CheckFailedError, match="step 14"):
        broken.verify()
    shown = text(broken)
    assert "CHECK FAILED" in shown
    assert "Stopped at step 14 of" in shown
    assert "15. " not in shown
    assert records(broken)["complete"] is False
