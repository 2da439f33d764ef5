"""Velocity of a front of the averaged chain (43), denoted by eps = 0, and of the chain (8).

Our method measures v on a window that moves with the front and states the uncertainty of v; for
(43) it can also solve for the travelling wave itself. A user would otherwise integrate a chain with
scipy's DOP853 and time the arrivals at the sites: for (43) reduced to real amplitudes by its phase
of a quarter turn per site, or for (8) as it is. A regression over the second half of the sites
gives v.

For (8) the reference is v̂ from a smooth average of the intervals (weights e^{-1/s(1-s)}, with
which the ripple of the arrivals of (8) decreases faster than any power of the length). scipy gives
it for one length. The effect of the initial state decreases more slowly than the ripple; therefore
the change of v̂ on a chain four times as long is added from our stepper, which agrees with scipy's
for that one length. ``agreement`` is the difference of the two steppers for the same length, plus
the change of v̂ from twice that length to four times that length; errors below it mean nothing and
are not compared. For (43) the reference is scipy's solution for the wave on a grid, whose error
arrivals do not limit, and ``agreement`` is its change on another grid.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import Any

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
from verification.references.passages import arrivals_by_scipy, mean_interval
from verification.runs.excite import excite_edge
from verification.runs.simulate import simulate

OURS, WAVE, REDUCED, WHOLE, SHORTCUT = (
    "measured front", "solved wave", "scipy, real averaged chain", "scipy, chain (8)",
    "averaged, for (8)",
)  # fmt: skip
FILLED, MARGIN = 24, 8
_LENGTHS, _TOLERANCES = (96, 160), (1e-6, 1e-10)
"""Sites and tolerances of scipy's runs for the references of (8), in a quick and a full run."""


def prepare(problem: Problem, quick: bool, report: Report) -> Prepared:
    """Return the settings of all methods, and how well the reference velocity is known."""
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
    """Return the chain of a problem; eps = 0 denotes the averaged chain."""
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
    """Return v of the averaged chain; its stated error, which does not concern (8), is left out."""
    return MethodAnswer(value=_measured(chain_of(problem).averaged(), tolerance, accuracy).value)


def _timed(problem: Problem, sites: int, tolerance: float) -> MethodAnswer:
    arrivals = by_scipy(problem, sites, tolerance)
    half = arrivals[arrivals.size // 2 :]
    return MethodAnswer(value=1.0 / float(np.polyfit(np.arange(half.size), half, 1)[0]))


def by_us(problem: Problem, sites: int, tolerance: float) -> FloatArray:
    """Return the slow times of arrival at the sites beyond those excited, by our stepper."""
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
    """Return the same as `by_us`, by scipy's DOP853."""
    chain = problem.vdp_chain(sites)
    how: dict[str, Any] = {
        "level": chain.unstable_amplitude, "watched": slice(FILLED, sites - MARGIN),
        "rtol": tolerance, "atol": tolerance,
    }  # fmt: skip
    if isinstance(chain_of(problem), AveragedChain):
        start = np.where(np.arange(sites) < FILLED, chain.stable_amplitude, 0.0)
        return arrivals_by_scipy(quarter_turn_rate(chain), start, amplitude=np.abs, **how)
    start = excite_edge(chain, FILLED).ravel()
    return chain.eps * arrivals_by_scipy(full_rate(chain), start, amplitude=amplitude_of, **how)


def smooth_velocity(arrivals: FloatArray) -> float:
    """Return v̂ from a smooth average of the intervals beyond the first third."""
    return 1.0 / mean_interval(arrivals[arrivals.size // 3 :])


def _first(method: str) -> MethodAnswer:
    """Measure the front of (8) once."""
    problem = next(problem for problem in timed("front") if problem["eps"])
    if method == OURS:
        return _measured(chain_of(problem), 1e-6, 1e-3)
    return _timed(problem, 40, 1e-3)


BENCHMARK = WorkPrecision(
    name="front",
    prepare=prepare,
    effort=Effort(min_repeats=2, max_repeats=31),
    quick_problems=2,
    style=Style(
        xlabel="error of v (right is better)",
        ylabel="processor seconds per velocity",
        caption="Error against run time of the velocity of a front. The averaged chain "
        "differs from (8) by a term of order ε.",
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
        WAVE: "it is for (43) alone, and for a front that is steady; a run shows how "
        "any front develops from any start",
        WHOLE: "it states no error and is accurate by accident: on a longer chain, at a smaller "
        "tolerance, its error is larger; ours states a bound",
    },
    first={name: partial(_first, name) for name in (OURS, WHOLE)},
)
