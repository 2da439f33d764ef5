"""Stability of fronts of (44), against Bessel functions, polynomial roots and running chains."""

import cmath
import math

import mpmath as mp
import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import jv

from theory.cells.vdp import threshold_ratio
from theory.piecewise import symbol
from theory.piecewise.folds import fold_coupling
from theory.piecewise.kinetic_relation import kinetic_relation
from theory.piecewise.stability import front_stability
from theory.piecewise.stability_limit import _crossing, _LeadingFront, stability_limit
from theory.piecewise.sums.series import sum_by_roots
from theory.piecewise.symbol import Symbol, symbol_coefficients
from verification.piecewise.run import FrontStatus
from verification.piecewise.simulation import simulate_front

ETA = 0.03125


def fastest(c, eta=ETA):
    return max((b for b in kinetic_relation(c, eta).branches if b.admissible), key=lambda b: b.v)


def sum_by_many_digits(v, c):
    return sum_by_roots(v, c, digits=30).value


def by_bessel(v, c, terms):
    """The coefficients as they are defined, with another sum and scipy's Bessel functions."""
    k = np.arange(1, terms + 1)
    crossing = -0.5 * complex(sum_by_many_digits(abs(v), c))
    if v < 0:
        crossing = 1.0 - crossing
    response = (-1j) ** k * np.exp((-0.5 + 1j * c) * k / abs(v)) * jv(k, c * k / abs(v))
    return 0.5 * np.real(np.exp(-1j * np.angle(crossing)) * response)


@pytest.mark.parametrize(
    ("v", "c"), [(0.3, 0.5), (1.29, 2.4), (5.0, 30.0), (-0.25, 1.3), (0.12, 900.0), (7.0, 0.5)]
)
def test_the_symbol_is_made_of_bessel_functions(v, c):
    found = symbol_coefficients(v, c, 40, points=None)
    assert np.allclose(found, by_bessel(v, c, 40), rtol=0, atol=1e-14)  # rounding of e^{iφ} c/v


@pytest.mark.parametrize("piece", [1, 100, 256])
def test_the_coefficients_are_the_same_in_however_many_pieces_points_are_summed(piece, monkeypatch):
    whole = symbol_coefficients(0.4, 0.7, 40, 256)
    monkeypatch.setattr(symbol, "_PIECE", piece)
    assert np.allclose(symbol_coefficients(0.4, 0.7, 40, 256), whole, rtol=0, atol=1e-16)


def test_where_the_first_coefficient_exceeds_all_others_there_is_no_zero(monkeypatch):
    q = np.array([1.01, -0.7, 0.3])
    assert min(abs(np.roots(q[::-1]))) > 1.0
    assert Symbol(q, 0.02).zeros_within(1.0) == 0
    monkeypatch.setattr(np.fft, "rfft", None)
    assert Symbol(q, 0.0).zeros_within(1.0) == 0


@pytest.mark.parametrize(("first", "uncertainty", "count"), [(0.99, 0.0, 1), (1.01, 0.02, None)])
def test_where_it_does_not_zeros_are_counted(first, uncertainty, count):
    # E(1) is first - 1
    assert Symbol(np.array([first, -0.7, -0.3]), uncertainty).zeros_within(1.0) == count


@pytest.mark.parametrize(
    ("v", "c"), [(1e-3, 0.11), (1.36e-3, 0.22), (7.9, 30.4), (9.1, 12.8), (1e-3, 1e-3)]
)
@pytest.mark.filterwarnings("error")
def test_terms_that_underflow_and_powers_that_would_overflow_are_no_multipliers(v, c):
    """At small v, E is constant and has no zero; at large v, Newton's points go astray."""
    found = front_stability(v, c)
    assert found.stable is not None or found.multiplier is None
    if v < 1.0:  # the two terms by Bessel functions in many digits: their ratio is the only zero
        with mp.workdps(30):
            first, second = (
                mp.re(
                    mp.expjpi(-mp.mpf(cmath.phase(-complex(sum_by_many_digits(v, c)))) / mp.pi)
                    * mp.mpc(0, -1) ** k
                    * mp.exp(mp.mpc(-0.5, c) * k / v)
                    * mp.besselj(k, c * k / v)
                )
                for k in (1, 2)
            )
        assert abs(second / first) < found.floor
        assert found.multiplier is None


@pytest.mark.parametrize(("v", "c"), [(1e-4, 1e-3), (5e-4, 0.1), (-1e-4, 1e-3), (1e-12, 1.0)])
@pytest.mark.filterwarnings("error")
def test_where_every_term_underflows_stability_is_not_decided(v, c):
    found = front_stability(v, c)
    assert (found.stable, found.multiplier) == (None, None)


