"""A pytest session that imports everything and collects all tests once, for all children."""

from __future__ import annotations

import contextlib
import gc
import os
import signal
import tempfile
from collections import defaultdict
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path
from types import FunctionType
from typing import Any

import pytest

from benchmarks.mutation import entered
from benchmarks.mutation.children import Answer
from benchmarks.mutation.put import libraries_of, names_used_on_import
from benchmarks.mutation.recorder import Recorder, TooLong, forget

OPTIONS = ("-q", "-s", "--no-header", "--assert=plain", "--tb=native", "--import-mode=importlib",
           "-p", "no:cacheprovider", "-p", "no:faulthandler",
           "-o", "tmp_path_retention_policy=none")  # fmt: skip


class Session:
    """The collected tests, the existing functions, and the functions entered during imports.

    Parameters
    ----------
    root : Path
        Root of the project.
    names : set of str
        Names of functions entered, as returned by :func:`benchmarks.mutation.entered.install`.

    Attributes
    ----------
    missing : dict
        For each module that cannot be imported, the library that is not installed here.
    on_import, before_tests : frozenset of str
        Functions entered during imports; the same together with those entered in preparing what
        is kept for all tests.
    names_on_import : frozenset of str
        Names used by the statements of modules.
    living : dict
        The existing functions, by ``path:line`` of their code.
    """

    def __init__(self, root: Path, names: set[str]) -> None:
        self.root, self.names = root, names
        self.items: dict[str, pytest.Item] = {}
        self.missing: dict[str, str] = {}
        self.on_import: frozenset[str] = frozenset()
        self.before_tests: frozenset[str] = frozenset()
        self.names_on_import: frozenset[str] = frozenset()
        self.living: dict[str, list[FunctionType]] = defaultdict(list)
        self._work: Callable[[], None] = lambda: None

    def collect(self, files: Sequence[str], work: Callable[[], None]) -> int:
        """Import the project, collect the tests of files, do the work; return pytest's exit code.

        Everything is imported here, since otherwise each child would import or compile it again.
        """
        self._work = work
        files_ = [self.root / each for each in self._modules()]
        for name in libraries_of(files_):
            with contextlib.suppress(ImportError):
                import_module(name)
        from hypothesis import Phase, settings

        # One failing example is enough; the search for the simplest one takes minutes.
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
        """Return all modules of the project except those that run when they are imported."""
        found = (path for each in entered.PACKAGES for path in (self.root / each).rglob("*.py"))
        paths = sorted(path for path in found if path.name != "__main__.py")
        return [path.relative_to(self.root).as_posix() for path in paths]

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Do the work instead of running all tests."""
        self.items = {item.nodeid: item for item in session.items}
        self.on_import = frozenset(self.names)
        files = {item.nodeid.split("::")[0] for item in session.items}  # for their tables of cases
        imported = (self.root / each for each in {*self._modules(), *files})
        self.names_on_import = names_used_on_import(imported)
        gc.unfreeze()  # conftest.py freezes what collection leaves, and only the rest is listed
        for each in gc.get_objects():
            if isinstance(each, FunctionType):
                path = os.path.relpath(each.__code__.co_filename, self.root)
                self.living[f"{path}:{each.__code__.co_firstlineno}"].append(each)
        compile_steppers()
        self.names.clear()
        read_sources()
        self.before_tests = self.on_import | self.names
        gc.freeze()
        # pytest removes what is in its temporary folder when this is first asked for: not in each
        # child, which would remove the files of tests that another one runs.
        config: Any = session.config
        config._tmp_path_factory.getbasetemp()
        self._work()
        return True

    def record(self, file: str, limit: float, write: Callable[[Answer], None]) -> None:
        """Run the tests of a file; for each that passes, write its time and the functions entered.

        A test that takes more than `limit` processor seconds counts as failed. The last answer
        marks the end, and lists the functions entered by all tests, whether they passed or not.
        """
        recorder = Recorder(self.names)
        whole: set[str] = set()
        for item in self.tests_of(file):
            failed = self.first_failing([item.nodeid], recorder, limit)
            answer = recorder.answer(item)
            whole.update(answer["entered"])
            if failed is None and answer["seconds"] <= limit:  # including processes that it started
                write({"test": item.nodeid, **answer})
        write({"entered by all": sorted(whole)})

    def tests_of(self, file: str) -> list[pytest.Item]:
        """Return the tests of a file."""
        return [item for item in self.items.values() if item.nodeid.split("::")[0] == file]

    def first_failing(
        self, tests: Sequence[str], plugin: object = None, limit: float = 0.0
    ) -> str | None:
        """Run tests until one fails, each within a limit of processor time; return its name."""
        if not tests:
            return None
        failures = Failures()
        manager = self.items[tests[0]].config.pluginmanager
        plugins = [failures, *([plugin] if plugin else [])]
        for each in plugins:
            manager.register(each)
        for name in tests:
            item = self.items[name]
            try:
                signal.setitimer(signal.ITIMER_PROF, limit)
                item.config.hook.pytest_runtest_protocol(item=item, nextitem=None)
            except TooLong:  # between a test and its report
                failures.first = name
                item.session._setupstate.teardown_exact(None)
            if failures.first:
                break
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        for each in plugins:
            manager.unregister(each)
        return failures.first


class Failures:
    """The first failing test; only the named tests are run, in their order."""

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


def compile_steppers() -> None:
    """Make numba compile the steppers of the chains once for all children, inner functions too.

    Otherwise each child would do so during its first test, and that test would count as too long.
    Code loaded from disk does not contain the inner functions separately, so that all of them would
    be compiled again for a change of one.
    """
    from numba.core import caching

    from theory.chains.friction import FrictionChain
    from theory.chains.vdp import AveragedChain, VdpChain
    from verification.fronts.measure import measure_front

    load = caching.Cache.load_overload
    caching.Cache.load_overload = lambda *_: None  # type: ignore[method-assign]
    for chain in (
        AveragedChain(a=4, b=0.5, c=0.6), VdpChain(a=4, b=0.5, c=0.6),
        FrictionChain(c=0.02, sites=31),
    ):  # fmt: skip
        measure_front(chain)
    caching.Cache.load_overload = load  # type: ignore[method-assign]
    forget()


def read_sources() -> None:
    """Read the files on which stored results depend once for all children."""
    from verification.execution.digest import digest_of_code

    digest_of_code(["paper_checks.discover", "verification.maps.state_map"])


def dotted(path: str) -> str:
    """Return the dotted name by which a module is imported.

    Examples
    --------
    >>> dotted("theory/cells/vdp.py"), dotted("theory/__init__.py")
    ('theory.cells.vdp', 'theory')
    """
    return path.removesuffix(".py").removesuffix("/__init__").replace("/", ".")
