"""Both cycles of one Van der Pol cell (Eq. 8 at c = 0), by shooting and by averaging.

    ÿ + y + ε ẏ (1 - a y² + b y⁴) = 0

The averaged radii are known in closed form.
"""

from __future__ import annotations

import math
from time import perf_counter

from theory.cells.oscillator import OscillatorCell
from theory.cells.vdp import ETA_END, eta_from_damping, is_bistable
from theory.parameters import Range, with_ranges, within
from verification.cells.result import Cell, CellCycle, CellStatus
from verification.cells.shooting import ROUNDING, TOLERANCES, shot_cycles

EPS_RANGE = Range(1e-4, 1.0)
"""Range of ε; below it the averaged cell is as accurate."""


@with_ranges(eps=EPS_RANGE, tolerance=TOLERANCES)
def vdp_cell(a: float, b: float, eps: float, tolerance: float) -> Cell:
    """Return both cycles of a cell.

    Parameters
    ----------
    a, b : float
        Coefficients of the damping, positive.
    eps : float
        Small parameter, {eps}.
    tolerance : float
        Relative tolerance of DOP853, {tolerance}.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or ε is so large that the averaged cycles do not lead to the
        exact ones or the latter are too stiff.

    Examples
    --------
    >>> found = vdp_cell(2.5, 0.5, 0.01, 1e-12)
    >>> abs(found.stable_cycle.amplitude - found.stable_cycle.averaged) < 1e-3
    True
    """
    begin = perf_counter()
    eta_from_damping(a, b)  # refuses what is out of range
    remedy = (
        "give a value in this range; for smaller ones use the averaged cell, which is their limit"
    )
    within("small parameter eps", eps, *EPS_RANGE, remedy)
    within("tolerance", tolerance, *TOLERANCES)
    damping = {(0, 0): 1.0, (2, 0): -a, (4, 0): b}
    cycles = shot_cycles(OscillatorCell(stiffness={1: 1.0}, damping=damping), eps, tolerance)
    unstable, stable = cycles or (None, None)
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
    """Return both cycles of (43) in closed form: |φ|² = (a/b)(1 ∓ √(1 - 8η)), of period 2π.

    At η = 1/8 they coincide in a semistable cycle.

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
        # As the cycles approach each other, rounding of η alone shifts the root by this much.
        spread = 8.0 * ROUNDING / root**2
        unstable, stable = (
            _closed(math.sqrt(square), spread)
            for square in (8.0 / a / (1.0 + root), a / b * (1.0 + root))
        )
        status = CellStatus.BISTABLE
    elif eta == ETA_END:
        # Rounding of η alone separates the cycles by the square root of it.
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
