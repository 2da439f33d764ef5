"""Velocity of a travelling front of Model II, measured on the running chain, with its uncertainty.

The front starts from sites on the stable cycle, each a quarter of a turn behind the one before
(the phase to which fronts lock), runs along a chain with free ends, and is timed at each site.

Behind the front, phase waves move at velocities up to c, undamped. A front with v̂ > c outruns them:
how it began does not matter, and only a number of sites behind it are stepped. A front with v̂ < c
is overtaken by what the free end sends after it, and its velocity is another one; then all sites
are stepped (``Behind``).

The rule by which v, its error and whether it is steady (to a thousandth, unless another part is
asked for) follow is that of ``verification.fronts.arrival_fit``; on a chain so long as is allowed,
but not long enough for a front with v̂ < c to be overtaken, the error is at least the difference
from the front with a wave behind it.

Velocities are v̂ = v/ε, sites per unit of slow time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from time import perf_counter

import numpy as np
import numpy.typing as npt

from theory.chains.chain import Ends
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError, count_within, positive, within
from verification.fronts.arrival_fit import FrontStatus, Trial, settle
from verification.fronts.watch import RunningFront, Watch
from verification.runs.vdp import Model
from verification.runs.vdp_integration import Lane
from verification.runs.vdp_start import staggered_front

FloatArray = npt.NDArray[np.float64]

LONGEST = 1000
"""Sites beyond the start of the longest chain tried."""
_BUDGET = 5000
"""Sites times steps between two looks."""
_END = 8
"""Sites at the far end that need not be reached: the end itself speeds the front up."""
_DECAYED = 0.5
_STILL = 1e-3


class Behind(StrEnum):
    """What is behind the first site; of consequence only where v̂ < c."""

    FREE = "free"
    """Nothing: the first site is a free end."""

    WAVE = "wave"
    """A wave that goes on for ever, each site a quarter of a turn ahead of the next."""


_OUTRUNS = 1.01
"""A front faster than c times this is not overtaken."""


@dataclass(frozen=True)
class FrontMeasurement:
    """A front and its velocity.

    Attributes
    ----------
    chain : VdpChain
        Parameters; ``sites`` is the length used in the end.
    model : Model
        Equation.
    behind : Behind
        What was behind the first site.
    status : FrontStatus
        What became of the front.
    outruns : bool
        Whether the front outruns the waves behind it, v̂ > c: then ``behind`` changes nothing.
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
    behind: Behind
    status: FrontStatus
    outruns: bool
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
    behind: Behind = Behind.FREE,
    tolerance: float = 1e-8,
    filled: int = 24,
    most_sites: int = LONGEST,
    patience: float = 60.0,
    accuracy: float = 1e-3,
    progress: Callable[[float], None] | None = None,
) -> FrontMeasurement:
    """Return the velocity of a front of (8) or (43).

    Parameters
    ----------
    chain : VdpChain
        Parameters; ``sites`` is the length tried first, beyond the filled ones, and the right end
        is taken as free.
    model : Model
        (8), or (43).
    behind : Behind
        What is behind the first site.
    tolerance : float
        Of the integrator.
    filled : int
        Sites on the cycle at the start, from 4 to 1000; so many are kept behind the front if it
        outruns the waves there.
    most_sites : int
        Longest chain tried before a front is called unsteady.
    accuracy : float
        Relative error of v below which the front counts as steady, from 1e-10 to 0.1.
    patience : float
        Slow time without an arrival after which the front is looked at, and twice that before it
        is called creeping.
    progress : callable, optional
        Told the fraction of the present chain that has been run through, now and then.

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
    rule = _Rule(model, tolerance, filled, most_sites, patience, accuracy, progress)
    found = _measure(chain, rule, Behind.WAVE)
    outruns = found.v is not None and found.v > _OUTRUNS * chain.c
    if behind is Behind.FREE and not outruns:
        found = _measure(chain, rule, Behind.FREE, found)
    return replace(found, behind=behind, outruns=outruns, seconds=perf_counter() - begin)


@dataclass(frozen=True)
class _Rule:
    model: Model
    tolerance: float
    filled: int
    most_sites: int
    patience: float
    accuracy: float
    progress: Callable[[float], None] | None


def _measure(
    chain: VdpChain, rule: _Rule, behind: Behind, wave: FrontMeasurement | None = None
) -> FrontMeasurement:
    """Measure on longer and longer chains, until v is known well enough; ``wave`` came before."""

    def sized(sites: int) -> VdpChain:
        return replace(chain, sites=rule.filled + sites, ends=Ends.FREE)

    def trial(sites: int) -> Trial:
        longer = sized(sites)
        watch = Watch(
            rule.patience / chain.eps, _STILL * chain.stable_amplitude, longer.sites, rule.progress
        )
        return watch.trial(lambda each: _begin(longer, rule, each, behind), rule.tolerance)

    found = settle(
        trial,
        max(chain.sites, 32),
        rule.most_sites,
        rule.accuracy,
        chain.eps / rule.patience,
        lambda sites, v: sites >= _overtaken(chain.c, v / chain.eps, rule.filled, behind),
        None if wave is None or wave.v is None else chain.eps * wave.v,
    )
    v, error = (None if x is None else x / chain.eps for x in (found.v, found.error))
    steps = found.steps + (wave.steps if wave else 0)
    return FrontMeasurement(
        sized(found.sites),
        rule.model,
        behind,
        found.status,
        False,
        v,
        error,
        found.arrivals,
        steps,
        0.0,
    )


def _overtaken(c: float, v: float, filled: int, behind: Behind) -> float:
    """Return the sites after which waves from the free end have long overtaken the front.

    The first reach it after v filled/(c - v) sites; four times that, so that it happens in the
    first half of those that are not used.
    """
    if behind is Behind.WAVE or v > _OUTRUNS * c:
        return 0.0
    return 4.0 * v * filled / (c - v) if v < c else np.inf


def _begin(chain: VdpChain, rule: _Rule, tolerance: float, behind: Behind) -> RunningFront:
    """Return a run long enough for every site to be reached just in time."""
    t_end = (chain.sites + 4) * 2.0 * rule.patience / chain.eps
    lane = Lane(
        chain,
        rule.model is Model.FULL,
        staggered_front(chain, rule.filled),
        np.array([0.0, t_end]),
        tolerance,
        chain.unstable_amplitude,
        window=True,
        behind=rule.filled if behind is Behind.WAVE else 0,
        wave=behind is Behind.WAVE,
    )
    return _Running(lane, rule.filled, chain.sites - _END, _DECAYED * chain.unstable_amplitude)


@dataclass(frozen=True)
class _Running:
    """A lane, its first site of which v is made, how many are wanted, and what counts as rest."""

    lane: Lane
    first: int
    wanted: int
    rest: float

    @property
    def time(self) -> float:
        return self.lane.time

    @property
    def steps(self) -> int:
        return int(self.lane.counters[3])

    @property
    def reached(self) -> int:
        return int(np.count_nonzero(~np.isnan(self.lane.arrivals)))

    @property
    def amplitude(self) -> FloatArray:
        amplitude: FloatArray = np.hypot(self.lane.state[0], self.lane.state[1])
        return amplitude

    @property
    def arrivals(self) -> FloatArray:
        return self.lane.arrivals[self.first :]

    def going_to_rest(self) -> bool:
        return bool(self.amplitude.max() < self.rest)

    def go_on(self) -> bool:
        self.lane.advance(_BUDGET)
        return not np.isnan(self.lane.arrivals[self.wanted - 1])
