"""The command that derives and checks everything for random chains."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from benchmarks import other_models
from benchmarks.other_models import ModelFinding, findings, main, random_model
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.evidence import Evidence
from derivations.catalogue import WITH_MODEL
from derivations.symbols import c

PASSES, FAILS = Evidence(True, "agrees"), Evidence(False, "off by a half")


def test_models_differ_in_all_that_a_derivation_hangs_on() -> None:
    models = [random_model(seed) for seed in range(60)]
    assert len(set(models)) > 50
    assert {model.reach for model in models} == {1, 2, 3}
    assert {bool(model.stiffness) for model in models} == {True, False}
    assert {model.coupling.has(c) for model in models} == {True, False}
    assert {bool(model.parameters) for model in models} == {True, False}
    assert {max(model.damping) for model in models} == {4, 6, 8}


def _load(monkeypatch: pytest.MonkeyPatch, **outcomes: Any) -> None:
    """Let derivations, by name with underscores, have steps with this evidence, or an error."""

    def loaded(name: str, model: object) -> SimpleNamespace:
        outcome = outcomes.get(name.replace("-", "_"), PASSES)

        def examined() -> Iterator[tuple[Any, Evidence]]:
            yield SimpleNamespace(name="first"), PASSES
            if isinstance(outcome, Exception):
                raise outcome
            yield SimpleNamespace(name="second"), outcome

        return SimpleNamespace(examined=examined)

    monkeypatch.setattr(other_models, "load", loaded)


def test_a_failing_check_an_error_and_a_refusal_are_told_apart(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    refusal = DerivationInputError("damping", "1", "of another form", "give one")
    _load(monkeypatch, averaging=FAILS, linearisation=ZeroDivisionError("oops"),
          piecewise_front=refusal)  # fmt: skip
    expected = {
        "averaging": ModelFinding(
            derivation="averaging", message="second: off by a half", fails=True
        ),
        "linearisation": ModelFinding(
            derivation="linearisation", message="ZeroDivisionError: oops", fails=True
        ),
        "piecewise-front": ModelFinding(
            derivation="piecewise-front", message=str(refusal), fails=False
        ),
    }
    found = list(findings(random_model(1)))
    assert found == [expected[name] for name in WITH_MODEL if name in expected]


@pytest.mark.parametrize("text", ["5:4", "many", "1:2:3", "1.5", ":", ""])
def test_what_names_no_seed_is_refused_and_not_found_to_hold(
    text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit, match="2"):
        main([text])
    assert f"{text!r} is not a seed: give a whole number" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("outcome", "code", "said"),
    [
        (PASSES, 0, "2 models, 0 with a check that fails"),
        (DerivationInputError("damping", "1", "another", "give one"), 0, "    refused averaging:"),
        (FAILS, 1, "2 models, 2 with a check that fails"),
        (ValueError("no"), 1, "    FAILS averaging: ValueError: no"),
    ],
)
def test_the_exit_code_says_whether_a_check_fails(
    outcome: Any, code: int, said: str,
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    _load(monkeypatch, averaging=outcome)
    assert main(["4:5"]) == code
    printed = capsys.readouterr().out
    assert said in printed
    assert printed.startswith("4 FAILS" if code else "4 holds")
