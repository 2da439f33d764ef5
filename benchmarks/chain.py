"""The Van der Pol chain: error versus run time, compared with other programs.

The first site starts on its cycle, the others at rest. The default stepper (Runge-Kutta of order
8 with an active window of the moving sites) is compared with its slower rivals, which are fixed
steps, Taylor series and a splitting, and with scipy, jitcode and heyoka, whose compile time is
reported separately. The error is the largest error of y and ẏ at the end, with respect to our
Taylor series at 1e-14, which is itself compared with scipy's DOP853 at 1e-13. Three whole tasks
follow: how the cost of a front grows with its path, the map of Fig. 15, and the thresholds of
Fig. 11. Times are seconds of processor time, except for the map, where they are wall-clock seconds.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from time import perf_counter, process_time
from typing import Any, Literal

import numpy as np

from benchmarks.record import Target, WorkPoint
from benchmarks.steppers.fixed import fixed_steps
from benchmarks.steppers.splitting import saba, split_steps
from benchmarks.steppers.taylor import taylor_steps
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
from theory.chains.vdp import VdpChain
from verification.quantities.problems import Problem, timed
from verification.references.equations import full_rate
from verification.references.pace import last_state
from verification.runs.excite import excite, excite_edge
from verification.runs.simulate import simulate
from verification.runs.smooth_integration import SmoothIntegration
from verification.steppers.friction_series import taylor_order

Solve = Callable[[float], FloatArray]
"""Maps a tolerance to the final (y, ẏ)."""
Forces = Callable[[Any, Any], list[Any]]
"""Maps y and ẏ, given as symbols of another program, to the accelerations."""

OURS, SERIES = "Runge-Kutta 8 (default)", "Taylor series"
STATED = "Runge-Kutta 8, error stated"
FIXED8, FIXED4, SPLIT = "Runge-Kutta 8, fixed", "Runge-Kutta 4, fixed", "splitting SABA4"
LOW, HIGH = 1e-9, 1e-3
"""Range of errors for which a speed was promised."""
TOLERANCES = tuple(10.0 ** (-half / 2) for half in range(6, 25))
"""Tolerances of all methods that have one: 1e-3 to 1e-12, in half decades."""


@dataclass(frozen=True, kw_only=True)
class TrajectoryTask:
    """A trajectory: the chain, the initial (y, ẏ), and the end time."""

    chain: VdpChain
    start: FloatArray
    end: float

    @property
    def parameters(self) -> FloatArray:
        """The parameters as the splitting and the Taylor series take them: a, b, c, ε."""
        return np.array([self.chain.a, self.chain.b, self.chain.c, self.chain.eps])


def task_of(problem: Problem) -> TrajectoryTask:
    """Return the trajectory of a test problem, with the first site on its cycle."""
    chain = problem.vdp_chain()
    start = np.zeros(2 * chain.sites)
    start[0] = chain.stable_amplitude
    return TrajectoryTask(chain=chain, start=start, end=problem["t"])


def prepare(problem: Problem, quick: bool, report: Report) -> Prepared:
    """Return the settings of all methods and the agreement of the two references."""
    task = task_of(problem)
    true = by_series(task, 1e-14)
    apart = float(np.abs(scipy_solver(task, "DOP853")(1e-13) - true).max())
    # Problems that only show the effect of stiffness are measured at fewer settings.
    few = quick or "ordinary" not in problem.tags
    peers, missing = _peers(task, true, few, report)
    return Prepared(agreement=apart, settings=[*_ours(task, true, few), *peers], failures=missing)


def _ours(task: TrajectoryTask, true: FloatArray, few: bool) -> list[Setting]:
    tolerances = TOLERANCES[::4] if few else TOLERANCES
    rows: list[tuple[str, str, Callable[[], MethodAnswer]]] = []
    for tolerance in tolerances:
        for name, solve in ((OURS, ours), (SERIES, by_series)):
            call = partial(at_end, partial(solve, task), tolerance)
            rows.append((name, f"tolerance {tolerance:.1e}", call))
    for tolerance in TOLERANCES[::6]:
        rows.append((STATED, f"tolerance {tolerance:.1e}", partial(_stated, task, tolerance)))
    for name, order, counts in (
        (FIXED8, 8, (1600, 2000, 2500, 3500, 5000, 8000)),
        (FIXED4, 4, (5000, 20000, 80000)),
        (SPLIT, 0, (1000, 4000, 16000, 64000)),
    ):
        for steps in counts[::2] if few else counts:
            rows.append((name, f"{steps} steps", partial(_fixed, task, order, steps)))
    return [
        Setting(method=name, knob=knob, evaluate=call, reference=true) for name, knob, call in rows
    ]


def _peers(
    task: TrajectoryTask, true: FloatArray, few: bool, report: Report
) -> tuple[list[Setting], list[tuple[str, str, str]]]:
    """Return the other programs at every tolerance, and those missing or failing to compile."""
    settings: list[Setting] = []
    missing: list[tuple[str, str, str]] = []
    tolerances = TOLERANCES[2:11:8] if few else TOLERANCES

    def add(name: str, knob: str, build: Callable[[], Solve], some: Sequence[float]) -> None:
        report(f"compiling {name}, {knob}")
        try:
            solve = build()
        except Exception as error:  # whatever another program raises is its result
            missing.append((name, knob, str(error)[:160]))
            return
        for tolerance in some:
            settings.append(
                Setting(
                    method=name, knob=f"tolerance {tolerance:.1e}", reference=true, peer=True,
                    evaluate=partial(at_end, solve, tolerance),
                )
            )  # fmt: skip

    for method in SCIPY:
        add(f"scipy {method}", "all", partial(scipy_solver, task, method), tolerances)
    for solver in ("dop853",) if few else ("dop853", "lsoda"):
        add(f"jitcode {solver}", "all", partial(jitcode_solver, task, solver), tolerances)
    for tolerance in tolerances:
        build = partial(heyoka_solver, task, tolerance)
        add("heyoka", f"{tolerance:.1e}", build, [tolerance])
    return settings, missing


def at_end(solve: Solve, tolerance: float) -> MethodAnswer:
    """Return the final state found by a solver at a tolerance."""
    return MethodAnswer(value=solve(tolerance))


def ours(task: TrajectoryTask, tolerance: float) -> FloatArray:
    """Return the final (y, ẏ) of our default stepper."""
    times = np.array([0.0, task.end])
    run = SmoothIntegration(
        task.chain, excite(task.chain, [1]), times, tolerance=tolerance, level=1.0
    )
    run.finish()
    final: FloatArray = run.samples[-1].ravel()
    return final


def _stated(task: TrajectoryTask, tolerance: float) -> MethodAnswer:
    """Return the final state with its error, from a run such as a user would start."""
    run = simulate(task.chain, excite(task.chain, [1]), task.end, tolerance=tolerance, samples=2)
    return MethodAnswer(value=run.states[-1].ravel(), claimed=run.error)


def by_series(task: TrajectoryTask, tolerance: float) -> FloatArray:
    """Return the final (y, ẏ) by Taylor series."""
    state = task.start.reshape(2, -1).copy()
    order = taylor_order(tolerance)
    if taylor_steps(state, task.parameters, task.end, tolerance, order) < 0:
        raise ArithmeticError("the result is not finite")
    return state.ravel()


def _fixed(task: TrajectoryTask, order: int, steps: int) -> MethodAnswer:

    state = task.start.reshape(2, -1).copy()
    h = task.end / steps
    if order:
        fixed_steps(task.chain, state, h, steps, order)
    else:
        split_steps(state, task.parameters, False, h, steps, *saba(4))
    return MethodAnswer(value=state.ravel())


ScipyMethod = Literal["DOP853", "LSODA"]
SCIPY: tuple[ScipyMethod, ...] = ("DOP853", "LSODA")


def scipy_solver(task: TrajectoryTask, method: ScipyMethod) -> Solve:
    """Return a solver that calls ``solve_ivp`` with one of its methods."""
    rate = full_rate(task.chain)

    def solve(tolerance: float) -> FloatArray:
        return last_state(
            rate, task.end, task.start, tolerance, tolerance, method=method, t_eval=[task.end]
        )

    return solve


def _forces(chain: VdpChain, y: Any, w: Any) -> list[Any]:
    """Return the accelerations in the symbols of another program."""
    found = []
    for i in range(chain.sites):
        square = y[i] ** 2
        force = -y[i] - chain.eps * w[i] * (1.0 - chain.a * square + chain.b * square * square)
        for j in (i - 1, i + 1):
            if 0 <= j < chain.sites:
                force = force - chain.eps * chain.c * (y[i] - y[j])
        found.append(force)
    return found


def jitcode_solver(task: TrajectoryTask, method: str) -> Solve:
    """Return jitcode's integrator, compiled."""
    return compiled_by_jitcode(partial(_forces, task.chain), task.start, task.end, method)


