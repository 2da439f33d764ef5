"""Watching a front travel until the far end is reached, or it has stopped; the same for all chains.

Velocities are fitted to the arrivals in ``verification.fronts.arrival_fit``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from verification.execution.progress import ProgressCallback
from verification.fronts.arrival_fit import Trial
from verification.fronts.status import FrontStatus
from verification.runs.comparison import COARSER
from verification.runs.integration import Integration

FloatArray = npt.NDArray[np.float64]

MARGIN = 8
"""Sites at the far end that need not be reached, and of which v is not made: the end itself speeds
the front up."""

BUDGET = 5000
"""Sites times steps between the first two checks; it doubles while that is short."""

CHECKS = 40
"""Checks in a stall time that are enough."""

_MAX_TOLERANCE = 1e-2


@dataclass(frozen=True, kw_only=True)
class Watch:
    """When a front counts as stopped.

    Attributes
    ----------
    stall_time : float
        Time without an arrival after which the amplitudes are noted, and twice that before the
        front is called pinned or creeping.
    settling_tolerance : float
        Change of an amplitude, from the first time to the second, below which it is pinned.
    first : int
        First site of which v is made, counted from 0; before it sites are excited.
    progress : callable, optional
        Called now and then with the part of the chain that has been reached.
    """

    stall_time: float
    settling_tolerance: float
    first: int
    progress: ProgressCallback | None = None

    def follow(self, run: Integration) -> FrontStatus | None:
        """Step until the far end is reached (None), or until the front has stopped."""
        sites = run.state.shape[1]
        furthest, when = 0, 0.0
        early: FloatArray | None = None
        budget, before = BUDGET, 0.0
        while True:
            run.advance(budget)
            if run.time - before < self.stall_time / CHECKS:
                budget *= 2
            before = run.time
            reached = int(np.flatnonzero(~np.isnan(run.arrivals)).max(initial=0))
            if reached >= sites - MARGIN - 1:
                return None
            if self.progress is not None:
                self.progress(reached / sites)
            if reached > furthest:
                furthest, when, early = reached, run.time, None
            if run.going_to_rest():
                return FrontStatus.COLLAPSED
            waited = run.time - when
            if waited > self.stall_time and early is None:
                early = run.amplitude
            if waited > 2.0 * self.stall_time and early is not None:
                change = float(np.max(np.abs(run.amplitude - early)))
                settled = change < self.settling_tolerance
                return FrontStatus.PINNED if settled else FrontStatus.CREEPING

    def trial(self, begin: Callable[[float], Integration], tolerance: float) -> Trial:
        """Follow a front at a tolerance and, if it reaches the far end, at a hundred times it."""
        runs: list[Integration] = []
        for each in (tolerance, min(_MAX_TOLERANCE, COARSER * tolerance)):
            runs.append(begin(each))
            stopped = self.follow(runs[-1])
            if stopped is not None:
                break
        used = slice(self.first, runs[0].state.shape[1] - MARGIN)
        steps = sum(run.counts["steps"] for run in runs)
        return Trial(stopped, runs[0].arrivals[used], runs[-1].arrivals[used], steps)
