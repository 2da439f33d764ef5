"""The sections of the page that show stored measurements."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from paper_checks.inline_math import typeset
from paper_checks.inline_svg import inline_svg
from paper_checks.measurements import Diagram, Section, Stamp


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
        "<tr>" + "".join(f"<td>{typeset(cell)}</td>" for cell in row) + "</tr>\n"
        for row in section.rows
    )
    return f"""<section aria-labelledby="{key}-title">
<h2 id="{key}-title">{escape(section.title)}</h2>
<p class="lead">{typeset(section.lead)}</p>
<div class="measured" tabindex="0"><table>
<thead><tr>{head}</tr></thead>
<tbody>
{rows}</tbody></table></div>
{_stored(section.stamps)}
{"".join(_diagram(diagram) for diagram in section.diagrams)}</section>
"""


def _stored(stamps: Sequence[Stamp]) -> str:
    commands = ", ".join(
        f"<code>{escape(one)}</code>" for one in dict.fromkeys(stamp.command for stamp in stamps)
    )
    dates = sorted({stamp.date for stamp in stamps})
    when = escape(dates[0] if len(dates) == 1 else f"{dates[0]} to {dates[-1]}")
    where = escape("; ".join(dict.fromkeys(stamp.machine for stamp in stamps)))
    return f'<p class="record">Stored. Measured {when} by {commands}; {where}.</p>'


def _diagram(diagram: Diagram) -> str:
    name = escape(diagram.name)
    drawing = inline_svg(diagram.svg, f"measured-{diagram.name}", f"Measurements: {diagram.name}")
    failures = "".join(f"<li>{typeset(one)}</li>" for one in diagram.failures)
    failed = f"<p>No value:</p><ul>{failures}</ul>" if failures else ""
    return (
        f"<details><summary>{name}</summary>"
        f'<figure><div class="card wide" tabindex="0">{drawing}</div></figure>'
        f'<div class="prose">{failed}</div></details>\n'
    )
