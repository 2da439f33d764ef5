"""The branch of fronts of (43) in c, by pseudo-arclength."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

from verification.continuation.branch import Fold, Steps, solutions_at, trace
from verification.continuation.newton import COUPLING_WEIGHT, NotConvergedError, solve_at
from verification.fronts.wave import FrontWave, NoFrontError, Window


@dataclass(frozen=True, kw_only=True)
class FrontBranch:
    """Fronts of (43) at one η, in order along their branch.

    Attributes
    ----------
    fronts : tuple of FrontWave
        At the couplings that were asked for, c descending.
    folds : tuple of (Fold, int)
        Where the branch turns back in c, and how many fronts are before it. None was found for any
        η that was tried.
    """

    fronts: tuple[FrontWave, ...]
    folds: tuple[tuple[Fold, int], ...]


def follow_front_wave(couplings: Sequence[float], eta: float) -> FrontBranch:
    """Return the fronts at several couplings, by pseudo-arclength from the largest one down.

    Parameters
    ----------
    couplings : sequence of float
        At least one, all above c_pin.
    eta : float
        η = b/a², from 1e-3 to 0.11.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    NoFrontError
        If the front at the largest coupling is pinned, or a front is slower than 1e-3.
    """
    begin = perf_counter()
    required = sorted(map(float, couplings))
    window = Window.started(required[-1], eta)
    system = window.system()
    try:
        start = solve_at(system, window.guess, required[-1])
        # An end just below the last coupling, so that it is passed.
        longest = max(2.0, COUPLING_WEIGHT * (required[-1] - required[0]) / 8.0)
        steps = Steps(length=0.1, longest=longest, most=2000, turns=3)
        branch = trace(system, start, required[0] * (1.0 - 1e-12), None, steps)
        fronts, legs = [], []
        for point, leg in solutions_at(system, branch, required):
            fronts.append(window.described(point, begin))
            legs.append(leg)
            begin = perf_counter()
    except NotConvergedError as refusal:
        raise NoFrontError(str(refusal)) from None
    folds = [(fold, sum(leg <= k for leg in legs)) for k, fold in enumerate(branch.folds)]
    return FrontBranch(fronts=tuple(fronts), folds=tuple(folds))
