"""What becomes of a nucleus: how many sites oscillate as slow time goes on, and how that ends.

A run of (8), or of (43), from the start. A site belongs to the nucleus from when its |Ψ| first
passes the unstable cycle of one cell. The end is named by these rules, the first that applies:

shrunk
    Fewer sites are above that level at the end than at the start.
held
    No site joined.
larger
    Sites joined, and none in the last half of the run, nor did one join at an end of the chain:
    a larger nucleus that stands.
undecided
    Fewer than ``SEVERAL`` sites joined, and the run is over.
front
    Between one site that joins and the next there is never more than ``PAUSE`` of slow time,
    until a site at an end of the chain joins or the run is over.
creep
    There is: the nucleus goes on growing, by jumps between which it stands almost still.

``PAUSE`` is written down, not derived: twenty times 1/c, the longest time of the linear motion. So
where creep becomes front is a convention; ``longest_pause`` is what was measured. That a larger
nucleus stands is shown for the time of the run only.

A start of exact mirror symmetry stays symmetric to the last bit, and then hides every instability
that breaks the symmetry. With noise it is free to break it. Where a nucleus creeps its phases
wander, and a run is good to its tolerance for a limited time: ``same_until`` says how long.
"""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np

from theory.arrays import FloatArray
from theory.chains.nucleus import MARGIN, Nucleus, outward_pattern, sites_for
from theory.chains.vdp import VanDerPolChain
from theory.parameters import count_within, positive, within
from theory.status import Status
from verification.breathers.orbits import solve_orbit
from verification.runs.comparison import coarser_tolerance
from verification.runs.excite import add_noise, excite
from verification.runs.simulate import simulate
from verification.runs.trajectory import Trajectory

PAUSE = 100.0
"""Longest slow time from one site that joins to the next in a front."""
SEVERAL = 6
"""Sites that must join before growth is called a front or creep: three on each side."""
SAME = 1.0
"""Slow time by which two runs may differ in when a site joined and still count as the same."""
_TOLERANCE = 1e-8
"""Local error of a run; that of the run for comparison is a hundred times larger."""
SAMPLES = 201
"""Samples of a run."""


class NucleusOutcome(Status):
    """What became of a nucleus by the end of a run; the rules are in the module."""

    SHRUNK = "shrunk", "fewer sites oscillate at the end than at the start."
    HELD = "held", "no site joined."
    LARGER = "larger nucleus", "sites joined, and none in the last half of the run: it stands."
    UNDECIDED = "undecided", "few sites joined by the end of the run: give it more time."
    FRONT = "front", "sites join one after the other without a long pause."
    CREEP = "creep", "the nucleus grows by jumps, between which it stands almost still."


@dataclass(frozen=True, kw_only=True)
class Evolution:
    """How a nucleus changed in one run; times in slow time, unless `evolution` was given others.

    Attributes
    ----------
    outcome : NucleusOutcome
        See the module.
    size : int
        Sites above the level at the end.
    sizes : tuple of (float, int)
        Slow time from which on so many sites had joined, the start included, at time 0.
    longest_pause : float or None
        Longest slow time between one site that joined and the next; None below two of them.
    slow_time : float
        Length of the run.
    """

    outcome: NucleusOutcome
    size: int
    sizes: tuple[tuple[float, int], ...]
    longest_pause: float | None
    slow_time: float

    def size_at(self, slow_time: float) -> int:
        """Return how many sites had joined by then."""
        return [size for joined, size in self.sizes if joined <= slow_time][-1]


@dataclass(frozen=True, kw_only=True)
class FollowedNucleus:
    """What became of a nucleus at a coupling.

    Attributes
    ----------
    evolution : Evolution
        How it changed.
    mirrored : bool
        Whether the last state is its own mirror image to the last bit.
    same_until : float
        Slow time up to which every site joined within `SAME` of when it did in a run at a hundred
        times the tolerance.
    confirmed : bool
        Whether that run ended in the same way.
    run : Trajectory
        The run.
    seconds : float
        Wall-clock time.
    """

    evolution: Evolution
    mirrored: bool
    same_until: float
    confirmed: bool
    run: Trajectory
    seconds: float


def evolution_of(run: Trajectory) -> Evolution:
    """Name what a run has shown, by the rules of the module.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=15)
    >>> evolution_of(simulate(chain, excite(chain, [8]), 5e3, estimate_error=False)).outcome.value
    'held'
    """
    chain = run.chain
    slow = chain.eps * run.arrivals
    return evolution(slow, chain.eps * float(run.times[-1]), int(run.width[-1]))


