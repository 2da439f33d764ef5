"""Run the tests against each change, fastest first, in copies of the project; store the results."""

from __future__ import annotations

import json
import os
import queue
import shutil
import subprocess
import sys
import threading
import time
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from benchmarks.mutation.mutants import Mutant
from benchmarks.mutation.survey import closure, digest, survey, test_files
from verification.execution.digest import digest_of
from verification.execution.store import Store

COPIED = (
    "theory",
    "derivations",
    "verification",
    "paper_checks",
    "fronts",
    "benchmarks",
    "tests",
    "docs",
    "pyproject.toml",
    "README.md",
    "Makefile",
)
QUICK_FILE = 0.8
"""Seconds to import a test file and set it up, up to which it is tried in the first round."""

FEW = 4
"""Functions that a test enters, up to which it is asked before those that enter more."""

MAX_KNOWN = 3
"""Tests that noticed the last changes of a function or its module, asked before all others."""


class Workers:
    """Processes of :mod:`benchmarks.mutation.zygote`, each in its own copy of the tree."""

    def __init__(self, root: Path, work: Path, count: int) -> None:
        self._root, self._work, self._count = root, work, count
        self._processes: list[subprocess.Popen[str]] = []

    def __enter__(self) -> Workers:
        for number in range(self._count):
            tree = self._work / f"tree-{number}"
            shutil.rmtree(tree, ignore_errors=True)
            tree.mkdir(parents=True)
            for name in COPIED:
                here = self._root / name
                if here.is_dir():
                    ignored = shutil.ignore_patterns("__pycache__", "results")
                    shutil.copytree(here, tree / name, ignore=ignored)
                elif here.exists():
                    shutil.copy2(here, tree / name)
            results = self._root / "benchmarks" / "results"
            if results.is_dir():
                shutil.copytree(results, tree / "benchmarks" / "results")
            environment = {
                **os.environ,
                "PYTHONPATH": str(tree),
                "PYTHONDONTWRITEBYTECODE": "1",
                "NUMBA_CACHE_DIR": str(self._work / "numba"),
                **dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1"),
            }
            process = subprocess.Popen(
                [sys.executable, str(tree / "benchmarks" / "mutation" / "zygote.py")],
                cwd=tree,
                env=environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
            self._processes.append(process)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        for process in self._processes:
            if process.stdin is not None:
                process.stdin.close()
            if kind is not None:
                process.terminate()
            process.wait()

    def serve(self, jobs: Callable[[], Callable[[Asker], None] | None]) -> None:
        """Let every process take jobs, each a function of what asks it, until there are none."""
        errors: queue.Queue[BaseException] = queue.Queue()

        def follow(process: subprocess.Popen[str]) -> None:
            def ask(request: dict[str, Any]) -> dict[str, Any]:
                assert process.stdin is not None
                assert process.stdout is not None
                process.stdin.write(json.dumps(request) + "\n")
                process.stdin.flush()
                return dict(json.loads(process.stdout.readline()))

            try:
                while errors.empty() and (job := jobs()) is not None:
                    job(ask)
            except BaseException as error:
                errors.put(error)

        threads = [threading.Thread(target=follow, args=(p,)) for p in self._processes]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        if not errors.empty():
            raise errors.get()


Asker = Callable[[dict[str, Any]], dict[str, Any]]


class Runs:
    """Stored results and the order of tests.

    Parameters
    ----------
    root, work : Path
        The project; the folder of results.
    workers : Workers
        Running processes.
    modules : iterable of str
        Paths of the modules to be changed.
    tests : sequence of str
        Files of tests, or modules with doctests, that are asked; all if empty.
    seconds : float
        Of tests, as measured on the unchanged tree, spent on one change at most.
    again : bool
        Forget stored results.
    """

    def __init__(
        self,
        root: Path,
        work: Path,
        workers: Workers,
        *,
        modules: Iterable[str],
        tests: Sequence[str] = (),
        seconds: float,
        again: bool,
    ) -> None:
        self._root, self._workers, self._seconds = root, workers, seconds
        self._lock = threading.Lock()
        identity = {"results": "of changes"}  # each row says by its key which code it is of
        self._store = Store(work / "results.sqlite", identity, resume=not again, replace=True)
        self._known: dict[str, dict[str, Any]] = dict(self._store.results)
        files = tests or test_files(root)
        self._survey = survey(root, work, modules, files, ask=self._ask_all, report=self._report)
        self._killers: dict[str, list[str]] = defaultdict(list)
        self._noticed: Counter[str] = Counter()
        self._importing = {file: closure(root, file) for file in files}

    def _report(self, text: str) -> None:
        print(text, file=sys.stderr, flush=True)

    def _ask_all(
        self, requests: list[dict[str, Any]], take: Callable[[int, dict[str, Any]], None]
    ) -> None:
        left = iter(enumerate(requests))

        def jobs() -> Callable[[Asker], None] | None:
            with self._lock:
                waiting = next(left, None)
            if waiting is None:
                return None
            index, request = waiting

            def job(ask: Asker) -> None:
                answer = ask(request)
                with self._lock:
                    take(index, answer)

            return job

        self._workers.serve(jobs)

    def run(self, mutants: Sequence[Mutant], until: float) -> dict[str, str]:
        """Return ``killed`` or ``survived`` for each change that was run or is kept."""
        found: dict[str, str] = {}
        for mutant in mutants:
            row = self._known.get(mutant.name)
            if row is None or (row["not_asked"] and row.get("asked", 0.0) < self._seconds):
                continue  # with more time there are more tests to ask
            if row["key"] == self._key(mutant, row["status"], row["by"]):
                found[mutant.name] = row["status"]
        rest = [mutant for mutant in mutants if mutant.name not in found]
        first_lines = {(mutant.module, mutant.function): mutant.first_line for mutant in mutants}
        for row in self._known.values():
            module, function = row["name"].split(":")[:2]
            if row["by"] in self._survey.seconds and (module, function) in first_lines:
                self._learn(module, first_lines[module, function], row["by"])
        self._report(f"{len(mutants)} changes, {len(found)} of them known")
        left = iter(rest)
        begin = time.monotonic()
        done = 0
        shown = begin

        def jobs() -> Callable[[Asker], None] | None:
            with self._lock:
                mutant = None if time.monotonic() > until else next(left, None)
            if mutant is None:
                return None

            def job(ask: Asker) -> None:
                nonlocal done, shown
                row = self._judge(mutant, ask)
                with self._lock:
                    done += 1
                    found[mutant.name] = row["status"]
                    self._store.add(mutant.name, row)
                    now = time.monotonic()
                    if now - shown > 10.0 or done == len(rest):
                        shown = now
                        missed = sum(status == "survived" for status in found.values())
                        ahead = (now - begin) / done * (len(rest) - done)
                        self._report(
                            f"[{done}/{len(rest)}] {mutant.module}, {missed} not noticed, "
                            f"about {ahead / 60.0:.0f} min left"
                        )

            return job

        self._workers.serve(jobs)
        return found

    def _tests(self, mutant: Mutant) -> list[str]:
        importing = [file for file, near in self._importing.items() if mutant.module in near]
        return self._survey.tests_for(mutant.module, mutant.first_line, importing)

    def _key(self, mutant: Mutant, status: str, by: str | None) -> str:
        """Identify a result: the changed text, and the tests that were or would be asked."""
        text = digest_of(mutant.source)
        if status == "killed":
            file = (by or "").split("::", maxsplit=1)[0].split(" ")[0]
            return digest(self._root, [file] if (self._root / file).is_file() else [], text)
        tests = self._tests(mutant)
        files = {test.split("::", maxsplit=1)[0] for test in tests}
        return digest(self._root, files, text, *tests)

    def _judge(self, mutant: Mutant, ask: Asker) -> dict[str, Any]:
        tests = self._tests(mutant)
        place = f"{mutant.module}:{mutant.first_line}"
        with self._lock:
            known = [test for test in self._killers[place] if test in tests]
            known += [test for test in self._killers[mutant.module] if test in tests]
        first = list(dict.fromkeys(known))[:MAX_KNOWN]
        picked = self._within_time(first, tests)
        rounds = [first, [], []]
        for test in picked[len(first) :]:
            rounds[1 if self._collecting(test) <= QUICK_FILE else 2].append(test)
        status, by, seconds = "survived", None, 0.0
        for round_ in rounds:
            if not round_ or status == "killed":
                continue
            files = list(dict.fromkeys(test.split("::", maxsplit=1)[0] for test in round_))
            usual = sum(self._survey.seconds[test] for test in round_)
            usual += sum(self._survey.collecting[file] for file in files)
            answer = ask(
                {
                    "files": files,
                    "tests": round_,
                    "module": mutant.module,
                    "source": mutant.source,
                    "timeout": 6.0 + 4.0 * usual,
                }
            )
            status, by = answer["status"], answer["by"]
            seconds += answer["seconds"]
        if by in self._survey.seconds:
            with self._lock:
                self._learn(mutant.module, mutant.first_line, str(by))
        return {
            "name": mutant.name,
            "status": status,
            "by": by,
            "tests": len(picked),
            "not_asked": 0 if status == "killed" else len(tests) - len(picked),
            "asked": self._seconds,
            "seconds": round(seconds, 3),
            "key": self._key(mutant, status, by),
        }

    def _learn(self, module: str, first_line: int, test: str) -> None:
        self._noticed[test] += 1
        for place in (f"{module}:{first_line}", module):
            self._killers[place] = [test, *(t for t in self._killers[place] if t != test)][:5]

    def _within_time(self, first: list[str], tests: list[str]) -> list[str]:
        """Return the tests that noticed other changes here, then more as the time allows."""
        spent = 0.0
        picked: list[str] = list(first)
        files = {test.split("::", maxsplit=1)[0] for test in first}
        took = self._survey.seconds

        def cost(test: str) -> tuple[bool, float]:
            # A test that enters few functions is about them.
            breadth = self._survey.breadth[test]
            time = (took[test] + self._collecting(test)) * breadth
            return breadth > FEW, time / (1.0 + self._noticed[test])

        for test in sorted(tests, key=cost):
            file = test.split("::", maxsplit=1)[0]
            more = took[test]
            more += 0.0 if file in files else max(0.0, self._collecting(test) - QUICK_FILE)
            if test not in first and spent + more <= self._seconds:
                spent += more
                files.add(file)
                picked.append(test)
        return picked or tests[:1]

    def _collecting(self, test: str) -> float:
        return self._survey.collecting[test.split("::", maxsplit=1)[0]]
