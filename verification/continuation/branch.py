"""Branches of solutions of F(u, p) = 0: pseudo-arclength continuation, folds, and crossings."""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from theory.arrays import EPS, FloatArray
from theory.result import Result
from verification.continuation.newton import (
    PARAMETER_WEIGHT,
    BranchPoint,
    NotConvergedError,
    System,
    bordered,
    solve_at,
    step_along,
)

Monitor = Callable[[FloatArray, float], tuple[float, ...]]

_MIN_LENGTH = 1e-5
"""Arclength of a step below which the continuation of a branch is given up."""
_CROSSING_TOLERANCE = 1e-11
"""Difference in the parameter between the two sides of a crossing at which its search stops."""
_MAX_CROSSING = 200
"""Largest number of steps of that search; bisection alone takes about 40."""
_FRACTIONS = 0.5, 0.75, 0.9
"""Fractions of the step to a fold at which an earlier fold is looked for."""
_MAX_STEPS = 60
"""Largest number of steps tried on the way to a value between two nodes."""
_SMALLEST_FLOAT = 5e-324
"""Its negative replaces an exact zero of a monitored value, at which the search would stop with a
point on one side only."""


@dataclass(frozen=True, kw_only=True)
class BranchFold(Result):
    """A fold, at which a branch turns back.

    Attributes
    ----------
    c, eta : float
        Coupling and η = b/a² of the fold, dimensionless.
    error : float
        Bound on the error of c or η, whichever was varied along the branch.
    points_before : int
        Number of points of the branch before the fold.
    height : float
        Amplitude at the centre for breathers; velocity for fronts.
    height_error : float or None
        Bound on its error; None for fronts, for which it is not computed.
    """

    c: float
    eta: float
    error: float
    points_before: int
    height: float
    height_error: float | None = None


@dataclass(frozen=True)
class Fold:
    """The point at which a branch turns back in the parameter.

    Attributes
    ----------
    parameter : float
        Value of the parameter at the fold: a coupling c, or η.
    error : float
        Estimated difference between ``parameter`` and the fold where the search stopped, multiplied
        by four because the curvature is that of a secant, plus the displacement of the fold by the
        residual and the rounding of F.
    u : float array
        The solution at the fold.
    offset : float array
        Estimated vector from ``u`` to the fold, along the branch; multiplied by four for the same
        reason.
    transverse_error : float
        Largest error of ``u`` across the branch: the displacement of the fold, and ten times the
        last correction.
    tangent : float array
        Change of ``u`` along the branch at the fold.
    index : int
        Index of the first point of the branch beyond the fold.
    """

    parameter: float
    error: float
    u: FloatArray
    offset: FloatArray
    transverse_error: float
    tangent: FloatArray
    index: int = 0


@dataclass(frozen=True)
class Crossing:
    """The point at which a monitored value becomes positive.

    Attributes
    ----------
    parameter, error : float
        Value of the parameter, and the distance between the last values tried on its two sides,
        plus 1e-12 for rounding.
    u : float array
        The solution at the crossing.
    from_start : bool
        Whether the value is positive from the first point of the branch on.
    """

    parameter: float
    error: float
    u: FloatArray
    from_start: bool


@dataclass(frozen=True)
class ContinuationBranch:
    """Solutions in order along a branch, up to the end of a range or one step beyond the last fold.

    Attributes
    ----------
    points : tuple of BranchPoint
        In order along the branch.
    folds : tuple of Fold
        The folds in the same order.
    monitored : tuple of tuple of float
        The monitor's values at each point before the first fold.
    """

    points: tuple[BranchPoint, ...]
    folds: tuple[Fold, ...]
    monitored: tuple[tuple[float, ...], ...]

    @property
    def fold(self) -> Fold | None:
        """The first fold; None if the branch reached the end of the range before any fold."""
        return self.folds[0] if self.folds else None


@dataclass(frozen=True, kw_only=True)
class StepControl:
    """Parameters that control how a branch is followed.

    Attributes
    ----------
    length, longest : float
        First and largest arclength of a step.
    tolerance : float
        Largest residual allowed for a solution.
    max_steps : int
        Largest number of steps.
    fold_tolerance : float
        Estimated distance of the parameter from the fold at which its search stops.
    folds : int
        Number of folds that are passed; the branch ends one step beyond the next one.
    generic : bool
        Whether branches do not cross, for lack of symmetry. Where two of them nearly do, steps are
        then shortened until the branch is not left.
    """

    length: float = 0.1
    longest: float = 0.6
    tolerance: float = 1e-11
    max_steps: int = 200
    fold_tolerance: float = 1e-11
    folds: int = 0
    generic: bool = False


