"""The map of states of Fig. 15: where its boundary of fronts lies, and at what cost.

The value is the coupling c above which the start of Fig. 15 sends a front, at one η, by bisection
of the labels; the error is the distance in c from the true boundary. A bisection claims half of its
last interval. Ours steps until a label is certain, by (8) or by the averaged chain. A user would
hand (8) to scipy's DOP853 until a fixed time and look whether the far end is above the unstable
cycle; beside the boundary no fixed time is enough.

The boundary of reference is ours at 1e-11, to 1e-5; scipy's, told to go on until the far end is
reached or the wait is far beyond the decision, confirms that there is no front at five per cent
less and one at five per cent more: ``agreement`` is these five per cent. Seconds are processor
seconds a boundary.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from time import process_time
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.quantity import Quantity, Tell
from benchmarks.record import Failure, Record, Target, WorkPoint, stamped
from benchmarks.runner import Answer, Contender, Effort, measure_side_by_side
from benchmarks.vdp_peers import right_side
from verification.execution.table import Point
from verification.maps.state import State
from verification.maps.state_map import StateTask
from verification.maps.vdp_rules import DISPLACEMENT, FIGURE_15
from verification.quantities.scenes import Scene, timed

if TYPE_CHECKING:
    from benchmarks.diagram import Style

FULL, AVERAGED = "label sweep, (8)", "label sweep, averaged"
PEER = "scipy until a fixed time"
STEPS = 10
"""Bisections: the interval becomes a thousandth of the first one."""
MARGIN = 0.05
"""The boundary of reference is confirmed to this part of itself."""
LONG = 600.0
"""Slow time of that: five per cent above the boundary the front is through the chain by then."""

Sends = Callable[[float], bool]
"""Whether there is a front at this coupling."""


def measure(quick: bool, tell: Tell) -> Record:
    """Measure every method at every scene."""
    points: list[WorkPoint] = []
    failures: list[Failure] = []
    agreement = {}
    effort = Effort(0.1, 1, 3, 0.2, 20.0) if quick else Effort(1.0, 1, 9, 1.0, 90.0)
    for scene in timed("map")[: 1 if quick else None]:
        tell(f"map at the scene {scene.name}: the references")
        eta, low, high = (scene.values[name] for name in ("eta", "low", "high"))
        task = StateTask(chain=FIGURE_15, tolerance=1e-8 if quick else 1e-11, perturbation=0.0)
        true, _ = boundary(partial(by_us, task, eta), low, high, STEPS if quick else STEPS + 6)
        agreement[scene.name] = (high - low) / 2**STEPS if quick else confirmed(eta, true)
        rows = [each for each in contenders(scene, true) if each.quick or not quick]
        tell(f"map at the scene {scene.name}: {len(rows)} settings")
        done, failed = measure_side_by_side("map", scene.name, rows, effort, process_time)
        points += done
        failures += failed
    command = "fronts bench map" + " --quick" * quick
    return stamped(command, agreement, points, failures, rates(points))


def contenders(scene: Scene, true: float) -> Iterator[Contender]:
    """Yield every method at every setting."""
    eta = scene.values["eta"]
    for method, chain in ((FULL, FIGURE_15), (AVERAGED, FIGURE_15.averaged())):
        for k in (3, 4, 5, 6, 8):
            task = StateTask(chain=chain, tolerance=10.0**-k, perturbation=0.0)
            yield Contender(
                method, f"tolerance 1e-{k}",
                partial(_bisected, scene, partial(by_us, task, eta), chain is FIGURE_15),
                true, quick=k in (4, 6),
            )  # fmt: skip
    for end, k in ((10.0, 3), (30.0, 3), (30.0, 6), (60.0, 3)):
        yield Contender(
            PEER, f"slow time {end:g}, tolerance 1e-{k}",
            partial(_bisected, scene, partial(by_scipy, eta, end, 10.0**-k), False), true,
            quick=end < 20.0, peer=True,
        )  # fmt: skip


def _bisected(scene: Scene, sends: Sends, claims: bool) -> Answer:
    """Return the boundary; half of the last interval is a claim only where labels are certain."""
    found, half = boundary(sends, scene.values["low"], scene.values["high"], STEPS)
    return Answer(found, half if claims else None)


def boundary(sends: Sends, low: float, high: float, steps: int) -> tuple[float, float]:
    """Return the coupling above which there is a front, and half of the last interval.

    Raises
    ------
    ArithmeticError
        If there is a front at both ends or at neither.

    Examples
    --------
    >>> boundary(lambda c: c > 0.3, 0.0, 1.0, 2)
    (0.375, 0.125)
    """
    if sends(low) or not sends(high):
        raise ArithmeticError(f"no boundary of fronts was seen from c = {low:g} to {high:g}")
    for _ in range(steps):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if sends(middle) else (middle, high)
    return 0.5 * (low + high), 0.5 * (high - low)


def by_us(task: StateTask, eta: float, c: float) -> bool:
    """Return whether the label is a front."""
    return task(Point(eta=eta, c=c))["label"] == str(State.FRONT)


def by_scipy(eta: float, end: float, tolerance: float, c: float) -> bool:
    """Return whether the far end of (8) is above the unstable cycle at slow time ``end``."""
    from scipy.integrate import solve_ivp

    chain = StateTask(chain=FIGURE_15).at({"eta": eta, "c": c})
    start = np.zeros(2 * chain.sites)
    start[chain.sites - 1] = DISPLACEMENT
    run = solve_ivp(
        right_side(chain), (0.0, end / chain.eps), start, "DOP853", [end / chain.eps],
        rtol=tolerance, atol=tolerance,
    )  # fmt: skip
    if not run.success:
        raise ArithmeticError(run.message)
    return bool(math.hypot(run.y[0, -1], run.y[chain.sites, -1]) > chain.unstable_amplitude)


def confirmed(eta: float, c: float) -> float:
    """Return to what distance in c scipy confirms a boundary.

    Raises
    ------
    ArithmeticError
        If it does not.
    """
    if patient(eta, c * (1.0 - MARGIN)) or not patient(eta, c * (1.0 + MARGIN)):
        raise ArithmeticError(f"scipy does not confirm a boundary of fronts at c = {c:g}")
    return c * MARGIN


def patient(eta: float, c: float) -> bool:
    """Return whether the far end is reached by slow time `LONG`, by scipy's stepper."""
    from scipy.integrate import DOP853

    chain = StateTask(chain=FIGURE_15).at({"eta": eta, "c": c})
    start = np.zeros(2 * chain.sites)
    start[chain.sites - 1] = DISPLACEMENT
    solver = DOP853(right_side(chain), 0.0, start, LONG / chain.eps, rtol=1e-6, atol=1e-6)
    while solver.status == "running":
        solver.step()
        if math.hypot(solver.y[0], solver.y[chain.sites]) > chain.unstable_amplitude:
            return True
    return False


