"""Shipped findings: used by the quick run, shown as stored, stale when their code has changed."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

from fronts.cli import main
from fronts.commands import check
from paper_checks import discover, shipped
from paper_checks.discover import find_entries
from paper_checks.outcome import judge
from verification.execution.digest import closure, digest_of, digest_of_code

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

CLAIMS = tuple(
    Claim(key=name, place="Fig. 1", quote="It is so.", statement="It is so.",
          recorded=Verdict.REPRODUCED, command="true", evidence=lambda name=name: evidence(name),
          rule=lambda e: holds(), text=__name__, methods=(Method("one", "m:f"),),
          expensive=name == "slow")
    for name in ("slow", "fast")
)
"""

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
    monkeypatch.setenv("SLOW_LOG", str(tmp_path / "log"))
    yield home
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
    return tmp_path / "findings" / "slow.json"


def change(path, edit):
    held = json.loads(path.read_text())
    edit(held)
    del held["checksum"]
    path.write_text(json.dumps(held | {"checksum": digest_of(held)}))


def long_ago(held):
    held["judgement"]["seconds"] = 1000.0


def other_versions(held):
    held["versions"]["numpy"] = "1.0"


def test_only_expensive_findings_are_recorded_and_the_quick_run_shows_them(capsys, tmp_path):
    path = record(capsys, tmp_path)
    assert [one.name for one in path.parent.iterdir()] == ["slow.json"]
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


def test_a_claim_that_is_not_expensive_is_computed_whatever_is_in_the_folder(capsys, tmp_path):
    slow = shipped.Shipped(tmp_path / "findings", "slow_code.claims", check._sources())
    fast = next(e for e in find_entries("slow_code.claims") if e.claim.key == "fast")
    record(capsys, tmp_path)
    slow.record(fast, judge(fast.claim), {})
    assert (tmp_path / "findings" / "fast.json").exists()
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


@pytest.mark.parametrize("changed", ["needed.py", "deep.py", "claims/fig1.py"])
def test_code_that_it_imports_makes_it_stale_and_a_cheap_one_is_computed_anew(
    capsys, tmp_path, package, changed
):
    record(capsys, tmp_path)
    with (package / changed).open("a") as file:
        file.write("\nOTHER = 3\n")
    _, claims, _, ran = run(capsys, tmp_path)
    assert ran == ["slow", "fast"]
    assert not claims["slow"]["stored"]


def test_a_stale_one_that_takes_long_is_shown_and_says_so(capsys, tmp_path, package):
    path = record(capsys, tmp_path)
    change(path, long_ago)
    (package / "deep.py").write_text("N = 2\n")
    _, claims, report, ran = run(capsys, tmp_path)
    assert ran == ["fast"]
    assert report["stale"] == ["slow"]
    assert claims["slow"]["provenance"]["stale"] is True
    assert main(["check", "--out", str(tmp_path / "out")]) == 0
    assert "Stale stored findings: slow;" in (" ".join(capsys.readouterr().out.split()))
    page = (tmp_path / "out" / "index.html").read_text()
    assert "stale; stored" in page.split('id="claim-slow"')[1]
    assert "Stale: the code it depends on has changed since." in page
    assert "1 rest on stored findings" in page


def test_record_computes_what_is_missing_or_stale_and_nothing_else(capsys, tmp_path, package):
    assert run(capsys, tmp_path, "--record")[3] == ["slow", "fast"]
    path = tmp_path / "findings" / "slow.json"
    change(path, long_ago)
    assert run(capsys, tmp_path, "--record")[3] == ["fast"]
    (package / "deep.py").write_text("N = 2\n")
    for name in [name for name in sys.modules if name.startswith("slow_code")]:
        del sys.modules[name]
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
            "digits": text.replace('"value": "1"', '"value": "2"'),
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
    ("arguments", "sentence"),
    [
        (["--list", "--record"], "leave out --record"),
        (["--list", "--full"], "leave out --full"),
    ],
)
def test_options_that_do_not_fit_are_refused(capsys, arguments, sentence):
    assert main(["check", *arguments]) == 2
    assert sentence in capsys.readouterr().err


def test_a_folder_that_takes_no_files_is_named(capsys, tmp_path):
    (tmp_path / "findings").touch()
    assert main(["check", "--full", "--record"]) == 2
    assert "cannot be written" in capsys.readouterr().err


def test_the_closure_follows_functions_and_parents_but_not_types(tmp_path, package):
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


def test_the_closure_of_a_claim_holds_what_it_was_seen_to_import(monkeypatch):
    """What Python itself has loaded after the module and its functions ran, as far as is ours."""
    import subprocess

    code = (
        "import sys\n"
        "from paper_checks.claims import fig16\n"
        "[claim.judge() for claim in fig16.CLAIMS]\n"
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


def test_the_shipped_findings_are_of_expensive_claims():
    expensive = {e.claim.key for e in find_entries("paper_checks.claims") if e.claim.expensive}
    held = {path.stem for path in shipped.FOLDER.glob("*.json")}
    assert held <= expensive  # a claim without a shipped finding is computed
