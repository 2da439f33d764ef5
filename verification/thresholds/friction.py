"""Critical coupling of Model I (Fig. 4): the coupling from which on a nucleus spreads.

The number depends on what counts as spreading, on the ends, on the point of the cycle and on the
final time; each is an option with a name. The search:

* runs at couplings that grow by a constant factor, until one spreads: the lowest is wanted, and at
  high coupling a small nucleus may go to rest instead;
* bisection between that coupling and the one before it;
* the same with twice the final time, from there downwards: spreading can be late;
* runs at couplings on both sides, to see whether spreading is monotone.

Wherever the last two contradict a single threshold, the interval of couplings in which they do is
reported as fuzzy.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum
from time import perf_counter

from theory.cells.friction import check_sliding_stable
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Place, nucleus_sites
from theory.parameters import ParameterError, count_within, positive, within
from verification.runs.comparison import COARSER
from verification.runs.excite import StartPoint, excite
from verification.runs.friction_integration import FrictionIntegration

GROWTH = 1.25
"""Factor between couplings of the first search."""
REACH = 0.2
"""Part of the threshold on either side of it where monotony is tested."""
SEVERAL = 3
"""New sites on each side of the nucleus for ``Definition.SEVERAL``."""
_LOOK = 50.0


class Definition(StrEnum):
    """What counts as spreading, within the final time."""

    FIRST = "first"
    """A site outside the nucleus sticks."""

    SEVERAL = "several"
    """Three sites beyond the nucleus stick, on each side that it has."""

    WHOLE = "whole"
    """Every site has stuck."""


@dataclass(frozen=True)
class Spreading:
    """What is excited, and what counts as spreading.

    Attributes
    ----------
    size : int
        Excited sites.
    place : Place
        At the edge or in the middle.
    definition : Definition
        What counts.
    final_time : float
        τ, from 1 to 1e6.
    point : StartPoint
        Point of the cycle from which the excited sites start.
    tolerance : float
        Of the integrator, from 1e-12 to 1e-4.

    Raises
    ------
    ParameterError
        If one is out of range.
    """

    size: int = 1
    place: Place = Place.EDGE
    definition: Definition = Definition.FIRST
    final_time: float = 1000.0
    point: StartPoint = StartPoint.MAXIMUM
    tolerance: float = 1e-8

    def __post_init__(self) -> None:
        count_within("nucleus size", self.size, 1, 100_000)
        within("final time tau", self.final_time, 1.0, 1e6)
        within("tolerance", self.tolerance, 1e-12, 1e-4)
        object.__setattr__(self, "place", Place(self.place))
        for name, kind in (("definition", Definition), ("point", StartPoint)):
            object.__setattr__(self, name, kind(getattr(self, name)))

    def watched(self, sites: int) -> tuple[int, ...]:
        """Return the sites that must stick, of which ``FIRST`` asks for one and others for all.

        Examples
        --------
        >>> Spreading(3, Place.BULK, Definition.SEVERAL).watched(31)
        (12, 13, 14, 18, 19, 20)
        """
        excited = nucleus_sites(sites, self.place, self.size)
        others = [n for n in range(1, sites + 1) if n not in excited]
        if self.definition is Definition.SEVERAL:
            low, high = excited[0] - SEVERAL, excited[-1] + SEVERAL
            others = [n for n in others if low <= n <= high]
        if not others:
            raise ParameterError(
                "number of sites n", sites, f"more than the nucleus of {self.size}", "add sites"
            )
        return tuple(others)


@dataclass(frozen=True)
class FrictionThreshold:
    """The lowest coupling found at which a nucleus spreads.

    Attributes
    ----------
    c : float
        Middle of the bracket.
    error : float
        Half the bracket; where runs at a hundred times the tolerance contradict it, also the
        difference from the threshold that they give.
    low, high : float
        The bracket: at ``low`` the nucleus does not spread, at ``high`` it does.
    late : float
        The same threshold when the final time is twice as long.
    fuzzy : tuple of float or None
        Interval around ``c`` in which runs contradict one sharp threshold: spreading that takes
        more than the final time, or that is not monotone in c. None if there is none.
    monotone : bool
        Whether spreading was monotone in c among the couplings tested.
    spreading : Spreading
        What was excited and what counted.
    chain : FrictionChain
        At ``c``.
    runs : int
        Runs made.
    seconds : float
        Run time.
    """

    c: float
    error: float
    low: float
    high: float
    late: float
    fuzzy: tuple[float, float] | None
    monotone: bool
    spreading: Spreading
    chain: FrictionChain
    runs: int
    seconds: float

    @property
    def width(self) -> float:
        """Width of the fuzzy interval; 0 without one."""
        return 0.0 if self.fuzzy is None else self.fuzzy[1] - self.fuzzy[0]


def spreads(chain: FrictionChain, spreading: Spreading, final_time: float | None = None) -> bool:
    """Run the chain until the nucleus has spread, has gone to rest, or the final time is over.

    Parameters
    ----------
    chain : FrictionChain
        Parameters, with its coupling.
    spreading : Spreading
        What is excited and what counts.
    final_time : float, optional
        In place of the one in ``spreading``.

    Examples
    --------
    >>> [spreads(FrictionChain(c=c), Spreading()) for c in (0.01, 0.011)]
    [False, True]
    """
    watched = spreading.watched(chain.sites)
    excited = nucleus_sites(chain.sites, spreading.place, spreading.size)
    start = excite(chain, excited, point=spreading.point)
    lane = FrictionIntegration(chain, start, tolerance=spreading.tolerance, watched=watched)
    wanted = 1 if spreading.definition is Definition.FIRST else len(watched)
    end = spreading.final_time if final_time is None else final_time
    while lane.time < end:
        if lane.advance_to(min(end, lane.time + _LOOK), required=wanted):
            return True
        if lane.going_to_rest():
            return False
    return lane.arrived >= wanted


def friction_threshold(
    chain: FrictionChain,
    spreading: Spreading,
    *,
    lowest: float = 1e-3,
    highest: float = 0.5,
    accuracy: float = 1e-6,
    tests: int = 12,
    progress: Callable[[float], None] | None = None,
) -> FrictionThreshold:
    """Find the lowest coupling at which a nucleus spreads.

    Parameters
    ----------
    chain : FrictionChain
        Parameters; its coupling is not used.
    spreading : Spreading
        What is excited and what counts.
    lowest, highest : float
        Couplings between which the first search goes.
    accuracy : float
        Width of the bracket, from 1e-12 to 0.1.
    tests : int
        Couplings on each side of the threshold where monotony is tested; 0 for no test of it, nor
        of what a later final time changes.
    progress : callable, optional
        Told, after each run, the fraction done, as far as it can be foreseen.

    Raises
    ------
    ParameterError
        If the nucleus spreads at ``lowest`` already, or nowhere up to ``highest``.

    Examples
    --------
    >>> found = friction_threshold(FrictionChain(c=0.0), Spreading(), accuracy=1e-4, tests=0)
    >>> found.low < 0.01056 < found.high, found.error < 1e-4
    (True, True)
    """
    begin = perf_counter()
    positive("lowest coupling", lowest)
    within("highest coupling", highest, 1.01 * lowest, 1e6, "it must be above the lowest")
    within("accuracy", accuracy, 1e-12, 0.1)
    count_within("tests of monotony", tests, 0, 10_000)
    runs = 0
    expected = 2.0 * tests + math.log(highest / lowest) / math.log(GROWTH)

    def at(c: float, longer: float, coarser: float) -> bool:
        nonlocal runs
        runs += 1
        if progress is not None:
            progress(runs / (runs + expected))
        tolerance = min(1e-4, coarser * spreading.tolerance)
        final = longer * spreading.final_time
        return spreads(replace(chain, c=c), replace(spreading, tolerance=tolerance), final)

    def first_above(start: float, longer: float, coarser: float) -> tuple[float, float]:
        low, c = start, start
        while not at(c, longer, coarser):
            if c >= highest:
                raise ParameterError(
                    "highest coupling",
                    highest,
                    "one up to which the nucleus spreads",
                    "take a lower v_d, a wider nucleus or a later final time",
                )
            low, c = c, min(highest, GROWTH * c)
        if c == start:
            check_sliding_stable(chain.cell)
            raise ParameterError(
                "lowest coupling", start, "one at which the nucleus does not spread", "lower it"
            )
        high = c
        while high - low > accuracy and low < 0.5 * (low + high) < high:
            middle = 0.5 * (low + high)
            low, high = (low, middle) if at(middle, longer, coarser) else (middle, high)
        return low, high

    low, high = first_above(lowest, 1.0, 1.0)
    c, error = 0.5 * (low + high), 0.5 * (high - low)
    if at(low, 1.0, COARSER) or not at(high, 1.0, COARSER):
        error += abs(c - 0.5 * sum(first_above(lowest, 1.0, COARSER)))
    late, fuzzy, monotone = c, None, True
    if tests > 0:
        if at(low, 2.0, 1.0):
            late = 0.5 * sum(first_above(lowest, 2.0, 1.0))
        places = [REACH * c * (k + 1) / tests for k in range(tests)]
        below = [c - place for place in places if at(c - place, 1.0, 1.0)]
        above = [c + place for place in places if not at(c + place, 1.0, 1.0)]
        monotone = not below and not above
        ends = (min([late, c, *below]), max([c, *above]))
        if ends[1] - ends[0] > 2.0 * accuracy:
            fuzzy = ends
    return FrictionThreshold(
        c,
        error,
        low,
        high,
        late,
        fuzzy,
        monotone,
        spreading,
        replace(chain, c=c),
        runs,
        perf_counter() - begin,
    )
