"""Each term of a stated error is there, with its sign and its factor."""

import math

import mpmath as mp
import numpy as np
import pytest

from theory.cells.vdp import eta_from_ratio
from theory.piecewise import folds as thresholds
from theory.piecewise.dispersion import root_free_strip
from theory.piecewise.limits import static_sum_distance
from theory.piecewise.sums import precise as sum_integral_precise
from theory.piecewise.sums import series as sum_series
from theory.piecewise.sums.axis import plain_points, slope_truncation
from theory.piecewise.sums.precise import precise_sum_by_integral
from theory.piecewise.sums.quadrature import sum_by_quadrature
from theory.piecewise.sums.series import sum_by_roots


def mean_on_line(v: float, c: float, depth: float, of: str = "G") -> float:
    """Return the mean over Re k of |G|, or of a derivative of it, on Im k = depth."""
    k = np.linspace(-np.pi, np.pi, 4000, endpoint=False) + 1j * depth
    A = 0.5 - 1j * c * (1.0 - np.cos(k))
    half = 0.5 * (A / v + 1j * k), 0.5 * (A / v - 1j * k)
    S = 0.5 * (1 / np.tanh(half[0]) + 1 / np.tanh(half[1]))
    S_a = -0.25 * (np.sinh(half[0]) ** -2 + np.sinh(half[1]) ** -2)
    by_A = S_a / (2 * v * A) - S / (2 * A**2)
    values = {"G": S / (2 * A), "by ln v": -S_a / (2 * v), "by ln c": (A - 0.5) * by_A}
    return float(np.abs(values[of]).mean())


def bounds_on_line(v: float, c: float, depth: float) -> tuple[float, float, float]:
    """Return means of bounds of |G| and of its derivatives by ln v and ln c on Im k = depth."""
    x = np.linspace(-np.pi, np.pi, 4000, endpoint=False)
    w = 1 + 2 * c * math.sinh(depth) * np.sin(x)
    less, more = w - 2 * v * depth, w + 2 * v * depth
    G = float(((1 + 2 * v / less + 2 * v / more) / w).mean())
    by_v = float((2 * v * (less**-2 + more**-2)).mean())
    lowest = float(w.min())
    return G, by_v, (G + by_v) * min(1 + 1 / lowest, 2 * c * (1 + math.cosh(depth)) / lowest)


@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (1.0, 0.2), (2.0, 1.5), (0.05, 0.1), (30.0, 1.0)])
@pytest.mark.parametrize("tolerance", [1e-2, 1e-6, 1e-12])
def test_equispaced_points_are_near_the_fewest_of_all_lines_in_the_strip(
    v: float, c: float, tolerance: float
) -> None:
    lines = np.linspace(0.5, 0.999, 100) * root_free_strip(v, c)
    means = [bounds_on_line(v, c, s)[0] for s in lines]
    every = list(zip(lines, means, strict=True))
    fewest = min(math.log1p(2 * mean / tolerance) / s for s, mean in every)
    points, bound = plain_points(v, c, tolerance)
    assert fewest <= points <= 1.16 * fewest + 8  # rounded up by an eighth, and one line is tried
    sharpest = min(2 * mean / math.expm1(points * s) for s, mean in every)
    assert 0.999 * sharpest <= bound <= min(1.5 * sharpest, tolerance)


@pytest.mark.parametrize(("v", "c"), [(0.05, 0.02), (0.2, 3.0), (1.0, 0.5), (3.0, 0.02)])
@pytest.mark.parametrize("count", [8, 60, 200])
def test_the_bound_of_slopes_is_the_mean_of_bounds_of_their_moduli(
    v: float, c: float, count: int
) -> None:
    """Where G is largest on a line, and in the mean over it."""
    s = root_free_strip(v, c)
    depth = s * (1 - max(2e-3, 1.5 / (count * s + 1.5)))
    G, by_v, by_c = bounds_on_line(v, c, depth)
    for of, bound in (("G", G), ("by ln v", by_v), ("by ln c", by_c)):
        assert mean_on_line(v, c, depth, of) <= bound
    expected = 2 * max(by_v, by_c) / math.expm1(count * depth)
    assert slope_truncation(v, c, count) == pytest.approx(expected, rel=1e-2, abs=0)
    assert np.isfinite(slope_truncation(0.011, 1e-20, 400 * count))
    both = slope_truncation(np.array([v, 1.0]), np.array([c, 0.3]), count)
    assert both[0] == pytest.approx(slope_truncation(v, c, count), rel=1e-12, abs=0)


@pytest.mark.parametrize(("v", "c"), [(0.05, 0.2), (0.3, 0.5), (1.0, 0.1), (3.0, 3.0)])
@pytest.mark.parametrize("depth", [0.3, 0.7, 0.99])
def test_the_bounds_for_one_velocity_and_coupling_hold_for_all_smaller_ones(
    v: float, c: float, depth: float
) -> None:
    """On one line, so that several values may share the points of the largest v and c."""
    line = depth * root_free_strip(v, c)
    largest = np.array(bounds_on_line(v, c, line))
    for share_v, share_c in ((0.99, 1.0), (1.0, 0.99), (0.5, 0.9), (0.1, 1.0), (0.01, 0.01)):
        assert np.all(np.array(bounds_on_line(share_v * v, share_c * c, line)) <= largest)


def test_near_the_static_limit_the_distance_to_it_is_an_error() -> None:
    found = precise_sum_by_integral("0.012", "0.5", 12)
    assert found.method == "static limit"
    rounding = 1e-20  # eight digits below the last one asked for
    assert found.error == pytest.approx(
        static_sum_distance(0.012, 0.5) + rounding, rel=1e-12, abs=0
    )


