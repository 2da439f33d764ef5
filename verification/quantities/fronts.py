"""Travelling fronts of (43), (8) and (44) on the running chain.

The references for (43) and (8) integrate the same chains by scipy and time the arrivals at the
sites. The intervals between arrivals are uneven, since each site oscillates with its own phase.
Therefore v is obtained from their weighted mean over the second half of the sites, with smooth
weights that vanish at both ends; the quasi-periodic part of the intervals then averages out faster
than any power of their number (Das, Saiki, Sander and Yorke 2017). Its uncertainty is six times the
difference from the mean over the first half, because a drift like n^{-2/3}, as of the head of a
wave, decays no faster.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial

import mpmath as mp
import numpy as np

from theory.arrays import FloatArray
from theory.piecewise.kinetic_relation import kinetic_relation
from verification.fronts.measure import measure_front
from verification.fronts.request import TOLERANCE
from verification.fronts.result import LeftBoundary
from verification.fronts.status import FrontStatus
from verification.fronts.wave import NoFrontError, front_wave
from verification.piecewise.simulation import simulate_front
from verification.quantities.chains import vdp_chain
from verification.quantities.kinetic_relation import precise_velocity
from verification.quantities.quantity import (
    MAX_UNCERTAINTY,
    Axis,
    Computation,
    Quantity,
    ReferenceCheck,
    StatedValue,
    axes,
)
from verification.references.equations import amplitude_of, as_state, full_rate, quarter_turn_rate
from verification.references.front_wave import front_velocity
from verification.references.pace import NoReferenceError, Pace
from verification.references.passages import arrivals_by_scipy, mean_interval

_FILLED, _END = 24, 8
_MIN_SITES, _MAX_SITES = 64, 352
"""Number of sites, beyond those excited at the start, at which a front is timed: as many as it
passes in `_TIME`, since a longer chain costs little more per step."""

_TIME = 5e3
"""Time t: half of what scipy integrates in the time allowed, at about sixty evaluations per
unit."""

_STALL_TIME = 60.0


_TOLERANCE = Axis(name="tolerance", low=1e-12, high=TOLERANCE.allowed.high)
"""Up to the largest that is accepted; below, the error of a velocity no longer depends on it."""


_GIVEN: Mapping[str, float] = {"a": 4.0, "eps": 0.01, "sites": 32, "tolerance": 1e-8}
"""Default values of parameters that a point omits."""


def _front(at: Mapping[str, float], full: bool) -> StatedValue:
    values = {**_GIVEN, **at}
    chain = vdp_chain(values)
    found = measure_front(
        chain if full else chain.averaged(),
        tolerance=values["tolerance"],
        left_boundary=LeftBoundary.WAVE,
        stall_time=_STALL_TIME,
    )
    settled = found.status in (FrontStatus.STEADY, FrontStatus.PINNED) and found.error is not None
    v = found.v if settled else None
    return StatedValue.of(found, v, note="" if v else found.status.value)


def _by_scipy(at: Mapping[str, float], stated: StatedValue, full: bool) -> ReferenceCheck:
    """Compare v with a run by scipy of (8), or of the real amplitudes of (43) with locked phases.

    Each site lags by a quarter turn behind its left neighbour; to the left the wave continues.
    """
    if stated.value is None:
        raise NoReferenceError(f"the front is {stated.note} and states no velocity.")
    scale = vdp_chain({**_GIVEN, **at}).eps if full else 1.0  # converts run times to slow times
    timed = round(min(max(_TIME * scale * stated.value, _MIN_SITES), _MAX_SITES))
    sites = _FILLED + timed + _END
    chain = vdp_chain({**_GIVEN, **at, "sites": sites})
    end = 2.0 * _STALL_TIME if stated.value == 0.0 else 1.5 * sites / stated.value
    filled = np.where(np.arange(sites) < _FILLED, chain.stable_amplitude, 0.0)
    amplitude, level = amplitude_of if full else np.abs, chain.unstable_amplitude
    rate = full_rate(chain, wave=True) if full else quarter_turn_rate(chain, wave=True)
    turns = np.array([(-1j) ** n for n in range(sites)])
    start = as_state(turns * filled) if full else filled
    pace = Pace()

    def check(t: float, times: FloatArray) -> None:
        pace.check(max(1.5 * t * scale / end, np.count_nonzero(times >= 0.0) / sites))

    reached = scale * arrivals_by_scipy(
        rate, start, amplitude=amplitude, level=level, watched=slice(_FILLED, sites - _END),
        rtol=1e-8, atol=1e-9, end=end / scale, each_step=check,
    )  # fmt: skip
    if stated.value == 0.0:
        late = int(np.count_nonzero(reached > 0.5 * end))
        return ReferenceCheck(distance=late / (0.5 * end), method="sites reached in scipy's run")
    return _timed(reached, stated.value, "scipy's DOP853, timed")


def _wave(at: Mapping[str, float]) -> StatedValue:
    """Solve for the front of (43); if there is none that travels, state this."""
    try:
        found = front_wave(at["c"], at["eta"])
    except NoFrontError as refusal:
        return StatedValue(value=None, error=0.0, note=str(refusal))
    return StatedValue.of(found, found.v)


_LADDER = (28, 40, 56, 80, 112)
"""Grid points per site in ξ; the results of two successive grids are compared."""


def _by_differences(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Compare v with finite differences in ξ, refining the grid until two solutions agree.

    The error of the finer one is much smaller than their difference.
    """
    if stated.value is None:
        raise NoReferenceError(stated.note)
    ahead = 24.0 * max(1.0, math.cbrt(at["c"]))
    coarse = np.longdouble(np.inf)
    for rung, points in enumerate(_LADDER):
        far = math.ceil(ahead * (1.0 + 0.5 * rung))
        try:
            fine = front_velocity(at["c"], at["eta"], points, behind=20 + 10 * rung, ahead=far)
        except (ArithmeticError, ValueError):
            raise NoReferenceError("no wave was found by differences") from None
        apart = abs(float(fine - coarse))
        coarse = fine
        if apart <= MAX_UNCERTAINTY * stated.error:
            break
    return ReferenceCheck(
        distance=abs(float(coarse - stated.value)),
        uncertainty=apart,
        method="differences in ξ, a sparse Newton",
    )


