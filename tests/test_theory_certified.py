"""Proofs in ball arithmetic against quadrature, root finding and sampling of other packages."""

import json
import math
import re
import shlex
import sys
from functools import cache, partial

import mpmath as mp
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

import fronts as fr
from fronts.cli import main
from theory.piecewise import certified_relation, certified_thresholds, certified_velocities
from theory.piecewise import certified_sum as certified_sum_module
from theory.piecewise.certified_relation import certify_relation
from theory.piecewise.certified_sum import Strip, ball_sum, certified_sum, needed_points
from theory.piecewise.certified_velocities import BITS, Relation, fast_bound
from theory.piecewise.sums.integral import sums
from verification.references.piecewise import static_sum, sum_by_quadrature, threshold_ratio

flint = pytest.importorskip("flint")


@cache
def _reference(v, c, digits=30):
    """Σ by mpmath's quadrature over half a period."""
    with mp.workdps(digits + 10):
        v, c = mp.mpf(v), mp.mpf(c)

        def G(k):
            cosine = mp.cos(k)
            A = mp.mpf("0.5") - 1j * c * (1 - cosine)
            E = mp.exp(A / v)
            sinh, cosh = (E - 1 / E) / 2, (E + 1 / E) / 2
            return sinh / (2 * A * (cosh - cosine))

        return -1 + mp.quad(G, mp.linspace(0, mp.pi, 9)) / mp.pi


def _by_scipy(v, c):
    """Σ by scipy's adaptive quadrature over half a period, to about 1e-10."""

    def integrand(k):
        A = 0.5 - 1j * c * (1.0 - math.cos(k))
        a = A / v
        half = [(a + 1j * k) / 2, (a - 1j * k) / 2]
        return sum(1.0 / np.tanh(each) for each in half) / (4.0 * A)

    found, _ = quad(integrand, 0.0, math.pi, complex_func=True, epsabs=1e-10, limit=2000)
    return found / math.pi - 1.0


@pytest.mark.parametrize(("v", "c"), [("0.3", "0.5"), ("2", "7"), ("0.05", "1.3"), ("5", "0.01")])
def test_sum_lies_within_its_proven_radius_at_many_digits(v, c):
    found = certified_sum(v, c, 30)
    with mp.workdps(45):
        assert abs(found.value - _reference(v, c)) <= found.error
        assert found.error <= mp.mpf(10) ** -30


@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (7.0, 40.0), (1.5, 1.5), (100.0, 3.0)])
def test_sum_lies_within_its_proven_radius_beside_scipy(v, c):
    found = certified_sum(v, c, digits=15)
    assert abs(found.value - _by_scipy(v, c)) <= found.error + 1e-9
    assert found.error < 1e-14


@pytest.mark.parametrize(("v", "c"), [(1e-12, 1e12), (1e12, 1e-12), (1e12, 1e12), (1e-12, 1e-12)])
def test_sum_is_proven_at_the_corners_of_its_range(v, c):
    found = certified_sum(v, c, digits=15)
    with mp.workdps(40):
        if v < 1:
            limit = static_sum(mp.mpf(c))
        else:
            # |Σ - ic/(4v²)| is of relative size c/v and 1/v²; scale it by the value at c = v.
            limit = mp.mpc(0, c) / (4 * mp.mpf(v) ** 2) if c < 1 else mp.mpc(found.value)
        assert abs(found.value - limit) <= found.error + 1e-10 * abs(limit)
    assert found.error < 1e-15 * max(1.0, abs(found.value)) + 1e-15


@pytest.mark.parametrize(("v", "c"), [(0.3, 0.5), (2.0, 7.0)])
@pytest.mark.parametrize("points", [8, 12, 20])
def test_few_points_give_a_wide_ball_that_holds_the_sum_and_its_derivatives(v, c, points):
    step = mp.mpf(10) ** -6
    with mp.workdps(30):
        at = {
            (i, j): _reference(mp.mpf(v) + i * step, mp.mpf(c) + j * step, 15)
            for i, j in [(0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)]
        }
        expected = [
            at[0, 0],
            (at[1, 0] - at[-1, 0]) / (2 * step),
            (at[0, 1] - at[0, -1]) / (2 * step),
            (at[1, 0] - 2 * at[0, 0] + at[-1, 0]) / step**2,
        ]
    _, strip = needed_points(v, c, 1e-3, 2)
    with flint.ctx.workprec(160):
        found = ball_sum(flint, flint.arb(v), flint.arb(c), points, strip, order=2)
        for ball, value in zip(
            (found.value, found.by_v, found.by_c, found.by_vv), expected, strict=True
        ):
            off = abs(ball - flint.acb(float(value.real), float(value.imag)))
            assert off.lower() < 1e-8 * (1.0 + abs(complex(value)))


