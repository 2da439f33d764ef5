"""Velocity of a travelling front of Model II, measured on the running chain, with its uncertainty.

The front starts from sites on the stable cycle, each a quarter of a turn behind the one before
(the phase to which fronts lock), runs along a chain with free ends, and is timed at each site.
Only a number of sites behind the front are stepped. The rule by which v, its error and whether it
is steady (to a thousandth, unless another part is asked for) follow is that of
``verification.arrival_fit``.

Velocities are v̂ = v/ε, sites per unit of slow time.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
import numpy.typing as npt

from theory.parameters import ParameterError, count_within, positive, within
from theory.vdp_chain import Ends, VdpChain
from verification.arrival_fit import FrontStatus, Trial, settle, velocity_of_arrivals
from verification.vdp_lane import Lane
from verification.vdp_run import COMPANION, Model
from verification.vdp_start import staggered_front

FloatArray = npt.NDArray[np.float64]

_BUDGET = 200_000
_DECAYED = 0.5


@dataclass(frozen=True)
class FrontMeasurement:
    """A front and its velocity.

    Attributes
    ----------
    chain : VdpChain
        Parameters; ``sites`` is the length used in the end.
    model : Model
        Equation.
    status : FrontStatus
        What became of the front.
    v : float or None
        v̂ = v/ε; 0 if pinned, None if there is no front or it is not known.
    error : float or None
        Uncertainty of v; for a pinned front the velocity that would have been seen.
    arrivals : ndarray, shape (m,)
        Times t at which the sites beyond the start were reached.
    steps : int
        Steps of the integrator.
    seconds : float
        Run time.
    """

    chain: VdpChain
    model: Model
    status: FrontStatus
    v: float | None
    error: float | None
    arrivals: FloatArray
    steps: int
    seconds: float

    @property
    def steady(self) -> bool:
        """Whether the velocity has settled."""
        return self.status is FrontStatus.STEADY


def measure_front(
    chain: VdpChain,
    model: Model = Model.ENVELOPE,
    *,
    tolerance: float = 1e-8,
    filled: int = 24,
    most_sites: int = 2000,
    patience: float = 60.0,
    accuracy: float = 1e-3,
) -> FrontMeasurement:
    """Return the velocity of a front of (8) or (43).

    Parameters
    ----------
    chain : VdpChain
        Parameters; ``sites`` is the length tried first, beyond the filled ones, and the ends are
        taken as free.
    model : Model
        (8), or (43).
    tolerance : float
        Of the integrator.
    filled : int
        Sites on the cycle at the start, and sites kept behind the front; from 4 to 1000.
    most_sites : int
        Longest chain tried before a front is called unsteady.
    accuracy : float
        Relative error of v below which the front counts as steady, from 1e-10 to 0.1.
    patience : float
        Slow time without an arrival after which the front is looked at, and twice that before it
        is called creeping.

    Raises
    ------
    ParameterError
        If the cell has no two cycles, or a parameter is out of range.

    Examples
    --------
    >>> front = measure_front(VdpChain(a=4, b=0.5, c=0.6))
    >>> front.status.value, abs(front.v - 0.722566) < 1e-6, front.error < 1e-5
    ('steady', True, True)
    """
    begin = perf_counter()
    count_within("filled sites", filled, 4, 1000)
    positive("patience", patience)
    within("accuracy", accuracy, 1e-10, 0.1)
    if chain.c == 0.0:
        raise ParameterError("coupling c", 0.0, "positive for a front", "give a coupling")

    def sized(sites: int) -> VdpChain:
        return replace(chain, sites=filled + sites, ends=Ends.FREE)

    def trial(sites: int) -> Trial:
        longer = sized(sites)
        lanes: list[Lane] = []
        for each in (tolerance, min(1e-2, COMPANION * tolerance)):
            lanes.append(_lane(longer, model, each, filled, patience))
            stopped = _follow(lanes[-1], longer, filled, patience)
            if stopped is not None:
                break
        steps = sum(int(lane.counters[3]) for lane in lanes)
        return Trial(stopped, lanes[0].arrivals[filled:], lanes[-1].arrivals[filled:], steps)

    seen = chain.eps / patience
    found = settle(trial, max(chain.sites, 32), most_sites, accuracy, seen)
    v, error = (None if x is None else x / chain.eps for x in (found.v, found.error))
    return FrontMeasurement(
        sized(found.sites),
        model,
        found.status,
        v,
        error,
        found.arrivals,
        found.steps,
        perf_counter() - begin,
    )


def velocity_of(arrivals: FloatArray, eps: float) -> tuple[float, float]:
    """Return v̂ and its uncertainty from the second half of the arrival times.

    Parameters
    ----------
    arrivals : ndarray, shape (m,)
        Times t, ascending, at neighbouring sites; m at least 16.
    eps : float
        ε.

    Examples
    --------
    >>> velocity_of(np.arange(32) / 0.02, eps=0.01)
    (2.0, 0.0)
    """
    v, error = velocity_of_arrivals(arrivals)
    return v / eps, error / eps


def _lane(chain: VdpChain, model: Model, tolerance: float, filled: int, patience: float) -> Lane:
    """Return a run long enough for every site to be reached just in time."""
    t_end = (chain.sites + 4) * 2.0 * patience / chain.eps
    start = staggered_front(chain, filled)
    return Lane(
        chain,
        model is Model.FULL,
        start,
        np.array([0.0, t_end]),
        tolerance,
        chain.unstable_amplitude,
        window=True,
        behind=filled,
    )


def _follow(lane: Lane, chain: VdpChain, filled: int, patience: float) -> FrontStatus | None:
    """Step until the last site but eight is reached (None), or until the front has stopped."""
    wanted = chain.sites - 8
    slow = 1.0 / chain.eps
    reached, when = filled, 0.0
    early: FloatArray | None = None
    while True:
        lane.go_on(_BUDGET // 40)
        arrivals = lane.arrivals
        if not np.isnan(arrivals[wanted - 1]):
            return None
        now = int(np.count_nonzero(~np.isnan(arrivals)))
        if now > reached:
            reached, when, early = now, lane.time, None
        if lane.time - when > patience * slow:
            current = _amplitudes(lane)
            if current.max() < _DECAYED * chain.unstable_amplitude:
                return FrontStatus.COLLAPSED
            if early is None:
                early = current
            if lane.time - when > 2.0 * patience * slow:
                change = float(np.max(np.abs(current - early)))
                still = change < 1e-3 * chain.stable_amplitude
                return FrontStatus.PINNED if still else FrontStatus.CREEPING


def _amplitudes(lane: Lane) -> FloatArray:
    amplitudes: FloatArray = np.hypot(lane.state[0], lane.state[1])
    return amplitudes
