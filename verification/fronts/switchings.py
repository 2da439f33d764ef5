"""Fronts of the piecewise-linear chain (44), advanced exactly from one switching to the next."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from theory.chains.piecewise import PiecewiseChain
from theory.parameters import count_within, within
from verification.fronts.result import Front

if TYPE_CHECKING:
    from verification.piecewise.run import FrontRun


def front_by_switchings(
    chain: PiecewiseChain, *, accuracy: float, max_sites: int, **start: Any
) -> Front:
    """Return the front of (44), advanced exactly from one switching to the next.

    Parameters
    ----------
    chain : PiecewiseChain
        Coupling and η.
    accuracy : float
        Relative spread of the period at which the motion counts as steady.
    max_sites : int
        Largest number of sites that the front may pass.
    **start
        Further parameters of `verification.piecewise.simulation.simulate_front`.

    Raises
    ------
    ParameterError
        If a value is out of range.
    """
    from verification.piecewise.simulation import PERIODS, TOLERANCES, simulate_front

    run = simulate_front(
        chain.c,
        chain.eta,
        tolerance=within("accuracy", accuracy, *TOLERANCES),
        max_periods=count_within("most sites passed, max_sites,", max_sites, *PERIODS),
        **start,
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
