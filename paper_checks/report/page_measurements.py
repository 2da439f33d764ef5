"""The sections of the page that show stored measurements."""

from __future__ import annotations

import base64
import re
from collections.abc import Sequence
from html import escape

from paper_checks.report.inline_math import typeset
from paper_checks.report.inline_svg import inline_svg
from paper_checks.report.section import Diagram, Failure, Origin, Section

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
"""What the names of the records stand for."""

_NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def measurement_sections(sections: Sequence[Section]) -> str:
    """Write the sections; empty without one."""
    return "".join(_section(section) for section in sections)


def contents(sections: Sequence[Section]) -> str:
    """Write links to the sections, for the first screen; empty without one."""
    if not sections:
        return ""
    links = ", ".join(
        f'<a href="#{escape(section.key)}-title">{escape(section.title.lower())}</a>'
        for section in sections
    )
    return f'<p class="record">Below the claims, from stored records: {links}.</p>'


def _section(section: Section) -> str:
    key = escape(section.key)
    head = "".join(f'<th scope="col">{escape(name)}</th>' for name in section.head)
    rows = "".join(
        "<tr>"
        + "".join(f"<td>{_cell(cell, place == 0)}</td>" for place, cell in enumerate(row))
        + "</tr>\n"
        for row in section.rows
    )
    diagrams = "".join(_diagram(diagram) for diagram in section.diagrams)
    return f"""<section aria-labelledby="{key}-title">
<h2 id="{key}-title">{escape(section.title)}</h2>
<p class="lead">{typeset(section.lead)}</p>
{f'<div class="diagrams">{diagrams}</div>' if diagrams else ""}
<div class="measured" tabindex="0"><table>
<thead><tr>{head}</tr></thead>
<tbody>
{rows}</tbody></table></div>
{_stored(section.origins)}
</section>
"""


def _stored(origins: Sequence[Origin]) -> str:
    commands = ", ".join(
        f"<code>{escape(one)}</code>" for one in dict.fromkeys(origin.command for origin in origins)
    )
    dates = sorted({origin.date for origin in origins})
    when = escape(dates[0] if len(dates) == 1 else f"{dates[0]} to {dates[-1]}")
    where = escape("; ".join(dict.fromkeys(origin.machine for origin in origins)))
    return f'<p class="record">Stored. Measured {when} by {commands}; {where}.</p>'


def _diagram(diagram: Diagram) -> str:
    title = in_words(diagram.name)
    drawing = inline_svg(diagram.svg, f"measured-{diagram.name}", f"Measurements: {title}")
    return (
        f'<figure id="measured-{escape(diagram.name)}"><figcaption><strong>{escape(title)}</strong>'
        f'</figcaption><div class="card wide" tabindex="0">{drawing}</div>'
        f"{_data(diagram)}{_failures(diagram.failures)}</figure>\n"
    )


def _data(diagram: Diagram) -> str:
    """Write a link to the numbers behind a diagram; empty where there are none."""
    if not diagram.data:
        return ""
    data, name = base64.b64encode(diagram.data.encode()).decode(), escape(diagram.name)
    return (
        f'<p><a download="{name}.csv" '
        f'href="data:text/csv;charset=utf-8;base64,{data}">Data (CSV)</a></p>'
    )


def _failures(failures: Sequence[Failure]) -> str:
    """Write what has no value, settings with the same reason together; empty without any."""
    if not failures:
        return ""
    items = "".join(
        f"<li>{typeset(method)}: {typeset(reason)} <span>({typeset(where)})</span></li>"
        for (method, reason), where in grouped(failures).items()
    )
    settings = "1 setting gave" if len(failures) == 1 else f"{len(failures)} settings gave"
    return (
        f'<details class="failures"><summary>{settings} no value</summary>'
        f"<ul>{items}</ul></details>"
    )


def grouped(failures: Sequence[Failure]) -> dict[tuple[str, str], str]:
    """Put failures with the same method and reason together: which settings they were, by both.

    Reasons are the same if they differ in numbers only; the first is given.

    Examples
    --------
    >>> grouped([Failure("quad", "narrow", "1e-6", "12 lost"),
    ...          Failure("quad", "narrow", "1e-9", "15 lost")])
    {('quad', '12 lost'): 'narrow: 1e-6, 1e-9'}
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
    """Name a measured quantity for a reader; one that is not known keeps its name.

    Examples
    --------
    >>> in_words("roots"), in_words("other")
    ('Roots of the dispersion relation (50)', 'other')
    """
    return WORDS.get(quantity, quantity)


def _cell(text: str, first: bool) -> str:
    return typeset(in_words(text) if first else text)
