"""Newton's method, branches, folds and crossings: systems whose answer is known in closed form."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

from tests.folds import fold_of
from verification.continuation import branch as branches
from verification.continuation.branch import (
    ContinuationBranch,
    StepControl,
    _Bracket,
    arrive,
    first_crossing,
    solutions_at,
    trace,
)
from verification.continuation.newton import (
    PARAMETER_WEIGHT,
    BranchPoint,
    NotConvergedError,
    solution_error,
    solve_at,
    step_along,
)


def circle(u: Any, c: float) -> tuple[Any, Any, Any]:
    """A circle of radius 0.7 about (0, 1): it folds at c = 0.3 and 1.7."""
    return u**2 + (c - 1.0) ** 2 - 0.49, np.diag(2.0 * u), np.array([2.0 * (c - 1.0)])


def cubic(u: Any, c: float) -> tuple[Any, Any, Any]:
    """c = u - u³/3, which folds at u = ∓1, c = ∓2/3."""
    # Products: the vectorised u**3 of some processors rounds a negative u otherwise.
    return u - u * u * u / 3 - c, np.diag(1 - u * u), np.array([-1.0])


# ------------------------------------------------------------------------------- Newton's method


def _linear(factor: float) -> Any:
    def system(u: Any, c: float) -> tuple[Any, Any, Any]:
        return factor * (u - c), np.diag(np.full(u.size, factor)), np.full(u.size, -factor)

    return system


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_solution_has_a_small_residual_and_has_been_reached_by_a_small_step(side: float) -> None:
    """Where F is flat a small residual says little, where it is steep a small step does not."""
    flat = solve_at(_linear(1e-3), np.array([1.0 + side * 5e-9]), 1.0)
    assert (flat.u[0], flat.iterations) == (pytest.approx(1.0, abs=1e-15), 2)
    far = solve_at(_linear(1e-12), np.array([1.0 + side]), 1.0)
    assert (far.u[0], far.iterations) == (pytest.approx(1.0, abs=1e-15), 3)
    one_of_two = solve_at(_linear(1e-12), np.array([1.0 + side, 1.0]), 1.0)
    assert one_of_two.iterations == 3  # a step is as long as its longest part

    def steep(u: Any, c: float) -> tuple[Any, Any, Any]:
        return 1e3 * (u * u - c), np.diag(2e3 * u), np.array([-1e3])

    found = solve_at(steep, np.array([1.0 + side * 1e-6]), 1.0)
    assert (found.residual < 1e-11, found.iterations) == (True, 3)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_step_that_leads_farther_away_is_halved(side: float) -> None:
    """Of arctan u Newton's method diverges from 1.5 on; half of its first step lands near zero."""
    tried: list[float] = []

    def arctan(u: Any, c: float) -> tuple[Any, Any, Any]:
        tried.append(float(u[0]))
        return np.arctan(u), np.diag(1.0 / (1.0 + u * u)), np.zeros(1)

    found = solve_at(arctan, np.array([1.5 * side]), 0.0)
    assert found.u[0] == pytest.approx(0.0, abs=1e-12)
    whole = math.atan(1.5) * (1.0 + 1.5**2)
    assert tried[:3] == pytest.approx([side * (1.5 - part * whole) for part in (0.0, 1.0, 0.5)])


def test_a_step_that_leads_no_nearer_is_halved() -> None:
    """Of F = 1.5 u, with slope ½ beyond u = ½, whole steps would lead from 1 to -1 and back."""

    def bent(u: Any, c: float) -> tuple[Any, Any, Any]:
        near = abs(u[0]) < 0.5
        value = 1.5 * u if near else np.sign(u) * (0.5 + 0.5 * np.abs(u))
        return value, np.eye(1) * (1.5 if near else 0.5), np.zeros(1)

    assert solve_at(bent, np.array([1.0]), 0.0).u.tolist() == [0.0]


def test_of_a_step_five_parts_are_tried() -> None:
    tried: list[float] = []

    def walled(u: Any, c: float) -> tuple[Any, Any, Any]:
        tried.append(float(u[0]))
        if u[0] < 1.0:
            raise NotConvergedError("outside")
        return u, np.eye(1), np.zeros(1)

    with pytest.raises(NotConvergedError, match=r"at c = 0\.25") as raised:
        solve_at(walled, np.array([1.0]), 0.25)
    assert raised.value.at == 0.25
    assert str(raised.value).startswith("no solution was found")
    assert tried == pytest.approx([1.0, 0.0, 0.5, 0.75, 0.9, 0.97])


def test_a_step_along_a_branch_ends_on_the_plane_across_its_tangent() -> None:
    start = solve_at(circle, np.array([0.5]), 1.4)
    slope, by_c = 2.0 * start.u[0], 2.0 * (start.parameter - 1.0)
    assert slope * start.tangent[0] + by_c * start.tangent[1] / PARAMETER_WEIGHT == pytest.approx(
        0, abs=1e-15
    )
    assert np.linalg.norm(start.tangent) == pytest.approx(1.0)
    for length in (-0.3, 0.3):
        end = step_along(circle, start, length)
        moved = np.append(end.u - start.u, PARAMETER_WEIGHT * (end.parameter - start.parameter))
        assert moved @ start.tangent == pytest.approx(length, rel=1e-11)
        assert end.residual < 1e-11
        assert end.tangent @ start.tangent > 0.0  # the same sense
        aside = moved - length * start.tangent
        assert branches._deviation(start, end, length) == pytest.approx(
            np.linalg.norm(aside) / abs(length) * math.copysign(1.0, length)
        )
        assert branches._length_to(start, end.u, end.parameter) == pytest.approx(length, rel=1e-11)