def evolution(joined: FloatArray, slow_time: float, size: int, pause: float = PAUSE) -> Evolution:
    """Apply the rules of the module to when sites joined, in slow time or another unit throughout.

    Parameters
    ----------
    joined : ndarray, shape (N,)
        Slow time at which each site joined, 0 for those excited at the start, nan for never.
    slow_time : float
        Length of the run.
    size : int
        Sites above the level at the end.
    pause : float, optional
        Longest pause of a front.

    Examples
    --------
    >>> nan = float("nan")
    >>> evolution(np.array([nan, nan, 30.0, 0.0, 30.0, nan, nan]), 200.0, 3).outcome.value
    'larger nucleus'
    >>> evolution(np.array([150.0, 90.0, 30.0, 0.0, 30.0, 90.0, 150.0]), 200.0, 7).outcome.value
    'front'
    >>> evolution(np.array([220.0, 190.0, 30.0, 0.0, 30.0, 190.0, 220.0]), 300.0, 7).outcome.value
    'creep'
    """
    started = int(np.count_nonzero(joined == 0.0))
    times = np.sort(joined[joined > 0.0])
    moments = np.concatenate([[0.0], np.unique(times)])
    sizes = tuple((float(at), started + int(np.count_nonzero(times <= at))) for at in moments)
    ends = joined[[0, -1]]
    filled = float(np.min(ends[ends > 0.0], initial=np.inf))
    grew = times[times <= filled]
    # What a front does until the run is over counts as a pause too; the end of the chain stops it.
    marks = grew if filled <= slow_time else np.append(grew, slow_time)
    longest = float(np.diff(grew).max()) if grew.size > 1 else None
    if size < started:
        outcome = NucleusOutcome.SHRUNK
    elif not times.size:
        outcome = NucleusOutcome.HELD
    elif filled > slow_time and times[-1] <= 0.5 * slow_time:
        outcome = NucleusOutcome.LARGER
    elif grew.size < SEVERAL and filled > slow_time:
        outcome = NucleusOutcome.UNDECIDED
    else:
        outcome = (
            NucleusOutcome.FRONT
            if np.diff(marks).max(initial=0.0) <= pause
            else NucleusOutcome.CREEP
        )
    return Evolution(
        outcome=outcome, size=size, sizes=sizes, longest_pause=longest, slow_time=slow_time
    )


def follow_nucleus(
    chain: VanDerPolChain,
    size: int = 1,
    *,
    perturbation: float = 0.0,
    seed: int = 0,
    slow_time: float = 1000.0,
) -> FollowedNucleus:
    """Follow a nucleus in the middle of a chain: all its sites in phase on the cycle of one cell.

    Parameters
    ----------
    chain : VdpChain or AveragedChain
        Parameters; N decides how far it can grow.
    size : int
        Excited sites, odd or even as N is, for a start of mirror symmetry.
    perturbation : float
        Size of the noise on every site; 0 for exact mirror symmetry.
    seed : int
        Seed of the noise.
    slow_time : float
        Length of the run in T = εt.

    Raises
    ------
    ParameterError
        If a number is out of range, or the cell has no cycle.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> chain = VdpChain(a=2.5, b=0.5, c=0.195, sites=21)
    >>> followed = follow_nucleus(chain, slow_time=140.0)
    >>> followed.evolution.size, followed.mirrored, followed.confirmed
    (5, True, True)
    """
    started = time.perf_counter()
    count_within("nucleus size", size, 1, chain.sites)
    positive("slow time", slow_time)
    within("perturbation", perturbation, 0.0, 1.0)
    first = (chain.sites - size) // 2 + 1
    start = excite(chain, range(first, first + size))
    if perturbation > 0.0:
        start = add_noise(start, perturbation, seed)
    runs = [
        simulate(
            chain,
            start,
            slow_time / chain.eps,
            tolerance=each,
            samples=SAMPLES,
            estimate_error=False,
        )
        for each in (_TOLERANCE, coarser_tolerance(_TOLERANCE))
    ]
    found = [evolution_of(run) for run in runs]
    last = runs[0].psi[-1]
    arrivals = [chain.eps * run.arrivals for run in runs]
    return FollowedNucleus(
        evolution=found[0],
        mirrored=bool(np.array_equal(last, last[::-1])),
        same_until=_same_until(arrivals[0], arrivals[1], slow_time),
        confirmed=found[0].outcome is found[1].outcome,
        run=runs[0],
        seconds=time.perf_counter() - started,
    )


@dataclass(frozen=True, kw_only=True)
class BreatherDistance:
    """How far the last state of a run is from the mirror-symmetric breather of its size.

    Attributes
    ----------
    gap : float
        Largest difference of |Ψ| and the amplitude of the orbit, over the sites. |Ψ| has a ripple
        of O(ε), so it is never far below ε times the amplitude. Infinite if there is no such orbit.
    growth : float or None
        Largest growth rate of the orbit per unit of slow time, perturbations of every shape; None
        if there is no such orbit.
    """

    gap: float
    growth: float | None


def distance_from_breather(followed: FollowedNucleus) -> BreatherDistance:
    """Return how far the last state is from the mirror-symmetric breather of its size.

    The breather is the periodic orbit of (8), followed from small coupling; nothing of the run is
    put into it.
    """
    size, sites = followed.evolution.size, followed.run.chain.sites
    margin = min(MARGIN, (sites - size) // 2)
    shorter = replace(followed.run.chain, sites=sites_for(size, margin))
    orbit = solve_orbit(shorter, Nucleus(size, outward_pattern(size)))
    if orbit.growth is None:
        return BreatherDistance(gap=float("inf"), growth=None)
    beside = (sites - shorter.sites) // 2
    inside = followed.run.amplitude[-1][beside : beside + shorter.sites]
    gap = float(np.abs(inside - orbit.amplitudes).max())
    return BreatherDistance(gap=gap, growth=orbit.growth)


def _same_until(one: FloatArray, other: FloatArray, slow_time: float) -> float:
    """Return the first time of a difference, or the end."""
    known = np.nan_to_num(one, nan=np.inf), np.nan_to_num(other, nan=np.inf)
    with np.errstate(invalid="ignore"):
        apart = ~((known[0] == known[1]) | (np.abs(known[0] - known[1]) <= SAME))
    first = np.minimum(*known)[apart]
    return float(first.min()) if first.size else slow_time
