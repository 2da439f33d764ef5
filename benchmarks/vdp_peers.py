"""The chain (8) as a user of scipy, jitcode or heyoka would integrate it; compile time apart.

State (y, ẏ), free ends. Each builder returns a function from a tolerance to the final state.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from theory.chains.vdp import VdpChain

FloatArray = npt.NDArray[np.float64]
Solve = Callable[[float], FloatArray]
ScipyMethod = Literal["DOP853", "LSODA"]

SCIPY: tuple[ScipyMethod, ...] = ("DOP853", "LSODA")


def right_side(chain: VdpChain) -> Callable[[float, FloatArray], FloatArray]:
    """Return the right side of (8) in numpy."""
    n, a, b, c, eps = chain.sites, chain.a, chain.b, chain.c, chain.eps

    def rate(_: float, x: FloatArray) -> FloatArray:
        y, w = x[:n], x[n:]
        pull = np.empty(n)
        pull[1:-1] = 2.0 * y[1:-1] - y[2:] - y[:-2]
        pull[0], pull[-1] = y[0] - y[1], y[-1] - y[-2]
        square = y * y
        return np.concatenate(
            [w, -y - eps * (c * pull + w * (1.0 - a * square + b * square * square))]
        )

    return rate


def scipy_solver(chain: VdpChain, start: FloatArray, end: float, method: ScipyMethod) -> Solve:
    """Return ``solve_ivp`` with one of its methods."""
    from scipy.integrate import solve_ivp

    rate = right_side(chain)

    def solve(tolerance: float) -> FloatArray:
        run = solve_ivp(
            rate, (0.0, end), start, method=method, rtol=tolerance, atol=tolerance, t_eval=[end]
        )
        if not run.success:
            raise ArithmeticError(run.message)
        return np.asarray(run.y[:, -1])

    return solve


def jitcode_solver(chain: VdpChain, start: FloatArray, end: float, method: str) -> Solve:
    """Return jitcode's integrator, compiled."""
    from jitcode import jitcode
    from jitcode import y as state

    n = chain.sites
    terms: list[Any] = [state(n + i) for i in range(n)]
    for i in range(n):
        pull = sum(state(i) - state(j) for j in (i - 1, i + 1) if 0 <= j < n)
        damping = 1 - chain.a * state(i) ** 2 + chain.b * state(i) ** 4
        terms.append(-state(i) - chain.eps * (chain.c * pull + state(n + i) * damping))
    ode = jitcode(terms, verbose=False)
    ode.compile_C()

    def solve(tolerance: float) -> FloatArray:
        ode.set_integrator(method, rtol=tolerance, atol=tolerance, nsteps=10**8)
        ode.set_initial_value(start.copy(), 0.0)
        return np.asarray(ode.integrate(end))

    return solve


def heyoka_solver(chain: VdpChain, start: FloatArray, end: float, tolerance: float) -> Solve:
    """Return heyoka's Taylor integrator at one tolerance, compiled."""
    import heyoka

    n = chain.sites
    y = heyoka.make_vars(*[f"y{i}" for i in range(n)])
    w = heyoka.make_vars(*[f"w{i}" for i in range(n)])
    system = [(y[i], w[i]) for i in range(n)]
    for i in range(n):
        square = y[i] ** 2
        force = -y[i] - chain.eps * w[i] * (1.0 - chain.a * square + chain.b * square * square)
        for j in (i - 1, i + 1):
            if 0 <= j < n:
                force = force - chain.eps * chain.c * (y[i] - y[j])
        system.append((w[i], force))
    # The whole step unrolled: slower to compile than compact mode, and twice as fast.
    run = heyoka.taylor_adaptive(system, start.copy(), tol=tolerance)

    def solve(_: float) -> FloatArray:
        run.time = 0.0
        run.state[:] = start
        run.propagate_until(end)
        return np.array(run.state)

    return solve
