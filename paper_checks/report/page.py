"""The report as one HTML file that needs nothing but itself."""

from __future__ import annotations

from html import escape
from importlib import resources

from paper_checks.claim import Verdict
from paper_checks.report.inline_math import typeset
from paper_checks.outcome import FAILED, Outcome, slug
from paper_checks.report.page_measurements import contents, measurement_sections
from paper_checks.report.page_parts import (
    STATUS,
    because,
    errata,
    figure_links,
    moment,
    place,
    sentence,
)
from paper_checks.report.page_rows import row
from paper_checks.report.document import Report
from paper_checks.report.table import duration

TITLE = "What the paper claims, and what we found"

NOTABLE = 1.0
"""Seconds of shared work from which on the report tells them."""

MOST_NAMED = 5
"""More changed verdicts than these are folded away, so that the first screen stays one."""

# The page itself forbids the browser every request, to the network or to other files.
POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'"


def page(report: Report) -> str:
    """Write the report as a self-contained HTML document."""
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{TITLE}</title>
<style>
{_resource("style.css")}</style>
</head>
<body>
<header>
<p class="kicker">Excitation fronts in self-excited chains</p>
<h1>{TITLE}</h1>
{_standfirst(report)}
{_counts(report)}
{_alert(report)}
{contents(report.measurements)}
</header>
<main>
{_headlines(report)}
{errata(report)}
<section aria-labelledby="claims-title">
<h2 id="claims-title">Every claim</h2>
{_filter(report)}
<div class="head" aria-hidden="true">
<span>Place</span><span>Claim</span><span>Verdict</span><span>The paper</span><span>Ours</span>
</div>
<ol id="claims" class="rows">
{"".join(row(outcome, report) for outcome in report.outcomes)}</ol>
<p id="none" hidden>No claim fits this choice.</p>
</section>
{measurement_sections(report.measurements)}</main>
{_footer(report)}
<script>
{_resource("script.js")}</script>
</body>
</html>
"""


def _resource(name: str) -> str:
    return resources.files("paper_checks.report").joinpath(name).read_text(encoding="utf-8")


def _standfirst(report: Report) -> str:
    judged = len(report.outcomes)
    stored = sum(outcome.judgement.stored for outcome in report.outcomes)
    repeated = sum(bool(outcome.claim.follows) for outcome in report.outcomes)
    mute = sum(
        outcome.status == slug(Verdict.UNTESTABLE)
        for outcome in report.outcomes
        if not outcome.claim.follows
    )
    if judged == report.available:
        what = "One claim of the paper" if judged == 1 else f"{judged} claims of the paper"
    else:
        what = f"{judged} of the {report.available} claims of the paper on record"
    parts = [f"{judged - repeated - mute} put to two methods that share no code"]
    if repeated:
        parts.append(f"{repeated} that repeat others and take their verdict")
    if mute:
        parts.append(f"{mute} that no computation can decide")
    shared = ""
    if report.shared >= NOTABLE:
        shared = (
            f", with {duration(report.shared)} for derivations and runs that several claims share"
        )
    kept = f" {stored} rest on stored findings and say so." if stored else ""
    return (
        f'<p class="standfirst">{what}: {", ".join(parts)}.{kept} '
        f"This run took <strong>{duration(report.seconds)}</strong>{shared}.</p>"
    )


def _counts(report: Report) -> str:
    items = []
    for name, count in report.counts.items():
        text = f"<b>{count}</b> {STATUS[name]}"
        if count:
            items.append(f'<li class="{name}"><a href="#verdict={name}">{text}</a></li>')
        elif name != FAILED:
            items.append(f'<li class="{name}"><span>{text}</span></li>')
    return f'<ul class="counts" aria-label="Number of claims by verdict">{"".join(items)}</ul>'


def _alert(report: Report) -> str:
    return _stale(report) + _changed(report)


def _stale(report: Report) -> str:
    if not report.stale:
        return ""
    items = ", ".join(
        f'<a href="#claim-{escape(one.claim.key)}">{escape(one.claim.key)}</a>'
        for one in report.stale
    )
    return (
        '<p class="record">Stored, and stale: found by other code than that of this run: '
        f"{items}. <code>fronts check --full</code> computes them.</p>"
    )


def _changed(report: Report) -> str:
    if not report.changed:
        return '<p class="record">Every verdict is as on record.</p>'
    items = [
        f'<li><a href="#claim-{escape(one.claim.key)}">{escape(one.change)}</a></li>'
        for one in report.changed
    ]
    first, rest = "".join(items[:MOST_NAMED]), "".join(items[MOST_NAMED:])
    if rest:
        more = len(items) - MOST_NAMED
        rest = f"<details><summary>{more} more</summary><ul>{rest}</ul></details>"
    return f'<div class="alert"><p>Not as on record:</p><ul>{first}</ul>{rest}</div>'


def _headlines(report: Report) -> str:
    items = "".join(_headline(outcome, report) for outcome in report.headlines)
    if not items:
        return ""
    return (
        '<section aria-labelledby="headlines-title">'
        '<h2 id="headlines-title">To read first</h2>'
        f'<ol class="headlines">{items}</ol></section>'
    )


def _headline(outcome: Outcome, report: Report) -> str:
    claim, finding = outcome.claim, outcome.finding
    if finding is None:
        return ""
    printed = f"The paper: {sentence(claim.printed)} " if claim.printed else ""
    reason = f'<p class="because">{because(outcome)}</p>' if outcome.because else ""
    figures = figure_links(report.shown_by[claim.key])
    figure = f" Figure: {figures}." if figures else ""
    return (
        f'<li class="{outcome.status}">'
        f'<p class="verdict">{escape(finding.verdict)}</p>'
        f'<p class="claim"><a href="#claim-{escape(claim.key)}">{typeset(claim.statement)}</a></p>'
        f"{reason}"
        f'<p class="where">{sentence(claim.place)} {printed}'
        f"Ours: {sentence(finding.value)}{figure}</p></li>"
    )


def _filter(report: Report) -> str:
    options = "".join(
        f'<option value="{name}">{STATUS[name]} ({count})</option>'
        for name, count in report.counts.items()
        if count
    )
    return f"""<form id="filter" hidden>
<label>Verdict <select id="verdict"><option value="">all</option>{options}</select></label>
<label>Place or claim <input id="place" type="search" autocomplete="off"
 placeholder="Fig. 17"></label>
<button type="button" id="unfold" aria-pressed="false">Open all</button>
<output id="shown" for="verdict place"></output>
</form>"""


def _footer(report: Report) -> str:
    versions = ", ".join(
        f"{name} {version}" for name, version in report.versions.items() if version
    )
    return (
        f"<footer><p>Made {moment(report.created)} on {escape(place(report.machine))}. "
        f"{escape(versions)}. Code {escape(report.source[:12])}.</p>"
        "<p>The same findings as data are in <code>report.json</code>, written with this page.</p>"
        "</footer>"
    )
