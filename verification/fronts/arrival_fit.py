"""Velocity of a front from its arrival times: regression, transient, test for a steady front.

The rule is the same for every chain:

* a site counts as reached once it or any site beyond it has been reached, since a front may skip
  sites and fill them in later;
* the first half of the arrivals is regarded as transient and discarded;
* v is the slope of the regression line through the remaining arrivals;
* its error is the largest of three quantities: three times the standard error of the slope; the
  difference between the slopes of the third and the fourth quarter of the arrivals; and the
  difference from a second run with a tolerance a hundred times larger, which is v itself if the
  front stops in that run;
* the part of the difference between the quarters that their standard errors do not explain is a
  drift and is multiplied by six: if the velocity approaches its limit like n^{-2/3}, as for the
  head of a wave, the limit is still 4.5 times that difference away;
* the front is steady if the error is below a stated fraction of v; otherwise the chain is
  lengthened.

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
_AT_ONCE = 1e-12
"""Relative difference of arrival times that may be a rounding error."""


@dataclass(frozen=True)
class Trial:
    """A pair of runs on a chain of one length.

    Attributes
    ----------
    stopped : FrontStatus or None
        Why the front did not reach the end in the first run; None if it did.
    arrivals, coarser : ndarray, shape (m,)
        Arrival times by site, nan where a site was not reached. The second array is from the run
        with a tolerance a hundred times larger; it is empty if the front did not reach the end in
        both runs.
    steps : int
        Total number of steps of both runs.
    """

    stopped: FrontStatus | None
    arrivals: FloatArray
    coarser: FloatArray
    steps: int


@dataclass(frozen=True)
class Settled:
    """Result of the trials on successively longer chains.

    Attributes
    ----------
    status : FrontStatus
        What became of the front.
    v, error : float or None
        Velocity and its uncertainty: 0 and ``pinned_error`` for a pinned front, None if there is no
        front, or all sites were reached at once.
    arrivals : ndarray, shape (m,)
        Arrival times of the last trial, without the sites that were not reached.
    sites : int
        Chain length in the last trial.
    steps : int
        Total number of steps of all trials.
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
    pinned_error: float,
    long_enough: Callable[[int, float], bool] = lambda sites, v: True,
    other_velocity: float | None = None,
) -> Settled:
    """Lengthen the chain until the velocity has settled, or the front has stopped.

    Parameters
    ----------
    trial : callable
        Makes a pair of runs on a chain with the given number of sites.
    sites : int
        Length tried first; it is doubled each time.
    max_sites : int
        Largest chain length.
    accuracy : float
        Relative error of v at which the front counts as steady.
    pinned_error : float
        Uncertainty stated for a pinned front: the smallest velocity that would have been noticed.
    long_enough : callable, optional
        Whether a chain with this number of sites is also long enough by another criterion, given v.
    other_velocity : float, optional
        A second velocity: if ``long_enough`` does not hold on the longest chain, the stated error
        is at least the difference between v and this velocity.

    Examples
    --------
    >>> def trial(sites):
    ...     return Trial(None, np.arange(sites) / 2.0, np.arange(sites) / 2.0, sites)
    >>> settle(trial, sites=32, max_sites=99, accuracy=1e-3, pinned_error=0.0).v
    2.0
    """
    steps = 0
    while True:
        runs = trial(sites)
        steps += runs.steps
        arrivals = runs.arrivals[~np.isnan(runs.arrivals)]
        if runs.stopped is not None:
            v, error = (0.0, pinned_error) if runs.stopped is FrontStatus.PINNED else (None, None)
            return Settled(runs.stopped, v, error, arrivals, sites, steps)
        reached, beside = leading(runs.arrivals), leading(runs.coarser)
        both = min(reached.size, beside.size) or reached.size
        v, error = velocity_of_arrivals(reached[:both])
        other = velocity_of_arrivals(beside[:both])[0] if beside.size else 0.0
        error = max(error, abs(v - other))
        long, longest = long_enough(sites, v), 2 * sites > max_sites
        if longest and not long and other_velocity is not None:
            error = max(error, abs(v - other_velocity))
        if error < accuracy * v and (long or longest):
            return Settled(FrontStatus.STEADY, v, error, arrivals, sites, steps)
        if longest and math.isinf(v):
            return Settled(FrontStatus.UNSTEADY, None, None, arrivals, sites, steps)
        if longest:
            return Settled(FrontStatus.UNSTEADY, v, error, arrivals, sites, steps)
        sites *= 2


def leading(arrivals: FloatArray) -> FloatArray:
    """Return when each site or one beyond it was first reached; trailing nan values are dropped.

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

    Both are infinite if those sites were reached at once, as by a force that acts on all of them.

    Parameters
    ----------
    arrivals : ndarray, shape (m,)
        Times at neighbouring sites, not decreasing; m at least 16.

    Examples
    --------
    >>> velocity_of_arrivals(np.arange(32) / 2.0)
    (2.0, 0.0)
    """
    late = arrivals[arrivals.size // 2 :]
    site = np.arange(late.size)
    slope, noise = line(site, late)
    if slope * late.size <= _AT_ONCE * late[-1]:
        return math.inf, math.inf
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
