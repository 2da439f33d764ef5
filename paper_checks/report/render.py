"""The report as HTML that needs nothing but itself: one page, and one of measurements."""

from __future__ import annotations

import base64
import functools
import hashlib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from importlib import resources
from typing import TYPE_CHECKING

from paper_checks.outcome import FAILED, Outcome
from paper_checks.report.document import Report
from paper_checks.report.inline_math import typeset
from paper_checks.report.inline_svg import inline_svg
from paper_checks.report.page_measurements import contents, measurement_sections
from paper_checks.report.page_parts import STATUS, because, errata, moment, place
from paper_checks.report.page_rows import drawn, row
from paper_checks.report.table import duration
from verification.execution.metadata import TOOLKIT

if TYPE_CHECKING:
    from jinja2 import Environment

POLICY = "default-src 'none'; style-src 'unsafe-inline'; base-uri 'none'; form-action 'none'"
"""The page itself forbids the browser every request, to the network or to other files, and every
script; the report's page allows its own one, by its digest (`policy_for`)."""

DOCS = "../site/index.html"
"""The documentation as ``make docs`` builds it, beside the report of ``make paper``."""

MAX_NAMED = 5
"""More changed verdicts than these are folded away, so that the first screen stays one."""


@dataclass(frozen=True)
class Paper:
    """The paper that is judged."""

    title: str
    authors: str


PAPER = Paper(
    "Nucleation and propagation of excitation fronts in self-excited systems",
    "I. B. Shiroky, A. Papangelo, N. Hoffmann, O. V. Gendelman",
)


def page(report: Report) -> str:
    """Write the report as a self-contained HTML document."""
    return (
        _environment()
        .get_template("template.html.j2")
        .render(
            title=f"What holds of “{PAPER.title}”",
            paper=PAPER,
            policy=policy_for(_resource("script.js")),
            docs=DOCS,
            style=_resource("style.css"),
            script=_resource("script.js"),
            standfirst=_standfirst(report),
            counts=_counts(report),
            alert=_stale(report) + _changed(report),
            lead=_lead(report),
            headlines=_headlines(report),
            has_methods=bool(report.measurements),
            gallery="".join(_gallery(report)),
            filter=_filter(report),
            rows="".join(row(outcome, report) for outcome in report.outcomes),
            errata=errata(report),
            toolkit=f"{TOOLKIT} {report.versions.get('toolkit') or ''}".strip(),
            created=report.created[:10],
            source=report.source[:12],
            footer=_footer(report),
        )
    )


def measurements_page(report: Report) -> str:
    """Write the stored measurements of the methods as a page of their own."""
    return f"""<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{POLICY}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>Benchmarks and stability of the methods</title>
<style>
{_resource("style.css")}</style>
</head>
<body>
<header><h1>Benchmarks and stability of the methods</h1>
<p class="record"><a href="index.html">Back to the report</a></p>
{contents(report.measurements)}</header>
<main>
{measurement_sections(report.measurements)}</main>
{_footer(report)}
</body>
</html>
"""


def policy_for(script: str) -> str:
    """Return the content security policy of a page with one script, written on a line of its own.

    A handler in an attribute, and any other script, is not of this digest and does not run.
    """
    digest = base64.b64encode(hashlib.sha256(f"\n{script}".encode()).digest()).decode()
    return f"{POLICY}; script-src 'sha256-{digest}'"


@functools.lru_cache(maxsize=1)
def _environment() -> Environment:
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    # The parts are HTML already, escaped where they are written.
    return Environment(
        loader=FunctionLoader(_resource), undefined=StrictUndefined, autoescape=False
    )


def _resource(name: str) -> str:
    return resources.files("paper_checks.report").joinpath(name).read_text(encoding="utf-8")


def _standfirst(report: Report) -> str:
    judged = len(report.outcomes)
    two, one = report.confirmed
    what = "One claim" if judged == 1 else f"{judged} claims"
    if judged != report.available:
        what = f"{judged} of {report.available} claims"
    stored = sum(outcome.judgement.stored for outcome in report.outcomes)
    parts = [f"{two} by two methods that share no engine", f"{one} by one"]
    text = f"{what} of the paper, judged on its own words: {', '.join(parts)}."
    if report.repeated:
        text += f" {report.repeated} sentences that repeat them are listed under them."
    if stored:
        text += f" {stored} rest on stored findings and say so."
    return f"{text} This run took <strong>{duration(report.seconds)}</strong>."


