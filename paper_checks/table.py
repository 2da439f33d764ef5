"""The report as text for the terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from paper_checks.claim import Verdict
from paper_checks.discover import Entry
from paper_checks.outcome import FAILED, Outcome, slug
from paper_checks.report import Report

NARROWEST = 60
"""Below this many columns a table cannot be read; lines wrap in the terminal instead."""


def report_as_text(report: Report, width: int = 100) -> str:
    """Give the table of claims, the counts, and what differs from the record."""
    rows = [_row(outcome) for outcome in report.outcomes]
    parts = [_table(("claim", "place", "verdict", "the paper", "ours"), rows, width)]
    if report.errata:
        parts.append(_errata(report, width))
    parts.append(_counts(report))
    if report.stale:
        parts.append(
            "\n".join(
                f"{one.claim.key}: stored, and stale: found by other code than that of this run. "
                f"'fronts check {one.claim.key} --full' computes it."
                for one in report.stale
            )
        )
    if report.changed:
        parts.append("\n".join(outcome.change for outcome in report.changed))
    return "\n\n".join(parts)


def entries_as_text(entries: Sequence[Entry], width: int = 100) -> str:
    """Give the table of claims that have not been judged."""
    rows = [
        (one.claim.key, one.claim.place, slug(one.claim.recorded), one.claim.statement)
        for one in entries
    ]
    return _table(("claim", "place", "on record", "statement"), rows, width)


def _errata(report: Report, width: int) -> str:
    rows = [
        (outcome.claim.place, erratum.fault.value, erratum.reason, outcome.claim.key)
        for outcome, erratum in report.errata
    ]
    return _table(("errata", "kind", "what is wrong", "proved under"), rows, width)


def duration(seconds: float) -> str:
    """Write a time for people.

    Examples
    --------
    >>> [duration(seconds) for seconds in (0.0123, 4.56, 59.96, 754.2)]
    ['0.01 s', '4.6 s', '1 min 0 s', '12 min 34 s']
    """
    if seconds < 1:
        return f"{seconds:.2f} s"
    if seconds < 59.95:
        return f"{seconds:.1f} s"
    whole = round(seconds)
    return f"{whole // 60} min {whole % 60} s"


def _row(outcome: Outcome) -> tuple[str, ...]:
    claim, finding = outcome.claim, outcome.finding
    mark = " (changed)" if outcome.changed and finding else ""
    mark += " (stored)" if outcome.judgement.stored else ""
    ours = f"{finding.value} [error: {finding.error}]" if finding else ""
    return (claim.key, claim.place, outcome.status + mark, claim.printed or "-", ours or "-")


def _counts(report: Report) -> str:
    names = {slug(verdict): verdict.value for verdict in Verdict} | {FAILED: FAILED}
    counted = [f"{count} {names[name]}" for name, count in report.counts.items() if count]
    total = len(report.outcomes)
    of_all = "" if total == report.available else f" of {report.available}"
    claims = "claim" if total == 1 and not of_all else "claims"
    return f"{total}{of_all} {claims} in {duration(report.seconds)}: {', '.join(counted)}."


def _table(head: Sequence[str], rows: Sequence[Sequence[str]], width: int) -> str:
    widths = _widths([head, *rows], max(width, NARROWEST))
    lines = [*_lines(head, widths), "  ".join("-" * columns for columns in widths)]
    for row in rows:
        lines += _lines(row, widths)
    return "\n".join(lines)


def _lines(cells: Sequence[str], widths: Sequence[int]) -> list[str]:
    wrapped = [
        textwrap.wrap(" ".join(cell.split()), columns) or [""]
        for cell, columns in zip(cells, widths, strict=True)
    ]
    height = max(map(len, wrapped))
    return [
        "  ".join(
            (lines[i] if i < len(lines) else "").ljust(columns)
            for lines, columns in zip(wrapped, widths, strict=True)
        ).rstrip()
        for i in range(height)
    ]


def _widths(table: Sequence[Sequence[str]], width: int) -> list[int]:
    """Give each column what its longest cell needs; the widest ones yield when space is short."""
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    room = width - 2 * (len(widths) - 1)
    while sum(widths) > room:
        widths[widths.index(max(widths))] -= 1
    return widths
