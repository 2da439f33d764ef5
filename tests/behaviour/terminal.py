"""Compare what a terminal shows of a result with the entries of its JSON object."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from fronts.wording import error_name

SHOWN = re.compile(r"(\S+)  +(-?[\d.]+(?:e[-+]\d+)?)(?:, uncertain by (\S+))?")
LAST = 1e-14
"""Relative size of the fifteenth digit of a number, at most."""
ROUNDED = 0.5 * (1.0 + 1e-6)
BESIDE = 1e-7
"""Relative size of the last digit of a number in a table whose error is not shown."""


def contradictions(entries: Mapping[str, Any], text: str) -> Iterator[str]:
    """Yield one line for each number of a text that its entry contradicts.

    A number with an error is rounded by at most half of it, others in their last digit.
    """
    table, head, count = "", [""], 0
    for line in text.splitlines():
        if not line.startswith(" "):
            table, head, count = line.removesuffix(":"), [""], 0
            if (found := SHOWN.fullmatch(line)) is not None:
                name, number, error = found.groups()
                yield from _compared(entries, name, number, 0.0)
                stated = entries.get(error_name(name, entries))
                if error is not None and abs(float(error) - stated) > 0.051 * stated:
                    yield f"{line}: its error is {stated}"
        elif isinstance(rows := entries.get(table), list):
            words = re.split(r"\s{2,}", line.strip())
            if head == [""] or words[0] == head[0]:
                head, count = words, 0  # further columns of the same table have the first again
            elif len(words) == len(head):
                for name, number in zip(head, words, strict=True):
                    yield from _compared(rows[count], name, number, BESIDE)
                count += 1


def _compared(entries: Mapping[str, Any], name: str, shown: str, part: float) -> Iterator[str]:
    value, error = entries.get(name), entries.get(error_name(name, entries))
    if not isinstance(value, float) or re.fullmatch(r"-?[\d.]+(e[-+]\d+)?", shown) is None:
        return
    number = float(shown)
    digits = len(re.sub(r"e.*|[-.]", "", shown).lstrip("0"))
    if not isinstance(error, float) or not error:
        error = 10.0 ** (1 - digits) * abs(number or value)
    if not _near(number, value, max(error, part * abs(value), LAST * abs(value))):
        yield f"{name} is shown as {shown}, is {value!r}, and errs by {error:.2g}"


def _near(one: float, other: float, unit: float) -> bool:
    return abs(one - other) <= ROUNDED * unit + 1e-300
