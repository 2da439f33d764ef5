"""Points of a sweep: coordinates by name, for single points or all combinations on some axes."""

from __future__ import annotations

import hashlib
import itertools
import json
import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any, overload

import numpy as np

from theory.parameters import ParameterError
from verification.execution.columns import Array, Scalar, column_of, plain, read_only


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

    def __reduce__(self) -> tuple[Callable[[dict[str, Scalar]], Point], tuple[dict[str, Scalar]]]:
        return _point_of, (self._items,)

    def __repr__(self) -> str:
        return f"Point({', '.join(f'{name}={value!r}' for name, value in self._items.items())})"

    def number(self, name: str) -> float:
        """Return a coordinate as a float."""
        return float(self._items[name])


def _point_of(items: dict[str, Scalar]) -> Point:
    """Return the point of these Python scalars, without copying or checking them."""
    point = Point.__new__(Point)
    point._items = items
    return point


class Grid(Sequence[Point]):
    """All combinations of the values on some axes, the last one varying fastest; made on demand.

    Attributes
    ----------
    axes : dict of str to list
        Values by name.

    Examples
    --------
    >>> Grid({"eta": [0.1, 0.2], "c": [1, 2]})[1]
    Point(eta=0.1, c=2)
    """

    def __init__(self, axes: Mapping[str, Iterable[Scalar]]) -> None:
        self.axes = {name: [plain(value) for value in values] for name, values in axes.items()}
        self._shape = tuple(len(values) for values in self.axes.values())

    def __len__(self) -> int:
        return math.prod(self._shape)

    @overload
    def __getitem__(self, index: int) -> Point: ...
    @overload
    def __getitem__(self, index: slice) -> tuple[Point, ...]: ...

    def __getitem__(self, index: int | slice) -> Point | tuple[Point, ...]:
        if isinstance(index, slice):
            return tuple(self[i] for i in range(*index.indices(len(self))))
        left = range(len(self))[index]  # IndexError beyond the last
        point: dict[str, Scalar] = dict.fromkeys(self.axes, 0)
        for name, values in reversed(self.axes.items()):
            left, place = divmod(left, len(values))
            point[name] = values[place]
        return _point_of(point)

    def __iter__(self) -> Iterator[Point]:
        for values in itertools.product(*self.axes.values()):
            yield _point_of(dict(zip(self.axes, values, strict=True)))

    @property
    def distinct_axes(self) -> tuple[str, ...]:
        """Names of the axes; empty if a value occurs twice on one of them, or is nan."""
        distinct = all(
            len(set(values)) == len(values)
            and not any(isinstance(value, float) and math.isnan(value) for value in values)
            for values in self.axes.values()
        )
        return tuple(self.axes) if distinct else ()

    def columns(self) -> dict[str, Array]:
        """Return the coordinates of all points by name."""
        places = np.indices(self._shape, sparse=True)
        return {
            name: read_only(np.broadcast_to(column_of(name, values)[at], self._shape).ravel())
            for (name, values), at in zip(self.axes.items(), places, strict=True)
        }


def points_of(points: Sequence[Mapping[str, Scalar]] | Mapping[str, Any]) -> Sequence[Point]:
    """Return points, given one by one or by the values on each axis.

    Raises
    ------
    ParameterError
        If their names differ.
    """
    if isinstance(points, Grid):
        return points
    try:
        found = _listed(points)
    except (TypeError, ValueError) as wrong:
        raise ParameterError(
            "points", type(points).__name__, "mappings of names to numbers or words, or names with "
            "the values on each axis", f"correct them: {wrong}".rstrip("."),
        ) from None  # fmt: skip
    if isinstance(found, Grid):
        return found
    for point in found:
        if list(point) != list(found[0]):
            raise ParameterError(
                "points",
                f"{point} beside {found[0]}",
                "all of the same names",
                "give all points the same names",
            )
    return found


def _listed(points: Any) -> Grid | tuple[Point, ...]:
    """Return points as they are given; raise a TypeError that names what is not a point."""
    if isinstance(points, Mapping) and not isinstance(points, Point):
        _need_names(points)
        axes = {name: np.atleast_1d(np.asarray(values)).tolist() for name, values in points.items()}
        return Grid(axes) if axes else ()
    if not isinstance(points, Iterable):
        raise TypeError("they are not a sequence")
    given = (points,) if isinstance(points, Point) else tuple(points)
    for each in given:
        if not isinstance(each, Mapping):
            raise TypeError(f"{each!r:.40} is not a mapping")
        _need_names(each)
    return tuple(each if isinstance(each, Point) else Point(each) for each in given)


def _need_names(names: Iterable[Any]) -> None:
    for name in names:
        if not isinstance(name, str):
            raise TypeError(f"{name!r:.40} is not a name")


def coordinates(points: Sequence[Point]) -> dict[str, Array]:
    """Return the coordinates of all points by name; no column if there is no point."""
    if isinstance(points, Grid):
        return points.columns() if len(points) else {}
    names = list(points[0]) if points else []
    return {name: column_of(name, [point[name] for point in points]) for name in names}


def digest_of_points(points: Iterable[Point]) -> str:
    """Return the digest of the list of all points, each a JSON list of names and values."""
    total = hashlib.sha256(b"[")
    begin = "["
    for coordinates_ in _coordinates_in_json(points):
        total.update(f"{begin}{', '.join(coordinates_)}]".encode())
        begin = ", ["
    total.update(b"]")
    return total.hexdigest()


def _coordinates_in_json(points: Iterable[Point]) -> Iterator[Iterable[str]]:
    """Yield the coordinates of each point as pairs; those of an axis are encoded only once."""
    if isinstance(points, Grid):
        yield from itertools.product(
            *(
                [json.dumps([name, value]) for value in values]
                for name, values in points.axes.items()
            )
        )
    else:
        yield from (map(json.dumps, point.items()) for point in points)
