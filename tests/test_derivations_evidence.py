"""Checks that accept a range, or that no printed formula exercises whole, at their edges."""

import math
import re

import pytest

from derivations.algebra.errors import DerivationInputError
from derivations.cell.envelope import derive_envelope
from derivations.cell.polynomial_input import coefficients
from derivations.cell.steps import derive


def test_a_cell_with_letters_and_another_damping_at_rest():
    derivation = derive(derive_envelope("3 - a*y**2 + b*y**4", "k3*y**3").model)
    assert len(derivation.verify()) == 12
    ratio = derivation.named("ratio of the cycles").result.rhs
    # The zeros of 3 - a s/4 + b s^2/8 at a = 11, b = 1, by hand: 11 -+ sqrt(97).
    expected = math.sqrt((11 - math.sqrt(97)) / (11 + math.sqrt(97)))
    given = {"a": 11, "b": 1}
    found = ratio.subs({symbol: given[symbol.name] for symbol in ratio.free_symbols})
    assert float(found) == pytest.approx(expected, rel=1e-12)


def test_a_refusal_shows_the_damping_as_it_was_read():
    with pytest.raises(DerivationInputError, match=re.escape("2*y**3 + 1")):
        derive_envelope("1 + 2*y**3")


def test_a_stiffness_may_be_absent_and_a_damping_may_not():
    assert coefficients(None, "stiffness") == {}
    for read in (lambda: coefficients(None, "damping"), lambda: derive_envelope(None)):
        with pytest.raises(DerivationInputError, match="damping = None is not allowed"):
            read()
