"""Find the quantities: every module of this package that exposes ``QUANTITIES``."""

from __future__ import annotations

import functools
from collections.abc import Sequence

from theory.parameters import ParameterError
from verification.execution.discovery import check_distinct, exposed
from verification.quantities.quantity import Quantity

PACKAGE = "verification.quantities"


@functools.cache
def all_quantities() -> tuple[Quantity, ...]:
    """Return every quantity, module by module in alphabetical order.

    Raises
    ------
    ValueError
        If two have the same name.

    Examples
    --------
    >>> "sigma-integral" in [quantity.name for quantity in all_quantities()]
    True
    """
    found: list[Quantity] = []
    for quantities in exposed(PACKAGE, "QUANTITIES").values():
        found += quantities
    check_distinct("quantities", (quantity.name for quantity in found))
    return tuple(found)


def quantity_named(name: str) -> Quantity:
    """Return the quantity of that name.

    Raises
    ------
    ParameterError
        If there is none.
    """
    for quantity in all_quantities():
        if quantity.name == name:
            return quantity
    known = ", ".join(quantity.name for quantity in all_quantities())
    raise ParameterError("quantity", name, f"one of {known}", "name one of these")


def chosen(names: Sequence[str]) -> tuple[Quantity, ...]:
    """Return the quantities named, or all if none is."""
    return tuple(quantity_named(name) for name in names) if names else all_quantities()
