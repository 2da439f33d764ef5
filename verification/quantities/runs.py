"""Trajectories of the chains (8) and (43).

Runs are compared at one short time, before chaos or a marginal event makes all methods differ.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache, partial

import numpy as np

from theory.arrays import ComplexArray
from theory.chains.vdp import VdpChain
from verification.quantities.chains import vdp_chain
from verification.quantities.quantity import (
    Axis,
    Computation,
    Quantity,
    ReferenceCheck,
    StatedValue,
    axes,
)
from verification.quantities.scipy_states import (
    TOLERANCE,
    at_all_sites,
    compared,
    moving_sites,
    precisely,
)
from verification.references import extrapolation
from verification.references.equations import (
    as_complex,
    as_state,
    averaged_rate,
    full_jacobian,
    full_rate,
)
from verification.references.extrapolation import PreciseState, extended, integrate
from verification.references.pace import NoReferenceError, last_state, paced
from verification.runs.excite import as_psi, excite
from verification.runs.simulate import simulate

_END = 30.0
_FIRST_PART, _MAX_PART = 30, 400
"""Number of sites, those that move, that a slow reference follows at first, and at most."""

REST = 1e-16
"""Fraction of the displacement below which a site is at rest."""

_STIFF = 30.0
"""Damping rate in t above which explicit integration needs too many steps."""


def _run(at: Mapping[str, float], full: bool) -> StatedValue:
    """Return the state of (8) at t = 30, or of (43) at T = 30, from one displaced site."""
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


def _full_precisely(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Compare with (8) in extended precision, or by scipy's Radau where the damping is stiff."""
    square = at["displacement"] ** 2
    chain = vdp_chain(at)
    rate = chain.eps * max(1.0, chain.b * square**2, chain.a * square)
    if rate > _STIFF:
        return _full_by_radau(chain, rate, stated)

    def precise(part: int, tolerance: float) -> PreciseState:
        start = extended(as_state(stated.extra[:part]))
        found = integrate(full_rate(replace(chain, sites=part)), start, _END, tolerance)
        return replace(found, value=as_complex(found.value))

    group = 0.5 * (math.sqrt(1.0 + 4.0 * chain.eps * chain.c) - 1.0)
    return _where_it_moves(stated, precise, group * _END)


def _full_by_radau(chain: VdpChain, rate: float, stated: StatedValue) -> ReferenceCheck:
    if rate * _END > 1e12:
        raise NoReferenceError("too stiff for scipy")
    size = float(np.abs(stated.extra).max())

    def last(part_sites: int, tolerance: float) -> ComplexArray:
        part, state = replace(chain, sites=part_sites), as_state(stated.extra[:part_sites])
        found = last_state(
            paced(full_rate(part), _END), _END, state, rtol=tolerance, atol=tolerance * size,
            method="Radau", jac=full_jacobian(part),
        )  # fmt: skip
        return as_complex(found)

    last, sites = cache(last), stated.value.size

    def at_rest(part: int) -> bool:
        return float(np.abs(last(part, TOLERANCE)[-2:]).max()) <= REST * size

    part = moving_sites(at_rest, sites, _FIRST_PART, _MAX_PART)
    return compared(
        stated.value, lambda each: at_all_sites(last(part, each), sites), "scipy's Radau"
    )


def _averaged_precisely(at: Mapping[str, float], stated: StatedValue) -> ReferenceCheck:
    """Compare with (43) in complex form, in extended precision."""
    chain = vdp_chain(at)

    def precise(part: int, tolerance: float) -> PreciseState:
        start = extended(stated.extra[:part])
        return integrate(averaged_rate(replace(chain, sites=part)), start, _END, tolerance)

    return _where_it_moves(stated, precise, chain.c * _END)


def _where_it_moves(
    stated: StatedValue, precise: Callable[[int, float], PreciseState], reach: float
) -> ReferenceCheck:
    """Compare with a run on enough sites that the last ones remain at rest.

    The run with the looser tolerance has more sites, so that the effect of the missing sites is
    part of the uncertainty.

    Parameters
    ----------
    stated : StatedValue
        States of all sites; ``extra`` contains the start.
    precise : callable
        Maps a number of sites and a tolerance to the state.
    reach : float
        Number of sites that linear waves have passed by the end.
    """
    sites, size, precise = stated.value.size, float(np.abs(stated.extra).max()), cache(precise)

    def at_rest(part: int) -> bool:
        return float(np.abs(precise(part, extrapolation.TOLERANCE).value[-2:]).max()) <= REST * size

    first = _FIRST_PART + 1.2 * reach
    if min(first, sites) > _MAX_PART:
        raise NoReferenceError("the motion leaves the sites that a reference in Python includes")
    part = moving_sites(at_rest, sites, round(first), _MAX_PART)
    tight = precise(part, extrapolation.TOLERANCE)
    looser = precise(min(sites, part + _FIRST_PART // 2), extrapolation.LOOSER)
    tight, looser = (replace(x, value=at_all_sites(x.value, sites)) for x in (tight, looser))
    return precisely(stated.value, tight.beside(looser))


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
                axes=_VDP, compute=partial(_run, full=True), check=_full_precisely,
                seconds=60.0, share=0.3, limits=_LIMITS,
            ),
            Computation(
                name="run-envelope",
                title="state of the averaged chain (43) at T = 30 from one displaced site",
                axes=_AVERAGED, compute=partial(_run, full=False), check=_averaged_precisely,
                seconds=60.0, share=0.3, limits=f"{_LIMITS}; at smaller eta the cycle attracts "
                "at a rate of 2/eta, and steps are explicit",
            ),
        ),
    ),
)  # fmt: skip
