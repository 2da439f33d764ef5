"""Both cycles of the friction cell, by shooting, and how they end (Fig. 2 and its continuation).

A single cycle is found in ``friction_cycles``; this module computes its error and where it ends.
Both cycles end at one belt velocity, in a grazing: the slip phase that starts from the point of
release just touches ẏ = v_d when it returns to that same point.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from itertools import count
from time import perf_counter

import numpy as np
from scipy.optimize import brentq

from theory.cells.friction import LARGEST, FrictionCell
from theory.cells.friction_law import FrictionLaw
from theory.parameters import ParameterError, Range, with_ranges, within
from verification.cells.friction_cycles import (
    ROUND_OFF,
    check_slip_cycles,
    grazing_slip,
    largest_after_release,
    slips_in_a_stable_cycle,
    stick_slip_once,
    unstable_once,
)
from verification.cells.result import TOLERANCE, BeltCell, CellCycle, CellStatus
from verification.execution.progress import ProgressCallback, of_part
from verification.runs.comparison import COARSER

TOLERANCES = Range(1e-14, 1e-4)
_SLOWEST_BELT = 1e-9
"""Slowest belt: below it a cycle can no longer be distinguished from the round-off of y."""
_FASTEST_STRIBECK, _TRIED = 10.0, 60
"""Ratio v_d/v_s up to which a first cycle is searched for, and number of velocities tried."""
_BESIDE = 1e-3
"""Relative distance from the end of the cycles at which the slope of the grazing is taken."""
_FAR = 3.0
"""Number of its errors above the end of the cycles at which both runs must have found the end."""
_SLOW, _CERTAIN = 1e-5, 1e-3
"""Values of v_d/v_s: below the first, round-off decides the energy gained in slip; from the second
on it does not."""
_DISTANCES = (1e-9, 1e-6, 1e-3)
"""Relative distances from a limit of v_d within which that at another tolerance is searched for.
The first is far above round-off, which may change the sign of the excess several times."""
_SLIPS = 150
"""Largest usual number of slip phases in a search for the limits of v_d, which is that of
relaxation cycles under Stribeck's law; for the fraction reported."""


@dataclass(frozen=True, kw_only=True)
class CycleLimits:
    """Belt velocities between which there is a stick-slip cycle; see :func:`cycle_velocities`.

    Attributes
    ----------
    first, end : float
        The limits.
    error : float
        The larger of their differences from a computation at a hundred times the tolerance, but at
        least the effect of round-off on ``end``; infinite if no bound is known.
    """

    first: float
    end: float
    error: float


@with_ranges(tolerance=TOLERANCES)
def friction_cell(
    cell: FrictionCell,
    tolerance: float = TOLERANCE,
    *,
    limits: CycleLimits | None = None,
    progress: ProgressCallback | None = None,
) -> BeltCell:
    """Return the cycles of a cell, and the velocities at which they end.

    Parameters
    ----------
    cell : FrictionCell
        Parameters.
    tolerance : float
        Local error, {tolerance}.
    limits : CycleLimits, optional
        Those of :func:`cycle_limits`, which do not depend on v_d, if they are known.
    progress : callable, optional
        Called at intervals with the fraction done: at strong damping the limits take minutes.

    Examples
    --------
    >>> found = friction_cell(FrictionCell())
    >>> found.status.value, round(found.stable_cycle.period, 6), found.error < 1e-8
    ('bistable', 6.353749, True)

    Raises
    ------
    ParameterError
        If the tolerance or v_d is out of range, the cell slips both ways and never sticks, it
        has another cycle without stick, or Coulomb's law is used without damping.
    """
    begin = perf_counter()
    coulomb = cell.law is FrictionLaw.COULOMB
    if coulomb and cell.effective_damping == 0.0:
        raise ParameterError(
            "damping ratio xi", 0, "positive under Coulomb's law: without damping every slip near "
            "steady sliding is a cycle, and none is stable", "add damping or a viscous part",
        )  # fmt: skip
    within("tolerance", tolerance, *TOLERANCES)
    within("belt velocity v_d", cell.v_d, _SLOWEST_BELT, LARGEST)
    if limits is None:
        limits = cycle_limits(cell, tolerance, progress)
    in_range = limits.first <= cell.v_d < limits.end
    stable = stick_slip_cycle(cell, tolerance) if in_range else None
    sliding_stable = cell.effective_damping > 0.0
    if cell.law is FrictionLaw.STRIBECK:
        check_slip_cycles(cell, tolerance)
    if stable is None and not sliding_stable:
        raise slips_in_a_stable_cycle(cell)
    separated = stable is not None and sliding_stable
    unstable = unstable_cycle(cell, tolerance) if separated and not coulomb else None
    if stable is None:
        status = CellStatus.SLIDING
    else:
        status = CellStatus.BISTABLE if sliding_stable else CellStatus.CYCLE
    return BeltCell(
        model="friction",
        cell=cell,
        parameters=asdict(cell),
        status=status,
        steady_sliding=cell.steady_sliding,
        effective_damping=cell.effective_damping,
        stable_cycle=stable,
        unstable_cycle=unstable,
        hopf_velocity=0.0 if coulomb else cell.hopf_velocity,
        cycle_begin_velocity=limits.first,
        cycle_end_velocity=limits.end,
        cycle_end_error=limits.error,
        grazing=grazing_slip(cell) if coulomb and separated else None,
        seconds=perf_counter() - begin,
    )


