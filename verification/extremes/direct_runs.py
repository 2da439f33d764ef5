"""Runs of the chains (8), (43) and (5), in the stability table.

Runs are compared at one short time, before chaos or a marginal event makes every method differ.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from theory.friction_cell import FrictionCell
from theory.friction_chain import FrictionChain
from theory.vdp_chain import VdpChain
from verification.extremes.quantity import Axis, Check, Claim, NoReferenceError, Quantity

ComplexArray = npt.NDArray[np.complex128]

_END, _TAU = 30.0, 40.0
_REFERENCE = 1e-12
_MOST_COMPARED = 30
"""Sites of the longest run that a slow reference follows; the others are at rest by then."""


def _chain(at: Mapping[str, float]) -> VdpChain:
    return VdpChain(at["a"], at["eta"] * at["a"] ** 2, at["c"], at["eps"], int(at["sites"]))


def _run(at: Mapping[str, float], full: bool) -> Claim:
    from verification.vdp.run import Model, run_vdp
    from verification.vdp.start import displaced

    chain = _chain(at)
    start = displaced(chain, [1], at["displacement"])
    end = _END if full else _END / chain.eps
    level = max(1e-9, 0.5 * at["displacement"])
    run = run_vdp(
        chain, start, end, model=Model.FULL if full else Model.ENVELOPE, samples=2, level=level,
        tolerance=at["tolerance"],
    )  # fmt: skip
    assert run.error is not None
    size = max(1.0, float(np.abs(start).max()))
    return Claim(run.psi[-1], run.error + 1e-15 * size * max(run.steps, 10), extra=start)


def full_run(at: Mapping[str, float]) -> Claim:
    """State of (8) at t = 30 from one displaced site."""
    return _run(at, True)


def averaged_run(at: Mapping[str, float]) -> Claim:
    """State of (43) at T = 30 from one displaced site."""
    return _run(at, False)


def full_by_scipy(at: Mapping[str, float], claim: Claim) -> Check:
    """(8) by Radau where the damping is stiff, else by DOP853."""
    from scipy.integrate import solve_ivp

    from verification.vdp.stiff_stage import full_jacobian, full_right_side

    kept = min(int(at["sites"]), _MOST_COMPARED)
    chain = replace(_chain(at), sites=kept)
    start = claim.extra[:kept]
    state = np.concatenate([start.imag, start.real])
    square = at["displacement"] ** 2
    rate = chain.eps * max(1.0, chain.a * square, chain.b * square**2, chain.c)
    stiff = rate > 30.0
    if stiff and rate * _END > 1e12:
        raise NoReferenceError("too stiff for scipy")
    options: Any = {"jac": lambda _, x: full_jacobian(chain, x)} if stiff else {}
    answers = []
    for tolerance in (_REFERENCE, 30.0 * _REFERENCE):
        run = solve_ivp(
            lambda _, x: full_right_side(chain, x),
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
        answers.append(w + 1j * y)
    return _compared(claim.value, answers, kept, "scipy")


def averaged_by_scipy(at: Mapping[str, float], claim: Claim) -> Check:
    """(43) in complex form by DOP853."""
    from scipy.integrate import solve_ivp

    chain = _chain(at)
    kept = min(chain.sites, _MOST_COMPARED)
    if chain.c * _END > kept / 2 and chain.sites > kept:
        raise NoReferenceError("waves leave the part that is compared")
    a, b, c = chain.a, chain.b, chain.c
    if max(a * at["displacement"] ** 2, b * at["displacement"] ** 4, c) > 1e4:
        raise NoReferenceError("too stiff for DOP853")

    def rate(_: float, phi: ComplexArray) -> ComplexArray:
        pull = -np.diff(phi, prepend=phi[:1], append=phi[-1:], n=2)
        s = np.abs(phi) ** 2
        out: ComplexArray = 0.5j * c * pull - 0.5 * phi * (1 - a * s / 4 + b * s**2 / 8)
        return out

    answers = []
    for tolerance in (_REFERENCE, 30.0 * _REFERENCE):
        run = solve_ivp(
            rate, (0.0, _END), claim.extra[:kept], method="DOP853", rtol=tolerance,
            atol=tolerance * at["displacement"],
        )  # fmt: skip
        if not run.success:
            raise NoReferenceError(run.message)
        answers.append(run.y[:, -1])
    return _compared(claim.value, answers, kept, "scipy's DOP853")


def _compared(value: ComplexArray, answers: list[ComplexArray], kept: int, by: str) -> Check:
    distance = float(np.abs(value[:kept] - answers[0]).max())
    uncertainty = float(np.abs(answers[0] - answers[1]).max())
    return Check(distance, uncertainty + 1e-14, by)


def _friction(at: Mapping[str, float]) -> FrictionChain:
    cell = FrictionCell(at["v_d"], at["mu_st"], 0.5, at["v0"], at["xi"])
    return FrictionChain(at["c"], cell, int(at["sites"]))


def friction_state(at: Mapping[str, float]) -> Claim:
    """State of the friction chain at τ = 40, the first site displaced."""
    from verification.friction.run import RunStatus, run_friction
    from verification.friction.start import nucleus

    chain = _friction(at)
    start = nucleus(chain, [1], at["displacement"])
    run = run_friction(chain, start, _TAU, samples=2, tolerance=1e-10)
    assert run.error is not None
    if run.status is not RunStatus.RESOLVED:
        raise ArithmeticError("the run says that its events differ from those of its companion.")
    return Claim(run.y[-1], run.error + 1e-12, extra=start)


def friction_by_scipy(at: Mapping[str, float], claim: Claim) -> Check:
    """Locate every event on scipy's DOP853."""
    from verification.friction.events import run_events

    kept = min(int(at["sites"]), 6)
    if int(at["sites"]) > kept and at["c"] > 1e-3:
        raise NoReferenceError("motion leaves the part that is compared")
    if at["v0"] < 1e-3 or at["v_d"] < 1e-2:
        raise NoReferenceError("too many steps for scipy")
    chain = replace(_friction(at), sites=kept)
    try:
        run = run_events(chain, claim.extra[:, :kept], _TAU, times=np.array([_TAU]))
    except ArithmeticError as error:
        raise NoReferenceError(str(error)) from None
    distance = float(np.abs(claim.value[:kept] - run.y[-1]).max())
    return Check(distance, 1e-10, "scipy's DOP853 with events")


_VDP = (
    Axis("a", 1e-2, 1e2),
    Axis("eta", 1e-4, 0.2, near=(0.125,)),
    Axis("c", 1e-8, 1e2),
    Axis("eps", 1e-6, 1.0),
    Axis("sites", 2, 1e5, whole=True),
    Axis("displacement", 1e-8, 1e3),
    Axis("tolerance", 1e-12, 1e-4),
)

QUANTITIES = (
    Quantity(
        "run-vdp",
        "state of the chain (8) at t = 30 from one displaced site",
        _VDP,
        full_run,
        full_by_scipy,
        30.0,
        share=1.0,
    ),
    Quantity(
        "run-envelope",
        "state of the averaged chain (43) at T = 30 from one displaced site",
        _VDP,
        averaged_run,
        averaged_by_scipy,
        30.0,
        share=1.0,
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
        share=1.0,
    ),
)