def heyoka_solver(task: TrajectoryTask, tolerance: float) -> Solve:
    """Return heyoka's Taylor integrator at one tolerance, compiled.

    The whole step is unrolled, which compiles more slowly than compact mode and runs twice as fast.
    """
    return compiled_by_heyoka(partial(_forces, task.chain), task.start, task.end, tolerance)


def compiled_by_jitcode(forces: Forces, start: FloatArray, end: float, method: str) -> Solve:
    """Return jitcode's integrator for given accelerations, from (y, ẏ) at 0 to an end time."""
    from jitcode import jitcode
    from jitcode import y as state

    n = start.size // 2
    y, w = [state(i) for i in range(n)], [state(n + i) for i in range(n)]
    ode = jitcode([*w, *forces(y, w)], verbose=False)
    ode.compile_C()

    def solve(tolerance: float) -> FloatArray:
        ode.set_integrator(method, rtol=tolerance, atol=tolerance, nsteps=10**8)
        ode.set_initial_value(start.copy(), 0.0)
        return np.asarray(ode.integrate(end))

    return solve


def compiled_by_heyoka(
    forces: Forces, start: FloatArray, end: float, tolerance: float, *, compact: bool = False
) -> Solve:
    """Return heyoka's Taylor integrator for accelerations, from (y, ẏ) at 0 to an end time."""
    import heyoka

    n = start.size // 2
    y = heyoka.make_vars(*[f"y{i}" for i in range(n)])
    w = heyoka.make_vars(*[f"w{i}" for i in range(n)])
    system = [*zip(y, w, strict=True), *zip(w, forces(y, w), strict=True)]
    run = heyoka.taylor_adaptive(system, start.copy(), tol=tolerance, compact_mode=compact)

    def solve(_: float) -> FloatArray:
        run.time = 0.0
        run.state[:] = start
        run.propagate_until(end)
        return np.array(run.state)

    return solve


