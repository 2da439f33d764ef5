"""The report shows every finding, harms nobody with its text, and survives interruptions."""

import base64
import contextlib
import json
import os
import re
import signal
import sqlite3
import subprocess
import sys
import time
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest

from fronts.cli import main
from fronts.commands import check
from fronts.commands.check import STORE
from paper_checks import discover
from paper_checks.claim import Verdict
from paper_checks.report import measurements, render
from paper_checks.run import sharing
from verification.pictures import figures
from verification.pictures.data_table import Curves, columns_as_csv, long_table
from verification.pictures.figures import new_axes, picture

HERE = Path(__file__).parent
KEYS = ["fig9-decay", "fig9-monotone", "fig16-speed", "fig16-misprint", "fig16-escape"]
KEYS += ["fig16-vague"]
PROGRAM = """
import signal
import sys
from paper_checks import discover
discover.PACKAGE = "example_claims"
from fronts.cli import main
from fronts.commands import check
from fronts.commands.check import STORE
if __name__ == "__main__":
    # A test run in the background may have been told to ignore interrupts.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.exit(main(["check", *sys.argv[1:]]))
"""


@pytest.fixture(autouse=True)
def example_claims(monkeypatch, tmp_path):
    """Six made-up claims in place of the paper's; judges log their runs."""
    monkeypatch.syspath_prepend(str(HERE / "report_example"))
    monkeypatch.setattr(discover, "PACKAGE", "example_claims")
    monkeypatch.setenv("EXAMPLE_LOG", str(tmp_path / "log"))
    monkeypatch.setattr(measurements, "RESULTS", HERE / "report_example" / "measured")
    monkeypatch.delenv("EXAMPLE_TROUBLE", raising=False)


@pytest.fixture
def plain(monkeypatch):
    """Claims without pictures, for which each process would import matplotlib."""
    monkeypatch.setenv("EXAMPLE_PLAIN", "")


def judged(tmp_path):
    log = tmp_path / "log"
    keys = [line.split()[0] for line in log.read_text().splitlines()] if log.exists() else []
    log.unlink(missing_ok=True)
    return keys


def start(*arguments):
    path = os.pathsep.join([str(HERE / "report_example"), str(HERE.parent)])
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *arguments],
        env={**os.environ, "PYTHONPATH": path},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )


