"""Curves: a function of a chain evaluated at many values of one parameter."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np

from theory.arrays import FloatArray
from theory.parameters import ParameterError
from theory.result import Result, is_cell, json_value


@dataclass(frozen=True, kw_only=True)
class Refusal(Result):
    """A point of a curve at which there is no result.

    Attributes
    ----------
    status : str
        ``refused``.
    reason : str
        The reason, in one sentence.
    """

    status: str = "refused"
    reason: str


@dataclass(frozen=True, kw_only=True)
class Curve(Result):
    """Results of one function along one parameter of a chain.

    Attributes
    ----------
    along : str
        Name of the parameter.
    values : ndarray, shape (n,)
        Values of the parameter.
    points : tuple of Result
        The result of the function at each value, or a `Refusal` where there is none.
    seconds : float
        Wall time.
    """

    is_curve = True

    along: str
    values: FloatArray
    points: tuple[Result, ...]
    seconds: float

    @property
    def needs_attention(self) -> bool:
        """Whether there is a point without a result."""
        return any(isinstance(point, Refusal) for point in self.points)

    @property
    def units(self) -> Mapping[str, str]:
        """Units of the entries of the points."""
        return {name: unit for point in self.points for name, unit in point.units.items()}

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row per value: the parameter, then all numbers and words of the result there.

        A result that contains several, one for each method, has a row for each of them. Columns of
        a result that is part of another have its name as a prefix, as in ``stable_cycle_max``.
        """
        rows = [
            {**row, self.along: float(value)}
            for value, point in zip(self.values, self.points, strict=True)
            for row in point.rows()
        ]
        # An entry that is a list, a mapping or a result at some points has no column.
        listed = {name for row in rows for name, value in row.items() if not is_cell(value)}
        parts = {name for point in self.points for name in point.parts()}
        every = dict.fromkeys([self.along, *(name for row in rows for name in row)])
        names = [name for name in every if name not in listed | parts]
        table = {}
        for name in names:
            cells = [row.get(name) for row in rows]
            numbers = all(
                cell is None or (isinstance(cell, (int, float)) and not isinstance(cell, bool))
                for cell in cells
            )
            table[name] = np.array(cells, dtype=float if numbers else object)
        return table

    def to_dict(self) -> dict[str, Any]:
        """Return ``along``, ``points`` (each with the value of the parameter) and ``seconds``."""
        points = [
            {self.along: float(value)} | point.to_dict()
            for value, point in zip(self.values, self.points, strict=True)
        ]
        return {"along": self.along, "points": points, "seconds": json_value(self.seconds)}


def curve(
    function: Callable[..., Result],
    chains: Sequence[Any],
    along: str,
    values: Sequence[float],
    arguments: Mapping[str, Any],
    *,
    workers: int | None,
    progress: Callable[[float], None] | None,
) -> Curve:
    """Evaluate a function for each of several chains.

    Parameters
    ----------
    function : callable
        A function of a chain and ``arguments``.
    chains : sequence of Chain
        The chains.
    along : str
        The parameter in which the chains differ.
    values : sequence of float
        The values of this parameter.
    arguments : mapping
        Further arguments by name.
    workers : int or None
        Number of processes; 1 for the present process, None for one per core.
    progress : callable or None
        Called with the fraction done.

    Returns
    -------
    Curve
        Points at which the function refuses its input, or fails, are `Refusal` objects.

    Raises
    ------
    ParameterError
        If the function refuses all of the chains.
    """
    from verification.execution.pool import answers_in_order

    begin = perf_counter()
    task = partial(_point, function, dict(arguments))
    points = tuple(answers_in_order(task, chains, workers=workers, progress=progress))
    if all(isinstance(point, Refusal) for point in points):
        # Raises the same error as for a single point.
        function(chains[0], **arguments)
    return Curve(
        along=along,
        values=np.asarray(values, dtype=float),
        points=points,
        seconds=perf_counter() - begin,
    )


def _point(function: Callable[..., Result], arguments: Mapping[str, Any], chain: Any) -> Result:
    """Return the result for a chain, or why there is none."""
    try:
        return function(chain, **arguments)
    except (ParameterError, ArithmeticError) as refusal:
        return Refusal(reason=str(refusal))
