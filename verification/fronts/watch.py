"""Follow a front until it reaches the far end or has stopped; the rule is the same for all chains.

Velocities are fitted to the arrivals in ``verification.fronts.arrival_fit``.
"""

from __future__ import annotations

import math

import numpy as np

from theory.arrays import FloatArray
from theory.chains.chain import Chain
from theory.chains.oscillator import OscillatorChain
from theory.chains.vdp import VdpChain, effective_epsilon
from verification.execution.progress import ProgressCallback
from verification.fronts.status import FrontStatus
from verification.runs.integration import Integration

MARGIN = 8
"""Number of sites at the far end that need not be reached, and the smallest number of those whose
arrivals are not used for v (`Tail`)."""

BUDGET = 5000
"""Sites times steps between the first two checks; doubled as long as the checks are too
frequent."""

CHECKS = 40
"""Number of checks per stall time; once they are this infrequent, their interval stays fixed."""


FALL = 0.1
"""Relative decrease of the amplitude of a site from which the front counts as having left it.

The waves behind a front at rest change the amplitudes there permanently, by one or two per cent."""


class Tail:
    """Measures how far a front reaches ahead of the last site that it has reached.

    The tail ahead is reflected at the free end and speeds the front up. At a distance d from the
    end it has been damped twice over that distance, so the effect falls off as the square of the
    tail. Arrivals within the length of the tail from the end are not used for v.

    Parameters
    ----------
    smallest : float
        Amplitude above which a site belongs to the tail.

    Attributes
    ----------
    sites : int
        Largest length of the tail so far. Close to the end it is cut off and does not count.
    """

    def __init__(self, smallest: float) -> None:
        self.smallest, self.sites = smallest, 0

    def note(self, amplitude: FloatArray, reached: int) -> None:
        """Take account of the present amplitudes, of which ``reached`` is the last one reached."""
        ahead = np.flatnonzero(amplitude[reached + 1 :] > self.smallest)
        if ahead.size:
            self.sites = max(self.sites, int(ahead[-1]) + 1)


class Stall:
    """Detects that a motion has stopped reaching new sites; queried repeatedly during the run.

    Two stall times after the last arrival the motion is at rest if no site ahead of the front
    reached a larger amplitude during the second stall time than during the first, and no site
    behind it has fallen. Other changes of the amplitudes are ignored: behind a front of (8) or (43)
    at rest, phase waves from the free end keep moving the excited sites irregularly, and with them
    the next site ahead.

    Parameters
    ----------
    run : Integration
        The run.
    time : float
        Stall time; after twice this time without an arrival the motion is called pinned or
        creeping.
    settling_tolerance : float
        Growth of the largest amplitude of a site, from the first stall time to the second, below
        which the motion counts as pinned.
    """

    def __init__(self, run: Integration, time: float, settling_tolerance: float) -> None:
        self.run, self.time, self.settling_tolerance = run, time, settling_tolerance
        self.reached, self.since = 0, 0.0
        self.early: FloatArray | None = None
        self._highest: FloatArray = np.zeros_like(run.amplitude)
        self._earlier = self._highest

    def note(self, reached: int) -> None:
        """Record how far the motion has come; if it has advanced, the waiting time starts anew."""
        if reached > self.reached:
            self.reached, self.since, self.early = reached, self.run.time, None
            self._highest = np.zeros_like(self._highest)

    @property
    def waited(self) -> float:
        """Time since the motion last advanced."""
        return self.run.time - self.since

    def status(self) -> FrontStatus | None:
        """Return why the motion has stopped, or None while it has not."""
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
            return None  # it has advanced in the meantime
        growth = np.maximum(self._highest, last) - self._earlier
        grows = bool(np.any(growth[~before] >= self.settling_tolerance))
        falls = bool(np.any(last[before] < (1.0 - FALL) * self.early[before]))
        return FrontStatus.CREEPING if grows or falls else FrontStatus.PINNED

    def _largest(self) -> FloatArray:
        """Return the largest amplitude of each site over a period, after every step.

        Within a cycle of (8), √(y² + ẏ²) varies by a fraction of order ε max|1 - a y² + b y⁴|.
        """
        found, end = self.run.amplitude, self.run.time + cycle_period(self.run.chain)
        while self.run.time < end and not self.run.finished:
            self.run.advance(1)
            found = np.maximum(found, self.run.amplitude)
        return found


def cycle_period(chain: Chain) -> float:
    """Return a time within which every cycle of a chain is completed; 0 for an averaged one.

    It is twice the period at small ε; for (8) the duration of the relaxation at large ε is added.

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
    # With forcing, amplitudes never become constant; without inertia, states do not oscillate.
    if not isinstance(chain, OscillatorChain) or chain.drive or not chain.oscillates:
        return 0.0
    return 2.0 * max((each.period for each in chain.cell.cycles), default=0.0)


def follow(
    run: Integration,
    *,
    stall_time: float,
    settling_tolerance: float,
    margin: int = MARGIN,
    tail: Tail | None = None,
    progress: ProgressCallback | None = None,
) -> FrontStatus | None:
    """Step until the far end is reached (None), or until the front has stopped.

    Parameters
    ----------
    run : Integration
        The run of the front.
    stall_time, settling_tolerance : float
        As in :class:`Stall`.
    margin : int
        Number of sites at the far end that need not be reached.
    tail : Tail, optional
        Measures the front at intervals.
    progress : callable, optional
        Called at intervals with the fraction of the chain that has been reached or, if larger, the
        elapsed fraction of the time after which a front counts as stopped.
    """
    sites = run.state.shape[1]
    stall = Stall(run, stall_time, settling_tolerance)
    budget, before, part = BUDGET, 0.0, 0.0
    while True:
        run.advance(budget)
        if run.time - before < stall_time / CHECKS:
            budget *= 2
        before = run.time
        reached = int(np.flatnonzero(~np.isnan(run.arrivals)).max(initial=0))
        if reached >= sites - margin - 1:
            return None
        if tail is not None:
            tail.note(run.amplitude, reached)
        stall.note(reached)
        if progress is not None:
            part = max(part, reached / sites, stall.waited / (2.0 * stall_time))
            progress(min(1.0, part))
        status = stall.status()
        if status is not None:
            return status
