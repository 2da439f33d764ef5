"""The steps of the search for front velocities, and of the verdict on (47), on made-up curves."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import brentq

from theory.piecewise import admissibility, branch_search

EPS = np.finfo(float).eps


class Curve:
    """g(t), its slope, and the error of g that it states, in place of a kinetic relation."""

    def __init__(self, g: Callable, slope: Callable, error: float = 0.0, by_c: float = 1.0) -> None:
        self.g, self.slope, self.error, self.by_c = g, slope, error, by_c
        self.evaluations = self.calls = 0
        self.case = np.zeros(1, dtype=int)
        self.asked: list[float] = []

    def __call__(self, case: np.ndarray, t: np.ndarray) -> np.ndarray:
        self.asked += t.tolist()
        self.evaluations += t.size
        self.calls += 1
        full = np.full(t.shape, 1.0)
        g, slope = self.g(t) * full, self.slope(t) * full
        return np.array([g, slope, self.error * full, self.by_c * full, 0.0 * full, 0.0 * full])

    def cells(self, points: list[float]) -> np.ndarray:
        t = np.array(points)
        g, d, e = self(np.zeros(t.size, dtype=int), t)[:3]
        self.evaluations = self.calls = 0
        ends = np.stack([t, g, d, e])
        return np.concatenate([ends[:, :-1], ends[:, 1:]])


def line(root: float, slope: float = 1.0, error: float = 0.0) -> Curve:
    return Curve(lambda t: slope * (t - root), lambda t: slope + 0.0 * t, error)


def owners(cells: np.ndarray) -> np.ndarray:
    return np.zeros(cells.shape[1], dtype=int)


@pytest.mark.parametrize("root", [2.25, 2.75])
@pytest.mark.parametrize("slope", [1.0, -3.0])
def test_a_straight_crossing_is_bracketed_at_once(root: float, slope: float) -> None:
    curve = line(root, slope)
    cells = curve.cells([2.0, 3.0])
    owner, found = branch_search._brackets(curve, owners(cells), cells)
    assert owner.tolist() == [0]
    assert (found[0, 0], found[4, 0]) == (2.0, 3.0)
    assert curve.evaluations == 0


def test_a_fold_touched_to_within_rounding_is_found_and_one_missed_by_more_is_not() -> None:
    for gap, solutions in ((0.0, 2), (1e-6, 0)):  # the fold is a double one
        curve = Curve(
            lambda t, gap=gap: (t - 2.3) ** 2 + gap, lambda t: 2.0 * (t - 2.3), error=1e-12
        )
        cells = curve.cells([2.0, 3.0])
        brackets = branch_search._brackets(curve, owners(cells), cells)
        owner, found = branch_search._distinct(curve, *brackets)
        assert owner.size == solutions
        assert np.all(np.abs(found[0] - 2.3) < 1e-6)


def test_beside_a_solution_a_cell_without_one_is_dropped_at_once() -> None:
    curve = Curve(lambda t: t * (1.0 + 0.1 * t), lambda t: 1.0 + 0.2 * t)
    cells = curve.cells([0.001, 1.0])
    owner, _ = branch_search._brackets(curve, owners(cells), cells)
    assert owner.size == curve.evaluations == 0


def test_a_cell_is_dropped_where_twice_its_steepest_slope_does_not_reach_zero_from_both_ends() -> (
    None
):
    # from 2.23 and 0.98, at the slope 2 × 1.56, it takes 1.03 to reach zero
    curve = Curve(lambda t: 2.23 - 0.94 * t - 0.31 * t**2, lambda t: -0.94 - 0.62 * t)
    cells = curve.cells([0.0, 1.0])
    owner, _ = branch_search._brackets(curve, owners(cells), cells)
    assert owner.size == curve.evaluations == 0


def test_a_pair_is_found_where_the_slope_between_the_ends_is_twice_that_at_the_ends() -> None:
    turn, high = 2.0 * math.pi, 0.74

    def fall(t):  # its slope is 1 at both ends and in the middle, and 2 between
        return 1.5 * t - np.sin(2.0 * turn * t) / (4.0 * turn)

    curve = Curve(
        lambda t: high - np.where(t < 0.5, fall(t), fall(1.0 - t)),
        lambda t: np.where(t < 0.5, -1.0, 1.0) * (1.0 + np.sin(turn * t) ** 2),
    )
    cells = curve.cells([0.0, 1.0])
    _, found = branch_search._brackets(curve, owners(cells), cells)
    roots = found[[0, 4]].T.tolist()
    assert len(roots) == 2
    assert all(curve.g(np.float64(a)) * curve.g(np.float64(b)) < 0 for a, b in roots)


def test_a_pair_is_found_beside_one_end_where_only_the_chord_is_steep() -> None:
    # the ends are 1 and 0.002, their slopes 0 and 0.2; the least value, at 0.96, is -0.002
    turn = math.pi / 0.96
    curve = Curve(
        lambda t: 0.498 + 0.5 * np.cos(turn * t), lambda t: -0.5 * turn * np.sin(turn * t)
    )
    cells = curve.cells([0.0, 1.0])
    _, found = branch_search._brackets(curve, owners(cells), cells)
    roots = found[[0, 4]].T.tolist()
    assert len(roots) == 2
    assert all(curve.g(a) * curve.g(b) < 0 for a, b in roots)


def test_slopes_that_agree_hide_no_pair_where_g_does_not_rise_as_they_say() -> None:
    # the slope is -1.5 at both ends of [0, 1], while g rises by 1; its least value is -0.08
    turn = 2.0 * math.pi
    curve = Curve(
        lambda t: 0.1 + t - 2.5 * np.sin(turn * t) / turn,
        lambda t: 1.0 - 2.5 * np.cos(turn * t),
    )
    cells = curve.cells([0.0, 1.0])
    _, found = branch_search._brackets(curve, owners(cells), cells)
    roots = found[[0, 4]].T.tolist()
    assert len(roots) == 2
    assert all(curve.g(a) * curve.g(b) < 0 for a, b in roots)


@pytest.mark.parametrize(("departure", "divided"), [(0.32, False), (0.35, True), (-0.35, True)])
@pytest.mark.parametrize("slopes", [(1.0, 1.0), (-1.0, -1.0), (1.0, 2.9), (2.9, 1.0)])
def test_a_cubic_whose_slope_stays_far_from_zero_has_one_solution(slopes, departure, divided):
    # The slope departs from a line by up to 1.5 times what its mean departs from that of both ends.
    # The smaller one is 1: were it to depart twice as far as for a third, it would reach zero.
    start, end = slopes
    rise = 0.5 * (start + end) - departure
    square, cube = 3.0 * rise - 2.0 * start - end, start + end - 2.0 * rise
    curve = Curve(
        lambda t: ((cube * t + square) * t + start) * t - 0.4 * rise,
        lambda t: (3.0 * cube * t + 2.0 * square) * t + start,
    )
    cells = curve.cells([0.0, 1.0])
    owner, _ = branch_search._brackets(curve, owners(cells), cells)
    assert owner.size == 1
    assert (curve.evaluations > 0) == divided


def parabola(root: float) -> Curve:
    return Curve(lambda t: t**2 - root**2, lambda t: 2.0 * t, error=1e-15)


@pytest.mark.parametrize(
    ("end", "root", "divided"), [(2.9, 2.0, False), (3.1, 2.0, True), (5.0, 0.99, False)]
)
def test_a_cell_with_a_solution_is_divided_until_the_slopes_at_its_ends_are_alike(
    end: float, root: float, divided: bool
) -> None:
    curve = parabola(root)
    cells = curve.cells([1.0, end])
    owner, found = branch_search._brackets(curve, owners(cells), cells)
    assert owner.size == (root > 1.0)
    assert np.all(found[6] < 3.0 * found[2])
    assert (curve.evaluations > 0) == divided


@pytest.mark.parametrize("root", [1.001, 1.1, 1.7, 2.5, 2.999])
def test_beside_a_fold_a_solution_is_found_in_few_steps(root: float) -> None:
    # the slope at one end is three times that at the other, as much as is allowed
    curve = parabola(root)
    cells = curve.cells([1.0, 3.0])
    found = branch_search._polish(curve, owners(cells), cells)
    assert found.v[0] == pytest.approx(math.exp(root), rel=8 * EPS)
    assert curve.calls <= 5


def test_three_solutions_between_slopes_of_one_sign_are_found() -> None:
    turn = 2.0 * math.pi
    curve = Curve(
        lambda t: t - 0.45 + 0.3 * np.sin(turn * t), lambda t: 1.0 + 0.3 * turn * np.cos(turn * t)
    )
    cells = curve.cells([0.0, 1.0])
    _, found = branch_search._brackets(curve, owners(cells), cells)
    assert found.shape[1] == 3


def test_the_guess_is_exact_for_an_inverse_cubic() -> None:
    # t = 2 + g/2 + g^3/8, so that t = 2 at g = 0, whatever the ends
    g = np.array([-0.7, 0.4])
    t, slope = 2.0 + g / 2 + g**3 / 8, 1.0 / (0.5 + 0.375 * g**2)
    cell = np.array([[t[0], g[0], slope[0], 0.0, t[1], g[1], slope[1], 0.0]]).T
    assert branch_search._crossing(cell)[0] == pytest.approx(2.0, rel=4 * EPS)


@pytest.mark.parametrize("slopes", [(0.0, 1.0), (1.0, 0.0), (-9.0, 1.0)])
def test_where_the_cubic_leaves_the_cell_the_guess_is_its_middle(slopes) -> None:
    cell = np.array([[1.0, -1.0, slopes[0], 0.0, 2.0, 3.0, slopes[1], 0.0]]).T
    assert branch_search._crossing(cell)[0] == 1.5


@pytest.mark.parametrize("error", [(1e-12, 0.0), (0.0, 1e-12)])
def test_a_short_cell_is_a_fold_if_either_end_is_zero_to_within_rounding(error) -> None:
    curve = line(0.0)
    rows = [2.0, 1e-13, 1.0, error[0], 2.0 + 5e-11, 1e-13, -1.0, error[1]]
    owner, _ = branch_search._brackets(curve, np.array([0]), np.array([rows]).T)
    assert owner.tolist() == [0]


def bracket(left: float, right: float, below: float, above: float) -> list[float]:
    return [left, below, 1.0, 0.0, right, above, 1.0, 0.0]


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("pair", [False, True])
def test_a_run_of_changes_of_sign_by_rounding_is_one_solution_or_a_pair(
    pair: bool, first: int
) -> None:
    # g is said to be known to 1e-12 only. The brackets of the run change sign by 1e-13; the one
    # far off rises to 1 and belongs to no run; the last is of another case, after or before.
    small = 1e-13
    cells = np.array(
        [
            bracket(5.0, 6.0, -1.0, 1.0),
            bracket(1.0, 1.1, -1.0, small),
            bracket(1.4, 1.5, -small, -1.0 if pair else 1.0),
            bracket(1.2, 1.3, small, -small),
            bracket(1.6, 1.7, -small, small),
        ]
    ).T
    owner = np.array([first, first, first, first, 1 - first])
    flat = Curve(lambda t: 0.0 * t, lambda t: 1.0 + 0.0 * t, error=1e-12)
    kept, found = branch_search._distinct(flat, owner, cells)
    run, lone = ([1.0, 1.4, 5.0] if pair else [1.2, 5.0]), [1.6]
    assert kept.tolist() == sorted([first] * len(run) + [1 - first])
    assert found[0].tolist() == (run + lone if first == 0 else lone + run)
    # g is looked at midway between neighbours of one case
    assert flat.asked == pytest.approx([1.15, 1.35, 3.25])


@pytest.mark.parametrize("which", ["before", "after", "between"])
def test_brackets_that_rise_above_rounding_are_told_apart(which: str) -> None:
    small, large = 1e-13, 1e-3
    cells = np.array(
        [
            bracket(0.8, 0.9, small, -small),
            bracket(1.0, 1.1, -small, large if which == "before" else small),
            bracket(1.2, 1.3, large if which == "after" else small, -small),
        ]
    ).T
    value = large if which == "between" else 0.0
    curve = Curve(lambda t: value + 0.0 * t, lambda t: 1.0 + 0.0 * t, error=1e-12)
    _, found = branch_search._distinct(curve, np.array([0, 0, 0]), cells)
    # three solutions; were the last joined to the run, one would be left
    assert found[0].tolist() == [0.8, 1.0, 1.2]


def test_a_root_is_polished_to_rounding_in_a_few_steps() -> None:
    root = 2.0 + 1.0 / 3.0
    curve = Curve(lambda t: np.expm1(t - root), lambda t: np.exp(t - root), by_c=0.7)
    cells = curve.cells([2.0, 3.0])
    found = branch_search._polish(curve, owners(cells), cells)
    v = math.exp(root)
    assert found.v[0] == pytest.approx(v, rel=4 * EPS)
    # the error is v times a spread of some roundings of t
    assert 4 * EPS * v <= found.error[0] <= 100 * EPS * v
    assert found.slope[0] == pytest.approx(1.0 / v, rel=1e-12)
    assert found.by_coupling[0] == 0.7
    assert (curve.calls, curve.evaluations) == (4, 6)  # the last with both sides


def test_a_step_that_was_taken_for_the_last_and_was_not_is_followed_by_others() -> None:
    # The slopes at both ends promise a line; the bump between them moves the root by 0.02.
    def bump(t):
        return 0.02 * np.exp(-(((t - 2.4) / 0.1) ** 2))

    curve = Curve(lambda t: t - 2.4 + bump(t), lambda t: 1.0 - 200.0 * (t - 2.4) * bump(t))
    cells = curve.cells([2.0, 3.0])
    found = branch_search._polish(curve, owners(cells), cells)
    v = math.exp(brentq(lambda t: float(curve.g(t)), 2.0, 3.0, xtol=1e-15))
    assert found.v[0] == pytest.approx(v, rel=8 * EPS)
    assert found.error[0] <= 100 * EPS * v


def test_where_the_cubic_leaves_the_bracket_it_is_halved() -> None:
    root, steep = 2.9, 400.0
    curve = Curve(
        lambda t: np.arctan(steep * (t - root)),
        lambda t: steep / (1.0 + (steep * (t - root)) ** 2),
    )
    cells = curve.cells([2.0, 3.0])
    found = branch_search._polish(curve, owners(cells), cells)
    assert found.v[0] == pytest.approx(math.exp(root), rel=1e-13)
    assert curve.calls <= 25


@pytest.mark.parametrize("t", [-3.7, 0.4, 5.2])
def test_the_spread_is_the_least_that_shows_a_change_of_sign(t: float) -> None:
    curve = line(t)
    place, case = np.array([t]), np.zeros(1, dtype=int)
    exact, _ = branch_search._confirmed_half_width(curve, case, place, curve(case, place))
    assert exact[0] == pytest.approx(4 * EPS * max(1.0, abs(t)), rel=1e-12)
    # a value that is off by 1e-9, with slope 4, moves the root by a quarter of that
    off = line(t, 4.0)
    there = off(case, place)
    there[0] = 1e-9
    wide, _ = branch_search._confirmed_half_width(off, case, place, there)
    assert wide[0] == pytest.approx(2.5e-9 / 4, rel=1e-5)


R = 0.5


class Shape(admissibility._Shape):
    """φ² = r² + side h(ζ), h positive where (47) holds; h dips at ζ = 1.3 to ``depth``."""

    velocity = np.ones((1, 1))

    def __init__(self, depth: float, curvature: float) -> None:
        self.depth, self.curvature = depth, curvature

    def shorter_than_waves(self, owner: np.ndarray) -> np.ndarray:
        return np.zeros(owner.shape)

    def h(self, zeta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        far = np.abs(zeta - 1.3)
        ahead = self.depth + self.curvature * far**2
        # from the threshold, at zeta = 0, up to the parabola about the dip
        rise = ahead * (1.0 - np.exp(-zeta / 0.2))
        slope = 2.0 * self.curvature * (zeta - 1.3) * (1.0 - np.exp(-zeta / 0.2))
        slope += ahead * np.exp(-zeta / 0.2) / 0.2
        behind = -0.1 * zeta
        return np.where(zeta > 0, rise, behind), np.where(zeta > 0, slope, -0.1)

    def at(self, zeta: np.ndarray) -> np.ndarray:
        h, _ = self.h(zeta)
        return np.sqrt(R * R + np.where(zeta > 0, -h, h)) + 0j

    def slope(self, zeta: np.ndarray, phi: np.ndarray, _: np.ndarray) -> np.ndarray:
        _, slope = self.h(zeta)
        return np.where(zeta > 0, -slope, slope) / (2.0 * phi)

    def with_slope(self, zeta: np.ndarray, _: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        phi = self.at(zeta)
        return phi, self.slope(zeta, phi, phi)

    def judged(self) -> float | None:
        zeta = np.arange(-16, 25) / 8
        phi, slope = self.with_slope(zeta, zeta)
        inside = np.ones((1, zeta.size), dtype=bool)
        values = phi[None], slope[None]
        (place,), _, decided = admissibility._first_violations(
            self, zeta, values, np.array([R]), inside
        )
        assert decided.all()
        return None if place == math.inf else float(place)


def test_a_curve_that_rests_at_the_threshold_to_within_the_tolerance_is_no_violation() -> None:
    assert Shape(depth=-5e-12, curvature=0.05).judged() is None


def test_a_violation_beside_a_point_at_the_threshold_is_found() -> None:
    # h = 4e-7 (zeta - 1.3)^2 - 1e-9 is zero at the point 1.25, and below it up to 1.35
    fails_at = Shape(depth=-1e-9, curvature=4e-7).judged()
    assert fails_at is not None
    assert 1.25 < fails_at < 1.35


def test_a_dip_far_narrower_than_the_spacing_of_points_is_found() -> None:
    # it is sqrt(1e-9/0.05) = 1.4e-4 wide, between points 0.125 apart
    fails_at = Shape(depth=-1e-9, curvature=0.05).judged()
    assert fails_at == pytest.approx(1.3, abs=2e-4)


class FirstCell(Shape):
    """h = d x (1 - 3.35 x + 2.5 x²), x = ζ/w over the first cell of width w: below 0 within it.

    It rises at both ends of the cell, at the far one 1.8 times as steeply, and from there on.
    """

    width = 0.125
    rate = 0.03

    def __init__(self) -> None:
        super().__init__(0.0, 0.0)

    def h(self, zeta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x = np.clip(zeta / self.width, 0.0, 1.0)
        beyond = np.maximum(zeta / self.width - 1.0, 0.0)
        inside = x * (1.0 - 3.35 * x + 2.5 * x * x) + 1.8 * beyond
        slope = 1.0 - 6.7 * x + 7.5 * x * x
        ahead = self.rate * self.width * inside
        return (
            np.where(zeta > 0, ahead, -0.1 * zeta),
            np.where(zeta >= 0, self.rate * slope, -0.1),
        )

    def slope(self, zeta: np.ndarray, phi: np.ndarray, _: np.ndarray) -> np.ndarray:
        _, slope = self.h(zeta)
        return np.where(zeta >= 0, -slope, slope) / (2.0 * phi)


def test_rising_at_both_ends_of_the_first_cell_does_not_hide_a_dip_between() -> None:
    fails_at = FirstCell().judged()
    low, high = ((3.35 - s * math.sqrt(3.35**2 - 10.0)) / 5.0 * FirstCell.width for s in (1, -1))
    assert fails_at is not None
    assert low < fails_at < high


class Rise(Shape):
    """h = d x (1 + b x + a x²), x = |ζ|/w, over the cells beside ζ = 0, and a line beyond."""

    velocity = np.full((1, 1), 1e9)  # so that the slope hardly jumps at ζ = 0
    width = 0.125

    def __init__(self, b: float, a: float) -> None:
        super().__init__(0.0, 0.0)
        self.b, self.a = b, a

    def h(self, zeta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x = np.abs(zeta) / self.width
        near = np.minimum(x, 1.0)
        slope = 1.0 + 2.0 * self.b * near + 3.0 * self.a * near**2
        value = near * (1.0 + self.b * near + self.a * near**2) + slope * (x - near)
        return 0.01 * value, 0.01 * slope / self.width * np.where(zeta < 0, -1.0, 1.0)

    def slope(self, zeta: np.ndarray, phi: np.ndarray, _: np.ndarray) -> np.ndarray:
        _, slope = self.h(zeta)
        return np.where(zeta < 0, slope, -slope) / (2.0 * phi)


@pytest.mark.parametrize(
    ("b", "a", "divided"),
    [
        (0.98, 0.0, False), (-0.48, 0.0, False), (1.02, 0.0, True), (-0.52, 0.0, True),
        (-0.7, 0.9, True), (2.0, -0.9, True),
    ],
)  # fmt: skip
def test_beside_the_front_a_cell_is_decided_at_once_where_the_margin_is_nearly_a_line(
    b: float, a: float, divided: bool
) -> None:
    # h/x is 1 and 1 + b + a at the ends of the cell. Neither b + a, its change, nor b + 2a, its
    # slope at the far end, may exceed the smaller one.
    zeta = np.arange(-2, 3) / 8
    shape = Rise(b, a)
    phi, slope = shape.with_slope(zeta, zeta)
    inside = np.abs(zeta[None]) < 0.2
    place, computed, _ = admissibility._first_violations(
        shape, zeta, (phi[None], slope[None]), np.array([R]), inside
    )
    assert place[0] == math.inf
    assert (computed[0] > 0) == divided


class Wave(Shape):
    """h falls as steeply at both ends of the cell from 1.25, rises over it, and is below 0 within.

    With x = (ζ - 1.25)/w it is 0.1 + x - 2.5 sin(2πx)/2π there, and positive elsewhere.
    """

    width = 0.125

    def __init__(self, longest: float) -> None:
        super().__init__(0.0, 0.0)
        self.longest = longest

    def shorter_than_waves(self, owner: np.ndarray) -> np.ndarray:
        return np.full(owner.shape, self.longest)

    def h(self, zeta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, turn = (zeta - 1.25) / self.width, 2.0 * math.pi
        within, beyond = np.clip(x, 0.0, 1.0), np.clip(x - 1.0, 0.0, None)
        value = 0.1 + within - 2.5 * np.sin(turn * within) / turn
        value += 1.5 * (-np.minimum(x, 0.0) - beyond + beyond**2)
        slope = 1.0 - 2.5 * np.cos(turn * within) + 3.0 * beyond
        rise = 1.0 - np.exp(-zeta / 0.02)
        ahead = (value * rise, slope / self.width * rise + value * (1.0 - rise) / 0.02)
        return np.where(zeta > 0, 1e-3 * ahead[0], -0.1 * zeta), np.where(
            zeta >= 0, 1e-3 * ahead[1], -0.1
        )

    def slope(self, zeta: np.ndarray, phi: np.ndarray, _: np.ndarray) -> np.ndarray:
        _, slope = self.h(zeta)
        return np.where(zeta >= 0, -slope, slope) / (2.0 * phi)


class Dip(Wave):
    """h is below 0 within the cell from 1.25, although it rises at both ends as over the cell."""

    def h(self, zeta: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, turn = (zeta - 1.25) / self.width, 2.0 * math.pi
        within, before = np.clip(x, 0.0, 1.0), np.minimum(x, 0.0)
        value = 0.6 + x + before**2 - 1.1 * (1.0 - np.cos(turn * within))
        slope = 1.0 + 2.0 * before - 1.1 * turn * np.sin(turn * within)
        rise = 1.0 - np.exp(-zeta / 0.02)
        ahead = (value * rise, slope / self.width * rise + value * (1.0 - rise) / 0.02)
        return np.where(zeta > 0, 1e-3 * ahead[0], -0.1 * zeta), np.where(
            zeta >= 0, 1e-3 * ahead[1], -0.1
        )


def test_slopes_that_agree_with_the_margin_decide_nothing_in_a_cell_as_long_as_waves() -> None:
    fails_at = Dip(longest=0.0).judged()
    assert fails_at is not None
    assert 1.25 < fails_at < 1.375
    assert Dip(longest=1.0).judged() is None  # what is left to the caller to rule out


@pytest.mark.parametrize("longest", [0.0, 1.0])
def test_slopes_that_agree_hide_no_violation_where_the_margin_does_not_follow_them(longest) -> None:
    fails_at = Wave(longest).judged()
    assert fails_at is not None
    assert 1.25 < fails_at < 1.375
