"""The two rules behind Σ(v, c): what they leave out, what they cost, what they state."""

from __future__ import annotations

import inspect
import math
import os
import re
import signal
import time
from pathlib import Path
from typing import Any

import mpmath as mp
import numpy as np
import numpy.typing as npt
import pytest
from numba import njit
from numba.core.ccallback import CFunc
from numba.core.dispatcher import Dispatcher

from theory.interruption import compile_uninterrupted
from theory.parameters import ParameterError
from theory.piecewise.roots import labelled_roots
from theory.piecewise.sums import arithmetic, axis, beside_roots, compiled, poles, segments
from theory.piecewise.sums.integral import MANY, sum_by_integral, sums
from theory.piecewise.sums.precise import departing_labels, precise_sum_by_integral
from theory.piecewise.sums.series import sum_by_roots

ComplexArray = npt.NDArray[np.complex128]
FloatArray = npt.NDArray[np.float64]
VELOCITIES = [0.08, 0.11, 0.16, 0.24, 0.4, 0.7, 1.1, 2.0, 5.0, 20.0, 300.0, 1e4, 1e8]


def roots_beside(v: float, c: float, paired: bool) -> ComplexArray:
    """Return the root nearest -i/2v, and the pair that meets in resonance, by their labels."""
    below = labelled_roots(v, c, np.array([0, -1]), upper=False).k
    above = labelled_roots(v, c, np.array([0]), upper=True).k
    return np.concatenate([below[:1], above, below[1:]]) if paired else below[:1]


def coth(z: ComplexArray) -> ComplexArray:
    return np.asarray(1 / np.tanh(z))


@pytest.mark.parametrize("rho", [1e-3, 0.05, 0.3, 0.6, 0.9, 1.0, 1.01, 1.2, 1.38, 1.8, 2.5, 3.0])
def test_what_the_points_on_the_axis_leave_is_as_small_as_stated(rho: float) -> None:
    """|G̃| ≤ M/(1 + c) on the line to which the bound of the rule refers."""
    paired = rho > 1.0
    depth = math.acosh(9 / rho - 1) - 0.25 if paired else math.acosh(1.7 / rho)
    k = np.linspace(-np.pi, np.pi, 800, endpoint=False) + 1j * depth
    for v in VELOCITIES:
        c = rho * v
        A = 0.5 - 1j * c * (1 - np.cos(k))
        left = (coth((A / v + 1j * k) / 2) + coth((A / v - 1j * k) / 2)) / (4 * A)
        for root in roots_beside(v, c, paired):
            slope = -1j * (v + c * np.sin(root))
            # near the root coth(L/2v)/4A = (1/2i)/(root L_k)/(k - root), and G is even
            near = 1 / np.tan((k - root) / 2) - 1 / np.tan((k + root) / 2)
            left -= 0.25 * near / (1j * root * slope)
        assert np.abs(left).max() * (1 + c) <= (1.0 if paired else 2.5), (v, c)


def left_on_a_segment(v: float, c: float, psi: float, depth: float) -> float:
    """Return (1/π)∫|g̃| du along Im u = depth, S from hyperbolic functions and not from e^{-a}."""
    A_0 = 0.5 + (2j * c if psi else 0)
    u = np.arange(-12, 12, 0.01) + 1j * depth
    m = 0.5 * v / c
    Y, A = m * u * u, A_0 + v * u * u
    a = 0.5 / v + 1j * psi + u * u
    k_u = 2 * np.exp(0.25j * np.pi) * math.sqrt(m) / np.sqrt(1 - 1j * Y)
    k = 2 * np.arcsin(np.exp(0.25j * np.pi) * math.sqrt(m) * u)
    with np.errstate(over="ignore", invalid="ignore"):
        rest = (coth((a + 1j * k) / 2) + coth((a - 1j * k) / 2)) / 2 - 1
    g = rest / (2 * A) * k_u
    if v >= axis.SLOWEST:
        for start in poles.two_roots_near(0.5 / v, psi, c / v):
            _, half, cosine = poles.root_near(start, 0.5 / v, psi, c / v)
            at = half / (np.exp(0.25j * np.pi) * math.sqrt(m))
            A_p = A_0 - 2j * c * half * half
            t = -1 / (A_p * (1 + 2 * c / v * half * cosine))
            g -= t / 2j * 2 * at / (u * u - at * at)
    if not psi and v >= axis.SLOWEST:  # the pole of -1/2A
        at = 1j / math.sqrt(2 * v)
        k_at = 2 * np.exp(0.25j * np.pi) * math.sqrt(m) / np.sqrt(1 + 0.25j / c)
        g += k_at / (4 * v * at) * 2 * at / (u * u - at * at)
    return float(np.sum(np.abs(g)) * 0.01 / np.pi)


