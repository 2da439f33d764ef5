"""Faults injected into simulate, sweep, map and check: resuming gives what was undisturbed.

In the manner of SQLite's own tests: not some faults, but one at every place where the disk is
touched, and at every array that memory is asked for.
"""

from __future__ import annotations

import errno
import importlib
import itertools
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from paper_checks.claim import Claim, Finding, Method, Verdict
from paper_checks.discover import Entry
from paper_checks.ruling import holds
from paper_checks.run import run
from theory.chains.vdp import AveragedChain, VdpChain
from theory.parameters import ParameterError
from verification.execution.files import FileError
from verification.execution.store import Store
from verification.execution.sweep import SweepError, sweep
from verification.maps.state_map import boundary_path, state_map
from verification.maps.task import StateTask
from verification.runs import checkpoint
from verification.runs.checkpoint import run_to_end
from verification.runs.excite import excite
from verification.runs.simulate import simulate

FOLDER = Path(__file__).parent
sys.path.insert(0, str(FOLDER))
fault_injection = importlib.import_module("fault_injection")
Disk, injected = fault_injection.Disk, fault_injection.injected
Memory, limited = fault_injection.Memory, fault_injection.limited
sweep_example = importlib.import_module("sweep_example")
Logistic = importlib.import_module("checkpoint_example").Logistic


def simulated(folder: Path) -> bytes:
    """Run two integrations, saved after each step; resume where there is a file."""
    both = [Logistic(2), Logistic(2)]
    run_to_end(both, 2.0, 1, folder / "run.npz", progress=None)
    return b"".join(each.state.tobytes() for each in both)


def integrated(folder: Path) -> bytes:
    """Run the Van der Pol chain itself, with the run that its error comes from."""
    chain = VdpChain(a=4, b=0.5, c=0.6, sites=3)
    start, file = excite(chain, [1]), folder / "run.npz"
    found = simulate(chain, start, 30.0, samples=3, checkpoint=file, budget=3000)
    return found.states.tobytes() + found.arrivals.tobytes() + np.array(found.error).tobytes()


def swept(folder: Path) -> bytes:
    sweep(sweep_example.value, {"x": range(5)}, out=folder / "out.csv", workers=1, resume=True)
    return (folder / "out.csv").read_bytes()


def mapped(folder: Path) -> bytes:
    """Name the states of a small chain, and bisect their boundary: two tables."""
    chain = AveragedChain(a=4, b=0.5, c=0.6, sites=5)
    task, out = StateTask(chain=chain, end=200.0), folder / "map.csv"
    state_map(task, c=[0.1, 0.6], refine=0.5, out=out, workers=1, resume=True)
    return b"".join(path.read_bytes() for path in (out, boundary_path(out)))


class Ready(Claim):
    """A claim whose evidence is its finding."""

    def found(self, evidence: Any) -> Finding:
        finding: Finding = evidence
        return finding


def _claim(key: str) -> Entry:
    finding = Finding(
        verdict=Verdict.REPRODUCED,
        value=key * 50,
        error="0",
        methods=("one", "two"),
        tolerance="none",
        explanation="Because.",
    )
    claim = Ready(
        key=key,
        place="Fig. 1",
        quote="So.",
        statement="So.",
        recorded=Verdict.REPRODUCED,
        command="true",
        evidence=lambda: replace(finding, error=str(np.arange(100.0).sum())),
        rule=lambda _: holds(),
        methods=(Method("one", "m:f"),),
    )
    return Entry("fig1", claim)


ENTRIES = tuple(map(_claim, ("a", "b", "c", "d")))


def checked(folder: Path) -> bytes:
    with Store(folder / "found", {"code": "this"}, resume=True, replace=True) as store:
        outcomes = run(ENTRIES, store=store)
    if any("MemoryError" in (outcome.judgement.failure or "") for outcome in outcomes):
        raise MemoryError
    return repr([outcome.judgement.finding for outcome in outcomes]).encode()


COMPUTATIONS = pytest.mark.parametrize("compute", [simulated, integrated, swept, mapped, checked])


@pytest.fixture
def tmp_path(tmp_path: Path) -> Iterator[Path]:
    """Give a folder in memory where there is such a thing: the disk may be busy."""
    memory = Path("/dev/shm")
    if not (memory.is_dir() and os.access(memory, os.W_OK)):
        yield tmp_path
        return
    with tempfile.TemporaryDirectory(dir=memory) as folder:
        yield Path(folder)


