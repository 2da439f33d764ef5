"""User-defined chains, compared with heyoka and jitcode (for symbolic systems) at equal error.

There are two problems to t = 200: 31 Duffing-Van der Pol cells with different a and springs to
second neighbours, and a square lattice of 100 x 100 cells, of which nine are excited. Our method is
the default stepper with all sites active; compile times are reported separately. The error is the
largest error of y and ẏ at the end, with respect to scipy's DOP853 at 1e-13 with the equation
written a second time. In addition, the time per step and the bytes a site are measured for a
million sites. Times are seconds of processor time.
"""

from __future__ import annotations

import functools
import resource
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from benchmarks.chain import Solve, at_end, compiled_by_heyoka, compiled_by_jitcode
from benchmarks.record import Target, WorkPoint
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
from theory.chains.oscillator import OscillatorChain
from verification.execution.time_limit import time_limit
from verification.quantities.own_chains import OURS, chain_of, rate_of
from verification.quantities.problems import Problem, timed
from verification.references.pace import last_state
from verification.runs.excite import excite
from verification.runs.simulate import simulate
from verification.runs.smooth_integration import SmoothIntegration

STATED, HEYOKA, JITCODE = "Runge-Kutta 8, error stated", "heyoka", "jitcode dop853"
LOW, HIGH = 1e-10, 1e-3
"""Range of errors for which a speed was promised."""
TOLERANCES = tuple(10.0**-k for k in range(4, 13))
BUILD_LIMIT = 900
"""Wall-clock seconds after which the compilation of another program is given up."""
MANY = 1000
"""Least number of sites for which other programs compile in parts and few tolerances are used."""


