"""The result of a run of a chain: states, amplitudes, arrivals, and their errors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from theory.arrays import AnyArray, BoolArray, ComplexArray, FloatArray, IntArray
from theory.chains.chain import SmoothChain
from theory.result import Result, json_value
from theory.status import Status


class RunStatus(Status):
    """How far a run can be trusted."""

    RESOLVED = (
        "resolved",
        "At every sample the error is below the largest amplitude so far, and the events are the "
        "same at other tolerances: the motion is as accurate as the error states.",
    )
    EVENTS_DIFFER = (
        "events differ",
        "The runs at other tolerances had a different number of events: some event is decided "
        "by amounts below the error, or the motion is chaotic.",
    )
    NOT_RESOLVED = (
        "not resolved",
        "The error is larger than the amplitude: beyond the time up to which it is resolved, the "
        "run shows one of many possible motions. Take a smaller tolerance, or an earlier end.",
    )
    NOT_COMPARED = "not compared", "No run at another tolerance was made, so the error is unknown."


@dataclass(frozen=True, kw_only=True)
class Trajectory(Result):
    """A run of a chain.

    Attributes
    ----------
    chain : Chain
        Parameters.
    t_end : float
        Final time of the run, which may be later than the last sample.
    times : ndarray, shape (M,)
        Times t of the samples (τ for the friction chain), dimensionless.
    states : ndarray, shape (M, 2, N)
        (y, w) at those times: (y, ẏ) for (8) and (5), with ẏ exactly v_d during stick; (Im φ, Re φ)
        for (43).
    amplitude : ndarray, shape (M, N)
        √(y² + w²), which for (8) is the envelope of y up to a ripple of O(ε). For the friction
        chain, half the difference between the last maximum and the last minimum of y; 0 until both
        have occurred.
    arrivals : ndarray, shape (N,)
        Time at which each site was first reached, that is, its amplitude passed ``level`` or, in
        the friction chain, it first stuck. nan if it was not reached (``None`` in JSON).
    level : float
        Amplitude that counts as an arrival; for the friction chain, the velocity of the belt.
    error : float or None
        Bound on √(Δy² + Δw²) of every sample, by comparison with runs at other tolerances, at some
        200 times at least (fewer for more than 500 sites), so that it hardly depends on the
        samples; None if no such run was made.
    arrival_error : float or None
        The same for ``arrivals``; inf if one run saw an arrival that another did not.
    status : RunStatus
        Whether the motion is resolved.
    resolved_until : float or None
        Time of the last comparison up to which the error is below the amplitude; None if not
        compared.
    tolerance : float
        Local error: relative to the largest value of the state, absolute for the friction chain.
    method : str
        The stepper, or steppers.
    counts : mapping
        ``steps``, ``site_steps``, and further counters of the stepper; of the steps,
        ``stiff_steps`` were taken by the implicit method.
    event_log : ndarray, shape (K, 3)
        Time, site (from 1) and kind of the first events of a friction chain, if requested; no error
        of the times is known.
    seconds : float
        Run time, summed over all sessions if the run was resumed.
    """

    chain: Any
    t_end: float
    times: FloatArray = field(metadata={"axis": "t"})
    states: FloatArray = field(metadata={"dims": ("t", "component", "site")})
    amplitude: FloatArray = field(metadata={"dims": ("t", "site")})
    arrivals: FloatArray = field(metadata={"dims": ("site",)})
    level: float
    error: float | None
    arrival_error: float | None
    status: RunStatus
    resolved_until: float | None
    tolerance: float
    method: str
    counts: Mapping[str, int]
    event_log: FloatArray
    seconds: float

    def to_dict(self) -> dict[str, Any]:
        """Return the result for JSON: last sample, arrivals, errors and counts, but no others."""
        smooth = isinstance(self.chain, SmoothChain)
        width = int(self.width[-1]) if smooth else int(np.count_nonzero(~np.isnan(self.arrivals)))
        return {
            "model": self.chain.model,
            "t_end": self.t_end,
            "amplitudes": json_value(self.amplitude[-1]),
            "width": width,
            "arrivals": json_value(self.arrivals),
            "level": self.level,
            "error": json_value(self.error),
            "arrival_error": json_value(self.arrival_error),
            "status": self.status.value,
            "resolved_until": json_value(self.resolved_until),
            "tolerance": self.tolerance,
            "method": self.method,
            **json_value(self.counts),
            "mean_active": self.mean_active,
            "seconds": self.seconds,
        }

    def arrays(self) -> dict[str, AnyArray]:
        """Return the arrays that are saved to a file: the samples, under the model's own names."""
        if isinstance(self.chain, SmoothChain):
            states: dict[str, AnyArray] = {"psi": self.psi}
        else:
            states = {"y": self.y, "velocity": self.velocity, "envelope": self.amplitude}
        return {
            "times": self.times,
            **states,
            "amplitude": self.amplitude,
            "arrivals": self.arrivals,
            "level": np.array(self.level),
        }

    @property
    def y(self) -> FloatArray:
        """First component of the states, shape (M, N)."""
        return self.states[:, 0]

    @property
    def velocity(self) -> FloatArray:
        """Second component of the states, shape (M, N): ẏ for (8) and (5), Re φ for (43)."""
        return self.states[:, 1]

    @property
    def psi(self) -> ComplexArray:
        """Ψ = ẏ + iy for (8), φ for (43), shape (M, N)."""
        return self.states[:, 1] + 1j * self.states[:, 0]

    @property
    def phase(self) -> FloatArray:
        """Phase of φ in radians, shape (M, N); for (8), the phase of Ψe^{-it}."""
        oscillates = getattr(self.chain, "oscillates", False)
        rotation: Any = np.exp(-1j * self.times)[:, None] if oscillates else 1.0
        phase: FloatArray = np.angle(self.psi * rotation)
        return phase

    @property
    def width(self) -> IntArray:
        """Number of sites above the level at each sample, shape (M,)."""
        width: IntArray = np.count_nonzero(self.amplitude > self.level, axis=1)
        return width

    @property
    def stuck(self) -> BoolArray:
        """Which sites of a friction chain stick at the last sample, shape (N,)."""
        stuck: BoolArray = np.equal(self.velocity[-1], self.chain.v_d)
        return stuck

    @property
    def event_count(self) -> int:
        """Number of events of a friction chain; 0 for a smooth one."""
        return sum(self.counts.get(kind, 0) for kind in ("sticks", "releases", "reversals"))

    @property
    def steps(self) -> int:
        """Number of integration steps."""
        return self.counts["steps"]

    @property
    def mean_active(self) -> float:
        """Number of sites stepped, averaged over the steps."""
        return self.counts["site_steps"] / max(1, self.steps)
