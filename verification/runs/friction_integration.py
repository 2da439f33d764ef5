"""The integration of the friction chain (5): exact from one event to the next."""

from __future__ import annotations

import math
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from theory.arrays import AnyArray, BoolArray, FloatArray
from theory.chains.chain import Chain
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.parameters import count_within, positive, truth
from verification.execution.digest import digest_of_arrays
from verification.runs.integration import (
    Integration,
    NotFiniteError,
    StandstillError,
    checked_state,
)
from verification.steppers import friction
from verification.steppers.friction_series import (
    ARRIVAL,
    CLOCK,
    LAST_MAXIMUM,
    LAST_MINIMUM,
    MODE,
    REST,
    W,
    Y,
    law_of,
    new_numbers,
    taylor_order,
)
from verification.steppers.stop_code import StopCode

_REST = 0.01
_LONGEST_FRAME = 1e6
"""Time after which a run without an end is left."""
_PIECE = 200_000
"""Largest number of sites times steps spent in one call of compiled code: a fraction of a
second."""


class FrictionIntegration(Integration):
    """A run of (5); the tolerance is absolute and applies to y and ẏ.

    Parameters
    ----------
    chain : FrictionChain
        Parameters.
    start : array_like
        (y, ẏ) at τ = 0.
    times : array_like, shape (M,), optional
        τ of the samples, ascending.
    tolerance : float
        Local error of y and ẏ, absolute.
    end : float, optional
        τ at the end; by default the last of ``times``, or no end.
    active_window : bool
        Do not step sites at the ends as long as they are within a hundredth of the tolerance of
        steady sliding.
    logged_events : int
        Number of events that are listed in ``log``, from 0 to 1e8.

    Raises
    ------
    ParameterError
        If the start does not fit the chain.
    """

    method: ClassVar[str] = "Taylor series, exact events"
    default_budget: ClassVar[int] = 200_000

    def __init__(
        self,
        chain: FrictionChain,
        start: npt.ArrayLike,
        times: npt.ArrayLike = (),
        *,
        tolerance: float = 1e-10,
        end: float | None = None,
        active_window: bool = True,
        logged_events: int = 0,
    ) -> None:
        state = checked_state(chain, start)
        self._start = state
        cell = chain.cell
        self.chain, self.tolerance = chain, positive("tolerance", tolerance)
        self.times = np.asarray(times, dtype=float)
        self.end = (float(self.times[-1]) if self.times.size else math.inf) if end is None else end
        logged = count_within("events logged", logged_events, 0, 10**8)
        neighbours = np.full(chain.sites, 2.0)
        if chain.ends is Ends.FREE:
            neighbours[0] -= 1.0
            neighbours[-1] -= 1.0
        self.order = taylor_order(tolerance)
        self._run = friction.new_run(
            new_numbers(cell, chain.c, tolerance),
            law_of(cell),
            state,
            neighbours,
            times=self.times,
            logged=logged,
            order=self.order,
        )
        if truth("active_window", active_window) and chain.ends is Ends.FREE:
            self._close_window(_REST * tolerance)

    def _close_window(self, rest: float) -> None:
        """Close the window around the moving sites; others are within ``rest`` of sliding."""
        cell, run = self.chain.cell, self._run
        y, velocity = self.state
        away = np.maximum(np.abs(y - cell.steady_sliding), np.abs(velocity))
        moving = np.flatnonzero(away > rest) + 1
        if moving.size == 0 or cell.effective_damping <= 0.0:
            return
        low = max(1, int(moving[0]) - friction.MARGIN)
        high = min(self.chain.sites + 1, int(moving[-1]) + friction.MARGIN + 1)
        run.numbers[REST] = rest
        run.counters[friction.LO], run.counters[friction.HI] = low, high
        for part in (slice(1, low), slice(high, -1)):
            run.site[Y, part], run.site[W, part] = cell.steady_sliding, -cell.v_d

    def _row(self, row: int) -> FloatArray:
        """One quantity at all sites, a view of shape (N,)."""
        return self._run.site[row, 1:-1]

    @property
    def time(self) -> float:
        """τ reached."""
        return float(self._run.numbers[CLOCK])

    @property
    def finished(self) -> bool:
        """Whether ``end`` has been reached."""
        return self.time >= self.end

    @property
    def state_arrays(self) -> dict[str, AnyArray]:
        """The arrays that make up the state of the run; filled in place when it is resumed."""
        run = self._run
        return {
            "numbers": run.numbers,
            "site": run.site,
            "mode": run.mode,
            "counters": run.counters,
            "samples": run.samples,
            "log": run.log,
        }

    @property
    def metadata(self) -> dict[str, Any]:
        """Everything that determines the run, to be compared with a checkpoint."""
        return {
            **self.chain.parameters(),
            "tolerance": self.tolerance,
            "rest": float(self._run.numbers[REST]),
            "t_end": self.end,
            "times": digest_of_arrays({"times": self.times})[:16],
            "logged_events": len(self._run.log),
            "start": digest_of_arrays({"start": self._start})[:16],
        }

    def check_state(self) -> None:
        """Raise ValueError if the arrays are no valid state; compiled code does not check them."""
        counters = self._run.counters
        first, last, sampled = (int(n) for n in counters[:3])
        if not np.isfinite(self._run.numbers[CLOCK]):
            raise ValueError("a clock that is finite")
        logged = int(counters[friction.LOGGED])
        if not (
            1 <= first <= last <= self.chain.sites + 1
            and 0 <= sampled <= self.times.size
            and 0 <= logged <= len(self._run.log)
        ):
            raise ValueError("counters within the arrays that they count")

    @property
    def state(self) -> FloatArray:
        """Present state (y, ẏ), shape (2, N); ẏ is exactly v_d during stick."""
        return np.array([self._row(Y), self._row(W) + self.chain.cell.v_d])

    @property
    def stuck(self) -> BoolArray:
        """Which sites stick at present, shape (N,)."""
        stuck: BoolArray = self._run.mode[MODE, 1:-1] == 0
        return stuck

    @property
    def last_extremes(self) -> FloatArray:
        """Last maximum and minimum of y in backward slip, shape (2, N); nan until they occur."""
        return np.array([self._row(LAST_MAXIMUM), self._row(LAST_MINIMUM)])

    @property
    def amplitude(self) -> FloatArray:
        """Half of last maximum minus last minimum of y, shape (N,); 0 until both have occurred."""
        highest, lowest = self.last_extremes
        half = 0.5 * (highest - lowest)
        amplitude: FloatArray = np.nan_to_num(np.abs(half), nan=0.0)
        return amplitude

    @property
    def samples(self) -> FloatArray:
        """(y, ẏ) at ``times``, shape (M, 2, N)."""
        samples = self._run.samples[:, :2].copy()
        samples[:, 1] += self.chain.cell.v_d
        return samples

    @property
    def sampled_amplitude(self) -> FloatArray:
        """The amplitude at ``times``, shape (M, N)."""
        return np.nan_to_num(self._run.samples[:, 2], nan=0.0)

    @property
    def arrivals(self) -> FloatArray:
        """τ at which each site first stuck, shape (N,); nan if it did not."""
        return self._row(ARRIVAL)

    def forget_arrivals(self) -> None:
        """Discard the arrivals recorded so far."""
        self._row(ARRIVAL)[:] = np.nan

    @property
    def counts(self) -> dict[str, int]:
        """Number of frames (``steps``), sites times frames, and series started within frames."""
        counters = self._run.counters
        return {
            "steps": int(counters[friction.FRAMES]),
            "site_steps": int(counters[friction.SITE_FRAMES]),
            "local_series": int(counters[friction.LOCAL]),
        }

    @property
    def events(self) -> dict[str, int]:
        """Number of sticks, releases and reversals."""
        kinds = self._run.counters[friction.KINDS :]
        return {
            "sticks": int(kinds[friction.STICK_BEGINS]),
            "releases": int(kinds[friction.STICK_ENDS]),
            "reversals": int(kinds[friction.REVERSAL]),
        }

    @property
    def log(self) -> FloatArray:
        """Rows (τ, site from 1, kind) of the first events."""
        return self._run.log[: int(self._run.counters[friction.LOGGED])].copy()

    @classmethod
    def perturbed(cls, chain: Chain, start: FloatArray, ulps: int) -> FloatArray:
        """Return the start with y at every site larger by ``ulps`` units in the last place.

        Examples
        --------
        >>> chain = FrictionChain(c=0.02, sites=2)
        >>> (FrictionIntegration.perturbed(chain, np.ones((2, 2)), 4) - 1.0).tolist()
        [[8.881784197001252e-16, 8.881784197001252e-16], [0.0, 0.0]]
        """
        perturbed_start = np.array(start, dtype=float)
        perturbed_start[0] += ulps * np.spacing(
            np.maximum(np.abs(perturbed_start[0]), chain.rest_state.y)
        )
        return perturbed_start

    def advance(self, budget: int) -> None:
        """Step until ``end``, or until a ``budget`` of sites times steps is spent."""
        # A frame of a chain that is exactly at rest is as long as it may be, but never infinite.
        stop = self.end if math.isfinite(self.end) else self.time + _LONGEST_FRAME
        self.advance_to(stop, max_steps=1 + budget // self.chain.sites)

    def advance_to(self, stop: float, *, max_steps: int = 2**62) -> None:
        """Step until ``stop``, or until ``max_steps`` frames have been taken.

        Compiled code cannot be interrupted, so it is left at intervals.

        Raises
        ------
        RunError
            If time does not advance or the state overflows.
        """
        stop_code, remaining = StopCode.BUDGET_SPENT, max_steps
        while stop_code is StopCode.BUDGET_SPENT and remaining > 0:
            steps = min(remaining, 1 + _PIECE // self.chain.sites)
            remaining -= steps
            stop_code = StopCode(friction.advance(self._run, stop, steps))
        if stop_code is StopCode.NOT_FINITE:
            raise NotFiniteError(
                f"the run overflowed at tau = {self.time:.6g}; start from a smaller displacement."
            )
        if stop_code is StopCode.STEP_TOO_SHORT:
            raise StandstillError(
                f"the time step vanished at tau = {self.time:.6g}; take a larger v0 or a smaller c."
            )

    def going_to_rest(self) -> bool:
        """Whether every site is so near to stable steady sliding that none will stick again.

        The criterion is sufficient: the energy relative to steady sliding is below that at which a
        site could reach the velocity 1e-3 v_d, and the damping is positive at all velocities below
        it.
        """
        cell, c = self.chain.cell, self.chain.c
        if cell.effective_damping <= 0.0 or self.chain.ends is not Ends.FREE:
            return False
        y, velocity = self.state
        deviation = y - cell.steady_sliding
        energy = 0.5 * float(velocity @ velocity + deviation @ deviation)
        energy += 0.5 * c * float(np.sum(np.diff(deviation) ** 2))
        # The energy decreases while every |ẏ| < u, if the damping is positive at v_d - u.
        u = min(1e-3 * cell.v_d, 0.5 * cell.stability_margin)
        return energy < 0.5 * u * u and math.isfinite(energy)
