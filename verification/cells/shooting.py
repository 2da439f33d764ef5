"""Cycles of one oscillator by shooting.

    ÿ + g(y) + ε h(y, ẏ) ẏ = 0

To leading order in ε they are given in ``theory.cells.oscillator``. The exact cycles are fixed
points of the map from one maximum of y to the next, computed by scipy's DOP853.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from theory.arrays import FloatArray
from theory.cells.oscillator import Oscillator, OscillatorCycle
from theory.parameters import ParameterError, Range
from verification.cells.result import CellCycle

TOLERANCES = Range(1e-13, 1e-6)
"""Range of the relative tolerance of DOP853."""
ROUNDING = 1e-14
"""Relative rounding error of a period, accumulated over some hundred steps."""
_STIFFEST = 60.0
"""Largest ε max|h| on a cycle over its frequency; DOP853 takes half a minute there."""
_WIDTHS = (1e-4, 1e-3, 1e-2, 0.05, 0.1, 0.2, 0.4)
"""Relative distances from the limit ε → 0 within which the cycle is searched for."""
_SHIFT = 3e-5
"""Step, relative to the largest velocity, of the differences that give the slope of the damping."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_CLOSED = 1e-3
"""Relative difference between a fixed point and the end of its turn, above which it is a jump."""


def shot_cycles(cell: Oscillator, eps: float, tolerance: float) -> tuple[CellCycle, ...]:
    """Return all cycles of a cell with their errors, inner to outer.

    Parameters
    ----------
    cell : Oscillator
        With inertia.
    eps : float
        ε.
    tolerance : float
        Relative tolerance of DOP853.

    Raises
    ------
    ParameterError
        If ε is so large that the cycles are not found near their limits ε → 0, or are too stiff.

    Examples
    --------
    >>> from theory.cells.oscillator import OscillatorCell
    >>> cell = OscillatorCell(stiffness={1: 1.0}, damping={(0, 0): -1.0, (2, 0): 1.0})
    >>> [round(each.max, 4) for each in shot_cycles(cell, 1.0, 1e-9)]  # of Van der Pol (1926)
    [2.0086]
    """
    for limit in cell.cycles:
        _check_stiffness(cell, eps, limit)
    return tuple(_cycle(cell, eps, at, tolerance) for at in range(len(cell.cycles)))


def longest_step(tolerance: float) -> float:
    """Return the longest step, relative to that at a tolerance of 1e-12.

    The error of such a step is proportional to the tolerance, since DOP853 is of order eight. If
    the step were the same at every tolerance, a coarser run limited by it would take the same
    steps, and a comparison of the two would not show their error.
    """
    return float((tolerance / 1e-12) ** (1.0 / 8.0))


@dataclass(frozen=True)
class _Extremum:
    """An event for scipy: ẏ decreases (-1) or increases (1) through 0, except at the start."""

    direction: float
    terminal: bool

    def __call__(self, t: float, z: FloatArray) -> float:
        return float(z[1]) if t > 0.0 else self.direction


@dataclass(frozen=True, kw_only=True)
class _Turn:
    """A turn from one maximum of y to the next: the latter, the minimum between, the duration.

    ``run`` is scipy's solution; None if there is no such turn.
    """

    top: float
    bottom: float
    period: float
    run: Any = None


def _turn(cell: Oscillator, eps: float, y: float, period: float, tolerance: float) -> _Turn:
    """Return the turn that begins at rest at y.

    A motion that decays to rest without turning back ends at 0, an unbounded one at infinity;
    neither has a period.
    """

    def rate(_: float, z: FloatArray) -> list[float]:
        y, v = z.tolist()
        return [v, -cell.force(y, v, eps)]

    with np.errstate(over="ignore", invalid="ignore"):
        run = solve_ivp(
            rate, (0.0, 100.0 * period), [y, 0.0], "DOP853",
            events=(_Extremum(-1.0, True), _Extremum(1.0, False)),
            rtol=tolerance, atol=1e-2 * tolerance * y,
            max_step=period / 30.0 * longest_step(tolerance), dense_output=True,
        )  # fmt: skip
    lowest: list[FloatArray] = list(run.y_events[1]) if run.y_events is not None else []
    if run.status != 1 or not lowest:
        rests = run.status == 0 and abs(run.y[0, -1]) < y
        return _Turn(top=0.0 if rests else math.inf, bottom=math.nan, period=math.inf)
    bottom = float(lowest[0][0])
    return _Turn(top=float(run.y[0, -1]), bottom=bottom, period=float(run.t[-1]), run=run)


