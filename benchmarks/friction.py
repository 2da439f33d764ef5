"""The friction chain by three families, error against run time.

The first site excited. Event-exact Taylor steps; the switch model of the
paper, fixed and adaptive; regularised friction through scipy's LSODA, Radau and BDF. The error is
the largest of y over 201 times and all sites, against the event-exact run at 1e-13, which is itself
compared with scipy's DOP853 with events: the record states by how much they differ. Times are
seconds of processor time, one thread each.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from time import process_time
from typing import TYPE_CHECKING

from benchmarks.equal_error import least_factor
from benchmarks.quantity import Quantity, Tell
from verification.quantities.scenes import timed

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    from benchmarks.diagram import Style
    from benchmarks.record import Failure, Record, Target, WorkPoint
    from benchmarks.runner import Answer, Contender
    from theory.chains.friction import FrictionChain
    from verification.quantities.scenes import Scene

    FloatArray = npt.NDArray[np.float64]

SAMPLES = 201
QUANTITY = "largest error of y"
GARBAGE = 0.1
"""An error beyond this is no answer: the amplitude of the cycle is 1.4."""

EXACT, FIXED, ADAPTIVE = "event-exact", "switch, fixed steps", "switch, adaptive"
STATED = "event-exact, error stated"
WIDTHS = (1e-2, 1e-3, 1e-4)
TOLERANCES = (1e-3, 1e-5, 1e-7)


def style() -> Style:
    """Return how the diagram is drawn."""
    from benchmarks.diagram import Style

    return Style(
        "largest error of y (right is better)",
        "processor seconds a run",
        "Error against run time, friction chain, N = 31. Pale: settings that another one "
        "of the same method beats. Grey: errors of the order of the motion itself.",
        {
            EXACT: ("blue", "o"),
            STATED: ("blue", "P"),
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
    from verification.references.friction_events import run_events
    from verification.runs.excite import excite
    from verification.runs.simulate import simulate

    effort = Effort(0.1, 1, 9, 0.2, 10.0) if quick else Effort(0.2, 3, 21, 0.4, 60.0)
    points: list[WorkPoint] = []
    failures: list[Failure] = []
    agreement = {}
    waited = 0.0
    for scene in timed("friction")[: 1 if quick else None]:
        chain = chain_of(scene)
        end = scene.values["t"]
        start = excite(chain, [1])
        tell(f"friction at the scene {scene.name}: the references")
        reference = simulate(
            chain, start, end, tolerance=1e-13, samples=SAMPLES, logged_events=10_000
        )
        second = run_events(chain, start, end)
        if len(second.log) != reference.event_count:
            raise ArithmeticError("the two references do not have the same events")
        agreement[scene.name] = float(np.abs(second.y - reference.y).max())
        waited += second.seconds
        # What only shows that stiffness makes it worse is measured at fewer settings.
        rows = contenders(chain, start, reference.y, end, quick or "ordinary" not in scene.tags)
        tell(f"friction at the scene {scene.name}: {len(rows)} settings")
        # Processor time, so that other work on a shared machine does not count.
        done, failed = measure_side_by_side(QUANTITY, scene.name, rows, effort, process_time)
        points += done
        failures += failed
    command = "fronts bench friction" + " --quick" * quick
    ordinary = [point for point in points if point.scene == timed("friction")[0].name]
    return record.stamped(
        command, agreement, points, failures,
        (*targets(ordinary), _second_reference(waited)),
    )  # fmt: skip


def chain_of(scene: Scene) -> FrictionChain:
    """Return the chain of a scene."""
    from theory.chains.friction import FrictionChain

    return FrictionChain(c=scene.c, sites=int(scene.values["sites"]))


def contenders(
    chain: FrictionChain, start: FloatArray, true: FloatArray, end: float, quick: bool
) -> list[Contender]:
    """Return every method at every setting."""
    from benchmarks.runner import Contender
    from verification.references.regularised import Solver

    rows = [
        Contender(EXACT, f"tolerance {each:g}", partial(_exact, chain, start, true, end, each), 0.0)
        for each in (1e-3, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12)
    ]
    rows += [
        Contender(
            STATED, f"tolerance {each:g}", partial(_exact, chain, start, true, end, each, True), 0.0
        )
        for each in (1e-6, 1e-8, 1e-10)
    ]
    rows += [
        Contender(
            FIXED, f"step {step:g}, band {band:g}",
            partial(_switch, chain, start, true, end, {"step": step, "band": band}), 0.0,
        )
        for step in ((1e-1, 1e-2, 1e-3) if quick else (1e-1, 3e-2, 1e-2, 1e-3, 1e-4))
        for band in (1e-4,)
    ]  # fmt: skip
    rows += [
        Contender(
            ADAPTIVE, f"relative {relative:g}, band {band:g}",
            partial(
                _switch, chain, start, true, end,
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
                        partial(
                            _regularised, chain, start, true, end, solver.value, delta, tolerance
                        ),
                        0.0, peer=True,
                    )
                )  # fmt: skip
    return rows


def _exact(
    chain: FrictionChain,
    start: FloatArray,
    true: FloatArray,
    end: float,
    tolerance: float,
    stated: bool = False,
) -> Answer:
    from verification.runs.simulate import simulate

    run = simulate(chain, start, end, tolerance=tolerance, samples=SAMPLES, estimate_error=stated)
    return _answer(run.y, true, run.error)


def _switch(
    chain: FrictionChain,
    start: FloatArray,
    true: FloatArray,
    end: float,
    options: dict[str, float],
) -> Answer:
    from verification.references.switch_model import run_switch

    run = run_switch(chain, start, end, samples=SAMPLES, **options)
    if run.reached < end:
        raise ArithmeticError(f"gave up at tau = {run.reached:.4g}")
    return _answer(run.y, true)


def _regularised(
    chain: FrictionChain,
    start: FloatArray,
    true: FloatArray,
    end: float,
    solver: str,
    delta: float,
    tolerance: float,
) -> Answer:
    from verification.references.regularised import Solver, run_regularised

    run = run_regularised(
        chain, start, end, solver=Solver(solver), delta=delta, tolerance=tolerance,
        samples=SAMPLES,
    )  # fmt: skip
    if not run.finished:
        raise ArithmeticError("the solver gave up")
    return _answer(run.y, true)


def _answer(y: FloatArray, true: FloatArray, claimed: float | None = None) -> Answer:
    """Return the largest error as the value; its reference is zero."""
    import numpy as np

    from benchmarks.runner import Answer

    error = float(np.abs(y - true).max())
    if not np.isfinite(error):
        raise ArithmeticError("the result is not finite")
    return Answer(error, claimed)


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


def _second_reference(seconds: float) -> Target:
    from benchmarks.record import Target

    detail = "scipy's DOP853 with events at 1e-13, which shares no code"
    return Target("the second reference", seconds, "no target", None, "s", detail)


def _first(method: str) -> None:
    """Run a tenth of the ordinary scene, compared with nothing."""
    import numpy as np

    from verification.runs.excite import excite

    scene = timed("friction")[0]
    chain = chain_of(scene)
    start, end = excite(chain, [1]), 0.1 * scene.values["t"]
    nothing = np.zeros((SAMPLES, chain.sites))
    if method == EXACT:
        _exact(chain, start, nothing, end, 1e-8)
    else:
        _regularised(chain, start, nothing, end, method.removeprefix("scipy "), 1e-3, 1e-5)


BENCHMARK = Quantity(
    "friction",
    "trajectory of the friction chain (5)",
    EXACT,
    (1e-8, GARBAGE),
    measure,
    style,
    (STATED,),
    first={name: partial(_first, name) for name in (EXACT, "scipy LSODA", "scipy BDF")},
)
