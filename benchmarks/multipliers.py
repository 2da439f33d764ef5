"""Floquet multipliers of a breather of (8), Eqs. 39-42, at a given orbit.

The error is the largest over all multipliers, each compared with its partner in the reference. Our
method is a Taylor series of the flow and of all its derivatives at once. A user would otherwise
take finite differences of scipy's flow, or pass the variational equations (42) to ``solve_ivp``.
Our method is compared with those variational equations at 1e-13, and scipy's methods with ours with
many steps; ``agreement`` is the difference of these two references.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import numpy as np

from benchmarks.work_precision import (
    Effort,
    MethodAnswer,
    Prepared,
    Report,
    Setting,
    Style,
    WorkPrecision,
)
from theory.arrays import ComplexArray, FloatArray
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from verification.breathers.floquet import floquet_multipliers
from verification.breathers.orbits import solve_orbit, steps_for
from verification.quantities.problems import Problem, timed
from verification.references.equations import full_rate, variational_rate
from verification.references.pace import last_state
from verification.steppers.variational import integrate_variations

TAYLOR, STATED = "Taylor series with variations", "Taylor series, error stated"
DIFFERENCES, EQUATIONS = "differences of scipy's flow", "scipy on the variational equations"


def prepare(problem: Problem, quick: bool, report: Report) -> Prepared:
    """Return the settings of all methods at the problem's orbit, with the references' agreement."""
    chain = problem.vdp_chain()
    orbit = solve_orbit(chain, Nucleus(1))
    here = (chain, orbit.state, orbit.period)
    ours = by_taylor(*here, 4 * steps_for(chain)).value
    theirs = by_equations(*here, 1e-13).value
    settings = [*_ours(*here, theirs), *_peers(*here, ours)]
    return Prepared(agreement=largest_distance(ours, theirs), settings=settings)


def _ours(
    chain: VdpChain, state: FloatArray, period: float, true: ComplexArray
) -> Iterator[Setting]:
    needed = steps_for(chain)
    for steps in sorted({5, 6, 8, 10, 12, 16, 24, needed}):
        found = partial(by_taylor, chain, state, period, steps)
        yield Setting(method=TAYLOR, knob=f"{steps} steps", evaluate=found, reference=true)
    for steps in (8, 16, needed):
        found = partial(_stated, chain, state, period, steps)
        knob = f"{steps} and {2 * steps} steps"
        yield Setting(method=STATED, knob=knob, evaluate=found, reference=true)


def _peers(
    chain: VdpChain, state: FloatArray, period: float, true: ComplexArray
) -> Iterator[Setting]:
    for k, h in ((4, 1e-2), (6, 1e-3), (9, 1e-4), (12, 1e-5)):
        yield Setting(
            method=DIFFERENCES, knob=f"tolerance 1e-{k}, h = {h:g}", reference=true, peer=True,
            evaluate=partial(by_differences, chain, state, period, 10.0**-k, h),
        )  # fmt: skip
    for k in (3, 5, 7, 9, 11):
        yield Setting(
            method=EQUATIONS, knob=f"tolerance 1e-{k}", reference=true, peer=True,
            evaluate=partial(by_equations, chain, state, period, 10.0**-k),
        )  # fmt: skip


def by_taylor(chain: VdpChain, state: FloatArray, period: float, steps: int) -> MethodAnswer:
    """Return the multipliers by our integrator."""
    return _multipliers(integrate_variations(chain, state, period, steps).monodromy)


def _multipliers(monodromy: FloatArray) -> MethodAnswer:
    return MethodAnswer(value=np.asarray(np.linalg.eigvals(monodromy), dtype=complex))


def _stated(chain: VdpChain, state: FloatArray, period: float, steps: int) -> MethodAnswer:
    """Return them with the error stated for the matrix: its change when the steps are halved."""
    coarse, fine = (integrate_variations(chain, state, period, n) for n in (steps, 2 * steps))
    change = float(np.abs(fine.monodromy - coarse.monodromy).max())
    found = floquet_multipliers(fine.monodromy, period, chain.eps, parity=0, error=change)
    return MethodAnswer(value=np.asarray(found.values, dtype=complex), claimed=found.error)


def by_differences(
    chain: VdpChain, state: FloatArray, period: float, tolerance: float, h: float
) -> MethodAnswer:
    """Return the multipliers by central differences of ``solve_ivp``."""
    rate = full_rate(chain)

    def flow(start: FloatArray) -> FloatArray:
        return last_state(rate, period, start, tolerance, tolerance, t_eval=[period])

    unit = h * np.eye(state.size)
    columns = [(flow(state + e) - flow(state - e)) / (2.0 * h) for e in unit]
    return _multipliers(np.array(columns).T)


def by_equations(
    chain: VdpChain, state: FloatArray, period: float, tolerance: float
) -> MethodAnswer:
    """Return the multipliers by the variational equations (42) and ``solve_ivp``."""
    size = state.size
    start = np.column_stack([state, np.eye(size)]).ravel()
    rate = variational_rate(chain)
    end = last_state(rate, period, start, tolerance, tolerance, t_eval=[period])
    return _multipliers(end.reshape(size, size + 1)[:, 1:])


def largest_distance(found: ComplexArray, true: ComplexArray) -> float:
    """Return the largest distance between partners, paired for the least total distance."""
    from scipy.optimize import linear_sum_assignment

    table = np.abs(found[:, None] - true[None, :])
    if not np.isfinite(table).all():
        raise ArithmeticError("the result is not finite")
    return float(table[linear_sum_assignment(table)].max())


def _first(method: str) -> object:
    """Return the multipliers of the cell's own cycle on a chain, which needs no orbit."""
    chain = timed("multipliers")[0].vdp_chain()
    state = np.zeros(2 * chain.sites)
    state[chain.sites] = chain.stable_amplitude
    here = (chain, state, 2.0 * math.pi)
    if method == TAYLOR:
        return by_taylor(*here, steps_for(chain))
    return by_differences(*here, 1e-6, 1e-3) if method == DIFFERENCES else by_equations(*here, 1e-7)


BENCHMARK = WorkPrecision(
    name="multipliers",
    prepare=prepare,
    error=largest_distance,
    quick_effort=Effort(seconds=0.1, min_repeats=2, max_repeats=21, once_from=0.3, limit=20.0),
    style=Style(
        xlabel="largest error of a multiplier (right is better)",
        ylabel="processor seconds",
        caption="Error against run time of the Floquet multipliers at a given orbit.",
        methods={
            TAYLOR: ("blue", "o"),
            STATED: ("sky", "^"),
            DIFFERENCES: ("vermilion", "s"),
            EQUATIONS: ("orange", "v"),
        },
        garbage=1e-1,
        floor=1e-15,
    ),
    variants=(STATED,),
    first={name: partial(_first, name) for name in (TAYLOR, DIFFERENCES, EQUATIONS)},
)
