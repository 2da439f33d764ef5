"""The outcome of a nucleus: how many sites oscillate as slow time passes, and how the run ends.

The chain (8) or (43) is run from the start. A site joins the nucleus when its |Ψ| first passes the
unstable cycle of one cell. The outcome is named by the first of these rules that applies:

shrunk
    Fewer sites are above that level at the end than at the start.
held
    No site joined.
larger
    Sites joined, but none in the last half of the run and none at an end of the chain: a larger
    nucleus that no longer grows.
undecided
    Fewer than ``SEVERAL`` sites joined before the run was over.
front
    Never more than ``PAUSE`` of slow time passes between one site that joins and the next, until a
    site at an end of the chain joins or the run is over.
creep
    There is such a pause: the nucleus continues to grow by jumps, between which it hardly changes.

``PAUSE`` is a convention, not derived: twenty times 1/c, the longest time scale of the linear
motion. The distinction between creep and front therefore depends on it; ``longest_pause`` is what
was measured. That a larger nucleus no longer grows is shown only for the duration of the run.

A start with exact mirror symmetry stays symmetric to the last bit, which hides every instability
that breaks the symmetry; noise allows it to break. The phases of a creeping nucleus wander, and a
run is accurate to its tolerance for a limited time only, which is stated in ``same_until``.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from theory.arrays import FloatArray
from theory.chains.nucleus import MARGIN, Nucleus, outward_pattern, sites_for
from theory.chains.vdp import VanDerPolChain
from theory.parameters import count_within, positive, within
from theory.status import Status
from verification.breathers.orbits import solve_orbit
from verification.runs.comparison import COARSER
from verification.runs.excite import add_noise, excite
from verification.runs.simulate import simulate
from verification.runs.trajectory import Trajectory

PAUSE = 100.0
"""Longest slow time between one site that joins and the next in a front."""
SEVERAL = 6
"""Sites that must join before growth is called a front or creep: three on each side."""
SAME = 1.0
"""Slow time by which the joining times of a site in two runs may differ and still agree."""
_TOLERANCE = 1e-8
"""Local error of a run; that of the comparison run is a hundred times larger."""
SAMPLES = 201
"""Number of samples of a run."""


class NucleusOutcome(Status):
    """The outcome of a nucleus at the end of a run; the module states the rules."""

    SHRUNK = "shrunk", "fewer sites oscillate at the end than at the start."
    HELD = "held", "no site joined."
    LARGER = "larger nucleus", "sites joined, but none in the last half of the run."
    UNDECIDED = "undecided", "few sites joined by the end of the run: allow more time."
    FRONT = "front", "sites join one after the other without a long pause."
    CREEP = "creep", "the nucleus grows in jumps, between which it hardly changes."


@dataclass(frozen=True, kw_only=True)
class Evolution:
    """How a nucleus changed in one run; in slow time, unless `evolution` was given another unit.

    Attributes
    ----------
    outcome : NucleusOutcome
        The outcome, as defined in the module.
    size : int
        Number of sites above the level at the end.
    sizes : tuple of (float, int)
        Slow times with the number of sites that had joined by then, beginning with the start at 0.
    longest_pause : float or None
        Longest slow time between two successive joining sites, up to the first one at an end of
        the chain; None if fewer than two joined by then.
    """

    outcome: NucleusOutcome
    size: int
    sizes: tuple[tuple[float, int], ...]
    longest_pause: float | None

    def size_at(self, slow_time: float) -> int:
        """Return how many sites had joined by a given slow time."""
        return [size for joined, size in self.sizes if joined <= slow_time][-1]


@dataclass(frozen=True, kw_only=True)
class FollowedNucleus:
    """The outcome of a nucleus at one coupling.

    Attributes
    ----------
    evolution : Evolution
        How the nucleus changed.
    mirrored : bool
        Whether the last state is its own mirror image to the last bit.
    same_until : float
        Slow time up to which every site joined within `SAME` of its joining time in a run with a
        hundred times the tolerance.
    confirmed : bool
        Whether that run ended with the same outcome.
    run : Trajectory
        The run.
    """

    evolution: Evolution
    mirrored: bool
    same_until: float
    confirmed: bool
    run: Trajectory


def evolution_of(run: Trajectory) -> Evolution:
    """Classify a run by the rules of the module.

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
    """Apply the rules of the module to joining times, in slow time or consistently in another unit.

    Parameters
    ----------
    joined : ndarray, shape (N,)
        Slow time at which each site joined, 0 for those excited at the start, nan for never.
    slow_time : float
        Length of the run.
    size : int
        Number of sites above the level at the end.
    pause : float, optional
        Longest pause between joining sites in a front.

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
    end_reached = float(np.min(ends[ends > 0.0], initial=np.inf))
    growth_times = times[times <= end_reached]
    # The time from the last site to the end of the run is a pause too, unless the chain is full.
    marks = growth_times if end_reached <= slow_time else np.append(growth_times, slow_time)
    longest = float(np.diff(growth_times).max()) if growth_times.size > 1 else None
    if size < started:
        outcome = NucleusOutcome.SHRUNK
    elif not times.size:
        outcome = NucleusOutcome.HELD
    elif end_reached > slow_time and times[-1] <= 0.5 * slow_time:
        outcome = NucleusOutcome.LARGER
    elif growth_times.size < SEVERAL and end_reached > slow_time:
        outcome = NucleusOutcome.UNDECIDED
    else:
        outcome = (
            NucleusOutcome.FRONT
            if np.diff(marks).max(initial=0.0) <= pause
            else NucleusOutcome.CREEP
        )
    return Evolution(outcome=outcome, size=size, sizes=sizes, longest_pause=longest)


def follow_nucleus(
    chain: VanDerPolChain,
    size: int = 1,
    *,
    perturbation: float,
    seed: int,
    slow_time: float = 1000.0,
) -> FollowedNucleus:
    """Follow a nucleus in the middle of a chain, all its sites in phase on the cycle of one cell.

    Parameters
    ----------
    chain : VdpChain or AveragedChain
        The chain; N determines how far the nucleus can grow.
    size : int
        Number of excited sites, of the same parity as N for a mirror-symmetric start.
    perturbation : float
        Standard deviation of the noise on every site; 0 for exact mirror symmetry.
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
    >>> followed = follow_nucleus(chain, perturbation=0.0, seed=0, slow_time=140.0)
    >>> followed.evolution.size, followed.mirrored, followed.confirmed
    (5, True, True)
    """
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
        for each in (_TOLERANCE, COARSER * _TOLERANCE)
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
    )


@dataclass(frozen=True, kw_only=True)
class BreatherDistance:
    """Distance of the last state of a run from the mirror-symmetric breather of its size.

    Attributes
    ----------
    gap : float
        Largest difference over the sites between |Ψ| and the amplitude of the orbit. |Ψ| has a
        ripple of O(ε), so the gap is never far below ε times the amplitude. Infinite if there is no
        such orbit.
    growth : float or None
        Largest growth rate of the orbit per unit of slow time, over perturbations of every shape;
        None if there is no such orbit.
    """

    gap: float
    growth: float | None


def distance_from_breather(followed: FollowedNucleus) -> BreatherDistance:
    """Return the distance of the last state from the mirror-symmetric breather of its size.

    The breather is the periodic orbit of (8), followed from small coupling without any use of the
    run.
    """
    size, sites = followed.evolution.size, followed.run.chain.sites
    margin = min(MARGIN, (sites - size) // 2)
    shorter = replace(followed.run.chain, sites=sites_for(size, margin))
    orbit = solve_orbit(shorter, Nucleus(size, outward_pattern(size)))
    if orbit.growth is None:
        return BreatherDistance(gap=float("inf"), growth=None)
    offset = (sites - shorter.sites) // 2
    inside = followed.run.amplitude[-1][offset : offset + shorter.sites]
    gap = float(np.abs(inside - orbit.amplitudes).max())
    return BreatherDistance(gap=gap, growth=orbit.growth)


def _same_until(one: FloatArray, other: FloatArray, slow_time: float) -> float:
    """Return the slow time of the first difference, or the end of the run."""
    times = np.nan_to_num(one, nan=np.inf), np.nan_to_num(other, nan=np.inf)
    with np.errstate(invalid="ignore"):
        differ = ~((times[0] == times[1]) | (np.abs(times[0] - times[1]) <= SAME))
    first = np.minimum(*times)[differ]
    return float(first.min()) if first.size else slow_time
