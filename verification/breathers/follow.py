"""Branches of breathers in the coupling, through their folds."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VanDerPolChain, VdpChain
from theory.parameters import ParameterError, ascending
from verification.breathers.breather import none_at, of_envelope, of_orbit, with_pattern
from verification.breathers.envelope import (
    START,
    describe_envelope,
    rotating_system,
    start_of_branch,
)
from verification.breathers.orbits import (
    FIRST_STEPS,
    describe_orbit,
    shooting_system,
    start_of_orbits,
)
from verification.breathers.result import Breather, BreatherMethod
from verification.continuation.branch import Fold, solutions_at, trace
from verification.continuation.newton import BranchPoint, NotConvergedError, System

_FURTHEST = 2.0
"""Coupling up to which a fold is looked for."""
_BEYOND = 1e-12
"""By so much of itself the range is made wider, so that its ends are passed."""


@dataclass(frozen=True, kw_only=True)
class FollowedBreather:
    """Breathers at given couplings, in order along their branch.

    Attributes
    ----------
    points : tuple of Breather
        Each coupling once for each passage; then those at which there is none.
    folds : tuple of (Fold, Breather, int)
        Where the branch turns back, the breather there, and how many points are before it.
    """

    points: tuple[Breather, ...]
    folds: tuple[tuple[Fold, Breather, int], ...]


def follow(
    chain: VanDerPolChain,
    couplings: Sequence[float] | NDArray[np.float64],
    *,
    nucleus: Nucleus,
    method: BreatherMethod,
    turns: int = 1,
) -> FollowedBreather:
    """Follow a breather from the smallest coupling through so many folds.

    Parameters
    ----------
    chain : VanDerPolChain
        A `VdpChain` for orbits; its c is not used.
    couplings : sequence of float
        Where the breather is required, dimensionless, positive.
    nucleus : Nucleus
        Which sites, and the pattern of phases.
    method : BreatherMethod
        ``orbit`` or ``envelope``.
    turns : int, optional
        Folds that are passed.

    Raises
    ------
    ParameterError
        If a coupling is out of range, or there is no such breather at small c.
    """
    started = time.perf_counter()
    required = ascending("coupling c", couplings)
    nucleus = with_pattern(nucleus)
    system, start = _beginning(chain, nucleus, method, required)
    # To turn, the branch may go beyond the couplings that are required.
    furthest = max(required[-1] * (1.0 + _BEYOND), _FURTHEST if turns else 0.0)
    branch = trace(system, start, furthest, None, replace(FIRST_STEPS, turns=turns))
    points, legs = [], []
    for point, leg in solutions_at(system, branch, required):
        points.append(_described(chain, nucleus, method, point, started))
        legs.append(leg)
        started = time.perf_counter()
    turned = []
    for number, fold in enumerate(branch.folds):
        there = BranchPoint(fold.u, fold.c, branch.points[fold.place].tangent, 0.0, 0.0, 0)
        place = sum(leg <= number for leg in legs)
        turned.append((fold, _described(chain, nucleus, method, there, started), place))
    passed = {point.chain.c for point in points}
    end = (branch.fold.c, branch.fold.error) if branch.fold is not None else (None, None)
    points += [
        none_at(chain.replace(c=c), nucleus, method, 0.0, end) for c in required if c not in passed
    ]
    return FollowedBreather(points=tuple(points), folds=tuple(turned))


def _beginning(
    chain: VanDerPolChain, nucleus: Nucleus, method: BreatherMethod, required: Sequence[float]
) -> tuple[System, BranchPoint]:
    """Return the equations, and a solution at the smallest coupling or at the least above it."""
    centre = nucleus.centre(chain.sites)
    lowest = required[0] * (1.0 - _BEYOND)
    if method is BreatherMethod.ENVELOPE:
        start = start_of_branch(chain, nucleus, min(START, lowest))
        return rotating_system(chain, centre), start
    if not isinstance(chain, VdpChain):
        raise ParameterError(
            "method", "orbit", "envelope for the averaged chain", "take it, or chain.full()"
        )
    start = start_of_orbits(chain, nucleus, required[-1])
    system = shooting_system(chain, centre)
    if lowest < start.c:
        with contextlib.suppress(NotConvergedError):
            start = trace(system, start, lowest, None, FIRST_STEPS).points[-1]
    return system, start


def _described(
    chain: VanDerPolChain,
    nucleus: Nucleus,
    method: BreatherMethod,
    point: BranchPoint,
    started: float,
) -> Breather:
    here = chain.replace(c=point.c)
    if isinstance(here, VdpChain) and method is BreatherMethod.ORBIT:
        return of_orbit(here, nucleus, describe_orbit(here, nucleus, point, started))
    return of_envelope(here, nucleus, describe_envelope(here, nucleus, point, started))
