"""The options of a front measurement."""

from __future__ import annotations

from dataclasses import dataclass, fields

from theory.chains.chain import MAX_SITES
from theory.parameters import LATEST, Range, count_within, refuse_unread, within
from verification.execution.progress import ProgressCallback
from verification.fronts.result import LeftBoundary
from verification.runs.comparison import COARSER
from verification.runs.excite import StartPoint
from verification.runs.simulate import TOLERANCES


@dataclass(frozen=True, kw_only=True)
class Option:
    """A numerical option of one kind of front: its name in refusals, its range and its default."""

    quantity: str
    allowed: Range
    default: float

    def number(self, given: float | None) -> float:
        """Return the given number, or the default if there is none.

        Raises
        ------
        ParameterError
            If the number is out of range.
        """
        return self.default if given is None else within(self.quantity, given, *self.allowed)

    def count(self, given: int | None) -> int:
        """Return the given whole number, or the default if there is none.

        Raises
        ------
        ParameterError
            If the number is out of range, or not whole.
        """
        value = self.default if given is None else given
        return count_within(self.quantity, value, *self.allowed)


@dataclass(frozen=True, kw_only=True)
class Request:
    """Options of :func:`measure_front`; None stands for the default of the kind of front."""

    accuracy: float | None = None
    tolerance: float | None = None
    excited: int | None = None
    max_sites: int | None = None
    stall_time: float | None = None
    left_boundary: LeftBoundary = LeftBoundary.FREE
    point: StartPoint | float = StartPoint.MAXIMUM
    directions: int | None = None
    progress: ProgressCallback | None = None

    def reads(self, *names: str, where: str) -> None:
        """Refuse every given option except the named ones; ``progress`` is always allowed."""
        defaults = {each.name: each.default for each in fields(self)}
        refuse_unread(vars(self), defaults, {*names, "progress"}, where)


def stall_time(default: float) -> Option:
    """Return the option of the time without an arrival, in units of ``chain.time_unit``."""
    return Option(quantity="stall time", allowed=Range(1e-6, LATEST), default=default)


def longest_chain(least: int, default: int) -> Option:
    """Return the option of the length of the longest chain, which must not be below ``least``."""
    allowed = Range(least, MAX_SITES)
    return Option(quantity="longest chain, max_sites,", allowed=allowed, default=default)


TOLERANCE = Option(
    quantity="tolerance", allowed=Range(TOLERANCES.low, TOLERANCES.high / COARSER), default=1e-8
)
"""Tolerance of the runs of a smooth chain: `COARSER` times as much must still be one of a run."""

RUN = ("accuracy", "tolerance", "excited", "max_sites", "stall_time")
"""Options that apply to every run on a chain that can be lengthened."""
