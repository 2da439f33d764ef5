"""The numbers behind a picture as CSV: one table, with several curves below each other."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from verification.execution.files import write_csv

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Column = ArrayLike | Sequence[float | None]


class Curves(dict[str, "Mapping[str, Column]"]):
    """The curves of a picture by name, recorded as they are drawn, for `long_table`."""

    def add(self, name: str, **columns: Column) -> tuple[Any, Any]:
        """Record the columns of one curve and return the first two, to be drawn.

        Raises
        ------
        ValueError
            If there is already a curve of that name.

        Examples
        --------
        >>> from verification.pictures.figures import new_axes
        >>> curves, (_, axes) = Curves(), new_axes()
        >>> line = axes.plot(*curves.add("chain", c=[1, 2], v=[0.5, 0.7]), "o", label="runs")
        >>> columns_as_csv(long_table(curves)).split()
        ['series,c,v', 'chain,1,0.5', 'chain,2,0.7']
        """
        if name in self:
            raise ValueError(f"there is a curve '{name}': choose another name for this one.")
        self[name] = columns
        x, y, *_ = columns.values()
        return x, y


def long_table(
    series: Mapping[str, Mapping[str, Column]],
) -> dict[str, NDArray[np.object_]]:
    r"""Put curves below each other: a column ``series`` with their names, then their columns.

    Parameters
    ----------
    series : mapping of str to mapping
        The columns of each curve, by its name. A single number or text applies to the whole curve.
        If a curve lacks a column that another one has, the cells are empty.

    Raises
    ------
    ValueError
        If the columns of one curve differ in length.

    Examples
    --------
    >>> table = long_table({"chain": {"c": [1, 2], "v": [0.5, 0.7]}, "paper": {"c": 3}})
    >>> columns_as_csv(table)
    'series,c,v\nchain,1,0.5\nchain,2,0.7\npaper,3,\n'
    """
    names = list(dict.fromkeys(name for columns in series.values() for name in columns))
    table: dict[str, list[object]] = {name: [] for name in ("series", *names)}
    for title, columns in series.items():
        arrays = {name: _plain(name, values) for name, values in columns.items()}
        lengths = {array.size for array in arrays.values() if array.ndim}
        if len(lengths) > 1:
            raise ValueError(f"the columns of '{title}' have {lengths} rows: give them one length.")
        rows = lengths.pop() if lengths else 1
        table["series"] += [title] * rows
        for name in names:
            array = arrays.get(name)
            if array is None:
                table[name] += [None] * rows
            else:
                table[name] += array.tolist() if array.ndim else [array.item()] * rows
    return {name: np.array(column, dtype=object) for name, column in table.items()}


def columns_as_csv(data: Mapping[str, Column]) -> str:
    r"""Write named columns as CSV, by the rule of `write_csv`.

    Raises
    ------
    ValueError
        If a column is complex or not one-dimensional, or two differ in length.

    Examples
    --------
    >>> columns_as_csv({"n": [1, 2], "v": [0.1, None]})
    'n,v\n1,0.1\n2,\n'
    """
    columns: dict[str, list[object]] = {}
    for name, values in data.items():
        columns[name] = np.atleast_1d(_plain(name, values)).tolist()
    lengths = {name: len(column) for name, column in columns.items()}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"the columns have {lengths} rows: put them below each other.")
    text = io.StringIO()
    write_csv(text, data, zip(*columns.values(), strict=True))
    return text.getvalue()


def _plain(name: str, values: Column) -> NDArray[Any]:
    """Return numbers or texts as an array of at most one dimension."""
    column = np.asarray(values)
    if column.ndim > 1:
        raise ValueError(f"the column '{name}' has {column.ndim} dimensions: give it one.")
    if np.iscomplexobj(column):
        raise ValueError(
            f"the column '{name}' is complex: give real and imaginary parts as two columns."
        )
    return column
