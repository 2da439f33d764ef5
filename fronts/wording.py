"""Display of results in a terminal: the entries of ``--json`` by name."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from theory.result import Result

WIDTH = 100
"""Largest number of characters of a line; a wider table is split into several below each other."""

MAX_VALUES = 8
"""Number of values that are printed of a longer list, followed by their total number."""

_MAIN = ("v", "c_crit", "re", "im", "centre", "neighbour")
"""Entries whose error is called ``error`` or ``radius`` if there is no ``<entry>_error``."""

_JUDGED = ("stable", "admissible")
"""Entries for which None means that they were not decided."""

_LAST = ("method", "terms", "steps", "counts", "seconds")
"""Entries on how the result was obtained, which are printed last."""

_ERRORS = ("error", "errors", "radius", "residual")
"""Endings of the names of errors, which are printed with two digits."""

_DIGITS, _IN_LISTS, _BESIDE = 10, 7, 8
"""Significant digits of a number without a known error, of a number in a list, and, at most, of a
number in a table that is not its main quantity."""


def in_words(result: Result, payload: Mapping[str, Any] | None = None) -> str:
    """Return the text that the command line prints for a result.

    The status comes first, with its sentence or its reason; then follow a line for each value, with
    its error, and a table for each list of rows. Values that are None are omitted.

    Parameters
    ----------
    result : Result
        The result.
    payload : mapping, optional
        The entries; by default those of ``result.to_dict()``.

    Examples
    --------
    >>> from fronts.piecewise.roots import Root, Roots
    >>> root = Root(label=0, re=0.25, im=0.5, residual=0.0, radius=1e-15)
    >>> print(in_words(Roots(upper=(root,), lower=(), counted=1, certified=False)))
    upper:
      label                 re                 im  residual   radius
          0  0.250000000000000  0.500000000000000   0.0e+00  1.0e-15
    counted    1
    certified  no
    """
    entries = dict(result.to_dict() if payload is None else payload)
    status = entries.pop("status", None)
    sentence = getattr(getattr(result, "status", None), "sentence", "")
    because = sentence or entries.pop("reason", None)
    head = [] if status is None else [f"{status}: {because}" if because else f"{status}"]
    entries |= {name: "not decided" for name in _JUDGED if entries.get(name, "") is None}
    if "branches" in entries:
        entries["branches"] = [_judged(row) for row in entries["branches"]]
    if result.is_curve:
        columns = result.columns()
        rows = rows_of(columns)
        if getattr(result, "stability_shown", False):
            rows = [_judged(row) for row in rows]
        listed = {"points", *(name for name in columns if isinstance(entries.get(name), list))}
        entries = {"points": rows} | {n: v for n, v in entries.items() if n not in listed}
    entries = _with_unknown_errors(result, entries)
    shown = [name for name, value in entries.items() if not _empty(value)]
    shown.sort(key=lambda name: name in _LAST)
    return "\n".join([*head, *_lines({name: entries[name] for name in shown}, result.units)])


def rows_of(columns: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the rows of columns that are arrays."""
    lists = [column.tolist() for column in columns.values()]
    return [dict(zip(columns, row, strict=True)) for row in zip(*lists, strict=True)]


def _with_unknown_errors(result: Any, entries: Mapping[str, Any]) -> dict[str, Any]:
    """Return entries with the errors that are infinite, also of results within this one.

    JSON has no infinity, but an error that is not known must not pass for none.
    """
    found = dict(entries)
    for name, value in entries.items():
        held = getattr(result, name, None)
        if value is None and name.endswith("error") and held == math.inf:
            of = [each for each in entries if error_name(each, entries) == name]
            if not of or any(entries[each] is not None for each in of):
                found[name] = math.inf
        elif isinstance(value, list) and name.endswith("_error"):
            numbers = entries.get(name.removesuffix("_error"))
            if isinstance(numbers, dict):  # complex numbers, by their parts
                numbers = numbers.get("re")
            if isinstance(numbers, list) and len(numbers) == len(value):
                found[name] = [
                    math.inf if error is None and each is not None else error
                    for each, error in zip(numbers, value, strict=True)
                ]
        elif isinstance(value, dict) and isinstance(held, Result):
            found[name] = _with_unknown_errors(held, value)
        elif isinstance(value, dict) and isinstance(held, Mapping) and len(held) == len(value):
            pairs = zip(value.items(), held.values(), strict=True)
            found[name] = {
                key: _with_unknown_errors(part, each) if isinstance(part, Result) else each
                for (key, each), part in pairs
            }
        elif isinstance(value, list) and isinstance(held, tuple) and len(held) == len(value):
            found[name] = [
                _with_unknown_errors(part, each) if isinstance(part, Result) else each
                for each, part in zip(value, held, strict=True)
            ]
    return found


