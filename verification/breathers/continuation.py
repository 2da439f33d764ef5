"""Branches of solutions of F(u, c) = 0: pseudo-arclength continuation, folds, and crossings."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from verification.breathers.newton import (
    COUPLING_WEIGHT,
    BranchPoint,
    NotConvergedError,
    Real,
    System,
    solve_at,
    step_along,
)

Monitor = Callable[[Real, float], tuple[float, ...]]


@dataclass(frozen=True)
class Fold:
    """The largest coupling on a branch.

    Attributes
    ----------
    c : float
        Coupling at the fold.
    error : float
        By how much ``c`` falls short where the search stopped, taken four times because the bend
        is a secant's, plus ten times the residual.
    u : float array
        The solution there.
    evaluations : int
        Evaluations of the system spent on it.
    """

    c: float
    error: float
    u: Real
    evaluations: int


@dataclass(frozen=True)
class Crossing:
    """Where a monitored value becomes positive.

    Attributes
    ----------
    c, error : float
        Coupling, and the change of it in the last step of the search.
    u : float array
        The solution there.
    from_start : bool
        Whether it is positive from the first point of the branch on.
    """

    c: float
    error: float
    u: Real
    from_start: bool


@dataclass(frozen=True)
class Branch:
    """Solutions from small coupling up to the fold and a step beyond.

    Attributes
    ----------
    points : tuple of BranchPoint
        In order along the branch.
    fold : Fold or None
        None if c reached the end of the range first.
    monitored : tuple of tuple of float
        The monitor's values at each point.
    """

    points: tuple[BranchPoint, ...]
    fold: Fold | None
    monitored: tuple[tuple[float, ...], ...]


def trace(
    system: System,
    start: BranchPoint,
    c_end: float,
    monitor: Monitor | None = None,
    *,
    length: float = 0.1,
    longest: float = 0.6,
    tolerance: float = 1e-11,
    most: int = 200,
    fold_tolerance: float = 1e-11,
) -> Branch:
    """Follow a branch towards larger c until it folds or reaches ``c_end``.

    Parameters
    ----------
    system : callable
        (u, c) → (F, ∂F/∂u, ∂F/∂c).
    start : BranchPoint
        From `solve_at`.
    c_end : float
        Stop there.
    monitor : callable, optional
        Evaluated at every point up to the fold.
    length, longest : float, optional
        First and largest arclength of a step.
    tolerance : float, optional
        Largest residual of a solution.
    most : int, optional
        Most steps.
    fold_tolerance : float, optional
        Shortfall of c at which the search for the fold stops.

    Raises
    ------
    NotConvergedError
        If the step becomes too short or there are too many.
    """
    watch = monitor or (lambda u, c: ())
    sense = 1.0 if start.tangent[-1] > 0 else -1.0
    point = BranchPoint(
        start.u, start.c, sense * start.tangent, start.residual, start.correction, start.iterations
    )
    points, seen = [point], [watch(point.u, point.c)]
    for _ in range(most):
        try:
            new = step_along(system, point, length, tolerance)
            # A turn or a correction too large for a smooth branch: it may be another branch.
            bent = float(new.tangent @ point.tangent) < 0.9 or _aside(point, new, length) > 0.3
        except (NotConvergedError, np.linalg.LinAlgError):
            bent = True
        if bent:
            length *= 0.5
            if length < 1e-5:
                raise NotConvergedError(
                    f"the branch of breathers could not be followed past c = {point.c:.6g}: "
                    "take a smaller eps, or an eta farther from 1/8."
                )
            continue
        if new.tangent[-1] <= 0.0:
            try:
                fold = find_fold(system, point, new, length, tolerance, fold_tolerance)
            except NotConvergedError:
                length *= 0.5
                continue
            return Branch((*points, new), fold, tuple(seen))
        points.append(new)
        seen.append(watch(new.u, new.c))
        if new.c >= c_end:
            return Branch(tuple(points), None, tuple(seen))
        if new.iterations <= 5:
            length = min(1.5 * length, longest)
        point = new
    raise NotConvergedError(
        f"the branch of breathers did not fold in {most} steps: end it at a smaller coupling."
    )


def find_fold(
    system: System,
    before: BranchPoint,
    beyond: BranchPoint,
    length: float,
    tolerance: float = 1e-11,
    fold_tolerance: float = 1e-11,
) -> Fold:
    """Find where dc/ds vanishes on a step from ``before`` of this length to ``beyond``.

    dc/ds is linear across a fold, so the bracketed secant (Illinois) takes a few evaluations;
    the error of c is of second order in that of the place.
    """
    low, high = 0.0, length
    f_low, f_high = before.tangent[-1], beyond.tangent[-1]
    best, missing, evaluations, side = beyond, np.inf, 0, 0
    for _ in range(40):
        bend = (f_low - f_high) / (high - low)
        best = step_along(system, before, low + f_low / bend, tolerance)
        evaluations += best.iterations
        value = best.tangent[-1]
        # c falls short by the integral of dc/ds from here to the fold.
        missing = value**2 / (2.0 * COUPLING_WEIGHT * abs(bend))
        if missing < fold_tolerance:
            break
        place = low + f_low / bend
        if value > 0:
            low, f_low = place, value
            f_high = 0.5 * f_high if side == 1 else f_high
            side = 1
        else:
            high, f_high = place, value
            f_low = 0.5 * f_low if side == -1 else f_low
            side = -1
    return Fold(best.c, 4.0 * missing + 10.0 * best.residual + 1e-15, best.u, evaluations)


def first_crossing(
    system: System, branch: Branch, monitor: Monitor, entry: int, tolerance: float = 1e-10
) -> Crossing | None:
    """Find the first coupling up to the fold at which a monitored value changes to positive.

    Returns
    -------
    Crossing or None
        None if the value is never positive.
    """
    nodes = [(point.u, point.c) for point in branch.points[: len(branch.monitored)]]
    values = [row[entry] for row in branch.monitored]
    if branch.fold is not None:
        nodes.append((branch.fold.u, branch.fold.c))
        values.append(monitor(*nodes[-1])[entry])
    positive = [place for place, value in enumerate(values) if value > 0.0]
    if not positive:
        return None
    place = positive[0]
    if place == 0:
        return Crossing(branch.points[0].c, 0.0, branch.points[0].u, from_start=True)
    before = branch.points[place - 1]
    low, high = 0.0, _length_to(before, *nodes[place])
    f_low, f_high = values[place - 1], values[place]
    here, last, side = before, np.inf, 0
    for _ in range(60):
        length = low + (high - low) * f_low / (f_low - f_high)
        here = step_along(system, before, length)
        value = monitor(here.u, here.c)[entry]
        if abs(here.c - last) < tolerance or value == 0.0:
            break
        last = here.c
        if value > 0.0:
            high, f_high = length, value
            f_low = 0.5 * f_low if side == 1 else f_low
            side = 1
        else:
            low, f_low = length, value
            f_high = 0.5 * f_high if side == -1 else f_high
            side = -1
    return Crossing(here.c, abs(here.c - last) + 1e-12, here.u, from_start=False)


def arrive(system: System, branch: Branch, c: float) -> BranchPoint:
    """Solve at a coupling that the branch has passed, on its part before the fold.

    Raises
    ------
    NotConvergedError
        If Newton's method fails from the interpolated start.
    """
    nearest = [point for point in branch.points[: len(branch.monitored)] if point.c <= c][-1]
    end = branch.fold if branch.fold is not None else branch.points[-1]
    span = end.c - nearest.c
    share = (c - nearest.c) / span if span > 0.0 else 0.0
    if branch.fold is not None:
        # Across a fold u varies like the square root of the distance to it.
        share = 1.0 - math.sqrt(max(0.0, 1.0 - share))
    return solve_at(system, nearest.u + share * (end.u - nearest.u), c)


def _aside(start: BranchPoint, end: BranchPoint, length: float) -> float:
    """Return the distance of a step's end from the tangent, relative to its length."""
    across = start.tangent
    away = np.append(end.u - start.u, COUPLING_WEIGHT * (end.c - start.c)) - length * across
    return float(np.linalg.norm(away)) / length


def _length_to(start: BranchPoint, u: Real, c: float) -> float:
    across = start.tangent
    return float(across[:-1] @ (u - start.u) + across[-1] * COUPLING_WEIGHT * (c - start.c))
