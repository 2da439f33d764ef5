"""Where solutions of (54) can lie, and how finely the search looks there."""

import math

import numpy as np
import pytest

from theory.piecewise import first_points
from theory.piecewise.branch_search import all_velocities
from theory.piecewise.limits import (
    resonance_number,
    resonant_velocities,
    static_sum,
    static_sum_distance,
)
from theory.piecewise.sums.integral import sum_by_integral, sums
from theory.piecewise.sums.series import sum_by_roots


def points_of_one(c: float, target: float, shift: float, refine: float) -> np.ndarray:
    """Return the first points ln v of one coupling."""
    case, _, t = first_points.first_points(np.array([c]), np.array([target]), shift, refine)
    assert not case.any()
    return t


@pytest.mark.parametrize(
    ("c", "least", "bound"),
    [
        # |Sum| <= 2c(1 + 2c)/v, from A and L on the real line
        (0.01, 0.6, lambda v, c: 2 * c * (1 + 2 * c) / v),
        # |Sum| <= c(1 + 2c)/(2w(v + w)), w^2 = v^2 - c^2
        *(
            (c, least, lambda v, c: c * (1 + 2 * c) / (4 * (v * v - c * c)))
            for c, least in ((0.5, 0.2), (3.0, 0.9), (2.0, 1e-3), (15.0, 0.4))
        ),
    ],
)
def test_beyond_the_largest_velocity_the_sum_is_too_small(c, least, bound):
    last = float(first_points._highest_velocities(np.array([c]), np.array([least]))[0])
    assert bound(last, c) == pytest.approx(least, rel=1e-12)
    for v in (last, 1.1 * last, 3 * last):
        assert abs(sum_by_roots(v, c).value) <= bound(v, c)


@pytest.mark.parametrize("shift", [0.0, 2.0])
def test_no_first_point_lies_beyond_the_largest_velocity(shift):
    last = math.exp(points_of_one(3.0, 0.6, shift, 1.0)[-1])
    least = np.array([abs(0.6 - shift)])  # |Sum| is at least that
    assert last == pytest.approx(first_points._highest_velocities(np.array([3.0]), least)[0])


def lowest(c: float, target: float, shift: float) -> float:
    return float(first_points._lowest_velocities(np.array([c]), np.array([target]), shift)[0])


def on_contour(v: float, c: float) -> float:
    return float(first_points._distance_on_contour(np.array([v]), np.array([c]))[0])


@pytest.mark.parametrize("shift", [0.0, 2.0])
@pytest.mark.parametrize("c", [0.3, 2.0])
def test_below_the_smallest_velocity_the_sum_is_too_near_its_limit(c, shift):
    target = abs(static_sum(c) + shift) + 0.05
    low = lowest(c, target, shift)
    # |Sum - Sum(0+)| is at most the mean of |1/2A|, which is below 1, times the plain bound
    A = 0.5 - 2j * c * np.sin(np.pi * (np.arange(400) + 0.5) / 400) ** 2
    mean = float(np.mean(np.abs(0.5 / A)))
    assert mean < 0.05 / static_sum_distance(low, c) < 1.3 * mean
    for v in (low, 0.7 * low):
        distance = abs(sum_by_roots(v, c).value - static_sum(c))
        assert distance <= mean * static_sum_distance(v, c) <= 0.05


def test_for_strong_coupling_the_smallest_velocity_is_larger_and_still_below_all_solutions():
    c, gap = 30.0, 0.05
    low = lowest(c, abs(static_sum(c)) + gap, 0.0)
    plain = 0.5 / math.log1p(2 / gap)
    assert plain < low < math.sqrt(c)
    assert 0.3 * gap < on_contour(low, c) <= 0.5 * gap
    for v in (low, 0.7 * low):
        assert abs(sum_by_integral(v, c).value - static_sum(c)) <= on_contour(v, c)


def test_each_of_several_couplings_has_the_points_that_it_has_alone():
    c, target = np.array([0.5, 150.0, 8.0, 2.0]), np.array([0.6, 0.9, 0.6, 0.4])
    case, piece, t = first_points.first_points(c, target, 0.0, 1.0)
    assert case.size > c.size  # at strong coupling not all of the way is searched
    case = case[piece]
    for i, (c_, target_) in enumerate(zip(c.tolist(), target.tolist(), strict=True)):
        np.testing.assert_array_equal(t[case == i], points_of_one(c_, target_, 0.0, 1.0))
    assert np.all(np.diff(case) >= 0)


