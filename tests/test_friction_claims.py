"""The claims on Figs. 3-6 and on the two models: recorded verdicts, and that they can change."""

from __future__ import annotations

import pytest

from paper_checks.claim import Claim, Verdict
from paper_checks.claims import _friction, fig03, fig04, fig05, fig06, models


@pytest.fixture(autouse=True)
def _forget() -> None:
    for kept in (
        fig04._figure,
        fig04._readings,
        fig05._checked,
        fig06._fronts,
    ):
        kept.cache_clear()


def _claim(module: object, key: str) -> Claim:
    return next(claim for claim in module.CLAIMS if claim.key == key)  # type: ignore[attr-defined]


def test_fig_3_is_as_recorded_and_a_sharper_eye_would_tell_the_curves_apart(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for claim in fig03.CLAIMS:
        assert claim.judge().verdict is claim.recorded
    monkeypatch.setattr(fig03, "SEEN", 0.01)
    assert _claim(fig03, "fig03-breather").judge().verdict is Verdict.NOT_REPRODUCED


def test_fig_4_is_as_recorded_and_the_verdicts_depend_on_the_readings(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(fig04, "SIZES", (1, 3))
    short = {name: fig04.READINGS[name] for name in ("literal (5) at the ends", "by τ = 400")}
    monkeypatch.setattr(fig04, "READINGS", short)
    for claim in fig04.CLAIMS:
        assert claim.judge().verdict is claim.recorded
    fig04._readings.cache_clear()
    monkeypatch.setattr(fig04, "READINGS", {})
    assert _claim(fig04, "fig04-edge").judge().verdict is Verdict.REPRODUCED
    assert _claim(fig04, "fig04-bulk").judge().verdict is Verdict.NOT_REPRODUCED


def test_fig_5_is_as_recorded_on_a_part_of_the_map(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fig05, "COUPLINGS", (0.005, 0.025, 0.055, 0.095))
    monkeypatch.setattr(fig05, "VELOCITIES", (1.05, 1.25, 1.45, 1.55, 1.95))
    monkeypatch.setattr(fig05, "WIDE_COUPLINGS", (0.03, 0.095))
    for claim in fig05.CLAIMS:
        assert claim.judge().verdict is claim.recorded
    # without the point that is in none of the three states
    monkeypatch.setattr(fig05, "COUPLINGS", (0.005, 0.055, 0.095))
    assert _claim(fig05, "fig05-regions").judge().verdict is Verdict.REPRODUCED
    # without a coupling low enough for a breather a region is missing
    monkeypatch.setattr(fig05, "COUPLINGS", (0.055, 0.095))
    assert _claim(fig05, "fig05-regions").judge().verdict is Verdict.PARTIAL
    # where one site does as well as many, nothing is wrong with the statement
    monkeypatch.setattr(fig05, "WIDE_COUPLINGS", (0.03,))
    assert _claim(fig05, "fig05-nucleation").judge().verdict is Verdict.REPRODUCED


def test_fig_6_is_as_recorded_and_a_shorter_range_of_c_would_look_linear(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(fig06, "COUPLINGS", (0.011, 0.012, 0.02, 0.04, 0.06, 0.08, 0.1))
    for claim in fig06.CLAIMS:
        assert claim.judge().verdict is claim.recorded
    monkeypatch.setattr(fig06, "STEEPER", 3.0)
    assert _claim(fig06, "fig06-rapid").judge().verdict is Verdict.NOT_REPRODUCED
    fig06._fronts.cache_clear()
    monkeypatch.setattr(fig06, "LARGE", (0.12,))
    assert _claim(fig06, "fig06-linear").judge().verdict is Verdict.REPRODUCED
    monkeypatch.setattr(fig06, "RESIDUAL", 1e-4)
    assert _claim(fig06, "fig06-linear").judge().verdict is Verdict.NOT_REPRODUCED


@pytest.mark.parametrize("claim", models.CLAIMS, ids=lambda claim: claim.key)
def test_the_models_side_by_side_are_as_recorded(claim: Claim) -> None:
    assert claim.judge().verdict is claim.recorded


def test_a_wrong_run_fails_the_claim_instead_of_judging_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    right = _friction.arrivals_compiled

    def wrong(*arguments: object) -> object:
        return 1.001 * right(*arguments)  # type: ignore[arg-type]

    monkeypatch.setattr(_friction, "arrivals_compiled", wrong)
    with pytest.raises(ArithmeticError, match="differ"):
        _claim(fig03, "fig03-front").judge()
