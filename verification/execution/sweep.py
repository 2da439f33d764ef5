"""One sweep engine for every map: a function, points, any executor, a store, a table.

The table depends on the function and the points only: not on the number of workers, the order in
which they finish, or how often the sweep was killed and resumed.

A point whose computation raises does not stop the others: they are finished and put into the store,
then `SweepError` names the failed ones. These are not in the store, so that a resumed sweep tries
them, and only them, again.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import closing, nullcontext
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from theory.parameters import ParameterError
from verification.execution.digest import code_of_objects, digest_of, digest_of_arrays
from verification.execution.interruption import terminated_as_interrupted
from verification.execution.metadata import COMMAND_LINE, Code, Metadata
from verification.execution.pool import answers
from verification.execution.progress import ProgressCallback
from verification.execution.store import Store
from verification.execution.table import Point, Scalar, Table, grid, load_table, plain, table_of

Task: TypeAlias = Callable[[Point], Any]
"""From a point to its results: a mapping of names to numbers or words, one such value, or a result
with ``to_dict``. Importable by name (a function of a module, or a frozen dataclass with
``__call__``) where there is more than one worker."""


class SweepError(RuntimeError):
    """Points that could not be computed; the finished ones are in the store, if there is one.

    Parameters
    ----------
    message : str
        One sentence.
    failures : sequence of (Point, Exception)
        The points and what was raised.
    """

    def __init__(self, message: str, failures: Sequence[tuple[Point, Exception]] = ()) -> None:
        self.failures = tuple(failures)
        super().__init__(message)


def sweep(
    function: Task,
    points: Sequence[Mapping[str, Scalar]] | Mapping[str, Any],
    *,
    out: Path | None = None,
    resume: bool = False,
    workers: int | None = None,
    executor: Executor | None = None,
    progress: ProgressCallback | None = None,
    command: str = "",
) -> Table:
    """Compute a function at every point.

    Parameters
    ----------
    function : callable
        See `Task`. Its name, its code and its parameters (of a dataclass, a ``functools.partial``,
        a closure) are held against a file that is resumed.
    points : sequence of mappings, or mapping
        Where: all with the same names; or names with values, of which every combination is taken,
        the last one fastest.
    out : Path, optional
        CSV file for the table, or a zarr store if it ends in ``.zarr``; its record goes beside it
        into ``<out>.json``, and while the sweep runs the finished points into ``<out>.part``.
    resume : bool, optional
        Go on from ``<out>.part``, if it is there; take the table if that is there already.
    workers : int, optional
        Processes, by default one a core that may be used; 1 computes in this process.
    executor : concurrent.futures.Executor, optional
        Used in place of own processes, and left open.
    progress : callable, optional
        See `verification.execution.progress.ProgressCallback`.
    command : str, optional
        What gives the table again, for its record.

    Returns
    -------
    Table
        One row a point: its coordinates, then its results.

    Raises
    ------
    ParameterError
        If the points, the file to resume from or the number of workers cannot be used.
    FileError
        If a file cannot be written, or another sweep writes it.
    SweepError
        If the function raised, or a worker process died.

    Examples
    --------
    >>> table = sweep(lambda point: {"square": point["x"] ** 2}, {"x": [1, 2]}, workers=1)
    >>> table["square"]
    array([1, 4])
    """
    begin = time.perf_counter()
    asked = points_of(points)
    out = None if out is None else Path(out)
    metadata = _metadata(function, asked, command, needed=out is not None)
    if out is not None and resume and not part_path(out).exists():
        table = load_table(out)
        known = None if table is None else table.metadata
        if table is not None and known is not None and _identity(known) == _identity(metadata):
            return table
    store = None if out is None else Store(part_path(out), _identity(metadata), resume=resume)
    with store or nullcontext(), terminated_as_interrupted() if out else nullcontext():
        found = {} if store is None else _found(store, len(asked))
        resumed = len(found)
        failures = _compute(
            function,
            asked,
            found=found,
            store=store,
            workers=workers,
            executor=executor,
            progress=progress,
        )
        if failures:
            raise _failed([(asked[index], failures[index]) for index in sorted(failures)])
        rows = [{**point, **found[index]} for index, point in enumerate(asked)]
        axes = (
            tuple(points) if isinstance(points, Mapping) and not isinstance(points, Point) else ()
        )
        table = table_of(rows, metadata, time.perf_counter() - begin, resumed, axes)
        if out is not None and store is not None:
            table.save(out)
            store.remove()
    return table


def part_path(out: Path) -> Path:
    """Return where the finished points of an unfinished sweep are.

    Examples
    --------
    >>> part_path(Path("map.csv")).name
    'map.csv.part'
    """
    return out.with_name(out.name + ".part")


def points_of(points: Sequence[Mapping[str, Scalar]] | Mapping[str, Any]) -> tuple[Point, ...]:
    """Return points, given one by one or as the values on each axis.

    Raises
    ------
    ParameterError
        If they differ in their names.
    """
    if isinstance(points, Mapping) and not isinstance(points, Point):
        axes = {name: np.atleast_1d(np.asarray(values)).tolist() for name, values in points.items()}
        found = grid(**axes) if axes else ()
    else:
        given: Any = (points,) if isinstance(points, Point) else points
        found = tuple(point if isinstance(point, Point) else Point(point) for point in given)
    for point in found:
        if list(point) != list(found[0]):
            raise ParameterError(
                "points", f"{point} beside {found[0]}", "all of the same names", "name them alike"
            )
    return found


def _compute(
    function: Task,
    points: Sequence[Point],
    *,
    found: dict[int, dict[str, Scalar]],
    store: Store | None,
    workers: int | None,
    executor: Executor | None,
    progress: ProgressCallback | None,
) -> dict[int, Exception]:
    """Fill ``found`` by index of the point; return what was raised, likewise."""
    failures: dict[int, Exception] = {}
    left = [index for index in range(len(points)) if index not in found]
    if progress:
        progress(len(found) / max(len(points), 1))
    # Closed at once on an interrupt, and not when the collector finds it: it owns the workers.
    with closing(
        answers(
            _PlainResult(function),
            [points[index] for index in left],
            workers=workers,
            executor=executor,
        )
    ) as coming:
        for number, answer in coming:
            index = left[number]
            if isinstance(answer, Exception):
                failures[index] = answer
                continue
            if store is not None:
                store.add(str(index), list(answer.items()))
            found[index] = answer
            if progress:
                progress((len(found) + len(failures)) / len(points))
    return failures


@dataclass(frozen=True)
class _PlainResult:
    """The function, with its results as cells of a table."""

    function: Task

    def __str__(self) -> str:
        return task_name(self.function)

    def __call__(self, point: Point) -> dict[str, Scalar]:
        result = self.function(point)
        if hasattr(result, "to_dict"):
            result = {
                name: value
                for name, value in result.to_dict().items()
                if isinstance(value, bool | int | float | str)
            }
        elif not isinstance(result, Mapping):
            result = {"value": result}
        return {str(name): plain(value) for name, value in result.items()}


def _found(store: Store, total: int) -> dict[int, dict[str, Scalar]]:
    """Return the results in a store by index of the point; what is none is left out."""
    found: dict[int, dict[str, Scalar]] = {}
    for key, row in store.results.items():
        try:
            index = int(key)
            if 0 <= index < total and key == str(index):
                found[index] = {str(name): plain(value) for name, value in row}
        except (ValueError, TypeError):
            continue
    return found


def _metadata(function: Task, points: Sequence[Point], command: str, needed: bool) -> Metadata:
    """Return what identifies a sweep, and where it was computed."""
    name = task_name(function)
    parameters: dict[str, Any] = {}
    code = None
    try:
        held = parameters_of(function)
        parameters = held if isinstance(held, dict) else {}
        modules, digest = code_of_objects(_owners(function))
        code = Code(modules=modules, digest=digest)
    except ParameterError:
        if needed:
            raise
    rows = [list(point.items()) for point in points]
    parameters |= {
        "function": name,
        "points": {"count": len(points), "digest": digest_of(rows)},
    }
    return Metadata(
        command=command or COMMAND_LINE.get() or f"sweep({name}, ...)",
        parameters=parameters,
        code=code,
    )


def _identity(metadata: Metadata) -> dict[str, Any]:
    return {
        "parameters": dict(metadata.parameters),
        "versions": dict(metadata.versions),
        "code": None if metadata.code is None else metadata.code.digest,
    }


def task_name(task: object) -> str:
    """Return the importable name of a function or class.

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
    """Return the parameters of a function or object as JSON has them.

    Raises
    ------
    ParameterError
        If it holds something that JSON does not have.
    """
    if isinstance(task, functools.partial):
        named = {str(i): value for i, value in enumerate(task.args)} | task.keywords
        return {name: parameters_of(value) for name, value in named.items()}
    if dataclasses.is_dataclass(task) and not isinstance(task, type):
        fields = {f.name: parameters_of(getattr(task, f.name)) for f in dataclasses.fields(task)}
        return {"is": task_name(task), **fields}
    if isinstance(task, Enum):
        return task.value
    if isinstance(task, np.ndarray):
        return {"array": digest_of_arrays({"": task})}
    if isinstance(task, Mapping):
        return {str(name): parameters_of(value) for name, value in task.items()}
    if isinstance(task, tuple | list):
        return [parameters_of(value) for value in task]
    if callable(task):
        inner = _captured(task)
        return {"is": task_name(task), **parameters_of(inner)} if inner else task_name(task)
    if isinstance(task, complex):
        return [task.real, task.imag]
    try:
        return task if task is None else plain(task)
    except TypeError:
        raise ParameterError(
            "function", f"one that holds a {type(task).__name__}",
            "one that holds numbers, words and their collections where its results are stored",
            "give its parameters as fields of a frozen dataclass",
        ) from None  # fmt: skip


