"""Trajectories of the chains (8) and (43).

Runs are compared at one short time, before chaos or a marginal event makes every method differ.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt

from verification.quantities.chains import vdp_chain
from verification.quantities.own_chains import RUN_OF_OWN_CHAIN
from verification.quantities.quantity import (
    Axis,
    Computation,
    NoReferenceError,
    Quantity,
    ReferenceCheck,
    StatedValue,
)
from verification.references.equations import (
    as_complex,
    as_state,
    averaged_rate,
    full_jacobian,
    full_rate,
)

ComplexArray = npt.NDArray[np.complex128]
FloatArray = npt.NDArray[np.float64]

_END = 30.0
_REFERENCE = 1e-12
_FIRST_PART, _MAX_PART = 30, 400
"""Sites that a slow reference follows at first, and at most: those that move."""

REST = 1e-14
"""Share of the displacement below which a site is at rest."""

_ROUNDING = 1e-14
"""Share of the displacement that rounding may add to a reference."""


def _run(at: Mapping[str, float], full: bool) -> StatedValue:
    from verification.runs.excite import as_psi, excite
    from verification.runs.simulate import simulate

    chain = vdp_chain(at)
    start = excite(chain, [1], at["displacement"])
    end = _END if full else _END / chain.eps
    level = max(1e-9, 0.5 * at["displacement"])
    run = simulate(
        chain if full else chain.averaged(), start, end, samples=2, level=level,
        tolerance=at["tolerance"],
    )  # fmt: skip
    assert run.error is not None
    return StatedValue(value=run.psi[-1], error=run.error, extra=as_psi(start))


def full_run(at: Mapping[str, float]) -> StatedValue:
    """State of (8) at t = 30 from one displaced site."""
    return _run(at, True)


def averaged_run(at: Mapping[str, float]) -> StatedValue:
    """State of (43) at T = 30 from one displaced site."""
    return _run(at, False)


def full_by_scipy(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """(8) by Radau where the damping is stiff, else by DOP853."""
    from scipy.integrate import solve_ivp

    square = at["displacement"] ** 2
    chain = vdp_chain(at)
    rate = chain.eps * max(1.0, chain.a * square, chain.b * square**2, chain.c)
    stiff = rate > 30.0
    if stiff and rate * _END > 1e12:
        raise NoReferenceError("too stiff for scipy")

    def last(part_sites: int, tolerance: float) -> ComplexArray:
        part, start = replace(chain, sites=part_sites), stated.extra[:part_sites]
        state = as_state(start)
        options: Any = {"jac": full_jacobian(part)} if stiff else {}
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
        return as_complex(run.y[:, -1])

    return _compared(stated, last, chain.sites, at["displacement"], "scipy")


def averaged_by_scipy(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """(43) in complex form by DOP853."""
    from scipy.integrate import solve_ivp

    chain = vdp_chain(at)
    square = at["displacement"] ** 2
    if max(chain.a * square, chain.b * square**2, chain.c) > 1e4:
        raise NoReferenceError("too stiff for DOP853")

    def last(part_sites: int, tolerance: float) -> ComplexArray:
        run = solve_ivp(
            averaged_rate(chain), (0.0, _END), stated.extra[:part_sites], method="DOP853",
            rtol=tolerance, atol=tolerance * abs(at["displacement"]),
        )  # fmt: skip
        if not run.success:
            raise NoReferenceError(run.message)
        answer: ComplexArray = run.y[:, -1]
        return answer

    return _compared(stated, last, chain.sites, at["displacement"], "scipy's DOP853")


def on_growing_part(
    run: Callable[[int], npt.NDArray[Any]],
    at_rest: Callable[[npt.NDArray[Any]], bool],
    sites: int,
    first: int,
    most: int,
) -> tuple[int, npt.NDArray[Any]]:
    """Run a reference on more and more sites until its last ones stay at rest, or on all."""
    part_sites = min(sites, first)
    while True:
        answer = run(part_sites)
        if part_sites == sites or at_rest(answer):
            return part_sites, answer
        if part_sites == most:
            raise NoReferenceError("motion leaves the part that a slow reference follows")
        part_sites = min(sites, 2 * part_sites, most)


def _compared(
    stated: StatedValue,
    last: Callable[[int, float], ComplexArray],
    sites: int,
    displacement: float,
    by: str,
) -> ReferenceCheck:
    """Hold the stated against a reference on so many sites that its last ones stay at rest."""
    part_sites, answer = on_growing_part(
        lambda part_sites: last(part_sites, _REFERENCE),
        lambda answer: float(np.abs(answer[-2:]).max()) <= REST * displacement,
        sites,
        _FIRST_PART,
        _MAX_PART,
    )
    distance = float(np.abs(stated.value[:part_sites] - answer).max())
    distance = max(distance, float(np.abs(stated.value[part_sites:]).max(initial=0.0)))
    uncertainty = float(np.abs(answer - last(part_sites, 30.0 * _REFERENCE)).max())
    return ReferenceCheck(
        distance=distance, uncertainty=uncertainty + _ROUNDING * displacement, method=by
    )


_VDP = (
    Axis(name="a", low=1e-2, high=1e2),
    Axis(name="eta", low=1e-12, high=1.0, near=(0.125,)),
    Axis(name="c", low=1e-8, high=1e2),
    Axis(name="eps", low=1e-6, high=1.0),
    Axis(name="sites", low=2, high=1e5, whole=True),
    Axis(name="displacement", low=1e-8, high=1e3),
    Axis(name="tolerance", low=1e-12, high=1e-4),
)

_AVERAGED = tuple(replace(axis, low=1e-6) if axis.name == "eta" else axis for axis in _VDP)

_LIMITS = "stronger couplings of 1e5 sites take minutes; a changes only the unit of y"

QUANTITIES = (
    Quantity(
        name="chain",
        title="trajectory of the Van der Pol chain (8)",
        equation="(8), (43)",
        problems="chain",
        reference="scipy's DOP853 at 1e-13, beside our Taylor series at 1e-14",
        accuracy=1e-9,
        default="Runge-Kutta 8 (default)",
        useful=(1e-9, 1e-3),
        computations=(
            RUN_OF_OWN_CHAIN,
            Computation(
                name="run-vdp",
                title="state of the chain (8) at t = 30 from one displaced site",
                axes=_VDP,
                compute=full_run,
                check=full_by_scipy,
                seconds=60.0,
                share=0.3,
                limits=_LIMITS,
            ),
            Computation(
                name="run-envelope",
                title="state of the averaged chain (43) at T = 30 from one displaced site",
                axes=_AVERAGED,
                compute=averaged_run,
                check=averaged_by_scipy,
                seconds=60.0,
                share=0.3,
                limits=_LIMITS
                + "; at smaller eta the cycle attracts at a rate of 2/eta, and steps are explicit",
            ),
        ),
    ),
)
