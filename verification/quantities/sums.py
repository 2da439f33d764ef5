"""Σ(v, c) of (53), in each of its methods, over sixteen decades of v and c."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import mpmath as mp

from theory.piecewise.limits import static_sum_distance
from theory.piecewise.sums.bessel import sum_by_bessel
from theory.piecewise.sums.integral import sum_by_integral
from theory.piecewise.sums.precise import precise_sum_by_integral
from theory.piecewise.sums.quadrature import sum_by_quadrature
from theory.piecewise.sums.result import KineticSum
from theory.piecewise.sums.series import sum_by_roots
from verification.quantities.quantity import (
    Computation,
    Quantity,
    ReferenceCheck,
    StatedValue,
    axes,
    whole,
)
from verification.references.pace import NoReferenceError
from verification.references.piecewise import static_sum

Method = Callable[[float, float, Any], KineticSum]
"""Function of v, c and a tolerance or a number of digits."""

MAX_PERIODS = 1500.0
"""Largest c/v for which the roots are summed in high precision: about one root per unit of it."""


def reference_sum(v: float, c: float, digits: int, without: str = "") -> tuple[Any, float, str]:
    """Return Σ(v, c), a bound on its error, and the name of the method.

    The method is the series over the roots if they are few, the closed static limit if v is so
    small that all else is negligible, otherwise the integral in high precision.

    Parameters
    ----------
    v, c : float
        Velocity and coupling, dimensionless.
    digits : int
        Number of digits after the decimal point.
    without : str
        ``series`` or ``integral``: a method that must not be used.

    Raises
    ------
    NoReferenceError
        If no other method can be used at this point.
    """
    if without != "series" and c / v < MAX_PERIODS:
        found = sum_by_roots(v, c, digits)
        return found.value, found.error, "series"
    bound = static_sum_distance(v, c)
    if bound < 10.0**-digits:
        with mp.workdps(digits + 10):
            return static_sum(mp.mpf(c)), bound + 10.0 ** (-digits - 5), "static limit"
    if without != "integral":
        found = precise_sum_by_integral(v, c, digits)
        return found.value, found.error, "integral in many digits"
    raise NoReferenceError(f"neither the series nor the static limit reaches v = {v!r}, c = {c!r}.")


def distance(value: Any, reference: Any, digits: int) -> float:
    """Return |value - reference|, computed with enough digits.

    Examples
    --------
    >>> distance(1.5, 1.25, 20)
    0.25
    """
    with mp.workdps(digits + 10):
        return float(abs(mp.mpmathify(value) - mp.mpmathify(reference)))


def needed_digits(error: float) -> int:
    """Return the number of digits of a reference that can judge a stated error."""
    return max(20, math.ceil(-math.log10(max(error, 1e-300))) + 4)


def _sum(by: Method, at: Mapping[str, float]) -> StatedValue:
    found = by(at["v"], at["c"], whole(at["digits"]) if "digits" in at else at["tolerance"])
    return StatedValue.of(found, found.value)


def _check(without: str, at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    digits = needed_digits(stated.error)
    value, uncertainty, by = reference_sum(at["v"], at["c"], digits, without)
    off = distance(stated.value, value, digits)
    return ReferenceCheck(distance=off, uncertainty=uncertainty, method=by)


def _row(
    name: str, title: str, by: Method, without: str = "", *,
    seconds: float, share: float = 1.0, **accuracy: tuple[float, float],
) -> Computation:  # fmt: skip
    """Return the table row of one method, a function of v, c and an accuracy."""
    return Computation(
        name=f"sigma-{name}", title=f"the sum (53) {title}",
        axes=axes(v=(1e-8, 1e8), c=(1e-8, 1e8), **accuracy),
        compute=partial(_sum, by), check=partial(_check, without),
        seconds=seconds, share=share, problems="sum",
    )  # fmt: skip


QUANTITIES = (
    Quantity(
        name="sum", title="the sum Σ(v, c) of Eq. (53)", equation="(53)",
        problems="sum", accuracy=1e-55, default="integral, in a batch", useful=(1e-12, 1e-2),
        reference="the series over the roots and the integral over k, 60 digits each",
        computations=(
            _row("integral", "by the periodised integral", sum_by_integral,
                 tolerance=(1e-15, 0.1), seconds=0.2, share=4.0),
            _row("series", "over the roots, in double and in many digits", sum_by_roots,
                 "series", digits=(1, 60), seconds=20.0),
            _row("precise-integral", "by the periodised integral in many digits",
                 precise_sum_by_integral, "integral", digits=(1, 60), seconds=30.0, share=0.6),
            _row("bessel", "by Bessel functions", sum_by_bessel,
                 tolerance=(1e-14, 0.1), seconds=30.0),
            _row("quadrature", "by adaptive quadrature", sum_by_quadrature,
                 tolerance=(1e-14, 0.1), seconds=30.0),
        ),
    ),
)  # fmt: skip
