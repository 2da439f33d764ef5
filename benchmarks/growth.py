"""Growth of run time and memory with sites, digits, 1/v, points of a map and workers.

Each kind of work is run at increasing sizes; the exponent is the slope of log time versus log size
over the larger half of the sizes, where a constant cost matters least. It is listed with the
exponent that the method should have. Memory is the peak allocated by Python and NumPy in this
process; tracing slows down work on many small objects, so memory is measured only for work that
takes less than `TRACED` seconds, and not for workers.
"""

from __future__ import annotations

import math
import tracemalloc
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from benchmarks.growth_work import WORKS, Work
from benchmarks.record import PACKAGES
from benchmarks.work_precision import Report
from verification.execution.files import write_json
from verification.execution.metadata import Code, Metadata, installed_versions

CLOSE = 0.2
"""Difference of fitted and expected exponents that needs no remark: fits are no more accurate."""
TRACED = 1.5
"""Longest work, in seconds, that is repeated in order to trace its memory."""


@dataclass(frozen=True)
class Growth:
    """The cost of one kind of work at increasing sizes.

    Attributes
    ----------
    work : Work
        The kind of work.
    sizes, seconds, megabytes : tuple of float
        Size, least time, peak memory (nan where it is not measured).
    exponent, memory_exponent : float
        Exponents of time and memory fitted over the larger half of the sizes.
    """

    work: Work
    sizes: tuple[float, ...]
    seconds: tuple[float, ...]
    megabytes: tuple[float, ...]
    exponent: float
    memory_exponent: float

    def to_dict(self) -> dict[str, object]:
        """Return the row for JSON; values that are not finite are null."""
        work = self.work
        return {
            "name": work.name,
            "size_name": work.size_name,
            "why": work.why,
            "sizes": self.sizes,
            "seconds": self.seconds,
            "megabytes": tuple(map(_finite, self.megabytes)),
            "exponent": _finite(self.exponent),
            "memory_exponent": _finite(self.memory_exponent),
            "expected": work.expected,
            "wall": work.wall,
            "remark": remark_on(work, self.exponent),
        }


def measure(quick: bool, report: Report) -> list[Growth]:
    """Measure every kind of work."""
    done = []
    for work in WORKS:
        report(f"growth: {work.name}")
        sizes = work.quick if quick else work.full
        work.work(sizes[0])  # compiles and imports before the timing
        costs = [cost(work, size) for size in sizes]
        half = slice(min(len(sizes) // 2, len(sizes) - 2), None)
        seconds, memory = ([row[i] for row in costs] for i in (0, 1))
        powers = (slope(sizes[half], each[half]) for each in (seconds, memory))
        done.append(Growth(work, tuple(map(float, sizes)), tuple(seconds), tuple(memory), *powers))
    return done


def remark_on(work: Work, fitted: float) -> str:
    """Return why the fitted exponent differs from the expected one; empty where it does not.

    Examples
    --------
    >>> work = Work("w", "sites", abs, (1,), (1,), 2.0, "why", remark="too few sites")
    >>> remark_on(work, 2.1), remark_on(work, 1.2)
    ('', 'too few sites')
    """
    if work.expected is None or abs(fitted - work.expected) <= CLOSE:
        return ""
    return work.remark or "not explained"


def cost(work: Work, size: float) -> tuple[float, float]:
    """Return the least time in seconds and the peak memory in megabytes."""
    clock = perf_counter if work.wall else process_time
    best = least_seconds(lambda: work.work(size), work.repeats, clock)
    if work.wall or best > TRACED:
        return best, math.nan
    tracemalloc.start()
    try:
        work.work(size)
        return best, tracemalloc.get_traced_memory()[1] / 1e6
    finally:
        tracemalloc.stop()


def least_seconds(
    work: Callable[[], object], repeats: int, clock: Callable[[], float] = process_time
) -> float:
    """Return the least time of repeated calls, or of one call if it takes more than two seconds."""
    best = math.inf
    for turn in range(repeats):
        begin = clock()
        work()
        best = min(best, clock() - begin)
        if best > 2.0 and turn == 0:
            break
    return best


def slope(sizes: Sequence[float], costs: Sequence[float]) -> float:
    """Return the slope of log cost versus log size, by least squares.

    Examples
    --------
    >>> round(slope([1, 2, 4], [3, 12, 48]), 12)
    2.0
    """
    known = [(s, c) for s, c in zip(sizes, costs, strict=True) if c > 0.0 and math.isfinite(c)]
    if len(known) < 2:
        return math.nan
    x, y = np.log(np.array(known)).T
    return float(np.polyfit(x, y, 1)[0])


def as_payload(rows: Sequence[Growth], command: str) -> dict[str, object]:
    """Return the table for JSON."""
    metadata = Metadata(
        command=command,
        versions=installed_versions(PACKAGES),
        code=Code.of(["benchmarks.growth"]),
    )
    return metadata.to_dict() | {"lines": [row.to_dict() for row in rows]}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _shown(value: float, form: str) -> str:
    return format(value, form) if math.isfinite(value) else "-"


def as_text(rows: Sequence[Growth]) -> str:
    """Return the table as text."""
    lines = [
        f"{'work':38} {'grows with':10} {'from':>7} {'to':>7} {'s at the end':>12} {'MB':>8} "
        f"{'exponent':>9} {'expected':>9} {'of memory':>10}"
    ]
    for row in rows:
        work, remark = row.work, remark_on(row.work, row.exponent)
        expected = "-" if work.expected is None else f"{work.expected:g}"
        lines.append(
            f"{work.name:38} {work.size_name:10} {row.sizes[0]:7g} {row.sizes[-1]:7g} "
            f"{row.seconds[-1]:12.3g} {_shown(row.megabytes[-1], '.3g'):>8} {row.exponent:9.2f} "
            f"{expected:>9} {_shown(row.memory_exponent, '.2f'):>10}"
        )
        lines.append(f"    {work.why}" + ("; wall-clock seconds" if work.wall else ""))
        if remark:
            lines.append(f"    not {work.expected:g}: {remark}")
    return "\n".join(lines)


def write_growth(payload: dict[str, object], rows: Sequence[Growth], folder: Path) -> None:
    """Write ``growth.json``, the diagram and its data."""
    from benchmarks.growth_diagram import draw_growth

    draw_growth([row.to_dict() for row in rows], folder)
    write_json(folder / "growth.json", payload)
