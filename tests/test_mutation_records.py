"""When what tests enter is recorded anew: when the way that they take may be another."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from benchmarks.mutation import children, survey
from benchmarks.mutation.children import Answer, ChildTask, in_children
from benchmarks.mutation.places import outermost_functions
from benchmarks.mutation.records import Records

SMALL = '''"""Small."""
LIMIT = 1.0

class Sum:
    def value(self):
        """Return one."""
        return LIMIT

    @property
    def twice(self):
        return 2.0

    @twice.setter
    def twice(self, value):
        self.half = value

def unseen(x, scale=2.0):
    """Return it.

    >>> unseen(1)
    1
    """
    return x
'''
FILES = {
    "fronts/small.py": SMALL,
    "tests/test_small.py": "from fronts.small import Sum\ndef test_one(): assert Sum().value()",
    "tests/shared.py": "TWO = 2",
    "conftest.py": "THREE = 3",
    "benchmarks/mutation/runs.py": "FOUR = 4",
}
ENTERED = ["fronts/small.py:Sum.value", "fronts/small.py:Sum.twice"]
ANSWERS = [{"test": "tests/test_small.py::test_one", "seconds": 0.01, "entered": ENTERED}]
TESTS = "tests/test_small.py"


def _write(root: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        (root / name).parent.mkdir(exist_ok=True, parents=True)
        (root / name).write_text(text, encoding="utf-8")


@pytest.mark.parametrize(
    ("path", "old", "new", "known"),
    [
        ("fronts/small.py", "", "", True),
        # Where it stands, and what is said of it.
        ("fronts/small.py", "LIMIT = 1.0", "# One.\nLIMIT = (1.0)\n", True),
        ("fronts/small.py", "Return one", "Return what is one", True),
        ("tests/shared.py", "TWO = 2", "TWO = 2  # twice one", True),
        # A function that no test entered, and one that a test did.
        ("fronts/small.py", "return x\n", "return -x\n", True),
        ("fronts/small.py", "return LIMIT", "return -LIMIT", False),
        ("fronts/small.py", "def value", "def values", False),
        # Two functions of one name.
        ("fronts/small.py", "return 2.0", "return 4.0", False),
        ("fronts/small.py", "self.half = value", "self.half = -value", False),
        # What an import executes.
        ("fronts/small.py", "LIMIT = 1.0", "LIMIT = 2.0", False),
        ("fronts/small.py", "scale=2.0", "scale=4.0", False),
        ("fronts/small.py", "    @property", "    @other", False),
        # The tests, and what they share.
        ("tests/test_small.py", "assert Sum", "assert not Sum", False),
        ("tests/shared.py", "TWO = 2", "TWO = 3", False),
        ("conftest.py", "THREE = 3", "THREE = 4", False),
        # What runs them counts by what records.
        ("benchmarks/mutation/runs.py", "FOUR = 4", "FOUR = 5", True),
    ],
)
def test_a_record_is_good_while_nothing_that_its_tests_ran_has_changed(
    path: str, old: str, new: str, known: bool, tmp_path: Path
) -> None:
    _write(tmp_path, FILES)
    imported, kept = set(FILES) - {"conftest.py"}, tmp_path / "kept.jsonl"
    Records(tmp_path, kept, 0.3).keep(TESTS, imported, ENTERED, ANSWERS)
    assert FILES[path].count(old) == 1 or not old
    _write(tmp_path, {path: FILES[path].replace(old, new)})
    found = Records(tmp_path, kept, 0.3).known(TESTS, imported)
    assert found == (ANSWERS if known else None)
    assert Records(tmp_path, kept, 0.6).known(TESTS, imported) is None
    Records(tmp_path, kept, 0.3).keep(TESTS, imported, ENTERED, [])
    assert Records(tmp_path, kept, 0.3).known(TESTS, imported) == []


def test_lines_that_a_kill_cut_short_or_an_older_runner_wrote_are_passed_over(
    tmp_path: Path,
) -> None:
    _write(tmp_path, FILES)
    imported, kept = set(FILES) - {"conftest.py"}, tmp_path / "kept.jsonl"
    Records(tmp_path, kept, 0.3).keep(TESTS, imported, ENTERED, ANSWERS)
    whole = kept.read_text(encoding="utf-8")
    older = json.dumps({"file": TESTS, "key": "", "answers": []})
    kept.write_text(f"{whole}{older}\n[1]\n{whole[: len(whole) // 2]}", encoding="utf-8")
    assert Records(tmp_path, kept, 0.3).known(TESTS, imported) == ANSWERS


def test_examples_in_docstrings_are_tests(tmp_path: Path) -> None:
    _write(tmp_path, FILES)
    kept, file = tmp_path / "kept.jsonl", "fronts/small.py"
    Records(tmp_path, kept, 0.3).keep(file, {file}, ENTERED, ANSWERS)
    assert Records(tmp_path, kept, 0.3).known(file, {file}) == ANSWERS
    _write(tmp_path, {file: SMALL.replace("unseen(1)\n    1", "unseen(2)\n    2")})
    assert Records(tmp_path, kept, 0.3).known(file, {file}) is None


def test_functions_are_found_where_they_stand_in_no_other() -> None:
    import ast

    source = (
        "if True:\n    def f():\n        def g(): pass\n        class C:\n            def m(): pass"
    )
    assert [name for name, _ in outermost_functions(ast.parse(source))] == ["f"]


def _surveyed(root: Path, record: Callable[..., None]) -> tuple[list[str], list[dict[str, Any]]]:
    """Return the tests that a survey knows, and what it kept."""
    session: Any = SimpleNamespace(
        record=record,
        tests_of=lambda file: [],
        before_tests=frozenset({"fronts/small.py:unseen", "theory/other.py:f"}),
    )
    kept, imported = root / "kept.jsonl", {TESTS: frozenset({"fronts/small.py", TESTS})}
    found = survey.survey(session, Records(root, kept, 0.3), imported, 0.3, 1)
    lines = kept.read_text(encoding="utf-8").splitlines() if kept.exists() else []
    return list(found.seconds), [json.loads(line) for line in lines]


def test_a_record_is_kept_where_the_file_ran_to_its_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    """Not where its child was ended in the middle, by a signal or the clock, or by an error."""
    _write(tmp_path, FILES)

    def whole(file: str, limit: float, write: Callable[[Answer], None]) -> None:
        write(ANSWERS[0])
        write({"entered by all": [*ENTERED, "fronts/small.py:Sum.other"]})

    def cut_off(file: str, limit: float, write: Callable[[Answer], None]) -> None:
        write(ANSWERS[0])
        raise TimeoutError

    def hung(file: str, limit: float, write: Callable[[Answer], None]) -> None:
        write(ANSWERS[0])
        time.sleep(3600.0)

    assert _surveyed(tmp_path, cut_off) == ([ANSWERS[0]["test"]], [])
    assert "not kept, since it was cut off: TimeoutError" in capfd.readouterr().err
    with monkeypatch.context() as context:
        context.setattr(children, "HANGING", 0.5)
        context.setattr(survey, "FILE_SECONDS", 0.0)
        assert _surveyed(tmp_path, hung) == ([ANSWERS[0]["test"]], [])
    assert f"not kept, since it was cut off: {children.HUNG}" in capfd.readouterr().err
    tests, kept = _surveyed(tmp_path, whole)
    assert tests == [ANSWERS[0]["test"]]
    # What all tests entered, and of what an import entered that which this file imports.
    names = ["Sum.other", "Sum.twice", "Sum.value", "unseen"]
    assert [record["entered"] for record in kept] == [[f"fronts/small.py:{each}" for each in names]]
    assert "not kept" not in capfd.readouterr().err
    assert _surveyed(tmp_path, hung) == (tests, kept)  # and not recorded again


def test_a_change_that_hangs_is_noticed_by_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(children, "HANGING", 0.1)
    answers: list[list[Answer]] = []
    in_children(
        iter([ChildTask(run=lambda write: time.sleep(3600.0), seconds=0.0, take=answers.append)]), 1
    )
    assert answers[0][0] == {"by": children.HUNG}
