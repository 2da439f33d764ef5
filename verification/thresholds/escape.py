"""Range of constant couplings over which a prepared nucleus begins to escape, for some seeds.

Escape need not be monotone in c, and it depends on the noise and on the duration of the run.
Therefore not a single coupling but a range is determined: in all runs made, the nucleus held below
the range and escaped above it. Without noise a nucleus escapes at the fold of the breather that it
follows; the same bisection approaches this fold as closely as the duration allows.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field, replace

from theory.chains.vdp import VanDerPolChain
from theory.parameters import ParameterError, Range, count_within, positive, with_ranges
from verification.thresholds.preparation import NucleusPreparation, hold
from verification.thresholds.result import Definition, Mechanism, RunThreshold, ThresholdMethod

FIRST, LOWEST, HIGHEST = 0.2, 1e-3, 2.0
"""First coupling tried, and the limits of the search."""
REACH, PROBES = 0.01, 8
"""Distance beyond the range, relative to it, up to which further runs are made, and their
number."""
PAD = 0.5
"""Margin added on each side, relative to the width, where escape is not monotone: there may be
isolated couplings of escape between those that were tried."""
SEED_COUNTS, SEEDS = Range(1, 100), 3
"""Range and default of the number of seeds tried if there is noise, beginning with that of the
preparation."""


@dataclass
class _EscapeRuns:
    """The runs with one seed: c and the slow time of escape, infinite if the nucleus held."""

    chain: VanDerPolChain
    preparation: NucleusPreparation
    duration: float
    escapes: dict[float, float] = field(default_factory=dict)

    def escape(self, c: float) -> float:
        """Return the slow time of escape."""
        if c not in self.escapes:
            run = hold(self.chain, self.preparation, c, self.duration)
            self.escapes[c] = run.time if run.escaped else math.inf
        return self.escapes[c]

    def bracket(self) -> None:
        """Find a coupling at which the nucleus holds and one at which it escapes soon."""
        c = FIRST
        while self.escape(c) < math.inf and c > LOWEST:
            c *= 0.8
        c = FIRST
        while not self.soon(c) and c < HIGHEST:
            c *= 1.25
        if math.inf not in self.escapes.values() or not any(map(self.soon, list(self.escapes))):
            raise ParameterError(
                "nucleus",
                self.preparation.size,
                f"one that holds at some c from {LOWEST:g} and escapes at some up to {HIGHEST:g}",
                "take another size, a smaller perturbation, or change a or b",
            )

    def soon(self, c: float) -> bool:
        """Whether the nucleus escapes within half the duration."""
        return self.escape(c) <= 0.5 * self.duration

    def ends(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the gaps that contain the ends of the range, each between two runs."""
        known = sorted(self.escapes)
        escaped = min(c for c in known if self.escapes[c] < math.inf)
        held = max(c for c in known if not self.soon(c))
        below = max((c for c in known if c < escaped), default=escaped)
        above = min((c for c in known if c > held), default=held)
        return (below, escaped), (held, above)

    def refine(self, tolerance: float) -> None:
        """Bisect both gaps."""
        for place in (0, 1):
            low, high = self.ends()[place]
            while high - low > tolerance:
                self.escape(0.5 * (low + high))
                low, high = self.ends()[place]

    def monotone(self) -> bool:
        """Whether all escapes lie above all runs that held."""
        held = [c for c, time in self.escapes.items() if time == math.inf]
        return max(held) < self.ends()[0][1]

    def range(self) -> tuple[float, float]:
        """Return the outer ends of the two gaps."""
        (low, _), (_, high) = self.ends()
        return low, high


