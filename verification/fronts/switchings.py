"""Fronts of the piecewise-linear chain (44), advanced exactly from one switching to the next."""

from __future__ import annotations

from typing import Literal

from theory.chains.piecewise import PiecewiseChain
from theory.parameters import with_ranges
from verification.fronts.result import Front
from verification.piecewise.run import FrontRun
from verification.piecewise.simulation import (
    ACCURACIES,
    ACCURACY,
    MAX_SITES,
    MAX_SITES_RANGE,
    simulate_front,
)


@with_ranges(accuracy=ACCURACIES, max_sites=MAX_SITES_RANGE)
def front_by_switchings(
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
        Initial state. Moving: a travelling wave, by default five per cent faster than the fastest
        that is compatible with the threshold; resting: the static front; step: phi = 1 up to site 0
        and 0 beyond, whose own relaxation can launch a front below c_pin.
    start_v : float, optional
        Velocity of a moving initial state; negative for a retreating front.
    accuracy : float, optional
        Relative spread of the period below which the motion counts as steady, {accuracy}.
    max_sites : int, optional
        Number of sites after which a front that has not settled is given up, {max_sites}.

    Returns
    -------
    Front

    Raises
    ------
    ParameterError
        If a value is out of range.
    """
    run = simulate_front(
        chain.c, chain.eta, start, start_velocity=start_v, accuracy=accuracy, max_sites=max_sites
    )
    return front_of_switchings(chain, run)


def front_of_switchings(chain: PiecewiseChain, run: FrontRun) -> Front:
    """Return the front that results from a run of (44) from switching to switching."""
    return Front(
        chain=chain,
        status=run.status,
        v=run.v,
        error=run.error,
        excited=None,
        left_boundary=None,
        outruns_waves=False,
        arrivals=run.crossing_times,
        method=run.method,
        counts={"events": run.events, "grazes": run.grazes, "window": run.window},
        seconds=run.seconds,
        detail=run,
    )