def start_of(chain: OscillatorChain) -> FloatArray:
    """Return the initial state: three adjacent sites excited, or a block of three by three."""
    rows, columns = chain.shape or (1, chain.sites)
    middle = (rows // 2) * columns + columns // 2
    across = (-columns, 0, columns) if rows > 1 else (0,)
    return excite(chain, [middle + row + n for row in across for n in (0, 1, 2)], 3.8)


def ours(chain: OscillatorChain, end: float, tolerance: float) -> FloatArray:
    """Return the final state of the default stepper with all sites active."""
    run = SmoothIntegration(
        chain, start_of(chain), [0.0, end], tolerance=tolerance, level=1e9, active_window=False
    )
    run.finish()
    final: FloatArray = run.samples[-1].ravel()
    return final


def _stated(chain: OscillatorChain, end: float, tolerance: float) -> MethodAnswer:
    """Return the final state with its error, from a run such as a user would start."""
    run = simulate(chain, start_of(chain), end, tolerance=tolerance, samples=2, active_window=False)
    return MethodAnswer(value=run.states[-1].ravel(), claimed=run.error)


def _forces(chain: OscillatorChain, y: Any, w: Any) -> list[Any]:
    """Return the accelerations in the symbols of another program."""
    a = np.broadcast_to(np.asarray(chain.site_values["a"]), chain.sites)
    k, links, found = chain.values.get("k", 0.0), chain.links, []
    for n in range(chain.sites):
        square = y[n] * y[n]
        force = -y[n] - chain.eps * w[n] * (1.0 - float(a[n]) * square + 0.5 * square * square)
        if k:
            force = force - k * square * y[n]
        row = slice(links.starts[n], links.starts[n + 1])
        pull = float(links.total[n]) * y[n]
        for j, weight in zip(links.sites[row], links.weights[row], strict=True):
            pull = pull - float(weight) * y[int(j)]
        found.append(force - chain.eps * chain.c * pull)
    return found


def _heyoka(chain: OscillatorChain, end: float, tolerance: float) -> Solve:
    """Return heyoka's Taylor integrator, compiled, in compact mode if there are many sites."""
    start, compact = start_of(chain).ravel(), chain.sites >= MANY
    return compiled_by_heyoka(partial(_forces, chain), start, end, tolerance, compact=compact)


def _jitcode(chain: OscillatorChain, end: float, _: float) -> Solve:
    """Return jitcode's integrator, compiled; it serves every tolerance."""
    return compiled_by_jitcode(partial(_forces, chain), start_of(chain).ravel(), end, "dop853")


def prepare(problem: Problem, quick: bool, report: Report) -> Prepared:
    """Return the settings of all methods, and how well the reference is known."""
    chain, end = chain_of(problem.values), problem["t"]
    report(f"scipy, {chain.sites} sites")
    true = last_state(rate_of(problem.values), end, start_of(chain).ravel(), 1e-13, 1e-15)
    apart = float(np.abs(ours(chain, end, 1e-13) - true).max())
    rows: list[tuple[str, float, Callable[[], MethodAnswer]]] = [
        (OURS, tolerance, partial(at_end, partial(ours, chain, end), tolerance))
        for tolerance in TOLERANCES[:: 4 if quick else 1]
    ]
    rows += [(STATED, each, partial(_stated, chain, end, each)) for each in (1e-6, 1e-9)]
    missing = []
    peers = TOLERANCES[1:8:3] if quick or chain.sites >= MANY else TOLERANCES
    for method, build, tolerances in (
        *((HEYOKA, partial(_heyoka, chain, end, each), [each]) for each in peers),
        (JITCODE, partial(_jitcode, chain, end, 0.0), peers),
    ):
        report(f"compiling {method} for {chain.sites} sites")
        try:
            with time_limit(BUILD_LIMIT):
                solve = build()
        except Exception as error:  # whatever another program raises is its result
            missing.append((method, f"tolerance {tolerances[0]:.0e}", str(error)[:160]))
            continue
        rows += [(method, each, partial(at_end, solve, each)) for each in tolerances]
    settings = [
        Setting(
            method=method, knob=f"tolerance {tolerance:.0e}", evaluate=call, reference=true,
            peer=method in (HEYOKA, JITCODE),
        )
        for method, tolerance, call in rows
    ]  # fmt: skip
    return Prepared(agreement=apart, settings=settings, failures=missing)


def targets(points: Sequence[WorkPoint], quick: bool, report: Report) -> tuple[Target, ...]:
    """Return comparisons of the default with other programs, and the cost of a million sites."""
    rows = []
    for problem in timed("own-chain"):
        here = [point for point in points if point.problem == problem.name]
        for peer in (HEYOKA, JITCODE):
            own, others = ([p for p in here if p.method == method] for method in (OURS, peer))
            claim = f"default stepper against {peer}, {problem.name}, at equal error"
            rows.append(ratio_target(claim, own, others, errors=(LOW, HIGH), limit=1.0))
    return tuple(rows) if quick else (*rows, *_million(report))


def _million(report: Report) -> tuple[Target, Target]:
    """Return seconds per step and bytes a site for a square lattice of 1000 x 1000 sites."""
    steps = 20
    report("stepping a million sites")
    chain = chain_of({**timed("own-chain")[-1].values, "rows": 1000, "sites": 1_000_000})
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start = excite(chain, [500_500], 3.8)
    run = SmoothIntegration(chain, start, [200.0], level=1e9, active_window=False)
    run.advance(chain.sites)
    begin, done = time.process_time(), run.counts["steps"]
    run.advance(steps * chain.sites)
    seconds = (time.process_time() - begin) / (run.counts["steps"] - done)
    size = 1024.0 * (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / chain.sites
    detail = f"a square lattice of {chain.sites} sites, {steps} steps"
    return (
        Target("a step of a million sites", seconds, "no target", None, "s", detail),
        Target("memory of a million sites", size, "no target", None, "bytes a site", detail),
    )


def _first(method: str) -> FloatArray:
    """Integrate the first problem; the first call includes all compilation."""
    return _solver(method)(1e-8)


@functools.cache
def _solver(method: str) -> Solve:
    problem = timed("own-chain")[0]
    chain, end = chain_of(problem.values), problem["t"]
    if method == OURS:
        return partial(ours, chain, end)
    return (_heyoka if method == HEYOKA else _jitcode)(chain, end, 1e-8)


BENCHMARK = WorkPrecision(
    name="own-chain",
    prepare=prepare,
    targets=targets,
    effort=Effort(seconds=1.0, max_repeats=21, limit=300.0),
    quick_effort=Effort(seconds=0.1, min_repeats=1, max_repeats=9, once_from=0.3, limit=20.0),
    style=Style(
        xlabel="largest error (right is better)",
        ylabel="processor seconds per run",
        caption="Error against run time, user-defined chains. Pale: settings surpassed by "
        "another one of the same method. Grey: errors of the order of the motion itself.",
        methods={
            OURS: ("blue", "o"),
            STATED: ("blue", "P"),
            HEYOKA: ("black", "*"),
            JITCODE: ("orange", "D"),
        },
        garbage=0.1,
    ),
    variants=(STATED,),
    reasons={
        HEYOKA: "it compiles in every process, for every chain and every tolerance, and is an "
        "optional extra",
        JITCODE: "it needs a C compiler and compiles anew for every chain",
    },
    first={name: partial(_first, name) for name in (OURS, HEYOKA, JITCODE)},
)