@pytest.mark.parametrize("c", [2.2, 2.38, 2.45, 3.0, 5.0, 13.0])
def test_the_leading_multiplier_is_the_largest_root_of_the_polynomial(c):
    v = fastest(c).v
    found = front_stability(v, c)
    terms = found.terms // 2  # e^{-K/2v} = 1e-15
    p = by_bessel(v, c, terms)
    polynomial = np.concatenate([[p.sum()], -p])
    roots = np.roots(polynomial)
    others = roots[np.abs(roots - 1.0) > 1e-6]
    leading = others[np.argmax(np.abs(others))]
    if found.multiplier is None:
        assert abs(leading) < found.floor * 1.01
    else:
        assert abs(abs(leading) - found.multiplier) < 1e-9  # of np.roots at this degree
        assert abs(abs(np.angle(leading)) - found.angle) < 1e-9
    assert found.stable == (abs(leading) < 1.0)


@pytest.mark.parametrize("c", [2.38, 2.5])
def test_a_disturbed_front_decays_or_grows_by_the_multiplier(c):
    """The switching times of the running chain obey z² = 2 |z| cos(angle) z - |z|²."""
    v = fastest(c).v
    found = front_stability(v, c)
    run = simulate_front(c, ETA, start_velocity=v * (1.0 + 1e-6))
    wait = np.diff(run.crossing_times) - 1.0 / v
    size = np.abs(wait)
    # The linear regime: small, and after the first transient; up to where it settles or has grown.
    begin = 25
    end = begin + int(np.argmax((size[begin:] > 1e-4) | (size[begin:] < 1e-11)) or 200)
    part = wait[begin:end]
    assert part.size > 20
    columns = np.stack([part[1:-1], part[:-2]], axis=1)
    (s, d), *_ = np.linalg.lstsq(columns, part[2:], rcond=None)
    assert math.sqrt(-d) == pytest.approx(found.multiplier, abs=2e-4)
    assert math.acos(s / 2 / math.sqrt(-d)) == pytest.approx(found.angle, abs=2e-4)


@pytest.mark.parametrize(
    ("c", "eta", "stable"),
    [(1.0, ETA, True), (3.0, ETA, False), (13.0, ETA, True), (9.0, 0.04, True), (1.5, 0.11, True)],
)
def test_the_running_chain_keeps_stable_fronts_and_leaves_unstable_ones(c, eta, stable):
    """c = 13 is beyond the first loss of stability: it has been regained."""
    branches = [b for b in kinetic_relation(c, eta).branches if b.admissible]
    branch = max(branches, key=lambda b: abs(b.v))
    assert branch.stable is stable
    run = simulate_front(c, eta, start_velocity=branch.v * (1.0 + 1e-5), accuracy=1e-9)
    if stable:
        assert run.status is FrontStatus.STEADY
        assert run.v == pytest.approx(branch.v, rel=1e-8)
    else:
        assert run.status is FrontStatus.UNSTEADY


@pytest.mark.parametrize("eta", [0.01, 0.04, 0.06])
@pytest.mark.parametrize("share", [0.97, 1.03])
def test_the_running_chain_loses_the_fastest_front_where_c_stable_says(eta, share):
    """Three per cent on both sides of c_stable, at other η than the paper's."""
    c = share * stability_limit(eta).c
    branch = kinetic_relation(c, eta).branches[-1]
    assert branch.admissible
    assert branch.stable is (share < 1.0)
    run = simulate_front(c, eta, start_velocity=branch.v * (1.0 + 1e-6), accuracy=1e-9)
    if branch.stable:
        assert run.v == pytest.approx(branch.v, rel=1e-8)
    assert run.status is (FrontStatus.STEADY if branch.stable else FrontStatus.UNSTEADY)


def multiplier_by_digits(v, c, near):
    """The modulus of the zero of the symbol beside ``near``, in 40 digits."""
    with mp.workdps(40):
        v, c = mp.mpf(v), mp.mpf(c)
        crossing = mp.mpc(-sum_by_many_digits(v, c) / 2)
        turn = mp.conj(crossing) / abs(crossing)
        p = [
            mp.re(turn * (-1j) ** k * mp.exp((-0.5 + 1j * c) * k / v) * mp.besselj(k, c * k / v))
            / 2
            for k in range(1, symbol.terms_at(float(v)) + 1)
        ]
        total = mp.fsum(p)

        def of(z):
            return total - mp.fsum(x * z ** (-k) for k, x in enumerate(p, start=1))

        return abs(mp.findroot(of, mp.mpc(near)))


