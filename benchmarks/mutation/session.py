"""One session of pytest that collects all tests once, and forks a child for each run of some.

A child begins with everything imported and all tests collected. A change is put in place there:
the functions, classes and constants that live become as changed, the files stay as they are, and
tests run until one fails. What is entered or named while modules are imported has left its results
in them. Where no test failed, such changes are made again with the project imported anew, and so
are, at once, those of what numba compiles; its store of compiled code is never written to.
"""

from __future__ import annotations

import contextlib
import gc
import json
import os
import resource
import selectors
import signal
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from types import FunctionType
from typing import TYPE_CHECKING, Any

import pytest

from benchmarks.mutation import entered
from benchmarks.mutation.mutants import Mutant
from benchmarks.mutation.put import (
    fits,
    libraries_of,
    names_bound,
    names_used_on_import,
    put_statement,
)

if TYPE_CHECKING:
    from benchmarks.mutation.derived import DerivationChecks

OPTIONS = ("-q", "-s", "--no-header", "--assert=plain", "--tb=native", "--import-mode=importlib",
           "-p", "no:cacheprovider", "-p", "no:faulthandler",
           "-o", "tmp_path_retention_policy=none")  # fmt: skip
KEPT_WARM = frozenset({"verification.execution.imports"})
"""What this keeps is read from the files of the project, which no change touches: seconds of
reading that would be charged to each test which stores a result with the digest of its code."""

Answer = dict[str, Any]
STOPPED = "time limit or crash"
"""What noticed a change where its child did not end by itself."""


@dataclass(frozen=True, kw_only=True)
class Task:
    """What a child does: it writes answers; processor seconds allowed; what takes the answers."""

    run: Callable[[Callable[[Answer], None]], None]
    seconds: float
    take: Callable[[list[Answer]], None]


