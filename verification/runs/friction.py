"""A direct run of the friction chain (5): samples, arrivals, envelopes, events, and its error.

The stepper is ``verification.steppers.friction``. The error comes from two companions
(``verification.runs.comparison``). Where steady sliding is unstable, rounding alone grows, and the
error says so.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from time import perf_counter

import numpy as np
import numpy.typing as npt

from theory.chains.friction import FrictionChain
from theory.parameters import ParameterError, end_time, within
from verification.execution.checkpoint import check_samples, run_to_end
from verification.runs.comparison import (
    ROUNDINGS,
    arrival_error_from,
    companion_tolerances,
    error_from,
)
from verification.runs.friction_integration import FrictionLane
from verification.steppers import friction

FloatArray = npt.NDArray[np.float64]


class RunStatus(StrEnum):
    """How far a run can be trusted."""

    RESOLVED = "resolved"
    """All runs had as many events of each kind."""

    EVENTS_DIFFER = "events differ"
    """They had not: an event is as small as the error, or the motion is chaotic."""


@dataclass(frozen=True)
class FrictionRun:
    """What a run has seen.

    Attributes
    ----------
    chain : FrictionChain
        Parameters.
    times : ndarray, shape (M,)
        τ of the samples.
    y, velocity : ndarray, shape (M, N)
        Position and velocity at those times; the velocity is exactly v_d in stick.
    envelope : ndarray, shape (M, N)
        Half of the last maximum minus the last minimum of y before each sample; 0 before both.
    stuck : ndarray of bool, shape (N,)
        Sites that stick at the end.
    arrivals : ndarray, shape (N,)
        τ at which a site first stuck; nan where it never did.
    sticks, releases, reversals : int
        Number of events of each kind.
    log : ndarray, shape (K, 3)
        τ, site (from 1) and kind of the first events, if they were asked for.
    error : float or None
        Bound on the error of y and ẏ, from the companions; None if there were none.
    arrival_error : float or None
        The same of ``arrivals``; inf if one run saw an arrival that the other did not.
    status : RunStatus
        Whether the companions saw the same events.
    tolerance : float
        Local error, absolute.
    steps : int
        Steps.
    mean_active : float
        Sites stepped, averaged over the steps.
    seconds : float
        Run time.
    """

    chain: FrictionChain
    times: FloatArray
    y: FloatArray
    velocity: FloatArray
    envelope: FloatArray
    stuck: npt.NDArray[np.bool_]
    arrivals: FloatArray
    sticks: int
    releases: int
    reversals: int
    log: FloatArray
    error: float | None
    arrival_error: float | None
    status: RunStatus
    tolerance: float
    steps: int
    mean_active: float
    seconds: float

    @property
    def events(self) -> int:
        """Number of events."""
        return self.sticks + self.releases + self.reversals


def run_friction(
    chain: FrictionChain,
    start: FloatArray,
    t_end: float,
    *,
    tolerance: float = 1e-10,
    samples: int = 201,
    times: Sequence[float] | None = None,
    window: bool = True,
    companion: bool = True,
    events: int = 0,
    checkpoint: Path | None = None,
    progress: Callable[[float], None] | None = None,
    budget: int = 200_000,
) -> FrictionRun:
    """Run the chain from τ = 0 to ``t_end``.

    Parameters
    ----------
    chain : FrictionChain
        Parameters of (5).
    start : ndarray, shape (2, N)
        y and ẏ (``verification.runs.friction_start``).
    t_end : float
        τ, positive, at most 1e9.
    tolerance : float
        Local error of y and ẏ, absolute, from 1e-14 to 1e-2.
    samples : int
        States kept, evenly spaced; at least 2.
    times : sequence of float, optional
        Where states are kept instead, ascending, the last one at most ``t_end``.
    window : bool
        Leave sites out while they are within a hundredth of the tolerance of steady sliding.
    companion : bool
        Run two companions beside it, for the error.
    events : int
        Events kept in ``log``, from 0 to 1e8.
    checkpoint : Path, optional
        File in which the run is kept every few seconds and when it is interrupted. If it exists,
        the run goes on from it, to the same bits.
    progress : callable, optional
        Told the fraction done, now and then.
    budget : int
        Sites times steps between two looks at the clock.

    Raises
    ------
    ParameterError
        If a parameter is out of range, the start does not fit, or the checkpoint belongs to
        another run.
    FrictionRunError
        If the run cannot go on.

    Examples
    --------
    >>> from verification.runs.friction_start import nucleus
    >>> chain = FrictionChain(c=0.02, sites=5)
    >>> run = run_friction(chain, nucleus(chain, [1]), 50.0, samples=2)
    >>> run.y.shape, run.error < 1e-6, run.status.value
    ((2, 5), True, 'resolved')
    """
    begin = perf_counter()
    end_time("end time tau", t_end)
    within("tolerance", tolerance, 1e-14, 1e-2)
    check_samples(samples if times is None else len(times), chain.sites)
    within("events kept", events, 0, 1e8)
    wanted = np.linspace(0.0, t_end, int(samples)) if times is None else np.asarray(times, float)
    if np.any(np.diff(wanted) < 0.0) or np.any(wanted < 0.0) or np.any(wanted > t_end):
        raise ParameterError(
            "times of the samples", "not ascending from 0 to the end", "ascending", "sort them"
        )
    runs = [(tolerance, 0)]
    if companion:
        runs += zip(companion_tolerances(tolerance), (ROUNDINGS, 0), strict=True)
    lanes = [
        FrictionLane(
            chain,
            moved(chain, start, roundings),
            each,
            window=window,
            times=wanted,
            events=events,
            end=t_end,
        )
        for each, roundings in runs
    ]
    spent = run_to_end(lanes, t_end, budget, checkpoint, progress)
    first = lanes[0]
    error = arrival_error = None
    status = RunStatus.RESOLVED
    states = first.samples
    kinds = first.counters[friction.KINDS :]
    if companion:
        others = lanes[1:]
        error = error_from(states[:, :2], [other.samples[:, :2] for other in others])
        arrival_error = arrival_error_from(first.arrivals, [other.arrivals for other in others])
        if any(np.any(kinds != other.counters[friction.KINDS :]) for other in others):
            status = RunStatus.EVENTS_DIFFER
    steps = int(first.counters[friction.STEPS])
    return FrictionRun(
        chain,
        wanted,
        states[:, 0],
        states[:, 1],
        states[:, 2],
        first.modes == 0,
        first.arrivals,
        int(kinds[friction.STICK_BEGINS]),
        int(kinds[friction.STICK_ENDS]),
        int(kinds[friction.REVERSAL]),
        first.log,
        error,
        arrival_error,
        status,
        tolerance,
        steps,
        float(first.counters[friction.SITE_STEPS]) / max(1, steps),
        spent + perf_counter() - begin,
    )


def moved(chain: FrictionChain, start: FloatArray, roundings: int) -> FloatArray:
    """Return the start with y at every site so many units in the last place larger.

    All sites are moved alike, so that a mirror-symmetric start stays so.

    Examples
    --------
    >>> chain = FrictionChain(c=0.02, sites=2)
    >>> (moved(chain, np.ones((2, 2)), 4) - 1.0).tolist()
    [[8.881784197001252e-16, 8.881784197001252e-16], [0.0, 0.0]]
    """
    new = np.array(start, dtype=float)
    if roundings and new.ndim:
        new[0] += roundings * np.spacing(np.maximum(np.abs(new[0]), chain.cell.steady_sliding))
    return new
