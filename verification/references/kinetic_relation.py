"""References: Σ, r and the static limit to many digits, by methods that the claim does not use."""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp

from theory.piecewise.limits import static_sum_distance
from theory.piecewise.sums.precise import precise_sum_by_integral
from theory.piecewise.sums.result import PrecisionError
from theory.piecewise.sums.series import sum_by_roots
from verification.quantities.quantity import NoReferenceError

MOST_PERIODS = 1500.0
"""Of c/v, up to which the roots are summed in high precision: about a root a unit of it."""


def reference_sum(v: float, c: float, digits: int, without: str = "") -> tuple[Any, float, str]:
    """Return Σ(v, c), a bound on its error, and by which method.

    The series over the roots where they are few, the closed static limit where v is so small that
    nothing else remains, else the integral in high precision.

    Parameters
    ----------
    v, c : float
        Velocity and coupling, dimensionless.
    digits : int
        After the point.
    without : str
        ``series`` or ``integral``: a method that must not be used.

    Raises
    ------
    NoReferenceError
        If no other method reaches this point.
    """
    if without != "series" and c / v < MOST_PERIODS:
        found = sum_by_roots(v, c, digits)
        return found.value, found.error, "series"
    bound = static_sum_distance(v, c) if v < 0.5 else 1.0
    if bound < 10.0**-digits:
        with mp.workdps(digits + 10):
            return static_sum_precise(mp.mpf(c)), bound + 10.0 ** (-digits - 5), "static limit"
    if without != "integral":
        found = precise_sum_by_integral(v, c, digits)
        return found.value, found.error, "integral in many digits"
    raise NoReferenceError(f"neither the series nor the static limit reaches v = {v!r}, c = {c!r}.")


def static_sum_precise(c: Any) -> Any:
    """Return -1 + 1/√(1 - 4ic) at the current precision."""
    return -1 + 1 / mp.sqrt(1 - 4j * c)


def ratio_precise(eta: Any) -> Any:
    """Return r = √[(1 - s)/(1 + s)], s = √(1 - 8η), straight from the two cycles."""
    with mp.workdps(mp.mp.dps + 40):  # of which 1 - s loses as many as η has zeros
        s = mp.sqrt(1 - 8 * mp.mpf(eta))
        return mp.sqrt((1 - s) / (1 + s))


def distance(value: Any, reference: Any, digits: int) -> float:
    """Return |value - reference| at enough digits.

    Examples
    --------
    >>> distance(1.5, 1.25, 20)
    0.25
    """
    with mp.workdps(digits + 10):
        return float(abs(mp.mpmathify(value) - mp.mpmathify(reference)))


def needed_digits(error: float) -> int:
    """Return the digits of a reference that can judge a stated error."""
    return max(20, math.ceil(-math.log10(max(error, 1e-300))) + 4)


__all__ = [
    "NoReferenceError",
    "PrecisionError",
    "distance",
    "needed_digits",
    "ratio_precise",
    "reference_sum",
    "static_sum_precise",
]