@pytest.mark.parametrize(
    "rho", [3.01, 3.14, 3.15, 3.6, 4.4, 5.2, 6.29, 6.31, 9.0, 9.42, 9.43, 60.0, 1e4]
)
def test_what_the_segments_leave_is_as_small_as_stated(rho: float) -> None:
    for v in [0.02, 0.05, *VELOCITIES]:
        c = rho * v
        psi = 2 * rho % (2 * np.pi) - np.pi
        for second in (False, True):
            far = abs(1 + 4j * c) if second else 1.0
            stated = segments._segment_size(rho, far, second)
            depth = 1.0 if second else 1.6
            assert left_on_a_segment(v, c, psi if second else 0.0, depth) <= stated, (v, c, second)


def test_the_cost_does_not_depend_on_the_coupling_along_the_velocities_of_fronts() -> None:
    """So many points as cost less than a root, or some thirty; from c = 1e-8 to 1e8."""
    for c in 10.0 ** np.arange(-8, 9):
        found = sums(math.sqrt(c) * np.geomspace(1 / 3, 3, 41), c, 1e-12)
        assert found.points.max() <= axis.MAX_PLAIN // 2
        assert found.error.max() < 2e-12


def points_at_random(seed: int, count: int) -> list[tuple[float, float]]:
    """Return points over all decades, near c = v, near v = √c, and beside resonance."""
    rng = np.random.default_rng(seed)
    anywhere = 10 ** rng.uniform(-6, 6, (count, 2))
    near = 10 ** np.stack([rng.uniform(-1.6, 6, count), rng.uniform(-1, 1, count)], 1)
    near[:, 1] *= near[:, 0]
    own = 10 ** np.stack([rng.uniform(-0.5, 0.5, count), rng.uniform(-8, 8, count)], 1)
    own[:, 0] *= np.sqrt(own[:, 1])
    v = 10 ** rng.uniform(0, 7, count)
    # v/c = (1 - cos k)/(k + 2πj) = sin k at the first three resonances
    resonant = np.array([0.7246113537767086, 0.21466068838601868, 0.12784492257479427])
    beside = v / resonant[np.arange(count) % 3]
    beside *= 1 + 10 ** rng.uniform(-9, -0.5, count) * rng.choice([-1, 1], count)
    every = np.concatenate([anywhere, near, own, np.stack([v, beside], 1)])
    return [(float(v), float(c)) for v, c in every]


def test_the_stated_error_bounds_the_true_one_one_by_one_and_in_an_array() -> None:
    points = points_at_random(31, 4)
    exact = [sum_by_roots(v, c, 20) for v, c in points]
    for tolerance in (1e-3, 1e-7, 1e-12, 1e-15):
        array = sums(*np.array(points).T, tolerance)
        for n, (v, c) in enumerate(points):
            one = sum_by_integral(v, c, tolerance)
            for value, error in ((one.value, one.error), (array.value[n], array.error[n])):
                with mp.workdps(30):
                    off = float(abs(mp.mpc(value) - exact[n].value))
                assert off <= error + float(exact[n].error), (v, c, tolerance)


@pytest.mark.parametrize(
    ("v", "c", "tolerance"),
    [
        *((*at, 1e-13) for at in [*points_at_random(32, 1), (7e5, 1.0), (0.3, 0.5), (2.0, 40.0)]),
        # of some thousand at random those whose error is nearest to the bound: by each rule
        (0.06504232, 0.11753616, 0.00474485),
        (5.68970679, 5.54716596, 2.56557423e-05),
        (2.02474561, 6.94737594, 4.48585161e-08),
        # where two compilations differ most: a root of the resonant pair beside a point
        (454360.99281176605, 627040.8705353825, 1e-15),
    ],
)
def test_the_stated_errors_of_the_derivatives_bound_the_true_ones(
    v: float, c: float, tolerance: float
) -> None:
    found = sums(v, c, tolerance, slopes=True)
    assert found.by_v is not None
    assert found.error_by_v is not None
    assert found.by_c is not None
    assert found.error_by_c is not None
    with mp.workdps(60):
        step = mp.mpf(10) ** -15  # the resonance is 1e-7 wide, relative to v = 5e6

        def exact(v: mp.mpf, c: mp.mpf) -> mp.mpc:
            return sum_by_roots(mp.nstr(v, 50), mp.nstr(c, 50), 30).value

        v_, c_ = mp.mpf(v), mp.mpf(c)
        by_v = (exact(v_ * (1 + step), c_) - exact(v_ * (1 - step), c_)) / (2 * step * v_)
        by_c = (exact(v_, c_ * (1 + step)) - exact(v_, c_ * (1 - step))) / (2 * step * c_)
        # the differences err by 1e-30/1e-15, and by 1e-30 of third derivatives, at most 1e15
        assert abs(by_v - complex(found.by_v)) <= float(found.error_by_v) + 1e-14 / v
        assert abs(by_c - complex(found.by_c)) <= float(found.error_by_c) + 1e-14 / c


