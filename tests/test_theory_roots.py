"""Claims about the roots of the dispersion relation (Eqs. 50-52)."""

from __future__ import annotations

import cmath
import math

import mpmath as mp
import numpy as np
import pytest

from fronts.piecewise.roots import roots
from theory.parameters import ParameterError
from theory.piecewise.certified_roots import certify_roots
from theory.piecewise.dispersion import dispersion, dispersion_slope, onsite, root_free_strip
from theory.piecewise.precise_roots import precise_roots
from theory.piecewise.root_count import (
    count_in_box,
    count_in_strips,
    edge_pieces,
    height_above_roots,
)
from theory.piecewise.roots import (
    MAX_LABEL,
    labelled_roots,
    nearest_roots,
    roots_within,
    strip_bounds,
)
from verification.quantities.problems import PROBLEMS, Problem

SUM = PROBLEMS["sum"]
LABELS = np.arange(-12, 13)
HALF_PLANES = [pytest.param(True, id="above"), pytest.param(False, id="below")]
# Where labels meet or seeds collide: the first two resonances of c = 100 and of c = 10, v just
# below and above c (a double root of the real part), and the naive Lambert argument's underflow.
MEETINGS = [(72.4611, 100.0), (21.7233, 100.0), (7.24611, 10.0), (0.999999, 1.0), (1.000001, 1.0)]
MEETINGS += [(1e-11, 1.0), (1e-6, 1e6), (1e6, 1e-6), (1e11, 1e11), (1e-11, 1e-11)]


def printed_dispersion(k: complex, v: float, c: float) -> mp.mpc:
    """Return L(k), Eq. (50) as printed, at the current precision of mpmath."""
    return -1j * mp.mpf(v) * k - 2j * mp.mpf(c) * mp.sin(k / 2) ** 2 + mp.mpf("0.5")


def true_root(k: complex, v: float, c: float) -> mp.mpc:
    """Newton from k, with the slope by a divided difference; 40 digits."""
    with mp.workdps(80):
        z, h = mp.mpc(k), mp.mpf(10) ** -35
        for _ in range(8):
            at = printed_dispersion(z, v, c)
            slope = (printed_dispersion(z + h, v, c) - printed_dispersion(z - h, v, c)) / (2 * h)
            z -= at / slope
            # 80 digits less those the difference loses; L is that small only at a root
            if abs(at) < mp.mpf(10) ** -30 * (1 + v * abs(z)):
                return z
        raise AssertionError(f"no root near {k}")


def winding(v: float, c: float, corners: list[complex], points: int) -> int:
    """Count roots in a polygon by plain dense sampling of the argument of L."""
    edge = np.concatenate(
        [
            np.linspace(a, b, points, endpoint=False)
            for a, b in zip(corners, corners[1:] + corners[:1], strict=True)
        ]
    )
    value = -1j * v * edge - 1j * c * (1 - np.cos(edge)) + 0.5
    turn = np.angle(np.roll(value, -1) / value)
    assert np.max(np.abs(turn)) < 1.5  # dense enough that no half turn can hide
    return round(float(np.sum(turn)) / (2 * math.pi))


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(math.log(low), math.log(high))))


def test_the_coded_relation_and_slope_are_the_printed_ones() -> None:
    rng = np.random.default_rng(1)
    for _ in range(20):
        v, c = rng.uniform(0.1, 3, 2)
        k = complex(rng.uniform(-9, 9), rng.uniform(-3, 3))
        with mp.workdps(30):
            exact = printed_dispersion(mp.mpc(k), v, c)
            still = printed_dispersion(mp.mpc(k), 0.0, c)
            slope = mp.diff(lambda z, v=v, c=c: printed_dispersion(z, v, c), mp.mpc(k))
        # a few roundings of numbers no larger than 3 (1 + cosh 3) + 3·10
        assert abs(complex(dispersion(np.array(k), v, c)) - complex(exact)) < 1e-13
        assert abs(complex(onsite(np.array(k), c)) - complex(still)) < 1e-13
        assert abs(complex(dispersion_slope(np.array(k), v, c)) - complex(slope)) < 1e-13