def trace(
    system: System,
    start: BranchPoint,
    p_end: float,
    monitor: Monitor | None = None,
    steps: StepControl = StepControl(),
) -> ContinuationBranch:
    """Follow a branch from a solution towards ``p_end``, through as many folds as ``steps`` states.

    Parameters
    ----------
    system : callable
        (u, p) → (F, ∂F/∂u, ∂F/∂p).
    start : BranchPoint
        A solution of `solve_at`.
    p_end : float
        The branch ends where the parameter leaves the range between its initial value and this one.
    monitor : callable, optional
        Evaluated at every point up to the first fold.

    Raises
    ------
    NotConvergedError
        If, before the first fold, the step becomes too short or there are too many steps. Beyond
        the first fold the branch simply ends there.
    """
    evaluate = monitor or (lambda u, p: ())
    low, high = min(start.parameter, p_end), max(start.parameter, p_end)
    direction = math.copysign(1.0, start.tangent[-1] * (p_end - start.parameter))
    point = start if direction > 0.0 else start.reversed()
    points, monitored, folds = [point], [evaluate(point.u, point.parameter)], []
    length = steps.length
    for _ in range(steps.max_steps):
        try:
            new, length = _next(system, point, length, steps)
            fold_passed = new.tangent[-1] * point.tangent[-1] <= 0.0
            if fold_passed:
                fold = _find_fold(system, point, new, length, steps)
                folds.append(replace(fold, index=len(points)))
        except NotConvergedError:
            length *= 0.5
            if length >= _MIN_LENGTH:
                continue
            if not folds:
                raise
            break
        points.append(new)
        if not folds:
            monitored.append(evaluate(new.u, new.parameter))
        if len(folds) > steps.folds or not low < new.parameter < high:
            break
        if new.iterations <= 5:
            length = min(1.5 * length, steps.longest)
        point = new
    else:
        if not folds:
            raise NotConvergedError(
                f"the branch was followed to c = {point.parameter:.6g} in {steps.max_steps} steps "
                "without a fold: take a smaller coupling."
            )
    return ContinuationBranch(tuple(points), tuple(folds), tuple(monitored))


def _next(
    system: System, point: BranchPoint, length: float, steps: StepControl
) -> tuple[BranchPoint, float]:
    """Take a step of this length, halved until it continues along a smooth branch.

    For generic systems a step past a bifurcation is taken only if no shorter step avoids it.

    Raises
    ------
    NotConvergedError
        If the step becomes too short.
    """
    past_bifurcation: tuple[BranchPoint, float] | None = None
    while length >= _MIN_LENGTH:
        with contextlib.suppress(NotConvergedError, np.linalg.LinAlgError):
            new = step_along(system, point, length, steps.tolerance)
            # A turn or a correction too large for a smooth branch may mean a jump to another
            # branch.
            if float(new.tangent @ point.tangent) >= 0.9 and _deviation(point, new, length) <= 0.3:
                if not steps.generic or new.orientation == point.orientation:
                    return new, length
                past_bifurcation = past_bifurcation or (new, length)
        length *= 0.5
    if past_bifurcation is not None:
        return past_bifurcation
    raise NotConvergedError(
        f"the branch could not be followed past c = {point.parameter:.6g}: take a smaller eps, or "
        "an eta farther from 1/8.",
        point.parameter,
    )


def solutions_at(
    system: System, branch: ContinuationBranch, values: Sequence[float]
) -> Iterator[tuple[BranchPoint, int]]:
    """Yield the solutions at given values in order along the branch, and the folds passed so far.

    Raises
    ------
    NotConvergedError
        If Newton's method fails both from the interpolated start and in steps.
    """
    nodes: list[tuple[FloatArray, float, Fold | None]] = [
        (point.u, point.parameter, None) for point in branch.points
    ]
    passed = 0
    for fold in reversed(branch.folds):
        nodes.insert(fold.index, (fold.u, fold.parameter, fold))
    required = np.unique(np.asarray(values, dtype=float))
    for index, ((u, p, from_fold), (u_next, p_next, to_fold)) in enumerate(
        itertools.pairwise(nodes)
    ):
        inside = required[
            (required >= min(p, p_next))
            & (required <= max(p, p_next))
            & ((required != p) | (index == 0))
        ]
        for value in (inside if p_next > p else inside[::-1]).tolist():
            fraction = (value - p) / (p_next - p)
            # Across a fold u varies like the square root of the distance from it.
            if to_fold is not None:
                fraction = 1.0 - math.sqrt(1.0 - fraction)
            elif from_fold is not None:
                fraction = math.sqrt(fraction)
            try:
                found = solve_at(system, u + fraction * (u_next - u), value)
            except NotConvergedError:
                found = _in_steps(system, u, p, value)
            for adjacent, side in ((from_fold, 1.0), (to_fold, -1.0)):
                if adjacent is not None:
                    found = _on_side(system, found, adjacent, side)
            yield found, passed
        passed += to_fold is not None


