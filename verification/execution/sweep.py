"""The sweep behind all maps: a function, points, any executor, a store, a table.

The table depends on the function and the points only, not on the number of workers, the order in
which they finish, or how often the sweep was killed and resumed. In memory there is one array per
column, filled as the points finish; if a file is given, a finished point is in the store before it
counts.

A point whose computation raises an exception does not stop the others: they are finished and
stored, then `SweepError` names the failed ones. Failed points are not stored, so that a resumed
sweep computes them, and only them, again.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import closing, nullcontext
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import FunctionType
from typing import Any, TypeAlias

import numpy as np

from theory.parameters import ParameterError, check_progress, file_path, need_instance, truth
from theory.result import is_cell, with_infinities
from verification.execution.columns import Cell, Columns, Scalar, cell_of, from_json, to_json
from verification.execution.digest import digest_of
from verification.execution.interruption import terminated_as_interrupted
from verification.execution.metadata import COMMAND_LINE, Metadata
from verification.execution.points import Grid, Point, coordinates, digest_of_points, points_of
from verification.execution.pool import answers
from verification.execution.progress import ProgressCallback
from verification.execution.store import Store
from verification.execution.table import ARRAY_FORMATS, Dims, Table, load_table, named_dims
from verification.execution.task import code_of, parameters_of, task_name

Task: TypeAlias = Callable[[Point], Any]
"""Function that maps a point to its results: a mapping of names to numbers, words or arrays of
numbers; a single such value; or a result with ``to_dict``, of which numbers and words are used. A
value that is None at some points is nan or empty there. With more than one worker the function must
be importable by name (a function in a module, or a frozen dataclass with ``__call__``)."""


class SweepError(RuntimeError):
    """Some points could not be computed; the finished ones are in the store, if there is one.

    Parameters
    ----------
    message : str
        One sentence.
    failures : sequence of (Point, Exception)
        The points and the exceptions raised.
    """

    def __init__(self, message: str, failures: Sequence[tuple[Point, Exception]] = ()) -> None:
        self.failures = tuple(failures)
        super().__init__(message)


def sweep(
    function: Task,
    points: Sequence[Mapping[str, Scalar]] | Mapping[str, Any],
    *,
    out: Path | str | None = None,
    resume: bool = False,
    workers: int | None = None,
    executor: Executor | None = None,
    dims: Mapping[str, str | Sequence[str]] | None = None,
    progress: ProgressCallback | None = None,
    command: str = "",
) -> Table:
    """Compute a function at every point.

    Parameters
    ----------
    function : callable
        See `Task`. Its name, its code and its parameters (those of a dataclass, a
        ``functools.partial``, a closure) are compared with those in a file that is resumed.
    points : sequence of mappings, or mapping
        The points, all with the same names; or names with lists of values, of which every
        combination is taken, the last one varying fastest.
    out : Path or str, optional
        CSV file for the table, or a zarr store or numpy arrays if it ends in ``.zarr`` or ``.npz``.
        Its record is written next to it as ``<out>.json`` and, while the sweep is running, the
        finished points as ``<out>.part``.
    resume : bool, optional
        Continue from ``<out>.part`` if it exists; read the table if that exists already.
    workers : int, optional
        Number of processes, by default one per available core; 1 computes in this process.
    executor : concurrent.futures.Executor, optional
        Used instead of processes of its own, and left open.
    dims : mapping of str to str or sequence of str, optional
        Names of the dimensions of results that are arrays, by result: ``{"profile": "site"}``. By
        default those of ``profile`` are ``profile_0``, ``profile_1`` ….
    progress : callable, optional
        See `verification.execution.progress.ProgressCallback`.
    command : str, optional
        The command that reproduces the table, for its record.

    Returns
    -------
    Table
        One row per point: its coordinates, then its results.

    Raises
    ------
    ParameterError
        If the points, the file to resume from or the number of workers cannot be used; if results
        differ in their names or shapes from point to point, or one has the name of a coordinate but
        another value; or if arrays are to be stored in CSV.
    FileError
        If a file cannot be written, or another sweep is writing it.
    SweepError
        If the function raised an exception, or a worker process died.

    Examples
    --------
    >>> table = sweep(lambda point: {"square": point["x"] ** 2}, {"x": [1, 2]}, workers=1)
    >>> table["square"]
    array([1, 4])

    Arrays, with one shape at all points:

    >>> powers = lambda point: {"powers": point["x"] ** np.arange(3)}
    >>> table = sweep(powers, {"x": [1, 2]}, workers=1, dims={"powers": "order"})
    >>> table.to_xarray()["powers"].sel(x=2, order=1).item(), table["powers"].shape
    (2, (2, 3))
    """
    begin = time.perf_counter()
    if not callable(function):
        need_instance("function", function, (FunctionType,), "give one from a point to its results")
    resume = truth("resume", resume)
    _check_kinds(executor, dims, progress, command)
    asked = points_of(points)
    if out is not None:
        out = file_path("out", out)
    metadata = _metadata(function, asked, command, needed=out is not None)
    if out is not None and resume and not part_path(out).exists():
        finished = _finished(out, metadata, dims or {})
        if finished is not None:
            return finished
    store = None if out is None else Store(part_path(out), _identity(metadata), resume=resume)
    with store or nullcontext(), terminated_as_interrupted() if out else nullcontext():
        found = _Found(points=asked, out=out, names=dims or {})
        resumed = found.take_from(store)
        try:
            failures = _compute(
                _Cells(function),
                found,
                store=store,
                workers=workers,
                executor=executor,
                progress=progress,
            )
        except ParameterError:
            if store is not None and not found.stored:
                store.remove()  # it contains nothing from which to continue
            raise
        if failures:
            raise _failed([(asked[index], failures[index]) for index in sorted(failures)])
        table = Table(
            arrays={**found.coordinates, **found.columns.arrays()},
            metadata=metadata,
            seconds=time.perf_counter() - begin,
            resumed=resumed,
            axes=asked.distinct_axes if isinstance(asked, Grid) and len(asked) else (),
            dims=found.dims,
        )
        if out is not None and store is not None:
            table.save(out)
            store.remove()
    return table


def _check_kinds(executor: object, dims: object, progress: object, command: object) -> None:
    """Refuse options that are objects of the wrong kind."""
    if executor is not None:
        need_instance("executor", executor, (Executor,), "give one, or the number of workers")
    if dims is not None:
        need_instance("dims", dims, (Mapping,), 'give names, as {"profile": "site"}')
    check_progress(progress)
    need_instance("command", command, (str,), "give a text, or leave it out")


def part_path(out: Path) -> Path:
    """Return the path of the file with the finished points of an unfinished sweep.

    Examples
    --------
    >>> part_path(Path("map.csv")).name
    'map.csv.part'
    """
    return out.with_name(out.name + ".part")


def _finished(
    out: Path, metadata: Metadata, dims: Mapping[str, str | Sequence[str]]
) -> Table | None:
    """Return the table of an earlier session, if there is one of the same sweep."""
    table = load_table(out)
    if table is None or table.metadata is None:
        return None
    if digest_of(_identity(table.metadata)) != digest_of(_identity(metadata)):
        return None
    shapes = {name: column.shape[1:] for name, column in table.arrays.items()}
    return replace(table, dims=named_dims(shapes, dims))


@dataclass(kw_only=True)
class _Found:
    """The known part of the table: the coordinates, and the results so far."""

    points: Sequence[Point]
    out: Path | None
    names: Mapping[str, str | Sequence[str]]
    dims: Dims = field(default_factory=dict)
    stored: int = 0

    def __post_init__(self) -> None:
        self.coordinates = coordinates(self.points)
        self.columns = Columns(
            len(self.points),
            flat=self.out is not None and self.out.suffix not in ARRAY_FORMATS,
            folder=None if self.out is None else self.out.parent,
        )

    def put(self, index: int, row: Mapping[str, Cell]) -> None:
        """Store the results of a point; refuse results, even the first, that fit no table."""
        first = not self.columns.shapes
        self.columns.put(index, self._beside_coordinates(index, row))
        if first:
            known = dict.fromkeys(self.coordinates, ()) | self.columns.shapes
            self.dims = named_dims(known, self.names)

    def _beside_coordinates(self, index: int, row: Mapping[str, Cell]) -> Mapping[str, Cell]:
        """Return a row without repeated coordinates; refuse a different value under such a name."""
        repeated = row.keys() & self.coordinates.keys()
        if not repeated:
            return row
        point = self.points[index]
        for name in repeated:
            cell, own = row[name], point[name]
            plain = isinstance(cell, float | int | str)  # comparing arrays costs microseconds
            if not (cell == own if plain else np.array_equal(np.asarray(cell), np.asarray(own))):
                raise ParameterError(
                    f"result {name}", cell, f"{own}, the coordinate of the same name",
                    "rename the result",
                )  # fmt: skip
        return {name: cell for name, cell in row.items() if name not in self.coordinates}

    def take_from(self, store: Store | None) -> int:
        """Copy the results in a store, and return their number; invalid ones are omitted."""
        for key, stored in () if store is None else store.read():
            try:
                index = int(key)
                if not (0 <= index < len(self.points) and key == str(index)):
                    continue
                row = {str(name): from_json(value) for name, value in stored}
            except (ValueError, TypeError, KeyError):
                continue
            self.put(index, row)
            self.stored += 1
        return self.stored


def _compute(
    function: _Cells,
    found: _Found,
    *,
    store: Store | None,
    workers: int | None,
    executor: Executor | None,
    progress: ProgressCallback | None,
) -> dict[int, Exception]:
    """Compute what is still missing; return the exceptions raised, by index of the point."""
    failures: dict[int, Exception] = {}
    total = len(found.points)
    left = np.flatnonzero(~found.columns.filled)
    done = total - left.size
    if progress:
        progress(done / max(total, 1))
    # Closed at once on an interrupt, rather than by the garbage collector: it owns the workers.
    with closing(
        answers(function, found.points, workers=workers, executor=executor, only=left)
    ) as coming:
        for index, answer in coming:
            if isinstance(answer, Exception):
                failures[index] = answer
            else:
                found.put(index, answer)
                if store is not None:
                    store.add(str(index), [(name, to_json(cell)) for name, cell in answer.items()])
                    found.stored += 1
            done += 1
            if progress:
                progress(done / total)
    return failures


@dataclass(frozen=True)
class _Cells:
    """The function, with its results converted to cells of a table."""

    function: Task

    def __str__(self) -> str:
        return task_name(self.function)

    def __call__(self, point: Point) -> dict[str, Cell]:
        result = self.function(point)
        if hasattr(result, "to_dict"):
            entries = with_infinities(result, result.to_dict())
            return {name: value if is_cell(value) else None for name, value in entries.items()}
        if not isinstance(result, Mapping):
            result = {"value": result}
        return {str(name): cell_of(value) for name, value in result.items()}


def _metadata(function: Task, points: Sequence[Point], command: str, needed: bool) -> Metadata:
    """Return what identifies a sweep, and where it was computed."""
    name = task_name(function)
    parameters: dict[str, Any] = {}
    code = None
    try:
        held = parameters_of(function)
        parameters = held if isinstance(held, dict) else {}
        code = code_of(function)
    except ParameterError:
        if needed:
            raise
    parameters |= {
        "function": name,
        "points": {"count": len(points), "digest": digest_of_points(points)},
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


def _failed(failures: Sequence[tuple[Point, Exception]]) -> SweepError:
    point, error = failures[0]
    others = f" and at {len(failures) - 1} more" if len(failures) > 1 else ""
    wrapped = SweepError(
        f"{point}{others} could not be computed: {type(error).__name__}: {error}", failures
    )
    wrapped.__cause__ = error
    return wrapped
