"""The error of a run, from companions: the same run at larger tolerances.

There are two, at a hundred and at a thousand times the tolerance. The error is twice the larger of
the difference from the first and a tenth of the difference from the second: an event may make one
difference small by accident, and where rounding decides, a companion is no worse than the run.
The first companion also starts a few roundings away. Where motion is unstable, rounding alone grows
by e^{λt}, and no tolerance helps; so the error says it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

COMPANION = 100.0
"""The first companion has the tolerance times this."""

ROUNDINGS = 8
"""Units in the last place by which the start of the first companion is moved."""

_SECOND = 1000.0
_SHARES = (1.0, COMPANION / _SECOND)
_MOST = 0.1


def companion_tolerances(tolerance: float) -> list[float]:
    """Return the tolerances of both companions, at most 0.1.

    Examples
    --------
    >>> companion_tolerances(2.0**-10)
    [0.09765625, 0.1]
    """
    return [min(_MOST, factor * tolerance) for factor in (COMPANION, _SECOND)]


def error_from(
    run: npt.NDArray[np.inexact], companions: Sequence[npt.NDArray[np.inexact]]
) -> float:
    """Return the error of samples, all of one shape: a bound in their own unit.

    Examples
    --------
    >>> error_from(np.array([1.0, 2.0]), [np.array([1.0, 2.25]), np.array([1.0, 3.0])])
    0.5
    """
    return _twice([float(np.max(np.abs(run - other), initial=0.0)) for other in companions])


def arrival_error_from(run: FloatArray, companions: Sequence[FloatArray]) -> float:
    """Return the error of arrival times; inf if one run saw an arrival that another did not.

    Examples
    --------
    >>> one = np.array([1.0, np.nan])
    >>> arrival_error_from(one, [one + 0.5, one])
    1.0
    """
    return _twice([difference(run, other) for other in companions])


def _twice(apart: Sequence[float]) -> float:
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