def _in_steps(system: System, u: FloatArray, p: float, value: float) -> BranchPoint:
    """Return the solution at a value, approached in steps from a solution u at p.

    The node beyond it is no guide where the branch bends, as where a last step passes c = 0.

    Raises
    ------
    NotConvergedError
        If the steps become too many.
    """
    to = value
    for _ in range(_MAX_STEPS):
        try:
            found = solve_at(system, u, to)
        except NotConvergedError:
            to = 0.5 * (p + to)
            continue
        if to == value:
            return found
        u, p, to = found.u, to, value
    raise NotConvergedError(
        f"the branch could not be followed from c = {p:.6g} to {value:.6g}: take couplings farther "
        "from there.",
        value,
    )


def _on_side(system: System, found: BranchPoint, fold: Fold, side: float) -> BranchPoint:
    """Return the solution before (-1) or after (1) a fold from one on either side of it.

    Close to a fold Newton's method may end on the other side. The solution sought is then about as
    far from the fold in the opposite direction.
    """
    tangent = fold.tangent
    if side * float(tangent @ (found.u - fold.u)) < 0.0:
        with contextlib.suppress(NotConvergedError):
            other = solve_at(system, 2.0 * fold.u - found.u, found.parameter)
            return other if side * float(tangent @ (other.u - fold.u)) > 0.0 else found
    return found


@dataclass
class _Bracket:
    """Two places with values of opposite sign, for the Illinois rule."""

    low: float
    high: float
    f_low: float
    f_high: float
    replaced: int = 0
    """1 if the last position replaced ``low``, -1 if ``high``."""

    def shrink(self, position: float, value: float) -> None:
        """Replace the end with a value of this sign; halve the value of an end kept twice."""
        if (value > 0.0) == (self.f_high > 0.0):
            self.high, self.f_high = position, value
            self.f_low *= 0.5 if self.replaced == -1 else 1.0
            self.replaced = -1
        else:
            self.low, self.f_low = position, value
            self.f_high *= 0.5 if self.replaced == 1 else 1.0
            self.replaced = 1


def _find_fold(
    system: System, before: BranchPoint, beyond: BranchPoint, length: float, steps: StepControl
) -> Fold:
    """Find where dp/ds vanishes on a step of this length from ``before`` to ``beyond``.

    dp/ds is linear across a fold, so the bracketed secant method (Illinois) needs few evaluations;
    the error of p is of second order in that of the position. Where two folds are close to each
    other dp/ds may vanish three times, and the first of these places is sought.
    """
    bracket = _Bracket(0.0, length, float(before.tangent[-1]), float(beyond.tangent[-1]))
    best, shortfall, distance = beyond, np.inf, np.inf
    for _ in range(40):
        curvature = (bracket.f_low - bracket.f_high) / (bracket.high - bracket.low)  # -d²p/ds²
        position = bracket.low + bracket.f_low / curvature
        best = step_along(system, before, position, steps.tolerance)
        value = float(best.tangent[-1])
        # p differs from the fold by the integral of dp/ds from here to it.
        distance = value / curvature
        shortfall = value**2 / (2.0 * PARAMETER_WEIGHT * abs(curvature))
        if shortfall < steps.fold_tolerance:
            earlier = _earlier_turn(system, before, position, steps)
            if earlier is None:
                break
            bracket = _Bracket(0.0, earlier[0], float(before.tangent[-1]), earlier[1])
        else:
            bracket.shrink(position, value)
    displacement = _fold_displacement(system, best)
    return Fold(
        parameter=best.parameter,
        error=4.0 * shortfall + displacement + 1e-15,
        u=best.u,
        offset=4.0 * distance * best.tangent[:-1],
        transverse_error=displacement + 10.0 * best.correction,
        tangent=best.tangent[:-1],
    )


def _earlier_turn(
    system: System, before: BranchPoint, position: float, steps: StepControl
) -> tuple[float, float] | None:
    """Return a position before a fold at which dp/ds has changed sign already, and dp/ds there."""
    for fraction in _FRACTIONS:
        dp_ds = float(step_along(system, before, fraction * position, steps.tolerance).tangent[-1])
        if dp_ds * before.tangent[-1] < 0.0:
            return fraction * position, dp_ds
    return None


def _fold_displacement(system: System, point: BranchPoint) -> float:
    """Return a bound on the displacement of p at a fold by the residual and the rounding of F.

    An error f of F displaces p by l·f, where l is the last row of the inverse of the bordered
    Jacobian matrix: at a fold, lᵀ∂F/∂u = 0 and l·∂F/∂p = 1. Twice the value of F and twice the
    rounding of its terms are taken for f; the bound is at least ten times the residual.
    """
    value, jacobian, by_p = system(point.u, point.parameter)
    inverse = np.linalg.inv(bordered(jacobian, by_p, point.tangent))
    f_bound = np.abs(value) + EPS * (np.abs(jacobian) @ np.abs(point.u))
    displacement = 2.0 * float(np.abs(inverse[-1, :-1]) @ f_bound) / PARAMETER_WEIGHT
    return max(displacement, 10.0 * point.residual)


