"""Which tests enter which function, and how long each takes: a recorded run of each test file."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from verification.execution.digest import digest_of, digest_of_files
from verification.execution.files import write_text
from verification.execution.imports import imports_of

LONGEST_FILE = 400.0
"""Seconds after which a file that is being recorded is given up."""

EXCLUDED = (
    "test_benchmarks",
    "test_documentation",
    "test_mutation",
    "test_report_browser",
)
"""Test files about other things, or about time."""


@dataclass
class Survey:
    """What the recorded runs found.

    Attributes
    ----------
    seconds : dict
        Test to its time, for those that pass on the unchanged tree.
    tests_of : dict
        ``path:first line`` of a function to the tests that enter it.
    collecting : dict
        File to the seconds that a run of it takes beside its tests.
    breadth : dict
        Test to the number of functions it enters.
    """

    seconds: dict[str, float] = field(default_factory=dict)
    tests_of: dict[str, set[str]] = field(default_factory=dict)
    collecting: dict[str, float] = field(default_factory=dict)
    breadth: dict[str, int] = field(default_factory=dict)

    def add(self, file: str, answer: dict[str, Any]) -> None:
        """Take in the answer of a recorded run."""
        passed = answer.get("passed", {})
        self.seconds.update(passed)
        self.collecting[file] = max(0.0, answer["seconds"] - sum(passed.values()))
        for test, places in answer.get("entered", {}).items():
            if test in passed:
                self.breadth[test] = len(places)
                for place in places:
                    self.tests_of.setdefault(place, set()).add(test)
        for place in answer.get("shared", ()):
            self.tests_of.setdefault(place, set()).update(passed)

    def tests_for(self, module: str, first_line: int, importing: Iterable[str]) -> list[str]:
        """Return the tests that can notice a change there, the fastest first."""
        if first_line:
            found = self.tests_of.get(f"{module}:{first_line}", set())
        else:
            files = set(importing)
            found = {test for test in self.seconds if test.split("::", maxsplit=1)[0] in files}
        return sorted(found, key=lambda test: (self.seconds[test], test))


def test_files(root: Path) -> list[str]:
    """Return the test files, and the modules with doctests, as paths from the root."""
    tests = [p for p in sorted((root / "tests").glob("test_*.py")) if p.stem not in EXCLUDED]
    modules = [
        path
        for package in ("theory", "derivations", "verification", "paper_checks", "fronts")
        for path in sorted((root / package).rglob("*.py"))
        if ">>> " in path.read_text(encoding="utf-8")
    ]
    return [path.relative_to(root).as_posix() for path in (*tests, *modules)]


def closure(root: Path, file: str) -> frozenset[str]:
    """Return the files of the project that a file imports, directly or not, itself included."""
    reached, ahead = {file}, [file]
    while ahead:
        for near in _imports(root, ahead.pop()):
            if near not in reached:
                reached.add(near)
                ahead.append(near)
    return frozenset(reached)


def _imports(root: Path, file: str) -> frozenset[str]:
    names, _ = imports_of(root / file, file.rpartition("/")[0].replace("/", "."))
    found = set()
    for name in names:
        for path in (f"{name.replace('.', '/')}.py", f"{name.replace('.', '/')}/__init__.py"):
            if (root / path).is_file():
                found.add(path)
    return frozenset(found)


def digest(root: Path, files: Iterable[str], *more: str) -> str:
    """Return a digest of the contents of files and of some words."""
    return digest_of([digest_of_files(root, [root / file for file in files]), *more])[:20]


def survey(
    root: Path,
    store: Path,
    modules: Iterable[str],
    tests: Iterable[str],
    *,
    ask: Callable[[list[dict[str, Any]], Callable[[int, dict[str, Any]], None]], None],
    report: Callable[[str], None],
) -> Survey:
    """Record the test files that import any of the modules, where not known from an earlier run.

    Parameters
    ----------
    root, store : Path
        The project; the folder that keeps what was found.
    modules : iterable of str
        Paths of the modules to be changed.
    tests : iterable of str
        Files of tests.
    ask : callable
        Hands requests to the processes and each answer to a function.
    report : callable
        Progress callback.
    """
    changed = set(modules)
    files = [file for file in tests if closure(root, file) & changed]
    path = store / "survey.json"
    known: dict[str, Any] = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    keys = {file: digest(root, closure(root, file)) for file in files}
    required = [file for file in files if known.get(file, {}).get("key") != keys[file]]

    def take(index: int, answer: dict[str, Any]) -> None:
        file = required[index]
        known[file] = {"key": keys[file], "answer": answer}
        write_text(path, json.dumps(known))
        report(f"recorded {file}: {len(answer.get('passed', {}))} tests, {answer['seconds']:.1f} s")

    requests = [{"files": [file], "record": True, "timeout": LONGEST_FILE} for file in required]
    ask(requests, take)
    found = Survey()
    for file in files:
        found.add(file, known[file]["answer"])
    return found
