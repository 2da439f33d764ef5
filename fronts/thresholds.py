"""The threshold of a friction chain as the shell asks for it: with the point of the cycle."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Literal

from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus
from theory.parameters import ParameterError
from verification.execution.progress import ProgressCallback
from verification.runs.excite import StartPoint, cycle_point
from verification.thresholds.result import RunThreshold
from verification.thresholds.threshold import threshold


@dataclass(frozen=True, kw_only=True)
class SpreadingThreshold(RunThreshold):
    """The threshold of a friction chain, with what it is a threshold of.

    Attributes
    ----------
    ends : str
        Ends of the chain.
    start_point : str
        Point of the cycle from which the excited sites started.
    """

    ends: str
    start_point: str


def spreading_threshold(
    chain: FrictionChain,
    nucleus: Nucleus = Nucleus(1),  # noqa: B008  (frozen)
    *,
    definition: Literal["first", "several", "whole"] = "first",
    final_time: float = 1000.0,
    start_point: StartPoint = StartPoint.MAXIMUM,
    accuracy: float = 1e-6,
    lowest: float = 1e-3,
    highest: float = 0.5,
    progress: ProgressCallback | None = None,
) -> SpreadingThreshold:
    """Return the coupling from which on a nucleus of the friction chain spreads.

    Parameters
    ----------
    chain : FrictionChain
        Its coupling is not used.
    nucleus : Nucleus, optional
        Size and place; the sites start in phase.
    definition : {"first", "several", "whole"}, optional
        What counts as spreading: one new site sticks, three on each side, all sites.
    final_time : float, optional
        τ by which it must have happened, from 1 to 1e6.
    start_point : StartPoint, optional
        Point of the cycle from which excited sites start.
    accuracy : float, optional
        Width of the bracket.
    lowest : float, optional
        Lowest coupling tried.
    highest : float, optional
        Highest coupling tried.
    progress : callable, optional
        Called with the fraction done, as far as it can be foreseen.

    Returns
    -------
    SpreadingThreshold

    Raises
    ------
    ParameterError
        If a value is out of range, or no threshold lies between the two couplings.
    """
    if set(nucleus.pattern) - {"0"}:
        raise ParameterError(
            "pattern", nucleus.pattern, "absent for the friction chain, whose sites start in phase",
            "leave it out",
        )  # fmt: skip
    other = start_point is not StartPoint.MAXIMUM
    found = threshold(
        chain,
        nucleus,
        definition=definition,
        final_time=final_time,
        lowest=lowest,
        highest=highest,
        accuracy=accuracy,
        displacement=cycle_point(chain.cell, start_point) if other else None,
        progress=progress,
    )
    values = {each.name: getattr(found, each.name) for each in dataclasses.fields(found)}
    return SpreadingThreshold(**values, ends=chain.ends.value, start_point=start_point.value)
