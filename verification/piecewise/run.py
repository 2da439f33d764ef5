"""What a run of the piecewise-linear front (Eq. 44) reports."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from theory.arrays import FloatArray
from verification.fronts.status import FrontStatus
from verification.piecewise.window import ChainState

METHOD = "exact propagation from switching to switching"


@dataclass(frozen=True)
class FrontRun:
    """A run of (44) and its verdict; all quantities dimensionless, times in T = eps t.

    Attributes
    ----------
    coupling, threshold : float
        c and r.
    v : float or None
        Velocity, sites per unit T: negative if the front retreats, 0 if pinned, a mean (over
        whole repeats, or over the second half) if unsteady, None if marginal.
    error : float or None
        Uncertainty of v.
    status : FrontStatus
        See `FrontStatus`.
    period_spread : float or None
        Largest minus smallest period over the mean, in the last block (``unsteady``: over
        the stretch that v is the mean of).
    events : int
        Switchings in the whole run, in either direction.
    events_per_site : float or None
        Switchings for each site gained (or lost) after the transient; 1 for a clean front.
    sliding_events : int
        Switchings at which (44) had no ordinary continuation and a relay of relative width 1e-4
        was used.
    grazes : int
        Near tangencies with the threshold closer than round-off.
    repeat : int or None
        Number of sites after which an unsteady motion repeats itself to 1e-9; None if it does
        not within 60.
    margin : float or None
        For a run at rest: distance from the threshold that the linear relaxation leaves.
    window : int
        Sites in the window.
    truncation : float
        Bound on the disturbance of ``|phi|`` by the ends of the window.
    seconds : float
        Wall time.
    crossing_times : ndarray
        Slow time at which each further site was gained (or lost) for good or for the first time.
    final : ChainState
        State at the end, from which another run may go on.
    method : str
        How it was computed.
    """

    shown: ClassVar[tuple[str, ...]] = (
        "period_spread", "events_per_site", "sliding_events", "repeat", "margin", "truncation",
    )  # fmt: skip

    coupling: float
    threshold: float
    v: float | None
    error: float | None
    status: FrontStatus
    period_spread: float | None
    events: int
    events_per_site: float | None
    sliding_events: int
    grazes: int
    repeat: int | None
    margin: float | None
    window: int
    truncation: float
    seconds: float
    crossing_times: FloatArray = field(repr=False)
    final: ChainState = field(repr=False)
    method: str = METHOD

    @property
    def steady(self) -> bool:
        """True only for motion whose period has settled to the tolerance."""
        return self.status is FrontStatus.STEADY
