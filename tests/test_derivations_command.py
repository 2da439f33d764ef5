"""``fronts derive``: fast to list, strict about its input, complete in JSON."""

import json
import os
import re
import subprocess
import sys
import time

import pytest

from derivations import catalogue
from fronts.cli import main


def run(capsys, *words):
    code = main(["derive", *words])
    shown = capsys.readouterr()
    return code, shown.out, shown.err


def test_the_listing_does_not_import_sympy_and_is_fast():
    program = (
        "import sys\nfrom fronts.cli import main\nmain(['derive'])\n"
        "assert not {'sympy', 'numpy', 'scipy'} & set(sys.modules)\n"
    )
    seconds = []
    for _ in range(3):
        start = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", program], capture_output=True, text=True, check=False,
            env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}, timeout=30,
        )  # fmt: skip
        seconds.append(time.perf_counter() - start)
        assert done.returncode == 0, done.stderr
    for name in catalogue.LISTING:
        assert name in done.stdout
    # 0.1 s is usual; the issue asks for 0.3. The fastest of three leaves out other work.
    assert min(seconds) < 0.3


def test_all_in_json_has_one_entry_for_each_number(capsys):
    code, out, _ = run(capsys, "all", "--json")
    data = json.loads(out)
    assert code == 0
    assert [entry["number"] for entry in data["equations"]] == list(range(1, 55))
    verdicts = {"holds", "misprint", "ambiguous", "inconsistent", "definition", "assumption"}
    assert {entry["verdict"] for entry in data["equations"]} == verdicts
    assert all(isinstance(entry["corrected"], (str, type(None))) for entry in data["equations"])
    assert data["seconds"] > 0


@pytest.mark.parametrize("form", ["text", "latex", "mathml", "json"])
def test_each_format(capsys, form):
    code, out, _ = run(capsys, "linearisation", "--format", form)
    assert code == 0
    assert {"text": "checked:", "latex": "\\documentclass", "mathml": "<math", "json": '"steps"'}[
        form
    ] in out


def test_one_equation_shows_its_check_and_its_verdict(capsys):
    code, out, _ = run(capsys, "--equation", "42")
    assert code == 0
    assert "(Eq. 42)" in out
    assert "In print: misprint" in out
    code, out, _ = run(capsys, "averaging", "--equation", "34", "--json")
    data = json.loads(out)
    assert data["judgement"]["verdict"] == "holds"
    assert [step["number"] for step in data["steps"]] == [34]


def test_second_order(capsys):
    code, out, _ = run(capsys, "multiple-scales", "--order", "2")
    assert code == 0
    assert "second order, chain" in out


def test_a_new_cell(capsys):
    code, out, _ = run(capsys, "cell", "--damping", "1 - a*y**2 + b*y**4", "--value", "a=4",
                       "--value", "b=0.5", "--json")  # fmt: skip
    data = json.loads(out)
    assert code == 0
    assert [cycle["stability"] for cycle in data["cycles"]] == ["unstable", "stable"]
    assert data["ratio"]["value"] == pytest.approx(0.267949192431)
    code, out, err = run(capsys, "cell", "--damping", "y**2 - 1")
    assert (code, out) == (2, "")
    assert "exactly two cycles" in err
    assert run(capsys, "cell", "--damping", "y**2 - 1", "--no-front")[0] == 0


@pytest.mark.parametrize(
    "words",
    [
        ("nothing",),
        ("--equation", "55"),
        ("averaging", "--equation", "54"),
        ("averaging", "--order", "3"),
        ("friction", "--order", "2"),
        ("all", "--equation", "3"),
        ("cell",),
        ("cell", "--damping", "__import__('os')"),
        ("cell", "--damping", "1", "--value", "a"),
        ("cell", "--damping", "1", "--value", "a=1"),
        ("cell", "--damping", "a", "--value", "a=1", "--value", "a=2"),
        ("cell", "--damping", "a", "--value", "a=y"),
        ("cell", "--damping", "1", "--order", "2"),
        ("averaging", "--damping", "1"),
        ("friction", "--out", "/nowhere/at/all.txt"),
    ],
)
def test_bad_input_is_one_sentence_and_exit_code_two(capsys, words):
    code, out, err = run(capsys, *words)
    assert (code, out) == (2, "")
    assert len(err.strip().splitlines()) == 1
    assert "defect" not in err
    code, out, err = run(capsys, *words, "--json")
    assert code == 2
    assert json.loads(err)["error"]["message"]


def test_out_writes_a_whole_file(capsys, tmp_path):
    target = tmp_path / "jacobian.tex"
    code, out, _ = run(capsys, "linearisation", "--format", "latex", "--out", str(target))
    assert (code, str(target) in out) == (0, True)
    assert target.read_text(encoding="utf-8").rstrip().endswith("\\end{document}")
    assert list(tmp_path.iterdir()) == [target]


@pytest.mark.parametrize("name", catalogue.LISTING)
def test_each_derivation_is_a_script(name):
    module = f"derivations.{catalogue.LISTING[name][0]}"
    done = subprocess.run(
        [sys.executable, "-m", module, "--format", "json"], capture_output=True, text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}, check=False, timeout=60,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["complete"]
    assert not re.search("warning", done.stderr, re.IGNORECASE)
