"""Newton's method at a fixed parameter, and one pseudo-arclength step, for F(u, p) = 0.

A *system* is a function (u, p) → (F, ∂F/∂u, ∂F/∂p). All matrices are dense, since u has tens of
entries. Arclength is measured in (u, `PARAMETER_WEIGHT`·p), so that u and p have similar weight.
The parameter p is the coupling c for most branches, and η for fronts followed along η.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from theory.arrays import FloatArray
from theory.parameters import RunError

System = Callable[[FloatArray, float], tuple[FloatArray, FloatArray, FloatArray]]

PARAMETER_WEIGHT = 10.0
MAX_NEWTON = 20


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
    """

    u: FloatArray
    parameter: float
    tangent: FloatArray
    residual: float
    correction: float
    iterations: int


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
            return BranchPoint(u, p, _tangent(slope, by_p, None), residual, left, iteration)
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
            return BranchPoint(u, p, _tangent(slope, by_p, across), residual, left, iteration)
        correction = float(np.abs(change).max())
        u = u - change[:-1]
        p -= float(change[-1]) / PARAMETER_WEIGHT
    raise NotConvergedError(
        f"no step of length {length:.2g} leads on from c = {start.parameter:.6g}: take a smaller "
        "coupling.",
        start.parameter,
    )


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
