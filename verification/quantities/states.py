"""The label of a state map, for one displaced site of (8) or (43), in the robustness table.

A label makes an assertion about all later times. The reference therefore integrates the chain by
scipy to somewhat more than twice the time at which the label was given, and checks that it still
holds.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np
from scipy.integrate import solve_ivp

from verification.maps.state import State
from verification.maps.vdp_rules import find_vdp_state
from verification.quantities.chains import vdp_chain
from verification.quantities.quantity import (
    Axis,
    Computation,
    Quantity,
    ReferenceCheck,
    StatedValue,
    axes,
)
from verification.references.equations import (
    amplitude_of,
    as_state,
    averaged_rate,
    damping,
    full_rate,
)
from verification.references.pace import NoReferenceError, paced
from verification.runs.excite import as_psi, excite

_SITES = 16
_AFTER, _CHECKS = 40.0, 200

_RIPPLE = 0.05


_GIVEN: Mapping[str, float] = {"a": 4.0, "eps": 0.01, "sites": _SITES}
"""Default values of parameters that a point omits."""


def _label(at: Mapping[str, float], full: bool) -> StatedValue:
    chain = vdp_chain({**_GIVEN, **at})
    start = excite(chain, [_SITES], at["displacement"])
    found = find_vdp_state(chain if full else chain.averaged(), start)
    value = None if found.state is State.UNDECIDED else 1.0
    extra = (found.time, as_psi(start))
    return StatedValue(value=value, error=0.0, note=str(found.state), extra=extra)


def _label_holds(at: Mapping[str, float], stated: StatedValue, full: bool) -> ReferenceCheck:
    """Return 0 if scipy's run of (8) or of (43) confirms the label, otherwise 1."""
    if stated.value is None:
        raise NoReferenceError("an undecided run makes no statement.")
    chain = vdp_chain({**_GIVEN, **at})
    given, psi = stated.extra
    rate, start = (full_rate(chain), as_state(psi)) if full else (averaged_rate(chain), psi)
    scale = chain.eps if full else 1.0  # converts times of the run to slow times
    end = 2.0 * given + _AFTER
    times = np.linspace(given + 0.5 * _AFTER, end, _CHECKS) / scale
    run = solve_ivp(
        paced(rate, times[-1]), (0.0, times[-1]), start, method="DOP853", t_eval=times,
        rtol=1e-8, atol=1e-9,
    )  # fmt: skip
    if not run.success:
        raise NoReferenceError(run.message)
    amplitude = amplitude_of(run.y.real) if full else np.abs(run.y)
    level = chain.unstable_amplitude if chain.bistable else np.inf
    above = amplitude > level
    if stated.note == "front":
        held = bool(above[0].all())
    elif stated.note == "breather":
        # Within a period |Ψ| changes at the rate ε|h|ẏ²/|Ψ|, and ẏ² is on average half of |Ψ|².
        y = np.linspace(0.0, float(amplitude.max()), 200)
        pulses = np.pi * chain.eps * np.abs(damping(y, chain.a, chain.b)).max() * y[-1]
        steady = np.ptp(amplitude, axis=1).max() < _RIPPLE * level + 0.5 * pulses
        held = bool(above.any(axis=0).all() and not above[0].any() and steady)
    else:
        early, late = np.split(np.linalg.norm(amplitude, axis=0), 2)
        held = bool(late.mean() < early.mean() and not above.any())
    return ReferenceCheck.exact(held, method="scipy's DOP853, to more than twice the time")


_AXES = (
    Axis(name="eta", low=1e-3, high=0.2, near=(0.125,), closest=1e-3),
    *axes(c=(1e-3, 1e2), displacement=(0.3, 1e1)),
)

_LIMITS = "smaller displacements go to rest; stronger couplings and smaller eps take scipy minutes"

QUANTITIES = (
    Quantity(
        name="map", title="boundary of fronts in the map of Fig. 15", equation="(8), (43)",
        problems="map", reference="scipy's DOP853 on (8) until far beyond the decision",
        accuracy=1e-2, default="label sweep, (8)", useful=(1e-3, 0.3),
        computations=(
            Computation(
                name="label-averaged",
                title="front, breather or rest: final state after displacement of one site of (43)",
                axes=_AXES,
                compute=partial(_label, full=False), check=partial(_label_holds, full=False),
                seconds=20.0, share=0.2, problems="map", limits=_LIMITS,
            ),
            Computation(
                name="label-vdp",
                title="front, breather or rest: final state after displacement of one site of (8)",
                axes=(*_AXES, *axes(eps=(1e-2, 1.0))),
                compute=partial(_label, full=True), check=partial(_label_holds, full=True),
                seconds=20.0, share=0.2, problems="map", limits=_LIMITS,
            ),
        ),
    ),
)  # fmt: skip
