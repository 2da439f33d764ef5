"""The error of a run, by comparison with the same run at a tenth of its tolerance.

The error of the second run is about a tenth as large, so that the difference is the error itself to
within some ten per cent. Three times the difference is stated, because occasionally, where steps
are limited by stability or a site starts to move between two of them, the finer run is hardly more
accurate. The second run also starts a few units in the last place away: if the motion is unstable,
rounding alone grows like e^{λt} whatever the tolerance, and the stated error then shows it. Where
the error exceeds the amplitude, the two runs are independent motions of this amplitude, and the
stated error is the sum of their amplitudes (``simulate``). If a tenth of the tolerance would be at
the level of rounding, the second run uses ten times the tolerance instead, and the stated error is
some tens of times too large. Since two runs may agree by accident, no error is stated below a
fraction of the local error allowed per step (``Integration.least_error``).
"""

from __future__ import annotations

import numpy as np

from theory.arrays import FloatArray

COARSER = 100.0
"""Ratio of the tolerance of the comparison run to that of the run, where an event is timed."""

PERTURBATION = 8
"""Units in the last place by which the start of the comparison run is perturbed."""

_RATIO = 10.0
SAFETY = 3.0
_FINEST = 1e-14


def other_tolerance(tolerance: float) -> float:
    """Return the tolerance of the comparison run.

    Examples
    --------
    >>> round(other_tolerance(1e-6), 12), round(other_tolerance(1e-14), 18)
    (1e-07, 1e-13)
    """
    finer = tolerance / _RATIO
    return finer if finer >= _FINEST else _RATIO * tolerance


def error_by_sample(samples: FloatArray, other: FloatArray) -> FloatArray:
    """Return the error of each sample: a bound on √(Δy² + Δw²) at every site.

    Parameters
    ----------
    samples, other : ndarray, shape (M, 2, N)
        States of the run and of the comparison run.

    Returns
    -------
    ndarray, shape (M,)

    Examples
    --------
    >>> state = np.zeros((1, 2, 1))
    >>> error_by_sample(state, state + 0.25).round(6).tolist()
    [1.06066]
    """
    distance: FloatArray = np.hypot(*np.moveaxis(samples - other, 1, 0)).max(axis=-1)
    return SAFETY * distance


def arrival_error_from(run: FloatArray, other: FloatArray) -> float:
    """Return the error of arrival times; inf if one run saw an arrival that the other did not.

    Examples
    --------
    >>> one = np.array([1.0, np.nan])
    >>> arrival_error_from(one, one + 0.5)
    1.5
    """
    return SAFETY * difference(run, other)


def difference(first: FloatArray, second: FloatArray) -> float:
    """Return the largest difference of arrival times; inf where only one of them is known.

    Examples
    --------
    >>> difference(np.array([1.0, np.nan]), np.array([1.5, np.nan]))
    0.5
    """
    missing_first, missing_second = np.isnan(first), np.isnan(second)
    if np.any(missing_first != missing_second):
        return float("inf")
    return float(np.max(np.abs(first - second)[~missing_first], initial=0.0))
