"""Claims about bounds and corrections that only hard cases put to the test."""

from __future__ import annotations

import itertools
import math

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import jv

from fronts.piecewise.kinetic_relation import kinetic_relation
from theory.cells.vdp import threshold_ratio
from theory.parameters import ParameterError
from theory.piecewise.branch_search import all_velocities
from theory.piecewise.first_points import first_points
from theory.piecewise.folds import fold_coupling
from theory.piecewise.profile import ProfileGrid, front_profile, tail_bound
from theory.piecewise.sums.integral import sums
from theory.piecewise.sums.precise import precise_sum_by_integral
from theory.piecewise.sums.series import sum_by_roots

FRONTS = [(0.3, 0.5), (1.0, 1.0), (0.05, 0.5), (3.0, 0.1), (1.0, 3.0), (7.4, 100.0), (50.0, 0.02)]


def printed(k: np.ndarray, v: float, c: float) -> np.ndarray:
    """Return L(k) of Eq. (50) as printed."""
    return -1j * v * k - 2j * c * np.sin(k / 2) ** 2 + 0.5


def profile_in_time(zeta: float, v: float, c: float) -> complex:
    """φ(ζ)/φ_s as what the sites already crossed have fed into the linear chain.

    ½ Σ_{m > ζ} (-i)^|m| ∫₀^{(m - ζ)/v} e^{-s/2 + ics} J_|m|(cs) ds, no transform and no roots. The
    integrals stop at s = 70, where e^{-s/2} = 6e-16; orders 30 past 70c add nothing there.
    """
    node, weight = np.polynomial.legendre.leggauss(200)
    total = 0j
    for m in range(math.floor(zeta) + 1, math.ceil(70 * c) + 30):
        end = min((m - zeta) / v, 70.0)
        s = 0.5 * end * (node + 1)
        waves = np.exp((-0.5 + 1j * c) * s) * jv(abs(m), c * s)
        total += (-1j) ** (abs(m) % 4) * 0.5 * end * np.sum(weight * waves)
    return 0.5 * total


def exact_profile(zeta: float, v: float, c: float, points: int) -> mp.mpc:
    """Return φ(ζ)/φ_s by the closed integral, k halfway between multiples of 2π/points."""
    with mp.workdps(40):
        v_, c_ = mp.mpf(v), mp.mpf(c)
        m = mp.floor(zeta)
        f = mp.mpf(zeta) - m
        total = mp.mpc(0)
        for j in range(points):
            k = 2 * mp.pi * (j + mp.mpf("0.5")) / points
            u = mp.expj(k)
            A = mp.mpf("0.5") - 1j * c_ * (1 - u.real)
            late = mp.exp(A * f / v_) / (1 - mp.exp(A / v_) / u)
            total += u**m / A * (1 / (1 - 1 / u) - late)
        return mp.mpf("0.5") - total / (2 * points)


@pytest.mark.parametrize(
    ("v", "c"),
    [
        pytest.param(159.82338529816317, 214.92354611211903, id="a pole has crossed"),
        pytest.param(7.0562693897135915, 10.802444936499525, id="a pole is touched"),
        pytest.param(160.3, 214.92354611211903, id="a pole is about to cross"),
    ],
)
def test_derivatives_hold_where_a_pole_of_the_contour_is_corrected(v: float, c: float) -> None:
    found = sums(v, c, 1e-14, slopes=True)
    assert found.by_v is not None
    assert found.by_c is not None
    for slope, dv, dc in ((found.by_v, v, 0.0), (found.by_c, 0.0, c)):
        h = 1e-7
        ends = [sum_by_roots(v + s * h * dv, c + s * h * dc, 30).value for s in (1, -1)]
        with mp.workdps(40):
            steps = (mp.mpf(v + h * dv) - mp.mpf(v - h * dv)) + (
                mp.mpf(c + h * dc) - mp.mpf(c - h * dc)
            )
            difference = complex((ends[0] - ends[1]) / steps)
        # second order: h² times the cube of the peaks' sharpness, v over width ≤ 500, is 1e-9;
        # where the contour touches a pole the rounding bound of the value itself is 1e-13 · 2π/h
        assert abs(complex(slope) - difference) < 1e-7 * (abs(difference) + 1 / (v + c))