def without_times(value):
    """Everything of a report but what a clock wrote."""
    if isinstance(value, dict):
        clock = {"seconds", "shared_seconds", "created", "judged", "stored"}
        return {key: without_times(item) for key, item in value.items() if key not in clock}
    return [without_times(item) for item in value] if isinstance(value, list) else value


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.tags, self.ids, self.links, self.words = [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        for name, value in attrs:
            if name == "id":
                self.ids.append(value)
            elif name in ("href", "src", "xlink:href", "srcset", "action"):
                self.links.append(value)

    def handle_data(self, data):
        self.words.append(data)


def test_claims_are_found_in_natural_order_and_groups_select_them():
    entries = discover.find_entries()
    assert [entry.claim.key for entry in entries] == KEYS
    chosen = discover.select(entries, ["fig16-vague", "fig9"])
    assert [entry.claim.key for entry in chosen] == ["fig9-decay", "fig9-monotone", "fig16-vague"]


def test_a_key_used_twice_is_refused(tmp_path, monkeypatch):
    package = tmp_path / "twice_claims"
    package.mkdir()
    (package / "__init__.py").touch()
    for name in ("one", "two"):
        (package / f"{name}.py").write_text("from example_claims.fig9 import CLAIMS\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    with pytest.raises(ValueError, match="'fig9-decay' is in one and in two"):
        discover.find_entries("twice_claims")


def test_exit_code_is_0_when_all_is_as_recorded_and_nothing_is_written(
    tmp_path, monkeypatch, capsys
):
    empty = tmp_path / "empty"
    empty.mkdir()
    monkeypatch.chdir(empty)
    assert main(["check"]) == 0
    assert list(empty.iterdir()) == []
    shown = capsys.readouterr()
    assert all(key in shown.out for key in KEYS)
    assert "6 claims in" in shown.out
    lines = shown.err.splitlines()  # plain lines: standard error is no terminal here
    assert len(lines) == 6
    assert "\x1b" not in shown.err
    assert "\r" not in shown.err


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_judge_that_raises_is_shown_as_failed_and_named(monkeypatch, capsys, tmp_path, jobs):
    monkeypatch.setenv("EXAMPLE_TROUBLE", "raise:fig9-monotone")
    assert main(["check", "--out", str(tmp_path), "--jobs", jobs]) == 1
    sentence = "ArithmeticError: no root in the box <0, 1>."
    assert f"fig9-monotone: its judge failed: {sentence}" in capsys.readouterr().out
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["changed"] == ["fig9-monotone"]
    assert report["claims"][1]["failure"] == sentence
    assert report["counts"]["failed"] == 1
    page = (tmp_path / "index.html").read_text()
    assert page.count("no root in the box &lt;0, 1&gt;.") == 2  # on top and in its row
    assert "second line" not in page


def test_a_changed_verdict_exits_with_1_and_is_named(monkeypatch, capsys):
    import example_claims.fig9

    changed = example_claims.fig9.CLAIMS[0]
    monkeypatch.setitem(changed.__dict__, "recorded", Verdict.PARTIAL)
    assert main(["check", "fig9"]) == 1
    sentence = "fig9-decay: on record as 'holds only in part', now 'reproduced'."
    assert sentence in capsys.readouterr().out


@pytest.mark.usefixtures("plain")
def test_a_worker_that_dies_fails_its_own_claim_only(monkeypatch, capsys):
    monkeypatch.setenv("EXAMPLE_TROUBLE", "kill:fig9-monotone")
    assert main(["check", "--jobs", "2", "--json"]) == 1
    report = json.loads(capsys.readouterr().out)
    assert report["changed"] == ["fig9-monotone"]
    assert "ended without an answer" in report["claims"][1]["failure"]
    assert report["counts"]["failed"] == 1


@pytest.mark.usefixtures("plain")
def test_claims_that_share_evidence_or_work_go_to_one_process(tmp_path):
    assert main(["check", "--jobs", "2", "--json"]) == 0
    process = dict(line.split() for line in (tmp_path / "log").read_text().splitlines())
    assert process["fig9-decay"] == process["fig9-monotone"]
    entries = discover.find_entries("paper_checks.claims")
    found = sharing(entries)
    assert sorted(entry.claim.key for group in found for entry in group) == sorted(
        entry.claim.key for entry in entries
    )
    together = [{entry.claim.key for entry in group} for group in found]
    assert {"fig11-stable", "fig11-all-lost"} in together  # the same evidence
    assert {"fig11-values", "fig11-order", "fig11-converged"} in together  # the same folds


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("fig61", "'fig61' is neither a claim nor a group of claims: did you mean fig16"),
        ("--verdict wrong", "'wrong' is not a verdict"),
        ("fig9 --verdict untestable", "no claim of fig9 has the verdict 'untestable'"),
        ("--jobs 0", "--workers = 0 is not allowed: it must be a whole number from 1 to 256"),
        ("--jobs two", "--workers = two is not allowed: it must be a whole number"),
        ("--resume", "--resume needs --out DIR"),
        ("--list --out x", "--list judges nothing: leave out --out."),
        ("--list --jobs 1 --record", "leave out --workers and --record."),
        ("--out ''", "an empty name is no folder"),
        ("--out ' '", "an empty name is no folder"),
        ("--out a-file", "--out a-file is a file: name a folder."),
        ("--out a-file/below", "--out a-file/below cannot be written"),
    ],
)
def test_bad_input_exits_with_2_before_any_work(line, sentence, tmp_path, monkeypatch, refused):
    monkeypatch.chdir(tmp_path)
    Path("a-file").touch()
    assert sentence in refused(f"check {line}")["message"]
    assert judged(tmp_path) == []
    assert [path.name for path in tmp_path.iterdir()] == ["a-file"]


def test_a_folder_that_takes_no_files_is_refused_before_any_work(tmp_path, monkeypatch, capsys):
    def refuse(**options):
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr("fronts.commands.check.tempfile.TemporaryFile", refuse)
    for _ in range(2):  # the folders are made, and then they exist
        assert main(["check", "--out", str(tmp_path / "new" / "report")]) == 2
        assert "cannot be written: Read-only file system." in capsys.readouterr().err
    assert judged(tmp_path) == []


def test_verdict_selects_by_the_record_and_the_rest_is_not_judged(tmp_path, answered):
    report = answered("check --verdict not-reproduced")
    assert [claim["key"] for claim in report["claims"]] == ["fig16-speed"]
    assert report["claims_available"] == 6
    assert judged(tmp_path) == ["fig16-speed"]


def test_list_judges_nothing(tmp_path, answered):
    claims = answered("check --list")["claims"]
    assert [claim["key"] for claim in claims] == KEYS
    assert judged(tmp_path) == []


