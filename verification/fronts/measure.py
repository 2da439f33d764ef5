"""Velocity of a travelling front of any chain, measured by running the chain, with an uncertainty.

A front is started from the first sites of a chain with free ends, and its arrival at each site is
timed; the chain is lengthened until the velocity has settled or the front has stopped. The rule is
the same for all models (``arrival_fit``, ``watch``); :class:`FrontPreparation` holds what differs.
Lattices and networks are not lengthened (``network``). By model:

* A smooth chain starts with sites on the stable cycle, with the phase step to which its fronts
  lock. Behind a front of (8) or (43), undamped phase waves run at velocities up to c. A front with
  v̂ > c outruns them: its velocity does not depend on how it was started, and only a fixed number
  of sites behind it is integrated. A front with v̂ < c is overtaken by the waves from the free end,
  which changes its velocity; then all sites are integrated (``LeftBoundary``). If the longest chain
  allowed is too short for the waves to arrive, the stated error is at least the difference from the
  velocity of the front that has a wave behind it.
* The friction chain starts with sites on the stick-slip cycle; a site is reached when it first
  sticks. Arrivals are spaced by about one period of the cycle, so that v is a mean over many sites;
  hence the coarser default accuracy.
* For (43) one can solve for the travelling wave itself (``wave``), which gives v to 1e-11 and the
  multipliers.
* The piecewise-linear chain (44) is infinite and is advanced exactly from one switching to the next
  (``verification.piecewise``).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import singledispatch
from time import perf_counter
from typing import Any, Literal

import numpy as np

from theory.cells.friction import check_sliding_stable
from theory.chains.chain import MAX_SITES, Chain, SmoothChain
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.chains.own import OwnChain
from theory.chains.piecewise import PiecewiseChain
from theory.chains.vdp import AveragedChain
from theory.parameters import (
    LATEST,
    ParameterError,
    count_within,
    need_instance,
    within,
    word,
)
from verification.execution.progress import ProgressCallback
from verification.fronts.arrival_fit import Settled, Trial, settle
from verification.fronts.network import spreading_front
from verification.fronts.request import RUN, Request
from verification.fronts.resting import StaticFold, static_fold
from verification.fronts.result import Front, LeftBoundary
from verification.fronts.status import FrontStatus
from verification.fronts.switchings import front_by_switchings
from verification.fronts.watch import MARGIN, Watch
from verification.fronts.wave import FrontWave, NoFrontError, front_wave
from verification.runs.excite import StartPoint, excite, excite_edge
from verification.runs.friction_integration import FrictionIntegration
from verification.runs.integration import Integration
from verification.runs.simulate import MAX_TOLERANCE, MIN_TOLERANCE
from verification.runs.smooth_integration import SmoothIntegration

OUTRUNS = 1.01
"""Ratio of front velocity to wave velocity above which the front outruns the waves behind it."""

EXCITED, MAX_EXCITED = 24, 1000


def measure_front(  # noqa: PLR0913  (options of every kind of chain)
    chain: Chain,
    *,
    method: Literal["run", "wave"] = "run",
    accuracy: float | None = None,
    tolerance: float | None = None,
    excited: int | None = None,
    max_sites: int | None = None,
    stall_time: float | None = None,
    left_boundary: LeftBoundary = LeftBoundary.FREE,
    point: StartPoint | float = StartPoint.MAXIMUM,
    directions: int | None = None,
    progress: ProgressCallback | None = None,
) -> Front:
    """Return the velocity of a front of (8), (43), (44), (5), or of a user-defined smooth chain.

    Parameters
    ----------
    chain : Chain
        The chain and its parameters, with free ends. Its ``sites`` is the length tried first: for a
        smooth chain the number of sites beyond the excited ones, at least 32; for a friction chain
        the total.
    method : {"run", "wave"}, optional
        ``run``: fit the arrival times on a running chain. ``wave``, for (43) only: solve for the
        travelling wave itself, with its multipliers; no other option applies then.
    accuracy : float, optional
        Relative error of v below which the front counts as steady, from 1e-13 to 0.1; by default
        1e-3, and 0.1 on a lattice or network. For the friction chain from 1e-6, by default 1e-2.
        For (44) it is the relative spread of the period, from 1e-13 to 0.01, by default 1e-12.
    tolerance : float, optional
        Local error of the integrator, from 1e-14 to 0.01, and for the friction chain from 1e-12 to
        1e-4; by default 1e-8.
    excited : int, optional
        Number of sites excited at the start. Smooth chain: 4 to 1000, by default 24; as many sites
        are kept behind a front that outruns its waves. Friction chain: 1 to 100, by default 1.
        Lattice: the number of rows, by default 4. Lattice with ``directions``, or network: the
        number of sites nearest to its centre, by default 37.
    max_sites : int, optional
        Length of the longest chain tried before a front is called unsteady: by default 1000 sites
        beyond the excited ones, and 800 in total for the friction chain. For (44) the largest
        number of sites that a front may pass, at least 80, by default 1000.
    stall_time : float, optional
        Time without an arrival, in units of ``chain.time_unit``, after which a front is suspected
        of having stopped; after twice this time it is called pinned or creeping. By default 60, and
        3000 for the friction chain.
    left_boundary : LeftBoundary
        What is to the left of the first site of a smooth chain.
    point : StartPoint or float
        Where on the cycle, or at which y, the excited sites of a friction chain start.
    directions : int, optional
        For a lattice: excite its centre and measure v in this number of directions, 4 to 360; by
        default a planar front runs across its rows. Lattices and networks are not lengthened.
    progress : callable, optional
        Called at intervals with the fraction of the present chain that the front has passed.

    Returns
    -------
    Front
        Its ``v`` and ``error`` are in sites per unit of the chain's slow time, dimensionless.

    Raises
    ------
    ParameterError
        If the cell does not have two cycles, sites start to oscillate by themselves, a parameter is
        out of range, or an option is given that has no effect on this front.

    References
    ----------
    Fronts in chains of discrete cells: W. Atkinson and N. Cabrera (1965), L. Slepyan (2002).

    Examples
    --------
    >>> from theory.chains.vdp import AveragedChain
    >>> front = measure_front(AveragedChain(a=4, b=0.5, c=0.6))
    >>> front.status.value, abs(front.v - 0.722566) < 1e-6, front.error < 1e-5
    ('steady', True, True)
    """
    begin = perf_counter()
    need_instance("chain", chain, (Chain,), "give one, as VdpChain(a=4, b=0.5, c=0.6)")
    word("method", method, ("run", "wave"))
    if accuracy is not None:
        accuracy = within("accuracy", accuracy, 1e-13, 0.1)
    if tolerance is not None:
        tolerance = within("tolerance", tolerance, MIN_TOLERANCE, MAX_TOLERANCE)
    if excited is not None:
        excited = count_within("excited sites", excited, 1, MAX_SITES)
    if max_sites is not None:
        max_sites = count_within("longest chain, max_sites,", max_sites, 1, MAX_SITES)
    if stall_time is not None:
        stall_time = within("stall time", stall_time, 1e-6, LATEST)
    if directions is not None:
        directions = count_within("directions", directions, 4, 360)
    request = Request(
        accuracy=accuracy,
        tolerance=tolerance,
        excited=excited,
        max_sites=max_sites,
        stall_time=stall_time,
        left_boundary=LeftBoundary(left_boundary),
        point=point,
        directions=directions,
        progress=progress,
    )
    if method == "wave":
        request.reads(where="beside the method wave")
        return front_of_wave(chain)
    if getattr(chain, "c", 1.0) == 0.0:
        raise ParameterError("coupling c", 0.0, "positive for a front", "give a coupling")
    return replace(_measured(chain, request), seconds=perf_counter() - begin)


def front_of_wave(chain: Chain, wave: FrontWave | None = None) -> Front:
    """Return the front of (43) by solving for the wave, or from a wave already solved for.

    Raises
    ------
    ParameterError
        If the chain is not of the form (43), or η is out of range.
    NoFrontError
        If the front is pinned, or travels at a velocity below 1e-3.
    """
    if not isinstance(chain, AveragedChain):
        raise ParameterError(
            "method", "wave", f"run for the model {chain.model}: a wave of (43) is solved for",
            "take the model averaged",
        )  # fmt: skip
    begin = perf_counter()
    found: FrontWave | StaticFold | None = wave
    if found is None:
        try:
            found = front_wave(chain.c, chain.eta)
        except NoFrontError:
            found = static_fold(chain.eta)
            if chain.c > found.c:
                raise
    front = Front(
        chain=chain,
        status=FrontStatus.PINNED,
        v=0.0,
        error=0.0,
        excited=None,
        left_boundary=LeftBoundary.WAVE,
        outruns_waves=False,
        arrivals=np.empty(0),
        method="wave",
        counts={},
        seconds=perf_counter() - begin,
        detail=found,
    )
    if isinstance(found, StaticFold):
        return front
    return replace(
        front,
        status=FrontStatus.STEADY,
        v=found.v,
        error=found.error,
        outruns_waves=found.v > OUTRUNS * chain.c,
        counts={"steps": found.steps, "iterations": found.iterations},
        seconds=found.seconds,
    )


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
        As in :func:`measure_front`.
    stall_time : float
        In units of t.
    settling_tolerance : float
        Growth of an amplitude ahead of the front below which the front counts as pinned; see
        ``watch.Stall``.
    method : str
        Name of the stepper.
    enough : callable
        Whether a chain of a given length is also long enough by another criterion, given v (in t).
    doubt : float, optional
        A second velocity (in t); if ``enough`` does not hold on the longest chain, the stated error
        is at least the difference from it.
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
    enough: Callable[[int, float], bool] = field(default=lambda sites, v: True)
    doubt: float | None = None


@singledispatch
def _measured(chain: Chain, request: Request) -> Front:
    """Return the front of a chain; each kind registers its method and the options it uses."""
    raise ParameterError(
        "model", chain.model, "one whose fronts can be measured", "take another chain"
    )


def _settled(preparation: FrontPreparation, progress: ProgressCallback | None) -> Settled:
    """Measure on successively longer chains until v has settled or the front has stopped."""
    watch = Watch(
        stall_time=preparation.stall_time,
        settling_tolerance=preparation.settling_tolerance,
        first=preparation.excited,
        progress=progress,
    )

    def trial(sites: int) -> Trial:
        longer = preparation.sized(sites)
        return watch.trial(lambda each: preparation.begin(longer, each), preparation.tolerance)

    return settle(
        trial,
        sites=preparation.sites,
        max_sites=preparation.max_sites,
        accuracy=preparation.accuracy,
        seen=1.0 / preparation.stall_time,
        enough=preparation.enough,
        doubt=preparation.doubt,
    )


def _front(
    preparation: FrontPreparation,
    found: Settled,
    boundary: LeftBoundary | None,
    outruns: bool,
    earlier_steps: int = 0,
) -> Front:
    chain = preparation.sized(found.sites)
    unit = chain.time_unit
    return Front(
        chain=chain,
        status=found.status,
        v=None if found.v is None else found.v * unit,
        error=None if found.error is None else found.error * unit,
        excited=preparation.excited,
        left_boundary=boundary,
        outruns_waves=outruns,
        arrivals=found.arrivals,
        method=preparation.method,
        counts={"steps": found.steps + earlier_steps},
        seconds=0.0,
    )


@_measured.register
def _smooth_front(chain: SmoothChain, request: Request) -> Front:
    request.reads(*RUN, "left_boundary", where="for a chain of a smooth cell")
    waves = chain.trailing_wave_velocity
    wave = _prepare_smooth(chain, request, LeftBoundary.WAVE)
    found = _settled(wave, request.progress)
    outruns = found.v is not None and found.v > OUTRUNS * waves
    stands = found.v is None or found.v == 0.0
    if request.left_boundary is LeftBoundary.WAVE and not (outruns or stands):
        found = _beside_longer_wave(found, wave.accuracy, chain, request)
    if request.left_boundary is LeftBoundary.WAVE or outruns or waves == 0.0:
        return _front(wave, found, request.left_boundary, outruns)
    free = replace(_prepare_smooth(chain, request, LeftBoundary.FREE), doubt=found.v)
    slower = _settled(free, request.progress)
    return _front(free, slower, request.left_boundary, False, found.steps)


def _beside_longer_wave(
    found: Settled, accuracy: float, chain: SmoothChain, request: Request
) -> Settled:
    """Return a front overtaken by waves, with an error no smaller than the effect of the boundary.

    The wave imposed at its left end has a phase lag of a quarter turn per site, whereas the front
    itself has exactly this lag only in the limit of small ε. The measurement is repeated with twice
    as many sites between boundary and front, so that a different part of that wave has arrived.
    """
    assert found.v is not None
    assert found.error is not None
    twice = min(2 * (request.excited or EXCITED), MAX_EXCITED)
    farther = _prepare_smooth(chain, replace(request, excited=twice), LeftBoundary.WAVE)
    other = _settled(farther, request.progress)
    apart = abs(found.v - (other.v or 0.0))
    steady = apart < accuracy * found.v
    return replace(
        found,
        error=max(found.error, apart),
        status=found.status if steady else FrontStatus.UNSTEADY,
        steps=found.steps + other.steps,
    )


@_measured.register
def _own_front(chain: OwnChain, request: Request) -> Front:
    """Measure a chain like any other model; a lattice or network, outwards from its centre."""
    if not chain.along_line:
        return spreading_front(chain, request)
    weights = chain.coupling.partition(":")[2]
    if any(np.ndim(each) for each in chain.values.values()):
        raise ParameterError(
            "values", "an array", "one number each for a front, whose chain is made longer",
            "give disorder by its spread and seed",
        )  # fmt: skip
    straight = f"chain:{weights}" if weights else "chain"
    free = chain.replace(coupling=straight, ends=Ends.FREE)
    if free.network is None:
        return _smooth_front(free, request)
    request.reads(*RUN, where="where sites differ or have more than two neighbours")
    prepared = _prepare_smooth(free, request, LeftBoundary.FREE)
    found = _settled(prepared, request.progress)
    outruns = found.v is not None and found.v > OUTRUNS * free.trailing_wave_velocity
    return _front(prepared, found, LeftBoundary.FREE, outruns)


def _prepare_smooth(
    chain: SmoothChain, request: Request, boundary: LeftBoundary
) -> FrontPreparation:
    excited = EXCITED if request.excited is None else request.excited
    count_within("excited sites", excited, 4, MAX_EXCITED)
    max_sites = 1000 if request.max_sites is None else request.max_sites
    stall = (60.0 if request.stall_time is None else request.stall_time) * chain.time_unit
    on = boundary is LeftBoundary.WAVE
    waves = chain.trailing_wave_velocity

    def sized(sites: int) -> SmoothChain:
        longer = chain.replace(sites=excited + sites)
        return longer if longer.ends is Ends.FREE else longer.replace(ends=Ends.FREE)

    def begin(longer: SmoothChain, tolerance: float) -> Integration:
        # Long enough for the slowest front that is not called stalled.
        end = (longer.sites + 4) * 2.0 * stall
        return SmoothIntegration(
            longer,
            excite_edge(longer, excited),
            [0.0, end],
            tolerance=tolerance,
            trailing_sites=excited if on else 0,
            left_boundary_wave=on,
        )

    def enough(sites: int, v: float) -> bool:
        """Whether waves from the free end have long overtaken the front.

        The first of them reach it after v·excited/(waves - v) sites. Four times as many are
        required: the waves then arrive within the first quarter of the sites, well before the
        second half, to which v is fitted.
        """
        if on or v > OUTRUNS * waves:
            return True
        return v < waves and sites >= 4.0 * v * excited / (waves - v)

    return FrontPreparation(
        sized=sized,
        begin=begin,
        excited=excited,
        sites=max(count_within("number of sites n", chain.sites, 2, max_sites), 32),
        max_sites=max_sites,
        accuracy=1e-3 if request.accuracy is None else request.accuracy,
        tolerance=1e-8 if request.tolerance is None else request.tolerance,
        stall_time=stall,
        settling_tolerance=1e-3 * chain.stable_amplitude,
        method=SmoothIntegration.method,
        enough=enough,
    )


FRICTION_MAX_SITES = 800

MAX_FRICTION_COUPLING = 1e4
"""Largest coupling for a front of (5). With the default options the run takes 1.4 s of CPU time at
c = 1e3, 11 s at this limit, 105 s at 2e4 and hours at 1e6: steps are as short as 1/√c, each
reversal of the fast waves is an event, and sites stick so rarely that the whole stall time
elapses."""


def checked_friction_sites(sites: int, excited: int, max_sites: int = FRICTION_MAX_SITES) -> int:
    """Return the length tried first, checked to be long enough for a front and not too long.

    Raises
    ------
    ParameterError
        If the length or the number of excited sites is out of range.
    """
    count_within("excited sites", excited, 1, 100)
    least = excited + 3 * MARGIN
    remedy = "give such a length: it is doubled until the velocity settles"
    return count_within("number of sites n", sites, least, max(max_sites, least), remedy)


@_measured.register
def _friction_front(chain: FrictionChain, request: Request) -> Front:
    request.reads(*RUN, "point", where="for the friction chain")
    excited = 1 if request.excited is None else request.excited
    max_sites = FRICTION_MAX_SITES if request.max_sites is None else request.max_sites
    checked_friction_sites(chain.sites, excited, max_sites)
    tolerance = 1e-8 if request.tolerance is None else request.tolerance
    within("tolerance", tolerance, 1e-12, 1e-4)
    accuracy = 1e-2 if request.accuracy is None else request.accuracy
    within("accuracy", accuracy, 1e-6, 0.1)
    remedy = "take a smaller one, or simulate a run of limited time: above, a front takes hours"
    within("coupling c of a friction front", chain.c, 0.0, MAX_FRICTION_COUPLING, remedy)
    check_sliding_stable(chain.cell)
    if chain.ends is not Ends.FREE:
        raise ParameterError("ends", chain.ends.value, "free for a front", "use free ends")

    def begin(longer: FrictionChain, each: float) -> Integration:
        sites = range(1, excited + 1)
        if isinstance(request.point, StartPoint):
            start = excite(longer, sites, point=request.point)
        else:
            start = excite(longer, sites, request.point)
        return FrictionIntegration(longer, start, tolerance=each)

    preparation = FrontPreparation(
        sized=lambda sites: chain.replace(sites=sites),
        begin=begin,
        excited=excited,
        sites=chain.sites,
        max_sites=max_sites,
        accuracy=accuracy,
        tolerance=tolerance,
        stall_time=3000.0 if request.stall_time is None else request.stall_time,
        settling_tolerance=1e-4,
        method=FrictionIntegration.method,
    )
    return _front(preparation, _settled(preparation, request.progress), None, False)


@_measured.register
def _piecewise_front(chain: PiecewiseChain, request: Request) -> Front:
    request.reads("accuracy", "max_sites", where="for the chain (44)")
    return front_by_switchings(
        chain,
        accuracy=1e-12 if request.accuracy is None else request.accuracy,
        max_sites=1000 if request.max_sites is None else request.max_sites,
    )
