"""The derivations by name. Importing this module does not import SymPy."""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from derivations.errors import DerivationInputError

if TYPE_CHECKING:
    from derivations.derivation import Derivation

LISTING = {
    "friction": ("friction", "model I: scales, steady sliding and its stability", "1-7"),
    "multiple-scales": ("multiple_scales", "the central particle by multiple scales", "8-30"),
    "averaging": ("averaging", "the averaged chain and what decays along it", "31-38"),
    "linearisation": ("linearisation", "the Jacobian, for a ring and for free ends", "39-42"),
    "piecewise-front": ("piecewise_front", "the front, its roots and its speed", "43-54"),
    "second-order": ("second_order", "the next order, by both routes", ""),
}
"""Name, module, what it derives, equation numbers."""

NUMBERED = tuple(name for name, row in LISTING.items() if row[2])
"""The derivations that carry equation numbers."""

WITH_ORDER = ("multiple-scales", "averaging")
"""Those that can be carried to second order."""


def load(name: str, order: int = 1) -> Derivation:
    """Build a derivation; nothing is checked yet.

    Parameters
    ----------
    name : str
        A name of `LISTING`.
    order : {1, 2}
        Power of eps, for multiple scales and averaging.

    Raises
    ------
    DerivationInputError
        If there is no such derivation or order.
    """
    if name not in LISTING:
        raise DerivationInputError(
            "derivation", name, f"one of {', '.join(LISTING)}", "choose one of these names"
        )
    if order not in (1, 2):
        raise DerivationInputError("order", order, "1 or 2", "choose one of the two")
    module = importlib.import_module(f"derivations.{LISTING[name][0]}")
    if name in WITH_ORDER:
        ordered: Derivation = module.derive(order)
        return ordered
    if order == 2 and name != "second-order":
        raise DerivationInputError(
            "order", order, f"1 for '{name}'", "leave it out: this derivation has one order"
        )
    made: Derivation = module.derive()
    return made


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
    for name, (_, _, numbers) in LISTING.items():
        if numbers:
            low, high = map(int, numbers.split("-"))
            if low <= number <= high:
                return name
    raise DerivationInputError("equation", number, "from 1 to 54", "choose one of these numbers")


def main(name: str, arguments: Sequence[str] | None = None) -> int:
    """Print one derivation: what ``python -m derivations.<module>`` does.

    Returns
    -------
    int
        0 if every check passed, 1 if one failed.
    """
    import json

    from derivations import rendering

    parser = argparse.ArgumentParser(prog=f"python -m derivations.{LISTING[name][0]}")
    parser.add_argument("--order", type=int, default=1, choices=(1, 2))
    parser.add_argument("--format", default="text", choices=rendering.FORMATS)
    parsed = parser.parse_args(arguments)
    derivation = load(name, parsed.order)
    if parsed.format == "json":
        data = rendering.records(derivation)
        sys.stdout.write(json.dumps(data) + "\n")
        return 0 if data["complete"] else 1
    sys.stdout.write(rendering.shown(derivation, parsed.format) + "\n")
    return 0 if all(evidence.holds for _, evidence in derivation.examined()) else 1
