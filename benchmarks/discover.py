"""Which quantities are measured: whatever module of this folder exposes ``BENCHMARK``.

Apart from ``quantity``, so that a benchmark does not depend on all others.
"""

from __future__ import annotations

import functools
from collections.abc import Sequence

from benchmarks.quantity import Quantity
from theory.parameters import ParameterError
from verification.execution.discovery import check_distinct, exposed


@functools.cache
def all_quantities() -> tuple[Quantity, ...]:
    """Return every quantity, by name.

    Raises
    ------
    ValueError
        If two have the same name.
    """
    found: list[Quantity] = list(exposed("benchmarks", "BENCHMARK").values())
    check_distinct("benchmarks", (quantity.name for quantity in found))
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
