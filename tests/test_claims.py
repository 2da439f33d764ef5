"""The claims of the simplified model: as recorded, and able to change their verdict."""

from __future__ import annotations

from dataclasses import replace

import pytest

from paper_checks.claim import Claim, Verdict
from paper_checks.claims import fig16, fig17, fig18
from theory.piecewise import admissibility
from theory.piecewise.profile import FrontProfile
from theory.piecewise.sums import integral as sum_integral


def _claim(key: str) -> Claim:
    return next(
        claim for claim in (*fig16.CLAIMS, *fig17.CLAIMS, *fig18.CLAIMS) if claim.key == key
    )


@pytest.mark.parametrize("module", [fig16, fig17, fig18])
def test_verdicts_are_as_recorded(module: object) -> None:
    for claim in module.CLAIMS:  # type: ignore[attr-defined]
        assert claim.judge().verdict is claim.recorded, claim.key


def test_a_wrong_profile_changes_the_verdict_on_fig_16(monkeypatch: pytest.MonkeyPatch) -> None:
    right = _profile_of()

    def wrong(*arguments: object, **options: object) -> FrontProfile:
        found = right(*arguments, **options)
        return replace(found, phi=1.001 * found.phi)

    monkeypatch.setattr("theory.piecewise.profile.front_profile", wrong)
    assert _claim("fig16-admissible").judge().verdict is Verdict.NOT_REPRODUCED


def _profile_of():  # type: ignore[no-untyped-def]
    from theory.piecewise.profile import front_profile

    return front_profile


def test_a_blind_admissibility_check_changes_the_verdict_on_fig_16(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(
        "theory.piecewise.admissibility.check_admissible",
        lambda v, c, r: admissibility.Admissibility(False, 0.0, (1.0, 1.0), 0),
    )
    assert _claim("fig16-admissible").judge().verdict is Verdict.NOT_REPRODUCED


@pytest.mark.parametrize(
    "key", ["fig17-linear", "fig17-single", "fig17-stable", "fig18-velocity", "fig18-forward"]
)
def test_a_wrong_sum_fails_the_claim_instead_of_judging_it(
    key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    right = sum_integral.sums

    def wrong(*arguments: object, **options: object) -> sum_integral.SumArray:
        found = right(*arguments, **options)  # type: ignore[arg-type]
        return sum_integral.SumArray(
            1.001 * found.value, found.error, found.by_v, found.by_c, found.points
        )

    monkeypatch.setattr("theory.piecewise.branch_search.sums", wrong)
    with pytest.raises(ArithmeticError, match="d"):
        _claim(key).judge()


def test_without_its_limits_the_velocity_is_not_explicit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("theory.piecewise.limits.strong_coupling_velocity", lambda eta: 0.7)
    claim = _claim("eq54-explicit")
    assert claim.judge().verdict is not claim.recorded


def test_a_wrong_series_fails_the_claim_on_explicitness(monkeypatch: pytest.MonkeyPatch) -> None:
    from theory.piecewise.sums.result import KineticSum

    wrong = KineticSum(value=0.5 + 0.5j, error=1e-14, terms=19, method="series", seconds=0.0)
    monkeypatch.setattr("theory.piecewise.sums.series.sum_by_roots", lambda v, c: wrong)
    with pytest.raises(ArithmeticError, match="differ"):
        _claim("eq54-explicit").judge()