@pytest.mark.parametrize("columns", [20, 60, 200])
def test_the_list_as_text_has_a_row_a_claim_and_breaks_no_key(columns, monkeypatch, capsys):
    """No sign of colour is among them, whatever the environment asks for."""
    monkeypatch.setenv("COLUMNS", str(columns))
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert main(["check", "--list"]) == 0
    head, *lines = capsys.readouterr().out.splitlines()
    assert head.split() == ["claim", "place", "on", "record", "statement"]
    assert [line.split()[0] for line in lines if not line.startswith(" ")] == KEYS
    assert max(map(len, lines)) <= max(columns, 60)
    assert not any("\x1b" in line for line in lines)


def test_one_and_two_processes_give_the_same_report(tmp_path):
    reports = []
    for jobs in ("1", "2"):
        folder = tmp_path / jobs
        assert main(["check", "--out", str(folder), "--jobs", jobs]) == 0
        reports.append(without_times(json.loads((folder / "report.json").read_text())))
    assert reports[0] == reports[1]
    names = sorted(path.name for path in (tmp_path / "1").iterdir() if path.is_file())
    assert names == sorted(path.name for path in (tmp_path / "2").iterdir() if path.is_file())
    assert len(names) == 4 + 4 * 2  # two pages, the JSON, the store, four files for each picture
    for name in (name for name in names if name.endswith((".svg", ".csv", ".png", ".pdf"))):
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes()


def test_json_holds_exactly_the_documented_fields(tmp_path, answered):
    report = answered(["check", "--out", str(tmp_path)])
    assert json.loads((tmp_path / "report.json").read_text()) == report
    text = (HERE.parent / "docs" / "report_schema.md").read_text()
    documented = [
        re.findall(r"^\| `(\w+)` \|", section, re.MULTILINE) for section in text.split("\n## ")
    ]
    assert list(report) == documented[1]
    assert all(list(claim) == documented[2] for claim in report["claims"])
    pictures = [one for claim in report["claims"] for one in claim["pictures"]]
    assert all(list(one) == documented[3] for one in pictures)
    assert [list(one) for one in report["errata"]] == [documented[4]]
    assert all(list(one) == documented[5] for one in report["measurements"])
    assert len(report["measurements"]) == 7
    assert report["errata"][0]["key"] == "fig16-misprint"
    assert report["claims"][3]["formulas"] == [
        {"label": "As printed", "latex": r"a^2 - b^2 < \alpha"}
    ]
    assert all(
        (tmp_path / one[kind]).stat().st_size for one in pictures for kind in ("svg", "data")
    )
    assert sum(report["counts"].values()) == len(report["claims"]) == 6
    assert report["headlines"] == ["fig16-speed", "fig9-monotone", "fig16-misprint"]
    assert {"python", "toolkit", "numpy", "scipy", "mpmath", "sympy"} <= set(report["versions"])
    assert set(report["machine"]) == {
        "system", "architecture", "processor", "cores", "threads",
    }  # fmt: skip


def test_the_page_shows_markup_as_text_and_asks_for_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(measurements, "RESULTS", tmp_path / "none")  # claims and errata only
    assert main(["check", "--out", str(tmp_path)]) == 0
    text = (tmp_path / "index.html").read_text()
    page = Page(text)
    words = "".join(page.words)
    for markup in (
        "<b>bold</b> & \"quoted\" 'text'",
        "<script>alert(1)</script>",
        "</details><img src=x onerror=alert(1)>",
        "echo '<i>' && echo \"&\"",
        'Markup such as </summary> & <b id="x"> stays text.',
    ):
        assert markup in words
    assert page.tags.count("script") == 1
    assert page.tags.count("b") == 5  # the counts
    # A formula, an erratum as printed and corrected, and a reason with two in its words: on top,
    # beside the sentence of the paper and in its row.
    assert page.tags.count("math") == 3 + 3 * 2
    assert page.tags.count("i") == 2 * 6  # "The paper:" and "Ours:" in each row
    assert not {"img", "link", "iframe", "object", "u"} & set(page.tags)
    assert len(page.ids) == len(set(page.ids))
    anchors = {f"#{name}" for name in page.ids}
    others = [link for link in page.links if link not in anchors]
    choices = [link for link in others if link.startswith("#verdict=")]
    data = [link for link in others if link.startswith("data:text/csv")]
    files = [link for link in others if re.fullmatch(r"[\w-]+\.(svg|png|pdf)", link)]
    assert sorted(others) == sorted([*choices, *data, *files, render.DOCS])
    assert len(files) == 3 * 2
    assert len(choices) == 5
    assert len(data) == 2  # one a picture
    assert "url(http" not in text
    assert "@import" not in text


