"""Shipped findings: used by the quick run, shown as stored, stale when their code has changed."""

from __future__ import annotations

import json
import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from fronts.cli import main
from fronts.commands import check
from paper_checks import discover, prose, shipped
from paper_checks.discover import find_entries
from paper_checks.outcome import judge
from paper_checks.plain_evidence import evidence_from, plain_evidence
from paper_checks.ruling import Ruling, Verdict, holds
from verification.execution.digest import digest_of, digest_of_code
from verification.execution.imports import SOURCES, closure

CLAIM = """
import os
from slow_code.needed import number
from dataclasses import dataclass
from paper_checks.claim import Claim, Method, Verdict
from paper_checks.ruling import holds

@dataclass(frozen=True)
class Seen:
    number: int

def evidence(name):
    with open(os.environ["SLOW_LOG"], "a") as log:
        log.write(name + "\\n")
    return Seen(number())

def slow():
    return evidence("slow")

def fast():
    return evidence("fast")

def rule(e):
    return holds()

CLAIMS = tuple(
    Claim(key=each.__name__, place="Fig. 1", quote="It is so.", statement="It is so.",
          recorded=Verdict.REPRODUCED, command="true", evidence=each, rule=rule,
          methods=(Method("one", "m:f"),), expensive=each is slow)
    for each in (slow, fast)
)
"""

CHANGED = "N = 2  # longer\n"
"""Of another length than before: bytecode is kept by time, in seconds, and length."""

TEXT = "# all\nvalue: {{ number }}\nerror: 0\ntolerance: none\n\nIt is.\n"


