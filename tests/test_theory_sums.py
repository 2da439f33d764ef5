"""Claims about Σ(v, c), the left side of the kinetic relation (53), and its four evaluations."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from theory.parameters import ParameterError
from theory.piecewise.limits import static_sum
from theory.piecewise.sums.bessel import sum_by_bessel
from theory.piecewise.sums.integral import sum_by_integral, sums
from theory.piecewise.sums.precise import precise_sum_by_integral
from theory.piecewise.sums.quadrature import sum_by_quadrature
from theory.piecewise.sums.result import KineticSum, PrecisionError
from theory.piecewise.sums.series import sum_by_roots
from verification.quantities.problems import PROBLEMS, Problem

# Where a method is at its limits: roots that cross or touch a path of integration, the first
# resonance of c = 100, and the corners of the (v, c) plane.
HARD = [
    (159.82338529816317, 214.92354611211903),
    (7.0562693897135915, 10.802444936499525),
    (72.46, 100.0),
    (1e5, 1e-5),
    (0.5, 300.0),
    (1e-9, 1e9),
]
EVERY = sorted({*HARD, *((problem.v, problem.c) for problem in PROBLEMS["sum"])})


def random_points(seed: int, count: int, decades: float) -> list[tuple[float, float]]:
    rng = np.random.default_rng(seed)
    v, c = np.exp(rng.uniform(-1, 1, (2, count)) * decades * math.log(10))
    return list(zip(v.tolist(), c.tolist(), strict=True))


@cache
def true_sum(v: float, c: float) -> KineticSum:
    """Return Σ to 20 digits; each point is a reference of several tests."""
    return precise_sum_by_integral(v, c, 20)


def distance(a: KineticSum, b: KineticSum) -> float:
    """|a - b|, not rounded before the subtraction."""
    with mp.workdps(60):
        return float(abs(mp.mpc(a.value) - mp.mpc(b.value)))


def textbook_sum(v: float, c: float) -> complex:
    """Return -1 + (v/π) ∫₀^∞ dk/(A² + v²k²), A = ½ - ic(1 - cos k), by plain equispaced points.

    Beyond K = 4000π the integrand is 1/(vk)², but for |A|²/(vk)⁴.
    """
    count, end = 1 << 19, 4000 * math.pi
    k = np.linspace(0, end, count + 1)
    value = 1 / ((0.5 - 1j * c * (1 - np.cos(k))) ** 2 + (v * k) ** 2)
    value[[0, -1]] *= 0.5
    return complex(-1 + v / math.pi * (np.sum(value) * end / count + 1 / (v * v * end)))


def periodised_sum(v: float, c: float) -> mp.mpc:
    """Return -1 + mean of sinh a/(2A (cosh a - cos k)), a = A/v, on 512 points in 30 digits."""
    with mp.workdps(30):
        terms = []
        for j in range(512):
            k = mp.pi * (2 * j + 1) / 512
            onsite = mp.mpf(1) / 2 - 1j * c * (1 - mp.cos(k))
            a = onsite / v
            terms.append(mp.sinh(a) / (2 * onsite * (mp.cosh(a) - mp.cos(k))))
        return mp.fsum(terms) / 512 - 1


def test_tens_of_thousands_of_pieces_are_added_without_losing_digits() -> None:
    v, c = 0.07989, 1.0468
    # 5e4 roundings of a total of order one would be some 5e-14, beyond the 3e-14 stated
    found = sum_by_quadrature(v, c, 1e-13)
    with mp.workdps(30):
        assert float(abs(periodised_sum(v, c) - mp.mpc(found.value))) < found.error < 4e-14


@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (1.0, 1.0), (3.0, 0.2)])
def test_sigma_is_the_real_line_integral_of_the_printed_relation(v: float, c: float) -> None:
    # the rest beyond K is below |A|²/(v³K³) = 1e-11 at v = 0.3; the points are exact to e^{-2πs/h}
    assert abs(textbook_sum(v, c) - sum_by_integral(v, c).value) < 3e-11


def test_the_printed_value_is_the_plain_sum_over_roots_found_by_newton() -> None:
    """Σ 1/(kL_k) over 4000 roots above the axis, from seeds of its own, at v = 0.3, c = 0.5."""
    v, c = 0.3, 0.5
    n = np.arange(-2000, 2001)
    centre = 2 * np.pi * n - np.pi / 2
    k = centre + 1j * np.log(np.maximum(2 * v * np.abs(centre) / c, 2.0))
    for _ in range(60):
        value = 0.5 - 1j * c * (1 - np.cos(k)) - 1j * v * k
        k = k + value / (1j * (v + c * np.sin(k)))
    k = np.unique(np.round(k[(k.imag > 0) & (abs(k.real) < 12500)], 8))
    terms = 1 / (-1j * k * (v + c * np.sin(k)))
    # the terms left out are 1/(v k²) and alternate in no way: 2/(v 2π 12500) in all
    assert abs(np.sum(terms) - sum_by_integral(v, c).value) < 2 / (v * 2 * np.pi * 12000)


@pytest.mark.parametrize(("v", "c"), random_points(11, 8, 0.6))
def test_the_four_evaluations_agree_at_random(v: float, c: float) -> None:
    found = [
        sum_by_integral(v, c),
        sum_by_roots(v, c),
        sum_by_bessel(v, c, 1e-11),
        sum_by_quadrature(v, c, 1e-8),
    ]
    assert {each.method for each in found} == {"integral", "series", "bessel", "quadrature"}
    for i, a in enumerate(found):
        assert a.terms > 0
        assert a.seconds >= 0
        for b in found[:i]:
            assert distance(a, b) <= a.error + b.error, (a.method, b.method)
    assert found[0].error < 1e-12
    assert found[1].error < 1e-12


CORNERS = [(1e-12, 1e12), (1e-11, 1e10), (0.0099, 50.0), (0.0101, 50.0), (1e12, 1e-12)]
"""Corners of the range, and both sides of where the contour needs no poles."""


@pytest.mark.parametrize(("v", "c"), [*EVERY, *CORNERS, *random_points(12, 16, 6.0)])
def test_integral_and_series_agree_over_twelve_decades(v: float, c: float) -> None:
    try:
        series = sum_by_roots(v, c)
    except PrecisionError:
        assert c / v > 1e4  # too many roots near the axis: the series' one weakness
        pytest.skip("refused: see the refusals below")
    integral = sum_by_integral(v, c)
    assert distance(integral, series) <= integral.error + series.error


@pytest.mark.parametrize(("v", "c"), EVERY)
@pytest.mark.parametrize(
    "method",
    [
        sum_by_integral,
        sum_by_roots,
        lambda v, c: sum_by_bessel(v, c, 1e-10),
        lambda v, c: sum_by_quadrature(v, c, 1e-6),
    ],
    ids=["integral", "series", "bessel", "quadrature"],
)
def test_no_error_bound_is_exceeded(
    method: Callable[[float, float], KineticSum], v: float, c: float
) -> None:
    # what is too expensive for this test: 1e5 pieces of quadrature or Bessel functions at a time
    slow = method not in (sum_by_integral, sum_by_roots) and (c > 20 or v < 5e-3 or c / v > 200)
    if slow:
        pytest.skip("too expensive for this test")
    try:
        found = method(v, c)
    except PrecisionError:
        assert method is not sum_by_integral
        pytest.skip("refused: see the refusals below")
    exact = true_sum(v, c)
    assert distance(found, exact) <= found.error + exact.error
    assert found.error < 1e-5  # an honest bound is also a useful one


def test_no_error_bound_of_the_array_is_exceeded_at_any_tolerance() -> None:
    """Points at random are in test_theory_sum_rules."""
    exact = [true_sum(v, c) for v, c in HARD]
    v, c = np.array(HARD).T
    for tolerance in (1e-3, 1e-8, 1e-12, 1e-15):
        found = sums(v, c, tolerance)
        off = np.array(
            [
                float(abs(mp.mpc(value) - reference.value))
                for value, reference in zip(found.value, exact, strict=True)
            ]
        )
        assert np.all(off <= found.error)


@pytest.mark.parametrize(
    ("v", "c", "digits"),
    [
        *((*at, 50) for at in ((0.3, 0.5), (3.0, 0.7), HARD[1])),
        *((*at, 30) for at in (*HARD[:5], (0.01, 0.5), (74.0, 1e4))),
    ],
)
def test_integral_and_series_agree_to_many_digits(v: float, c: float, digits: int) -> None:
    integral, series = precise_sum_by_integral(v, c, digits), sum_by_roots(v, c, digits)
    assert distance(integral, series) <= integral.error + series.error
    assert integral.error + series.error < 10.0 ** (1 - digits)


def test_a_string_is_a_decimal_and_a_float_is_binary() -> None:
    decimal, binary = sum_by_roots("0.3", "0.5", 25), sum_by_roots(0.3, 0.5, 25)
    # 0.3 in binary is off by 1.1e-17, and |∂Σ/∂v| is about one
    assert 1e-19 < distance(decimal, binary) < 1e-16
    assert distance(decimal, precise_sum_by_integral("0.3", "0.5", 25)) < 1e-24


@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (1.0, 1.0), HARD[0], HARD[1], (1e-2, 0.5)])
def test_both_half_planes_together_give_minus_two(v: float, c: float) -> None:
    above, below = sum_by_roots(v, c, 25), sum_by_roots(v, c, 25, upper=False)
    with mp.workdps(40):
        assert abs(above.value + below.value + 2) <= above.error + below.error
    quick = sum_by_roots(v, c).value + sum_by_roots(v, c, upper=False).value
    assert abs(quick + 2) < 1e-11  # double precision, sums of at most a few hundred terms


@pytest.mark.parametrize(
    "problem",
    [problem for problem in PROBLEMS["sum"] if "ordinary" in problem.tags],
    ids=lambda problem: problem.name,
)
def test_sixty_roots_are_enough_for_twelve_digits(problem: Problem) -> None:
    found = sum_by_roots(problem.v, problem.c, 12)
    assert found.terms <= 60
    assert distance(found, true_sum(problem.v, problem.c)) < 1e-12


def test_terms_are_paid_for_by_the_tolerance() -> None:
    points = [sum_by_integral(10, 100, tolerance).terms for tolerance in (1e-3, 1e-8, 1e-14)]
    assert points == sorted(set(points))
    assert len({sum_by_roots(0.3, 0.5, digits).terms for digits in (5, 15, 50)}) == 3


@pytest.mark.parametrize(
    ("v", "c"), [(0.3, 0.5), (1.0, 1.0), (0.05, 0.2), (7.4, 100.0), (72.46, 100.0), (0.01, 3.0)]
)
def test_derivatives_are_those_of_finite_differences(v: float, c: float) -> None:
    found = sums(v, c, 1e-14, slopes=True)
    assert found.by_v is not None
    assert found.by_c is not None

    def at(v: float, c: float) -> complex:
        return complex(sum_by_roots(v, c, 17).value)

    for slope, dv, dc in ((found.by_v, 1.0, 0.0), (found.by_c, 0.0, 1.0)):
        h = 1e-4 * (v * dv + c * dc)
        h = min(h, 1e-3)  # the resonance at v = 72.46 is some 0.2 wide
        near = at(v + h * dv, c + h * dc) - at(v - h * dv, c - h * dc)
        far = at(v + 2 * h * dv, c + 2 * h * dc) - at(v - 2 * h * dv, c - 2 * h * dc)
        fourth = (8 * near - far) / (12 * h)
        # fourth order, plus rounding of the values over the step
        assert abs(complex(slope) - fourth) < 1e-9 * (1 + abs(fourth)) + 1e-15 / h


def test_the_sum_is_flat_at_small_v_and_small_at_large_v() -> None:
    assert abs(sum_by_integral(1e-6, 0.5).value - static_sum(0.5)) < 1e-14
    assert abs(static_sum(0.5) - (1 / np.sqrt(1 - 2j) - 1)) < 1e-15
    # as v → ∞ Σ ≈ ic/(4v²), with the next term smaller by 1/v
    assert abs(sum_by_integral(1e3, 0.5).value / (0.5j / 4e6) - 1) < 1e-2


def test_arrays_broadcast_and_equal_their_single_values() -> None:
    v, c = np.geomspace(0.01, 100, 7)[:, None], np.geomspace(0.1, 1000, 5)
    found = sums(v, c)
    assert found.value.shape == found.error.shape == found.points.shape == (7, 5)
    for i in range(7):
        for j in range(5):
            one = sum_by_integral(float(v[i, 0]), float(c[j]))
            # the same rule, in arrays perhaps with more points so that more values have as many
            assert one.terms <= found.points[i, j] <= 2 * one.terms
            assert abs(found.value[i, j] - one.value) <= one.error


REFUSED = [
    pytest.param(lambda: sum_by_roots(1.0, 1e8), id="series"),
    pytest.param(lambda: sum_by_roots(1.0, 1e6, 30), id="precise series"),
    pytest.param(lambda: sum_by_quadrature(1e-6, 1.0, 1e-12), id="quadrature"),
    pytest.param(lambda: sum_by_bessel(1e-3, 1e6), id="bessel"),
]


@pytest.mark.parametrize("refused", REFUSED)
def test_a_refusal_is_one_sentence_that_says_what_to_do(refused: Callable[[], Any]) -> None:
    with pytest.raises(PrecisionError) as caught:
        refused()
    message = str(caught.value)
    assert message.endswith(".")
    assert "\n" not in message
    assert ". " not in message
    assert "v = " in message
    assert "use the method integral" in message


@pytest.mark.parametrize("bad", [0.0, -1.0, math.nan, math.inf, 1e13])
@pytest.mark.parametrize(
    "method", [sum_by_integral, sum_by_roots, sum_by_bessel, sum_by_quadrature]
)
def test_bad_parameters_are_refused_by_name(
    method: Callable[[float, float], KineticSum], bad: float
) -> None:
    with pytest.raises(ParameterError, match="coupling c"):
        method(1.0, bad)
    with pytest.raises(ParameterError, match="velocity v"):
        method(bad, 1.0)


def test_bad_digits_and_tolerances_are_refused() -> None:
    for digits in (0, -1, 2001):
        with pytest.raises(ParameterError, match="digits"):
            sum_by_roots(0.3, 0.5, digits)
        with pytest.raises(ParameterError, match="digits"):
            precise_sum_by_integral(0.3, 0.5, digits)
    for tolerance in (0.0, -1.0, 1.0, math.nan):
        for method in (sum_by_integral, sum_by_bessel, sum_by_quadrature):
            with pytest.raises(ParameterError, match="tolerance"):
                method(0.3, 0.5, tolerance)


@pytest.mark.parametrize(("v", "c"), [(0.02, 0.5), (0.3, 0.5), (7.4, 100.0), (1.0, 1.0)])
@pytest.mark.parametrize("upper", [True, False])
def test_few_digits_have_an_honest_error_too(v: float, c: float, upper: bool) -> None:
    """At 4 and 5 digits the tail once began too near its singularities for its own estimate.

    Up to 10 digits it begins at the same label.
    """
    exact = sum_by_roots(v, c, 30, upper)
    for digits in (1, 3, 4, 5, 7, 10, 11, 13, 15):
        found = sum_by_roots(v, c, digits, upper)
        assert distance(found, exact) <= found.error + exact.error, digits


@pytest.mark.parametrize(
    ("v", "c"),
    [
        (58211555053.99406, 1.76e-12),  # 2m/x overflows in Miller's recurrence
        (947591542275.8, 1.96e-6),
        (2.1e-5, 0.079),  # the first site alone lasts 5e4 units of time
        (8.3e-6, 2.2e-10),
    ],
)
def test_the_bessel_series_at_the_ends_of_its_range(v: float, c: float) -> None:
    found, other = sum_by_bessel(v, c), sum_by_integral(v, c)
    assert abs(found.value - other.value) <= found.error + other.error < 1e-11
    assert found.terms < 1e5
