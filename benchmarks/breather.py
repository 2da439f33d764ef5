"""A breather of the chain (8): amplitudes and frequency, by solving for it and by waiting for it.

One site excited. The error is the largest of max |y_n| over the sites and of the frequency.
Ours are Newton's method on the averaged chain, whose error is of order ε whatever it costs,
shooting with variational equations, and a long run. A user would pick scipy: ``root`` on the flow
of ``solve_ivp``, started from the averaged breather, or ``solve_ivp`` for a long time. Ours are
held against scipy's shooting at 1e-13, scipy's against our shooting with twice the steps;
``agreement`` is how far these two are apart: some 1e-9, because ours reads the largest displacement
off a parabola through three samples; states and periods agree to 1e-12. What shooting claims is of
state and period, what the long run claims is of what has not settled yet. The averaged breather is
exact for another equation, and claims nothing about (8).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from time import process_time
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from benchmarks.quantity import Quantity, Tell
from benchmarks.record import Failure, Record, WorkPoint, stamped
from benchmarks.runner import Answer, Contender, Effort, measure_side_by_side
from benchmarks.vdp_peers import right_side
from theory.averaged.breather import BreatherStatus
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from verification.breathers.envelope import solve_envelope_breather
from verification.breathers.orbits import orbit_guess, solve_orbit, steps_for
from verification.breathers.run import run_breather
from verification.quantities.scenes import Scene, damping, timed

if TYPE_CHECKING:
    from benchmarks.diagram import Style

FloatArray = npt.NDArray[np.float64]

ENVELOPE, SHOOTING, RUN = "averaged chain", "shooting", "long run"
ROOT, LONG = "scipy root over solve_ivp", "scipy, long run"
_SAMPLES = 256


def measure(quick: bool, tell: Tell) -> Record:
    """Measure every method at every scene."""
    points: list[WorkPoint] = []
    failures: list[Failure] = []
    agreement = {}
    effort = Effort(0.1, 1, 5, 0.3, 20.0) if quick else Effort(1.0, 3, 21, 2.0, 60.0)
    for scene in timed("breather")[: 1 if quick else None]:
        name, chain = scene.name, chain_of(scene)
        tell(f"breather at the scene {name}: the references")
        theirs = by_scipy(chain, 1e-11 if quick else 1e-13)
        ours = by_shooting(chain, 2 * steps_for(chain))
        agreement[name] = float(np.abs(theirs - ours).max())
        rows = [each for each in contenders(chain, ours, theirs) if each.quick or not quick]
        tell(f"breather at the scene {name}: {len(rows)} settings")
        done, failed = measure_side_by_side("breather", name, rows, effort, process_time)
        points += done
        failures += failed
    command = "fronts bench breather" + " --quick" * quick
    return stamped(command, agreement, points, failures)


def chain_of(scene: Scene) -> VdpChain:
    """Return the chain of a scene."""
    a, b, c, eps = damping(scene.values)
    return VdpChain(a=a, b=b, c=c, eps=eps, sites=int(scene.values["sites"]))


def contenders(chain: VdpChain, ours: FloatArray, theirs: FloatArray) -> Iterator[Contender]:
    """Yield every method at every setting."""
    yield Contender(ENVELOPE, "as it is", partial(_envelope, chain, theirs), 0.0)
    for steps in sorted({6, 8, 12, 16, 24, steps_for(chain)}):
        yield Contender(SHOOTING, f"{steps} steps", partial(_shooting, chain, theirs, steps), 0.0)
    for k in (2, 4, 6, 8):
        yield Contender(RUN, f"drift 1e-{k}", partial(_run, chain, theirs, 10.0**-k), 0.0)
    for k in (4, 6, 8, 10):
        yield Contender(
            ROOT, f"tolerance 1e-{k}", partial(_root, chain, ours, 10.0**-k), 0.0,
            quick=k < 9, peer=True,
        )  # fmt: skip
    for end, k in ((20.0, 4), (40.0, 6), (80.0, 8)):
        yield Contender(
            LONG, f"slow time {end:g}, tolerance 1e-{k}",
            partial(_long, chain, ours, end, 10.0**-k), 0.0, quick=k < 5, peer=True,
        )  # fmt: skip


def by_shooting(chain: VdpChain, steps: int) -> FloatArray:
    """Return amplitudes and frequency of the orbit, shape (N + 1,)."""
    orbit = solve_orbit(chain, Nucleus(1), steps=steps)
    return np.append(orbit.amplitudes, orbit.frequency)


def by_scipy(chain: VdpChain, tolerance: float) -> FloatArray:
    """Return the same by ``scipy.optimize.root`` on the flow of ``solve_ivp``.

    Raises
    ------
    ArithmeticError
        If either gives up.
    """
    from scipy.integrate import solve_ivp
    from scipy.optimize import root

    rate = right_side(chain)
    centre = Nucleus(1).centre(chain.sites)

    def flow(u: FloatArray, times: FloatArray | None = None) -> FloatArray:
        run = solve_ivp(rate, (0.0, u[-1]), u[:-1], "DOP853", times, rtol=tolerance, atol=tolerance)
        if not run.success:
            raise ArithmeticError(run.message)
        return np.asarray(run.y if times is not None else run.y[:, -1])

    def system(u: FloatArray) -> FloatArray:
        return np.append(flow(u) - u[:-1], u[centre])

    # The flow contracts by parts in a hundred a period, so that the step of the finite differences
    # must stand far above its error.
    found = root(system, orbit_guess(chain, Nucleus(1)), tol=tolerance,
                 options={"eps": math.sqrt(tolerance)})  # fmt: skip
    if float(np.abs(found.fun).max()) > 1e3 * tolerance:
        raise ArithmeticError(f"root gave up: {found.message}")
    times = np.arange(_SAMPLES) * (found.x[-1] / _SAMPLES)
    y = flow(found.x, np.append(times, found.x[-1]))[: chain.sites, :-1]
    return np.append(_peaks(y), 2.0 * math.pi / found.x[-1])


def _peaks(y: FloatArray) -> FloatArray:
    """Return max |y_n| of one period of samples, shape (N, samples), by trigonometric sums.

    From the largest sample, Newton's method on the derivative.
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


