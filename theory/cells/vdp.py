"""The bistable Van der Pol cell of Model II (Eq. 8 at c = 0): η and the ratio of its two cycles.

The averaged equation (43) for the amplitude ρ = |φ| of a single cell is
ρ' = -(ρ/2)(1 - a ρ²/4 + b ρ⁴/8). Its two cycles are ρ² = (a/b)(1 ∓ √(1 - 8η)), η = b/a².
"""

from __future__ import annotations

import math

from theory.parameters import ParameterError, Range, at_least, number, with_ranges, within

DAMPING = Range(1e-100, 1e100)
"""Range of a and b; outside it the amplitudes would exceed the range of double precision."""

DAMPING_REMEDY = (
    "give a positive number and, where amplitudes would leave double precision, write the chain "
    "for y sqrt(s), which turns a into a/s and b into b/s^2, and keeps eta"
)

ETA_END = 0.125
"""η at which the two cycles meet; beyond it the cell has no limit cycle."""

SMALLEST_ETA = 1e-24
"""Smallest η; below it |Σ| = 2r cannot be distinguished from zero in double precision, and products
of the squared amplitudes of the two cycles lose accuracy."""


@with_ranges(damping=DAMPING)
def eta_from_damping(a: float, b: float) -> float:
    """Return η = b/a² of the damping 1 - a y² + b y⁴ (Eq. 54).

    Parameters
    ----------
    a, b : float
        Coefficients of (8), dimensionless, {damping}; outside this range the amplitudes would
        exceed that of double precision.

    Raises
    ------
    ParameterError
        If a or b is not finite and positive, or out of range.

    Examples
    --------
    >>> eta_from_damping(4, 0.5)
    0.03125
    """
    a, b = (
        within(f"damping coefficient {name}", value, *DAMPING, DAMPING_REMEDY)
        for name, value in (("a", a), ("b", b))
    )
    return b / a**2


def checked_eta(eta: float) -> float:
    """Return η after checking that it is large enough for double precision.

    Raises
    ------
    ParameterError
        If η is not finite, or below ``SMALLEST_ETA``.
    """
    remedy = (
        "give a larger value: below it double precision does not resolve the ratio of the cycles, "
        "r = sqrt(2 eta), and the velocity of (54) is near its limit sqrt(c/(8 r))"
    )
    return at_least("eta = b/a^2", eta, SMALLEST_ETA, remedy)


def is_bistable(eta: float) -> bool:
    """Return whether the cell has two limit cycles: 0 < η < 1/8."""
    return 0 < eta < ETA_END


def bistable_eta(eta: float) -> float:
    """Return η as a float after checking that the cell has two limit cycles, or that they meet.

    Raises
    ------
    ParameterError
        If η is not in (0, 1/8].
    """
    allowed, remedy = (
        "greater than 0 and at most 1/8",
        "take a value in this range: above 1/8 there are no cycles",
    )
    found = number("eta = b/a^2", eta, allowed, remedy)
    if not 0 < found <= ETA_END:
        raise ParameterError("eta = b/a^2", eta, allowed, remedy)
    return found


def eta_of_fronts(eta: float, allowed: Range) -> float:
    """Return η after checking that it is in the range in which fronts of (43) are solved for.

    Raises
    ------
    ParameterError
        If it is not; the remedy depends on whether there are fronts at this η at all.
    """
    remedy = "measure the front on a running chain"
    if number("eta = b/a^2", eta, str(allowed), remedy) >= ETA_END:
        remedy = "take a smaller eta: from 1/8 on a cell has no two cycles, and there is no front"
    return within("eta = b/a^2", eta, *allowed, remedy)


def threshold_ratio(eta: float) -> float:
    """Return r(η) = |φ_us|/|φ_s|, half of the right side of Eq. (54).

    Parameters
    ----------
    eta : float
        η = b/a², dimensionless, 0 < η ≤ 1/8.

    Returns
    -------
    float
        r, dimensionless, 0 < r ≤ 1; accurate to rounding for every η.

    Raises
    ------
    ParameterError
        If η is not in (0, 1/8].

    Notes
    -----
    r² = (1 - s)/(1 + s) with s = √(1 - 8η); it is computed as 8η/(1 + s)², without cancellation.

    Examples
    --------
    >>> round(threshold_ratio(0.03125), 12)
    0.267949192431
    """
    eta = bistable_eta(eta)
    return math.sqrt(8.0 * eta) / (1.0 + math.sqrt(1.0 - 8.0 * eta))


def attraction_rate(eta: float) -> float:
    """Return the rate per unit of slow time at which the stable cycle attracts, for η up to 1/8.

    Examples
    --------
    >>> round(attraction_rate(0.03125), 6)
    12.928203
    """
    root = math.sqrt(1.0 - eta / ETA_END)
    return (1.0 + root) * root / (4.0 * eta)


def eta_from_ratio(r: float) -> float:
    """Return the η at which |φ_us|/|φ_s| = r, the inverse of :func:`threshold_ratio`.

    Parameters
    ----------
    r : float
        Ratio of the cycles, dimensionless, 0 ≤ r ≤ 1.

    Examples
    --------
    >>> round(eta_from_ratio(0.5), 12)
    0.08
    """
    return r**2 / (2.0 * (1.0 + r**2) ** 2)


def threshold_ratio_slope(eta: float) -> float:
    """Return dr/dη = 2 r / (8η √(1 - 8η)), for 0 < η < 1/8.

    From r² = (1 - s)/(1 + s), s = √(1 - 8η): dr/ds = -1/(r (1 + s)²) and ds/dη = -4/s.

    Examples
    --------
    >>> step = 1e-6
    >>> difference = threshold_ratio(0.05 + step) - threshold_ratio(0.05 - step)
    >>> abs(difference / (2 * step) - threshold_ratio_slope(0.05)) < 1e-8
    True
    """
    s = math.sqrt(1.0 - 8.0 * eta)
    return 4.0 / (threshold_ratio(eta) * s * (1.0 + s) ** 2)