def _judged(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return a row that says so if the stability of an admissible front was not decided."""
    undecided = row.get("admissible") and row.get("stable", True) is None
    return {**row, "stable": "not decided"} if undecided else dict(row)


def _lines(entries: Mapping[str, Any], units: Mapping[str, str]) -> Iterator[str]:
    tables = {name: rows for name, value in entries.items() if (rows := _rows(value))}
    beside = {
        error_name(name, entries) for name, each in entries.items() if isinstance(each, float)
    }
    width = max((len(name) for name in entries if name not in beside | {*tables}), default=0)
    for name, value in entries.items():
        if name in tables:
            yield f"{name}:"
            yield from table_lines(tables[name], units)
        elif name not in beside:
            error = entries.get(error_name(name, entries))
            if not isinstance(error, float):
                error = None  # the error of a value given as text has its own line
            uncertain = "" if error is None else f", uncertain by {error:.1e}"
            if error == math.inf:
                uncertain = " (error unknown)"
            unit = f" {units[name]}" if name in units else ""
            yield f"{name:<{width}}  {_text(name, value, error)}{unit}{uncertain}"


def error_name(name: str, entries: Mapping[str, Any]) -> str:
    """Return the name of the entry with the error of another one; empty if there is none.

    Examples
    --------
    >>> error_name("v", {"v": 0.5, "error": 1e-3}), error_name("growth", {"error": 1e-3})
    ('error', '')
    """
    names = (f"{name}_error", *(("error", "radius") if name in _MAIN else ()))
    return next((each for each in names if each in entries), "")


def table_lines(
    rows: Sequence[Mapping[str, Any]], units: Mapping[str, str] | None
) -> Iterator[str]:
    r"""Yield the lines of a table of rows, or of several tables where one would be too wide.

    Missing values are shown as a dash. There is no column for lists and mappings, nor for the error
    of a number in another column, since the digits of that number show it, unless the error of one
    is not known.

    Examples
    --------
    >>> rows = [{"c": 0.1, "v": 0.25, "v_error": 1e-3}, {"c": 0.2, "v": None, "v_error": None}]
    >>> print("\n".join(table_lines(rows, units=None)))
        c      v
      0.1  0.250
      0.2      -
    """
    columns: list[list[str]] = []
    beside = {
        error
        for name in rows[0]
        if all(row.get(error := f"{name}_error") != math.inf for row in rows)
    }
    for name in rows[0]:
        if name in beside or all(
            _empty(row[name]) or isinstance(row[name], (list, dict)) for row in rows
        ):
            continue
        unit = (units or {}).get(name)
        head = name if unit is None else f"{name} ({unit})"
        cells = [head, *(_cell(name, row) for row in rows)]
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


def _cell(name: str, row: Mapping[str, Any]) -> str:
    error, value = row.get(error_name(name, row)), row[name]
    if _empty(error):
        error = None
    elif name not in _MAIN:
        error = max(error, abs(value) * 10.0 ** (1 - _BESIDE))
    return _text(name, value, error)


def _empty(value: Any) -> bool:
    missing = isinstance(value, float) and math.isnan(value)
    return missing or value is None or value in ("", [], {})


def _rows(value: Any) -> list[dict[str, Any]]:
    """Return the rows of a value that is a table: a list of mappings, or mappings by name."""
    if isinstance(value, dict) and all(isinstance(each, dict) for each in value.values()):
        return [
            each if name in each.values() else {"name": name, **each}
            for name, each in value.items()
        ]
    rows = isinstance(value, list) and all(isinstance(each, dict) for each in value)
    return value if rows else []


def _text(name: str, value: Any, error: float | None = None, digits: int = _DIGITS) -> str:
    """Return a value on one line.

    A number with an error has at most fifteen digits, up to that of the first digit of the error,
    so that it is rounded by at most half of the error. A number without a known error has
    ``digits`` digits, and an error has two.

    Examples
    --------
    >>> _text("c", 1151998399.931, 0.016), _text("c", 0.25, 1e-3), _text("c", 0.25)
    ('1151998399.93', '0.250', '0.25')
    >>> _text("re", 1.25e-25, 1e-21)
    '1e-25'
    >>> _text("errors", [1e-9, math.inf]), _text("readings_error", {"tail": 1.25e-15})
    ('[1.0e-09, inf]', 'tail 1.2e-15')
    """
    if _empty(value):
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return _number(name, value, error, digits)
    if isinstance(value, dict):
        of = name if name.endswith(_ERRORS) else ""
        parts = ((key, each) for key, each in value.items() if not _empty(each))
        return ", ".join(f"{key} {_text(of or key, each)}" for key, each in parts)
    if isinstance(value, list):
        few = [_text(name, each, digits=_IN_LISTS) for each in value[:MAX_VALUES]]
        more = "" if len(value) <= MAX_VALUES else f", … ({len(value)} values)"
        return f"[{', '.join(few)}{more}]"
    return str(value)


def _number(name: str, value: float, error: float | None, digits: int) -> str:
    if name in ("lower", "upper"):  # a rounded enclosure would not be an enclosure
        return repr(value)
    if name.endswith(_ERRORS):
        return f"{value:.1e}"
    if name.endswith("seconds"):
        return f"{value:.3g}"
    if error is None or not value:
        return f"{value:.{digits}g}"
    digits = 15
    if error:
        last = min(math.log10(error), 308.0)  # of an error that is not known, too
        digits = min(max(math.floor(math.log10(abs(value))) - math.floor(last) + 1, 1), digits)
    return f"{value:#.{digits}g}".removesuffix(".").replace(".e", "e")