def test_the_printed_slope_51_is_the_derivative_on_the_roots() -> None:
    k = nearest_roots(0.3, 0.5, 20, upper=True).k
    printed = -1 / (2 * k) + (2j * 0.5 / k) * np.sin(k / 2) ** 2 - 0.5j * np.sin(k)
    # 1e-13: rounding of terms of size c cosh(Im k) < 30
    assert np.max(np.abs(printed - dispersion_slope(k, 0.3, 0.5))) < 1e-13


@pytest.mark.parametrize("upper", HALF_PLANES)
@pytest.mark.parametrize("problem", SUM, ids=lambda problem: problem.name)
def test_the_labels_of_every_problem_are_complete(problem: Problem, upper: bool) -> None:
    roots = labelled_roots(problem.v, problem.c, LABELS, upper)
    assert count_in_strips(problem.v, problem.c, LABELS, upper) == LABELS.size
    assert np.unique(roots.k).size == LABELS.size


def test_roots_are_complete_over_many_decades_of_v_over_c_and_of_c() -> None:
    for c in np.logspace(-7, 7, 8):
        for ratio in np.logspace(-7, 7, 15):
            v = min(max(float(c * ratio), 1e-12), 1e12)
            for upper in (True, False):
                labels = np.arange(-3, 4)
                roots = labelled_roots(v, float(c), labels, upper)
                counted = count_in_strips(v, float(c), labels, upper)
                assert counted == labels.size, f"v = {v!r}, c = {c!r}, upper = {upper}"
                low, high = strip_bounds(labels, upper)
                assert np.all((low < roots.k.real) & (roots.k.real < high))
                assert np.all((roots.k.imag > 0) == upper)


@pytest.mark.parametrize(("v", "c"), MEETINGS)
@pytest.mark.parametrize("upper", HALF_PLANES)
def test_roots_are_complete_where_labels_meet(v: float, c: float, upper: bool) -> None:
    labels = np.arange(-5, 6)
    roots = labelled_roots(v, c, labels, upper)
    assert count_in_strips(v, c, labels, upper) == labels.size
    gap = np.abs(roots.k[:, None] - roots.k[None, :])[~np.eye(labels.size, dtype=bool)]
    assert gap.min() > 2 * roots.radius.max()  # no root is listed twice


def test_the_count_agrees_with_plain_sampling_of_the_argument() -> None:
    seed = 2
    rng = np.random.default_rng(seed)
    for trial in range(30):
        v, c = log_uniform(rng, 0.03, 30), log_uniform(rng, 0.03, 30)
        x, y = np.sort(rng.uniform(-30, 30, 2)), np.sort(rng.uniform(-6, 6, 2))
        corners = [complex(x[0], y[0]), complex(x[1], y[0]), complex(*[x[1], y[1]])]
        corners.append(complex(x[0], y[1]))
        counted = count_in_box(v, c, x_low=x[0], x_high=x[1], y_low=y[0], y_high=y[1])
        assert counted == winding(v, c, corners, 40_000), f"seed {seed}, trial {trial}"


def test_boxes_of_any_shape_hold_as_many_roots_as_are_listed() -> None:
    seed = 3
    rng = np.random.default_rng(seed)
    for trial in range(40):
        v, c = log_uniform(rng, 1e-3, 1e3), log_uniform(rng, 1e-3, 1e3)
        x = np.sort(rng.uniform(-60, 60, 2))
        y = np.sort(rng.uniform(-8, 8, 2))
        listed = [labelled_roots(v, c, np.arange(-15, 16), upper).k for upper in (True, False)]
        k = np.concatenate(listed)
        inside = (k.real > x[0]) & (k.real < x[1]) & (k.imag > y[0]) & (k.imag < y[1])
        counted = count_in_box(v, c, x_low=x[0], x_high=x[1], y_low=y[0], y_high=y[1])
        assert counted == int(inside.sum()), f"seed {seed}, trial {trial}: v = {v!r}, c = {c!r}"


