"""Whether the default method is the fastest, read from the records for each decade of error.

For each error 10^-k that a user is likely to require, every method is given its fastest setting
whose true error is no larger. The default should then be the fastest; where another method is
faster by more than a tenth, the table names it and gives the factor. Errors smaller than the
difference of the two references are left out, since they are not known. Variants of the default
and methods that solve another problem do not count as rivals; the latter are listed with the
problem that they solve. For each rival that is faster, the table states why the default is
nevertheless the default.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

from benchmarks.record import BenchmarkRecord, WorkPoint, read_record
from benchmarks.registry import quantity_of
from benchmarks.work_precision import WorkPrecision
from verification.execution.files import write_json
from verification.execution.metadata import staleness
from verification.quantities.quantity import Quantity

NO_REASON = "no reason is given: the default must be changed"

NOISE = 1.1
"""Ratio of run times below which two methods count as equally fast."""


@dataclass(frozen=True)
class Beaten:
    """An error at which another method is faster.

    Attributes
    ----------
    error : float
        The required error.
    by : str
        The fastest method at this error.
    factor : float or None
        Run time of the default divided by that of ``by``; None where the default does not reach
        this error.
    """

    error: float
    by: str
    factor: float | None


@dataclass(frozen=True)
class Choice:
    """The default method of one quantity at one test problem.

    Attributes
    ----------
    quantity, problem, default : str
        The quantity, the test problem and the default method.
    recorded : str
        Date of the record.
    fastest : tuple of float
        Required errors at which no other method is faster.
    beaten : tuple of Beaten
        The required errors at which another method is faster.
    reasons : mapping of str to str
        For each rival that is faster at some error, why the default is nevertheless the default.
    others : mapping of str to str
        Methods of the record that are not rivals because they solve another problem, each with
        that problem.
    stale : str
        Why the record is out of date; empty if it is not.
    """

    quantity: str
    problem: str
    default: str
    recorded: str
    fastest: tuple[float, ...]
    beaten: tuple[Beaten, ...]
    reasons: Mapping[str, str] = field(default_factory=dict)
    others: Mapping[str, str] = field(default_factory=dict)
    stale: str = ""

    @property
    def lower_envelope(self) -> bool:
        """Whether the default is the fastest at every useful error that some method reaches."""
        return not self.beaten and bool(self.fastest)


def choices(benchmark: WorkPrecision, quantity: Quantity, record: BenchmarkRecord) -> list[Choice]:
    """Return one `Choice` for each test problem.

    Raises
    ------
    ValueError
        If the record lacks the default method at a test problem.
    """
    rows, default = [], quantity.default
    stale = staleness(record.metadata.code)
    apart = {*benchmark.variants, *benchmark.others}
    for problem in dict.fromkeys(point.problem for point in record.points):
        here = [point for point in record.points if point.problem == problem]
        if not any(point.method == default for point in here):
            raise ValueError(f"{benchmark.name}: no point of {default} at {problem}")
        fastest, beaten = [], []
        low, high = quantity.useful or (0.0, 0.0)
        for error in decades(max(low, record.agreement[problem]), high):
            best = fastest_within((point for point in here if point.method not in apart), error)
            if not best:
                continue
            own = best.pop(default, math.inf)
            rival = min(best, key=lambda name: best[name], default=None)
            if rival is None or own <= NOISE * best[rival]:
                fastest.append(error)
            else:
                factor = own / best[rival] if math.isfinite(own) else None
                beaten.append(Beaten(error, rival, factor))
        rows.append(
            Choice(
                benchmark.name, problem, default, record.metadata.date,
                tuple(fastest), tuple(beaten),
                {each.by: benchmark.reasons.get(each.by, NO_REASON) for each in beaten},
                {name: what for name, what in benchmark.others.items()
                 if any(point.method == name for point in here)},
                stale,
            )
        )  # fmt: skip
    return rows


def decades(low: float, high: float) -> list[float]:
    """Return the powers of ten from ``high`` down to ``low``.

    Examples
    --------
    >>> decades(1e-4, 0.1)
    [0.1, 0.01, 0.001, 0.0001]
    """
    first, last = math.floor(math.log10(high) + 1e-9), math.ceil(math.log10(low) - 1e-9)
    return [float(f"1e{k}") for k in range(first, last - 1, -1)]


def fastest_within(points: Iterable[WorkPoint], error: float) -> dict[str, float]:
    """Return the least time of each method among its settings within the given error."""
    best: dict[str, float] = {}
    for point in points:
        if point.error <= error:
            best[point.method] = min(best.get(point.method, math.inf), point.seconds)
    return best


def stored_choices(
    benchmarks: Sequence[WorkPrecision], folder: Path
) -> tuple[list[Choice], list[str]]:
    """Return the choices from a folder's records, and the benchmarks that have no record there."""
    rows: list[Choice] = []
    missing = []
    for benchmark in benchmarks:
        path = folder / f"{benchmark.name}.json"
        if path.is_file():
            rows += choices(benchmark, quantity_of(benchmark), read_record(path))
        else:
            missing.append(benchmark.name)
    return rows, missing


def as_payload(rows: Sequence[Choice]) -> list[dict[str, object]]:
    """Return the table for JSON."""
    return [
        {
            **{name: value for name, value in asdict(row).items() if name != "stale"},
            "lower_envelope": row.lower_envelope,
        }
        for row in rows
    ]


def write_choices(rows: Sequence[Choice], path: Path) -> None:
    """Write the table as JSON."""
    write_json(path, {"choices": as_payload(rows)})


def as_text(rows: Sequence[Choice]) -> str:
    """Return the table as text: a line for each problem and for each method that is faster.

    Examples
    --------
    >>> print(as_text([Choice("sum", "s", "m", "today", (1e-2,), (Beaten(1e-3, "n", 2.0),))]))
    quantity     problem                      default                       is the fastest
    sum          s                            m                             at 1 of 2 errors: 1e-02
                     n is faster: 1e-03 (2.0 times)
    """
    lines = [f"{'quantity':12} {'problem':28} {'default':29} is the fastest"]
    for row in rows:
        total = len(row.fastest) + len(row.beaten)
        where = span(row.fastest)
        verdict = f"everywhere, {where}" if row.lower_envelope else (
            f"at {len(row.fastest)} of {total} errors" + (f": {where}" if where else "")
        )  # fmt: skip
        lines.append(f"{row.quantity:12} {row.problem:28} {row.default:29} {verdict}")
        for by in dict.fromkeys(each.by for each in row.beaten):
            there = ", ".join(
                f"{each.error:.0e} "
                + ("(not reached)" if each.factor is None else f"({each.factor:.1f} times)")
                for each in row.beaten
                if each.by == by
            )
            lines.append(f"{'':16} {by} is faster: {there}")
            if by in row.reasons:
                lines.append(f"{'':16} the default is kept: {row.reasons[by]}")
        for name, what in row.others.items():
            lines.append(f"{'':16} {name} is not comparable: {what}")
        if row.stale:
            lines.append(f"{'':16} stale: {row.stale}")
    return "\n".join(lines)


def span(errors: Sequence[float]) -> str:
    """Return the first and last of consecutive decades, or all errors if a decade is missing.

    Examples
    --------
    >>> span([1e-2, 1e-3, 1e-4]), span([1e-2, 1e-4]), span([])
    ('1e-02 to 1e-04', '1e-02, 1e-04', '')
    """
    if len(errors) > 2 and list(errors) == decades(errors[-1], errors[0]):
        return f"{errors[0]:.0e} to {errors[-1]:.0e}"
    return ", ".join(f"{error:.0e}" for error in errors)
