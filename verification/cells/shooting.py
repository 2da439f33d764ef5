"""Cycles of one oscillator by shooting.

    ÿ + g(y) + ε h(y, ẏ) ẏ = 0

To leading order in ε they are given in ``theory.cells.oscillator``. The exact cycles are fixed
points of the map from one maximum of y to the next, computed by scipy's DOP853 and searched for by
Newton's method. For an unstable cycle time runs backwards, so that deviations decay.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal, NamedTuple

import numpy as np
from scipy.integrate import ode
from scipy.optimize import brentq

from theory.arrays import FloatArray
from theory.cells.oscillator import Oscillator, OscillatorCycle
from theory.parameters import ParameterError, Range
from verification.cells.result import CellCycle

TOLERANCES = Range(1e-13, 1e-6)
"""Range of the relative tolerance of DOP853."""
ROUNDING = 1e-14
"""Relative rounding error of a period, accumulated over some hundred steps."""
_STIFFEST = 300.0
"""Largest ε max|h| on a cycle over its frequency; DOP853 takes some seconds there."""
_SHIFT = 3e-5
"""Step, relative to the velocity, of the differences that give the slope of a compiled damping."""
_MAX_TURNS, _MAX_STEPS = 50, 100_000
_STIFF, _SINGULAR = -4, -3
"""Codes with which scipy's DOP853 returns: from the 1000th step on, where stability limits steps;
and where steps become too small because motion becomes infinite in a finite time."""
_UNBOUNDED = 1e4
"""Size of y, relative to that at the beginning, above which motion is taken to be unbounded."""
_TRIED = np.geomspace(1e-4, 1e4, 200)
"""Amplitudes at which turns are compared with the cycles found, in units of `Oscillator.sizes`;
their ratio is 1.1."""
_TRIED_TOLERANCE, _GROWTH = 1e-8, 1e-5
"""Tolerance of these turns, and relative growth below which their direction is not decided."""
_MODERATE = 10.0
"""Largest ε max|h| over the frequency at which they are tried."""


def shot_cycles(cell: Oscillator, eps: float, tolerance: float) -> tuple[CellCycle, ...]:
    """Return all cycles of a cell with their errors, inner to outer.

    Parameters
    ----------
    cell : Oscillator
        With inertia.
    eps : float
        ε.
    tolerance : float
        Relative tolerance of DOP853; smaller in proportion where ε max|h| is below the frequency.

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
    # The weaker the damping, the more the errors of a turn shift the cycle.
    strengths = [_stiffness(cell, eps, limit) for limit in cell.cycles]
    return tuple(
        _cycle(cell, eps, at, max(TOLERANCES.low, tolerance * min(1.0, strength)))
        for at, strength in enumerate(strengths)
    )


def check_turns(cell: Oscillator, eps: float, cycles: tuple[CellCycle, ...], rests: bool) -> None:
    """Refuse ε at which a turn grows or decays against the stability of the cycles beside it.

    At a finite ε there may be pairs of cycles that do not exist in the limit ε → 0, from which all
    cycles are found. A pair between two neighbouring amplitudes of those tried is not noticed.

    Parameters
    ----------
    cell : Oscillator
        With inertia, and at rest at y = 0 only; a cell with other rest states is not checked.
    eps : float
        ε.
    cycles : tuple of CellCycle
        The cycles found, inner to outer.
    rests : bool
        Whether rest is stable.

    Raises
    ------
    ParameterError
        If there is such a turn.
    """
    if cell.rest_states():
        return
    for y in np.union1d(*(_TRIED * size for size in cell.sizes)).tolist():
        limit = OscillatorCycle(y, cell.velocity(y), cell.period(y), stable=True)
        strength, both_signs = _strength(cell, eps, limit)
        if not (both_signs and strength <= _MODERATE):
            continue  # damping of one sign leaves no doubt
        turn = _turn(cell, eps, y, limit, _TRIED_TOLERANCE)
        growth = turn.top / y - 1.0 if turn else 0.0
        grows = rests == bool(sum(each.max < y for each in cycles) % 2)
        if abs(growth) > _GROWTH and (growth > 0.0) is not grows:
            raise ParameterError(
                "small parameter eps", eps,
                f"so small that there are only the cycles of the limit eps -> 0, but a turn that "
                f"begins at y = {y:.3g} {'grows' if growth > 0.0 else 'decays'}",
                "take a smaller eps, or simulate a chain with c = 0",
            )  # fmt: skip


def longest_step(tolerance: float) -> float:
    """Return the longest step, relative to that at a tolerance of 1e-12.

    The error of such a step is proportional to the tolerance, since DOP853 is of order eight. If
    the step were the same at every tolerance, a coarser run limited by it would take the same
    steps, and a comparison of the two would not show their error.
    """
    return float((tolerance / 1e-12) ** (1.0 / 8.0))


