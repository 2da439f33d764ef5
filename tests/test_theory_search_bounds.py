"""Where solutions of (54) can lie, and how finely the search looks there."""

import math

import numpy as np
import pytest

from theory.piecewise import branch_search
from theory.piecewise.limits import resonant_velocities, static_sum, static_sum_distance
from theory.piecewise.sums.integral import sum_by_integral
from theory.piecewise.sums.quadrature import sum_by_quadrature


@pytest.mark.parametrize(
    ("c", "target", "shift"), [(0.5, 0.6, 0.0), (3.0, 0.9, 0.0), (2.0, 0.7, 2.0)]
)
def test_beyond_the_largest_velocity_the_sum_is_too_small(c, target, shift):
    last = math.exp(branch_search._first_points(c, target, shift, 1.0)[-1])
    # |Sum| <= 2c(1 + 2c)/v, from A and L on the real line; |Sum| >= |target - shift| is needed.
    assert last == pytest.approx(2 * c * (1 + 2 * c) / abs(target - shift), rel=1e-12)
    for v in (last, 3 * last):
        size = abs(sum_by_quadrature(v, c).value)
        assert size <= 2 * c * (1 + 2 * c) / v <= abs(target - shift) * (1 + 1e-12)


@pytest.mark.parametrize("shift", [0.0, 2.0])
@pytest.mark.parametrize("c", [0.3, 2.0])
def test_below_the_smallest_velocity_the_sum_is_too_near_its_limit(c, shift):
    target = abs(static_sum(c) + shift) + 0.05
    low = branch_search._lowest_velocity(c, target, shift)
    assert static_sum_distance(low, c) == pytest.approx(0.05, rel=1e-9)
    assert abs(sum_by_quadrature(low, c).value - static_sum(c)) <= 0.05


def test_for_strong_coupling_the_smallest_velocity_is_larger_and_still_below_all_solutions():
    c, gap = 30.0, 0.05
    low = branch_search._lowest_velocity(c, abs(static_sum(c)) + gap, 0.0)
    plain = 0.5 / math.log1p(2 / gap)
    assert plain < low < math.sqrt(c)
    assert 0.3 * gap < branch_search._distance_on_contour(low, c) <= 0.5 * gap
    for v in (low, 0.7 * low):
        bound = branch_search._distance_on_contour(v, c)
        assert abs(sum_by_integral(v, c).value - static_sum(c)) <= bound


def test_the_contour_is_one_period_of_k_weighted_by_its_length():
    # X = sin^2(k/2), so dX = sin(k/2) cos(k/2) dk; the integral is over |dk| / 2 pi, both halves.
    step = 1e-5
    sigma = branch_search._SIGMA

    def of(s):
        square = 1j * np.exp(2 * s)
        return square / (1 + square)

    X = of(sigma)
    np.testing.assert_allclose(branch_search._X, X, rtol=1e-12)
    middle = abs(sigma) < 8  # beyond, 1 - X is lost in rounding
    slope = (of(sigma + step) - of(sigma - step)) / (2 * step)
    length = np.abs(slope / np.sqrt(X * (1 - X))) * np.diff(sigma)[0] / np.pi
    ours = branch_search._LENGTH
    np.testing.assert_allclose(ours[middle], length[middle], rtol=1e-5)


@pytest.mark.parametrize("refine", [1.0, 2.0])
def test_the_first_points_are_as_near_as_the_waves_of_the_sum_ask_for(refine):
    c = 0.8
    t = branch_search._first_points(c, 0.6, 0.0, refine)
    wave = math.pi / (4 * c + 1) / refine
    coarse = branch_search._COARSEST / refine
    nearness = np.maximum(np.diff(t) / coarse, -np.diff(np.exp(-t)) / wave)
    assert np.all(nearness <= 1 + 1e-9)
    assert np.median(nearness) > 0.5


def test_the_first_points_hold_every_resonance_and_both_its_sides():
    c = 8.0
    t = branch_search._first_points(c, 0.6, 0.0, 2.0)
    velocities, widths = resonant_velocities(c, 4)
    held = 0
    for centre, width in zip(velocities, widths, strict=True):
        for v in (centre, centre - width / 2, centre + width / 2):
            if math.exp(t[0]) < v < math.exp(t[-1]):
                held += 1
                assert np.abs(t - math.log(v)).min() < 1e-12
    assert held >= 6
