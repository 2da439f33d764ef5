"""Measurements shown beside the claims: speed, cost, extreme cases, work reduction.

They are read from stored records, which the benchmarks and ``fronts stress --record`` write into
``benchmarks/results`` of the source tree; nothing is measured for the report itself. An installed
package has no records, and then these sections are absent.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from derivations.algebra.notation import raised
from paper_checks.report.section import Diagram, Failure, Json, Origin, Section, origin_of, warned
from verification.quantities.registry import all_quantities

RESULTS = Path(__file__).parents[2] / "benchmarks" / "results"

Records = Mapping[str, Json]
Columns = Mapping[str, Callable[..., str]]
"""Functions that produce the cells of a row, by the heading of the column."""


def stored_sections() -> tuple[Section, ...]:
    """Read the sections for which there are records; none if the folder does not exist."""
    folder = RESULTS
    records = {path.stem: _read(path) for path in sorted(folder.glob("*.json"))}
    makers = (_speed, _first_calls, _defaults, _problems, _growth, _stability, _work_reduction)
    return tuple(section for maker in makers if (section := maker(records, folder)))


def _read(path: Path) -> Json:
    content: Json = json.loads(path.read_text(encoding="utf-8"))
    return content


def _section(
    key: str, title: str, lead: str, *, records: Records, lines: Iterable[object], columns: Columns
) -> Section:
    """Return a table with one row per line; its introduction names the stale records."""
    return Section(
        key,
        title,
        warned(lead, records),
        tuple(columns),
        tuple(tuple(cell(line) for cell in columns.values()) for line in lines),
        tuple(origin_of(record) for record in records.values()),
    )


def _known(value: float | None, spec: str, unit: str = "") -> str:
    """Write a number, or a dash if it is unknown."""
    return "-" if value is None else f"{value:{spec}}{unit}"


def _diagram(name: str, record: Json, folder: Path) -> Diagram | None:
    picture = folder / f"{name}.svg"
    if not picture.is_file():
        return None
    failures = tuple(
        Failure(one["method"], one["problem"], str(one["knob"]), one["reason"])
        for one in record.get("failures", ())
    )
    numbers = folder / f"{name}.csv"
    data = numbers.read_text(encoding="utf-8") if numbers.is_file() else ""
    return Diagram(name, picture.read_text(encoding="utf-8"), failures, data)


def _speed(records: Records, folder: Path) -> Section | None:
    measured = {name: record for name, record in records.items() if "targets" in record}
    if not measured:
        return None
    found = _section(
        "speed",
        "Error against run time",
        "Each quantity is computed by our methods and by the programs that one would otherwise "
        "use, in one run. The table compares the results with the targets, and the diagrams show "
        "every setting of every method. Marks are pale where another setting of the same method "
        "is both faster and more accurate.",
        records=measured,
        lines=(
            {"quantity": name, **target}
            for name, record in measured.items()
            for target in record["targets"]
            if target["limit"] is not None
        ),
        columns={
            "Quantity": lambda x: x["quantity"],
            "What is compared": lambda x: x["claim"],
            "Required": lambda x: f"{x['relation']} {x['limit']:g} {x['unit']}".strip(),
            "Measured": lambda x: _known(x["measured"], ".3g"),
            "Verdict": lambda x: x["verdict"],
        },
    )
    diagrams = (_diagram(name, record, folder) for name, record in measured.items())
    return replace(found, diagrams=tuple(diagram for diagram in diagrams if diagram))


def _first_calls(records: Records, folder: Path) -> Section | None:
    """Return what the methods cost before their first value."""
    measured = {name: record for name, record in records.items() if record.get("first_calls")}
    if not measured:
        return None
    return _section(
        "first-calls",
        "First calls",
        "The time until a method returns its first value, each in a process of its own. "
        "Cold: nothing was compiled before. Loaded: the next process, which finds the compiled "
        "code on disk. Again: the second call in that process. Times are wall-clock seconds; the "
        "imports of the benchmark itself are not counted.",
        records=measured,
        lines=(
            {"quantity": name, **call}
            for name, record in measured.items()
            for call in record["first_calls"]
        ),
        columns={
            "Quantity": lambda x: x["quantity"],
            "Method": lambda x: x["method"],
            "Cold": lambda x: _known(x["cold"], ".2g", " s"),
            "Loaded": lambda x: _known(x["loaded"], ".2g", " s"),
            "Again": lambda x: _known(x["again"], ".2g", " s"),
            "No value because": lambda x: x["reason"],
        },
    )


def _defaults(records: Records, folder: Path) -> Section | None:
    """Return where each default is the fastest, and why it is the default where it is not."""
    if "defaults" not in records:
        return None
    choices = records["defaults"]["choices"]
    named = dict.fromkeys(choice["quantity"] for choice in choices)
    dates = sorted({choice["recorded"] for choice in choices})
    found = _section(
        "defaults",
        "The default methods",
        "Errors at which the default method is the fastest. Where it is not, the table names the "
        "faster method, the factor, and the reason for the default. Methods that solve another "
        "problem appear in the diagrams and are not compared.",
        records={name: records[name] for name in named if name in records},
        lines=choices,
        columns={
            "Quantity": lambda x: x["quantity"],
            "Test problem": lambda x: x["problem"],
            "Default": lambda x: x["default"],
            "Fastest at errors": lambda x: _decades(x["fastest"]) or "nowhere",
            "Another one is faster at": lambda x: _rivals(x["beaten"]) or "nowhere",
            "Reason for the default": lambda x: _listed(x.get("reasons", {})),
            "Solve another problem": lambda x: _listed(x.get("others", {})),
        },
    )
    origin = Origin("fronts bench --defaults", f"{dates[0]} to {dates[-1]}", "as above")
    return replace(found, origins=(origin,))


def _problems(records: Records, folder: Path) -> Section | None:
    """Return the test problems with their references."""
    measured = {name: record for name, record in records.items() if "agreement" in record}
    if not measured:
        return None

    def apart(quantity: str, problem: str) -> str:
        return _known(measured.get(quantity, {}).get("agreement", {}).get(problem), ".0e")

    return _section(
        "problems",
        "The test problems",
        "The parameters at which tests, benchmarks and the robustness table compute the "
        "quantities, with the independent method that gives the true value, its accuracy, and "
        "the distance between the two references in the measurement of error and run time.",
        records=measured,
        lines=((each, problem) for each in all_quantities() for problem in each.test_problems),
        columns={
            "Quantity": lambda x: x[0].name,
            "Problem": lambda x: x[1].name,
            "Tags": lambda x: ", ".join(x[1].tags),
            "Parameters": lambda x: ", ".join(f"{k} = {v:.6g}" for k, v in x[1].values.items()),
            "Reference": lambda x: x[0].reference,
            "To within": lambda x: f"{x[0].accuracy:.0e}",
            "Measured apart": lambda x: apart(x[0].name, x[1].name),
        },
    )


def _growth(records: Records, folder: Path) -> Section | None:
    if "growth" not in records:
        return None
    record = records["growth"]
    found = _section(
        "growth",
        "Cost as the work grows",
        "Time is fitted by a power of the size.",
        records={"growth": record},
        lines=record["lines"],
        columns={
            "What": lambda x: x["name"],
            "Size": lambda x: f"{x['size_name']}, {x['sizes'][0]:g} to {x['sizes'][-1]:g}",
            "Time": lambda x: f"{x['seconds'][0]:.2g} to {x['seconds'][-1]:.2g} s",
            "Power": lambda x: f"{x['exponent']:.2f}",
            "Expected": lambda x: f"{x['expected']:g}: {x['why']}",
            "Reason for the difference": lambda x: x.get("remark", ""),
            "Power of memory": lambda x: _known(x["memory_exponent"], ".2f"),
        },
    )
    diagram = _diagram("growth", record, folder)
    return replace(found, diagrams=(diagram,) if diagram else ())


OUTCOMES = ("right", "refused", "undecided", "unchecked", "exceeded", "nan", "crash", "slow")


def _stability(records: Records, folder: Path) -> Section | None:
    if "stability" not in records:
        return None
    record = records["stability"]
    total = {"quantity": "all", "points": record["points"], "counts": record["counts"]}
    return _section(
        "stability",
        "Stiff and extreme cases",
        "Every quantity over all decades of its parameters, at the test problems, at the "
        "corners and at random, each value held against another method. Undecided: that one is "
        "too uncertain to confirm the error stated. Unchecked: no other method reaches there. "
        "The last four kinds must be zero: a stated error exceeded, not a number, a crash, "
        "slower than its limit. Where a range ends before its parameter does, the reason is "
        "beside it.",
        records={"the table": record},
        lines=[*record["quantities"], total],
        columns={
            "Quantity": lambda x: x["quantity"],
            "What": lambda x: x.get("what", ""),
            "Over": lambda x: x.get("over", "") + (f" ({x['ends']})" if x.get("ends") else ""),
            "Points": lambda x: str(x["points"]),
            **{
                one.capitalize(): lambda x, one=one: str(x["counts"].get(one, "-"))
                for one in OUTCOMES
            },
            "Slowest": lambda x: f"{x['slowest']:.2g} s" if "slowest" in x else "",
        },
    )


def _work_reduction(records: Records, folder: Path) -> Section | None:
    if "work_reduction" not in records:
        return None
    record = records["work_reduction"]
    return _section(
        "work-reduction",
        "What is not computed",
        "Computations that are truncated or omitted, the criterion for this, and a bound on the "
        "resulting change. Each case was computed with and without the omission, to the same "
        "accuracy. The table gives the difference of the two results, the largest difference "
        "possible (by the bound, and by the error of the result without the omission where it "
        "has one), and both costs. The test verifies the bound in other cases too.",
        records={"the table": record},
        lines=record["work_reduction"],
        columns={
            "What": lambda x: x["what"],
            "How it is decided": lambda x: x["decided"],
            "Bound": lambda x: x["bound"],
            "Changed": lambda x: x["changed"],
            "Cost": lambda x: x["measured"],
            "Test": lambda x: x["test"],
        },
    )


def _listed(sentences: Mapping[str, str]) -> str:
    """Write the remark on each method, or a dash if there are none."""
    return "; ".join(f"{by}: {said}" for by, said in sentences.items()) or "-"


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
    """Write powers of ten, with consecutive ones as ranges.

    Examples
    --------
    >>> _decades([1e-3, 1e-4, 1e-5, 1e-8])
    '10⁻³ to 10⁻⁵, 10⁻⁸'
    >>> _decades([1e-5, 1e-4])
    '10⁻⁵, 10⁻⁴'
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
    return f"10{raised(round(math.log10(value)))}"
