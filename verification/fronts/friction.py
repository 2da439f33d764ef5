"""Velocity of a travelling front of Model I (Fig. 6), measured on the running chain.

The front starts from the first sites of a chain with free ends, each at a point of the stick-slip
cycle, and a site is reached when it first sticks. The rule by which v, its error and whether it is
steady (to a hundredth, unless another part is asked for) follow is that of
``verification.fronts.arrival_fit``.

Arrivals come in steps of about one period of the cycle, so that the intervals between neighbours
alternate between multiples of it and v is a mean over many sites: hence the coarser accuracy.

Velocities are in sites per unit of τ.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np
import numpy.typing as npt

from theory.cells.friction import check_sliding_stable
from theory.chains.chain import Ends
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Place
from theory.parameters import ParameterError, count_within, positive, within
from verification.fronts.arrival_fit import FrontStatus, Trial, settle
from verification.fronts.watch import RunningFront, Watch
from verification.runs.friction_integration import FrictionLane
from verification.runs.friction_start import StartPoint, nucleus, nucleus_sites
from verification.steppers import friction

FloatArray = npt.NDArray[np.float64]

MARGIN = 8
"""Sites at the far end that need not be reached: the end itself speeds the front up."""
LONGEST = 800
"""Sites of the longest chain tried."""
_LOOKS = 20
_STILL = 1e-4


@dataclass(frozen=True)
class FrictionFront:
    """A front and its velocity.

    Attributes
    ----------
    chain : FrictionChain
        Parameters; ``sites`` is the length used in the end.
    nucleus : int
        Sites excited at the start.
    status : FrontStatus
        What became of the front.
    v : float or None
        Sites per unit τ; 0 if pinned, None if there is no front or it is not known.
    error : float or None
        Uncertainty of v; for a pinned front the velocity that would have been seen.
    arrivals : ndarray, shape (m,)
        τ at which the sites beyond the nucleus first stuck.
    steps : int
        Steps of the integrator.
    seconds : float
        Run time.
    """

    chain: FrictionChain
    nucleus: int
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


def checked_sites(sites: int, size: int, most_sites: int = LONGEST) -> int:
    """Return the length tried first if it holds the nucleus and a front, and is not too long.

    Raises
    ------
    ParameterError
        If it is out of range, or the size of the nucleus is.
    """
    count_within("nucleus size", size, 1, 100)
    least = size + 3 * MARGIN
    remedy = "give such a length: it is doubled until the velocity settles"
    return count_within("number of sites n", sites, least, max(most_sites, least), remedy)


def measure_friction_front(
    chain: FrictionChain,
    *,
    size: int = 1,
    point: StartPoint | float = StartPoint.MAXIMUM,
    tolerance: float = 1e-8,
    most_sites: int = LONGEST,
    patience: float = 3000.0,
    accuracy: float = 1e-2,
    progress: Callable[[float], None] | None = None,
) -> FrictionFront:
    """Return the velocity of a front of (5) that starts from an edge.

    Parameters
    ----------
    chain : FrictionChain
        Parameters, with free ends; ``sites`` is the length tried first, at least the nucleus and
        24 more.
    size : int
        Excited sites, from 1 to 100.
    point : StartPoint or float
        Where on the cycle they start.
    tolerance : float
        Local error of y and ẏ, absolute, from 1e-12 to 1e-4.
    most_sites : int
        Longest chain tried before a front is called unsteady.
    patience : float
        τ without an arrival after which the front is looked at, and twice that before it is called
        pinned or creeping.
    accuracy : float
        Relative error of v below which the front counts as steady, from 1e-6 to 0.1.
    progress : callable, optional
        Told the part of the present chain that has been reached, now and then.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or sites start by themselves.

    Examples
    --------
    >>> front = measure_friction_front(FrictionChain(c=0.05, sites=51))
    >>> front.status.value, abs(front.v - 0.0438) < front.error < 5e-4
    ('steady', True)
    """
    started = perf_counter()
    checked_sites(chain.sites, size, most_sites)
    within("tolerance", tolerance, 1e-12, 1e-4)
    positive("patience", patience)
    within("accuracy", accuracy, 1e-6, 0.1)
    if chain.c == 0.0:
        raise ParameterError("coupling c", 0.0, "positive for a front", "give a coupling")
    check_sliding_stable(chain.cell)
    if chain.ends is not Ends.FREE:
        raise ParameterError("ends", chain.ends.value, "free for a front", "use free ends")

    def trial(sites: int) -> Trial:
        longer = replace(chain, sites=sites)
        start = nucleus(longer, nucleus_sites(sites, Place.EDGE, size), point)

        def begin(each: float) -> RunningFront:
            far = range(sites - MARGIN, sites + 1)
            lane = FrictionLane(longer, start, each, watched=far)
            return _Running(lane, slice(size, sites - MARGIN), patience / _LOOKS)

        return Watch(patience, _STILL, sites, progress).trial(begin, tolerance)

    found = settle(trial, chain.sites, most_sites, accuracy, 1.0 / patience)
    return FrictionFront(
        replace(chain, sites=found.sites),
        size,
        found.status,
        found.v,
        found.error,
        found.arrivals,
        found.steps,
        perf_counter() - started,
    )


@dataclass(frozen=True)
class _Running:
    """A lane, the sites of which v is made, and how far to step between two looks."""

    lane: FrictionLane
    used: slice
    piece: float

    @property
    def time(self) -> float:
        return self.lane.time

    @property
    def steps(self) -> int:
        return int(self.lane.counters[friction.STEPS])

    @property
    def reached(self) -> int:
        return int(np.flatnonzero(~np.isnan(self.lane.arrivals)).max(initial=0))

    @property
    def amplitude(self) -> FloatArray:
        return self.lane.amplitude

    @property
    def arrivals(self) -> FloatArray:
        return self.lane.arrivals[self.used]

    def going_to_rest(self) -> bool:
        return self.lane.going_to_rest()

    def go_on(self) -> bool:
        return self.lane.go_to(self.lane.time + self.piece, wanted=1)
