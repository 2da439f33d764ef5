"""The derivations by name. Importing this module does not import SymPy."""

from __future__ import annotations

import importlib
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from derivations.algebra.errors import DerivationInputError

if TYPE_CHECKING:
    from derivations.algebra.steps import Derivation

LISTING = {
    "friction": ("friction.steps", "model I: scales, steady sliding and its stability", "1-7"),
    "multiple-scales": (
        "multiple_scales.steps", "the central particle by multiple scales", "8-30"
    ),
    "averaging": (
        "averaging.steps", "the averaged chain and its decaying solutions", "31-38, 43"
    ),
    "linearisation": ("linearisation.steps", "the Jacobian, for a ring and for free ends", "39-42"),
    "piecewise-front": ("front.steps", "the front, its roots and its speed", "44-54"),
    "second-order": ("averaging.second_order", "the next order, by both routes", ""),
}  # fmt: skip
"""Name, module, subject and equation numbers of each derivation."""

NUMBERED = tuple(name for name, row in LISTING.items() if row[2])
"""The derivations that carry equation numbers."""

WITH_ORDER = ("multiple-scales", "averaging")
"""Derivations that can be carried to second order."""

WITH_MODEL = tuple(name for name in LISTING if name != "friction")
"""Derivations that apply to any chain of self-excited oscillators."""

COUPLED = ("multiple-scales", "averaging", "piecewise-front")
"""Those among them that require sites to be coupled."""


def load(name: str, order: int = 1, model: Any = None) -> Derivation:
    """Build a derivation, of which each step is computed and checked once, on demand.

    Parameters
    ----------
    name : str
        A name in `LISTING`.
    order : {1, 2}
        Power of eps, for multiple scales and averaging.
    model : ChainModel or None
        The chain; None for that of Eq. (8).

    Raises
    ------
    DerivationInputError
        If there is no such derivation or order, it does not start from a chain, it requires springs
        that the chain lacks, or a letter of the chain has another meaning in it.
    """
    if name not in LISTING:
        raise DerivationInputError(
            "derivation", name, f"one of {', '.join(LISTING)}", "choose one of these names"
        )
    if order not in (1, 2):
        raise DerivationInputError("order", order, "1 or 2", "choose one of the two")
    if order == 2 and name not in (*WITH_ORDER, "second-order"):
        raise DerivationInputError(
            "order", order, f"1 for '{name}'", "leave it out: this derivation has one order"
        )
    if model is not None and name not in WITH_MODEL:
        raise DerivationInputError(
            "model",
            "another chain",
            f"left out for '{name}'",
            f"choose one of {', '.join(WITH_MODEL)}",
        )
    if model is not None:
        if model.coupling == 0 and name in COUPLED:
            raise DerivationInputError(
                "coupling", 0, f"other than zero for '{name}'",
                "give one, or derive the isolated cell with 'derive cell'",
            )  # fmt: skip
        _refuse_taken_letters(name, model)
    made: Derivation = _of_paper(name) if model is None else _module(name).derive(model)
    if order == 2 and name in WITH_ORDER:
        from derivations.averaging.second_order import extended

        return extended(made) if model is None else extended(made, model)
    return made


def _module(name: str) -> Any:
    return importlib.import_module(f"derivations.{LISTING[name][0]}")


def _refuse_taken_letters(name: str, model: Any) -> None:
    """Refuse a chain with a letter that would be mistaken for a symbol of the derivation itself."""
    import sympy as sp

    from derivations.chain import PAPER

    own = [importlib.import_module(f"derivations.{LISTING[name][0].partition('.')[0]}.symbols"),
           importlib.import_module("derivations.symbols")]  # fmt: skip
    known = [each for module in own for each in vars(module).values()]
    known += [each for group in known if isinstance(group, tuple) for each in group]
    taken = {each.name for each in known if isinstance(each, sp.Symbol)}
    taken -= {each.name for each in PAPER.parameters}
    for letter in model.parameters:
        if letter.name in taken:
            raise DerivationInputError(
                "letter", letter.name, f"one that has no other meaning in '{name}'",
                f"take another; also taken are {', '.join(sorted(taken - {letter.name}))}",
            )  # fmt: skip


@lru_cache(maxsize=len(LISTING))
def _of_paper(name: str) -> Derivation:
    """Return the derivation for the paper's chain, whose steps keep what they have computed."""
    made: Derivation = _module(name).derive()
    return made


def everything() -> tuple[Derivation, ...]:
    """Return all derivations that contain equation numbers, including the second order."""
    return tuple(load(name) for name in (*NUMBERED, "second-order"))


def numbers_of(name: str) -> tuple[int, ...]:
    """Return the equation numbers that a derivation contains.

    Examples
    --------
    >>> numbers_of("averaging")[-2:]
    (38, 43)
    """
    found: list[int] = []
    for stretch in LISTING[name][2].split(", ") if LISTING[name][2] else ():
        low, _, high = stretch.partition("-")
        found += range(int(low), int(high or low) + 1)
    return tuple(found)


def owner(number: int) -> str:
    """Return the derivation that contains an equation number.

    Raises
    ------
    DerivationInputError
        If the paper has no such equation.

    Examples
    --------
    >>> owner(34)
    'averaging'
    """
    for name in LISTING:
        if number in numbers_of(name):
            return name
    raise DerivationInputError("equation", number, "from 1 to 54", "choose one of these numbers")
