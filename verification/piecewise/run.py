"""The result of a run of the piecewise-linear front (Eq. 44)."""

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
        c, and r to rounding.
    v : float or None
        Velocity in sites per unit T: negative if the front retreats, 0 if pinned, a mean (over
        whole repetition periods, or over the second half) if unsteady, None if marginal.
    error : float or None
        Uncertainty of v.
    status : FrontStatus
        See `FrontStatus`.
    period_spread : float or None
        Largest minus smallest period relative to the mean, in the last block (``unsteady``: over
        the interval of which v is the mean).
    events : int
        Number of switchings in the whole run, in either direction.
    events_per_site : float or None
        Switchings per site gained (or lost) after the transient; 1 for a clean front.
    sliding_events : int
        Number of switchings at which (44) had no ordinary continuation, so that a relay of relative
        width 1e-4 was used.
    grazes : int
        Near tangencies with the threshold closer than round-off.
    repeat : int or None
        Number of sites after which an unsteady motion repeats itself to 1e-9; None if it does not
        do so within 60.
    margin : float or None
        For a run at rest: the distance from the threshold that remains after linear relaxation; no
        error is known.
    window : int
        Number of sites in the window.
    truncation : float
        Bound on the disturbance of ``|phi|`` by the ends of the window.
    seconds : float
        Wall-clock time.
    crossing_times : ndarray
        Slow times at which further sites were gained (or lost), permanently or for the first time;
        no error is known.
    final : ChainState
        Final state, from which another run may continue.
    method : str
        The numerical method.
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
        """Whether the period has settled to within the tolerance."""
        return self.status is FrontStatus.STEADY
