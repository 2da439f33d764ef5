"""The report is quick to read: reasons and figures first, short text, formulas typeset."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from fronts.cli import main
from paper_checks import discover, measurements, report_text
from paper_checks.claim import Claim, Finding, Verdict
from paper_checks.discover import Entry
from paper_checks.figure_links import modules_named
from paper_checks.outcome import Judgement, Outcome
from paper_checks.report import make_report
from paper_checks.report_text import report_as_text

HERE = Path(__file__).parent


@pytest.fixture
def example_claims(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Six made-up claims in place of the paper's."""
    monkeypatch.syspath_prepend(str(HERE / "report_example"))
    monkeypatch.setattr(discover, "PACKAGE", "example_claims")
    monkeypatch.setattr(measurements, "RESULTS", HERE / "report_example" / "measured")
    monkeypatch.delenv("EXAMPLE_TROUBLE", raising=False)
    monkeypatch.delenv("EXAMPLE_LOG", raising=False)


def test_what_the_paper_rests_on_and_does_not_hold_says_why() -> None:
    for entry in discover.find_entries():
        claim = entry.claim
        if claim.weight == 2 and not claim.follows and claim.recorded is not Verdict.REPRODUCED:
            assert claim.because, claim.key
            assert "\n" not in claim.because
            assert len(claim.because) < 200


@pytest.mark.usefixtures("example_claims")
def test_a_headline_says_why_and_leads_to_its_row_and_to_a_figure(tmp_path: Path) -> None:
    assert main(["check", "--out", str(tmp_path)]) == 0
    page = (tmp_path / "index.html").read_text()
    headlines = re.findall(r"<li.*?</li>", page[page.index('<ol class="headlines">') :])[:3]
    assert "Because a fold looks straight over a &lt;short&gt; range" in headlines[0]
    for headline, key, figure in zip(
        headlines,
        ("fig16-speed", "fig9-monotone", "fig16-misprint"),
        ("fig16-speed", "fig9-decay", "fig16-speed"),
        strict=True,
    ):
        assert f'href="#claim-{key}"' in headline
        assert f'href="#figure-{figure}"' in headline
        assert f'id="figure-{figure}"' in page
    report = json.loads((tmp_path / "report.json").read_text())
    assert all(claim["shown_by"] for claim in report["claims"])


@pytest.mark.usefixtures("example_claims")
def test_a_reason_is_not_given_for_a_verdict_that_has_changed(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import example_claims.fig16

    claim = example_claims.fig16.CLAIMS[0]
    monkeypatch.setitem(claim.__dict__, "recorded", Verdict.REPRODUCED)
    assert main(["check", "fig16-speed", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["claims"][0]["because"] == ""


def test_figures_named_by_a_place_are_found() -> None:
    assert modules_named("Section 2.2, Fig. 11") == ("fig11",)
    assert modules_named("Figures without numbers, Eq. (5)") == ()


@pytest.mark.usefixtures("example_claims")
def test_the_text_starts_with_counts_and_findings_and_ends_with_measurements(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(report_text, "FEW", 2)
    assert main(["check"]) == 0
    text = capsys.readouterr().out
    assert text.startswith("6 claims in ")
    order = ["To read first", "Because a fold looks", "errata", "claim  ", "Error against run time"]
    places = [text.index(part) for part in order]
    assert places == sorted(places)
    for title in ("The default methods", "Cost as the work", "Stiff and", "What a scene does not"):
        assert f"{title}" in text
    assert all(len(line) <= 100 for line in text.splitlines())


@pytest.mark.usefixtures("example_claims")
def test_a_single_claim_is_shown_whole(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "fig16-speed"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    for part in (
        "Because a fold",
        "Error: 4e-7",
        "By: derivative of the closed form; and slope",
        "one decade further the exponent",
        "Figure: fig16-speed",
        "Reproduce with: fronts",
    ):
        assert part in text


def test_claims_that_say_the_same_are_told_in_one_sentence() -> None:
    claim = Claim("a", "Eq. 1", "It holds.", None, Verdict.REPRODUCED, "true", lambda: FINDING)
    outcomes = [
        Outcome(Entry("equations", replace(claim, key=key)), Judgement(FINDING, None, 0.0, "now"))
        for key in "abcdefghijkl"
    ]
    report = make_report(outcomes, 1.0, 12, {}, "0")
    text = report_as_text(report)
    assert "reproduced (as printed): a, b, c, d, e, f, g, h, i, j, k, l" in text
    assert text.count(FINDING.error) == 0
    other = replace(outcomes[4], judgement=Judgement(None, "It broke.", 0.0, "now"))
    text = report_as_text(make_report([*outcomes[:4], other, *outcomes[5:]], 1.0, 12, {}, "0"))
    assert "a, b, c, d, f, g" in text
    assert "e: its judge failed: It broke." in text


FINDING = Finding(
    Verdict.REPRODUCED, "as printed", "none: symbolic", ("one", "two"), "none", "It is so."
)
