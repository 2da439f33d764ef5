"""Fronts on lattices and networks: arrival times against the distance from the excited sites.

A lattice or network cannot be lengthened. The sites nearest to its centre are excited, the run
continues until every site has been reached or none has been for a long time, and v is fitted to the
arrival times in the outer half of the distances, with an error by the same rule as in a chain
(``arrival_fit``). A front from a centre is slower the more it is curved, and its error includes the
difference from a straight one. As on a chain, no front is steady that has not travelled for the
relaxation time of the chain. On a lattice, distances are measured in the plane and v along rays.
The shape of an expanding front is governed by its slowest directions (Wulff's construction), so
that along a ray it is at most as fast as a planar front. On any other network the distance is the
number of links.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from theory.arrays import BoolArray, FloatArray
from theory.chains.own import OwnChain
from theory.parameters import ParameterError, Range, count_within
from theory.result import Result
from verification.execution.progress import ProgressCallback
from verification.fronts.arrival_fit import error_beside, velocity_of_arrivals
from verification.fronts.request import TOLERANCE, Option, Request, stall_time
from verification.fronts.result import Front
from verification.fronts.status import FrontStatus
from verification.fronts.watch import MARGIN, Stall
from verification.runs.comparison import COARSER
from verification.runs.excite import excite
from verification.runs.smooth_integration import SmoothIntegration

EXCITED = 37
"""Default number of sites excited: on a square lattice those within a radius of about 3.5."""
HALF_WIDTH = 1.0
"""Distance from a ray within which a site belongs to its direction."""
LEAST = 6
"""Smallest number of arrivals to which a velocity is fitted; as many before them are left out."""
EDGE = 2
"""Distance from a free side within which sites are not used, because the front is faster there."""
MEETING = 4
"""How many of the largest distances in links are not used, since fronts may meet there."""
ROWS = 4
"""Default number of rows excited for a planar front."""
ACCURACY = Option(quantity="accuracy", allowed=Range(1e-13, 0.1), default=0.1)
"""The default is coarse because the lattice cannot be enlarged."""
STALL_TIME = stall_time(60.0)
DIRECTIONS = Option(quantity="directions", allowed=Range(4, 360), default=4)
"""The default is that of networks; on a lattice, no number means a planar front."""
_BUDGET, _NEVER = 200_000, 1e9


@dataclass(frozen=True, kw_only=True)
class Spread(Result):
    """Arrivals of a motion that spreads from the centre of a lattice or network.

    Attributes
    ----------
    angles : ndarray, shape (K,)
        Directions in radians, from the first axis (along a row); a single 0 where distances are
        numbers of links.
    velocities, errors : ndarray, shape (K,)
        Velocity in each direction, in neighbour distances (or links) per ``time_unit``, and its
        uncertainty; nan where too few sites were reached, infinite where the farther ones were not
        reached later. Uncertainties are infinite, too, if the last site was reached before the
        relaxation time of the chain.
    distances : ndarray, shape (N,)
        Distance of every site from the centre, to rounding.
    arrivals : ndarray, shape (N,)
        Times t at which the sites were first reached, of which no error is known; nan for others.
    positions : ndarray, shape (N, 2), or None
        Coordinates of the sites, to rounding; None for a network that is not a lattice.
    """

    shown: ClassVar[tuple[str, ...]] = ("angles", "velocities", "errors")
    """Attributes that appear in the JSON object of a front."""

    angles: FloatArray = field(metadata={"axis": "angle"})
    velocities: FloatArray = field(metadata={"dims": ("angle",)})
    errors: FloatArray = field(metadata={"dims": ("angle",)})
    distances: FloatArray = field(metadata={"dims": ("site",), "json": None})
    arrivals: FloatArray = field(metadata={"dims": ("site",), "json": None})
    positions: FloatArray | None = field(default=None, metadata={"json": None})


@dataclass(frozen=True, kw_only=True)
class SpreadRun:
    """Why a motion failed to spread (None if it spread), the arrivals, and the number of steps."""

    stopped: FrontStatus | None
    spread: Spread
    steps: int


def middle_site(chain: OwnChain) -> int:
    """Return the index of the middle site: in the plane for a lattice, otherwise by number."""
    positions = chain.links.positions
    if positions is None:
        return chain.sites // 2
    away = np.linalg.norm(positions - positions.mean(axis=0), axis=1)
    return int(np.argmin(away))


def distances_from(chain: OwnChain, site: int) -> FloatArray:
    """Return the distance of every site from a given one, in the plane of a lattice or in links."""
    positions = chain.links.positions
    if positions is None:
        return chain.links.distances([site])
    away: FloatArray = np.linalg.norm(positions - positions[site], axis=1)
    return away


def spread(
    chain: OwnChain,
    *,
    excited: int = EXCITED,
    directions: int,
    tolerance: float,
    stall: float,
    progress: ProgressCallback | None = None,
) -> SpreadRun:
    """Excite the centre of a lattice or network and record when each site is reached.

    Parameters
    ----------
    chain : OscillatorChain
        A chain with any coupling.
    excited : int
        Number of sites excited, those nearest to the centre.
    directions : int
        Number of directions on a lattice, evenly spaced over a full turn.
    tolerance : float
        Local error.
    stall : float
        Time t without an arrival after which the motion counts as stopped.
    progress : callable, optional
        Called with the fraction of the sites that has been reached.

    Raises
    ------
    ParameterError
        If the excited sites are all the sites there are.
    """
    excited = count_within("excited sites", excited, 1, chain.sites - 1)
    middle = middle_site(chain)
    away = distances_from(chain, middle)
    nearest = np.argsort(away, kind="stable")[:excited]
    turns = [chain.front_phase_step * round(float(away[n])) for n in nearest]
    start = excite(chain, [int(n) + 1 for n in nearest], quarter_turns=turns)

    def fit(arrivals: FloatArray) -> _Fit:
        return _fitted(
            chain,
            away,
            middle=middle,
            arrivals=arrivals,
            directions=directions,
            excited=excited,
        )

    return _measured(chain, start, away, fit, tolerance=tolerance, stall=stall, progress=progress)


_Fit = tuple[FloatArray, FloatArray, FloatArray]
"""Directions, velocities per unit t, and their uncertainties."""


def _measured(
    chain: OwnChain,
    start: FloatArray,
    distances: FloatArray,
    fit: Callable[[FloatArray], _Fit],
    *,
    tolerance: float,
    stall: float,
    progress: ProgressCallback | None,
) -> SpreadRun:
    """Run until all sites at a finite distance are reached, and fit velocities to the arrivals.

    Their error includes the difference from a second run at a coarser tolerance, and is at least
    the velocity itself if the motion stopped in that run only. It is infinite if the last site was
    reached before the relaxation time of the chain.
    """
    within_reach = np.isfinite(distances)
    run = SmoothIntegration(chain, start, [_NEVER], tolerance=tolerance)
    stopped = _follow(run, stall, within_reach, progress)
    steps = run.counts["steps"]
    angles, v, error = fit(run.arrivals)
    if stopped is None:
        other = SmoothIntegration(chain, start, [_NEVER], tolerance=COARSER * tolerance)
        arrived = _follow(other, stall, within_reach, progress) is None
        coarser = fit(other.arrivals)[1] if arrived else [None] * v.size
        pairs = zip(v, error, coarser, strict=True)
        error = np.array([error_beside(*each, tolerance) for each in pairs])
        if np.nanmax(run.arrivals) < chain.relaxation_time:
            error.fill(math.inf)
        steps += other.counts["steps"]
    found = Spread(
        angles=angles,
        velocities=v * chain.time_unit,
        errors=error * chain.time_unit,
        distances=distances,
        arrivals=run.arrivals.copy(),
        positions=chain.links.positions,
    )
    return SpreadRun(stopped=stopped, spread=found, steps=steps)


def _follow(
    run: SmoothIntegration,
    stall: float,
    within_reach: BoolArray,
    progress: ProgressCallback | None,
) -> FrontStatus | None:
    """Step until all sites within reach have been reached (None), or the motion has stopped."""
    watch = Stall(run, stall, 1e-3 * run.chain.stable_amplitude)
    while True:
        run.advance(_BUDGET)
        reached = int(np.count_nonzero(~np.isnan(run.arrivals)))
        if reached == np.count_nonzero(within_reach):
            return None
        if progress is not None:
            progress(reached / within_reach.size)
        watch.note(reached)
        status = watch.status()
        if status is not None:
            return status


def _fitted(
    chain: OwnChain,
    away: FloatArray,
    *,
    middle: int,
    arrivals: FloatArray,
    directions: int,
    excited: int,
) -> _Fit:
    positions = chain.links.positions
    first = np.sort(away)[excited - 1]
    if positions is None:
        levels, times = _shells(away, arrivals, first)
        v, error = _velocity(times, levels)
        return np.zeros(1), np.array([v]), np.array([error])
    inside = np.linalg.norm(positions - positions[middle], axis=1) <= _radius(chain, middle)
    angles = 2.0 * math.pi * np.arange(directions) / directions
    found = []
    for angle in angles:
        offset = positions - positions[middle]
        near = np.abs(_along(offset, angle + 0.5 * math.pi)) <= HALF_WIDTH
        ray = inside & near & (_along(offset, angle) > first) & ~np.isnan(arrivals)
        found.append(_velocity(arrivals[ray], _along(offset, angle)[ray]))
    v, error = np.array(found).T
    return angles, v, error


def _along(offset: FloatArray, angle: float) -> FloatArray:
    """Return the components in a direction, without the rounding that would decide what is near."""
    part: FloatArray = np.round(offset @ np.array([math.cos(angle), math.sin(angle)]), 9)
    return part


def _radius(chain: OwnChain, middle: int) -> float:
    """Return the distance of the centre from the nearest side, less the margin a side disturbs."""
    positions = chain.links.positions
    assert positions is not None
    assert chain.shape is not None
    index = np.stack(np.unravel_index(np.arange(chain.sites), chain.shape), axis=1)
    limits = np.array(chain.shape) - 1
    side = np.any((index == 0) | (index == limits), axis=1)
    return float(np.linalg.norm(positions[side] - positions[middle], axis=1).min()) - EDGE


def _shells(away: FloatArray, arrivals: FloatArray, first: float) -> tuple[FloatArray, FloatArray]:
    """Return the distances in links beyond the excited sites, and the mean arrival time at each.

    Beyond the distance at which there are most sites, those that are left may lie in corners, which
    a front reaches at another velocity; these distances are used only if there are too few others.
    """
    reached = ~np.isnan(arrivals) & np.isfinite(away) & (away > first)
    levels, counts = np.unique(away[reached], return_counts=True)
    levels, most = levels[:-MEETING], np.flatnonzero(counts == counts.max(initial=0))
    if most.size and most[-1] + 1 >= 2 * LEAST:
        levels = levels[: most[-1] + 1]
    times = [float(arrivals[reached & (away == level)].mean()) for level in levels]
    return levels, np.array(times)


def _velocity(arrivals: FloatArray, distances: FloatArray | None = None) -> tuple[float, float]:
    """Return v and its uncertainty; nan if there are too few arrivals."""
    if arrivals.size < 2 * LEAST:
        return math.nan, math.nan
    return velocity_of_arrivals(arrivals, distances)


def planar(
    chain: OwnChain,
    *,
    excited: int = ROWS,
    tolerance: float,
    stall: float,
    progress: ProgressCallback | None = None,
) -> SpreadRun:
    """Excite the first rows of a lattice and record when each further row is reached.

    Rows are timed in their middle. Sides that cut links in other directions than along the rows and
    across them slow the front down beside them, and in time everywhere; on a hexagonal lattice,
    whose sides are slanted, they also turn it. The error of v is at least the difference from the
    velocities at the sides.

    Parameters
    ----------
    chain : OscillatorChain
        A lattice.
    excited : int
        Rows excited.
    tolerance, stall, progress
        As in `spread`.

    Returns
    -------
    SpreadRun
        The single direction, at angle π/2, is across the rows; velocities are in rows.
    """
    assert chain.shape is not None
    rows, columns = chain.shape
    excited = count_within("excited rows", excited, 1, max(rows, ROWS))
    most = rows - EDGE - 2 * LEAST
    if excited > most:
        remedy = "take more rows, or turn the lattice"
        if most > 0:
            remedy = f"take more rows, turn the lattice, or excite at most {most}"
        first = "1 excited row" if excited == 1 else f"{excited} excited rows"
        raise ParameterError(
            "number of rows", rows, f"at least {excited + rows - most} for a front that starts "
            f"from {first}", remedy,
        )  # fmt: skip
    row = np.arange(chain.sites) // columns
    sites = np.flatnonzero(row < excited)
    turns = [chain.front_phase_step * int(row[n]) for n in sites]
    start = excite(chain, (sites + 1).tolist(), quarter_turns=turns)
    used = slice(excited, rows - max(EDGE, min(MARGIN, rows - excited - 2 * LEAST)))
    centre = np.abs(np.arange(columns) - 0.5 * (columns - 1)) <= HALF_WIDTH

    def fit(arrivals: FloatArray) -> _Fit:
        times = arrivals.reshape(rows, columns)[used]
        v, error = _velocity(times[:, centre].mean(axis=1))
        sides = [_velocity(times[:, side])[0] for side in (0, -1)]
        # A front that is not straight has not settled. An infinite velocity has an infinite error.
        error = max(error, *(abs(v - each) for each in sides))
        return np.full(1, 0.5 * math.pi), np.full(1, v), np.full(1, error)

    away = row.astype(float)
    return _measured(chain, start, away, fit, tolerance=tolerance, stall=stall, progress=progress)


def velocity_of(found: SpreadRun, chain: OwnChain) -> tuple[float, float]:
    """Return v in the first direction and its error, for a motion that spread."""
    v, error = float(found.spread.velocities[0]), float(found.spread.errors[0])
    if math.isnan(v):
        raise ParameterError(
            "number of sites n", chain.sites, f"so many that {2 * LEAST} distances lie between the "
            "excited sites and the sides", "take a larger lattice, or excite fewer sites",
        )  # fmt: skip
    return v, error


def spreading_front(chain: OwnChain, request: Request) -> Front:
    """Return the front of a lattice or a network."""
    read = ("accuracy", "tolerance", "excited", "stall_time")
    if chain.shape is None:
        request.reads(*read, where="on a network that is not a lattice")
    else:
        request.reads(*read, "directions", where="on a lattice")
    stall = STALL_TIME.number(request.stall_time)
    accuracy, directions = ACCURACY.number(request.accuracy), DIRECTIONS.count(request.directions)
    options: dict[str, Any] = {
        "tolerance": TOLERANCE.number(request.tolerance),
        "stall": stall * chain.time_unit,
        "progress": request.progress,
    }
    if request.excited is not None:
        options["excited"] = request.excited
    if chain.shape is not None and request.directions is None:
        found = planar(chain, **options)
    else:
        found = spread(chain, directions=directions, **options)
    v: float | None = None
    error: float | None = None
    if found.stopped is None:
        v, error = velocity_of(found, chain)
        status = FrontStatus.STEADY if error < accuracy * v else FrontStatus.UNSTEADY
        if math.isinf(v):
            v = error = None
    else:
        status = found.stopped
        if status is FrontStatus.PINNED:
            v, error = 0.0, 1.0 / stall
    return Front(
        chain=chain,
        status=status,
        v=v,
        error=error,
        excited=int(np.count_nonzero(found.spread.arrivals == 0.0)),
        left_boundary=None,
        outruns_waves=False,
        arrivals=np.sort(found.spread.arrivals[found.spread.arrivals > 0.0]),
        method=SmoothIntegration.method,
        counts={"steps": found.steps},
        seconds=0.0,
        detail=found.spread,
    )
