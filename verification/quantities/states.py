"""The label of a state map, for one displaced site of (8) or (43), in the stability table.

A label is a promise about all later times. So the reference steps the chain by scipy to twice the
time at which the label was given, and some, and checks that it still holds.
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
from verification.references.equations import amplitude_of, as_state, averaged_rate, full_rate

FloatArray = npt.NDArray[np.float64]

_A, _SITES = 4.0, 16
_AFTER, _CHECKS = 40.0, 200
_MAX_TIME = 2e4
_RIPPLE = 0.05


def _chain(at: Mapping[str, float]) -> VdpChain:
    return VdpChain(a=_A, b=at["eta"] * _A**2, c=at["c"], eps=at.get("eps", 0.01), sites=_SITES)


def _label(at: Mapping[str, float], full: bool) -> StatedValue:
    from verification.maps.state import State
    from verification.maps.vdp_rules import find_vdp_state
    from verification.runs.excite import as_psi, excite

    chain = _chain(at)
    start = excite(chain, [_SITES], at["displacement"])
    found = find_vdp_state(chain if full else chain.averaged(), start)
    if found.state is State.UNDECIDED:
        return StatedValue(value=None, error=0.0, note="undecided", extra=(found, as_psi(start)))
    return StatedValue(value=1.0, error=0.0, note=str(found.state), extra=(found, as_psi(start)))


def _check_averaged(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Step (43) as complex numbers."""
    chain = _chain(at)
    return _label_holds(
        chain,
        stated,
        rate=averaged_rate(chain),
        start=stated.extra[1],
        scale=1.0,
        amplitude_of=np.abs,
    )


def _check_full(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Step (8)."""
    chain = _chain(at)
    return _label_holds(
        chain,
        stated,
        rate=full_rate(chain),
        start=as_state(stated.extra[1]),
        scale=chain.eps,
        amplitude_of=amplitude_of,
    )


def _label_holds(
    chain: VdpChain,
    stated: StatedValue,
    *,
    rate: Any,
    start: npt.NDArray[Any],
    scale: float,
    amplitude_of: Callable[[Any], FloatArray],
) -> ReferenceCheck:
    """Return 0 if scipy's run keeps the promise of the label, else 1."""
    from scipy.integrate import solve_ivp

    if stated.value is None:
        raise NoReferenceError("an undecided run promises nothing.")
    given = stated.extra[0].time
    end = 2.0 * given + _AFTER
    if end / scale > _MAX_TIME:
        raise NoReferenceError("too many periods for scipy")
    times = np.linspace(given + 0.5 * _AFTER, end, _CHECKS) / scale
    run = solve_ivp(
        rate, (0.0, times[-1]), start, method="DOP853", t_eval=times, rtol=1e-9, atol=1e-10
    )
    if not run.success:
        raise NoReferenceError(run.message)
    amplitude = amplitude_of(run.y)
    level = chain.unstable_amplitude if chain.bistable else np.inf
    above = amplitude > level
    if stated.note == "front":
        held = bool(above[0].all())
    elif stated.note == "breather":
        steady = np.ptp(amplitude, axis=1).max() < (_RIPPLE + 4.0 * chain.eps) * level
        held = bool(above.any(axis=0).all() and not above[0].any() and steady)
    else:
        early, late = np.split(np.linalg.norm(amplitude, axis=0), 2)
        held = bool(late.mean() < early.mean() and not above.any())
    return ReferenceCheck(
        distance=0.0 if held else 1.0, method="scipy's DOP853, to more than twice the time"
    )


_AXES = (
    Axis(name="eta", low=1e-3, high=0.2, near=(0.125,), closest=1e-3),
    Axis(name="c", low=1e-3, high=1e2),
    Axis(name="displacement", low=0.3, high=1e1),
)

_LIMITS = "smaller displacements go to rest; stronger couplings and smaller eps take scipy minutes"

QUANTITIES = (
    Quantity(
        name="map",
        title="boundary of fronts in the map of Fig. 15",
        equation="(8), (43)",
        problems="map",
        reference="scipy's DOP853 on (8) until far beyond the decision",
        accuracy=1e-2,
        default="label sweep, (8)",
        useful=(1e-3, 0.3),
        computations=(
            Computation(
                name="label-averaged",
                title="front, breather or rest: what becomes of a displaced site of (43)",
                axes=_AXES,
                compute=partial(_label, full=False),
                check=_check_averaged,
                seconds=20.0,
                share=0.2,
                problems="map",
                limits=_LIMITS,
            ),
            Computation(
                name="label-vdp",
                title="front, breather or rest: what becomes of a displaced site of (8)",
                axes=(*_AXES, Axis(name="eps", low=1e-2, high=1.0)),
                compute=partial(_label, full=True),
                check=_check_full,
                seconds=20.0,
                share=0.2,
                problems="map",
                limits=_LIMITS,
            ),
        ),
    ),
)
