"""The registry: the quantities that the modules of this package expose, and their computations."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from typing import TypeVar

from theory.parameters import ParameterError
from verification.execution.discovery import check_distinct, exposed
from verification.quantities.chains import computations_of_chains
from verification.quantities.quantity import Computation, Quantity

PACKAGE = "verification.quantities"

_Named = TypeVar("_Named", Quantity, Computation)


@functools.cache
def all_quantities() -> tuple[Quantity, ...]:
    """Return every quantity, module by module in alphabetical order.

    Raises
    ------
    ValueError
        If two quantities have the same name.

    Examples
    --------
    >>> "sum" in [quantity.name for quantity in all_quantities()]
    True
    """
    found = tuple(each for module in exposed(PACKAGE, "QUANTITIES").values() for each in module)
    check_distinct("quantities", (quantity.name for quantity in found))
    return found


def all_computations() -> tuple[Computation, ...]:
    """Return the rows of the robustness table, including those of chains registered since.

    Raises
    ------
    ValueError
        If two computations have the same name.

    Examples
    --------
    >>> "sigma-integral" in [computation.name for computation in all_computations()]
    True
    """
    found = tuple(each for quantity in all_quantities() for each in quantity.computations)
    found += computations_of_chains()
    check_distinct("computations", (computation.name for computation in found))
    return found


def quantity_named(name: str) -> Quantity:
    """Return the quantity of the given name; raise `ParameterError` if there is none."""
    return _named(all_quantities(), name)


def computation_named(name: str) -> Computation:
    """Return the computation of the given name; raise `ParameterError` if there is none."""
    return _named(all_computations(), name)


def _named(registered: Sequence[_Named], name: str) -> _Named:
    for each in registered:
        if each.name == name:
            return each
    known = ", ".join(each.name for each in registered)
    raise ParameterError("quantity", name, f"one of {known}", "name one of these")


def chosen(names: Sequence[str]) -> tuple[Computation, ...]:
    """Return the computations named, or all if none are."""
    return tuple(computation_named(name) for name in names) if names else all_computations()