def points_at_which_roots_are_taken_away(seed: int, count: int) -> tuple[FloatArray, FloatArray]:
    """Return v and c of each kind at random, and fronts of c ≥ 10."""
    rng = np.random.default_rng(seed)
    v, c = np.array(points_at_random(seed, count)).T
    strong = 10 ** rng.uniform(1, 8, 4 * count)
    fast = np.sqrt(strong) * 3.0 ** rng.uniform(-1, 1, strong.size)
    # and where a root lies beside a node of the second segment, whose nodes then begin at u = 0
    v, c = np.append(v, [*fast, 828.5864188974699]), np.append(c, [*strong, 11685.06286414494])
    beside = axis.plan(v, c, 1e-12)[0] == 0
    return v[beside], c[beside]


@pytest.mark.parametrize("slopes", [False, True])
def test_compiled_or_not_the_rules_give_the_same(slopes: bool) -> None:
    """Roots in loops over many values, and in one that knows of no other."""
    v, c = points_at_which_roots_are_taken_away(33, 60)
    plain, fast = (sums(v, c, 1e-12, slopes, compiled) for compiled in (False, True))
    assert v.size > 100
    assert np.array_equal(plain.points, fast.points)
    np.testing.assert_allclose(fast.error, plain.error, rtol=1e-3)
    # the truncation is the same: what is left are roundings
    assert (np.abs(plain.value - fast.value) <= 2 * (plain.error - 3e-13).clip(1e-14)).all()
    if slopes:
        assert (np.abs(plain.by_v - fast.by_v) <= 0.2 * plain.error_by_v).all()
        assert (np.abs(plain.by_c - fast.by_c) <= 0.2 * plain.error_by_c).all()


@pytest.mark.parametrize(
    ("name", "arguments", "tolerance"),
    [
        ("exponential", np.linspace(-699.0, 699.0, 999), 3e-16),
        ("exponential", np.linspace(-1.0, 1.0, 999), 3e-16),
        ("logarithm", np.linspace(1.0, 3.0, 999), 1e-15),
        ("logarithm", np.geomspace(1.0, 1e300, 999), 1e-15),
    ],
)
def test_functions_without_branches_are_those_of_python(
    name: str, arguments: FloatArray, tolerance: float
) -> None:
    plain, other = (getattr(arithmetic, name + end) for end in ("", "_without_branches"))
    for x in arguments.tolist():
        assert abs(other(x) - plain(x)) <= tolerance * abs(plain(x)), x


def test_exponents_without_branches_are_limited() -> None:
    assert arithmetic.exponential_without_branches(-700.1) == 0.0
    assert arithmetic.exponential_without_branches(-5e9) == 0.0
    for x in (701.0, 1e300):
        assert arithmetic.exponential_without_branches(x) == pytest.approx(math.exp(700.0))


@pytest.mark.parametrize("x", [0.0, 3.0, 2.0 * math.pi, 6.3, 700.0, 1e7, 1e15, 1e40])
def test_a_remainder_without_branches_is_known_to_the_rounding_of_the_number(x: float) -> None:
    found = arithmetic.remainder_without_branches(x, 2.0 * math.pi)
    assert 0.0 <= found <= 2.0 * math.pi
    apart = abs(found - arithmetic.remainder(x, 2.0 * math.pi))
    assert min(apart, 2.0 * math.pi - apart) <= 2.0 * math.ulp(x)


