"""Newton's method at a fixed parameter, and one pseudo-arclength step, for F(u, p) = 0.

A *system* is a function (u, p) → (F, ∂F/∂u, ∂F/∂p). All matrices are dense, since u has tens of
entries. Arclength is measured in (u, `PARAMETER_WEIGHT`·p), so that u and p have similar weight.
The parameter p is the coupling c for most branches, and η for fronts followed along η.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from theory.arrays import EPS, FloatArray
from theory.parameters import RunError

System = Callable[[FloatArray, float], tuple[FloatArray, FloatArray, FloatArray]]

PARAMETER_WEIGHT = 10.0
MAX_NEWTON = 20
_INCREMENTS = 1e-7, 1e-3
"""Range of the increment of u in the difference quotient for the second derivative of F."""


class NotConvergedError(RunError):
    """Newton's method did not converge from this start.

    Parameters
    ----------
    message : str
        The message, worded for a coupling c as the parameter.
    at : float, optional
        Value of the parameter, for callers that follow another parameter.
    """

    def __init__(self, message: str, at: float | None = None) -> None:
        super().__init__(message)
        self.at = at


@dataclass(frozen=True)
class BranchPoint:
    """One solution.

    Attributes
    ----------
    u : float array
        The unknowns.
    parameter : float
        Coupling c, or η.
    tangent : float array
        Unit tangent (du, weight·dp) of the branch, in either direction.
    residual : float
        Largest entry of F.
    correction : float
        Size of the next Newton step: an estimate of the error of u.
    iterations : int
        Number of evaluations of the system.
    orientation : float
        Sign of det(∂F/∂u) times the last entry of the tangent. It is constant along a branch, so
        that a step after which it differs has passed a bifurcation or led to another branch.
    """

    u: FloatArray
    parameter: float
    tangent: FloatArray
    residual: float
    correction: float
    iterations: int
    orientation: float

    def reversed(self) -> BranchPoint:
        """Return the same solution with the tangent in the other direction."""
        return replace(self, tangent=-self.tangent, orientation=-self.orientation)


def solve_at(system: System, guess: FloatArray, p: float, tolerance: float = 1e-11) -> BranchPoint:
    """Solve F(u, p) = 0 for u by Newton's method.

    Raises
    ------
    NotConvergedError
        If the residual does not fall below ``tolerance``.

    Examples
    --------
    >>> def circle(u, p):
    ...     return u**2 + p**2 - 1.0, np.diag(2.0 * u), np.array([2.0 * p])
    >>> round(float(solve_at(circle, np.array([1.0]), 0.6).u[0]), 9)
    0.8
    """
    u = np.array(guess, dtype=float)
    correction = np.inf
    value, jacobian, by_p = system(u, p)
    for iteration in range(1, MAX_NEWTON + 1):
        residual = float(np.abs(value).max())
        if not np.isfinite(residual):
            break
        # One more step when the residual is already small costs little and squares the error.
        if residual < tolerance and correction < np.sqrt(tolerance):
            next_step = float(np.abs(np.linalg.solve(jacobian, value)).max())
            tangent = _tangent(jacobian, by_p, None)
            orientation = _orientation(jacobian, tangent)
            return BranchPoint(u, p, tangent, residual, next_step, iteration, orientation)
        try:
            increment = np.linalg.solve(jacobian, value)
        except np.linalg.LinAlgError:
            break
        for damping in (1.0, 0.5, 0.25, 0.1, 0.03):
            try:
                trial = system(u - damping * increment, p)
            except NotConvergedError:
                continue
            if float(np.abs(trial[0]).max()) < max(residual, tolerance):
                break
        else:
            break
        value, jacobian, by_p = trial
        u = u - damping * increment
        correction = float(np.abs(damping * increment).max())
    raise NotConvergedError(
        f"no solution was found at c = {p:.6g}: take a smaller coupling, or a smaller eps.", p
    )


def solution_error(
    system: System,
    u: FloatArray,
    p: float,
    rounding: FloatArray | float = 0.0,
    parameter_error: float = 0.0,
) -> float:
    """Return a bound on the distance of an approximate solution from the exact one.

    Let y be the largest Newton step for any F within twice the computed one plus its rounding, and
    K the second derivative of F along this step, multiplied by the inverse of ∂F/∂u. The distance e
    obeys e ≤ y + ½Ke² (Kantorovich). Where ½Ke² - e + y = 0 has two roots, that is, where
    2h = 2Ky ≤ 1, the smaller one bounds e. Close to a fold there is none, and there may be two
    exact solutions; their distances are below the root of ½Ke² = e + y.

    Parameters
    ----------
    system : System
        The equations.
    u : float array
        A solution of `solve_at`.
    p : float
        Value of the parameter.
    rounding : float array or float
        Bound on the errors of F, besides those that relative errors of u in the last place cause.
    parameter_error : float
        Error of the parameter: close to a fold, that of the fold, within which the two solutions
        that meet there are not distinguished.
    """
    value, jacobian, by_p = system(u, p)
    f_bound = 2.0 * np.abs(value) + EPS * (np.abs(jacobian) @ np.abs(u)) + rounding
    f_bound += parameter_error * np.abs(by_p)
    try:
        inverse = np.linalg.inv(jacobian)
    except np.linalg.LinAlgError:
        return np.inf
    step_bounds = np.abs(inverse) @ f_bound
    largest_step = float(step_bounds.max())
    if not 0.0 < largest_step < np.inf:
        return largest_step
    newton_step = inverse @ np.copysign(f_bound, inverse[int(step_bounds.argmax())])
    # Near the size of the error, since F'' may be much larger elsewhere.
    size = float(np.clip(10.0 * largest_step, *_INCREMENTS))
    increment = newton_step * (size / largest_step)
    second_derivative = inverse @ ((system(u + increment, p)[1] - jacobian) @ increment)
    curvature = float(np.abs(second_derivative).max()) / size**2
    twice_h = 2.0 * curvature * largest_step
    if twice_h <= 1.0:
        return 2.0 * largest_step / (1.0 + float(np.sqrt(1.0 - twice_h)))
    return (1.0 + float(np.sqrt(1.0 + twice_h))) / curvature


def step_along(
    system: System, start: BranchPoint, length: float, tolerance: float = 1e-11
) -> BranchPoint:
    """Take one pseudo-arclength step: solve F = 0 on the plane orthogonal to the tangent.

    Raises
    ------
    NotConvergedError
        If Newton's method fails; then take a shorter step.
    """
    direction = start.tangent
    u = start.u + length * direction[:-1]
    p = float(start.parameter + length * direction[-1] / PARAMETER_WEIGHT)
    correction = np.inf
    for iteration in range(1, MAX_NEWTON + 1):
        value, jacobian, by_p = system(u, p)
        residual = float(np.abs(value).max())
        if not np.isfinite(residual) or residual > 1e6:
            break
        arclength_residual = (
            direction[:-1] @ (u - start.u)
            + direction[-1] * PARAMETER_WEIGHT * (p - start.parameter)
            - length
        )
        increment = np.linalg.solve(
            bordered(jacobian, by_p, direction), np.append(value, arclength_residual)
        )
        if residual < tolerance and correction < np.sqrt(tolerance):
            next_step = float(np.abs(increment).max())
            tangent = _tangent(jacobian, by_p, direction)
            orientation = _orientation(jacobian, tangent)
            return BranchPoint(u, p, tangent, residual, next_step, iteration, orientation)
        correction = float(np.abs(increment).max())
        u = u - increment[:-1]
        p -= float(increment[-1]) / PARAMETER_WEIGHT
    raise NotConvergedError(
        f"no step of length {length:.2g} leads on from c = {start.parameter:.6g}: take a smaller "
        "coupling.",
        start.parameter,
    )


def _orientation(jacobian: FloatArray, tangent: FloatArray) -> float:
    return float(np.linalg.slogdet(jacobian)[0] * np.sign(tangent[-1]))


def bordered(jacobian: FloatArray, by_p: FloatArray, row: FloatArray) -> FloatArray:
    """Return the Jacobian matrix of F in (u, weight·p), bordered by a row from below."""
    return np.vstack([np.column_stack([jacobian, by_p / PARAMETER_WEIGHT]), row])


def _tangent(jacobian: FloatArray, by_p: FloatArray, direction: FloatArray | None) -> FloatArray:
    """Return the unit null vector of (∂F/∂u, ∂F/∂p), along ``direction`` if given."""
    size = jacobian.shape[1] + 1
    border = np.zeros(size) if direction is None else direction
    if direction is None:
        border[-1] = 1.0
    vector = np.linalg.solve(bordered(jacobian, by_p, border), np.append(np.zeros(size - 1), 1.0))
    unit: FloatArray = vector / np.linalg.norm(vector)
    return unit
