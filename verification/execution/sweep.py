"""One sweep engine for every map: a task, points, any executor, a journal, a table.

The table depends on the task and the points only: not on the number of workers, the order in which
they finish, or how often the sweep was killed and resumed.

A point whose task raises does not stop the others: they are finished and put into the journal,
then `SweepError` names the failed ones. These are not in the journal, so that a resumed sweep
tries them, and only them, again.
"""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import importlib.metadata
import importlib.util
import json
import multiprocessing
import os
import platform
import signal
import threading
import time
from collections.abc import Callable, Generator, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager, nullcontext
from enum import Enum
from pathlib import Path
from typing import Any, TypeAlias

from theory.parameters import count_within
from verification.execution.journal import Journal, journal_path
from verification.execution.table import Point, Scalar, Table, load_table, plain, table_of

Task: TypeAlias = Callable[[Point], Mapping[str, Scalar]]
"""From a point to its results; picklable (a function of a module, or a frozen dataclass with
``__call__``) where there is more than one worker."""

ProgressCallback: TypeAlias = Callable[[int, int, float | None], None]
"""Told of points done, points in all, and seconds left (None before the first)."""

SOURCES = ("theory", "verification")
"""Packages whose code a result may depend on."""


class SweepError(RuntimeError):
    """Points that could not be computed; the finished ones are in the journal, if there is one.

    Parameters
    ----------
    message : str
        One sentence.
    failures : sequence of (Point, BaseException)
        The points and what was raised.
    """

    def __init__(self, message: str, failures: Sequence[tuple[Point, BaseException]] = ()) -> None:
        self.failures = tuple(failures)
        super().__init__(message)


def sweep(
    task: Task,
    points: Sequence[Point],
    *,
    out: Path | None = None,
    resume: bool = False,
    workers: int | None = None,
    executor: Executor | None = None,
    progress: ProgressCallback | None = None,
) -> Table:
    """Compute a task at every point.

    Parameters
    ----------
    task : callable
        See `Task`. Its name and, for a dataclass or ``functools.partial``, its parameters go into
        the stamp.
    points : sequence of Point
        Where; all with the same names.
    out : Path, optional
        CSV file for the table; the stamp goes beside it into ``<out>.json``, and while the sweep
        runs the journal into ``<out>.part``.
    resume : bool, optional
        Go on from the journal, if there is one; take the table if it is there already.
    workers : int, optional
        Processes, by default one a core that may be used; 1 computes in this process.
    executor : Executor, optional
        Used in place of own processes, and left open.
    progress : callable, optional
        See `ProgressCallback`.

    Returns
    -------
    Table
        One row a point: its coordinates, then its results.

    Raises
    ------
    ParameterError
        If the journal cannot be used, or the number of workers is not allowed.
    SweepError
        If a task raised, or a worker process died.

    Examples
    --------
    >>> from verification.execution.table import grid
    >>> table = sweep(lambda point: {"square": point.number("x") ** 2}, grid(x=[1, 2]), workers=1)
    >>> table["square"]
    array([1., 4.])
    """
    begin = time.perf_counter()
    points = [point if isinstance(point, Point) else Point(point) for point in points]
    stamp = stamp_of(task, points)
    if out and resume and not journal_path(out).exists():
        table = load_table(out)
        if table is not None and table.stamp == stamp:
            return table
    finished: dict[int, Mapping[str, Scalar]] = {}
    failures: dict[int, Exception] = {}
    journal = Journal(journal_path(out), stamp, len(points), resume) if out else None
    with journal or nullcontext():
        finished.update(journal.finished if journal else {})
        resumed = len(finished)
        left = [(index, point) for index, point in enumerate(points) if index not in finished]
        if progress:
            progress(resumed, len(points), None)
        # Closed at once on an interrupt, and not when the collector finds it: it owns the workers.
        with closing(_outcomes(task, left, executor, workers)) as outcomes:
            for index, outcome in outcomes:
                if isinstance(outcome, Exception):
                    failures[index] = outcome
                    continue
                if journal:
                    journal.add(index, outcome)
                finished[index] = outcome
                if progress:
                    new = len(finished) - resumed
                    rate = (time.perf_counter() - begin) / new
                    progress(len(finished), len(points), rate * (len(left) - new))
        if failures:
            raise _failed([(points[index], failures[index]) for index in sorted(failures)])
        rows = [{**point, **finished[index]} for index, point in enumerate(points)]
        table = table_of(rows, stamp, time.perf_counter() - begin, resumed)
        if out and journal:
            table.save(out)
            journal.remove()
    return table


