"""Whether a stored measurement still is of the code that is here.

A record carries the names of the modules that measured it and a digest of their code and of all
the toolkit's code that they import, directly or through others. Docstrings, comments and line
breaks do not count, nor does what only draws. A record whose digest no longer fits is stale, and so
is one that has none.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from paper_checks.imports import closure, digest

SOURCES = ("theory", "derivations", "verification", "benchmarks")
"""Packages whose code may change a measurement."""

DRAWING = ("benchmarks.diagram", "benchmarks.tables", "benchmarks.choice")
"""Modules that show what was measured, and change nothing of it."""

CHANGED = "the code that was measured has changed since"
UNKNOWN = "it does not say which code was measured"


def fingerprint(modules: Iterable[str]) -> dict[str, object]:
    """Return the names of modules and a digest of the code they depend on.

    Parameters
    ----------
    modules : iterable of str
        Dotted names.

    Returns
    -------
    dict
        ``modules``, sorted, and ``digest``; for the record.

    Raises
    ------
    ValueError
        If there is no such module.
    """
    names = sorted(set(modules))
    for name in names:
        if name not in closure(name, SOURCES):
            raise ValueError(f"there is no module {name} whose code could be measured")
    return {"modules": names, "digest": digest(names, SOURCES, DRAWING)}


def staleness(record: Mapping[str, Any]) -> str:
    """Return why a record is stale; empty if it is not.

    Examples
    --------
    >>> staleness({"code": None})
    'it does not say which code was measured'
    """
    code = record.get("code")
    if not code:
        return UNKNOWN
    try:
        now = fingerprint(code["modules"])["digest"]
    except ValueError:
        return CHANGED
    return "" if now == code["digest"] else CHANGED
