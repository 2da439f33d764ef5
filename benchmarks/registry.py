"""The list of benchmarks, the quantity of each, and a complete measurement.

This is separate from ``work_precision`` so that the record of a benchmark depends on the code that
it measures and not on that of all other benchmarks.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence

from benchmarks.first_call import first_calls
from benchmarks.record import PACKAGES, BenchmarkFailure, BenchmarkRecord, WorkPoint
from benchmarks.work_precision import Report, WorkPrecision, measure_side_by_side
from theory.parameters import ParameterError
from verification.execution.discovery import check_distinct, exposed
from verification.execution.metadata import Code, Metadata, installed_versions
from verification.quantities.quantity import Quantity
from verification.quantities.registry import quantity_named


def quantity_of(benchmark: WorkPrecision) -> Quantity:
    """Return the registered quantity that a benchmark measures."""
    return quantity_named(benchmark.name)


@functools.cache
def all_benchmarks() -> tuple[WorkPrecision, ...]:
    """Return all benchmarks of this folder, sorted by name.

    Raises
    ------
    ValueError
        If two benchmarks have the same name.
    """
    found: list[WorkPrecision] = list(exposed("benchmarks", "BENCHMARK").values())
    check_distinct("benchmarks", (benchmark.name for benchmark in found))
    return tuple(sorted(found, key=lambda benchmark: benchmark.name))


def chosen(names: Sequence[str]) -> tuple[WorkPrecision, ...]:
    """Return the named benchmarks, or all if no name is given.

    Raises
    ------
    ParameterError
        If there is no benchmark of a given name.
    """
    known = {benchmark.name: benchmark for benchmark in all_benchmarks()}
    for name in names:
        if name not in known:
            allowed = f"one of {', '.join(known)}, growth"
            raise ParameterError("quantity", name, allowed, "see 'fronts bench --list'")
    return tuple(known[name] for name in dict.fromkeys(names)) if names else tuple(known.values())


def measured(benchmark: WorkPrecision, quick: bool, report: Report) -> BenchmarkRecord:
    """Measure a benchmark and return its record; a quick one has no first calls."""
    code = Code.of([benchmark.module, *benchmark.code])  # as it is before the measurement
    points: list[WorkPoint] = []
    failures: list[BenchmarkFailure] = []
    agreement: dict[str, float] = {}
    problems = quantity_of(benchmark).timed_problems[: benchmark.quick_problems if quick else None]
    for problem in problems:
        report(f"{benchmark.name} at the problem {problem.name}: the references")
        prepared = benchmark.prepare(problem, quick, report)
        agreement[problem.name] = prepared.agreement
        settings = [each for each in prepared.settings if each.quick or not quick]
        report(f"{benchmark.name} at the problem {problem.name}: {len(settings)} settings")
        effort = benchmark.quick_effort if quick else benchmark.effort
        where = (benchmark.name, problem.name)
        done, failed = measure_side_by_side(*where, settings, effort=effort, error=benchmark.error)
        points += done
        failures += failed
        failures += [BenchmarkFailure(*where, *each) for each in prepared.failures]
    targets = benchmark.targets(points, quick, report)
    calls = () if quick else first_calls(benchmark, report)
    command = f"fronts bench {benchmark.name}" + " --quick" * quick
    return BenchmarkRecord(
        agreement=agreement,
        points=points,
        failures=failures,
        targets=targets,
        first_calls=calls,
        metadata=Metadata(command=command, versions=installed_versions(PACKAGES), code=code),
    )
