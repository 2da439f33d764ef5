"""Worker processes: a single pool for everything that is computed in parallel.

No worker outlives the process that started it, however that process ends: an interrupt ends the
workers at once, and each of them notices a kill, in the middle of compiled code if the system
supports this (Linux), otherwise as soon as it returns to Python.
"""

from __future__ import annotations

import ctypes
import itertools
import multiprocessing
import os
import pickle
import re
import signal
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from dataclasses import dataclass
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, TypeVar

from theory.parameters import MissingPackageError, ParameterError, count_within

if TYPE_CHECKING:
    from theory.arrays import IntArray

Item = TypeVar("Item")
Answer = TypeVar("Answer")

MAX_WORKERS = 1024
BATCH_SECONDS = 0.02
"""Duration of a batch, in which several short items are handed over together: the pool spends 0.2
ms on each transfer, a quarter of the time for one point of the averaged chain."""
MAX_BATCH = 16
_BATCHES_REMEMBERED = 8
"""Number of recent batches of which the slowest determines the time per item: among quick items, a
batch of slow ones would keep one worker busy while the others have nothing left to do."""
MAX_PENDING = 256 * MAX_BATCH
"""Largest number of items handed over and not yet answered, in at most 256 batches. A dask
scheduler keeps 14 kB per batch, so memory must not grow with the total number."""
CLUSTER_TIMEOUT = 5.0
"""Seconds within which a scheduler must answer, and then have a worker."""

_PR_SET_PDEATHSIG = 1


class WorkerDiedError(RuntimeError):
    """The process that computed an item ended without an answer."""

    def __init__(self) -> None:
        super().__init__(
            "the process that computed it ended without an answer: it was killed, memory ran out, "
            "or it was started by a script whose calls are not below if __name__ == '__main__'; "
            "with workers=1 no process is started."
        )


def cores_allowed() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def worker_pool(workers: int) -> Iterator[Executor]:
    """Provide a pool of processes, none of which outlives this process or an interrupt.

    Parameters
    ----------
    workers : int
        Number of processes.

    Raises
    ------
    ParameterError
        If the number is not between 1 and `MAX_WORKERS`.
    """
    count = worker_count(workers)
    before = set(multiprocessing.active_children())
    # 'spawn' on every system: forking a process that runs compiled threads can deadlock.
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(
        count, mp_context=context, initializer=_begin_worker, initargs=(os.getpid(),)
    )
    try:
        yield pool
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for child in set(multiprocessing.active_children()) - before:
            child.terminate()
            child.join()
        raise
    pool.shutdown()


@contextmanager
def cluster(address: str) -> Iterator[Executor]:
    """Provide the workers of a running dask cluster as an executor; they keep running afterwards.

    Parameters
    ----------
    address : str
        Address of its scheduler, as in ``tcp://host:8786``.

    Raises
    ------
    MissingPackageError
        If dask.distributed is not installed.
    ParameterError
        If there is no such scheduler, or it has no workers.

    References
    ----------
    Rocklin (2015), Dask: parallel computation with blocked algorithms and task scheduling,
    Proc. 14th Python in Science Conf., 126-132.
    """
    try:
        import distributed
    except ModuleNotFoundError:
        raise MissingPackageError("distributed", "cluster", "a dask cluster") from None
    unknown = ParameterError(
        "scheduler", address, "the address of a dask scheduler that answers, as in tcp://host:8786",
        "start one with 'dask scheduler', which prints its address",
    )  # fmt: skip
    if not re.fullmatch(r"(tcp|tls)://\S+:\d+", address):
        raise unknown
    try:
        client = distributed.Client(address, timeout=CLUSTER_TIMEOUT, set_as_default=False)
    except OSError:
        raise unknown from None
    with client:
        try:
            client.wait_for_workers(1, timeout=CLUSTER_TIMEOUT)
        except TimeoutError:
            raise ParameterError(
                "scheduler", address, "one with at least one worker",
                f"start some with 'dask worker {address}'",
            ) from None  # fmt: skip
        # Each point is a task of its own, so its key need not be a digest of its arguments.
        yield client.get_executor(pure=False)


