"""Putting a change in place in a child process, and running tests or checks against it.

A child begins with everything imported and all tests collected. The existing functions, classes and
constants are changed in memory, the files are left as they are, and tests run until one fails.
Code that is entered or named while modules are imported has left its results in them. If no test
fails, such changes are therefore tested again with the project imported again. What numba compiled
from the changed code is compiled again in memory; its cache on disk is not written to, and not read
in such a child.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from types import CodeType
from typing import TYPE_CHECKING

import pytest

from benchmarks.mutation import entered
from benchmarks.mutation.children import Answer, ChildTask, in_children
from benchmarks.mutation.mutants import Mutant
from benchmarks.mutation.places import names_bound
from benchmarks.mutation.put import differs, fits, put_statement
from benchmarks.mutation.recompiled import (
    compile_again,
    concerned_by,
    made,
    python_function,
    use_no_cache,
)
from benchmarks.mutation.session import OPTIONS, Failures, Session, dotted

if TYPE_CHECKING:
    from benchmarks.mutation.alternatives import Replacement
    from benchmarks.mutation.derived import DerivationChecks

OF_A_TEST = 6.0
"""Processor seconds that a test may need for compiling what it uses."""


@dataclass(frozen=True)
class TestTask:
    """A change and the tests to run against it.

    Attributes
    ----------
    mutant : Mutant
        The change.
    usual : dict
        Processor seconds that each of the tests takes with the unchanged code.
    begins : float
        Processor seconds allowed, besides tests, for compiling or importing again.
    """

    mutant: Mutant
    usual: dict[str, float]
    begins: float

    @property
    def tests(self) -> list[str]:
        """The tests, in the order in which they are run."""
        return list(self.usual)

    @property
    def seconds(self) -> float:
        """Processor seconds allowed for everything."""
        return 4.0 * sum(self.usual.values()) + self.begins

    def pytest_runtest_logstart(self, nodeid: str) -> None:
        """Allow each test, as a pytest plugin, four times its usual time."""
        self._allow(4.0 * self.usual[nodeid] + min(self.begins, OF_A_TEST))

    def pytest_runtest_logfinish(self) -> None:
        """Allow what follows the tests all the time that is left."""
        self._allow(self.seconds)

    def _allow(self, seconds: float) -> None:
        _, most = resource.getrlimit(resource.RLIMIT_CPU)
        until = min(int(time.process_time() + seconds) + 1, most)
        resource.setrlimit(resource.RLIMIT_CPU, (until, most))


class Judge:
    """Runs the tests, or the checks of the derivations, against changes."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def by_tests(self, task: TestTask, write: Callable[[Answer], None]) -> None:
        """Run tests against a change until one fails, and write which test failed."""
        mutant, tests = task.mutant, task.tests
        again = concerned_by(mutant)
        use_no_cache(reading=not again)
        if self._put(mutant):
            compile_again(again)
            failed = self._session.first_failing(tests, task)
            compiled = mutant.qualified in entered.compiled
            if failed or compiled or not self._used_on_import(mutant):
                return write({"by": failed})
        write({"by": self._anew(mutant, tests) if tests else None})

    def by_tests_together(self, tasks: Sequence[TestTask], write: Callable[[Answer], None]) -> None:
        """Compile changes together, then run the tests against each of them in a child of its own.

        Each answer has the name of its change.
        """
        from benchmarks.mutation.alternatives import Alternatives, select

        use_no_cache()
        compiled = Alternatives([each.mutant for each in tasks], self._of_compiled)
        for name, error in compiled.failed.items():
            write({"name": name, "by": error})

        def selected(task: TestTask, write: Callable[[Answer], None]) -> None:
            self._put(task.mutant)  # for tests that run the function without compiling it
            select(compiled.numbers[task.mutant.name])
            write({"by": self._session.first_failing(task.tests, task)})

        def take(task: TestTask, answers: list[Answer]) -> None:
            for each in answers[:1]:
                write({"name": task.mutant.name, **each})

        def children() -> Iterator[ChildTask]:
            for task in tasks:
                if task.mutant.name not in compiled.failed:
                    together = task.mutant.name in compiled.numbers
                    run = partial(selected if together else self.by_tests, task)
                    yield ChildTask(run=run, seconds=task.seconds, take=partial(take, task))

        in_children(children(), 1)

    def by_checks(
        self, mutant: Mutant, checks: DerivationChecks, write: Callable[[Answer], None]
    ) -> None:
        """Run the derivations' checks against a change; write the step whose check notices it."""
        write({"by": checks.noticing(mutant) if self._put(mutant) else None})

    def made_on_import(self, mutant: Mutant) -> bool:
        """Return whether the changed object is created, or entered, during the import."""
        at = mutant.function_at
        return not mutant.outermost or mutant.of_default or at in self._session.on_import

    def _used_on_import(self, mutant: Mutant) -> bool:
        """Return whether importing the project leaves results of the changed code elsewhere."""
        if mutant.outermost:
            return mutant.function_at in self._session.on_import
        bound = names_bound(mutant.statement)
        return not bound or not bound.isdisjoint(self._session.names_on_import)

    def seconds_to_begin(self, mutant: Mutant) -> float:
        """Return the processor seconds allowed, besides tests, for compiling or importing again."""
        if mutant.qualified in entered.compiled:
            return 12.0
        return 15.0 if self.made_on_import(mutant) else 2.0

    def _put(self, mutant: Mutant) -> bool:
        """Change the existing functions and values; return whether that was possible."""
        if not mutant.outermost or mutant.of_default:
            with mutant.made():
                return put_statement(sys.modules[dotted(mutant.module)], mutant.statement)
        compiled = [python_function(each) for each in made]
        pairs = [
            (old, code)
            for code in self._codes(mutant)
            for old in [*self._session.living[f"{mutant.module}:{code.co_firstlineno}"], *compiled]
            if fits(old.__code__, code)
        ]
        for old, changed in pairs:
            old.__code__ = changed
        return bool(pairs)

    def _codes(self, mutant: Mutant) -> list[CodeType]:
        """Return the code of the changed function, and of those nested in it."""
        with mutant.made() as tree:
            code = compile(tree, str(self._session.root / mutant.module), "exec", dont_inherit=True)
        tops = [each for each in entered.codes_in(code) if each.co_qualname == mutant.outermost]
        return [each for top in tops for each in entered.codes_in(top)]

    def _of_compiled(self, mutant: Mutant) -> list[Replacement]:
        """Return what numba compiled from the changed function, with the changed code."""
        if not mutant.outermost or mutant.of_default:
            return []
        return [
            (each, code)
            for code in self._codes(mutant)
            for each in made
            if fits(python_function(each).__code__, code)
            and (mutant.unchanged or differs(python_function(each).__code__, code))
        ]

    def _anew(self, mutant: Mutant, tests: Sequence[str]) -> str | None:
        """Import the project again with a change and run tests, in a session within this one."""
        with mutant.made() as tree:
            code = compile(tree, str(self._session.root / mutant.module), "exec", dont_inherit=True)
        entered.replaced[mutant.module] = code
        packages = (*entered.PACKAGES, "benchmarks", "tests")
        for name in list(sys.modules):
            if name.split(".")[0] in packages and not name.startswith("benchmarks.mutation"):
                del sys.modules[name]
        files = {name.split("::")[0] for name in tests}
        failures = Failures(tests)
        with tempfile.TemporaryDirectory(prefix="fronts-mutation-") as base:
            options = [*OPTIONS, "-x", f"--basetemp={base}/pytest"]
            code_ = pytest.main([*options, *sorted(files)], plugins=[failures])
        return failures.first or (None if code_ in (0, 5) else f"exit code {int(code_)}")
