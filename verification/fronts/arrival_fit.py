"""Velocity of a front from its arrival times: regression, transient, test for a steady front.

The rule is the same for every chain, lattice and network:

* a site counts as reached once it or any site beyond it has been reached, since a front may skip
  sites and fill them in later;
* the first half of the arrivals, in order of distance, is regarded as transient and discarded;
* v is the slope of the regression line through the remaining arrivals;
* its error is the largest of five quantities: three times the standard error of the slope; the
  difference between the slopes of the third and the fourth quarter of the arrivals; three times the
  difference from the slope of the middle half of those fitted, as far as three standard errors of
  that slope do not explain it; three times the difference from a second run with a tolerance a
  hundred times larger, or v itself if the front stops in that run; and a quarter of the tolerance,
  relative to v;
* the part of the difference between the quarters that their standard errors do not explain is a
  drift and is multiplied by six: if the velocity approaches its limit like n^{-2/3}, as for the
  head of a wave, the limit is still 4.5 times that difference away;
* the slope of the middle half differs where the transient of the start at one end and the free end
  of the chain at the other change the arrivals alike, so that the quarters agree; three times the
  difference is enough if the middle half has at most two thirds of that change;
* standard errors explain no difference where quarters have fewer than four arrivals, or arrivals
  have distances of their own, as those of a front that spreads from a centre: its velocity changes
  with its curvature, like the inverse of the distance, and the arrivals scatter with its shape;
* this scatter may hide the drift, since quarters have few distances; where arrivals have distances
  of their own, the error is at least twice the difference from the velocity far away according to a
  fit of a line and a logarithm of the distance to the farther three quarters of the arrivals: the
  factor allows that an extrapolation is wrong by as much as it corrects;
* where sites differ at random, arrival times deviate from the line like a random walk, of which the
  standard error of a regression takes no account; the error is then at least three times the
  deviation of the slope of such a walk;
* the front is steady if the error is below a stated fraction of v; otherwise the chain is
  lengthened.

Velocities are in sites per unit of the time in which the arrivals are given.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from theory.arrays import FloatArray

_NOISE, _DRIFT, _BEND, _CURVED = 3.0, 6.0, 3.0, 2.0
_BLOCKS = 8
_FEWEST = 4
"""Fewest arrivals of which a standard error explains a difference of slopes: of fewer, those of a
front that changes its velocity are as far from a line as those with noise."""
_BESIDE, _LEAST = 3.0, 0.25
"""Multiple of the difference from the run at the coarser tolerance, and part of the tolerance, to
which the relative error of a velocity is stated at least. The errors of a run are not proportional
to the tolerance, since steps change at intervals only, so that both runs can err alike."""
_AT_ONCE = 1e-12
"""Relative difference of arrival times that may be a rounding error."""


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


def velocity_of_arrivals(
    arrivals: FloatArray, distances: FloatArray | None = None
) -> tuple[float, float]:
    """Return v and its uncertainty from the farther half of the arrival times.

    Both are infinite if those sites were reached at once, as by a force that acts on all of them.

    Parameters
    ----------
    arrivals : ndarray, shape (m,)
        Arrival times, m at least 11.
    distances : ndarray, shape (m,), optional
        Distances of the sites, in any order; by default those of neighbouring sites, 1 apart.

    Examples
    --------
    >>> velocity_of_arrivals(np.arange(32) / 2.0)
    (2.0, 0.0)
    """
    away = np.arange(arrivals.size) if distances is None else distances
    farther = np.argsort(away, kind="stable")[arrivals.size // 2 :]
    position, late = away[farther], arrivals[farther]
    slope, noise = line(position, late)
    trusted = distances is None and late.size >= 2 * _FEWEST
    if slope * (position[-1] - position[0]) <= _AT_ONCE * float(late.max()):
        return math.inf, math.inf
    half = late.size // 2
    first, first_noise = line(position[:half], late[:half])
    second, second_noise = line(position[half:], late[half:])
    apart = abs(first - second)
    drift = _DRIFT * (apart - trusted * 2.0 * math.hypot(first_noise, second_noise))
    outer = late.size // 4
    middle, middle_noise = line(position[outer:-outer], late[outer:-outer])
    bend = _BEND * (abs(slope - middle) - trusted * _NOISE * middle_noise)
    curved = 0.0 if distances is None else _CURVED * abs(slope - _far_away(distances, arrivals))
    return 1.0 / slope, max(_NOISE * noise, apart, drift, bend, curved) / slope**2


def error_by_disorder(arrivals: FloatArray) -> float:
    """Return the uncertainty of v from the farther half of the arrivals if sites differ at random.

    The time from site to site then varies, and the arrivals wander about the line. Of m steps of a
    random walk of variance s² each, the slope of the regression line has the variance 6s²/5m. Here
    s² is found from the durations of eight blocks, which should be longer than the front is wide.

    Examples
    --------
    >>> error_by_disorder(np.arange(64) / 2.0)
    0.0
    """
    late = arrivals[arrivals.size // 2 :]
    length = (late.size - 1) // _BLOCKS
    if length < 1:
        return math.inf
    blocks = np.diff(late[: length * _BLOCKS + 1 : length])
    slope, _ = line(np.arange(late.size), late)
    wander = math.sqrt(1.2 * float(np.var(blocks, ddof=1)) / length / late.size)
    return _NOISE * wander / slope**2 if slope > 0.0 else math.inf


def _far_away(distances: FloatArray, arrivals: FloatArray) -> float:
    """Return the slope of arrival times at infinite distance, if it changes like its inverse."""
    farther = np.argsort(distances, kind="stable")[arrivals.size // 4 :]
    position = distances[farther]
    terms = np.column_stack([np.ones(position.size), position, np.log(position)])
    return float(np.linalg.lstsq(terms, arrivals[farther])[0][1])


def error_beside(v: float, error: float, coarser: float | None, tolerance: float) -> float:
    """Return the error of a velocity, given that from a run at a coarser tolerance.

    Parameters
    ----------
    v, error : float
        Velocity, and its uncertainty from the arrival times.
    coarser : float or None
        Velocity in the second run; None if the front stopped in that run.
    tolerance : float
        Tolerance of the first run.

    Examples
    --------
    >>> error_beside(2.0, 1e-6, 2.0, 1e-3), error_beside(2.0, 1e-6, None, 1e-3)
    (0.0005, 2.0)
    """
    if coarser is None or math.isinf(v):
        return max(error, v)
    return max(error, _LEAST * tolerance * v, _BESIDE * abs(v - coarser))


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
