"""Columns of a table: typed arrays that are filled row by row, in any order.

A cell is a truth value, a number, a word, or an array of numbers whose shape is the same in the
whole column. A column has the narrowest type that holds all its cells, whatever their order: truth
values, integers, or floats. A missing cell is nan among numbers and empty among words; a column in
which every cell is missing is omitted. While being filled, a column of words stores each distinct
word once. Arrays may be kept in a file, so that their size is not bounded by memory.
"""

from __future__ import annotations

import base64
import os
import tempfile
from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

from theory.arrays import AnyArray
from theory.parameters import ParameterError
from verification.execution.files import file_error

Scalar: TypeAlias = bool | int | float | str
"""A coordinate of a point, or a cell of CSV."""
Array: TypeAlias = AnyArray
Cell: TypeAlias = Scalar | Array | None
"""Possible content of a cell; None if it is missing."""

FORBIDDEN = "#\r\n"
"""Characters that CSV readers take for a comment or a new row, even between quotes."""

_TYPES: dict[str, Any] = {"b": np.bool_, "i": np.int64, "f": np.float64, "U": np.int64}
_KINDS = {bool: "b", int: "i", float: "f", str: "U"}


def plain(value: object) -> Scalar:
    """Return a Python scalar for a Python or numpy one.

    Raises
    ------
    TypeError
        If it is not a truth value, a number or a word.
    """
    if isinstance(value, np.generic) or (isinstance(value, np.ndarray) and not value.ndim):
        value = value.item()
    if isinstance(value, str):
        return str(value)
    if isinstance(value, bool | int | float):
        return value
    raise TypeError(f"a cell of a table cannot hold {value!r}: give a number or a word.")


def cell_of(value: object) -> Cell:
    """Return a value as a cell: a scalar as `plain` does, a sequence as an array.

    Raises
    ------
    TypeError
        If it is not a scalar, nor an array of real numbers with at least one entry.

    Examples
    --------
    >>> cell_of(np.float32(0.5)), cell_of((1, 2))
    (0.5, array([1, 2]))
    """
    if type(value) in _KINDS:
        return value  # type: ignore[return-value]
    if not isinstance(value, list | tuple) and not getattr(value, "ndim", 0):
        return plain(value)
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        array = np.array(None)
    kind = "i" if array.dtype.kind == "u" else array.dtype.kind
    if kind not in "bif" or not array.size:
        raise TypeError(
            "a cell of a table cannot hold such a sequence: give an array of real numbers, complex "
            "ones as two arrays."
        )
    if array.max() > np.iinfo(np.int64).max:
        kind = "f"
    return np.array(array, dtype=_TYPES[kind], order="C")


def to_json(cell: Cell) -> Any:
    """Return a cell as JSON data, an array by its bytes.

    Examples
    --------
    >>> from_json(to_json(np.array([0.1, 2.0])))
    array([0.1, 2. ])
    """
    if not isinstance(cell, np.ndarray):
        return cell
    content = base64.b64encode(cell.astype(cell.dtype.newbyteorder("<")).tobytes()).decode()
    return {"kind": cell.dtype.kind, "shape": list(cell.shape), "bytes": content}


def from_json(stored: Any) -> Cell:
    """Return the cell that `to_json` produced.

    Raises
    ------
    TypeError, ValueError, KeyError
        If it was not produced by `to_json`.
    """
    if stored is None:
        return None
    if not isinstance(stored, dict):
        return plain(stored)
    little = np.dtype(_TYPES[stored["kind"]]).newbyteorder("<")
    array = np.frombuffer(base64.b64decode(stored["bytes"]), little).reshape(stored["shape"])
    return cell_of(array)


