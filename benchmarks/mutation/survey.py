"""A survey of which tests enter which functions, and how long each test takes."""

from __future__ import annotations

import ast
import re
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator
from functools import partial
from pathlib import Path

from benchmarks.mutation.children import STOPPED, Answer, ChildTask, in_children
from benchmarks.mutation.entered import PACKAGES
from benchmarks.mutation.mutants import Mutant
from benchmarks.mutation.places import names_bound, outermost_functions
from benchmarks.mutation.records import Records
from benchmarks.mutation.session import Session, dotted

FILE_SECONDS = 120.0
"""Processor seconds for the tests of a file, in addition to twice the limit of each test."""

OVERHEAD = 0.002
"""Processor seconds that pytest itself takes for each test."""

EXCLUDED = (
    "test_benchmarks",
    "test_documentation",
    "test_mutation",
    "test_mutation_records",
    "test_report_browser",
)
"""Test files that concern other subjects, or measure time."""


class Survey:
    """The results of the recorded runs.

    Attributes
    ----------
    seconds : dict
        Processor seconds, including fixtures, of each test that passes on the unchanged code.
    breadth : dict
        Number of functions that each test enters.
    """

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.breadth: dict[str, int] = {}
        self._entering: dict[str, set[str]] = defaultdict(set)

    def add(self, answers: Iterable[Answer]) -> None:
        """Add the answers of the tests of a file."""
        for answer in answers:
            test = answer["test"]
            self.seconds[test] = answer["seconds"]
            self.breadth[test] = len(answer["entered"])
            for place in answer["entered"]:
                self._entering[place].add(test)
                self._entering[place.split(":")[0]].add(test)

    def reaching(
        self,
        mutant: Mutant,
        on_import: bool,
        importing: dict[str, frozenset[str]],
        texts: dict[str, str],
        callers: Iterable[str] = (),
    ) -> list[str]:
        """Return the tests that can notice a change; those of few functions and fast ones first.

        A test as fast as pytest's own work for it counts as taking that, so that of the many tests
        of no measurable time those of few functions come first: for a change of code that runs on
        import only the first few files are asked.

        These tests enter the function. A change of code that runs on import may affect other tests.
        Of those of the files that import the module the first are those of files that name what is
        changed (a constant, say), and those that enter a function of the module that uses it; then
        those that enter any function of the module, or of the modules that call what is compiled.
        """
        near = [file for file, modules in importing.items() if mutant.module in modules]
        tiers = [self._entering[mutant.function_at]]
        if on_import:
            names = names_bound(mutant.statement)
            words = [re.compile(rf"\b{name}\b") for name in names]
            files = {file for file in near if any(word.search(texts[file]) for word in words)}
            naming = {test for test in self.seconds if test.partition("::")[0] in files}
            using = (
                self._entering[f"{mutant.module}:{name}"]
                for name, function in outermost_functions(mutant.tree)
                if any(
                    isinstance(each, ast.Name) and each.id in names for each in ast.walk(function)
                )
            )
            tiers.append(naming.union(*using))
            tiers.append(set().union(*(self._entering[each] for each in (mutant.module, *callers))))
            tiers.append({test for test in self.seconds if test.partition("::")[0] in near})

        def cost(test: str) -> tuple[float, str]:
            return (self.seconds[test] + OVERHEAD) * self.breadth[test], test

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
    """Return, for each file, the project's files that it imports, indirectly too, and itself."""
    from verification.execution.imports import Imported, closure

    packages = (*PACKAGES, "benchmarks", "tests")
    known: dict[str, Imported] = {}
    return {
        file: frozenset(
            path.relative_to(root).as_posix()
            for path in closure(dotted(file), packages, known=known).values()
        )
        for file in files
    }


def survey(
    session: Session, records: Records, imported: dict[str, frozenset[str]], limit: float, jobs: int
) -> Survey:
    """Return the functions that the tests of files enter, recorded in children if not yet known.

    The record of a child that did not reach the end of its file is used, but not stored.

    Parameters
    ----------
    session : Session
        Session with the collected tests.
    records : Records
        Existing records.
    imported : dict
        The files that each test file imports.
    limit : float
        Processor time of a test, in seconds, above which it is not used.
    jobs : int
        Number of children that run at the same time.
    """
    found = Survey()

    def take(file: str, answers: list[Answer]) -> None:
        passed = [each for each in answers if "test" in each]
        found.add(passed)
        near = imported[file]
        begun = {each for each in session.before_tests if each.partition(":")[0] in near}
        whole = [each["entered by all"] for each in answers if "entered by all" in each]
        if whole:
            records.keep(file, near, begun | set(whole[0]), passed)
        end = next((each["by"] for each in answers if "by" in each), STOPPED)
        said = "" if whole else f"; not kept, since it was cut off: {end}"
        took = sum(each["seconds"] for each in passed)
        print(f"recorded {file}: {len(passed)} tests, {took:.1f} s{said}",
              file=sys.stderr, flush=True)  # fmt: skip

    def tasks() -> Iterator[ChildTask]:
        for file, near in imported.items():
            known = records.known(file, near)
            if known is not None:
                found.add(known)
                continue
            seconds = FILE_SECONDS + 2.0 * limit * len(session.tests_of(file))
            run = partial(session.record, file, limit)
            yield ChildTask(run=run, seconds=seconds, take=partial(take, file))

    in_children(tasks(), jobs)
    return found
