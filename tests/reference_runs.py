"""Right-hand sides and runs by scipy with which only tests compare."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from theory.arrays import FloatArray
from verification.references.equations import Rate
from verification.references.network import Force, undriven


def overdamped_rate(
    g: Force, matrix: Any, *, c: float, force: Callable[[float], Any] = undriven
) -> Rate:
    """Return the right-hand side without inertia, for y alone."""

    def rate(t: float, y: FloatArray) -> FloatArray:
        slope: FloatArray = force(t) - g(y) - c * (matrix @ y)
        return slope

    return rate


def states_by_scipy(
    rate: Rate, start: FloatArray, times: FloatArray, tolerance: float = 1e-12
) -> FloatArray:
    """Return the states at the times, shape (M, …), by DOP853.

    Raises
    ------
    ArithmeticError
        If the integration does not reach the last of them.
    """
    span, floor = (0.0, float(times[-1])), 1e-2 * tolerance
    found = solve_ivp(rate, span, start, method="DOP853", rtol=tolerance, atol=floor, t_eval=times)
    if not found.success:
        raise ArithmeticError(found.message)
    return np.asarray(found.y.T)
