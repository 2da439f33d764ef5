"""Common parts of Figs. 3-6: their chain, and arrivals computed by scipy alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from theory.arrays import FloatArray

if TYPE_CHECKING:
    from theory.chains.friction import FrictionChain

V_D, SITES = 1.25, 31
"""Belt velocity and number of sites of Figs. 3, 4 and 6; the other parameters are in (7)."""


def chain_of(c: float, sites: int = SITES, v_d: float = V_D) -> FrictionChain:
    """Return the chain of the figures."""
    from theory.cells.friction import FrictionCell
    from theory.chains.friction import FrictionChain

    return FrictionChain.of(FrictionCell(v_d=v_d), c=c, sites=sites)


def arrivals_by_scipy(chain: FrictionChain, excited: tuple[int, ...], end: float) -> FloatArray:
    """Return the τ at which each site first sticks, nan if it does not, by DOP853 with events."""
    from verification.references.friction_events import run_events
    from verification.runs.excite import excite

    run = run_events(chain, excite(chain, excited), end, tolerance=1e-9, longest_step=0.5)
    arrivals = np.full(chain.sites, np.nan)
    for time, site, kind in run.log[::-1]:
        if kind == 0:
            arrivals[int(site) - 1] = time
    return arrivals


def arrivals_compiled(chain: FrictionChain, excited: tuple[int, ...], end: float) -> FloatArray:
    """Return the same by the event-exact Taylor stepper."""
    from verification.runs.excite import excite
    from verification.runs.friction_integration import FrictionIntegration

    run = FrictionIntegration(chain, excite(chain, excited), tolerance=1e-10)
    run.advance_to(end)
    return run.arrivals


def disagreement(chain: FrictionChain, excited: tuple[int, ...], end: float) -> float:
    """Return the largest difference in the arrivals between the two computations.

    Raises
    ------
    ArithmeticError
        If it is larger than 1e-3, or only one of them saw an arrival.
    """
    from verification.runs.comparison import difference

    gap = difference(arrivals_by_scipy(chain, excited, end), arrivals_compiled(chain, excited, end))
    if not gap < 1e-3:
        raise ArithmeticError(f"arrivals by scipy and by Taylor steps differ by {gap:.1e}")
    return gap