@with_ranges(seeds=SEED_COUNTS)
def escape_range(
    chain: VanDerPolChain,
    preparation: NucleusPreparation,
    duration: float = 2000.0,
    tolerance: float = 1e-5,
    seeds: int = SEEDS,
) -> RunThreshold:
    """Bisect for the range of escape, then extend it by runs around it until it no longer grows.

    Every run below ``low`` of the result held for ``duration``; every run above ``high`` escaped
    within half of it. If escape is not monotone, both are moved outwards by `PAD` of the width.

    Parameters
    ----------
    chain : VdpChain or AveragedChain
        The chain: a, b and the ends; its c and N are not used.
    preparation : NucleusPreparation
        The start, with its first seed.
    duration : float, optional
        Duration of a run in slow time.
    tolerance : float, optional
        Width of the final brackets.
    seeds : int, optional
        Number of seeds, {seeds}; one is enough without noise.

    Raises
    ------
    ParameterError
        If the nucleus holds, or escapes, at every coupling tried.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> found = escape_range(VdpChain(a=2.5, b=0.5, c=0), NucleusPreparation(1), 500.0, 1e-3)
    >>> found.low < 0.19079 < found.high, found.monotone
    (True, True)
    """
    started = time.perf_counter()
    positive("duration", duration)
    positive("tolerance", tolerance)
    count_within("number of seeds", seeds, *SEED_COUNTS)
    if preparation.perturbation == 0.0:
        seeds = 1
    every = [
        _EscapeRuns(chain, replace(preparation, seed=preparation.seed + number), duration)
        for number in range(seeds)
    ]
    for runs in every:
        runs.bracket()
        runs.refine(tolerance)
    middle = sum(sum(runs.range()) for runs in every) / (2 * seeds)
    spacing = middle * REACH / PROBES
    seen: set[int] = set()
    while True:
        low = min(runs.range()[0] for runs in every)
        high = max(runs.range()[1] for runs in every)
        first = max(1, math.ceil((low - REACH * middle) / spacing))
        last = math.floor((high + REACH * middle) / spacing)
        fresh = set(range(first, last + 1)) - seen
        if not fresh:
            break
        for runs in every:
            for number in fresh:
                runs.escape(number * spacing)
            runs.refine(tolerance)
        seen |= fresh
    monotone = all(runs.monotone() for runs in every)
    pad = 0.0 if monotone else PAD * (high - low)
    low, high = low - pad, high + pad
    return RunThreshold(
        c_crit=0.5 * (low + high),
        # The error covers the runs that were made, not longer times or other seeds.
        error=0.5 * (high - low),
        method=ThresholdMethod.HOLD,
        definition=Definition.FIRST,
        mechanism=Mechanism.HELD,
        model="averaged",
        nucleus=preparation.nucleus,
        sites=preparation.chain(chain, 0.0).sites,
        low=low,
        high=high,
        range_by_seed={runs.preparation.seed: runs.range() for runs in every},
        perturbation=preparation.perturbation,
        final_time=duration,
        monotone=monotone,
        runs=sum(len(runs.escapes) for runs in every),
        seconds=time.perf_counter() - started,
    )


def escape_threshold(
    chain: VanDerPolChain,
    preparation: NucleusPreparation,
    *,
    duration: float = 2000.0,
    tolerance: float,
) -> RunThreshold:
    """Bisect for the coupling at which the prepared nucleus escapes within a time.

    Near a fold runs take ever longer to escape, c - c_fold ~ duration⁻², so that escapes within
    half of the duration begin four times as far above the fold. The difference is part of the
    error, which then extends down to the fold.

    Raises
    ------
    ParameterError
        If it holds or escapes at every coupling tried.
    """
    started = time.perf_counter()
    runs = _EscapeRuns(chain, preparation, duration)
    runs.bracket()
    runs.refine(tolerance)
    (low, high), soon = runs.ends()
    c = 0.5 * (low + high)
    return RunThreshold(
        c_crit=c,
        error=0.5 * tolerance + abs(0.5 * sum(soon) - c),
        method=ThresholdMethod.HOLD,
        definition=Definition.FIRST,
        mechanism=Mechanism.HELD,
        model="averaged",
        nucleus=preparation.nucleus,
        sites=preparation.chain(chain, c).sites,
        low=low,
        high=high,
        perturbation=preparation.perturbation,
        final_time=duration,
        runs=len(runs.escapes),
        seconds=time.perf_counter() - started,
    )