def cycle_limits(
    cell: FrictionCell, tolerance: float, progress: ProgressCallback | None
) -> CycleLimits:
    """Return the limits of :func:`cycle_velocities` with their error; they do not depend on v_d."""
    limits = cycle_velocities(cell, tolerance, of_part(progress, 0, 2))
    coarse = _limits_beside(cell, limits, COARSER * tolerance, of_part(progress, 1, 2))
    gaps = (0.0 if a == b else abs(a - b) for a, b in zip(limits, coarse, strict=True))
    first, end = limits
    error = max(*gaps, _rounding_of_end(cell, end, tolerance))
    if not _ends_below(cell, end + _FAR * error, tolerance):
        error = math.inf
    return CycleLimits(first=first, end=end, error=error)


def stick_slip_cycle(cell: FrictionCell, tolerance: float = TOLERANCE) -> CellCycle | None:
    """Return the stick-slip cycle; None if the slip phase from release never sticks again."""
    fine = stick_slip_once(cell, tolerance)
    coarse = stick_slip_once(cell, COARSER * tolerance)
    return _with_error(cell, fine, coarse)


def unstable_cycle(cell: FrictionCell, tolerance: float = TOLERANCE) -> CellCycle | None:
    """Return the cycle without stick that separates the two basins; None if there is none.

    It exists between the Hopf velocity and the end of the stick-slip cycle.
    """
    fine, coarse = (unstable_once(cell, each) for each in (tolerance, COARSER * tolerance))
    return _with_error(cell, fine, coarse)


def cycle_end_velocity(cell: FrictionCell, tolerance: float = TOLERANCE) -> float:
    """Return the v_d at which the stick-slip cycle ends; see :func:`cycle_velocities`."""
    return cycle_velocities(cell, tolerance)[1]


def cycle_velocities(
    cell: FrictionCell, tolerance: float, progress: ProgressCallback | None = None
) -> tuple[float, float]:
    """Return the limits of v_d between which there is a stick-slip cycle; both 0 if there is none.

    At the limits the slip phase from release just touches ẏ = v_d. The upper limit is infinite for
    ξ = 0, where a slow departure from v_rel = 0 gains energy and nothing dissipates it, and is
    stated as infinite if it exceeds the largest v_d that is allowed for a cell. The lower limit is
    0 except under Stribeck's law, which does not decrease at small velocities, so that no energy
    is gained there. With little damping it is v_H(1 + ¾(v_H/v_s)²), where v_H is the velocity at
    which sliding becomes unstable.

    Examples
    --------
    >>> first, end = cycle_velocities(FrictionCell(), 1e-12)
    >>> first, stick_slip_cycle(FrictionCell(v_d=0.9999 * end)).stick_time < 0.03
    (0.0, True)
    """
    excess = _excess(cell, tolerance, progress)
    first, low = 0.0, 1e-3 * min(1.0, cell.curve.scale)
    if cell.law is FrictionLaw.STRIBECK:
        sliding = cell.unstable_sliding
        begin = min(low, 0.5 * sliding.low or low)
        if sliding.low < _SLOW * cell.v_s < sliding.high:
            first, begin = sliding.low, _CERTAIN * cell.v_s
        tried = np.geomspace(begin, _FASTEST_STRIBECK * cell.v_s, _TRIED)
        at = next((at for at, v_d in enumerate(tried) if excess(float(v_d)) > 0.0), None)
        if at is None:
            return 0.0, 0.0
        low = float(tried[at])
        if at > 0:
            first = _zero(excess, float(tried[at - 1]), low)
    else:
        # While sliding is unstable, slip grows until it sticks, so the cycle ends above. A search
        # that starts there takes a quarter of the slip phases of one that starts below.
        hopf = 0.0 if cell.law is FrictionLaw.COULOMB else cell.hopf_velocity
        if _SLOWEST_BELT <= hopf <= LARGEST and excess(hopf) > 0.0:
            low = hopf
        while excess(low) <= 0.0:
            if low < _SLOWEST_BELT:
                return 0.0, 0.0
            low *= 1e-2
    if cell.xi == cell.viscous == 0.0:
        return first, math.inf
    high = low
    while excess(high) > 0.0:
        if high == LARGEST:
            return first, math.inf
        low, high = high, min(1.25 * high, LARGEST)
    return first, _zero(excess, low, high)


