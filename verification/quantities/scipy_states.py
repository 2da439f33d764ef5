"""Comparison of a state with a reference at two tolerances, on no more sites than move."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from theory.arrays import AnyArray
from verification.quantities.quantity import ReferenceCheck
from verification.references.extrapolation import PreciseState
from verification.references.pace import NoReferenceError

TOLERANCE, LOOSER = 1e-12, 3e-11
"""Relative tolerances of a reference; the difference of its two states is its uncertainty."""


def compared(value: AnyArray, last: Callable[[float], AnyArray], by: str) -> ReferenceCheck:
    """Compare a state with that of a reference, a function of the tolerance.

    The uncertainty of the reference is the difference of its states at two tolerances.
    """
    found = last(TOLERANCE)
    return ReferenceCheck(
        distance=float(np.abs(found - value).max()),
        uncertainty=float(np.abs(found - last(LOOSER)).max()),
        method=by,
    )


def precisely(value: AnyArray, found: PreciseState) -> ReferenceCheck:
    """Compare a state with one in extended precision."""
    return ReferenceCheck(
        distance=float(np.abs(found.value - value).max()),
        uncertainty=found.uncertainty,
        method="extrapolation in extended precision",
    )


def moving_sites(at_rest: Callable[[int], bool], sites: int, first: int, most: int) -> int:
    """Return how many sites a slow reference must follow for its last ones to remain at rest.

    Raises
    ------
    NoReferenceError
        If they do not remain at rest even with the largest number that it can follow.
    """
    part = min(sites, first)
    while part < sites and not at_rest(part):
        if part == most:
            raise NoReferenceError("the motion leaves the sites that a slow reference includes")
        part = min(sites, 2 * part, most)
    return part


def at_all_sites(state: AnyArray, sites: int, rest: float = 0.0) -> AnyArray:
    """Return the state of a part, extended by sites at rest.

    Examples
    --------
    >>> at_all_sites(np.array([2.0, 1.0]), 4).tolist()
    [2.0, 1.0, 0.0, 0.0]
    """
    return np.pad(state, (0, sites - state.size), constant_values=rest)
