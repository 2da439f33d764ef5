"""The report is quick to read: reasons and figures first, short text, formulas typeset."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from fronts.cli import main
from paper_checks import discover, measurements
from paper_checks.claim import Verdict
from paper_checks.figure_links import modules_named

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
