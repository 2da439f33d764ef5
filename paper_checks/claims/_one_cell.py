"""A run of one oscillator by scipy alone, as a function of time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Real = NDArray[np.float64]
Rate = Callable[[float, Real], list[float]]


def trajectory(rate: Rate, end: float, start: list[float]) -> Callable[[float], Real]:
    """Return (y, y') as a function of time from 0 to ``end``."""
    from scipy.integrate import solve_ivp

    run = solve_ivp(
        rate, (0.0, end), start, method="DOP853", rtol=1e-11, atol=1e-13, dense_output=True
    )
    dense = run.sol
    if dense is None:
        raise ArithmeticError("the integrator kept no solution.")
    return lambda time: np.asarray(dense(time), dtype=float)
