"""Σ(v, c) of (53), in each of its methods, over sixteen decades of v and c."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from theory.piecewise.sums.bessel import sum_by_bessel
from theory.piecewise.sums.integral import sum_by_integral
from theory.piecewise.sums.precise import precise_sum_by_integral
from theory.piecewise.sums.quadrature import sum_by_quadrature
from theory.piecewise.sums.result import KineticSum
from theory.piecewise.sums.series import sum_by_roots
from verification.quantities.quantity import Axis, Check, Claim, Quantity, whole
from verification.references.kinetic_relation import distance, needed_digits, reference_sum

V, C = Axis("v", 1e-8, 1e8), Axis("c", 1e-8, 1e8)


def _claim(found: KineticSum) -> Claim:
    return Claim(found.value, found.error)


def _check(without: str) -> Callable[[Mapping[str, float], Claim], Check]:
    def check(at: Mapping[str, float], claim: Claim) -> Check:
        digits = needed_digits(claim.error)
        value, uncertainty, by = reference_sum(at["v"], at["c"], digits, without)
        return Check(distance(claim.value, value, digits), uncertainty, by)

    return check


def _by_integral(at: Mapping[str, float]) -> Claim:
    return _claim(sum_by_integral(at["v"], at["c"], at["tolerance"]))


def _by_series(at: Mapping[str, float]) -> Claim:
    return _claim(sum_by_roots(at["v"], at["c"], whole(at["digits"])))


def _by_bessel(at: Mapping[str, float]) -> Claim:
    return _claim(sum_by_bessel(at["v"], at["c"], at["tolerance"]))


def _by_quadrature(at: Mapping[str, float]) -> Claim:
    return _claim(sum_by_quadrature(at["v"], at["c"], at["tolerance"]))


def _by_precise_integral(at: Mapping[str, float]) -> Claim:
    return _claim(precise_sum_by_integral(at["v"], at["c"], whole(at["digits"])))


QUANTITIES = (
    Quantity(
        "sigma-integral",
        "the sum (53) by the periodised integral",
        (V, C, Axis("tolerance", 1e-15, 0.1)),
        _by_integral,
        _check("integral in double"),
        seconds=0.2,
        share=4.0,
        scenes="sum",
    ),
    Quantity(
        "sigma-series",
        "the sum (53) over the roots, in double and in many digits",
        (V, C, Axis("digits", 1, 60, whole=True)),
        _by_series,
        _check("series"),
        seconds=20.0,
        scenes="sum",
    ),
    Quantity(
        "sigma-precise-integral",
        "the sum (53) by the periodised integral in many digits",
        (V, C, Axis("digits", 1, 60, whole=True)),
        _by_precise_integral,
        _check("integral"),
        seconds=30.0,
        share=0.6,
        scenes="sum",
    ),
    Quantity(
        "sigma-bessel",
        "the sum (53) by Bessel functions",
        (V, C, Axis("tolerance", 1e-14, 0.1)),
        _by_bessel,
        _check("bessel"),
        seconds=30.0,
        scenes="sum",
    ),
    Quantity(
        "sigma-quadrature",
        "the sum (53) by adaptive quadrature",
        (V, C, Axis("tolerance", 1e-14, 0.1)),
        _by_quadrature,
        _check("quadrature"),
        seconds=30.0,
        scenes="sum",
    ),
)
