"""The error of a run, by comparison with the same run at a tenth of its tolerance.

The error of the other run is about a tenth, so that the difference is the error itself within some
ten per cent. Three times the difference is stated: now and then, where steps are limited by
stability or a site wakes up between two of them, the finer run is hardly better. The other run also
starts a few units in the last place away. Where motion is unstable, rounding alone grows by e^{λt},
and no tolerance helps; so the error says it. Where the tolerance is so small that a tenth of it
would be rounding, the other run has ten times the tolerance instead, and the error is some tens of
times too large. Two runs may agree by accident; so no error below a part of the local error that is
allowed to a step is stated (``Integration.least_error``).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

COARSER = 100.0
"""Tolerance over that of a run for comparison, where an event is timed and not a state."""

PERTURBATION = 8
"""Units in the last place by which the start of the other run is perturbed."""

_RATIO = 10.0
_SAFETY = 3.0
_FINEST, _COARSEST = 1e-14, 1e-2


def other_tolerance(tolerance: float) -> float:
    """Return the tolerance of the run for comparison.

    Examples
    --------
    >>> round(other_tolerance(1e-6), 12), round(other_tolerance(1e-14), 18)
    (1e-07, 1e-13)
    """
    finer = tolerance / _RATIO
    return finer if finer >= _FINEST else _RATIO * tolerance


def coarser_tolerance(tolerance: float) -> float:
    """Return the tolerance of the run for comparison where an event is timed.

    Examples
    --------
    >>> coarser_tolerance(1e-3)
    0.01
    """
    return min(_COARSEST, COARSER * tolerance)


def error_by_sample(samples: FloatArray, other: FloatArray) -> FloatArray:
    """Return the error of each sample, a bound on √(Δy² + Δw²) of every site.

    Parameters
    ----------
    samples, other : ndarray, shape (M, 2, N)
        States of the run, and of the run for comparison.

    Returns
    -------
    ndarray, shape (M,)

    Examples
    --------
    >>> state = np.zeros((1, 2, 1))
    >>> error_by_sample(state, state + 0.25).round(6).tolist()
    [1.06066]
    """
    apart: FloatArray = np.hypot(*np.moveaxis(samples - other, 1, 0)).max(axis=-1)
    return _SAFETY * apart


def arrival_error_from(run: FloatArray, other: FloatArray) -> float:
    """Return the error of arrival times; inf if one run saw an arrival that the other did not.

    Examples
    --------
    >>> one = np.array([1.0, np.nan])
    >>> arrival_error_from(one, one + 0.5)
    1.5
    """
    return _SAFETY * difference(run, other)


def difference(first: FloatArray, second: FloatArray) -> float:
    """Return the largest difference of arrival times; inf where only one of them is known.

    Examples
    --------
    >>> difference(np.array([1.0, np.nan]), np.array([1.5, np.nan]))
    0.5
    """
    one, other = np.isnan(first), np.isnan(second)
    if np.any(one != other):
        return float("inf")
    return float(np.max(np.abs(first - second)[~one], initial=0.0))