class FoldShift(NamedTuple):
    """Largest shifts of a fold by errors of F: in its parameter, and of u across the branch."""

    parameter: float
    solution: float


def fold_shift(system: System, fold: Fold, f_bound: FloatArray) -> FoldShift:
    """Return the largest shifts of a fold that errors of F can cause.

    Parameters
    ----------
    f_bound : float array
        Bounds on the errors of F.
    """
    _, jacobian, by_p = system(fold.u, fold.parameter)
    inverse = np.linalg.inv(
        np.vstack([np.column_stack([jacobian, by_p]), np.append(fold.tangent, 0.0)])
    )
    shifts = np.abs(inverse[:, :-1]) @ f_bound
    return FoldShift(float(shifts[-1]), float(shifts[:-1].max()))


def first_crossing(
    system: System, branch: ContinuationBranch, monitor: Monitor, entry: int
) -> Crossing | None:
    """Find the first parameter up to the fold at which a monitored value changes to positive.

    Returns
    -------
    Crossing or None
        None if the value is never positive.

    Raises
    ------
    NotConvergedError
        If the crossing is not found to 1e-11 in the parameter.
    """
    nodes = [(point.u, point.parameter) for point in branch.points[: len(branch.monitored)]]
    values = [row[entry] for row in branch.monitored]
    if branch.fold is not None:
        nodes.append((branch.fold.u, branch.fold.parameter))
        values.append(monitor(*nodes[-1])[entry])
    positive = [index for index, value in enumerate(values) if value > 0.0]
    if not positive:
        return None
    first = positive[0]
    if first == 0:
        return Crossing(branch.points[0].parameter, 0.0, branch.points[0].u, from_start=True)
    ends = [(values[at], nodes[at][1], nodes[at][0]) for at in (first - 1, first)]
    return _crossing(system, branch.points[first - 1], ends, lambda u, p: monitor(u, p)[entry])


def _crossing(
    system: System,
    before: BranchPoint,
    ends: Sequence[tuple[float, float, FloatArray]],
    monitored: Callable[[FloatArray, float], float],
) -> Crossing:
    """Find where a value becomes positive on a step; ``ends`` holds value, p and u at both ends."""
    full_length = _length_to(before, ends[1][2], ends[1][1])
    evaluated = {0.0: ends[0], full_length: ends[1]}

    def value(length: float) -> float:
        if length not in evaluated:
            point = step_along(system, before, length)
            evaluated[length] = (monitored(point.u, point.parameter), point.parameter, point.u)
        return evaluated[length][0] or -_SMALLEST_FLOAT

    try:
        length = brentq(
            value,
            0.0,
            full_length,
            xtol=_CROSSING_TOLERANCE * PARAMETER_WEIGHT,
            maxiter=_MAX_CROSSING,
        )
    except NotConvergedError:
        length = None  # limited by rounding: the crossing lies between the two nearest places
    except RuntimeError:
        raise NotConvergedError(
            f"where stability changes between c = {ends[0][1]:.6g} and {ends[1][1]:.6g} was not "
            f"found in {_MAX_CROSSING} steps: take an eta farther from 1/8."
        ) from None
    low = max(index for index, (found, _, _) in evaluated.items() if found <= 0.0)
    high = min(index for index, (found, _, _) in evaluated.items() if found > 0.0)
    bracket_width = abs(evaluated[high][1] - evaluated[low][1])
    nearest = evaluated[low if length is None else length]
    return Crossing(nearest[1], bracket_width + 1e-12, nearest[2], from_start=False)


def arrive(system: System, branch: ContinuationBranch, p: float) -> BranchPoint:
    """Solve at a parameter that the branch has passed, on its part before the fold.

    Raises
    ------
    NotConvergedError
        If Newton's method fails from the interpolated start.
    """
    return next(solutions_at(system, branch, [p]))[0]


def _deviation(start: BranchPoint, end: BranchPoint, length: float) -> float:
    """Return the deviation of the end of a step from the tangent, relative to the step length."""
    tangent = start.tangent
    deviation = (
        np.append(end.u - start.u, PARAMETER_WEIGHT * (end.parameter - start.parameter))
        - length * tangent
    )
    return float(np.linalg.norm(deviation)) / length


def _length_to(start: BranchPoint, u: FloatArray, p: float) -> float:
    tangent = start.tangent
    return float(
        tangent[:-1] @ (u - start.u) + tangent[-1] * PARAMETER_WEIGHT * (p - start.parameter)
    )
