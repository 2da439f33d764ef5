"""Branches of breathers in the coupling, followed through their folds."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from theory.arrays import FloatArray
from theory.averaged.breather import BreatherStatus
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VanDerPolChain
from theory.parameters import ascending
from verification.breathers.breather import with_pattern
from verification.breathers.families import own_family, own_method
from verification.breathers.family import BreatherFamily
from verification.breathers.result import Breather
from verification.continuation.branch import BranchFold, Fold, solutions_at, trace

_MAX_FOLD_COUPLING = 2.0
"""Coupling up to which a fold is searched for."""
_WIDENING = 1e-12
"""Relative amount by which the range is widened, so that its ends are passed."""


@dataclass(frozen=True, kw_only=True)
class FollowedBreather:
    """Breathers at given couplings, in order along their branch.

    Attributes
    ----------
    points : tuple of Breather
        A breather for each passage through each coupling; then the couplings without a breather.
    folds : tuple of BranchFold
        Folds where the branch turns back.
    """

    points: tuple[Breather, ...]
    folds: tuple[BranchFold, ...]


def follow(
    chain: VanDerPolChain,
    couplings: Sequence[float] | FloatArray,
    *,
    nucleus: Nucleus,
    folds: int,
) -> FollowedBreather:
    """Follow a breather from the smallest coupling through a given number of folds.

    Parameters
    ----------
    chain : VanDerPolChain
        A `VdpChain` for orbits, an `AveragedChain` for solutions of (43); its c is not used.
    couplings : sequence of float
        Couplings at which the breather is requested, dimensionless, positive.
    nucleus : Nucleus
        Which sites oscillate, and their pattern of phases.
    folds : int
        Number of folds that are passed.

    Raises
    ------
    ParameterError
        If a coupling is out of range, or there is no such breather at small c.
    """
    started = time.perf_counter()
    required = ascending("coupling c", couplings)
    nucleus = with_pattern(nucleus, chain.sites)
    family = own_family(chain, nucleus)
    system = family.system()
    start = family.start(required[-1], required[0] * (1.0 - _WIDENING))
    # To reach its fold, the branch may go beyond the couplings requested.
    c_end = max(required[-1] * (1.0 + _WIDENING), _MAX_FOLD_COUPLING if folds else 0.0)
    steps = replace(family.step_control(c_end), folds=folds)
    branch = trace(system, start, c_end, None, steps)
    with_errors = [(fold, family.fold_error(fold)) for fold in branch.folds]
    end = _end(with_errors)
    points, folds_passed = [], []
    for point, passed in solutions_at(system, branch, required):
        nearby_fold = _fold_at(with_errors, point.parameter)
        points.append(replace(family.measured(point, started, nearby_fold), **end))
        folds_passed.append(passed)
        started = time.perf_counter()
    described = []
    for number, fold in enumerate(branch.folds):
        points_before = sum(each <= number for each in folds_passed)
        described.append(_described(family, fold, points_before))
    reached = {point.chain.c for point in points}
    points += [
        Breather(
            chain=chain.replace(c=c),
            nucleus=nucleus,
            method=own_method(chain),
            status=BreatherStatus.NONE,
            seconds=0.0,
            **end,
        )
        for c in required
        if c not in reached
    ]
    return FollowedBreather(points=tuple(points), folds=tuple(described))


def _fold_at(folds: Sequence[tuple[Fold, float]], c: float) -> Fold | None:
    """Return the nearest of the folds (given with their errors) whose error reaches a coupling."""
    within_error = [fold for fold, error in folds if abs(fold.parameter - c) <= error]
    return min(within_error, key=lambda fold: abs(fold.parameter - c), default=None)


def _end(folds: Sequence[tuple[Fold, float]]) -> dict[str, Any]:
    """Return the largest coupling of a branch with its error; nothing if it has no fold."""
    if not folds:
        return {}
    last, error = max(folds, key=lambda each: each[0].parameter)
    return {"fold": last.parameter, "fold_error": error}


def _described(family: BreatherFamily, fold: Fold, points_before: int) -> BranchFold:
    """Return a fold with the errors of its coupling and of its amplitude.

    Its coupling is known to the square of its distance along the branch, its amplitude only to this
    distance.
    """
    site, shift = family.nucleus.outward(family.chain.sites), family.step_error(fold)
    height, height_away = (
        float(family.amplitudes(u, fold.parameter)[site]) for u in (fold.u, fold.u + fold.offset)
    )
    # Transverse to the branch, an amplitude changes by at most twice the error of the state, since
    # it depends on two of its components.
    return BranchFold(
        c=float(fold.parameter),
        eta=family.chain.eta,
        error=fold.error + shift.parameter,
        height=height,
        height_error=abs(height - height_away)
        + 2.0 * family.unit * (fold.transverse_error + shift.solution)
        + 1e-14 * height,
        points_before=points_before,
    )