@pytest.mark.parametrize("c", [2.3, 2.45, 30.0])
def test_the_error_of_a_multiplier_bounds_it(c):
    v = fastest(c).v
    found = front_stability(v, c)
    true = multiplier_by_digits(v, c, found.multiplier * np.exp(1j * found.angle))
    assert abs(true - found.multiplier) <= found.error
    assert found.error < 1e-10


@pytest.mark.parametrize(
    ("eta", "above"), [(ETA, 1e-13), (ETA, 1e-6), (0.01, 1e-9), (0.01, 1e-6), (0.044, 1e-7)]
)
def test_beside_a_fold_the_error_of_v_is_in_that_of_the_multiplier(eta, above):
    c = fold_coupling(eta).value * (1.0 + above)
    for branch in kinetic_relation(c, eta).branches:
        if branch.multiplier is None:
            continue
        near = branch.multiplier * np.exp(1j * front_stability(branch.v, c).angle)
        ends = [multiplier_by_digits(branch.v + s * branch.error, c, near) for s in (-1, 1)]
        change = max(abs(end - branch.multiplier) for end in ends)
        assert change <= branch.multiplier_error < 10.0 * change
        decided = abs(branch.multiplier - 1.0) > branch.multiplier_error
        assert branch.stable is (branch.multiplier < 1.0 if decided else None)


@pytest.mark.parametrize("v", [0.05, 0.4, 3.0, 60.0])
@pytest.mark.parametrize("ratio", [1e-2, 1.0, 30.0, 1e5])
def test_the_points_of_the_mean_leave_aliases_below_rounding(v, ratio):
    """The theorem on the trapezoidal rule, with ln|u| sampled on lines beside the path."""
    c, terms = v * ratio, symbol.terms_at(v)
    points = symbol._mean_points(terms, v, c)
    x, bend = np.linspace(-math.pi, math.pi, 2001), min(1.0, ratio)
    exponents = []
    for tau in np.geomspace(1e-6, 3.0, 100):
        lines = np.stack([x + 1j * tau, x - 1j * tau])
        kappa = lines + 1j * bend * (np.sin(lines) + 1.0 / ratio)
        u = 1j * kappa - (0.5 - 1j * c * (1.0 - np.cos(kappa))) / v
        exponents.append(points * tau - terms * max(0.0, u.real.max() + 0.5 / v))
    assert max(exponents) > 45.0  # e^{-45} is 3e-20, beside coefficients of e^{-1/2v} and less


def test_where_stability_is_first_lost():
    limit = stability_limit(ETA)
    assert 2.405 < limit.c < 2.41  # seen on running chains
    below, above = (front_stability(fastest(c).v, c) for c in (limit.c - 1e-6, limit.c + 1e-6))
    assert below.multiplier < 1.0 < above.multiplier
    # By the multipliers of two couplings, linearly: ten digits.
    rate = (above.multiplier - below.multiplier) / 2e-6
    assert limit.c - 1e-6 + (1.0 - below.multiplier) / rate == pytest.approx(limit.c, abs=1e-10)
    assert limit.error < 1e-11
    assert kinetic_relation(0.5, ETA).c_stable == limit.c


def test_stability_may_end_with_the_branch_itself():
    limit = stability_limit(0.01)
    assert limit.angle == 0.0
    before, beyond = (kinetic_relation(limit.c + d, 0.01) for d in (-1e-6, 1e-6))
    assert len(before.branches) == len(beyond.branches) + 2
    near = front_stability(before.branches[-1].v, before.c)
    assert near.stable
    assert 0.99 < near.multiplier < 1.0


@pytest.mark.parametrize(("eta", "least", "most"), [(0.071, 34.0, 36.0)])
def test_no_earlier_loss_of_stability_over_three_per_cent_is_passed_over(eta, least, most):
    limit = stability_limit(eta)
    assert least < limit.c < most
    first = 1.001 * fold_coupling(eta).value
    couplings = np.exp(np.arange(math.log(first), math.log(limit.c), 0.015))
    couplings = [*couplings.tolist(), limit.c - 1e-4, limit.c + 1e-4]
    stable = []
    for c in couplings:
        admissible = [b for b in kinetic_relation(c, eta).branches if b.admissible]
        stable.append(admissible[-1].stable if admissible else None)
    assert stable[-2:] == [True, False]
    assert stable.count(True) > 20
    # where a branch begins its front may be unstable over less than three per cent
    assert not any(stable[i : i + 3] == [False] * 3 for i in range(len(stable)))


