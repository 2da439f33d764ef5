"""One run of the friction chain in progress: state, bookkeeping, and how to go on with it."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from theory.chains.chain import Ends
from theory.chains.friction import FrictionChain
from theory.parameters import ParameterError, RunError, positive
from verification.steppers import friction
from verification.steppers.friction_series import binomials
from verification.steppers.taylor import taylor_order

FloatArray = npt.NDArray[np.float64]

_REST = 0.01
_PIECE = 200_000
"""Sites times steps, at most, between two looks at the keyboard: a fraction of a second."""


class FrictionRunError(RunError):
    """A run that cannot go on: time stands still, or the state has left double precision."""


class FrictionLane:
    """A run of (5) at one tolerance.

    Parameters
    ----------
    chain : FrictionChain
        Parameters.
    start : ndarray, shape (2, N)
        y and ẏ at τ = 0.
    tolerance : float
        Local error of y and ẏ, absolute.
    window : bool
        Leave out sites at the ends that are within a hundredth of the tolerance of steady sliding.
    watched : sequence of int, optional
        Sites from 1 to N whose arrivals count for :meth:`go_to`; by default all.
    times : ndarray, optional
        Where the state is sampled, ascending.
    events : int
        Events that are kept in ``log``.
    end : float
        τ to which :meth:`go_on` goes.

    Raises
    ------
    ParameterError
        If the start does not fit the chain.
    """

    def __init__(
        self,
        chain: FrictionChain,
        start: FloatArray,
        tolerance: float,
        *,
        window: bool = True,
        watched: Sequence[int] | None = None,
        times: FloatArray | None = None,
        events: int = 0,
        end: float = math.inf,
    ) -> None:
        start = np.asarray(start, dtype=float)
        if start.shape != (2, chain.sites) or not np.all(np.isfinite(start)):
            raise ParameterError(
                "start", f"an array of shape {start.shape}", f"finite, of shape (2, {chain.sites})",
                "give y and its velocity at every site",
            )  # fmt: skip
        cell = chain.cell
        self.chain, self.tolerance = chain, positive("tolerance", tolerance)
        self.order = taylor_order(tolerance)
        self._parameters = np.array([cell.mu_st, cell.mu_d, cell.v0, cell.xi, cell.v_d, chain.c])
        self._free = chain.ends is Ends.FREE
        self._binomial = binomials(self.order)
        self.y = start[0].copy()
        self._w = start[1] - cell.v_d
        self.modes = friction.initial_modes(self.y, self._w, self._parameters, self._free)
        kept = friction.allocate(chain.sites)
        self._released: npt.NDArray[np.bool_] = kept["released"]
        self._clock, self.counters = kept["clock"], kept["counters"]
        self.arrivals: FloatArray = kept["arrivals"]
        self._extremes: FloatArray = kept["extremes"]
        self._watched = np.ones(chain.sites, dtype=bool)
        if watched is not None:
            self._watched[:] = False
            self._watched[[site - 1 for site in watched]] = True
        self.times = np.zeros(0) if times is None else np.asarray(times, dtype=float)
        self._samples = np.zeros((self.times.size, 3, chain.sites))
        self._log = np.zeros((events, 3))
        self.end = end
        self._start = hashlib.sha256(np.ascontiguousarray(start).tobytes()).hexdigest()[:16]
        self._rest = -1.0
        self.counters[friction.HI] = chain.sites
        if window and self._free:
            self._leave_out_rest(_REST * tolerance)

    def _leave_out_rest(self, rest: float) -> None:
        cell, sites = self.chain.cell, self.chain.sites
        away = np.maximum(np.abs(self.y - cell.steady_sliding), np.abs(self._w + cell.v_d))
        moving = np.flatnonzero(away > rest)
        if moving.size == 0 or cell.effective_damping <= 0.0:
            return
        low = max(0, int(moving[0]) - friction.MARGIN)
        high = min(sites, int(moving[-1]) + friction.MARGIN + 1)
        self._rest = rest
        self.counters[friction.LO], self.counters[friction.HI] = low, high
        for part in (slice(0, low), slice(high, sites)):
            self.y[part], self._w[part] = cell.steady_sliding, -cell.v_d

    @property
    def time(self) -> float:
        """τ reached."""
        return float(self._clock[0])

    @property
    def finished(self) -> bool:
        """Whether ``end`` has been reached."""
        return self.time >= self.end

    @property
    def state_arrays(self) -> dict[str, npt.NDArray[Any]]:
        """The arrays that make up the state of the run; filled in place when it is resumed."""
        return {
            "y": self.y,
            "w": self._w,
            "modes": self.modes,
            "released": self._released,
            "clock": self._clock,
            "counters": self.counters,
            "arrivals": self.arrivals,
            "extremes": self._extremes,
            "samples": self._samples,
            "log": self._log,
        }

    @property
    def metadata(self) -> dict[str, float | int | str | bool]:
        """What decides the run, to be held against a checkpoint."""
        cell = self.chain.cell
        return {
            **{name: getattr(cell, name) for name in ("mu_st", "mu_d", "v0", "xi", "v_d")},
            "c": self.chain.c,
            "sites": self.chain.sites,
            "ends": self.chain.ends.value,
            "tolerance": self.tolerance,
            "rest": self._rest,
            "t_end": self.end,
            "times": hashlib.sha256(self.times.tobytes()).hexdigest()[:16],
            "events": len(self._log),
            "start": self._start,
        }

    def check_state(self) -> None:
        """Raise ValueError if the arrays are no state of this run; compiled code does not look."""
        first, last = (int(self.counters[n]) for n in (friction.LO, friction.HI))
        sampled, logged = (int(self.counters[n]) for n in (friction.SAMPLED, friction.LOGGED))
        if not np.all(np.isfinite(self._clock)):
            raise ValueError("a clock that is finite")
        counted = 0 <= sampled <= len(self._samples) and 0 <= logged <= len(self._log)
        if not (0 <= first <= last <= self.chain.sites and counted):
            raise ValueError("counters within the arrays that they count")

    def advance(self, budget: int) -> None:
        """Step until ``end``, or until a ``budget`` of sites times steps is spent."""
        self.go_to(self.end, most_steps=1 + budget // self.chain.sites)

    @property
    def velocity(self) -> FloatArray:
        """ẏ now; exactly v_d in stick."""
        velocity: FloatArray = self._w + self.chain.cell.v_d
        return velocity

    @property
    def samples(self) -> FloatArray:
        """y, ẏ and :attr:`amplitude` at ``times``, shape (M, 3, N)."""
        samples = self._samples.copy()
        samples[:, 1] += self.chain.cell.v_d
        np.nan_to_num(samples[:, 2], copy=False, nan=0.0)
        return samples

    @property
    def log(self) -> FloatArray:
        """Rows (τ, site from 1, kind) of the events kept."""
        log: FloatArray = self._log[: int(self.counters[friction.LOGGED])].copy()
        log[:, 1] += 1
        return log

    @property
    def amplitude(self) -> FloatArray:
        """Half of last maximum minus last minimum of y, per site; 0 before there are both."""
        half = 0.5 * (self._extremes[0] - self._extremes[1])
        amplitude: FloatArray = np.nan_to_num(np.abs(half), nan=0.0)
        return amplitude

    @property
    def arrived(self) -> int:
        """Watched sites that have stuck at some time."""
        return int(np.count_nonzero(~np.isnan(self.arrivals) & self._watched))

    def go_to(self, stop: float, *, wanted: int = 0, most_steps: int = 2**62) -> bool:
        """Step until ``stop``, or until so many watched sites have stuck; tell whether they have.

        Compiled code cannot be interrupted, so it is left now and then.

        Raises
        ------
        FrictionRunError
            If time stands still or the state overflows.
        """
        ended, left = friction.BUDGET, most_steps
        while ended == friction.BUDGET and left > 0:
            steps = min(left, 1 + _PIECE // self.chain.sites)
            left -= steps
            ended = self._advance(stop, wanted, steps)
        if ended == friction.NOT_FINITE:
            raise FrictionRunError(
                f"the run overflowed at tau = {self.time:.6g}; start from a smaller displacement."
            )
        if ended == friction.TOO_SHORT:
            raise FrictionRunError(
                f"time stands still at tau = {self.time:.6g}; take a larger v0 or a smaller c."
            )
        return bool(ended == friction.WANTED)

    def _advance(self, stop: float, wanted: int, most_steps: int) -> int:
        ended: int = friction.advance(
            self._parameters,
            self._free,
            self.y,
            self._w,
            self.modes,
            self._released,
            self._clock,
            self.counters,
            stop,
            self.tolerance,
            self.order,
            self._binomial,
            self._rest,
            self.chain.cell.steady_sliding,
            self.arrivals,
            self._watched,
            wanted,
            self._extremes,
            self.times,
            self._samples,
            self._log,
            most_steps,
        )
        return ended

    def going_to_rest(self, share: float = 1e-3) -> bool:
        """Tell whether every site is so near to stable steady sliding that none will stick again.

        Sufficient: the energy about steady sliding is below that at which a site could reach the
        velocity ``share`` v_d; there the friction curve is convex and all damping positive.
        """
        cell, c = self.chain.cell, self.chain.c
        if cell.effective_damping <= 0.0 or not self._free:
            return False
        away, velocity = self.y - cell.steady_sliding, self.velocity
        energy = 0.5 * float(velocity @ velocity + away @ away)
        energy += 0.5 * c * float(np.sum(np.diff(away) ** 2))
        # Energy falls while every |ẏ| < u, for which the damping at v_d - u must be positive.
        u = min(share * cell.v_d, 0.5 * (cell.v_d - cell.hopf_velocity))
        return energy < 0.5 * u * u and math.isfinite(energy)