def test_stored_measurements_stand_beside_the_claims(tmp_path, monkeypatch):
    assert main(["check", "--out", str(tmp_path)]) == 0
    assert "methods.html" in Page((tmp_path / "index.html").read_text()).links
    words = "".join(Page((tmp_path / "methods.html").read_text()).words)
    for shown in (
        "at least 200 times150not met",
        "10⁻³ to 10⁻⁴, 10⁻⁶10⁻⁵: series, 2.5 timesseries: it <cannot> do small v",
        "it <cannot> do small vquad: one root only",
        "ours, compiled31 s0.25 s0.001 s",
        "theirs---not <installed>",
        "beside-the-foldstiff",
        "Stale: sum; it does not state the code on which it depends.",
        "sites, 10 to 100",
        " (faster ones take minutes)10",
        "all1062110000",
        "15 in place of 2000 roots: 133 times",
        "quad: gave up <here> (narrow: 1e-9)",
        "Measured 2026-01-02 03:04 UTC by fronts bench sum; made up <&>, 2 cores; numpy 2.0.",
    ):
        assert shown in words.replace("\n", "")
    assert "compilation" not in words  # nothing was promised
    # Some claims only, or no records, as in an installed package: no such section.
    assert main(["check", "fig9", "--out", str(tmp_path)]) == 0
    assert json.loads((tmp_path / "report.json").read_text())["measurements"] == []
    monkeypatch.setattr(measurements, "RESULTS", tmp_path / "none")
    assert main(["check", "--out", str(tmp_path)]) == 0
    assert "methods.html" not in (tmp_path / "index.html").read_text()


def test_a_picture_name_used_for_two_pictures_fails_the_second(monkeypatch, capsys):
    from example_claims import fig16

    figure, _ = new_axes()
    other = picture("fig9-decay", figure, {"x": [1.0]}, caption="Another one.")
    claim = fig16.CLAIMS[1]
    first = claim.found
    monkeypatch.setitem(
        claim.__dict__, "found", lambda evidence: replace(first(evidence), pictures=(other,))
    )
    assert main(["check", "--json"]) == 1
    report = json.loads(capsys.readouterr().out)
    assert report["changed"] == ["fig16-misprint"]
    assert "of fig9-decay" in report["claims"][3]["failure"]


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_a_killed_run_is_resumed_where_it_stopped(tmp_path, monkeypatch, answered, jobs):
    folder = tmp_path / "report"
    monkeypatch.setenv("EXAMPLE_TROUBLE", "wait:fig16-speed")
    process = start("--out", str(folder), "--jobs", jobs)
    for line in process.stderr:  # with two processes all others end while one waits
        if f"[{2 if jobs == '1' else 5}/6]" in line:
            break
    wait_for(tmp_path / "log", "fig16-speed")
    process.kill()
    process.communicate(timeout=20)
    assert not still_alive(pids_of(tmp_path / "log")), "a worker outlives its killed parent"
    done = 2 if jobs == "1" else 5
    judged(tmp_path)
    assert not (folder / "index.html").exists()
    monkeypatch.delenv("EXAMPLE_TROUBLE")
    report = answered(["check", "--out", str(folder), "--resume"])
    assert len(judged(tmp_path)) == 6 - done
    assert sum(claim["stored"] for claim in report["claims"]) == done
    anew = answered(["check", "--out", str(tmp_path / "fresh")])
    assert without_times(anew) == without_times(report)


def wait_for(log, word):
    deadline = time.monotonic() + 120
    while not (log.exists() and word in log.read_text()):
        assert time.monotonic() < deadline
        time.sleep(0.01)


def pids_of(log):
    return {int(line.split()[1]) for line in log.read_text().splitlines()}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize("jobs", ["1", "2"])
