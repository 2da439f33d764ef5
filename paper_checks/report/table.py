"""Tables and durations as text for the terminal."""

from __future__ import annotations

import io
from collections.abc import Sequence

from paper_checks.discover import Entry
from paper_checks.outcome import slug

NARROWEST = 60
"""Width in columns below which a table is unreadable; lines then wrap in the terminal instead."""


def entries_as_text(entries: Sequence[Entry], width: int) -> str:
    """Return the table of claims that have not been judged."""
    from rich.console import Console
    from rich.table import Table

    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("claim", no_wrap=True)
    for name in ("place", "on record", "statement"):
        table.add_column(name)
    for one in entries:
        claim = one.claim
        table.add_row(claim.key, claim.place, slug(claim.recorded), claim.statement)
    text = io.StringIO()
    Console(
        file=text, width=max(width, NARROWEST), color_system=None, markup=False, emoji=False
    ).print(table)
    return "\n".join(line.rstrip() for line in text.getvalue().splitlines())


def duration(seconds: float) -> str:
    """Write a duration in readable form.

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
