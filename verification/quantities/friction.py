"""The friction chain (5): runs, the stick-slip cycle of one cell (Fig. 2), and the switch model.

The switch model, which is the paper's own integrator, states no error, so it is compared with the
most that friction can do. With E the energy, and |v_rel| at most half of v_d within the stick band,
friction of at most μ_st at each of N sites increases √(2E) by at most 2μ_st √N per unit of τ.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np

from theory.arrays import FloatArray
from theory.chains.friction import FrictionChain
from theory.parameters import RunError
from verification.cells.friction import stick_slip_cycle
from verification.quantities.chains import friction_cell, friction_chain
from verification.quantities.quantity import (
    Computation,
    Quantity,
    ReferenceCheck,
    StatedValue,
    axes,
)
from verification.quantities.runs import REST
from verification.quantities.scipy_states import at_all_sites, moving_sites
from verification.references.friction_events import BEGINS, EventRun, run_events
from verification.references.pace import NoReferenceError, Pace
from verification.references.switch_model import run_switch
from verification.runs.excite import excite
from verification.runs.simulate import simulate
from verification.runs.trajectory import RunStatus

_TAU = 40.0

_FIRST_PART, _MAX_PART = 6, 24
"""Number of sites that the event-located reference follows at first, and at most."""

_ROUNDED, _DECIDED = 4e-15, 1e-3
"""Relative change of the start that represents rounding, and relative change of the result above
which the result is determined by rounding."""

_TIGHT, _LOOSE = (1e-13, 0.05), (1e-12, 0.06)
"""Tolerance and longest step of a reference, and of the run it is compared with; their difference
is mainly the error of the latter."""

_ROUGH = (1e-9, 0.2)
"""The same if it only matters whether the cell sticks again, and v_d is not small."""

_SLIP = 400.0
"""τ of slip, some sixty oscillations, after which a cell that has not stuck is taken never to
stick."""

_BY = "scipy's DOP853 with events"


def stable_cycle(at: Mapping[str, float]) -> StatedValue:
    """Period and stick time; both are zero if there is no cycle."""
    found = stick_slip_cycle(friction_cell(at))
    if found is None:
        return StatedValue(value=np.zeros(2), error=0.0, note="no cycle")
    value = np.array([found.period, found.stick_time])
    return StatedValue(value=value, error=found.error)


def cycle_by_scipy(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Let the belt carry the cell to its release, and locate every event on scipy's DOP853."""
    cell = friction_cell(at)
    period = float(stated.value[0])
    # Start in the middle of the stick phase or, if there is none, shortly before its end.
    carried = 0.5 * float(stated.value[1]) or min(0.01, cell.mu_st / cell.v_d)
    start = np.array([[cell.release - carried * cell.v_d], [cell.v_d]])

    def run(end: float, accuracy: tuple[float, float]) -> EventRun:
        return _events(FrictionChain.of(cell, c=0.0, sites=1), start, end, accuracy)

    if not period:
        # A cell that sticks again is carried to the same release, which makes it a cycle, however
        # long it takes. Since oscillations may be as small as v_d, the tolerances must be small
        # compared with it.
        small = max(min(_ROUGH[0], 1e-6 * cell.v_d), _TIGHT[0])
        soon, late = 0.1 * _SLIP, _SLIP  # most cells that stick do so in the first slip
        sticks = any(run(end, (small, _ROUGH[1])).when(BEGINS).size for end in (soon, late))
        return ReferenceCheck.exact(not sticks, method=_BY)
    true, looser = (run(2.2 * period, each).last_cycle for each in (_TIGHT, _LOOSE))
    if true is None or looser is None:
        return ReferenceCheck.exact(False, method=_BY)
    return ReferenceCheck(
        distance=float(np.abs(true - stated.value).max()),
        uncertainty=float(np.abs(np.subtract(true, looser)).max()),
        method=_BY,
    )


def _events(
    chain: FrictionChain, start: FloatArray, end: float, accuracy: tuple[float, float] = _TIGHT
) -> EventRun:
    with np.errstate(all="ignore"):  # scipy tries steps that overflow
        return run_events(
            chain, start, end, times=np.array([end]),
            tolerance=accuracy[0], longest_step=accuracy[1], pace=Pace(),
        )  # fmt: skip


def friction_state(at: Mapping[str, float]) -> StatedValue:
    """State of the friction chain at τ = 40, with the first site displaced."""
    chain = friction_chain(at)
    start = excite(chain, [1], at["displacement"])
    run = simulate(chain, start, _TAU, samples=2, tolerance=1e-10)
    assert run.error is not None
    if run.status is not RunStatus.RESOLVED:
        raise RunError("runs at other tolerances have other events: rounding decides.")
    return StatedValue(value=run.y[-1], error=run.error, extra=start)


