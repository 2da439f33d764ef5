"""Watching a front run until the far end is reached, or it has stopped: the same for both models.

Velocities are fitted to the arrivals in ``verification.fronts.arrival_fit``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from verification.fronts.arrival_fit import FrontStatus, Trial
from verification.runs.comparison import COMPANION

FloatArray = npt.NDArray[np.float64]

_COARSEST = 1e-2


class RunningFront(Protocol):
    """A run at one tolerance in which a front may travel."""

    @property
    def time(self) -> float:
        """Time reached."""

    @property
    def steps(self) -> int:
        """Steps of the integrator."""

    @property
    def reached(self) -> int:
        """Sites reached; it grows while the front runs."""

    @property
    def amplitude(self) -> FloatArray:
        """Amplitude of every site."""

    @property
    def arrivals(self) -> FloatArray:
        """Arrival times of the sites of which v is made, nan where there was none."""

    def going_to_rest(self) -> bool:
        """Whether no site will be reached any more, and all go to rest."""

    def go_on(self) -> bool:
        """Step for a while, much less than the patience; whether the far end is reached."""


@dataclass(frozen=True)
class Watch:
    """When a front counts as stopped.

    Attributes
    ----------
    patience : float
        Time without an arrival after which the amplitudes are looked at, and twice that before
        the front is called pinned or creeping.
    still : float
        Change of an amplitude, from the first look to the second, below which it is pinned.
    sites : int
        Length of the chain, for the progress.
    progress : callable, optional
        Told the part of the chain that has been reached, now and then.
    """

    patience: float
    still: float
    sites: int
    progress: Callable[[float], None] | None = None

    def follow(self, front: RunningFront) -> FrontStatus | None:
        """Step until the far end is reached (None), or until the front has stopped."""
        furthest, when = 0, 0.0
        early: FloatArray | None = None
        while not front.go_on():
            reached = front.reached
            if self.progress is not None:
                self.progress(reached / self.sites)
            if reached > furthest:
                furthest, when, early = reached, front.time, None
            if front.going_to_rest():
                return FrontStatus.COLLAPSED
            waited = front.time - when
            if waited > self.patience and early is None:
                early = front.amplitude
            if waited > 2.0 * self.patience and early is not None:
                change = float(np.max(np.abs(front.amplitude - early)))
                return FrontStatus.PINNED if change < self.still else FrontStatus.CREEPING
        return None

    def trial(self, begin: Callable[[float], RunningFront], tolerance: float) -> Trial:
        """Follow a front at a tolerance and, if it reaches the far end, at a hundred times it."""
        fronts: list[RunningFront] = []
        for each in (tolerance, min(_COARSEST, COMPANION * tolerance)):
            fronts.append(begin(each))
            stopped = self.follow(fronts[-1])
            if stopped is not None:
                break
        steps = sum(front.steps for front in fronts)
        return Trial(stopped, fronts[0].arrivals, fronts[-1].arrivals, steps)