def targets(points: Sequence[WorkPoint], quick: bool, report: Report) -> tuple[Target, ...]:
    """Return comparisons of the default stepper at the ordinary problem, and whole tasks."""
    here = [point for point in points if point.problem == timed("chain")[0].name]
    ratios = [
        ratio_target(
            f"default stepper against {who}, at equal error",
            [point for point in here if point.method == OURS],
            [point for point in here if point.method.startswith(names)],
            errors=(LOW, HIGH),
            limit=limit,
        )
        for who, names, limit in (
            ("scipy", ("scipy",), 50.0),
            ("jitcode", ("jitcode",), 5.0),
            ("heyoka", ("heyoka",), 1.0),
            ("its own rivals", (SERIES, FIXED8, FIXED4, SPLIT), None),
        )
    ]
    return (*ratios, *_tasks(quick, report))


def _tasks(quick: bool, report: Report) -> list[Target]:
    """Measure whole tasks: a front on chains of growing length, the map, the thresholds."""
    report("measuring whole tasks ...")
    rows = [_front_cost((100, 200, 400) if quick else (100, 300, 1000, 3000))]
    if not quick:
        rows += [_map("full", 30.0), _map("envelope", 2.0), _thresholds()]
    return rows


def _front_cost(lengths: Sequence[int]) -> Target:

    seconds = []
    for sites in lengths:
        chain = VdpChain(a=4.0, b=0.5, c=0.6, sites=sites)
        begin = process_time()
        simulate(
            chain.averaged(), excite_edge(chain, 24), sites / 0.72 / chain.eps,
            trailing_sites=24, estimate_error=False, samples=2,
        )  # fmt: skip
        seconds.append(process_time() - begin)
    exponent = float(np.polyfit(np.log(lengths), np.log(seconds), 1)[0])
    detail = ", ".join(f"{n} sites {s:.2g} s" for n, s in zip(lengths, seconds, strict=True))
    return Target(
        "cost of a front over N sites: N to the power", exponent, "below", 1.3, "", detail
    )


