"""States of a chain held against a reference's: at two tolerances, on no more sites than move."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from theory.arrays import AnyArray
from verification.quantities.quantity import ReferenceCheck
from verification.references.extrapolation import PreciseState
from verification.references.pace import NoReferenceError

TOLERANCE, LOOSER = 1e-12, 3e-11
"""Relative tolerances of a reference; by how much its two states differ is its uncertainty."""


def compared(value: AnyArray, last: Callable[[float], AnyArray], by: str) -> ReferenceCheck:
    """Hold a state against that of a reference, a function of the tolerance.

    The reference is uncertain by how far its states at two tolerances are apart.
    """
    found = last(TOLERANCE)
    return ReferenceCheck(
        distance=float(np.abs(found - value).max()),
        uncertainty=float(np.abs(found - last(LOOSER)).max()),
        method=by,
    )


def precisely(value: AnyArray, found: PreciseState) -> ReferenceCheck:
    """Hold a state against one in extended precision."""
    return ReferenceCheck(
        distance=float(np.abs(found.value - value).max()),
        uncertainty=found.uncertainty,
        method="extrapolation in extended precision",
    )


def moving_sites(at_rest: Callable[[int], bool], sites: int, first: int, most: int) -> int:
    """Return how many sites a slow reference must follow: ``at_rest`` says when its last ones rest.

    Raises
    ------
    NoReferenceError
        If that is not so even with the most that it can follow.
    """
    part = min(sites, first)
    while part < sites and not at_rest(part):
        if part == most:
            raise NoReferenceError("motion leaves the part that a slow reference follows")
        part = min(sites, 2 * part, most)
    return part


def at_all_sites(state: AnyArray, sites: int, rest: float = 0.0) -> AnyArray:
    """Return the state of a part, with those at rest beyond it.

    Examples
    --------
    >>> at_all_sites(np.array([2.0, 1.0]), 4).tolist()
    [2.0, 1.0, 0.0, 0.0]
    """
    return np.pad(state, (0, sites - state.size), constant_values=rest)
