"""Every check notices a wrong sign, a wrong factor, a wrong exponent or a wrong index."""

from collections import Counter
from functools import lru_cache

import pytest
import sympy as sp
from sympy.core.function import AppliedUndef

from derivations import catalogue
from derivations.algebra.equations import equation, left_minus_right
from derivations.algebra.errors import CheckFailedError
from derivations.algebra.rendering import records, text
from derivations.algebra.steps import Derivation, Given
from derivations.cell.envelope import derive_envelope
from derivations.cell.steps import derive as derive_cell
from derivations.multiple_scales.symbols import Y
from derivations.symbols import epsilon, omega, t_hat, tau
from tests.perturbed_equations import sampled

PARTS = 12
"""Tests a derivation; nothing is derived before they run."""

EQUIVALENT = {
    # A modulus.
    "kinetic relation": Counter(["sign of 1/(L_k*k)"]),
    "relation by the ratio": Counter(["sign of 1/(L_k*k)"]),
}
"""Changes that say the same, each once."""
CELLS = {
    "bistable": ("1 - a*y**2 + b*y**4", None),
    "detuned": ("y**2 - 1", "k2*y**2 + k3*y**3"),
}


@lru_cache(maxsize=16)
def derivation(key: str) -> Derivation:
    if key in CELLS:
        damping, stiffness = CELLS[key]
        return derive_cell(derive_envelope(damping, stiffness).model)
    return catalogue.load(key)


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
