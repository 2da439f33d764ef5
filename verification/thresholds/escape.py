"""Range of constant couplings over which a prepared nucleus begins to escape, for some seeds.

Escape need not be monotone in c, and it depends on the noise and on the duration of the run.
Therefore not a single coupling but a range is determined: in all runs made, the nucleus held below
the range and escaped above it. Without noise a nucleus escapes at the fold of the breather that it
follows; the same bisection approaches this fold as closely as the duration allows. The stated error
extends to where escapes end if the nucleus is held for longer (`_EscapeRuns.end`).
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
LONGER = 2.0
"""Relative duration of the runs that show whether a nucleus escapes later."""
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
    longer_runs: int = 0

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
                "take another size, a smaller perturbation, another a or b, or the method envelope",
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

    def end(self) -> float:
        """Return a coupling below that at which escapes of any duration end, by their approach.

        Near a fold, c - c_0 ~ time⁻², and near a loss of stability ~ time⁻¹: c_0 is no farther
        below the range than is its other end, above which escapes take half of the duration.
        """
        low, high = self.range()
        return low - (high - low)

    def end_by_longer_runs(self, tolerance: float) -> float:
        """Return `end`, or less where longer runs show that escapes continue below it.

        A nucleus that moves irregularly may escape at any time. Runs of `LONGER` times the duration
        are made at distances below the range that are doubled from the tolerance up to `REACH`.
        """
        low, lowest, distance = self.range()[0], self.end(), tolerance
        while distance <= max(REACH * low, low - lowest) and distance < low:
            run = hold(self.chain, self.preparation, low - distance, LONGER * self.duration)
            self.longer_runs += 1
            distance *= 2.0
            if run.escaped:
                lowest = min(lowest, low - distance)
        return lowest

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
    within half of it. If escape is not monotone, both are moved outwards by `PAD` of the width. The
    error extends beyond ``low``, to where escapes end if the nucleus is held for longer: by the law
    of their approach, and by runs of twice the duration. It does not bound the effect of other
    seeds, nor that of escapes from an irregular motion after still longer times.

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
    c = 0.5 * (low + high)
    lowest = min(low, *(runs.end_by_longer_runs(tolerance) for runs in every))
    return RunThreshold(
        c_crit=c,
        error=c - lowest,
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
        runs=sum(len(runs.escapes) + runs.longer_runs for runs in every),
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

    The error extends down to where escapes end if the nucleus is held for longer.

    Raises
    ------
    ParameterError
        If it holds or escapes at every coupling tried.
    """
    started = time.perf_counter()
    runs = _EscapeRuns(chain, preparation, duration)
    runs.bracket()
    runs.refine(tolerance)
    (low, high), _ = runs.ends()
    c = 0.5 * (low + high)
    return RunThreshold(
        c_crit=c,
        error=c - runs.end(),
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