def test_a_strip_that_holds_a_root_proves_nothing():
    found = ball_sum(flint, flint.arb(0.3), flint.arb(0.5), 64, Strip(half_width=2.0))
    assert not found.value.is_finite()


def test_derivatives_over_whole_cells_lie_in_their_balls():
    random = np.random.default_rng(3)
    for _ in range(30):
        v, c = 10.0 ** random.uniform(-1.2, 1.0), 10.0 ** random.uniform(-3, 1.3)
        v_end, c_end = v * (1 + 10.0 ** random.uniform(-5, -1.5)), c * (1 + random.uniform(0, 0.02))
        grid = np.meshgrid(np.linspace(v, v_end, 5), np.linspace(c, c_end, 3))
        found = sums(*grid, 1e-13, slopes=True)
        cell = [flint.arb(low).union(flint.arb(high)) for low, high in ((v, v_end), (c, c_end))]
        points, strip = needed_points(v_end * (1 + 1e-12), c_end * (1 + 1e-12), 1e-6, 1, c)
        balls = ball_sum(flint, *cell, points, strip, order=1)
        for ball, slopes in ((balls.by_v, found.by_v), (balls.by_c, found.by_c)):
            for slope in np.ravel(slopes):
                off = abs(ball - flint.acb(float(slope.real), float(slope.imag)))
                assert off.lower() <= 1e-9 * (1.0 + abs(slope))


def test_on_the_path_balls_of_velocities_stay_narrow_at_strong_coupling():
    """There |dSigma/dv| is 0.06, and on the axis its ball over such a cell has a radius of 4."""
    cell = flint.arb(0.297).union(flint.arb(0.303))
    points, strip = needed_points(0.304, 20.0, 1e-4, 1)
    assert strip.ratio is not None
    found = ball_sum(flint, cell, flint.arb(20.0), points, strip, order=1)
    assert abs(found.by_v).upper() < 1.0


@pytest.mark.parametrize(("sigma", "ratio"), [(0.02, 0.001), (0.1, 0.1), (0.3, 0.5), (0.6, 0.9)])
def test_on_the_strip_about_the_path_the_real_part_is_bounded(sigma, ratio):
    k, y = np.meshgrid(np.linspace(-np.pi, np.pi, 2001), np.linspace(-sigma, sigma, 41))
    bent = certified_sum_module._TAU
    z = k + 1j * y + 1j * bent * np.sin(k + 1j * y)
    least = (np.sin(z.real) * np.sinh(z.imag) - ratio * np.abs(z.imag)).min()
    between = min(  # of the axis and the path
        (np.sin(k[0]) * np.sinh(turn * bent * np.sin(k[0]))
         - ratio * turn * bent * np.abs(np.sin(k[0]))).min()
        for turn in np.linspace(0.0, 1.0, 21)
    )  # fmt: skip
    found = certified_sum_module._bound_of_m(sigma, ratio)
    assert -min(least, between) <= found <= -1.02 * min(least, between) + 2e-3 * ratio


def test_a_path_for_slower_fronts_proves_nothing():
    strip = Strip(half_width=0.3, ratio=0.5)
    for v, proven in ((0.2, True), (0.3, False)):
        found = ball_sum(flint, flint.arb(v), flint.arb(0.5), 64, strip)
        assert bool(found.value.is_finite()) is proven


def test_bounds_at_small_and_large_velocity_hold():
    random = np.random.default_rng(4)
    closest = 0.0
    for _ in range(40):
        c = 10.0 ** random.uniform(-3, 2)
        v = c * random.uniform(0.8, 3.0) + 10.0 ** random.uniform(-1, 2)
        value, error = _by_scipy(v, c), 1e-9
        bound = float(fast_bound(flint, v, flint.arb(c)).upper())
        assert abs(value) - error <= bound
        closest = max(closest, abs(value) / bound)
    assert closest > 0.5
    k = np.linspace(1e-3, 60.0, 1_000_000)
    assert 0.7246 < ((1.0 - np.cos(k)) / k).max() < certified_velocities._GAMMA


