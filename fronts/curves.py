"""A curve: one function of a chain at many values of one parameter."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from theory.arrays import FloatArray
from theory.parameters import ParameterError
from theory.result import Result, is_cell, plain


@dataclass(frozen=True, kw_only=True)
class Refusal(Result):
    """A point of a curve at which there is no answer.

    Attributes
    ----------
    status : str
        ``refused``.
    reason : str
        Why, in one sentence.
    """

    status: str = "refused"
    reason: str


@dataclass(frozen=True, kw_only=True)
class Curve(Result):
    """Results of one function along one parameter of a chain.

    Attributes
    ----------
    along : str
        The parameter.
    values : ndarray, shape (n,)
        Its values.
    points : tuple of Result
        What the function gives there; a `Refusal` where it cannot.
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
        """Whether a point has no answer."""
        return any(isinstance(point, Refusal) for point in self.points)

    @property
    def units(self) -> Mapping[str, str]:
        """Those of the points."""
        return {name: unit for point in self.points for name, unit in point.units.items()}

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row a value: the parameter, then every number and word of the result there.

        A result that holds several, one a method, has a row for each of them. Of a result that is
        part of that of a point the columns have its name before theirs: ``stable_cycle_max``.
        """
        rows = [
            {**row, self.along: float(value)}
            for value, point in zip(self.values, self.points, strict=True)
            for row in point.rows()
        ]
        # What is None at some points and a list, a mapping or a result at others has no column.
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
        """Return ``along``, ``points`` (each with its value of the parameter) and ``seconds``."""
        points = [
            {self.along: float(value)} | point.to_dict()
            for value, point in zip(self.values, self.points, strict=True)
        ]
        return {"along": self.along, "points": points, "seconds": plain(self.seconds)}


def curve(
    function: Callable[..., Result],
    chains: Sequence[Any],
    along: str,
    values: Sequence[float],
    arguments: Mapping[str, Any],
    *,
    workers: int | None = 1,
    progress: Callable[[float], None] | None = None,
) -> Curve:
    """Compute a function of each chain.

    Parameters
    ----------
    function : callable
        Of a chain and ``arguments``.
    chains : sequence of Chain
        The chains.
    along : str
        The parameter in which they differ.
    values : sequence of float
        Its values.
    arguments : mapping
        Further arguments by name.
    workers : int, optional
        Processes; by default this one alone, None for one a core.
    progress : callable, optional
        Called with the fraction done.

    Returns
    -------
    Curve
        A point at which the function refuses its input, or cannot go on, is a `Refusal`.

    Raises
    ------
    ParameterError
        If it refuses every one of them.
    """
    from verification.execution.pool import answers_in_order

    begin = perf_counter()
    task = _Task(function, dict(arguments))
    points = tuple(answers_in_order(task, chains, workers=workers, progress=progress))
    if all(isinstance(point, Refusal) for point in points):
        # One sentence, as for a single point.
        function(chains[0], **arguments)
    return Curve(
        along=along,
        values=np.asarray(values, dtype=float),
        points=points,
        seconds=perf_counter() - begin,
    )


@dataclass(frozen=True)
class _Task:
    """A function with its further arguments, for another process."""

    function: Callable[..., Result]
    arguments: dict[str, Any]

    def __call__(self, chain: Any) -> Result:
        try:
            return self.function(chain, **self.arguments)
        except (ParameterError, ArithmeticError) as refusal:
            return Refusal(reason=str(refusal))
