"""Measurements that the report shows beside the claims: speed, cost, extreme cases, savings.

They come from stored records, which the benchmarks and ``fronts stress --record`` write into
``benchmarks/results`` of the source tree; nothing is measured for the report itself. An installed
package has no records, and then no such section.
"""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).parents[1] / "benchmarks" / "results"

Row = tuple[str, ...]
Json = Mapping[str, Any]


@dataclass(frozen=True)
class Stamp:
    """Where numbers come from: the command that gave them, when, and with what."""

    command: str
    date: str
    machine: str


@dataclass(frozen=True)
class Failure:
    """A setting of a method that gave no value, and why."""

    method: str
    scene: str
    knob: str
    reason: str


@dataclass(frozen=True)
class Diagram:
    """A picture of a section, its numbers as CSV, and what could not be measured for it."""

    name: str
    svg: str
    failures: tuple[Failure, ...]
    data: str = ""


@dataclass(frozen=True)
class Section:
    """One table of the report.

    Attributes
    ----------
    key, title, lead : str
        Name in addresses, heading, and what the table is.
    head : tuple of str
        Names of the columns.
    rows : tuple of tuple of str
        Cells.
    stamps : tuple of Stamp
        Of the records it was read from.
    diagrams : tuple of Diagram
        Pictures below the table.
    """

    key: str
    title: str
    lead: str
    head: Row
    rows: tuple[Row, ...]
    stamps: tuple[Stamp, ...]
    diagrams: tuple[Diagram, ...] = ()

    def as_dict(self) -> dict[str, object]:
        """Give the table for JSON, without its pictures."""
        return {
            "key": self.key,
            "title": self.title,
            "head": list(self.head),
            "rows": [list(row) for row in self.rows],
            "stored": [vars(stamp) for stamp in self.stamps],
        }


def stored_sections() -> tuple[Section, ...]:
    """Read the sections for which there are records; none where there is no folder."""
    folder = RESULTS
    records = {path.stem: _read(path) for path in sorted(folder.glob("*.json"))}
    makers: tuple[Callable[[Mapping[str, Json], Path], Section | None], ...] = (
        _speed,
        _defaults,
        _growth,
        _stability,
        _savings,
    )
    return tuple(section for maker in makers if (section := maker(records, folder)))


def _read(path: Path) -> Json:
    content: Json = json.loads(path.read_text(encoding="utf-8"))
    return content


def _stamp(record: Json) -> Stamp:
    machine = record["machine"]
    return Stamp(
        record["command"], record["date"], f"{machine['processor']}, {machine['cores']} cores"
    )


def _diagram(name: str, record: Json, folder: Path) -> Diagram | None:
    picture = folder / f"{name}.svg"
    if not picture.is_file():
        return None
    failures = tuple(
        Failure(one["method"], one["scene"], str(one["knob"]), one["reason"])
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
        "Each quantity by our methods and by what a user would otherwise pick, in one run. The "
        "table has what was promised; the diagrams have every setting of every method.",
        ("Quantity", "What is compared", "Wanted", "Measured", "Verdict"),
        tuple(rows),
        tuple(_stamp(record) for record in measured.values()),
        tuple(diagram for diagram in diagrams if diagram),
    )


def _defaults(records: Mapping[str, Json], folder: Path) -> Section | None:
    if "defaults" not in records:
        return None
    rows = []
    for choice in records["defaults"]["choices"]:
        rows.append(
            (
                choice["quantity"],
                choice["scene"],
                choice["default"],
                _decades(choice["fastest"]) or "nowhere",
                _rivals(choice["beaten"]) or "nowhere",
            )
        )
    dates = sorted({choice["recorded"] for choice in records["defaults"]["choices"]})
    return Section(
        "defaults",
        "The default methods",
        "Chosen from the diagrams: at each error asked for, is the default the fastest? Where it "
        "is not, the table says what is, and by how much.",
        ("Quantity", "Scene", "Default", "Fastest at errors", "Another one is faster at"),
        tuple(rows),
        (Stamp("fronts bench --defaults", f"{dates[0]} to {dates[-1]}", "as above"),),
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
                "-" if memory is None else f"{memory:.2f}",
            )
        )
    diagram = _diagram("growth", record, folder)
    return Section(
        "growth",
        "Cost as the work grows",
        "Time is fitted by a power of the size.",
        ("What", "Size", "Time", "Power", "Expected", "Power of memory"),
        tuple(rows),
        (_stamp(record),),
        (diagram,) if diagram else (),
    )


OUTCOMES = ("right", "refused", "unchecked", "exceeded", "nan", "crash", "slow")


def _stability(records: Mapping[str, Json], folder: Path) -> Section | None:
    if "stability" not in records:
        return None
    record = records["stability"]
    rows = [
        (
            line["quantity"],
            str(line["points"]),
            *(str(line["counts"][outcome]) for outcome in OUTCOMES),
            f"{line['slowest']:.2g} s",
        )
        for line in record["quantities"]
    ]
    total = ("all", str(record["points"]), *(str(record["counts"][one]) for one in OUTCOMES), "")
    return Section(
        "stability",
        "Stiff and extreme cases",
        "Every quantity over all decades of its parameters, at named scenes, at the corners and at "
        "random, each value held against another method. Unchecked: no other method reaches there. "
        "The last four kinds must be zero: a stated error exceeded, not a number, a crash, slower "
        "than its limit.",
        ("Quantity", "Points", *(one.capitalize() for one in OUTCOMES), "Slowest"),
        (*rows, total),
        (_stamp(record),),
    )


def _savings(records: Mapping[str, Json], folder: Path) -> Section | None:
    if "savings" not in records:
        return None
    record = records["savings"]
    return Section(
        "savings",
        "What a scene does not need",
        "What is left out, how the code decides, and the bound on what that changes. Each scene "
        "was computed with the omission and without it, to the same accuracy: how far the two "
        "results were apart, how far they could be (by the bound, and by the error of the result "
        "without the omission where it has one), and both costs. The test asserts the bound in "
        "other scenes too.",
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
            for row in record["savings"]
        ),
        (_stamp(record),),
    )
