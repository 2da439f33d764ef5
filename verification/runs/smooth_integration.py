"""The integration of a smooth chain: compiled DOP853, and for (8) an implicit stage where stiff."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields
from typing import Any, ClassVar

import numpy as np
import numpy.typing as npt

from theory.arrays import AnyArray, FloatArray
from theory.chains.chain import MAX_SITES, SmoothChain
from theory.chains.ends import Ends
from theory.chains.vdp import VdpChain
from theory.parameters import (
    ParameterError,
    Range,
    count_within,
    need_instance,
    positive,
    real_number,
    truth,
    word,
)
from verification.execution.digest import digest_of_arrays
from verification.runs.integration import (
    Integration,
    NotFiniteError,
    StandstillError,
    as_psi,
    checked_state,
)
from verification.steppers import smooth
from verification.steppers.active import FOLLOWING, FREE, NETWORK, RING
from verification.steppers.kernel import own_slope_mark
from verification.steppers.stop_code import StopCode

STIFF_METHOD = "Radau"
"""Name of the implicit method, which takes over from the explicit one where (8) is stiff."""

STIFF_STEP = 5e-4
"""Steps of (8) below this are left to the implicit method; the damping rate is then about 1e4."""

MAX_STIFF_STEPS = 100_000_000
"""Largest number of explicit steps below `STIFF_STEP` that a run may still need: one and a half
minutes on a few sites, three on a few dozen."""

_PACE_STEPS = 100_000
"""Number of steps after which the pace of a run is measured."""
_PACE_CHANGE, _PACE_GAIN = 0.2, 0.4
"""A relative change of the state, and the factor to which a damping rate proportional to y⁴ falls
over it, 0.8⁴ = 0.4: meanwhile steps grow at most by the inverse of this factor."""

REVIEW = 6.5
"""Kernel time after which the step of an oscillation may grow: slightly more than a period."""

MARGIN, WEAK_COUPLING = 4, 3.0
"""Number of sites at rest that are stepped beyond the last moving one; it is doubled at couplings
above the second number. The effect of the active window is then below a hundredth of the
tolerance."""

_RATES = Range(-1e300, 1e300)
"""Range of the rates of change of drifting parameters."""
_DECAYED = 0.5
"""Fraction of the unstable amplitude, or of the level, below which every site decays to rest."""
_AT_REST = 1e-290
"""Largest value of a state below which its errors are no longer relative to it, since they would
underflow."""


class SmoothIntegration(Integration):
    """A run of a smooth chain; the tolerance is relative to the largest value of the state.

    The steps are taken in kernel time, which is t times ``chain.kernel_rate``: slow time εt for
    (43), t itself for (8).

    Parameters
    ----------
    chain : SmoothChain
        Parameters.
    start : array_like
        State at t = 0.
    times : array_like, shape (M,)
        Times t of the samples.
    tolerance : float
        Local error relative to the largest value.
    end : float, optional
        Time t of the end; by default the last of ``times``.
    level : float, optional
        Amplitude that counts as an arrival; by default the unstable amplitude of the chain.
    active_window : bool
        Step only the sites that move, and a few beside them.
    trailing_sites : int
        For a front that runs to larger n: step only this number of sites behind the foremost
        arrival, and continue a wave beyond them; 0 for all sites.
    left_boundary_wave : bool
        Continue an unending wave beyond the first site, instead of an end.
    drift : dict of str to float, optional
        Rates of change of parameters, per unit of t.
    step : float, optional
        Take equal steps of this length, in kernel time, instead of using the tolerance.
    shortest_step, longest_step : float
        Limits of the step in kernel time: the run fails if a shorter one is needed (a start of 1e3
        in (43) needs about 1e-11), and no step is longer than the second.
    watch, memory : optional
        A stop condition (``steppers.smooth.Condition``) and its numbers.
    """

    method: ClassVar[str] = "DOP853"

    def __init__(  # noqa: PLR0913  (all but three by name)
        self,
        chain: SmoothChain,
        start: npt.ArrayLike,
        times: npt.ArrayLike,
        *,
        tolerance: float = 1e-9,
        end: float | None = None,
        level: float | None = None,
        active_window: bool = True,
        trailing_sites: int = 0,
        left_boundary_wave: bool = False,
        drift: dict[str, float] | None = None,
        step: float | None = None,
        shortest_step: float = 1e-13,
        longest_step: float = math.inf,
        watch: smooth.Condition | None = None,
        memory: FloatArray | None = None,
    ) -> None:
        state = checked_state(chain, start)
        wave = truth("left_boundary_wave", left_boundary_wave)
        trailing = count_within("trailing sites", trailing_sites, 0, MAX_SITES)
        first = _beyond_first_site(chain, trailing, wave)
        _check_steps(step, shortest_step, longest_step)
        self.chain, self.tolerance = chain, tolerance
        self.times = np.asarray(times, dtype=float)
        self.end = float(self.times[-1]) if end is None else end
        self.level = chain.unstable_amplitude if level is None else level
        self.trailing_sites = trailing
        self._rate = chain.kernel_rate
        self._stiff = isinstance(chain, VdpChain) and step is None and watch is None
        self._start = state.copy()
        self._size = float(np.hypot(*state).max())
        self._left_boundary_wave = wave
        self._run = _at_start(state, self.times.size, self.level, memory)
        self._margin, self._watch = _margin(chain), watch
        self._measured = (0, 0.0, self._size)
        # Where rest is unstable, even the smallest motion ahead grows, so no site is left out.
        local = first != RING and self._margin < chain.sites and chain.rest_attracts
        windowed = truth("active_window", active_window) and local
        self._rest = self._close_window() if windowed else -1.0
        if self._rest < 0.0:
            self._run.counters[smooth.HI] = chain.sites
        self._task = smooth.LoopTask(
            parameters=np.array(chain.kernel_parameters()),
            drift=self._drift({} if drift is None else drift),
            first=first,
            end=self.end * self._rate,
            tolerance=0.0 if step is not None else tolerance,
            shortest=STIFF_STEP if self._stiff else shortest_step,
            longest=longest_step if step is None else step,
            review=REVIEW if chain.oscillates else 0.0,
            rest=self._rest,
            margin=self._margin,
            level=self.level,
            trailing=self.trailing_sites,
            times=self.times * self._rate,
            clock_place=smooth.clock_place(chain),
            least_size=max(chain.forced_size, _AT_REST),
        )

    def _drift(self, rates: dict[str, float]) -> FloatArray:
        """Return the rates of change of the kernel's parameters, per unit of kernel time."""
        p = np.array(self.chain.kernel_parameters())
        found = np.zeros(p.size)
        need_instance("drift", rates, (Mapping,), 'give rates by parameter, as {"c": 1e-5}')
        known = [each.name for each in fields(self.chain) if each.type == "float"]
        for name, rate in rates.items():
            word("drifting parameter", name, known)
            quantity, remedy = f"rate of change of {name}", "give its change per unit of t"
            real_number(quantity, rate, *_RATES, remedy)
            # The kernel's parameters are affine in each chain parameter that may drift.
            shifted = self.chain.replace(**{name: getattr(self.chain, name) + 1.0})
            found += rate * (np.array(shifted.kernel_parameters()) - p)
        return found / self._rate

    def _close_window(self) -> float:
        """Close the window around the moving sites; return the amplitude of sites at rest."""
        chain: SmoothChain = self.chain
        rest = self.tolerance * max(self._size, chain.forced_size)
        state, counters, sites = self._run.state, self._run.counters, self.chain.sites
        counters[smooth.HI] = sites
        moves = np.hypot(*state) > rest
        for force in chain.forces:
            moves |= force.amplitudes(sites) != 0.0
        moving = np.flatnonzero(moves)
        if moving.size:
            counters[smooth.LO] = max(0, moving[0] - self._margin)
            counters[smooth.HI] = min(sites, moving[-1] + self._margin + 1)
            state[:, : counters[smooth.LO]] = 0.0
            state[:, counters[smooth.HI] :] = 0.0
        return rest

    @property
    def state_arrays(self) -> dict[str, AnyArray]:
        """The arrays that make up the state of the run; filled in place when it is resumed."""
        return dict(self._run._asdict())

    @property
    def metadata(self) -> dict[str, Any]:
        """Everything that determines the run, to be compared with a checkpoint."""
        return {
            **self.chain.parameters(),
            "right_hand_side": own_slope_mark(self.chain),
            "tolerance": self._task.tolerance,
            "level": self.level,
            "left_boundary_wave": self._left_boundary_wave,
            "trailing_sites": self.trailing_sites,
            "rest": self._rest,
            "t_end": self.end,
            "samples": int(self.times.size),
            "times": digest_of_arrays({"times": self.times})[:16],
            "drift": self._task.drift.tolist(),
            "step": self._task.longest if self._task.tolerance == 0.0 else None,
            "step_limits": [str(each) for each in (self._task.shortest, self._task.longest)],
            "start": digest_of_arrays({"start": self._start})[:16],
        }

    def check_state(self) -> None:
        """Raise ValueError if the arrays are no valid state; compiled code does not check them."""
        counters = self._run.counters
        first, last, sampled = (int(n) for n in counters[:3])
        if not np.all(np.isfinite(self._run.clock)):
            raise ValueError("a clock that is finite")
        if not (0 <= first <= last <= self.chain.sites and 0 <= sampled <= self.times.size):
            raise ValueError("counters within the arrays that they count")

    @property
    def time(self) -> float:
        """Time t reached, at most the end."""
        return min(float(self._run.clock[0]) / self._rate, self.end)

    @property
    def finished(self) -> bool:
        """Whether every sample has been taken, or the stop condition is met."""
        sampled = self._run.counters[smooth.SAMPLED] == self.times.size
        return bool((sampled and self._run.clock[0] >= self._task.end) or self.outcome)

    @property
    def outcome(self) -> int:
        """The return value of the stop condition; 0 while it is not met."""
        return int(self._run.counters[smooth.OUTCOME])

    @property
    def state(self) -> FloatArray:
        """Present state (y, w), shape (2, N)."""
        return self._run.state

    @property
    def amplitude(self) -> FloatArray:
        """Present √(y² + w²) of every site, shape (N,)."""
        amplitude: FloatArray = np.hypot(*self._run.state)
        return amplitude

    @property
    def left_behind(self) -> FloatArray:
        """√(y² + w²) of the sites left out behind a front, at the time when each was left out."""
        first = int(self._run.counters[smooth.LO]) if self.trailing_sites else 0
        return self.amplitude[:first]

    @property
    def samples(self) -> FloatArray:
        """(y, w) at ``times``, shape (M, 2, N)."""
        return self._run.samples

    @property
    def sampled_amplitude(self) -> FloatArray:
        """√(y² + w²) at ``times``, shape (M, N)."""
        return np.abs(as_psi(self._run.samples))

    @property
    def arrivals(self) -> FloatArray:
        """Time t at which each site first passed the level, shape (N,); nan if it did not."""
        return self._run.arrivals / self._rate

    @property
    def counts(self) -> dict[str, int]:
        """Number of steps, sites times steps, and how many steps the implicit method took."""
        counters = self._run.counters
        return {
            "steps": int(counters[smooth.STEPS] + counters[smooth.STIFF_STEPS]),
            "site_steps": int(counters[smooth.SITE_STEPS]),
            "stiff_steps": int(counters[smooth.STIFF_STEPS]),
        }

    @classmethod
    def method_of(cls, counts: Mapping[str, int]) -> str:
        """Return ``DOP853``, ``Radau``, or both if both took steps."""
        stiff, steps = counts["stiff_steps"], counts["steps"]
        if not stiff:
            return cls.method
        return STIFF_METHOD if stiff == steps else f"{cls.method}, {STIFF_METHOD}"

    def going_to_rest(self) -> bool:
        """Whether no further site will be reached, because all are decaying to rest.

        All must be below half the unstable amplitude, and below half the level where that is lower.
        """
        if self.chain.forces or not self.chain.rest_attracts:
            return False
        level = min(self.level, self.chain.unstable_amplitude)
        return bool(self.amplitude.max() < _DECAYED * level)

    def least_error(self) -> float:
        """Return the local error of a step that does not grow, at the largest sampled state."""
        local_tolerance = self.tolerance
        if self.counts["stiff_steps"]:
            from verification.steppers.stiff_stage import TIGHTEST

            local_tolerance = max(local_tolerance, TIGHTEST)
        size: float = max(float(np.abs(self._run.samples).max()), self.chain.forced_size)
        return smooth.LAZY * local_tolerance * size

    def least_arrival_error(self) -> float:
        """Return the same fraction of the tolerance, in kernel time."""
        return smooth.LAZY * self.tolerance / self._rate

    def advance(self, budget: int) -> None:
        """Step until the end, or until about ``budget`` sites times steps are spent.

        Raises
        ------
        RunError
            If the state overflows, or the steps would become too short.
        """
        run, counters = self._run, self._run.counters
        active = max(1, int(counters[smooth.HI] - counters[smooth.LO]))
        loop = smooth.loop(self.chain, self._watch)
        stop_code = StopCode(loop(self._task, run, max(1, budget // active)))
        if stop_code is StopCode.STEP_TOO_SHORT and self._stiff:
            self._pass_stiff_stage()
        elif stop_code is StopCode.STEP_TOO_SHORT:
            raise StandstillError(
                f"a displacement of {np.abs(run.state).max():.3g} makes the model "
                f"{self.chain.model} need steps below {self._task.shortest:g} of its time at "
                f"t = {self.time:.6g}: start from a smaller displacement"
                + (
                    ", or run (8), which has a stiff method."
                    if hasattr(self.chain, "full")
                    else "."
                )
            )
        elif stop_code is StopCode.NOT_FINITE:
            raise NotFiniteError(
                f"the run overflowed at t = {self.time:.6g}; "
                "start from a smaller displacement, or lower the coupling."
            )

    def check_pace(self) -> None:
        """Refuse a run to its end that would take very many short steps.

        The number of steps is a lower bound: it is counted up to where the largest value of the
        state has changed by a fifth, at its present rate.

        Raises
        ------
        StandstillError
            If more than `MAX_STIFF_STEPS` are still needed.
        """
        run, task = self._run, self._task
        steps, time = int(run.counters[smooth.STEPS]), float(run.clock[0])
        new_steps = steps - self._measured[0]
        if new_steps < _PACE_STEPS or self._watch is not None or task.tolerance == 0.0:
            return
        size = float(np.abs(run.state).max())
        elapsed, change = time - self._measured[1], abs(size - self._measured[2])
        self._measured = (steps, time, size)
        remaining = max(task.end - time, 0.0)
        if change > 0.0:
            remaining = min(remaining, _PACE_CHANGE * size / change * elapsed)
        if (
            elapsed < STIFF_STEP * new_steps
            and _PACE_GAIN * remaining * new_steps > MAX_STIFF_STEPS * elapsed
        ):
            raise StandstillError(
                f"a displacement of {size:.3g} makes the model {self.chain.model} so stiff that at "
                f"t = {self.time:.6g} it needs more than {MAX_STIFF_STEPS:g} further steps of some "
                f"{elapsed / new_steps / self._rate:.2g}: start from a smaller displacement, or "
                "end earlier; of all chains only (8) of model vdp has a stiff method."
            )

    def _pass_stiff_stage(self) -> None:
        """Cover an interval of time, with its samples and arrivals, by the implicit method."""
        from verification.steppers.stiff_stage import solve_stiff_piece

        run, counters, task = self._run, self._run.counters, self._task
        first, last = int(counters[smooth.LO]), int(counters[smooth.HI])
        piece = solve_stiff_piece(
            self.chain,
            run.state,
            (first, last),
            float(run.clock[0]),
            task.end,
            self.tolerance,
            self._rest,
            self._margin,
            int(counters[smooth.STIFF_STEPS]),
        )
        active, end = slice(piece.first, piece.last), float(piece.times[-1])
        while (
            counters[smooth.SAMPLED] < self.times.size
            and task.times[counters[smooth.SAMPLED]] <= end
        ):
            sample = run.samples[counters[smooth.SAMPLED]]
            sample[:] = run.state
            sample[:, active] = piece.state(task.times[counters[smooth.SAMPLED]])
            counters[smooth.SAMPLED] += 1
        for site, time in piece.passes(self.level).items():
            if np.isnan(run.arrivals[site]):
                run.arrivals[site] = time
        run.state[:, active] = piece.state(end)
        run.clock[0], run.clock[4] = end, 0.0
        moving = piece.first + np.flatnonzero(np.hypot(*run.state[:, active]) > self._rest)
        if moving.size:
            sites = self.chain.sites
            counters[smooth.LO] = min(first, max(0, moving[0] - self._margin))
            counters[smooth.HI] = max(last, min(sites, moving[-1] + self._margin + 1))
        steps = piece.times.size - 1
        counters[smooth.STIFF_STEPS] += steps
        counters[smooth.SITE_STEPS] += steps * (piece.last - piece.first)


def _at_start(
    state: FloatArray, samples: int, level: float, memory: FloatArray | None
) -> smooth.LoopState:
    """Return the arrays of a run at time 0, with sites above the level counted as arrived."""
    sites = state.shape[1]
    return smooth.LoopState(
        state=state,
        clock=np.zeros(5),
        counters=np.zeros(7, dtype=np.int64),
        arrivals=np.where(np.hypot(*state) >= level, 0.0, np.nan),
        samples=np.zeros((samples, 2, sites)),
        memory=np.zeros(1) if memory is None else memory,
    )


def _check_steps(step: float | None, shortest: float, longest: float) -> None:
    """Refuse invalid lengths of steps."""
    if step is not None:
        positive("step", step, "give the length of the steps in kernel time")
    for name, limit in (("shortest step", shortest), ("longest step", longest)):
        if limit != math.inf:
            real_number(name, limit, 0.0, 1e300, "give a length in kernel time")


def _beyond_first_site(chain: SmoothChain, trailing_sites: int, wave: bool) -> int:
    """Return which kind of boundary lies before the first site (``steppers.active``)."""
    if chain.network is not None:
        if trailing_sites or wave:
            raise ParameterError(
                "left boundary", "a wave", "free where sites are coupled to sites other "
                "than their neighbours", "leave it out",
            )  # fmt: skip
        return NETWORK
    if chain.ends is Ends.PERIODIC:
        if trailing_sites:
            raise ParameterError("trailing sites", trailing_sites, "0 on a ring", "take free ends")
        return RING
    if chain.ends is not Ends.FREE:
        raise ParameterError("ends", chain.ends.value, "free or periodic", "choose one of these")
    return FOLLOWING if wave else FREE


def _margin(chain: SmoothChain) -> int:
    """Return the number of sites at rest that are stepped beyond the last moving one."""
    margin = 2 * MARGIN if getattr(chain, "c", math.inf) > WEAK_COUPLING else MARGIN
    return margin if chain.network is None else margin * max(1, chain.network.reach)
