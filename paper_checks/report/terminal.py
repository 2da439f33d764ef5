"""The report as text for the terminal: ten lines for many claims, in full for a few."""

from __future__ import annotations

import textwrap

from paper_checks.claim import Verdict
from paper_checks.finding import Finding
from paper_checks.outcome import FAILED, JudgedClaim, slug
from paper_checks.report.document import Report
from paper_checks.report.table import NARROWEST, duration

FEW = 8
"""Largest number of claims that are shown in full."""
NAMED = 6
"""Largest number of keys that are listed; the rest is counted."""


def report_as_text(report: Report, width: int) -> str:
    """Write the counts, changed verdicts, stale evidence, and three findings.

    A few claims are shown in full instead.
    """
    width = max(width, NARROWEST)
    lines = [_counts(report), _methods(report)]
    if report.changed:
        lines += [one.change for one in report.changed[:NAMED]]
        if len(report.changed) > NAMED:
            lines.append(f"… and {len(report.changed) - NAMED} more.")
    else:
        lines.append("Every verdict agrees with the recorded one.")
    if report.stale:
        keys = _named([one.claim.key for one in report.stale])
        lines.append(f"Stale stored findings: {keys}; 'fronts check KEY --full' computes them.")
    if len(report.outcomes) <= FEW:
        text = "\n".join(_filled(line, width) for line in lines)
        return "\n\n".join([text, *(_whole(one, report, width) for one in report.outcomes)])
    lines += [_headline(*one) for one in report.headlines]
    lines.append(f"{len(report.errata)} errata. 'fronts check KEY' shows a claim whole.")
    return "\n".join(lines)


def _counts(report: Report) -> str:
    names = {slug(verdict): verdict.value for verdict in Verdict} | {FAILED: FAILED}
    counted = [f"{count} {names[name]}" for name, count in report.counts.items() if count]
    total = len(report.outcomes)
    of_all = "" if total == report.available else f" of {report.available}"
    claims = "claim" if total == 1 and not of_all else "claims"
    return f"{total}{of_all} {claims} in {duration(report.seconds)}: {', '.join(counted)}."


def _methods(report: Report) -> str:
    two, one = report.confirmed
    stored = sum(outcome.judgement.stored for outcome in report.outcomes)
    return (
        f"Judged by two independent methods: {two}, by one: {one}; passages that repeat them: "
        f"{report.repeated}; from stored findings: {stored}."
    )


def _headline(outcome: JudgedClaim, finding: Finding) -> str:
    claim = outcome.claim
    if finding.headline:
        return f"- {finding.headline} ({claim.key})"
    because = finding.because or "as the paper says."
    verdict = finding.verdict.capitalize()
    return f"- {claim.place}: {claim.statement} {verdict}: {because} ({claim.key})"


def _named(keys: list[str]) -> str:
    rest = f" and {len(keys) - NAMED} more" if len(keys) > NAMED else ""
    return ", ".join(keys[:NAMED]) + rest


def _whole(outcome: JudgedClaim, report: Report, width: int) -> str:
    claim, finding = outcome.claim, outcome.finding
    mark = " (changed)" if outcome.changed and finding else ""
    head = f"{claim.key} ({claim.place}): {outcome.status}{mark}"
    lines = [f"The paper: “{claim.quote}”", f"Judged: {claim.statement}"]
    if outcome.because:
        lines.append(f"Because {outcome.because}")
    if claim.printed:
        lines.append(f"Printed: {claim.printed}")
    if finding:
        if finding.part:
            lines.append(f"The part that fails: “{finding.part}”")
        lines += [f"Ours: {finding.value}", f"Error: {finding.error}"]
        lines += [
            f"{'By' if k == 0 else 'And by'}: {method.words} [{method.code}]"
            + (f", for {method.covers}" if method.covers else "")
            for k, method in enumerate(claim.methods)
        ]
        if len(claim.methods) == 1:
            lines.append("There is no second method.")
        lines.append(f"Tolerance: {finding.tolerance}")
        lines += [part for part in finding.explanation.split("\n\n") if part.strip()]
        lines += [f"Remark: {remark}" for remark in finding.remarks]
    lines += [f"Repeated in {one.place}: “{one.quote}”" for one in claim.repeats]
    figures = report.shown_by[claim.key]
    if figures:
        lines.append(f"Figure: {', '.join(figures)}")
    lines += _origin(outcome)
    lines.append(f"Reproduce with: {claim.command}")
    return "\n".join([head, *(_filled(line, width - 2, "  ") for line in lines)])


def _origin(outcome: JudgedClaim) -> list[str]:
    """State the date and versions of a stored finding, whether it is stale, and its command."""
    judged = outcome.judgement
    origin = judged.provenance
    if origin is None:
        return []
    versions = ", ".join(
        f"{name} {version}" for name, version in origin.versions.items() if version
    )
    stale = "; stale, since the code that it depends on has changed" if origin.stale else ""
    return [
        f"Stored: found {judged.judged} in {duration(judged.seconds)}, with {versions}{stale}.",
        f"Compute it anew with: {origin.command}",
    ]


def _filled(text: str, width: int, indent: str = "") -> str:
    lines = textwrap.wrap(" ".join(text.split()), width)
    return "\n".join(indent + line for line in lines)