def friction_by_scipy(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Locate every event on scipy's DOP853."""
    chain, rest = friction_chain(at), friction_chain(at).cell.steady_sliding

    @cache
    def last(part: int) -> FloatArray:
        run = _events(replace(chain, sites=part), stated.extra[:, :part], _TAU)
        return np.asarray(run.y[-1])

    def at_rest(part: int) -> bool:
        return bool(abs(last(part)[-1] - rest) <= REST * (at["displacement"] + rest))

    part = moving_sites(at_rest, chain.sites, _FIRST_PART, _MAX_PART)
    nearby = stated.extra[:, :part].copy()
    nearby[0] *= 1.0 + _ROUNDED
    changed = _events(replace(chain, sites=part), nearby, _TAU, _LOOSE).y[-1]
    uncertainty = float(np.abs(last(part) - changed).max())
    if uncertainty > _DECIDED * float(np.abs(last(part)).max()):
        raise NoReferenceError("rounding of the start decides what the reference finds")
    distance = float(np.abs(stated.value - at_all_sites(last(part), chain.sites, rest)).max())
    return ReferenceCheck(distance=distance, uncertainty=uncertainty, method=_BY)


_SHORT = 10.0
"""Duration τ of the runs of the switch model."""


def switch_energy(at: Mapping[str, float]) -> StatedValue:
    """Return √(2E) at the end of a run with fixed steps; ``band`` is a fraction of v_d."""
    chain = friction_chain(at)
    start = excite(chain, [1], at["displacement"])
    run = run_switch(
        chain, start, _SHORT, step=at["step"], band=at["band"] * chain.cell.v_d, samples=2
    )
    return StatedValue(
        value=_root_energy(chain.c, run.y[-1], run.velocity[-1]), error=0.0, extra=start
    )


def _root_energy(c: float, y: FloatArray, velocity: FloatArray) -> float:
    return math.sqrt(float(y @ y + velocity @ velocity + c * np.sum(np.diff(y) ** 2)))


def within_the_work_of_friction(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Compare with √(2E) of the start plus the most that friction can add."""
    added = 2.0 * at["mu_st"] * math.sqrt(at["sites"]) * _SHORT
    most = _root_energy(at["c"], *stated.extra) + added
    # A bound, with an allowance for the rounding of thousands of steps; it only tells right from
    # wrong.
    return ReferenceCheck.exact(
        float(stated.value) <= (1.0 + 1e-9) * most, method="the work of friction"
    )


QUANTITIES = (
    Quantity(
        name="friction", title="trajectory of the friction chain (5)", equation="(5), (6)",
        problems="friction", accuracy=1e-10, default="event-exact", useful=(1e-8, 0.1),
        reference="scipy's DOP853 with located events, at 1e-13, beside ours at 1e-13",
        computations=(
            Computation(
                name="run-friction",
                title="state of the friction chain (5) at tau = 40 from one displaced site",
                axes=axes(
                    c=(1e-8, 1e1), v_d=(1e-2, 1e1), v0=(1e-3, 1e1), xi=(1e-6, 1.0),
                    mu_st=(0.51, 1e1), sites=(1, 10_000), displacement=(1e-8, 1e1),
                ),
                compute=friction_state, check=friction_by_scipy, seconds=60.0, share=0.3,
                limits="faster belts, thinner friction curves and stronger springs take minutes, "
                "with as many events",
            ),
            Computation(
                name="cycle-friction",
                title="period and stick time of the stick-slip cycle of a friction cell",
                axes=axes(v_d=(1e-8, 1e8), v0=(1e-6, 1e6), xi=(1e-6, 1.0), mu_st=(0.51, 1e3)),
                compute=stable_cycle, check=cycle_by_scipy, seconds=10.0, share=0.5,
            ),
            Computation(
                name="switch-friction",
                title="energy of the switch model of (5) at tau = 10, for any stick band and step",
                axes=axes(
                    band=(1e-12, 0.5), step=(1e-4, 1.0), c=(1e-8, 1e8), v_d=(1e-8, 1e8),
                    v0=(1e-8, 1e8), xi=(1e-6, 1.0), mu_st=(0.51, 1e3), sites=(1, 100),
                    displacement=(1e-8, 1e3),
                ),
                compute=switch_energy, check=within_the_work_of_friction, seconds=30.0, share=0.5,
            ),
        ),
    ),
)  # fmt: skip