class Session:
    """The collected tests, the functions that live, and what importing them has entered.

    Parameters
    ----------
    root : Path
        The project.
    names : set of str
        Of functions entered, as :func:`benchmarks.mutation.entered.install` returned it.

    Attributes
    ----------
    missing : dict
        By module that cannot be imported, the library that is not installed here.
    """

    def __init__(self, root: Path, names: set[str]) -> None:
        self.root, self.names = root, names
        self.items: dict[str, pytest.Item] = {}
        self.missing: dict[str, str] = {}
        self.on_import: frozenset[str] = frozenset()
        self._names_on_import: frozenset[str] = frozenset()
        self._living: dict[str, list[FunctionType]] = defaultdict(list)
        self._work: Callable[[], None] = lambda: None

    def collect(self, files: Sequence[str], work: Callable[[], None]) -> int:
        """Import the project, collect the tests of files, do the work; return pytest's exit code.

        What a child imports would be imported, or compiled, in each child again.
        """
        self._work = work
        files_ = [self.root / each for each in self._modules()]
        for name in libraries_of(files_):
            with contextlib.suppress(ImportError):
                import_module(name)
        from hypothesis import Phase, settings

        # An example that fails is enough; to look for the simplest one takes minutes.
        first_one = (Phase.explicit, Phase.generate)
        settings.register_profile("mutation", phases=first_one, database=None)
        settings.load_profile("mutation")
        for module in self._modules():
            try:
                import_module(dotted(module))
            except ModuleNotFoundError as error:
                if str(error.name).split(".")[0] in entered.PACKAGES:
                    raise
                self.missing[module] = str(error.name)
        with tempfile.TemporaryDirectory(prefix="fronts-mutation-") as temporary:
            options = [*OPTIONS, f"--basetemp={temporary}/pytest"]
            os.environ["HYPOTHESIS_STORAGE_DIRECTORY"] = temporary
            return int(pytest.main([*options, *files], plugins=[self]))

    def _modules(self) -> list[str]:
        """Return all modules of the project but those that run when they are imported."""
        found = (path for each in entered.PACKAGES for path in (self.root / each).rglob("*.py"))
        paths = sorted(path for path in found if path.name != "__main__.py")
        return [path.relative_to(self.root).as_posix() for path in paths]

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """In the place of running all tests."""
        self.items = {item.nodeid: item for item in session.items}
        self.on_import = frozenset(self.names)
        files = {item.nodeid.split("::")[0] for item in session.items}  # their tables of cases
        imported = (self.root / each for each in {*self._modules(), *files})
        self._names_on_import = names_used_on_import(imported)
        gc.unfreeze()  # conftest.py freezes what collection leaves, and only the rest is listed
        for each in gc.get_objects():
            if isinstance(each, FunctionType):
                path = os.path.relpath(each.__code__.co_filename, self.root)
                self._living[f"{path}:{each.__code__.co_firstlineno}"].append(each)
        compile_steppers()
        from verification.execution.digest import digest_of_code

        digest_of_code(["paper_checks.discover", "verification.maps.state_map"])
        gc.freeze()
        self._work()
        return True

    def record(self, file: str, limit: float, write: Callable[[Answer], None]) -> None:
        """Run the tests of a file; write of each that passes its time and what it entered.

        A test that takes more than `limit` processor seconds counts as one that does not pass.
        """
        recorder = _Recorder(self.names)
        for item in self._on(file):
            failed = self._first_failing([item.nodeid], recorder, limit)
            if failed is None:
                write({"test": item.nodeid, **recorder.answer(item)})

    def _on(self, file: str) -> list[pytest.Item]:
        return [item for item in self.items.values() if item.nodeid.split("::")[0] == file]

    def judge(self, mutant: Mutant, tests: Sequence[str], write: Callable[[Answer], None]) -> None:
        """Run tests against a change until one fails; write which."""
        from numba.core import caching

        caching.Cache.save_overload = lambda *_: None  # type: ignore[method-assign]
        compiled = mutant.qualified in entered.compiled
        if not compiled and self._put(mutant):
            failed = self._first_failing(tests)
            if failed or not self._used_on_import(mutant):
                return write({"by": failed})
        write({"by": self._anew(mutant, tests, compiled) if tests else None})

    def judge_by_checks(
        self, mutant: Mutant, checks: DerivationChecks, write: Callable[[Answer], None]
    ) -> None:
        """Put a change to the checks of the derivations; write which step's check notices it."""
        write({"by": checks.noticing(mutant) if self._put(mutant) else None})

    def made_on_import(self, mutant: Mutant) -> bool:
        """Return whether what is changed is made, or entered, while the project is imported."""
        at = mutant.function_at
        return not mutant.first_line or mutant.of_default or at in self.on_import

    def _used_on_import(self, mutant: Mutant) -> bool:
        """Return whether importing the project leaves results of what is changed elsewhere."""
        if mutant.first_line:
            return mutant.function_at in self.on_import
        bound = names_bound(mutant.statement)
        return not bound or not bound.isdisjoint(self._names_on_import)

    def seconds_to_begin(self, mutant: Mutant) -> float:
        """Return the processor seconds allowed for compiling or importing anew beside tests."""
        if mutant.qualified in entered.compiled:
            return 120.0
        return 15.0 if self.made_on_import(mutant) else 2.0

    def _first_failing(
        self, tests: Sequence[str], plugin: object = None, limit: float = 0.0
    ) -> str | None:
        if not tests:
            return None
        failures = _Failures()
        manager = self.items[tests[0]].config.pluginmanager
        plugins = [failures, *([plugin] if plugin else [])]
        for each in plugins:
            manager.register(each)
        for name in tests:
            signal.setitimer(signal.ITIMER_PROF, limit)
            item = self.items[name]
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=None)
            if failures.first:
                break
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        for each in plugins:
            manager.unregister(each)
        return failures.first

    def _put(self, mutant: Mutant) -> bool:
        """Give what lives the changed code and values; return whether that could be done."""
        with mutant.made() as tree:
            if not mutant.first_line or mutant.of_default:
                return put_statement(sys.modules[dotted(mutant.module)], mutant.statement)
            code = compile(tree, str(self.root / mutant.module), "exec", dont_inherit=True)
        tops = [c for c in entered.codes_in(code) if c.co_firstlineno == mutant.first_line]
        new = [c for top in tops for c in entered.codes_in(top)]  # with what it has returned before
        pairs = [
            (old, c)
            for c in new
            for old in self._living[f"{mutant.module}:{c.co_firstlineno}"]
            if fits(old.__code__, c)
        ]
        for old, changed in pairs:
            old.__code__ = changed
        return bool(pairs)

    def _anew(self, mutant: Mutant, tests: Sequence[str], compiled: bool) -> str | None:
        """Import the project anew with a change and run tests, in a session within this one."""
        with mutant.made() as tree:
            code = compile(tree, str(self.root / mutant.module), "exec", dont_inherit=True)
        entered.replaced[mutant.module] = code
        for name in list(sys.modules):
            if name.split(".")[0] in (*entered.PACKAGES, "tests"):
                del sys.modules[name]
        files = {name.split("::")[0] for name in tests}
        failures = _Failures(tests)
        with tempfile.TemporaryDirectory(prefix="fronts-mutation-") as base:
            if compiled:  # what calls the changed function would come from the store as it was
                from numba.core import config

                vars(config)["CACHE_DIR"] = base
            options = [*OPTIONS, "-x", f"--basetemp={base}/pytest"]
            code_ = pytest.main([*options, *sorted(files)], plugins=[failures])
        return failures.first or (None if code_ in (0, 5) else f"exit code {int(code_)}")


class _Failures:
    """The first test that fails; of the named tests only, in their order."""

    def __init__(self, tests: Sequence[str] = ()) -> None:
        self.first: str | None = None
        self._order = {name: i for i, name in enumerate(tests)}

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        items[:] = [item for item in items if item.nodeid in self._order]
        items.sort(key=lambda item: self._order[item.nodeid])

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed and self.first is None:
            self.first = report.nodeid

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.failed and self.first is None:
            self.first = f"{report.nodeid} (import)"


