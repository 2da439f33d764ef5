"""Fronts of the piecewise-linear chain (44), advanced exactly from one switching to the next."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from theory.chains.piecewise import PiecewiseChain
from verification.fronts.result import Front

if TYPE_CHECKING:
    from verification.piecewise.run import FrontRun


def front_by_switchings(chain: PiecewiseChain, **options: Any) -> Front:
    """Return the front of (44), advanced exactly from one switching to the next.

    Parameters
    ----------
    chain : PiecewiseChain
        Coupling and η.
    **options
        Further parameters of `verification.piecewise.simulation.simulate_front`.

    Raises
    ------
    ParameterError
        If a value is out of range.
    """
    from verification.piecewise.simulation import simulate_front

    run = simulate_front(chain.c, chain.eta, **options)
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
