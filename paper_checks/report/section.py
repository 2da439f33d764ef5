"""A table of stored measurements, and the origin of its numbers."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from verification.execution.metadata import staleness

Row = tuple[str, ...]
Json = Mapping[str, Any]

WORDS = {
    "sum": "Sum of (53)",
    "roots": "Roots of the dispersion relation (50)",
    "velocity": "Velocities that solve (54)",
    "breather": "Breather of (8): amplitudes",
    "multipliers": "Floquet multipliers of the breather",
    "chain": "Motion of the chain (8)",
    "friction": "Motion of the friction chain (5)",
    "front": "Front velocity from a run",
    "map": "Map of states",
    "derivation": "Derivation of the averaged equations",
    "growth": "Cost as the work grows",
}
"""Titles for the names of the records."""

_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")


@dataclass(frozen=True)
class Origin:
    """Origin of numbers: the command that produced them, the date, and the versions used."""

    command: str
    date: str
    machine: str
    stale: str = ""
    """Why the numbers do not belong to the present code; empty if they do."""


@dataclass(frozen=True)
class Failure:
    """A setting of a method that gave no value, with the reason."""

    method: str
    problem: str
    knob: str
    reason: str


@dataclass(frozen=True)
class Diagram:
    """A picture of a section, its numbers as CSV, and what could not be measured for it."""

    name: str
    svg: str
    failures: tuple[Failure, ...]
    data: str = ""

    @property
    def title(self) -> str:
        """What is measured."""
        return in_words(self.name)


@dataclass(frozen=True)
class Section:
    """One table of the report.

    Attributes
    ----------
    key, title, lead : str
        Name in addresses, heading, and an introduction to the table.
    head : tuple of str
        Names of the columns.
    rows : tuple of tuple of str
        Cells.
    origins : tuple of Origin
        Origins of the records from which the table was made.
    diagrams : tuple of Diagram
        Pictures below the table.
    """

    key: str
    title: str
    lead: str
    head: Row
    rows: tuple[Row, ...]
    origins: tuple[Origin, ...]
    diagrams: tuple[Diagram, ...] = ()

    def as_dict(self) -> dict[str, object]:
        """Return the table for JSON, without its pictures."""
        return {
            "key": self.key,
            "title": self.title,
            "head": list(self.head),
            "rows": [list(row) for row in self.rows],
            "stored": [vars(origin) for origin in self.origins],
        }


def origin_of(record: Json) -> Origin:
    """Return the origin of a record, with the versions used for the measurement."""
    machine = record["machine"]
    versions = ", ".join(
        f"{name} {version}"
        for name, version in record["versions"].items()
        if version not in (None, "not installed")
    )
    where = f"{machine['processor']}, {machine['cores']} cores; {versions}"
    return Origin(record["command"], record["date"], where, staleness(record.get("code")))


def warned(lead: str, records: Mapping[str, Json]) -> str:
    """Add to an introduction which of the underlying records are stale, and why."""
    reasons: dict[str, list[str]] = {}
    for name, record in records.items():
        if why := staleness(record.get("code")):
            reasons.setdefault(why, []).append(name)
    return lead + "".join(f" Stale: {', '.join(names)}; {why}." for why, names in reasons.items())


def grouped(failures: Sequence[Failure]) -> dict[tuple[str, str], str]:
    """Group failures by method and reason, and list the settings of each group.

    Reasons count as equal if they differ in numbers only; the first one is given.

    Examples
    --------
    >>> grouped([Failure("quad", "narrow", "1e-6", "12 lost"),
    ...          Failure("quad", "narrow", "1e-9", "15 lost"),
    ...          Failure("quad", "wide", "1e-6", "no root")])
    {('quad', '12 lost'): 'narrow: 1e-6, 1e-9', ('quad', 'no root'): 'wide: 1e-6'}
    """
    reasons: dict[tuple[str, str], str] = {}
    settings: dict[tuple[str, str], dict[str, list[str]]] = {}
    for one in failures:
        kind = (one.method, _NUMBER.sub("#", one.reason))
        reasons.setdefault(kind, one.reason)
        settings.setdefault(kind, {}).setdefault(one.problem, []).append(one.knob)
    return {
        (kind[0], reasons[kind]): "; ".join(
            f"{problem}: {', '.join(knobs)}" for problem, knobs in problems.items()
        )
        for kind, problems in settings.items()
    }


def in_words(quantity: str) -> str:
    """Return the title of a measured quantity; an unknown quantity keeps its name.

    Examples
    --------
    >>> in_words("roots"), in_words("other")
    ('Roots of the dispersion relation (50)', 'other')
    """
    return WORDS.get(quantity, quantity)
