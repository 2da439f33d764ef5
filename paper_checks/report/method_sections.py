"""The tables about the methods: their first calls, the test problems, and which is the default."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from paper_checks.report.section import Json, Origin, Section, origin_of, warned
from verification.quantities.registry import all_quantities


def first_calls(records: Mapping[str, Json]) -> Section | None:
    """Return what the methods cost before their first value; None if no record has it."""
    measured = {name: record for name, record in records.items() if record.get("first_calls")}
    if not measured:
        return None
    rows = [
        (
            name,
            call["method"],
            *("-" if call[when] is None else f"{call[when]:.2g} s" for when in _WHEN),
            call["reason"],
        )
        for name, record in measured.items()
        for call in record["first_calls"]
    ]
    return Section(
        "first-calls",
        "First calls",
        warned(
            "What a method costs before it gives its first value, each in a process of its own. "
            "Cold: nothing was compiled before. Loaded: the next process, which finds on disk what "
            "the first one compiled. Again: the second call there. Seconds of the wall; what the "
            "benchmark itself imports before is not counted.",
            measured,
        ),
        ("Quantity", "Method", "Cold", "Loaded", "Again", "No value because"),
        tuple(rows),
        tuple(origin_of(record) for record in measured.values()),
    )


_WHEN = ("cold", "loaded", "again")


def problems(records: Mapping[str, Json]) -> Section | None:
    """Return the table of test problems with their references; None if nothing was measured."""
    apart = {
        (name, problem): distance
        for name, record in records.items()
        for problem, distance in record.get("agreement", {}).items()
    }
    if not any("agreement" in record for record in records.values()):
        return None
    rows = [
        (
            quantity.name,
            problem.name,
            ", ".join(problem.tags),
            ", ".join(f"{name} = {value:.6g}" for name, value in problem.values.items()),
            quantity.reference,
            f"{quantity.accuracy:.0e}",
            f"{apart[key]:.0e}" if (key := (quantity.name, problem.name)) in apart else "-",
        )
        for quantity in all_quantities()
        for problem in quantity.test_problems
    ]
    return Section(
        "problems",
        "The test problems",
        "Where the quantities are computed by tests, benchmarks and the stability table, and how "
        "the true value is known there: the independent method, to what accuracy, and how far the "
        "two references were apart where error and run time were measured.",
        ("Quantity", "Problem", "Tags", "Parameters", "Reference", "To within", "Measured apart"),
        tuple(rows),
        tuple(origin_of(record) for record in records.values() if "agreement" in record),
    )


def defaults(records: Mapping[str, Json]) -> Section | None:
    """Return where each default is the fastest, and why it is the default elsewhere."""
    if "defaults" not in records:
        return None
    rows = []
    for choice in records["defaults"]["choices"]:
        rows.append(
            (
                choice["quantity"],
                choice["problem"],
                choice["default"],
                _decades(choice["fastest"]) or "nowhere",
                _rivals(choice["beaten"]) or "nowhere",
                "; ".join(f"{by}: {why}" for by, why in choice.get("reasons", {}).items()) or "-",
                "; ".join(f"{by}: {what}" for by, what in choice.get("others", {}).items()) or "-",
            )
        )
    named = dict.fromkeys(choice["quantity"] for choice in records["defaults"]["choices"])
    dates = sorted({choice["recorded"] for choice in records["defaults"]["choices"]})
    return Section(
        "defaults",
        "The default methods",
        warned(
            "At each error asked for, is the default the fastest? Where it is not, the table says "
            "what is, by how much, and why the default is the default all the same. Methods that "
            "solve another problem are in the diagrams and are not compared.",
            {name: records[name] for name in named if name in records},
        ),
        (
            "Quantity",
            "Test problem",
            "Default",
            "Fastest at errors",
            "Another one is faster at",
            "Why it is the default all the same",
            "Solve another problem",
        ),
        tuple(rows),
        (Origin("fronts bench --defaults", f"{dates[0]} to {dates[-1]}", "as above"),),
    )


def _rivals(beaten: Iterable[Json]) -> str:
    """Write which methods are faster than the default, at which errors and by what factor."""
    rivals: dict[str, list[Json]] = {}
    for one in beaten:
        rivals.setdefault(one["by"], []).append(one)
    texts = []
    for rival, ones in rivals.items():
        factors = [one["factor"] for one in ones if one["factor"] is not None]
        texts.append(f"{_decades(one['error'] for one in ones)}: {rival}")
        if factors:
            low, high = f"{min(factors):.2g}", f"{max(factors):.2g}"
            texts[-1] += f", {low} times" if low == high else f", {low} to {high} times"
        if len(factors) < len(ones):
            texts[-1] += ", and the default does not get so far"
    return "; ".join(texts)


def _decades(errors: Iterable[float]) -> str:
    """Write powers of ten, runs of neighbours as ranges.

    Examples
    --------
    >>> _decades([1e-3, 1e-4, 1e-5, 1e-8])
    '10⁻³ to 10⁻⁵, 10⁻⁸'
    """
    runs: list[list[float]] = []
    for error in errors:
        if runs and abs(runs[-1][-1] / error - 10.0) < 0.1:
            runs[-1].append(error)
        else:
            runs.append([error])
    return ", ".join(
        _power(run[0]) + (f" to {_power(run[-1])}" if len(run) > 1 else "") for run in runs
    )


def _power(value: float) -> str:
    """Write a power of ten."""
    exponent = str(round(math.log10(value)))
    return "10" + exponent.translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
