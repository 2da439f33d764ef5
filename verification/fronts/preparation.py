"""Measurement of a front by runs on successively longer chains, for any kind of chain."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from theory.arrays import FloatArray
from theory.chains.chain import Chain
from verification.execution.progress import ProgressCallback
from verification.fronts.arrival_fit import (
    error_beside,
    error_by_disorder,
    leading,
    velocity_of_arrivals,
)
from verification.fronts.result import Front, LeftBoundary
from verification.fronts.status import FrontStatus
from verification.fronts.watch import MARGIN, Tail, follow
from verification.runs.comparison import COARSER
from verification.runs.integration import Integration

_BEHIND = 100.0
"""Relative error of a velocity over the square of what a site left out behind the front was away
from its final state. The effect of that end on v is of second order, since it is damped on the way
to it and back; for the Nagumo chain it is this square times 0.2 at alpha = 0.1, 2 at 0.3 and 20 at
0.45, and close to 1/2, where v vanishes, it grows like 1/(1 - 2 alpha)."""

_LARGEST_MARGIN = 0.25
"""Largest part of the sites beyond the excited ones whose arrivals are not used because of the
tail; where the tail is longer, the error of v decides on a longer chain."""


class Trial(NamedTuple):
    """A pair of runs on a chain of one length.

    ``stopped`` is why the front did not reach the end in the first run, None if it did. The arrival
    times by site are then those of ``leading``, so that none is missing; otherwise they are nan
    where a site was not reached. Those of the run at the coarser tolerance are empty if the front
    did not reach the end in both runs. ``counts`` are those of both runs, and ``unsettled`` is the
    result of ``FrontPreparation.unsettled`` in the first.
    """

    stopped: FrontStatus | None
    arrivals: FloatArray
    coarser: FloatArray
    counts: Counter[str]
    unsettled: float = 0.0


@dataclass(frozen=True)
class Settled:
    """Result of the trials on successively longer chains.

    Attributes
    ----------
    status : FrontStatus
        What became of the front.
    v, error : float or None
        Velocity and its uncertainty: 0 and the smallest velocity that would have been noticed for a
        pinned front, None if there is no front, or all sites were reached at once. The uncertainty
        is infinite if the front has not travelled for the relaxation time.
    arrivals : ndarray, shape (m,)
        Arrival times of the last trial, without the sites that were not reached.
    sites : int
        Chain length in the last trial.
    counts : Counter
        Counts of the integrations of all trials.
    wide : bool
        Whether the trials were ended because the front is too wide for the sites kept behind it.
    """

    status: FrontStatus
    v: float | None
    error: float | None
    arrivals: FloatArray
    sites: int
    counts: Counter[str]
    wide: bool = False


@dataclass(frozen=True, kw_only=True)
class FrontPreparation:
    """The parts of a front measurement that differ between models.

    Attributes
    ----------
    sized : callable
        Returns the chain with a given length: all its sites, or those beyond the excited ones.
    begin : callable
        Starts the integration of a chain at a given tolerance.
    excited : int
        Sites excited at the start.
    sites, max_sites : int
        Lengths of the first and of the longest chain, as ``sized`` takes them.
    accuracy, tolerance : float
        As in ``measure_front``.
    stall_time : float
        In units of t.
    settling_tolerance : float
        Growth of an amplitude ahead of the front below which the front counts as pinned; see
        ``watch.Stall``.
    kind : type
        The class of the integrations.
    long_enough : callable
        Whether a chain of a given length is also long enough by another criterion, given v (in t).
    other_velocity : float, optional
        A second velocity (in t); if ``long_enough`` does not hold on the longest chain, the stated
        error is at least the difference from it.
    tail_amplitude : float
        Amplitude above which sites ahead of the front belong to its tail. Arrivals within the
        length of the tail from the far end are not used, nor are those at the last ``MARGIN``
        sites; by default these are all.
    unsettled : callable
        By what part of its amplitude a site was away from its final state when it was left out
        behind the front, in a given run.
    compared : bool
        Whether the error of v is at least its difference from v on a chain of half the length. This
        shows how far v is from its limit where the arrivals scatter so much that their fit does
        not.
    disordered : bool
        Whether sites differ at random, so that arrivals deviate from a line like a random walk.
    settling_time : float
        Time (in t) within which a front is not steady. Before disturbances ahead of it have
        decayed, its velocity can pass through a minimum, where no fit of arrivals shows that it
        will change; nor does one show it of a front that has stopped and started only once or
        twice.
    """

    sized: Callable[[int], Chain]
    begin: Callable[[Any, float], Integration]
    excited: int
    sites: int
    max_sites: int
    accuracy: float
    tolerance: float
    stall_time: float
    settling_tolerance: float
    kind: type[Integration]
    long_enough: Callable[[int, float], bool] = field(default=lambda sites, v: True)
    other_velocity: float | None = None
    tail_amplitude: float = math.inf
    unsettled: Callable[[Integration], float] = field(default=lambda run: 0.0)
    compared: bool = False
    disordered: bool = False
    settling_time: float = 0.0

    def settled(self, progress: ProgressCallback | None) -> Settled:
        """Measure on successively longer chains until v has settled or the front has stopped."""
        counts, sites, before = Counter[str](), self.sites, 0.0
        while True:
            runs = self.trial(sites, progress)
            counts += runs.counts
            arrivals = runs.arrivals[~np.isnan(runs.arrivals)]
            behind = _BEHIND * runs.unsettled**2
            if behind > self.accuracy:
                return Settled(FrontStatus.UNSTEADY, None, None, arrivals, sites, counts, wide=True)
            if runs.stopped is not None:
                pinned = runs.stopped is FrontStatus.PINNED
                v, error = (0.0, 1.0 / self.stall_time) if pinned else (None, None)
                return Settled(runs.stopped, v, error, arrivals, sites, counts)
            v, error = velocity_of_arrivals(arrivals)
            other = velocity_of_arrivals(runs.coarser)[0] if runs.coarser.size else None
            error = max(error_beside(v, error, other, self.tolerance), behind * v)
            if self.disordered:
                error = max(error, error_by_disorder(arrivals))
            if sites < self.settling_time * v:
                error = math.inf
            if self.compared and math.isfinite(v):
                error, before = max(error, abs(v - before)), v
            long, longest = self.long_enough(sites, v), 2 * sites > self.max_sites
            if longest and not long and self.other_velocity is not None:
                error = max(error, abs(v - self.other_velocity))
            if error < self.accuracy * v and (long or longest):
                return Settled(FrontStatus.STEADY, v, error, arrivals, sites, counts)
            if longest and math.isinf(v):
                return Settled(FrontStatus.UNSTEADY, None, None, arrivals, sites, counts)
            if longest:
                return Settled(FrontStatus.UNSTEADY, v, error, arrivals, sites, counts)
            sites *= 2

    def trial(self, sites: int, progress: ProgressCallback | None) -> Trial:
        """Follow a front and, if it reaches the far end, again at a hundred times the tolerance."""
        chain = self.sized(sites)
        how: dict[str, Any] = {
            "stall_time": self.stall_time,
            "settling_tolerance": self.settling_tolerance,
            "margin": MARGIN,
            "progress": progress,
        }
        run, tail = self.begin(chain, self.tolerance), Tail(self.tail_amplitude)
        stopped = follow(run, tail=tail, **how)
        margin = max(MARGIN, min(tail.sites, int(_LARGEST_MARGIN * sites)))
        used = slice(self.excited, run.state.shape[1] - margin)
        counts, arrivals, coarser = Counter(run.counts), run.arrivals[used], np.empty(0)
        if stopped is None:
            arrivals = _complete(run.arrivals, used)
            other = self.begin(chain, COARSER * self.tolerance)
            if follow(other, **how) is None:
                coarser = _complete(other.arrivals, used)
            counts += Counter(other.counts)
        return Trial(stopped, arrivals, coarser, counts, self.unsettled(run))

    def front(
        self,
        found: Settled,
        boundary: LeftBoundary | None,
        outruns: bool,
    ) -> Front:
        """Return the result as a front, with velocities in the chain's unit of time."""
        chain = self.sized(found.sites)
        unit = chain.time_unit
        return Front(
            chain=chain,
            status=found.status,
            v=None if found.v is None else found.v * unit,
            error=None if found.error is None else found.error * unit,
            excited=self.excited,
            left_boundary=boundary,
            outruns_waves=outruns,
            arrivals=found.arrivals,
            method=self.kind.method_of(found.counts),
            counts={"steps": found.counts["steps"]},
            seconds=0.0,
        )


def _complete(arrivals: FloatArray, used: slice) -> FloatArray:
    """Return ``leading`` of the used sites of a front that reached the end, without a site missing.

    The last of them may have been skipped; they count as reached with the first site beyond them.
    """
    found = leading(arrivals[used])
    skipped = used.stop - used.start - found.size
    if not skipped:
        return found
    beyond = float(np.nanmin(arrivals[used.stop :]))
    return np.append(found, np.full(skipped, max(beyond, found.max(initial=0.0))))
