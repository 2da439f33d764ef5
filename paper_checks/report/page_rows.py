"""The rows of the page: one a claim, which opens to its evidence."""

from __future__ import annotations

import base64
from html import escape

from paper_checks.finding import Finding, Picture
from paper_checks.outcome import Outcome
from paper_checks.report.document import Report
from paper_checks.report.inline_math import typeset
from paper_checks.report.inline_svg import inline_svg, width_of
from paper_checks.report.mathml import formula
from paper_checks.report.page_parts import (
    STATUS,
    because,
    facts_list,
    figure_links,
    formulas_block,
    moment,
    place,
)
from paper_checks.report.table import duration

WIDE = 300
"""Pictures wider than this, in points, do not fit a phone."""

IN_ROW = 280
"""Characters of LaTeX of an equation that a closed row has room for."""


def row(outcome: Outcome, report: Report) -> str:
    """Write a claim as a row that opens to its evidence."""
    claim, finding = outcome.claim, outcome.finding
    verdict = STATUS[outcome.status]
    notes = [
        note
        for note, holds in (
            (f"on record: {claim.recorded}", outcome.changed),
            ("stale", outcome.judgement.stale),
            ("stored", outcome.judgement.stored),
        )
        if holds
    ]
    note = f'<span class="note">{escape("; ".join(notes))}</span>' if notes else ""
    ours = finding.value if finding else "no value"
    printed = typeset(claim.printed) if claim.printed else _unvalued(outcome)
    key = escape(claim.key)
    return f"""<li id="claim-{key}" class="{outcome.status}" data-verdict="{outcome.status}">
<details><summary>
<span class="place">{escape(claim.place)}</span>
<span class="claim">{_said(claim.quote)}{typeset(claim.statement)}</span>
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


def _evidence(outcome: Outcome) -> str:
    failure = escape(outcome.judgement.failure or "")
    return f"<p>The judge of this claim failed: {failure}</p>" + facts_list(
        [("Verdict on record", escape(outcome.claim.recorded)), *_provenance(outcome)]
    )


def _findings(outcome: Outcome, finding: Finding, report: Report) -> str:
    claim = outcome.claim
    reason = f'<p class="because">{because(outcome)}</p>' if outcome.because else ""
    prose = reason + "".join(
        f"<p>{typeset(paragraph)}</p>"
        for paragraph in finding.explanation.split("\n\n")
        if paragraph.strip()
    )
    remarks = "".join(
        f'<p class="remark"><b>Remark.</b> {typeset(remark)}</p>' for remark in finding.remarks
    )
    methods = "".join(
        f"<li>{typeset(str(method))} <code>{escape(method.code)}</code></li>"
        for method in claim.methods
    )
    facts = [
        ("Our value", typeset(finding.value)),
        ("Its error", typeset(finding.error)),
        ("The paper’s value", typeset(claim.printed or "none given")),
        (
            "Two methods" if len(claim.methods) == 2 else "A single method",
            f"<ol>{methods}</ol>",
        ),
        ("Tolerance", typeset(finding.tolerance)),
        *_provenance(outcome),
    ]
    if finding.part:
        facts.insert(0, ("The part that fails", f"<q>{typeset(finding.part)}</q>"))
    if claim.repeats:
        also = "".join(
            f"<li>{typeset(one.place)}: <q>{typeset(one.quote)}</q></li>" for one in claim.repeats
        )
        facts.append(("Also said in", f"<ul>{also}</ul>"))
    shown_by = figure_links(report.shown_by[outcome.claim.key])
    if shown_by and not finding.pictures:
        facts.insert(0, ("Figure", shown_by))
    pictures = "".join(
        _picture(outcome.claim.key, picture)
        for picture in finding.pictures
        if picture.name not in report.in_gallery
    )
    shown = [picture.name for picture in finding.pictures if picture.name in report.in_gallery]
    if shown:
        facts.insert(0, ("Figure", figure_links(shown)))
    formulas = formulas_block(finding.formulas)
    return f'<div class="prose">{prose}{remarks}</div>{formulas}{facts_list(facts)}{pictures}'


def _provenance(outcome: Outcome) -> list[tuple[str, str]]:
    judged = outcome.judgement
    facts = [("Reproduce with", f"<pre><code>{escape(outcome.claim.command)}</code></pre>")]
    origin = judged.provenance
    if origin is None:
        how = "kept from an earlier run, where it took" if judged.stored else "computed in"
        when = f"{moment(judged.judged)}, {how} {duration(judged.seconds)}"
        if outcome.claim.shared is not None:
            when += ", after work that it shares with other claims"
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
        f"{state}Found {moment(judged.judged)} in {duration(judged.seconds)}, on "
        f"{escape(place(origin.machine))}, with {escape(versions)}. Found anew by "
        f"<code>{escape(origin.command)}</code>."
    )
    return [*facts, ("Stored finding", stored)]


def _said(quote: str) -> str:
    """Write the paper's words; of an equation they stand below."""
    return "" if quote.startswith("Eq. (") else f"<q>{typeset(quote)}</q> "


def _picture(key: str, picture: Picture) -> str:
    return drawn(picture, f"{key}-{picture.name}", f"figure-{picture.name}")


def drawn(picture: Picture, salt: str, anchor: str) -> str:
    """Write a picture with its caption and its files."""
    data = base64.b64encode(picture.data.encode()).decode()
    name, caption = escape(picture.name), typeset(picture.caption)
    drawing = inline_svg(picture.svg, salt, picture.caption)
    # A phone scrolls a wide picture sideways: shrunk to its screen it could not be read.
    wide = ' wide" tabindex="0' if (width_of(picture.svg) or 0) > WIDE else ""
    return (
        f'<figure id="{escape(anchor)}"><div class="card{wide}">{drawing}</div>'
        f'<figcaption>{caption} <a href="{name}.svg">SVG</a>, <a href="{name}.png">PNG</a>, '
        f'<a href="{name}.pdf">PDF</a>, <a download="{name}.csv" '
        f'href="data:text/csv;charset=utf-8;base64,{data}">data (CSV)</a></figcaption></figure>'
    )