def _captured(task: object) -> dict[str, Any]:
    """Return the default arguments and the captured variables of a function."""
    code = getattr(task, "__code__", None)
    if code is None:
        return {}
    cells = zip(code.co_freevars, getattr(task, "__closure__", None) or (), strict=False)
    defaults = {f"default {i}": v for i, v in enumerate(getattr(task, "__defaults__", None) or ())}
    return defaults | (getattr(task, "__kwdefaults__", None) or {}) | {
        name: cell.cell_contents for name, cell in cells
    }  # fmt: skip


def _owners(task: object) -> Iterator[Any]:
    """Yield whatever has code: functions, and classes of objects."""
    if isinstance(task, functools.partial):
        yield from _owners(task.func)
        for value in (*task.args, *task.keywords.values()):
            yield from _owners(value)
    elif dataclasses.is_dataclass(task) and not isinstance(task, type):
        yield type(task)
        for each in dataclasses.fields(task):
            yield from _owners(getattr(task, each.name))
    elif isinstance(task, tuple | list):
        yield from itertools.chain.from_iterable(map(_owners, task))
    elif isinstance(task, Mapping):
        yield from itertools.chain.from_iterable(map(_owners, task.values()))
    elif callable(task):
        yield task
        for value in _captured(task).values():
            yield from _owners(value)


def _failed(failures: Sequence[tuple[Point, Exception]]) -> SweepError:
    point, error = failures[0]
    others = f" and {len(failures) - 1} other points" if len(failures) > 1 else ""
    wrapped = SweepError(
        f"{point}{others} could not be computed: {type(error).__name__}: {error}", failures
    )
    wrapped.__cause__ = error
    return wrapped