def _counts(report: Report) -> str:
    items = []
    for name, count in report.counts.items():
        text = f"<b>{count}</b> {STATUS[name]}"
        if count:
            items.append(f'<li class="{name}"><a href="#verdict={name}">{text}</a></li>')
        elif name != FAILED:
            items.append(f'<li class="{name}"><span>{text}</span></li>')
    return f'<ul class="counts" aria-label="Number of claims by verdict">{"".join(items)}</ul>'


def _stale(report: Report) -> str:
    if not report.stale:
        return ""
    items = ", ".join(_link(one) for one in report.stale)
    return (
        f'<p class="record">Stale stored findings, of other code than that of this run: {items}. '
        "<code>fronts check KEY --full</code> computes one.</p>"
    )


def _changed(report: Report) -> str:
    if not report.changed:
        return '<p class="record">Every verdict is as on record.</p>'
    items = [
        f'<li><a href="#claim-{escape(one.claim.key)}">{escape(one.change)}</a></li>'
        for one in report.changed
    ]
    first, rest = "".join(items[:MAX_NAMED]), "".join(items[MAX_NAMED:])
    if rest:
        more = len(items) - MAX_NAMED
        rest = f"<details><summary>{more} more</summary><ul>{rest}</ul></details>"
    return f'<div class="alert"><p>Not as on record:</p><ul>{first}</ul>{rest}</div>'


def _link(outcome: Outcome) -> str:
    key = escape(outcome.claim.key)
    return f'<a href="#claim-{key}">{key}</a>'


def _lead(report: Report) -> str:
    """Draw the last picture of the first headline that has one."""
    for outcome in report.headlines:
        pictures = outcome.finding.pictures if outcome.finding else ()
        if pictures:
            picture = pictures[-1]
            svg = inline_svg(picture.svg, f"lead-{picture.name}", picture.caption)
            return f'<figure class="lead-figure"><div class="card">{svg}</div></figure>'
    return ""


def _headlines(report: Report) -> str:
    items = "".join(_headline(outcome) for outcome in report.headlines)
    if not items:
        return ""
    return (
        '<section aria-labelledby="headlines-title">'
        '<h2 id="headlines-title">To read first</h2>'
        f'<ol class="headlines">{items}</ol></section>'
    )


def _headline(outcome: Outcome) -> str:
    claim, finding = outcome.claim, outcome.finding
    if finding is None:
        return ""
    reason = f'<p class="because">{because(outcome)}</p>' if outcome.because else ""
    said = (
        f'<p class="where">{typeset(claim.place)}: <q>{typeset(claim.quote)}</q>: '
        if finding.headline
        else f'{reason}<p class="where">{typeset(claim.place)}: '
    )
    return (
        f'<li class="{outcome.status}"><p class="claim"><a href="#claim-{escape(claim.key)}">'
        f"{typeset(finding.headline or claim.statement)}</a></p>"
        f'{said}<span class="verdict">{escape(finding.verdict)}</span></p></li>'
    )


def _gallery(report: Report) -> list[str]:
    """Write one card a figure of the paper: its words, our verdicts, the picture, a sentence."""
    by_figure: dict[str, list[Outcome]] = {}
    for outcome in report.outcomes:
        if re.fullmatch(r"fig\d+", outcome.entry.group):
            by_figure.setdefault(outcome.entry.group, []).append(outcome)
    return [_card(group, outcomes, report) for group, outcomes in by_figure.items()]


def _card(group: str, outcomes: Sequence[Outcome], report: Report) -> str:
    number = int(group.removeprefix("fig"))
    body = "".join(
        drawn(picture, f"gallery-{picture.name}", f"figure-{picture.name}")
        for one in outcomes
        if one.finding
        for picture in one.finding.pictures
        if report.in_gallery.get(picture.name) == group
    )
    lines = "".join(
        f'<li class="{one.status}"><a class="verdict" href="#claim-{escape(one.claim.key)}">'
        f"{escape(STATUS[one.status])}</a> <q>{typeset(one.claim.quote)}</q> "
        f"{typeset(_sentence(one))}</li>"
        for one in outcomes
    )
    return (
        f'<article class="figure-card" id="fig-{number}"><h3>Fig. {number}</h3>{body}'
        f'<ul class="judged">{lines}</ul></article>\n'
    )


def _sentence(outcome: Outcome) -> str:
    """Say in one sentence what was found."""
    if outcome.because:
        return f"Because {outcome.because}"
    return f"Ours: {outcome.finding.value}." if outcome.finding else "No finding."


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
