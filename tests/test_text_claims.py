"""The claims about the text: as recorded, and able to change when what they rest on is wrong."""

from __future__ import annotations

import ast
import dataclasses
import math
import re
from pathlib import Path

import numpy as np
import pytest

from paper_checks.claim import Claim, Verdict
from paper_checks.claims import (
    _friction_cell,
    text_1_setup,
    text_1_states,
    text_2_breather,
    text_2_cells,
    text_2_nucleation,
    text_3_front,
    text_3_simplified,
)
from paper_checks.outcome import judge
from theory.averaged.breather import Reading

MODULES = (
    text_1_setup,
    text_1_states,
    text_2_breather,
    text_2_cells,
    text_2_nucleation,
    text_3_front,
    text_3_simplified,
)
COMPUTED = [
    claim
    for module in MODULES
    for claim in module.CLAIMS
    if not claim.follows and claim.recorded is not Verdict.UNTESTABLE
]


def claim(key: str) -> Claim:
    return next(one for one in COMPUTED if one.key == key)


@pytest.mark.parametrize("one", COMPUTED, ids=[one.key for one in COMPUTED])
def test_the_verdict_is_as_recorded(one: Claim) -> None:
    found = judge(one)
    assert found.failure is None
    assert found.finding is not None
    assert found.finding.verdict is one.recorded
    corrected = one.recorded is Verdict.CORRECTED
    assert not corrected or found.finding.erratum is not None


def test_what_no_computation_decides_gives_a_reason() -> None:
    for module in MODULES:
        for one in module.CLAIMS:
            if one.recorded is Verdict.UNTESTABLE and not one.follows:
                finding = one.judge()
                assert finding.verdict is Verdict.UNTESTABLE
                assert len(finding.explanation) > 30


def test_the_hopf_speed_is_where_the_slope_of_friction_balances_the_damper() -> None:
    belt = _friction_cell.hopf_speed()
    step = 1e-6
    slope = (_friction_cell.friction(belt + step) - _friction_cell.friction(belt - step)) / 2e-6
    assert abs(2.0 * _friction_cell.XI + slope) < 1e-8  # second-order difference at step 1e-6


def test_a_wrong_friction_law_changes_the_unstable_cycle(monkeypatch: pytest.MonkeyPatch) -> None:
    """With friction that grows with speed, steady sliding attracts all: no unstable cycle."""
    monkeypatch.setattr(_friction_cell, "friction", lambda speed: 1.0 - 0.5 * math.exp(-speed))
    assert judge(claim("text-inner-cycle")).failure is not None


def test_a_damped_ring_in_place_of_free_ends_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    from theory.averaged import envelope

    literal = envelope.coupling_matrix

    def wrong(sites: int, ends: object) -> np.ndarray:
        return 2.0 * np.eye(sites) - np.eye(sites, k=1) - np.eye(sites, k=-1)

    assert literal(4, envelope.Ends.FREE)[0, 0] == 1.0
    monkeypatch.setattr(envelope, "coupling_matrix", wrong)
    assert claim("text-ends").judge().verdict is Verdict.NOT_REPRODUCED


def test_a_wrong_cycle_amplitude_changes_the_verdict_on_the_cell(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from theory.chains.vdp import VdpChain

    right = VdpChain.stable_amplitude.fget
    assert right is not None
    monkeypatch.setattr(VdpChain, "stable_amplitude", property(lambda chain: 1.07 * right(chain)))
    assert claim("text-cell").judge().verdict is Verdict.NOT_REPRODUCED


def test_a_wrong_closed_form_is_not_found_by_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    from theory.averaged import breather

    right = breather.solve_breather

    def wrong(chain: object, reading: Reading = Reading.NEIGHBOUR) -> object:
        found = right(chain, reading)  # type: ignore[arg-type]
        alpha = found.alpha_0
        return dataclasses.replace(found, alpha_0=None if alpha is None else alpha + 1e-6)

    monkeypatch.setattr(breather, "solve_breather", wrong)
    assert claim("text-extraction").judge().verdict is Verdict.NOT_REPRODUCED


def test_outside_of_the_bistable_range_patterns_do_not_coexist(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(text_1_states, "V_D", 1.95)
    assert claim("text-intro-bistable").judge().verdict is Verdict.NOT_REPRODUCED


def test_where_a_strong_coupling_extinguishes_the_nucleus_it_does_not_promote(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    right = text_1_states.chain_of
    monkeypatch.setattr(
        text_1_states, "chain_of", lambda c, sites=31, belt=1.35: right(c, sites, belt)
    )
    monkeypatch.setattr(text_1_states, "LADDER", (0.005, 0.03, 0.2))
    assert claim("text-coupling-promotes").judge().verdict is Verdict.NOT_REPRODUCED


def test_a_wrong_sign_of_the_coupling_in_the_average_is_seen(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from theory.averaged import envelope

    right = envelope.envelope_rate
    monkeypatch.setattr(
        envelope, "envelope_rate", lambda phi, chain: np.conj(right(np.conj(phi), chain))
    )
    assert claim("text-gauge").judge().verdict is Verdict.NOT_REPRODUCED


def test_a_wrong_fold_fails_instead_of_judging(monkeypatch: pytest.MonkeyPatch) -> None:
    from verification.thresholds import continuation as module

    right = module.breather_threshold

    def wrong(*arguments: object, **options: object) -> object:
        found = right(*arguments, **options)  # type: ignore[arg-type]
        return dataclasses.replace(found, c=found.c + 1e-3)

    monkeypatch.setattr(module, "breather_threshold", wrong)
    for key in ("text-limiting", "text-two-values"):
        assert "ArithmeticError" in (judge(claim(key)).failure or "")


VERIFICATION = Path(__file__).parents[1] / "verification"
PACKAGES = sorted(
    path.parent.relative_to(VERIFICATION).as_posix() for path in VERIFICATION.rglob("__init__.py")
)


@pytest.mark.parametrize("package", PACKAGES)
def test_what_a_package_says_of_its_modules_exists(package: str) -> None:
    here = VERIFICATION / package
    modules = {path.stem for path in here.glob("*.py")} | {
        path.parent.name for path in here.glob("*/__init__.py")
    }
    described = ast.get_docstring(ast.parse((here / "__init__.py").read_text(encoding="utf-8")))
    named = set(re.findall(r"``([\w ]+)``", described or ""))
    assert named - {"QUANTITIES"} <= modules
