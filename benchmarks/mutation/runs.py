"""The order of the tests for a change: those that noticed other changes nearby come first."""

from __future__ import annotations

import os
import sys
import time
from collections import defaultdict
from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING

from benchmarks.mutation import entered
from benchmarks.mutation.children import Answer, ChildTask
from benchmarks.mutation.judge import Judge, TestTask
from benchmarks.mutation.mutants import Mutant
from benchmarks.mutation.outcome import KILLED, SURVIVED, UNREACHED
from benchmarks.mutation.recompiled import concerned_by, python_function
from benchmarks.mutation.session import Session
from benchmarks.mutation.survey import OVERHEAD, Survey

if TYPE_CHECKING:
    from benchmarks.mutation.derived import DerivationChecks

MAX_KNOWN = 6
"""Number of tests run first because they noticed the last changes of the function or module."""

TOGETHER = 24
"""Number of changes of compiled code that are compiled together."""

MAX_FILES = 6
"""Largest number of test files for a change of code run on import; each is collected again."""


class Runs:
    """Changes to be run, and the outcome of those that were run.

    Parameters
    ----------
    session, survey : Session, Survey
        The tests, and the functions that each of them enters.
    importing : dict
        The files that each test file imports.
    seconds : float
        Largest total time of the tests, as recorded, for one change.

    Attributes
    ----------
    found : dict
        ``killed``, ``survived`` or ``unreached`` by name of the change.
    seconds : float
        As given; it may be raised between runs.
    """

    def __init__(
        self, session: Session, survey: Survey, importing: dict[str, frozenset[str]], seconds: float
    ) -> None:
        self._survey, self.seconds = survey, seconds
        self._importing, self._judge, self._root = importing, Judge(session), session.root
        self._texts = {
            file: (session.root / file).read_text(encoding="utf-8") for file in importing
        }
        self._killers: dict[str, list[str]] = defaultdict(list)
        self._begin = self._shown = time.monotonic()
        self._done = 0
        self.found: dict[str, str] = {}

    def tasks(self, mutants: Sequence[Mutant], until: float) -> Iterator[ChildTask]:
        """Yield children's tasks for the changes, until a time of the monotonic clock.

        Changes of compiled code are tested together with others of the same module.
        """
        self._begin, self._done = time.monotonic(), 0
        waiting: dict[str, list[Mutant]] = defaultdict(list)
        for mutant in mutants:
            if time.monotonic() > until:
                return
            if mutant.qualified not in entered.compiled:
                yield from self._task([mutant], len(mutants))
            else:
                waiting[mutant.module].append(mutant)
                if len(waiting[mutant.module]) == TOGETHER:
                    yield from self._task(waiting.pop(mutant.module), len(mutants))
        for group in waiting.values():
            yield from self._task(group, len(mutants))

    def _task(self, mutants: Sequence[Mutant], count: int) -> Iterator[ChildTask]:
        """Yield the task of a child for changes to be tested together, if any test reaches them."""
        tasks = []
        for mutant in mutants:
            usual = {test: self._survey.seconds[test] for test in self._asked(mutant)}
            if usual:
                tasks.append(TestTask(mutant, usual, self._judge.seconds_to_begin(mutant)))
            else:
                self._take(mutant, count, False, None)
        if tasks:
            judge = self._judge
            alone = partial(judge.by_tests, tasks[0]) if len(tasks) == 1 else None
            run = alone or partial(judge.by_tests_together, tasks)
            take = partial(self._take_all, [each.mutant for each in tasks], count)
            yield ChildTask(run=run, seconds=sum(each.seconds for each in tasks), take=take)

    def _take_all(self, mutants: Sequence[Mutant], count: int, answers: list[Answer]) -> None:
        """Take the answers of a child; a change has none if those before it took all its time."""
        only = mutants[0].name if len(mutants) == 1 else ""
        by = {each.get("name", only): each["by"] for each in reversed(answers)}
        for mutant in mutants:
            if mutant.name in by:
                self._take(mutant, count, True, by[mutant.name])
        left = sum(mutant.name not in by for mutant in mutants)
        if left:
            print(f"{left} changes of {mutants[0].module} were not run: {by.get('', 'no answer')}",
                  file=sys.stderr, flush=True)  # fmt: skip

    def tasks_of_checks(
        self, mutants: Sequence[Mutant], checks: DerivationChecks, until: float
    ) -> Iterator[ChildTask]:
        """Yield a child's task for each change in derivations that no test noticed."""
        for mutant in mutants:
            if time.monotonic() > until:
                return
            seconds = checks.seconds(mutant)
            if self.found.get(mutant.name, KILLED) != KILLED and seconds:
                run = partial(self._judge.by_checks, mutant, checks)
                take = partial(self._take_of_checks, mutant)
                yield ChildTask(run=run, seconds=2.0 * seconds + 2.0, take=take)

    def _take_of_checks(self, mutant: Mutant, answers: list[Answer]) -> None:
        by = answers[0]["by"] if answers else None
        if by:
            self.found[mutant.name] = KILLED
        print(f"{'noticed by ' + by if by else 'no check notices'}: {mutant.name}",
              file=sys.stderr, flush=True)  # fmt: skip

    def _asked(self, mutant: Mutant) -> list[str]:
        """Return the tests that noticed other changes nearby, then others as time allows."""
        on_import = self._judge.made_on_import(mutant)
        compiled = (python_function(each).__code__ for each in concerned_by(mutant))
        callers = {os.path.relpath(code.co_filename, self._root) for code in compiled}
        reaching = self._survey.reaching(
            mutant, on_import, self._importing, self._texts, sorted(callers)
        )
        known = self._killers[mutant.function_at]
        known = [*known, *self._killers[mutant.module]]
        picked = [test for test in dict.fromkeys(known) if test in reaching][:MAX_KNOWN]
        left = self.seconds - sum(self._survey.seconds[test] for test in picked)
        files = {test.partition("::")[0] for test in picked}
        collected = on_import and mutant.qualified not in entered.compiled
        for test in reaching:
            cost, file = self._survey.seconds[test] + OVERHEAD, test.partition("::")[0]
            another = collected and file not in files and len(files) == MAX_FILES
            if test not in picked and cost <= left and not another:
                left -= cost
                files.add(file)
                picked.append(test)
        return picked or reaching[:1]

    def _take(self, mutant: Mutant, count: int, asked: bool, by: str | None) -> None:
        self.found[mutant.name] = KILLED if by else SURVIVED if asked else UNREACHED
        if not by and not mutant.unchanged:
            word = "noticed" if asked else "reached"
            print(f"not {word}: {mutant.module}:{mutant.line} {mutant.function}: {mutant.change}",
                  file=sys.stderr, flush=True)  # fmt: skip
        if by and (mutant.unchanged or by not in self._survey.seconds):
            print(f"noticed by {by}: {mutant.name}", file=sys.stderr, flush=True)
        if by in self._survey.seconds:
            for place in (mutant.function_at, mutant.module):
                self._killers[place] = [by, *(t for t in self._killers[place] if t != by)][:5]
        now = time.monotonic()
        self._done += 1
        if now - self._shown > 10.0 or self._done == count:
            self._shown = now
            missed = sum(status != KILLED for status in self.found.values())
            ahead = (now - self._begin) / self._done * (count - self._done) / 60.0
            print(f"[{self._done}/{count}] {missed} not noticed, {ahead:.0f} min left",
                  file=sys.stderr, flush=True)  # fmt: skip