def test_on_each_certain_piece_of_an_edge_the_argument_turns_less_than_half() -> None:
    v, c = 7.4, 100.0
    start, end = 0.3 + 0.001j, 30.0 + 0.001j
    a, b = edge_pieces(v, c, start, end)
    assert abs(np.sum(b - a) - (end - start)) < 1e-9  # rounding of a thousand summands
    part = np.linspace(0, 1, 201)[:, None]
    value = dispersion(a + part * (b - a), v, c)
    middle = dispersion(0.5 * (a + b), v, c)
    assert np.all((value / middle).real > 0)


def test_no_root_lies_above_the_height_the_count_uses() -> None:
    seed = 4
    rng = np.random.default_rng(seed)
    for _ in range(200):
        v, c = log_uniform(rng, 1e-9, 1e9), log_uniform(rng, 1e-9, 1e9)
        for upper in (True, False):
            k = labelled_roots(v, c, np.arange(-4, 5), upper).k
            extent = float(np.abs(k.real).max())
            highest = float(np.abs(k.imag).max())
            assert highest < height_above_roots(v, c, extent), f"seed {seed}: {v!r}, {c!r}"


@pytest.mark.parametrize("upper", HALF_PLANES)
def test_the_radius_bounds_the_distance_to_the_true_root(upper: bool) -> None:
    seed = 5
    rng = np.random.default_rng(seed)
    places = [(p.v, p.c) for p in SUM] + MEETINGS
    places += [(log_uniform(rng, 1e-9, 1e9), log_uniform(rng, 1e-9, 1e9)) for _ in range(20)]
    for v, c in places:
        roots = labelled_roots(v, c, np.array([-7, -1, 0, 1, 6]), upper)
        for k, radius in zip(roots.k.tolist(), roots.radius.tolist(), strict=True):
            distance = float(abs(true_root(k, v, c) - k))
            assert distance <= radius, f"seed {seed}: v = {v!r}, c = {c!r}, k = {k}"
            # A radius must also say something. The condition number of a root is about
            # |c k/L_k| ≤ 1e4 in these places, which leaves twelve digits.
            assert radius < 1e-10 * max(1.0, abs(k)), f"seed {seed}: v = {v!r}, c = {c!r}"


def test_the_residual_is_what_l_gives_there() -> None:
    roots = labelled_roots(0.3, 0.5, LABELS, upper=True)
    for k, residual in zip(roots.k.tolist(), roots.residual.tolist(), strict=True):
        with mp.workdps(40):
            exact = float(abs(printed_dispersion(mp.mpc(k), 0.3, 0.5)))
        # rounding of terms of size v |k| < 25
        assert abs(residual - exact) < 3e-14


@pytest.mark.parametrize("upper", HALF_PLANES)
@pytest.mark.parametrize("moving", ["v", "c"])
def test_each_label_follows_one_root_continuously(moving: str, upper: bool) -> None:
    """Steps are halved until every root moves by less than half the gap to any other root."""
    inner = slice(4, -4)

    def positions(logarithm: float) -> tuple[np.ndarray, np.ndarray]:
        scale = math.exp(logarithm)
        v, c = (0.6 * scale, 2.0) if moving == "v" else (0.6, 2.0 * scale)
        mine = labelled_roots(v, c, LABELS, upper).k
        return mine[inner], np.concatenate([mine, labelled_roots(v, c, LABELS, not upper).k])

    at, step = math.log(1e-4), 0.1
    here, everyone = positions(at)
    while at < math.log(1e4):
        there, _ = positions(at + step)
        gap = np.abs(everyone[:, None] - here[None, :])
        gap[gap == 0.0] = np.inf
        if np.all(np.abs(there - here) < 0.5 * gap.min(axis=0)):
            at, step = at + step, 1.5 * step
            here, everyone = positions(at)
        else:
            step *= 0.5
            assert step > 1e-6, f"a label jumps at {moving} scaled by {math.exp(at)}"


