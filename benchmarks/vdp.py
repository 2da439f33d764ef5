"""The Van der Pol chain, error against run time beside peers.

N = 31, t = 1000, a = 4, b = 0.5, c = 0.6, ε = 0.01, the first site on its cycle. The default
stepper (Runge-Kutta of order 8, sites at rest left out) beside its losing rivals, which are fixed
steps, Taylor series and a splitting, and beside scipy, jitcode and heyoka. The error is the largest
of y and ẏ at the end, against our Taylor series at 1e-14, which is itself compared with scipy's
DOP853 at 1e-13. Then: how the cost of a front grows with its path, the map of Fig. 15, and the
thresholds of Fig. 11. Times are processor seconds, but for the map, where they are wall seconds.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from time import perf_counter, process_time
from typing import TYPE_CHECKING

from benchmarks.equal_error import least_factor
from benchmarks.quantity import Quantity, Tell

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from benchmarks.diagram import Style
    from benchmarks.record import Failure, Record, Target, WorkPoint
    from benchmarks.runner import Answer, Contender
    from theory.vdp_chain import VdpChain

    FloatArray = npt.NDArray[np.float64]

SITES, T_END, SCENE = 31, 1000.0, "N = 31, t = 1000"
QUANTITY = "largest error of y and its velocity"
GARBAGE = 0.1
OURS, SERIES = "Runge-Kutta 8 (default)", "Taylor series"
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
        "Error against run time, Van der Pol chain, N = 31, t = 1000. Pale: settings that another "
        "one of the same method beats. Grey: errors of the order of the motion itself.",
        {
            OURS: ("blue", "o"),
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
    from theory.vdp_chain import VdpChain

    chain = VdpChain(4.0, 0.5, 0.6, eps=0.01, sites=SITES)
    begin = perf_counter()
    ours(chain, 1e-3)
    compiled = perf_counter() - begin
    tell("measuring the reference ...")
    true = by_series(chain, 1e-14)
    second = scipy_solver(chain, _start(chain), T_END, "DOP853")(1e-13)
    apart = float(np.abs(second - true).max())
    rows, waits, missing = contenders(chain, true, quick, tell)
    tell(f"measuring {len(rows)} settings ...")
    effort = Effort(0.1, 1, 9, 0.3, 20.0) if quick else Effort(0.3, 3, 41, 2.0, 120.0)
    points, failures = measure_side_by_side(QUANTITY, SCENE, rows, effort, process_time)
    waits = {"ours, compiled or loaded": compiled, **waits}
    return record.Record(
        "fronts bench chain" + " --quick" * quick, record.now(), record.this_machine(),
        record.these_versions(), {SCENE: apart}, points, failures + missing,
        (*targets(points), *_compile_times(waits), *_tasks(quick, tell)),
    )  # fmt: skip


def _start(chain: VdpChain) -> FloatArray:
    import numpy as np

    start = np.zeros(2 * chain.sites)
    start[0] = chain.stable_amplitude
    return start


def ours(chain: VdpChain, tolerance: float) -> FloatArray:
    """Return the final (y, ẏ) of our default stepper."""
    import numpy as np

    from verification.vdp.lane import Lane
    from verification.vdp.start import displaced

    lane = Lane(chain, True, displaced(chain, [1]), np.array([0.0, T_END]), tolerance, 1.0, True, 0)
    while not lane.finished:
        lane.go_on(10**9)
    final: FloatArray = lane.samples[-1].ravel()
    return final


def by_series(chain: VdpChain, tolerance: float) -> FloatArray:
    """Return the final (y, ẏ) by Taylor series."""
    import numpy as np

    from verification.integrators.active import FREE
    from verification.integrators.slopes import FULL
    from verification.integrators.taylor import taylor_order, taylor_steps

    state = _start(chain).reshape(2, -1)
    parameters = np.array([chain.a, chain.b, chain.c, chain.eps])
    order = taylor_order(tolerance)
    if taylor_steps(FULL, state, parameters, FREE, T_END, tolerance, order) < 0:
        raise ArithmeticError("the result is not finite")
    return state.ravel()


def contenders(
    chain: VdpChain, true: FloatArray, quick: bool, tell: Tell
) -> tuple[list[Contender], dict[str, float], tuple[Failure, ...]]:
    """Return every method at every setting, compile times of peers, and the peers not there."""
    from benchmarks.runner import Contender

    rows = [
        Contender(name, f"tolerance {tol:.1e}", partial(_own, chain, true, tol, solve), 0.0)
        for name, solve in ((OURS, ours), (SERIES, by_series))
        for tol in (TOLERANCES[::4] if quick else TOLERANCES)
    ]
    rows += [
        Contender(name, f"{steps} steps", partial(_fixed, chain, true, order, steps), 0.0)
        for name, order, counts in (
            (FIXED8, 8, (1600, 2000, 2500, 3500, 5000, 8000)),
            (FIXED4, 4, (5000, 20000, 80000)),
            (SPLIT, 0, (1000, 4000, 16000, 64000)),
        )
        for steps in (counts[::2] if quick else counts)
    ]
    peers, waits, missing = _peers(chain, true, quick, tell)
    return rows + peers, waits, missing


def _peers(
    chain: VdpChain, true: FloatArray, quick: bool, tell: Tell
) -> tuple[list[Contender], dict[str, float], tuple[Failure, ...]]:
    from benchmarks import vdp_peers
    from benchmarks.record import Failure
    from benchmarks.runner import Contender

    start = _start(chain)
    rows: list[Contender] = []
    waits: dict[str, float] = {}
    missing = []
    tolerances = TOLERANCES[2:11:8] if quick else TOLERANCES

    def add(name: str, solve: vdp_peers.Solve, tolerance: float) -> None:
        evaluate = partial(_peer, solve, tolerance, true)
        rows.append(Contender(name, f"tolerance {tolerance:.1e}", evaluate, 0.0, peer=True))

    for solver in vdp_peers.SCIPY:
        solve = vdp_peers.scipy_solver(chain, start, T_END, solver)
        for tolerance in tolerances:
            add(f"scipy {solver}", solve, tolerance)
    for method in ("dop853",) if quick else ("dop853", "lsoda"):
        tell(f"compiling jitcode {method} ...")
        try:
            solve, waits[f"jitcode {method}"] = vdp_peers.jitcode_solver(
                chain, start, T_END, method
            )
        except Exception as error:  # whatever a peer raises is its result
            missing.append(Failure(QUANTITY, SCENE, f"jitcode {method}", "all", str(error)[:160]))
            continue
        for tolerance in tolerances:
            add(f"jitcode {method}", solve, tolerance)
    for tolerance in tolerances:
        knob = f"{tolerance:.1e}"
        tell(f"compiling heyoka at {knob} ...")
        try:
            solve, wait = vdp_peers.heyoka_solver(chain, start, T_END, tolerance)
        except Exception as error:  # whatever a peer raises is its result
            missing.append(Failure(QUANTITY, SCENE, "heyoka", knob, str(error)[:160]))
            continue
        slowest = "heyoka, slowest tolerance"
        waits[slowest] = max(wait, waits.get(slowest, 0.0))
        add("heyoka", solve, tolerance)
    return rows, waits, tuple(missing)


def _own(
    chain: VdpChain,
    true: FloatArray,
    tolerance: float,
    solve: Callable[[VdpChain, float], FloatArray],
) -> Answer:
    return _answer(solve(chain, tolerance), true)


def _fixed(chain: VdpChain, true: FloatArray, order: int, steps: int) -> Answer:
    import numpy as np

    from verification.integrators.active import FREE
    from verification.integrators.runge_kutta import fixed_steps
    from verification.integrators.slopes import FULL
    from verification.integrators.splitting import saba, split_steps

    state = _start(chain).reshape(2, -1)
    parameters = np.array([chain.a, chain.b, chain.c, chain.eps])
    h = T_END / steps
    if order:
        fixed_steps(FULL, state, parameters, FREE, h, steps, order)
    else:
        split_steps(state, parameters, False, h, steps, *saba(4))
    return _answer(state.ravel(), true)


def _peer(solve: Callable[[float], FloatArray], tolerance: float, true: FloatArray) -> Answer:
    return _answer(solve(tolerance), true)


def _answer(state: FloatArray, true: FloatArray) -> Answer:
    """Return the largest error as the value; its reference is zero."""
    import numpy as np

    from benchmarks.runner import Answer

    error = float(np.abs(state - true).max())
    if not math.isfinite(error):
        raise ArithmeticError("the result is not finite")
    return Answer(error, None)


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


def _compile_times(waits: dict[str, float]) -> list[Target]:
    from benchmarks.record import Target

    detail = "before the first run, in seconds of wall time; not in the times above"
    return [Target(f"compilation, {name}", s, "no target", None, "s", detail)
            for name, s in waits.items()]  # fmt: skip


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
    from theory.vdp_chain import VdpChain
    from verification.vdp.run import Model, run_vdp
    from verification.vdp.start import staggered_front

    seconds = []
    for sites in lengths:
        chain = VdpChain(4.0, 0.5, 0.6, sites=sites)
        begin = process_time()
        run_vdp(
            chain, staggered_front(chain, 24), sites / 0.72 / chain.eps, model=Model.ENVELOPE,
            behind=24, companion=False, samples=2,
        )  # fmt: skip
        seconds.append(process_time() - begin)
    exponent = float(np.polyfit(np.log(lengths), np.log(seconds), 1)[0])
    detail = ", ".join(f"{n} sites {s:.2g} s" for n, s in zip(lengths, seconds, strict=True))
    return Target(
        "cost of a front over N sites: N to the power", exponent, "below", 1.3, "", detail
    )


def _map(model: str, limit: float) -> Target:
    import numpy as np

    from benchmarks.record import Target
    from verification.sweeps.sweep import sweep
    from verification.vdp.map import StateTask, state_points
    from verification.vdp.run import Model

    etas, couplings = np.linspace(0.01, 0.14, 14).tolist(), np.linspace(0.05, 1.0, 20).tolist()
    begin = perf_counter()
    table = sweep(StateTask(Model(model)), state_points(etas, couplings), workers=2)
    seconds = perf_counter() - begin
    detail = f"{len(table)} points on two workers, their start included"
    return Target(f"map of Fig. 15, {model}", seconds, "below", limit, "s", detail)


def _thresholds() -> Target:
    from benchmarks.record import Target
    from theory.vdp_chain import VdpChain
    from verification.breathers.nucleus import Nucleus, outward_pattern
    from verification.breathers.threshold import Method, breather_threshold

    chain = VdpChain(2.5, 0.5, 0.0, 0.01)
    sizes = (1, 2, 3, 5, 7, 9)
    begin = perf_counter()
    found = [
        breather_threshold(chain, Nucleus(size, outward_pattern(size)), Method.ENVELOPE).c
        for size in sizes
    ]
    seconds = perf_counter() - begin
    detail = ", ".join(f"size {n}: {c:.5f}" for n, c in zip(sizes, found, strict=True))
    return Target("all thresholds of Fig. 11 by continuation", seconds, "below", 20.0, "s", detail)


BENCHMARK = Quantity(
    "chain",
    "trajectory of the Van der Pol chain (8)",
    (SCENE,),
    OURS,
    (LOW, HIGH),
    measure,
    style,
)
