"""How many points the rules of quadrature take, how far they reach, what they say was added up."""

import math

import numpy as np
import pytest

from theory.piecewise.profile import ProfileGrid, _smooth_number, front_profile
from theory.piecewise.roots import labelled_roots
from theory.piecewise.sums.graded_contour import departing_labels, graded_rule, graded_sum
from theory.piecewise.sums.result import PrecisionError


@pytest.mark.parametrize("extent", [60.0, 200.0])
def test_the_lattice_of_the_profile_is_centred_and_holds_the_extent(extent: float) -> None:
    grid = ProfileGrid.make(0.3, 0.01, extent, 0.1)
    zeta, phi = grid.on_lattice(2)
    assert zeta[0] == -(grid.points // 2)
    assert zeta[-1] == grid.points // 2 - 0.5
    assert zeta[0] <= -extent
    assert zeta[-1] >= extent
    # the middle of the front, where phi falls from 1 to 0, is at 0
    assert abs(phi[zeta == -40.0] - 1) < 1e-6
    assert abs(phi[zeta == 40.0]) < 1e-6


def test_the_points_of_the_profile_are_the_fewest_of_their_kind() -> None:
    def kind(n: int) -> bool:
        twos = n & -n
        return n % 2 == 0 and n // twos in (1, 3, 5, 9, 15)

    for least in range(8, 600):
        fewest = next(n for n in range(least, 4 * least) if kind(n))
        assert _smooth_number(least) == fewest


def test_a_profile_of_more_than_two_million_points_is_refused() -> None:
    with pytest.raises(PrecisionError, match="more than 2097152"):
        front_profile([2.5e6], 0.3, 0.5)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-9, 1e-14])
@pytest.mark.parametrize("v", [1.0, 4.0, 20.0, 90.0, 400.0])
def test_the_reach_is_what_the_tolerance_asks_for(v: float, tolerance: float) -> None:
    c = 2.0
    rule = graded_rule(np.array([v]), np.array([c]), tolerance)

    def left_out(reach: float) -> float:
        # |S| <= coth((1/2 - v y)/2v), y = sqrt 2 e^{-R}, times the integral of sech over pi
        y = math.sqrt(2) * math.exp(-reach)
        return 0.64 * math.exp(-reach) / math.tanh((0.5 - v * y) / (2 * v))

    # A sixth of the tolerance is meant for an end; it lies on the next fourth step.
    reach = rule.left * rule.step
    assert left_out(reach) <= 0.17 * tolerance
    assert left_out(reach - 4 * rule.step) >= 0.15 * tolerance


@pytest.mark.parametrize(("v", "c"), [(0.8, 3.0), (0.4, 0.9), (20.0, 30.0)])
def test_the_points_and_the_size_stated_are_those_of_the_sum(v: float, c: float) -> None:
    tolerance = 1e-8
    found = graded_sum(np.array([v]), np.array([c]), tolerance, slopes=False)
    rule = graded_rule(np.array([v]), np.array([c]), tolerance)
    sigma = rule.step * np.arange(-rule.left, rule.right + 1)
    assert found.points == sigma.size
    # dk = 2 dT/(1 + T^2) with T = tan(k/2) = e^{sigma + i pi/4}, both halves of the period
    T = np.exp(sigma + 0.25j * np.pi)
    k = 2 * np.arctan(T)
    A = 0.5 - 1j * c * (1 - np.cos(k))
    a = A / v
    with np.errstate(over="ignore", invalid="ignore"):
        kernel = np.sinh(a) / (np.cosh(a) - np.cos(k)) / (2 * A)
    added = np.abs(kernel * 2 * T / (1 + T * T)) * rule.step / np.pi
    labels = departing_labels(np.array([v]), np.array([c]))[0]
    poles = labelled_roots(v, c, labels, upper=False).k
    terms = np.abs(1 / (poles * (v + c * np.sin(poles))))
    assert terms.sum() > 0.01 * added.sum()
    assert found.size[0] == pytest.approx(added.sum() + terms.sum(), rel=1e-6)