@pytest.mark.parametrize("length", [-0.5, 0.5])
@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("tolerance", [1e-1, 1e-2, 1e-4])
def test_the_correction_of_a_step_is_how_far_its_end_still_is(
    tolerance: float, side: float, length: float
) -> None:
    """On a circle beside a coordinate that c alone decides, so that one has nothing to move."""

    def system(u: Any, c: float) -> tuple[Any, Any, Any]:
        value = np.array([u[0] ** 2 + (c - 1.0) ** 2 - 0.49, 1e-3 * (u[1] - 2.0)])
        return value, np.diag([2.0 * u[0], 1e-3]), np.array([2.0 * (c - 1.0), 0.0])

    start = solve_at(system, np.array([side * 0.5, 2.0]), 1.4)
    exact, rough = (step_along(system, start, length, each) for each in (1e-14, tolerance))
    apart = max(
        np.abs(rough.u - exact.u).max(), PARAMETER_WEIGHT * abs(rough.parameter - exact.parameter)
    )
    assert apart <= 2.0 * rough.correction + 1e-14
    assert 0.0 <= rough.correction < 0.1
    assert rough.iterations == round(rough.iterations) < exact.iterations
    assert rough.residual == np.abs(system(rough.u, rough.parameter)[0]).max() > rough.correction


def test_a_short_correction_of_a_steep_function_is_no_solution_yet() -> None:
    """Of 1000 (u² - c) a step ends 2e-6 beside the branch; after one correction F is still 4e-9."""

    def steep(u: Any, c: float) -> tuple[Any, Any, Any]:
        return 1e3 * (u * u - c), np.diag(2e3 * u), np.array([-1e3])

    start = solve_at(steep, np.array([1.0]), 1.0)
    end = step_along(steep, start, 0.04)
    assert end.residual < 1e-11
    assert end.u[0] == pytest.approx(math.sqrt(end.parameter), rel=1e-14)


def test_a_small_residual_after_a_long_correction_is_no_solution_yet() -> None:
    """Of 1e-8 (u² + (c - 1)² - 0.49) beside an unknown that needs no correction."""

    def flat(u: Any, c: float) -> tuple[Any, Any, Any]:
        value, slope, by_c = circle(u[:1], c)
        return (
            np.array([1e-8 * value[0], u[1]]),
            np.diag([1e-8 * slope[0, 0], 1.0]),
            np.array([1e-8 * by_c[0], 0.0]),
        )

    start = solve_at(flat, np.array([0.5, 0.0]), 1.4)
    end = step_along(flat, start, 0.1)
    assert circle(end.u[:1], end.parameter)[0] == pytest.approx(0.0, abs=1e-10)


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e7])
def test_a_step_into_what_is_no_solution_by_far_is_given_up_at_once(value: float) -> None:
    tried: list[float] = []

    def walled(u: Any, c: float) -> tuple[Any, Any, Any]:
        tried.append(c)
        return np.full(1, value), np.diag(np.full(1, value)), np.zeros(1)

    start = BranchPoint(np.zeros(1), 1.0, np.array([0.0, 1.0]), 0.0, 0.0, 1, 1.0)
    with pytest.raises(NotConvergedError, match=r"leads on from c = 1") as raised:
        step_along(walled, start, 0.1)
    assert (tried, raised.value.at) == ([1.01], 1.0)


@pytest.mark.parametrize(("apart", "same"), [(0.2, True), (0.5, False)])
def test_a_step_that_ends_far_beside_its_tangent_is_halved(apart: float, same: bool) -> None:
    """Of two parallel lines, of which the second takes over half a step ahead."""

    def two_lines(u: Any, c: float) -> tuple[Any, Any, Any]:
        return u - (0.0 if c < 0.05 else apart), np.eye(1), np.zeros(1)

    start = solve_at(two_lines, np.zeros(1), 0.0)
    new, length = branches._next(two_lines, start, 1.0, StepControl())
    assert (new.u[0], length) == ((apart, 1.0) if same else (0.0, 0.25))


@pytest.mark.parametrize(("turn", "length"), [(0.4, 1.0), (0.55, 0.5)])
def test_a_step_over_too_sharp_a_turn_is_halved(turn: float, length: float) -> None:
    """Of a line that turns half a step ahead: its end is near the tangent, but leads elsewhere."""

    def bent(u: Any, c: float) -> tuple[Any, Any, Any]:
        beyond = PARAMETER_WEIGHT * max(c - 0.05 - 1e-9, 0.0)
        by_c = -turn * PARAMETER_WEIGHT if beyond else 0.0
        return u - turn * beyond, np.eye(1), np.array([by_c])

    start = solve_at(bent, np.zeros(1), 0.0)
    new, taken = branches._next(bent, start, 1.0, StepControl())
    assert taken == length
    assert (new.parameter > 0.06) is (length == 1.0)


def test_along_a_straight_line_a_step_begins_where_it_ends() -> None:
    """In every unknown, so that nothing is corrected."""
    start = solve_at(_linear(1.0), np.full(3, 0.25), 0.25)
    end = step_along(_linear(1.0), start, 2.0)
    assert (end.iterations, end.parameter > 0.3) == (2, True)
    assert end.u == pytest.approx(end.parameter, rel=1e-14)


def test_a_step_ends_where_rounding_keeps_its_corrections_from_vanishing() -> None:
    """Of F = 1e-4 (u - c), evaluated to 1e-13: corrections of 1e-9 are left for ever."""

    def rounded(u: Any, c: float) -> tuple[Any, Any, Any]:
        value = 1e-4 * (u - c) + 1e-13 * np.sin(1e12 * u)
        return value, np.diag([1e-4]), np.array([-1e-4])

    start = BranchPoint(
        np.zeros(1), 0.0, np.array([1.0, 10.0]) / math.sqrt(101.0), 0.0, 0.0, 1, 1.0
    )
    end = step_along(rounded, start, 0.5)
    assert end.u[0] == pytest.approx(end.parameter, abs=1e-8)


