"""The branch of fronts of (43) in c or in η, followed by pseudo-arclength continuation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from time import perf_counter

from theory.cells.vdp import eta_of_fronts
from theory.parameters import with_ranges
from verification.continuation.branch import Fold, StepControl, solutions_at, trace
from verification.continuation.newton import PARAMETER_WEIGHT, NotConvergedError, solve_at
from verification.fronts.resting import ETAS
from verification.fronts.wave import SLOWEST, FrontWave, Window, not_found
from verification.steppers.amplitudes import Parameter


@dataclass(frozen=True, kw_only=True)
class FrontBranch:
    """Fronts of (43) at one η or at one c, in order along their branch.

    Attributes
    ----------
    fronts : tuple of FrontWave
        The fronts at the requested values, in descending order of the parameter.
    folds : tuple of (Fold, int)
        The folds at which the branch turns back, each with the number of fronts before it. None was
        found for any c and η that were tried.
    """

    fronts: tuple[FrontWave, ...]
    folds: tuple[tuple[Fold, int], ...]


@with_ranges(eta=ETAS, slowest=SLOWEST)
def follow_front_wave(values: Sequence[float], other: float, along: Parameter) -> FrontBranch:
    """Return the fronts at several values of c or of η, by pseudo-arclength continuation.

    The branch is started at the largest value, where the window of sites must be longest.

    Parameters
    ----------
    values : sequence of float
        Couplings above c_pin, or η {eta} and below η_pin; at least one.
    other : float
        η where couplings are followed, c where η is.
    along : {"c", "eta"}
        The parameter in which the branch is followed.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    NoFrontError
        If the front at the largest value is pinned, or a front is slower than {slowest}.
    """
    begin = perf_counter()
    required = sorted(map(float, values))
    if along == "eta":
        eta_of_fronts(required[0], ETAS)
    window = Window.started(
        *((required[-1], other) if along == "c" else (other, required[-1])), along
    )
    system = window.system()
    try:
        start = solve_at(system, window.guess, required[-1])
        # The branch ends just beyond the smallest value, so that this value is passed.
        longest = max(2.0, PARAMETER_WEIGHT * (required[-1] - required[0]) / 8.0)
        steps = StepControl(length=0.1, longest=longest, max_steps=2000, folds=3)
        branch = trace(system, start, required[0] * (1.0 - 1e-12), None, steps)
        fronts, passed = [], []
        for point, folds_passed in solutions_at(system, branch, required):
            fronts.append(window.described(point, begin))
            passed.append(folds_passed)
            begin = perf_counter()
    except NotConvergedError as refusal:
        raise not_found(refusal, along) from None
    folds = [(fold, sum(each <= k for each in passed)) for k, fold in enumerate(branch.folds)]
    return FrontBranch(fronts=tuple(fronts), folds=tuple(folds))