def _excess(
    cell: FrictionCell, tolerance: float, progress: ProgressCallback | None
) -> Callable[[float], float]:
    """Return by how much slip after release exceeds v_d, as a function of v_d that is counted."""
    slips = count(1)

    def excess(v_d: float) -> float:
        found = largest_after_release(replace(cell, v_d=v_d), tolerance)
        done = next(slips)
        if progress is not None:
            progress(done / max(_SLIPS, done + 1))
        return found

    return excess


def _zero(excess: Callable[[float], float], low: float, high: float) -> float:
    """Return a velocity at which the excess changes sign, to a relative accuracy of 2e-15."""
    return float(brentq(excess, low, high, xtol=1e-15 * low, rtol=9e-16))


def _limits_beside(
    cell: FrictionCell,
    limits: tuple[float, float],
    tolerance: float,
    progress: ProgressCallback | None,
) -> tuple[float, float]:
    """Return the limits of v_d, searched for closely beside those at another tolerance."""
    excess, found = _excess(cell, tolerance, progress), []
    for limit in limits if 0.0 < limits[1] < math.inf else ():
        if limit == cell.unstable_sliding.low:  # not found by a search
            found.append(limit)
            continue
        for distance in _DISTANCES:
            low, high = limit * (1.0 - distance), limit * (1.0 + distance)
            if (excess(low) > 0.0) is not (excess(high) > 0.0):
                found.append(_zero(excess, low, high))
                break
    if len(found) == 2:
        return found[0], found[1]
    return cycle_velocities(cell, tolerance, progress)


def _rounding_of_end(cell: FrictionCell, end: float, tolerance: float) -> float:
    """Return how far round-off of the slip phase moves the velocity at which the cycles end.

    It is at least the accuracy of the search, and what round-off of y amounts to in μ(v_d).
    Relaxation oscillations (large ξ, small v₀) end abruptly, where μ' is about -(2ξ + κ), so that
    the slip phases on either side do not show it.

    It is infinite if round-off hides how the grazing depends on the velocity (ξ of some 1e-13).
    Under Coulomb's law slip is linear, and runs at both tolerances take the same steps; where
    friction falls slowly, the same happens at small tolerances. The difference of the two ends is
    then zero or decided by chance. The two slip phases take a hundredth of the time of the ends.
    """
    if not 0.0 < end < math.inf:
        return 0.0
    below, above = (
        largest_after_release(replace(cell, v_d=end * (1.0 + part)), tolerance)
        for part in (-_BESIDE, _BESIDE)
    )
    rounding = ROUND_OFF * (end + abs(replace(cell, v_d=end).release))
    if below - above < 2.0 * rounding:
        return math.inf
    drag = max(1.0, 2.0 * cell.xi + cell.viscous)
    slope = (below - above) / (2.0 * _BESIDE * end)
    return max(ROUND_OFF * end, rounding / drag, rounding / slope)


def _ends_below(cell: FrictionCell, v_d: float, tolerance: float) -> bool:
    """Return whether the stick-slip cycle, if there is one at any velocity, has ended at this v_d.

    It has if slip after release falls short of v_d by more than its error, for which the difference
    from a run at a hundred times the tolerance stands. With ξ so small that this error decides
    where slip falls short, it does so at any velocity, and the ends at both tolerances do not show
    that there may be none.
    """
    if v_d == 0.0 or cell.xi == cell.viscous == 0.0:
        return True
    if not v_d <= LARGEST:
        return False
    there = replace(cell, v_d=v_d)
    fine, coarse = (largest_after_release(there, each) for each in (tolerance, COARSER * tolerance))
    return fine + abs(fine - coarse) <= 0.0


def _with_error(
    cell: FrictionCell, fine: CellCycle | None, coarse: CellCycle | None
) -> CellCycle | None:
    if fine is None:
        return None
    if coarse is None:
        unknown = None if fine.multiplier is None else math.inf
        return replace(fine, error=math.inf, multiplier_error=unknown)
    names = ("max", "min", "period", "stick_time", "slip_time", "speed")
    gaps = [abs(getattr(fine, name) - getattr(coarse, name)) for name in names]
    multiplier_error = fine.multiplier_error
    if fine.multiplier is not None and multiplier_error is not None:
        other = coarse.multiplier
        multiplier_error += math.inf if other is None else abs(fine.multiplier - other)
    reach = max(fine.max, abs(fine.min))
    # Stick carries the cell by the belt, so an error in position means one in time, larger by
    # 1/v_d.
    size = max(fine.period, reach, reach / cell.v_d if fine.stick_time else 0.0)
    error = max(*gaps, fine.error, coarse.error, ROUND_OFF * size)
    return replace(fine, error=error, multiplier_error=multiplier_error)
