"""A table of results with named columns: in memory, as CSV that every reader opens, and as zarr."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
import numpy.typing as npt

from theory.result import Result, optional_package
from verification.execution.digest import digest_of
from verification.execution.files import write_by, write_text
from verification.execution.metadata import Metadata
from verification.execution.record import Record

if TYPE_CHECKING:
    import xarray as xr

Scalar: TypeAlias = bool | int | float | str
"""What a cell of a table may hold."""

FORBIDDEN = ',"#\r\n'
"""Characters that some reader of CSV would take for something else."""


class Point(Mapping[str, Scalar]):
    """A frozen, hashable, picklable mapping of names to numbers (or words).

    Examples
    --------
    >>> point = Point(eta=0.03, c=0.6)
    >>> point["c"], dict(point), point == Point(eta=0.03, c=0.6)
    (0.6, {'eta': 0.03, 'c': 0.6}, True)
    """

    __slots__ = ("_items",)

    def __init__(self, items: Mapping[str, Scalar] | None = None, /, **values: Scalar) -> None:
        merged = {**(items or {}), **values}
        self._items = {name: plain(value) for name, value in merged.items()}

    def __getitem__(self, name: str) -> Scalar:
        return self._items[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._items)

    def __len__(self) -> int:
        return len(self._items)

    def __hash__(self) -> int:
        return hash(tuple(self._items.items()))

    def __reduce__(self) -> tuple[type[Point], tuple[dict[str, Scalar]]]:
        return Point, (dict(self._items),)

    def __repr__(self) -> str:
        return f"Point({', '.join(f'{name}={value!r}' for name, value in self._items.items())})"

    def number(self, name: str) -> float:
        """Return a coordinate as a float."""
        return float(self._items[name])


def plain(value: object) -> Scalar:
    """Return a Python scalar for a Python or numpy one.

    Raises
    ------
    TypeError
        If it is neither a truth value, a number nor a word.
    """
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, str):
        return str(value)
    if isinstance(value, bool | int | float):
        return value
    raise TypeError(f"a cell of a table cannot hold {value!r}: give a number or a word.")


def grid(**axes: Iterable[Scalar]) -> tuple[Point, ...]:
    """Return every combination of some coordinates, the last one fastest.

    Examples
    --------
    >>> grid(eta=[0.1, 0.2], c=[1, 2])[1]
    Point(eta=0.1, c=2)
    """
    points = [Point()]
    for name, values in axes.items():
        axis = list(values)
        points = [Point(point, **{name: value}) for point in points for value in axis]
    return tuple(points)


@dataclass(frozen=True, kw_only=True)
class Table(Result):
    """Results of a sweep, one row a point, in the order of the points.

    Attributes
    ----------
    arrays : mapping of str to ndarray
        The columns by name: the coordinates, then the results; all of one length, read-only.
    metadata : Metadata or None
        Where the table comes from; None if it was put together by hand.
    seconds : float
        Wall time of the session that finished the table.
    resumed : int
        Rows that came from an earlier session.
    axes : tuple of str
        Coordinates of which the rows are every combination, the last one fastest; empty if they are
        none.

    Examples
    --------
    >>> table = table_of([{"c": 1, "label": "front"}, {"c": 2.5, "label": "breather"}])
    >>> table["c"], table.counts("label")
    (array([1. , 2.5]), {'breather': 1, 'front': 1})
    """

    arrays: Mapping[str, npt.NDArray[Any]]
    metadata: Metadata | None = None
    seconds: float = 0.0
    resumed: int = 0
    axes: tuple[str, ...] = ()

    def __getitem__(self, name: str) -> npt.NDArray[Any]:
        return self.arrays[name]

    def __len__(self) -> int:
        return min((len(column) for column in self.arrays.values()), default=0)

    def columns(self) -> dict[str, npt.NDArray[Any]]:
        """Return the columns, by name."""
        return dict(self.arrays)

    def rows(self) -> Iterator[dict[str, Scalar]]:
        """Yield each row by name, as Python scalars."""
        lists = [column.tolist() for column in self.arrays.values()]
        for cells in zip(*lists, strict=True):
            yield dict(zip(self.arrays, cells, strict=True))

    def counts(self, name: str) -> dict[str, int]:
        """Return how often each word of a column occurs."""
        words, numbers = np.unique(self.arrays[name], return_counts=True)
        return dict(zip(words.tolist(), numbers.tolist(), strict=True))

    def to_xarray(self) -> xr.Dataset:
        """Return the table as a dataset of xarray, over its axes if it has them, else its rows.

        Raises
        ------
        MissingPackageError
            If xarray is not installed.
        """
        dataset: type[xr.Dataset] = optional_package("xarray").Dataset
        if not self.axes:
            return dataset({name: ("row", each) for name, each in self.arrays.items()})
        ticks = {name: list(dict.fromkeys(self.arrays[name].tolist())) for name in self.axes}
        shape = tuple(len(values) for values in ticks.values())
        over = {
            name: (self.axes, column.reshape(shape))
            for name, column in self.arrays.items()
            if name not in ticks
        }
        return dataset(over, ticks)

    def as_csv(self) -> str:
        r"""Return the table as CSV; floats have the digits that give back the same float.

        Examples
        --------
        >>> table_of([{"c": 0.1, "label": "fixed point"}]).as_csv()
        'c,label\n0.1,fixed point\n'
        """
        lines = [",".join(self.arrays)]
        lines += [",".join(str(cell) for cell in row.values()) for row in self.rows()]
        return "\n".join(lines) + "\n"

    def save(self, path: Path) -> None:
        """Write the table, whole or not at all, and its record beside it in ``<path>.json``.

        It is a zarr store, written by chunks, where the path ends in ``.zarr``
        (``xarray.open_zarr``); else CSV, of which lines at the end that begin with ``#`` say
        command, parameters and versions (``pandas.read_csv(path, comment="#")``). The record has
        them as JSON, with the date, the machine, the digest of the code, and what `load_table`
        needs.

        Raises
        ------
        FileError
            If they cannot be written.
        MissingPackageError
            If a package for zarr is not installed.
        """
        metadata = self.metadata or Metadata()
        text = _written(self, metadata)
        about = {
            "columns": {name: column.dtype.kind for name, column in self.arrays.items()},
            "axes": list(self.axes),
            "digest": digest_of(text),
            "seconds": self.seconds,
            "resumed": self.resumed,
        }
        Record(kind="table", content={"table": about}, metadata=metadata).save(record_path(path))
        if path.suffix == ".zarr":
            write_by(path, zarr_writer(self.to_xarray(), metadata.to_dict()))
        else:
            write_text(path, text)


def zarr_writer(data: xr.Dataset, provenance: Mapping[str, Any]) -> Callable[[Path], None]:
    """Return what writes a dataset as a zarr store, with where it comes from as an attribute.

    Raises
    ------
    MissingPackageError
        If zarr is not installed.
    """
    optional_package("zarr")
    data = data.assign_attrs(provenance=json.dumps(provenance))

    def write(path: Path) -> None:
        path.unlink(missing_ok=True)
        data.to_zarr(path, mode="w-", zarr_format=2)  # words are not yet in the standard of 3

    return write


def commented(entries: Mapping[str, Any], names: Iterable[str]) -> str:
    r"""Return entries as lines ``# name: value`` for the end of a CSV file.

    Examples
    --------
    >>> commented({"command": "fronts map", "parameters": {"c": 0.5}}, ["parameters"])
    '# parameters: {"c": 0.5}\n'
    """
    values = {name: entries[name] for name in names}
    return "".join(
        f"# {name}: {value if isinstance(value, str) else json.dumps(value)}\n"
        for name, value in values.items()
    )


def load_table(path: Path) -> Table | None:
    """Read a table that `Table.save` wrote; None if it is missing or no longer what was written."""
    try:
        record = Record.load(record_path(path), "table")
        about = record.content["table"]
        if path.suffix == ".zarr":
            rows = _rows_of_zarr(path, about["columns"])
        else:
            text = path.read_bytes().decode()
            rows = _rows_of_csv(text, about["columns"])
        axes = tuple(about.get("axes", ()))
        table = table_of(rows, record.metadata, float(about["seconds"]), len(rows), axes)
        if path.suffix == ".zarr":
            text = _written(table, record.metadata)
        return table if about["digest"] == digest_of(text) else None
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return None


def _written(table: Table, metadata: Metadata) -> str:
    """Return the CSV of a table with where it comes from; its digest is that of the table."""
    said = ("command", "parameters", "versions")
    return table.as_csv() + commented(metadata.to_dict(), said)


def _rows_of_csv(text: str, columns: Mapping[str, str]) -> list[dict[str, Scalar]]:
    reads: dict[str, Callable[[str], Scalar]] = {
        "f": float,
        "i": int,
        "U": str,
        "b": lambda word: word == "True",
    }
    kinds = [reads[kind] for kind in columns.values()]
    lines = [line.split(",") for line in text.splitlines()[1:] if not line.startswith("#")]
    rows = [[read(cell) for read, cell in zip(kinds, line, strict=True)] for line in lines]
    return [dict(zip(columns, row, strict=True)) for row in rows]


def _rows_of_zarr(path: Path, columns: Iterable[str]) -> list[dict[str, Scalar]]:
    xarray = optional_package("xarray")
    with xarray.open_zarr(path) as data:
        lists = [each.values.ravel().tolist() for each in xarray.broadcast(*map(data.get, columns))]
    return [dict(zip(columns, row, strict=True)) for row in zip(*lists, strict=True)]


def record_path(path: Path) -> Path:
    """Return where the record of a table is written.

    Examples
    --------
    >>> record_path(Path("map.csv")).name
    'map.csv.json'
    """
    return path.with_name(path.name + ".json")


def table_of(
    rows: Sequence[Mapping[str, Scalar]],
    metadata: Metadata | None = None,
    seconds: float = 0.0,
    resumed: int = 0,
    axes: tuple[str, ...] = (),
) -> Table:
    """Put rows of the same names into a table.

    Raises
    ------
    ValueError
        If rows differ in their names, or a name or word would be misread in CSV.
    """
    names = list(rows[0]) if rows else []
    for row in rows:
        if list(row) != names:
            raise ValueError(f"a row has the columns {list(row)} and another one {names}.")
    columns = {}
    for name in names:
        if not name.isidentifier():
            raise ValueError(f"the column name {name!r} must be letters, digits and underscores.")
        column = _column(name, [row[name] for row in rows])
        column.flags.writeable = False
        columns[name] = column
    return Table(arrays=columns, metadata=metadata, seconds=seconds, resumed=resumed, axes=axes)


def _column(name: str, cells: list[Scalar]) -> npt.NDArray[Any]:
    words = [cell for cell in cells if isinstance(cell, str)]
    if words:
        for word in words:
            if not word or word != word.strip() or any(sign in word for sign in FORBIDDEN):
                raise ValueError(f"the word {word!r} in column {name} would be misread in CSV.")
        if len(words) < len(cells):
            raise ValueError(f"the column {name} has numbers beside words.")
        return np.array(cells, dtype=str)
    if all(isinstance(cell, bool) for cell in cells):
        return np.array(cells, dtype=np.bool_)
    if all(isinstance(cell, int) and not isinstance(cell, bool) for cell in cells):
        return np.array(cells, dtype=np.int64)
    return np.array([float(cell) for cell in cells])
