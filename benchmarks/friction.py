"""The friction chain by three families of methods: error versus run time.

The first site is excited. The methods are Taylor steps with exact events; the switch model of the
paper, with fixed and with adaptive steps; and regularised friction with scipy's LSODA, Radau and
BDF. The error is the largest error of y over 201 times and all sites, with respect to the
event-exact run at 1e-13, which is itself compared with scipy's DOP853 with events; the record
states by how much they differ. Times are seconds of processor time, with one thread each.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from benchmarks.record import Target, WorkPoint
from benchmarks.regularised import Solver, run_regularised
from benchmarks.work_precision import (
    Effort,
    MethodAnswer,
    Prepared,
    Report,
    Setting,
    Style,
    WorkPrecision,
    ratio_target,
)
from theory.arrays import FloatArray
from theory.chains.friction import FrictionChain
from verification.quantities.problems import Problem, timed
from verification.references.friction_events import run_events
from verification.references.switch_model import run_switch
from verification.runs.excite import excite
from verification.runs.simulate import simulate

SAMPLES = 201
GARBAGE = 0.1
"""Error above which a result counts as useless: the amplitude of the cycle is 1.4."""

EXACT, FIXED, ADAPTIVE = "event-exact", "switch, fixed steps", "switch, adaptive"
STATED = "event-exact, error stated"
WIDTHS = (1e-2, 1e-3, 1e-4)
TOLERANCES = (1e-3, 1e-5, 1e-7)
BAND = 1e-4


def prepare(problem: Problem, quick: bool, report: Report) -> Prepared:
    """Return the settings of all methods and the agreement of the two references."""
    chain, end = chain_of(problem), problem["t"]
    start = excite(chain, [1])
    true = simulate(chain, start, end, tolerance=1e-13, samples=SAMPLES, logged_events=10_000)
    second = run_events(chain, start, end, tolerance=1e-13)
    if len(second.log) != true.event_count:
        raise ArithmeticError("the two references do not have the same events")
    report(f"the second reference took {second.seconds:.3g} s")
    # Problems that only show the effect of stiffness are measured at fewer settings.
    few = quick or "ordinary" not in problem.tags
    settings = [
        Setting(method=name, knob=knob, evaluate=call, reference=true.y, peer="scipy" in name)
        for name, knob, call in methods(chain, start, end, few)
    ]
    return Prepared(agreement=float(np.abs(second.y - true.y).max()), settings=settings)


def chain_of(problem: Problem) -> FrictionChain:
    """Return the chain of a test problem."""
    return FrictionChain(c=problem.c, sites=problem.sites)


def methods(
    chain: FrictionChain, start: FloatArray, end: float, few: bool
) -> Iterator[tuple[str, str, Callable[[], MethodAnswer]]]:
    """Yield every method at every setting."""
    here = (chain, start, end)
    for tolerance in (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12):
        yield EXACT, f"tolerance {tolerance:g}", partial(_exact, *here, tolerance)
    for tolerance in (1e-6, 1e-8, 1e-10):
        yield STATED, f"tolerance {tolerance:g}", partial(_exact, *here, tolerance, True)
    for step in (1e-1, 1e-2, 1e-3) if few else (1e-1, 3e-2, 1e-2, 1e-3, 1e-4):
        found = partial(_switch, *here, {"step": step, "band": BAND})
        yield FIXED, f"step {step:g}, band {BAND:g}", found
    for relative in TOLERANCES:
        for band in (BAND,) if few else (BAND, 1e-6):
            options = {"relative": relative, "absolute": 1e-3 * relative, "band": band}
            found = partial(_switch, *here, options)
            yield ADAPTIVE, f"relative {relative:g}, band {band:g}", found
    for solver in Solver:
        for delta in WIDTHS[1:2] if few else WIDTHS:
            for tolerance in TOLERANCES[1:2] if few else TOLERANCES:
                found = partial(_regularised, *here, solver, delta, tolerance)
                yield f"scipy {solver.value}", f"delta {delta:g}, tolerance {tolerance:g}", found


def _exact(
    chain: FrictionChain, start: FloatArray, end: float, tolerance: float, stated: bool = False
) -> MethodAnswer:
    run = simulate(chain, start, end, tolerance=tolerance, samples=SAMPLES, estimate_error=stated)
    return MethodAnswer(value=run.y, claimed=run.error)


def _switch(
    chain: FrictionChain, start: FloatArray, end: float, options: dict[str, float]
) -> MethodAnswer:
    run = run_switch(chain, start, end, samples=SAMPLES, **options)
    if run.reached < end:
        raise ArithmeticError(f"stopped at tau = {run.reached:.4g}")
    return MethodAnswer(value=run.y)


def _regularised(
    chain: FrictionChain,
    start: FloatArray,
    end: float,
    solver: Solver,
    delta: float,
    tolerance: float,
) -> MethodAnswer:
    y = run_regularised(
        chain, start, end, solver=solver, delta=delta, tolerance=tolerance, samples=SAMPLES
    )
    return MethodAnswer(value=y)


def targets(points: Sequence[WorkPoint], quick: bool, report: Report) -> tuple[Target, ...]:
    """Return the least factor by which the event-exact run is faster than scipy at equal error.

    At every error that scipy reaches, except errors above `GARBAGE`, its fastest setting with that
    error is compared with our fastest setting that is at least as accurate.
    """
    ordinary = timed("friction")[0].name
    points = [point for point in points if point.problem == ordinary]
    ours = [point for point in points if point.method == EXACT]
    peers = [point for point in points if point.method.startswith("scipy ")]
    garbage = sum(point.error > GARBAGE for point in peers)
    claim = "event-exact against scipy's best, at equal error"
    found = ratio_target(claim, ours, peers, errors=(0.0, GARBAGE), limit=50.0)
    unusable = f"{garbage} of {len(peers)} settings of scipy are garbage: error above {GARBAGE:g}"
    return (replace(found, detail=f"{found.detail}; {unusable}"),)


def _first(method: str) -> MethodAnswer:
    """Run the first tenth of the ordinary problem."""
    problem = timed("friction")[0]
    chain = chain_of(problem)
    start, end = excite(chain, [1]), 0.1 * problem["t"]
    if method == EXACT:
        return _exact(chain, start, end, 1e-8)
    return _regularised(chain, start, end, Solver(method.removeprefix("scipy ")), 1e-3, 1e-5)


BENCHMARK = WorkPrecision(
    name="friction",
    prepare=prepare,
    targets=targets,
    effort=Effort(seconds=0.2, max_repeats=21, once_from=0.4),
    quick_effort=Effort(seconds=0.1, min_repeats=1, max_repeats=9, once_from=0.2, limit=10.0),
    style=Style(
        xlabel="largest error of y (right is better)",
        ylabel="processor seconds per run",
        caption="Error against run time, friction chain, N = 31. Pale: settings surpassed by "
        "another one of the same method. Grey: errors of the order of the motion itself.",
        methods={
            EXACT: ("blue", "o"),
            STATED: ("blue", "P"),
            FIXED: ("green", "^"),
            ADAPTIVE: ("sky", "v"),
            "scipy LSODA": ("vermilion", "s"),
            "scipy Radau": ("orange", "D"),
            "scipy BDF": ("purple", "X"),
        },
        garbage=GARBAGE,
    ),
    variants=(STATED,),
    first={name: partial(_first, name) for name in (EXACT, "scipy LSODA", "scipy BDF")},
)
