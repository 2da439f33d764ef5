"""The error of a run, by comparison with the same run at two other, larger tolerances.

They are a hundred and a thousand times the tolerance. The error is twice the larger of the
difference from the first and a tenth of the difference from the second: an event may make one
difference small by accident, and where rounding decides, such a run is no worse than the run
itself. The first of them also starts a few units in the last place away. Where motion is unstable,
rounding alone grows by e^{λt}, and no tolerance helps; so the error says it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

COARSER = 100.0
"""The first run at another tolerance has the tolerance times this."""

PERTURBATION = 8
"""Units in the last place by which the start of that run is perturbed."""

_SECOND = 1000.0
_SHARES = (1.0, COARSER / _SECOND)
_MAX_TOLERANCE = 0.1


def coarser_tolerances(tolerance: float) -> list[float]:
    """Return the tolerances of both runs for comparison, at most 0.1.

    Examples
    --------
    >>> coarser_tolerances(2.0**-10)
    [0.09765625, 0.1]
    """
    return [min(_MAX_TOLERANCE, factor * tolerance) for factor in (COARSER, _SECOND)]


def error_by_sample(samples: FloatArray, others: Sequence[FloatArray]) -> FloatArray:
    """Return the error of each sample, a bound on √(Δy² + Δw²) of every site.

    Parameters
    ----------
    samples, others : ndarray, shape (M, 2, N), and a pair of such
        States of the run, and of the runs at the other tolerances.

    Returns
    -------
    ndarray, shape (M,)

    Examples
    --------
    >>> state = np.zeros((1, 2, 1))
    >>> error_by_sample(state, [state + 0.25, state]).round(6).tolist()
    [0.707107]
    """
    apart = [np.hypot(*np.moveaxis(samples - other, 1, 0)).max(axis=-1) for other in others]
    worst: FloatArray = 2.0 * np.max([s * a for s, a in zip(_SHARES, apart, strict=True)], axis=0)
    return worst


def arrival_error_from(run: FloatArray, others: Sequence[FloatArray]) -> float:
    """Return the error of arrival times; inf if one run saw an arrival that another did not.

    Examples
    --------
    >>> one = np.array([1.0, np.nan])
    >>> arrival_error_from(one, [one + 0.5, one])
    1.0
    """
    apart = [difference(run, other) for other in others]
    return 2.0 * max(share * each for share, each in zip(_SHARES, apart, strict=True))


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