def _velocity_by_scipy(c, eta, low, high):
    target = 2.0 * float(threshold_ratio(mp.mpf(eta)))
    return brentq(lambda v: abs(_by_scipy(v, c)) - target, low, high, xtol=1e-13)


def test_velocity_of_the_readme_is_enclosed_where_scipy_finds_it():
    proven = fr.kinetic_relation(0.5, 0.03125, certify=True)
    assert proven.certified
    (velocity,) = proven.v_enclosures
    assert velocity.upper - velocity.lower < 1e-15
    assert abs(_velocity_by_scipy(0.5, 0.03125, 0.2, 0.4) - velocity.lower) < 1e-9
    assert proven.c_pin in proven.c_pin_enclosure


@pytest.mark.parametrize(
    ("c", "eta", "count"),
    [(0.45, 0.03125, 2), (0.455301, 0.03125, 6), (0.3, 0.03125, 0), (3.0, 0.11, 1), (2.0, 0.02, 1)],
)
def test_number_of_velocities_is_proven_and_each_is_where_it_was_computed(c, eta, count):
    proven = fr.kinetic_relation(c, eta, certify=True)
    assert proven.certified, proven.unproven
    assert len(proven.v_enclosures) == len(proven.branches) == count
    for branch, each in zip(proven.branches, proven.v_enclosures, strict=True):
        assert each.lower - branch.error <= branch.v <= each.upper + branch.error
        assert each.upper - each.lower <= 1e-15 * abs(each.upper)


def test_thresholds_are_enclosed_between_what_quadrature_shows():
    proven = fr.kinetic_relation(0.3, 0.03125, certify=True)
    fold, target = proven.c_fold_enclosure, 2.0 * float(threshold_ratio(mp.mpf(0.03125)))
    assert fold.upper - fold.lower < 1e-12

    def highest(c):
        return max(abs(_by_scipy(v, c)) for v in np.linspace(0.18, 0.2, 21))

    assert highest(fold.lower - 1e-5) < target < highest(fold.upper + 1e-5)
    with mp.workdps(40):
        ends = [
            abs(static_sum(mp.mpf(c))) - 2 * threshold_ratio(mp.mpf(0.03125))
            for c in (proven.c_pin_enclosure.lower, proven.c_pin_enclosure.upper)
        ]
    assert ends[0] < 0 < ends[1]


def test_a_fold_at_pinning_is_proven_where_slow_fronts_are_nearly_as_high():
    """At eta = 0.05, max |Sigma| is that at v = 0, and |Sigma| leaves it like e^{-1/2v}."""
    proven = fr.kinetic_relation(0.3, 0.05, certify=True)
    fold, pin = proven.c_fold_enclosure, proven.c_pin_enclosure
    assert fold is not None, proven.unproven
    assert fold.upper - fold.lower < 1e-11  # tried at 1e-15, widened where that is no proof
    assert fold.lower < pin.lower <= fold.upper


def test_retreating_fronts_and_their_threshold_are_enclosed():
    proven = fr.kinetic_relation(3.0, 0.11, certify=True)
    (velocity,) = proven.v_enclosures
    assert velocity.upper < 0.0
    with mp.workdps(40):
        ends = [
            abs(2 + static_sum(mp.mpf(c))) - 2 * threshold_ratio(mp.mpf(0.11))
            for c in (proven.c_retreat_enclosure.lower, proven.c_retreat_enclosure.upper)
        ]
    assert ends[0] > 0 > ends[1] or ends[0] < 0 < ends[1]


def test_a_coupling_above_the_fold_is_not_said_to_be_below_it():
    """The proof that no front moves must fail where one does."""
    with flint.ctx.workprec(BITS):
        target = 2 * certified_thresholds.ball_ratio(flint, 0.03125)
        assert certified_thresholds._never_moves(flint, 0.4337, target, 0.189)
        assert not certified_thresholds._never_moves(flint, 0.434, target, 0.0)
        assert not certified_thresholds._never_moves(flint, 0.434, target, 0.189)