@dataclass(frozen=True, kw_only=True)
class _Turn:
    """A turn from one maximum of y to the next or, backwards in time, to the one before.

    Attributes
    ----------
    top, bottom : float
        The maximum at its end, and the minimum between.
    period : float
        Duration.
    exponent : float
        Integral of the divergence of the flow, in the direction of time. By the formula of
        Liouville a deviation from a cycle grows by its exponential.
    slope : float
        Derivative of the maximum at the end by that at the beginning.
    """

    top: float
    bottom: float
    period: float
    exponent: float
    slope: float


class _Swing(NamedTuple):
    """Half a turn: from rest at one y to rest at another. All are infinite if it is unbounded."""

    y: float
    time: float
    exponent: float


def _turn(
    cell: Oscillator, eps: float, y: float, limit: OscillatorCycle, tolerance: float
) -> _Turn | None:
    """Return the turn that begins at rest at y; None if motion does not turn back twice.

    Where motion is unbounded the top is infinite.
    """
    down = _swing(cell, eps, y, limit, tolerance)
    up = _swing(cell, eps, down.y, limit, tolerance) if down and down.y < math.inf else down
    if down is None or up is None:
        return None
    exponent, slope = down.exponent + up.exponent, math.inf
    if up.y < math.inf:
        # The flow crosses the line ẏ = 0 with the acceleration -g.
        first, last = (cell.force(each, 0.0, eps, _SHIFT)[0] for each in (y, up.y))
        with np.errstate(over="ignore"):
            slope = first / last * float(np.exp(exponent))
    return _Turn(
        top=up.y, bottom=down.y, period=down.time + up.time, exponent=exponent, slope=slope
    )


def _swing(
    cell: Oscillator, eps: float, y: float, limit: OscillatorCycle, tolerance: float
) -> _Swing | None:
    """Return the swing that begins at rest at y; None if motion only approaches rest."""
    size = abs(y)
    solver = partial(_solver, cell, eps, limit, tolerance, size)
    run = solver()
    path = _path(run, y, limit, pull=cell.force(y, 0.0, eps, _SHIFT)[0])
    if len(path) < 2:  # the force is not finite at the start
        return None
    (begin, before), (end, after) = path[-2:]
    if before[1] * after[1] < 0.0:
        time, (y, _, exponent) = _rest(solver, before, end - begin, after, limit)
        return _Swing(y, begin + time, exponent / size)
    unbounded = run.get_return_code() == _SINGULAR or abs(after[0]) >= _UNBOUNDED * size
    return _Swing(math.inf, math.inf, math.inf) if unbounded else None


def _solver(
    cell: Oscillator, eps: float, limit: OscillatorCycle, tolerance: float, size: float
) -> ode:
    """Return a solver for y, ẏ and the exponent times the size of y; backwards if unstable."""
    sense, coarseness = 1.0 if limit.stable else -1.0, longest_step(tolerance)
    # A coarser run takes larger differences, so that comparison shows their error as well.
    shift = _SHIFT * coarseness

    def rate(_: float, z: FloatArray) -> list[float]:
        y, v, _ = z.tolist()
        force, drag = cell.force(y, sense * v, eps, shift)
        return [v, -force, -sense * drag * size]

    return ode(rate).set_integrator(
        "dop853", rtol=tolerance, atol=1e-2 * tolerance * size,
        max_step=limit.period / 30.0 * coarseness, nsteps=_MAX_STEPS,
    )  # fmt: skip


def _path(
    run: ode, y: float, limit: OscillatorCycle, pull: float
) -> list[tuple[float, FloatArray]]:
    """Return times and states of motion from rest at y until its velocity has the sign of pull."""
    path: list[tuple[float, FloatArray]] = []

    def watch(t: float, z: FloatArray) -> Literal[-1, 0]:
        path.append((t, z.copy()))
        bounded = abs(z[0]) < _UNBOUNDED * abs(y) and len(path) < _MAX_STEPS
        return 0 if bounded and z[1] * pull <= 0.0 else -1

    run.set_solout(watch)
    with warnings.catch_warnings(action="ignore"):  # of stiffness, and of steps that are too many
        run.set_initial_value([y, 0.0, 0.0]).integrate(100.0 * limit.period)
        while run.get_return_code() == _STIFF:
            run.integrate(100.0 * limit.period)
    return path


