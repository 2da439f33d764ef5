"""Small steps of the derivations that no other test looks at one by one."""

import random

import mpmath
import numpy as np
import pytest
import sympy as sp

from derivations.algebra.errors import DerivationInputError
from derivations.algebra.evidence import equals, value
from derivations.averaging.readings import averaged_breather
from derivations.cell import polynomial_text
from derivations.cell.polynomial_text import LONGEST, read_polynomial
from derivations.front.numbers import Lattice, kinetic_sum, profile, roots
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from theory.piecewise.profile import front_profile
from verification.breathers.envelope import solve_envelope_breather

x = sp.Symbol("x")


@pytest.mark.parametrize("mark", ["(", "-"])
def test_a_text_may_be_nested_as_deep_as_its_length_allows(mark: str) -> None:
    deep = LONGEST - 2 if mark == "-" else LONGEST // 2 - 1
    text = mark * deep + "y" + ")" * (deep if mark == "(" else 0)
    assert read_polynomial(text, "damping") == {(("y", 1),): 1}
    with pytest.raises(DerivationInputError, match="characters"):
        read_polynomial(f"({2 * mark}{text})", "damping")


@pytest.mark.parametrize("kind", [RecursionError, MemoryError])
def test_a_text_for_which_the_stack_is_too_small_is_refused(
    kind: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    def parse(*_: object, **__: object) -> None:
        raise kind

    monkeypatch.setattr(polynomial_text.ast, "parse", parse)
    with pytest.raises(DerivationInputError, match="nested too deep"):
        read_polynomial("y", "damping")


@pytest.mark.parametrize(("tolerance", "holds"), [(0.34, True), (0.33, False)])
def test_a_difference_counts_relative_to_both_sides(tolerance: float, holds: bool) -> None:
    def draw(_: random.Random) -> tuple[dict, list[complex]]:
        return {x: 1.0}, [0.5]

    # found 1, expected 1/2: a half, of terms of size 1 and 1/2
    evidence = equals("a half", tolerance=tolerance)(draw)(sp.Eq(x, 0, evaluate=False))
    assert evidence.holds is holds


def test_a_complex_number_of_mpmath_keeps_its_sign() -> None:
    assert complex(value(x, {x: mpmath.mpc(1, 2)})) == 1 + 2j


@pytest.mark.parametrize("zeta", [-1.5, 0.7])
def test_the_profile_by_history_is_that_of_the_integral_at_strong_coupling(zeta: float) -> None:
    v, c = 2.5, 6.0
    exact = front_profile([zeta], v, c, 1e-12)
    assert abs(profile(Lattice(0.5, (c,)), zeta, v) - exact.phi[0]) < 1e-9


@pytest.mark.parametrize("springs", [(4.02, 9.08), (5.0, 0.3), (3.0, 4.0, 5.0)])
def test_roots_at_strong_springs_are_all_there_and_none_is_false(
    springs: tuple[float, ...],
) -> None:
    """With labels from the fourth period on, the sum was off by 0.001 to 0.01."""
    lattice, v = Lattice(0.5, springs), 0.5
    found = roots(lattice, v)
    terms = 1 / (found * lattice.slope(found, v))
    inside = [terms[abs(found.real) < 2 * np.pi * count + 0.3].sum() for count in (1500, 3000)]
    # What is left out falls like the inverse of the distance.
    assert abs(2 * inside[1] - inside[0] - kinetic_sum(lattice, v)) < 1e-6


def test_the_sampled_breather_is_that_of_the_averaged_chain() -> None:
    found = abs(averaged_breather())
    chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=23)
    exact = solve_envelope_breather(chain, Nucleus(1)).amplitudes[11:]
    np.testing.assert_allclose(found[:8], exact[:8], rtol=1e-8, atol=1e-12)