def _exponents(cell: Oscillator, eps: float, turn: _Turn) -> FloatArray:
    """Return -ε ∮ ∂(hẏ)/∂ẏ dt over a turn, for a step and twice the step of the difference in ẏ.

    By the formula of Liouville a deviation from a cycle grows by the exponential of this integral
    of the divergence of the flow.
    """
    if turn.run is None:
        return np.full(2, math.inf)
    times = turn.run.t
    half = 0.5 * np.diff(times)[:, None]
    y, v = turn.run.sol((times[:-1, None] + half * (1.0 + _NODES)).ravel())
    step = _SHIFT * float(np.abs(v).max())
    h = cell.damping_at(y, v)
    slopes = (
        (cell.damping_at(y, v + each) - cell.damping_at(y, v - each)) / (2.0 * each)
        for each in (step, 2.0 * step)
    )
    weights = (half * _WEIGHTS).ravel()
    return -eps * np.array([weights @ (h + v * slope) for slope in slopes])


def _cycle(cell: Oscillator, eps: float, at: int, tolerance: float) -> CellCycle:
    """Return one cycle and its error, starting from its limit as ε → 0."""
    limit = cell.cycles[at]
    coarse = _fixed(cell, eps, at, 100.0 * tolerance)
    fine = _fixed(cell, eps, at, tolerance, coarse)
    turn, other = (
        _turn(cell, eps, y, limit.period, each)
        for y, each in ((fine, tolerance), (coarse, 100.0 * tolerance))
    )
    pairs = ((fine, coarse), (turn.bottom, other.bottom), (turn.period, other.period))
    error = max(*(abs(one - two) for one, two in pairs), ROUNDING * turn.period)
    # Relative, since a cycle may be far smaller than the error of its period.
    aside = fine * min(max(*(abs(1.0 - two / one) for one, two in pairs), ROUNDING), 0.5)
    multiplier, multiplier_error = _multiplier(
        _exponents(cell, eps, turn),
        _exponents(cell, eps, other),
        *(
            _exponents(cell, eps, _turn(cell, eps, fine + each, limit.period, tolerance))
            for each in (aside, -aside)
        ),
    )
    return CellCycle(
        max=fine,
        min=turn.bottom,
        period=turn.period,
        slip_time=turn.period,
        multiplier=multiplier,
        multiplier_error=multiplier_error,
        averaged=limit.amplitude,
        error=error,
    )


def _multiplier(
    exponents: FloatArray, *others: FloatArray
) -> tuple[float, float] | tuple[None, None]:
    """Return the multiplier of a cycle and its error; None if it leaves double precision.

    The error is the largest difference from the multiplier of any of the other turns and by
    differences of twice the step, but at least rounding.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        found = float(np.exp(exponents[0]))
        gaps = np.abs(np.exp(np.concatenate([exponents[1:], *others])) - found)
    if found == math.inf:
        return None, None
    return found, float(gaps.max()) + ROUNDING * (1.0 + abs(float(exponents[0]))) * found


def _check_stiffness(cell: Oscillator, eps: float, limit: OscillatorCycle) -> None:
    angle = np.linspace(0.0, 2.0 * math.pi, 201)
    with np.errstate(over="ignore", invalid="ignore"):  # an overflow is refused as well
        h = cell.damping_at(limit.amplitude * np.sin(angle), limit.velocity * np.cos(angle))
    stiffness = eps * float(np.max(np.abs(h))) * limit.period / (2.0 * math.pi)
    if not stiffness <= _STIFFEST:
        raise ParameterError(
            "eps max|damping| over the frequency of a cycle", f"{stiffness:.4g}",
            f"at most {_STIFFEST:g} for a true cycle", "take a smaller eps",
        )  # fmt: skip


def _fixed(
    cell: Oscillator, eps: float, at: int, tolerance: float, near: float | None = None
) -> float:
    """Return the largest y of a cycle: a fixed point between the neighbouring cycles.

    It is searched around ``near``, by default around the limit ε → 0.
    """
    amplitudes = [each.amplitude for each in cell.cycles]
    guess, period = near or amplitudes[at], cell.cycles[at].period
    low = math.sqrt(amplitudes[at - 1] * amplitudes[at]) if at else 0.0
    high = math.sqrt(amplitudes[at + 1] * amplitudes[at]) if at + 1 < len(amplitudes) else math.inf

    @cache  # at the ends of an interval and at its root brentq asks again
    def growth(y: float) -> float:
        top = _turn(cell, eps, y, period, tolerance).top
        return top / y - 1.0 if math.isfinite(top) else 1.0

    for width in _WIDTHS:
        ends = max(low, guess * (1.0 - width)), min(high, guess * (1.0 + width))
        if growth(ends[0]) * growth(ends[1]) < 0.0:
            found = float(brentq(growth, *ends, xtol=1e-14 * guess, rtol=1e-14))
            if abs(growth(found)) < _CLOSED:
                return found
            break
    raise ParameterError(
        "small parameter eps", eps, "so small that averaging locates the cycles approximately",
        "take a smaller eps, or parameters farther from those at which cycles meet",
    )  # fmt: skip
