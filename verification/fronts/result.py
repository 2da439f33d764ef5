"""A front and its velocity."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from theory.arrays import FloatArray
from theory.result import Result, json_value
from theory.status import Status
from verification.fronts.status import FrontStatus


class LeftBoundary(Status):
    """What lies to the left of the first site; it matters only where waves overtake the front."""

    FREE = "free", "Nothing: the first site is a free end."
    WAVE = "wave", "A wave without end, with the phase step of the front at each site."


@dataclass(frozen=True, kw_only=True)
class Front(Result):
    """A front and its velocity.

    Attributes
    ----------
    chain : Chain
        The chain and its parameters; its length, if finite, is that of the last run.
    status : FrontStatus
        What became of the front.
    v : float or None
        Velocity in sites per ``time_unit`` of the chain: v̂ = v/ε for (8) and (43), per unit τ for
        (5), per slow time for (44). 0 if pinned, None if there is no front or its velocity is
        unknown.
    error : float or None
        Uncertainty of v; for a pinned front, the smallest velocity that would have been noticed.
        Infinite if it is not known, since the front of a smooth chain has not travelled for the
        relaxation time of that chain, or that of a friction chain for ten periods.
    excited : int or None
        Number of sites excited at the start.
    left_boundary : LeftBoundary or None
        What lay to the left of the first site; None where the model offers no such choice.
    outruns_waves : bool
        Whether the front outruns all waves behind it, in which case ``left_boundary`` has no
        effect.
    arrivals : ndarray, shape (m,)
        Times t at which the sites beyond the start were reached, in order of the sites; no error is
        known.
    method : str
        The numerical method.
    counts : mapping
        ``steps`` of the integrator, or ``events``, and further counts.
    seconds : float
        Run time.
    detail : object or None
        Further results of the method: for (44) a ``verification.piecewise.run.FrontRun``, for a
        wave a ``verification.fronts.wave.FrontWave``, for a lattice or network a
        ``verification.fronts.network.Spread``. The attributes named in its ``shown`` appear in the
        JSON object.
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
        """Return the result for JSON, with the number of arrivals in place of their list."""
        found = {
            "model": self.chain.model,
            "v": json_value(self.v),
            "error": json_value(self.error),
            "steady": self.steady,
            "status": self.status.value,
            "arrivals": int(self.arrivals.size),
            "sites": getattr(self.chain, "sites", None),
            "excited": self.excited,
            "left_boundary": json_value(self.left_boundary),
            "outruns_waves": self.outruns_waves,
            "steps": self.steps,
            **json_value(self.counts),
            "method": self.method,
            "seconds": self.seconds,
            "chain": json_value(self.chain),
        }
        group_velocity = getattr(self.chain, "largest_group_velocity", None)
        if group_velocity is not None:
            found["largest_group_velocity"] = group_velocity
        for name in getattr(self.detail, "shown", ()):
            found[name] = json_value(getattr(self.detail, name))
        return found

    @property
    def steady(self) -> bool:
        """Whether the velocity has settled."""
        return self.status is FrontStatus.STEADY

    @property
    def steps(self) -> int:
        """Number of integrator steps; 0 for methods without an integrator."""
        return self.counts.get("steps", 0)