@pytest.mark.parametrize("c", [1.0, 1e-6, 1e-12])
@pytest.mark.parametrize("off", [1e-16, 1e-13, 1e-9])
def test_a_solution_beside_a_fold_errs_by_no_more_than_is_stated(c: float, off: float) -> None:
    """u² = c, where F may be wrong by δ: the root of c ± δ, or of 0."""

    def parabola(u: Any, c: float) -> tuple[Any, Any, Any]:
        return u**2 - c, np.diag(2.0 * u), np.array([-1.0])

    stated = solution_error(parabola, np.array([math.sqrt(c)]), c, off)
    assert solution_error(parabola, np.array([-math.sqrt(c)]), c, off) == stated
    aside = solution_error(parabola, np.array([math.sqrt(c)]), c, 0.0, off)
    for true in (max(c - off, 0.0), c + off):
        assert abs(math.sqrt(true) - math.sqrt(c)) <= min(stated, aside)
    least = off + 1e-15 * c
    assert max(stated, aside) <= 4.0 * least / max(math.sqrt(c), math.sqrt(least))


@pytest.mark.parametrize("share", [0.01, 0.3, 0.6, 0.9, 1.5, 4.0])
def test_the_error_of_a_parabola_is_the_distance_of_its_farthest_root(share: float) -> None:
    """Of u² = c ± δ with δ < c, the root of c - δ; beyond it, where the two meet, the other one.

    Beside it is an unknown that is nearly known, from an equation of another size.
    """
    c = 0.49

    def parabola(u: Any, c: float) -> tuple[Any, Any, Any]:
        slope = np.diag([2.0 * u[0], 10.0])
        return np.array([u[0] ** 2 - c, 10.0 * (u[1] - 2.0)]), slope, np.array([-1.0, 0.0])

    off = share * c
    farthest = -math.sqrt(c + off) if share > 1.0 else math.sqrt(c - off)
    beside = 1e-4 * share
    for side in (-1.0, 1.0):
        u = np.array([math.sqrt(c), 2.0 + side * beside])
        assert solution_error(parabola, u, c) == pytest.approx(2.0 * beside, rel=1e-6)
    stated = solution_error(parabola, u, c, np.array([off, 0.0]))
    # The second derivative is a difference, which is exact here but for rounding.
    assert stated == pytest.approx(abs(math.sqrt(c) - farthest), rel=1e-6)


def test_an_exact_solution_of_exact_equations_has_no_error() -> None:
    assert solution_error(_linear(1.0), np.zeros(1), 0.0) == 0.0


def test_the_curvature_in_an_error_is_that_near_the_solution() -> None:
    """F = u up to |u| = 1e-6, steep beyond: an error δ = 1e-9 of F leads not so far."""

    def walled(u: Any, c: float) -> tuple[Any, Any, Any]:
        beyond = np.maximum(np.abs(u) - 1e-6, 0.0)
        value = u + np.sign(u) * 0.5e9 * beyond**2
        return value, np.diag(1.0 + 1e9 * beyond), np.zeros(1)

    assert solution_error(walled, np.zeros(1), 0.0, 1e-9) == pytest.approx(1e-9, rel=1e-12)


def test_an_error_of_one_equation_that_bends_another_is_in_the_error_of_both() -> None:
    """F = (x + Ky²/2, y), each wrong by up to δ: x = ±δ₁ - Kδ₂²/2."""
    bend, off = 500.0, np.array([1e-3, 0.9e-3])

    def system(u: Any, c: float) -> tuple[Any, Any, Any]:
        value = np.array([u[0] + 0.5 * bend * u[1] ** 2, u[1]])
        return value, np.array([[1.0, bend * u[1]], [0.0, 1.0]]), np.zeros(2)

    farthest = off[0] + 0.5 * bend * off[1] ** 2
    assert farthest <= solution_error(system, np.zeros(2), 0.0, off) <= 1.5 * farthest


def test_the_curvature_in_an_error_is_that_along_the_largest_of_the_steps() -> None:
    """F = (p + q, p - q)/2, p = x + Kx²/2, q = 10y: wrong by ±δ each, p ± 2δ and q = 0 at most.

    Where instead q is wrong most, by 2δ, x is the exact one, and nothing bends.
    """
    bend, off = 1.0, 0.1875

    def system(u: Any, c: float) -> tuple[Any, Any, Any]:
        p, q = u[0] + 0.5 * bend * u[0] ** 2, 10.0 * u[1]
        slope = 0.5 * np.array([[1.0 + bend * u[0], 10.0], [1.0 + bend * u[0], -10.0]])
        return 0.5 * np.array([p + q, p - q]), slope, np.zeros(2)

    farthest = 0.5 / bend  # of x + Kx²/2 = -2δ = -3/8K
    assert solution_error(system, np.zeros(2), 0.0, off) == pytest.approx(farthest, rel=1e-6)


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("tolerance", [1e-1, 1e-2, 1e-4])
def test_the_correction_of_a_solution_is_how_far_it_still_is(tolerance: float, side: float) -> None:
    """Of two unknowns, one of which is known exactly."""

    def system(u: Any, c: float) -> tuple[Any, Any, Any]:
        return np.array([u[0] ** 2 - c, u[1] - 2.0]), np.diag([2.0 * u[0], 1.0]), np.array([-1, 0])

    rough = solve_at(system, np.array([1.2 * side, 2.0]), 1.0, tolerance)
    apart = np.abs(rough.u - [side, 2.0]).max()
    assert 0.0 < apart <= 2.0 * rough.correction
    assert rough.correction <= 2.0 * apart


