"""A table of results: in memory, as CSV readable by any program, as zarr, as numpy arrays."""

from __future__ import annotations

import csv
import json
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice, product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from theory.parameters import MissingPackageError, ParameterError
from theory.result import Result, optional_package
from verification.execution.columns import Array, Cell, Columns, on_disk, python_rows, read_only
from verification.execution.digest import digest_of_arrays
from verification.execution.files import write_by, write_csv
from verification.execution.metadata import Metadata
from verification.execution.record import Record

if TYPE_CHECKING:
    import xarray as xr

ARRAY_FORMATS = (".zarr", ".npz")
"""Suffixes of files that can hold arrays; a file with any other suffix is CSV."""

CHUNK_BYTES = 1 << 20
"""Size of a chunk of a zarr store before compression; one is held in memory during writing."""

Dims = Mapping[str, tuple[str, ...]]
"""Names of the dimensions of arrays, by column."""


@dataclass(frozen=True, kw_only=True)
class Table(Result):
    """Results of a sweep, one row per point, in the order of the points.

    Attributes
    ----------
    arrays : mapping of str to ndarray
        The columns by name: the coordinates, then the results; all of one length, read-only. In a
        column whose cells are arrays, their dimensions follow the first one.
    metadata : Metadata or None
        Provenance of the table; None if it was assembled by hand.
    seconds : float
        Wall-clock time of the session that finished the table.
    resumed : int
        Number of rows from an earlier session.
    axes : tuple of str
        Coordinates of which the rows are all combinations, the last one varying fastest; empty if
        the rows are not such a grid.
    dims : mapping of str to tuple of str
        Names of the dimensions of one cell, for columns whose cells are arrays.

    Examples
    --------
    >>> labels = np.array(["front", "breather"])
    >>> table = Table(arrays={"c": np.array([1.0, 2.5]), "label": labels})
    >>> table["c"], table.counts("label")
    (array([1. , 2.5]), {'breather': 1, 'front': 1})
    """

    arrays: Mapping[str, Array]
    metadata: Metadata | None = None
    seconds: float = 0.0
    resumed: int = 0
    axes: tuple[str, ...] = ()
    dims: Dims = field(default_factory=dict)

    def __getitem__(self, name: str) -> Array:
        return self.arrays[name]

    def __len__(self) -> int:
        return min((len(column) for column in self.arrays.values()), default=0)

    def columns(self) -> dict[str, Array]:
        """Return the columns, by name.

        Raises
        ------
        ParameterError
            If the cells of a column are arrays, which do not fit into a table of rows and columns.
        """
        for name, column in self.arrays.items():
            if column.ndim > 1:
                raise ParameterError(
                    f"column {name}", f"arrays of shape {column.shape[1:]}",
                    "one number or word for each point in CSV or a data frame",
                    "take to_xarray(), or name a file ending in .zarr or .npz",
                )  # fmt: skip
        return dict(self.arrays)

    def rows(self) -> Iterator[dict[str, Any]]:
        """Yield each row as a mapping from names to Python scalars, and to lists for arrays."""
        for cells in python_rows(self.arrays):
            yield dict(zip(self.arrays, cells, strict=True))

    def counts(self, name: str) -> dict[str, int]:
        """Return how often each word of a column occurs."""
        words, numbers = np.unique(self.arrays[name], return_counts=True)
        return dict(zip(words.tolist(), numbers.tolist(), strict=True))

    def to_xarray(self) -> xr.Dataset:
        """Return the table as an xarray dataset, over its axes if it has any, else over its rows.

        Arrays have further dimensions, named as in ``dims``.

        Raises
        ------
        MissingPackageError
            If xarray is not installed.
        """
        dataset: type[xr.Dataset] = optional_package("xarray").Dataset
        ticks = {name: list(dict.fromkeys(self.arrays[name].tolist())) for name in self.axes}
        over = self.axes or ("row",)
        shape = tuple(len(values) for values in ticks.values()) or (len(self),)
        variables = {
            name: ((*over, *self.dims.get(name, ())), column.reshape(*shape, *column.shape[1:]))
            for name, column in self.arrays.items()
            if name not in ticks
        }
        return dataset(variables, ticks)

    def save(self, path: Path) -> None:
        """Write the table, completely or not at all, and its record next to it in ``<path>.json``.

        The table is a zarr store, written by chunks, if the path ends in ``.zarr``
        (``xarray.open_zarr``); arrays of its columns if it ends in ``.npz`` (``numpy.load``);
        otherwise CSV, whose last lines, beginning with ``#``, state command, parameters and
        versions (``pandas.read_csv(path, comment="#")``). The record contains these as JSON, with
        the date, the machine, the digest of the code, and what `load_table` needs.

        Raises
        ------
        FileError
            If one of the files cannot be written.
        MissingPackageError
            If a package needed for zarr is not installed.
        ParameterError
            If the cells of a column are arrays, and the file is CSV.
        """
        metadata = self.metadata or Metadata()
        about = {
            "columns": {name: column.dtype.kind for name, column in self.arrays.items()},
            "rows": len(self),
            "axes": list(self.axes),
            "dims": {name: list(names) for name, names in self.dims.items()},
            "digest": digest_of_arrays(self.arrays),
            "seconds": self.seconds,
            "resumed": self.resumed,
        }
        Record(kind="table", content={"table": about}, metadata=metadata).save(record_path(path))
        write_by(path, self._writer(path, metadata))

    def _writer(self, path: Path, metadata: Metadata) -> Callable[[Path], object]:
        if path.suffix == ".zarr":
            return zarr_writer(self.to_xarray(), metadata.to_dict())
        if path.suffix == ".npz":
            text = np.array(json.dumps(metadata.to_dict()))
            content: dict[str, Any] = {**self.arrays, "provenance": text}
            return lambda part: np.savez_compressed(part, **content)

        def write(part: Path) -> None:
            columns = self.columns()
            with part.open("w", encoding="utf-8", newline="") as file:
                write_csv(file, columns, python_rows(columns))
                file.write(commented(metadata.to_dict(), ("command", "parameters", "versions")))

        return write


