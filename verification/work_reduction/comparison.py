"""One computation made twice: with a truncation or active window, and without."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from time import perf_counter
from typing import TypeVar

T = TypeVar("T")


@dataclass(frozen=True)
class Comparison:
    """The costs of both computations, the difference of their results, and a bound on it.

    Attributes
    ----------
    spent, whole : float
        Cost with and without the reduction, in the unit of the row.
    changed : float
        Distance between the two results; inf if they differ in kind.
    bound : float
        Bound on this distance: the bound of the row, plus the error of the result without the
        reduction if there is one. Both were known before the results were compared.
    """

    spent: float
    whole: float
    changed: float
    bound: float

    @property
    def holds(self) -> bool:
        """Whether the bound holds.

        Examples
        --------
        >>> Comparison(1.0, 2.0, 0.0, 0.0).holds, Comparison(1.0, 2.0, 1e-9, 1e-12).holds
        (True, False)
        """
        return self.changed <= self.bound

    def __str__(self) -> str:
        if self.bound == 0.0 and self.changed == 0.0:
            return "nothing"
        beyond = "" if self.holds else ": the bound is exceeded"
        return f"{self.changed:.2g}, at most {self.bound:.2g}{beyond}"


def timed(compute: Callable[[], T], times: int = 2) -> tuple[T, float]:
    """Return a result and the shortest of several run times, in seconds."""
    shortest = float("inf")
    for _ in range(times):
        begin = perf_counter()
        found = compute()
        shortest = min(shortest, perf_counter() - begin)
    return found, shortest
