"""What the verdict on (47) is made of: the shape of either direction, the reach, the count."""

import math

import numpy as np
import pytest

from theory.cells.vdp import threshold_ratio
from theory.piecewise.admissibility import _Shape, check_admissible
from theory.piecewise.kinetic_relation import kinetic_relation
from theory.piecewise.profile import ProfileGrid, front_profile_by_roots, tail_bound

V, C = 0.6, 1.5


def shape_of(retreating: bool) -> _Shape:
    return _Shape(ProfileGrid.make(V, C, 8.0, 1e-12), retreating)


def by_roots(zeta: np.ndarray, retreating: bool) -> tuple[np.ndarray, float]:
    """The series over the roots; a retreating front is 1 - phi(-zeta)."""
    found = front_profile_by_roots(-zeta if retreating else zeta, V, C)
    return (1.0 - found.phi if retreating else found.phi), found.error


@pytest.mark.parametrize("retreating", [False, True])
def test_the_shape_is_that_of_the_series_over_roots(retreating: bool) -> None:
    shape = shape_of(retreating)
    zeta = np.array([-3.4, -1.0, -0.3, 0.2, 1.0, 2.7])
    exact, error = by_roots(zeta, retreating)
    np.testing.assert_allclose(shape.at(zeta), exact, atol=2 * error)
    lattice, phi = shape.sampled(2.0, 3.0)
    np.testing.assert_allclose(lattice, np.arange(-16, 25) / 8)  # eight points a site
    away = abs(lattice) > 0.1  # at 0 the series has not converged
    exact, error = by_roots(lattice[away], retreating)
    np.testing.assert_allclose(phi[away], exact, atol=2 * error)


@pytest.mark.parametrize("retreating", [False, True])
def test_its_slope_is_that_of_central_differences(retreating: bool) -> None:
    shape = shape_of(retreating)
    zeta, step = np.array([-2.3, -0.6, 0.4, 1.7]), 1e-4
    neighbours = shape.at(zeta + 1.0) + shape.at(zeta - 1.0)
    slope = shape.slope(zeta, shape.at(zeta), neighbours)
    # third derivatives are of order (c/v)^3 = 16: the differences err by 16 step^2 / 6
    difference = (shape.at(zeta + step) - shape.at(zeta - step)) / (2 * step)
    np.testing.assert_allclose(slope, difference, atol=1e-7)


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
        assert verdict.points >= 8 * ProfileGrid.make(abs(branch.v), c, 3.0, 1e-9).points


def test_every_value_of_the_profile_is_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    v = kinetic_relation(0.5, 0.03125).branches[-1].v
    counted = 0
    at, on_lattice = ProfileGrid.at, ProfileGrid.on_lattice

    def counting_at(self, *arguments):
        nonlocal counted
        phi = at(self, *arguments)
        counted += phi.size
        return phi

    def counting_on_lattice(self, per_site):
        nonlocal counted
        counted += per_site * self.points
        return on_lattice(self, per_site)

    monkeypatch.setattr(ProfileGrid, "at", counting_at)
    monkeypatch.setattr(ProfileGrid, "on_lattice", counting_on_lattice)
    verdict = check_admissible(v, 0.5, threshold_ratio(0.03125))
    assert verdict.points == counted > 0


def test_the_quadrature_reaches_every_point_that_is_looked_at(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    make, reach = ProfileGrid.make.__func__, []

    def noted(cls, v, c, extent, tolerance):
        reach.append(extent)
        return make(cls, v, c, extent, tolerance)

    monkeypatch.setattr(ProfileGrid, "make", classmethod(noted))
    for c, eta in ((0.5, 0.03125), (1.5, 0.05)):
        branch = kinetic_relation(c, eta).branches[-1]
        reach.clear()
        verdict = check_admissible(branch.v, c, threshold_ratio(eta))
        # slopes are taken up to the last site, from values a site farther on
        assert reach[0] >= max(verdict.proven_beyond) + 1.0
