"""The record of a benchmark: points of error versus run time, failures, targets, the machine.

Errors are absolute and dimensionless. Times are processor seconds, so that other work on a shared
machine does not count, or wall-clock seconds where a record says so.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from verification.execution.files import write_json
from verification.execution.metadata import installed_versions, now, this_machine

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


@dataclass(frozen=True)
class BenchmarkRecord:
    """One run of the benchmarks.

    Attributes
    ----------
    command : str
        The command line.
    date : str
        UTC, ISO 8601.
    machine, versions : mapping
        The machine and the versions of the packages (`verification.execution.metadata`).
    agreement : mapping of str to float
        For each test problem, the distance between the two references that share no code.
    points, failures, targets
        The measurements.
    first_calls : tuple of FirstCall
        Times of first calls, with compilation; empty in a quick run.
    code : mapping or None
        The measured code (`verification.execution.metadata.Code`); None in a record that does not
        state it.
    """

    command: str
    date: str
    machine: Mapping[str, Any]
    versions: Mapping[str, str | None]
    agreement: Mapping[str, float]
    points: tuple[WorkPoint, ...]
    failures: tuple[BenchmarkFailure, ...]
    targets: tuple[Target, ...]
    first_calls: tuple[FirstCall, ...] = ()
    code: Mapping[str, object] | None = None


def record_of(
    command: str,
    agreement: Mapping[str, float],
    *,
    points: Sequence[WorkPoint],
    failures: Sequence[BenchmarkFailure],
    targets: Sequence[Target] = (),
    first_calls: Sequence[FirstCall] = (),
    code: Mapping[str, object] | None = None,
) -> BenchmarkRecord:
    """Return the record of a run that has just ended on this machine."""
    return BenchmarkRecord(
        command, now(), this_machine(), installed_versions(PACKAGES), agreement, tuple(points),
        tuple(failures), tuple(targets), tuple(first_calls), code,
    )  # fmt: skip


def as_payload(record: BenchmarkRecord) -> dict[str, Any]:
    """Return a record for JSON, with the verdict on each target."""
    payload = asdict(record)
    for row, target in zip(payload["targets"], record.targets, strict=True):
        row["verdict"] = target.verdict
    return payload


def write_record(record: BenchmarkRecord, path: Path) -> None:
    """Write a record as JSON."""
    write_json(path, as_payload(record))


def read_record(path: Path) -> BenchmarkRecord:
    """Read a record written by :func:`write_record`."""
    payload = json.loads(path.read_text(encoding="utf-8"))
    for row in payload["targets"]:
        del row["verdict"]
    rows = {
        "points": WorkPoint, "failures": BenchmarkFailure, "targets": Target,
        "first_calls": FirstCall,
    }  # fmt: skip
    for name, kind in rows.items():
        payload[name] = tuple(kind(**row) for row in payload.get(name, ()))
    return BenchmarkRecord(**payload)
