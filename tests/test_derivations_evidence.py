"""Checks that accept a range, or that no printed formula exercises whole, at their edges."""

import math
import re

import pytest
import sympy as sp
from derivations.derivation import equation

from derivations import friction, linearisation
from derivations.algebra.errors import DerivationInputError
from derivations.cell.envelope import derive_envelope
from derivations.cell.steps import derive


@pytest.mark.parametrize(("share", "holds"), [(1.01, True), (0.99, False)])
def test_sliding_at_125_is_stable_from_the_damping_on_that_the_slope_of_friction_asks_for(
    share, holds
):
    # 2 xi = (mu_st - mu_d) / v_0 e^{-v_d / v_0}, by hand from (2) and (5), at v_d = 1.25.
    static, dynamic, scale = 0.9, 0.3, 0.4
    ratio = share * (static - dynamic) / scale * math.exp(-1.25 / scale) / 2
    numbers = (static, dynamic, scale, ratio)
    given = sp.Tuple(*(equation(sp.Symbol(f"p_{i}"), x) for i, x in enumerate(numbers)))
    assert friction._bistable_at_125(given) is holds


def test_a_cell_with_letters_and_another_damping_at_rest():
    derivation = derive(derive_envelope("3 - a*y**2 + b*y**4", "k3*y**3"))
    assert len(derivation.verify()) == 8
    ratio = derivation.steps[-2].equation.rhs
    # The zeros of 3 - a s/4 + b s^2/8 at a = 11, b = 1, by hand: 11 -+ sqrt(97).
    expected = math.sqrt((11 - math.sqrt(97)) / (11 + math.sqrt(97)))
    given = {"a": 11, "b": 1}
    found = ratio.subs({symbol: given[symbol.name] for symbol in ratio.free_symbols})
    assert float(found) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("columns", [1, 2])
def test_the_first_wrong_entry_of_a_matrix_is_named(columns):
    make = linearisation.vector_field if columns == 1 else linearisation.jacobian
    name = linearisation.field_name if columns == 1 else linearisation.jacobian_name
    right = sp.Matrix(make(3))
    check = linearisation.matrix_check("ring", columns)
    assert check(equation(name, sp.ImmutableMatrix(right))).holds
    right[4, columns - 1] += 1
    found = check(equation(name, sp.ImmutableMatrix(right)))
    assert not found.holds
    assert found.statement == f"1 entries differ, the first at (5, {columns})"


def test_a_refusal_shows_the_damping_as_it_was_read():
    with pytest.raises(DerivationInputError, match=re.escape("2*y**3 + 1")):
        derive_envelope("1 + 2*y**3")
