"""``threshold`` and ``state_map`` take any chain, and refuse in a sentence what does not apply."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus
from theory.chains.piecewise import PiecewiseChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.maps.state_map import state_map
from verification.thresholds import threshold as thresholds
from verification.thresholds.result import BranchThreshold, Definition, Mechanism, RunThreshold
from verification.thresholds.threshold import threshold


def test_bisection_between_runs_meets_the_fold_of_continuation() -> None:
    """Two methods that share no code; a run passes a fold in a time like (c - c_fold)^(-1/2)."""
    chain = AveragedChain(a=2.5, b=0.5, c=0.0, sites=15)
    fold = threshold(chain)
    runs = threshold(chain, method="bisection", accuracy=1e-4, lowest=0.1, tests=0, final_time=1e3)
    assert fold.definition is Definition.EXISTENCE
    assert isinstance(runs, RunThreshold)
    assert runs.high > fold.c_crit
    assert runs.perturbation == 0.0
    assert -runs.error <= runs.c_crit - fold.c_crit < 3e-4
    stable = threshold(chain, definition="stability")
    assert isinstance(stable, BranchThreshold)
    assert stable.mechanism is Mechanism.SYMMETRY_BREAKING
    assert (stable.c_crit, stable.error) == (stable.stable_to, stable.stable_to_error)
    assert stable.c_crit < fold.c_crit


@pytest.mark.parametrize(
    "make",
    [
        lambda: threshold(VdpChain(a=2.5, b=0.5, c=0), method="guess"),
        lambda: threshold(VdpChain(a=2.5, b=0.5, c=0), definition="whole"),
        lambda: threshold(VdpChain(a=1, b=0.5, c=0)),
        lambda: threshold(VdpChain(a=2.5, b=0.5, c=0), Nucleus(43, "0" * 42)),
        lambda: threshold(VdpChain(a=2.5, b=0.5, c=0), Nucleus(3, "-+"), method="sweep"),
        lambda: threshold(VdpChain(a=2.5, b=0.5, c=0), Nucleus(3, "-+"), method="closed-form"),
        lambda: threshold(
            AveragedChain(a=2.5, b=0.5, c=0), Nucleus(3, "-+"), definition="stability"
        ),
        lambda: threshold(PiecewiseChain(c=0.5, eta=0.03)),
        lambda: state_map(VdpChain(a=2.5, b=0.5, c=0, sites=16)),
        lambda: state_map(PiecewiseChain(c=0.5, eta=0.03), c=[0.1]),
    ],
)
def test_what_does_not_apply_is_refused_in_a_sentence(make: Any) -> None:
    with pytest.raises(ParameterError):
        make()


@pytest.mark.parametrize(
    ("method", "definitions"),
    [
        ("envelope", {"existence", "stability"}),
        ("orbit", {"existence", "stability"}),
        ("closed-form", {"existence"}),
        ("sweep", {"existence"}),
        ("hold", {"first"}),
        ("bisection", {"first", "several", "whole"}),
    ],
)
def test_a_method_finds_what_is_asked_or_refuses(
    method: str, definitions: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every definition with every method: the threshold has the one that was named."""
    _in_place_of_runs(monkeypatch)
    chain = VdpChain(a=2.5, b=0.5, c=0)
    assert threshold(chain, method=method).definition.value in definitions
    for each in Definition:
        if each.value in definitions:
            assert threshold(chain, method=method, definition=each).definition is each
        else:
            refusal = f"definition for the method {method} .* take another method"
            with pytest.raises(ParameterError, match=refusal):
                threshold(chain, method=method, definition=each)


def test_a_sweep_without_a_fold_is_no_threshold_of_existence(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The coupling is then held; who named `existence` is told so, others by the result."""
    _in_place_of_runs(monkeypatch, of_a_sweep=Definition.FIRST)
    chain = VdpChain(a=2.5, b=0.5, c=0)
    assert threshold(chain, method="sweep").definition is Definition.FIRST
    with pytest.raises(ParameterError, match="definition = existence"):
        threshold(chain, method="sweep", definition="existence")


def _in_place_of_runs(
    monkeypatch: pytest.MonkeyPatch, of_a_sweep: Definition = Definition.EXISTENCE
) -> None:
    def found(definition: Definition) -> Any:
        return SimpleNamespace(definition=definition)

    made = {
        "breather_threshold": lambda *_, **__: found(Definition.EXISTENCE),
        "_of_stability": lambda _: found(Definition.STABILITY),
        "sweep_threshold": lambda *_: found(of_a_sweep),
        "escape_range": lambda *_: found(Definition.FIRST),
        "spreading_threshold": lambda _, spreading, **__: found(spreading.definition),
    }
    for name, function in made.items():
        monkeypatch.setattr(thresholds, name, function)


@pytest.mark.parametrize("chain", [FrictionChain(c=0), PiecewiseChain(c=0.5, eta=0.03)])
def test_a_method_that_a_model_has_not_is_what_is_refused(chain: Any) -> None:
    with pytest.raises(ParameterError, match=f"method = orbit .* for the model {chain.model}"):
        threshold(chain, method="orbit")
