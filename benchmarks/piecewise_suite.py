"""All benchmarks of the piecewise-linear front: Σ beside its peers, and the promised speeds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from benchmarks.piecewise_sum import QUANTITY, SCENES, References, contenders, references
from benchmarks.piecewise_targets import batch_target, other_targets, ratio_targets
from benchmarks.record import Failure, Target, WorkPoint
from benchmarks.runner import Effort, measure_side_by_side
from verification.scenes import scene_named

FULL = Effort()
QUICK = Effort(seconds=0.1, fewest=2, most=9, patience=1.0, limit=10.0)


@dataclass(frozen=True)
class Measured:
    """What one suite found; see ``benchmarks.record``."""

    agreement: dict[str, float]
    points: tuple[WorkPoint, ...]
    failures: tuple[Failure, ...]
    targets: tuple[Target, ...]


def measure(
    quick: bool, scenes: Sequence[str] = SCENES, tell: Callable[[str], None] = lambda _: None
) -> Measured:
    """Measure every method at the scenes, then the targets.

    Parameters
    ----------
    quick : bool
        Fewer settings and repeats; within a minute.
    scenes : sequence of str
        Names out of ``verification.scenes``. Ratios to peers are taken at each.
    tell : callable
        Told what is being done.
    """
    points: list[WorkPoint] = []
    failures: list[Failure] = []
    agreement: dict[str, float] = {}
    for name in scenes:
        tell(f"{QUANTITY} at the scene {name}")
        scene = scene_named(name)
        known = references(scene.v, scene.c)
        agreement[name] = known.apart
        taking_part = [each for each in contenders(scene, known) if each.quick or not quick]
        done, failed = measure_side_by_side(QUANTITY, name, taking_part, QUICK if quick else FULL)
        points += done
        failures += failed
    tell("promised speeds")
    ratios = [row for name in scenes for row in ratio_targets(points, name)]
    targets = (batch_target(quick), *ratios, *other_targets(quick))
    return Measured(agreement, tuple(points), tuple(failures), targets)


def methods() -> list[str]:
    """Return every method and setting, for a listing."""
    scene = scene_named(SCENES[0])
    return [f"{each.method:24} {each.knob}" for each in contenders(scene, References(0j, 0j))]
