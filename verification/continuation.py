"""Branches of solutions of F(u, c) = 0: Newton, pseudo-arclength steps, folds, and crossings.

A *system* is a function (u, c) → (F, ∂F/∂u, ∂F/∂c). Everything is dense: u has tens of entries.
Arclength is measured in (u, `COUPLING_WEIGHT`·c), so that a step sees c and u alike.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
System = Callable[[Real, float], tuple[Real, Real, Real]]
Monitor = Callable[[Real, float], tuple[float, ...]]

COUPLING_WEIGHT = 10.0
MOST_NEWTON = 20


class NotConvergedError(ArithmeticError):
    """Newton's method found no solution from this start."""


@dataclass(frozen=True)
class BranchPoint:
    """One solution.

    Attributes
    ----------
    u : float array
        The unknowns.
    c : float
        Coupling.
    tangent : float array
        Unit tangent (du, weight·dc) of the branch, of either sense.
    residual : float
        Largest entry of F.
    correction : float
        Size of the last Newton step: with quadratic convergence it bounds the error of u.
    iterations : int
        Evaluations of the system.
    """

    u: Real
    c: float
    tangent: Real
    residual: float
    correction: float
    iterations: int


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


def solve_at(system: System, guess: Real, c: float, tolerance: float = 1e-11) -> BranchPoint:
    """Solve F(u, c) = 0 for u by Newton's method.

    Raises
    ------
    NotConvergedError
        If the residual does not fall to ``tolerance``.

    Examples
    --------
    >>> def circle(u, c):
    ...     return u**2 + c**2 - 1.0, np.diag(2.0 * u), np.array([2.0 * c])
    >>> round(float(solve_at(circle, np.array([1.0]), 0.6).u[0]), 9)
    0.8
    """
    u = np.array(guess, dtype=float)
    correction = np.inf
    value, slope, by_c = system(u, c)
    for iteration in range(1, MOST_NEWTON + 1):
        residual = float(np.abs(value).max())
        if not np.isfinite(residual):
            break
        # One more step once the residual is small costs little and squares the error.
        if residual < tolerance and correction < np.sqrt(tolerance):
            tangent = _tangent(slope, by_c, None)
            return BranchPoint(u, c, tangent, residual, correction, iteration)
        try:
            change = np.linalg.solve(slope, value)
        except np.linalg.LinAlgError:
            break
        for share in (1.0, 0.5, 0.25, 0.1, 0.03):
            try:
                trial = system(u - share * change, c)
            except NotConvergedError:
                continue
            if float(np.abs(trial[0]).max()) < max(residual, tolerance):
                break
        else:
            break
        value, slope, by_c = trial
        u = u - share * change
        correction = float(np.abs(share * change).max())
    raise NotConvergedError(f"no solution found at c = {c:.6g}")


def step_along(
    system: System, start: BranchPoint, length: float, tolerance: float = 1e-11
) -> BranchPoint:
    """Take one pseudo-arclength step: solve F = 0 on the plane across the tangent.

    Raises
    ------
    NotConvergedError
        If Newton's method fails; take a shorter step.
    """
    across = start.tangent
    u = start.u + length * across[:-1]
    c = start.c + length * float(across[-1]) / COUPLING_WEIGHT
    correction = np.inf
    for iteration in range(1, MOST_NEWTON + 1):
        value, slope, by_c = system(u, c)
        residual = float(np.abs(value).max())
        if not np.isfinite(residual) or residual > 1e6:
            break
        if residual < tolerance and correction < np.sqrt(tolerance):
            return BranchPoint(u, c, _tangent(slope, by_c, across), residual, correction, iteration)
        plane = across[:-1] @ (u - start.u) + across[-1] * COUPLING_WEIGHT * (c - start.c) - length
        change = np.linalg.solve(_bordered(slope, by_c, across), np.append(value, plane))
        correction = float(np.abs(change).max())
        u = u - change[:-1]
        c -= float(change[-1]) / COUPLING_WEIGHT
    raise NotConvergedError(f"no step of length {length:.2g} from c = {start.c:.6g}")


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
                raise NotConvergedError(f"the branch could not be followed past c = {point.c:.6g}")
            continue
        if new.tangent[-1] <= 0.0:
            fold = find_fold(system, point, new, length, tolerance, fold_tolerance)
            return Branch((*points, new), fold, tuple(seen))
        points.append(new)
        seen.append(watch(new.u, new.c))
        if new.c >= c_end:
            return Branch(tuple(points), None, tuple(seen))
        if new.iterations <= 5:
            length = min(1.5 * length, longest)
        point = new
    raise NotConvergedError(f"the branch did not fold in {most} steps")


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


def _aside(start: BranchPoint, end: BranchPoint, length: float) -> float:
    """Return the distance of a step's end from the tangent, relative to its length."""
    across = start.tangent
    away = np.append(end.u - start.u, COUPLING_WEIGHT * (end.c - start.c)) - length * across
    return float(np.linalg.norm(away)) / length


def _length_to(start: BranchPoint, u: Real, c: float) -> float:
    across = start.tangent
    return float(across[:-1] @ (u - start.u) + across[-1] * COUPLING_WEIGHT * (c - start.c))


def _bordered(slope: Real, by_c: Real, row: Real) -> Real:
    return np.vstack([np.column_stack([slope, by_c / COUPLING_WEIGHT]), row])


def _tangent(slope: Real, by_c: Real, along: Real | None) -> Real:
    """Return the unit null vector of (∂F/∂u, ∂F/∂c), in the sense of ``along`` if given."""
    size = slope.shape[1] + 1
    row = np.zeros(size) if along is None else along
    if along is None:
        row[-1] = 1.0
    vector = np.linalg.solve(_bordered(slope, by_c, row), np.append(np.zeros(size - 1), 1.0))
    unit: Real = vector / np.linalg.norm(vector)
    return unit