def _averaged_front_known(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Compare a steady v with the wave itself if differences in ξ resolve it, else with a run."""
    if stated.value and 0.15 <= at["c"] <= 10.0 and at["eta"] >= 1e-2:
        found = _by_differences(at, stated)
        if found.uncertainty <= MAX_UNCERTAINTY * stated.error:
            return found
    return _by_scipy(at, stated, full=False)


def _timed(reached: FloatArray, v: float, by: str) -> ReferenceCheck:
    if np.isnan(reached).any():
        raise NoReferenceError("scipy's front does not run through the chain")
    before, last = map(mean_interval, np.array_split(reached, 2))
    uncertain = 6.0 * abs(last - before) / last**2 + 1e-7 / last
    if uncertain > 0.1 * v:
        raise NoReferenceError("scipy's front does not settle within the chain")
    return ReferenceCheck(distance=abs(v - 1.0 / last), uncertainty=uncertain, method=by)


_LIMITS = "outside, scipy takes minutes for the reference, or there is no front"


def _piecewise_front(at: Mapping[str, float]) -> StatedValue:
    """Measure a front of (44) where a run takes less than a minute; its tails grow with c."""
    found = simulate_front(at["c"], at["eta"])
    steady = found.status is FrontStatus.STEADY and found.error is not None
    v = found.v if steady else None
    return StatedValue.of(found, v, note="" if v else found.status.value)


def _check_piecewise(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Compare with the nearest root of (54), found by the secant method with many digits.

    A run that never settles states no velocity.
    """
    theory = kinetic_relation(at["c"], at["eta"])
    if stated.value is None:
        raise NoReferenceError(f"the run is {stated.note} and states no velocity.")
    if not theory.branches:
        raise NoReferenceError("a steady run where (54) has no branch.")
    near = min(theory.branches, key=lambda branch: abs(branch.v - stated.value))
    v, uncertainty = precise_velocity(near.v, at)
    off = abs(float(v - mp.mpf(stated.value)))
    return ReferenceCheck(
        distance=off, uncertainty=uncertainty, method="root of (54) in many digits"
    )


QUANTITIES = (
    Quantity(
        name="front", title="velocity of a front of (43) and (8)", equation="(8), (43), (44)",
        problems="front", accuracy=2e-6, default="measured front", useful=(1e-8, 1e-2),
        reference="arrivals by scipy's DOP853, and by ours on twice the length",
        computations=(
            Computation(
                name="front-averaged", title="velocity of a front of (43) on the running chain",
                axes=(
                    *axes(c=(1e-3, 1e2)), Axis(name="eta", low=1e-4, high=0.125, near=(0.125,)),
                    _TOLERANCE,
                ),
                compute=partial(_front, full=False), check=_averaged_front_known,
                seconds=60.0, share=0.08, problems="front", limits=_LIMITS,
            ),
            Computation(
                name="front-wave", title="velocity of a front of (43) as a solution",
                axes=axes(c=(0.15, 10.0), eta=(1e-2, 0.1)),
                compute=_wave, check=_by_differences,
                seconds=60.0, share=0.05, problems="front",
                limits="outside, fronts rest, or are steeper or longer than the reference reaches",
            ),
            Computation(
                name="front-vdp", title="velocity of a front of (8) on the running chain",
                axes=(*axes(c=(1e-1, 1e1), eta=(1e-2, 0.1), eps=(1e-2, 0.3)), _TOLERANCE),
                compute=partial(_front, full=True), check=partial(_by_scipy, full=True),
                seconds=60.0, share=0.05, problems="front", limits=_LIMITS,
            ),
            Computation(
                name="front-velocity", title="velocity of a front of (44) from event to event",
                axes=(
                    *axes(c=(0.05, 5.0)),
                    Axis(name="eta", low=1e-6, high=0.125, near=(0.08, 0.125)),
                ),
                compute=_piecewise_front, check=_check_piecewise,
                seconds=60.0, share=0.05, problems="relation",
                limits="outside, a run takes several minutes: tails are long, or fronts slow",
            ),
        ),
    ),
)  # fmt: skip