def _answer(found: FloatArray, true: FloatArray, claimed: float | None) -> Answer:
    error = float(np.abs(found - true).max())
    if not math.isfinite(error):
        raise ArithmeticError("the result is not finite")
    return Answer(error, claimed)


def _envelope(chain: VdpChain, true: FloatArray) -> Answer:
    found = solve_envelope_breather(chain, Nucleus(1))
    return _answer(np.append(np.abs(found.phi), 1.0 + chain.eps * found.omega), true, None)


def _shooting(chain: VdpChain, true: FloatArray, steps: int) -> Answer:
    orbit = solve_orbit(chain, Nucleus(1), steps=steps)
    return _answer(np.append(orbit.amplitudes, orbit.frequency), true, orbit.error)


def _run(chain: VdpChain, true: FloatArray, tolerance: float) -> Answer:
    run = run_breather(chain, Nucleus(1), tolerance=tolerance)
    if run.status is not BreatherStatus.SETTLED:
        raise ArithmeticError(f"the run is {run.status.value}")
    return _answer(np.append(run.amplitudes, run.frequency), true, run.error)


def _root(chain: VdpChain, true: FloatArray, tolerance: float) -> Answer:
    return _answer(by_scipy(chain, tolerance), true, None)


def _long(chain: VdpChain, true: FloatArray, end: float, tolerance: float) -> Answer:
    """Wait until slow time ``end``, then take the last period between two rising zeros."""
    from scipy.integrate import solve_ivp

    rate = right_side(chain)
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
        raise ArithmeticError("no period was seen")
    zeros = run.t_events[0]
    period = float(zeros[1] - zeros[0])
    y = run.y[: chain.sites, run.t <= period]
    return _answer(np.append(np.abs(y).max(axis=1), 2.0 * math.pi / period), true, None)


@dataclass(frozen=True)
class _Rising:
    """An event of ``solve_ivp``: y of a site passes zero upwards."""

    site: int
    direction: float = 1.0

    def __call__(self, _: float, x: FloatArray) -> float:
        return float(x[self.site])


def style() -> Style:
    """Return how the diagram is drawn."""
    from benchmarks.diagram import Style

    return Style(
        "largest error (right is better)",
        "processor seconds a breather",
        "Error against run time of a breather of (8), seven sites. The averaged chain is solved "
        "exactly, and errs by a term of order ε.",
        {
            ENVELOPE: ("green", "^"),
            SHOOTING: ("blue", "o"),
            RUN: ("sky", "v"),
            ROOT: ("vermilion", "s"),
            LONG: ("orange", "X"),
        },
        1.0,
        1e-15,
    )


def _first(method: str) -> object:
    """Return a breather of the first scene, compared with nothing."""
    chain = chain_of(timed("breather")[0])
    return by_scipy(chain, 1e-6) if method == ROOT else by_shooting(chain, steps_for(chain))


BENCHMARK = Quantity(
    "breather",
    "breather of the chain (8)",
    SHOOTING,
    (1e-8, 1e-3),
    measure,
    style,
    others={ENVELOPE: "the averaged chain (43), whose breather differs by a term of order eps"},
    first={name: partial(_first, name) for name in (SHOOTING, ROOT)},
)
