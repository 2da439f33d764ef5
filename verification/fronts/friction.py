"""Fronts of the friction chain, measured by running it.

The friction chain starts with sites on the stick-slip cycle; a site is reached when it first
sticks. Arrivals are spaced by about one period of the cycle, so that v is a mean over many sites;
hence the coarser default accuracy. At strong coupling the front passes many sites in each of these
periods and stands still in between. Arrivals of one or two periods can lie on a line of another
slope by chance; the chain is made so long that the front travels on it for several periods.
"""

from __future__ import annotations

import math

from theory.cells.friction import check_sliding_stable
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.parameters import ParameterError, Range, count_within, within
from verification.fronts.preparation import FrontPreparation
from verification.fronts.request import RUN, Option, Request, longest_chain, stall_time
from verification.fronts.result import Front
from verification.fronts.watch import MARGIN
from verification.runs.excite import StartPoint, excite
from verification.runs.friction_integration import FrictionIntegration
from verification.runs.integration import Integration

ACCURACY = Option(quantity="accuracy", allowed=Range(1e-6, 0.1), default=1e-2)
TOLERANCE = Option(quantity="tolerance", allowed=Range(1e-12, 1e-4), default=1e-8)
EXCITED = Option(quantity="excited sites", allowed=Range(1, 100), default=1)
STALL_TIME = stall_time(3000.0)
LONGEST = 800
"""Default length of the longest chain."""
MORE_SITES = 3 * MARGIN
"""Fewest sites of a chain in addition to the excited ones."""

TEN_PERIODS = 20.0 * math.pi
"""Time τ within which a front is not steady: ten periods of free oscillation, so that the half of
the arrivals to which v is fitted contains four at least."""

MAX_FRICTION_COUPLING = 1e4
"""Largest coupling for a front of (5). With the default options the run takes 1.4 s of CPU time at
c = 1e3, 11 s at this limit, 105 s at 2e4 and hours at 1e6: steps are as short as 1/√c, each
reversal of the fast waves is an event, and sites stick so rarely that the whole stall time
elapses."""


def friction_front(chain: FrictionChain, request: Request) -> Front:
    """Measure a front that begins at the first sites of a friction chain."""
    request.reads(*RUN, "point", where="for the friction chain")
    accuracy = ACCURACY.number(request.accuracy)
    tolerance = TOLERANCE.number(request.tolerance)
    excited = EXCITED.count(request.excited)
    least = excited + MORE_SITES
    max_sites = longest_chain(least, LONGEST).count(request.max_sites)
    remedy = "give such a length: it is doubled until the velocity settles"
    count_within("number of sites n", chain.sites, least, max_sites, remedy)
    remedy = (
        "take a smaller coupling, or simulate a run of limited time: above, a front takes hours"
    )
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
        stall_time=STALL_TIME.number(request.stall_time),
        settling_tolerance=1e-4,
        kind=FrictionIntegration,
        settling_time=TEN_PERIODS,
    )
    return preparation.front(preparation.settled(request.progress), None, False)
