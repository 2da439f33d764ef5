"""Velocity of a front of the averaged chain (43), where eps = 0, and of the chain (8).

Ours measures on a window that moves with the front and says how uncertain v is; of (43) it also
solves for the wave itself. A user would hand
a chain to scipy's DOP853 and time the sites: (43) reduced to real amplitudes by its phases of a
quarter turn a site, or (8) as it stands. Regression over the second half of the sites gives v.

The reference is v̂ from a smooth average of the intervals (weights e^{-1/s(1-s)}, which makes the
ripple of the arrivals of (8) fall faster than any power of the length). scipy gives it on one
length; as what is left of the start falls off more slowly than the ripple, the difference that a
chain four times as long makes is added from our stepper, which agrees with scipy's on that one
length. ``agreement`` is how far the two steppers are apart on the same length, plus the change from
twice that length to four times it; errors below it mean nothing and are not compared. Of (43) the
reference is scipy's wave on a grid along it, which no arrivals limit, and ``agreement`` what
another grid changes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING

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
from theory.chains.chain import Chain
from theory.chains.vdp import AveragedChain, VdpChain
from verification.fronts.measure import measure_front
from verification.quantities.problems import Problem, timed
from verification.references.equations import amplitude_of, full_rate, quarter_turn_rate
from verification.references.front_wave import front_velocity
from verification.runs.excite import excite_edge
from verification.runs.simulate import simulate

if TYPE_CHECKING:
    from scipy.integrate import DOP853

Rate = Callable[[float, FloatArray], FloatArray]

OURS, WAVE, REDUCED, WHOLE, SHORTCUT = (
    "measured front", "solved wave", "scipy, real averaged chain", "scipy, chain (8)",
    "averaged, for (8)",
)  # fmt: skip
FILLED, MARGIN = 24, 8
_LENGTHS, _TOLERANCES = (96, 160), (1e-6, 1e-10)
"""Sites and tolerances of scipy's runs for the references of (8), quick and full."""


def prepare(problem: Problem, quick: bool, report: Report) -> Prepared:
    """Return the velocity of reference, how well it is known, and all methods."""
    if isinstance(chain_of(problem), AveragedChain):
        coarse, fine = (float(front_velocity(problem.c, problem["eta"], m)) for m in (80, 112))
        settings = [*_ours(problem, fine), *_peers(problem, fine)]
        return Prepared(agreement=abs(fine - coarse), settings=settings)
    sites = _LENGTHS[not quick]
    theirs = smooth_velocity(by_scipy(problem, sites, _TOLERANCES[not quick]))
    lengths = (sites, 2 * sites, (2 if quick else 4) * sites)
    short, long, longest = (smooth_velocity(by_us(problem, n, 1e-11)) for n in lengths)
    apart = abs(theirs - short) + abs(longest - (short if quick else long))
    settings = [*_ours(problem, theirs + (longest - short)), *_peers(problem, longest)]
    return Prepared(agreement=apart, settings=settings)


def _ours(problem: Problem, true: float) -> Iterator[Setting]:
    chain = chain_of(problem)
    averaged = isinstance(chain, AveragedChain)
    for k, accuracy in ((3, 1e-2), (4, 1e-3), (6, 1e-4), (8, 1e-5), (10, 1e-7)):
        yield Setting(
            method=OURS, knob=f"tolerance 1e-{k}, accuracy {accuracy:g}", reference=true,
            evaluate=partial(_measured, chain, 10.0**-k, accuracy),
            quick=averaged or k < 5,
        )  # fmt: skip
    if averaged:
        yield Setting(
            method=WAVE, knob="wave", evaluate=partial(_wave, chain), reference=true,
        )  # fmt: skip
    else:
        shortcut = partial(_averaged, problem, 1e-8, 1e-5)
        yield Setting(method=SHORTCUT, knob="tolerance 1e-8", evaluate=shortcut, reference=true)


def _peers(problem: Problem, true: float) -> Iterator[Setting]:
    peer = REDUCED if isinstance(chain_of(problem), AveragedChain) else WHOLE
    for sites, k in ((40, 3), (56, 5), (56, 7), (88, 9)):
        yield Setting(
            method=peer, knob=f"{sites} sites, tolerance 1e-{k}", reference=true, quick=k < 6,
            evaluate=partial(_timed, problem, sites, 10.0**-k), peer=True,
        )  # fmt: skip