@pytest.mark.parametrize(("v", "c", "few"), [("0.3", "0.5", True), ("6", "40", False)])
def test_many_digits_by_either_rule_agree_with_the_series(v: str, c: str, few: bool) -> None:
    found = precise_sum_by_integral(v, c, 25)
    exact = sum_by_roots(v, c, 30)
    assert abs(found.value - exact.value) <= found.error + exact.error
    assert 1e-33 <= found.error <= 1e-24  # rounding eight digits below
    assert (found.terms < 150) == few


@pytest.mark.parametrize(
    ("v", "c", "digits"), [("20", "30", 20), ("22.482047592347637", "35.054965197985474", 12)]
)
def test_roots_between_contour_and_axis_or_beside_it_are_taken_away(
    v: str, c: str, digits: int
) -> None:
    # without them Sigma would be off by 0.02; the second has one 7e-4 from the contour
    found, exact = precise_sum_by_integral(v, c, digits), sum_by_roots(v, c, digits + 5)
    assert abs(found.value - exact.value) <= found.error + exact.error
    assert found.error <= 10.0**-digits


@pytest.mark.parametrize(("v", "c"), [("0.3", "0.5"), ("3", "2")])
def test_many_equispaced_points_err_by_no_more_than_their_bound(v: str, c: str) -> None:
    digits = 20
    found = precise_sum_by_integral(v, c, digits)
    count, strip = 2 * found.terms, root_free_strip(float(v), float(c))

    def bound(s: float) -> float:
        shift = float(c) * math.sinh(s)
        size = 1 / math.tanh((0.5 - shift - float(v) * s) / (2 * float(v))) / (1 - 2 * shift)
        return 2 * size / math.expm1(count * s)

    sharpest = min(bound(s) for s in np.linspace(0.9, 0.9999, 1000) * strip)
    rounding = 10.0 ** (-digits - 8)
    assert sharpest <= found.error <= 1.3 * sharpest + rounding  # one width is tried
    # as many as 10^(-digits - 1) asks for, no more
    assert found.error <= 10.0 ** (-digits - 1) <= found.error * math.exp(2 * strip)


@pytest.mark.parametrize(("v", "c"), [("0.3", "0.5"), ("6", "40")])
def test_the_points_stated_are_those_computed(v: str, c: str, monkeypatch) -> None:
    plain, computed = sum_integral_precise._integrand, 0

    def counted(*arguments):
        nonlocal computed
        computed += 1
        return plain(*arguments)

    monkeypatch.setattr(sum_integral_precise, "_integrand", counted)
    # an even number of steps has one point more
    assert precise_sum_by_integral(v, c, 20).terms + 1 == computed


def test_without_a_far_end_the_rest_of_quadrature_is_charged_as_it_is() -> None:
    # X is at least 2; the pieces cost next to nothing, so the rest max|A|^2 / 2X^3 is the error.
    found = sum_by_quadrature(0.7, 1e-3, 0.1)
    rest = (0.25 + 4e-6) / (2 * 2.0**3) / math.pi
    assert found.error == pytest.approx(rest, rel=1e-3)


def test_a_fold_at_pinning_is_known_to_the_rounding_of_pinning() -> None:
    fold = thresholds.fold_couplings([0.079])[0]
    assert fold.velocity == 0.0
    assert fold.value > 30
    assert math.ulp(fold.value) / 2 <= fold.error <= 8 * math.ulp(fold.value)


def test_the_error_of_quadrature_is_twice_its_estimate_and_the_rest() -> None:
    v, c, tolerance = 0.7, 1.2, 1e-6
    found = sum_by_quadrature(v, c, tolerance)
    # The rest beyond X is max|A|^2 / 2X^3 over pi; of the pieces a tenth of the tolerance is asked.
    largest = 0.25 + 4 * c * c
    end = (2 * largest / tolerance) ** (1 / 3)
    rest = largest / (2 * end**3) / math.pi
    assert rest <= found.error <= rest + 0.2 * tolerance / math.pi + 2e-15


def test_the_series_adds_the_rounding_and_what_both_tails_leave(monkeypatch) -> None:
    missed = iter([mp.mpf("2e-17"), mp.mpf("5e-17")])
    monkeypatch.setattr(sum_series, "_summed_terms", lambda *_: (mp.mpc(0), 1e-16))
    monkeypatch.setattr(sum_series, "tail_sum", lambda *_: (mp.mpc(0), next(missed)))
    monkeypatch.setattr(sum_series, "_summed_labels", lambda *_: (-3, 8))
    found = sum_by_roots(0.3, 0.5)
    assert found.error == pytest.approx(1.7e-16, rel=1e-12, abs=0)
    assert found.terms == 12


def test_the_error_of_the_fold_in_eta_is_that_of_the_sum_times_the_slope(monkeypatch) -> None:
    height = thresholds._modulus_and_slopes
    inflated = 1e-4

    def uncertain(t, c):
        value, slope, by_c, _ = height(t, c)
        return value, slope, by_c, np.full(value.shape, inflated)

    c = 0.45
    exact = thresholds.fold_eta(c)
    monkeypatch.setattr(thresholds, "_modulus_and_slopes", uncertain)
    found = thresholds.fold_eta(c)
    assert found.value == exact.value
    # eta = r^2 / 2(1 + r^2)^2, so that r is the smaller root; its slope by differences.
    root = math.sqrt(1 - 8 * found.value)
    r, h = math.sqrt((1 - root) / (1 + root)), 1e-5
    slope = (eta_from_ratio(r + h) - eta_from_ratio(r - h)) / (2 * h)
    assert found.error == pytest.approx(slope * inflated, rel=1e-6)
