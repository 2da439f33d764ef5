"""The map of states of Fig. 15: the boundary of fronts, and the cost of finding it.

The value is the coupling c above which the initial state of Fig. 15 produces a front, at one η, by
bisection of the states; the error is the distance in c from the true boundary. A bisection states
half of its last interval as its error. Our methods integrate (8) or the averaged chain until the
state is certain. A user would otherwise integrate (8) with scipy's DOP853 to a fixed time and check
whether the far end is above the unstable cycle; close to the boundary no fixed time is long enough.

The reference boundary is ours at tolerance 1e-11, to 1e-5. scipy, run until the far end is reached
or until long after the state is decided, confirms that there is no front at a coupling five per
cent smaller and that there is one at a coupling five per cent larger: ``agreement`` is these five
per cent. Times are seconds of processor time per boundary.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial

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
from verification.execution.points import Point
from verification.maps.state import State
from verification.maps.task import StateTask
from verification.maps.vdp_rules import DISPLACEMENT, FIGURE_15
from verification.quantities.problems import Problem, timed
from verification.references.equations import full_rate
from verification.references.pace import last_state

FULL, AVERAGED = "label sweep, (8)", "label sweep, averaged"
PEER = "scipy until a fixed time"
STEPS = 10
"""Number of bisections, which reduce the interval to a thousandth of its initial length."""
MARGIN = 0.05
"""Relative distance to which the reference boundary is confirmed."""
LONG = 600.0
"""Slow time of that confirmation, by which a front at c above by MARGIN has crossed the chain."""

Sends = Callable[[float], bool]
"""Whether there is a front at the given coupling."""


def prepare(problem: Problem, quick: bool, report: Report) -> Prepared:
    """Return the settings of all methods, and how well the reference boundary is confirmed."""
    eta, low, high = (problem[name] for name in ("eta", "low", "high"))
    task = StateTask(chain=FIGURE_15, tolerance=1e-8 if quick else 1e-11, perturbation=0.0)
    true, _ = boundary(partial(by_us, task, eta), low, high, STEPS if quick else STEPS + 6)
    agreement = (high - low) / 2**STEPS if quick else confirmed(eta, true)
    return Prepared(agreement=agreement, settings=[*_ours(problem, true), *_peers(problem, true)])


def _ours(problem: Problem, true: float) -> Iterator[Setting]:
    for method, chain in ((FULL, FIGURE_15), (AVERAGED, FIGURE_15.averaged())):
        for k in (3, 4, 5, 6, 8):
            task = StateTask(chain=chain, tolerance=10.0**-k, perturbation=0.0)
            sends = partial(by_us, task, problem["eta"])
            yield Setting(
                method=method, knob=f"tolerance 1e-{k}", reference=true, quick=k in (4, 6),
                evaluate=partial(_bisected, problem, sends, chain is FIGURE_15),
            )  # fmt: skip


def _peers(problem: Problem, true: float) -> Iterator[Setting]:
    for end, k in ((10.0, 3), (30.0, 3), (30.0, 6), (60.0, 3)):
        sends = partial(by_scipy, problem["eta"], end, 10.0**-k)
        yield Setting(
            method=PEER, knob=f"slow time {end:g}, tolerance 1e-{k}", reference=true,
            evaluate=partial(_bisected, problem, sends, False), quick=end < 20.0, peer=True,
        )  # fmt: skip


def _bisected(problem: Problem, sends: Sends, claims: bool) -> MethodAnswer:
    """Return the boundary, with half of the last interval as its error if states are certain."""
    found, half = boundary(sends, problem["low"], problem["high"], STEPS)
    return MethodAnswer(value=found, claimed=half if claims else None)


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
    """Return whether the state is a front."""
    return task(Point(eta=eta, c=c))["label"] == str(State.FRONT)


def by_scipy(eta: float, end: float, tolerance: float, c: float) -> bool:
    """Return whether the far end of (8) is above the unstable cycle at slow time ``end``."""
    chain = StateTask(chain=FIGURE_15).at({"eta": eta, "c": c})
    start = np.zeros(2 * chain.sites)
    start[chain.sites - 1] = DISPLACEMENT
    span = end / chain.eps
    state = last_state(full_rate(chain), span, start, tolerance, tolerance, t_eval=[span])
    return bool(math.hypot(state[0], state[chain.sites]) > chain.unstable_amplitude)


def confirmed(eta: float, c: float) -> float:
    """Return the distance in c to which scipy confirms a boundary.

    Raises
    ------
    ArithmeticError
        If scipy does not confirm it.
    """
    if reaches_the_end(eta, c * (1.0 - MARGIN)) or not reaches_the_end(eta, c * (1.0 + MARGIN)):
        raise ArithmeticError(f"scipy does not confirm a boundary of fronts at c = {c:g}")
    return c * MARGIN


def reaches_the_end(eta: float, c: float) -> bool:
    """Return whether the far end is reached by slow time `LONG`, by scipy's stepper."""
    from scipy.integrate import DOP853

    chain = StateTask(chain=FIGURE_15).at({"eta": eta, "c": c})
    start = np.zeros(2 * chain.sites)
    start[chain.sites - 1] = DISPLACEMENT
    solver = DOP853(full_rate(chain), 0.0, start, LONG / chain.eps, rtol=1e-6, atol=1e-6)
    while solver.status == "running":
        solver.step()
        if math.hypot(solver.y[0], solver.y[chain.sites]) > chain.unstable_amplitude:
            return True
    return False


def _first(method: str) -> bool:
    """Return one state of the first test problem."""
    eta = timed("map")[0]["eta"]
    if method == FULL:
        return by_us(StateTask(chain=FIGURE_15, perturbation=0.0), eta, 0.5)
    return by_scipy(eta, 10.0, 1e-3, 0.5)


BENCHMARK = WorkPrecision(
    name="map",
    prepare=prepare,
    effort=Effort(min_repeats=1, max_repeats=9, once_from=1.0, limit=90.0),
    quick_effort=Effort(seconds=0.1, min_repeats=1, max_repeats=3, once_from=0.2, limit=20.0),
    style=Style(
        xlabel="distance in c from the boundary (right is better)",
        ylabel="processor seconds per boundary",
        caption="Error against run time of the boundary of fronts in the map of Fig. 15, by "
        "bisection of states to a thousandth of the interval.",
        methods={FULL: ("blue", "o"), AVERAGED: ("green", "^"), PEER: ("vermilion", "s")},
        garbage=0.5,
        floor=1e-6,
    ),
    others={AVERAGED: "the averaged chain (43), whose boundary differs by a term of order eps"},
    first={name: partial(_first, name) for name in (FULL, PEER)},
)
