"""The possible states of a chain, and the result of a run; the rules are in ``*_rules``."""

from __future__ import annotations

from dataclasses import dataclass, field

from theory.arrays import FloatArray
from theory.result import Result
from theory.status import Status


class State(Status):
    """The state of a chain at the end of a run."""

    FRONT = "front", "the disturbance has filled the chain and persists."
    BREATHER = "breather", "some sites continue to oscillate steadily, and no further one joins."
    FIXED_POINT = "fixed point", "the chain is certain to be at rest for ever."
    UNDECIDED = "undecided", "none of the rules applied in time; the reason is stated."


class Reason(Status):
    """Why a state was assigned, or why it is undecided."""

    DECIDED = "decided", "a rule applied, in the first half of the time."
    END_TIME = "end time", "no rule applied in the first half of the time: take a later end time."
    PERTURBATION = "perturbation", "a perturbed start leads to another state: a boundary is close."
    UNSTABLE_BACKGROUND = (
        "unstable background",
        "it looks like a breather, but the sites around it cannot remain at rest.",
    )


@dataclass(frozen=True, kw_only=True)
class FoundState(Result):
    """The result of one run.

    Attributes
    ----------
    state : State
        State of the chain.
    reason : Reason
        Whether a rule applied and, if not, why not.
    time : float
        Time at which the state was certain, or at which the run was stopped: slow time for (8) and
        (43), τ for (5), t for any other chain.
    above : int
        Sites above the level at the end (for friction, sites that stuck in the last window).
    reached : int or None
        Number of sites that were reached at some time, if counted.
    steps : int
        Number of steps.
    amplitude : float array, shape (N,)
        Amplitude of every site at the end: √(y² + w²), |φ| for (43); for (5) half of the last
        maximum of y minus the last minimum; no error is known.
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