class _Recorder:
    """What a test enters and how long it takes, with the fixtures that it shares with others."""

    def __init__(self, names: set[str]) -> None:
        self._names = names
        self._shared: dict[str, tuple[float, set[str]]] = {}
        self._begin = self._elsewhere = 0.0
        signal.signal(signal.SIGPROF, _too_long)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_protocol(self) -> None:
        forget()
        self._names.clear()
        self._begin, self._elsewhere = _spent(), 0.0

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any) -> Iterator[None]:
        before, begin = set(self._names), _spent()
        self._names.clear()
        try:
            return (yield)
        finally:
            if fixturedef.scope != "function":
                took = _spent() - begin
                self._elsewhere += took
                self._shared[fixturedef.argname] = took, set(self._names)
            self._names |= before

    def answer(self, item: pytest.Item) -> Answer:
        """Return the processor seconds of the last test and what it entered."""
        seconds = max(0.0, _spent() - self._begin - self._elsewhere)
        entered_ = set(self._names)
        for fixture in getattr(item, "fixturenames", ()):
            took, more = self._shared.get(fixture, (0.0, set()))
            seconds += took
            entered_ |= more
        return {"seconds": seconds, "entered": sorted(entered_)}


def forget() -> None:
    """Empty all caches of the project and its tests, as a child that runs a single test finds them.

    What one test leaves in them another would not enter, and would seem cheaper than it is alone.
    """
    for name, module in list(sys.modules.items()):
        if name.split(".")[0] in (*entered.PACKAGES, "tests") and name not in KEPT_WARM:
            for value in list(vars(module).values()):
                if hasattr(value, "cache_clear"):
                    value.cache_clear()


def compile_steppers() -> None:
    """Let numba compile what steps the chains, or load it, once for all children.

    Each would do it within the seconds of its first test, and that test would count as too long.
    """
    from theory.chains.friction import FrictionChain
    from theory.chains.vdp import AveragedChain, VdpChain
    from verification.fronts.measure import measure_front

    for chain in (
        AveragedChain(a=4, b=0.5, c=0.6), VdpChain(a=4, b=0.5, c=0.6),
        FrictionChain(c=0.02, sites=31),
    ):  # fmt: skip
        measure_front(chain)
    forget()


def _spent() -> float:
    """Return the processor seconds of this process and of the children that have ended."""
    return sum(os.times()[:4])


def _too_long(*_: object) -> None:
    raise TimeoutError("this test is too long to be asked")


def dotted(path: str) -> str:
    """Return the name by which a module is imported.

    Examples
    --------
    >>> dotted("theory/cells/vdp.py"), dotted("theory/__init__.py")
    ('theory.cells.vdp', 'theory')
    """
    return path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def in_children(tasks: Iterator[Task], count: int) -> None:
    """Do tasks in forked children, so many at a time; what they start ends with them.

    A child that is ended by a signal, or by its time, answers with that as what noticed.
    """
    waiting = selectors.DefaultSelector()
    left = True
    try:
        while left or waiting.get_map():
            while left and len(waiting.get_map()) < count:
                task = next(tasks, None)
                left = task is not None
                if task is not None:
                    child, pipe = _begin(task)
                    until = time.monotonic() + 4.0 * task.seconds + 20.0
                    state = (task, child, until, bytearray())
                    waiting.register(pipe, selectors.EVENT_READ, state)
            ready = {key.fd for key, _ in waiting.select(0.5)}
            for key in list(waiting.get_map().values()):
                task, child, until, received = key.data
                part = os.read(key.fd, 1 << 16) if key.fd in ready else None
                received += part or b""
                if part == b"" or time.monotonic() > until:
                    waiting.unregister(key.fd)
                    os.close(key.fd)
                    task.take(_ended(child, bytes(received)))
    finally:
        for key in waiting.get_map().values():
            _ended(key.data[1], b"")


def _begin(task: Task) -> tuple[int, int]:
    reading, writing = os.pipe()
    child = os.fork()
    if child:
        os.close(writing)
        return child, reading
    os.setsid()
    nowhere = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(nowhere, stream)
    limit = int(time.process_time() + task.seconds) + 1
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))

    def write(answer: Answer) -> None:
        os.write(writing, json.dumps(answer).encode() + b"\n")

    try:
        task.run(write)
    except BaseException as error:
        write({"by": type(error).__name__})
    os._exit(0)


def _ended(child: int, received: bytes) -> list[Answer]:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(child, signal.SIGKILL)  # the child's own session
    _, status = os.waitpid(child, 0)
    whole, _, _ = received.rpartition(b"\n")
    answers = [json.loads(line) for line in whole.splitlines()]
    return answers or ([{"by": STOPPED}] if os.WIFSIGNALED(status) else [])
