"""The report as one HTML file that needs nothing but itself."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from html import escape
from importlib import resources

from paper_checks.claim import Finding, Picture, Verdict
from paper_checks.inline_math import typeset
from paper_checks.inline_svg import inline_svg, width_of
from paper_checks.mathml import formula
from paper_checks.outcome import FAILED, Outcome, slug
from paper_checks.page_measurements import contents, measurement_sections
from paper_checks.page_parts import errata, facts_list, figure_links, formulas_block
from paper_checks.report import Report
from paper_checks.table import duration

TITLE = "What the paper claims, and what we found"

STATUS = {slug(verdict): verdict.value for verdict in Verdict} | {FAILED: "judge failed"}
"""Words for each status."""

WIDE = 300
"""Pictures wider than this, in points, do not fit a phone."""

IN_ROW = 280
"""Characters of LaTeX of an equation that a closed row has room for."""

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
{_resource("page.css")}</style>
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
{"".join(_row(outcome, report) for outcome in report.outcomes)}</ol>
<p id="none" hidden>No claim fits this choice.</p>
</section>
{measurement_sections(report.measurements)}</main>
{_footer(report)}
<script>
{_resource("page.js")}</script>
</body>
</html>
"""


def _resource(name: str) -> str:
    return resources.files("paper_checks").joinpath(name).read_text(encoding="utf-8")


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
    kept = f" {stored} rest on stored findings and say so." if stored else ""
    return (
        f'<p class="standfirst">{what}: {", ".join(parts)}.{kept} '
        f"This run took <strong>{duration(report.seconds)}</strong>.</p>"
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
    printed = f"The paper: {_sentence(claim.printed)} " if claim.printed else ""
    because = f'<p class="because">{_because(outcome)}</p>' if outcome.because else ""
    figures = figure_links(report.shown_by[claim.key])
    figure = f" Figure: {figures}." if figures else ""
    return (
        f'<li class="{outcome.status}">'
        f'<p class="verdict">{escape(finding.verdict)}</p>'
        f'<p class="claim"><a href="#claim-{escape(claim.key)}">{typeset(claim.statement)}</a></p>'
        f"{because}"
        f'<p class="where">{_sentence(claim.place)} {printed}'
        f"Ours: {_sentence(finding.value)}{figure}</p></li>"
    )


def _because(outcome: Outcome) -> str:
    return f"Because {_sentence(outcome.because)}"


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


def _row(outcome: Outcome, report: Report) -> str:
    claim, finding = outcome.claim, outcome.finding
    verdict = STATUS[outcome.status]
    notes = [
        note
        for note, holds in (
            (f"on record: {claim.recorded}", outcome.changed),
            ("stale", outcome.judgement.stale),
            ("stored", outcome.judgement.stored),
            (_followed_by(outcome), bool(outcome.judgement.followed)),
        )
        if holds
    ]
    note = f'<span class="note">{escape("; ".join(notes))}</span>' if notes else ""
    ours = finding.value if finding else "no value"
    printed = typeset(claim.printed) if claim.printed else _unvalued(outcome)
    place, key = escape(claim.place), escape(claim.key)
    return f"""<li id="claim-{key}" class="{outcome.status}" data-verdict="{outcome.status}">
<details><summary>
<span class="place">{place}</span>
<span class="claim">{typeset(claim.statement)}</span>
<span class="verdict">{escape(verdict)}{note}</span>
<span class="printed"><i>The paper: </i>{printed}</span>
<span class="ours"><i>Ours: </i>{typeset(ours)}</span>
{_equation(outcome)}</summary>
<div class="evidence">
{_evidence(outcome) if finding is None else _findings(outcome, finding, report)}
</div>
</details>
</li>
"""


def _unvalued(outcome: Outcome) -> str:
    """Say what stands in the place of the paper's value where it gives none."""
    if outcome.finding is None or not outcome.finding.formulas:
        return "no value"
    return "the equation below" if _equation(outcome) else "a long equation: open this row"


def _equation(outcome: Outcome) -> str:
    """Write the equation that a claim is about where a row has room for it."""
    finding = outcome.finding
    if finding is None or outcome.claim.printed or not finding.formulas:
        return ""
    latex = finding.formulas[0].latex
    if len(latex) > IN_ROW:
        return ""
    return f'<span class="equation">{formula(latex)}</span>\n'


def _followed_by(outcome: Outcome) -> str:
    followed = outcome.judgement.followed
    return f"as {followed[0]}" if len(followed) == 1 else f"from {len(followed)} others"


def _evidence(outcome: Outcome) -> str:
    failure = escape(outcome.judgement.failure or "")
    return f"<p>The judge of this claim failed: {failure}</p>" + facts_list(
        [("Verdict on record", escape(outcome.claim.recorded)), *_provenance(outcome)]
    )


def _findings(outcome: Outcome, finding: Finding, report: Report) -> str:
    first, second = (typeset(method) for method in finding.methods)
    because = f'<p class="because">{_because(outcome)}</p>' if outcome.because else ""
    prose = because + "".join(
        f"<p>{typeset(paragraph)}</p>"
        for paragraph in finding.explanation.split("\n\n")
        if paragraph.strip()
    )
    facts = [
        ("Our value", typeset(finding.value)),
        ("Its error", typeset(finding.error)),
        ("The paper’s value", typeset(outcome.claim.printed or "none given")),
        ("Two methods", f"<ol><li>{first}</li><li>{second}</li></ol>"),
        ("Tolerance", typeset(finding.tolerance)),
        *_provenance(outcome),
    ]
    if outcome.judgement.followed:
        links = ", ".join(
            f'<a href="#claim-{escape(key)}">{escape(key)}</a>'
            for key in outcome.judgement.followed
        )
        facts.insert(0, ("Verdict taken from", links))
    shown_by = figure_links(report.shown_by[outcome.claim.key])
    if shown_by and not finding.pictures:
        facts.insert(0, ("Figure", shown_by))
    pictures = "".join(_picture(outcome.claim.key, picture) for picture in finding.pictures)
    formulas = formulas_block(finding.formulas)
    return f'<div class="prose">{prose}</div>{formulas}{facts_list(facts)}{pictures}'


def _provenance(outcome: Outcome) -> list[tuple[str, str]]:
    judged = outcome.judgement
    facts = [("Reproduce with", f"<pre><code>{escape(outcome.claim.command)}</code></pre>")]
    if judged.followed:
        return facts
    origin = judged.provenance
    if origin is None:
        how = "kept from an earlier run, where it took" if judged.stored else "computed in"
        when = f"{_moment(judged.judged)}, {how} {duration(judged.seconds)}"
        return [*facts, ("Judged", when)]
    versions = ", ".join(
        f"{name} {version}" for name, version in origin.versions.items() if version
    )
    state = (
        "Stale: the code it depends on has changed since. "
        if origin.stale
        else "The code it depends on has not changed since. "
    )
    stored = (
        f"{state}Found {_moment(judged.judged)} in {duration(judged.seconds)}, on "
        f"{escape(_place(origin.machine))}, with {escape(versions)}. Found anew by "
        f"<code>{escape(origin.command)}</code>."
    )
    return [*facts, ("Stored finding", stored)]


def _place(machine: Mapping[str, object]) -> str:
    return f"{machine['system']} {machine['architecture']}, {machine['cores']} cores"


def _picture(key: str, picture: Picture) -> str:
    data = base64.b64encode(picture.data.encode()).decode()
    name, caption = escape(picture.name), typeset(picture.caption)
    drawing = inline_svg(picture.svg, f"{key}-{picture.name}", picture.caption)
    # A phone scrolls a wide picture sideways: shrunk to its screen it could not be read.
    wide = ' wide" tabindex="0' if (width_of(picture.svg) or 0) > WIDE else ""
    return (
        f'<figure id="figure-{name}"><div class="card{wide}">{drawing}</div>'
        f'<figcaption>{caption} <a download="{name}.csv" '
        f'href="data:text/csv;charset=utf-8;base64,{data}">Data (CSV)</a></figcaption></figure>'
    )


def _footer(report: Report) -> str:
    versions = ", ".join(
        f"{name} {version}" for name, version in report.versions.items() if version
    )
    return (
        f"<footer><p>Made {_moment(report.created)} on {escape(_place(report.machine))}. "
        f"{escape(versions)}. Code {escape(report.source[:12])}.</p>"
        "<p>The same findings as data are in <code>report.json</code>, written with this page.</p>"
        "</footer>"
    )


def _sentence(text: str) -> str:
    return typeset(text if text.endswith((".", "!", "?")) else f"{text}.")


def _moment(iso: str) -> str:
    return f'<time datetime="{escape(iso)}">{escape(iso[:10])} {escape(iso[11:16])} UTC</time>'
