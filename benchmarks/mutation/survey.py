"""Which tests enter which function, and how long each takes: every test is run and recorded."""

from __future__ import annotations

import json
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path

from benchmarks.mutation.entered import PACKAGES
from benchmarks.mutation.mutants import Mutant
from benchmarks.mutation.session import Answer, Session, Task, dotted, in_children

FILE_SECONDS = 30.0
"""Processor seconds after which the tests of a file that are left are not recorded."""

EXCLUDED = (
    "test_benchmarks",
    "test_documentation",
    "test_mutation",
    "test_report_browser",
)
"""Test files about other things, or about time."""


class Survey:
    """What the recorded runs found.

    Attributes
    ----------
    seconds : dict
        Test to its processor seconds, fixtures included, if it passes on the unchanged code.
    breadth : dict
        Test to the number of functions it enters.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.breadth: dict[str, int] = {}
        self._entering: dict[str, set[str]] = defaultdict(set)

    def add(self, answers: Iterable[Answer]) -> None:
        """Take in what the tests of a file entered."""
        for answer in answers:
            test = answer["test"]
            self.seconds[test] = answer["seconds"]
            self.breadth[test] = len(answer["entered"])
            for place in answer["entered"]:
                self._entering[place].add(test)
                self._entering[place.split(":")[0]].add(test)

    def reaching(
        self, mutant: Mutant, on_import: bool, importing: dict[str, frozenset[str]]
    ) -> list[str]:
        """Return the tests that can notice a change, those about few functions and fast ones first.

        They enter the function. What an import leaves may change others: those that enter any
        function of the module come next, then those of all files that import it.
        """
        tiers = [self._entering[mutant.function_at]]
        if on_import:
            tiers.append(self._entering[mutant.module])
            tiers.append({t for t in self.seconds if mutant.module in importing[t.split("::")[0]]})

        def cost(test: str) -> tuple[float, str]:
            return self.seconds[test] * self.breadth[test], test

        return list(dict.fromkeys(test for tier in tiers for test in sorted(tier, key=cost)))


def test_files(root: Path) -> list[str]:
    """Return the test files, and the modules with doctests, as paths from the root."""
    tests = [p for p in sorted((root / "tests").glob("test_*.py")) if p.stem not in EXCLUDED]
    modules = [
        path
        for package in PACKAGES
        for path in sorted((root / package).rglob("*.py"))
        if ">>> " in path.read_text(encoding="utf-8") and "explore" not in path.parts
    ]
    return [path.relative_to(root).as_posix() for path in (*tests, *modules)]


def closures(root: Path, files: Iterable[str]) -> dict[str, frozenset[str]]:
    """Return by file the files of the project that it imports, directly or not, itself included.

    As `verification.execution.imports.closure` of each, but no module is looked for twice.
    """
    from verification.execution.imports import imports_of, source_of

    place: dict[str, str] = {}
    direct: dict[str, tuple[str, ...]] = {}

    def read(name: str) -> None:
        top = name.partition(".")[0]
        path = source_of(name) if top in (*PACKAGES, "benchmarks", "tests") else None
        direct[name] = ()
        if path is not None:
            place[name] = path.relative_to(root).as_posix()
            parent = name.rpartition(".")[0]
            names, computed = imports_of(path, name if path.name == "__init__.py" else parent)
            whole = (root / top).rglob("*.py") if computed and source_of(top) else ()
            below = (dotted(each.relative_to(root).as_posix()) for each in whole)
            direct[name] = (parent, *names, *below)

    def reached(file: str) -> frozenset[str]:
        found: set[str] = set()
        waiting = [dotted(file)]
        while waiting:
            name = waiting.pop()
            if name not in found:
                found.add(name)
                if name not in direct:
                    read(name)
                waiting.extend(direct[name])
        return frozenset(place[name] for name in found if name in place)

    return {file: reached(file) for file in files}


def survey(
    session: Session, path: Path, imported: dict[str, frozenset[str]], limit: float, jobs: int
) -> Survey:
    """Return what the tests of files enter, recorded in children where it is not known.

    Parameters
    ----------
    session : Session
        With the tests collected.
    path : Path
        Where records are kept; one is good for as long as nothing that its file imports changes,
        nor this.
    imported : dict
        By test file, what it imports.
    limit : float
        Processor seconds of a test above which it is not asked.
    jobs : int
        Children at a time.
    """
    from verification.execution.digest import digest_of, digest_of_files

    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    known = {record["file"]: record for record in map(json.loads, lines)}
    found = Survey()
    root = session.root

    def take(file: str, key: str, answers: list[Answer]) -> None:
        passed = [each for each in answers if "test" in each]
        found.add(passed)
        with path.open("a", encoding="utf-8") as kept:
            kept.write(json.dumps({"file": file, "key": key, "answers": passed}) + "\n")
        took = sum(each["seconds"] for each in passed)
        print(f"recorded {file}: {len(passed)} tests, {took:.1f} s", file=sys.stderr, flush=True)

    def tasks() -> Iterator[Task]:
        here = Path(__file__).parent  # how it is recorded decides what is found
        recording = (here / f"{name}.py" for name in ("entered", "session", "survey"))
        runner = digest_of_files(here, recording)
        for file, files in imported.items():
            read = digest_of_files(root, [root / each for each in files])
            key = digest_of([read, runner, limit])
            if known.get(file, {}).get("key") == key:
                found.add(known[file]["answers"])
            else:
                run = partial(session.record, file, limit)
                yield Task(run=run, seconds=FILE_SECONDS, take=partial(take, file, key))

    in_children(tasks(), jobs)
    return found
