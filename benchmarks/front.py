"""Velocity of a front of the averaged chain (43), where eps = 0, and of the chain (8).

Ours measures on a window that moves with the front and says how uncertain v is. A user would hand
a chain to scipy's DOP853 and time the sites: (43) reduced to real amplitudes by its phases of a
quarter turn a site, or (8) as it stands. Regression over the second half of the sites gives v.

The reference is v̂ from a smooth average of the intervals (weights e^{-1/s(1-s)}, which makes the
ripple of the arrivals of (8) fall faster than any power of the length). scipy gives it on one
length; as what is left of the start falls off more slowly than the ripple, the difference that a
chain four times as long makes is added from our stepper, which agrees with scipy's on that one
length. ``agreement`` is how far the two steppers are apart on the same length, plus the change from
twice that length to four times it; errors below it mean nothing and are not compared.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from time import process_time
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from benchmarks.quantity import Quantity, Tell
from benchmarks.record import Failure, Record, WorkPoint, stamped
from benchmarks.runner import Answer, Contender, Effort, measure_side_by_side
from benchmarks.vdp_peers import right_side
from theory.chains.vdp import VdpChain
from verification.fronts.measure import measure_front
from verification.quantities.scenes import Scene, damping, timed
from verification.runs.excite import excite_edge
from verification.runs.model import Model
from verification.runs.simulate import simulate

if TYPE_CHECKING:
    from scipy.integrate import DOP853

    from benchmarks.diagram import Style

FloatArray = npt.NDArray[np.float64]
Rate = Callable[[float, FloatArray], FloatArray]

OURS, STAGGERED, WHOLE, SHORTCUT = (
    "measured front", "scipy, staggered chain", "scipy, chain (8)", "averaged, for (8)",
)  # fmt: skip
FILLED, MARGIN = 24, 8
_LENGTHS = {Model.ENVELOPE: (88, 120), Model.FULL: (96, 160)}
_TOLERANCES = {Model.ENVELOPE: (1e-10, 1e-12), Model.FULL: (1e-6, 1e-10)}
"""Sites and tolerances of scipy's runs for the references, quick and full."""


def measure(quick: bool, tell: Tell) -> Record:
    """Measure every method at both scenes."""
    points: list[WorkPoint] = []
    failures: list[Failure] = []
    agreement = {}
    effort = Effort(0.1, 1, 9, 0.5, 20.0) if quick else Effort(1.0, 2, 31, 2.0, 60.0)
    for scene in timed("front")[: 2 if quick else None]:
        tell(f"front at the scene {scene.name}: the references")
        model = model_of(scene)
        sites = _LENGTHS[model][not quick]
        theirs = smooth_velocity(by_scipy(scene, sites, _TOLERANCES[model][not quick]))
        lengths = (sites, 2 * sites, (2 if quick else 4) * sites)
        short, long, longest = (smooth_velocity(by_us(scene, n, 1e-11)) for n in lengths)
        agreement[scene.name] = abs(theirs - short) + abs(longest - (short if quick else long))
        true = theirs + (longest - short)
        rows = [each for each in contenders(scene, longest, true) if each.quick or not quick]
        tell(f"front at the scene {scene.name}: {len(rows)} settings")
        done, failed = measure_side_by_side("front", scene.name, rows, effort, process_time)
        points += done
        failures += failed
    command = "fronts bench front" + " --quick" * quick
    return stamped(command, agreement, points, failures)


def contenders(scene: Scene, ours: float, theirs: float) -> Iterator[Contender]:
    """Yield every method at every setting."""
    model = model_of(scene)
    for k, accuracy in ((3, 1e-2), (4, 1e-3), (6, 1e-4), (8, 1e-5), (10, 1e-7)):
        yield Contender(
            OURS, f"tolerance 1e-{k}, accuracy {accuracy:g}",
            partial(_measured, scene, model, 10.0**-k, accuracy), theirs,
            quick=model is Model.ENVELOPE or k < 5,
        )  # fmt: skip
    if model is Model.FULL:
        shortcut = partial(_averaged, scene, 1e-8, 1e-5)
        yield Contender(SHORTCUT, "tolerance 1e-8", shortcut, theirs)
    peer = STAGGERED if model is Model.ENVELOPE else WHOLE
    for sites, k in ((40, 3), (56, 5), (56, 7), (88, 9)):
        yield Contender(
            peer, f"{sites} sites, tolerance 1e-{k}",
            partial(_timed, scene, sites, 10.0**-k), ours, quick=k < 6, peer=True,
        )  # fmt: skip


def model_of(scene: Scene) -> Model:
    """Return the equation of a scene: eps = 0 stands for the averaged chain."""
    return Model.FULL if scene.values["eps"] else Model.ENVELOPE


def chain_of(scene: Scene, sites: int) -> VdpChain:
    """Return the chain of a scene; of the averaged chain eps is only the unit of time."""
    a, b, c, eps = damping(scene.values)
    return VdpChain(a=a, b=b, c=c, eps=eps or 0.01, sites=sites)


def _measured(scene: Scene, model: Model, tolerance: float, accuracy: float) -> Answer:
    found = measure_front(
        model.chain_of(chain_of(scene, 32)), tolerance=tolerance, accuracy=accuracy, max_sites=2000
    )
    if found.v is None:
        raise ArithmeticError(f"the front is {found.status.value}")
    return Answer(found.v, found.error)


def _averaged(scene: Scene, tolerance: float, accuracy: float) -> Answer:
    """Return v of the averaged chain, whose claim is not about (8)."""
    return Answer(_measured(scene, Model.ENVELOPE, tolerance, accuracy).value, None)


