"""Starts of the friction chain: which sites are excited, and from which point of the cycle.

The paper: excited sites start "close to the stick-slip limit cycle" of one cell, the others near
steady sliding, all with ẏ = 0. The cycle has two such points. Where the cell has no stick-slip
cycle, beyond its end, the paper does not say; here the point is taken at the end of the cycle.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from theory.cells.friction import FrictionCell
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Place
from theory.parameters import ParameterError, count_within, within

FloatArray = npt.NDArray[np.float64]


class StartPoint(StrEnum):
    """Where on the cycle of one cell the excited sites start, ẏ = 0."""

    MAXIMUM = "maximum"
    """At the largest y."""

    MINIMUM = "minimum"
    """At the smallest y."""


def nucleus_sites(sites: int, place: Place, size: int) -> tuple[int, ...]:
    """Return the excited sites, from 1.

    Raises
    ------
    ParameterError
        If the nucleus does not fit, or cannot be in the middle.

    Examples
    --------
    >>> nucleus_sites(31, Place.BULK, 3), nucleus_sites(31, Place.EDGE, 2)
    ((15, 16, 17), (1, 2))
    """
    count_within("nucleus size", size, 1, sites, "give a nucleus that fits the chain")
    if Place(place) is Place.EDGE:
        return tuple(range(1, size + 1))
    first = (sites - size) // 2 + 1
    return tuple(range(first, first + size))


def cycle_point(cell: FrictionCell, point: StartPoint) -> float:
    """Return y of the excited sites."""
    low, high = _turning_points(cell)
    return high if StartPoint(point) is StartPoint.MAXIMUM else low


@lru_cache(maxsize=4096)
def _turning_points(cell: FrictionCell) -> tuple[float, float]:
    from verification.cells.friction_cycles import cycle_turning_points

    return cycle_turning_points(cell)


def nucleus(
    chain: FrictionChain,
    sites: Sequence[int],
    point: StartPoint | float = StartPoint.MAXIMUM,
) -> FloatArray:
    """Return a start, shape (2, N): the named sites excited, the others in steady sliding, ẏ = 0.

    Parameters
    ----------
    chain : FrictionChain
        Parameters.
    sites : sequence of int
        Excited sites, from 1 to N.
    point : StartPoint or float
        Point of the cycle, or y itself.

    Raises
    ------
    ParameterError
        If a site is not in the chain.

    Examples
    --------
    >>> nucleus(FrictionChain(c=0.02, sites=3), [2], 2.0)[0].round(6).tolist()
    [0.541042, 2.0, 0.541042]
    """
    if not sites:
        raise ParameterError("excited sites", "none", "at least one", "name a site from 1 to n")
    start = np.zeros((2, chain.sites))
    start[0] = chain.cell.steady_sliding
    if isinstance(point, StartPoint):
        height = cycle_point(chain.cell, point)
    else:
        height = within("displacement", point, -1e3, 1e3)
    for site in sites:
        if not 1 <= site <= chain.sites:
            raise ParameterError(
                "excited site", site, f"from 1 to {chain.sites}", "name a site of the chain"
            )
        start[0, site - 1] = height
    return start