def test_a_name_means_the_same_in_all_modules_that_are_compiled_together() -> None:
    """Their functions share one namespace, in which the last module would win."""
    found: dict[str, Any] = {}
    for module in compiled._MODULES:
        for name, value in vars(module).items():
            if not name.startswith("__"):
                assert found.setdefault(name, value) == value, name


@pytest.mark.parametrize("fast", [False, True])
def test_at_negligible_coupling_the_sum_vanishes_at_every_velocity(fast: bool) -> None:
    """Σ = 0 at c = 0; the root on the axis is then the only one, and others are far away."""
    v = np.array([1e20, 1e19, 1e15, 1e3])
    found = sums(v, np.full(v.size, 1e-20), 1e-12, slopes=True, compiled=fast)
    assert (np.abs(found.value) <= found.error).all()
    assert found.error.max() < 1e-12
    assert (np.abs(found.by_v) <= found.error_by_v).all()
    assert np.isfinite(found.by_c).all()


def test_roots_that_do_not_settle_are_computed_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    v, c = points_at_which_roots_are_taken_away(39, 10)
    monkeypatch.setattr(beside_roots, "_MAX_STEPS", 1)
    plain, fast = (sums(v, c, 1e-12, compiled=compiled) for compiled in (False, True))
    assert (plain.value == fast.value).sum() > v.size // 2
    assert (np.abs(plain.value - fast.value) <= 2 * (plain.error - 3e-13).clip(1e-14)).all()


def test_what_a_value_becomes_does_not_depend_on_those_beside_it() -> None:
    v, c = points_at_which_roots_are_taken_away(37, 40)
    together = sums(v, c, 1e-12, slopes=True, compiled=True)
    for some in (slice(0, 1), slice(3, 17), slice(None, None, -1)):
        apart = sums(v[some], c[some], 1e-12, slopes=True, compiled=True)
        for name in ("value", "error", "by_v", "by_c", "error_by_v", "error_by_c", "points"):
            assert np.array_equal(getattr(together, name)[some], getattr(apart, name)), name


def test_along_the_velocities_of_fronts_the_compiled_error_bounds_the_true_one() -> None:
    """From c = 1e-8 to 1e8, beside the series over the roots, which shares no code."""
    rng = np.random.default_rng(38)
    c = 10 ** np.linspace(-8, 8, 17)
    v = np.sqrt(c) * 3.0 ** rng.uniform(-1, 1, c.size)
    found = sums(v, c, 1e-12, compiled=True)
    assert found.error.max() < 2e-12
    for i in range(c.size):
        # thousands of roots are computed in double precision
        series = sum_by_roots(float(v[i]), float(c[i]), 20 if c[i] < 1e6 else 15)
        with mp.workdps(30):
            off = float(abs(mp.mpc(complex(found.value[i])) - mp.mpc(series.value)))
        assert off + float(series.error) <= found.error[i]


@pytest.mark.parametrize("slopes", [False, True])
def test_many_values_at_once_are_as_good_as_single_ones(slopes: bool) -> None:
    """As arrays and in compiled loops, where points on the axis are enough; groups of any size."""
    rng = np.random.default_rng(34)
    v, c = np.exp(rng.uniform(np.log(0.02), np.log(1.5), (2, 1100)))
    plain, fast = (sums(v, c, 1e-12, slopes, compiled) for compiled in (False, True))
    assert np.array_equal(plain.points, fast.points)
    np.testing.assert_allclose(fast.error, plain.error, rtol=1e-6)
    # the truncation is the same, and roundings are below the part of the error that is theirs
    assert (np.abs(plain.value - fast.value) <= 1e-14).all()
    if slopes:
        assert (np.abs(plain.by_v - fast.by_v) <= 0.2 * plain.error_by_v).all()
        assert (np.abs(plain.by_c - fast.by_c) <= 0.2 * plain.error_by_c).all()
    few = sums(v[:40], c[:40], 1e-12, slopes)  # more points than are needed, in fewer groups
    for i in range(6):
        exact = precise_sum_by_integral(float(v[i]), float(c[i]), 20)
        for found in (plain, fast, few):
            assert abs(complex(exact.value) - found.value[i]) <= found.error[i]


def test_what_was_computed_before_does_not_show_in_the_last_digit() -> None:
    rng = np.random.default_rng(36)
    v, c = np.exp(rng.uniform(np.log(0.02), np.log(40.0), (2, MANY)))
    few = slice(0, 300)
    before = sums(v[few], c[few], 1e-12, slopes=True)
    sums(v, c, 1e-12)  # so many that compiled rules are loaded
    after = sums(v[few], c[few], 1e-12, slopes=True)
    for name in ("value", "error", "by_v", "by_c", "error_by_v", "error_by_c", "points"):
        assert np.array_equal(getattr(before, name), getattr(after, name)), name