def test_an_interrupt_stores_what_is_finished_and_leaves_no_process(
    tmp_path, monkeypatch, jobs, number
):
    folder = tmp_path / "report"
    monkeypatch.setenv("EXAMPLE_TROUBLE", "wait:fig16-speed")
    process = start("--out", str(folder), "--jobs", jobs)
    finished = 2 if jobs == "1" else 5
    for line in process.stderr:
        if f"[{finished}/6]" in line:
            break
    wait_for(tmp_path / "log", "fig16-speed")
    if number == signal.SIGINT:
        os.killpg(process.pid, number)  # as a terminal does: to the workers as well
    else:
        process.terminate()
    _, errors = process.communicate(timeout=20)
    assert process.returncode == 130
    assert f"{finished} of 6 claims are judged and stored" in errors
    assert "Traceback" not in errors
    assert len(stored(folder)) == finished
    assert [path.name for path in folder.iterdir()] == [STORE]
    assert not still_alive(pids_of(tmp_path / "log"))


def still_alive(pids):
    deadline = time.monotonic() + 5  # a terminated process needs a moment to be gone
    while pids and time.monotonic() < deadline:
        pids = {pid for pid in pids if alive(pid)}
        time.sleep(0.01)
    return pids


def alive(pid):
    if Path("/proc/self/stat").exists():
        stat = Path(f"/proc/{pid}/stat")
        # A process that nobody has waited for yet is a zombie, not alive.
        return stat.exists() and ") Z " not in stat.read_text()
    with contextlib.suppress(ProcessLookupError):
        os.kill(pid, 0)
        return True
    return False


def stored(folder):
    file = sqlite3.connect(folder / STORE)
    try:
        return [key for (key,) in file.execute("SELECT key FROM results")]
    finally:
        file.close()


DAMAGE = {
    "other digits": "UPDATE results SET text = replace(text, '0.700 000 000 1', '0.700 000 000 2')",
    "another claim's": "UPDATE results SET text = (SELECT min(text) FROM results)",
    "no JSON": "UPDATE results SET text = '[1, 2' WHERE key = 'fig9-decay'",
    "gone": "DELETE FROM results WHERE key = 'fig9-decay'",
}


@pytest.mark.usefixtures("plain")
@pytest.mark.parametrize("damage", DAMAGE)
def test_a_damaged_finding_is_computed_again(tmp_path, capsys, damage):
    folder = tmp_path / "report"
    assert main(["check", "fig9", "--out", str(folder)]) == 0
    judged(tmp_path)
    with contextlib.closing(sqlite3.connect(folder / STORE)) as file:
        assert file.execute(DAMAGE[damage]).rowcount
        file.commit()
    assert main(["check", "fig9", "--out", str(folder), "--resume", "--json"]) == 0
    assert judged(tmp_path) == ["fig9-decay"]
    capsys.readouterr()
    assert main(["check", "fig9", "--out", str(folder), "--resume"]) == 0
    assert judged(tmp_path) == []
    assert main(["check", "fig9", "--out", str(folder)]) == 0
    assert judged(tmp_path) == ["fig9-decay", "fig9-monotone"]


@pytest.mark.parametrize("content", [b"", b"no database" * 500, None])
def test_a_store_of_other_code_or_damaged_is_begun_anew(tmp_path, monkeypatch, content):
    folder = tmp_path / "report"
    assert main(["check", "fig9", "--out", str(folder)]) == 0
    judged(tmp_path)
    if content is None:
        monkeypatch.setattr(check, "digest_of_packages", lambda _: "other code")
    else:
        (folder / STORE).write_bytes(content)
    assert main(["check", "fig9", "--out", str(folder), "--resume"]) == 0
    assert judged(tmp_path) == ["fig9-decay", "fig9-monotone"]
    assert len(stored(folder)) == 2


def test_a_picture_is_the_same_bytes_each_time_and_its_data_are_exact():
    def draw():
        figure, axes = new_axes("page", xlabel=r"$\hat v$")
        axes.plot([1, 2], [0.1, 1 / 3], "o-")
        axes.fill_between([0, 1], [0, 1], alpha=0.3)
        return picture("pair", figure, {"n": [1, 2], "x": np.array([0.1, 1 / 3])})

    first, second = draw(), draw()
    assert first == second
    assert not re.search(r"<dc:date|Matplotlib v", first.svg)
    assert "<text" not in first.svg  # letters are paths: accents are in place everywhere
    assert 'xlink:href="#DejaVuSans' in first.svg
    assert first.data == f"n,x\n1,0.1\n2,{1 / 3!r}\n"


