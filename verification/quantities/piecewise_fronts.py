"""Fronts of the piecewise-linear chain (44) by direct simulation, beside the kinetic relation.

The range is where a run takes less than a minute: at c = 100 the tails of a front are so long that
a run takes several.
"""

from __future__ import annotations

from collections.abc import Mapping

from theory.piecewise.kinetic_relation import kinetic_relation
from verification.fronts.status import FrontStatus
from verification.piecewise.simulation import simulate_front
from verification.quantities.quantity import Axis, Check, Claim, NoReferenceError, Quantity


def _front(at: Mapping[str, float]) -> Claim:
    found = simulate_front(at["c"], at["eta"])
    if found.status is not FrontStatus.STEADY or found.v is None or found.error is None:
        return Claim(None, 0.0, note=found.status.value, extra=found)
    return Claim(found.v, found.error, extra=found)


def _check_front(at: Mapping[str, float], claim: Claim) -> Check:
    """Compare with the admissible branches of (54); a run that never settles claims nothing."""
    theory = kinetic_relation(at["c"], at["eta"])
    if claim.value is None:
        raise NoReferenceError(f"the run is {claim.note} and claims no velocity.")
    if not theory.branches:
        raise NoReferenceError("a steady run where (54) has no branch.")
    near = min(theory.branches, key=lambda branch: abs(branch.v - claim.value))
    return Check(abs(near.v - claim.value), near.error, "kinetic relation")


QUANTITIES = (
    Quantity(
        "front-velocity",
        "velocity of a front of (44) from event to event",
        (Axis("c", 0.05, 5.0), Axis("eta", 1e-6, 0.125, near=(0.08, 0.125))),
        _front,
        _check_front,
        seconds=60.0,
        share=0.05,
        scenes="relation",
        ends="outside, a run takes several minutes: tails are long, or fronts slow",
    ),
)