@pytest.mark.parametrize(("v", "c"), FRONTS)
@pytest.mark.parametrize("ahead", [True, False])
def test_the_tail_constant_exceeds_the_integral_it_bounds(v: float, c: float, ahead: bool) -> None:
    rate, size = tail_bound(v, c, ahead)
    shift = 1j * rate if ahead else -1j * rate

    def modulus(x: float) -> float:
        k = np.asarray(x + shift)
        return float(1 / abs(k * printed(k, v, c)))

    # by octaves, so that the peak at 0 and the oscillations of |L| are both resolved
    edges = [0.0, *np.geomspace(0.1 * rate, 400.0, 60)]
    half = [
        sum(quad(modulus, s * a, s * b, limit=200)[0] for s in (1, -1))
        for a, b in itertools.pairwise(edges)
    ]
    assert sum(half) / (4 * math.pi) <= size
    # there is no root between the axis and the line, so |φ - limit| decays at this rate
    line = np.linspace(-400, 400, 400_001) + shift
    assert np.min(printed(line, v, c).real) > 0


def test_the_error_of_the_profile_holds_at_every_tolerance_and_distance() -> None:
    seed = 21
    rng = np.random.default_rng(seed)
    for trial in range(16):
        v, c = np.exp(rng.uniform(np.log(0.04), np.log(4.0), 2)).tolist()
        zeta, tolerance = float(rng.uniform(-6, 6)), float(10 ** rng.uniform(-14, -1))
        exact = exact_profile(zeta, v, c, 60 + math.ceil(85 * (v + c)))  # to 1e-20
        far = [zeta, float(rng.uniform(-25, 25))]
        for where in ([zeta], far):
            found = front_profile(where, v, c, tolerance)
            off = float(abs(found.phi[0] - exact))
            assert off <= found.error, f"seed {seed}, trial {trial}: v = {v!r}, c = {c!r}"
            # what was asked for, plus rounding of a few hundred terms
            assert found.error <= tolerance + 1e-11, f"seed {seed}, trial {trial}"


@pytest.mark.parametrize(
    ("v", "c", "tolerance", "extent"),
    [(0.31, 1.44e-3, 0.075, 3), (0.378, 3.66e-3, 0.0896, 2), (0.559, 2.53e-3, 0.0723, 2)],
)
def test_the_truncation_of_the_profile_is_within_a_hundred_of_its_bound(
    v: float, c: float, tolerance: float, extent: int
) -> None:
    """Where coupling is weak and points are few: a hundredth of the bound would be wrong."""
    grid = ProfileGrid.make(v, c, float(extent), tolerance)
    zeta = np.arange(-extent, extent + 1.0)[:, None] + np.array([0.0, 0.5, 0.999])
    exact = [complex(exact_profile(each, v, c, 60)) for each in zeta.ravel().tolist()]
    off = float(np.abs(grid.at(zeta.ravel()) - exact).max())
    assert 0.01 * grid.error < off <= grid.error


@pytest.mark.parametrize(
    ("v", "c", "digits", "method"),
    [
        pytest.param(0.27897857, 0.00038978, 3, "integral", id="points on the axis"),
        pytest.param(0.083398, 0.0451136, 4, "integral", id="points on the axis, more coupling"),
        pytest.param(2.013796, 8.003987, 3, "integral", id="graded points"),
        pytest.param(0.0015, 0.00276, 142, "static limit", id="limit of slow fronts"),
    ],
)
def test_the_error_of_many_digits_is_within_a_hundred_of_its_bound(
    v: float, c: float, digits: int, method: str
) -> None:
    found = precise_sum_by_integral(v, c, digits)
    assert found.method == method
    # the series, and where it would need too many roots the integral that the limit saved
    better = sum_by_roots(v, c, 40) if digits < 40 else precise_sum_by_integral(v, c, 170)
    assert better.method != method or digits < 40
    with mp.workdps(200):
        off = abs(found.value - better.value)
        assert 0.01 * found.error < off <= found.error


@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (1.0, 1.0), (3.0, 0.1), (0.4, 2.0)])
def test_the_profile_is_the_one_built_up_in_time(v: float, c: float) -> None:
    zeta = np.array([-3.3, -0.45, 0.0, 0.3, 2.0])
    found = front_profile(zeta, v, c)
    for position, phi in zip(zeta.tolist(), found.phi, strict=True):
        # 1e-12: some hundred Bessel integrals, each good to 1e-15 of its size, below 2
        assert abs(phi - profile_in_time(position, v, c)) < found.error + 1e-12


