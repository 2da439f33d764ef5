"""The friction chain by three families, error against run time.

N = 31, τ = 200, the first site excited, c = 0.02. Event-exact Taylor steps; the switch model of the
paper, fixed and adaptive; regularised friction through scipy's LSODA, Radau and BDF. The error is
the largest of y over 201 times and all sites, against the event-exact run at 1e-13, which is itself
compared with scipy's DOP853 with events: the record states by how much they differ. Times are
seconds of processor time, one thread each.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from time import perf_counter, process_time
from typing import TYPE_CHECKING

from benchmarks.equal_error import least_factor
from benchmarks.quantity import Quantity, Tell

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from benchmarks.diagram import Style
    from benchmarks.record import Record, Target, WorkPoint
    from benchmarks.runner import Answer, Contender
    from theory.friction_chain import FrictionChain

    FloatArray = npt.NDArray[np.float64]

SITES, T_END, COUPLING, SAMPLES = 31, 200.0, 0.02, 201
SCENE = "N = 31, tau = 200"
QUANTITY = "largest error of y"
GARBAGE = 0.1
"""An error beyond this is no answer: the amplitude of the cycle is 1.4."""

EXACT, FIXED, ADAPTIVE = "event-exact", "switch, fixed steps", "switch, adaptive"
WIDTHS = (1e-2, 1e-3, 1e-4)
TOLERANCES = (1e-3, 1e-5, 1e-7)


def style() -> Style:
    """Return how the diagram is drawn."""
    from benchmarks.diagram import Style

    return Style(
        "largest error of y (right is better)",
        "processor seconds a run",
        "Error against run time, friction chain, N = 31, τ = 200. Pale: settings that another one "
        "of the same method beats. Grey: errors of the order of the motion itself.",
        {
            EXACT: ("blue", "o"),
            FIXED: ("green", "^"),
            ADAPTIVE: ("sky", "v"),
            "scipy LSODA": ("vermilion", "s"),
            "scipy Radau": ("orange", "D"),
            "scipy BDF": ("purple", "X"),
        },
        GARBAGE,
    )


def measure(quick: bool, tell: Tell) -> Record:
    """Measure every contender side by side and judge the target."""
    import numpy as np

    from benchmarks import record
    from benchmarks.runner import Effort, measure_side_by_side
    from theory.friction_chain import FrictionChain
    from verification.friction.events import run_events
    from verification.friction.run import run_friction
    from verification.friction.start import nucleus

    chain = FrictionChain(COUPLING, sites=SITES)
    start = nucleus(chain, [1])
    begin = perf_counter()
    run_friction(chain, start, 1.0)
    compiled = perf_counter() - begin
    tell("measuring the reference ...")
    reference = run_friction(chain, start, T_END, tolerance=1e-13, samples=SAMPLES, events=10_000)
    second = run_events(chain, start, T_END)
    if len(second.log) != reference.events:
        raise ArithmeticError("the two references do not have the same events")
    apart = float(np.abs(second.y - reference.y).max())
    rows = contenders(chain, start, reference.y, quick)
    tell(f"measuring {len(rows)} settings ...")
    effort = Effort(0.1, 1, 9, 0.2, 10.0) if quick else Effort(0.2, 3, 21, 0.4, 60.0)
    # Processor time, so that other work on a shared machine does not count.
    points, failures = measure_side_by_side(QUANTITY, SCENE, rows, effort, process_time)
    command = "fronts bench friction" + " --quick" * quick
    return record.Record(
        command, record.now(), record.this_machine(), record.these_versions(), {SCENE: apart},
        points, failures,
        (*targets(points), _compile_time(compiled), _second_reference(second.seconds)),
    )  # fmt: skip


def contenders(
    chain: FrictionChain, start: FloatArray, true: FloatArray, quick: bool
) -> list[Contender]:
    """Return every method at every setting."""
    from benchmarks.runner import Contender
    from verification.friction.regularised import Solver

    rows = [
        Contender(EXACT, f"tolerance {each:g}", partial(_exact, chain, start, true, each), 0.0)
        for each in (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
    ]
    rows += [
        Contender(
            FIXED, f"step {step:g}, band {band:g}",
            partial(_switch, chain, start, true, {"step": step, "band": band}), 0.0,
        )
        for step in ((1e-1, 1e-2, 1e-3) if quick else (1e-1, 3e-2, 1e-2, 1e-3, 1e-4))
        for band in (1e-4,)
    ]  # fmt: skip
    rows += [
        Contender(
            ADAPTIVE, f"relative {relative:g}, band {band:g}",
            partial(
                _switch, chain, start, true,
                {"relative": relative, "absolute": 1e-3 * relative, "band": band},
            ), 0.0,
        )
        for relative in (1e-3, 1e-5, 1e-7)
        for band in ((1e-4,) if quick else (1e-4, 1e-6))
    ]  # fmt: skip
    for solver in Solver:
        for delta in WIDTHS[1:2] if quick else WIDTHS:
            for tolerance in TOLERANCES[1:2] if quick else TOLERANCES:
                rows.append(
                    Contender(
                        f"scipy {solver.value}", f"delta {delta:g}, tolerance {tolerance:g}",
                        partial(_regularised, chain, start, true, solver.value, delta, tolerance),
                        0.0, peer=True,
                    )
                )  # fmt: skip
    return rows


def _exact(chain: FrictionChain, start: FloatArray, true: FloatArray, tolerance: float) -> Answer:
    from verification.friction.run import run_friction

    run = run_friction(chain, start, T_END, tolerance=tolerance, samples=SAMPLES, companion=False)
    return _answer(run.y, true)


def _switch(
    chain: FrictionChain, start: FloatArray, true: FloatArray, options: dict[str, float]
) -> Answer:
    from verification.friction.switch import run_switch

    run = run_switch(chain, start, T_END, samples=SAMPLES, **options)
    if run.reached < T_END:
        raise ArithmeticError(f"gave up at tau = {run.reached:.4g}")
    return _answer(run.y, true)


def _regularised(
    chain: FrictionChain,
    start: FloatArray,
    true: FloatArray,
    solver: str,
    delta: float,
    tolerance: float,
) -> Answer:
    from verification.friction.regularised import Solver, run_regularised

    run = run_regularised(
        chain, start, T_END, solver=Solver(solver), delta=delta, tolerance=tolerance,
        samples=SAMPLES,
    )  # fmt: skip
    if not run.finished:
        raise ArithmeticError("the solver gave up")
    return _answer(run.y, true)


def _answer(y: FloatArray, true: FloatArray) -> Answer:
    """Return the largest error as the value; its reference is zero."""
    import numpy as np

    from benchmarks.runner import Answer

    error = float(np.abs(y - true).max())
    if not np.isfinite(error):
        raise ArithmeticError("the result is not finite")
    return Answer(error, None)


def targets(points: Sequence[WorkPoint]) -> tuple[Target, ...]:
    """Return the least factor, at equal error, by which the event-exact run beats scipy.

    At every error that scipy reaches, short of garbage, its fastest setting that is as exact is
    compared with our fastest setting that is at least as exact.
    """
    from benchmarks.record import Target

    ours = [point for point in points if point.method == EXACT]
    peers = [point for point in points if point.method.startswith("scipy ")]
    garbage = sum(point.error > GARBAGE for point in peers)
    least = least_factor(ours, peers, 0.0, GARBAGE)
    detail = f"{garbage} of {len(peers)} settings of scipy are garbage: error above {GARBAGE:g}"
    if least is not None:
        best = least[1]
        detail = (
            f"scipy's best: {best.method}, {best.knob}: error {best.error:.1e} in "
            f"{best.seconds:.2g} s; {detail}"
        )
    return (
        Target(
            "event-exact against scipy's best, at equal error",
            None if least is None else least[0], "at least", 50.0, "times", detail,
        ),
    )  # fmt: skip


def _compile_time(seconds: float) -> Target:
    from benchmarks.record import Target

    detail = "first call in this process; seconds if compiled before, tens of seconds if not"
    return Target("compilation or loading it", seconds, "no target", None, "s", detail)


def _second_reference(seconds: float) -> Target:
    from benchmarks.record import Target

    detail = "scipy's DOP853 with events at 1e-13, which shares no code"
    return Target("the second reference", seconds, "no target", None, "s", detail)


BENCHMARK = Quantity(
    "friction",
    "trajectory of the friction chain (5)",
    (SCENE,),
    EXACT,
    (1e-8, GARBAGE),
    measure,
    style,
)
