"""Watching a front travel until the far end is reached, or it has stopped; the same for all chains.

Velocities are fitted to the arrivals in ``verification.fronts.arrival_fit``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from theory.arrays import FloatArray
from theory.chains.chain import Chain
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import VdpChain, effective_epsilon
from verification.execution.progress import ProgressCallback
from verification.fronts.arrival_fit import Trial
from verification.fronts.status import FrontStatus
from verification.runs.comparison import coarser_tolerance
from verification.runs.integration import Integration

MARGIN = 8
"""Sites at the far end that need not be reached, and whose arrivals are not used for v.

What runs ahead of the front is reflected there and speeds it up. At a distance d from the end that
is twice damped by the decay ahead of the front, so it falls off as the square of what arrives; from
c = 0.6 to 1000, four sites less or more change v by less than its error."""

BUDGET = 5000
"""Sites times steps between the first two checks; it doubles while that is short."""

CHECKS = 40
"""Number of checks within a stall time from which their interval grows no longer."""


LEFT = 0.1
"""Part of its amplitude by which a site that was reached must fall to count as left by the front;
the waves behind a front that is at rest change amplitudes there for ever, by a percent or two."""


class Stall:
    """Whether a run in which sites are reached has stopped; asked again and again as it goes on.

    Two stall times after the last arrival it is at rest if no site that was not reached has become
    larger in the second of them than it was in the first, and no site that was reached has fallen.
    What the amplitudes do otherwise does not count: beside a front of (8) or (43) that is at rest,
    phase waves from the free end move the excited sites, irregularly and without end, and with them
    the site that is reached next.

    Parameters
    ----------
    run : Integration
        The run.
    time : float
        Stall time; twice that without an arrival, the motion is called pinned or creeping.
    settling_tolerance : float
        Growth of the largest amplitude, from the first stall time to the second, below which it is
        pinned.
    """

    def __init__(self, run: Integration, time: float, settling_tolerance: float) -> None:
        self.run, self.time, self.settling_tolerance = run, time, settling_tolerance
        self.reached, self.since = 0, 0.0
        self.early: FloatArray | None = None
        self._highest: FloatArray = np.zeros_like(run.amplitude)
        self._earlier = self._highest

    def note(self, reached: int) -> None:
        """Note how far the motion has come; it begins to wait anew if that is farther."""
        if reached > self.reached:
            self.reached, self.since, self.early = reached, self.run.time, None
            self._highest = np.zeros_like(self._highest)

    @property
    def waited(self) -> float:
        """Time since the motion came farther."""
        return self.run.time - self.since

    def status(self) -> FrontStatus | None:
        """Return what has become of the motion if it has stopped."""
        if self.run.going_to_rest():
            return FrontStatus.COLLAPSED
        self._highest = np.maximum(self._highest, self.run.amplitude)
        if self.waited > self.time and self.early is None:
            self.early = self._largest()
            self._earlier = np.maximum(self._highest, self.early)
            self._highest = np.zeros_like(self._highest)
        if self.waited <= 2.0 * self.time or self.early is None:
            return None
        before = ~np.isnan(self.run.arrivals)
        last = self._largest()
        if np.any(~np.isnan(self.run.arrivals) & ~before):
            return None  # it has come farther meanwhile
        growth = np.maximum(self._highest, last) - self._earlier
        grows = bool(np.any(growth[~before] >= self.settling_tolerance))
        falls = bool(np.any(last[before] < (1.0 - LEFT) * self.early[before]))
        return FrontStatus.CREEPING if grows or falls else FrontStatus.PINNED

    def _largest(self) -> FloatArray:
        """Return the largest amplitudes over a period, step by step.

        Within a cycle of (8), √(y² + ẏ²) varies by some part ε max|1 - a y² + b y⁴| of itself.
        """
        found, end = self.run.amplitude, self.run.time + cycle_period(self.run.chain)
        while self.run.time < end and not self.run.finished:
            self.run.advance(1)
            found = np.maximum(found, self.run.amplitude)
        return found


def cycle_period(chain: Chain) -> float:
    """Return a time within which every cycle of a chain has turned once; 0 of an averaged one.

    It is twice the period at small ε, and for (8) longer by what relaxation takes at large ε.

    Examples
    --------
    >>> from theory.chains.vdp import AveragedChain, VdpChain
    >>> cycle_period(AveragedChain(a=4, b=0.5, c=0.1))
    0.0
    >>> cycle_period(VdpChain(a=4, b=0.5, c=0.1)) > 6.285216
    True
    """
    if isinstance(chain, VdpChain):
        return 4.0 * math.pi + 0.5 * effective_epsilon(chain)
    # Under a force amplitudes never become constant, and states without inertia do not turn.
    if not isinstance(chain, OscillatorChain) or chain.drive or not chain.oscillates:
        return 0.0
    return 2.0 * max((each.period for each in chain.cell.cycles), default=0.0)


@dataclass(frozen=True, kw_only=True)
class Watch:
    """When a front counts as stopped.

    Attributes
    ----------
    stall_time, settling_tolerance : float
        As in :class:`Stall`.
    first : int
        First site of which v is made, counted from 0; before it sites are excited.
    progress : callable, optional
        Called now and then with the part of the chain that has been reached or, where that is
        more, of the time that is waited for a front that stands.
    """

    stall_time: float
    settling_tolerance: float
    first: int
    progress: ProgressCallback | None = None

    def follow(self, run: Integration) -> FrontStatus | None:
        """Step until the far end is reached (None), or until the front has stopped."""
        sites = run.state.shape[1]
        stall = Stall(run, self.stall_time, self.settling_tolerance)
        budget, before, part = BUDGET, 0.0, 0.0
        while True:
            run.advance(budget)
            if run.time - before < self.stall_time / CHECKS:
                budget *= 2
            before = run.time
            reached = int(np.flatnonzero(~np.isnan(run.arrivals)).max(initial=0))
            if reached >= sites - MARGIN - 1:
                return None
            stall.note(reached)
            if self.progress is not None:
                part = max(part, reached / sites, stall.waited / (2.0 * self.stall_time))
                self.progress(min(1.0, part))
            status = stall.status()
            if status is not None:
                return status

    def trial(self, begin: Callable[[float], Integration], tolerance: float) -> Trial:
        """Follow a front at a tolerance and, if it reaches the far end, at a hundred times it."""
        run = begin(tolerance)
        stopped = self.follow(run)
        used, steps = slice(self.first, run.state.shape[1] - MARGIN), run.counts["steps"]
        coarser = np.empty(0)
        if stopped is None:
            other = begin(coarser_tolerance(tolerance))
            if self.follow(other) is None:
                coarser = other.arrivals[used]
            steps += other.counts["steps"]
        return Trial(stopped, run.arrivals[used], coarser, steps)