def fast_sum(v: float, c: float) -> mp.mpc:
    """Return Σ at v ≥ c/3, v ≫ 1, from the real line, less the same at c = 0, where Σ = 0."""
    with mp.workdps(40):
        v_, c_ = mp.mpf(v), mp.mpf(c)

        def integrand(k: mp.mpf) -> mp.mpc:
            A, onsite, x2 = mp.mpf(0.5) - 1j * c_ * (1 - mp.cos(k)), mp.mpf(0.25), (v_ * k) ** 2
            return (onsite - A * A) / ((A * A + x2) * (onsite + x2))

        decades = [mp.mpf(10) ** j / v_ for j in range(-3, int(mp.log10(v)) + 1)]
        return v_ / mp.pi * mp.quad(integrand, [0, *decades, *mp.linspace(mp.pi, 9 * mp.pi, 9)])


@pytest.mark.parametrize("compiled", [False, True])
def test_fronts_of_any_velocity_have_a_sum(compiled: bool) -> None:
    for v, c in ((5e16, 1.0), (5.4e16, 1.0), (1e18, 1e-3), (1e20, 1e20), (4e19, 1e20)):
        found = sums([v], [c], 1e-12, compiled=compiled)
        assert abs(complex(fast_sum(v, c)) - found.value[0]) <= found.error[0] < 1e-11


@pytest.mark.parametrize(
    ("v", "c", "said"),
    [(2e20, 1.0, "velocity v = 2e+20"), ([1.0, 0.0], 1.0, "velocity v = 0"),
     (1.0, 1e21, "coupling c = 1e+21"), (1.0, [0.5, math.nan], "coupling c = nan")],
)  # fmt: skip
def test_values_that_the_rules_cannot_compute_are_refused(v, c, said) -> None:
    with pytest.raises(ParameterError, match=re.escape(said)):
        sums(v, c)


def test_no_values_are_an_empty_answer() -> None:
    assert sums(np.empty((0, 3)), 0.5, 1e-12, slopes=True).value.shape == (0, 3)


@pytest.mark.parametrize("others", [([2.0], [3.0]), ([3.0], [0.01])])
@pytest.mark.parametrize(("v", "c"), [(0.0109459291, 1.48574e-20), (0.1, 0.01), (0.15, 1e-6)])
def test_more_points_than_a_value_needs_leave_the_bounds_of_its_slopes(
    v: float, c: float, others: tuple[list[float], list[float]]
) -> None:
    """A few values together are computed with the points of the one that needs most."""
    found = sums([v] * 4 + others[0], [c] * 4 + others[1], 1e-13, slopes=True)
    assert found.points.min() > sums([v], [c], 1e-13).points[0]
    assert found.error_by_v is not None
    assert found.error_by_c is not None
    assert np.all((found.error_by_v > 0) & (found.error_by_v < 1e-6))
    assert np.all((found.error_by_c > 0) & np.isfinite(found.error_by_c))


def test_a_few_values_together_have_the_points_and_bounds_of_the_largest() -> None:
    v, c = np.array([[0.05, 0.2], [0.4, 0.9], [0.4, 0.2], [1.1, 1e-3]]).T
    step = 1e-4  # the differences err by some 1e-8, and the bounds are above 1e-6
    exact, more_v, less_v, more_c, less_c = (
        np.array([complex(sum_by_roots(*at, 14).value) for at in np.array([v * up, c * to]).T])
        for up, to in ((1, 1), (1 + step, 1), (1 - step, 1), (1, 1 + step), (1, 1 - step))
    )
    for tolerance in (1e-2, 1e-6):
        found = sums(v, c, tolerance, slopes=True)
        assert set(found.points) == set(sums([1.1], [0.9], tolerance).points)
        assert found.by_v is not None
        assert found.by_c is not None
        assert np.all(np.abs(found.value - exact) <= found.error)
        assert np.all(np.abs(found.by_v - (more_v - less_v) / (2 * step * v)) <= found.error_by_v)
        assert np.all(np.abs(found.by_c - (more_c - less_c) / (2 * step * c)) <= found.error_by_c)
        assert found.error.max() <= tolerance + 1e-13


