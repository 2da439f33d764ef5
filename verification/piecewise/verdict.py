"""The classification of the motion of a piecewise-linear front (Eq. 44) from its switchings."""

from __future__ import annotations

import time

import numpy as np

from theory.arrays import FloatArray
from verification.fronts.status import FrontStatus
from verification.piecewise.chain import PiecewiseMotion, Rest
from verification.piecewise.run import FrontRun
from verification.piecewise.window import truncation_bound, widened, window_length

BLOCK = 20
"""Periods in a block; blocks are compared to distinguish transient from steady motion."""
_FLOOR = 2e-14  # relative; for periods of about one from times with a few units of round-off
_STALL_TIME = 120.0  # slow time without a switching; linear relaxation is then over, exp(-60)
_LONG = 20  # number of blocks after which a motion that does not decay is called unsteady
_GROUP = 5  # number of blocks whose largest spreads are compared to detect a geometric decay
_MAX_EVENTS_PER_SITE = 60
_SLIDING_ERROR = 1e-4  # relative, equal to the width of the relay; the tests vary the relay


class History:
    """A chain with the record of its front: when further sites were gained or lost."""

    def __init__(self, chain: PiecewiseMotion, coupling: float) -> None:
        self.chain = chain
        self.coupling = coupling
        self.events = 0
        self.sliding = 0
        self.zone = 1
        self._position = self._furthest = self._least = 0
        # for each direction: waiting times between records, and the number of events at each record
        self._waits: dict[int, list[float]] = {1: [], -1: []}
        self._counts: dict[int, list[int]] = {1: [], -1: []}
        self._jitter = 0.0
        self._slides: dict[int, list[int]] = {1: [], -1: []}
        self._since: dict[int, float] = {1: 0.0, -1: 0.0}

    def extend(self, records: int) -> Rest | None:
        """Follow the front over ``records`` further sites; return early if it comes to rest."""
        goal = self._total() + records
        most = self.events + _MAX_EVENTS_PER_SITE * records
        while self._total() < goal and self.events < most:
            step = self.chain.advance(_STALL_TIME)
            if isinstance(step, Rest):
                return step
            self.events += 1
            self.sliding += step.sliding
            self._jitter = max(step.jitter, 0.9 * self._jitter)
            self._position += step.direction
            for direction in (1, -1):
                self._since[direction] += step.wait
            if self._position > self._furthest:
                self._furthest = self._position
                self._note(1)
            elif self._position < self._least:
                self._least = self._position
                self._note(-1)
            self._keep_in_window(step.site)
        self._keep_wide()
        return None

    def _total(self) -> int:
        return len(self._waits[1]) + len(self._waits[-1])

    def _note(self, direction: int) -> None:
        self._waits[direction].append(self._since[direction])
        self._counts[direction].append(self.events)
        self._slides[direction].append(self.sliding)
        self._since[direction] = 0.0

    def _direction(self) -> int:
        return 1 if len(self._waits[1]) >= len(self._waits[-1]) else -1

    def _periods(self) -> FloatArray:
        return np.array(self._waits[self._direction()][1:])

    def _keep_in_window(self, site: int) -> None:
        sites = self.chain.sites
        slot = site - self.chain.origin
        if 3 * sites < 8 * slot < 5 * sites:
            return
        first_off, last_on = self.chain.zone()
        width = last_on - first_off + 1
        self.zone = max(self.zone, width)
        if 2 * width > sites or not sites <= 8 * slot < 7 * sites:
            self._widen(2 * sites)
        else:
            shift = (first_off + last_on) // 2 - sites // 2
            if 8 * abs(shift) >= sites:
                self.chain.shift(shift)

    def _keep_wide(self) -> None:
        """Lengthen the window if the front is faster or broader than expected."""
        first_off, last_on = self.chain.zone()
        self.zone = max(self.zone, last_on - first_off + 1)
        needed = window_length(
            self.coupling, self._mean_velocity(), 1e-14 * self.chain.threshold, self.zone
        )
        if needed > self.chain.sites:
            self._widen(needed)

    def _widen(self, sites: int) -> None:
        state = widened(self.chain.state(), sites)
        grazes = self.chain.grazes
        self.chain = PiecewiseMotion(self.coupling, self.chain.threshold, state)
        self.chain.grazes = grazes

    def _mean_velocity(self) -> float:
        recent = self._periods()[-BLOCK:]
        total = float(recent.sum())
        return self._direction() * len(recent) / total if total > 0 else 0.0

    def _spreads(self) -> FloatArray:
        """Spread of the period relative to its mean, block by block, counted back from the end."""
        periods = self._periods()
        blocks = len(periods) // BLOCK
        cut = periods[len(periods) - blocks * BLOCK :].reshape(blocks, BLOCK)
        return np.asarray(np.ptp(cut, axis=1) / cut.mean(axis=1))

    def _relative_error(self, spreads: FloatArray) -> float:
        """Bound the distance of the last mean period from its limit, for geometric convergence.

        If deviations shrink by q per block, the last block changed by (1 - q) of its deviation.
        """
        floor = self._floor()
        resolved = spreads[spreads > 30 * floor]
        q = float(resolved[-1] / resolved[-2]) if len(resolved) > 1 else 0.0
        if len(resolved) >= 2 * _GROUP:
            before = float(resolved[-2 * _GROUP : -_GROUP].max())
            q = max(q, (float(resolved[-_GROUP:].max()) / before) ** (1 / _GROUP))
        return float(max(spreads[-1], floor)) / (1 - min(q, 0.999))

    def _floor(self) -> float:
        """Relative spread explained by round-off alone; steeper crossings are sharper."""
        return max(_FLOOR, 4 * self._jitter * abs(self._mean_velocity()))

    def decided(self, tolerance: float, max_periods: int) -> bool:
        """Return whether further periods would not change the verdict."""
        spreads = self._spreads()
        if self._is_steady(spreads, tolerance) or self._total() >= max_periods:
            return True
        if self.events >= 6 * max_periods:
            return True
        return len(spreads) >= _LONG and not _shrinks(spreads)

    def _is_steady(self, spreads: FloatArray, tolerance: float) -> bool:
        reached = max(tolerance, 2 * self._floor())
        if len(spreads) < 3 or spreads[-2] > 10 * reached:
            return False
        return self._relative_error(spreads) <= reached

    def verdict(self, rest: Rest | None, tolerance: float, began: float) -> FrontRun:
        """Return the result of the run."""
        direction, periods, spreads = self._direction(), self._periods(), self._spreads()
        chain, r = self.chain, self.chain.threshold
        margin = events_per_site = spread = None
        repeat: int | None = None
        v: float | None = None
        error: float | None = None
        if rest is not None:
            status = FrontStatus.PINNED if rest.proven else FrontStatus.MARGINAL
            margin = rest.margin - rest.remainder
            v, error = (0.0, 0.0) if rest.proven else (None, None)
        elif self._is_steady(spreads, tolerance):
            slides = self._slides[direction]
            slid = slides[-1] > slides[-1 - BLOCK]
            status = FrontStatus.SLIDING if slid else FrontStatus.STEADY
            last = periods[-BLOCK:]
        elif _decays(spreads):
            status = FrontStatus.SETTLING
            last = periods[-BLOCK:]
        else:
            status = FrontStatus.UNSTEADY
            last = periods[len(periods) // 2 :]
            repeat = _repeat(periods)
            if repeat is not None:  # a mean over whole repetition periods is sharp
                last = periods[-(BLOCK * 6 // repeat) * repeat :]
        if rest is None and len(last) > 0:
            v = direction * len(last) / float(last.sum())
            spread = float(np.ptp(last) / last.mean())
            counts = self._counts[direction]
            events_per_site = (counts[-1] - counts[-1 - len(last)]) / len(last)
        truncation = truncation_bound(self.coupling, v or 0.0, chain.sites - self.zone)
        if rest is None and v is not None:
            if status is FrontStatus.UNSTEADY:
                sharp = abs(v) * 1e-9
                error = _spread_of_means(last) if repeat is None else sharp
            else:
                error = abs(v) * (self._relative_error(spreads) + truncation / r)
            if status is FrontStatus.SLIDING:
                error += abs(v) * _SLIDING_ERROR
        return FrontRun(
            coupling=self.coupling,
            threshold=r,
            v=v,
            error=error,
            status=status,
            period_spread=spread,
            events=self.events,
            events_per_site=events_per_site,
            sliding_events=self.sliding,
            grazes=chain.grazes,
            repeat=repeat,
            margin=margin,
            window=chain.sites,
            truncation=truncation,
            seconds=time.perf_counter() - began,
            crossing_times=np.cumsum(self._waits[direction]),
            final=chain.state(),
        )


def _shrinks(spreads: FloatArray) -> bool:
    """Return whether the largest spread decreases from one group of blocks to the next, twice."""
    if len(spreads) < 3 * _GROUP:
        return False
    groups = spreads[-3 * _GROUP :].reshape(3, _GROUP).max(axis=1)
    return bool(groups[2] < 0.99 * groups[1] < 0.99**2 * groups[0])


def _decays(spreads: FloatArray) -> bool:
    """Return whether it decreases and is small enough for a geometric decay."""
    return _shrinks(spreads) and bool(spreads[-3 * _GROUP :].max() < 0.1)


def _repeat(periods: FloatArray) -> int | None:
    """Find the smallest number of sites after which the last 120 periods repeat to 1e-9."""
    last = periods[-120:]
    for lag in range(1, len(last) // 2 + 1):
        if np.max(np.abs(last[lag:] - last[:-lag])) <= 1e-9 * last.mean():
            return lag
    return None


def _spread_of_means(periods: FloatArray) -> float:
    """Return half the range of the mean velocity over five equal parts."""
    parts = [part for part in np.array_split(periods, 5) if len(part)]
    means = [1 / float(part.mean()) for part in parts]
    return (max(means) - min(means)) / 2 if len(means) > 1 else means[0]
