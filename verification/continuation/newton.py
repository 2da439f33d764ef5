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
_BESIDE = 1e-7, 1e-3
"""Range of the step, in u, of the difference that gives the second derivative of F."""


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
    value, slope, by_p = system(u, p)
    for iteration in range(1, MAX_NEWTON + 1):
        residual = float(np.abs(value).max())
        if not np.isfinite(residual):
            break
        # One more step when the residual is already small costs little and squares the error.
        if residual < tolerance and correction < np.sqrt(tolerance):
            left = float(np.abs(np.linalg.solve(slope, value)).max())
            tangent = _tangent(slope, by_p, None)
            side = _orientation(slope, tangent)
            return BranchPoint(u, p, tangent, residual, left, iteration, side)
        try:
            change = np.linalg.solve(slope, value)
        except np.linalg.LinAlgError:
            break
        for share in (1.0, 0.5, 0.25, 0.1, 0.03):
            try:
                trial = system(u - share * change, p)
            except NotConvergedError:
                continue
            if float(np.abs(trial[0]).max()) < max(residual, tolerance):
                break
        else:
            break
        value, slope, by_p = trial
        u = u - share * change
        correction = float(np.abs(share * change).max())
    raise NotConvergedError(
        f"no solution was found at c = {p:.6g}: take a smaller coupling, or a smaller eps.", p
    )


def solution_error(
    system: System, u: FloatArray, p: float, rounding: FloatArray | float = 0.0, aside: float = 0.0
) -> float:
    """Return a bound on the distance of an approximate solution from the exact one.

    With y the largest Newton step for any F within twice the computed one plus its rounding, and K
    the second derivative of F along this step, in units of ∂F/∂u, the distance e obeys e ≤ y + ½Ke²
    (Kantorovich). The smaller root bounds it where there are two. There are none close to a fold:
    the exact solutions, of which there may be two, are then within the root of ½Ke² = e + y.

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
    aside : float
        Error of the parameter: close to a fold, that of the fold, within which the two solutions
        that meet there are not distinguished.
    """
    value, slope, by_p = system(u, p)
    off = 2.0 * np.abs(value) + EPS * (np.abs(slope) @ np.abs(u)) + rounding
    off += aside * np.abs(by_p)
    try:
        inverse = np.linalg.inv(slope)
    except np.linalg.LinAlgError:
        return np.inf
    steps = np.abs(inverse) @ off
    largest = float(steps.max())
    if not 0.0 < largest < np.inf:
        return largest
    worst = inverse @ np.copysign(off, inverse[int(steps.argmax())])
    # Near the size of the error, since F'' may be much larger elsewhere.
    beside = worst * (float(np.clip(10.0 * largest, *_BESIDE)) / largest)
    bend = inverse @ ((system(u + beside, p)[1] - slope) @ beside)
    curvature = float(np.abs(bend).max()) / float(np.abs(beside).max()) ** 2
    twice = 2.0 * curvature * largest
    if twice <= 1.0:
        return 2.0 * largest / (1.0 + float(np.sqrt(1.0 - twice)))
    return (1.0 + float(np.sqrt(1.0 + twice))) / curvature


def step_along(
    system: System, start: BranchPoint, length: float, tolerance: float = 1e-11
) -> BranchPoint:
    """Take one pseudo-arclength step: solve F = 0 on the plane orthogonal to the tangent.

    Raises
    ------
    NotConvergedError
        If Newton's method fails; then take a shorter step.
    """
    across = start.tangent
    u = start.u + length * across[:-1]
    p = float(start.parameter + length * across[-1] / PARAMETER_WEIGHT)
    correction = np.inf
    for iteration in range(1, MAX_NEWTON + 1):
        value, slope, by_p = system(u, p)
        residual = float(np.abs(value).max())
        if not np.isfinite(residual) or residual > 1e6:
            break
        plane = (
            across[:-1] @ (u - start.u)
            + across[-1] * PARAMETER_WEIGHT * (p - start.parameter)
            - length
        )
        change = np.linalg.solve(bordered(slope, by_p, across), np.append(value, plane))
        if residual < tolerance and correction < np.sqrt(tolerance):
            left = float(np.abs(change).max())
            tangent = _tangent(slope, by_p, across)
            side = _orientation(slope, tangent)
            return BranchPoint(u, p, tangent, residual, left, iteration, side)
        correction = float(np.abs(change).max())
        u = u - change[:-1]
        p -= float(change[-1]) / PARAMETER_WEIGHT
    raise NotConvergedError(
        f"no step of length {length:.2g} leads on from c = {start.parameter:.6g}: take a smaller "
        "coupling.",
        start.parameter,
    )


def _orientation(slope: FloatArray, tangent: FloatArray) -> float:
    return float(np.linalg.slogdet(slope)[0] * np.sign(tangent[-1]))


def bordered(slope: FloatArray, by_p: FloatArray, row: FloatArray) -> FloatArray:
    """Return the matrix of a step along a branch: that of F, and a row for its plane."""
    return np.vstack([np.column_stack([slope, by_p / PARAMETER_WEIGHT]), row])


def _tangent(slope: FloatArray, by_p: FloatArray, along: FloatArray | None) -> FloatArray:
    """Return the unit null vector of (∂F/∂u, ∂F/∂p), in the direction of ``along`` if given."""
    size = slope.shape[1] + 1
    row = np.zeros(size) if along is None else along
    if along is None:
        row[-1] = 1.0
    vector = np.linalg.solve(bordered(slope, by_p, row), np.append(np.zeros(size - 1), 1.0))
    unit: FloatArray = vector / np.linalg.norm(vector)
    return unit
