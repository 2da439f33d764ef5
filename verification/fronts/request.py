"""The options of a front measurement."""

from __future__ import annotations

from dataclasses import dataclass, fields

from theory.parameters import refuse_unread
from verification.execution.progress import ProgressCallback
from verification.fronts.result import LeftBoundary
from verification.runs.excite import StartPoint


@dataclass(frozen=True, kw_only=True)
class Request:
    """Options of :func:`measure_front`; None stands for the default of the model."""

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


RUN = ("accuracy", "tolerance", "excited", "max_sites", "stall_time")
"""Options that apply to every run on a chain that can be lengthened."""
