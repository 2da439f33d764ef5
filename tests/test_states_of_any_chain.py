"""``threshold`` and ``state_map`` take any chain, and refuse in a sentence what does not apply."""

from __future__ import annotations

from typing import Any

import pytest

from theory.chains.nucleus import Nucleus
from theory.chains.piecewise import PiecewiseChain
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.maps.state_map import state_map
from verification.thresholds.result import Definition, Mechanism, RunThreshold
from verification.thresholds.threshold import threshold


def test_bisection_between_runs_meets_the_fold_of_continuation() -> None:
    """Two methods that share no code; a run passes a fold in a time like (c - c_fold)^(-1/2)."""
    chain = AveragedChain(a=2.5, b=0.5, c=0.0, sites=15)
    fold = threshold(chain)
    runs = threshold(chain, method="bisection", accuracy=1e-4, lowest=0.1, tests=0, final_time=1e3)
    assert fold.definition is Definition.EXISTENCE
    assert isinstance(runs, RunThreshold)
    assert runs.high > fold.c
    assert -runs.error <= runs.c - fold.c < 3e-4
    stable = threshold(chain, definition="stability")
    assert stable.mechanism is Mechanism.SYMMETRY_BREAKING
    assert stable.c < fold.c


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