def test_a_branch_left_out_by_the_search_is_noticed():
    from dataclasses import replace

    answer = fr.kinetic_relation(0.45, 0.03125)
    lost = certify_relation(replace(answer, branches=answer.branches[:1]))
    assert not lost.certified
    assert len(lost.v_enclosures) == 2
    assert "2 velocities are proven, and 1 were computed" in lost.unproven[0]
    off = replace(answer.branches[0], v=answer.branches[0].v + 1e-9)
    moved = certify_relation(replace(answer, branches=(off, answer.branches[1])))
    assert "farther than its error" in moved.unproven[0]


def test_where_resonances_are_too_many_the_part_without_a_proof_is_named(monkeypatch):
    relation = Relation(flint, flint.arb(30.0), flint.arb(0.5), max_work=5_000)
    with pytest.raises(certified_velocities.WorkLimitError, match="5000 values"):
        certified_velocities.prove_velocities(relation)
    less = partial(Relation, max_work=20_000)  # at this coupling all of it would not do either
    monkeypatch.setattr(certified_relation, "Relation", less)
    proven = fr.kinetic_relation(2e3, 0.03125, certify=True)
    assert not proven.certified
    assert any("the number of velocities is not proven" in each for each in proven.unproven)
    assert proven.c_pin_enclosure is not None


def test_where_the_fold_takes_too_long_to_prove_the_part_that_does_is_named(monkeypatch):
    # enough for the line at this coupling, and not for the boxes below it
    monkeypatch.setattr(certified_thresholds, "Relation", partial(Relation, max_work=30_000))
    eta = 0.062
    fold = fr.kinetic_relation(1.0, eta).c_fold
    with flint.ctx.workprec(BITS):
        target = 2 * certified_thresholds.ball_ratio(flint, eta)
        # below c with 8c(1 + 2c) < 2r nothing is left to show
        halved = (0.99 * fold / 2**k for k in range(1, 20))
        least = next(c for c in halved if 4 * c * (1 + 2 * c) < threshold_ratio(eta))
        part = re.escape(f"|Sum| < 2r for c from {least:.3g} to {0.99 * fold:.6g} and v from ")
        with pytest.raises(certified_velocities.WorkLimitError, match=part):
            certified_thresholds._never_moves(flint, 0.99 * fold, target, 0.0)


def test_two_velocities_that_nearly_meet_are_told_apart_or_left_open():
    fold = fr.kinetic_relation(0.3, 0.03125).c_fold
    proven = fr.kinetic_relation(fold + 1e-10, 0.03125, certify=True)
    assert proven.certified, proven.unproven
    first, second = proven.v_enclosures
    assert first.upper < second.lower
    # Two fronts meet like the square root of the distance from the fold.
    assert 1e-6 < second.lower - first.upper < 1e-3


def test_periodised_form_is_the_real_line_form():
    """The identity on which the balls stand, by quadrature of both sides."""
    value, error = sum_by_quadrature(0.7, 0.9, 1e-7, 2000)
    assert abs(_by_scipy(0.7, 0.9) - value) < error + 1e-9


def test_command_line_certifies_and_names_the_extra_if_it_is_missing(capsys, monkeypatch, refused):
    assert main(shlex.split("kinetic --c 0.5 --eta 0.03125 --certify --json")) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["certified"] is True
    assert answer["unproven"] == []
    (velocity,) = answer["v_enclosures"]
    assert velocity["lower"] < answer["branches"][0]["v"] + 1e-13
    assert set(answer["c_fold_enclosure"]) == {"lower", "upper"}
    assert main(shlex.split("kinetic --c 0.5 --eta 0.03125 --certify")) == 0
    assert ["certified", "yes"] in map(str.split, capsys.readouterr().out.splitlines())
    for line in ("kinetic --c 0.5 --eta 0.03125 --certify", "sum --v 1 --c 1 --method certified"):
        with monkeypatch.context() as without:
            without.setitem(sys.modules, "flint", None)
            assert "excitation-fronts[certify]" in refused(line)["message"]


def test_uncertified_sums_stay_within_their_errors_of_the_proven_ones():
    """A small part of the comparison at 10⁴ random points."""
    random = np.random.default_rng(5)
    v, c = 10.0 ** random.uniform(-2, 2, 60), 10.0 ** random.uniform(-3, 2, 60)
    found = sums(v, c, 1e-13)
    for v_, c_, value, error in zip(v, c, found.value, found.error, strict=True):
        proven = certified_sum(float(v_), float(c_), digits=15)
        assert abs(proven.value - value) <= error + proven.error
