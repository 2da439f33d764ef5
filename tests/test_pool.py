"""Workers: any executor, one death for one item, and none outlives a killed parent."""

from __future__ import annotations

import importlib
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from theory.parameters import ParameterError
from verification.execution import pool
from verification.execution.pool import WorkerDiedError, answers, cores_allowed, worker_count

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
    died = found.pop(0)
    assert isinstance(died, WorkerDiedError)
    assert str(died).endswith("with workers=1 no process is started.")
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


class _Mortal(Executor):
    """A pool in this process, which breaks for good at an item of 3, as processes do."""

    def __init__(self) -> None:
        self.broken = False

    def submit(self, function: Callable[..., Any], *items: Any, **_: Any) -> Future[Any]:
        future: Future[Any] = Future()
        self.broken = self.broken or 3 in np.ravel(items)
        if self.broken:
            future.set_exception(BrokenProcessPool())
        else:
            future.set_result(function(*items))
        return future


def _pools(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Let pools be of this process; return where the number of their workers is noted."""
    made: list[int] = []

    @contextmanager
    def counted(workers: int) -> Iterator[Executor]:
        made.append(workers)
        yield _Mortal()

    monkeypatch.setattr(pool, "worker_pool", counted)
    return made


def test_a_pool_is_begun_where_several_are_to_compute_several_items(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = _pools(monkeypatch)
    for workers, items, pools in (
        (2, [1, 2, 4], [2]), (8, [1, 2, 4], [3]), (1, [1, 2, 4], []), (2, [1], []), (2, [], []),
    ):  # fmt: skip
        made.clear()
        found = dict(answers(pool_example.inverse, items, workers=workers))
        assert found == {index: 1 / item for index, item in enumerate(items)}
        assert made == pools
    made.clear()
    monkeypatch.setattr(pool, "cores_allowed", lambda: 2)
    assert dict(answers(pool_example.inverse, [1, 2, 4], only=[2, 0])) == {2: 0.25, 0: 1.0}
    assert made == [2]


def test_a_function_without_a_name_may_go_to_an_executor_that_is_given() -> None:
    with ThreadPoolExecutor(2) as threads:
        found = answers(lambda item: item + 1, [1, 2, 3], workers=2, executor=threads)
        assert dict(found) == {0: 2, 1: 3, 2: 4}


@pytest.mark.parametrize("items", [[1.0], [1.0, 2.0]])
def test_an_executor_that_is_given_computes_everything(items: list[float]) -> None:
    threads = _Timed(0.0)
    assert dict(answers(abs, items, executor=threads, workers=1)) == dict(enumerate(items))
    assert sum(threads.sizes) == len(items)


class _Timed(Executor):
    """A pool in this process in which each item takes so long; it notes how many come at once."""

    def __init__(self, seconds: float) -> None:
        self.seconds, self.sizes = seconds, list[int]()

    def submit(self, function: Callable[..., Any], *given: Any, **_: Any) -> Future[Any]:
        future: Future[Any] = Future()
        (items,) = given
        self.sizes.append(len(items))
        found, _ = function(items)
        future.set_result((found, self.seconds * len(items)))
        return future


@pytest.mark.parametrize("count", [2, 5, 10])
def test_quick_items_are_handed_over_by_as_many_as_take_the_time_of_a_batch(count: int) -> None:
    """One by one until the first answer tells how long they take, then always as many."""
    timed = _Timed(pool.BATCH_SECONDS / (count + 0.5))
    found = dict(answers(pool_example.inverse, range(1, 2001), executor=timed))
    assert found == {index: 1 / (index + 1) for index in range(2000)}
    unknown = pool.MAX_PENDING // pool.MAX_BATCH
    assert set(timed.sizes[:unknown]) == {1}
    assert set(timed.sizes[unknown:-1]) == {count}


@pytest.mark.parametrize("pending", [pool.MAX_PENDING, 1])
def test_of_a_pool_that_breaks_only_the_item_that_is_alone_in_another_has_died(
    pending: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether all items have been handed over by then, or one of them."""
    monkeypatch.setattr(pool, "MAX_PENDING", pending)
    monkeypatch.setattr(pool, "MAX_BATCH", min(pending, pool.MAX_BATCH))
    made = _pools(monkeypatch)
    items = [1, 2, 3, 4, 5, 3, 6]
    found = dict(answers(pool_example.inverse, items, workers=2))
    died = {index for index, answer in found.items() if isinstance(answer, WorkerDiedError)}
    assert died == {2, 5}
    assert all(found[index] == 1 / items[index] for index in {*range(7)} - died)
    assert made[0] == 2
    assert made[-1] == 1


def test_where_cores_are_not_given_to_processes_those_of_the_machine_are_allowed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delattr(os, "sched_getaffinity", raising=False)
    for cores, allowed in ((6, 6), (None, 1)):
        monkeypatch.setattr(os, "cpu_count", lambda cores=cores: cores)
        assert cores_allowed() == allowed


def test_the_cores_that_count_are_those_of_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    given = {0: {3}, os.getpid(): {3}}
    monkeypatch.setattr(
        os, "sched_getaffinity", lambda number: given.get(number, {0, 1, 2, 3}), raising=False
    )
    assert cores_allowed() == 1


def test_a_pool_that_is_left_by_an_error_ends_its_own_processes(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ended: list[str] = []

    class Child:
        def __init__(self, name: str) -> None:
            self.name = name

        def terminate(self) -> None:
            ended.append(f"{self.name} told")

        def join(self) -> None:
            ended.append(f"{self.name} ended")

    other, own = Child("other"), Child("own")
    children = [other]
    monkeypatch.setattr(pool.multiprocessing, "active_children", lambda: list(children))

    def work() -> None:
        with pool.worker_pool(1):
            children.append(own)
            raise KeyError("work")

    with pytest.raises(KeyError, match="work"):
        work()
    assert ended == ["own told", "own ended"]


def test_a_pool_that_is_left_waits_for_its_processes_but_not_after_an_exception(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    ended = []

    class Pool:
        def __init__(self, *_: object, **__: object) -> None:
            pass

        def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
            ended.append((wait, cancel_futures))

    monkeypatch.setattr(pool, "ProcessPoolExecutor", Pool)
    with pool.worker_pool(1):
        pass
    assert ended == [(True, False)]
    with pytest.raises(KeyError, match="work"), pool.worker_pool(1):
        raise KeyError("work")
    assert ended[1:] == [(False, True)]  # nor begins what still waits


def test_a_worker_ends_with_its_parent_where_the_system_does_not_see_to_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    parent, ended = threading.Event(), threading.Event()
    answers_: list[int] = []

    class Parent:
        def join(self) -> None:
            parent.wait(60.0)

    def leave(code: int) -> None:
        answers_.append(code)
        ended.set()

    signals: dict[int, Any] = {}
    monkeypatch.setattr(pool.signal, "signal", signals.__setitem__)
    monkeypatch.setattr(sys, "platform", "other")
    monkeypatch.setattr(pool.multiprocessing, "parent_process", Parent)
    monkeypatch.setattr(os, "_exit", leave)
    before = set(threading.enumerate())
    pool._begin_worker(os.getppid())
    (waiting,) = set(threading.enumerate()) - before
    assert waiting.daemon  # a worker that has done its work does not wait for its parent
    assert signals == {signal.SIGINT: signal.SIG_IGN, signal.SIGTERM: signal.SIG_DFL}
    assert not ended.is_set()
    parent.set()
    assert ended.wait(60.0)
    assert answers_ == [1]


@pytest.mark.parametrize("orphan", [True, False])
def test_a_worker_ends_at_once_whose_parent_has_ended_before_the_system_sees_to_it(
    orphan: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[Any] = []
    kernel = SimpleNamespace(prctl=lambda *given: done.append(given))
    monkeypatch.setattr(pool.ctypes, "CDLL", lambda _: kernel)
    monkeypatch.setattr(pool.signal, "signal", lambda *_: None)
    monkeypatch.setattr(pool.multiprocessing, "parent_process", lambda: None)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(os, "_exit", done.append)
    pool._begin_worker(os.getppid() + orphan)
    assert done == [(1, signal.SIGKILL), *([1] if orphan else [])]  # PR_SET_PDEATHSIG is 1


def test_what_is_left_when_nobody_asks_any_more_is_not_computed() -> None:
    futures: list[Future[Any]] = []

    class Slow(Executor):
        """A pool that has computed the first item and no other yet."""

        def submit(self, function: Callable[..., Any], *given: Any, **_: Any) -> Future[Any]:
            futures.append(Future())
            if len(futures) == 1:
                futures[0].set_result(function(*given))
            return futures[-1]

    found = answers(pool_example.inverse, [1, 2, 4], executor=Slow())
    assert next(iter(found)) == (0, 1.0)
    found.close()  # type: ignore[attr-defined]
    assert len(futures) > 1
    assert all(each.cancelled() for each in futures[1:])


def test_a_worker_that_has_died_is_told_with_what_may_have_ended_it() -> None:
    assert "memory ran out" in str(WorkerDiedError())


def test_what_is_computed_here_is_said_as_it_begins_and_how_much_is_done() -> None:
    begun: list[int] = []
    coming = answers(pool_example.inverse, [1, 2, 4], workers=1, only=[2, 0], begun=begun.append)
    assert [(index, list(begun)) for index, _ in coming] == [(2, [2]), (0, [2, 0])]
    seen: list[float] = []
    found = pool.answers_in_order(pool_example.inverse, [1, 2], workers=1, progress=seen.append)
    assert (found, seen) == ([1.0, 0.5], [0.5, 1.0])


def test_code_that_was_typed_into_a_session_is_in_no_file(monkeypatch: pytest.MonkeyPatch) -> None:
    def typed(x: float) -> float:
        return x

    main: Any = sys.modules["__main__"]
    typed.__module__, typed.__qualname__ = "__main__", "typed"
    monkeypatch.setattr(main, "typed", typed, raising=False)
    monkeypatch.setattr(main, "__file__", "script.py", raising=False)
    assert pool._sendable(typed)
    monkeypatch.delattr(main, "__file__")
    assert not pool._sendable(typed)
    assert pool._sendable(pool_example.inverse)


def test_items_handed_over_together_are_answered_one_by_one_where_one_of_them_fails(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(pool, "MAX_PENDING", 2 * pool.MAX_BATCH)  # so that batches become longer
    items = [0 if index % 30 == 29 else 2 for index in range(120)]
    with ThreadPoolExecutor(2) as threads:
        found = dict(answers(pool_example.inverse, items, executor=threads))
    assert sorted(found) == list(range(120))
    for index, item in enumerate(items):
        if item:
            assert found[index] == 0.5
        else:
            assert isinstance(found[index], ZeroDivisionError)


def test_what_a_broken_pool_does_not_take_is_answered_by_its_death() -> None:
    class Broken(ThreadPoolExecutor):
        def submit(self, *_: object, **__: object) -> Any:
            raise BrokenProcessPool

    with Broken() as broken:
        coming = pool._side_by_side(pool_example.inverse, [1, 2], iter([0, 1]), broken, None)
        ((index, answer),) = coming
    assert index == 0
    assert isinstance(answer, WorkerDiedError)