def test_the_contour_is_one_period_of_k_weighted_by_its_length():
    # X = sin^2(k/2), so dX = sin(k/2) cos(k/2) dk; the integral is over |dk| / 2 pi, both halves.
    step = 1e-5
    sigma = first_points._SIGMA

    def of(s):
        square = 1j * np.exp(2 * s)
        return square / (1 + square)

    X = of(sigma)
    np.testing.assert_allclose(first_points._X, X, rtol=1e-12)
    middle = abs(sigma) < 8  # beyond, 1 - X is lost in rounding
    slope = (of(sigma + step) - of(sigma - step)) / (2 * step)
    length = np.abs(slope / np.sqrt(X * (1 - X))) * np.diff(sigma)[0] / np.pi
    ours = first_points._LENGTH
    np.testing.assert_allclose(ours[middle], length[middle], rtol=1e-5)


@pytest.mark.parametrize("refine", [1.0, 2.0])
def test_the_first_points_are_as_near_as_the_waves_of_the_sum_ask_for(refine):
    c = 0.8
    t = points_of_one(c, 0.6, 0.0, refine)
    wave = math.pi / (4 * c + 1) / refine
    coarse = first_points._MAX_SPACING / refine
    nearness = np.maximum(np.diff(t) / coarse, -np.diff(np.exp(-t)) / wave)
    assert np.all(nearness <= 1 + 1e-9)
    assert np.median(nearness) > 0.5


def test_the_first_points_hold_every_resonance_and_both_its_sides():
    c = 8.0
    t = points_of_one(c, 0.6, 0.0, 2.0)
    velocities, widths = resonant_velocities(c, np.arange(4))
    held = 0
    for centre, width in zip(velocities, widths, strict=True):
        for v in (centre, centre - width / 2, centre + width / 2):
            if math.exp(t[0]) < v < math.exp(t[-1]):
                held += 1
                assert np.abs(t - math.log(v)).min() < 1e-12
    assert held >= 6


@pytest.mark.parametrize(
    ("c", "target", "shift", "low", "high"),
    [
        # pairs beside a resonance: of number 15 and 24, and at the foot of the third
        (32201.40274441094, 1.998349188874283, 2.0, 655.0, 666.0),
        (69195.2, 0.04626, 0.0, 850.0, 890.0),
        (378.3933383389198, 0.1564503721704097, 0.0, 33.5, 35.0),
    ],
)
def test_no_pair_of_velocities_beside_a_narrow_resonance_is_lost(c, target, shift, low, high):
    v = np.linspace(low, high, 20_001)
    g = np.abs(sums(v, np.full(v.size, c), 1e-13).value + shift) - target
    (changes,) = np.nonzero(g[1:] * g[:-1] < 0)
    found = all_velocities(np.array([c]), np.array([target]), shift == 2.0).v
    within = found[(found > low) & (found < high)]
    assert changes.size == within.size == 3
    assert np.all((v[changes] < within) & (within < v[changes + 1]))


def test_points_beside_a_resonance_are_as_far_apart_as_they_are_from_it():
    """The sides of the narrow resonances at large v, up to the distance of the other points."""
    c = 32201.4
    t = points_of_one(c, 1.99834919, 2.0, 1.0)
    centre, width = (float(x[0]) for x in resonant_velocities(c, np.array([15])))
    v = np.exp(t)
    spacing = centre**2 * math.pi / (4 * c)
    beside = np.sort(np.abs(v - centre))
    beside = beside[(beside > 0.5 * width) & (beside < spacing)]
    assert beside[0] == pytest.approx(width, rel=1e-6)
    assert np.max(beside[1:] / beside[:-1]) <= first_points._GRADING * (1 + 1e-6)
    assert spacing / beside[-1] <= first_points._GRADING


def test_the_number_of_a_resonance_is_that_of_its_velocity():
    number = np.array([0, 1, 12, 1000, 10**7])
    v, _ = resonant_velocities(3.0, number)
    assert resonance_number(v / 3.0) == pytest.approx(number, rel=1e-9, abs=1e-9)
    assert -0.1 < resonance_number(np.array([0.9]))[0] < 0.0  # above all of them
    assert -0.1 < resonance_number(np.array([50.0]))[0] < 0.0
