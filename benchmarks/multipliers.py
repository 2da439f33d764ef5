"""Floquet multipliers of a breather of (8), Eqs. 39-42, at a given orbit.

The error is the largest over all multipliers, each with its partner in the reference. Ours is a
Taylor series of the flow and of all its derivatives at once. A user would take differences of
scipy's flow, or write the variational equations (42) down and hand them to ``solve_ivp``. Ours is
held against those variational equations at 1e-13, scipy's against ours with many steps;
``agreement`` is how far these two are apart.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial
from time import process_time
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from benchmarks.breather import chain_of
from benchmarks.quantity import Quantity, Tell
from benchmarks.record import Failure, Record, WorkPoint, stamped
from benchmarks.runner import Answer, Contender, Effort, measure_side_by_side
from benchmarks.vdp_peers import right_side
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from verification.breathers.floquet import floquet_multipliers
from verification.breathers.orbits import solve_orbit, steps_for
from verification.quantities.scenes import timed
from verification.steppers.variational import integrate_variations

if TYPE_CHECKING:
    from benchmarks.diagram import Style

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

TAYLOR, STATED = "Taylor series with variations", "Taylor series, error stated"
DIFFERENCES, EQUATIONS = "differences of scipy's flow", "scipy on the variational equations"


def measure(quick: bool, tell: Tell) -> Record:
    """Measure every method at every scene."""
    points: list[WorkPoint] = []
    failures: list[Failure] = []
    agreement = {}
    effort = Effort(0.1, 2, 21, 0.3, 20.0) if quick else Effort(1.0, 3, 51, 2.0, 60.0)
    for scene in timed("multipliers")[: 1 if quick else None]:
        name, chain = scene.name, chain_of(scene)
        tell(f"multipliers at the scene {name}")
        orbit = solve_orbit(chain, Nucleus(1))
        state, period = orbit.state, orbit.period
        ours = by_taylor(chain, state, period, 4 * steps_for(chain))
        theirs = by_equations(chain, state, period, 1e-13)
        agreement[name] = apart(ours, theirs)
        rows = [
            each
            for each in contenders(chain, state, period, ours, theirs)
            if each.quick or not quick
        ]
        done, failed = measure_side_by_side("multipliers", name, rows, effort, process_time)
        points += done
        failures += failed
    command = "fronts bench multipliers" + " --quick" * quick
    return stamped(command, agreement, points, failures)


def contenders(
    chain: VdpChain, state: FloatArray, period: float, ours: ComplexArray, theirs: ComplexArray
) -> Iterator[Contender]:
    """Yield every method at every setting."""

    def evaluate(method: partial[ComplexArray], true: ComplexArray) -> Answer:
        error = apart(method(), true)
        if not math.isfinite(error):
            raise ArithmeticError("the result is not finite")
        return Answer(error, None)

    for steps in sorted({5, 6, 8, 10, 12, 16, 24, steps_for(chain)}):
        found = partial(by_taylor, chain, state, period, steps)
        yield Contender(TAYLOR, f"{steps} steps", partial(evaluate, found, theirs), 0.0)
    for steps in (8, 16, steps_for(chain)):
        yield Contender(
            STATED, f"{steps} and {2 * steps} steps",
            partial(_stated, chain, state, period, steps, theirs), 0.0,
        )  # fmt: skip
    for k, h in ((4, 1e-2), (6, 1e-3), (9, 1e-4), (12, 1e-5)):
        found = partial(by_differences, chain, state, period, 10.0**-k, h)
        yield Contender(
            DIFFERENCES, f"tolerance 1e-{k}, h = {h:g}", partial(evaluate, found, ours), 0.0,
            peer=True,
        )  # fmt: skip
    for k in (3, 5, 7, 9, 11):
        found = partial(by_equations, chain, state, period, 10.0**-k)
        yield Contender(
            EQUATIONS, f"tolerance 1e-{k}", partial(evaluate, found, ours), 0.0, peer=True
        )


def by_taylor(chain: VdpChain, state: FloatArray, period: float, steps: int) -> ComplexArray:
    """Return the multipliers by our integrator."""
    flow = integrate_variations(chain, state, period, steps)
    return np.asarray(np.linalg.eigvals(flow.monodromy), dtype=complex)


def _stated(
    chain: VdpChain, state: FloatArray, period: float, steps: int, true: ComplexArray
) -> Answer:
    """Return the error with the claim of the matrix: its change when the steps are halved."""
    coarse, fine = (integrate_variations(chain, state, period, n) for n in (steps, 2 * steps))
    change = float(np.abs(fine.monodromy - coarse.monodromy).max())
    found = floquet_multipliers(fine.monodromy, period, chain.eps, 0, change)
    error = apart(np.asarray(found.values, dtype=complex), true)
    if not math.isfinite(error):
        raise ArithmeticError("the result is not finite")
    return Answer(error, found.error)


def by_differences(
    chain: VdpChain, state: FloatArray, period: float, tolerance: float, h: float
) -> ComplexArray:
    """Return the multipliers by central differences of ``solve_ivp``."""
    from scipy.integrate import solve_ivp

    rate = right_side(chain)

    def flow(start: FloatArray) -> FloatArray:
        run = solve_ivp(
            rate, (0.0, period), start, "DOP853", [period], rtol=tolerance, atol=tolerance
        )
        return np.asarray(run.y[:, -1])

    unit = h * np.eye(state.size)
    columns = [(flow(state + e) - flow(state - e)) / (2.0 * h) for e in unit]
    return np.asarray(np.linalg.eigvals(np.array(columns).T), dtype=complex)


def by_equations(
    chain: VdpChain, state: FloatArray, period: float, tolerance: float
) -> ComplexArray:
    """Return the multipliers by (42), written out here, and ``solve_ivp``."""
    from scipy.integrate import solve_ivp

    n, a, b, eps = chain.sites, chain.a, chain.b, chain.eps
    springs = 2.0 * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
    springs[0, 0] = springs[-1, -1] = 1.0
    pull = np.eye(n) + eps * chain.c * springs

    def rate(_: float, x: FloatArray) -> FloatArray:
        y, w = x[:n], x[n : 2 * n]
        d = x[2 * n :].reshape(2 * n, 2 * n)
        square = y * y
        damping = 1.0 - a * square + b * square * square
        bend = w * (4.0 * b * square * y - 2.0 * a * y)
        turned = -pull @ d[:n] - eps * (bend[:, None] * d[:n] + damping[:, None] * d[n:])
        return np.concatenate([w, -pull @ y - eps * w * damping, d[n:].ravel(), turned.ravel()])

    start = np.concatenate([state, np.eye(2 * n).ravel()])
    run = solve_ivp(rate, (0.0, period), start, "DOP853", [period], rtol=tolerance, atol=tolerance)
    if not run.success:
        raise ArithmeticError(run.message)
    monodromy = run.y[2 * n :, -1].reshape(2 * n, 2 * n)
    return np.asarray(np.linalg.eigvals(monodromy), dtype=complex)


def apart(found: ComplexArray, true: ComplexArray) -> float:
    """Return the largest distance between partners, paired so that the sum of all is least."""
    from scipy.optimize import linear_sum_assignment

    table = np.abs(found[:, None] - true[None, :])
    return float(table[linear_sum_assignment(table)].max())


def style() -> Style:
    """Return how the diagram is drawn."""
    from benchmarks.diagram import Style

    return Style(
        "largest error of a multiplier (right is better)",
        "processor seconds",
        "Error against run time of the Floquet multipliers at a given orbit.",
        {
            TAYLOR: ("blue", "o"),
            STATED: ("sky", "^"),
            DIFFERENCES: ("vermilion", "s"),
            EQUATIONS: ("orange", "v"),
        },
        1e-1,
        1e-15,
    )


def _first(method: str) -> object:
    """Return the multipliers of the cell's own cycle on a chain, which needs no orbit."""
    chain = chain_of(timed("multipliers")[0])
    state = np.zeros(2 * chain.sites)
    state[chain.sites] = chain.stable_amplitude
    if method == TAYLOR:
        return by_taylor(chain, state, 2.0 * math.pi, steps_for(chain))
    if method == DIFFERENCES:
        return by_differences(chain, state, 2.0 * math.pi, 1e-6, 1e-3)
    return by_equations(chain, state, 2.0 * math.pi, 1e-7)


BENCHMARK = Quantity(
    "multipliers",
    "Floquet multipliers of a breather, Eqs. 39-42",
    TAYLOR,
    (1e-10, 1e-3),
    measure,
    style,
    (STATED,),
    first={name: partial(_first, name) for name in (TAYLOR, DIFFERENCES, EQUATIONS)},
)
