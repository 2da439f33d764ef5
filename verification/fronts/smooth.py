"""Fronts of smooth chains, measured by running them.

A smooth chain starts with sites on the stable cycle, with the phase step to which its fronts
lock. Behind a front of (8) or (43), undamped phase waves run at velocities up to c. A front with
v̂ > c outruns them: its velocity does not depend on how it was started, and only a fixed number
of sites behind it is integrated. A front with v̂ < c is overtaken by the waves from the free end,
which changes its velocity; then all sites are integrated (``LeftBoundary``). If the longest chain
allowed is too short for the waves to arrive, the stated error is at least the difference from the
velocity of the front that has a wave behind it.

A front of cells without waves and oscillations can be so wide that a site is still changing when it
is left out behind it. The state in which sites are left out shows this; the numbers of sites
behind the front and on the shortest chain are then doubled, until it is settled. Of cells that
oscillate with coupled velocities, whose fronts are wide too, amplitudes and arrivals vary with the
phase; these numbers are doubled until v hardly changes, and the chain until it is twice as long as
one of nearly the same v. Arrivals close to the far end, within the length of the tail ahead of the
front, are not used for v.

Where coupling is strong, a front passes many sites before a site at rest would return there. If
waves run ahead of it, the velocity after the start falls to a minimum and rises slowly to its
limit; the chain is made so long that the front travels on it for at least the relaxation time
(``SmoothChain.relaxation_time``). Where small motion is hardly damped, that of motion near the
unstable cycle counts. Without inertia no waves run ahead, and the velocity has no minimum.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np

from theory.chains.chain import SmoothChain
from theory.chains.ends import Ends
from theory.chains.own import OwnChain
from theory.parameters import ParameterError, Range, RunError, count_within
from verification.fronts.network import spreading_front
from verification.fronts.preparation import FrontPreparation, Settled
from verification.fronts.request import RUN, TOLERANCE, Option, Request, longest_chain, stall_time
from verification.fronts.result import Front, LeftBoundary
from verification.fronts.status import FrontStatus
from verification.runs.excite import excite_edge
from verification.runs.integration import Integration
from verification.runs.smooth_integration import SmoothIntegration

OUTRUNS = 1.01
"""Ratio of front velocity to wave velocity above which the front outruns the waves behind it."""

MORE_SITES = 32
"""Fewest sites beyond the excited ones, to which v is fitted."""
ACCURACY = Option(quantity="accuracy", allowed=Range(1e-13, 0.1), default=1e-3)
EXCITED = Option(quantity="excited sites", allowed=Range(4, 1000), default=24)
LONGEST = 1000
"""Default number of sites of the longest chain beyond the excited ones."""
STALL_TIME = stall_time(60.0)
TAIL = 1e-2
"""Part of the amplitude of arrival above which a site ahead of the front belongs to its tail. The
velocity at this distance from a free end differs by a part of the order of its square."""


def smooth_front(chain: SmoothChain, request: Request) -> Front:
    """Measure a front that begins at the first sites, with a wave or a free end behind it."""
    request.reads(*RUN, "left_boundary", where="for a chain of a smooth cell")
    waves = chain.trailing_wave_velocity
    wave, found = _widened(chain, request)
    outruns = found.v is not None and found.v > OUTRUNS * waves
    stands = found.v is None or found.v == 0.0
    if request.left_boundary is LeftBoundary.WAVE and not (outruns or stands):
        found = _beside_longer_wave(found, wave.accuracy, chain, request)
    if request.left_boundary is LeftBoundary.WAVE or outruns or waves == 0.0:
        return wave.front(found, request.left_boundary, outruns)
    free = replace(_prepare_smooth(chain, request, LeftBoundary.FREE), other_velocity=found.v)
    slower = free.settled(request.progress)
    both = replace(slower, counts=found.counts + slower.counts)
    return free.front(both, request.left_boundary, False)


def _widened(chain: SmoothChain, request: Request) -> tuple[FrontPreparation, Settled]:
    """Return a front with a wave behind it, with so many sites behind it that the last is settled.

    Where amplitudes do not show this and fronts may be wide, there are so many that half of them
    give the same velocity; the error is at least the difference.

    Raises
    ------
    RunError
        If the longest chain allowed is too short for so many sites.
    """
    widening, earlier = 1, Counter[str]()
    before: float | None = None
    while True:
        wave = _prepare_smooth(chain, request, LeftBoundary.WAVE, widening)
        found = wave.settled(request.progress)
        counts = earlier + found.counts
        if not found.wide:
            alike, found = _alike(replace(found, counts=counts), before, wave)
            if alike:
                return wave, found
            before = found.v
        earlier = counts
        widening *= 2
        if widening * MORE_SITES > _most_beyond(request, _excited(request, widening)):
            if not found.wide:
                return wave, replace(found, status=FrontStatus.UNSTEADY)
            raise RunError(
                "the front is too wide for chains of max_sites = "
                f"{wave.excited + wave.max_sites} sites: take a smaller coupling, or more "
                "max_sites."
            )


def _alike(found: Settled, before: float | None, wave: FrontPreparation) -> tuple[bool, Settled]:
    """Return whether v is that with half as many sites behind the front, and v with its error.

    It is not asked of fronts without a velocity, and of chains whose fronts are not compared.
    """
    if not wave.compared or not found.v or found.error is None:
        return True, found
    apart = found.v if before is None else abs(found.v - before)
    return apart < wave.accuracy * found.v, replace(found, error=max(found.error, apart))


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
    excited = EXCITED.count(request.excited)
    twice = min(2 * excited, int(EXCITED.allowed.high))
    longest = twice + _most_beyond(request, excited)
    farther = _prepare_smooth(
        chain, replace(request, excited=twice, max_sites=longest), LeftBoundary.WAVE
    )
    other = farther.settled(request.progress)
    apart = abs(found.v - (other.v or 0.0))
    steady = apart < accuracy * found.v
    return replace(
        found,
        error=max(found.error, apart),
        status=found.status if steady else FrontStatus.UNSTEADY,
        counts=found.counts + other.counts,
    )


def own_front(chain: OwnChain, request: Request) -> Front:
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
        return smooth_front(free, request)
    request.reads(*RUN, where="where sites differ or have more than two neighbours")
    prepared, found = _with_enough_excited(free, request)
    outruns = found.v is not None and found.v > OUTRUNS * free.trailing_wave_velocity
    return prepared.front(found, LeftBoundary.FREE, outruns)


def _with_enough_excited(chain: SmoothChain, request: Request) -> tuple[FrontPreparation, Settled]:
    """Return a front with a free end behind it, with so many sites excited that they persist.

    At strong coupling, and where the rest state is nearly as stable as the other, fewer than some
    widths of a front go to rest. Where waves travel, fronts are never so wide.
    """
    widening, earlier = 1, Counter[str]()
    while True:
        prepared = _prepare_smooth(chain, request, LeftBoundary.FREE, widening)
        found = prepared.settled(request.progress)
        counts = earlier + found.counts
        given = request.excited is not None or chain.trailing_wave_velocity > 0.0
        widening *= 2
        most = _most_beyond(request, _excited(request, widening))
        if given or found.status is not FrontStatus.COLLAPSED or widening * MORE_SITES > most:
            return prepared, replace(found, counts=counts)
        earlier = counts


def _excited(request: Request, widening: int) -> int:
    """Return the number of excited sites, which is multiplied for a wide front unless given."""
    return (widening if request.excited is None else 1) * EXCITED.count(request.excited)


def _most_beyond(request: Request, excited: int) -> int:
    """Return the number of sites of the longest chain beyond the excited ones.

    Raises
    ------
    ParameterError
        If the longest chain is too short for a front.
    """
    least = EXCITED.count(request.excited) + MORE_SITES
    return longest_chain(least, excited + LONGEST).count(request.max_sites) - excited


def _prepare_smooth(
    chain: SmoothChain, request: Request, boundary: LeftBoundary, widening: int = 1
) -> FrontPreparation:
    """Return the measurement of a front.

    ``widening`` multiplies the numbers of sites behind the front, of the shortest chain and, unless
    it is given, of those excited.
    """
    trailing = widening * EXCITED.count(request.excited)
    excited = _excited(request, widening)
    most = _most_beyond(request, excited)
    first = count_within(
        "number of sites n", chain.sites, 2, most, "take a shorter chain, or more max_sites"
    )
    stall = STALL_TIME.number(request.stall_time) * chain.time_unit
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
            [end],
            tolerance=tolerance,
            trailing_sites=trailing if on else 0,
            left_boundary_wave=on,
        )

    def long_enough(sites: int, v: float) -> bool:
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
        sites=max(first, widening * MORE_SITES),
        max_sites=most,
        accuracy=ACCURACY.number(request.accuracy),
        tolerance=TOLERANCE.number(request.tolerance),
        stall_time=stall,
        settling_tolerance=1e-3 * chain.stable_amplitude,
        kind=SmoothIntegration,
        long_enough=long_enough,
        tail_amplitude=TAIL * chain.unstable_amplitude,
        unsettled=_unsettled if waves == 0.0 and not chain.oscillates else _not_measured,
        disordered=bool(getattr(chain, "disorder", {})),
        settling_time=chain.relaxation_time,
        # Velocities are coupled only where cells oscillate.
        compared=getattr(chain, "velocity_coupling", 0.0) != 0.0,
    )


def _unsettled(run: Integration) -> float:
    """Return by what part of its amplitude a site was away from the stable state when left out.

    It is the mean over the later half of such sites, since the first of them are left out while the
    front forms; 0 as long as there are none.
    """
    assert isinstance(run, SmoothIntegration)
    left = run.left_behind
    later = left[left.size // 2 :]
    return float(abs(1.0 - later / run.chain.stable_amplitude).mean()) if later.size else 0.0


def _not_measured(_: Integration) -> float:
    """Return 0: where waves travel or cells oscillate, amplitudes vary for other reasons."""
    return 0.0
