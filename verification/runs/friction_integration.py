"""The integration of the friction chain (5): exact from event to event."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from theory.chains.chain import Chain, Ends
from theory.chains.friction import FrictionChain
from theory.parameters import count_within, positive
from verification.execution.digest import digest_of_arrays
from verification.runs.integration import (
    Integration,
    NotFiniteError,
    StandstillError,
    check_options,
    checked_state,
    integration,
)
from verification.steppers import friction
from verification.steppers.friction_series import binomials
from verification.steppers.stop_code import StopCode
from verification.steppers.taylor import taylor_order

FloatArray = npt.NDArray[np.float64]

_REST = 0.01
_PIECE = 200_000
"""Sites times steps, at most, for which compiled code is not left: a fraction of a second."""


class FrictionIntegration(Integration):
    """A run of (5); the tolerance is absolute, of y and ẏ.

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
        τ of the end; by default the last of ``times``, or none.
    active_window : bool
        Do not step sites at the ends while they are within a hundredth of the tolerance of steady
        sliding.
    watched : sequence of int, optional
        Sites from 1 to N whose arrivals count for :meth:`advance_to`; by default all.
    logged_events : int
        Events that are kept in ``log``, from 0 to 1e8.

    Raises
    ------
    ParameterError
        If the start does not fit the chain.
    """

    method: ClassVar[str] = "Taylor series, exact events"
    default_tolerance: ClassVar[float] = 1e-10
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
        watched: Sequence[int] | None = None,
        logged_events: int = 0,
    ) -> None:
        state = checked_state(chain, start)
        self._start = state
        cell = chain.cell
        self.chain, self.tolerance = chain, positive("tolerance", tolerance)
        self.times = np.asarray(times, dtype=float)
        self.end = (float(self.times[-1]) if self.times.size else math.inf) if end is None else end
        logged = count_within("events logged", logged_events, 0, 10**8)
        parameters = np.array([cell.mu_st, cell.mu_d, cell.v0, cell.xi, cell.v_d, chain.c])
        free = chain.ends is Ends.FREE
        y, w = state[0].copy(), state[1] - cell.v_d
        modes = friction.initial_modes(y, w, parameters, free)
        self._run = friction.new_run(y, w, modes, self.times.size, logged)
        self._run.counters[friction.HI] = chain.sites
        rest = self._close_window(_REST * tolerance) if active_window and free else -1.0
        marked = np.ones(chain.sites, dtype=bool)
        if watched is not None:
            marked[:] = False
            marked[[site - 1 for site in watched]] = True
        self.order = taylor_order(tolerance)
        self._task = friction.Task(
            parameters,
            free,
            tolerance,
            self.order,
            binomials(self.order),
            rest,
            cell.steady_sliding,
            marked,
            self.times,
        )

    def _close_window(self, rest: float) -> float:
        """Close the window around what moves; return the distance up to which a site is at rest."""
        cell, sites, run = self.chain.cell, self.chain.sites, self._run
        away = np.maximum(np.abs(run.y - cell.steady_sliding), np.abs(run.w + cell.v_d))
        moving = np.flatnonzero(away > rest)
        if moving.size == 0 or cell.effective_damping <= 0.0:
            return -1.0
        low = max(0, int(moving[0]) - friction.MARGIN)
        high = min(sites, int(moving[-1]) + friction.MARGIN + 1)
        run.counters[friction.LO], run.counters[friction.HI] = low, high
        for part in (slice(0, low), slice(high, sites)):
            run.y[part], run.w[part] = cell.steady_sliding, -cell.v_d
        return rest

    @property
    def time(self) -> float:
        """τ reached."""
        return float(self._run.clock[0])

    @property
    def finished(self) -> bool:
        """Whether ``end`` has been reached."""
        return self.time >= self.end

    @property
    def state_arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The arrays that make up the state of the run; filled in place when it is resumed."""
        return dict(self._run._asdict())

    @property
    def metadata(self) -> dict[str, Any]:
        """What decides the run, to be held against a checkpoint."""
        return {
            **self.chain.parameters(),
            "tolerance": self.tolerance,
            "rest": self._task.rest,
            "t_end": self.end,
            "times": digest_of_arrays({"times": self.times})[:16],
            "logged_events": len(self._run.log),
            "start": digest_of_arrays({"start": self._start})[:16],
        }

    def check_state(self) -> None:
        """Raise ValueError if the arrays are no state of this run; compiled code does not look."""
        counters = self._run.counters
        first, last, sampled = (int(n) for n in counters[:3])
        if not np.all(np.isfinite(self._run.clock)):
            raise ValueError("a clock that is finite")
        logged = int(counters[friction.LOGGED])
        if not (
            0 <= first <= last <= self.chain.sites
            and 0 <= sampled <= self.times.size
            and 0 <= logged <= len(self._run.log)
        ):
            raise ValueError("counters within the arrays that they count")

    @property
    def state(self) -> FloatArray:
        """(y, ẏ) now, shape (2, N); ẏ is exactly v_d in stick."""
        return np.array([self._run.y, self._run.w + self.chain.cell.v_d])

    @property
    def stuck(self) -> npt.NDArray[np.bool_]:
        """Sites that stick now, shape (N,)."""
        stuck: npt.NDArray[np.bool_] = self._run.modes == 0
        return stuck

    @property
    def amplitude(self) -> FloatArray:
        """Half of last maximum minus last minimum of y, shape (N,); 0 before there are both."""
        half = 0.5 * (self._run.extremes[0] - self._run.extremes[1])
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
        """τ at which each site first stuck, shape (N,); nan where it did not."""
        return self._run.arrivals

    @property
    def arrived(self) -> int:
        """Watched sites that have stuck at some time."""
        return int(np.count_nonzero(~np.isnan(self._run.arrivals) & self._task.watched))

    def forget_arrivals(self) -> None:
        """Count arrivals anew from now on."""
        self._run.arrivals[:] = np.nan

    @property
    def counts(self) -> dict[str, int]:
        """Steps, and sites times steps."""
        counters = self._run.counters
        return {
            "steps": int(counters[friction.STEPS]),
            "site_steps": int(counters[friction.SITE_STEPS]),
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
        log: FloatArray = self._run.log[: int(self._run.counters[friction.LOGGED])].copy()
        log[:, 1] += 1
        return log

    @classmethod
    def perturbed(cls, chain: Chain, start: FloatArray, ulps: int) -> FloatArray:
        """Return the start with y at every site so many units in the last place larger.

        Examples
        --------
        >>> chain = FrictionChain(c=0.02, sites=2)
        >>> (FrictionIntegration.perturbed(chain, np.ones((2, 2)), 4) - 1.0).tolist()
        [[8.881784197001252e-16, 8.881784197001252e-16], [0.0, 0.0]]
        """
        moved = np.array(start, dtype=float)
        moved[0] += ulps * np.spacing(np.maximum(np.abs(moved[0]), chain.rest_state.y))
        return moved

    def advance(self, budget: int) -> None:
        """Step until ``end``, or until a ``budget`` of sites times steps is spent."""
        self.advance_to(self.end, max_steps=1 + budget // self.chain.sites)

    def advance_to(self, stop: float, *, required: int = 0, max_steps: int = 2**62) -> bool:
        """Step until ``stop``, or until so many watched sites have stuck; return whether they have.

        Compiled code cannot be interrupted, so it is left now and then.

        Raises
        ------
        RunError
            If time stands still or the state overflows.
        """
        ended, left = StopCode.BUDGET_SPENT, max_steps
        while ended is StopCode.BUDGET_SPENT and left > 0:
            steps = min(left, 1 + _PIECE // self.chain.sites)
            left -= steps
            ended = StopCode(friction.advance(self._task, self._run, stop, required, steps))
        if ended is StopCode.NOT_FINITE:
            raise NotFiniteError(
                f"the run overflowed at tau = {self.time:.6g}; start from a smaller displacement."
            )
        if ended is StopCode.STEP_TOO_SHORT:
            raise StandstillError(
                f"time stands still at tau = {self.time:.6g}; take a larger v0 or a smaller c."
            )
        return ended is StopCode.CONDITION

    def going_to_rest(self, share: float = 1e-3) -> bool:
        """Whether every site is so near to stable steady sliding that none will stick again.

        Sufficient: the energy about steady sliding is below that at which a site could reach the
        velocity ``share`` v_d; there the friction curve is convex and all damping positive.
        """
        cell, c = self.chain.cell, self.chain.c
        if cell.effective_damping <= 0.0 or not self._task.free:
            return False
        y, velocity = self.state
        away = y - cell.steady_sliding
        energy = 0.5 * float(velocity @ velocity + away @ away)
        energy += 0.5 * c * float(np.sum(np.diff(away) ** 2))
        # Energy falls while every |ẏ| < u, for which the damping at v_d - u must be positive.
        u = min(share * cell.v_d, 0.5 * (cell.v_d - cell.hopf_velocity))
        return energy < 0.5 * u * u and math.isfinite(energy)


@integration.register
def _(
    chain: FrictionChain, start: npt.ArrayLike, times: npt.ArrayLike, **options: Any
) -> FrictionIntegration:
    check_options(FrictionIntegration, options)
    return FrictionIntegration(chain, start, times, **options)
