"""What comes of judging a claim: status, changes, judgements and evidence as they are stored."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from paper_checks import claim as claims
from paper_checks import outcome as outcomes
from paper_checks import prose
from paper_checks.claim import Claim, Method, Repeat
from paper_checks.discover import Entry, UnknownKeyError, select
from paper_checks.finding import Erratum, Fault, Finding, Formula, Picture
from paper_checks.outcome import (
    FAILED,
    JudgedClaim,
    Judgement,
    Provenance,
    checked_finding,
    judge,
    judged_by,
)
from paper_checks.plain_evidence import evidence_from, plain_evidence
from paper_checks.ruling import Verdict, fails, holds, partly
from paper_checks.run import run
from tests.independence import solvers

FINDING = Finding(
    verdict=Verdict.REPRODUCED, value="1", error="0", methods=("one", "other"), tolerance="none",
    explanation="It is.",
)  # fmt: skip


@dataclass(frozen=True)
class Seen:
    number: float


def made_up(key: str = "k", **changes: Any) -> Claim:
    """Return a claim that holds; its evidence is a number."""
    return replace(
        Claim(
            key=key, place="Eq. 1", quote="at  $c = 1$ it holds", statement="It holds.",
            recorded=Verdict.REPRODUCED, command="true", evidence=lambda: Seen(2.0),
            rule=lambda _: holds(), methods=(Method("one", "theory.cells.vdp:f"),),
        ),
        **changes,
    )  # fmt: skip


@pytest.fixture(autouse=True)
def _prose(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give every claim the same text, in place of a file beside its module."""
    erratum = Erratum(Fault.AMBIGUOUS, "x", "y", "of the text", "", "")
    prose = SimpleNamespace(
        value="2", error="0", tolerance="none", explanation="It is.", remarks=("elsewhere too",),
        headline="", erratum=lambda: erratum, caption=lambda name: f"seen in {name}",
    )  # fmt: skip
    monkeypatch.setattr(claims, "written", lambda *_: prose)


# ------------------------------------------------------------------------------------ the outcome


@pytest.mark.parametrize(
    ("verdict", "status", "changed"),
    [
        (Verdict.REPRODUCED, "reproduced", False),
        (Verdict.NOT_REPRODUCED, "not-reproduced", True),
        (None, FAILED, True),
    ],
)
def test_an_outcome_is_changed_if_its_verdict_is_not_the_recorded_one_or_its_judge_failed(
    verdict: Verdict | None, status: str, changed: bool
) -> None:
    found = None if verdict is None else replace(FINDING, verdict=verdict, because="It is off.")
    outcome = JudgedClaim(
        Entry("fig01", made_up()), Judgement(found, None if found else "No root.", 1.0, "")
    )
    assert (outcome.status, outcome.changed) == (status, changed)
    assert outcome.because == ("It is off." if found else "")
    assert ("k: " in outcome.change) is changed
    assert ("its judge failed: No root." in outcome.change) is (found is None)


@pytest.mark.parametrize("stale", [True, False])
def test_only_a_stored_finding_of_other_code_is_stale(stale: bool) -> None:
    judgement = Judgement(FINDING, None, 1.0, "")
    assert (judgement.stale, judgement.stored, judgement.shared) == (False, False, 0.0)
    assert replace(judgement, provenance=Provenance("", {}, {}, stale)).stale is stale


def test_evidence_is_kept_of_claims_that_were_judged() -> None:
    assert judge(made_up()).evidence == plain_evidence(Seen(2.0))
    assert judge(made_up(rule=lambda _: 1 / 0)).evidence is None


