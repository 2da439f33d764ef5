"""Newton's method at fixed coupling, and one pseudo-arclength step, for F(u, c) = 0.

A *system* is a function (u, c) → (F, ∂F/∂u, ∂F/∂c). Everything is dense: u has tens of entries.
Arclength is measured in (u, `COUPLING_WEIGHT`·c), so that a step sees c and u alike.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from theory.parameters import RunError

Real = NDArray[np.float64]
System = Callable[[Real, float], tuple[Real, Real, Real]]

COUPLING_WEIGHT = 10.0
MAX_NEWTON = 20


class NotConvergedError(RunError):
    """Newton's method found no solution from this start.

    Parameters
    ----------
    message : str
        For a parameter that is a coupling c.
    at : float, optional
        Value of the parameter, for who follows another one.
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
    c : float
        Coupling.
    tangent : float array
        Unit tangent (du, weight·dc) of the branch, of either sense.
    residual : float
        Largest entry of F.
    correction : float
        Size of the Newton step that would come next: an estimate of the error of u.
    iterations : int
        Evaluations of the system.
    """

    u: Real
    c: float
    tangent: Real
    residual: float
    correction: float
    iterations: int


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
    for iteration in range(1, MAX_NEWTON + 1):
        residual = float(np.abs(value).max())
        if not np.isfinite(residual):
            break
        # One more step once the residual is small costs little and squares the error.
        if residual < tolerance and correction < np.sqrt(tolerance):
            left = float(np.abs(np.linalg.solve(slope, value)).max())
            return BranchPoint(u, c, _tangent(slope, by_c, None), residual, left, iteration)
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
    raise NotConvergedError(
        f"no solution was found at c = {c:.6g}: take a smaller coupling, or a smaller eps.", c
    )


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
    c = float(start.c + length * across[-1] / COUPLING_WEIGHT)
    correction = np.inf
    for iteration in range(1, MAX_NEWTON + 1):
        value, slope, by_c = system(u, c)
        residual = float(np.abs(value).max())
        if not np.isfinite(residual) or residual > 1e6:
            break
        plane = across[:-1] @ (u - start.u) + across[-1] * COUPLING_WEIGHT * (c - start.c) - length
        change = np.linalg.solve(_bordered(slope, by_c, across), np.append(value, plane))
        if residual < tolerance and correction < np.sqrt(tolerance):
            left = float(np.abs(change).max())
            return BranchPoint(u, c, _tangent(slope, by_c, across), residual, left, iteration)
        correction = float(np.abs(change).max())
        u = u - change[:-1]
        c -= float(change[-1]) / COUPLING_WEIGHT
    raise NotConvergedError(
        f"no step of length {length:.2g} leads on from c = {start.c:.6g}: take a smaller coupling.",
        start.c,
    )


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