@pytest.mark.parametrize("large", [4, 5])
@pytest.mark.parametrize("encoded", [True, False])
def test_a_figure_is_rendered_in_each_format_measured_and_closed(
    encoded, large, monkeypatch, caplog
):
    from matplotlib import pyplot

    monkeypatch.setattr(figures, "_render", lambda name, _: f"<{name}>")
    monkeypatch.setattr(figures, "_encoded", lambda figure, kind: f"{kind} of {figure.number}")
    monkeypatch.setattr(figures, "LARGE", large)
    drawn = pyplot.figure()
    found = picture("all", drawn, {"x": [1.0]}, caption="No line", encoded=encoded)
    assert drawn.number not in pyplot.get_fignums()
    assert (found.caption, found.svg, found.data) == ("No line", "<all>", "x\n1.0\n")
    formats = [f"{kind} of {drawn.number}" for kind in ("png", "pdf")]
    assert [found.png, found.pdf] == (formats if encoded else ["", ""])
    assert ["the picture all has" in each.getMessage() for each in caplog.records] == [True] * (
        large < 5
    )


def test_a_picture_that_is_too_large_is_named(monkeypatch, caplog):
    monkeypatch.setattr(figures, "LARGE", 2_000)
    drawn, axes = new_axes()
    axes.plot([1.0, 2.0], [3.0, 5.0])
    axes.plot([1.0, 2.0], [4.0, 4.5], label="a guide")
    found = picture("many-points", drawn, {"x": [1.0, 2.0], "y": [3.0, 5.0]}, guides=True,
                    caption="Two points")  # fmt: skip
    assert (found.caption, found.svg[:5]) == ("Two points", "<?xml")
    assert base64.b64decode(found.png).startswith(b"\x89PNG")
    assert drawn.axes == []  # the figure is empty
    assert base64.b64decode(found.pdf).startswith(b"%PDF")
    (record,) = caplog.records
    assert "many-points has 0.0 MB" in record.getMessage()


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("../up", {"x": [1.0]}, "choose another"),
        ("ok", {"x": np.ones((2, 2))}, "2 dimensions"),
        ("ok", {"x": [1j]}, "real and imaginary"),
        ("ok", {"x": [1.0, 2.0], "y": [1.0]}, "below each other"),
    ],
)
def test_unusable_pictures_are_refused(name, data, message):
    figure, _ = new_axes()
    with pytest.raises(ValueError, match=message):
        picture(name, figure, data)


def test_what_is_drawn_is_in_the_data():
    figure, axes = new_axes()
    axes.plot([1.0, np.nan, 2.0], [3.0, 4.0, 5.0], label="curve")
    axes.bar([0.1, 0.2], [7.0, 8.0], width=0.03, label="bars")
    axes.axhline(9.0, label="level")
    axes.plot([], [], label="for the legend")
    curve, bars = {"x": [1.0, 2.0], "y": [3.0, 5.0]}, {"x": [0.1, 0.2], "n": [7.0, 8.0]}
    other = {"x": [1.0, 2.0], "y": [3.0, 5.1]}
    for data, lost in (
        (long_table({"curve": curve | {"kind": "a"}, "bars": bars}), []),
        (long_table({"curve": other, "bars": bars}), ["curve"]),
        # each number, and no such pair
        ({"x": [1.0, 2.0, 0.1, 0.2], "y": [5.0, 3.0, 7.0, 8.0]}, ["curve"]),
        (curve, ["bars"]),
    ):
        assert figures.drawn_beyond(figure, data) == lost
    with pytest.raises(ValueError, match="'curve', which is not in its data"):
        picture("ok", figure, other | bars)


def test_curves_of_one_table_stand_below_each_other():
    table = long_table({"a": {"x": [1.0, 2.0], "kind": "p"}, "b": {"x": 3, "error": [None]}})
    assert columns_as_csv(table) == "series,x,kind,error\na,1.0,p,\na,2.0,p,\nb,3,,\n"
    with pytest.raises(ValueError, match="'a' have"):
        long_table({"a": {"x": [1.0, 2.0], "y": [1.0, 2.0, 3.0]}})


def test_a_curve_takes_the_place_of_no_other():
    curves = Curves()
    assert curves.add("a", x=[1.0], y=[2.0], error=0.1) == ([1.0], [2.0])
    with pytest.raises(ValueError, match="another name"):
        curves.add("a", x=[2.0], y=[1.0])


def test_claim_records_and_pictures_do_not_import_matplotlib():
    code = (
        "import sys, paper_checks.claim, verification.pictures.figures, fronts.commands.check;"
        "assert not any(name.startswith('matplotlib') for name in sys.modules)"
    )
    environment = {**os.environ, "PYTHONPATH": str(HERE.parent)}
    subprocess.run([sys.executable, "-c", code], env=environment, check=True)
