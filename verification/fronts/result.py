"""A front and its velocity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from theory.arrays import FloatArray
from theory.result import Result, plain
from theory.status import Status
from verification.fronts.status import FrontStatus


class LeftBoundary(Status):
    """What is to the left of the first site; of consequence only where waves overtake the front."""

    FREE = "free", "Nothing: the first site is a free end."
    WAVE = "wave", "A wave that goes on for ever, with the phase step of the front at each site."


@dataclass(frozen=True, kw_only=True)
class Front(Result):
    """A front and its velocity.

    Attributes
    ----------
    chain : Chain
        Parameters; its length, if it has one, is the one used in the end.
    status : FrontStatus
        What became of the front.
    v : float or None
        Velocity in sites per ``time_unit`` of the chain: v̂ = v/ε of (8) and (43), per unit τ of
        (5), per slow time of (44). 0 if pinned, None if there is no front or it is not known.
    error : float or None
        Uncertainty of v; for a pinned front the velocity that would have been seen.
    excited : int or None
        Sites excited at the start.
    left_boundary : LeftBoundary or None
        What was to the left of the first site; None where the model has no such choice.
    outruns_waves : bool
        Whether the front outruns all waves behind it: then ``left_boundary`` changes nothing.
    arrivals : ndarray, shape (m,)
        Times t at which the sites beyond the start were reached, in their order.
    method : str
        How it was computed.
    counts : mapping
        ``steps`` of the integrator, or ``events``; and what else was counted.
    seconds : float
        Run time.
    detail : object or None
        What the method knows beyond this: of (44) a ``verification.piecewise.run.FrontRun``, of a
        wave a ``verification.fronts.wave.FrontWave``, of a lattice or network a
        ``verification.fronts.network.Spread``. What its ``shown`` names is in the JSON.
    """

    chain: Any
    status: FrontStatus
    v: float | None
    error: float | None
    excited: int | None
    left_boundary: LeftBoundary | None
    outruns_waves: bool
    arrivals: FloatArray
    method: str
    counts: Mapping[str, int]
    seconds: float
    detail: Any = field(default=None, repr=False, metadata={"json": None})

    def to_dict(self) -> dict[str, Any]:
        """Return the result for JSON; arrivals are counted, not listed."""
        found = {
            "model": self.chain.model,
            "v": plain(self.v),
            "error": plain(self.error),
            "steady": self.steady,
            "status": self.status.value,
            "arrivals": int(self.arrivals.size),
            "sites": getattr(self.chain, "sites", None),
            "excited": self.excited,
            "left_boundary": plain(self.left_boundary),
            "outruns_waves": self.outruns_waves,
            "steps": self.steps,
            **plain(self.counts),
            "method": self.method,
            "seconds": self.seconds,
            "chain": plain(self.chain),
        }
        group_velocity = getattr(self.chain, "largest_group_velocity", None)
        if group_velocity is not None:
            found["largest_group_velocity"] = group_velocity
        for name in getattr(self.detail, "shown", ()):
            found[name] = plain(getattr(self.detail, name))
        return found

    @property
    def steady(self) -> bool:
        """Whether the velocity has settled."""
        return self.status is FrontStatus.STEADY

    @property
    def steps(self) -> int:
        """Steps of the integrator; 0 where there is none."""
        return self.counts.get("steps", 0)