@pytest.mark.parametrize("u", [-0.5, -0.01, 0.01, 0.5])
def test_either_way_along_a_branch_its_orientation_is_constant(u: float) -> None:
    """Past a fold as well, where both ∂F/∂u and the direction in c change their signs.

    Beside it an unknown that is twice the first one, whose direction does not change there.
    """

    def system(u: Any, c: float) -> tuple[Any, Any, Any]:
        value = np.array([u[0] ** 2 + (c - 1.0) ** 2 - 0.49, u[1] - 2.0 * u[0]])
        slope = np.array([[2.0 * u[0], 0.0], [-2.0, 1.0]])
        return value, slope, np.array([2.0 * (c - 1.0), 0.0])

    start = solve_at(system, np.array([u, 2.0 * u]), 1.0 + math.sqrt(0.49 - u**2))
    ends = []
    for point in (start, start.reversed()):
        end = step_along(system, point, 0.05)
        assert end.orientation == point.orientation
        ends.append(float(end.u[0]))
    assert (min(ends) * max(ends) < 0.0) is (abs(u) < 0.1)
    assert start.orientation == -start.reversed().orientation


# ------------------------------------------------------------------------------- branches, folds


def test_the_solutions_of_a_branch_have_residuals_within_the_tolerance_and_by_default_1e_11() -> (
    None
):
    start = solve_at(circle, np.array([0.7]), 1.0)
    for steps, tolerance in ((StepControl(), 1e-11), (StepControl(tolerance=1e-14), 1e-14)):
        branch = trace(circle, start, 5.0, None, steps)
        for point in branch.points[1:]:
            assert np.abs(circle(point.u, point.parameter)[0]).max() < tolerance


@pytest.mark.parametrize("bend", [1e-3, 1.0, 1e3])
def test_the_error_of_a_fold_is_a_small_multiple_of_its_shortfall(bend: float) -> None:
    """c = 1 - bend (u²/2 + u³/3) where the search stops early, for gentle and for sharp folds."""

    def skew(u: Any, c: float) -> tuple[Any, Any, Any]:
        value = bend * u**2 * (0.5 + u / 3.0) + c - 1.0
        return value, np.diag(bend * u * (1.0 + u)), np.ones(1)

    u = -0.3 / max(1.0, PARAMETER_WEIGHT * bend)
    start = solve_at(skew, np.array([u]), 1.0 - bend * u**2 * (0.5 + u / 3.0))
    steps = StepControl(length=-1.3 * u, fold_tolerance=0.01 * (1.0 - start.parameter))
    fold = trace(skew, start, 2.0, None, steps).fold
    assert fold is not None
    shortfall = 1.0 - fold.parameter
    assert shortfall > 1e-10
    assert shortfall <= fold.error <= 10.0 * shortfall


@pytest.mark.parametrize("bend", [1.0, 1e3])
def test_the_error_of_a_fold_is_four_times_what_its_curvature_leaves(bend: float) -> None:
    """c = 1 - bend u²/2, whose curvature that of a secant is, where the search stops early."""

    def parabola(u: Any, c: float) -> tuple[Any, Any, Any]:
        return 0.5 * bend * u**2 + c - 1.0, np.diag(bend * u), np.ones(1)

    u = -0.3 / (PARAMETER_WEIGHT * bend)
    start = solve_at(parabola, np.array([u]), 1.0 - 0.5 * bend * u**2)
    steps = StepControl(length=-1.3 * u, fold_tolerance=0.01 * (1.0 - start.parameter))
    fold = trace(parabola, start, 2.0, None, steps).fold
    assert fold is not None
    assert fold.error / (1.0 - fold.parameter) == pytest.approx(4.0, rel=0.1)


def test_the_error_of_a_fold_covers_the_rounding_of_its_parameter() -> None:
    """u² + 3c = 1 folds at a third, where the equation is solved to the last bit."""

    def parabola(u: Any, c: float) -> tuple[Any, Any, Any]:
        return u**2 + 3.0 * c - 1.0, np.diag(2.0 * u), np.array([3.0])

    start = solve_at(parabola, np.array([0.5]), 0.25)
    fold = trace(parabola, start, 1.0, None, StepControl(fold_tolerance=1e-15)).fold
    assert fold is not None
    off = abs(Fraction(fold.parameter) - Fraction(1, 3))
    assert 0 < off <= Fraction(fold.error) < Fraction(1, 10**14)


def test_the_rounding_of_large_terms_that_cancel_is_in_the_error_of_a_fold() -> None:
    """c = 1 - u² where v = √2: as v is rounded, the fold is displaced by 1e6 (v² - 2)."""

    def system(u: Any, c: float) -> tuple[Any, Any, Any]:
        value = np.array([u[0] ** 2 + c - 1.0 + 1e6 * (u[1] ** 2 - 2.0), u[1] - math.sqrt(2.0)])
        slope = np.array([[2.0 * u[0], 2e6 * u[1]], [0.0, 1.0]])
        return value, slope, np.array([1.0, 0.0])

    start = solve_at(system, np.array([-0.5, math.sqrt(2.0)]), 0.75)
    fold = trace(system, start, 2.0, None, StepControl(fold_tolerance=1e-13)).fold
    assert fold is not None
    assert 1e-10 < abs(fold.parameter - 1.0) <= fold.error < 1e-8
    assert fold.tangent == pytest.approx([1.0, 0.0], abs=1e-6)  # only u changes along the branch


def test_where_two_branches_nearly_cross_the_one_that_is_followed_is_not_left() -> None:
    """(u - c)(u + c) + δ = 0 turns back at c = √δ if followed from u = c < 0."""

    def crossing(u: Any, c: float) -> tuple[Any, Any, Any]:
        return u**2 - c**2 + 1e-6, np.diag(2.0 * u), np.array([-2.0 * c])

    start = solve_at(crossing, np.array([-1.0]), -1.0)
    along = StepControl(length=0.3)
    jumped, kept = (
        trace(crossing, start, 1.0, None, steps) for steps in (along, replace(along, generic=True))
    )
    assert jumped.folds == ()  # it goes on along u = c
    assert abs(kept.fold.parameter + 1e-3) <= kept.fold.error < 1e-9


