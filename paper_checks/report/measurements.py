"""Measurements that the report shows beside the claims: speed, cost, extreme cases, work reduction.

They come from stored records, which the benchmarks and ``fronts stress --record`` write into
``benchmarks/results`` of the source tree; nothing is measured for the report itself. An installed
package has no records, and then no such section.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path

from paper_checks.report.method_sections import defaults, first_calls, problems
from paper_checks.report.section import Diagram, Failure, Json, Section, origin_of, warned

RESULTS = Path(__file__).parents[2] / "benchmarks" / "results"


def stored_sections() -> tuple[Section, ...]:
    """Read the sections for which there are records; none where there is no folder."""
    folder = RESULTS
    records = {path.stem: _read(path) for path in sorted(folder.glob("*.json"))}
    makers: tuple[Callable[[Mapping[str, Json], Path], Section | None], ...] = (
        _speed,
        lambda records, _: first_calls(records),
        lambda records, _: defaults(records),
        lambda records, _: problems(records),
        _growth,
        _stability,
        _work_reduction,
    )
    return tuple(section for maker in makers if (section := maker(records, folder)))


def _read(path: Path) -> Json:
    content: Json = json.loads(path.read_text(encoding="utf-8"))
    return content


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


def _speed(records: Mapping[str, Json], folder: Path) -> Section | None:
    measured = {name: record for name, record in records.items() if "targets" in record}
    if not measured:
        return None
    rows = [
        (
            name,
            target["claim"],
            f"{target['relation']} {target['limit']:g} {target['unit']}".strip(),
            "-" if target["measured"] is None else f"{target['measured']:.3g}",
            target["verdict"],
        )
        for name, record in measured.items()
        for target in record["targets"]
        if target["limit"] is not None
    ]
    diagrams = (_diagram(name, record, folder) for name, record in measured.items())
    return Section(
        "speed",
        "Error against run time",
        warned(
            "Each quantity by our methods and by what a user would otherwise pick, in one run. The "
            "table has what was promised; the diagrams have every setting of every method. Pale "
            "marks are settings that another one of the same method beats.",
            measured,
        ),
        ("Quantity", "What is compared", "Required", "Measured", "Verdict"),
        tuple(rows),
        tuple(origin_of(record) for record in measured.values()),
        tuple(diagram for diagram in diagrams if diagram),
    )


def _growth(records: Mapping[str, Json], folder: Path) -> Section | None:
    if "growth" not in records:
        return None
    record = records["growth"]
    rows = []
    for line in record["lines"]:
        memory = line["memory_exponent"]
        rows.append(
            (
                line["name"],
                f"{line['size_name']}, {line['sizes'][0]:g} to {line['sizes'][-1]:g}",
                f"{line['seconds'][0]:.2g} to {line['seconds'][-1]:.2g} s",
                f"{line['exponent']:.2f}",
                f"{line['expected']:g}: {line['why']}",
                line.get("remark", ""),
                "-" if memory is None else f"{memory:.2f}",
            )
        )
    diagram = _diagram("growth", record, folder)
    return Section(
        "growth",
        "Cost as the work grows",
        warned("Time is fitted by a power of the size.", {"growth": record}),
        ("What", "Size", "Time", "Power", "Expected", "Why they differ", "Power of memory"),
        tuple(rows),
        (origin_of(record),),
        (diagram,) if diagram else (),
    )


OUTCOMES = ("right", "refused", "undecided", "unchecked", "exceeded", "nan", "crash", "slow")


def _tried_over(line: Json) -> tuple[str, str]:
    """Return what the quantity is and its ranges; a record from before they were kept has none."""
    ends = f" ({line['ends']})" if line.get("ends") else ""
    return line.get("what", ""), line.get("over", "") + ends


def _stability(records: Mapping[str, Json], folder: Path) -> Section | None:
    if "stability" not in records:
        return None
    record = records["stability"]
    rows = [
        (
            line["quantity"],
            *_tried_over(line),
            str(line["points"]),
            *(str(line["counts"].get(outcome, "-")) for outcome in OUTCOMES),
            f"{line['slowest']:.2g} s",
        )
        for line in record["quantities"]
    ]
    total = (
        "all",
        "",
        "",
        str(record["points"]),
        *(str(record["counts"].get(one, "-")) for one in OUTCOMES),
        "",
    )
    return Section(
        "stability",
        "Stiff and extreme cases",
        warned(
            "Every quantity over all decades of its parameters, at the test problems, at the "
            "corners and at random, each value held against another method. Undecided: that one is "
            "too uncertain to confirm the error stated. Unchecked: no other method reaches there. "
            "The last four kinds must be zero: a stated error exceeded, not a number, a crash, "
            "slower than its limit. Where a range ends before its parameter does, the reason is "
            "beside it.",
            {"the table": record},
        ),
        ("Quantity", "What", "Over", "Points", *(one.capitalize() for one in OUTCOMES), "Slowest"),
        (*rows, total),
        (origin_of(record),),
    )


def _work_reduction(records: Mapping[str, Json], folder: Path) -> Section | None:
    if "work_reduction" not in records:
        return None
    record = records["work_reduction"]
    return Section(
        "work-reduction",
        "What is not computed",
        warned(
            "What is truncated or not computed, how the code decides, and the bound on what that "
            "changes. Each case was computed with the omission and without it, to the same "
            "accuracy: how far the two results were apart, how far they could be (by the bound, "
            "and by the error of the result without the omission where it has one), and both "
            "costs. The test asserts the bound in other cases too.",
            {"the table": record},
        ),
        ("What", "How it is decided", "Bound", "Changed", "Cost", "Test"),
        tuple(
            (
                row["what"],
                row["decided"],
                row["bound"],
                row["changed"],
                row["measured"],
                row["test"],
            )
            for row in record["work_reduction"]
        ),
        (origin_of(record),),
    )
