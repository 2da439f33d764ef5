"""Tables of text for the terminal."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence

from paper_checks.discover import Entry
from paper_checks.outcome import slug

NARROWEST = 60
"""Below this many columns a table cannot be read; lines wrap in the terminal instead."""


def table(
    head: Sequence[str], rows: Sequence[Sequence[str]], width: int, lines: int | None = None
) -> str:
    """Write a table.

    Parameters
    ----------
    head : sequence of str
        Names of the columns.
    rows : sequence of sequence of str
        Cells.
    width : int
        Columns of the terminal.
    lines : int, optional
        Most lines of a cell; what does not fit is cut and ends with an ellipsis.

    Examples
    --------
    >>> print(table(("a", "b"), [("1", "a longer cell")], 60))
    a  b
    -  -------------
    1  a longer cell
    """
    widths = _widths([head, *rows], max(width, NARROWEST), lines)
    written = [*_lines(head, widths, None), "  ".join("-" * columns for columns in widths)]
    for row in rows:
        written += _lines(row, widths, lines)
    return "\n".join(written)


def entries_as_text(entries: Sequence[Entry], width: int = 100) -> str:
    """Give the table of claims that have not been judged."""
    rows = [
        (one.claim.key, one.claim.place, slug(one.claim.recorded), one.claim.statement)
        for one in entries
    ]
    return table(("claim", "place", "on record", "statement"), rows, width)


def duration(seconds: float) -> str:
    """Write a time for people.

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


def wrapped(text: str, columns: int, lines: int | None = None) -> list[str]:
    """Break text into lines; beyond so many lines it is cut and ends with an ellipsis.

    Examples
    --------
    >>> wrapped("one two three four", 9, 2)
    ['one two', 'three …']
    """
    return (
        textwrap.wrap(" ".join(text.split()), columns, max_lines=lines, placeholder=" …")
        if columns > 2
        else textwrap.wrap(text, max(columns, 1))
    ) or [""]


def _lines(cells: Sequence[str], widths: Sequence[int], most: int | None) -> list[str]:
    broken = [wrapped(cell, columns, most) for cell, columns in zip(cells, widths, strict=True)]
    height = max(map(len, broken))
    return [
        "  ".join(
            (lines[i] if i < len(lines) else "").ljust(columns)
            for lines, columns in zip(broken, widths, strict=True)
        ).rstrip()
        for i in range(height)
    ]


def _widths(cells: Sequence[Sequence[str]], width: int, lines: int | None) -> list[int]:
    """Give each column what its longest cell needs; the widest ones yield when space is short.

    The first column, which names the row, yields last where cells are cut.
    """
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    room = width - 2 * (len(widths) - 1)
    while sum(widths) > room:
        yielding = widths[1:] if lines and max(widths[1:], default=0) > NARROWEST // 6 else widths
        first = len(widths) - len(yielding)
        widths[first + yielding.index(max(yielding))] -= 1
    return widths