def test_as_v_vanishes_each_root_goes_to_the_closed_form_of_its_strip() -> None:
    # At v = 0, cos k = 1 + i/(2c); the root moves by O(v).
    c, v = 0.8, 1e-9
    still = cmath.acos(1 + 0.5j / c)
    still = still if still.imag > 0 else -still
    for label in range(-2, 3):
        found = complex(labelled_roots(v, c, np.array([label]), upper=True).k[0])
        target = still + 2 * math.pi * label
        target -= 2 * math.pi * round((target.real - (2 * label - 0.5) * math.pi) / (2 * math.pi))
        assert abs(found - target) < 1e-7


@pytest.mark.parametrize("upper", HALF_PLANES)
def test_the_nearest_roots_are_the_nearest_of_a_much_larger_set(upper: bool) -> None:
    for problem in SUM:
        count = 31
        found = nearest_roots(problem.v, problem.c, count, upper)
        every = labelled_roots(problem.v, problem.c, np.arange(-400, 401), upper)
        size = np.sort(np.abs(every.k))[:count]
        assert np.all(np.diff(np.abs(found.k)) >= 0)
        # the same numbers, from vectors of another length
        assert np.allclose(np.abs(found.k), size, rtol=1e-13, atol=0)
        assert found.labels.size == np.unique(found.labels).size == count


@pytest.mark.parametrize("upper", HALF_PLANES)
def test_the_roots_within_an_extent_are_those_the_argument_principle_counts(upper: bool) -> None:
    for v, c, extent in ((0.3, 0.5, 50.0), (7.4, 100.0, 33.0), (1e3, 1e-3, 70.0), (1e-3, 3.0, 9.0)):
        found = roots_within(v, c, extent, upper)
        height = height_above_roots(v, c, extent)
        low, high = (0.0, height) if upper else (-height, 0.0)
        assert found.k.size == count_in_box(
            v, c, x_low=-extent, x_high=extent, y_low=low, y_high=high
        )
        assert np.all(np.diff(np.abs(found.k)) >= 0)


def test_two_thousand_roots_each_lie_within_their_radius_of_a_distinct_strip() -> None:
    roots = nearest_roots(0.3, 0.5, 2000, upper=True)
    low, high = strip_bounds(roots.labels, True)
    assert np.all((roots.k.real - roots.radius > low) & (roots.k.real + roots.radius < high))
    assert np.unique(roots.labels).size == 2000


@pytest.mark.parametrize("upper", HALF_PLANES)
def test_precise_roots_solve_the_printed_relation_to_the_digits_asked(upper: bool) -> None:
    for v, c in (("0.3", "0.5"), ("72.46", "100"), ("1e-3", "1e3"), ("1000", "1e-3")):
        for digits in (3, 20, 50):
            labels = np.array([-9, -1, 0, 1, 8])
            roots = precise_roots(v, c, labels, upper, digits)
            low, high = strip_bounds(labels, upper)
            for n, k in enumerate(roots):
                with mp.workdps(digits + 40):
                    slope = abs(mp.mpf(v) + mp.mpf(c) * mp.sin(k))
                    k0 = mp.mpc(k)
                    shift = abs(
                        -1j * mp.mpf(v) * k0 - 2j * mp.mpf(c) * mp.sin(k0 / 2) ** 2 + mp.mpf("0.5")
                    )
                    assert shift / slope < mp.mpf(10) ** -digits * abs(k0)
                    assert low[n] < k0.real < high[n]


def test_a_string_is_a_decimal_and_a_float_is_binary() -> None:
    label = np.array([0])
    decimal = precise_roots("0.3", "0.5", label, True, 40)[0]
    binary = precise_roots(0.3, 0.5, label, True, 40)[0]
    # 0.3 as a double is 1.1e-17 too small
    assert mp.mpf("1e-19") < abs(decimal - binary) < mp.mpf("1e-16")


