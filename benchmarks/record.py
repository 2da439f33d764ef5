"""The record of a benchmark: points of error versus run time, failures, targets, the machine.

Errors are absolute and dimensionless. Times are processor seconds, so that other work on a shared
machine does not count, or wall-clock seconds where a record says so.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal

from verification.execution.metadata import Metadata
from verification.execution.record import Record

KIND = "benchmark"
PACKAGES = (
    "numpy", "scipy", "mpmath", "numba", "cxroots", "python-flint", "jitcode", "heyoka",
    "oscilate", "asymptotics",
)  # fmt: skip


@dataclass(frozen=True)
class WorkPoint:
    """The cost and the error of one method at one setting.

    Attributes
    ----------
    quantity, problem, method, knob : str
        The quantity, the test problem, the method, and the setting that trades error for time.
    error : float
        Distance from the reference.
    claimed : float or None
        The error bound or estimate that the method itself states; None where it states none.
    first_seconds : float
        Time of the first call in this process, per evaluation; modules and caches may already have
        been loaded by other settings.
    seconds : float
        Median time of the repeated calls, per evaluation.
    repeats : int
        Number of repeated calls, without the first.
    warning : str
        Warning of the method on the first call; empty if there was none.
    """

    quantity: str
    problem: str
    method: str
    knob: str
    error: float
    claimed: float | None
    first_seconds: float
    seconds: float
    repeats: int
    warning: str = ""


@dataclass(frozen=True)
class BenchmarkFailure:
    """A method that gave no value at a setting, and the reason."""

    quantity: str
    problem: str
    method: str
    knob: str
    reason: str


@dataclass(frozen=True)
class FirstCall:
    """The time until a method gives its first value, in a process of its own.

    Attributes
    ----------
    method : str
        Name of the method.
    cold : float or None
        Seconds of the first call when nothing has been compiled before; None if it failed.
    loaded : float or None
        The same in the next process, which loads what the first one compiled.
    again : float or None
        Seconds of the second call in that process.
    reason : str
        Why the method failed; empty if it did not.
    """

    method: str
    cold: float | None
    loaded: float | None
    again: float | None
    reason: str = ""


Relation = Literal["at least", "below", "no target"]


@dataclass(frozen=True)
class Target:
    """A promised speed and the measured one.

    Attributes
    ----------
    claim : str
        What is measured, in words.
    measured : float or None
        The measured value; None where it could not be measured, for the reason in ``detail``.
    relation : {"at least", "below", "no target"}
        How the measured value must compare with ``limit``.
    limit : float or None
        The target.
    unit : str
        Unit of both.
    detail : str
        How it was measured, and the numbers from which a ratio was formed.
    """

    claim: str
    measured: float | None
    relation: Relation
    limit: float | None
    unit: str
    detail: str

    @property
    def verdict(self) -> str:
        """``met``, ``not met``, ``not measured``, or ``-`` where nothing was promised."""
        if self.measured is None:
            return "not measured"
        if self.limit is None:
            return "-"
        at_least = self.relation == "at least"
        good = self.measured >= self.limit if at_least else self.measured < self.limit
        return "met" if good else "not met"


_ROWS: Mapping[str, type] = {
    "points": WorkPoint,
    "failures": BenchmarkFailure,
    "targets": Target,
    "first_calls": FirstCall,
}


@dataclass(frozen=True, kw_only=True)
class BenchmarkRecord:
    """One run of the benchmarks.

    Attributes
    ----------
    agreement : mapping of str to float
        For each test problem, the distance between the two references that share no code.
    points, failures, targets
        The measurements.
    first_calls : sequence of FirstCall
        Times of first calls, with compilation; empty in a quick run.
    metadata : Metadata
        The command, the machine, the versions of the packages, and the measured code.
    """

    agreement: Mapping[str, float]
    points: Sequence[WorkPoint]
    failures: Sequence[BenchmarkFailure]
    targets: Sequence[Target]
    first_calls: Sequence[FirstCall] = ()
    metadata: Metadata = field(default_factory=Metadata)

    def stored(self) -> Record:
        """Return the record as it is stored, with the verdict on each target."""
        content: dict[str, Any] = {
            name: [asdict(each) for each in getattr(self, name)] for name in _ROWS
        }
        for row, target in zip(content["targets"], self.targets, strict=True):
            row["verdict"] = target.verdict
        content["agreement"] = dict(self.agreement)
        return Record(kind=KIND, content=content, metadata=self.metadata)


def read_record(path: Path) -> BenchmarkRecord:
    """Read a stored record."""
    found = Record.load(path, KIND)
    rows = {name: [dict(row) for row in found.content[name]] for name in _ROWS}
    for row in rows["targets"]:
        del row["verdict"]
    made = {name: tuple(kind(**row) for row in rows[name]) for name, kind in _ROWS.items()}
    return BenchmarkRecord(agreement=found.content["agreement"], metadata=found.metadata, **made)
