"""The sum over a set of roots, as a symbol."""

from derivations.front_symbols import L_k, M_plus, SumOver, c, k, v


def test_what_is_summed_over_is_not_free() -> None:
    total = SumOver(v / (k * L_k), k, M_plus)
    assert total.free_symbols == {v, L_k}
    assert (c * total).free_symbols == {c, v, L_k}
