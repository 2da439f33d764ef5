"""The profile of the front, and its admissibility."""

from __future__ import annotations

import math

import numpy as np
import pytest

from theory.admissibility import check_admissible
from theory.front_profile import front_profile, front_profile_by_roots, tail_bound
from theory.kinetic_relation import kinetic_relation
from theory.sum_bessel import sum_by_bessel
from theory.unit_cell import threshold_ratio

SCENES = [(0.3, 0.5), (1.0, 1.0), (0.05, 0.5), (3.0, 0.1), (1.0, 3.0), (7.4, 100.0), (50.0, 0.02)]


@pytest.mark.parametrize(("v", "c"), SCENES)
def test_the_integral_agrees_with_the_printed_series(v: float, c: float) -> None:
    rng = np.random.default_rng(5)
    zeta = rng.uniform(-9, 9, 60)
    integral, series = front_profile(zeta, v, c), front_profile_by_roots(zeta, v, c, 2000)
    assert np.max(np.abs(integral.phi - series.phi)) <= integral.error + series.error


@pytest.mark.parametrize(("v", "c"), SCENES)
def test_the_profile_is_continuous_at_the_front(v: float, c: float) -> None:
    step = 1e-7 * min(1.0, v)
    left, here, right = front_profile([-step, 0.0, step], v, c, 1e-13).phi
    steepest = (1.0 + 2.0 * c) / v  # from (48)
    assert abs(left - here) <= 2 * steepest * step
    assert abs(right - here) <= 2 * steepest * step


@pytest.mark.parametrize(("v", "c"), [scene for scene in SCENES if scene[1] < 10])
def test_the_value_at_the_front_is_minus_half_the_sum(v: float, c: float) -> None:
    here = front_profile([0.0], v, c)
    oracle = sum_by_bessel(v, c)
    assert abs(here.phi[0] + 0.5 * oracle.value) <= here.error + oracle.error


@pytest.mark.parametrize(("v", "c"), SCENES)
def test_the_advance_delay_equation_holds_in_integrated_form(v: float, c: float) -> None:
    """Integrate (48) over [a, b] by Gauss–Legendre between the kinks, at whole ζ."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    for a, b in ((-2.0, -1.0), (-1.0, 0.0), (0.0, 1.0), (2.0, 3.0)):
        pieces = max(1, math.ceil((1.0 + c) / v / 4.0))
        edges = np.linspace(a, b, pieces + 1)
        half = 0.5 * np.diff(edges)[:, None]
        zeta = (0.5 * (edges[1:] + edges[:-1])[:, None] + half * nodes).ravel()
        weight = (half * weights).ravel()
        phi, ahead, behind = (front_profile(zeta + d, v, c).phi for d in (0.0, 1.0, -1.0))
        source = 0.5 if b <= 0 else 0.0
        rate = 0.5 * phi - 0.5j * c * (2 * phi - ahead - behind) - source
        ends = front_profile([a, b], v, c).phi
        # 1e-10: an analytic piece with 40 nodes, and profile errors below 1e-12 (1 + c)
        assert abs(v * (ends[1] - ends[0]) - np.sum(weight * rate)) < 1e-10 * (1 + c)


@pytest.mark.parametrize(("v", "c"), SCENES)
def test_the_tails_stay_within_their_bound(v: float, c: float) -> None:
    for ahead in (True, False):
        rate, size = tail_bound(v, c, ahead)
        zeta = np.linspace(0.0, 12.0 / rate, 400) * (1 if ahead else -1)
        found = front_profile(zeta, v, c)
        distance = np.abs(found.phi - (0.0 if ahead else 1.0))
        assert np.all(distance <= size * np.exp(-rate * np.abs(zeta)) + found.error)


@pytest.mark.parametrize(
    ("c", "eta"),
    [
        (0.5, 0.03125),
        (0.45, 0.03125),
        (0.46, 0.03125),
        (0.3, 0.01),
        (1.0, 0.03125),
        (3.0, 0.03125),
        (10.0, 0.03125),
        (30.0, 0.03125),
        (10.0, 1e-3),
        (0.3, 1e-4),
        (5.0, 0.005),
        (20.0, 0.02),
        (2.0, 0.11),
        (5.0, 0.1),
    ],
)
def test_admissibility_agrees_with_dense_sampling(c: float, eta: float) -> None:
    r = threshold_ratio(eta)
    for branch in kinetic_relation(c, eta).branches:
        verdict = check_admissible(branch.v, c, r)
        near = np.geomspace(1e-9, 1e-2, 60)
        reach = [min(end, 40.0) for end in verdict.proven_beyond]
        zeta = np.concatenate([-near, near, np.linspace(-reach[0], reach[1], 6001)])
        if branch.v > 0:
            size = np.abs(front_profile(zeta, branch.v, c).phi)
        else:
            size = np.abs(1.0 - front_profile(-zeta, -branch.v, c).phi)
        # closer than 1e-11 to the threshold neither method can tell
        wrong = np.where(zeta < 0, size < r - 1e-11, size > r + 1e-11) & (zeta != 0)
        assert verdict.admissible == (not wrong.any()), (c, eta, branch.v)
        if wrong.any():
            assert verdict.fails_at is not None
            nearest = np.min(np.abs(zeta[wrong]))
            # reported to within an eighth of a site
            assert abs(abs(verdict.fails_at) - nearest) <= 0.13


def test_an_empty_or_bad_position_is_handled() -> None:
    assert front_profile([], 0.3, 0.5).phi.size == 0
    with pytest.raises(ValueError, match="position zeta"):
        front_profile([math.nan], 0.3, 0.5)
