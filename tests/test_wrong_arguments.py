"""Functions that take a chain refuse what is none, or another model, in a sentence."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

import fronts as fr

CHAINS = {
    "vdp": fr.VdpChain(a=4, b=0.5, c=0.05, sites=7),
    "averaged": fr.AveragedChain(a=4, b=0.5, c=0.05, sites=7),
    "piecewise": fr.PiecewiseChain(c=0.5, eta=0.03125),
    "friction": fr.FrictionChain(c=0.02, sites=7),
    "own": fr.OscillatorChain(damping="1 - 4*y**2 + 0.5*y**4", c=0.05, sites=7),
}
NO_CHAINS = {
    "nothing": None,
    "text": "vdp",
    "cell": fr.FrictionCell(),
    "class": fr.VdpChain,
    "array": [[0.0, 1.0], [0.0, 0.0]],
}
TAKE_A_CHAIN: dict[str, tuple[Callable[[Any], object], set[str]]] = {
    "averaging_error": (fr.averaging_error, {"averaged", "piecewise", "friction"}),
    "breather": (fr.breather, {"piecewise", "friction"}),
    "cell": (fr.cell, {"piecewise"}),
    "ensemble": (lambda chain: fr.ensemble(len, chain), {*CHAINS}),
    "excite": (lambda chain: fr.excite(chain, [1]), {"piecewise"}),
    "follow_breather": (
        lambda chain: fr.follow_breather(chain, [0.1]), {"piecewise", "friction", "own"}
    ),
    "follow_front": (
        lambda chain: fr.follow_front(chain, [0.5]), {"vdp", "piecewise", "friction", "own"}
    ),
    "measure_front": (fr.measure_front, set()),
    "simulate": (lambda chain: fr.simulate(chain, [[0.0] * 7] * 2, 1.0), {"piecewise"}),
    "state_map": (lambda chain: fr.state_map(chain, c=[0.1]), {"piecewise"}),
    "threshold": (fr.threshold, {"piecewise"}),
}  # fmt: skip
"""Function, and the models that it has no answer for."""


@pytest.mark.parametrize("given", NO_CHAINS)
@pytest.mark.parametrize("name", TAKE_A_CHAIN)
def test_what_is_no_chain_is_refused(name: str, given: str) -> None:
    if (name, given) == ("cell", "cell"):
        return
    with pytest.raises(fr.ParameterError, match="is not allowed: it must be"):
        TAKE_A_CHAIN[name][0](NO_CHAINS[given])


@pytest.mark.parametrize(
    ("name", "model"), [(n, m) for n, (_, wrong) in TAKE_A_CHAIN.items() for m in sorted(wrong)]
)
def test_a_model_that_a_function_has_no_answer_for_is_refused(name: str, model: str) -> None:
    with pytest.raises(fr.ParameterError, match="is not allowed: it must be"):
        TAKE_A_CHAIN[name][0](CHAINS[model])


@pytest.mark.parametrize("nucleus", [3, "3", None])
def test_a_nucleus_is_a_nucleus(nucleus: Any) -> None:
    chain = CHAINS["vdp"]
    for ask in (
        lambda: fr.breather(chain, nucleus=nucleus),
        lambda: fr.threshold(chain, nucleus),
        lambda: fr.follow_breather(chain, [0.1], nucleus=nucleus),
    ):
        with pytest.raises(fr.ParameterError, match=r"Nucleus\(3\)"):
            ask()


@pytest.mark.parametrize("couplings", [0.1, "0.1", [], [-0.1], [float("nan")], ["a"], None])
def test_couplings_are_positive_numbers(couplings: Any) -> None:
    for ask in (
        lambda: fr.follow_breather(CHAINS["vdp"], couplings),
        lambda: fr.follow_front(CHAINS["averaged"], couplings),
    ):
        with pytest.raises(fr.ParameterError, match=r"^coupling c = "):
            ask()