@pytest.fixture(autouse=True)
def package(monkeypatch, tmp_path):
    """An expensive and a cheap claim, code that they need, and code that they do not."""
    home = tmp_path / "slow_code"
    (home / "claims").mkdir(parents=True)
    (home / "__init__.py").touch()
    (home / "claims" / "__init__.py").touch()
    (home / "claims" / "fig1.py").write_text(CLAIM)
    (home / "claims" / "fig1.md").write_text(TEXT)
    (home / "needed.py").write_text(
        "def number():\n    from slow_code.deep import N\n\n    return N\n"
    )
    (home / "deep.py").write_text("N = 1\n")
    (home / "unrelated.py").write_text("M = 1\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(discover, "PACKAGE", "slow_code.claims")
    monkeypatch.setattr("fronts.commands.check.FOLDER", tmp_path / "findings")
    # Sections of their own, with other stores.
    monkeypatch.setattr("paper_checks.report.measurements.stored_sections", tuple)
    monkeypatch.setenv("SLOW_LOG", str(tmp_path / "log"))
    yield home
    forget()


def forget():
    """Have the package read again."""
    prose._sections.cache_clear()
    for name in [name for name in sys.modules if name.startswith("slow_code")]:
        del sys.modules[name]


def run(capsys, tmp_path, *arguments):
    """Run; give the exit code, the claims by key, the report, and which judges ran."""
    (tmp_path / "log").unlink(missing_ok=True)
    code = main(["check", *arguments, "--json"])
    report = json.loads(capsys.readouterr().out)
    log = tmp_path / "log"
    ran = log.read_text().split() if log.exists() else []
    return code, {one["key"]: one for one in report["claims"]}, report, ran


def record(capsys, tmp_path):
    code, _, _, ran = run(capsys, tmp_path, "--full", "--record")
    assert code == 0
    assert ran == ["slow", "fast"]
    return tmp_path / "findings" / "fig1.slow.json"


def change(path, edit):
    held = json.loads(path.read_text())
    edit(held)
    del held["checksum"]
    path.write_text(json.dumps(held | {"checksum": digest_of(held)}))


def long_ago(held):
    held["seconds"] = 1000.0


def other_versions(held):
    held["versions"]["numpy"] = "1.0"


def test_only_expensive_findings_are_recorded_and_the_quick_run_shows_them(capsys, tmp_path):
    path = record(capsys, tmp_path)
    assert [one.name for one in path.parent.iterdir()] == ["fig1.slow.json"]
    code, claims, report, ran = run(capsys, tmp_path)
    assert code == 0
    assert ran == ["fast"]
    assert claims["slow"]["stored"]
    assert not claims["fast"]["stored"]
    origin = claims["slow"]["provenance"]
    assert origin["command"] == "fronts check slow --full --record"
    assert origin["stale"] is False
    assert {"python", "numpy"} <= set(origin["versions"])
    assert report["stale"] == []


def test_a_digest_is_of_every_package_once(monkeypatch):
    for package, expected in (("slow_code.claims", (*SOURCES, "slow_code")),
                              ("paper_checks.claims", SOURCES)):  # fmt: skip
        monkeypatch.setattr(discover, "PACKAGE", package)
        assert check._sources() == expected


def test_a_claim_that_is_not_expensive_is_computed_whatever_is_in_the_folder(capsys, tmp_path):
    slow = shipped.Shipped(tmp_path / "findings", check._sources())
    fast = next(e for e in find_entries("slow_code.claims") if e.claim.key == "fast")
    record(capsys, tmp_path)
    slow.record(fast, judge(fast.claim), {})
    assert (tmp_path / "findings" / "fig1.fast.json").exists()
    assert run(capsys, tmp_path)[3] == ["fast"]


def test_full_computes_everything(capsys, tmp_path):
    record(capsys, tmp_path)
    _, claims, _, ran = run(capsys, tmp_path, "--full")
    assert ran == ["slow", "fast"]
    assert not claims["slow"]["stored"]


def test_code_that_it_does_not_import_does_not_make_it_stale(capsys, tmp_path, package):
    record(capsys, tmp_path)
    (package / "unrelated.py").write_text("M = 2\n")
    assert run(capsys, tmp_path)[3] == ["fast"]


@pytest.mark.parametrize(
    ("changed", "edit", "stale"),
    [
        ("needed.py", ("return N", "return N + 1"), True),
        ("deep.py", ("N = 1", "N = 2"), True),
        ("deep.py", ("N = 1", "N = (1)  # as before"), False),
        ("unrelated.py", ("M = 1", "M = 2"), False),
        ("claims/fig1.py", ('return evidence("slow")', 'return evidence("slow") or None'), True),
        ("claims/fig1.py", ("return holds()", "return not e or holds()"), True),
        ("claims/fig1.md", ("It is.", "So it is."), False),
    ],
)
def test_the_code_that_evidence_comes_from_makes_it_stale_and_other_code_and_text_do_not(
    capsys, package, changed, edit, stale
):
    record(capsys, package.parent)
    path = package / changed
    old, new = edit
    assert old in path.read_text()
    path.write_text(path.read_text().replace(old, new))
    _, claims, _, ran = run(capsys, package.parent)
    assert ran == (["slow", "fast"] if stale else ["fast"])
    assert claims["slow"]["stored"] is not stale


def test_rule_text_and_figure_are_those_of_the_run_and_not_those_of_the_recording(
    capsys, tmp_path, package
):
    change(record(capsys, tmp_path), long_ago)  # stale as the rule changes, and shown so
    (package / "claims" / "fig1.md").write_text(TEXT.replace("It is.", "So {{ number }} is."))
    path = package / "claims" / "fig1.py"
    text = path.read_text().replace("import holds", "import fails, holds")
    path.write_text(text.replace("return holds()", "return fails('No.')"))
    forget()
    code, claims, _, ran = run(capsys, tmp_path)
    assert (code, ran) == (1, ["fast"])
    assert claims["slow"]["explanation"] == "So 1 is."
    assert claims["slow"]["verdict"] == "not reproduced"
    assert claims["slow"]["stored"]


@dataclass(frozen=True)
class Held:
    """Evidence with one of everything."""

    pairs: dict[int | None, dict[float, str]]
    points: tuple[tuple[float, float | None], ...]
    waves: np.ndarray
    words: np.ndarray
    found: frozenset[tuple[str, ...]]
    verdict: Verdict
    inner: tuple[Ruling, ...]
    never: float = math.inf


def test_evidence_is_read_back_to_the_last_bit():
    third = np.array([[1.0 / 3.0 + 2e-300j], [-0.0]])
    held = Held(
        pairs={None: {0.1: "front"}, 1: {}},
        points=((0.1 + 0.2, None), (5e-324, -0.0)),
        waves=third,
        words=np.array(["front", "rest"]),
        found=frozenset({("a", "b"), ("c",)}),
        verdict=Verdict.PARTIAL,
        inner=(holds(),),
    )
    plain = json.loads(json.dumps(plain_evidence(held), allow_nan=False))
    back = evidence_from(plain, (__name__.partition(".")[0], "paper_checks"))
    assert repr(back) == repr(held)
    assert back.waves.tobytes() == third.tobytes()
    assert back.verdict is Verdict.PARTIAL
    with pytest.raises(ValueError, match=r"evidence holds a Verdict of paper_checks\.ruling"):
        evidence_from(plain, (__name__.partition(".")[0],))
    with pytest.raises(TypeError, match="evidence cannot hold"):
        plain_evidence(print)


def test_a_stale_one_that_takes_long_is_shown_and_says_so(capsys, tmp_path, package):
    path = record(capsys, tmp_path)
    change(path, long_ago)
    (package / "deep.py").write_text(CHANGED)
    _, claims, report, ran = run(capsys, tmp_path)
    assert ran == ["fast"]
    assert report["stale"] == ["slow"]
    assert claims["slow"]["provenance"]["stale"] is True
    assert main(["check", "--out", str(tmp_path / "out")]) == 0
    assert "Stale stored findings: slow;" in (" ".join(capsys.readouterr().out.split()))
    page = (tmp_path / "out" / "index.html").read_text()
    assert "stale; stored" in page.split('id="claim-slow"')[1]
    assert "Stale: the code on which it depends has changed since." in page
    assert "The findings of 1 were stored by an earlier run" in page


def test_record_computes_what_is_missing_or_stale_and_nothing_else(capsys, tmp_path, package):
    assert run(capsys, tmp_path, "--record")[3] == ["slow", "fast"]
    path = tmp_path / "findings" / "fig1.slow.json"
    change(path, long_ago)
    assert run(capsys, tmp_path, "--record")[3] == ["fast"]
    (package / "deep.py").write_text(CHANGED)
    forget()
    code, claims, _, ran = run(capsys, tmp_path, "--record")
    assert (code, ran) == (0, ["slow", "fast"])
    assert claims["slow"]["value"] == "2"
    assert run(capsys, tmp_path)[2]["stale"] == []


@pytest.mark.parametrize("damage", ["half", "digits", "field"])
def test_a_damaged_one_is_ignored(capsys, tmp_path, damage):
    path = record(capsys, tmp_path)
    text = path.read_text()
    path.write_text(
        {
            "half": text[: len(text) // 2],
            "digits": text.replace('"number": 1', '"number": 2'),
            "field": text.replace('"machine"', '"mashine"'),
        }[damage]
    )
    assert run(capsys, tmp_path)[3] == ["slow", "fast"]


def test_other_versions_do_not_make_it_stale(capsys, tmp_path):
    path = record(capsys, tmp_path)
    change(path, other_versions)
    _, claims, _, ran = run(capsys, tmp_path)
    assert ran == ["fast"]
    assert claims["slow"]["provenance"]["versions"]["numpy"] == "1.0"


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("--list --record", "leave out --record"),
        ("--list --full", "leave out --full"),
    ],
)
def test_options_that_do_not_fit_are_refused(refused, line, sentence):
    assert sentence in refused(f"check {line}")["message"]


