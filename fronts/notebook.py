"""Display of results in a notebook, as HTML tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import fields
from enum import Enum
from html import escape

from theory.result import Result, records, shown_names, summary

_MAX_ROWS = 10
"""Largest number of rows of a table within the table of a result."""


def as_html(result: Result) -> str:
    """Return a result as a table of two columns; results that it contains are nested tables.

    The points of a curve, which are the rows of `Result.columns`, follow in a table below.

    Examples
    --------
    >>> from fronts.curves import Refusal
    >>> as_html(Refusal(reason="c < 0")).count("</td>")
    2
    """
    cells = {name: getattr(result, name) for name in shown_names(result)}
    below = ""
    if result.is_curve:
        cells = {name: value for name, value in cells.items() if not records(value)}
        columns = {name: values.tolist() for name, values in result.columns().items()}
        below = _rows(list(columns), list(zip(*columns.values(), strict=True)))
    rows = "".join(
        f"<tr><th style='text-align:left'>{escape(name)}</th>"
        f"<td style='text-align:left'>{_cell(name, value)}</td></tr>"
        for name, value in cells.items()
    )
    return f"<table><caption>{escape(type(result).__name__)}</caption>{rows}</table>{below}"


def _cell(name: str, value: object) -> str:
    """Return a value as HTML: dataclasses of one class as a table, text unchanged."""
    held = records(value)
    if held:
        first = held[0]
        names = shown_names(first) if isinstance(first, Result) else [x.name for x in fields(first)]
        return _rows(names, [[getattr(each, name) for name in names] for each in held])
    sentence = getattr(value, "sentence", None)
    if isinstance(value, Enum) and isinstance(sentence, str):
        return escape(f"{value.value}: {sentence}")
    return escape(value if isinstance(value, str) else _number(name, value))


def _rows(names: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return a table with a header, the first rows, and the number of remaining rows."""
    shown = [
        [_word(name, value) for name, value in zip(names, row, strict=True)]
        for row in rows[:_MAX_ROWS]
    ]
    table = "".join(
        f"<tr>{''.join(f'<{tag}>{escape(cell)}</{tag}>' for cell in row)}</tr>"
        for tag, row in zip(("th", *["td"] * len(shown)), (names, *shown), strict=True)
    )
    left = len(rows) - len(shown)
    return f"<table>{table}</table>" + (f"and {left} more" if left else "")


def _word(name: str, value: object) -> str:
    """Return a value as text; missing values (None, or NaN in a column of numbers) are empty."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return ""
    return value if isinstance(value, str) else _number(name, value)


def _number(name: str, value: object) -> str:
    """Return a value with all digits, but errors and run times with two significant digits."""
    if isinstance(value, float) and (name == "seconds" or name.endswith("error")):
        return f"{value:.2g}"
    return summary(value)
