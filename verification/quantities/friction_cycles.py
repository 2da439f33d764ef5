"""The stick-slip cycle of one friction cell (Fig. 2), in the stability table."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from theory.chains.friction import FrictionChain
from verification.quantities.chains import friction_cell
from verification.quantities.quantity import Axis, Check, Claim, NoReferenceError, Quantity

_LONGEST = 400.0
"""τ that the slow reference follows."""


def stable_cycle(at: Mapping[str, float]) -> Claim:
    """Period and stick time; both zero where there is no cycle."""
    from verification.cells.friction import stick_slip_cycle

    found = stick_slip_cycle(friction_cell(at))
    if found is None:
        return Claim(np.zeros(2), 0.0, note="no cycle")
    value = np.array([found.period, found.stick_time])
    return Claim(value, found.error + 1e-13 * found.period)


def cycle_by_scipy(at: Mapping[str, float], claim: Claim) -> Check:
    """Let the belt carry the cell to its release, and locate every event on scipy's DOP853."""
    from verification.references.friction_events import run_events
    from verification.steppers.friction import STICK_BEGINS, STICK_ENDS

    cell = friction_cell(at)
    period = float(claim.value[0])
    end = 2.2 * period if period else _LONGEST
    if end > _LONGEST or cell.v0 < 1e-3 or cell.v_d < 1e-2:
        raise NoReferenceError("too many steps for scipy")
    # From the middle of the stick phase; where there is none, from shortly before its end.
    carried = 0.5 * float(claim.value[1]) or min(0.01, cell.mu_st / cell.v_d)
    start = np.array([[cell.release - carried * cell.v_d], [cell.v_d]])
    try:
        with np.errstate(all="ignore"):  # scipy tries steps that overflow
            run = run_events(
                FrictionChain.of(cell, c=0.0, sites=1), start, end, times=np.array([end])
            )
    except ArithmeticError as error:
        raise NoReferenceError(str(error)) from None
    ends, begins = (run.log[run.log[:, 2] == kind, 0] for kind in (STICK_ENDS, STICK_BEGINS))
    if not period:
        return Check(float(begins.size), 0.5, "scipy's DOP853 with events")
    if ends.size < 2 or begins.size < 1:
        return Check(period, 1e-9, "scipy's DOP853 with events")
    last = ends[-1]
    true = np.array([last - ends[-2], last - begins[begins < last][-1]])
    return Check(float(np.abs(true - claim.value).max()), 1e-9, "scipy's DOP853 with events")


QUANTITIES = (
    Quantity(
        "cycle-friction",
        "period and stick time of the stick-slip cycle of a friction cell",
        (
            Axis("v_d", 1e-8, 1e8),
            Axis("v0", 1e-6, 1e6),
            Axis("xi", 1e-6, 1.0),
            Axis("mu_st", 0.51, 1e3),
        ),
        stable_cycle,
        cycle_by_scipy,
        10.0,
        share=0.5,
    ),
)