def test_the_strip_without_roots_is_free_of_them() -> None:
    """`plain_points` stays below s, c sinh s + vs = ½: its N is more than the rate at s asks."""
    for v, c in points_at_random(35, 100):
        s = min(0.5 / (c + v), math.asinh(0.5 / c))
        for _ in range(50):  # Newton's method, monotonic from above
            s -= (c * math.sinh(s) + v * s - 0.5) / (c * math.cosh(s) + v)
        count, bound = axis.plain_points(v, c, 1e-12)
        assert count % 4 == 0
        assert bound <= 1e-12
        assert count * s >= math.log(1 + 2 / bound)


def test_a_root_at_a_point_of_the_rule_costs_no_digits() -> None:
    """v chosen so that the resonance lies at a point of the rule with the fewest points."""
    c, points = 1e6, 16
    k = (2 * 3 + 1) * math.pi / points
    v = c * (1 - math.cos(k)) / k
    found = sum_by_integral(v, c, 1e-12)
    exact = sum_by_roots(v, c, 25)
    with mp.workdps(30):
        assert float(abs(mp.mpc(found.value) - exact.value)) <= found.error < 2e-12


@pytest.mark.parametrize("v", [0.5, 0.8, 2.0])
@pytest.mark.parametrize("n", [-5, -17])
def test_the_labels_are_those_whose_root_passes_the_middle_of_its_strip(v: float, n: int) -> None:
    # Fact 4: the root of strip n passes Re k = (2n + 1) pi where v (2|n| - 1) pi equals
    c = v * (2 * abs(n) - 1) * math.pi / (1 + math.cosh(0.5 / v))
    root = labelled_roots(v, c, np.array([n]), upper=False).k[0]
    assert root.real == pytest.approx((2 * n + 1) * math.pi, rel=1e-12)
    assert departing_labels(v, c).tolist() == [n - 1, n, n + 1]


def test_compiled_rules_are_kept_beside_the_source_whatever_else_uses_numba(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    monkeypatch.setattr("numba.core.config.CACHE_DIR", str(tmp_path))
    rules: Any = compiled.compiled_rules.__wrapped__()
    folder = Path(rules.block_values.stats.cache_path)
    assert folder == Path(compiled.__file__).parent / "__pycache__"


def test_compiled_rules_of_other_sources_are_kept_for_a_week(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    rules: Any = compiled.compiled_rules.__wrapped__()
    folder, state = Path(rules.block_values.stats.cache_path), compiled._state_of_sources()
    folder.mkdir(parents=True, exist_ok=True)
    names = {
        days: [f"axis.block_values_{days:012x}-3.py312{ending}" for ending in (".nbi", ".1.nbc")]
        for days in (6, 8)
    }
    others = ["blocks.cpython-312.pyc", "other.function-3.py312.nbi", f"a_{8:012x}-3.py312.pyc"]
    for days, name in [*((n, each) for n in names for each in names[n]), *((8, n) for n in others)]:
        (folder / name).touch()
        os.utime(folder / name, (time.time() - days * 86400.0,) * 2)
    compiled.compiled_rules.__wrapped__()
    assert {each.name for each in folder.iterdir()} == {*names[6], *others}
    # Files of numba itself have such names; where those of these sources are, nothing is looked at.
    rules.block_values(np.ones(1), np.ones(1), 4)
    made = [each for each in folder.iterdir() if state in each.name]
    assert len(made) == 2
    for each in made:
        assert compiled._OF_RULES.search(each.name)
    (folder / names[8][0]).touch()
    os.utime(folder / names[8][0], (0.0, 0.0))
    compiled.compiled_rules.__wrapped__()
    assert (folder / names[8][0]).exists()


@pytest.mark.usefixtures("interruptible")
def test_an_interrupt_waits_until_a_rule_is_compiled_where_nothing_else_uses_numba(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plain, reached = inspect.unwrap(Dispatcher.compile), []

    def interrupted(self: Any, signature: Any) -> Any:
        signal.raise_signal(signal.SIGINT)
        reached.append(signature)
        return plain(self, signature)

    monkeypatch.setattr(Dispatcher, "compile", interrupted)
    monkeypatch.setattr(CFunc, "compile", CFunc.compile)  # put back afterwards
    compile_uninterrupted.cache_clear()
    compiled.compiled_rules.__wrapped__()
    with pytest.raises(KeyboardInterrupt):
        njit(lambda x: 2.0 * x)(1.5)
    assert len(reached) == 1
