"""Travelling fronts of (43) and (8) on the running chain, in the stability table.

The references step the same chains by scipy, time the sites, and take v from their own intervals:
the mean interval over the last quarter of the sites, uncertain by six times how far that of the
quarter before is from it (a drift like n^{-2/3}, as of the head of a wave, is not over sooner), or
by how uneven they are.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from theory.chains.vdp import VdpChain
from verification.quantities.quantity import Axis, Check, Claim, NoReferenceError, Quantity
from verification.references.equations import amplitude_of, as_state, full_rate

FloatArray = npt.NDArray[np.float64]
Rate = Callable[[float, FloatArray], FloatArray]

_FILLED, _SITES, _END = 24, 96, 8
_A = 4.0
_PATIENCE = 60.0
_MOST_TIME = 3e4


def _chain(at: Mapping[str, float]) -> VdpChain:
    return VdpChain(a=_A, b=at["eta"] * _A**2, c=at["c"], eps=at.get("eps", 0.01), sites=32)


def _front(at: Mapping[str, float], full: bool) -> Claim:
    from verification.fronts.measure import measure_front
    from verification.fronts.result import LeftBoundary
    from verification.fronts.status import FrontStatus
    from verification.runs.model import Model

    model = Model.FULL if full else Model.ENVELOPE
    found = measure_front(
        model.chain_of(_chain(at)), left_boundary=LeftBoundary.WAVE, stall_time=_PATIENCE
    )
    settled = found.status in (FrontStatus.STEADY, FrontStatus.PINNED)
    if not settled or found.v is None or found.error is None:
        return Claim(None, 0.0, note=found.status.value)
    return Claim(found.v, found.error, note="pinned" * (found.v == 0.0))


def _check_averaged(at: Mapping[str, float], claim: Claim) -> Check:
    """Step the real amplitudes behind which phases are locked at a quarter of a turn a site."""
    chain = _chain(at)
    a, b, c = chain.a, chain.b, chain.c

    def rate(_: float, r: FloatArray) -> FloatArray:
        left, right = np.concatenate([r[:1], r[:-1]]), np.concatenate([r[1:], [0.0]])
        square = r * r
        damping = 1.0 - 0.25 * a * square + 0.125 * b * square * square
        out: FloatArray = 0.5 * c * (left - right) - 0.5 * r * damping
        return out

    start = np.where(np.arange(_SITES) < _FILLED, chain.stable_amplitude, 0.0)
    return _by_scipy(chain, claim, rate, start, 1.0, np.abs)


def _check_full(at: Mapping[str, float], claim: Claim) -> Check:
    """Step (8), with a wave that goes on behind."""
    chain = _chain(at)
    turns = 1j * (-1j) ** np.arange(_SITES)  # each site a quarter of a turn behind the one before
    psi = np.where(np.arange(_SITES) < _FILLED, chain.stable_amplitude * turns, 0.0)
    return _by_scipy(
        chain, claim, full_rate(chain, wave=True), as_state(psi), chain.eps, amplitude_of
    )


def _by_scipy(
    chain: VdpChain,
    claim: Claim,
    rate: Rate,
    start: FloatArray,
    scale: float,
    amplitude: Callable[[FloatArray], FloatArray],
) -> Check:
    """Return how far the claim is from the velocity of scipy's run; times are slow over scale."""
    from scipy.integrate import DOP853

    if claim.value is None:
        raise NoReferenceError(f"the front is {claim.note} and claims no velocity.")
    end = 2.0 * _PATIENCE if claim.value == 0.0 else 1.5 * _SITES / claim.value
    if end / scale > _MOST_TIME:
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
    if claim.value == 0.0:
        late = int(np.count_nonzero(reached > 0.5 * end))
        return Check(late / (0.5 * end), 0.0, "sites reached in scipy's run")
    return _timed(reached, claim.value, "scipy's DOP853, timed")


def _timed(reached: FloatArray, v: float, by: str) -> Check:
    if np.isnan(reached).any():
        raise NoReferenceError("scipy's front does not run through the chain")
    quarter = reached.size // 4
    last = float(reached[-1] - reached[-1 - quarter]) / quarter
    before = float(reached[-1 - quarter] - reached[-1 - 2 * quarter]) / quarter
    uneven = float(np.ptp(np.diff(reached[-1 - quarter :]))) / quarter
    uncertain = max(6.0 * abs(last - before), uneven) / last**2 + 1e-7 / last
    return Check(abs(v - 1.0 / last), uncertain, by)


def _crossing(
    solver: Any, amplitude: Callable[[FloatArray], FloatArray], site: int, level: float
) -> float:
    from scipy.optimize import brentq

    path = solver.dense_output()
    return float(
        brentq(lambda t: amplitude(path(t))[site] - level, solver.t_old, solver.t, xtol=1e-9)
    )


_ENDS = "outside, scipy takes minutes for the reference, or there is no front"

QUANTITIES = (
    Quantity(
        "front-averaged",
        "velocity of a front of (43) on the running chain",
        (Axis("c", 1e-3, 1e2), Axis("eta", 1e-4, 0.125, near=(0.125,))),
        partial(_front, full=False),
        _check_averaged,
        seconds=60.0,
        share=0.08,
        scenes="front",
        ends=_ENDS,
    ),
    Quantity(
        "front-vdp",
        "velocity of a front of (8) on the running chain",
        (Axis("c", 1e-1, 1e1), Axis("eta", 1e-2, 0.1), Axis("eps", 1e-2, 0.3)),
        partial(_front, full=True),
        _check_full,
        seconds=60.0,
        share=0.05,
        scenes="front",
        ends=_ENDS,
    ),
)