def chain_of(problem: Problem, sites: int = 32) -> VdpChain | AveragedChain:
    """Return the chain of a problem: eps = 0 stands for the averaged one."""
    chain = problem.vdp_chain(sites)
    return chain if problem["eps"] else chain.averaged()


def _measured(chain: Chain, tolerance: float, accuracy: float) -> MethodAnswer:
    found = measure_front(chain, tolerance=tolerance, accuracy=accuracy, max_sites=2000)
    if found.v is None:
        raise ArithmeticError(f"the front is {found.status.value}")
    return MethodAnswer(value=found.v, claimed=found.error)


def _wave(chain: Chain) -> MethodAnswer:
    found = measure_front(chain, method="wave")
    return MethodAnswer(value=found.v, claimed=found.error)


def _averaged(problem: Problem, tolerance: float, accuracy: float) -> MethodAnswer:
    """Return v of the averaged chain, whose claim is not about (8)."""
    return MethodAnswer(value=_measured(chain_of(problem).averaged(), tolerance, accuracy).value)


def _timed(problem: Problem, sites: int, tolerance: float) -> MethodAnswer:
    arrivals = by_scipy(problem, sites, tolerance)
    half = arrivals[arrivals.size // 2 :]
    return MethodAnswer(value=1.0 / float(np.polyfit(np.arange(half.size), half, 1)[0]))


def by_us(problem: Problem, sites: int, tolerance: float) -> FloatArray:
    """Return slow times at which sites beyond the start are reached, by our stepper."""
    chain = chain_of(problem, sites)
    end = 1.2 * sites / (1.1 * chain.c) / chain.eps
    run = simulate(
        chain, excite_edge(chain, FILLED), end, tolerance=tolerance,
        samples=2, estimate_error=False,
    )  # fmt: skip
    arrivals = run.arrivals[FILLED : sites - MARGIN] * chain.eps
    if not np.isfinite(arrivals).all():
        raise ArithmeticError("the front did not run through the chain")
    return arrivals


def by_scipy(problem: Problem, sites: int, tolerance: float) -> FloatArray:
    """Return the same by scipy's DOP853."""
    chain = problem.vdp_chain(sites)
    level, filled = chain.unstable_amplitude, chain.stable_amplitude
    if isinstance(chain_of(problem), AveragedChain):
        start = np.where(np.arange(sites) < FILLED, filled, 0.0)
        return _arrivals(
            quarter_turn_rate(chain), start, sites, level=level, tolerance=tolerance, amplitude=abs
        )
    start = excite_edge(chain, FILLED).ravel()
    return chain.eps * _arrivals(
        full_rate(chain), start, sites, level=level, tolerance=tolerance, amplitude=amplitude_of
    )


def _arrivals(
    rate: Rate,
    start: FloatArray,
    sites: int,
    *,
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


def _first(method: str) -> MethodAnswer:
    """Measure the front of (8) once."""
    problem = next(problem for problem in timed("front") if problem["eps"])
    if method == OURS:
        return _measured(chain_of(problem), 1e-6, 1e-3)
    return _timed(problem, 40, 1e-3)


BENCHMARK = WorkPrecision(
    name="front",
    prepare=prepare,
    effort=Effort(least=2, most=31),
    quick_problems=2,
    style=Style(
        xlabel="error of v (right is better)",
        ylabel="processor seconds a velocity",
        caption="Error against run time of the velocity of a front. What the averaged chain says "
        "of (8) is off by a term of order ε.",
        methods={
            OURS: ("blue", "o"),
            WAVE: ("black", "D"),
            SHORTCUT: ("green", "^"),
            REDUCED: ("vermilion", "s"),
            WHOLE: ("orange", "v"),
        },
        garbage=0.1,
        floor=1e-15,
    ),
    others={SHORTCUT: "the averaged chain (43), whose front differs by a term of order eps"},
    reasons={
        WAVE: "it is for (43) alone, and for a front that is steady; a run says what becomes of "
        "any front, from any start",
        WHOLE: "it states no error and is so near by chance: on a longer chain, at a smaller "
        "tolerance, it is farther off; ours says how far it may be",
    },
    first={name: partial(_first, name) for name in (OURS, WHOLE)},
)