def worker_count(workers: int | None) -> int:
    """Return the number of processes: as many as given, or one per core.

    Raises
    ------
    ParameterError
        If the number is not between 1 and `MAX_WORKERS`.
    """
    return cores_allowed() if workers is None else count_within("workers", workers, 1, MAX_WORKERS)


def answers(
    function: Callable[[Item], Answer],
    items: Sequence[Item],
    *,
    workers: int | None = None,
    executor: Executor | None = None,
    only: Sequence[int] | IntArray | None = None,
    begun: Callable[[int], None] | None = None,
) -> Generator[tuple[int, Answer | Exception], None, None]:
    """Compute a function of every item; yield the answers as they arrive.

    An item whose computation raises an exception does not stop the others, nor does one that kills
    its worker: the others continue in a new pool, and the items that had been handed over are
    computed again, one at a time. Items that take less than `BATCH_SECONDS` are handed over in
    batches; if one of a batch raises, each of its items is computed again separately.

    Parameters
    ----------
    function : callable
        A function of one item; importable by name if other processes compute it.
    items : sequence
        The items; each is retrieved when it is begun or handed over.
    workers : int, optional
        Number of processes, by default one per available core, and never more than there are items;
        1 computes in this process, as does the default if no other process can import the function.
    executor : Executor, optional
        Any executor of ``concurrent.futures``, used instead of processes of its own; it is left
        open.
    only : sequence of int, optional
        Indices of the items to compute, in this order; all if not given.
    begun : callable, optional
        Called with the index of an item when it is begun or handed over.

    Yields
    ------
    tuple of int and object
        The index of an item with its answer, or with the exception that it raised.

    Raises
    ------
    ParameterError
        If the number of workers is not allowed, or the function cannot be sent to another process.

    Examples
    --------
    >>> dict(answers(abs, [-1, 2], workers=1))
    {0: 1, 1: 2}
    """
    chosen = range(len(items)) if only is None else only
    count = min(worker_count(workers), len(chosen))
    if executor is None and count > 1 and not _sendable(function):
        if workers is not None:
            raise ParameterError(
                "function", function, "importable by its name where other processes compute it",
                "define it in a module, or give workers=1",
            )  # fmt: skip
        count = 1
    if executor is None and count <= 1:
        yield from _here(function, items, chosen, begun)
        return
    left = map(int, chosen)
    if executor is not None:
        yield from _side_by_side(function, items, left, executor, begun)
        yield from ((index, WorkerDiedError()) for index in left)  # of an executor that broke
        return
    died: list[int] = []
    broken = True
    while broken:
        broken = False
        with worker_pool(count) as pool:
            for index, answer in _side_by_side(function, items, left, pool, begun):
                if isinstance(answer, WorkerDiedError):
                    broken = True
                    died.append(index)
                else:
                    yield index, answer
    # A worker that dies takes the whole pool and everything handed over with it. Only an item that
    # kills a process in which it is alone is at fault.
    again = iter(sorted(died))
    for index in again:
        with worker_pool(1) as pool:
            for each in itertools.chain((index,), again):
                answer = _answer_of(pool.submit(function, items[each]))
                yield each, answer
                if isinstance(answer, WorkerDiedError):
                    break


def answers_in_order(
    function: Callable[[Item], Answer],
    items: Sequence[Item],
    *,
    workers: int | None,
    progress: Callable[[float], None] | None,
) -> list[Answer]:
    """Compute a function of every item; raise the exception that an item raises.

    Parameters
    ----------
    function, items, workers
        As in `answers`.
    progress : callable or None
        Called with the fraction done.

    Returns
    -------
    list
        The answers in the order of the items.

    Examples
    --------
    >>> answers_in_order(abs, [-1, 2], workers=1, progress=None)
    [1, 2]
    """
    found: dict[int, Answer] = {}
    for index, answer in answers(function, items, workers=workers):
        if isinstance(answer, Exception):
            raise answer
        found[index] = answer
        if progress is not None:
            progress(len(found) / len(items))
    return [found[index] for index in range(len(items))]


def _here(
    function: Callable[[Item], Answer],
    items: Sequence[Item],
    chosen: Iterable[int],
    begun: Callable[[int], None] | None,
) -> Iterator[tuple[int, Answer | Exception]]:
    for index in map(int, chosen):
        if begun is not None:
            begun(index)
        try:
            answer: Answer | Exception = function(items[index])
        except Exception as error:
            answer = error
        yield index, answer


