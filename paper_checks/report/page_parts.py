"""Parts of the page: errata, equations, reasons, lists of facts."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from html import escape

from paper_checks.finding import Erratum, Formula
from paper_checks.outcome import FAILED, Outcome, slug
from paper_checks.report.document import Report
from paper_checks.report.inline_math import typeset
from paper_checks.report.mathml import formula
from paper_checks.ruling import Verdict

STATUS = {slug(verdict): verdict.value for verdict in Verdict} | {FAILED: "judge failed"}
"""Words for each status."""


def errata(report: Report) -> str:
    """Write the section of errata; empty without one."""
    items = "".join(_erratum(outcome, erratum) for outcome, erratum in report.errata)
    if not items:
        return ""
    return (
        '<section aria-labelledby="errata-title">'
        f'<h2 id="errata-title">Errata ({len(report.errata)})</h2>'
        '<p class="lead">Lines of the paper that should read otherwise. Each opens to the text as '
        "printed, as corrected, and to what proves it.</p>"
        f'<ol id="errata" class="rows">{items}</ol></section>'
    )


def _erratum(outcome: Outcome, erratum: Erratum) -> str:
    key = escape(outcome.claim.key)
    facts = [
        ("As printed", f'<div class="math">{typeset(erratum.printed)}</div>'),
        ("Corrected", f'<div class="math">{typeset(erratum.corrected)}</div>'),
        ("Proof", typeset(erratum.proof)),
        ("Affects", typeset(erratum.affects)),
        ("Judged under", f'<a href="#claim-{key}">{key}</a>'),
    ]
    return f"""<li id="erratum-{key}"><details><summary>
<span class="place">{escape(outcome.claim.place)}</span>
<span class="claim">{typeset(erratum.reason)}</span>
<span class="fault">{erratum.fault}</span>
</summary>
<div class="evidence">{facts_list(facts)}</div>
</details></li>
"""


def formulas_block(formulas: tuple[Formula, ...]) -> str:
    """Write equations with their labels."""
    return "".join(
        f'<figure class="formula"><figcaption>{escape(one.label)}</figcaption>'
        f'<div class="math">{formula(one.latex, block=True)}</div></figure>'
        for one in formulas
    )


def figure_links(names: Iterable[str]) -> str:
    """Write links to pictures of the page; empty without one."""
    return ", ".join(f'<a href="#figure-{escape(name)}">{escape(name)}</a>' for name in names)


def because(outcome: Outcome) -> str:
    """Write why the verdict is what it is."""
    return typeset(f"Because {outcome.because}")


def facts_list(facts: list[tuple[str, str]]) -> str:
    """Write names and values, which are HTML already, as a list."""
    rows = "".join(f"<div><dt>{name}</dt><dd>{value}</dd></div>" for name, value in facts)
    return f"<dl>{rows}</dl>"


def place(machine: Mapping[str, object]) -> str:
    """Write what kind of machine it was."""
    return f"{machine['system']} {machine['architecture']}, {machine['cores']} cores"


def sentence(text: str) -> str:
    """Typeset a sentence, with the stop that it may lack."""
    return typeset(text if text.endswith((".", "!", "?")) else f"{text}.")


def moment(iso: str) -> str:
    """Write a time of day."""
    return f'<time datetime="{escape(iso)}">{escape(iso[:10])} {escape(iso[11:16])} UTC</time>'