def test_the_error_of_a_limit_where_admissibility_begins_bounds_what_its_tolerance_does(
    monkeypatch,
):
    r, beside = threshold_ratio(0.006), (8.5, 8.8)

    def found():
        stable, unstable = (_LeadingFront.at(c, r) for c in beside)
        assert (stable.unstable, unstable.unstable) == (False, True)
        return _crossing(stable, unstable, r)

    limit = found()
    assert limit.angle == 0.0
    monkeypatch.setattr("theory.piecewise.admissibility.TOLERANCE", 5e-11)
    assert 0.01 * limit.error < abs(found().c - limit.c) < limit.error


def test_what_is_not_decided_says_so(monkeypatch):
    found = front_stability(1e4, 1e7)
    assert (found.stable, found.multiplier, found.error) == (None, None, None)
    assert stability_limit(0.09).c is None
    assert "no front advances" in stability_limit(0.09).reason
    assert "not below 60" in stability_limit(0.0795).reason
    monkeypatch.setattr("theory.piecewise.stability_limit._MAX_COUPLING", 20.0)
    assert "up to 20" in stability_limit(0.07).reason
    monkeypatch.setattr(symbol, "_MAX_PRODUCTS", 100)
    assert "too long" in stability_limit(0.0005).reason
    inadmissible = [b for b in kinetic_relation(0.45, ETA).branches if not b.admissible]
    assert all(b.stable is None for b in inadmissible)


@pytest.mark.parametrize(("c", "low", "high"), [(0.5, 0.21, 0.22), (2.0, 0.28, 0.29)])
def test_where_the_threshold_may_be_passed_at_no_rate_within_the_error_of_v_nothing_is_decided(
    c, low, high
):
    """The rate, by scipy's Bessel functions, changes its sign within the larger error only."""

    def rate(v):
        return by_bessel(v, c, 40).sum()

    root = brentq(rate, low, high, xtol=1e-12)
    for v in (root - 1e-9, root + 1e-9):
        assert rate(v - 2e-10) * rate(v + 2e-10) > 0.0 > rate(v - 2e-9) * rate(v + 2e-9)
        assert front_stability(v, c, 2e-10).stable is False
        assert front_stability(v, c, 2e-9).stable is None


@pytest.mark.parametrize(
    ("v", "c", "error"),
    [
        (0.70068681, 79.661579, 3.6e-6),
        (1.33769106, 25.753805, 2.8e-5),
        (5.64837793, 27.189748, 1.5e-4),
        (-0.16871188, 31.403357, 7.7e-7),
    ],
)
def test_where_a_multiplier_may_cross_the_circle_within_the_error_of_v_nothing_is_decided(
    v, c, error
):
    """Its size at v is not known, or is that of another one, farther inside the circle at v."""
    sides = {front_stability(v + part * error, c).stable for part in (-0.9, 0.9)}
    assert sides == {True, False}
    assert front_stability(v, c, 1e-3 * error).stable is True
    assert front_stability(v, c, error).stable is None


def test_an_error_of_v_over_which_the_coefficients_turn_leaves_stability_open():
    """Slow fronts at strong coupling: the coefficients p_k oscillate with the phase c/v."""
    v, c, error = 0.054528, 73.51524, 1.53e-5
    assert {front_stability(v - part * error, c).stable for part in (0.0, 1.0)} == {True, False}
    assert front_stability(v, c, error).stable is None
    assert front_stability(v, c, 1e-10).stable is False


def test_a_velocity_without_error_adds_none_to_that_of_a_multiplier(monkeypatch):
    first = kinetic_relation(2.4, ETA).branches[0]
    found = front_stability(first.v, 2.4)
    monkeypatch.setattr(symbol.Symbol, "zero_near", lambda *_: complex(math.nan))
    assert front_stability(first.v, 2.4) == found
    assert front_stability(first.v, 2.4, first.error).stable is None


def test_the_json_object_says_what_is_stable_and_up_to_where_if_asked():
    import fronts as fr

    single = fr.kinetic_relation(2.4, ETA)
    first = single.branches[0]
    found = front_stability(first.v, 2.4, first.error)
    (branch,) = single.to_dict()["branches"]
    assert (branch["stable"], branch["multiplier"]) == (found.stable, found.multiplier)
    assert branch["multiplier_error"] == found.error > front_stability(first.v, 2.4).error
    assert "c_stable" not in single.to_dict()
    curve = fr.kinetic_relation([2.4, 2.41], ETA, stability=True)
    assert [point.branches[0].stable for point in curve.points] == [True, False]
    limit = curve.points[0].to_dict()
    assert 2.4 + limit["c_stable_error"] < limit["c_stable"] < 2.41 - limit["c_stable_error"]
    assert all(b.stable is None for b in fr.kinetic_relation([2.4], ETA).points[0].branches)