class Columns:
    """A table with a given number of rows that is being filled.

    Parameters
    ----------
    count : int
        Number of rows.
    flat : bool, optional
        Refuse arrays, which cannot be stored in CSV.
    folder : Path, optional
        Folder for a file that holds the columns of arrays, see `on_disk`; by default they are in
        memory.

    Attributes
    ----------
    filled : bool array, shape (count,)
        Which rows are filled.

    Examples
    --------
    >>> columns = Columns(2)
    >>> columns.put(1, {"c": 2.5, "label": "breather"})
    >>> columns.put(0, {"c": 1, "label": "front"})
    >>> columns.arrays()
    {'c': array([1. , 2.5]), 'label': array(['front', 'breather'], dtype='<U8')}

    A missing cell:

    >>> columns = Columns(2)
    >>> columns.put(0, {"v": None, "period": None})
    >>> columns.put(1, {"v": 3, "period": None})
    >>> columns.arrays()
    {'v': array([nan,  3.])}
    """

    def __init__(self, count: int, *, flat: bool = False, folder: Path | None = None) -> None:
        self.filled = np.zeros(count, dtype=np.bool_)
        self._flat, self._folder = flat, folder
        self._columns: dict[str, _Column] = {}

    @property
    def shapes(self) -> dict[str, tuple[int, ...]]:
        """Shape of one cell of each column; () for a scalar."""
        return {name: column.shape for name, column in self._columns.items()}

    def put(self, index: int, row: Mapping[str, Cell]) -> None:
        """Fill a row.

        Raises
        ------
        ParameterError
            If it does not fit the existing rows, or a name or word would be misread in CSV.
        """
        if not self._columns:
            self._columns = {
                name: _Column(name, self.filled.size, self._flat, self._folder) for name in row
            }
        elif row.keys() != self._columns.keys():
            raise ParameterError(
                "columns of a row", ", ".join(row), f"{', '.join(self._columns)}, as of others",
                "return the same names at every point, with nan for a number that is missing",
            )  # fmt: skip
        for name, column in self._columns.items():
            column.put(index, row[name])
        self.filled[index] = True

    def arrays(self) -> dict[str, Array]:
        """Return the columns by name, read-only, omitting those in which every cell is missing."""
        return {name: each.array() for name, each in self._columns.items() if not each.empty}


def column_of(name: str, cells: Collection[Cell]) -> Array:
    """Return one column, read-only; raises as `Columns.put` does.

    Examples
    --------
    >>> column_of("c", [1, 2.5])
    array([1. , 2.5])
    """
    column = _Column(name, len(cells))
    for index, cell in enumerate(cells):
        column.put(index, cell)
    return column.array()


def on_disk(shape: Sequence[int], kind: npt.DTypeLike, folder: Path) -> Array:
    """Return zeros stored in an unnamed file that exists as long as the array.

    Raises
    ------
    FileError
        If there is not enough space on the disk.

    Examples
    --------
    >>> on_disk((2, 3), float, Path(tempfile.gettempdir()))[1]
    array([0., 0., 0.])
    """
    size = int(np.prod(shape)) * np.dtype(kind).itemsize
    try:
        with tempfile.TemporaryFile(dir=folder) as file:
            # Allocate everything now: a disk that fills up later, in an assignment, would kill the
            # process.
            if hasattr(os, "posix_fallocate"):
                os.posix_fallocate(file.fileno(), 0, size)
            return np.asarray(np.memmap(file, kind, "r+", shape=tuple(shape)))
    except OSError as error:
        raise file_error(folder, error) from None


def read_only(array: Array) -> Array:
    """Return the array, made read-only."""
    array.flags.writeable = False
    return array


def python_rows(arrays: Mapping[str, Array]) -> Iterator[tuple[Any, ...]]:
    """Yield the rows of columns as Python scalars and lists, with few of them in memory at a time.

    Examples
    --------
    >>> list(python_rows({"c": np.array([1.0, 2.5]), "odd": np.array([True, False])}))
    [(1.0, True), (2.5, False)]
    """
    count = min((len(column) for column in arrays.values()), default=0)
    for begin in range(0, count, 1024):
        lists = [column[begin : begin + 1024].tolist() for column in arrays.values()]
        yield from zip(*lists, strict=True)


