"""The map of states of Fig. 15, at a few points: how many labels are right, and at what cost.

The error is the part of the points with another label than the reference. Ours steps until a label
is certain, by (8) or by the averaged chain. A user would hand (8) to scipy's DOP853 until a fixed
time and look at the amplitudes there: above the unstable cycle at the far end is a front, only
elsewhere a breather, nowhere a fixed point. The reference of ours is such a run, long and at 1e-6;
that of scipy's is ours at 1e-11; ``agreement`` is the part of the points where these two differ.
Seconds are processor seconds a point.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from time import process_time
from typing import TYPE_CHECKING

import numpy as np

from benchmarks.quantity import Quantity, Tell
from benchmarks.record import Record, Target, WorkPoint, stamped
from benchmarks.runner import Answer, Contender, Effort, measure_side_by_side
from benchmarks.vdp_peers import right_side
from verification.label import Label
from verification.sweeps.sweep import sweep
from verification.sweeps.table import Point, grid
from verification.vdp.map import StateTask
from verification.vdp.run import Model

if TYPE_CHECKING:
    from benchmarks.diagram import Style

SCENE = "few points of Fig. 15"
FULL, AVERAGED = "label sweep, (8)", "label sweep, averaged"
PEER = "scipy until a fixed time"
ETAS, COUPLINGS = (0.02, 0.05, 0.08, 0.11), (0.1, 0.9)
LONG = 260.0
"""Slow time of the reference: at c = 0.1, η = 0.02 the front reaches the far end at 217 only."""


def measure(quick: bool, tell: Tell) -> Record:
    """Measure every method over the same points."""
    points = map_points(quick)
    tell(f"map: the references at {len(points)} points")
    end = 40.0 if quick else LONG
    theirs = by_scipy(points, end, 1e-6)
    ours = by_us(points, StateTask(Model.FULL, tolerance=1e-11, perturbation=0.0))
    apart = wrong(theirs, ours)
    rows = [each for each in contenders(points, ours, theirs) if each.quick or not quick]
    tell(f"map: {len(rows)} settings")
    effort = Effort(0.1, 1, 3, 0.2, 20.0) if quick else Effort(1.0, 1, 9, 1.0, 90.0)
    done, failures = measure_side_by_side("map", SCENE, rows, effort, process_time)
    command = "fronts bench map" + " --quick" * quick
    return stamped(command, {SCENE: apart}, done, failures, rates(done))


def map_points(quick: bool) -> tuple[Point, ...]:
    """Return the points, of all three kinds."""
    return grid(eta=ETAS[1::2] if quick else ETAS, c=COUPLINGS)


def contenders(
    points: Sequence[Point], ours: Sequence[str], theirs: Sequence[str]
) -> Iterator[Contender]:
    """Yield every method at every setting."""
    count = len(points)
    for method, model in ((FULL, Model.FULL), (AVERAGED, Model.ENVELOPE)):
        for k in (3, 5, 8):
            for perturbation in (0.0, 1e-6):
                task = StateTask(model, tolerance=10.0**-k, perturbation=perturbation)
                knob = f"tolerance 1e-{k}" + ", run twice" * (perturbation > 0.0)
                yield Contender(
                    method, knob, partial(_ours, points, task, theirs), 0.0, count,
                    quick=perturbation == 0.0,
                )  # fmt: skip
    for end, k in ((10.0, 3), (30.0, 3), (30.0, 6)):
        yield Contender(
            PEER, f"slow time {end:g}, tolerance 1e-{k}",
            partial(_theirs, points, end, 10.0**-k, ours), 0.0, count, quick=end < 20.0, peer=True,
        )  # fmt: skip


def _ours(points: Sequence[Point], task: StateTask, true: Sequence[str]) -> Answer:
    return Answer(wrong(by_us(points, task), true), None)


def _theirs(points: Sequence[Point], end: float, tolerance: float, true: Sequence[str]) -> Answer:
    return Answer(wrong(by_scipy(points, end, tolerance), true), None)


def by_us(points: Sequence[Point], task: StateTask) -> list[str]:
    """Return the labels by the sweep, in this process."""
    return [str(label) for label in sweep(task, points, workers=1)["label"]]


def by_scipy(points: Sequence[Point], end: float, tolerance: float) -> list[str]:
    """Return the labels by the amplitudes of (8) at slow time ``end``."""
    from scipy.integrate import solve_ivp

    task = StateTask()
    labels = []
    for point in points:
        chain = task.chain(point.number("eta"), point.number("c"))
        start = np.zeros(2 * chain.sites)
        start[chain.sites - 1] = task.displacement
        run = solve_ivp(
            right_side(chain), (0.0, end / chain.eps), start, "DOP853", [end / chain.eps],
            rtol=tolerance, atol=tolerance,
        )  # fmt: skip
        if not run.success:
            raise ArithmeticError(run.message)
        above = np.hypot(run.y[: chain.sites, -1], run.y[chain.sites :, -1])
        reached = above > chain.unstable_amplitude
        label = Label.BREATHER if reached.any() else Label.FIXED_POINT
        labels.append(str(Label.FRONT if reached[0] else label))
    return labels


def wrong(found: Sequence[str], true: Sequence[str]) -> float:
    """Return the part of the labels that differ.

    Examples
    --------
    >>> wrong(["front", "breather"], ["front", "fixed point"])
    0.5
    """
    return sum(a != b for a, b in zip(found, true, strict=True)) / len(true)


def rates(points: Sequence[WorkPoint]) -> list[Target]:
    """Return points a second of each setting."""
    return [
        Target(
            f"{point.method}, {point.knob}", 1.0 / point.seconds, "no target", None,
            "points a second", f"{100.0 * point.error:.0f} per cent of the labels differ",
        )
        for point in points
    ]  # fmt: skip


def style() -> Style:
    """Return how the diagram is drawn."""
    from benchmarks.diagram import Style

    return Style(
        "part of the labels that differ",
        "processor seconds a point",
        "Wrong labels against run time, a few points of the map of Fig. 15. None wrong is drawn "
        "at 1e-3.",
        {FULL: ("blue", "o"), AVERAGED: ("green", "^"), PEER: ("vermilion", "s")},
        0.5,
        1e-3,
    )


BENCHMARK = Quantity(
    "map", "labels of the map of Fig. 15", (SCENE,), FULL, (1e-3, 0.3), measure, style
)