@pytest.fixture(autouse=True)
def _saved_at_each_step(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("verification.execution.files.os.fsync", lambda _: None)
    monkeypatch.setattr(checkpoint, "SAVE_PERIOD", -1.0)
    monkeypatch.setattr(checkpoint, "SAVE_SHARE", 0.0)


@pytest.mark.parametrize(
    ("compute", "number", "step"),
    [
        # The chain itself writes by the same code as the small run, a map by that of the sweep, and
        # a full disk is met where any error is: a part of their places is enough.
        *itertools.product((simulated, swept, checked), (errno.EIO,), (1,)),
        *itertools.product((simulated, swept, checked), (errno.ENOSPC,), (3,)),
        *itertools.product((integrated,), (errno.EIO, errno.ENOSPC), (11,)),
        *itertools.product((mapped,), (errno.EIO, errno.ENOSPC), (3,)),
    ],
)
def test_an_error_at_any_operation_of_the_disk_is_one_sentence_and_loses_nothing(
    compute: Callable[[Path], bytes], number: int, step: int, tmp_path: Path
) -> None:
    whole = compute(_new(tmp_path / "whole"))
    said: list[str] = []
    for n in itertools.count(step=step):
        folder = _new(tmp_path / str(n))
        with injected(Disk(folder, fails=n, number=number)) as disk:
            try:
                assert compute(folder) == whole
            except FileError as error:
                said.append(f"{error}")
        assert compute(folder) == whole
        leftover = [p.name for p in folder.iterdir() if p.name.startswith(".writing")]
        assert not leftover
        if disk.count <= n:
            break
    assert n > 15, "the faults did not reach the disk"
    assert len(said) > 10
    assert all(os.strerror(number).lower() in each.lower() or "disk" in each for each in said)
    assert not any("\n" in each for each in said)


@COMPUTATIONS
def test_a_kill_at_any_operation_of_the_disk_loses_nothing(
    compute: Callable[[Path], bytes], tmp_path: Path
) -> None:
    copies = _new(tmp_path / "copies")
    folder = _new(tmp_path / "run")
    with injected(Disk(folder, copies=copies)) as disk:
        whole = compute(folder)
    assert len(list(copies.iterdir())) == disk.count > 15
    for copy in sorted(copies.iterdir())[:: 7 if compute is integrated else 1]:
        assert compute(copy) == whole, copy.name


@COMPUTATIONS
def test_a_file_size_limit_is_one_sentence_and_loses_nothing(
    compute: Callable[[Path], bytes], tmp_path: Path
) -> None:
    """The system itself refuses here, at whatever byte: EFBIG."""
    whole = compute(_new(tmp_path / "whole"))
    said: list[str] = []
    for size in range(0, 6000, 300):
        folder = _new(tmp_path / str(size))
        soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
        try:
            assert compute(folder) == whole
        except (FileError, ParameterError) as error:
            said.append(f"{error}")
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        assert compute(folder) == whole
    assert len(said) > 2
    assert not any("\n" in each for each in said)


@pytest.mark.parametrize(
    ("compute", "least"),
    [(simulated, 0), (integrated, 0), (swept, 0), (checked, 0), (mapped, 100)],
)
def test_memory_that_runs_out_at_any_array_loses_nothing(
    compute: Callable[[Path], bytes], least: int, tmp_path: Path
) -> None:
    """In a new run; those of a map are very many, so that only larger ones are refused."""
    whole = compute(_new(tmp_path / "whole"))
    failed = 0
    for n in itertools.count():
        folder = _new(tmp_path / str(n))
        with limited(Memory(fails=n, least=least)) as memory:
            try:
                assert compute(folder) == whole
            except MemoryError:
                failed += 1
            except SweepError as error:
                failed += "MemoryError" in f"{error}"
        assert compute(folder) == whole
        if memory.count <= n:
            break
    assert n > 2, "no array was refused"
    assert failed > 2


@pytest.mark.parametrize("compute", [simulated, integrated])
def test_memory_that_runs_out_when_a_run_is_resumed_loses_nothing(
    compute: Callable[[Path], bytes], tmp_path: Path
) -> None:
    folder = _new(tmp_path / "run")
    whole = compute(folder)
    for n in itertools.count():
        with limited(Memory(fails=n)) as memory, suppress(MemoryError):
            assert compute(folder) == whole
        assert compute(folder) == whole
        if memory.count <= n:
            break
    assert n > 2


@COMPUTATIONS
def test_a_clock_that_jumps_changes_nothing(
    compute: Callable[[Path], bytes], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = compute(_new(tmp_path / "whole"))
    chance = random.Random(1)
    for name in ("time.perf_counter", "time.monotonic", "time.time"):
        monkeypatch.setattr(name, lambda: chance.choice([-1e9, 0.0, 1e-3, 1.0, 1e9, 1e18]))
    monkeypatch.setattr(checkpoint, "perf_counter", lambda: chance.choice([-1e9, 0.0, 1.0, 1e18]))
    assert compute(_new(tmp_path / "jumping")) == whole


@pytest.mark.parametrize(
    ("compute", "held"),
    [
        (simulated, "from verification.execution.files import sole_writer as held; "
                    "lock = held(folder / 'run.npz')"),
        (swept, "lock = Store(folder / 'out.csv.part', {}, resume=False)"),
        (mapped, "lock = Store(folder / 'map.csv.part', {}, resume=False)"),
        (checked, "lock = Store(folder / 'found', {'code': 'this'}, resume=False)"),
    ],
)  # fmt: skip
def test_of_two_processes_the_second_is_refused_until_the_first_has_ended(
    compute: Callable[[Path], bytes], held: str, tmp_path: Path
) -> None:
    whole = compute(_new(tmp_path / "whole"))
    folder = _new(tmp_path / "shared")
    program = (
        "import sys, time; from pathlib import Path; folder = Path(sys.argv[1])\n"
        "from verification.execution.store import Store\n"
        f"{held}\n"
        "with lock: print('held', flush=True); time.sleep(60)"
    )
    first = subprocess.Popen(
        [sys.executable, "-c", program, str(folder)],
        stdout=subprocess.PIPE,
        cwd=FOLDER.parent,
    )
    try:
        assert first.stdout.readline() == b"held\n"
        with pytest.raises(FileError, match="is in use by another run"):
            compute(folder)
    finally:
        first.send_signal(signal.SIGKILL)
        first.communicate()
    if compute in (swept, mapped):  # the other one had begun another sweep there
        for path in folder.iterdir():
            path.unlink()
    assert compute(folder) == whole


def _new(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    return folder
