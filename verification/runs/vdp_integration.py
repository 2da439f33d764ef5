"""One run of Model II in progress: everything that is needed to go on with it, and nothing else."""

from __future__ import annotations

import hashlib

import numpy as np
import numpy.typing as npt

from theory.chains.chain import Ends
from theory.chains.vdp import VdpChain
from theory.parameters import RunError
from verification.steppers import stepping
from verification.steppers.active import FOLLOWING, FREE, RING
from verification.steppers.slopes import ENVELOPE, FULL

FloatArray = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]

SHORTEST = 5e-4
"""Steps of (8) below this are left to the stiff method: the damping rate is then some 1e4."""

SHORTEST_SLOW = 1e-13
"""Steps of (43) below this are given up; a start of 1e3 needs some 1e-11."""

_REST, _MARGIN, _WEAK = 1.0, 4, 3.0
"""Rest level of the active window over the tolerance times the largest |Ψ| of the start; sites kept
beyond the last one above it, twice as many at couplings above the last number. What this changes is
below a hundredth of the tolerance."""


class NotFiniteError(RunError):
    """The state has left the range of double precision."""


class Lane:
    """A run at one tolerance.

    Parameters
    ----------
    chain : VdpChain
        Parameters.
    full : bool
        (8) or, if false, (43) in slow time T = εt.
    start : ndarray of complex, shape (N,)
        Ψ(0).
    times : ndarray, shape (M,)
        Times t of the samples, from 0 to the end.
    tolerance, level, window, behind
        As in ``verification.runs.vdp.run_vdp``.
    wave : bool
        To the left of the first site a wave goes on, φ = iφ of its neighbour, instead of an end.
    """

    def __init__(
        self,
        chain: VdpChain,
        full: bool,
        start: ComplexArray,
        times: FloatArray,
        tolerance: float,
        level: float,
        window: bool,
        behind: int,
        wave: bool = False,
    ) -> None:
        self._chain, self._full = chain, full
        self._first = RING if chain.ends is Ends.PERIODIC else FOLLOWING if wave else FREE
        self._model = FULL if full else ENVELOPE
        self._scale = 1.0 if full else chain.eps
        self.tolerance, self.level, self._behind = tolerance, level, behind
        self.sample_times = times * self._scale
        self._start = hashlib.sha256(np.ascontiguousarray(start).tobytes()).hexdigest()[:16]
        # y = Im Ψ and ẏ = Re Ψ; for the envelope (Re φ, Im φ).
        self.state = np.array([start.imag, start.real] if full else [start.real, start.imag])
        self.samples = np.zeros((times.size, 2, chain.sites))
        self.clock = np.zeros(5)
        self.counters = np.zeros(6, dtype=np.int64)
        self._arrivals = np.full(chain.sites, np.nan)
        size = np.abs(start)
        self._arrivals[size >= level] = 0.0
        self.rest = -1.0
        self.margin = _MARGIN if chain.c <= _WEAK else 2 * _MARGIN
        self.counters[:2] = 0, chain.sites
        if window and chain.ends is Ends.FREE:
            self.rest = _REST * tolerance * float(size.max())
            moving = np.flatnonzero(size > self.rest)
            if moving.size:
                self.counters[0] = max(0, moving[0] - self.margin)
                self.counters[1] = min(chain.sites, moving[-1] + self.margin + 1)
                self.state[:, : self.counters[0]] = 0.0
                self.state[:, self.counters[1] :] = 0.0

    @property
    def state_arrays(self) -> dict[str, FloatArray | npt.NDArray[np.int64]]:
        """The arrays that make up the state of the run; filled in place when it is resumed."""
        return {
            "state": self.state,
            "samples": self.samples,
            "clock": self.clock,
            "counters": self.counters,
            "arrivals": self._arrivals,
        }

    @property
    def metadata(self) -> dict[str, float | int | str | bool]:
        """What decides the run, to be held against a checkpoint."""
        chain = self._chain
        return {
            "a": chain.a,
            "b": chain.b,
            "c": chain.c,
            "eps": chain.eps,
            "sites": chain.sites,
            "ends": chain.ends.value,
            "model": self._model,
            "tolerance": self.tolerance,
            "level": self.level,
            "first": self._first,
            "behind": self._behind,
            "rest": self.rest,
            "t_end": self.end,
            "samples": int(self.sample_times.size),
            "start": self._start,
        }

    def check_state(self) -> None:
        """Raise ValueError if the arrays are no state of this run; compiled code does not look."""
        first, last, sampled = (int(n) for n in self.counters[:3])
        if not np.all(np.isfinite(self.clock)):
            raise ValueError("a clock that is finite")
        if not (0 <= first <= last <= self._chain.sites and 0 <= sampled <= len(self.samples)):
            raise ValueError("counters within the arrays that they count")

    @property
    def time(self) -> float:
        """Time t reached, at most the end."""
        return min(float(self.clock[0]), self.end) / self._scale

    @property
    def end(self) -> float:
        """Time of the last sample, slow time for the envelope."""
        return float(self.sample_times[-1])

    @property
    def finished(self) -> bool:
        """Whether every sample has been taken."""
        return bool(self.counters[2] == self.sample_times.size)

    @property
    def stiff_steps(self) -> int:
        """Steps of the stiff method."""
        return int(self.counters[5])

    @property
    def psi(self) -> ComplexArray:
        """The samples as Ψ or φ, shape (M, N)."""
        y, w = self.samples[:, 0], self.samples[:, 1]
        psi: ComplexArray = w + 1j * y if self._full else y + 1j * w
        return psi

    @property
    def arrivals(self) -> FloatArray:
        """Times t of arrival, shape (N,)."""
        return self._arrivals / self._scale

    def advance(self, budget: int) -> None:
        """Step until the end, or until some ``budget`` of sites times steps is spent.

        Raises
        ------
        NotFiniteError
            If the state overflows.
        """
        chain = self._chain
        active = max(1, int(self.counters[1] - self.counters[0]))
        ended = stepping.advance(
            self._model,
            np.array([chain.a, chain.b, chain.c, chain.eps]),
            self._first,
            self.state,
            self.clock,
            self.counters,
            self.end,
            self.tolerance,
            self.rest,
            self.margin,
            self.level,
            self._behind,
            self._arrivals,
            self.sample_times,
            self.samples,
            SHORTEST if self._full else SHORTEST_SLOW,
            max(1, budget // active),
        )
        if ended == stepping.TOO_SHORT and self._full:
            self._pass_stiff_stage()
        elif ended == stepping.TOO_SHORT:
            raise NotFiniteError(
                f"a displacement of {np.abs(self.state).max():.3g} makes the averaged chain (43) "
                f"need steps below {SHORTEST_SLOW:g} of slow time: start from a smaller one, or "
                "run (8), which has a stiff method."
            )
        elif ended == stepping.NOT_FINITE:
            raise NotFiniteError(
                f"the run overflowed at t = {self.time:.6g}; "
                "start from a smaller displacement, or lower the coupling."
            )

    def _pass_stiff_stage(self) -> None:
        """Go on by the stiff method for a piece of time; samples and arrivals are taken from it."""
        from verification.steppers.stiff_stage import solve_stiff_piece

        first, last = (int(site) for site in self.counters[:2])
        piece = solve_stiff_piece(
            self._chain,
            self.state,
            (first, last),
            float(self.clock[0]),
            self.end,
            self.tolerance,
            self.rest,
            self.margin,
            self.stiff_steps,
        )
        part, end = slice(piece.first, piece.last), float(piece.times[-1])
        while not self.finished and self.sample_times[self.counters[2]] <= end:
            sample = self.samples[self.counters[2]]
            sample[:] = self.state
            sample[:, part] = piece.state(self.sample_times[self.counters[2]])
            self.counters[2] += 1
        for site, time in piece.passes(self.level).items():
            if np.isnan(self._arrivals[site]):
                self._arrivals[site] = time
        self.state[:, part] = piece.state(end)
        self.clock[0], self.clock[4] = end, 0.0
        moving = piece.first + np.flatnonzero(np.hypot(*self.state[:, part]) > self.rest)
        if moving.size:
            self.counters[0] = min(first, max(0, moving[0] - self.margin))
            self.counters[1] = max(last, min(self._chain.sites, moving[-1] + self.margin + 1))
        self.counters[5] += piece.times.size - 1
