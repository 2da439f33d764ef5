"""The claims on fronts and maps of Model II: as recorded, and able to change their verdict."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from paper_checks.claim import Verdict
from paper_checks.claims import _fronts, fig13
from theory.chains.vdp import VdpChain
from verification.fronts.measure import measure_front
from verification.fronts.result import Front


def test_fig_13_is_as_recorded_and_a_straight_line_would_be_reproduced(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    (claim,) = fig13.CLAIMS
    assert claim.judge().verdict is claim.recorded
    c = np.array(fig13.FULL)
    monkeypatch.setattr(fig13, "_full_velocities", lambda: (c + 0.1, 0.01 * c))
    assert claim.judge().verdict is Verdict.REPRODUCED


def test_a_wrong_velocity_of_the_full_chain_fails_instead_of_judging(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def wrong(*arguments: object, **options: object) -> Front:
        found = measure_front(*arguments, **options)  # type: ignore[arg-type]
        strong = found.chain.model == "vdp" and found.chain.c > 50.0
        return dataclasses.replace(found, v=found.chain.c) if strong else found

    monkeypatch.setattr("verification.fronts.measure.measure_front", wrong)
    with pytest.raises(ArithmeticError, match="scipy"):
        fig13._full_velocities()


def test_a_front_of_the_full_chain_goes_on_with_the_fastest_waves_not_with_c() -> None:
    """Waves by the slope of ω(q), without the closed form; 2 % is what a front may be ahead."""
    c, eps = 100.0, 0.01
    q = np.linspace(1e-3, np.pi, 4001)
    waves = np.gradient(np.sqrt(1.0 + 2.0 * eps * c * (1.0 - np.cos(q))), q).max() / eps
    assert abs(waves / _fronts.wave_velocity(c, eps) - 1.0) < 1e-5
    front = measure_front(VdpChain(a=4.0, b=0.5, c=c, eps=eps), accuracy=1e-2, max_sites=300)
    assert front.v is not None
    assert 1.0 < front.v / waves < 1.02
    assert abs(_fronts.velocity_on_few_sites(c) / front.v - 1.0) < 0.02
