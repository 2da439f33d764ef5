"""What the report makes of judgements and of stored measurements, a piece at a time.

The commands and the pages as a whole are those of `tests.test_report`.
"""

from __future__ import annotations

import pickle
import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest

from paper_checks import prose, run, shipped
from paper_checks.claim import Claim, Method, Repeat, Verdict
from paper_checks.discover import Entry, find_entries
from paper_checks.finding import Finding, Formula, Picture
from paper_checks.outcome import JudgedClaim, Judgement, Provenance, slug
from paper_checks.report import measurements, render, state_picture
from paper_checks.report import section as sections
from paper_checks.report.document import make_report, to_json
from paper_checks.report.figure_links import pictures_of
from paper_checks.report.inline_svg import width_of
from paper_checks.report.mathml import WIDE, _opened, _parts, formula, mathml_element
from paper_checks.report.safe_svg import safe_svg
from paper_checks.report.table import NARROWEST, entries_as_text
from paper_checks.report.terminal import NAMED, _headline, _named, report_as_text
from paper_checks.ruling import holds
from tests.tables import table_of
from verification.quantities.registry import all_quantities

PICTURE = Picture("fig16-speed", "Speed.", "<svg/>", "")
FINDING = Finding(
    verdict=Verdict.PARTIAL, value="1", error="0", methods=("one",), tolerance="none",
    explanation="It is.", because="It is off.", part="everywhere", pictures=(PICTURE,),
)  # fmt: skip


def claim(key: str, **changes: Any) -> Claim:
    return replace(
        Claim(
            key=key, place="Fig. 16", quote="It holds everywhere.", statement="It holds.",
            recorded=Verdict.REPRODUCED, command="true", evidence=object, rule=lambda _: holds(),
            methods=(Method("one", "theory.cells.vdp:f"),),
        ),
        **changes,
    )  # fmt: skip


def outcome(key: str, finding: Finding | None = FINDING, **changes: Any) -> JudgedClaim:
    failure = None if finding else "ArithmeticError: no root."
    return JudgedClaim(
        Entry("fig16", claim(key, **changes)), Judgement(finding, failure, 1.0, "now")
    )


def report_of(*outcomes: JudgedClaim) -> Any:
    return make_report(outcomes, seconds=1.0, available=9, versions={}, source="0", measurements=())


def test_a_part_of_the_claims_is_said_to_be_one_and_a_headline_gives_its_reason() -> None:
    report = report_of(outcome("one"))
    assert report_as_text(report, 100).startswith("1 of 9 claims in ")
    assert report_as_text(replace(report, available=1), 100).startswith("1 claim in ")
    plain = replace(FINDING, verdict=Verdict.REPRODUCED, because="", part="")
    for finding, because in ((FINDING, "It is off."), (plain, "as the paper says.")):
        assert _headline(outcome("one", finding), finding).endswith(f": {because} (one)")


# ------------------------------------------------------------------------------------- judging


def test_claims_with_work_in_common_are_one_group_and_others_are_not() -> None:
    def work() -> None: ...

    entries = [
        Entry("fig16", claim("a", evidence=lambda: 1, shared=work)),
        Entry("fig16", claim("b", evidence=tuple)),
        Entry("fig16", claim("c", evidence=lambda: 2, shared=work)),
        Entry("fig16", claim("d", evidence=tuple)),
        Entry("fig16", claim("e", evidence=list)),
    ]
    groups = [[entry.claim.key for entry in group] for group in run.sharing(entries)]
    assert groups == [["a", "c"], ["b", "d"], ["e"]]


def test_in_one_process_each_claim_is_done_before_the_next_begins() -> None:
    """So that an interrupt loses none, although claims of one group would be judged together."""
    told: list[str] = []
    entries = [Entry("fig16", claim(key, evidence=tuple)) for key in ("a", "b")]
    run.run(entries, started=told.append, done=lambda one: told.append(f"{one.entry.claim.key}!"))
    assert told == ["a", "a!", "b", "b!"]


