"""Runs of the chains (8), (43) and (5), in the stability table.

Runs are compared at one short time, before chaos or a marginal event makes every method differ.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from theory.parameters import RunError
from verification.quantities.chains import friction_chain, vdp_chain
from verification.quantities.quantity import Axis, Check, Claim, NoReferenceError, Quantity
from verification.references.equations import as_state, averaged_rate, full_rate

ComplexArray = npt.NDArray[np.complex128]
FloatArray = npt.NDArray[np.float64]

_END, _TAU = 30.0, 40.0
_REFERENCE = 1e-12
_FIRST_COMPARED, _MOST_COMPARED = 30, 400
"""Sites that a slow reference follows at first, and at most: those that move."""

_STILL = 1e-14
"""Share of the displacement below which a site that the reference left out is at rest."""

_ROUNDING = 1e-14
"""Share of the displacement that rounding may add to a reference."""

_FIRST_STICKING, _MOST_STICKING = 6, 24
"""The same for the event-located reference of the friction chain."""

_ROUNDED, _DECIDED = 4e-15, 1e-3
"""By how much a start is moved to see what rounding does; above which rounding decides."""


def _run(at: Mapping[str, float], full: bool) -> Claim:
    from verification.runs.excite import as_psi, excite
    from verification.runs.simulate import simulate

    chain = vdp_chain(at)
    start = excite(chain, [1], at["displacement"])
    end = _END if full else _END / chain.eps
    level = max(1e-9, 0.5 * at["displacement"])
    run = simulate(
        chain if full else chain.averaged(),
        start,
        end,
        samples=2,
        level=level,
        tolerance=at["tolerance"],
    )
    assert run.error is not None
    return Claim(run.psi[-1], run.error, extra=as_psi(start))


def full_run(at: Mapping[str, float]) -> Claim:
    """State of (8) at t = 30 from one displaced site."""
    return _run(at, True)


def averaged_run(at: Mapping[str, float]) -> Claim:
    """State of (43) at T = 30 from one displaced site."""
    return _run(at, False)


def full_by_scipy(at: Mapping[str, float], claim: Claim) -> Check:
    """(8) by Radau where the damping is stiff, else by DOP853."""
    from scipy.integrate import solve_ivp

    from verification.steppers.stiff_stage import full_jacobian

    square = at["displacement"] ** 2
    chain = vdp_chain(at)
    rate = chain.eps * max(1.0, chain.a * square, chain.b * square**2, chain.c)
    stiff = rate > 30.0
    if stiff and rate * _END > 1e12:
        raise NoReferenceError("too stiff for scipy")

    def last(kept: int, tolerance: float) -> ComplexArray:
        part, start = replace(chain, sites=kept), claim.extra[:kept]
        state = as_state(start)
        options: Any = {"jac": lambda _, x: full_jacobian(part, x)} if stiff else {}
        run = solve_ivp(
            full_rate(part),
            (0.0, _END),
            state,
            method="Radau" if stiff else "DOP853",
            rtol=tolerance,
            atol=tolerance * max(1e-300, float(np.abs(state).max())),
            **options,
        )
        if not run.success:
            raise NoReferenceError(run.message)
        y, w = np.split(run.y[:, -1], 2)
        answer: ComplexArray = w + 1j * y
        return answer

    return _compared(claim, last, chain.sites, at["displacement"], "scipy")


def averaged_by_scipy(at: Mapping[str, float], claim: Claim) -> Check:
    """(43) in complex form by DOP853."""
    from scipy.integrate import solve_ivp

    chain = vdp_chain(at)
    square = at["displacement"] ** 2
    if max(chain.a * square, chain.b * square**2, chain.c) > 1e4:
        raise NoReferenceError("too stiff for DOP853")

    def last(kept: int, tolerance: float) -> ComplexArray:
        run = solve_ivp(
            averaged_rate(chain), (0.0, _END), claim.extra[:kept], method="DOP853", rtol=tolerance,
            atol=tolerance * abs(at["displacement"]),
        )  # fmt: skip
        if not run.success:
            raise NoReferenceError(run.message)
        answer: ComplexArray = run.y[:, -1]
        return answer

    return _compared(claim, last, chain.sites, at["displacement"], "scipy's DOP853")


def _followed(
    run: Callable[[int], npt.NDArray[Any]],
    at_rest: Callable[[npt.NDArray[Any]], bool],
    sites: int,
    first: int,
    most: int,
) -> tuple[int, npt.NDArray[Any]]:
    """Run a reference on more and more sites until its last ones stay at rest, or on all."""
    kept = min(sites, first)
    while True:
        answer = run(kept)
        if kept == sites or at_rest(answer):
            return kept, answer
        if kept == most:
            raise NoReferenceError("motion leaves the part that a slow reference follows")
        kept = min(sites, 2 * kept, most)


def _compared(
    claim: Claim,
    last: Callable[[int, float], ComplexArray],
    sites: int,
    displacement: float,
    by: str,
) -> Check:
    """Hold the claim against a reference on so many sites that its last ones stay at rest."""
    kept, answer = _followed(
        lambda kept: last(kept, _REFERENCE),
        lambda answer: float(np.abs(answer[-2:]).max()) <= _STILL * displacement,
        sites,
        _FIRST_COMPARED,
        _MOST_COMPARED,
    )
    distance = float(np.abs(claim.value[:kept] - answer).max())
    distance = max(distance, float(np.abs(claim.value[kept:]).max(initial=0.0)))
    uncertainty = float(np.abs(answer - last(kept, 30.0 * _REFERENCE)).max())
    return Check(distance, uncertainty + _ROUNDING * displacement, by)


def friction_state(at: Mapping[str, float]) -> Claim:
    """State of the friction chain at τ = 40, the first site displaced."""
    from verification.runs.excite import excite
    from verification.runs.simulate import simulate
    from verification.runs.trajectory import RunStatus

    chain = friction_chain(at)
    start = excite(chain, [1], at["displacement"])
    run = simulate(chain, start, _TAU, samples=2, tolerance=1e-10)
    assert run.error is not None
    if run.status is not RunStatus.RESOLVED:
        raise RunError("the run says that its companions see other events: rounding decides.")
    return Claim(run.y[-1], run.error, extra=start)


def friction_by_scipy(at: Mapping[str, float], claim: Claim) -> Check:
    """Locate every event on scipy's DOP853."""
    from verification.references.friction_events import run_events

    chain, rest = friction_chain(at), friction_chain(at).cell.steady_sliding
    if at["v0"] < 1e-3 or at["v_d"] < 1e-2:
        raise NoReferenceError("too many steps for scipy")

    def last(kept: int, tolerance: float, start: FloatArray) -> FloatArray:
        part = replace(chain, sites=kept)
        try:
            with np.errstate(all="ignore"):  # scipy tries steps that overflow
                run = run_events(
                    part, start[:, :kept], _TAU, times=np.array([_TAU]), tolerance=tolerance
                )
        except ArithmeticError as error:
            raise NoReferenceError(str(error)) from None
        answer: FloatArray = run.y[-1]
        return answer

    kept, answer = _followed(
        lambda kept: last(kept, 1e-13, claim.extra),
        lambda answer: bool(abs(answer[-1] - rest) <= _STILL * (at["displacement"] + rest)),
        chain.sites,
        _FIRST_STICKING,
        _MOST_STICKING,
    )
    distance = float(np.abs(claim.value[:kept] - answer).max())
    distance = max(distance, float(np.abs(claim.value[kept:] - rest).max(initial=0.0)))
    nearby = claim.extra.copy()
    nearby[0] *= 1.0 + _ROUNDED
    uncertainty = float(np.abs(answer - last(kept, 1e-12, nearby)).max())
    if uncertainty > _DECIDED * float(np.abs(answer).max()):
        raise NoReferenceError("rounding of the start decides what the reference finds")
    return Check(distance, uncertainty + 1e-12, "scipy's DOP853 with events")


