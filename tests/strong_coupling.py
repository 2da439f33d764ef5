"""κ of the front of (43) at strong coupling by shooting with scipy, r''' - κr' + f(r) = 0."""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp

from theory.arrays import FloatArray


def kappa_by_shooting(eta: float, low: float, high: float) -> tuple[float, float]:
    """Return the ends of an interval of κ that contains the front, by bisection from a wider one.

    The decaying solution is integrated backwards from r = 0. For κ above the value of the front it
    leaves r_s upwards, below it downwards.

    Parameters
    ----------
    eta : float
        η = b/a², dimensionless; up to 0.085, beyond which the side is not conclusive.
    low, high : float
        The initial interval.

    Raises
    ------
    ArithmeticError
        If it does not contain the front.
    """
    if not (_leaves_upwards(high, eta) and not _leaves_upwards(low, eta)):
        raise ArithmeticError(f"no front with κ from {low:g} to {high:g}")
    while high - low > 1e-12 * max(1.0, abs(high)):
        middle = 0.5 * (low + high)
        if _leaves_upwards(middle, eta):
            high = middle
        else:
            low = middle
    return low, high


def _leaves_upwards(kappa: float, eta: float) -> bool:
    r_s = math.sqrt((1.0 + math.sqrt(1.0 - 8.0 * eta)) / eta)  # a = 1, b = η
    roots = np.roots([1.0, 0.0, -kappa, 0.5])
    rate = float(min(roots, key=lambda root: root.real).real)

    def backward(_: float, x: FloatArray) -> list[float]:
        r = x[0]
        f = 0.5 * r * (1.0 - r * r / 4.0 + eta * r**4 / 8.0)
        return [-x[1], -x[2], -(kappa * x[1] - f)]

    def above(_: float, x: FloatArray) -> float:
        return float(x[0] - 1.4 * r_s)

    def below(_: float, x: FloatArray) -> float:
        return float(x[0] + 0.4 * r_s)

    above.terminal = below.terminal = True  # type: ignore[attr-defined]
    r = 1e-7 * r_s
    start = [r, rate * r, rate * rate * r]
    run = solve_ivp(
        backward, (0.0, 400.0), start, "DOP853", events=(above, below), rtol=1e-13, atol=1e-18
    )
    return run.t_events is not None and bool(run.t_events[0].size)
