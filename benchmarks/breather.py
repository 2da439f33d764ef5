"""A breather of the chain (8): amplitudes and frequency, by a solver and by a long run.

One site is excited. The error is the largest of the errors of max |y_n| over the sites and of the
frequency. Our methods are Newton's method on the averaged chain, whose error is of order ε whatever
it costs, shooting with variational equations, and a long run. A user would otherwise choose scipy:
``root`` on the flow of ``solve_ivp``, started from the averaged breather, or ``solve_ivp`` for a
long time. Our methods are compared with scipy's shooting at 1e-13, and scipy's methods with our
shooting with twice the steps. ``agreement`` is the difference between these two references, below
1e-11. The error that shooting states is that of state and period; the error that
the long run states measures how far it has not yet settled. The averaged breather is exact for
another equation, and states no error with respect to (8).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
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
from theory.arrays import FloatArray
from theory.averaged.breather import BreatherStatus
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from verification.breathers.envelope import solve_envelope_breather
from verification.breathers.orbits import orbit_guess, solve_orbit, steps_for
from verification.breathers.run import run_breather
from verification.quantities.problems import Problem, timed
from verification.references.equations import full_rate

ENVELOPE, SHOOTING, RUN = "averaged chain", "shooting", "long run"
ROOT, LONG = "scipy root over solve_ivp", "scipy, long run"
_SAMPLES = 256


def prepare(problem: Problem, quick: bool, report: Report) -> Prepared:
    """Return the settings of all methods, compared with the two references."""
    chain = problem.vdp_chain()
    theirs = by_scipy(chain, 1e-11 if quick else 1e-13)
    ours = by_shooting(chain, 2 * steps_for(chain))
    apart = float(np.abs(theirs - ours).max())
    return Prepared(agreement=apart, settings=[*_ours(chain, theirs), *_peers(chain, ours)])


def _ours(chain: VdpChain, true: FloatArray) -> Iterator[Setting]:
    averaged = partial(_envelope, chain)
    yield Setting(method=ENVELOPE, knob="as it is", evaluate=averaged, reference=true)
    for steps in sorted({6, 8, 12, 16, 24, steps_for(chain)}):
        found = partial(_shooting, chain, steps)
        yield Setting(method=SHOOTING, knob=f"{steps} steps", evaluate=found, reference=true)
    for k in (2, 4, 6, 8):
        found = partial(_run, chain, 10.0**-k)
        yield Setting(method=RUN, knob=f"drift 1e-{k}", evaluate=found, reference=true)


def _peers(chain: VdpChain, true: FloatArray) -> Iterator[Setting]:
    for k in (4, 6, 8, 10):
        yield Setting(
            method=ROOT, knob=f"tolerance 1e-{k}", reference=true, quick=k < 9, peer=True,
            evaluate=partial(_root, chain, 10.0**-k),
        )  # fmt: skip
    for end, k in ((20.0, 4), (40.0, 6), (80.0, 8)):
        yield Setting(
            method=LONG, knob=f"slow time {end:g}, tolerance 1e-{k}", reference=true, quick=k < 5,
            peer=True, evaluate=partial(_long, chain, end, 10.0**-k),
        )  # fmt: skip


def by_shooting(chain: VdpChain, steps: int) -> FloatArray:
    """Return amplitudes and frequency of the orbit, shape (N + 1,)."""
    orbit = solve_orbit(chain, Nucleus(1), steps=steps)
    return np.append(orbit.amplitudes, 2.0 * math.pi / orbit.period)


def by_scipy(chain: VdpChain, tolerance: float) -> FloatArray:
    """Return the same as `by_shooting`, by ``scipy.optimize.root`` on the flow of ``solve_ivp``.

    Raises
    ------
    ArithmeticError
        If either of the two fails.
    """
    from scipy.integrate import solve_ivp
    from scipy.optimize import root

    rate = full_rate(chain)
    centre = Nucleus(1).centre(chain.sites)

    def flow(u: FloatArray, times: FloatArray | None = None) -> FloatArray:
        run = solve_ivp(rate, (0.0, u[-1]), u[:-1], "DOP853", times, rtol=tolerance, atol=tolerance)
        if not run.success:
            raise ArithmeticError(run.message)
        return np.asarray(run.y if times is not None else run.y[:, -1])

    def system(u: FloatArray) -> FloatArray:
        return np.append(flow(u) - u[:-1], u[centre])

    # The flow contracts by only a few per cent per period, so the step of the finite differences
    # must be far larger than the error of the flow.
    found = root(system, orbit_guess(chain, Nucleus(1)), tol=tolerance,
                 options={"eps": math.sqrt(tolerance)})  # fmt: skip
    if float(np.abs(found.fun).max()) > 1e3 * tolerance:
        raise ArithmeticError(f"root failed: {found.message}")
    times = np.arange(_SAMPLES) * (found.x[-1] / _SAMPLES)
    y = flow(found.x, np.append(times, found.x[-1]))[: chain.sites, :-1]
    return np.append(_peaks(y), 2.0 * math.pi / found.x[-1])


def _peaks(y: FloatArray) -> FloatArray:
    """Return max |y_n| from samples of one period, shape (N, samples), by trigonometric sums.

    Newton's method, started at the largest sample, finds the zero of the derivative.
    """
    size = y.shape[1]
    terms = np.fft.rfft(y, axis=1)[:, : size // 2] / size
    order = 1j * np.arange(terms.shape[1])
    phase = 2.0 * math.pi * np.abs(y).argmax(axis=1) / size

    def derivative(k: int) -> FloatArray:
        sums = terms * order**k * np.exp(order * phase[:, None])
        return np.asarray(2.0 * sums.sum(axis=1).real - (k == 0) * terms[:, 0].real)

    for _ in range(6):
        phase = phase - derivative(1) / derivative(2)
    return np.abs(derivative(0))


def _envelope(chain: VdpChain) -> MethodAnswer:
    found = solve_envelope_breather(chain, Nucleus(1))
    return MethodAnswer(value=np.append(found.amplitudes, 1.0 + chain.eps * found.unknowns[-1]))


def _shooting(chain: VdpChain, steps: int) -> MethodAnswer:
    orbit = solve_orbit(chain, Nucleus(1), steps=steps)
    return MethodAnswer(
        value=np.append(orbit.amplitudes, 2.0 * math.pi / orbit.period), claimed=orbit.error
    )


def _run(chain: VdpChain, tolerance: float) -> MethodAnswer:
    run = run_breather(chain, Nucleus(1), tolerance=tolerance)
    if run.status is not BreatherStatus.SETTLED or run.frequency is None:
        raise ArithmeticError(f"the run is {run.status.value}")
    return MethodAnswer(value=np.append(run.amplitudes, run.frequency), claimed=run.error)


def _root(chain: VdpChain, tolerance: float) -> MethodAnswer:
    return MethodAnswer(value=by_scipy(chain, tolerance))


def _long(chain: VdpChain, end: float, tolerance: float) -> MethodAnswer:
    """Run to slow time ``end``, then measure one period between two upward zero crossings."""
    from scipy.integrate import solve_ivp

    rate = full_rate(chain)
    centre = Nucleus(1).centre(chain.sites)

    start = np.zeros(2 * chain.sites)
    start[chain.sites + centre] = chain.stable_amplitude
    settled = solve_ivp(
        rate, (0.0, end / chain.eps), start, "DOP853", [end / chain.eps],
        rtol=tolerance, atol=tolerance,
    )  # fmt: skip
    run = solve_ivp(
        rate, (0.0, 16.0), settled.y[:, -1], "DOP853", np.linspace(0.0, 16.0, 4096),
        events=_Rising(centre), rtol=tolerance, atol=tolerance,
    )  # fmt: skip
    if run.t_events is None:
        raise ArithmeticError("no period was found")
    zeros = run.t_events[0]
    period = float(zeros[1] - zeros[0])
    y = run.y[: chain.sites, run.t <= period]
    return MethodAnswer(value=np.append(np.abs(y).max(axis=1), 2.0 * math.pi / period))


@dataclass(frozen=True)
class _Rising:
    """An event of ``solve_ivp``: y of a site crosses zero upwards."""

    site: int
    direction: float = 1.0

    def __call__(self, _: float, x: FloatArray) -> float:
        return float(x[self.site])


def _first(method: str) -> object:
    """Return a breather of the first test problem, without comparing it."""
    chain = timed("breather")[0].vdp_chain()
    return by_scipy(chain, 1e-6) if method == ROOT else by_shooting(chain, steps_for(chain))


BENCHMARK = WorkPrecision(
    name="breather",
    prepare=prepare,
    effort=Effort(max_repeats=21),
    quick_effort=Effort(seconds=0.1, min_repeats=1, max_repeats=5, once_from=0.3, limit=20.0),
    style=Style(
        xlabel="largest error (right is better)",
        ylabel="processor seconds per breather",
        caption="Error against run time of a breather of (8), seven sites. The averaged chain is "
        "solved exactly; it differs from (8) by a term of order ε.",
        methods={
            ENVELOPE: ("green", "^"),
            SHOOTING: ("blue", "o"),
            RUN: ("sky", "v"),
            ROOT: ("vermilion", "s"),
            LONG: ("orange", "X"),
        },
        garbage=1.0,
        floor=1e-15,
    ),
    others={ENVELOPE: "the averaged chain (43), whose breather differs by a term of order eps"},
    first={name: partial(_first, name) for name in (SHOOTING, ROOT)},
)
