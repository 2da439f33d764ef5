"""All benchmarks of the piecewise-linear front: Σ beside its peers, and the promised speeds."""

from __future__ import annotations

import math
from functools import partial
from time import process_time
from typing import TYPE_CHECKING

from benchmarks.piecewise_peers import by_contour_roots, plain_quad
from benchmarks.piecewise_sum import QUANTITY, contenders, first_batch, references
from benchmarks.piecewise_targets import batch_target, other_targets, ratio_targets
from benchmarks.quantity import Quantity, Tell
from benchmarks.record import Failure, Record, WorkPoint, stamped
from benchmarks.runner import Effort, measure_side_by_side
from verification.quantities.scenes import timed

if TYPE_CHECKING:
    from benchmarks.diagram import Style

FULL = Effort()
QUICK = Effort(seconds=0.1, fewest=2, most=9, patience=1.0, limit=10.0)


def measure(quick: bool, tell: Tell) -> Record:
    """Measure every method at the scenes, then the targets; ratios to peers at each scene."""
    points: list[WorkPoint] = []
    failures: list[Failure] = []
    agreement: dict[str, float] = {}
    for scene in timed(QUANTITY):
        name = scene.name
        tell(f"{QUANTITY} at the scene {name}")
        known = references(scene.v, scene.c)
        agreement[name] = known.apart
        taking_part = [each for each in contenders(scene, known) if each.quick or not quick]
        done, failed = measure_side_by_side(
            QUANTITY, name, taking_part, QUICK if quick else FULL, process_time
        )
        points += done
        failures += failed
    tell("promised speeds")
    ratios = [row for name in agreement for row in ratio_targets(points, name)]
    targets = (batch_target(quick), *ratios, *other_targets(quick))
    command = "fronts bench sum" + " --quick" * quick
    return stamped(command, agreement, points, failures, targets)


def style() -> Style:
    """Return how the diagram is drawn."""
    from benchmarks.diagram import Style

    return Style(
        "error of Σ (right is better)",
        "seconds an evaluation",
        "Error against run time of Σ(v, c). Pale: settings that another one of the same method "
        "beats. Below 1e-16 a double shows nothing.",
        {
            "integral, in a batch": ("blue", "o"),
            "integral, one call": ("sky", "o"),
            "integral, many digits": ("blue", "P"),
            "root series": ("vermilion", "s"),
            "root series, cut off": ("vermilion", "x"),
            "Bessel series": ("green", "^"),
            "quadrature in pieces": ("purple", "D"),
            "scipy.integrate.quad": ("orange", "v"),
            "cxroots, our tail": ("black", "X"),
            "cxroots, cut off": ("black", "+"),
        },
        math.inf,
        1e-51,
    )


FIRST = {
    "integral, in a batch": partial(first_batch, 0.3, 0.5),
    "scipy.integrate.quad": partial(plain_quad, 0.3, 0.5, 1e-8, 1_000),
    "cxroots, our tail": partial(by_contour_roots, 0.3, 0.5, 1, True, {"M": 2}),
}
"""Σ at the ordinary scene."""


BENCHMARK = Quantity(
    "sum",
    "the sum Σ(v, c) of Eq. (53)",
    "integral, in a batch",
    (1e-12, 1e-2),
    measure,
    style,
    ("integral, one call",),
    first=FIRST,
)
