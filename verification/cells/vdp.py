"""Both cycles of one Van der Pol cell (Eq. 8 at c = 0), averaged and by shooting.

    ÿ + y + ε ẏ (1 - a y² + b y⁴) = 0

The averaged radii are closed forms. The true cycles are fixed points of the map from one maximum
of y to the next, taken by scipy's DOP853.
"""

from __future__ import annotations

import math
from time import perf_counter

from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from theory.arrays import FloatArray
from theory.cells.vdp import ETA_END, eta_from_damping, is_bistable
from theory.parameters import ParameterError, within
from verification.cells.result import Cell, CellCycle, CellStatus

ROUNDING = 1e-14
"""Relative rounding of a period, over the some hundred steps that it takes."""
_LONGEST = 1e3
_STEP = 0.2
"""Longest step at a tolerance of 1e-12."""
_STIFFEST = 60.0
"""Largest ε max|1 - a y² + b y⁴| on the stable cycle: DOP853 takes half a minute there."""


def longest_step(tolerance: float) -> float:
    """Return the longest step, over that at a tolerance of 1e-12.

    It errs in proportion to the tolerance, as DOP853 is of order eight. Were it the same at every
    tolerance, a coarser run would take the same steps where that is all that limits them, and
    nothing would be seen of their error.
    """
    return float((tolerance / 1e-12) ** (1.0 / 8.0))


class Maximum:
    """An event for scipy: ẏ falls through 0, the start not counted."""

    direction, terminal = -1.0, True

    def __call__(self, t: float, z: FloatArray) -> float:
        """Return what changes sign."""
        return float(z[1]) if t > 0.0 else -1.0


def vdp_cell(a: float, b: float, eps: float, tolerance: float) -> Cell:
    """Return both cycles of a cell.

    y → y√a turns (a, b) into (1, η), so that shooting has the same tolerance for every a.

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
    >>> found = vdp_cell(2.5, 0.5, 0.01, 1e-12)
    >>> abs(found.stable_cycle.amplitude - found.stable_cycle.averaged) < 1e-3
    True
    """
    begin = perf_counter()
    eta = eta_from_damping(a, b)
    remedy = "give such a value; for smaller ones take the averaged cell, which is their limit"
    within("small parameter eps", eps, 1e-4, 1.0, remedy)
    within("tolerance", tolerance, 1e-13, 1e-6)
    stable = unstable = None
    if is_bistable(eta):
        _check_stiffness(eta, eps)
        root = math.sqrt(1.0 - 8.0 * eta)
        # |φ_us|² and |φ_s|² with a = 1: neither cancels.
        squares = 8.0 / (1.0 + root), (1.0 + root) / eta
        unstable, stable = (
            _cycle(
                eta,
                eps,
                math.sqrt(each),
                between=(squares[0] * squares[1]) ** 0.25,
                a=a,
                tolerance=tolerance,
            )
            for each in squares
        )
    return Cell(
        model="vdp",
        parameters={"a": a, "b": b, "eps": eps},
        status=CellStatus.REST if stable is None else CellStatus.BISTABLE,
        steady_sliding=None,
        effective_damping=eps,
        stable_cycle=stable,
        unstable_cycle=unstable,
        seconds=perf_counter() - begin,
    )


def averaged_cell(a: float, b: float, eps: float) -> Cell:
    """Return both cycles of (43), in closed form: |φ|² = (a/b)(1 ∓ √(1 - 8η)), of period 2π.

    At η = 1/8 they are one, which is semistable.

    Raises
    ------
    ParameterError
        If a parameter is out of range.

    Examples
    --------
    >>> found = averaged_cell(4, 0.5, 0.01)
    >>> round(found.unstable_cycle.amplitude, 6), round(found.stable_cycle.amplitude, 6)
    (1.035276, 3.863703)
    """
    begin = perf_counter()
    eta = eta_from_damping(a, b)
    stable = unstable = None
    status = CellStatus.REST
    if is_bistable(eta):
        root = math.sqrt(1.0 - 8.0 * eta)
        # Rounding of η alone moves the root by this much, as the cycles meet.
        spread = 8.0 * ROUNDING / root**2
        unstable, stable = (
            _closed(math.sqrt(square), spread)
            for square in (8.0 / a / (1.0 + root), a / b * (1.0 + root))
        )
        status = CellStatus.BISTABLE
    elif eta == ETA_END:
        # Rounding of η alone parts the cycles by the root of it.
        unstable = _closed(math.sqrt(a / b), math.sqrt(8.0 * ROUNDING))
        status = CellStatus.SEMISTABLE
    return Cell(
        model="averaged",
        parameters={"a": a, "b": b, "eps": eps},
        status=status,
        steady_sliding=None,
        effective_damping=eps,
        stable_cycle=stable,
        unstable_cycle=unstable,
        seconds=perf_counter() - begin,
    )


def _closed(amplitude: float, spread: float) -> CellCycle:
    period = 2.0 * math.pi
    return CellCycle(
        max=amplitude,
        min=-amplitude,
        period=period,
        slip_time=period,
        averaged=amplitude,
        error=spread * amplitude,
    )


def _check_stiffness(eta: float, eps: float) -> None:
    """Refuse what DOP853 takes too long for: ε max|1 - a y² + b y⁴| over the stable cycle.

    The largest is (1 + 7s)/(1 - s), s = √(1 - 8η), here without cancellation.
    """
    root = math.sqrt(1.0 - 8.0 * eta)
    stiffness = eps * (1.0 + 7.0 * root) * (1.0 + root) / (8.0 * eta)
    if stiffness > _STIFFEST:
        raise ParameterError(
            "eps max|1 - a y^2 + b y^4|", f"{stiffness:.4g}", f"at most {_STIFFEST:g} for a true "
            "cycle", "take a smaller eps, or a larger eta",
        )  # fmt: skip


def _cycle(
    eta: float, eps: float, averaged: float, *, between: float, a: float, tolerance: float
) -> CellCycle:
    """Return one cycle in y, from that in y√a at two tolerances."""
    (y, period), (coarse, other) = (
        _shoot(eta, eps, averaged, between, each) for each in (tolerance, 100.0 * tolerance)
    )
    scale = math.sqrt(a)
    return CellCycle(
        max=y / scale,
        min=-y / scale,
        period=period,
        slip_time=period,
        averaged=averaged / scale,
        error=max(abs(y - coarse) / scale, abs(period - other), ROUNDING * period),
    )


def _shoot(
    eta: float, eps: float, guess: float, between: float, tolerance: float
) -> tuple[float, float]:
    """Return amplitude and period of the cycle near ``guess``, on its side of ``between``."""

    def following(y: float) -> tuple[float, float]:
        def rate(_: float, z: FloatArray) -> list[float]:
            damping = 1.0 - z[0] ** 2 + eta * z[0] ** 4
            return [z[1], -z[0] - eps * z[1] * damping]

        run = solve_ivp(
            rate, (0.0, _LONGEST), [y, 0.0], "DOP853", events=Maximum(), rtol=tolerance,
            atol=1e-2 * tolerance, max_step=_STEP * longest_step(tolerance),
        )  # fmt: skip
        if run.status != 1:
            return 0.0, math.inf  # it creeps to rest without turning
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
