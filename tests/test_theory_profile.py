"""Claims about the shape of the front (Eqs. 47-49)."""

from __future__ import annotations

import math

import numpy as np
import pytest

from theory.cells.vdp import threshold_ratio
from theory.parameters import ParameterError
from theory.piecewise.kinetic_relation import trace_kinetic_relation
from theory.piecewise.profile import (
    ProfileGrid,
    front_profile,
    front_profile_by_roots,
    tail_bound,
)
from theory.piecewise.sums.result import PrecisionError
from theory.piecewise.sums.series import sum_by_roots

FRONTS = [(0.3, 0.5), (0.05, 0.4), (1.0, 1.0), (3.0, 0.2), (2.0, 10.0)]
ETA = 0.03125


@pytest.mark.parametrize(("v", "c"), FRONTS)
def test_the_integral_is_the_series_over_roots(v: float, c: float) -> None:
    zeta = np.array([-7.3, -2.0, -0.9, -0.4, 0.3, 1.0, 1.7, 5.25])
    integral, series = front_profile(zeta, v, c), front_profile_by_roots(zeta, v, c, count=2000)
    # the exponential factor of the roots' imaginary parts makes the series converge off ζ = 0
    assert np.max(np.abs(integral.phi - series.phi)) <= integral.error + series.error
    assert integral.error < 2e-12


@pytest.mark.parametrize(("v", "c"), [*FRONTS, (1e-12, 1e-3), (1e-5, 0.5), (900.0, 1e-3)])
def test_positions_equally_far_before_a_site_are_those_one_by_one(v: float, c: float) -> None:
    """Their roundings differ, which over a small v counts: there they are a third of v away."""
    grid = ProfileGrid.make(v, c, 5.0, 1e-12)
    for zeta in (np.linspace(-4.0, 4.0, 25), np.arange(-4.0, 4.0) - min(v, 1.0) / 3.0):
        together = front_profile(zeta, v, c)
        one_by_one = np.array([grid.at(np.array([each]))[0] for each in zeta])
        assert np.max(np.abs(together.phi - one_by_one)) <= together.error


@pytest.mark.parametrize(("v", "c"), FRONTS)
def test_the_front_is_continuous_and_its_value_at_zero_is_half_of_sigma(v: float, c: float) -> None:
    h = 1e-9
    shape = front_profile([-h, 0.0, h], v, c)
    assert abs(shape.phi[1] + 0.5 * sum_by_roots(v, c).value) < 2e-12
    # |v φ'| ≤ ½|φ| + ½ + (c/2)(2|φ| + …) < 1 + 4c for |φ| < 2
    assert np.max(np.abs(np.diff(shape.phi))) < h * (1 + 4 * c) * 2 / v + 4e-12


@pytest.mark.parametrize(("v", "c"), FRONTS)
def test_the_tails_are_bounded_and_tend_to_the_two_states(v: float, c: float) -> None:
    for ahead, limit in ((True, 0.0), (False, 1.0)):
        rate, size = tail_bound(v, c, ahead)
        distance = np.linspace(0.1, 12 / rate, 60)
        phi = front_profile(distance if ahead else -distance, v, c).phi
        assert np.all(np.abs(phi - limit) <= size * np.exp(-rate * distance) + 2e-12)
        far = 32.0 / rate
        end = front_profile([far if ahead else -far], v, c).phi[0]
        assert abs(end - limit) < 1e-10


@pytest.mark.parametrize(("v", "c"), FRONTS)
def test_the_advance_delay_equation_holds_between_any_two_points(v: float, c: float) -> None:
    """Eq. (48), integrated by Gauss-Legendre over pieces that avoid the kinks at whole ζ."""
    node, weight = np.polynomial.legendre.leggauss(30)
    for low, high in ((-2.9, -2.1), (-1.0, -0.5), (-0.5, 0.0), (0.0, 0.5), (0.2, 0.9), (1.1, 1.8)):
        z = 0.5 * (low + high) + 0.5 * (high - low) * node
        here, ahead, behind = (front_profile(z + shift, v, c).phi for shift in (0.0, 1.0, -1.0))
        theta = 1.0 if high <= 0 else 0.0
        rate = 0.5 * here - 0.5 * theta - 0.5j * c * (2 * here - ahead - behind)
        change = front_profile([high], v, c).phi[0] - front_profile([low], v, c).phi[0]
        # error of φ times (1 + 2c), and of 30 nodes on e^{a f}, |a| ≤ 20 / 0.3
        total = 0.5 * (high - low) * np.sum(weight * rate)
        assert abs(v * change - total) < 1e-10 * (1 + c)


def brute_force(v: float, c: float, r: float) -> float | None:
    """Return the smallest |ζ| at which (47) fails, by 200 points a site up to 40 sites."""
    zeta = np.concatenate([-np.arange(1, 8000)[::-1], np.arange(1, 8000)]) / 200 + 0.0
    phi = front_profile(-zeta if v < 0 else zeta, abs(v), c, 1e-10).phi
    size = np.abs(1 - phi if v < 0 else phi)
    wrong = zeta[np.where(zeta < 0, size < r - 1e-9, size > r + 1e-9)]
    return float(wrong[np.argmin(np.abs(wrong))]) if wrong.size else None


CASES = [(c, ETA) for c in (0.435, 0.45, 0.5, 0.8, 1.5, 3.0, 10.0)]
CASES += [(0.3, 0.01), (1.5, 0.05), (2.0, 0.01), (5.0, 0.06), (2.0, 0.11), (0.1, 1e-3)]


@pytest.mark.parametrize(("c", "eta"), CASES)
def test_the_verdict_on_admissibility_is_that_of_dense_sampling(c: float, eta: float) -> None:
    r = threshold_ratio(eta)
    (answer,) = trace_kinetic_relation([c], [eta])
    assert answer.branches
    for branch in answer.branches:
        fails_at = brute_force(branch.v, c, r)
        assert branch.admissible is (fails_at is None)
        if fails_at is not None:
            # to within an eighth of a site, as documented, and a sample
            assert abs(branch.fails_at - fails_at) < 0.14


def test_known_failures_are_found_where_they_are() -> None:
    (ten,) = trace_kinetic_relation([10.0], [ETA])
    assert any(b.fails_at is not None and b.fails_at > 0 for b in ten.branches)
    (slow, fast) = trace_kinetic_relation([0.45], [ETA])[0].branches
    assert (slow.admissible, slow.fails_at) == (False, 0.0)
    assert fast.admissible is True


def test_a_profile_too_long_to_follow_is_refused() -> None:
    with pytest.raises(PrecisionError):
        front_profile([0.0], 1e6, 1e6)


def test_bad_positions_are_refused() -> None:
    for bad in (math.nan, math.inf):
        with pytest.raises(ParameterError, match="zeta"):
            front_profile([0.0, bad], 0.3, 0.5)
    with pytest.raises(ParameterError):
        front_profile([0.0], 0.3, -0.5)
    assert front_profile([], 0.3, 0.5).phi.size == 0