@pytest.mark.parametrize("upper", HALF_PLANES)
def test_certified_balls_hold_the_true_root_and_their_count_is_certified(upper: bool) -> None:
    pytest.importorskip("flint")
    # In the last one roots lie nearer to the edges of their strips than doubles do to each other.
    places = [(0.3, 0.5), (72.46, 100.0), (1e-3, 0.5), (1e3, 1e-3), (1e9, 1e-9)]
    for v, c in places:
        labels = np.arange(-4, 5)
        certified = certify_roots(v, c, labels, upper)
        assert certified.counted == labels.size
        plain = labelled_roots(v, c, labels, upper)
        assert np.all(np.abs(certified.roots.k - plain.k) <= plain.radius)
        for k, radius in zip(certified.roots.k.tolist(), certified.roots.radius, strict=True):
            assert float(abs(true_root(k, v, c) - k)) <= radius < 1e-10 * max(1.0, abs(k))


def test_an_edge_through_a_root_is_refused() -> None:
    k = complex(nearest_roots(0.3, 0.5, 1, upper=True).k[0])
    with pytest.raises(ValueError, match="move the edge"):
        count_in_box(0.3, 0.5, x_low=k.real, x_high=5.0, y_low=0.0, y_high=5.0)


def test_no_root_is_real_since_re_l_is_one_half_there() -> None:
    x = np.linspace(-50, 50, 10_001) + 0j
    for problem in SUM:
        # the real part is the constant ½ with nothing added to it, hence exact
        assert np.all(dispersion(x, problem.v, problem.c).real == 0.5)
        for upper in (True, False):
            k = nearest_roots(problem.v, problem.c, 40, upper)
            assert np.all(np.abs(k.k.imag) > k.radius)


def test_no_root_is_double() -> None:
    """L_k = 0 needs sin k = -v/c; at every such k, |L| keeps a distance from zero."""
    seed = 6
    rng = np.random.default_rng(seed)
    n = np.arange(-20, 21)
    for _ in range(200):
        v, c = log_uniform(rng, 1e-4, 1e4), log_uniform(rng, 1e-4, 1e4)
        if v >= c:
            y = math.acosh(v / c)
            k = np.concatenate([-np.pi / 2 + 2 * np.pi * n + 1j * y * s for s in (1, -1)])
            # |Im L| = |c + v x| with c ≤ v and |x| ≥ π/2
            least = v * (math.pi / 2 - 1)
        else:
            x = math.asin(-v / c)
            k = np.concatenate([x + 2 * np.pi * n, np.pi - x + 2 * np.pi * n]) + 0j
            least = 0.5
        # L_k loses |L_kk| times the rounding of k: ten ulps of numbers up to v, times cosh y = v/c
        assert np.max(np.abs(dispersion_slope(k, v, c))) < 1e-13 * 1e3 * (v + c)
        # 1e-9: rounding of |k| ≤ 130 in v k
        assert np.min(np.abs(dispersion(k, v, c))) > least * (1 - 1e-9), f"seed {seed}: {v}, {c}"
        for upper in (True, False):
            roots = labelled_roots(v, c, np.arange(-3, 4), upper)
            # so at a root the slope outweighs what rounding of the root can do to it
            shift = c * np.cosh(roots.k.imag) * roots.radius
            assert np.all(np.abs(dispersion_slope(roots.k, v, c)) > 2 * shift), f"seed {seed}"


def test_no_root_crosses_the_lines_between_strips() -> None:
    y = np.linspace(0.0, 20.0, 4001)[1:]
    for v, c in ((0.3, 0.5), (1.0, 1.0), (1e-3, 2.0), (50.0, 0.1), (2.0, 300.0)):
        for n in range(-6, 7):
            above = dispersion(n * np.pi + 1j * y, v, c).real
            # sin(nπ) is 1e-15 in floating point and multiplies c sinh y; the exact Re L is ½ + v y
            rounding = 1e-14 * (1 + v * y + c * np.sinh(y))
            assert np.all(np.abs(above - 0.5 - v * y) <= rounding)
            below = -1j * y + n * np.pi
            crossing = np.argmin(np.abs(dispersion(below, v, c).real))
            if (n % 2 == 0 and n <= 0) or (n % 2 == 1 and n > 0):
                imaginary = dispersion(below[crossing : crossing + 1], v, c).imag
                assert abs(imaginary[0]) > 0


