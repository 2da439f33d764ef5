"""Workers: any executor, one death for one item, and none outlives a killed parent."""

from __future__ import annotations

import importlib
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from theory.parameters import ParameterError
from verification.execution.pool import WorkerDiedError, answers, worker_count

FOLDER = Path(__file__).parent
sys.path.insert(0, str(FOLDER))  # inherited by spawned processes
pool_example = importlib.import_module("pool_example")


def test_answers_are_the_same_by_any_executor_and_errors_are_answers() -> None:
    items = [1, 0, 4]
    with ThreadPoolExecutor(2) as threads:
        for options in ({"workers": 1}, {"workers": 2}, {"executor": threads}):
            found = dict(answers(pool_example.inverse, items, **options))  # type: ignore[arg-type]
            assert (found[0], found[2]) == (1.0, 0.25)
            assert isinstance(found[1], ZeroDivisionError)
        assert threads.submit(int, "1").result() == 1  # left open


def test_items_are_handed_over_as_others_are_answered(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("verification.execution.pool.MAX_PENDING", 3)
    begun: list[int] = []
    found = {}
    with ThreadPoolExecutor(2) as threads:
        coming = answers(pool_example.inverse, range(1, 21), executor=threads, begun=begun.append)
        for index, answer in coming:
            found[index] = answer
            assert len(begun) <= len(found) + 3
    assert begun == list(range(20))
    assert found == {index: 1 / (index + 1) for index in range(20)}


def test_an_item_that_kills_its_worker_takes_no_other_with_it() -> None:
    items = [3, 0, 1, 2, *range(4, 12)]  # most of them wait when the first one kills the pool
    found = dict(answers(pool_example.deadly, items, workers=2))
    assert isinstance(found.pop(0), WorkerDiedError)
    assert found == {index: item**2 for index, item in enumerate(items) if item != 3}


@pytest.mark.parametrize("count", [0, -1, 1025, 1.5, "two", float("nan")])
def test_a_number_of_workers_that_is_none_is_refused(count: object) -> None:
    with pytest.raises(ParameterError, match="workers"):
        worker_count(count)  # type: ignore[arg-type]


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere they end with the compiled call")
def test_workers_in_the_middle_of_compiled_code_end_with_their_killed_parent() -> None:
    program = "import pool_example; pool_example.main()"
    parent = subprocess.Popen(
        [sys.executable, "-c", program], cwd=FOLDER, stdout=subprocess.PIPE, text=True
    )
    assert parent.stdout is not None
    workers = [int(parent.stdout.readline()) for _ in range(2)]
    time.sleep(0.2)  # now they hold the interpreter
    os.kill(parent.pid, signal.SIGKILL)
    parent.wait()
    deadline = time.monotonic() + 3.0
    while workers and time.monotonic() < deadline:
        workers = [pid for pid in workers if _runs(pid)]
        time.sleep(0.01)
    assert not workers
    parent.stdout.close()


def _runs(pid: int) -> bool:
    stat = Path(f"/proc/{pid}/stat")
    try:
        return ") Z " not in stat.read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_a_script_whose_workers_import_it_anew_is_told_so(tmp_path: Path) -> None:
    script = tmp_path / "plain.py"
    script.write_text(
        "import json\n"
        "from verification.execution.sweep import sweep\n"
        "sweep(json.dumps, {'x': [1, 2]}, workers=2)\n"
    )
    run = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert run.returncode == 1
    (said,) = (line for line in run.stderr.splitlines() if "SweepError: " in line)
    assert "if __name__ == '__main__'" in said
