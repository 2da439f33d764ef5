"""The sum over a set of roots, as a symbol; integrals over k, as numbers."""

import math

import numpy as np
import pytest

from derivations.algebra.sums import SumOver
from derivations.front.numbers import _to_infinity
from derivations.front.symbols import L_k, M_plus, c, k, v


def test_the_variable_is_bound_and_the_set_is_free() -> None:
    total = SumOver(v / (k * L_k), k, M_plus)
    assert total.free_symbols == {v, L_k, M_plus}
    assert (c * total).free_symbols == {c, v, L_k, M_plus}


def test_an_integral_to_infinity_is_known_to_its_digits_or_refused() -> None:
    for integrand, true in (
        (lambda k: 1.0 / (1.0 + k * k), math.pi / 2),
        (lambda k: (1.0 - np.cos(k)) / (k * k), math.pi / 2),
        (lambda k: 1.0 / (1.0 + k) ** 2, 1.0),
    ):
        assert abs(_to_infinity(integrand) - true) < 1e-8
    with pytest.raises(ArithmeticError, match="did not converge"):
        _to_infinity(lambda k: 1.0 / (1.0 + k))
