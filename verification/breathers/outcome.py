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
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from theory.chains.vdp import VdpChain
from theory.parameters import count_within, positive, within
from verification.runs.comparison import COARSER
from verification.runs.excite import add_noise, excite
from verification.runs.model import Model
from verification.runs.simulate import simulate
from verification.runs.trajectory import Trajectory

FloatArray = NDArray[np.float64]

PAUSE = 100.0
"""Longest slow time from one site that joins to the next in a front."""
SEVERAL = 6
"""Sites that must join before growth is called a front or creep: three on each side."""
SAME = 1.0
"""Slow time by which two runs may differ in when a site joined and still count as the same."""
SAMPLES = 201
"""States kept of a run."""


class End(StrEnum):
    """How it ended; see the module."""

    SHRUNK = "shrunk"
    HELD = "held"
    LARGER = "larger nucleus"
    UNDECIDED = "undecided"
    FRONT = "front"
    CREEP = "creep"


@dataclass(frozen=True)
class Growth:
    """How a nucleus grew in one run.

    Attributes
    ----------
    end : End
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

    end: End
    size: int
    sizes: tuple[tuple[float, int], ...]
    longest_pause: float | None
    slow_time: float

    def size_at(self, slow_time: float) -> int:
        """Return how many sites had joined by then."""
        return [size for joined, size in self.sizes if joined <= slow_time][-1]


@dataclass(frozen=True)
class Fate:
    """What became of a nucleus at a coupling.

    Attributes
    ----------
    growth : Growth
        How it grew.
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

    growth: Growth
    mirrored: bool
    same_until: float
    confirmed: bool
    run: Trajectory
    seconds: float


def growth_of(run: Trajectory) -> Growth:
    """Name what a run has shown, by the rules of the module.

    Examples
    --------
    >>> chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=15)
    >>> growth_of(simulate(chain, excite(chain, [8]), 5e3, estimate_error=False)).end.value
    'held'
    """
    chain = run.chain
    slow = chain.eps * run.arrivals
    return growth(slow, chain.eps * float(run.times[-1]), int(run.width[-1]))


def growth(joined: FloatArray, slow_time: float, size: int, pause: float = PAUSE) -> Growth:
    """Apply the rules of the module to when sites joined.

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
    >>> growth(np.array([nan, nan, 30.0, 0.0, 30.0, nan, nan]), 200.0, 3).end.value
    'larger nucleus'
    >>> growth(np.array([150.0, 90.0, 30.0, 0.0, 30.0, 90.0, 150.0]), 200.0, 7).end.value
    'front'
    >>> growth(np.array([220.0, 190.0, 30.0, 0.0, 30.0, 190.0, 220.0]), 300.0, 7).end.value
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
        end = End.SHRUNK
    elif not times.size:
        end = End.HELD
    elif filled > slow_time and times[-1] <= 0.5 * slow_time:
        end = End.LARGER
    elif grew.size < SEVERAL and filled > slow_time:
        end = End.UNDECIDED
    else:
        end = End.FRONT if np.diff(marks).max(initial=0.0) <= pause else End.CREEP
    return Growth(end, size, sizes, longest, slow_time)


def follow_nucleus(
    chain: VdpChain,
    size: int = 1,
    *,
    perturbation: float = 0.0,
    seed: int = 0,
    slow_time: float = 1000.0,
    tolerance: float = 1e-8,
    model: Model = Model.FULL,
) -> Fate:
    """Follow a nucleus in the middle of a chain: all its sites in phase on the cycle of one cell.

    Parameters
    ----------
    chain : VdpChain
        Parameters; N decides how far it can grow.
    size : int
        Excited sites, odd or even as N is, for a start of mirror symmetry.
    perturbation : float
        Size of the noise on every site; 0 for exact mirror symmetry.
    seed : int
        Seed of the noise.
    slow_time : float
        Length of the run in T = εt.
    tolerance : float
        Local error of the run; the one beside it has a hundred times as much.
    model : Model
        (8), or (43).

    Raises
    ------
    ParameterError
        If a number is out of range, or the cell has no cycle.

    Examples
    --------
    >>> chain = VdpChain(a=2.5, b=0.5, c=0.195, sites=21)
    >>> fate = follow_nucleus(chain, slow_time=140.0)
    >>> fate.growth.size, fate.mirrored, fate.confirmed
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
            model.chain_of(chain), start, slow_time / chain.eps, tolerance=each, samples=SAMPLES,
            estimate_error=False)
        for each in (tolerance, min(1e-2, COARSER * tolerance))
    ]  # fmt: skip
    found = [growth_of(run) for run in runs]
    last = runs[0].psi[-1]
    return Fate(
        found[0],
        bool(np.array_equal(last, last[::-1])),
        _same_until(chain.eps * runs[0].arrivals, chain.eps * runs[1].arrivals, slow_time),
        found[0].end is found[1].end,
        runs[0],
        time.perf_counter() - started,
    )


def distance_from_breather(fate: Fate) -> tuple[float, float]:
    """Return how far the last state is from the mirror-symmetric breather of its size.

    The breather is the periodic orbit of (8), followed from small coupling; nothing of the run is
    put into it.

    Returns
    -------
    gap : float
        Largest difference of |Ψ| and the amplitude of the orbit, over the sites. |Ψ| has a ripple
        of O(ε), so it is never far below ε times the amplitude. Infinite if there is no such orbit.
    growth : float
        Largest growth rate of the orbit per unit of slow time, perturbations of every shape.
    """
    from theory.chains.nucleus import MARGIN, Nucleus, outward_pattern, sites_for
    from verification.breathers.orbits import solve_orbit

    size, sites = fate.growth.size, fate.run.chain.sites
    margin = min(MARGIN, (sites - size) // 2)
    shorter = replace(fate.run.chain, sites=sites_for(size, margin))
    orbit = solve_orbit(shorter, Nucleus(size, outward_pattern(size)))
    if orbit.multipliers is None:
        return float("inf"), float("nan")
    beside = (sites - shorter.sites) // 2
    inside = fate.run.amplitude[-1][beside : beside + shorter.sites]
    return float(np.abs(inside - orbit.amplitudes).max()), orbit.multipliers.growth


def _same_until(one: FloatArray, other: FloatArray, slow_time: float) -> float:
    """Return the first time of a difference, or the end."""
    known = np.nan_to_num(one, nan=np.inf), np.nan_to_num(other, nan=np.inf)
    with np.errstate(invalid="ignore"):
        apart = ~((known[0] == known[1]) | (np.abs(known[0] - known[1]) <= SAME))
    first = np.minimum(*known)[apart]
    return float(first.min()) if first.size else slow_time