def zarr_writer(data: xr.Dataset, provenance: Mapping[str, Any]) -> Callable[[Path], None]:
    """Return a function that writes a dataset as a zarr store, with its provenance as an attribute.

    Raises
    ------
    MissingPackageError
        If zarr is not installed.
    """
    optional_package("zarr")
    data = data.assign_attrs(provenance=json.dumps(provenance))
    chunks = {
        name: {"chunks": chunk_shape(each.shape, each.dtype.itemsize)}
        for name, each in data.variables.items()
        if each.ndim
    }

    def write(path: Path) -> None:
        path.unlink(missing_ok=True)
        # the zarr standard 3 does not yet support words
        data.to_zarr(path, mode="w-", zarr_format=2, encoding=chunks)

    return write


def chunk_shape(shape: Sequence[int], itemsize: int) -> tuple[int, ...]:
    """Return the shape of chunks of at most `CHUNK_BYTES`, consecutive in an array.

    Examples
    --------
    >>> chunk_shape((14, 20, 100_000), 8)
    (1, 1, 100000)
    >>> chunk_shape((14, 2000, 100), 8)
    (1, 1310, 100)
    """
    room = max(CHUNK_BYTES // itemsize, 1)
    found: list[int] = []
    for size in reversed(shape):
        found.append(max(min(size, room), 1))
        room = max(room // max(size, 1), 1)
    return tuple(reversed(found))


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
    """Read a table written by `Table.save`; None if it is missing or has been altered."""
    try:
        record = Record.load(record_path(path), "table")
        about = record.content["table"]
        table = Table(
            arrays=_read(path, about["columns"], int(about["rows"]), about["axes"]),
            metadata=record.metadata,
            seconds=float(about["seconds"]),
            resumed=int(about["rows"]),
            axes=tuple(about["axes"]),
            dims={name: tuple(names) for name, names in about["dims"].items()},
        )
        return table if about["digest"] == digest_of_arrays(table.arrays) else None
    except (MemoryError, MissingPackageError):
        raise
    except Exception:  # each format and codec raises its own errors for a damaged file
        return None


def _read(
    path: Path, columns: Mapping[str, str], count: int, axes: Sequence[str]
) -> dict[str, Array]:
    """Return the columns in a file."""
    if path.suffix == ".zarr":
        xarray = optional_package("xarray")
        with warnings.catch_warnings(action="ignore"), xarray.open_zarr(path, chunks=None) as data:
            return _columns_of_zarr(data, path.parent, columns, count, axes)
    if path.suffix == ".npz":
        # np.load does not close a file that it opened itself and cannot read.
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            return {name: read_only(file[name]) for name in columns}
    reads: dict[str, Callable[[str], Cell]] = {
        "f": float,
        "i": int,
        "U": lambda word: word or None,
        "b": lambda word: word == "True",
    }
    kinds = {name: reads[kind] for name, kind in columns.items()}
    filled = Columns(count)
    with path.open(encoding="utf-8", newline="") as file:
        next(file)
        for index, row in enumerate(csv.reader(islice(file, count))):
            cells = zip(kinds.items(), row, strict=True)
            filled.put(index, {name: read(cell) for (name, read), cell in cells})
        for line in file:
            if not line.startswith("#"):
                raise ValueError("more rows than were written.")
    return filled.arrays()


def _columns_of_zarr(
    data: xr.Dataset, folder: Path, columns: Iterable[str], count: int, axes: Sequence[str]
) -> dict[str, Array]:
    shape = tuple(data.sizes[name] for name in axes) or (count,)
    found = {}
    for name in columns:
        if data[name].ndim > len(shape):
            found[name] = read_only(_from_chunks(data[name], folder, len(shape)))
            continue
        values = data[name].values
        if name in axes:
            place = [values.size if other == name else 1 for other in axes]
            values = np.broadcast_to(values.reshape(place), shape)
        values = values.reshape(count)
        found[name] = read_only(values.astype(str) if values.dtype.kind == "O" else values)
    return found


def _from_chunks(stored: xr.DataArray, folder: Path, axes: int) -> Array:
    """Return arrays, one per point, copied from a store to a file of their own chunk by chunk."""
    found = on_disk(stored.shape, stored.dtype, folder)
    steps = list(zip(stored.shape, stored.encoding["chunks"], strict=True))
    for corner in product(*(range(0, size, step) for size, step in steps)):
        ends = (begin + step for begin, (_, step) in zip(corner, steps, strict=True))
        chunk = tuple(map(slice, corner, ends))
        found[chunk] = stored[chunk].values
    return found.reshape(-1, *stored.shape[axes:])


def record_path(path: Path) -> Path:
    """Return the path of the record of a table.

    Examples
    --------
    >>> record_path(Path("map.csv")).name
    'map.csv.json'
    """
    return path.with_name(path.name + ".json")


def named_dims(shapes: Mapping[str, tuple[int, ...]], dims: Mapping[str, Any]) -> Dims:
    """Return the dimensions of columns whose cells are arrays.

    Parameters
    ----------
    shapes : mapping of str to tuple of int
        Shape of a cell, by column.
    dims : mapping of str to str or sequence of str
        Names of the dimensions, by column; by default those of ``profile`` are ``profile_0``,
        ``profile_1`` …. Columns that share a name must have the same number of entries along it.

    Raises
    ------
    ParameterError
        If names and dimensions do not match.

    Examples
    --------
    >>> named_dims({"c": (), "profile": (7,), "pair": (2,)}, {"profile": "site"})
    {'profile': ('site',), 'pair': ('pair_0',)}
    """
    found: dict[str, tuple[str, ...]] = {}
    sizes: dict[str, int] = {}
    for name in dims:
        if not shapes.get(name):
            raise ParameterError(
                "dims", name, "of results that are arrays", "leave it out, or correct the name"
            )
    for name, shape in shapes.items():
        if not shape:
            continue
        given = dims.get(name, tuple(f"{name}_{i}" for i in range(len(shape))))
        names = (given,) if isinstance(given, str) else tuple(map(str, given))
        if len(set(names)) != len(shape) or len(names) != len(shape):
            raise ParameterError(
                f"dims of {name}", names, f"{len(shape)} different names", "name each dimension"
            )
        for each, size in zip(names, shape, strict=True):
            if not each.isidentifier() or each in shapes or each == "row":
                raise ParameterError(
                    f"dims of {name}", each, "letters, digits and underscores, and no column",
                    "rename the dimension",
                )  # fmt: skip
            if sizes.setdefault(each, size) != size:
                raise ParameterError(
                    f"dimension {each}", f"{size} and {sizes[each]} entries", "of one length",
                    "give each length a different name",
                )  # fmt: skip
        found[name] = names
    return found