def _map(model: str, limit: float) -> Target:
    from verification.execution.sweep import sweep
    from verification.maps.task import StateTask, state_points
    from verification.maps.vdp_rules import FIGURE_15

    etas, couplings = np.linspace(0.01, 0.14, 14).tolist(), np.linspace(0.05, 1.0, 20).tolist()
    begin = perf_counter()
    task = StateTask(chain=FIGURE_15 if model == "full" else FIGURE_15.averaged())
    table = sweep(task, state_points(task, {"eta": etas, "c": couplings}), workers=2)
    seconds = perf_counter() - begin
    detail = f"{len(table)} points on two workers, their start included"
    return Target(f"map of Fig. 15, {model}", seconds, "below", limit, "s", detail)


def _thresholds() -> Target:
    from theory.chains.nucleus import Nucleus, outward_pattern
    from verification.thresholds.continuation import breather_threshold
    from verification.thresholds.result import ThresholdMethod

    chain = VdpChain(a=2.5, b=0.5, c=0.0, eps=0.01)
    sizes = (1, 2, 3, 5, 7, 9)
    begin = perf_counter()
    found = [
        breather_threshold(
            chain, Nucleus(size, outward_pattern(size)), ThresholdMethod.ENVELOPE
        ).c_crit
        for size in sizes
    ]
    seconds = perf_counter() - begin
    detail = ", ".join(f"size {n}: {c:.5f}" for n, c in zip(sizes, found, strict=True))
    return Target("all thresholds of Fig. 11 by continuation", seconds, "below", 20.0, "s", detail)


def _first(method: str) -> FloatArray:
    """Integrate the ordinary problem; the first call includes all compilation."""
    return _solver(method)(1e-8)


@functools.cache
def _solver(method: str) -> Solve:
    task = task_of(timed("chain")[0])
    if method == OURS:
        return partial(ours, task)
    if method == "heyoka":
        return heyoka_solver(task, 1e-8)
    if method == "jitcode dop853":
        return jitcode_solver(task, "dop853")
    return scipy_solver(task, "DOP853")


BENCHMARK = WorkPrecision(
    name="chain",
    prepare=prepare,
    targets=targets,
    effort=Effort(seconds=0.3, max_repeats=41, limit=120.0),
    quick_effort=Effort(seconds=0.1, min_repeats=1, max_repeats=9, once_from=0.3, limit=20.0),
    style=Style(
        xlabel="largest error (right is better)",
        ylabel="processor seconds per run",
        caption="Error against run time, Van der Pol chain, N = 31. Pale: settings surpassed by "
        "another one of the same method. Grey: errors of the order of the motion itself.",
        methods={
            OURS: ("blue", "o"),
            STATED: ("blue", "P"),
            SERIES: ("sky", "v"),
            FIXED8: ("green", "^"),
            FIXED4: ("green", "x"),
            SPLIT: ("purple", "P"),
            "heyoka": ("black", "*"),
            "jitcode dop853": ("orange", "D"),
            "jitcode lsoda": ("orange", "+"),
            "scipy DOP853": ("vermilion", "s"),
            "scipy LSODA": ("vermilion", "X"),
        },
        garbage=0.1,
    ),
    variants=(STATED,),
    reasons={
        FIXED8: "its step was found by trial at this problem: it neither "
        "estimates its error nor adapts",
        SPLIT: "its step was found by trial at this problem: it neither "
        "estimates its error nor adapts",
        "heyoka": "it compiles in every process, for every number of sites and every tolerance, "
        "and is an optional extra; it has no active window",
        SERIES: "faster at an error of 1e-9 and at this problem only, of 31 sites that all move, "
        "where the settings of the default are a factor of 100 apart: one "
        "stepper is used for all problems",
        "jitcode dop853": "it needs a C compiler and compiles anew for every chain",
    },
    first={
        name: partial(_first, name) for name in (OURS, "heyoka", "jitcode dop853", "scipy DOP853")
    },
)
