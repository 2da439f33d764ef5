"""Results for people at a terminal: the entries of ``--json`` by their names."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from theory.result import Result

CURVES = ("Curve", "Branch", "KineticCurve", "Bifurcation")
"""Classes of results that are shown by their own table of columns."""

WIDTH = 100
"""Letters of a line; the columns of a wider table follow below, so that none is broken."""

MAX_VALUES = 8
"""Of a longer list these are printed, and how many there are."""

_ERRORS = {"v": "error", "c_crit": "error", "re": "radius", "im": "radius"}
"""Entries whose error is not called ``<entry>_error``."""

_JUDGED = ("stable", "admissible")
"""Entries of which None says that they were not decided."""


def in_words(result: Result, payload: Mapping[str, Any] | None = None) -> str:
    """Return what the command line prints of a result.

    A line for each value, with its error, and a table for each list of rows. The status comes
    first, with its sentence. What is None is a dash.

    Parameters
    ----------
    result : Result
        The result.
    payload : mapping, optional
        The entries, by default those of ``result.to_dict()``.

    Examples
    --------
    >>> from fronts.piecewise.roots import Root, Roots
    >>> root = Root(label=0, re=0.1, im=0.2, residual=0.0, radius=1e-15)
    >>> print(in_words(Roots(upper=(root,), lower=(), counted=1, certified=False)))
    upper:
      label   re   im  residual   radius
          0  0.1  0.2   0.0e+00  1.0e-15
    counted    1
    certified  no
    """
    entries = {"status": "", **(result.to_dict() if payload is None else payload)}
    sentence = getattr(getattr(result, "status", None), "sentence", "")
    if sentence:
        entries["status"] = f"{entries['status']}: {sentence}"
    entries |= {name: "not decided" for name in _JUDGED if entries.get(name, "") is None}
    if type(result).__name__ in CURVES:
        columns = {name: column.tolist() for name, column in result.columns().items()}
        rows = [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]
        listed = {"points", *(name for name in columns if isinstance(entries.get(name), list))}
        entries = {"points": rows} | {n: v for n, v in entries.items() if n not in listed}
    return "\n".join(_lines({n: v for n, v in entries.items() if v not in ("", [], {})}))


def _lines(entries: Mapping[str, Any]) -> Iterator[str]:
    tables = {name: rows for name, value in entries.items() if (rows := _rows(value))}
    beside = {
        _error_name(name, entries)
        for name, each in entries.items()
        if each is None or isinstance(each, float)
    }
    width = max((len(name) for name in entries if name not in beside | {*tables}), default=0)
    for name, value in entries.items():
        if name in tables:
            yield f"{name}:"
            yield from table_lines(tables[name])
        elif name not in beside:
            error = entries.get(_error_name(name, entries))
            uncertain = "" if error is None else f", uncertain by {error:.1e}"
            yield f"{name:<{width}}  {_text(name, value, 16, error)}{uncertain}"


def _error_name(name: str, entries: Mapping[str, Any]) -> str:
    own = f"{name}_error"
    return own if own in entries else _ERRORS.get(name, "")


def table_lines(rows: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    r"""Yield rows of the same names as a table, or as several where it would be too wide.

    What does not exist is a dash; what is a list or a mapping itself has no column.

    Examples
    --------
    >>> print("\n".join(table_lines([{"c": 0.1, "v": 0.25}, {"c": 0.2, "v": None}])))
        c     v
      0.1  0.25
      0.2     -
    """
    columns: list[list[str]] = []
    for name in rows[0]:
        if all(_empty(row[name]) or isinstance(row[name], (list, dict)) for row in rows):
            continue
        cells = [
            name,
            *(_text(name, row[name], 10, row.get(_error_name(name, row))) for row in rows),
        ]
        width = max(map(len, cells))
        columns.append([cell.rjust(width) for cell in cells])
    blocks = [columns[:1]]  # each begins with the first column
    for column in columns[1:]:
        if len(blocks[-1]) > 1 and sum(len(each[0]) + 2 for each in (*blocks[-1], column)) > WIDTH:
            blocks.append(columns[:1])
        blocks[-1] = [*blocks[-1], column]
    for block in blocks:
        for line in zip(*block, strict=True):
            yield "  " + "  ".join(line)


def _empty(value: Any) -> bool:
    missing = isinstance(value, float) and math.isnan(value)
    return missing or value is None or value in ("", [], {})


def _rows(value: Any) -> list[dict[str, Any]]:
    """Return what is a table: a list of mappings, or mappings by name."""
    if isinstance(value, dict) and all(isinstance(each, dict) for each in value.values()):
        return [
            each if name in each.values() else {"": name, **each} for name, each in value.items()
        ]
    rows = isinstance(value, list) and all(isinstance(each, dict) for each in value)
    return value if rows else []


def _text(name: str, value: Any, digits: int, error: float | None = None) -> str:
    """Return a value in one line.

    A number has so many digits; with an error fifteen, and none that the error may change by more
    than one. An error itself has two.

    Examples
    --------
    >>> _text("c", 1151998399.931, 16, 0.016), _text("c", 0.25, 16, 1e-17)
    ('1151998399.9', '0.25')
    """
    if _empty(value):
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        if name in ("lower", "upper"):  # rounded, an enclosure would be none
            return repr(value)
        if name.endswith(("error", "radius", "residual")):
            return f"{value:.1e}"
        if name.endswith("seconds"):
            return f"{value:.3g}"
        if error is not None:
            digits = next((n for n in range(1, 15) if error * 10.0**n >= abs(value)), 15)
        return f"{value:.{digits}g}"
    if isinstance(value, dict):
        parts = ((key, each) for key, each in value.items() if not _empty(each))
        return ", ".join(f"{key} {_text(key, each, 9)}" for key, each in parts)
    if isinstance(value, list):
        few = [_text(name, each, 7) for each in value[:MAX_VALUES]]
        more = "" if len(value) <= MAX_VALUES else f", … ({len(value)} values)"
        return f"[{', '.join(few)}{more}]"
    return str(value)
