"""A claim that follows others has their verdict, in every order of work, and says whose it is."""

from __future__ import annotations

import contextlib
import itertools
import json
import sqlite3
import sys
from pathlib import Path

import pytest

from fronts.cli import main
from fronts.commands.check import STORE
from paper_checks import discover
from paper_checks.claim import Verdict
from paper_checks.following import combined

PACKAGE = """
import os
from paper_checks.claim import Claim, Finding, Verdict
from paper_checks.following import following

def judge(name):
    verdict = os.environ.get("VERDICT_" + name.upper(), "reproduced")
    if verdict == "raise":
        raise ArithmeticError("no root")
    return Finding(Verdict(verdict), "1.5", "0.1", ("one", "two"), "none", "Because.")

def claim(name, recorded="reproduced"):
    return Claim(name, "Fig. 1", "It is so.", None, Verdict(recorded), "true", lambda: judge(name))
"""
FIRST = """
from follow_claims._judge import claim, following
CLAIMS = (
    following("a-both", "Abstract", "Both are so.", "one", "two"),
    following("a-group", "Abstract", "The figure is so.", "fig1"),
)
"""
FIGURE = """
from follow_claims._judge import claim
CLAIMS = (claim("one"), claim("two", "not reproduced"))
"""


@pytest.fixture(autouse=True)
def claims(monkeypatch, tmp_path):
    """Two claims, and two that follow them and come first."""
    folder = tmp_path / "follow_claims"
    folder.mkdir()
    (folder / "__init__.py").touch()
    (folder / "_judge.py").write_text(PACKAGE)
    (folder / "abstract.py").write_text(FIRST)
    (folder / "fig1.py").write_text(FIGURE)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", f"{tmp_path}:{Path(__file__).parent.parent}")
    monkeypatch.setattr(discover, "PACKAGE", "follow_claims")
    monkeypatch.setenv("VERDICT_TWO", "not reproduced")
    yield folder
    for name in [name for name in sys.modules if name.startswith("follow_claims")]:
        del sys.modules[name]


def run(capsys, *arguments):
    code = main(["check", *arguments, "--json"])
    report = json.loads(capsys.readouterr().out)
    return code, {one["key"]: one for one in report["claims"]}, report


def test_combining_does_what_its_documentation_says():
    good, fixed, part, wrong, unknown = Verdict
    rules = {
        frozenset({good, fixed}): fixed,
        frozenset({good, part}): part,
        frozenset({good, wrong}): part,
        frozenset({good, unknown}): part,
        frozenset({fixed, part}): part,
        frozenset({fixed, wrong}): part,
        frozenset({fixed, unknown}): part,
        frozenset({part, wrong}): part,
        frozenset({part, unknown}): part,
        frozenset({wrong, unknown}): wrong,
    }
    for pair in itertools.product(Verdict, repeat=2):
        expected = pair[0] if pair[0] is pair[1] else rules[frozenset(pair)]
        assert combined(pair) is expected
    assert combined([good] * 5 + [wrong]) is part
    assert combined([good, fixed, wrong]) is part


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_it_takes_the_verdict_of_this_run(capsys, jobs):
    code, claims, report = run(capsys, "--jobs", jobs)
    assert code == 0
    assert list(claims) == ["a-both", "a-group", "one", "two"]
    assert claims["a-both"]["verdict"] == "holds only in part"
    assert claims["a-both"]["recorded"] == "holds only in part"
    assert claims["a-group"]["follows"] == ["one", "two"]
    assert claims["one"]["follows"] == []
    assert sum(report["counts"].values()) == 4


def test_a_changed_verdict_changes_all_that_follow_it(capsys, monkeypatch):
    monkeypatch.setenv("VERDICT_TWO", "reproduced")
    code, claims, report = run(capsys)
    assert code == 1
    assert report["changed"] == ["a-both", "a-group", "two"]
    assert claims["a-both"]["verdict"] == "reproduced"


def test_asking_for_it_brings_in_what_it_follows(capsys):
    code, claims, _ = run(capsys, "a-both")
    assert code == 0
    assert list(claims) == ["a-both", "one", "two"]


def test_asking_by_verdict_brings_them_in_as_well(capsys):
    code, claims, _ = run(capsys, "--verdict", "partial")
    assert code == 0
    assert list(claims) == ["a-both", "a-group", "one", "two"]


def test_a_list_shows_only_what_was_asked_for_with_the_verdict_of_the_others(capsys):
    assert main(["check", "a-both", "--list", "--json"]) == 0
    (claim,) = json.loads(capsys.readouterr().out)["claims"]
    assert claim["recorded"] == "holds only in part"


def test_a_failed_judge_fails_what_follows_it(capsys, monkeypatch):
    monkeypatch.setenv("VERDICT_ONE", "raise")
    code, claims, _ = run(capsys)
    assert code == 1
    assert "one" in claims["a-both"]["failure"]
    assert claims["a-both"]["verdict"] is None


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ('following("b", "Abstract", "So.", "fig7")', "follows 'fig7', and there is no such"),
        ('following("b", "Abstract", "So.", "a-both")', "'a-both', which follows others itself"),
    ],
)
def test_what_cannot_be_followed_fails_and_is_named(capsys, claims, line, sentence):
    text = f"from follow_claims._judge import following\nCLAIMS = ({line},)\n"
    (claims / "second.py").write_text(text)
    code, found, _ = run(capsys)
    assert code == 1
    assert sentence in found["b"]["failure"]


def test_an_interrupted_run_stores_no_verdict_that_was_taken_over(capsys, monkeypatch, tmp_path):
    folder = str(tmp_path / "out")
    run(capsys, "--out", folder)
    with contextlib.closing(sqlite3.connect(tmp_path / "out" / STORE)) as file:
        stored = {key for (key,) in file.execute("SELECT key FROM results")}
    assert stored == {"one", "two"}
    code, claims, _ = run(capsys, "--out", folder, "--resume")
    assert code == 0
    assert claims["a-both"]["stored"]
    assert claims["a-both"]["verdict"] == "holds only in part"


def test_the_page_links_to_what_it_follows(capsys, tmp_path):
    assert main(["check", "--out", str(tmp_path / "out")]) == 0
    page = (tmp_path / "out" / "index.html").read_text()
    row = page.split('id="claim-a-both"')[1].split("</li>")[0]
    assert 'href="#claim-one"' in row
    assert "from 2 others" in row
    assert "2 put to two methods" in page
    assert "2 that repeat others" in page
