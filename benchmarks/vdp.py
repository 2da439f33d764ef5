"""The Van der Pol chain, error against run time beside peers.

The first site on its cycle, the others at rest. The default
stepper (Runge-Kutta of order 8, sites at rest left out) beside its losing rivals, which are fixed
steps, Taylor series and a splitting, and beside scipy, jitcode and heyoka. The error is the largest
of y and ẏ at the end, against our Taylor series at 1e-14, which is itself compared with scipy's
DOP853 at 1e-13. Then: how the cost of a front grows with its path, the map of Fig. 15, and the
thresholds of Fig. 11. Times are processor seconds, but for the map, where they are wall seconds.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from time import perf_counter, process_time
from typing import TYPE_CHECKING

from benchmarks.equal_error import least_factor
from benchmarks.quantity import Quantity, Tell
from verification.quantities.scenes import damping, timed

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from benchmarks.diagram import Style
    from benchmarks.record import Failure, Record, Target, WorkPoint
    from benchmarks.runner import Answer, Contender
    from theory.chains.vdp import VdpChain
    from verification.quantities.scenes import Scene

    FloatArray = npt.NDArray[np.float64]

QUANTITY = "largest error of y and its velocity"
GARBAGE = 0.1
OURS, SERIES = "Runge-Kutta 8 (default)", "Taylor series"
STATED = "Runge-Kutta 8, error stated"
FIXED8, FIXED4, SPLIT = "Runge-Kutta 8, fixed", "Runge-Kutta 4, fixed", "splitting SABA4"
LOW, HIGH = 1e-9, 1e-3
"""Errors between which speed was promised."""
TOLERANCES = tuple(10.0 ** (-half / 2) for half in range(6, 25))
"""1e-3 to 1e-12, by half decades, for all with a tolerance."""


def style() -> Style:
    """Return how the diagram is drawn."""
    from benchmarks.diagram import Style

    return Style(
        "largest error (right is better)",
        "processor seconds a run",
        "Error against run time, Van der Pol chain, N = 31. Pale: settings that another "
        "one of the same method beats. Grey: errors of the order of the motion itself.",
        {
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
        GARBAGE,
    )


def measure(quick: bool, tell: Tell) -> Record:
    """Measure every contender side by side and judge the targets."""
    import numpy as np

    from benchmarks import record
    from benchmarks.runner import Effort, measure_side_by_side
    from benchmarks.vdp_peers import scipy_solver

    points: list[WorkPoint] = []
    failures: list[Failure] = []
    agreement = {}
    effort = Effort(0.1, 1, 9, 0.3, 20.0) if quick else Effort(0.3, 3, 41, 2.0, 120.0)
    for scene in timed("chain")[: 1 if quick else None]:
        task = task_of(scene)
        tell(f"chain at the scene {scene.name}: the references")
        true = by_series(task, 1e-14)
        second = scipy_solver(task.chain, task.start, task.end, "DOP853")(1e-13)
        agreement[scene.name] = float(np.abs(second - true).max())
        # What only shows that stiffness makes it worse is measured at fewer settings.
        rows, missing = contenders(task, true, quick or "ordinary" not in scene.tags, tell)
        tell(f"chain at the scene {scene.name}: {len(rows)} settings")
        done, failed = measure_side_by_side(QUANTITY, scene.name, rows, effort, process_time)
        points += done
        failures += [*failed, *missing]
    ordinary = [point for point in points if point.scene == timed("chain")[0].name]
    return record.stamped(
        "fronts bench chain" + " --quick" * quick, agreement, points, failures,
        (*targets(ordinary), *_tasks(quick, tell)),
    )  # fmt: skip


@dataclass(frozen=True)
class Task:
    """A trajectory: of which chain, from where (y, ẏ), until when, and its scene."""

    chain: VdpChain
    start: FloatArray
    end: float
    scene: str

    @property
    def parameters(self) -> FloatArray:
        """As the steppers want them."""
        import numpy as np

        return np.array([self.chain.a, self.chain.b, self.chain.c, self.chain.eps])


def task_of(scene: Scene) -> Task:
    """Return the trajectory of a scene: the first site on its cycle."""
    import numpy as np

    from theory.chains.vdp import VdpChain

    a, b, c, eps = damping(scene.values)
    chain = VdpChain(a=a, b=b, c=c, eps=eps, sites=int(scene.values["sites"]))
    start = np.zeros(2 * chain.sites)
    start[0] = chain.stable_amplitude
    return Task(chain, start, scene.values["t"], scene.name)


def ours(task: Task, tolerance: float) -> FloatArray:
    """Return the final (y, ẏ) of our default stepper."""
    import numpy as np

    from verification.runs.excite import excite
    from verification.runs.smooth_integration import SmoothIntegration

    times = np.array([0.0, task.end])
    run = SmoothIntegration(
        task.chain, excite(task.chain, [1]), times, tolerance=tolerance, level=1.0
    )
    while not run.finished:
        run.advance(10**9)
    final: FloatArray = run.samples[-1].ravel()
    return final


def _stated(task: Task, true: FloatArray, tolerance: float) -> Answer:
    """Return the error with the claim: the run as a user asks for it, a companion beside it."""
    import numpy as np

    from verification.runs.excite import excite
    from verification.runs.simulate import simulate

    run = simulate(
        task.chain, excite(task.chain, [1]), task.end, tolerance=tolerance, samples=2
    )  # fmt: skip
    return _answer(np.concatenate([run.psi[-1].imag, run.psi[-1].real]), true, run.error)


def by_series(task: Task, tolerance: float) -> FloatArray:
    """Return the final (y, ẏ) by Taylor series."""
    from verification.steppers.active import FREE
    from verification.steppers.taylor import FULL, taylor_order, taylor_steps

    state = task.start.reshape(2, -1).copy()
    order = taylor_order(tolerance)
    if taylor_steps(FULL, state, task.parameters, FREE, task.end, tolerance, order) < 0:
        raise ArithmeticError("the result is not finite")
    return state.ravel()


def contenders(
    task: Task, true: FloatArray, few: bool, tell: Tell
) -> tuple[list[Contender], tuple[Failure, ...]]:
    """Return every method at every setting, or at few of them, and the peers not there."""
    from benchmarks.runner import Contender

    rows = [
        Contender(name, f"tolerance {tol:.1e}", partial(_own, task, true, tol, solve), 0.0)
        for name, solve in ((OURS, ours), (SERIES, by_series))
        for tol in (TOLERANCES[::4] if few else TOLERANCES)
    ]
    rows += [
        Contender(STATED, f"tolerance {tol:.1e}", partial(_stated, task, true, tol), 0.0)
        for tol in TOLERANCES[::6]
    ]
    rows += [
        Contender(name, f"{steps} steps", partial(_fixed, task, true, order, steps), 0.0)
        for name, order, counts in (
            (FIXED8, 8, (1600, 2000, 2500, 3500, 5000, 8000)),
            (FIXED4, 4, (5000, 20000, 80000)),
            (SPLIT, 0, (1000, 4000, 16000, 64000)),
        )
        for steps in (counts[::2] if few else counts)
    ]
    peers, missing = _peers(task, true, few, tell)
    return rows + peers, missing


def _peers(
    task: Task, true: FloatArray, few: bool, tell: Tell
) -> tuple[list[Contender], tuple[Failure, ...]]:
    from benchmarks import vdp_peers
    from benchmarks.record import Failure
    from benchmarks.runner import Contender

    rows: list[Contender] = []
    missing = []
    tolerances = TOLERANCES[2:11:8] if few else TOLERANCES
    here = (task.chain, task.start, task.end)

    def add(name: str, solve: vdp_peers.Solve, tolerance: float) -> None:
        evaluate = partial(_peer, solve, tolerance, true)
        rows.append(Contender(name, f"tolerance {tolerance:.1e}", evaluate, 0.0, peer=True))

    for solver in vdp_peers.SCIPY:
        solve = vdp_peers.scipy_solver(*here, solver)
        for tolerance in tolerances:
            add(f"scipy {solver}", solve, tolerance)
    for method in ("dop853",) if few else ("dop853", "lsoda"):
        tell(f"compiling jitcode {method}")
        try:
            solve = vdp_peers.jitcode_solver(*here, method)
        except Exception as error:  # whatever a peer raises is its result
            reason = str(error)[:160]
            missing.append(Failure(QUANTITY, task.scene, f"jitcode {method}", "all", reason))
            continue
        for tolerance in tolerances:
            add(f"jitcode {method}", solve, tolerance)
    for tolerance in tolerances:
        knob = f"{tolerance:.1e}"
        tell(f"compiling heyoka at {knob}")
        try:
            solve = vdp_peers.heyoka_solver(*here, tolerance)
        except Exception as error:  # whatever a peer raises is its result
            missing.append(Failure(QUANTITY, task.scene, "heyoka", knob, str(error)[:160]))
            continue
        add("heyoka", solve, tolerance)
    return rows, tuple(missing)


def _own(
    task: Task, true: FloatArray, tolerance: float, solve: Callable[[Task, float], FloatArray]
) -> Answer:
    return _answer(solve(task, tolerance), true)


def _fixed(task: Task, true: FloatArray, order: int, steps: int) -> Answer:
    from verification.steppers.fixed import fixed_steps
    from verification.steppers.splitting import saba, split_steps

    state = task.start.reshape(2, -1).copy()
    h = task.end / steps
    if order:
        fixed_steps(task.chain, state, h, steps, order)
    else:
        split_steps(state, task.parameters, False, h, steps, *saba(4))
    return _answer(state.ravel(), true)


def _peer(solve: Callable[[float], FloatArray], tolerance: float, true: FloatArray) -> Answer:
    return _answer(solve(tolerance), true)


def _answer(state: FloatArray, true: FloatArray, claimed: float | None = None) -> Answer:
    """Return the largest error as the value; its reference is zero."""
    import numpy as np

    from benchmarks.runner import Answer

    error = float(np.abs(state - true).max())
    if not math.isfinite(error):
        raise ArithmeticError("the result is not finite")
    return Answer(error, claimed)


def targets(points: Sequence[WorkPoint]) -> tuple[Target, ...]:
    """Return the least factors, at equal error, by which the default stepper beats the others."""
    from benchmarks.record import Target

    default = [point for point in points if point.method == OURS]
    rows = []
    for names, limit in (
        (("scipy",), 50.0),
        (("jitcode",), 5.0),
        (("heyoka",), 1.0),
        ((SERIES, FIXED8, FIXED4, SPLIT), None),
    ):
        peers = [point for point in points if point.method.startswith(names)]
        least = least_factor(default, peers, LOW, HIGH)
        detail = f"errors from {LOW:g} to {HIGH:g}"
        if least is not None:
            worst = least[1]
            detail = (
                f"least favourable: {worst.method}, {worst.knob}: error {worst.error:.1e} in "
                f"{worst.seconds:.2g} s"
            )
        who = "its own rivals" if SERIES in names else names[0]
        rows.append(
            Target(
                f"default stepper against {who}, at equal error",
                None if least is None else least[0],
                "no target" if limit is None else "at least",
                limit, "times", detail,
            )
        )  # fmt: skip
    return tuple(rows)


def _tasks(quick: bool, tell: Tell) -> list[Target]:
    """Measure whole tasks: a front over longer and longer chains, the map, the thresholds."""
    tell("measuring whole tasks ...")
    rows = [_front_cost((100, 200, 400) if quick else (100, 300, 1000, 3000))]
    if not quick:
        rows += [_map("full", 30.0), _map("envelope", 2.0), _thresholds()]
    return rows


def _front_cost(lengths: Sequence[int]) -> Target:
    import numpy as np

    from benchmarks.record import Target
    from theory.chains.vdp import VdpChain
    from verification.runs.excite import excite_edge
    from verification.runs.simulate import simulate

    seconds = []
    for sites in lengths:
        chain = VdpChain(a=4.0, b=0.5, c=0.6, sites=sites)
        begin = process_time()
        simulate(
            chain.averaged(),
            excite_edge(chain, 24),
            sites / 0.72 / chain.eps,
            trailing_sites=24,
            estimate_error=False,
            samples=2,
        )
        seconds.append(process_time() - begin)
    exponent = float(np.polyfit(np.log(lengths), np.log(seconds), 1)[0])
    detail = ", ".join(f"{n} sites {s:.2g} s" for n, s in zip(lengths, seconds, strict=True))
    return Target(
        "cost of a front over N sites: N to the power", exponent, "below", 1.3, "", detail
    )


def _map(model: str, limit: float) -> Target:
    import numpy as np

    from benchmarks.record import Target
    from verification.execution.sweep import sweep
    from verification.maps.state_map import StateTask, state_points
    from verification.maps.vdp_rules import FIGURE_15

    etas, couplings = np.linspace(0.01, 0.14, 14).tolist(), np.linspace(0.05, 1.0, 20).tolist()
    begin = perf_counter()
    task = StateTask(chain=FIGURE_15 if model == "full" else FIGURE_15.averaged())
    table = sweep(task, state_points(task, {"eta": etas, "c": couplings}), workers=2)
    seconds = perf_counter() - begin
    detail = f"{len(table)} points on two workers, their start included"
    return Target(f"map of Fig. 15, {model}", seconds, "below", limit, "s", detail)


def _thresholds() -> Target:
    from benchmarks.record import Target
    from theory.chains.nucleus import Nucleus, outward_pattern
    from theory.chains.vdp import VdpChain
    from verification.thresholds.continuation import breather_threshold
    from verification.thresholds.result import ThresholdMethod

    chain = VdpChain(a=2.5, b=0.5, c=0.0, eps=0.01)
    sizes = (1, 2, 3, 5, 7, 9)
    begin = perf_counter()
    found = [
        breather_threshold(chain, Nucleus(size, outward_pattern(size)), ThresholdMethod.ENVELOPE).c
        for size in sizes
    ]
    seconds = perf_counter() - begin
    detail = ", ".join(f"size {n}: {c:.5f}" for n, c in zip(sizes, found, strict=True))
    return Target("all thresholds of Fig. 11 by continuation", seconds, "below", 20.0, "s", detail)


def _first(method: str) -> FloatArray:
    """Integrate the ordinary scene; the first call compiles whatever has to be compiled."""
    return _solver(method)(1e-8)


@functools.cache
def _solver(method: str) -> Callable[[float], FloatArray]:
    from benchmarks import vdp_peers

    task = task_of(timed("chain")[0])
    here = (task.chain, task.start, task.end)
    if method == OURS:
        return partial(ours, task)
    if method == "heyoka":
        return vdp_peers.heyoka_solver(*here, 1e-8)
    if method == "jitcode dop853":
        return vdp_peers.jitcode_solver(*here, "dop853")
    return vdp_peers.scipy_solver(*here, "DOP853")


BENCHMARK = Quantity(
    "chain",
    "trajectory of the Van der Pol chain (8)",
    OURS,
    (LOW, HIGH),
    measure,
    style,
    (STATED,),
    reasons={
        FIXED8: "its step was found by trial at this scene: it knows no error and adapts to none",
        SPLIT: "its step was found by trial at this scene: it knows no error and adapts to none",
        "heyoka": "it compiles in every process, for every number of sites and every tolerance, "
        "and is an optional extra; sites at rest are not left out",
        SERIES: "faster at an error of 1e-9 and at this scene only, of 31 sites that all move, "
        "where the settings of the default are a factor of 100 apart: one stepper serves all",
        "jitcode dop853": "it needs a C compiler and compiles anew for every chain",
    },
    first={
        name: partial(_first, name) for name in (OURS, "heyoka", "jitcode dop853", "scipy DOP853")
    },
)
