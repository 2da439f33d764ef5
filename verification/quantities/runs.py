"""Trajectories of the chains (8) and (43).

Runs are compared at one short time, before chaos or a marginal event makes every method differ.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
import numpy.typing as npt

from verification.quantities.chains import vdp_chain
from verification.quantities.quantity import (
    Axis,
    Computation,
    NoReferenceError,
    Quantity,
    ReferenceCheck,
    StatedValue,
    axes,
)
from verification.quantities.scipy_states import (
    TOLERANCE,
    at_all_sites,
    compared,
    last_state,
    moving_sites,
)
from verification.references.equations import (
    as_complex,
    as_state,
    averaged_rate,
    full_jacobian,
    full_rate,
)

ComplexArray = npt.NDArray[np.complex128]

_END = 30.0
_FIRST_PART, _MAX_PART = 30, 400
"""Sites that a slow reference follows at first, and at most: those that move."""

REST = 1e-14
"""Share of the displacement below which a site is at rest."""

_ROUNDING = 1e-14
"""Share of the displacement that rounding may add to a reference."""


def _run(at: Mapping[str, float], full: bool) -> StatedValue:
    """Return the state of (8) at t = 30, or of (43) at T = 30, from one displaced site."""
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


def _full_by_scipy(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """(8) by Radau where the damping is stiff, else by DOP853."""
    square = at["displacement"] ** 2
    chain = vdp_chain(at)
    rate = chain.eps * max(1.0, chain.a * square, chain.b * square**2, chain.c)
    stiff = rate > 30.0
    if stiff and rate * _END > 1e12:
        raise NoReferenceError("too stiff for scipy")

    def last(part_sites: int, tolerance: float) -> ComplexArray:
        part, state = replace(chain, sites=part_sites), as_state(stated.extra[:part_sites])
        options: Any = {"method": "Radau", "jac": full_jacobian(part)} if stiff else {}
        atol = tolerance * max(1e-300, float(np.abs(state).max()))
        return as_complex(
            last_state(full_rate(part), _END, state, rtol=tolerance, atol=atol, **options)
        )

    return _where_it_moves(at, stated, last, "scipy")


def _averaged_by_scipy(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """(43) in complex form by DOP853."""
    chain = vdp_chain(at)
    square = at["displacement"] ** 2
    if max(chain.a * square, chain.b * square**2, chain.c) > 1e4:
        raise NoReferenceError("too stiff for DOP853")

    def last(part_sites: int, tolerance: float) -> ComplexArray:
        start, atol = stated.extra[:part_sites], tolerance * abs(at["displacement"])
        return last_state(averaged_rate(chain), _END, start, rtol=tolerance, atol=atol)

    return _where_it_moves(at, stated, last, "scipy's DOP853")


def _where_it_moves(
    at: Mapping[str, float],
    stated: StatedValue,
    last: Callable[[int, float], ComplexArray],
    by: str,
) -> ReferenceCheck:
    """Hold the stated against a reference on so many sites that its last ones stay at rest."""
    size, sites, last = at["displacement"], stated.value.size, cache(last)

    def at_rest(part: int) -> bool:
        return float(np.abs(last(part, TOLERANCE)[-2:]).max()) <= REST * size

    part = moving_sites(at_rest, sites, _FIRST_PART, _MAX_PART)
    return compared(
        stated.value,
        lambda tolerance: at_all_sites(last(part, tolerance), sites),
        by,
        _ROUNDING * size,
    )


_VDP = (
    *axes(a=(1e-2, 1e2)),
    Axis(name="eta", low=1e-12, high=1.0, near=(0.125,)),
    *axes(
        c=(1e-8, 1e2), eps=(1e-6, 1.0), sites=(2, 100_000), displacement=(1e-8, 1e3),
        tolerance=(1e-12, 1e-4),
    ),
)  # fmt: skip

_AVERAGED = tuple(replace(axis, low=1e-6) if axis.name == "eta" else axis for axis in _VDP)

_LIMITS = "stronger couplings of 1e5 sites take minutes; a changes only the unit of y"

QUANTITIES = (
    Quantity(
        name="chain", title="trajectory of the Van der Pol chain (8)", equation="(8), (43)",
        problems="chain", reference="scipy's DOP853 at 1e-13, beside our Taylor series at 1e-14",
        accuracy=1e-9, default="Runge-Kutta 8 (default)", useful=(1e-9, 1e-3),
        computations=(
            Computation(
                name="run-vdp", title="state of the chain (8) at t = 30 from one displaced site",
                axes=_VDP, compute=partial(_run, full=True), check=_full_by_scipy,
                seconds=60.0, share=0.3, limits=_LIMITS,
            ),
            Computation(
                name="run-envelope",
                title="state of the averaged chain (43) at T = 30 from one displaced site",
                axes=_AVERAGED, compute=partial(_run, full=False), check=_averaged_by_scipy,
                seconds=60.0, share=0.3, limits=f"{_LIMITS}; at smaller eta the cycle attracts "
                "at a rate of 2/eta, and steps are explicit",
            ),
        ),
    ),
)  # fmt: skip
