"""Travelling fronts of (43), (8) and (44) on the running chain.

The references of (43) and (8) step the same chains by scipy, time the sites, and take v from their
own intervals: the mean interval over the last quarter of the sites, uncertain by six times how far
that of the quarter before is from it (a drift like n^{-2/3}, as of the head of a wave, is not over
sooner), or by how uneven they are.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from theory.chains.vdp import VdpChain
from verification.quantities.quantity import (
    Axis,
    Computation,
    NoReferenceError,
    Quantity,
    ReferenceCheck,
    StatedValue,
)
from verification.references.equations import amplitude_of, as_state, full_rate, quarter_turn_rate

FloatArray = npt.NDArray[np.float64]
Rate = Callable[[float, FloatArray], FloatArray]

_FILLED, _SITES, _END = 24, 96, 8
_A = 4.0
_STALL_TIME = 60.0
_MAX_TIME = 3e4


def _chain(at: Mapping[str, float]) -> VdpChain:
    return VdpChain(a=_A, b=at["eta"] * _A**2, c=at["c"], eps=at.get("eps", 0.01), sites=32)


def _front(at: Mapping[str, float], full: bool) -> StatedValue:
    from verification.fronts.measure import measure_front
    from verification.fronts.result import LeftBoundary
    from verification.fronts.status import FrontStatus

    chain = _chain(at)
    found = measure_front(
        chain if full else chain.averaged(), left_boundary=LeftBoundary.WAVE, stall_time=_STALL_TIME
    )
    settled = found.status in (FrontStatus.STEADY, FrontStatus.PINNED)
    if not settled or found.v is None or found.error is None:
        return StatedValue(value=None, error=0.0, note=found.status.value)
    return StatedValue(value=found.v, error=found.error, note="pinned" * (found.v == 0.0))


def _check_averaged(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Step the real amplitudes behind which phases are locked at a quarter of a turn a site."""
    chain = _chain(at)
    start = np.where(np.arange(_SITES) < _FILLED, chain.stable_amplitude, 0.0)
    return _by_scipy(
        chain,
        stated,
        rate=quarter_turn_rate(chain, wave=True),
        start=start,
        scale=1.0,
        amplitude=np.abs,
    )


