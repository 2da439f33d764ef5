"""What every benchmark offers: one quantity, its scenes, how to measure it and how to draw it.

A module of this folder that exposes ``BENCHMARK`` is a quantity; nothing else lists them.
"""

from __future__ import annotations

import functools
import importlib
import pkgutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from theory.parameters import ParameterError

if TYPE_CHECKING:
    from benchmarks.diagram import Style
    from benchmarks.record import Record

RESULTS = Path(__file__).resolve().parent / "results"

Tell = Callable[[str], None]
"""Told what is being done."""


@dataclass(frozen=True)
class Quantity:
    """One quantity and the methods that compute it.

    Attributes
    ----------
    name : str
        As on the command line; the record is ``<name>.json``.
    what : str
        In a few words.
    scenes : tuple of str
        Where it is computed.
    default : str
        The method that the toolkit uses unless told otherwise.
    useful : (float, float)
        Least and largest error that a user is likely to ask for.
    measure : callable
        From (quick, tell) to the record; quick is within 20 s, full within 3 minutes.
    style : callable
        How the diagram is drawn.
    variants : tuple of str
        The default in other dress, such as one call in place of a batch: drawn, and no rivals.
    """

    name: str
    what: str
    scenes: tuple[str, ...]
    default: str
    useful: tuple[float, float]
    measure: Callable[[bool, Tell], Record]
    style: Callable[[], Style]
    variants: tuple[str, ...] = ()


@functools.cache
def all_quantities() -> tuple[Quantity, ...]:
    """Return every quantity, by name.

    Raises
    ------
    ValueError
        If two have the same name.
    """
    home = importlib.import_module("benchmarks")
    modules = [each.name for each in pkgutil.iter_modules(home.__path__) if not each.ispkg]
    found = []
    for name in modules:
        quantity = getattr(importlib.import_module(f"benchmarks.{name}"), "BENCHMARK", None)
        if quantity is not None:
            found.append(quantity)
    names = [quantity.name for quantity in found]
    if len(set(names)) < len(names):
        raise ValueError(f"two benchmarks of one name among {names}")
    return tuple(sorted(found, key=lambda quantity: quantity.name))


def chosen(names: Sequence[str]) -> tuple[Quantity, ...]:
    """Return the quantities named, or all if none is.

    Raises
    ------
    ParameterError
        If there is none of that name.
    """
    known = {quantity.name: quantity for quantity in all_quantities()}
    for name in names:
        if name not in known:
            allowed = f"one of {', '.join(known)}, growth"
            raise ParameterError("quantity", name, allowed, "see 'fronts bench --list'")
    return tuple(known[name] for name in dict.fromkeys(names)) if names else tuple(known.values())