def _rest(
    solver: Callable[[], ode],
    before: FloatArray,
    step: float,
    after: FloatArray,
    limit: OscillatorCycle,
) -> tuple[float, list[float]]:
    """Return the time of rest within the last step, from its beginning, and the state there."""
    states = {0.0: before, step: after}

    def state(t: float) -> FloatArray:
        if t not in states:
            states[t] = solver().set_initial_value(before).integrate(t)
        return states[t]

    def velocity(t: float) -> float:
        return float(state(t)[1])

    time = float(brentq(velocity, 0.0, step, xtol=1e-15 * limit.period, rtol=1e-15))
    return time, state(time).tolist()


def _cycle(cell: Oscillator, eps: float, at: int, tolerance: float) -> CellCycle:
    """Return one cycle and its error, starting from its limit as ε → 0.

    The error is the largest difference from cycles at ten and at a hundred times the tolerance:
    where stability limits the steps, errors do not grow in proportion, and one of the two may by
    chance be as wrong as the cycle itself.
    """
    limit = cell.cycles[at]
    turns, y, left = [], limit.amplitude, 0.0
    for coarser in (100.0, 10.0, 1.0):
        turn, left = _closed_turn(cell, eps, at, coarser * tolerance, y)
        turns.append(turn)
        y = turn.top
    *others, turn = turns
    gaps = (
        abs(getattr(turn, name) - getattr(other, name))
        for other in others
        for name in ("top", "bottom", "period")
    )
    exponents = [each.exponent if limit.stable else -each.exponent for each in reversed(turns)]
    multiplier, multiplier_error = _multiplier(*exponents)
    return CellCycle(
        max=turn.top,
        min=turn.bottom,
        period=turn.period,
        slip_time=turn.period,
        multiplier=multiplier,
        multiplier_error=multiplier_error,
        averaged=limit.amplitude,
        error=max(*gaps, left, ROUNDING * turn.period),
    )


def _multiplier(exponent: float, *others: float) -> tuple[float, float] | tuple[None, None]:
    """Return the multiplier of a cycle and its error; None if it leaves double precision.

    The error is the largest difference from the multiplier of any other turn, and at least
    rounding.
    """
    with np.errstate(over="ignore", invalid="ignore"):
        found = float(np.exp(exponent))
        gaps = np.abs(np.exp(others) - found)
    if found == math.inf:
        return None, None
    rounding = ROUNDING * (1.0 + abs(exponent)) * found
    return found, float(gaps.max(initial=np.finfo(float).tiny)) + rounding


def _strength(cell: Oscillator, eps: float, limit: OscillatorCycle) -> tuple[float, bool]:
    """Return ε max|h| on a cycle over its frequency, and whether h has both signs there."""
    angle = np.linspace(0.0, 2.0 * math.pi, 201)
    with np.errstate(over="ignore", invalid="ignore"):  # what overflows is not moderate
        h = cell.damping_at(limit.amplitude * np.sin(angle), limit.velocity * np.cos(angle))
    strength = eps * float(np.max(np.abs(h))) * limit.period / (2.0 * math.pi)
    return strength, bool(h.min() < 0.0 < h.max())


def _stiffness(cell: Oscillator, eps: float, limit: OscillatorCycle) -> float:
    """Return ε max|h| on a cycle over its frequency; refuse a cycle for which it is too large."""
    stiffness, _ = _strength(cell, eps, limit)
    if not stiffness <= _STIFFEST:
        raise ParameterError(
            "eps max|damping| over the frequency of a cycle", f"{stiffness:.4g}",
            f"at most {_STIFFEST:g} for a true cycle", "take a smaller eps",
        )  # fmt: skip
    return stiffness


def _closed_turn(
    cell: Oscillator, eps: float, at: int, tolerance: float, y: float
) -> tuple[_Turn, float]:
    """Return the turn along a cycle and the last correction of its maximum, searched from y on.

    The maximum lies between those of the neighbouring cycles, at least as ε → 0. Where Newton's
    method does not apply, motion itself leads to the cycle. The search ends with corrections that
    no longer halve, as round-off of the turns makes them.
    """
    limit, neighbours = cell.cycles[at], [0.0, *(each.amplitude for each in cell.cycles), math.inf]
    low, high = (math.sqrt(limit.amplitude * each) for each in neighbours[at : at + 3 : 2])
    before = math.inf
    for _ in range(_MAX_TURNS):
        turn = _turn(cell, eps, y, limit, tolerance)
        if turn is None:
            break
        gap = turn.top - y
        move = gap / (1.0 - turn.slope) if turn.slope < 1.0 else gap
        closed, correction = abs(gap) <= tolerance * y, abs(move)
        if closed and not ROUNDING * y < correction < 0.5 * before:
            return turn, correction
        before = correction
        y = y + move if low < y + move < high else turn.top
        if not low < y < high:
            break
    raise ParameterError(
        "small parameter eps", eps, "so small that averaging locates the cycles approximately",
        "take a smaller eps, or parameters farther from those at which cycles meet",
    )  # fmt: skip
