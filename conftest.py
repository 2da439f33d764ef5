"""Which modules pytest leaves out, no search for garbage, time limits, and who shares a process.

Numbers are compared by ``pytest.approx`` with a relative tolerance alone, unless an absolute one is
named: by default it is 1e-12 too, within which any two errors of the size of round-off are equal.

Left out are modules without a doctest: importing them all, with those that an optional extra needs,
took a sixth of collecting. Collecting makes millions of objects that live to the end: looking
through them took a third of it, and time in every test after. Each process begins to collect at
another file of tests, and finds on disk the assertions that others have already rewritten.
Where several processes test, each takes whole files; those that ask for the derivations of the
paper go to one of them, since deriving and checking all takes ten seconds a process. Files that
take long are taken first, so that no process is left with one when the others have ended. The
first ones compile different functions, ten to twenty seconds each, as soon as they begin: what two
processes need at the same time both compile, and only later does every process find it on disk.
"""

import gc
import json
import os
import shlex
import signal
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path, PurePath
from typing import Any

import pytest

# Twenty times as many answers as sympy keeps by default: a twelfth of the time of derivations.
os.environ.setdefault("SYMPY_CACHE_SIZE", "20000")
setattr(type(pytest.approx(1.0)), "DEFAULT_ABSOLUTE_TOLERANCE", 0.0)  # noqa: B010


def pytest_ignore_collect(collection_path: Path) -> bool | None:
    """Leave out modules that are no tests and have no doctest."""
    tests = collection_path.name.startswith("test_")
    if collection_path.suffix != ".py" or tests or b">>>" in collection_path.read_bytes():
        return None
    return True


def pytest_collection() -> None:
    """Search for no garbage while modules are imported and tests are made."""
    gc.disable()


def pytest_collection_finish() -> None:
    """Search again, though less often, and leave out what has been collected."""
    gc.freeze()
    gc.set_threshold(100_000, 20, 100)  # a twentieth of the time of computer algebra
    gc.enable()


class _FromAnotherFile(pytest.Dir):
    """A folder whose files are collected cyclically, by each process from another one on."""

    def collect(self) -> list[pytest.Item | pytest.Collector]:
        """Return the files, the first of this process first."""
        files = list(super().collect())
        worker = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw"))
        first = worker * len(files) // int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
        return [*files[first:], *files[:first]]


def pytest_collect_directory(path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect the folder of tests cyclically."""
    tests = path == parent.config.rootpath / "tests"
    return _FromAnotherFile.from_parent(parent, path=path) if tests else None


@pytest.fixture
def interruptible() -> Iterator[None]:
    """SIGINT raises KeyboardInterrupt, also where a shell has started pytest in the background."""
    was = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, was)


@pytest.fixture
def answered(capsys: pytest.CaptureFixture[str]) -> Callable[[str | Sequence[str]], Any]:
    """Return what a line, or its words, prints in JSON."""
    from fronts.cli import main

    def answer_to(line: str | Sequence[str]) -> Any:
        words = shlex.split(line) if isinstance(line, str) else line
        assert main([*words, "--json"]) == 0
        return json.loads(capsys.readouterr().out)

    return answer_to


@pytest.fixture
def refused(capsys: pytest.CaptureFixture[str]) -> Callable[[str], dict[str, str]]:
    """Return the error of a line that is refused in one sentence, the same in JSON."""
    from fronts.cli import main

    def error_of(line: str) -> dict[str, str]:
        assert main(shlex.split(line)) == 2
        shown = capsys.readouterr()
        assert shown.out == ""
        assert len(shown.err.strip().splitlines()) == 1
        assert main([*shlex.split(line), "--json"]) == 2
        error: dict[str, str] = json.loads(capsys.readouterr().err)["error"]
        assert shown.err == f"fronts: {error['message']}\n"
        return error

    return error_of


@pytest.fixture
def unhurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ten times the time limits of values and of references: a machine may be slow, or shared."""
    from verification.quantities import judging
    from verification.references import pace

    monkeypatch.setattr(pace, "MAX_SECONDS", 10.0 * pace.MAX_SECONDS)
    monkeypatch.setattr(judging, "SLOWNESS", 10.0)


DERIVING = (
    "test_behaviour",
    "test_derivations",
    "test_errata",
    "test_report_of_the_paper",
    "test_transcription",
)
"""How the names of the files begin whose tests ask for the derivations of the paper."""
OF_OTHER_MODELS = ("test_derivations_front_models", "test_derivations_other_models")
"""Those among them that ask for so many of other chains that the paper's would be forgotten."""
LONG = (
    "test_theory_sum_rules", "test_robustness", "test_friction_laws", DERIVING[0],
    "test_own_compiled", *OF_OTHER_MODELS, "test_sweep", "test_benchmarks",
    "test_theory_stability", "test_state_map", "test_mutation", "test_command_line",
    "test_front_wave", "test_vdp_runs", "test_vdp_fronts", "test_own_cells", "test_theory_sums",
    "test_report",
)  # fmt: skip
"""Files of ten seconds and more, and one that compiles what other files on friction need, in the
order in which they are handed out."""


def _scope(name: str) -> str:
    """Return the file whose tests go to one process, or what those that derive go by."""
    derives = name.startswith(DERIVING) and name not in OF_OTHER_MODELS
    return DERIVING[0] if derives else name


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the files that take long first, and the others in one order in all processes."""
    if "PYTEST_XDIST_WORKER" in os.environ:
        items.sort(key=lambda item: item.path)
    places = {scope: place for place, scope in enumerate(LONG)}
    items.sort(key=lambda item: places.get(_scope(item.path.stem), len(LONG)))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Hand out whole files in the order of the tests, those that derive together."""
    if config.getoption("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class Sharing(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = PurePath(nodeid.partition("::")[0])
            return str(file.with_stem(_scope(file.stem)))

    config.option.loadscopereorder = False  # by the number of tests
    return Sharing(config, log)
