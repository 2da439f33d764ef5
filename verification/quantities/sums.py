"""Σ(v, c) of (53), in each of its methods, over sixteen decades of v and c."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
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
    Axis,
    Computation,
    NoReferenceError,
    Quantity,
    ReferenceCheck,
    StatedValue,
    whole,
)
from verification.references.piecewise import static_sum

V, C = Axis(name="v", low=1e-8, high=1e8), Axis(name="c", low=1e-8, high=1e8)


MAX_PERIODS = 1500.0
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
    if without != "series" and c / v < MAX_PERIODS:
        found = sum_by_roots(v, c, digits)
        return found.value, found.error, "series"
    bound = static_sum_distance(v, c) if v < 0.5 else 1.0
    if bound < 10.0**-digits:
        with mp.workdps(digits + 10):
            return static_sum(mp.mpf(c)), bound + 10.0 ** (-digits - 5), "static limit"
    if without != "integral":
        found = precise_sum_by_integral(v, c, digits)
        return found.value, found.error, "integral in many digits"
    raise NoReferenceError(f"neither the series nor the static limit reaches v = {v!r}, c = {c!r}.")


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


def _stated(found: KineticSum) -> StatedValue:
    return StatedValue(value=found.value, error=found.error)


def _check(without: str) -> Callable[[Mapping[str, float], StatedValue], ReferenceCheck]:
    def check(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
        digits = needed_digits(stated.error)
        value, uncertainty, by = reference_sum(at["v"], at["c"], digits, without)
        return ReferenceCheck(
            distance=distance(stated.value, value, digits), uncertainty=uncertainty, method=by
        )

    return check


def _by_integral(at: Mapping[str, float]) -> StatedValue:
    return _stated(sum_by_integral(at["v"], at["c"], at["tolerance"]))


def _by_series(at: Mapping[str, float]) -> StatedValue:
    return _stated(sum_by_roots(at["v"], at["c"], whole(at["digits"])))


def _by_bessel(at: Mapping[str, float]) -> StatedValue:
    return _stated(sum_by_bessel(at["v"], at["c"], at["tolerance"]))


def _by_quadrature(at: Mapping[str, float]) -> StatedValue:
    return _stated(sum_by_quadrature(at["v"], at["c"], at["tolerance"]))


def _by_precise_integral(at: Mapping[str, float]) -> StatedValue:
    return _stated(precise_sum_by_integral(at["v"], at["c"], whole(at["digits"])))


QUANTITIES = (
    Quantity(
        name="sum",
        title="the sum Σ(v, c) of Eq. (53)",
        equation="(53)",
        problems="sum",
        reference="the series over the roots and the integral over k, 60 digits each",
        accuracy=1e-55,
        default="integral, in a batch",
        useful=(1e-12, 1e-2),
        computations=(
            Computation(
                name="sigma-integral",
                title="the sum (53) by the periodised integral",
                axes=(V, C, Axis(name="tolerance", low=1e-15, high=0.1)),
                compute=_by_integral,
                check=_check("integral in double"),
                seconds=0.2,
                share=4.0,
                problems="sum",
            ),
            Computation(
                name="sigma-series",
                title="the sum (53) over the roots, in double and in many digits",
                axes=(V, C, Axis(name="digits", low=1, high=60, whole=True)),
                compute=_by_series,
                check=_check("series"),
                seconds=20.0,
                problems="sum",
            ),
            Computation(
                name="sigma-precise-integral",
                title="the sum (53) by the periodised integral in many digits",
                axes=(V, C, Axis(name="digits", low=1, high=60, whole=True)),
                compute=_by_precise_integral,
                check=_check("integral"),
                seconds=30.0,
                share=0.6,
                problems="sum",
            ),
            Computation(
                name="sigma-bessel",
                title="the sum (53) by Bessel functions",
                axes=(V, C, Axis(name="tolerance", low=1e-14, high=0.1)),
                compute=_by_bessel,
                check=_check("bessel"),
                seconds=30.0,
                problems="sum",
            ),
            Computation(
                name="sigma-quadrature",
                title="the sum (53) by adaptive quadrature",
                axes=(V, C, Axis(name="tolerance", low=1e-14, high=0.1)),
                compute=_by_quadrature,
                check=_check("quadrature"),
                seconds=30.0,
                problems="sum",
            ),
        ),
    ),
)
