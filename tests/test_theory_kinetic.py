"""Claims about the kinetic relation (Eq. 54): its branches, thresholds, limits and derivatives."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np
import pytest

from fronts.piecewise.kinetic_relation import kinetic_relation as front_door
from theory.cells.vdp import (
    eta_from_damping,
    eta_from_ratio,
    is_bistable,
    threshold_ratio,
    threshold_ratio_slope,
)
from theory.parameters import ParameterError
from theory.piecewise.branch_search import all_velocities
from theory.piecewise.folds import LAST_FOLD, fold_coupling, fold_eta
from theory.piecewise.kinetic_relation import (
    KineticBranch,
    Regime,
    kinetic_relation,
    trace_kinetic_relation,
)
from theory.piecewise.limits import (
    pinning_coupling,
    pinning_eta,
    resonant_velocities,
    retreat_coupling,
    static_sum,
    static_sum_distance,
    strong_coupling_sum,
    strong_coupling_velocity,
    weak_threshold_velocity,
)
from theory.piecewise.sums.integral import sum_by_integral, sums
from theory.piecewise.sums.series import sum_by_roots

ETA = 0.03125  # a = 4, b = 0.5, the paper's


def exact_ratio(eta: float | mp.mpf) -> mp.mpf:
    """Return |φ_us|/|φ_s| from the roots of 1 - a x/4 + b x²/8 = 0 at a = 1, b = η."""
    low, high = sorted(
        mp.polyroots([mp.mpf(eta) / 8, mp.mpf(-0.25), 1], maxsteps=200, extraprec=200)
    )
    return mp.sqrt(low / high)


def size_by_roots(v: float, c: float, retreating: bool = False) -> float:
    """Return |Σ| (|2 + Σ| for a retreat) by the series over the roots."""
    return float(abs(sum_by_roots(v, c).value + (2 if retreating else 0)))


def velocities(c: float, eta: float) -> list[KineticBranch]:
    (answer,) = trace_kinetic_relation([c], [eta], admissibility=False)
    return list(answer.branches)


def search(c: float, eta: float, refine: float, retreating: bool = False) -> np.ndarray:
    target = np.array([2 * threshold_ratio(eta)])
    return all_velocities(np.array([c]), target, retreating, refine).v


def fold_at(eta: float) -> float:
    fold = fold_coupling(eta)
    return fold.value


CASES = [
    (0.3, 0.01),
    (0.5, ETA),
    (0.45, ETA),
    (1.0, 0.05),
    (3.0, 1e-3),
    (10.0, ETA),
    (30.0, 1e-4),
    (100.0, 1e-4),
    (1e3, 1e-3),
    (1e3, 1e-5),
    (1e4, 0.03),
    (1e-3, 1e-9),
    (0.01, 1e-6),
]
RETREATING = [(2.0, 0.11), (0.5, 0.12), (20.0, 0.09), (100.0, 0.1), (1e3, 0.124)]


@pytest.mark.parametrize(("c", "eta"), CASES)
def test_a_coarse_and_a_fine_search_find_the_same_branches(c: float, eta: float) -> None:
    coarse, fine = search(c, eta, 1.0), search(c, eta, 4.0)
    assert coarse.size == fine.size
    assert coarse == pytest.approx(fine, rel=1e-9)  # both polished; worse only close to a fold


@pytest.mark.parametrize(("c", "eta"), RETREATING)
def test_coarse_and_fine_agree_on_retreating_fronts(c: float, eta: float) -> None:
    coarse, fine = search(c, eta, 1.0, True), search(c, eta, 4.0, True)
    assert coarse.size == fine.size > 0
    assert coarse == pytest.approx(fine, rel=1e-9)


def test_coarse_and_fine_agree_on_random_scenes() -> None:
    rng = np.random.default_rng(21)
    c = np.exp(rng.uniform(math.log(1e-3), math.log(100), 30))
    eta = np.exp(rng.uniform(math.log(1e-6), math.log(0.079), 30))
    target = np.array([2 * threshold_ratio(value) for value in eta])
    coarse, fine = all_velocities(c, target), all_velocities(c, target, refine=4.0)
    assert np.array_equal(coarse.case, fine.case)
    # the roots' own conditioning, and some cases fall close to a fold
    assert np.all(np.abs(coarse.v - fine.v) <= coarse.error + fine.error)


@pytest.mark.parametrize(("c", "eta"), [(0.45, ETA), (0.5, ETA), (2.0, 0.01), (100.0, 1e-4)])
def test_no_branch_is_lost_by_a_plain_scan_of_the_sign(c: float, eta: float) -> None:
    found = search(c, eta, 1.0)
    v = np.geomspace(0.5 * found.min(), 1.5 * found.max(), 8_001)
    sign = np.sign(np.abs(sums(v, c, 1e-12).value) - 2 * threshold_ratio(eta))
    assert np.count_nonzero(np.diff(sign)) == found.size


@pytest.mark.parametrize("eta", [0.005, ETA, 0.04])
def test_none_just_below_the_fold_and_two_just_above(eta: float) -> None:
    fold = fold_coupling(eta)
    assert fold.error < 1e-11
    for refine in (1.0, 4.0):
        assert search(fold.value - 1e-9, eta, refine).size == 0
        above = search(fold.value + 1e-9, eta, refine)
        assert above.size == 2
        # a pair √1e-9 apart about the velocity of the fold
        assert above.min() < fold.velocity < above.max()
        assert above.max() - above.min() < 1e-3
    # where the slope is lost the error is large, and says so
    for branch in velocities(fold.value + 1e-9, eta):
        assert abs(size_by_roots(branch.v, fold.value + 1e-9) - 2 * threshold_ratio(eta)) < 1e-12
    slopes = [branch.slope for branch in velocities(fold.value + 1e-6, eta)]
    assert slopes == [1, -1]


def test_the_resonances_of_large_c_carry_branches_of_their_own() -> None:
    c, eta = 100.0, 1e-4
    peaks, widths = resonant_velocities(c, np.arange(3))
    # max (1 - cos k)/k over k, at k = 2.3311
    assert peaks[0] == pytest.approx(72.4611, rel=1e-6)
    size = np.abs(
        sums(np.array([peaks[0] - 8 * widths[0], peaks[0], peaks[0] + 8 * widths[0]]), c).value
    )
    assert size[1] > size[0]
    assert size[1] > size[2]
    found = velocities(c, eta)
    assert len(found) % 2 == 1
    assert [branch.slope for branch in found] == [
        -1 if i % 2 == 0 else 1 for i in range(len(found))
    ]


@pytest.mark.parametrize(("c", "eta"), [case for case in CASES if case[0] < 200])
def test_every_branch_satisfies_54_by_the_series_over_roots(c: float, eta: float) -> None:
    target = 2 * float(exact_ratio(eta))
    for branch in velocities(c, eta):
        assert branch.v > 0
        # errors of the two sums, 1e-13 each, and the rounding of v times |∂Σ/∂v| < 1/v
        assert abs(size_by_roots(branch.v, c) - target) < 5e-13


@pytest.mark.parametrize(("c", "eta"), RETREATING[:4])
def test_every_retreat_satisfies_its_own_relation(c: float, eta: float) -> None:
    """A front that runs backwards is the mirror image: Σ over the roots below the axis."""
    found = velocities(c, eta)
    assert found
    for branch in found:
        assert branch.v < 0
        mirrored = abs(sum_by_roots(-branch.v, c, upper=False).value)
        assert abs(mirrored - 2 * float(exact_ratio(eta))) < 5e-13


@pytest.mark.parametrize(("c", "eta"), [(0.45, ETA), (0.01, 1e-6)])
def test_the_error_of_v_is_honest(c: float, eta: float) -> None:
    for branch in velocities(c, eta):
        with mp.workdps(40):
            target = 2 * exact_ratio(eta)

            def relation(v: mp.mpf, target: mp.mpf = target) -> mp.mpf:
                return abs(sum_by_roots(mp.nstr(v, 40), mp.nstr(mp.mpf(c), 40), 25).value) - target

            guess = mp.mpf(branch.v)
            exact = mp.findroot(relation, (guess, guess * (1 + mp.mpf("1e-9"))), tol=1e-40)
            off = abs(exact - guess)
        assert off <= branch.error
        assert branch.error < 1e-11 * branch.v + 1e-10 * (c == 0.45)  # near the fold less is known


@pytest.mark.parametrize("eta", [1e-8, 1e-3, ETA, 0.06, 0.0799])
def test_c_pin_is_where_the_limit_of_slow_fronts_meets_the_threshold(eta: float) -> None:
    c = pinning_coupling(eta)
    # at v = 1/70, e^{-1/2v} = 6e-16: Σ is at its limit to rounding
    slow = abs(sum_by_integral(1 / 70, c).value) if c < 100 else abs(static_sum(c))
    assert slow == pytest.approx(2 * float(exact_ratio(eta)), rel=1e-10, abs=1e-14)
    assert pinning_eta(c) == pytest.approx(eta, rel=1e-12)
    assert 2 * threshold_ratio(eta) == pytest.approx(abs(1 / np.sqrt(1 - 4j * c) - 1), rel=1e-11)


@pytest.mark.parametrize("eta", [0.081, 0.1, 0.12, 0.125])
def test_c_retreat_is_where_the_slow_retreat_meets_the_threshold(eta: float) -> None:
    c = retreat_coupling(eta)
    assert pinning_coupling(eta) is None
    # 1e-12: of c some 1e3 at η = 0.081 by rounding of r, whose slope is 1/c
    assert abs(1 / np.sqrt(1 - 4j * c) + 1) == pytest.approx(2 * float(exact_ratio(eta)), abs=1e-12)
    assert retreat_coupling(0.05) is None


TO_THE_END = [0.5, 1e-3, 1e-7, 1e-11, 1e-15]
ROUNDINGS = 8 * 2.3e-16
"""Some eight operations, whose condition at a given binary η is at most one."""


@pytest.mark.parametrize("beside", TO_THE_END)
def test_thresholds_are_right_to_rounding_up_to_where_they_end(beside: float) -> None:
    with mp.workdps(60):
        for eta in (0.08 * (1.0 - beside), 0.08 * (1.0 + beside), 0.125 - beside / 32):
            r, c = exact_ratio(eta), pinning_coupling(eta)
            side = -1 if c is None else 1
            gap = side * (1 - 4 * r**2)
            p = (1 + mp.sqrt(1 - side * 8 * r**2 * gap)) / (2 * gap)
            found = retreat_coupling(eta) if c is None else c
            assert abs(found / (p * mp.sqrt(p**2 - 1) / 2) - 1) < ROUNDINGS


@pytest.mark.parametrize("beside", TO_THE_END)
def test_the_strong_coupling_velocity_is_right_to_rounding_up_to_its_end(beside: float) -> None:
    eta = 0.08 * (1.0 - beside)
    found = strong_coupling_velocity(eta)
    assert found is not None
    with mp.workdps(60):

        def defect(x: mp.mpf) -> mp.mpf:
            q = mp.sqrt(mp.mpc(-(x**2), 1))
            return abs(q * (x - 1j * q)) - 1 / (2 * exact_ratio(eta))

        near = mp.mpf(found)
        assert abs(found / mp.findroot(defect, (near, near * 1.001)) - 1) < ROUNDINGS


def test_the_distance_from_the_static_sum_is_bounded() -> None:
    for v in (0.02, 0.05, 0.1, 0.3, 1.0, 10.0):
        for c in (1e-3, 0.1, 0.5, 2.0, 50.0):
            gap = abs(sum_by_integral(v, c).value - static_sum(c))
            assert gap <= static_sum_distance(v, c) + 1e-13
    # and it is of that order, no wild overestimate: both fall like e^{-1/2v}
    ratio = [
        abs(sum_by_integral(v, 0.5).value - static_sum(0.5)) / static_sum_distance(v, 0.5)
        for v in (0.03, 0.05, 0.1)
    ]
    assert min(ratio) > 0.01


@pytest.mark.parametrize("eta", [1e-3, ETA, 0.06])
def test_strong_coupling_grows_like_the_square_root(eta: float) -> None:
    slope = strong_coupling_velocity(eta)
    assert slope is not None
    found = velocities(1e6, eta)
    # corrections are of relative order 1/√c = 1e-3 or smaller
    assert found[0].v / 1e3 == pytest.approx(slope, rel=2e-3)
    # the limit solves its own equation, written out with the root of -iκ²/2 - ixκ + ½ = 0
    kappa = [k for k in np.roots([-0.5j, -1j * slope, 0.5]) if k.imag > 0]
    assert len(kappa) == 1
    limit = 1 / (kappa[0] * -1j * (slope + kappa[0]))
    assert abs(limit) == pytest.approx(2 * threshold_ratio(eta), rel=1e-12)
    assert abs(strong_coupling_sum(slope) - limit) < 1e-12
    assert strong_coupling_velocity(0.08) is None


def test_small_eta_at_fixed_c_follows_its_limit() -> None:
    for c in (0.1, 0.5, 2.0):
        for eta, within in ((1e-8, 0.1), (1e-12, 1e-2), (1e-16, 1e-3)):
            fastest = velocities(c, eta)[-1].v
            # v ~ (c/8r)^{1/2}: the correction is of relative order (1 + c)/v
            assert fastest == pytest.approx(math.sqrt(c / (8 * math.sqrt(2 * eta))), rel=within)
            assert weak_threshold_velocity(c, eta) == pytest.approx(fastest, rel=within)


def test_the_two_limits_do_not_commute() -> None:
    """η → 0 and then c → ∞ gives v = √(c/8r); the other order is √2 times faster."""
    eta, c = 1e-14, 1.0
    first_eta = weak_threshold_velocity(c, eta) / math.sqrt(c)
    first_c = strong_coupling_velocity(eta)
    assert first_c / first_eta == pytest.approx(math.sqrt(2), rel=1e-3)
    # and the relation itself has both: c ≪ and ≫ v
    slow = velocities(0.5, 1e-14)[-1].v / weak_threshold_velocity(0.5, 1e-14)
    fast = velocities(1e6, 1e-6)[0].v / weak_threshold_velocity(1e6, 1e-6)
    assert slow == pytest.approx(1.0, rel=1e-2)
    assert fast == pytest.approx(math.sqrt(2), rel=5e-2)


def test_the_fold_lies_below_pinning_by_what_a_scan_sees() -> None:
    for eta in (1e-3, ETA, 0.06):
        fold, pin = fold_coupling(eta), pinning_coupling(eta)
        assert fold.value <= pin
        v = np.geomspace(0.02, 5, 8000)
        below = np.abs(sums(v, fold.value * (1 - 1e-7)).value).max()
        above = np.abs(sums(v, fold.value * (1 + 1e-6)).value).max()
        assert below < 2 * threshold_ratio(eta) < above
        assert fold_eta(fold.value).value == pytest.approx(eta, rel=1e-10)


def test_no_maximum_exceeds_the_static_limit_at_larger_couplings() -> None:
    for c in np.geomspace(0.9, 100, 9):
        v = np.unique(
            np.concatenate([np.geomspace(0.015, 3 * c + 3, 1500), 1 / np.arange(1, 60, 0.05)])
        )
        top = np.abs(sums(v, float(c), 1e-14).value).max()
        assert top <= abs(static_sum(float(c))) + 1e-12
    assert LAST_FOLD >= 0.9
    last = fold_coupling(0.0795)
    assert last.velocity == 0.0
    assert last.value == pinning_coupling(0.0795)
    assert fold_eta(5.0).value == pinning_eta(5.0)
    assert fold_coupling(0.09) is None


@pytest.mark.parametrize(
    ("c", "eta"), [(0.5, ETA), (0.45, ETA), (10.0, ETA), (2.0, 1e-3), (2.0, 0.11), (100.0, 1e-4)]
)
def test_derivatives_of_v_are_those_of_finite_differences(c: float, eta: float) -> None:
    here = velocities(c, eta)
    h = 1e-6
    right, left = velocities(c * (1 + h), eta), velocities(c * (1 - h), eta)
    up, down = velocities(c, eta * (1 + h)), velocities(c, eta * (1 - h))
    assert len(here) == len(right) == len(left) == len(up) == len(down) > 0
    for b, r, le, u, d in zip(here, right, left, up, down, strict=True):
        # second order in h, and the errors of v over the step
        noise = 4 * b.error / h
        by_c, by_eta = (r.v - le.v) / (2 * h * c), (u.v - d.v) / (2 * h * eta)
        assert b.by_c == pytest.approx(by_c, rel=1e-5, abs=noise / c)
        assert b.by_eta == pytest.approx(by_eta, rel=1e-5, abs=noise / eta)


def exact_derivatives(branch: KineticBranch, c: float, eta: float) -> tuple[mp.mpf, mp.mpf]:
    """Return ∂v/∂c and ∂v/∂η at the true velocity, from 30 digits of the series over the roots."""
    direction, shift = (1, 0) if branch.v > 0 else (-1, 2)

    def size(v: mp.mpf, c: mp.mpf) -> mp.mpf:
        return abs(sum_by_roots(mp.nstr(v, 40), mp.nstr(c, 40), 30).value + shift)

    c_, h = mp.mpf(c), mp.mpf(10) ** -10
    v = abs(mp.mpf(branch.v))
    steep = 2 * mp.diff(exact_ratio, eta) / mp.mpf(branch.by_eta) * direction
    for _ in range(2):  # of the distance, each leaves the part by which the slope is wrong
        v -= (size(v, c_) - 2 * exact_ratio(eta)) / steep
    by_v = (size(v * (1 + h), c_) - size(v * (1 - h), c_)) / (2 * h * v)
    by_c = (size(v, c_ * (1 + h)) - size(v, c_ * (1 - h))) / (2 * h * c_)
    return -direction * by_c / by_v, direction * 2 * mp.diff(exact_ratio, eta) / by_v


@pytest.mark.parametrize(
    ("c", "eta"),
    [(0.5, ETA), (fold_at(ETA) + 1e-9, ETA), (2.0, 0.11), (100.0, 1e-4), (0.3, 1e-9)],
)  # fmt: skip
def test_the_errors_of_the_derivatives_of_v_bound_the_true_ones(c: float, eta: float) -> None:
    for branch in velocities(c, eta):
        with mp.workdps(40):
            by_c, by_eta = exact_derivatives(branch, c, eta)
            off_c, off_eta = abs(branch.by_c - by_c), abs(branch.by_eta - by_eta)
        # the differences are good to 1e-30/1e-10, and to 1e-20 of third derivatives
        assert off_c <= branch.by_c_error + 1e-17 * abs(by_c)
        assert off_eta <= branch.by_eta_error + 1e-17 * abs(by_eta)
        assert branch.by_c_error < 1e-3 * abs(branch.by_c)
        assert branch.by_eta_error < 1e-3 * abs(branch.by_eta)


def test_where_the_fold_is_within_the_error_the_derivatives_have_no_bound_and_say_so() -> None:
    fold = fold_coupling(ETA)
    seen = 0
    c = fold.value + np.arange(-8, 9) * math.ulp(fold.value)
    for answer in trace_kinetic_relation(c, ETA, admissibility=False):
        for branch in answer.branches:
            if math.isinf(branch.by_c_error):
                seen += 1
                assert math.isinf(branch.by_eta_error)
                shown = branch.to_dict()
                assert shown["by_c_error"] is None
                assert shown["by_eta_error"] is None
    assert seen > 0


def test_just_above_c_retreat_the_sign_of_the_derivative_may_be_unknown_and_its_error_says_so() -> (
    None
):
    """A front that retreats does so the faster the stronger the coupling: ∂v/∂c < 0."""
    eta = 0.085
    end = kinetic_relation(1.0, eta).c_retreat
    errors = []
    for answer in trace_kinetic_relation(
        end * (1.0 + np.geomspace(1e-11, 1e-10, 24)), eta, admissibility=False
    ):
        for branch in answer.branches:
            assert branch.by_c - branch.by_c_error < 0.0
            errors.append(branch.by_c_error)
    assert math.inf in errors
    assert min(errors) < math.inf


def test_the_papers_point_has_one_admissible_front() -> None:
    answer = kinetic_relation(0.5, ETA)
    (branch,) = answer.branches
    assert answer.status is Regime.PROPAGATING
    assert branch.admissible is True
    assert branch.fails_at is None
    assert branch.slope == -1
    assert "c_pin" in answer.reason
    assert answer.terms > 0


@pytest.mark.parametrize(("eta", "end", "shift"), [(0.05, "c_pin", 0), (0.11, "c_retreat", 2)])
def test_a_front_too_slow_to_be_searched_for_is_not_denied(
    eta: float, end: str, shift: int
) -> None:
    """By mpmath |Σ + shift| is on different sides of 2r at v = 0 and at v = 0.018."""
    closed = getattr(kinetic_relation(0.5, eta), end)
    answer = kinetic_relation(closed * (1.0 + 1e-13), eta)
    assert not answer.branches
    assert f"above {end} = " in answer.reason
    assert "slower than |v| = 0.018" in answer.reason
    with mp.workdps(30):
        c, v = mp.mpf(answer.c), mp.mpf("0.018")
        root = mp.sqrt(1 - 8 * mp.mpf(eta))
        twice_r = 2 * mp.sqrt((1 - root) / (1 + root))
        total, points = -1, 400
        for j in range(points):  # the trapezoidal rule, with half a step between points and k = 0
            k = (j + mp.mpf("0.5")) * mp.pi / points
            A = mp.mpf("0.5") - 1j * c * (1 - mp.cos(k))
            total += mp.sinh(A / v) / (mp.cosh(A / v) - mp.cos(k)) / (2 * A) / points
        at_rest = -1 + 1 / mp.sqrt(1 - 4j * c)
        gaps = [abs(each + shift) - twice_r for each in (at_rest, total)]
    assert gaps[0] * gaps[1] < 0


def test_each_kind_of_motion_has_its_reason_and_nearest_threshold() -> None:
    retreat = retreat_coupling(0.11)
    cases = [
        (0.2, ETA, Regime.PINNED, "c_fold = 0.433776"),
        (0.44, ETA, Regime.PROPAGATING, "between c_fold"),
        (0.5, ETA, Regime.PROPAGATING, "above c_pin"),
        (0.5, 0.08, Regime.PINNED, "2/25"),
        (0.5 * retreat, 0.11, Regime.PINNED, "c_retreat"),
        (1.5 * retreat, 0.11, Regime.PROPAGATING, "retreats"),
        (1.0, 0.124999999999875, Regime.PROPAGATING, "c_retreat = 0.000632453, where no static"),
        (0.5, 0.125, Regime.NOT_BISTABLE, "1/8"),
        (0.5, 3.0, Regime.NOT_BISTABLE, "1/8"),
    ]
    for c, eta, status, words in cases:
        answer = kinetic_relation(c, eta)
        assert answer.status is status, (c, eta)
        assert words in answer.reason
        assert answer.reason.endswith(".")
        assert [b.v for b in answer.branches] == sorted(b.v for b in answer.branches)
        if status is not Regime.PROPAGATING:
            assert not answer.branches
        if eta >= 0.08:
            assert answer.c_pin is None
            assert answer.c_fold is None


def test_a_curve_is_its_points_one_by_one() -> None:
    c = np.linspace(0.42, 3.0, 23)
    curve = trace_kinetic_relation(c, ETA)
    assert [answer.c for answer in curve] == c.tolist()
    for answer in curve[::4]:
        alone = kinetic_relation(answer.c, ETA)
        assert alone.status is answer.status
        assert len(alone.branches) == len(answer.branches)
        for a, b in zip(alone.branches, answer.branches, strict=True):
            assert abs(a.v - b.v) <= a.error + b.error
            assert a.admissible is b.admissible


@pytest.mark.parametrize("c", [0.0, -1.0, math.nan, math.inf, 1e9, 1e-9])
def test_a_bad_coupling_is_refused_in_one_sentence(c: float) -> None:
    with pytest.raises(ParameterError, match=r"^coupling c = .* is not allowed: .*\.$") as caught:
        kinetic_relation(c, ETA)
    assert "\n" not in str(caught.value)
    assert caught.value.remedy


@pytest.mark.parametrize("eta", [0.0, -0.1, math.nan, math.inf, 1e-25])
def test_a_bad_eta_is_refused_in_one_sentence(eta: float) -> None:
    with pytest.raises(ParameterError, match=r"^eta = b/a\^2 = .* is not allowed: .*\.$"):
        kinetic_relation(0.5, eta)


def test_the_threshold_ratio_is_that_of_the_two_cycles() -> None:
    for eta in (1e-24, 1e-12, 1e-3, ETA, 0.08, 0.12, 0.1249999, 0.125):
        with mp.workdps(60):
            if eta < 0.125:
                assert threshold_ratio(eta) == pytest.approx(float(exact_ratio(eta)), rel=1e-14)
            # near 1/8 the inverse is flat in r: η is well known, r less so
            assert eta_from_ratio(threshold_ratio(eta)) == pytest.approx(eta, rel=1e-14)
    assert threshold_ratio(0.125) == 1.0
    assert threshold_ratio(0.08) == pytest.approx(0.5, rel=1e-15)
    with mp.workdps(40):
        slope = mp.diff(exact_ratio, mp.mpf(ETA), h=mp.mpf(10) ** -12)
    assert threshold_ratio_slope(ETA) == pytest.approx(float(slope), rel=1e-12)
    for bad in (0.0, -1.0, 0.126, math.nan):
        with pytest.raises(ParameterError):
            threshold_ratio(bad)


def test_eta_comes_from_the_damping() -> None:
    assert eta_from_damping(4, 0.5) == ETA
    assert is_bistable(ETA)
    assert not is_bistable(0.125)
    for a, b in ((0.0, 1.0), (1.0, 0.0), (-1.0, 1.0), (math.nan, 1.0), (1.0, math.inf)):
        with pytest.raises(ParameterError, match="damping coefficient"):
            eta_from_damping(a, b)


@pytest.mark.parametrize("of", [pinning_eta, lambda c: fold_eta(c).value])
@pytest.mark.parametrize("c", [1e308, 1e-310, float("inf"), float("nan"), -1.0])
def test_a_coupling_beyond_double_precision_is_refused(
    of: Callable[[float], float], c: float
) -> None:
    with pytest.raises(ParameterError, match="coupling c"):
        of(c)
    assert 0 < of(1e-150) < of(1e300) <= 0.08


@pytest.mark.parametrize(
    ("c", "eta", "said"),
    [
        ([0.5, 0.6], [0.03, 0.04, 0.05], r"eta = 3 numbers .* one for each of 2 couplings"),
        ([[0.5, 0.6]], 0.03, r"shape of coupling c = \(1, 2\)"),
        (0.5, [], r"eta = \[\]"),
    ],
)
def test_arrays_that_are_no_curve_are_refused(c: Any, eta: Any, said: str) -> None:
    with pytest.raises(ParameterError, match=said):
        front_door(c=c, eta=eta)


def test_pairs_of_numbers_are_a_curve_whose_time_is_all_of_it() -> None:
    found = front_door(c=[0.5, 0.6], eta=[0.03, 0.04], stability=True)
    assert [(point.c, point.eta) for point in found.points] == [(0.5, 0.03), (0.6, 0.04)]
    assert sum(point.seconds for point in found.points) < found.seconds
