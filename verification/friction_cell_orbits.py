"""Both cycles of the friction cell, by shooting, and how they end (Fig. 2 and its continuation).

The stick-slip cycle passes the point of release, so that one slip phase from there gives all of
it: nothing has to be iterated. The unstable cycle slips all the time; its largest y is a fixed
point of the map from one maximum to the next. Both end at one belt velocity, where the slip phase
from the point of release only touches ẏ = v_d, on returning to that very point: a grazing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import lru_cache
from time import perf_counter

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from theory.friction_cell import FrictionCell, stick_phase
from theory.parameters import within
from verification.integrators import friction_cell_phase as phases
from verification.integrators.friction_series import binomials
from verification.integrators.taylor import taylor_order

FloatArray = npt.NDArray[np.float64]

_LONGEST = 1e4
_LARGEST_SPEED = 1e3
_ROUND_OFF = 1e-14
COMPANION = 100.0


class CellStatus(StrEnum):
    """Which states of a cell are stable."""

    BISTABLE = "bistable"
    """Steady sliding and the stick-slip cycle."""

    CYCLE = "stick-slip only"
    """The stick-slip cycle."""

    SLIDING = "steady sliding only"
    """Steady sliding."""


@dataclass(frozen=True)
class Cycle:
    """A cycle of the cell.

    Attributes
    ----------
    max, min : float
        Largest and smallest y.
    period : float
        In units of τ.
    stick_time, slip_time : float
        Durations of the two phases; 0 and the period for the unstable cycle.
    speed : float
        Largest ẏ; v_d where the cycle sticks.
    multiplier : float
        Factor by which a deviation grows in one period; 0 where the cycle sticks.
    error : float
        Largest difference of any of these from a computation at a hundred times the tolerance.
    """

    max: float
    min: float
    period: float
    stick_time: float
    slip_time: float
    speed: float
    multiplier: float
    error: float

    @property
    def amplitude(self) -> float:
        """Half of max - min."""
        return 0.5 * (self.max - self.min)


@dataclass(frozen=True)
class CellOrbits:
    """What one cell can do.

    Attributes
    ----------
    cell : FrictionCell
        Parameters.
    status : CellStatus
        Which states are stable.
    stable, unstable : Cycle or None
        The stick-slip cycle and the unstable cycle, where they exist.
    cycle_end_velocity : float
        v_d at which both end by grazing; infinite if they never do, 0 if there is no cycle.
    cycle_end_error : float
        Its difference from a computation at a hundred times the tolerance.
    seconds : float
        Run time.
    """

    cell: FrictionCell
    status: CellStatus
    stable: Cycle | None
    unstable: Cycle | None
    cycle_end_velocity: float
    cycle_end_error: float
    seconds: float

    @property
    def basin(self) -> tuple[float, float] | None:
        """Range of y that ends in steady sliding when started with ẏ = 0.

        None if none does; infinite where all do.
        """
        if self.status is CellStatus.SLIDING:
            return -math.inf, math.inf
        if self.unstable is None:
            return None
        return self.unstable.min, self.unstable.max

    @property
    def error(self) -> float:
        """Largest of the errors."""
        known = [each.error for each in (self.stable, self.unstable) if each is not None]
        return max([self.cycle_end_error, *known])


def cell_orbits(cell: FrictionCell, tolerance: float = 1e-12) -> CellOrbits:
    """Return the cycles of a cell, and where they end.

    Parameters
    ----------
    cell : FrictionCell
        Parameters.
    tolerance : float
        Local error, from 1e-14 to 1e-4.

    Examples
    --------
    >>> orbits = cell_orbits(FrictionCell())
    >>> orbits.status.value, round(orbits.stable.period, 6), orbits.error < 1e-8
    ('bistable', 6.353749, True)
    """
    begin = perf_counter()
    within("tolerance", tolerance, 1e-14, 1e-4)
    end = cycle_end_velocity(cell, tolerance)
    coarse_end = cycle_end_velocity(cell, COMPANION * tolerance)
    stable = stick_slip_cycle(cell, tolerance) if cell.v_d < end else None
    sliding_stable = cell.effective_damping > 0.0
    unstable = unstable_cycle(cell, tolerance) if stable and sliding_stable else None
    if stable is None:
        status = CellStatus.SLIDING
    else:
        status = CellStatus.BISTABLE if sliding_stable else CellStatus.CYCLE
    end_error = 0.0 if end == coarse_end else abs(end - coarse_end)
    return CellOrbits(cell, status, stable, unstable, end, end_error, perf_counter() - begin)


def cycle_turning_points(cell: FrictionCell, tolerance: float = 1e-12) -> tuple[float, float]:
    """Return the smallest and the largest y of the stick-slip cycle.

    Beyond the end of the cycle they are those of the slip phase that follows a release.

    Examples
    --------
    >>> low, high = cycle_turning_points(FrictionCell())
    >>> round(low, 6), round(high, 6)
    (-0.76708, 1.995817)
    """
    low, high = (
        _phase(cell, cell.release, 0.0, True, end, tolerance)[1]
        for end in (phases.LOWEST, phases.HIGHEST)
    )
    return low, high


def stick_slip_cycle(cell: FrictionCell, tolerance: float = 1e-12) -> Cycle | None:
    """Return the stick-slip cycle, None if the slip phase from release never sticks again."""
    fine = stick_slip_once(cell, tolerance)
    coarse = stick_slip_once(cell, COMPANION * tolerance)
    return _with_error(fine, coarse)


def unstable_cycle(cell: FrictionCell, tolerance: float = 1e-12) -> Cycle | None:
    """Return the cycle without stick that separates the two basins, None if there is none.

    It exists between the Hopf velocity and the end of the stick-slip cycle.
    """
    return _with_error(unstable_once(cell, tolerance), unstable_once(cell, COMPANION * tolerance))


def cycle_end_velocity(cell: FrictionCell, tolerance: float = 1e-12) -> float:
    """Return v_d at which the slip phase from release only touches ẏ = v_d.

    Infinite if it always sticks again (ξ = 0), 0 if it never does.

    Examples
    --------
    >>> end = cycle_end_velocity(FrictionCell())
    >>> stick_slip_cycle(FrictionCell(v_d=0.9999 * end)).stick_time < 0.03
    True
    """

    def excess(v_d: float) -> float:
        return _largest_after_release(replace(cell, v_d=v_d), tolerance)

    low = 1e-3 * min(1.0, cell.v0)
    if excess(low) <= 0.0:
        return 0.0
    high = low
    while excess(high) > 0.0:
        low, high = high, 1.25 * high
        if high > _LARGEST_SPEED:
            return math.inf
    return float(brentq(excess, low, high, xtol=1e-15, rtol=9e-16))


@lru_cache(maxsize=64)
def _binomials(order: int) -> FloatArray:
    return binomials(order)


def _phase(
    cell: FrictionCell, y: float, w: float, released: bool, end: int, tolerance: float
) -> tuple[float, float, float]:
    numbers = np.array([cell.mu_st, cell.mu_d, cell.v0, cell.xi, cell.v_d, 0.0])
    order = taylor_order(tolerance)
    t, y, w = phases.phase(
        numbers, y, w, released, end, tolerance, order, _binomials(order), _LONGEST
    )
    return float(t), float(y), float(w)


def _largest_after_release(cell: FrictionCell, tolerance: float) -> float:
    """Return the first maximum of ẏ - v_d after release; below 0 if there is none."""
    t, _, w = _phase(cell, cell.release, 0.0, True, phases.FASTEST, tolerance)
    return w if t >= 0.0 or w > 0.0 else -cell.v_d


def stick_slip_once(cell: FrictionCell, tolerance: float) -> Cycle | None:
    """Return the stick-slip cycle without its error (nan)."""
    t, y, _ = _phase(cell, cell.release, 0.0, True, phases.TOUCH, tolerance)
    stick = stick_phase(cell, y) if t >= 0.0 else None
    if stick is None:
        return None
    low, high = cycle_turning_points(cell, tolerance)
    return Cycle(high, low, t + stick.duration, stick.duration, t, cell.v_d, 0.0, math.nan)


def unstable_once(cell: FrictionCell, tolerance: float) -> Cycle | None:
    """Return the unstable cycle without its error (nan)."""
    centre = cell.steady_sliding

    def following(y: float, end: int) -> tuple[float, float, float]:
        return _phase(cell, y, -cell.v_d, False, end, tolerance)

    def growth(y: float) -> float:
        return float((following(y, phases.HIGHEST)[1] - y) / (y - centre))

    _, outside = cycle_turning_points(cell, tolerance)
    inside = centre + 1e-6 * (outside - centre)
    while inside < outside and growth(inside) >= 0.0:
        inside = centre + 4.0 * (inside - centre)
        if inside - centre > 1e-3 * (outside - centre):
            return None
    if growth(outside) <= 0.0:
        return None
    y = float(brentq(growth, inside, outside, xtol=1e-15, rtol=9e-16))
    period, _, _ = following(y, phases.HIGHEST)
    _, low, _ = following(y, phases.LOWEST)
    _, _, fastest = following(low, phases.FASTEST)
    step = 1e-5 * (y - centre)
    ahead, behind = (following(y + each, phases.HIGHEST)[1] for each in (step, -step))
    multiplier = (ahead - behind) / (2.0 * step)
    return Cycle(y, low, period, 0.0, period, fastest + cell.v_d, multiplier, math.nan)


def _with_error(fine: Cycle | None, coarse: Cycle | None) -> Cycle | None:
    if fine is None:
        return None
    if coarse is None:
        return replace(fine, error=math.inf)
    names = ("max", "min", "period", "stick_time", "slip_time", "speed")
    gaps = [abs(getattr(fine, name) - getattr(coarse, name)) for name in names]
    return replace(fine, error=max(*gaps, _ROUND_OFF * max(1.0, fine.period)))
