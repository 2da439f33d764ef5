"""The base of all results, which can be converted to JSON and tables, drawn, and displayed.

How to write a new result
-------------------------
1. Derive from `Result` and decorate with ``@dataclass(frozen=True, kw_only=True)``. Name the class
   after the quantity (`Front`, `Trajectory`). Its fields are the value or values, ``error``,
   ``status`` (an enum whose members carry a ``sentence``), ``method``, counts, and ``seconds``. A
   value that does not exist is ``None``, never NaN.
2. The metadata of a field describe its role where that does not follow from its type. All entries
   are optional.

   ``json``
       ``None`` excludes the field from `Result.to_dict`, where its key would be its name.
   ``dims``
       Names of the dimensions of an array, such as ``("t", "site")``. Fields with dimensions make
       the result tabular: `Result.to_pandas` has one row for each index of the first dimension,
       and `Result.to_xarray` has all dimensions.
   ``axis``
       Name of the dimension for which this one-dimensional array is the coordinate.

3. Properties that belong in the JSON object too are named in the class variable ``derived``.
4. A picture is drawn by a function in `fronts.pictures`, registered there under the name of the
   class; nothing in this module imports a plotting library.
5. Where dimensions do not suffice (rows of different kinds), override `Result.columns`.
6. If the rows are the points of a curve, set ``is_curve = True``.
7. Two results are equal if all their fields except ``seconds`` are equal, arrays included; fields
   with ``compare=False`` are ignored.

Examples
--------
>>> from dataclasses import dataclass, field
>>> import numpy as np
>>> @dataclass(frozen=True, kw_only=True)
... class Decay(Result):
...     rate: float
...     error: float
...     times: np.ndarray = field(metadata={"axis": "t"})
...     values: np.ndarray = field(metadata={"dims": ("t",)})
>>> found = Decay(rate=0.5, error=1e-9, times=np.array([0.0, 1.0]), values=np.array([1.0, 0.6]))
>>> found
Decay(rate=0.5, error=1e-09, times=<2 floats>, values=<2 floats>)
>>> found.to_dict()
{'rate': 0.5, 'error': 1e-09, 'times': [0.0, 1.0], 'values': [1.0, 0.6]}
>>> list(found.columns())
['times', 'values']
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import Field, fields, is_dataclass
from enum import Enum
from importlib import import_module
from pathlib import PurePath
from typing import TYPE_CHECKING, Any, ClassVar

from theory.parameters import MissingPackageError

if TYPE_CHECKING:
    import numpy as np
    import pandas as pd
    import xarray as xr
    from matplotlib.axes import Axes

PICTURES = "fronts.pictures"
"""Module with ``draw(result, axes, **style)``; given by name, as ``theory`` cannot import it."""

NOTEBOOK = "fronts.notebook"
"""Module with ``as_html(result)``, given by name for the same reason."""

_LONGEST = 60
"""Largest number of characters of one value in a repr."""


class Result:
    """Base class of all results of the toolkit; the module describes how to write one."""

    __slots__ = ()

    derived: ClassVar[tuple[str, ...]] = ()
    """Properties that `to_dict` lists after the fields."""

    in_columns: ClassVar[tuple[str, ...]] = ()
    """Entries of `to_dict` that `columns` contains under other names."""

    is_curve: ClassVar[bool] = False
    """Whether the rows of `columns` are points of a curve, which terminal and notebook list."""

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        # Otherwise the dataclass would generate its own methods: a repr with every number of every
        # array, and a comparison that fails for arrays.
        for name in ("__repr__", "__eq__", "__hash__"):
            if name not in cls.__dict__:
                type.__setattr__(cls, name, getattr(Result, name))

    def __eq__(self, other: object) -> bool:
        """Return whether all fields except the run time are equal, arrays element by element."""
        if type(other) is not type(self):
            return NotImplemented
        return all(_same(getattr(self, name), getattr(other, name)) for name in _compared(self))

    def __hash__(self) -> int:
        """Return a hash of the text fields, which are the same in equal results."""
        values = (getattr(self, name) for name in _compared(self))
        return hash((type(self), *(each for each in values if isinstance(each, str))))

    @property
    def units(self) -> Mapping[str, str]:
        """Units of the entries of `to_dict` that have one; a terminal shows them."""
        return {}

    def to_dict(self) -> dict[str, Any]:
        """Return the result as a JSON object: numbers, strings, lists, dictionaries, ``None``.

        Returns
        -------
        dict
            Arrays become lists, complex numbers pairs ``{"re": …, "im": …}``, enums their values;
            numbers that are not finite become ``None``.

        Raises
        ------
        TypeError
            If a field has a value that JSON cannot represent.
        """
        listed = [each.name for each in _fields(self) if "json" not in each.metadata]
        return {name: json_value(getattr(self, name)) for name in (*listed, *self.derived)}

    def row(self) -> dict[str, Any]:
        """Return the entries of `to_dict` as cells of one row of a table.

        Returns
        -------
        dict
            The entries of a result that is part of this one are included, with its name as a
            prefix. Lists and mappings remain unchanged. Infinite numbers, which JSON does not have,
            are infinite, as errors without a bound are.
        """
        parts = self.parts()
        cells: dict[str, Any] = {}
        for name, value in with_infinities(self, self.to_dict()).items():
            if name in parts:
                part = with_infinities(parts[name], value)
                cells |= {f"{name}_{key}": each for key, each in part.items()}
            else:
                cells[name] = value
        return cells

    def rows(self) -> Iterable[Mapping[str, Any]]:
        """Return the rows of this result as part of a curve: one, unless it contains several."""
        return [self.row()]

    def parts(self) -> dict[str, Result]:
        """Return those fields that are results themselves, by name."""
        held = ((each.name, getattr(self, each.name)) for each in _fields(self))
        return {name: part for name, part in held if isinstance(part, Result)}

    def plot(self, axes: Axes | None = None, **style: Any) -> Axes:
        """Draw the result with Matplotlib.

        Parameters
        ----------
        axes : matplotlib.axes.Axes, optional
            Axes in which to draw; by default new ones.
        **style
            Options passed on to Matplotlib, such as ``color="k"``.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        TypeError
            If results of this class cannot be drawn.
        """
        drawn: Axes = import_module(PICTURES).draw(self, axes, **style)
        return drawn

    def columns(self) -> dict[str, np.ndarray]:
        """Return the result as a table: columns that are one-dimensional arrays of equal length.

        Returns
        -------
        dict of str to ndarray
            There is one row for each index of the leading dimension. A field with a second
            dimension gives one column for each of its indices, named after the coordinate, or
            numbered from 1.

        Raises
        ------
        TypeError
            If the result is not tabular.
        """
        dims = _dimensions(self)
        leading = next(iter(dims.values()))[0]
        table: dict[str, np.ndarray] = {}
        for name, over in dims.items():
            values = getattr(self, name)
            if over == (leading,):
                table[name] = values
            elif len(over) == 2 and over[0] == leading:
                labels = _coordinate(self, over[1])
                count = values.shape[1]
                names = range(1, count + 1) if labels is None else [f"{x:.12g}" for x in labels]
                table |= {f"{name}_{label}": values[:, i] for i, label in enumerate(names)}
        return table

    def to_pandas(self) -> pd.DataFrame:
        """Return the result as a pandas data frame, with the columns of `columns`.

        Returns
        -------
        pandas.DataFrame

        Raises
        ------
        TypeError
            If the result is not tabular.
        MissingPackageError
            If pandas is not installed.
        """
        columns = self.columns()
        frame: pd.DataFrame = optional_package("pandas").DataFrame(columns)
        return frame

    def to_xarray(self) -> xr.Dataset:
        """Return the result as an xarray dataset, with named dimensions and coordinates.

        Returns
        -------
        xarray.Dataset

        Raises
        ------
        TypeError
            If the result is not tabular.
        MissingPackageError
            If xarray is not installed.
        """
        described = {each.name: each.metadata for each in _fields(self)}
        try:
            dims = _dimensions(self)
        except TypeError:
            columns = self.columns()  # an override, or the same TypeError again
            listed: xr.Dataset = optional_package("xarray").Dataset(
                {name: ("row", values) for name, values in columns.items()}
            )
            return listed
        variables, coordinates = {}, {}
        for name, over in dims.items():
            axis = described[name].get("axis")
            if axis is None:
                variables[name] = (over, getattr(self, name))
            else:
                coordinates[axis] = getattr(self, name)
        data: xr.Dataset = optional_package("xarray").Dataset(variables, coordinates)
        return data

    def __repr__(self) -> str:
        shown = (f"{name}={summary(getattr(self, name))}" for name in shown_names(self))
        return f"{type(self).__name__}({', '.join(shown)})"

    def _repr_html_(self) -> str:
        """Return the table that a notebook shows."""
        table: str = import_module(NOTEBOOK).as_html(self)
        return table


def with_infinities(result: Result, entries: Mapping[str, Any]) -> dict[str, Any]:
    """Return the entries of a result with its infinite numbers, for which JSON has None."""
    held = {name: getattr(result, name, None) for name, value in entries.items() if value is None}
    infinite = {name for name, value in held.items() if value in (math.inf, -math.inf)}
    return {name: held[name] if name in infinite else value for name, value in entries.items()}


def is_cell(value: object) -> bool:
    """Return whether a JSON value is a number, a truth value, a string or None."""
    return value is None or isinstance(value, (bool, int, float, str))


def json_value(value: object) -> Any:
    """Return a value converted to JSON types.

    Parameters
    ----------
    value : object
        A number, string, enum, path, array, collection, mapping, result, chain (anything with
        ``parameters()``) or other dataclass.

    Returns
    -------
    object
        A ``dict``, ``list``, ``str``, ``int``, ``float`` (finite), ``bool`` or ``None``.

    Raises
    ------
    TypeError
        If the value cannot be converted.

    Examples
    --------
    >>> json_value({"v": 0.5, "late": float("inf"), "phi": 1 + 2j, "counts": (1, 2)})
    {'v': 0.5, 'late': None, 'phi': {'re': 1.0, 'im': 2.0}, 'counts': [1, 2]}
    """
    if isinstance(value, Enum):
        return json_value(value.value)
    if value is None or isinstance(value, (bool, int, str)):
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, complex):
        return {"re": json_value(value.real), "im": json_value(value.imag)}
    if isinstance(value, PurePath):
        return str(value)
    if hasattr(value, "dtype") and hasattr(value, "tolist"):
        if value.dtype.kind == "c" and getattr(value, "ndim", 0):
            parts: Any = value
            return {"re": json_value(parts.real.tolist()), "im": json_value(parts.imag.tolist())}
        return json_value(value.tolist())
    for method in ("to_dict", "parameters"):
        if hasattr(value, method):
            return json_value(getattr(value, method)())
    if is_dataclass(value) and not isinstance(value, type):
        return {each.name: json_value(getattr(value, each.name)) for each in fields(value)}
    if isinstance(value, Mapping):
        return {str(json_value(key)): json_value(each) for key, each in value.items()}
    if isinstance(value, Collection):
        return [json_value(each) for each in value]
    raise TypeError(f"a value of type {type(value).__name__} cannot be represented in JSON.")


def _compared(result: Result) -> list[str]:
    return [each.name for each in _fields(result) if each.compare and each.name != "seconds"]


def _same(one: Any, other: Any) -> bool:
    """Return whether two values are equal, element by element; NaN equals NaN."""
    if one is other:
        return True
    if hasattr(one, "__array__") and hasattr(other, "__array__"):
        import numpy as np

        numbers = one.dtype.kind in "fc"
        return one.dtype == other.dtype and np.array_equal(one, other, equal_nan=numbers)
    if isinstance(one, (list, tuple)) and type(one) is type(other):
        return len(one) == len(other) and all(map(_same, one, other))
    if isinstance(one, Mapping) and isinstance(other, Mapping):
        return one.keys() == other.keys() and all(_same(one[name], other[name]) for name in one)
    written = is_dataclass(one) and type(one).__dataclass_params__.eq  # type: ignore[union-attr]
    if written and type(one) is type(other) and not isinstance(one, Result):
        return all(_same(getattr(one, f.name), getattr(other, f.name)) for f in fields(one))
    if isinstance(one, float) and isinstance(other, float):
        return one == other or (math.isnan(one) and math.isnan(other))
    return bool(one == other)


def _fields(result: Result) -> tuple[Field[Any], ...]:
    return fields(result)  # type: ignore[arg-type]  # every Result is a dataclass


def shown_names(result: Result) -> list[str]:
    """Return the names that are shown: fields that have a repr, and derived properties."""
    return [each.name for each in _fields(result) if each.repr] + list(result.derived)


def _dimensions(result: Result) -> dict[str, tuple[str, ...]]:
    """Return the dimensions of the array in each field."""
    dims = {}
    for each in _fields(result):
        over = each.metadata.get("dims") or each.metadata.get("axis")
        if over and getattr(result, each.name) is not None:
            dims[each.name] = (over,) if isinstance(over, str) else tuple(over)
    if not dims:
        raise TypeError(
            f"{type(result).__name__} cannot be written as a table: use to_dict() instead."
        )
    return dims


def _coordinate(result: Result, axis: str) -> Any:
    for each in _fields(result):
        if each.metadata.get("axis") == axis:
            return getattr(result, each.name)
    return None


def optional_package(package: str) -> Any:
    """Import and return a package of the extra ``tables``.

    Raises
    ------
    MissingPackageError
        If the package is not installed.
    """
    try:
        return import_module(package)
    except ModuleNotFoundError:
        raise MissingPackageError(package, "tables", "such a table") from None


def summary(value: object) -> str:
    """Return a value on one line; of an array or a long collection only its size is shown."""
    if isinstance(value, Enum):
        return str(value.value)
    if isinstance(value, float):
        return f"{value:.15g}"
    if hasattr(value, "dtype") and hasattr(value, "shape") and value.shape:
        kind = {"f": "floats", "c": "complex", "i": "integers", "b": "truths"}.get(
            value.dtype.kind, "entries"
        )
        return f"<{' x '.join(map(str, value.shape))} {kind}>"
    text = repr(value)
    if len(text) <= _LONGEST:
        return text
    if isinstance(value, str):
        return text[: _LONGEST - 2] + "…" + text[-1]
    if isinstance(value, Collection):
        held = records(value)
        kind = type(held[0]).__name__ if held else f"in a {type(value).__name__}"
        return f"<{len(value)} {kind}>"
    return f"<{type(value).__name__}>"


def records(value: object) -> Sequence[Any]:
    """Return a dataclass, or several of one class, as a sequence; empty for any other value."""
    several = value if isinstance(value, (tuple, list)) else (value,)
    kinds = {type(each) for each in several}
    return several if len(kinds) == 1 and is_dataclass(kinds.pop()) else ()
