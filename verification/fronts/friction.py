"""Fronts of the friction chain, measured by running it.

The friction chain starts with sites on the stick-slip cycle; a site is reached when it first
sticks. Arrivals are spaced by about one period of the cycle, so that v is a mean over many sites;
hence the coarser default accuracy.
"""

from __future__ import annotations

from theory.cells.friction import check_sliding_stable
from theory.chains.chain import MAX_SITES
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.parameters import ParameterError, count_within, within
from verification.fronts.preparation import FrontPreparation
from verification.fronts.request import RUN, Request
from verification.fronts.result import Front
from verification.fronts.watch import MARGIN
from verification.runs.excite import StartPoint, excite
from verification.runs.friction_integration import FrictionIntegration
from verification.runs.integration import Integration

FRICTION_MAX_SITES = 800

MAX_FRICTION_COUPLING = 1e4
"""Largest coupling for a front of (5). With the default options the run takes 1.4 s of CPU time at
c = 1e3, 11 s at this limit, 105 s at 2e4 and hours at 1e6: steps are as short as 1/√c, each
reversal of the fast waves is an event, and sites stick so rarely that the whole stall time
elapses."""


def checked_friction_sites(sites: int, excited: int, max_sites: int = FRICTION_MAX_SITES) -> int:
    """Return the length tried first, checked to be long enough for a front and not too long.

    Raises
    ------
    ParameterError
        If the length or the number of excited sites is out of range.
    """
    count_within("excited sites", excited, 1, 100)
    least = excited + 3 * MARGIN
    count_within("longest chain, max_sites,", max_sites, least, MAX_SITES)
    remedy = "give such a length: it is doubled until the velocity settles"
    return count_within("number of sites n", sites, least, max_sites, remedy)


def friction_front(chain: FrictionChain, request: Request) -> Front:
    """Measure a front that begins at the first sites of a friction chain."""
    request.reads(*RUN, "point", where="for the friction chain")
    excited = 1 if request.excited is None else request.excited
    max_sites = FRICTION_MAX_SITES if request.max_sites is None else request.max_sites
    checked_friction_sites(chain.sites, excited, max_sites)
    tolerance = 1e-8 if request.tolerance is None else request.tolerance
    within("tolerance", tolerance, 1e-12, 1e-4)
    accuracy = 1e-2 if request.accuracy is None else request.accuracy
    within("accuracy", accuracy, 1e-6, 0.1)
    remedy = "take a smaller one, or simulate a run of limited time: above, a front takes hours"
    within("coupling c of a friction front", chain.c, 0.0, MAX_FRICTION_COUPLING, remedy)
    check_sliding_stable(chain.cell)
    if chain.ends is not Ends.FREE:
        raise ParameterError("ends", chain.ends.value, "free for a front", "use free ends")

    def begin(longer: FrictionChain, each: float) -> Integration:
        sites = range(1, excited + 1)
        if isinstance(request.point, StartPoint):
            start = excite(longer, sites, point=request.point)
        else:
            start = excite(longer, sites, request.point)
        return FrictionIntegration(longer, start, tolerance=each)

    preparation = FrontPreparation(
        sized=lambda sites: chain.replace(sites=sites),
        begin=begin,
        excited=excited,
        sites=chain.sites,
        max_sites=max_sites,
        accuracy=accuracy,
        tolerance=tolerance,
        stall_time=3000.0 if request.stall_time is None else request.stall_time,
        settling_tolerance=1e-4,
        method=FrictionIntegration.method,
    )
    return preparation.front(preparation.settled(request.progress), None, False)