def test_a_claim_whose_process_died_has_failed_and_of_a_group_each_is_tried_again(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    told: list[str] = []
    ended: list[Any] = []
    tried: list[tuple[str, ...]] = []

    def answers(judges: Any, keys: Any, *, workers: int, begun: Any) -> Any:
        assert judges.args == (package or run.PACKAGE,)
        assert pickle.loads(pickle.dumps(judges)).args == judges.args
        assert workers == 2
        for index, group in enumerate(keys):
            begun(index)
            tried.append(group)
            dead = "dies" in group
            fine = tuple(Judgement(FINDING, None, 1.0, key) for key in group)
            yield index, RuntimeError("its process died.") if dead else fine

    monkeypatch.setattr(run, "answers", answers)
    entries = [Entry("fig16", claim(key, evidence=tuple)) for key in ("holds", "dies")]
    entries.append(Entry("fig16", claim("other", evidence=list)))
    package = "examples"
    assert len(run.run(entries[:1], jobs=2, package=package)) == 1
    package = ""
    tried.clear()
    found = run.run(entries, jobs=2, started=told.append, done=ended.append)
    assert tried == [("holds", "dies"), ("other",), ("holds",), ("dies",)]
    assert told == ["holds", "dies", "other", "holds", "dies"]
    assert sorted(map(id, (one.judgement for one in ended))) == sorted(
        id(one.judgement) for one in found
    )
    assert [one.judgement.failure for one in found] == [None, "its process died.", None]
    assert [one.finding for one in found] == [FINDING, None, FINDING]
    assert [one.judgement.seconds for one in found] == [1.0, 0.0, 1.0]
    assert [one.pictures for one in found] == [(PICTURE,), (), (PICTURE,)]


def test_another_process_finds_its_claims_by_their_keys(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []

    def find(package: str) -> tuple[Entry, ...]:
        asked.append(package)
        return tuple(Entry("fig16", claim(key)) for key in ("a", "b", "c"))

    monkeypatch.setattr(run, "find_entries", find)
    monkeypatch.setattr(run, "judge", lambda one: Judgement(None, one.key, 1.0, ""))
    found = run._judgements("some.claims", ("c", "a"))
    assert [one.failure for one in found] == ["c", "a"]
    assert asked == ["some.claims"]


def test_shipped_evidence_goes_into_a_folder_that_may_not_be_there(tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "findings"
    entry = Entry("fig16", claim("a", evidence=_evidence, expensive=True))
    path = shipped.Shipped(folder, ("tests",)).record(entry, Judgement(FINDING, None, 1.0, ""), {})
    assert path.parent == folder
    assert path.is_file()


def _evidence() -> None: ...


@pytest.mark.parametrize("seconds", [0.5 * shipped.CHEAP, 2.0 * shipped.CHEAP])
def test_stale_evidence_that_takes_long_is_shown_unless_it_is_to_be_renewed(
    seconds: float, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    entry = Entry("fig16", claim("a", evidence=_evidence, expensive=True))
    here = shipped.Shipped(tmp_path, ("tests",))
    here.record(entry, Judgement(FINDING, None, seconds, "2026-01-01T00:00:00Z"), {})
    monkeypatch.setattr(shipped, "judged_by", lambda *_, **given: given["provenance"])
    fresh: Any = here.load(entry)
    assert fresh.stale is False
    monkeypatch.setattr(shipped, "digest_of_code", lambda *_: "of other code")
    stale: Any = here.load(entry)
    assert (stale is None) is (seconds < shipped.CHEAP)
    assert stale is None or stale.stale
    assert replace(here, renew=True).load(entry) is None


def test_a_folder_without_code_is_no_module_beside_which_a_text_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "only_a_folder").mkdir()
    monkeypatch.syspath_prepend(str(tmp_path))
    for name in ("only_a_folder", "no_such_thing"):
        with pytest.raises(ValueError, match=f"no module {name}"):
            prose.template(name, "key")


# ------------------------------------------------------------------------------ the whole report


def test_claims_are_counted_by_their_methods_and_those_that_cannot_be_judged_are_not() -> None:
    two = (Method("one", "a:f"), Method("other", "b:f"))
    found = report_of(
        outcome("a", methods=two), outcome("b"), outcome("c", methods=two), outcome("d", None),
        outcome("e", methods=two), outcome("f", recorded=Verdict.UNTESTABLE),
    )  # fmt: skip
    assert found.confirmed == (3, 2)


def test_shared_work_of_earlier_runs_is_none_of_this_one() -> None:
    def judged(key: str, shared: float, stored: bool) -> JudgedClaim:
        judgement = Judgement(FINDING, None, 1.0, "now", stored=stored, shared=shared)
        return JudgedClaim(Entry("fig16", claim(key)), judgement)

    found = report_of(judged("a", 2.0, False), judged("b", 4.0, True), judged("c", 8.0, False))
    assert found.shared == 10.0


def test_a_record_has_what_was_found_and_none_of_it_if_the_judge_failed() -> None:
    printed = Formula("As printed", "x = 1")
    finding = replace(FINDING, remarks=("By the way.",), formulas=(printed,))
    held, failed = to_json(report_of(outcome("a", finding), outcome("b", None)))["claims"]
    for name in ("methods", "remarks"):
        assert (held[name], failed[name]) == (list(getattr(finding, name)), [])
    for name in ("value", "error", "tolerance", "explanation", "part"):
        assert held[name] == getattr(FINDING, name)
        assert failed[name] is None
    assert (held["verdict"], failed["verdict"]) == ("holds only in part", None)
    assert (held["failure"], failed["failure"]) == (None, "ArithmeticError: no root.")
    assert held["pictures"][0]["svg"] == "fig16-speed.svg"
    assert (held["formulas"], failed["formulas"]) == ([vars(printed)], [])


def test_pictures_of_the_gallery_are_captioned_with_their_figure_or_else_the_first() -> None:
    def shown(group: str, **captions: str) -> JudgedClaim:
        pictures = tuple(Picture(*each, "<svg/>", "") for each in captions.items())
        found = replace(FINDING, pictures=pictures)
        return replace(outcome(group, found), entry=Entry(group, claim(group)))

    report = report_of(
        shown("fig03", a="Fig. 3a.", b="Fig. 33.", c="Fig. 3."), shown("fig03", d="More."),
        shown("fig04", e="Without.", f="Another."), shown("fig04", g="And more."),
        shown("equations", h="Fig. 5."),
    )  # fmt: skip
    assert report.in_gallery == {"a": "fig03", "c": "fig03", "e": "fig04"}


def test_a_claim_without_pictures_is_shown_by_those_of_the_figure_that_its_place_names() -> None:
    text = replace(outcome("b", replace(FINDING, pictures=())), entry=Entry("text", claim("b")))
    assert pictures_of([outcome("a"), text])["b"] == pictures_of([outcome("a")])["a"] != ()
    other = replace(FINDING, pictures=(Picture("fig16-other", "Other.", "<svg/>", ""),))
    bare = outcome("d", replace(FINDING, pictures=()), place="Fig. 3")  # its module comes first
    found = pictures_of([outcome("a"), outcome("c", other), bare])
    assert found == {"a": ("fig16-speed",), "c": ("fig16-other",),
                     "d": ("fig16-speed", "fig16-other")}  # fmt: skip


def test_test_problems_stand_with_the_reference_of_their_quantity(tmp_path: Path) -> None:
    quantity = all_quantities()[0]
    problem = quantity.test_problems[0]
    record = {"agreement": {problem.name: 2e-13}, "command": "c", "date": "d", "versions": {},
              "machine": {"processor": "made up", "cores": 2}}  # fmt: skip
    found = measurements._problems({quantity.name: record}, tmp_path)
    assert (found.key, found.title) == ("problems", "The test problems")
    row = dict(zip(found.head, found.rows[0], strict=True))
    assert (row["Quantity"], row["Problem"]) == (quantity.name, problem.name)
    assert row["Reference"] == quantity.reference
    assert float(row["To within"]) == pytest.approx(quantity.accuracy, rel=0.5)
    assert row["Measured apart"] == "2e-13"
    assert len(found.rows) == sum(len(each.test_problems) for each in all_quantities())


def test_text_on_the_page_is_no_markup() -> None:
    template = render._environment().from_string("{{ words }} {{ 'c < 1' | typeset }}")
    assert template.render(words="<b> & c") == "&lt;b&gt; &amp; c c &lt; 1"


def test_the_schema_is_of_the_version_that_is_written() -> None:
    schema = (Path(__file__).parents[1] / "docs" / "report_schema.md").read_text("utf-8")
    written = to_json(report_of())["format"]
    assert f"`format` | integer | version of this document, now {written} |" in schema


def test_a_report_takes_the_place_of_an_earlier_one_and_of_nothing_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from fronts.commands import check

    files = {"a.png": b"image", "a.csv": "c,v\n"}
    monkeypatch.setattr(check, "picture_files", lambda _: files)
    monkeypatch.setattr(check, "pictures_listed", lambda _: {"a.png", "old.svg", "gone.svg"})
    for name in ("page", "measurements_page"):
        monkeypatch.setattr(render, name, lambda _, name=name: f"<{name}>")
    for name in ("old.svg", "mine.svg"):
        (tmp_path / name).touch()
    report: Any = None
    assert check._write(tmp_path, report, {"η": 1.0}) == 1
    found = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    assert found == {
        "a.png": b"image", "a.csv": b"c,v\n", "mine.svg": b"", "index.html": b"<page>",
        "methods.html": b"<measurements_page>", "report.json": '{\n  "η": 1.0\n}\n'.encode(),
    }  # fmt: skip
    with pytest.raises(ValueError, match="not JSON compliant"):
        check._write(tmp_path, report, {"v": np.nan})


def test_the_list_of_claims_has_a_line_for_each_and_is_never_too_narrow_to_read() -> None:
    one, *others = find_entries()[:3]
    entries = [replace(one, claim=replace(one.claim, place="[b] :book:")), *others]  # as it is
    head, *rows = (re.split(" {2,}", line) for line in entries_as_text(entries, 400).splitlines())
    assert head == ["claim", "place", "on record", "statement"]
    for row, claim in zip(rows, (entry.claim for entry in entries), strict=True):
        assert row == [claim.key, claim.place, slug(claim.recorded), claim.statement]
    assert max(map(len, entries_as_text(entries, 100).splitlines())) <= 100
    assert entries_as_text(entries, 10) == entries_as_text(entries, NARROWEST)
    longest = max(find_entries(), key=lambda entry: len(entry.claim.key))
    assert f"\n{longest.claim.key} " in entries_as_text([longest], NARROWEST)  # as it is asked for


def test_a_claim_as_text_has_everything_that_was_found_in_this_order() -> None:
    found = replace(FINDING, remarks=("elsewhere too",), explanation="It is.\n\nSo.")
    repeats = (Repeat("Fig. 9", "It holds there."),)
    text = report_as_text(report_of(outcome("a", found, printed="x = 1", repeats=repeats)), 100)
    assert text.split("\n\n")[1].splitlines() == [
        "a (Fig. 16): partial (changed)", "  The paper: “It holds everywhere.”",
        "  Judged: It holds.", "  Because It is off.", "  Printed: x = 1",
        "  The part that fails: “everywhere”", "  Ours: 1", "  Error: 0",
        "  By: one [theory.cells.vdp:f]", "  There is no second method.", "  Tolerance: none",
        "  It is.", "  So.", "  Remark: elsewhere too",
        "  Repeated in Fig. 9: “It holds there.”", "  Figure: fig16-speed",
        "  Reproduce with: true",
    ]  # fmt: skip


def test_a_claim_as_text_has_its_mark_its_part_and_its_figure_on_lines_of_their_own() -> None:
    width = 60
    long = replace(FINDING, explanation="Many words. " * 30)
    text = report_as_text(report_of(outcome("a", long), outcome("b", None)), width)
    assert all(len(line) <= width for line in text.splitlines())
    first, second = text.split("\n\n")[1:]
    head, *lines = first.splitlines()
    assert head == "a (Fig. 16): partial (changed)"
    assert all(line.startswith("  ") for line in lines)
    for shown in ("  The part that fails: “everywhere”", "  Figure: fig16-speed"):
        assert shown in lines
    # A failure is no change of the verdict: it is named by itself.
    assert second.splitlines()[0] == "b (Fig. 16): failed"
    methods = (Method("one", "a:f"), Method("other", "b:f", covers="one half"))
    covered = report_as_text(report_of(outcome("a", methods=methods)), 100)
    assert "  By: one [a:f]\n  And by: other [b:f], for one half\n" in covered
    assert "no second method" not in covered
    alone = report_as_text(report_of(outcome("a", methods=methods[:1])), 100)
    assert "  By: one [a:f]\n  There is no second method.\n" in alone
    assert ("  Printed: 0.5\n" in alone) is False
    assert "  Printed: 0.5\n" in report_as_text(report_of(outcome("a", printed="0.5")), 100)
    kept = replace(FINDING, verdict=Verdict.REPRODUCED, because="", part="", pictures=())
    unchanged = report_as_text(report_of(outcome("a", kept)), 100)
    assert "(changed)" not in unchanged
    assert "Figure" not in unchanged
    agrees = "Every verdict agrees with the recorded one.\n"
    assert (agrees in unchanged, agrees in text) == (True, False)


@pytest.mark.parametrize("stale", [False, True])
def test_a_stored_finding_as_text_says_whether_its_code_has_changed(stale: bool) -> None:
    origin = Provenance(command="c", versions={"numpy": "2.0"}, machine={}, stale=stale)
    judged = Judgement(FINDING, None, 1.0, "then", stored=True, provenance=origin)
    text = report_as_text(report_of(JudgedClaim(Entry("fig16", claim("a")), judged)), 100)
    assert "  Stored: found then in 1.0 s, with numpy 2.0" in text
    assert ("code that it depends on has changed" in " ".join(text.split())) is stale
    assert ("\nStale stored findings: a; 'fronts check KEY --full' computes them." in text) is stale


def test_of_many_claims_a_headline_is_the_finding_s_own_or_its_verdict() -> None:
    said = replace(FINDING, headline="Read this first.")
    others = [outcome(f"k{n}", None) for n in range(9)]
    report = report_of(outcome("a", said), outcome("b"), *others)
    text = report_as_text(report, 100)
    assert report_as_text(report_of(*others), 100).startswith("9 claims in ")
    assert text.splitlines()[-1].startswith(f"{len(report.errata)} errata. ")
    assert "- Read this first. (a)" in text
    assert "- Fig. 16: It holds. Holds only in part: It is off. (b)" in text


def test_of_many_verdicts_that_have_changed_some_are_named_and_the_rest_counted() -> None:
    for count in (NAMED, NAMED + 2):
        report = report_of(*(outcome(f"k{n}") for n in range(count)))
        lines = report_as_text(report, 200).splitlines()
        assert lines[2 : 2 + NAMED] == [each.change for each in report.changed[:NAMED]]
        more = [line for line in lines if line.startswith("…")]
        assert more == ["… and 2 more."] * (count > NAMED)
        keys = [f"k{n}" for n in range(count)]
        rest = " and 2 more" if count > NAMED else ""
        assert _named(keys) == ", ".join(keys[:NAMED]) + rest


# ----------------------------------------------------------------------------- stored measurements


def test_a_report_says_what_it_replaces() -> None:
    from fronts.commands import check

    alone, replacing = (check._written(Path("x"), removed) for removed in (0, 3))
    assert alone == f"\nThe report is in {Path('x', 'index.html')}."
    assert replacing.startswith(f"{alone} It replaces an earlier one there; 3 pictures")


@pytest.mark.parametrize(("judged", "shown"), [("ab", ("fig12",)), ("a", ()), ("", ())])
def test_stored_measurements_are_shown_if_all_claims_are_judged(
    judged: str, shown: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    from fronts.commands import check

    monkeypatch.setattr(measurements, "stored_sections", lambda: ("fig12",))
    monkeypatch.setattr(check, "installed_versions", lambda _: {})
    monkeypatch.setattr(check, "digest_of_packages", lambda _: "code")
    monkeypatch.setattr(check, "judge_all", lambda *_, **__: ())
    monkeypatch.setattr(check, "make_report", lambda *_, measurements, **__: measurements)
    entries: Any = tuple(judged)
    every: Any = tuple("ab")
    found: Any = check._judged(
        entries, every=every, jobs=1, folder=None, resume=False, shipped=None, quiet=True
    )
    assert found == shown


def test_a_default_that_is_nowhere_the_fastest_is_said_to_be_so(tmp_path: Path) -> None:
    def choice(recorded: str, **known: Any) -> dict[str, Any]:
        empty = {"quantity": "sum", "problem": "narrow", "default": "series", "fastest": [],
                 "beaten": [], "recorded": recorded}  # fmt: skip
        return empty | known

    rivals = [{"by": "quad", "error": 1e-3, "factor": 2.5}, {"by": "quad", "error": 1e-4,
              "factor": 4.0}, {"by": "quad", "error": 1e-5, "factor": None},
              {"by": "sinc", "error": 1e-3, "factor": 3.0}]  # fmt: skip
    choices = [
        choice("2026-01-02", beaten=rivals, reasons={"quad": "it is new", "sinc": "no"}),
        choice("2026-01-01", fastest=[1e-3, 1e-4], others={"newton": "one root"}),
    ]
    found = measurements._defaults({"defaults": {"choices": choices}}, tmp_path)
    assert (found.key, found.title) == ("defaults", "The default methods")
    first, second = (dict(zip(found.head, row, strict=True)) for row in found.rows)
    faster = "Another one is faster at"
    assert first["Fastest at errors"] == second[faster] == "nowhere"
    assert second["Fastest at errors"] == "10⁻³ to 10⁻⁴"
    assert first[faster] == (
        "10⁻³ to 10⁻⁵: quad, 2.5 to 4 times, and the default does not get so far; "
        "10⁻³: sinc, 3 times"
    )
    assert first["Reason for the default"] == "quad: it is new; sinc: no"
    assert second["Reason for the default"] == "-"
    assert second["Solve another problem"] == "newton: one root"
    (origin,) = found.origins
    assert (origin.date, origin.machine) == ("2026-01-01 to 2026-01-02", "as above")


def test_where_a_range_ends_before_its_parameter_does_the_reason_is_beside_it(
    tmp_path: Path,
) -> None:
    line = {"quantity": "sum", "points": 3, "counts": {"right": 3}, "what": "Σ", "slowest": 0.5}
    record: dict[str, Any] = {
        "quantities": [line | {"over": "c to 10", "ends": "no reference"}, line | {"over": "v"}],
        "points": 6, "counts": {"right": 6, "slow": 0},
        "command": "fronts stress", "date": "2026-01-01", "versions": {},
        "machine": {"processor": "made up", "cores": 2},
    }  # fmt: skip
    found = measurements._stability({"stability": record}, tmp_path)
    assert found is not None
    rows = [dict(zip(found.head, row, strict=True)) for row in found.rows]
    assert [row["Over"] for row in rows] == ["c to 10 (no reference)", "v", ""]
    assert [row["What"] for row in rows] == ["Σ", "Σ", ""]
    assert [row["Slow"] for row in rows] == ["-", "-", "0"]
    assert [row["Slowest"] for row in rows] == ["0.5 s", "0.5 s", ""]
    assert rows[-1]["Points"] == "6"


def test_growth_is_shown_with_its_diagram_and_why_it_is_not_as_expected(tmp_path: Path) -> None:
    line = {"name": "run", "size_name": "N", "sizes": [10, 100], "seconds": [0.1, 1.0],
            "exponent": 1.004, "expected": 1, "why": "sites", "memory_exponent": None}  # fmt: skip
    record = {"lines": [line, line | {"remark": "a cache"}], "command": "c", "date": "d",
              "versions": {}, "machine": {"processor": "made up", "cores": 2}}  # fmt: skip
    for pictures in ((), ("<svg/>",)):
        found = measurements._growth({"growth": record}, tmp_path)
        assert found is not None
        assert tuple(each.svg for each in found.diagrams) == pictures
        (tmp_path / "growth.svg").write_text("<svg/>", encoding="utf-8")
    one, other = (dict(zip(found.head, row, strict=True)) for row in found.rows)
    assert (one["Size"], one["Time"], one["Power"]) == ("N, 10 to 100", "0.1 to 1 s", "1.00")
    assert (found.key, found.title) == ("growth", "Cost as the work grows")
    reasons = "Reason for the difference"
    assert (one[reasons], other[reasons]) == ("", "a cache")


def test_sections_have_an_address_a_title_and_a_lead(monkeypatch: pytest.MonkeyPatch) -> None:
    folder = Path(__file__).parent / "report_example" / "measured"
    assert (measurements.RESULTS / "growth.json").is_file()
    monkeypatch.setattr(measurements, "RESULTS", folder)
    found = measurements.stored_sections()
    assert len({section.key for section in found}) == len(found) > 3
    for section in found:
        assert re.fullmatch(r"[a-z-]+", section.key)
        assert section.title[0].isupper()
        assert not section.title.endswith(".")
        assert section.lead.endswith(".")


def test_a_lead_names_the_records_that_are_stale_with_others_of_the_same_reason(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sections, "staleness", lambda why: why)
    records = {"a": {"code": "old"}, "b": {"code": ""}, "c": {"code": "gone"}, "d": {"code": "old"}}
    assert sections.warned("Times.", records) == "Times. Stale: a, d; old. Stale: c; gone."
    assert sections.warned("Times.", {"b": records["b"]}) == "Times."


def test_a_diagram_without_its_numbers_is_shown_and_numbers_without_one_are_not(
    tmp_path: Path,
) -> None:
    assert measurements._diagram("sum", {}, tmp_path) is None
    (tmp_path / "sum.svg").write_text("<svg/>", encoding="utf-8")
    for data in ("", "c,v\n1,2\n"):
        found = measurements._diagram("sum", {}, tmp_path)
        assert (found.name, found.svg, found.data, found.failures) == ("sum", "<svg/>", data, ())
        (tmp_path / "sum.csv").write_text("c,v\n1,2\n", encoding="utf-8")
    failed = {"method": "quad", "problem": "narrow", "knob": 1e-3, "reason": "too slow"}
    (failure,) = measurements._diagram("sum", {"failures": [failed]}, tmp_path).failures
    assert vars(failure) == failed | {"knob": "0.001"}


_ORIGIN = {
    "command": "c", "date": "d", "versions": {"numpy": "2.0", "zarr": None, "mpmath": "1.3"},
    "machine": {"processor": "made up", "cores": 2},
}  # fmt: skip


def test_targets_and_first_calls_are_rows_of_their_quantities(tmp_path: Path) -> None:
    target = {"claim": "ours to theirs", "relation": "at least", "limit": 2.0, "unit": "times",
              "measured": 2.5, "verdict": "met"}  # fmt: skip
    call = {"method": "series", "cold": 1.5, "loaded": 0.25, "again": None, "reason": "none"}
    record = {"targets": [target, target | {"limit": None}], "first_calls": [call]} | _ORIGIN
    records: dict[str, Any] = {"sum": record, "other": {**_ORIGIN}}
    (tmp_path / "sum.svg").write_text("<svg/>", encoding="utf-8")
    speed = measurements._speed(records, tmp_path)
    assert speed is not None
    assert (speed.key, speed.title) == ("speed", "Error against run time")
    assert speed.head == ("Quantity", "What is compared", "Required", "Measured", "Verdict")
    assert speed.rows == (("sum", "ours to theirs", "at least 2 times", "2.5", "met"),)
    assert [each.name for each in speed.diagrams] == ["sum"]
    first = measurements._first_calls(records, tmp_path)
    assert first is not None
    assert (first.key, first.title) == ("first-calls", "First calls")
    assert first.rows == (("sum", "series", "1.5 s", "0.25 s", "-", "none"),)
    for found in (speed, first):
        assert found.lead.endswith(".")
        (origin,) = found.origins
        place = "made up, 2 cores; numpy 2.0, mpmath 1.3"
        assert (origin.command, origin.date, origin.machine) == ("c", "d", place)
        assert origin.stale.startswith("it does not state the code")
    for maker in (measurements._speed, measurements._first_calls, measurements._work_reduction):
        assert maker({"other": {**_ORIGIN}}, tmp_path) is None


def test_what_is_not_computed_stands_with_its_bound_its_change_and_its_test(tmp_path: Path) -> None:
    row = {"what": "a tail", "decided": "by its bound", "bound": "1e-9", "changed": "1e-10",
           "measured": "1 s and 2 s", "test": "tests/test_x.py"}  # fmt: skip
    record = {"work_reduction": [row]} | _ORIGIN
    found = measurements._work_reduction({"work_reduction": record}, tmp_path)
    assert found is not None
    assert (found.key, found.title) == ("work-reduction", "What is not computed")
    assert found.head == ("What", "How it is decided", "Bound", "Changed", "Cost", "Test")
    assert found.rows == (tuple(row.values()),)
    assert found.lead.startswith("Computations that are truncated")


# ------------------------------------------------------------------------- pictures and equations


def test_a_place_on_the_last_tick_is_in_the_last_cell() -> None:
    ticks = np.array([0.0, 1.0, 2.0])
    places = [state_picture._before(ticks, x) for x in (-1.0, 0.0, 0.5, 1.0, 1.5, 2.0, 3.0)]
    assert places == [0, 0, 0, 1, 1, 1, 1]
    assert state_picture._before(ticks[:1], 0.0) == state_picture._before(ticks[:2], 1.0) == 0


@pytest.mark.parametrize(
    ("changes", "segments"),
    [
        # About the middle one of nine points: a rhombus.
        (
            [("c", 0.5, 1.0), ("c", 1.5, 1.0), ("v", 1.0, 0.5), ("v", 1.0, 1.5)],
            {((0.5, 1.0), (1.0, 0.5)), ((1.5, 1.0), (1.0, 0.5)), ((0.5, 1.0), (1.0, 1.5)),
             ((1.5, 1.0), (1.0, 1.5))},
        ),
        # Where three regions meet: each to the mean. A single change is not joined to anything.
        (
            [("c", 0.5, 0.0), ("v", 0.0, 0.5), ("v", 1.0, 0.5)],
            {((0.5, 0.0), (0.5, 1.0 / 3.0)), ((0.0, 0.5), (0.5, 1.0 / 3.0)),
             ((1.0, 0.5), (0.5, 1.0 / 3.0))},
        ),
    ],
)  # fmt: skip
def test_changes_of_label_are_joined_cell_by_cell(
    changes: list[tuple[str, float, float]], segments: set[Any]
) -> None:
    grid = table_of([{"c": c, "v": v} for c in (0.0, 1.0, 2.0) for v in (0.0, 1.0, 2.0)])
    boundary = table_of([{"along": along, "c": c, "v": v, "at": c if along == "c" else v}
                         for along, c, v in changes])  # fmt: skip
    found = state_picture._contours(grid, "c", "v", boundary)
    *pieces, rest = np.split(found, np.flatnonzero(np.isnan(found[:, 0])) + 1)
    assert not len(rest)
    assert {frozenset(map(tuple, piece[:-1].round(12))) for piece in pieces} == {
        frozenset(tuple(np.round(end, 12)) for end in ends) for ends in segments
    }


def test_brackets_are_taken_apart_where_more_is_in_them_than_a_line_holds() -> None:
    sizes = set()
    for number in range(1, WIDE):
        (row,) = mathml_element(rf"\left({'x' * number}\right)")
        (bracket,) = row
        sizes.add(size := len(list(bracket.iter())))
        assert (len(_opened(row)) > 1) is (size > WIDE)
    assert {WIDE, WIDE + 1} <= sizes


@pytest.mark.parametrize(
    ("latex", "lines"),
    [("a = -b + (c - d)", ["a", "=−b", "+(c−d)"]), ("= a + b", ["=a", "+b"]),
     (r"a,\quad b", ["a,", "b"]), (r"a \left(b + c\right) - [d + e]", ["a(b+c)", "−[d+e]"])],
)  # fmt: skip
def test_a_line_breaks_before_signs_of_two_sides_outside_brackets_and_after_spaces(
    latex: str, lines: list[str]
) -> None:
    assert ["".join(part.itertext()) for part in _parts(mathml_element(latex))] == lines


def test_what_is_no_bracket_stays_whole_however_wide_it_is() -> None:
    row = ElementTree.fromstring(f"<mrow><mrow>{'<mi>x</mi>' * 2 * WIDE}</mrow></mrow>")
    assert [node.tag for node in _opened(row)] == ["mrow"]


def test_a_picture_is_as_wide_as_it_says_in_points_or_pixels() -> None:
    widths = {'width="12pt"': 12.0, 'width="12px"': 9.0, 'width="12"': 9.0, "": None}
    assert {text: width_of(f"<svg {text}></svg>") for text in widths} == widths


@pytest.mark.parametrize(
    ("width", "wide"),
    [("", False), ('width="300pt"', False), ('width="301pt"', True), ('width="400px"', False),
     ('width="404px"', True)],
)  # fmt: skip
def test_a_picture_that_a_phone_does_not_hold_is_scrolled_sideways(width: str, wide: bool) -> None:
    is_wide = render._environment().filters["is_wide"]
    assert is_wide(f"<svg {width}></svg>") is wide


def test_a_document_cut_out_of_a_page_is_the_one_that_declares_its_prefix() -> None:
    picture = '<svg{} width="8pt"><path id="a"/><use xlink:href="#a"/></svg>'
    declared = safe_svg(picture.format(' xmlns:xlink="http://www.w3.org/1999/xlink"'))
    assert safe_svg(picture.format("")) == declared
    assert 'xlink:href="#a"' in declared


def test_what_ends_as_a_document_of_svg_and_begins_as_none_holds_none() -> None:
    for text in ("<p/></svg>", "<svg>", "</svg><svg>"):
        with pytest.raises(ValueError, match="holds no SVG"):
            safe_svg(text)


def test_rows_of_several_things_and_of_one_are_written() -> None:
    assert prose.rows_written([(1, "ab"), (2, "c")], "{}{}") == "1ab, 2c"
    assert prose.rows_written(["ab", 3], "<{}>", "; ") == "<ab>; <3>"


def test_an_empty_group_is_no_bracket() -> None:
    row = ElementTree.fromstring("<mrow><mrow/><mi>x</mi></mrow>")
    assert [node.tag for node in _opened(row)] == ["mrow", "mi"]
    assert "<mi>y</mi>" in formula("{}" + "x + " * 200 + "y")
