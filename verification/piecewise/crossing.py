"""The first zero of a short polynomial, with a guarantee that no earlier one is missed.

Between two switchings the modulus of a site of the piecewise-linear chain (Eq. 44) is an entire
function of time; over a short interval its Taylor polynomial is exact to within round-off. The zero
is approached from the left by steps that a bound on the second derivative proves free of zeros, so
that double crossings and near tangencies cannot be missed by sampling.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

_ROUND_OFF = 4e-16
_MAX_STEPS = 400


@dataclass(frozen=True)
class FirstZero:
    """The point at which a polynomial that is positive at the start first reaches zero.

    Attributes
    ----------
    at : float or None
        The zero; None if there is none in the interval.
    grazes : int
        Near tangencies that came within round-off of zero and were judged not to cross it.
    """

    at: float | None
    grazes: int


def _value_and_slope(coefficients: Sequence[float], x: float) -> tuple[float, float]:
    value = slope = 0.0
    for a in reversed(coefficients):
        slope = slope * x + value
        value = value * x + a
    return value, slope


def first_zero(coefficients: Sequence[float], end: float) -> FirstZero:
    """Find the first zero of ``sum_j coefficients[j] x**j`` in ``0 <= x <= end``.

    If ``p(x) = v > 0`` and ``p'(x) = d``, and ``|p''| <= F`` on the interval, then p has no zero
    before ``x + 2 v / (sqrt(d**2 + 2 F v) - d)``. Near a simple zero the step approaches Newton's.

    Parameters
    ----------
    coefficients : sequence of float
        Coefficients, beginning with the constant; dimensionless.
    end : float
        Right end of the interval, positive.

    Returns
    -------
    FirstZero
        A value that is at or below round-off and still decreasing counts as a zero.

    Examples
    --------
    >>> round(first_zero([0.5, -2.0, 1.0], 1.0).at, 12)  # (1 - x)^2 = 1/2
    0.292893218813
    >>> first_zero([1.0, -1.999, 1.0], 2.0).at is None  # misses zero by 0.001
    True
    """
    size = sum(abs(a) * end**j for j, a in enumerate(coefficients))
    curvature = sum(j * (j - 1) * abs(a) * end ** (j - 2) for j, a in enumerate(coefficients) if j)
    curvature = max(curvature, 1e-300)
    floor = _ROUND_OFF * size
    x, grazes = 0.0, 0
    for _ in range(_MAX_STEPS):
        value, slope = _value_and_slope(coefficients, x)
        if value <= floor:
            if value < -4 * floor:
                return FirstZero(x, grazes)
            if slope < 0 and slope * slope > 8 * curvature * floor:
                zero = max(x - value / slope, 0.0)
                return FirstZero(zero, grazes) if zero <= end else FirstZero(None, grazes)
            grazes += 1
            x += 2 * math.sqrt(2 * floor / curvature)
        else:
            root = math.sqrt(slope * slope + 2 * curvature * value)
            if slope > 0:
                x += (root + slope) / curvature
            else:
                x += max(2 * value / (root - slope), 1e-16 * end)
        if x > end:
            return FirstZero(None, grazes)
    return FirstZero(x, grazes + 1)
