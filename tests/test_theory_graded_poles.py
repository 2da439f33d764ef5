"""What the rule on the graded contour owes to the roots beside it."""

import math

import numpy as np
import pytest

from theory.piecewise.roots import labelled_roots
from theory.piecewise.sums.graded_contour import _departing_poles, departing_labels, graded_rule

SCENES = [(0.8, 3.0), (0.4, 0.9), (1.5, 12.0), (0.25, 0.3)]
STEP = 0.5
"""Coarse, so that the corrections are far above rounding."""


def correction(v: float, c: float) -> complex:
    return complex(_departing_poles(np.array([v]), np.array([c])).correction(STEP)[0])


@pytest.mark.parametrize(("v", "c"), SCENES)
def test_the_slopes_of_the_correction_are_its_differences(v: float, c: float) -> None:
    slopes = _departing_poles(np.array([v]), np.array([c])).correction_slopes(STEP)[:, 0]
    h = 1e-5  # third derivatives are of order 2 pi / STEP cubed: 2000 h^2 = 2e-7
    by_v = (correction(v + h * v, c) - correction(v - h * v, c)) / (2 * h * v)
    by_c = (correction(v, c + h * c) - correction(v, c - h * c)) / (2 * h * c)
    assert abs(correction(v, c)) > 1e-7
    assert slopes[0] == pytest.approx(by_v, rel=1e-5)
    assert slopes[1] == pytest.approx(by_c, rel=1e-5)


@pytest.mark.parametrize("v", [0.5, 0.8, 2.0])
@pytest.mark.parametrize("n", [-5, -17])
def test_the_labels_are_those_whose_root_passes_the_middle_of_its_strip(v: float, n: int) -> None:
    # Fact 4: the root of strip n passes Re k = (2n + 1) pi where v (2|n| - 1) pi equals
    c = v * (2 * abs(n) - 1) * math.pi / (1 + math.cosh(0.5 / v))
    root = labelled_roots(v, c, np.array([n]), upper=False).k[0]
    assert root.real == pytest.approx((2 * n + 1) * math.pi, rel=1e-12)
    assert departing_labels(np.array([v]), np.array([c])).tolist() == [[n - 1, n, n + 1]]


def test_near_the_axis_the_labels_are_the_first_three_and_far_off_they_are_still_whole() -> None:
    few = departing_labels(np.array([1.0, 1e-3]), np.array([1e-6, 1.0]))
    assert few[0].tolist() == [-3, -2, -1]
    assert few[1, 1] == -(10**12)


@pytest.mark.parametrize("v", [0.3, 5.0])
def test_the_ends_that_are_left_out_are_bounded_by_what_is_stated(v: float) -> None:
    c = 2.0
    rule = graded_rule(np.array([v]), np.array([c]), 1e-9)
    assert rule.discretisation == pytest.approx(math.exp(-(math.pi**2) / (2 * rule.step)), abs=0)
    total = 0.0
    for count, size in ((rule.left, 1.0), (rule.right, math.hypot(1.0, 4 * c))):
        reach = math.exp(-count * rule.step)
        y = math.sqrt(2) * reach
        # |S| <= coth((1/2 - v y)/2v) over 2|A|, times the integral of sech, 2 e^{-R}, over pi.
        total += 2 / math.pi * reach / (math.tanh((0.5 - v * y) / (2 * v)) * size)
    bound = rule.ends(np.array([v]), np.array([c]))[0]
    assert total <= bound <= 1.01 * total


@pytest.mark.parametrize(("v", "c"), [(0.8, 3.0), (20.0, 30.0), (159.8, 214.9)])
def test_what_the_rounding_of_a_root_does_is_charged(v: float, c: float) -> None:
    step = 0.1
    poles = _departing_poles(np.array([v]), np.array([c]))
    points = step * np.arange(-20_000, 20_001)
    charged = 0.0
    for k in poles.k[0]:
        slope = -1j * (v + c * np.sin(k))
        sigma = np.log(np.tan(-k / 2)) - 0.25j * math.pi
        weight = abs(1 / np.expm1(-2j * math.pi * sigma / step))
        # rounding of v k over the slope of L moves the root; the integrand has a pole
        # t/(sigma - sigma_p), the correction t times the weight
        moved = 16 * np.finfo(float).eps * abs(k) * (1 + v / abs(slope))
        integrand = np.sum(step / abs(points - sigma) ** 2)
        correction = 2 * math.pi / step * weight * (1 + weight)
        through_sigma = (integrand + correction) / abs(np.sin(k))
        charged += moved / abs(k * slope) * (through_sigma + weight * c / abs(slope))
    ours = poles.uncertainty(step)[0]
    assert ours == pytest.approx(charged, rel=0.02, abs=0)
