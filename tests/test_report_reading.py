"""The report is quick to read: reasons and figures first, short text, formulas typeset."""

from __future__ import annotations

import json
import re
import sys
import time
from collections.abc import Callable
from html import escape
from pathlib import Path
from xml.etree import ElementTree

import pytest

from fronts.cli import main
from fronts.commands.check import STORE
from paper_checks import discover
from paper_checks.claim import Claim, Verdict
from paper_checks.discover import Entry
from paper_checks.outcome import JudgedClaim, judge
from paper_checks.report import measurements, terminal
from paper_checks.report.document import make_report, pictures_listed
from paper_checks.report.figure_links import modules_named
from paper_checks.report.inline_math import typeset
from paper_checks.report.mathml import formula, mathml

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "report_example"))

from example_claims._made import Made, made  # noqa: E402


@pytest.fixture
def example_claims(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Six made-up claims in place of the paper's."""
    monkeypatch.syspath_prepend(str(HERE / "report_example"))
    monkeypatch.setattr(discover, "PACKAGE", "example_claims")
    monkeypatch.setattr(measurements, "RESULTS", HERE / "report_example" / "measured")
    monkeypatch.delenv("EXAMPLE_TROUBLE", raising=False)
    monkeypatch.delenv("EXAMPLE_LOG", raising=False)


@pytest.mark.usefixtures("example_claims")
def test_a_headline_says_why_and_leads_to_its_row_and_to_a_figure(tmp_path: Path) -> None:
    assert main(["check", "--out", str(tmp_path)]) == 0
    page = (tmp_path / "index.html").read_text()
    found = re.findall(r"<li.*?</li>", page[page.index('<ol class="headlines">') :], re.DOTALL)
    headlines = found[:3]
    assert "Because a fold looks straight over a &lt;short&gt; range" in headlines[0]
    keys = ("fig16-speed", "fig9-monotone", "fig16-misprint")
    for headline, key in zip(headlines, keys, strict=True):
        assert f'href="#claim-{key}"' in headline
    for figure in ("fig16-speed", "fig9-decay"):
        assert page.count(f'id="figure-{figure}"') == 1
    report = json.loads((tmp_path / "report.json").read_text())
    assert all(claim["shown_by"] for claim in report["claims"])


def test_figures_named_by_a_place_are_found() -> None:
    assert modules_named("Section 2.2, Fig. 11") == ("fig11",)
    assert modules_named("Figures without numbers, Eq. (5)") == ()


def test_a_report_that_names_files_elsewhere_removes_none(tmp_path: Path) -> None:
    path = tmp_path / "report.json"
    names = ["../a.svg", "/etc/passwd", "a.svg", 3, ".hidden"]
    pictures = [{"svg": name, "data": "a.csv"} for name in names]
    path.write_text(json.dumps({"claims": [{"pictures": pictures}]}))
    assert pictures_listed(path) == {"a.svg", "a.csv"}
    for broken in ("", "[]", "{}", '{"claims": [{}]}', '{"claims": 1}'):
        path.write_text(broken)
        assert pictures_listed(path) == set()


@pytest.mark.usefixtures("example_claims")
def test_many_claims_are_told_in_ten_lines(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    monkeypatch.setattr(terminal, "FEW", 2)
    assert main(["check", "--out", str(tmp_path)]) == 0
    lines = capsys.readouterr().out.strip().splitlines()
    assert len(lines) <= 10
    assert lines[0].startswith("6 claims in ")
    assert "by two independent methods" in lines[1]
    assert "agrees with the recorded one" in lines[2]
    assert "because a fold looks" in " ".join(lines).lower() or "a fold looks" in " ".join(lines)
    assert lines[-1].endswith("index.html.")


@pytest.mark.usefixtures("example_claims")
def test_a_single_claim_is_shown_whole(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", "fig16-speed"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    for part in (
        "Because a fold",
        "The paper: “The velocity is asymptotically linear",
        "Error: 4e-7",
        "By: derivative of the closed form",
        "And by: slope",
        "one decade further the exponent",
        "Figure: fig16-speed",
        "Reproduce with: fronts",
    ):
        assert part in text


@pytest.mark.usefixtures("example_claims")
def test_a_smaller_report_leaves_no_pictures_of_a_larger_one(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["check", "--out", str(tmp_path)]) == 0
    (tmp_path / "mine.csv").write_text("kept")
    assert "removed" not in capsys.readouterr().out
    assert main(["check", "fig9", "--out", str(tmp_path)]) == 0
    assert "4 pictures and data files of that one" in " ".join(capsys.readouterr().out.split())
    there = {path.name for path in tmp_path.iterdir() if path.is_file()}
    kinds = ("svg", "png", "pdf", "csv")
    pictures = {f"fig9-decay.{kind}" for kind in kinds}
    pages = {"index.html", "methods.html", "report.json"}
    assert there == pages | {"mine.csv", STORE} | pictures
    assert main(["check", "fig9", "--out", str(tmp_path)]) == 0
    assert "removed" not in capsys.readouterr().out


def _claim(shared: Callable[[], object]) -> Claim:
    return made(
        "a", "Eq. 1", "It holds.", printed=None, recorded=Verdict.REPRODUCED, command="true",
        evidence=lambda: Made(verdict=Verdict.REPRODUCED, value="1", error="0", tolerance="0",
                     explanation="It is so."),
        shared=shared,
    )  # fmt: skip


@pytest.mark.usefixtures("example_claims")
def test_shared_work_is_not_charged_to_the_first_claim() -> None:
    done: list[int] = []

    def work() -> None:
        if not done:
            time.sleep(0.2)
        done.append(1)

    claim = _claim(work)
    first, second = judge(claim), judge(claim)
    assert first.shared >= 0.2
    assert second.shared < 0.2
    outcomes = [JudgedClaim(Entry("one", claim), first), JudgedClaim(Entry("one", claim), second)]
    report = make_report(
        outcomes, seconds=1.0, available=2, versions={}, source="0", measurements=()
    )
    assert report.shared == first.shared + second.shared


@pytest.mark.usefixtures("example_claims")
def test_shared_work_that_fails_fails_the_claim() -> None:
    def broken() -> None:
        raise ArithmeticError("no root")

    assert judge(_claim(broken)).failure == "ArithmeticError: no root."


@pytest.mark.parametrize(
    ("prose", "shown"),
    [
        ("v_d", "<msub><mi>v</mi><mi>d</mi></msub>"),
        ("c_fold", "<mi>fold</mi>"),
        ("A_nn", "<msub><mi>A</mi><mrow><mi>n</mi><mi>n</mi></mrow></msub>"),
        ("mu_st,", "<msub><mi>μ</mi><mrow><mrow><mi>st</mi>"),
        ("b x^4", "<msup><mi>x</mi><mrow><mn>4</mn></mrow></msup>"),
        ("rate^(2/3)", "<msup><mtext>rate</mtext>"),
        ("e^{-2 pi rho}", "<mi>π</mi><mi>ρ</mi>"),
        ("e^{-2 i omega t}", "<mi>i</mi><mi>ω</mi><mi>t</mi>"),
        ("eta = 1/32", "<mi>η</mi>"),
        ("distance^1.00", "<mn>1.00</mn>"),
        ("..x_{2N}", "<msub><mi>x</mi><mrow><mn>2</mn><mi>N</mi></mrow></msub>"),
    ],
)
def test_mathematics_in_prose_is_typeset(prose: str, shown: str) -> None:
    assert shown in typeset(prose)


@pytest.mark.parametrize(
    "prose",
    ["tests/test_sums.py::test_x_y", "--eta 0.1", "eta-pin", "beta and theory", "a_b_c", "x^", "_d",
     "snake_case", "1e-4", "it's phi's"],
)  # fmt: skip
def test_names_of_files_and_options_stay_as_they_are(prose: str) -> None:
    assert typeset(prose) == escape(prose)


def test_markup_in_prose_is_escaped_beside_formulas() -> None:
    text = typeset("<b>v_d</b> & e^{<i>}")
    assert text.startswith("&lt;b&gt;<math><mrow>")
    assert "<b>" not in text
    assert "<i>" not in text


def test_a_long_equation_may_break_where_no_bracket_is_open() -> None:
    terms = " + ".join(rf"\frac{{a_{n}}}{{b_{n}}}" for n in range(9))
    assert formula(terms).count("<wbr>") == 8
    assert formula(f"f({terms})").count("<wbr>") == 0
    cut = formula(rf"x = \left({terms}\right)")
    assert cut.count("<wbr>") == 9
    assert cut.count("minsize") == 2
    assert formula(rf"x = \left({terms}").startswith("<code>")
    for part in re.findall(r"<math>.*?</math>", cut):
        ElementTree.fromstring(part)


def test_a_prime_is_no_exponent_and_a_name_stands_apart_from_factor_and_argument() -> None:
    tight, apart = {"lspace": "0", "rspace": "0"}, {"lspace": "0", "rspace": "0.17em"}
    primed = ElementTree.fromstring(mathml(r"\varphi_n' + r''"))
    assert not primed.findall(".//msup") + primed.findall(".//msubsup")
    assert [(each.text, each.attrib) for each in primed.findall("mrow/mrow/mo")] == [
        ("′", tight), ("″", tight),
    ]  # fmt: skip
    (row,) = ElementTree.fromstring(mathml(r"2 \cos k \sinh^2 a / \sin(k)"))
    assert ["".join(each.itertext()) for each in row] == [
        "2", "\u2062", "cos", "\u2061", "k", "\u2062", "sinh2", "\u2061", "a",
        "/", "sin", "(", "k", ")",
    ]  # fmt: skip
    assert [each.attrib for each in row if each.text in ("\u2061", "\u2062")] == [apart] * 4
