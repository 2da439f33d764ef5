"""The front of the piecewise-linear chain by direct simulation, for the command line."""

from __future__ import annotations

from typing import Literal

from theory.chains.piecewise import PiecewiseChain
from theory.parameters import with_ranges
from verification.fronts.result import Front
from verification.piecewise.simulation import ACCURACIES, ACCURACY, MAX_SITES, PERIODS


@with_ranges(accuracy=ACCURACIES, max_sites=PERIODS.low)
def piecewise_front(
    chain: PiecewiseChain,
    *,
    start: Literal["moving", "resting", "step"] = "moving",
    start_v: float | None = None,
    accuracy: float = ACCURACY,
    max_sites: int = MAX_SITES,
) -> Front:
    """Return the front of (44), integrated exactly from one switching to the next.

    Parameters
    ----------
    chain : PiecewiseChain
        The chain.
    start : {"moving", "resting", "step"}, optional
        Initial state. Moving: a travelling wave, close to the fastest possible one; resting: the
        static front; step: phi = 1 up to site 0 and 0 beyond.
    start_v : float, optional
        Velocity of a moving initial state; negative for a retreating front.
    accuracy : float, optional
        Relative spread of the period below which the motion counts as steady, {accuracy}.
    max_sites : int, optional
        Largest number of sites that the front may pass, at least {max_sites}.

    Returns
    -------
    Front

    Raises
    ------
    ParameterError
        If a value is out of range.
    """
    from verification.fronts.switchings import front_by_switchings

    return front_by_switchings(
        chain, accuracy=accuracy, max_sites=max_sites, start=start, start_velocity=start_v
    )