def _side_by_side(
    function: Callable[[Item], Answer],
    items: Sequence[Item],
    chosen: Iterator[int],
    pool: Executor,
    begun: Callable[[int], None] | None,
) -> Iterator[tuple[int, Answer | Exception]]:
    """Yield answers as they arrive, with at most `MAX_PENDING` items handed over and unanswered.

    If the pool breaks, the items that were handed over are answered by `WorkerDiedError`, and no
    more are taken from ``chosen``.
    """
    futures: dict[Future[Any], list[int]] = {}
    # Each finished future puts itself here: polling all of them would cost more than an answer.
    done: SimpleQueue[Future[Any]] = SimpleQueue()
    alone: deque[int] = deque()
    paces: deque[float] = deque(maxlen=_BATCHES_REMEMBERED)
    size, broken = 1, False

    def hand_over(batch: list[int]) -> None:
        future = pool.submit(_Batch(function), [items[index] for index in batch])
        futures[future] = batch
        future.add_done_callback(done.put)

    def batches() -> Iterator[list[int]]:
        """Yield what to hand over next, as long as this is permitted."""
        while len(futures) < max(MAX_PENDING // MAX_BATCH, 1):
            again = [alone.popleft()] if alone else []
            fresh = [] if again else list(itertools.islice(chosen, min(size, MAX_PENDING)))
            for index in fresh if begun is not None else ():
                begun(index)  # type: ignore[misc]
            if not (again or fresh):
                return
            yield again or fresh

    try:
        while True:
            for batch in () if broken else batches():
                try:
                    hand_over(batch)
                except BrokenProcessPool:
                    broken = True
                    alone.extend(batch)
                    break
            if not futures:
                yield from ((index, WorkerDiedError()) for index in alone)
                return
            finished = done.get()
            batch, answer = futures.pop(finished), _answer_of(finished)
            if isinstance(answer, WorkerDiedError):
                broken = True
                alone.extend(batch)
            elif not isinstance(answer, Exception):
                found, seconds = answer
                paces.append(seconds / len(batch))
                size = _batch_size(max(paces))
                yield from zip(batch, found, strict=True)
            elif len(batch) == 1:
                yield batch[0], answer
            else:
                alone.extend(batch)  # which of them raised?
    finally:
        for future in futures:
            future.cancel()


@dataclass(frozen=True)
class _Batch:
    """The function applied to several items, with the seconds that they took."""

    function: Callable[[Any], Any]

    def __call__(self, items: list[Any]) -> tuple[list[Any], float]:
        begin = time.perf_counter()
        found = [self.function(item) for item in items]
        return found, time.perf_counter() - begin


def _batch_size(seconds: float) -> int:
    """Return how many items to hand over at once if one takes this long.

    Examples
    --------
    >>> _batch_size(0.0), _batch_size(0.004), _batch_size(1.0)
    (16, 5, 1)
    """
    return int(min(max(BATCH_SECONDS / max(seconds, 1e-9), 1.0), MAX_BATCH))


def _answer_of(future: Future[Any]) -> Any:
    """Return the answer of a future that is done, or the exception raised."""
    try:
        return future.result()
    except BrokenProcessPool:
        return WorkerDiedError()
    except Exception as error:
        return error


def _sendable(function: Callable[..., Any]) -> bool:
    """Return whether another process can find the function by its name."""
    try:
        text = pickle.dumps(function)
    except (pickle.PicklingError, AttributeError, TypeError):
        return False
    # Code typed into a session is in no file that another process could read.
    return b"__main__" not in text or hasattr(sys.modules["__main__"], "__file__")


def _begin_worker(parent: int) -> None:
    """Leave interrupts to the parent, and end when it ends, even if it is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if sys.platform == "linux":
        # The kernel ends this process, even within compiled code, with the thread that started it.
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
        if os.getppid() != parent:
            os._exit(1)
    began = multiprocessing.parent_process()

    def follow() -> None:
        if began is not None:
            began.join()
            os._exit(1)

    threading.Thread(target=follow, daemon=True).start()
