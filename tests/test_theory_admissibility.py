"""What the verdict on (47) is made of: the shape of either direction, the reach, the count."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from theory.cells.vdp import threshold_ratio
from theory.piecewise import admissibility, far_field
from theory.piecewise.admissibility import _Shape, check_admissible, check_fronts
from theory.piecewise.kinetic_relation import kinetic_relation, trace_kinetic_relation
from theory.piecewise.limits import pinning_coupling
from theory.piecewise.profile import (
    ProfileGrid,
    front_profile,
    front_profile_by_roots,
    points_of_profile,
    profile_slope,
    required_points,
    tail_bound,
)
from theory.piecewise.roots import labelled_roots
from theory.piecewise.steepest_descent import NearShape

V, C = 0.6, 1.5


def shape_of(v: float, c: float, extent: float, tolerance: float = 1e-12) -> _Shape:
    points, error = points_of_profile(abs(v), c, extent, tolerance)
    column = np.array([[abs(v)]]), np.array([[c]])
    return _Shape(ProfileGrid.of_points(*column, points, error), v < 0)


def values_of(shape: _Shape, zeta: np.ndarray) -> np.ndarray:
    return shape.with_slope(zeta, np.zeros(zeta.size, dtype=int))[0]


def by_roots(zeta: np.ndarray, retreating: bool) -> tuple[np.ndarray, float]:
    """The series over the roots; a retreating front is 1 - phi(-zeta)."""
    found = front_profile_by_roots(-zeta if retreating else zeta, V, C, count=2000)
    return (1.0 - found.phi if retreating else found.phi), found.error


@pytest.mark.parametrize("retreating", [False, True])
def test_the_shape_is_that_of_the_series_over_roots(retreating: bool) -> None:
    shape = shape_of(-V if retreating else V, C, 8.0)
    zeta = np.array([-3.4, -1.0, -0.3, 0.2, 1.0, 2.7])
    exact, error = by_roots(zeta, retreating)
    np.testing.assert_allclose(values_of(shape, zeta), exact, atol=2 * error)
    lattice, (phi,) = shape.on_lattice()
    assert (np.diff(lattice) == 0.125).all()  # eight points a site
    some, (part,) = shape.on_lattice((3, 2))
    assert some[0] <= -3.0
    assert some[-1] >= 2.0
    held = np.isin(lattice, some)
    assert held.sum() == some.size < lattice.size
    np.testing.assert_array_equal(part, phi[held])
    away = (abs(lattice) > 0.1) & (abs(lattice) < 3.0)  # at 0 the series has not converged
    assert away.sum() == 46
    exact, error = by_roots(lattice[away], retreating)
    np.testing.assert_allclose(phi[away], exact, atol=2 * error)


@pytest.mark.parametrize("retreating", [False, True])
def test_its_slope_is_that_of_central_differences(retreating: bool) -> None:
    shape = shape_of(-V if retreating else V, C, 8.0)
    zeta, step = np.array([-2.3, -0.6, 0.4, 1.7]), 1e-4
    phi, slope = shape.with_slope(zeta, np.zeros(4, dtype=int))
    # third derivatives are of order (c/v)^3 = 16: the differences err by 16 step^2 / 6
    difference = (values_of(shape, zeta + step) - values_of(shape, zeta - step)) / (2 * step)
    np.testing.assert_allclose(slope, difference, atol=1e-7)
    neighbours = values_of(shape, zeta + 1.0) + values_of(shape, zeta - 1.0)
    (together,) = shape.slope(zeta, phi[None], neighbours[None])
    np.testing.assert_allclose(together, slope, atol=1e-12)


def test_fronts_together_are_judged_as_each_by_itself() -> None:
    """Several of one number of points and of others, of either direction, and by roots."""
    fronts = [
        (branch.v, c, threshold_ratio(eta))
        for eta in (0.03125, 0.07, 0.11)
        for c in (0.4, 0.45, 0.8, 0.81, 0.82, 2.0, 5.0, 300.0)
        for branch in trace_kinetic_relation([c], [eta], False)[0].branches
    ]
    fronts.append((1e14, 1.0, 0.3))
    together = check_fronts(*np.array(fronts).T)
    assert together == [check_admissible(*front) for front in fronts]
    assert {verdict.admissible for verdict in together} == {True, False, None}


@pytest.mark.parametrize(("c", "eta"), [(0.5, 0.03125), (1.5, 0.05), (2.0, 0.11), (0.1, 1e-3)])
def test_it_is_proven_from_the_first_site_on_where_the_tail_is_small_enough(
    c: float, eta: float
) -> None:
    r = threshold_ratio(eta)
    for branch in kinetic_relation(c, eta).branches:
        verdict = check_admissible(branch.v, c, r)
        sides = [tail_bound(abs(branch.v), c, ahead=ahead) for ahead in (False, True)]
        if branch.v < 0:
            sides.reverse()
        # |phi - 1| below 1 - r leaves |phi| above r behind; ahead |phi| itself must be below r.
        for sites, (rate, size), room in zip(
            verdict.proven_beyond, sides, (1.0 - r, r), strict=True
        ):
            assert size * math.exp(-rate * sites) <= room * (1 + 1e-12)
            assert sites == 1.0 or size * math.exp(-rate * (sites - 1)) > room
        assert verdict.points >= 8 * sum(verdict.proven_beyond)


def test_every_value_of_the_profile_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    v = kinetic_relation(0.5, 0.03125).branches[-1].v
    counted = 0
    with_neighbours, on_lattice = ProfileGrid.with_neighbours, ProfileGrid.on_lattice

    def counting_neighbours(self, *arguments):
        nonlocal counted
        phi, both = with_neighbours(self, *arguments)
        counted += phi.size + 2 * both.size
        return phi, both

    def counting_on_lattice(self, *arguments):
        nonlocal counted
        zeta, phi = on_lattice(self, *arguments)
        counted += phi.size
        return zeta, phi

    monkeypatch.setattr(ProfileGrid, "with_neighbours", counting_neighbours)
    monkeypatch.setattr(ProfileGrid, "on_lattice", counting_on_lattice)
    verdict = check_admissible(v, 0.5, threshold_ratio(0.03125))
    assert verdict.points == counted > 0


def test_the_quadrature_reaches_every_point_that_is_looked_at(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    reach = []

    def noted(extent, *rest):
        reach.append(extent)
        return required_points(extent, *rest)

    monkeypatch.setattr(admissibility, "required_points", noted)
    for c, eta in ((0.5, 0.03125), (1.5, 0.05)):
        branch = kinetic_relation(c, eta).branches[-1]
        reach.clear()
        verdict = check_admissible(branch.v, c, threshold_ratio(eta))
        # slopes are taken up to the last site, from values a site farther on
        assert reach[0] >= max(verdict.proven_beyond) + 1.0


PATHS = [(8.1, 300.0), (5.39, 50.0), (60.0, 200.0), (0.9, 12.0), (0.05, 40.0), (0.01, 0.1)]
PATHS += [(13.5, 46.0), (13.6, 46.0), (500.0, 40.0), (66.0, 1100.0), (67.0, 1100.0)]
PATHS += [(-0.11, 300.0), (-30.0, 90.0)]
PATHS += [(214.66068838601907, 1000.0), (200.0 / (3.0 * math.pi), 100.0)]  # in resonance


@pytest.mark.parametrize(("v", "c"), PATHS)
def test_steepest_descent_is_the_quadrature_on_the_real_axis(v: float, c: float) -> None:
    zeta = np.geomspace(1e-6, 12.0, 60)
    zeta = np.concatenate([-zeta, [-3.0, -1.0, 0.0, 1.0, 2.0], zeta])
    shape = NearShape(v, c)
    phi, slope = shape.with_slope(zeta)
    exact = front_profile(math.copysign(1.0, v) * zeta, abs(v), c)
    expected = exact.phi if v > 0 else 1.0 - exact.phi
    # rounding of zeta is multiplied by the steepness, c/v at most
    error = np.abs(phi - expected) - 1e-15 * max(1.0, c / abs(v))
    assert np.all(error <= shape.error(zeta) + exact.error)
    assert np.all(shape.error(zeta) < 1e-12)
    around = [shape.with_slope(zeta + step)[0] for step in (1.0, -1.0)]
    np.testing.assert_allclose(
        slope,
        profile_slope(zeta, phi, sum(around), v, c),
        atol=1e-12 * (1.0 + c / abs(v)),
        rtol=0.0,
    )


@pytest.mark.parametrize(("v", "c"), PATHS)
def test_between_two_points_the_shape_goes_no_farther_than_its_bound(v: float, c: float) -> None:
    rng = np.random.default_rng(3)
    shape = NearShape(v, c)
    site = rng.integers(-4, 4, 400)
    here = rng.random(400)
    there = np.clip(here + rng.choice([-1, 1], 400) * 10 ** rng.uniform(-6, 0, 400), 0.0, 1.0)
    ends = np.sort(site + np.stack([here, there]), axis=0)
    inside = ends[0] + rng.random(400) * (ends[1] - ends[0])
    gone, bent = shape.spread(ends)
    values = [shape.with_slope(zeta)[0] for zeta in (*ends, inside)]
    for one, other in ((0, 1), (0, 2), (1, 2)):
        assert np.all(np.abs(values[one] - values[other]) <= gone + 1e-13)
    part = (inside - ends[0]) / np.maximum(ends[1] - ends[0], 1e-300)
    chord = values[0] + part * (values[1] - values[0])
    leaves = np.abs(values[2] - chord)
    assert np.all(leaves <= bent + 1e-13)
    assert np.median(np.abs(values[0] - values[1]) / gone) > 1e-3 * min(1.0, c / v**2)
    told = leaves > 1e-12
    assert np.median(leaves[told] / bent[told]) > 1e-4 * min(1.0, c / v**2)


def _in_resonance(n: int, c: float) -> float:
    """Return v whose saddle point sin k = -v/c has k + (2c/v) sin²(k/2) = 2πn."""

    def turns(v: float) -> float:
        k = math.pi + math.asin(v / c)
        return (k + 2.0 * c / v * math.sin(0.5 * k) ** 2) / (2.0 * math.pi)

    return float(brentq(lambda v: turns(v) - n, 2.0 * math.sqrt(c), c, xtol=1e-8, rtol=1e-15))


@pytest.mark.parametrize("n", [2, 5, 40])
@pytest.mark.parametrize("c", [1e7, 1e10])
def test_a_saddle_point_in_resonance_is_resolved(n: int, c: float) -> None:
    shape = NearShape(_in_resonance(n, c), c)
    zeta = np.array([-1.5, -0.3, 0.4, 1.7])
    assert np.all(shape.error(zeta) < 1e-12)
    phi, slope = shape.with_slope(zeta)
    around = shape.with_slope(zeta + 1.0)[0] + shape.with_slope(zeta - 1.0)[0]
    motion = profile_slope(zeta, phi, around, shape.v, c)
    np.testing.assert_allclose(slope, motion, atol=1e-12 * c / shape.v, rtol=0.0)


def test_both_ways_to_decide_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(8)
    c = np.exp(rng.uniform(math.log(0.7), math.log(150.0), 12))
    eta = np.exp(rng.uniform(math.log(1e-5), math.log(0.12), 12))
    verdicts = set()
    for c_, answer in zip(c.tolist(), trace_kinetic_relation(c, eta, False), strict=True):
        r = threshold_ratio(answer.eta)
        for branch in answer.branches[-2:]:
            found = []
            for longest in (1e9, 0.0):
                monkeypatch.setattr(admissibility, "_LONGEST_GRID", longest)
                found.append(check_admissible(branch.v, c_, r))
            one, other = found
            assert one.admissible is other.admissible is not None
            if one.fails_at is not None:
                assert other.fails_at == pytest.approx(one.fails_at, abs=0.25)
            verdicts.add(one.admissible)
    assert verdicts == {True, False}


@pytest.mark.parametrize(("c", "eta"), [(1e3, 0.03125), (2e3, 0.06), (1e3, 1e-4), (700.0, 0.11)])
def test_at_strong_coupling_the_verdict_is_that_of_eight_points_a_site(
    c: float, eta: float
) -> None:
    r = threshold_ratio(eta)
    (answer,) = trace_kinetic_relation([c], [eta], False)
    branch = answer.branches[-1]
    shape = shape_of(branch.v, c, 400.0, 1e-11)
    zeta, (phi,) = shape.on_lattice()
    near = abs(zeta) <= 300.0
    zeta, phi = zeta[near], phi[near]
    wrong = zeta[np.where(zeta < 0, abs(phi) < r - 1e-9, abs(phi) > r + 1e-9)]
    verdict = check_admissible(branch.v, c, r)
    assert verdict.admissible is not None
    if verdict.admissible:
        assert wrong.size == 0
    else:
        assert wrong.size
        assert abs(verdict.fails_at) <= abs(wrong).min() + 0.125
        (phi,) = values_of(shape, np.array([verdict.fails_at or 0.0]))
        assert verdict.fails_at == 0.0 or (abs(phi) - r) * verdict.fails_at > 0


@pytest.mark.parametrize("c", [1e4, 1e6])
def test_far_out_fronts_are_decided(c: float) -> None:
    (answer,) = trace_kinetic_relation([c], [0.03125])
    assert [branch.admissible for branch in answer.branches] == [True]


def test_a_small_threshold_is_resolved() -> None:
    c, eta = 1e8, 1e-12
    r = threshold_ratio(eta)
    (answer,) = trace_kinetic_relation([c], [eta], False)
    behind = -np.geomspace(2e-3, 0.8, 300)
    seen = 0
    for branch in answer.branches[::4]:
        shape = NearShape(branch.v, c)
        wrong = behind[np.abs(shape.with_slope(behind)[0]) < r - 2 * shape.error(behind)]
        if wrong.size:
            seen += 1
            verdict = check_admissible(branch.v, c, r)
            assert verdict.fails_at is not None
            assert abs(verdict.fails_at) <= abs(wrong).min() + 0.125
    assert seen >= 3


def test_a_velocity_out_of_range_is_left_undecided_with_a_reason() -> None:
    verdict = check_admissible(1e14, 1.0, 1e-15)
    assert verdict.admissible is None
    assert verdict.reason is not None
    assert "1e+12" in verdict.reason


def test_slow_fronts_at_strong_coupling_are_decided() -> None:
    """Their waves are short, c/v radians a site, and their margins thin, of order 1/√c."""
    for eta, times, expected in ((0.075, 1.01, True), (0.075, 1.5, False), (0.078, 1.5, False)):
        c = times * pinning_coupling(eta)
        r = threshold_ratio(eta)
        (branch,) = trace_kinetic_relation([c], [eta])[0].branches
        assert branch.admissible is expected
        zeta = np.geomspace(1e-7, 0.9, 120)
        zeta = np.concatenate([-zeta, zeta])
        size = np.abs(front_profile(zeta, branch.v, c).phi)
        seen = bool(np.any(np.where(zeta < 0, r - size, size - r) > 1e-9))
        assert seen is not expected


def test_a_front_whose_cells_are_too_many_is_left_undecided(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    c, eta = 11.5, 0.07
    v = kinetic_relation(c, eta).branches[0].v
    r = threshold_ratio(eta)
    plain = check_admissible(v, c, r)
    assert plain.admissible is not None
    monkeypatch.setattr(admissibility, "_LONGEST_GRID", 0)
    by_descent = check_admissible(v, c, r)
    assert by_descent.admissible is plain.admissible
    monkeypatch.setattr(admissibility._Descent, "max_values", 1)
    left = check_admissible(v, c, r)
    assert (left.admissible, left.fails_at) == (None, None)
    assert left.points < by_descent.points


def test_more_roots_than_are_found_leave_a_front_undecided_with_a_reason() -> None:
    verdict = check_admissible(1e-6, 1.0, 0.3)
    assert verdict.admissible is not None  # its tails are short: no root is asked for
    verdict = check_admissible(0.1, 1e10, 0.49)
    assert verdict.admissible is None
    assert verdict.reason is not None
    assert "c/v above 1e+10" in verdict.reason


@pytest.mark.parametrize(("v", "c"), [(5.0, 6.0), (0.06, 3e3), (44.0, 9e5), (700.0, 3e6)])
@pytest.mark.parametrize("upper", [False, True])
def test_what_stands_for_blocks_of_labels_bounds_the_sum_over_every_one(
    v: float, c: float, upper: bool
) -> None:
    side = far_field.FarField.make(v, c, upper, 0.0)
    last = max(24, math.ceil(c / v))
    k = labelled_roots(v, c, np.arange(-last, last + 1), upper).k
    size = 0.5 / np.abs(k * (v + c * np.sin(k)))
    for distance in (2.0, 5.0, 30.0, math.sqrt(c), c):
        every = size @ np.exp(-np.abs(k.imag) * distance)
        bound = np.abs(side.terms) @ np.exp(side.rates.real * distance)
        bound += side.size @ np.exp(side.decay * distance)
        # from label 48 on, blocks grow by 1/24 and terms may fall like its square: some 8 per cent
        assert (1.0 - 1e-12) * every <= bound <= 1.2 * every
    assert side.terms.size + side.size.size < 4000


def test_no_cell_has_a_site_within(monkeypatch: pytest.MonkeyPatch) -> None:
    sites: set[float] = set()
    spread = NearShape.spread

    def noted(self, ends):
        assert np.all(np.ceil(ends[1]) - np.floor(ends[0]) <= 1.0)
        sites.update(np.floor(ends[0]).tolist())
        return spread(self, ends)

    monkeypatch.setattr(NearShape, "spread", noted)
    (branch,) = trace_kinetic_relation([1.0], [0.03125], False)[0].branches
    for eta, times in ((0.078, 1.01), (0.078, 2.0), (0.0795, 1.01)):
        c = times * pinning_coupling(eta)
        (branch,) = trace_kinetic_relation([c], [eta], False)[0].branches
        assert check_admissible(branch.v, c, threshold_ratio(eta)).admissible is True
    assert sites >= {-2.0, -1.0, 0.0, 1.0}
    shape = admissibility._Descent(NearShape(branch.v, c))
    ends = np.array([[2.95, 3.2], [3.05, 3.3]])
    for sign in (1.0, -1.0):
        sites.clear()
        admissibility._along_stretches(shape, sign * ends, 0.45)
        assert sites == ({2.0, 3.0} if sign > 0 else {-4.0, -3.0})