def _timed(scene: Scene, sites: int, tolerance: float) -> Answer:
    arrivals = by_scipy(scene, sites, tolerance)
    half = arrivals[arrivals.size // 2 :]
    return Answer(1.0 / float(np.polyfit(np.arange(half.size), half, 1)[0]), None)


def by_us(scene: Scene, sites: int, tolerance: float) -> FloatArray:
    """Return slow times at which sites beyond the start are reached, by our stepper."""
    chain = chain_of(scene, sites)
    run = simulate(
        model_of(scene).chain_of(chain),
        excite_edge(chain, FILLED),
        1.2 * sites / (1.1 * chain.c) / chain.eps,
        tolerance=tolerance,
        samples=2,
        estimate_error=False,
    )
    arrivals = run.arrivals[FILLED : sites - MARGIN] * chain.eps
    if not np.isfinite(arrivals).all():
        raise ArithmeticError("the front did not run through the chain")
    return arrivals


def by_scipy(scene: Scene, sites: int, tolerance: float) -> FloatArray:
    """Return the same by scipy's DOP853."""
    chain = chain_of(scene, sites)
    level, filled = chain.unstable_amplitude, chain.stable_amplitude
    if model_of(scene) is Model.ENVELOPE:
        start = np.where(np.arange(sites) < FILLED, filled, 0.0)
        return _arrivals(staggered_rate(chain), start, sites, level, tolerance, abs)
    psi = excite_edge(chain, FILLED)
    start = np.concatenate([psi.imag, psi.real])

    def amplitude(x: FloatArray) -> FloatArray:
        return np.asarray(np.hypot(x[:sites], x[sites:]))

    return chain.eps * _arrivals(right_side(chain), start, sites, level, tolerance, amplitude)


def staggered_rate(chain: VdpChain) -> Rate:
    """Return r_n' = (c/2)(r_{n-1} - r_{n+1}) - (r_n/2)(1 - a r_n²/4 + b r_n⁴/8), slow time.

    The ends, where one neighbour is missing, are left without the term that the reduction loses.
    """
    a, b, c = chain.a, chain.b, chain.c

    def rate(_: float, r: FloatArray) -> FloatArray:
        square = r * r
        out = -0.5 * r * (1.0 - 0.25 * a * square + 0.125 * b * square * square)
        out[1:] += 0.5 * c * r[:-1]
        out[:-1] -= 0.5 * c * r[1:]
        return np.asarray(out)

    return rate


def _arrivals(
    rate: Rate,
    start: FloatArray,
    sites: int,
    level: float,
    tolerance: float,
    amplitude: Callable[[FloatArray], FloatArray],
) -> FloatArray:
    """Step until all sites but the last eight have been reached, and locate each in its step."""
    from scipy.integrate import DOP853

    solver = DOP853(rate, 0.0, start, np.inf, rtol=tolerance, atol=tolerance)
    times = np.full(sites, np.nan)
    while np.isnan(times[FILLED : sites - MARGIN]).any():
        solver.step()
        new = np.flatnonzero((amplitude(solver.y) > level) & np.isnan(times))
        if new.size:
            times[new] = [_crossing(solver, amplitude, site, level) for site in new.tolist()]
    return times[FILLED : sites - MARGIN]


def _crossing(
    solver: DOP853[np.float64],
    amplitude: Callable[[FloatArray], FloatArray],
    site: int,
    level: float,
) -> float:
    """Return when a site passed the level within the last step."""
    from scipy.optimize import brentq

    inside = solver.dense_output()

    def above(t: float) -> float:
        return float(amplitude(inside(t))[site] - level)

    if above(solver.t_old) >= 0.0:
        return float(solver.t_old)
    return float(brentq(above, solver.t_old, solver.t, xtol=1e-13))


def smooth_velocity(arrivals: FloatArray) -> float:
    """Return v̂ from the intervals beyond the first third, in a smooth average."""
    intervals = np.diff(arrivals)[arrivals.size // 3 :]
    place = (np.arange(intervals.size) + 0.5) / intervals.size
    weights = np.exp(-1.0 / (place * (1.0 - place)))
    return float(weights.sum() / (weights @ intervals))


def style() -> Style:
    """Return how the diagram is drawn."""
    from benchmarks.diagram import Style

    return Style(
        "error of v (right is better)",
        "processor seconds a velocity",
        "Error against run time of the velocity of a front. What the averaged chain says of (8) "
        "is off by a term of order ε.",
        {
            OURS: ("blue", "o"),
            SHORTCUT: ("green", "^"),
            STAGGERED: ("vermilion", "s"),
            WHOLE: ("orange", "v"),
        },
        0.1,
        1e-15,
    )


def _first(method: str) -> Answer:
    """Measure the front of (8) once."""
    scene = next(scene for scene in timed("front") if scene.values["eps"])
    if method == OURS:
        return _measured(scene, Model.FULL, 1e-6, 1e-3)
    return _timed(scene, 40, 1e-3)


BENCHMARK = Quantity(
    "front",
    "velocity of a front of (43) and (8)",
    OURS,
    (1e-8, 1e-2),
    measure,
    style,
    others={SHORTCUT: "the averaged chain (43), whose front differs by a term of order eps"},
    reasons={
        WHOLE: "it states no error and is so near by chance: on a longer chain, at a smaller "
        "tolerance, it is farther off; ours says how far it may be",
    },
    first={name: partial(_first, name) for name in (OURS, WHOLE)},
)
