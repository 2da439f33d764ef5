"""Velocity of a front from its arrival times: the regression, the cut, the test that it is steady.

It is the same for every chain. The rule:

* a site counts as reached when it or a site beyond it is: fronts may leave sites out and fill them
  later;
* the first half of the arrivals is transient and is not used;
* v is the slope of the regression line of the rest;
* its error is the largest of three times the standard error of that slope, the difference between
  the slopes of the third and the fourth quarter, and the difference from a run at a hundred times
  the tolerance, which is all of v if the front stops there;
* a difference between the quarters beyond what their standard errors explain is a drift, and counts
  six times: the velocity of a front that drifts like n^{-2/3}, as the head of a wave does, is still
  4.5 times that difference away from its limit;
* the front is steady if that error is below a stated part of v; if not, the chain is made longer.

Velocities are in sites per unit of the time in which the arrivals are given.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from theory.arrays import FloatArray
from verification.fronts.status import FrontStatus

_NOISE, _DRIFT = 3.0, 6.0


@dataclass(frozen=True)
class Trial:
    """One pair of runs on a chain of one length.

    Attributes
    ----------
    stopped : FrontStatus or None
        What became of a front that did not reach the end in the first run; None if it did.
    arrivals, coarser : ndarray, shape (m,)
        Arrival times by site, nan where there was none; the second at a hundred times the
        tolerance, empty if a front did not reach the end.
    steps : int
        Steps of both runs.
    """

    stopped: FrontStatus | None
    arrivals: FloatArray
    coarser: FloatArray
    steps: int


@dataclass(frozen=True)
class Settled:
    """What the trials on longer and longer chains led to.

    Attributes
    ----------
    status : FrontStatus
        What became of the front.
    v, error : float or None
        Velocity and its uncertainty; 0 and ``seen`` for a pinned front, None if there is none.
    arrivals : ndarray, shape (m,)
        Arrival times of the last trial, those that there were.
    sites : int
        Length of the last trial.
    steps : int
        Steps of all trials.
    """

    status: FrontStatus
    v: float | None
    error: float | None
    arrivals: FloatArray
    sites: int
    steps: int


def settle(
    trial: Callable[[int], Trial],
    *,
    sites: int,
    max_sites: int,
    accuracy: float,
    seen: float,
    enough: Callable[[int, float], bool] = lambda sites, v: True,
    doubt: float | None = None,
) -> Settled:
    """Make the chain longer until the velocity has settled, or the front has stopped.

    Parameters
    ----------
    trial : callable
        From a number of sites to a pair of runs.
    sites : int
        Length tried first; doubled each time.
    max_sites : int
        Longest chain.
    accuracy : float
        Relative error of v at which the front counts as steady.
    seen : float
        The velocity that would have been seen if the front were not pinned.
    enough : callable, optional
        From a number of sites and v to whether the chain is long enough for another reason.
    doubt : float, optional
        Another velocity, from which v differs by less than the error if the longest chain is not
        long enough.

    Examples
    --------
    >>> def trial(sites):
    ...     return Trial(None, np.arange(sites) / 2.0, np.arange(sites) / 2.0, sites)
    >>> settle(trial, sites=32, max_sites=99, accuracy=1e-3, seen=0.0).v
    2.0
    """
    steps = 0
    while True:
        runs = trial(sites)
        steps += runs.steps
        arrivals = runs.arrivals[~np.isnan(runs.arrivals)]
        if runs.stopped is not None:
            v, error = (0.0, seen) if runs.stopped is FrontStatus.PINNED else (None, None)
            return Settled(runs.stopped, v, error, arrivals, sites, steps)
        reached, beside = leading(runs.arrivals), leading(runs.coarser)
        both = min(reached.size, beside.size) or reached.size
        v, error = velocity_of_arrivals(reached[:both])
        other = velocity_of_arrivals(beside[:both])[0] if beside.size else 0.0
        error = max(error, abs(v - other))
        long, longest = enough(sites, v), 2 * sites > max_sites
        if longest and not long and doubt is not None:
            error = max(error, abs(v - doubt))
        if error < accuracy * v and (long or longest):
            return Settled(FrontStatus.STEADY, v, error, arrivals, sites, steps)
        if longest:
            return Settled(FrontStatus.UNSTEADY, v, error, arrivals, sites, steps)
        sites *= 2


def leading(arrivals: FloatArray) -> FloatArray:
    """Return when each site or one beyond it was first reached; sites beyond the last are not used.

    Examples
    --------
    >>> leading(np.array([0.0, 1.0, 7.0, 2.0, np.nan])).tolist()
    [0.0, 1.0, 2.0, 2.0]
    """
    known = np.where(np.isnan(arrivals), np.inf, arrivals)
    first: FloatArray = np.minimum.accumulate(known[::-1])[::-1]
    return first[np.isfinite(first)]


def velocity_of_arrivals(arrivals: FloatArray) -> tuple[float, float]:
    """Return v and its uncertainty from the second half of the arrival times.

    Parameters
    ----------
    arrivals : ndarray, shape (m,)
        Times, not descending, at neighbouring sites; m at least 16.

    Examples
    --------
    >>> velocity_of_arrivals(np.arange(32) / 2.0)
    (2.0, 0.0)
    """
    late = arrivals[arrivals.size // 2 :]
    site = np.arange(late.size)
    slope, noise = line(site, late)
    half = late.size // 2
    first, first_noise = line(site[:half], late[:half])
    second, second_noise = line(site[half:], late[half:])
    apart = abs(first - second)
    drift = _DRIFT * (apart - 2.0 * math.hypot(first_noise, second_noise))
    return 1.0 / slope, max(_NOISE * noise, apart, drift) / slope**2


def line(x: npt.ArrayLike, y: npt.ArrayLike) -> tuple[float, float]:
    """Return the slope of the regression line and its standard error.

    Examples
    --------
    >>> line([0, 1, 2], [1.0, 3.0, 5.0])
    (2.0, 0.0)
    """
    across, up = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    centred = across - across.mean()
    weight = float(centred @ centred)
    slope = float(centred @ up) / weight
    rest = up - up.mean() - slope * centred
    return slope, float(np.sqrt(rest @ rest / max(1, across.size - 2) / weight))