_VDP = (
    Axis("a", 1e-2, 1e2),
    Axis("eta", 1e-12, 1.0, near=(0.125,)),
    Axis("c", 1e-8, 1e2),
    Axis("eps", 1e-6, 1.0),
    Axis("sites", 2, 1e5, whole=True),
    Axis("displacement", 1e-8, 1e3),
    Axis("tolerance", 1e-12, 1e-4),
)

_AVERAGED = tuple(replace(axis, low=1e-6) if axis.name == "eta" else axis for axis in _VDP)

_ENDS = "stronger couplings of 1e5 sites take minutes; a changes only the unit of y"

QUANTITIES = (
    Quantity(
        "run-vdp",
        "state of the chain (8) at t = 30 from one displaced site",
        _VDP,
        full_run,
        full_by_scipy,
        60.0,
        share=0.3,
        ends=_ENDS,
    ),
    Quantity(
        "run-envelope",
        "state of the averaged chain (43) at T = 30 from one displaced site",
        _AVERAGED,
        averaged_run,
        averaged_by_scipy,
        60.0,
        share=0.3,
        ends=_ENDS
        + "; at smaller eta the cycle attracts at a rate of 2/eta, and steps are explicit",
    ),
    Quantity(
        "run-friction",
        "state of the friction chain (5) at tau = 40 from one displaced site",
        (
            Axis("c", 1e-8, 1e1),
            Axis("v_d", 1e-2, 1e1),
            Axis("v0", 1e-3, 1e1),
            Axis("xi", 1e-6, 1.0),
            Axis("mu_st", 0.51, 1e1),
            Axis("sites", 1, 1e4, whole=True),
            Axis("displacement", 1e-8, 1e1),
        ),
        friction_state,
        friction_by_scipy,
        60.0,
        share=0.3,
        ends="faster belts, thinner friction curves and stronger springs take minutes, with as "
        "many events",
    ),
)