@pytest.mark.parametrize("problem", SUM, ids=lambda problem: problem.name)
def test_the_root_free_strip_is_free_of_roots(problem: Problem) -> None:
    v, c = problem.v, problem.c
    s = root_free_strip(v, c)
    for upper in (True, False):
        k = nearest_roots(v, c, 400, upper).k
        assert np.min(np.abs(k.imag)) >= s
    assert count_in_box(v, c, x_low=-40.0, x_high=40.0, y_low=-s, y_high=s) == 0
    with mp.workdps(40):
        exact = mp.findroot(lambda x: c * mp.sinh(x) + v * x - 0.5, s)
        # never more than the true width, and less by no more than a few roundings
        assert 0 <= exact - s < 1e-13 * exact


@pytest.mark.parametrize(
    ("v", "c"), [(-1, 0.5), (1, -2), (0, 1), (np.float64(-1), 0.5), (np.int64(0), 1)]
)
def test_whole_numbers_are_checked_like_others(v: float, c: float) -> None:
    with pytest.raises(ParameterError):
        nearest_roots(v, c, 5, upper=True)
    with pytest.raises(ParameterError):
        labelled_roots(v, c, np.array([0]), upper=True)


@pytest.mark.parametrize("label", [10**8, 10**10, MAX_LABEL - 4])
def test_far_labels_are_found_and_lie_in_their_strips_to_within_rounding(label: int) -> None:
    draw = np.random.default_rng(7)
    for v, c in 10.0 ** draw.uniform(-8.0, 8.0, (30, 2)):
        for upper in (True, False):
            for labels in (np.arange(label, label + 5), -np.arange(label, label + 5)):
                roots = labelled_roots(float(v), float(c), labels, upper)
                low, high = strip_bounds(labels, upper)
                outside = np.maximum(low - roots.k.real, roots.k.real - high)
                assert np.all(outside <= np.spacing(np.abs(low) + np.abs(high)))
                k, radius = complex(roots.k[2]), float(roots.radius[2])
                assert abs(true_root(k, float(v), float(c)) - k) <= radius < 0.1


def test_labels_too_far_for_double_precision_are_refused() -> None:
    farthest = np.iinfo(np.int64)
    for label in (MAX_LABEL + 1, -MAX_LABEL - 1, farthest.min, farthest.max):
        with pytest.raises(ParameterError, match=r"label = .* take labels nearer 0"):
            labelled_roots(0.3, 0.5, np.array([0, label]), upper=True)


@pytest.mark.parametrize("certify", [False, True])
@pytest.mark.parametrize(("v", "c"), [("0.3", "0.5"), (0.3, 0.5), ("0.1", "0.7")])
def test_a_radius_holds_the_root_of_the_number_that_was_given(
    v: float | str, c: float | str, certify: bool
) -> None:
    """Of a decimal as it is written, of a float as the binary number that it is."""
    if certify:
        pytest.importorskip("flint")
    found = roots(v, c, extent=20.0, certify=certify)
    with mp.workdps(40):
        v_, c_ = mp.mpf(v), mp.mpf(c)
        for root in (*found.upper, *found.lower):
            k = mp.mpc(root.re, root.im)
            for _ in range(4):
                slope = -1j * (v_ + c_ * mp.sin(k))
                k -= (0.5 - 2j * c_ * mp.sin(k / 2) ** 2 - 1j * v_ * k) / slope
            assert abs(k - mp.mpc(root.re, root.im)) <= root.radius


def test_digits_beyond_those_of_doubles_are_not_said_to_be_certified() -> None:
    with pytest.raises(
        ParameterError,
        match=r"digits = 30 .* certified radii are available in double precision only",
    ):
        roots(0.3, 0.5, digits=30, certify=True)


def test_of_hundreds_of_digits_the_radius_is_no_zero() -> None:
    assert roots("0.3", "0.5", count=1, digits=340).upper[0].radius > 0.0