def test_what_a_claim_shares_is_done_first_and_its_time_stated_apart(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    done: list[str] = []

    def evidence() -> Seen:
        done.append("evidence")
        return Seen(2.0)

    times = iter((1.0, 4.0, 11.0))
    monkeypatch.setattr(outcomes.time, "perf_counter", lambda: next(times))
    monkeypatch.setattr(outcomes, "now", lambda: "2026-01-01T00:00:00Z")
    found = judge(made_up(evidence=evidence, shared=lambda: done.append("shared")))
    assert done == ["shared", "evidence"]
    assert (found.shared, found.seconds) == (3.0, 7.0)
    assert (found.judged, found.failure) == ("2026-01-01T00:00:00Z", None)


@pytest.mark.parametrize(
    ("error", "said"),
    [
        (ArithmeticError("no root"), "ArithmeticError: no root."),
        (ValueError("Is it?\nIt is not."), "ValueError: Is it?"),
        (SystemExit(), "SystemExit."),
    ],
)
def test_an_error_of_a_judge_is_one_sentence(error: BaseException, said: str) -> None:
    def evidence() -> None:
        raise error

    judgement = judge(made_up(evidence=evidence))
    assert (judgement.finding, judgement.failure) == (None, said)


def test_a_finding_has_one_method_or_two() -> None:
    for methods in ((), ("one", "two", "three")):
        wrong = replace(FINDING, methods=methods)
        with pytest.raises(ValueError, match="one method or two"):
            checked_finding(wrong)


# -------------------------------------------------------------------------------------- the claim


def test_a_part_that_fails_is_one_of_the_quote_whatever_its_spaces_and_dollar_signs() -> None:
    def ruled(part: str) -> Any:
        return made_up(rule=lambda _: partly(part, "It is off."))

    assert ruled("$c =  1$").found(Seen(2.0)).part == "$c =  1$"
    with pytest.raises(ValueError, match="not a part of the quote"):
        ruled("at c = 2").found(Seen(2.0))
    assert made_up(rule=lambda _: fails("It is off.")).found(Seen(2.0)).part == ""


def test_a_finding_has_what_the_claim_draws_typesets_and_corrects() -> None:
    drawn, formula = Picture("p", "", "<svg/>", ""), Formula("As printed", "x")
    own = Erratum(Fault.MISPRINT, "a", "b", "of the claim", "", "")
    claim = made_up(figure=lambda _: (drawn,), formulas=lambda _: (formula,), erratum=lambda _: own)
    found = claim.found(Seen(2.0))
    assert [picture.caption for picture in found.pictures] == ["seen in p"]
    assert (found.formulas, found.erratum) == ((formula,), own)
    plain = made_up().found(Seen(2.0))
    assert (plain.pictures, plain.formulas) == ((), ())
    assert plain.erratum.reason == "of the text"


def test_the_text_of_a_claim_is_beside_the_module_of_its_rule(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[Any] = []
    prose = claims.written  # the one of these tests

    def written(*arguments: Any) -> Any:
        asked.extend(arguments)
        return prose(*arguments)

    monkeypatch.setattr(claims, "written", written)
    made_up(rule=lambda _: holds()).found(Seen(2.0))
    assert asked == [__name__, "k", Seen(2.0)]


WORDS = """place: Eq. 1
quote: It holds at $c = 1$.
statement: It holds.
printed: c = 1
recorded: holds only in part
command: fronts check one  # as printed
by: runs [verification.runs.simulate:simulate], for c = 1
by: reading [paper_checks.claims.expectations:rule]
also: Section 2: it holds: always"""


def beside(monkeypatch: pytest.MonkeyPatch, section: str) -> Claim:
    """Return the claim whose words are in a made-up text."""
    monkeypatch.setattr(prose, "_sections", lambda _: {"one": section})
    return Claim.beside("one", rule=holds, evidence=dict, weight=0)


@pytest.mark.parametrize(("line", "headline"), [("headline: Why.\n", "Why."), ("", "")])
def test_the_text_of_a_claim_is_filled_in_as_it_is(
    line: str, headline: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    section = f"{WORDS}\n\n{line}value: {{{{ e }}}}\nerror: 1\ntolerance: 0\n\nIt is.\n"
    monkeypatch.setattr(prose, "_sections", lambda _: {"one": section})
    found = prose.written(prose.__name__, "one", "a < b")
    assert (found.value, found.headline, found.explanation) == ("a < b", headline, "It is.")


def test_the_words_of_a_claim_are_those_of_its_text(monkeypatch: pytest.MonkeyPatch) -> None:
    claim = beside(monkeypatch, f"{WORDS}\n\nvalue: 1\n")
    assert claim == Claim(
        key="one", place="Eq. 1", quote="It holds at $c = 1$.", statement="It holds.",
        printed="c = 1", recorded=Verdict.PARTIAL, command="fronts check one  # as printed",
        methods=(Method("runs", "verification.runs.simulate:simulate", "c = 1"),
                 Method("reading", "paper_checks.claims.expectations:rule")),
        repeats=(Repeat("Section 2", "it holds: always"),),
        rule=holds, evidence=dict, weight=0,
    )  # fmt: skip
    without_value = beside(monkeypatch, WORDS.replace("printed: c = 1\n", ""))
    assert without_value == replace(claim, printed=None)


@pytest.mark.parametrize(
    ("line", "instead", "said"),
    [
        ("quote: It holds at $c = 1$.\n", "", "the text of one has"),
        ("statement:", "weight: 2\nstatement:", "the text of one has"),
        ("place: Eq. 1\n", "", "begins with 'place:'"),
        ("[verification.runs.simulate:simulate]", "by simulation", "write it as WORDS"),
        ("], for c = 1", "] for c = 1", "write it as WORDS"),
        ("only in part", "in part", "not a valid Verdict"),
    ],
)
def test_a_text_without_the_words_of_its_claim_is_refused(
    monkeypatch: pytest.MonkeyPatch, line: str, instead: str, said: str
) -> None:
    assert WORDS.count(line) == 1
    with pytest.raises(ValueError, match=said):
        beside(monkeypatch, WORDS.replace(line, instead))


def test_a_claim_is_of_ordinary_weight_and_computed_in_every_run_unless_it_says_otherwise() -> None:
    claim = made_up()
    assert (claim.weight, claim.expensive, claim.repeats) == (1, False, ())


def test_a_method_says_what_it_covers_if_that_is_not_all() -> None:
    method = Method("a run", "verification.runs.simulate:simulate")
    assert (str(method), method.module) == ("a run", "verification.runs.simulate")
    assert str(replace(method, covers="the velocity")) == "a run (this covers the velocity)"


def test_claims_are_chosen_by_key_or_group_in_their_own_order() -> None:
    entries = tuple(Entry(group, made_up(key)) for group, key in (
        ("fig02", "fig02-stick"), ("fig02", "fig02-map"), ("fig03", "fig03-front"),
    ))  # fmt: skip
    assert select(entries, ["fig03-front", "fig02"]) == entries
    assert select(entries, ["fig02-map"]) == entries[1:2]
    assert select(entries, []) == entries
    with pytest.raises(UnknownKeyError, match="did you mean fig02-stick"):
        select(entries, ["fig02-stik"])
    with pytest.raises(UnknownKeyError) as refusal:
        select(entries, ["zzz"])
    assert "did you mean" not in str(refusal.value)


# --------------------------------------------------------------------------------------- as stored


def test_evidence_of_an_earlier_run_is_judged_by_the_rule_of_this_one() -> None:
    first = judge(made_up())
    packages = (__name__.partition(".")[0],)
    kept = json.loads(json.dumps(first.evidence))
    earlier = {"seconds": 1.5, "judged": "2026-01-01T00:00:00Z", "shared": 0.25}
    again = judged_by(made_up(), kept, packages, **earlier)
    assert again == Judgement(first.finding, None, 1.5, "2026-01-01T00:00:00Z", True, shared=0.25)
    changed = judged_by(made_up(rule=lambda _: fails("It is off.")), kept, packages, **earlier)
    assert changed.finding.verdict is Verdict.NOT_REPRODUCED
    with pytest.raises(ValueError, match="Seen of"):
        judged_by(made_up(), kept, ("paper_checks",), **earlier)


@dataclass(frozen=True)
class Other:
    verdict: Verdict


def test_a_store_is_given_what_was_judged_and_holds_nothing_of_a_claim_that_failed(
    caplog: pytest.LogCaptureFixture,
) -> None:
    def broken() -> None:
        raise ArithmeticError("no root")

    entries = [Entry("m", made_up()), Entry("m", made_up("broken", evidence=broken))]
    held: dict[str, Any] = {}
    store: Any = SimpleNamespace(results=held, add=held.__setitem__)
    with caplog.at_level("INFO", logger="paper_checks.run"):
        for stored in (False, True):  # at first there is nothing, and nothing damaged
            first, second = run(entries, store=store, packages=(__name__.partition(".")[0],))
            assert (first.judgement.stored, second.judgement.stored) == (stored, False)
            assert list(held) == ["k"]
    assert not caplog.records


def test_evidence_that_is_forged_or_is_none_is_refused() -> None:
    packages = (__name__.partition(".")[0], "paper_checks")
    plain = plain_evidence(Other(Verdict.PARTIAL))
    assert evidence_from(plain, packages) == Other(Verdict.PARTIAL)
    member = plain["object"]["verdict"]
    for forged in (
        {**member, "of": plain["of"]},  # a member of what is no enumeration
        {"object": {}, "of": member["of"]},  # an object of what is no dataclass
        {"other": {}, "of": plain["of"]},
        {"other": {}, "of": member["of"]},
    ):
        with pytest.raises(ValueError, match="evidence holds a"):
            evidence_from(forged, packages)
    for other in (Other, object()):
        with pytest.raises(TypeError, match="evidence cannot hold"):
            plain_evidence(other)


def test_complex_numbers_are_kept_also_in_arrays_and_so_is_none() -> None:
    held = (1.0 - 2.0j, np.array([[3.0 + 4.0j], [complex(5.0, math.inf)]]), None, True)
    back = evidence_from(json.loads(json.dumps(plain_evidence(held))), ())
    assert (back[0], back[2], back[3]) == (held[0], None, True)
    assert np.array_equal(back[1], held[1])


def test_evidence_is_the_same_text_whatever_the_order_of_its_sets() -> None:
    words = [f"site {n}" for n in range(20)]
    assert plain_evidence(set(words)) == {"set": sorted(words)}
    assert plain_evidence(tuple(words[::-1])) == {"tuple": words[::-1]}


def test_finite_numbers_are_kept_as_numbers_and_the_others_as_words() -> None:
    assert plain_evidence([0.1, math.inf]) == [0.1, {"float": "inf"}]
    back = evidence_from(json.loads(json.dumps(plain_evidence({math.inf: [math.nan]}))), ())
    assert list(back) == [math.inf]
    assert math.isnan(back[math.inf][0])


# ------------------------------------------------------------------------------------ independence


def test_a_solver_computes_and_is_no_definition() -> None:
    run = Method("a run", "verification.runs.simulate:simulate")
    found = solvers(run)
    assert "verification.runs.simulate" in found
    assert "verification.steppers.friction" in found
    for defined in ("theory.parameters", "theory.chains.vdp", "verification", "theory.chains"):
        assert defined not in found
    assert not any(name.startswith("theory.cells.") for name in found)
