"""What every benchmark offers: one quantity, how to measure it and how to draw it.

A module of this folder that exposes ``BENCHMARK`` is a quantity (``discover``). Its scenes are
those of ``verification.quantities.scenes`` that are to be timed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from verification.quantities.scenes import timed

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
    others : mapping of str to str
        Methods that solve another problem, and which: drawn, and no rivals.
    reasons : mapping of str to str
        Rivals that are faster somewhere, and why the default is the default all the same.
    first : mapping of str to callable
        One first call of the default and of each peer, for a process of its own; imports inside.
    code : tuple of str
        Modules that are measured and that the benchmark does not import itself.
    """

    name: str
    what: str
    default: str
    useful: tuple[float, float]
    measure: Callable[[bool, Tell], Record]
    style: Callable[[], Style]
    variants: tuple[str, ...] = ()
    others: Mapping[str, str] = field(default_factory=dict)
    reasons: Mapping[str, str] = field(default_factory=dict)
    first: Mapping[str, Callable[[], object]] = field(default_factory=dict)
    code: tuple[str, ...] = ()

    @property
    def scenes(self) -> tuple[str, ...]:
        """Names of the scenes where it is measured."""
        return tuple(scene.name for scene in timed(self.name))

    @property
    def module(self) -> str:
        """Dotted name of the module that measures it."""
        return self.measure.__module__