def _check_full(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Step (8), with a wave that goes on behind."""
    chain = _chain(at)
    turns = 1j * (-1j) ** np.arange(_SITES)  # each site a quarter of a turn behind the one before
    psi = np.where(np.arange(_SITES) < _FILLED, chain.stable_amplitude * turns, 0.0)
    return _by_scipy(
        chain,
        stated,
        rate=full_rate(chain, wave=True),
        start=as_state(psi),
        scale=chain.eps,
        amplitude=amplitude_of,
    )


def _by_scipy(
    chain: VdpChain,
    stated: StatedValue,
    *,
    rate: Rate,
    start: FloatArray,
    scale: float,
    amplitude: Callable[[FloatArray], FloatArray],
) -> ReferenceCheck:
    """Return how far the stated is from the velocity of scipy's run; times are slow over scale."""
    from scipy.integrate import DOP853

    if stated.value is None:
        raise NoReferenceError(f"the front is {stated.note} and states no velocity.")
    end = 2.0 * _STALL_TIME if stated.value == 0.0 else 1.5 * _SITES / stated.value
    if end / scale > _MAX_TIME:
        raise NoReferenceError("too many periods for scipy")
    solver = DOP853(rate, 0.0, start, end / scale, rtol=1e-8, atol=1e-9)
    times = np.full(_SITES, np.nan)
    times[:_FILLED] = 0.0
    while solver.status == "running" and np.isnan(times[_SITES - _END - 1]):
        with np.errstate(all="ignore"):  # scipy tries steps that overflow
            solver.step()
        now = amplitude(solver.y) > chain.unstable_amplitude
        for site in np.flatnonzero(now & np.isnan(times)).tolist():
            times[site] = scale * _crossing(solver, amplitude, site, chain.unstable_amplitude)
    reached = times[_FILLED : _SITES - _END]
    if stated.value == 0.0:
        late = int(np.count_nonzero(reached > 0.5 * end))
        return ReferenceCheck(distance=late / (0.5 * end), method="sites reached in scipy's run")
    return _timed(reached, stated.value, "scipy's DOP853, timed")


def _timed(reached: FloatArray, v: float, by: str) -> ReferenceCheck:
    if np.isnan(reached).any():
        raise NoReferenceError("scipy's front does not run through the chain")
    quarter = reached.size // 4
    last = float(reached[-1] - reached[-1 - quarter]) / quarter
    before = float(reached[-1 - quarter] - reached[-1 - 2 * quarter]) / quarter
    uneven = float(np.ptp(np.diff(reached[-1 - quarter :]))) / quarter
    uncertain = max(6.0 * abs(last - before), uneven) / last**2 + 1e-7 / last
    return ReferenceCheck(distance=abs(v - 1.0 / last), uncertainty=uncertain, method=by)


def _crossing(
    solver: Any, amplitude: Callable[[FloatArray], FloatArray], site: int, level: float
) -> float:
    from scipy.optimize import brentq

    path = solver.dense_output()
    return float(
        brentq(lambda t: amplitude(path(t))[site] - level, solver.t_old, solver.t, xtol=1e-9)
    )


_LIMITS = "outside, scipy takes minutes for the reference, or there is no front"


def _piecewise_front(at: Mapping[str, float]) -> StatedValue:
    """Measure a front of (44), where a run takes less than a minute: tails grow with c."""
    from verification.fronts.status import FrontStatus
    from verification.piecewise.simulation import simulate_front

    found = simulate_front(at["c"], at["eta"])
    if found.status is not FrontStatus.STEADY or found.v is None or found.error is None:
        return StatedValue(value=None, error=0.0, note=found.status.value, extra=found)
    return StatedValue(value=found.v, error=found.error, extra=found)


def _check_piecewise(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Compare with the admissible branches of (54); a run that never settles states nothing."""
    from theory.piecewise.kinetic_relation import kinetic_relation

    theory = kinetic_relation(at["c"], at["eta"])
    if stated.value is None:
        raise NoReferenceError(f"the run is {stated.note} and states no velocity.")
    if not theory.branches:
        raise NoReferenceError("a steady run where (54) has no branch.")
    near = min(theory.branches, key=lambda branch: abs(branch.v - stated.value))
    return ReferenceCheck(
        distance=abs(near.v - stated.value), uncertainty=near.error, method="kinetic relation"
    )


QUANTITIES = (
    Quantity(
        name="front",
        title="velocity of a front of (43) and (8)",
        equation="(8), (43), (44)",
        problems="front",
        reference="arrivals by scipy's DOP853, and by ours on twice the length",
        accuracy=2e-6,
        default="measured front",
        useful=(1e-8, 1e-2),
        computations=(
            Computation(
                name="front-averaged",
                title="velocity of a front of (43) on the running chain",
                axes=(
                    Axis(name="c", low=1e-3, high=1e2),
                    Axis(name="eta", low=1e-4, high=0.125, near=(0.125,)),
                ),
                compute=partial(_front, full=False),
                check=_check_averaged,
                seconds=60.0,
                share=0.08,
                problems="front",
                limits=_LIMITS,
            ),
            Computation(
                name="front-vdp",
                title="velocity of a front of (8) on the running chain",
                axes=(
                    Axis(name="c", low=1e-1, high=1e1),
                    Axis(name="eta", low=1e-2, high=0.1),
                    Axis(name="eps", low=1e-2, high=0.3),
                ),
                compute=partial(_front, full=True),
                check=_check_full,
                seconds=60.0,
                share=0.05,
                problems="front",
                limits=_LIMITS,
            ),
            Computation(
                name="front-velocity",
                title="velocity of a front of (44) from event to event",
                axes=(
                    Axis(name="c", low=0.05, high=5.0),
                    Axis(name="eta", low=1e-6, high=0.125, near=(0.08, 0.125)),
                ),
                compute=_piecewise_front,
                check=_check_piecewise,
                seconds=60.0,
                share=0.05,
                problems="relation",
                limits="outside, a run takes several minutes: tails are long, or fronts slow",
            ),
        ),
    ),
)
