"""The pictures that illustrate a claim: its own, or those of claims about the same figure."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from paper_checks.outcome import JudgedClaim

_FIGURES = re.compile(r"Figs?\.\s*(\d+)(?:\s+and\s+(\d+))?")


def pictures_of(outcomes: Sequence[JudgedClaim]) -> Mapping[str, tuple[str, ...]]:
    """Return the names of the pictures that illustrate each claim, by its key.

    A claim without pictures of its own is illustrated by those of its module, which concerns one
    figure of the paper, or else by those of the figures that its place mentions. If there are none,
    the tuple is empty.
    """
    own = {one.claim.key: _names(one) for one in outcomes}
    by_module: dict[str, tuple[str, ...]] = {}
    for one in outcomes:
        by_module[one.entry.group] = _joined([by_module.get(one.entry.group, ()), _names(one)])
    found = {}
    for one in outcomes:
        key = one.claim.key
        found[key] = (
            own[key]
            or by_module[one.entry.group]
            or _joined(by_module.get(name, ()) for name in modules_named(one.claim.place))
        )
    return found


def modules_named(place: str) -> tuple[str, ...]:
    """Return the modules of the figures that a place mentions.

    Examples
    --------
    >>> modules_named("Captions of Figs. 17 and 18"), modules_named("Fig. 3a, section 1.2")
    (('fig17', 'fig18'), ('fig03',))
    """
    numbers = [number for pair in _FIGURES.findall(place) for number in pair if number]
    return tuple(f"fig{int(number):02d}" for number in numbers)


def _names(outcome: JudgedClaim) -> tuple[str, ...]:
    return tuple(picture.name for picture in outcome.pictures)


def _joined(parts: Iterable[tuple[str, ...]]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(name for part in parts for name in part))