@pytest.mark.parametrize("v", [1e-10, 1e-5, 1e-3])
@pytest.mark.parametrize("part", [1e-6, 0.3, 3.0])
def test_just_behind_the_threshold_a_slow_front_is_right_to_its_error(
    v: float, part: float
) -> None:
    """The distance to the next site, not the one from the last, sets the rounding over v."""
    zeta = -part * v
    found = front_profile([zeta], v, 1e-3)
    assert abs(found.phi[0] - profile_in_time(zeta, v, 1e-3)) < 1e-14 + 1e-3 * found.error


@pytest.mark.parametrize(("v", "c"), FRONTS)
def test_the_profile_joins_at_whole_sites_and_reaches_its_limits(v: float, c: float) -> None:
    grid = ProfileGrid.make(v, c, 9.0, 1e-12)
    m = np.arange(-7.0, 7.0)
    right_end, left_end = grid.between(m, np.zeros(14)), grid.between(m + 1, np.ones(14))
    # both sides of a site are one number but for the error of each
    assert np.max(np.abs(right_end - left_end)) <= 2 * grid.error
    zeta, phi = grid.on_lattice(4)
    inner = np.abs(zeta) < 7
    # the transform and the plain sum add up the same terms
    plain = front_profile(zeta[inner], v, c)
    assert np.max(np.abs(phi[inner] - plain.phi)) <= grid.error + plain.error
    for ahead, limit in ((True, 0.0), (False, 1.0)):
        rate, size = tail_bound(v, c, ahead)
        far = math.log(size / 1e-10) / rate * (1 if ahead else -1)
        found = front_profile([far], v, c)
        assert abs(found.phi[0] - limit) < 1.01e-10 + found.error


@pytest.mark.parametrize(("c", "eta"), [(2.0, 0.11), (0.5, 0.12), (20.0, 0.09)])
def test_a_retreating_front_solves_the_relation_over_the_lower_roots(c: float, eta: float) -> None:
    """Under v → -v the roots k turn into -k: Σ(-v) is minus the sum over M⁻ at v."""
    target = 2 * threshold_ratio(eta)
    found = all_velocities(np.array([c]), np.array([target]), retreating=True)
    assert found.v.size > 0
    for v, error, slope in zip(found.v, found.error, found.slope, strict=True):
        lower = sum_by_roots(float(v), c, upper=False)
        # the error of v through the slope, and that of the sum
        assert abs(abs(lower.value) - target) <= 2 * abs(slope) * error + lower.error + 1e-14


@pytest.mark.parametrize("eta", [0.0803, 0.0808])
def test_beside_the_end_of_resting_fronts_rounding_does_not_multiply_the_values(eta: float) -> None:
    """Close to c_retreat, |2 + Σ| equals 2r to within rounding over a whole range of small v."""
    target = np.array([2 * threshold_ratio(eta)])
    limit = kinetic_relation(c=1.0, eta=eta).c_retreat
    assert limit is not None
    c = np.array([(1 + 1e-9) * limit])
    found = all_velocities(c, target, retreating=True)
    # Finding the solutions takes about as many values as the first points do.
    assert found.evaluations < 3 * first_points(c, target, 2.0, 1.0)[2].size
    (v,), (error,) = found.v, found.error
    below, above = (
        abs(2 + precise_sum_by_integral(float(at), float(c[0]), 20).value) - target[0]
        for at in (v - error, v + error)
    )
    assert below * above < 0


@pytest.mark.parametrize("eta", [0.01, 0.02, 0.03125, 0.04])
def test_beside_the_fold_rounding_does_not_multiply_the_branches(eta: float) -> None:
    fold = fold_coupling(eta)
    c = fold.value + np.arange(-40, 41) * math.ulp(fold.value)
    target = np.full(c.size, 2 * threshold_ratio(eta))
    # |Σ| is known to 1e-15: none, two, or one that is double to within rounding; never more
    assert np.bincount(all_velocities(c, target).case).max() <= 2
    for ulps in range(0, c.size, 5):
        one = all_velocities(c[ulps : ulps + 1], target[:1])
        assert one.v.size <= 2, f"{ulps - 40} ulps from c_fold({eta})"


@pytest.mark.parametrize(("v", "c"), [("abc", "0.5"), ("0.3", ""), (None, 0.5), ("nan", 1.0)])
def test_what_is_no_number_is_refused_in_words(v: object, c: object) -> None:
    for compute in (sum_by_roots, precise_sum_by_integral):
        with pytest.raises(ParameterError, match="is not allowed: it must be "):
            compute(v, c, 20)  # type: ignore[arg-type]
