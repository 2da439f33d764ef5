"""Both cycles of the friction cell, by shooting, and how they end (Fig. 2 and its continuation).

How one cycle is found is in ``friction_cycles``; here are its error and where it ends. Both
cycles end at one belt velocity, where the slip phase from the point of release only touches
ẏ = v_d, on returning to that very point: a grazing.
"""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from time import perf_counter

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from theory.cells.friction import FrictionCell
from theory.cells.friction_law import FrictionLaw
from theory.parameters import ParameterError, within
from verification.cells.friction_cycles import (
    ROUND_OFF,
    largest_after_release,
    never_sticks,
    stick_slip_once,
    unstable_once,
)
from verification.cells.result import BeltCell, CellStatus, Cycle
from verification.runs.comparison import COARSER

FloatArray = npt.NDArray[np.float64]

_SLOWEST_BELT, _FASTEST_BELT = 1e-9, 1e9
"""Beyond these a cycle and the round-off of y can no longer be distinguished."""


def friction_cell(cell: FrictionCell, tolerance: float = 1e-12) -> BeltCell:
    """Return the cycles of a cell, and where they end.

    Parameters
    ----------
    cell : FrictionCell
        Parameters.
    tolerance : float
        Local error, from 1e-14 to 1e-4.

    Examples
    --------
    >>> found = friction_cell(FrictionCell())
    >>> found.status.value, round(found.stable.period, 6), found.error < 1e-8
    ('bistable', 6.353749, True)

    Raises
    ------
    ParameterError
        If the tolerance or v_d is out of range, the law is not that of (2), or the cell slips both
        ways and never sticks.
    """
    begin = perf_counter()
    within("tolerance", tolerance, 1e-14, 1e-4)
    within("belt velocity v_d", cell.v_d, _SLOWEST_BELT, _FASTEST_BELT)
    end = cycle_end_velocity(cell, tolerance)
    coarse_end = cycle_end_velocity(cell, COARSER * tolerance)
    stable = stick_slip_cycle(cell, tolerance) if cell.v_d < end else None
    sliding_stable = cell.effective_damping > 0.0
    if stable is None and not sliding_stable:
        raise never_sticks(cell)
    unstable = unstable_cycle(cell, tolerance) if stable and sliding_stable else None
    if stable is None:
        status = CellStatus.SLIDING
    else:
        status = CellStatus.BISTABLE if sliding_stable else CellStatus.CYCLE
    end_error = 0.0 if end == coarse_end else abs(end - coarse_end)
    return BeltCell(
        model="friction",
        cell=cell,
        parameters=asdict(cell),
        status=status,
        rest=cell.steady_sliding,
        effective_damping=cell.effective_damping,
        stable=stable,
        unstable=unstable,
        hopf_velocity=cell.hopf_velocity,
        cycle_end_velocity=end,
        cycle_end_error=end_error,
        seconds=perf_counter() - begin,
    )


def stick_slip_cycle(cell: FrictionCell, tolerance: float = 1e-12) -> Cycle | None:
    """Return the stick-slip cycle, None if the slip phase from release never sticks again."""
    fine = stick_slip_once(cell, tolerance)
    coarse = stick_slip_once(cell, COARSER * tolerance)
    return _with_error(fine, coarse)


def unstable_cycle(cell: FrictionCell, tolerance: float = 1e-12) -> Cycle | None:
    """Return the cycle without stick that separates the two basins, None if there is none.

    It exists between the Hopf velocity and the end of the stick-slip cycle.
    """
    return _with_error(unstable_once(cell, tolerance), unstable_once(cell, COARSER * tolerance))


def cycle_end_velocity(cell: FrictionCell, tolerance: float = 1e-12) -> float:
    """Return v_d at which the slip phase from release only touches ẏ = v_d.

    Infinite for ξ = 0: slow departure from v_rel = 0 gains energy and nothing loses any. 0 if
    there is no cycle even at small v_d.

    Raises
    ------
    ParameterError
        If the law is not that of (2), with or without a viscous part.

    Examples
    --------
    >>> end = cycle_end_velocity(FrictionCell())
    >>> stick_slip_cycle(FrictionCell(v_d=0.9999 * end)).stick_time < 0.03
    True
    """
    if cell.law is not FrictionLaw.EXPONENTIAL:
        raise ParameterError(
            "friction law", cell.law.value, "exponential for both cycles of a cell and their end",
            "simulate a chain of one site with this law instead",
        )  # fmt: skip

    def excess(v_d: float) -> float:
        return largest_after_release(replace(cell, v_d=v_d), tolerance)

    low = 1e-3 * min(1.0, cell.v0)
    if excess(low) <= 0.0:
        return 0.0
    if cell.xi == cell.viscous == 0.0:
        return math.inf
    high = low
    while excess(high) > 0.0:
        low, high = high, 1.25 * high
    return float(brentq(excess, low, high, xtol=1e-15, rtol=9e-16))


def _with_error(fine: Cycle | None, coarse: Cycle | None) -> Cycle | None:
    if fine is None:
        return None
    if coarse is None:
        return replace(fine, error=math.inf)
    names = ("max", "min", "period", "stick_time", "slip_time")
    gaps = [abs(getattr(fine, name) - getattr(coarse, name)) for name in names]
    size = max(1.0, fine.period, abs(fine.max), abs(fine.min))
    return replace(fine, error=max(*gaps, fine.error, coarse.error, ROUND_OFF * size))