def stamp_of(task: Task, points: Sequence[Point]) -> dict[str, Any]:
    """Return what identifies a sweep: task, parameters, points, versions, code."""
    rows = json.dumps([list(point.items()) for point in points]).encode()
    return {
        "task": task_name(task),
        "parameters": parameters_of(task),
        "points": {"count": len(points), "sha256": hashlib.sha256(rows).hexdigest()},
        "versions": {
            "python": platform.python_version(),
            **{name: importlib.metadata.version(name) for name in ("numpy", "scipy", "numba")},
        },
        "source": _source_hash(),
    }


def task_name(task: object) -> str:
    """Return the importable name of a task's function or class.

    Examples
    --------
    >>> task_name(plain)
    'verification.execution.table.plain'
    """
    if isinstance(task, functools.partial):
        return task_name(task.func)
    owner: Any = task if hasattr(task, "__qualname__") else type(task)
    return f"{owner.__module__}.{owner.__qualname__}"


def parameters_of(task: object) -> Any:
    """Return the parameters of a task as JSON would give them back."""
    if isinstance(task, functools.partial):
        named = {str(i): value for i, value in enumerate(task.args)} | task.keywords
        return {name: parameters_of(value) for name, value in named.items()}
    if dataclasses.is_dataclass(task) and not isinstance(task, type):
        fields = {f.name: parameters_of(getattr(task, f.name)) for f in dataclasses.fields(task)}
        return {"is": task_name(task), **fields}
    if isinstance(task, Enum):
        return task.value
    if isinstance(task, tuple | list):
        return [parameters_of(value) for value in task]
    if callable(task):
        return task_name(task)
    return task if task is None else plain(task)


def _outcomes(
    task: Task,
    left: Sequence[tuple[int, Point]],
    executor: Executor | None,
    workers: int | None,
) -> Generator[tuple[int, Mapping[str, Scalar] | Exception], None, None]:
    """Yield results or errors as they come."""
    count = workers_allowed() if workers is None else count_within("workers", workers, 1, 1024)
    count = min(count, len(left))
    if executor is None and count <= 1:
        for index, point in left:
            try:
                yield index, _plain_result(task, point)
            except Exception as error:
                yield index, error
        return
    with own_workers(count) if executor is None else nullcontext(executor) as pool:
        futures: dict[Future[dict[str, Scalar]], int] = {}
        try:
            for index, point in left:
                futures[pool.submit(_plain_result, task, point)] = index
            for future in as_completed(futures):
                try:
                    yield futures[future], future.result()
                except BrokenProcessPool:
                    raise
                except Exception as error:
                    yield futures[future], error
        except BrokenProcessPool:
            raise SweepError(
                "a worker process ended without an answer (killed, or out of memory); the "
                "finished points are in the journal and the sweep can be resumed."
            ) from None
        finally:
            for future in futures:
                future.cancel()


def _plain_result(task: Task, point: Point) -> dict[str, Scalar]:
    return {name: plain(value) for name, value in task(point).items()}


def _failed(failures: Sequence[tuple[Point, BaseException]]) -> SweepError:
    point, error = failures[0]
    others = f" and {len(failures) - 1} other points" if len(failures) > 1 else ""
    wrapped = SweepError(
        f"{point}{others} could not be computed: {type(error).__name__}: {error}", failures
    )
    wrapped.__cause__ = error
    return wrapped


def workers_allowed() -> int:
    """Return the number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


@contextmanager
def own_workers(count: int) -> Iterator[Executor]:
    """Give a pool of processes, none of which outlives this one or an interrupt."""
    before = set(multiprocessing.active_children())
    # 'spawn' on every system: forking a process that runs compiled threads can hang.
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(count, mp_context=context, initializer=_begin_worker)
    try:
        yield pool
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for child in set(multiprocessing.active_children()) - before:
            child.terminate()
            child.join()
        raise
    pool.shutdown()


def _begin_worker() -> None:
    """Leave interrupts to the parent, and end when it ends, even if it is killed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()

    def follow() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


@functools.cache
def _source_hash() -> str:
    digest = hashlib.sha256()
    for package in SOURCES:
        spec = importlib.util.find_spec(package)
        for folder in sorted(spec.submodule_search_locations or ()) if spec else ():
            for path in sorted(Path(folder).rglob("*.py")):
                digest.update(path.relative_to(folder).as_posix().encode() + b"\0")
                digest.update(path.read_bytes())
    return digest.hexdigest()
