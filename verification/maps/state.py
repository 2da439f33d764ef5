"""What may become of a chain, and what a run has shown; the rules stand in ``*_rules``."""

from __future__ import annotations

from dataclasses import dataclass, field

from theory.arrays import FloatArray
from theory.result import Result
from theory.status import Status


class State(Status):
    """What became of a chain."""

    FRONT = "front", "the disturbance has filled the chain, which stays filled."
    BREATHER = "breather", "some sites oscillate on, steadily, and no further one joins."
    FIXED_POINT = "fixed point", "the chain is certain to be at rest for ever."
    UNDECIDED = "undecided", "none of the rules applied in time; the reason is beside it."


class Reason(Status):
    """Why a state is what it is said to be, or why it is undecided."""

    DECIDED = "decided", "a rule applied, in the first half of the time."
    END_TIME = "end time", "no rule applied by half of the end time: take a later one."
    PERTURBATION = "perturbation", "a perturbed start has another state: a boundary is close."
    UNSTABLE_BACKGROUND = (
        "unstable background",
        "it looks like a breather, but the sites at rest around it cannot stay there.",
    )


@dataclass(frozen=True, kw_only=True)
class FoundState(Result):
    """What one run has shown.

    Attributes
    ----------
    state : State
        What became of the chain.
    reason : Reason
        Whether a rule applied, and if not, why not.
    time : float
        Time at which the state was certain, or at which the run was given up: slow time of (8) and
        (43), τ of (5), t of any other chain.
    above : int
        Sites above the level (stuck in the last window, for friction) at the end.
    reached : int or None
        Sites that were reached at some time, where that is counted.
    steps : int
        Steps taken.
    amplitude : float array, shape (N,)
        Of every site at the end: √(y² + w²), |φ| of (43); of (5) half of the last maximum of y
        minus the last minimum.
    seconds : float
        Run time.
    """

    state: State
    reason: Reason
    time: float
    above: int
    reached: int | None = None
    steps: int
    amplitude: FloatArray = field(metadata={"json": None})
    seconds: float
