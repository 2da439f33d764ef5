"""Boundary conditions: what the two ends of a chain are coupled to."""

from __future__ import annotations

from theory.status import Status


class Ends(Status):
    """What the end sites of a chain are coupled to."""

    FREE = "free", "One neighbour only: the coupling of site 1 is c(y_1 - y_2)."
    PERIODIC = "periodic", "The two ends are neighbours of each other, as in (40): a ring."
    LITERAL = (
        "literal",
        "The missing neighbours are zero, as (5) stands: the coupling of site 1 is c(2y_1 - y_2), "
        "a spring to a wall.",
    )
    FIXED = "fixed", "The missing neighbours are held at rest: springs to walls at both ends."
