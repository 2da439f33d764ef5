"""The report as text for the terminal: counts and findings first, then the tables.

Many claims are shown short, a line or two each; a few are shown whole.
"""

from __future__ import annotations

from paper_checks.claim import Verdict
from paper_checks.report.mathml import in_letters
from paper_checks.outcome import FAILED, Outcome, slug
from paper_checks.report.document import Report
from paper_checks.report.section import Section
from paper_checks.report.table import NARROWEST, duration, table, wrapped

FEW = 8
"""Up to so many claims are shown whole."""

SHORT = 2
"""Lines of a cell where claims are shown short."""

NOTABLE = 1.0
"""Seconds of shared work from which on they are told."""

MERGED = 3
"""So many claims of one module with the same words are told in one sentence."""


def report_as_text(report: Report, width: int = 100) -> str:
    """Write counts, what differs from the record, the findings to read first, and all tables."""
    width = max(width, NARROWEST)
    parts = [_filled(_counts(report), width)]
    if report.changed:
        parts.append("\n".join(outcome.change for outcome in report.changed))
    if report.stale:
        parts.append(_stale(report, width))
    if len(report.outcomes) <= FEW:
        parts += [_whole(outcome, report, width) for outcome in report.outcomes]
        return "\n\n".join(parts)
    parts.append("To read first\n\n" + _headlines(report, width))
    if report.errata:
        parts.append(_errata(report, width))
    parts.append(_claims(report, width))
    parts += [_section(section, width) for section in report.measurements]
    parts.append("'fronts check KEY' shows a claim whole; 'fronts check --out DIR' writes it all.")
    return "\n\n".join(parts)


def _counts(report: Report) -> str:
    names = {slug(verdict): verdict.value for verdict in Verdict} | {FAILED: FAILED}
    counted = [f"{count} {names[name]}" for name, count in report.counts.items() if count]
    total = len(report.outcomes)
    of_all = "" if total == report.available else f" of {report.available}"
    claims = "claim" if total == 1 and not of_all else "claims"
    shared = f", {duration(report.shared)} of it shared" if report.shared >= NOTABLE else ""
    return f"{total}{of_all} {claims} in {duration(report.seconds)}{shared}: {', '.join(counted)}."


def _stale(report: Report, width: int) -> str:
    keys = ", ".join(one.claim.key for one in report.stale)
    return _filled(
        f"Stored, and stale: found by other code than that of this run: {keys}. "
        "'fronts check KEY --full' computes them.",
        width,
    )


def _headlines(report: Report, width: int) -> str:
    written = []
    for number, outcome in enumerate(report.headlines, 1):
        claim, finding = outcome.claim, outcome.finding
        if finding is None:
            continue
        lines = [f"{claim.place}: {claim.statement} {finding.verdict.capitalize()}."]
        if outcome.because:
            lines.append(f"Because {outcome.because}")
        printed = f"The paper: {claim.printed}. " if claim.printed else ""
        lines.append(f"{printed}Ours: {finding.value} ({claim.key})")
        text = "\n".join(_filled(line, width - 3, "   ") for line in lines)
        written.append(f"{number}. {text.lstrip()}")
    return "\n".join(written)


def _errata(report: Report, width: int) -> str:
    rows = [
        (outcome.claim.key, outcome.claim.place, erratum.fault.value, in_letters(erratum.reason))
        for outcome, erratum in report.errata
    ]
    head = ("errata", "place", "kind", "what is wrong")
    return table(head, rows, width, SHORT)


def _claims(report: Report, width: int) -> str:
    alike: dict[tuple[str, ...], list[Outcome]] = {}
    for outcome in report.outcomes:
        alike.setdefault(_words(outcome), []).append(outcome)
    rows: list[tuple[str, ...]] = []
    sentences: list[str] = []
    for outcome in report.outcomes:
        same = alike[_words(outcome)]
        if len(same) < MERGED or outcome.changed or outcome.finding is None:
            rows.append(_row(outcome))
        elif outcome is same[0]:
            keys = ", ".join(one.claim.key for one in same if not one.changed)
            value = outcome.finding.value
            sentences.append(_filled(f"{outcome.status} ({value}): {keys}", width))
    parts = ["\n".join(sentences)] if sentences else []
    if rows:
        parts.append(table(("claim", "verdict", "the paper", "ours"), rows, width, SHORT))
    return "\n\n".join(parts)


def _words(outcome: Outcome) -> tuple[str, ...]:
    """Give what claims that are told in one sentence have in common."""
    finding = outcome.finding
    said = (finding.value, finding.error, finding.tolerance) if finding else (outcome.claim.key,)
    return (outcome.entry.group, outcome.status, *said)


def _row(outcome: Outcome) -> tuple[str, ...]:
    claim, finding = outcome.claim, outcome.finding
    return (
        claim.key,
        outcome.status + _mark(outcome),
        claim.printed or "-",
        finding.value if finding else "-",
    )


def _mark(outcome: Outcome) -> str:
    mark = " (changed)" if outcome.changed and outcome.finding else ""
    return mark + (" (stored)" if outcome.judgement.stored else "")


def _whole(outcome: Outcome, report: Report, width: int) -> str:
    claim, finding = outcome.claim, outcome.finding
    head = f"{claim.key} ({claim.place}): {outcome.status}{_mark(outcome)}"
    lines = [claim.statement]
    if outcome.because:
        lines.append(f"Because {outcome.because}")
    if claim.printed:
        lines.append(f"The paper: {claim.printed}")
    if finding:
        lines += [
            f"Ours: {finding.value}",
            f"Error: {finding.error}",
            f"By: {finding.methods[0]}; and {finding.methods[1]}",
            f"Tolerance: {finding.tolerance}",
            *(part for part in finding.explanation.split("\n\n") if part.strip()),
        ]
    figures = report.shown_by[claim.key]
    if figures:
        lines.append(f"Figure: {', '.join(figures)}")
    lines.append(f"Reproduce with: {claim.command}")
    return "\n".join([head, *(_filled(line, width - 2, "  ") for line in lines)])


def _section(section: Section, width: int) -> str:
    """Write a table of measurements, a line a row."""
    return f"{section.title} (stored)\n\n{table(section.head, section.rows, width, 1)}"


def _filled(text: str, width: int, indent: str = "") -> str:
    return "\n".join(indent + line for line in wrapped(text, width))
