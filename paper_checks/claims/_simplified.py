"""What Figs. 16 to 18 share: the two ways to a front of the simplified model (44)."""

from __future__ import annotations

from paper_checks.claim import Method

KINETIC = Method(
    "all solutions of (54), by the sum as one integral over a period",
    "theory.piecewise.kinetic_relation:kinetic_relation",
)
CHAIN = Method(
    "direct simulation of (44), exact between crossings",
    "verification.piecewise.simulation:simulate_front",
)
