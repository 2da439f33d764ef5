"""The sum over a set of roots, as a symbol."""

from derivations.algebra.sums import SumOver
from derivations.front.symbols import L_k, M_plus, c, k, v


def test_the_variable_is_bound_and_the_set_is_free() -> None:
    total = SumOver(v / (k * L_k), k, M_plus)
    assert total.free_symbols == {v, L_k, M_plus}
    assert (c * total).free_symbols == {c, v, L_k, M_plus}