class _Column:
    """One column that is being filled; words are numbered in order of appearance."""

    def __init__(
        self, name: str, count: int, flat: bool = False, folder: Path | None = None
    ) -> None:
        if not name.isidentifier():
            raise ParameterError(
                "column name", repr(name), "letters, digits and underscores", "rename the result"
            )
        self.name, self.shape = name, tuple[int, ...]()
        self._flat, self._folder = flat, folder
        self._kind = ""  # until there is a cell
        self._values: Array = np.full(count, np.nan)
        self._words: dict[str, int] = {}
        self._missing: list[int] = []

    @property
    def empty(self) -> bool:
        """Whether there is no cell yet."""
        return not self._kind

    def put(self, index: int, cell: Cell) -> None:
        if cell is None:
            self._missing.append(index)
            return
        kind = _kind(cell)
        if self.empty:
            self._begin(cell, kind)
        elif kind != self._kind:
            self._widen(kind)
        if isinstance(cell, str):
            if cell not in self._words:
                self._check(cell)
            self._values[index] = self._words.setdefault(cell, len(self._words))
            return
        if (self.shape or isinstance(cell, np.ndarray)) and np.shape(cell) != self.shape:
            raise ParameterError(
                f"shape of {self.name}", np.shape(cell), f"{self.shape}, as at other points",
                "fill the shorter arrays up, or store what has one shape",
            )  # fmt: skip
        try:
            self._values[index] = cell
        except OverflowError:
            raise ParameterError(
                f"column {self.name}", cell, "a whole number of 64 bits", "give a float"
            ) from None

    def array(self) -> Array:
        if self._missing:
            self._fill()
        if self._kind != "U":
            return read_only(self._values)
        words = np.array(list(self._words), dtype=str)
        return read_only(words[self._values])

    def _fill(self) -> None:
        """Fill missing cells with the value that represents them."""
        if self._kind == "U":
            self._values[self._missing] = self._words.setdefault("", len(self._words))
        elif not self.empty:
            self._widen("f")
            self._values[self._missing] = np.nan
        self._missing = []

    def _begin(self, cell: Cell, kind: str) -> None:
        """Allocate space for cells like the first."""
        self.shape = cell.shape if isinstance(cell, np.ndarray) else ()
        self._kind = kind
        if self.shape and self._flat:
            raise ParameterError(
                f"column {self.name}", f"an array of shape {self.shape}",
                "one number or word for each point where the table is CSV",
                "name a file ending in .zarr or .npz",
            )  # fmt: skip
        self._values = self._zeros((len(self._values), *self.shape), _TYPES[kind])

    def _widen(self, kind: str) -> None:
        if "U" in (kind, self._kind):
            raise ParameterError(
                f"column {self.name}", "numbers and words", "of one kind",
                "return only numbers, or only words",
            )  # fmt: skip
        if self._kind != "f":
            narrow = self._values
            self._kind, self._values = "f", self._zeros(narrow.shape, np.float64)
            self._values[...] = narrow

    def _zeros(self, shape: tuple[int, ...], kind: npt.DTypeLike) -> Array:
        if self._folder is None or not self.shape:
            return np.zeros(shape, dtype=kind)
        return on_disk(shape, kind, self._folder)

    def _check(self, word: str) -> None:
        if not word or word != word.strip() or any(sign in word for sign in FORBIDDEN):
            raise ParameterError(
                f"word in column {self.name}", repr(word),
                "a word that every reader of CSV reads correctly: without #, line ends, or blanks "
                "at its ends",
                "replace them",
            )  # fmt: skip


def _kind(cell: Cell) -> str:
    return cell.dtype.kind if isinstance(cell, np.ndarray) else _KINDS[type(cell)]