def rates(points: list[WorkPoint]) -> list[Target]:
    """Return boundaries a second of each setting."""
    return [
        Target(
            f"{point.method}, {point.knob}, {point.scene}", 1.0 / point.seconds, "no target", None,
            "boundaries a second", f"off by {point.error:.1e} in c",
        )
        for point in points
    ]  # fmt: skip


def style() -> Style:
    """Return how the diagram is drawn."""
    from benchmarks.diagram import Style

    return Style(
        "distance in c from the boundary of fronts (right is better)",
        "processor seconds a boundary",
        "Error against run time of the boundary of fronts in the map of Fig. 15, by bisection of "
        "labels to a thousandth of the interval.",
        {FULL: ("blue", "o"), AVERAGED: ("green", "^"), PEER: ("vermilion", "s")},
        0.5,
        1e-6,
    )


def _first(method: str) -> bool:
    """Return one label of the first scene."""
    eta = timed("map")[0].values["eta"]
    if method == FULL:
        return by_us(StateTask(chain=FIGURE_15, perturbation=0.0), eta, 0.5)
    return by_scipy(eta, 10.0, 1e-3, 0.5)


BENCHMARK = Quantity(
    "map",
    "boundary of fronts in the map of Fig. 15",
    FULL,
    (1e-3, 0.3),
    measure,
    style,
    others={AVERAGED: "the averaged chain (43), whose boundary differs by a term of order eps"},
    first={name: partial(_first, name) for name in (FULL, PEER)},
)
