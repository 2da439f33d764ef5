"""Thresholds by direct runs of any chain: the coupling above which a nucleus spreads (Fig. 4).

The value depends on the definition of spreading, on the ends, on the start and on the final time;
each is a named option. The search consists of

* runs at couplings that grow by a constant factor until one spreads: the lowest threshold is
  sought, since at high coupling a small nucleus may go to rest instead;
* bisection between that coupling and the preceding one;
* the same with twice the final time, from there downwards, because spreading may be late;
* runs at couplings on both sides, to test whether spreading is monotone.

If the last two contradict a single threshold, the interval of couplings in which they do is
reported as fuzzy.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from theory.cells.friction import check_sliding_stable
from theory.chains.chain import COUPLING_RANGE, SMALLEST_C, Chain
from theory.chains.friction import FrictionChain
from theory.chains.nucleus import Nucleus, Place
from theory.parameters import ParameterError, Range, count_within, with_ranges, within
from verification.runs.comparison import SAFETY
from verification.runs.excite import StartPoint, excite
from verification.runs.integrations import integration
from verification.thresholds.result import Definition, Mechanism, RunThreshold, ThresholdMethod

GROWTH = 1.25
"""Factor between successive couplings of the first search."""
REACH = 0.2
"""Fraction of the threshold, on either side of it, over which monotonicity is tested."""
SEVERAL = 3
"""Number of new sites on each side of the nucleus for ``Definition.SEVERAL``."""
FINER = 100.0
"""Ratio of the tolerance of a threshold to that of the threshold with which it is compared."""
_BUDGET = 20_000
"""Sites times steps between two checks of the sites reached."""
FINAL_TIMES, TOLERANCES, ACCURACIES = Range(1.0, 1e6), Range(1e-12, 1e-4), Range(1e-12, 0.1)


@with_ranges(final_time=FINAL_TIMES, tolerance=TOLERANCES)
@dataclass(frozen=True)
class Spreading:
    """Which sites are excited, and what counts as spreading.

    Attributes
    ----------
    size : int
        Number of excited sites.
    place : Place
        At the edge or in the middle.
    definition : Definition
        What counts as spreading: ``first``, ``several`` or ``whole``.
    final_time : float
        Maximum duration in units of the chain's `time_unit` (τ for (5), slow time for (8) and
        (43)), {final_time}.
    point : StartPoint
        Point on the cycle of (5) from which the excited sites start.
    tolerance : float
        Tolerance of the integrator, {tolerance}; of a threshold, which is compared with that at a
        hundredth of the tolerance, from 1e-10.
    pattern : str
        Phase steps between the excited sites of a smooth chain, as in `Nucleus`.
    displacement : float or None
        Displacement of the excited sites; by default the excited state of one cell.

    Raises
    ------
    ParameterError
        If a value is out of range.
    """

    size: int = 1
    place: Place = Place.EDGE
    definition: Definition = Definition.FIRST
    final_time: float = 1000.0
    point: StartPoint = StartPoint.MAXIMUM
    tolerance: float = 1e-8
    pattern: str = ""
    displacement: float | None = None

    def __post_init__(self) -> None:
        count_within("nucleus size", self.size, 1, 100_000)
        within("final time", self.final_time, *FINAL_TIMES)
        within("tolerance", self.tolerance, *TOLERANCES)
        for name, kind in (("place", Place), ("definition", Definition), ("point", StartPoint)):
            object.__setattr__(self, name, kind(getattr(self, name)))
        if self.definition in (Definition.EXISTENCE, Definition.STABILITY):
            raise ParameterError(
                "definition", self.definition.value, "first, several or whole for runs",
                "take one of them, or a method that follows breathers",
            )  # fmt: skip
        _ = self.nucleus

    @property
    def nucleus(self) -> Nucleus:
        """The excited sites."""
        return Nucleus(self.size, self.pattern, self.place)

    def watched(self, sites: int) -> tuple[int, ...]:
        """Return the sites to be reached: one of them for ``first``, all of them otherwise.

        Examples
        --------
        >>> Spreading(3, Place.BULK, Definition.SEVERAL).watched(31)
        (12, 13, 14, 18, 19, 20)
        """
        excited = self.nucleus.excited(sites)
        others = [n for n in range(1, sites + 1) if n not in excited]
        if self.definition is Definition.SEVERAL:
            low, high = excited[0] - SEVERAL, excited[-1] + SEVERAL
            others = [n for n in others if low <= n <= high]
        if not others:
            raise ParameterError(
                "number of sites n", sites, f"more than the nucleus of {self.size}", "add sites"
            )
        return tuple(others)

    def start(self, chain: Chain) -> Any:
        """Return the start, (y, w) of every site."""
        sites = self.nucleus.excited(_sites(chain))
        return excite(
            chain,
            sites,
            self.displacement,
            quarter_turns=self.nucleus.quarter_turns(),
            point=self.point,
        )


def _sites(chain: Chain) -> int:
    sites: int = getattr(chain, "sites", 0)
    if not sites:
        raise ParameterError("model", chain.model, "a chain of finite length", "take another chain")
    return sites


def spreads(
    chain: Chain,
    spreading: Spreading,
    final_time: float | None = None,
    progress: Callable[[float], None] | None = None,
) -> bool:
    """Run the chain until the nucleus has spread or gone to rest, or the final time is over.

    Parameters
    ----------
    chain : Chain
        The chain with its coupling, of any model that is integrated in time.
    spreading : Spreading
        Which sites are excited, and what counts as spreading.
    final_time : float, optional
        Replaces the final time of ``spreading``.
    progress : callable, optional
        Called at intervals with the fraction of the final time that has elapsed.

    Examples
    --------
    >>> [spreads(FrictionChain(c=c), Spreading()) for c in (0.01, 0.011)]
    [False, True]
    """
    watched = np.array(spreading.watched(_sites(chain))) - 1
    required = 1 if spreading.definition is Definition.FIRST else watched.size
    end = chain.time_unit * (spreading.final_time if final_time is None else final_time)
    run = integration(chain, spreading.start(chain), [end], tolerance=spreading.tolerance, end=end)

    def spread() -> bool:
        return int(np.count_nonzero(run.arrivals[watched] <= end)) >= required

    while not run.finished:
        run.advance(_BUDGET)
        if spread():
            return True
        if run.going_to_rest():
            return False
        if progress is not None:
            progress(run.time / end)
    return spread()


class _Search:
    """Runs at various couplings, counted, and a bracket of the lowest coupling that spreads."""

    def __init__(
        self, chain: Chain, spreading: Spreading, accuracy: float, lowest: float, highest: float
    ) -> None:
        self._chain, self._spreading, self._accuracy = chain, spreading, accuracy
        self._lowest, self._highest = lowest, highest
        self._progress: Callable[[float], None] | None = None
        self._expected = math.log(highest / lowest) / math.log(GROWTH)
        self.runs = 0

    def expect(self, runs: int, progress: Callable[[float], None] | None) -> None:
        """Report progress, expecting this number of runs in addition to the first search."""
        self._expected += runs
        self._progress = progress

    def spreads(self, c: float, *, longer: float = 1.0, finer: float = 1.0) -> bool:
        """Run the chain at a coupling, to a longer final time or with a smaller tolerance."""
        self.runs += 1
        self._report(0.0)
        final = longer * self._spreading.final_time
        spreading = replace(self._spreading, tolerance=self._spreading.tolerance / finer)
        return spreads(self._chain.replace(c=c), spreading, final, self._report)

    def _report(self, part: float) -> None:
        """Report progress after a fraction of the present run, which may take minutes."""
        if self._progress is not None:
            done = self.runs + part
            self._progress(done / (done + self._expected))

    def bracket(self, *, longer: float = 1.0, finer: float = 1.0) -> tuple[float, float]:
        """Search upwards from the lowest coupling by a constant factor, then bisect."""
        low, high = self._lowest, self._lowest
        while not self.spreads(high, longer=longer, finer=finer):
            if high >= self._highest:
                raise ParameterError(
                    "highest coupling", self._highest, "one up to which the nucleus spreads",
                    "take a wider nucleus, a later final time, or for friction a lower v_d",
                )  # fmt: skip
            low, high = high, min(self._highest, GROWTH * high)
        if high == self._lowest:
            if isinstance(self._chain, FrictionChain):
                check_sliding_stable(self._chain.cell)
            raise ParameterError(
                "lowest coupling", self._lowest, "one at which the nucleus does not spread",
                "lower it",
            )  # fmt: skip
        while high - low > self._accuracy and low < 0.5 * (low + high) < high:
            middle = 0.5 * (low + high)
            if self.spreads(middle, longer=longer, finer=finer):
                high = middle
            else:
                low = middle
        return low, high

    def effect_of_tolerance(self, low: float, high: float) -> float:
        """Return a bound on the error of a threshold between two couplings by the tolerance.

        It is three times the difference from the threshold at a hundredth of the tolerance. That at
        a larger tolerance, or one closer to it, can err alike: steps change at intervals only.
        """
        if not self.spreads(low, finer=FINER) and self.spreads(high, finer=FINER):
            return 0.0
        return SAFETY * 0.5 * abs(low + high - sum(self.bracket(finer=FINER)))

    def exceptions(self, c: float, tests: int) -> tuple[list[float], list[float]]:
        """Return couplings below c at which the nucleus spreads, and above at which it does not."""
        distances = [REACH * c * (k + 1) / tests for k in range(tests)]
        below = [c - distance for distance in distances if self.spreads(c - distance)]
        above = [c + distance for distance in distances if not self.spreads(c + distance)]
        return below, above


@with_ranges(accuracy=ACCURACIES)
def spreading_threshold(
    chain: Chain,
    spreading: Spreading,
    *,
    lowest: float,
    highest: float = 0.5,
    accuracy: float,
    tests: int,
    progress: Callable[[float], None] | None = None,
) -> RunThreshold:
    """Find the lowest coupling at which a nucleus spreads.

    Parameters
    ----------
    chain : Chain
        A chain of any model with a coupling c that is integrated in time; the value of c is not
        used.
    spreading : Spreading
        Which sites are excited, and what counts as spreading.
    lowest, highest : float
        Range of couplings of the first search.
    accuracy : float
        Final width of the bracket, {accuracy}.
    tests : int
        Number of couplings tested for monotonicity on each side of the threshold; with 0, neither
        monotonicity nor the effect of a later final time is tested.
    progress : callable, optional
        Called after each run with the fraction done, as far as it can be estimated.

    Raises
    ------
    ParameterError
        If the nucleus spreads already at ``lowest``, or nowhere up to ``highest``.

    Examples
    --------
    >>> chain, how = FrictionChain(c=0.0), {"lowest": 1e-3, "accuracy": 1e-4, "tests": 0}
    >>> found = spreading_threshold(chain, Spreading(), **how)
    >>> found.low < 0.01056 < found.high, found.error < 1e-4
    (True, True)
    """
    begin = perf_counter()
    within("lowest coupling", lowest, SMALLEST_C, COUPLING_RANGE.high / 1.01)
    remedy = "it must be above the lowest"
    within("highest coupling", highest, 1.01 * lowest, COUPLING_RANGE.high, remedy)
    within("accuracy", accuracy, *ACCURACIES)
    within("tolerance", spreading.tolerance, FINER * TOLERANCES.low, TOLERANCES.high)
    count_within("tests of monotonicity", tests, 0, 10_000)
    search = _Search(chain, spreading, accuracy, lowest, highest)
    search.expect(2 * tests, progress)
    low, high = search.bracket()
    c = 0.5 * (low + high)
    of_tolerance = search.effect_of_tolerance(low, high)
    error = 0.5 * (high - low) + of_tolerance
    late: float | None = None
    late_error: float | None = None
    fuzzy: tuple[float, float] | None = None
    monotone: bool | None = None
    if tests > 0:
        spreads_late = search.spreads(low, longer=2.0)
        first, last = search.bracket(longer=2.0) if spreads_late else (low, high)
        late, late_error = 0.5 * (first + last), 0.5 * (last - first) + of_tolerance
        below, above = search.exceptions(c, tests)
        monotone = not below and not above
        ends = (min([late, c, *below]), max([c, *above]))
        fuzzy = ends if ends[1] - ends[0] > 2.0 * accuracy else None
    from_cycle = isinstance(chain, FrictionChain) and spreading.displacement is None
    return RunThreshold(
        c_crit=c,
        error=error,
        method=ThresholdMethod.BISECTION,
        definition=spreading.definition,
        mechanism=Mechanism.SPREADING,
        model=chain.model,
        nucleus=spreading.nucleus,
        sites=_sites(chain),
        low=low,
        high=high,
        final_time=spreading.final_time,
        ends=getattr(chain, "ends", None),
        start_point=spreading.point if from_cycle else None,
        c_crit_at_twice_the_time=late,
        c_crit_at_twice_the_time_error=late_error,
        fuzzy=fuzzy,
        monotone=monotone,
        runs=search.runs,
        seconds=perf_counter() - begin,
    )