def test_a_folder_that_takes_no_files_is_named(capsys, tmp_path):
    (tmp_path / "findings").touch()
    assert main(["check", "--full", "--record"]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_the_closure_follows_functions_and_parents_but_not_types(package):
    (package / "typed.py").write_text(
        "from typing import TYPE_CHECKING\n"
        "if TYPE_CHECKING:\n    from slow_code.unrelated import M\n"
        "def late():\n    from . import needed\n    return needed\n"
    )
    found = closure("slow_code.typed", check._sources())
    assert list(found) == ["slow_code", "slow_code.deep", "slow_code.needed", "slow_code.typed"]


def test_a_computed_import_counts_as_the_whole_package(package):
    (package / "any.py").write_text("import importlib\nimportlib.import_module('x' + 'y')\n")
    assert "slow_code.unrelated" in closure("slow_code.any", check._sources())


def test_the_digest_does_not_depend_on_line_ends(package):
    before = digest_of_code(["slow_code.deep"], check._sources())
    (package / "deep.py").write_bytes(b"N = 1\r\n")
    assert digest_of_code(["slow_code.deep"], ["slow_code"]) == before


def test_the_closure_of_a_claim_holds_what_it_was_seen_to_import():
    """What Python itself has loaded after the module and its functions ran, as far as is ours."""
    import subprocess

    code = (
        "import sys\n"
        "from paper_checks.claims import fig16\n"
        "[claim.found(claim.evidence()) for claim in fig16.CLAIMS]\n"
        "print(*sorted(n for n in sys.modules if n.split('.')[0] in "
        "('theory', 'verification', 'paper_checks', 'derivations')))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=120,
        cwd=Path(__file__).parent.parent,
    )  # fmt: skip
    loaded = set(done.stdout.split())
    held = set(
        closure(
            "paper_checks.claims.fig16", ("theory", "verification", "paper_checks", "derivations")
        )
    )
    assert loaded <= held
    assert "verification.piecewise.simulation" in loaded


def test_the_shipped_evidence_is_that_of_expensive_claims():
    folder = shipped.Shipped(shipped.FOLDER, check._sources())
    every = [each.claim for each in find_entries("paper_checks.claims")]
    dear = [each.evidence for each in every if each.expensive]
    files = {shipped.root_of(each): folder.path(each) for each in dear}
    assert set(shipped.FOLDER.glob("*.json")) <= set(files.values())  # the others are computed
    assert len(set(files.values())) == len(files)  # one file each
    assert all("<" not in root for root in files)  # functions that another process finds by name
