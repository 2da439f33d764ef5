"""Measurement of a front by runs on successively longer chains, for any kind of chain."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from theory.chains.chain import Chain
from verification.execution.progress import ProgressCallback
from verification.fronts.arrival_fit import Settled, Trial, settle
from verification.fronts.result import Front, LeftBoundary
from verification.fronts.watch import Watch
from verification.runs.integration import Integration


@dataclass(frozen=True, kw_only=True)
class FrontPreparation:
    """The parts of a front measurement that differ between models.

    Attributes
    ----------
    sized : callable
        Returns the chain with a given length.
    begin : callable
        Starts the integration of a chain at a given tolerance.
    excited : int
        Sites excited at the start.
    sites, max_sites : int
        Lengths of the first and of the longest chain.
    accuracy, tolerance : float
        As in ``measure_front``.
    stall_time : float
        In units of t.
    settling_tolerance : float
        Growth of an amplitude ahead of the front below which the front counts as pinned; see
        ``watch.Stall``.
    method : str
        Name of the stepper.
    long_enough : callable
        Whether a chain of a given length is also long enough by another criterion, given v (in t).
    other_velocity : float, optional
        A second velocity (in t); if ``long_enough`` does not hold on the longest chain, the stated
        error is at least the difference from it.
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
    method: str
    long_enough: Callable[[int, float], bool] = field(default=lambda sites, v: True)
    other_velocity: float | None = None

    def settled(self, progress: ProgressCallback | None) -> Settled:
        """Measure on successively longer chains until v has settled or the front has stopped."""
        watch = Watch(
            stall_time=self.stall_time,
            settling_tolerance=self.settling_tolerance,
            first=self.excited,
            progress=progress,
        )

        def trial(sites: int) -> Trial:
            longer = self.sized(sites)
            return watch.trial(lambda each: self.begin(longer, each), self.tolerance)

        return settle(
            trial,
            sites=self.sites,
            max_sites=self.max_sites,
            accuracy=self.accuracy,
            pinned_error=1.0 / self.stall_time,
            long_enough=self.long_enough,
            other_velocity=self.other_velocity,
        )

    def front(
        self,
        found: Settled,
        boundary: LeftBoundary | None,
        outruns: bool,
        earlier_steps: int = 0,
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
            method=self.method,
            counts={"steps": found.steps + earlier_steps},
            seconds=0.0,
        )
