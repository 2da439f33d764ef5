"""Both cycles of one Van der Pol cell (Eq. 8 at c = 0), averaged and by shooting.

    ÿ + y + ε ẏ (1 - a y² + b y⁴) = 0

The averaged radii are closed forms. The true cycles are fixed points of the map from one maximum
of y to the next, taken by scipy's DOP853.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from time import perf_counter

import numpy as np
import numpy.typing as npt
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from theory.cells.vdp import eta_from_damping, is_bistable
from theory.chains.vdp import VdpChain, effective_epsilon
from theory.parameters import ParameterError, within

FloatArray = npt.NDArray[np.float64]

_LONGEST = 1e3
_STIFFEST = 60.0
"""Largest ε max|1 - a y² + b y⁴| on the stable cycle: DOP853 takes half a minute there."""


@dataclass(frozen=True)
class VdpCycle:
    """A cycle; symmetric about y = 0.

    Attributes
    ----------
    amplitude : float
        Largest y.
    period : float
        In units of t.
    averaged : float
        Amplitude as ε → 0, in closed form.
    error : float
        Difference of amplitude and period from a computation at a hundred times the tolerance.
    """

    amplitude: float
    period: float
    averaged: float
    error: float


@dataclass(frozen=True)
class VdpCell:
    """What one cell can do.

    Attributes
    ----------
    eta : float
        b/a².
    stable, unstable : VdpCycle or None
        None for η >= 1/8.
    seconds : float
        Run time.
    """

    eta: float
    stable: VdpCycle | None
    unstable: VdpCycle | None
    seconds: float


class _Turn:
    """An event for scipy: ẏ falls through 0, the start not counted."""

    direction, terminal = -1.0, True

    def __call__(self, t: float, z: FloatArray) -> float:
        return float(z[1]) if t > 0.0 else -1.0


def vdp_cell(a: float, b: float, eps: float, tolerance: float = 1e-12) -> VdpCell:
    """Return both cycles of a cell.

    Parameters
    ----------
    a, b : float
        Coefficients of the damping, positive.
    eps : float
        Small parameter, from 1e-4 to 1.
    tolerance : float
        Relative tolerance of DOP853, from 1e-13 to 1e-6.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or ε is so large that the averaged cycles do not lead to
        the true ones, or that these are too stiff.

    Examples
    --------
    >>> cell = vdp_cell(2.5, 0.5, 0.01)
    >>> abs(cell.stable.amplitude - cell.stable.averaged) < 1e-3
    True
    """
    begin = perf_counter()
    eta = eta_from_damping(a, b)
    within("small parameter eps", eps, 1e-4, 1.0)
    within("tolerance", tolerance, 1e-13, 1e-6)
    if not is_bistable(eta):
        return VdpCell(eta, None, None, perf_counter() - begin)
    chain = VdpChain(a=a, b=b, c=0.0, eps=eps)
    stiffness = effective_epsilon(chain)
    if stiffness > _STIFFEST:
        raise ParameterError(
            "eps max|1 - a y^2 + b y^4|", f"{stiffness:.4g}", f"at most {_STIFFEST:g} for a true "
            "cycle", "take a smaller eps, or a larger eta",
        )  # fmt: skip
    inner, outer = chain.unstable_amplitude, chain.stable_amplitude
    found = []
    for averaged in (outer, inner):
        (y, period), (coarse, other) = (
            _shoot(a, b, eps, averaged, math.sqrt(inner * outer), each)
            for each in (tolerance, 100.0 * tolerance)
        )
        error = max(abs(y - coarse), abs(period - other), 1e-14 * period)
        found.append(VdpCycle(y, period, averaged, error))
    return VdpCell(eta, found[0], found[1], perf_counter() - begin)


def _shoot(
    a: float, b: float, eps: float, guess: float, between: float, tolerance: float
) -> tuple[float, float]:
    """Return amplitude and period of the cycle near ``guess``, on its side of ``between``."""

    def following(y: float) -> tuple[float, float]:
        def rate(_: float, z: FloatArray) -> list[float]:
            damping = 1.0 - a * z[0] ** 2 + b * z[0] ** 4
            return [z[1], -z[0] - eps * z[1] * damping]

        run = solve_ivp(
            rate, (0.0, _LONGEST), [y, 0.0], "DOP853", events=_Turn(), rtol=tolerance,
            atol=1e-2 * tolerance, max_step=0.2,
        )  # fmt: skip
        if run.status != 1:
            raise ArithmeticError(f"no maximum follows y = {y:g}")
        return float(run.y[0, -1]), float(run.t[-1])

    def growth(y: float) -> float:
        return following(y)[0] / y - 1.0

    far, ratio = guess, min(1.2, max(1.0 / 1.2, guess / between))
    for _ in range(20):
        far *= ratio
        if growth(far) < 0.0 < growth(between):
            y = float(brentq(growth, far, between, xtol=1e-14, rtol=1e-14))
            return y, following(y)[1]
    raise ParameterError(
        "small parameter eps", eps, "small enough for averaging to point at the cycles",
        "take a smaller eps, or eta further from 1/8",
    )  # fmt: skip