def test_a_step_across_a_bifurcation_is_taken_whole_if_no_shorter_one_avoids_it() -> None:
    """From a millionth before the bifurcation of u² = c² all of them lead across."""

    def crossing(u: Any, c: float) -> tuple[Any, Any, Any]:
        return u**2 - c**2, np.diag(2.0 * u), np.array([-2.0 * c])

    start = solve_at(crossing, np.array([-1e-6]), -1e-6)
    start = start if start.tangent[-1] > 0.0 else start.reversed()
    new, length = branches._next(crossing, start, 0.3, StepControl(generic=True))
    assert length == 0.3
    assert new.u[0] == pytest.approx(new.parameter, rel=1e-9)
    assert new.parameter > 0.0


def test_a_fold_that_is_not_found_on_a_step_is_looked_for_on_its_half(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As that of ten sites near c = 0.2009 in (8), where Newton's method fails within the step."""
    find = branches._find_fold
    tried: list[float] = []

    def seldom(*given: Any) -> Any:
        tried.append(given[3])
        if len(tried) < 3:
            raise NotConvergedError("no step leads on")
        return find(*given)

    monkeypatch.setattr(branches, "_find_fold", seldom)
    found = trace(circle, solve_at(circle, np.array([0.7]), 1.0), 5.0)
    assert abs(found.fold.parameter - 1.7) <= found.fold.error
    assert tried[1] < tried[0]


@pytest.mark.parametrize("sense", [-1.0, 1.0])
def test_of_two_folds_within_one_step_the_first_is_found(sense: float) -> None:
    """A branch that turns at u = 0.4, back at 0.5 and again at 0.6; beside it is one of u/10."""

    def course(u: Any, c: float) -> tuple[Any, Any, Any]:
        s = u[0] - 0.5
        return (
            np.array([s * (s**2 - 0.02) * s / 4.0 + sense * c, u[1] - 0.1 * u[0]]),
            np.array([[s**3 - 0.01 * s, 0.0], [-0.1, 1.0]]),
            np.array([sense, 0.0]),
        )

    start = solve_at(course, np.array([0.3, 0.03]), -0.0002 * sense)
    branch = trace(course, start, sense, None, StepControl(length=0.64))
    assert branch.fold.u[0] == pytest.approx(0.4, abs=1e-3)
    found = branches._earlier_turn(course, branch.points[0], 0.25, StepControl())
    assert found is not None
    place, turned = found
    assert place == 0.125
    assert turned == step_along(course, branch.points[0], place).tangent[-1]


@pytest.mark.parametrize("at", [-3.0, 0.0, 3.0])
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_solution_on_the_wrong_side_of_a_fold_is_looked_for_on_the_other(
    side: float, at: float
) -> None:
    solved: list[Any] = []

    def parabola(u: Any, c: float) -> tuple[Any, Any, Any]:
        solved.append(u)
        return (u - at) ** 2 + c, np.diag(2.0 * (u - at)), np.array([1.0])

    fold = fold_of(0.0, 0.0, np.full(1, at), tangent=np.ones(1))
    for begun in (-0.1, 0.1):
        found = solve_at(parabola, np.array([at + begun]), -0.01)
        solved.clear()
        there = branches._on_side(parabola, found, fold, side)
        assert there.u[0] - at == pytest.approx(0.1 * side)
        assert bool(solved) == (begun != 0.1 * side)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_where_there_is_none_on_the_other_side_of_a_fold_the_solution_stays(
    side: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Newton's method may lead back to the same side, and farther away."""
    found = BranchPoint(np.array([-0.1 * side]), -0.01, np.ones(2), 0.0, 0.0, 1, 1.0)
    monkeypatch.setattr(branches, "solve_at", lambda *_: replace(found, u=np.array([-3.0 * side])))
    fold = fold_of(0.0, 0.0, np.zeros(1), tangent=np.ones(1))
    assert branches._on_side(circle, found, fold, side) is found


def test_what_displaces_a_fold_is_in_the_errors_of_its_parameter_and_of_its_solution(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    first = solve_at(circle, np.array([0.7]), 1.0)
    exact = trace(circle, first, 5.0).fold
    monkeypatch.setattr(branches, "_fold_displacement", lambda *_: 0.125)
    displaced = trace(circle, first, 5.0).fold
    assert exact is not None
    assert displaced is not None
    for error, without in (
        (displaced.error, exact.error),
        (displaced.transverse_error, exact.transverse_error),
    ):
        assert error - without == pytest.approx(0.125, rel=1e-8)  # beside errors below 1e-9
    # Across the branch ten times the last correction is added.
    step = branches.step_along
    monkeypatch.setattr(
        branches, "step_along", lambda *given: replace(step(*given), correction=0.0625)
    )
    found = trace(circle, first, 5.0).fold
    assert found is not None
    assert found.transverse_error == pytest.approx(0.125 + 0.625, rel=1e-12)
    assert found.error == displaced.error


@pytest.mark.parametrize("off", [-1e-9, 1e-9, 0.0])
def test_a_fold_is_displaced_by_the_residual_and_the_rounding_of_its_equations(off: float) -> None:
    """F = ((x² - c + 1 - z)/100, z - 1): c is off by a hundred times what the first is."""

    def system(u: Any, c: float) -> tuple[Any, Any, Any]:
        value = np.array([0.01 * (u[0] ** 2 - c + 1.0 - u[1]) + off, u[1] - 1.0])
        return value, np.array([[0.02 * u[0], -0.01], [0.0, 1.0]]), np.array([-0.01, 0.0])

    point = BranchPoint(np.array([0.0, 1.0]), 0.0, np.array([1.0, 0.0, 0.0]), abs(off), 0.0, 1, 1.0)
    least = 100.0 * abs(off) + 2.0 * np.finfo(float).eps  # z has one rounding, as has F
    assert least <= branches._fold_displacement(system, point) < 3.0 * least


def test_errors_of_an_equation_shift_a_fold_and_move_its_solution_across_the_branch() -> None:
    """F = (x² - c + z, z), wrong by up to (δ₁, δ₂): c = 0 becomes ±δ₁ ± δ₂, and z = ±δ₂."""

    def system(u: Any, c: float) -> tuple[Any, Any, Any]:
        value = np.array([u[0] ** 2 - c + u[1], u[1]])
        return value, np.array([[2.0 * u[0], 1.0], [0.0, 1.0]]), np.array([-1.0, 0.0])

    fold = fold_of(0.0, 0.0, np.zeros(2), tangent=np.array([1.0, 0.0]))
    for errors in ([3e-6, 1e-6], [1e-6, 3e-6]):
        shift = branches.fold_shift(system, fold, np.array(errors))
        assert shift == pytest.approx((sum(errors), errors[1]), rel=1e-12)


@pytest.mark.parametrize("beside", [-3.0, 3.0])
def test_continuation_finds_the_fold_of_a_circle(
    beside: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Alone, and beside an unknown that changes three times as fast and does not turn.

    Across a fold the change of c is linear, so that two or three secants lead there; at three
    places before it an earlier fold is looked for.
    """
    steps: list[float] = []
    step, find = branches.step_along, branches._find_fold

    def counted(*given: Any) -> Any:
        steps.append(given[2])
        return step(*given)

    def found(*given: Any) -> Any:
        steps.clear()
        with monkeypatch.context() as changed:
            changed.setattr(branches, "step_along", counted)
            return find(*given)

    monkeypatch.setattr(branches, "_find_fold", found)

    def system(u: Any, c: float) -> tuple[Any, Any, Any]:
        value, slope, by_c = circle(u[:1], c)
        whole = np.array([[slope[0, 0], 0.0], [-beside, 1.0]])
        return np.append(value, u[1] - beside * u[0]), whole, np.append(by_c, 0.0)

    for equations, u in ((circle, [0.7]), (system, [0.7, 0.7 * beside])):
        branch = trace(equations, solve_at(equations, np.array(u), 1.0), 5.0)
        assert abs(branch.fold.parameter - 1.7) <= branch.fold.error < 1e-9
        assert branch.fold.index == len(branch.points) - 1  # it ends a step beyond
        assert len(steps) <= 6


def test_a_fold_where_c_turns_upwards_is_found_like_its_mirror_image() -> None:
    there, back = (
        trace(
            cubic, solve_at(cubic, np.array([u]), u - u**3 / 3), end, None, StepControl(folds=1)
        ).folds
        for u, end in ((-2.5, -10.0), (2.5, 10.0))
    )
    for fold, mirrored, c in zip(there, back, (-2 / 3, 2 / 3), strict=True):
        assert abs(fold.parameter - c) <= fold.error < 1e-10
        assert (fold.parameter, fold.error) == (-mirrored.parameter, mirrored.error)


def test_a_branch_goes_either_way_and_ends_where_it_leaves_the_range() -> None:
    start = solve_at(circle, np.array([0.7]), 1.0)
    for end, sense in ((1.4, 1.0), (0.6, -1.0)):
        found = trace(circle, start, end)
        couplings = [sense * point.parameter for point in found.points]
        assert couplings == sorted(couplings)
        assert couplings[-2] < sense * end <= couplings[-1]
        assert found.folds == ()
        assert arrive(circle, found, end).parameter == end


def test_what_is_watched_is_watched_up_to_the_first_fold() -> None:
    start = solve_at(circle, np.array([0.7]), 1.0)
    found = trace(circle, start, 5.0, lambda u, c: (c, float(u[0])), StepControl(folds=1))
    first = found.folds[0].index
    assert [c for c, _ in found.monitored] == [point.parameter for point in found.points[:first]]
    assert [u for _, u in found.monitored] == [point.u[0] for point in found.points[:first]]


def test_on_both_sides_of_a_fold_a_solution_is_found_with_how_often_it_has_turned() -> None:
    start = solve_at(circle, np.array([0.7]), 1.0)
    branch = trace(circle, start, 5.0, None, StepControl(folds=1))
    last = branch.points[branch.fold.index - 1].parameter
    beside = [1.0, 1.2, 1.5, 0.5 * (last + branch.fold.parameter)]  # the last within its step
    found = list(solutions_at(circle, branch, beside))
    assert [(point.parameter, turned) for point, turned in found] == [
        *((c, 0) for c in beside), *((c, 1) for c in reversed(beside)),
    ]  # fmt: skip
    for point, turned in found:
        assert point.u[0] == pytest.approx(
            (1 - 2 * turned) * math.sqrt(0.49 - (point.parameter - 1) ** 2)
        )


def test_solutions_are_in_their_order_along_the_branch() -> None:
    branch = trace(circle, solve_at(circle, np.array([0.7]), 1.0), 5.0, None, StepControl(folds=1))
    values = np.linspace(1.0, 1.69, 40).tolist()
    found = [point.parameter for point, _ in solutions_at(circle, branch, values[::-1])]
    assert found == [*values, *values[::-1]]


def test_an_end_that_stays_twice_counts_half() -> None:
    """The Illinois rule."""
    bracket = _Bracket(0.0, 1.0, -1.0, 1.0)
    course = [
        (0.5, 0.25, (0.0, 0.5, -1.0, 0.25)),
        (0.4, 0.2, (0.0, 0.4, -0.5, 0.2)),
        (0.1, -0.3, (0.1, 0.4, -0.3, 0.2)),
        (0.2, -0.2, (0.2, 0.4, -0.2, 0.1)),
        (0.25, -0.1, (0.25, 0.4, -0.1, 0.05)),
        (0.3, 0.02, (0.25, 0.3, -0.1, 0.02)),
    ]
    for place, value, expected in course:
        bracket.shrink(place, value)
        found = (bracket.low, bracket.high, bracket.f_low, bracket.f_high)
        assert found == pytest.approx(expected)


def test_the_length_to_a_solution_is_along_the_tangent() -> None:
    tangent = np.array([0.1, 0.2, 0.3])
    start = BranchPoint(np.array([1.0, 2.0]), 0.5, tangent, 0.0, 0.0, 1, 1.0)
    found = branches._length_to(start, np.array([1.5, 4.0]), 0.7)
    assert found == pytest.approx(0.05 + 0.4 + 0.3 * PARAMETER_WEIGHT * 0.2)


def test_a_step_is_shortened_if_any_of_its_equations_becomes_worse() -> None:
    """A step of one leads to where one of two is solved and the other one is far from it."""

    def system(u: Any, c: float) -> tuple[Any, Any, Any]:
        value = np.array([0.0, 5.0]) if u[0] < -0.75 else np.array([u[0] + 0.5, u[1]])
        return value, np.diag([0.5, 1.0]), np.ones(2)

    assert solve_at(system, np.zeros(2), 1.0).u == pytest.approx([-0.5, 0.0], abs=1e-9)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_the_first_end_that_is_replaced_leaves_the_other_as_it_is(side: float) -> None:
    bracket = _Bracket(0.0, 1.0, -1.0, 1.0)
    bracket.shrink(0.5, 0.25 * side)
    assert (bracket.f_low, bracket.f_high) == ((-1.0, 0.25) if side > 0.0 else (-0.25, 1.0))


@pytest.mark.parametrize("at", [1.234, 1.55, 1.69])
def test_a_crossing_is_where_a_monitored_value_becomes_positive(at: float) -> None:
    """The second of two values, on either side of the last point before the fold."""

    def monitor(u: Any, c: float) -> tuple[float, float]:
        return -1.0, math.sinh(5.0 * (c - at))

    branch = trace(circle, solve_at(circle, np.array([0.7]), 1.0), 5.0, monitor)
    assert first_crossing(circle, branch, monitor, 0) is None
    found = first_crossing(circle, branch, monitor, 1)
    assert not found.from_start
    assert abs(found.parameter - at) <= found.error < 1e-9
    assert found.u[0] == pytest.approx(math.sqrt(0.49 - (at - 1.0) ** 2), abs=1e-9)


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("at", [1.3, math.pi / 2, 1.7])
def test_a_crossing_that_a_secant_hits_at_once_is_no_better_than_rounding(
    at: float, side: float
) -> None:
    """Along a straight branch, upwards or downwards, of a value that is linear."""

    def monitor(u: Any, c: float) -> tuple[float]:
        return (side * (c - at),)

    begin = 1.5 - 0.5 * side
    start = solve_at(_linear(1.0), np.array([begin]), begin)
    branch = trace(_linear(1.0), start, 3.0 - begin, monitor)
    found = first_crossing(_linear(1.0), branch, monitor, 0)
    assert abs(found.parameter - at) <= found.error
    assert np.spacing(at) < found.error < 1e-9


@pytest.mark.parametrize("off", [-1e-12, 1e-12])
def test_a_crossing_beside_a_fold_is_as_uncertain_as_the_rounding_of_its_equations(
    off: float,
) -> None:
    """The coupling hardly changes there, so that its values on the two sides do not show it."""

    def rounded(u: Any, c: float) -> tuple[Any, Any, Any]:
        value, slope, by_c = circle(u, c)
        return value + off, slope, by_c

    def monitor(u: Any, c: float) -> tuple[float]:
        return (1e-5 - float(u[0]),)

    branch = trace(rounded, solve_at(rounded, np.array([0.7]), 1.0), 5.0, monitor)
    found = first_crossing(rounded, branch, monitor, 0)
    apart = abs(found.parameter - (1.0 + math.sqrt(0.49 - 1e-10)))
    assert apart == pytest.approx(abs(off) / 1.4, rel=0.01)  # ∂F/∂c = 1.4
    assert apart <= found.error < 1e-11


STEEP = {
    "steep": lambda x: math.expm1(60.0 * x),
    "jump": lambda x: 1.0 if x > 0.0 else -1e-6,
    "flat": lambda x: x**9,
    "zero before": lambda x: max(x, 0.0),
}


@pytest.mark.parametrize("shape", STEEP)
def test_the_error_of_a_crossing_bounds_its_distance_whatever_the_shape(shape: str) -> None:
    at, long = 0.5123, StepControl(length=6.0, longest=6.0)

    def monitor(u: Any, c: float) -> tuple[float]:
        return (STEEP[shape](c - at),)

    branch = trace(_linear(1.0), solve_at(_linear(1.0), np.array([0.0]), 0.0), 1.0, monitor, long)
    found = first_crossing(_linear(1.0), branch, monitor, 0)
    assert abs(found.parameter - at) <= found.error < 1e-10


def test_a_crossing_that_is_not_found_in_time_is_no_crossing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def monitor(u: Any, c: float) -> tuple[float]:
        return (STEEP["flat"](c - 0.5123),)

    branch = trace(_linear(1.0), solve_at(_linear(1.0), np.array([0.0]), 0.0), 1.0, monitor)
    monkeypatch.setattr(branches, "_MAX_CROSSING", 5)
    with pytest.raises(NotConvergedError, match=r"stability changes between c = .* in 5 steps"):
        first_crossing(_linear(1.0), branch, monitor, 0)


@pytest.mark.parametrize("after", [0, 3])
def test_a_crossing_whose_search_rounding_ends_is_as_uncertain_as_its_sides(
    after: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As near a fold at tiny ε, where the next step of Newton's method never becomes small."""
    at = 0.3217

    def monitor(u: Any, c: float) -> tuple[float]:
        return (math.expm1(3.0 * (c - at)),)

    branch = trace(_linear(1.0), solve_at(_linear(1.0), np.zeros(1), 0.0), 1.0, monitor)
    exact, left = branches.step_along, [after]

    def failing(*arguments: Any) -> Any:
        left[0] -= 1
        if left[0] < 0:
            raise NotConvergedError("rounding")
        return exact(*arguments)

    monkeypatch.setattr(branches, "step_along", failing)
    found = first_crossing(_linear(1.0), branch, monitor, 0)
    assert abs(found.parameter - at) <= found.error
    assert (found.error > 1e-3) is (after == 0)
    assert monitor(found.u, found.parameter)[0] <= 0.0


def test_what_is_positive_from_the_start_crosses_there() -> None:
    start = solve_at(circle, np.array([0.7]), 1.0)
    branch = trace(circle, start, 5.0, lambda u, c: (c,))
    found = first_crossing(circle, branch, lambda u, c: (c,), 0)
    assert (found.parameter, found.error, found.from_start) == (1.0, 0.0, True)
    assert found.u.tolist() == start.u.tolist()


def test_a_crossing_beyond_the_last_point_before_the_fold_is_looked_for_there() -> None:
    """What only the fold itself shows, and what first turns positive on a branch without a fold."""
    start = solve_at(circle, np.array([0.7]), 1.0)
    for end, at in ((5.0, 1.7 - 1e-6), (1.4, 1.3)):

        def monitor(u: Any, c: float, at: float = at) -> tuple[float]:
            return (c - at,)

        found = first_crossing(circle, trace(circle, start, end, monitor), monitor, 0)
        assert abs(found.parameter - at) <= found.error


def test_a_branch_of_a_single_step_has_what_its_ends_are() -> None:
    """Interpolated between two solutions; the start of the range is found once."""
    points = tuple(
        BranchPoint(np.array([c]), c, np.ones(2), 0.0, 0.0, 1, 1.0) for c in (0.0, 2.0, 4.0)
    )
    branch = ContinuationBranch(points, (), ())
    asked: list[float] = []

    def line(u: Any, c: float) -> tuple[Any, Any, Any]:
        asked.append(float(u[0]))
        return u - c, np.eye(1), np.array([-1.0])

    found = [
        (point.parameter, passed)
        for point, passed in solutions_at(line, branch, [4.0, 0.0, 2.0, 0.5])
    ]
    assert found == [(0.0, 0), (0.5, 0), (2.0, 0), (4.0, 0)]
    assert asked == [0.0, 0.0, 0.5, 0.5, 2.0, 2.0, 4.0, 4.0]  # each is begun at the solution


def test_where_interpolation_fails_a_value_is_approached_in_steps() -> None:
    """The node beyond leads to u < 0, where nothing is solved; from the one before, u stays near.

    Newton's method is allowed starts within a factor of two of the solution, so that it takes
    several steps to go from 1 to 1/64.
    """
    point = BranchPoint(np.array([1.0]), 1.0, np.ones(2), 0.0, 0.0, 1, 1.0)
    beyond = replace(point, u=np.array([-3.0]), parameter=0.0)
    branch = ContinuationBranch((point, beyond), (), ())

    def narrow(u: Any, c: float) -> tuple[Any, Any, Any]:
        if not 0.45 * c < u[0] < 2.2 * c or c < 0.01:
            raise NotConvergedError("too far")
        return u - c, np.eye(1), np.array([-1.0])

    ((found, passed),) = solutions_at(narrow, branch, [1.0 / 64.0])
    assert (found.u.tolist(), found.parameter, passed) == ([1.0 / 64.0], 1.0 / 64.0, 0)
    upwards = ContinuationBranch((point, replace(beyond, parameter=20.0)), (), ())
    ((found, _),) = solutions_at(narrow, upwards, [16.0])
    assert (found.u.tolist(), found.parameter) == ([16.0], 16.0)
    with pytest.raises(NotConvergedError, match=r"from c = 0\.01\S* to 0\.005: take") as refusal:
        list(solutions_at(narrow, branch, [0.005]))
    assert refusal.value.at == 0.005


@pytest.mark.parametrize("after", [False, True])
def test_beside_a_fold_the_start_is_that_of_a_parabola(after: bool) -> None:
    """u² = c at a fold at 0: three quarters of the way to it in c are half of it in u."""
    side = 1.0 if after else -1.0
    point = BranchPoint(np.array([1.0]), 1.0, np.ones(2), 0.0, 0.0, 1, orientation=side)
    other = replace(point, u=np.array([-1.0]))
    fold = fold_of(0.0, 0.0, np.zeros(1), index=1)
    begun: list[float] = []

    def parabola(u: Any, c: float) -> tuple[Any, Any, Any]:
        begun.append(float(u[0]))
        return u**2 - c, np.diag(2.0 * u), np.array([-1.0])

    points = (other, point) if after else (point, other)
    found = list(solutions_at(parabola, ContinuationBranch(points, (fold,), ()), [0.25]))
    assert [(each.u[0], turned) for each, turned in found] == [
        (points[0].u[0] / 2, 0), (points[1].u[0] / 2, 1),
    ]  # fmt: skip
    assert set(begun) == {0.5, -0.5}


def test_a_branch_that_cannot_be_followed_ends_in_a_sentence() -> None:
    start = solve_at(circle, np.array([0.7]), 1.0)
    with pytest.raises(NotConvergedError, match=r"to c = 1\.\d+ in 3 steps without a fold"):
        trace(circle, start, 5.0, None, StepControl(longest=0.1, max_steps=3))

    def walled(u: Any, c: float) -> tuple[Any, Any, Any]:
        if c > 1.3:
            raise NotConvergedError("outside")
        return circle(u, c)

    with pytest.raises(NotConvergedError, match=r"past c = 1\.3") as raised:
        trace(walled, start, 5.0)
    assert raised.value.at == pytest.approx(1.3, abs=1e-4)
