"""An independent event-located run of the friction chain (5) by scipy, slow but separate.

Between events scipy's DOP853 integrates (y, w = ẏ - v_d). Events are searched for at several points
per step on its dense output, and located by Brent's method. The module shares only the parameters
with the compiled stepper of ``verification.steppers``, and serves to check it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np
from scipy.integrate import DOP853
from scipy.optimize import brentq

from theory.arrays import FloatArray, IntArray
from theory.chains.friction import FrictionChain
from theory.parameters import positive, within
from verification.references.equations import dynamic_friction, load
from verification.references.pace import NoReferenceError, Pace

BEGINS, ENDS, REVERSES = 0, 1, 2
"""Kinds of events."""

_CHECKS = 8
_SIMULTANEOUS = 1e-12
_BEYOND = 1e-9


@dataclass(frozen=True)
class EventRun:
    """The result of a run.

    Attributes
    ----------
    times : ndarray, shape (M,)
        τ of the samples.
    y, velocity : ndarray, shape (M, N)
        State at those times.
    log : ndarray, shape (K, 3)
        τ, site (from 1) and kind of every event.
    seconds : float
        Run time.
    """

    times: FloatArray
    y: FloatArray
    velocity: FloatArray
    log: FloatArray
    seconds: float

    def when(self, kind: int) -> FloatArray:
        """Return the τ of all events of a kind, over all sites."""
        found: FloatArray = self.log[self.log[:, 2] == kind, 0]
        return found

    @property
    def last_cycle(self) -> tuple[float, float] | None:
        """Period and stick time of a single site's last cycle; None if it never stuck twice."""
        ends, begins = self.when(ENDS), self.when(BEGINS)
        if ends.size < 2 or begins.size < 1:
            return None
        return float(ends[-1] - ends[-2]), float(ends[-1] - begins[begins < ends[-1]][-1])


def run_events(
    chain: FrictionChain,
    start: FloatArray,
    t_end: float,
    *,
    tolerance: float,
    times: FloatArray | None = None,
    longest_step: float = 0.05,
    pace: Pace | None = None,
) -> EventRun:
    """Run (5) from τ = 0 to ``t_end``, locating every event.

    Parameters
    ----------
    chain : FrictionChain
        Parameters.
    start : ndarray, shape (2, N)
        y and ẏ.
    t_end : float
        τ, positive.
    tolerance : float
        Relative tolerance of DOP853; the absolute one is a tenth of it.
    times : ndarray, optional
        Times at which the state is sampled, ascending; by default 201 evenly spaced times.
    longest_step : float
        Longest step, which makes the dense output, of order 7 only, sufficiently accurate.
    pace : Pace, optional
        Aborts runs that would take too long; by default there is no limit.

    Raises
    ------
    ParameterError
        If a number is out of range.
    NoReferenceError
        If DOP853 fails, or a site starts exactly on an event.
    TooSlowError
        If the run proceeds too slowly.

    Examples
    --------
    >>> chain = FrictionChain(c=0.0, sites=1)
    >>> run = run_events(chain, np.array([[2.0], [0.0]]), 12.0, tolerance=1e-9)
    >>> run.log[:, 2].astype(int).tolist()
    [0, 1, 0, 1]
    """
    begin = perf_counter()
    positive("end time tau", t_end)
    within("tolerance", tolerance, 2.3e-14, 1e-2)
    positive("longest step", longest_step)
    sampled = np.linspace(0.0, t_end, 201) if times is None else np.asarray(times, dtype=float)
    sites = chain.sites
    law = _Law(chain)
    state = np.concatenate([start[0], np.asarray(start[1]) - chain.cell.v_d])
    modes = law.first_modes(state)
    samples = np.zeros((sampled.size, 2 * sites))
    log: list[tuple[float, int, int]] = []
    t, taken = 0.0, 0
    while t < t_end:
        solver = DOP853(
            partial(law.rate, modes), t, state, t_end,
            rtol=tolerance, atol=0.1 * tolerance, max_step=longest_step,
        )  # fmt: skip
        event = None
        while event is None and solver.status == "running":
            complaint = solver.step()
            if complaint is not None:
                raise NoReferenceError(f"DOP853 failed at tau = {solver.t:.6g}: {complaint}")
            if pace is not None:
                pace.check(solver.t / t_end)
            dense = solver.dense_output()
            event = _earliest(law, dense, modes, float(solver.t_old), float(solver.t))
            reached = float(solver.t) if event is None else event
            while taken < sampled.size and sampled[taken] <= reached:
                samples[taken] = dense(sampled[taken])
                taken += 1
        t = reached
        if event is None:
            break
        state, kinds = law.switched(dense(event), dense, event, modes)
        log += [(event, site + 1, kind) for site, kind in kinds]
    return EventRun(
        sampled,
        samples[:, :sites],
        samples[:, sites:] + chain.cell.v_d,
        np.array(log).reshape(-1, 3),
        perf_counter() - begin,
    )


class _Law:
    """Equations (5) and (6) between events, and the events."""

    def __init__(self, chain: FrictionChain) -> None:
        self.chain, self.cell, self.sites = chain, chain.cell, chain.sites

    def hold(self, z: FloatArray) -> FloatArray:
        """Return the force that would hold each site on the belt; z may have several columns."""
        return load(z[: self.sites], self.cell.v_d, self.chain)

    def rate(self, modes: IntArray, _: float, z: FloatArray) -> FloatArray:
        """Return the derivative of (y, w) for modes 0 in stick, otherwise the sign of w in slip."""
        w = z[self.sites :]
        velocity = w + self.cell.v_d
        friction = modes * dynamic_friction(modes * w, self.cell)
        force = friction + load(z[: self.sites], velocity, self.chain)
        return np.concatenate([velocity, -np.abs(modes) * force])

    def first_modes(self, z: FloatArray) -> IntArray:
        """Return the modes at the start."""
        w, force = z[self.sites :], self.hold(z)
        free = np.where(np.abs(force) > self.cell.mu_st, -np.sign(force), 0.0)
        return np.where(w != 0.0, np.sign(w), free).astype(np.int64)

    def distance(self, z: FloatArray, modes: IntArray) -> FloatArray:
        """Return a function that is positive before the event of a site and negative after it."""
        signs = modes.reshape(-1, *[1] * (z.ndim - 1))
        stick = self.cell.mu_st - np.abs(self.hold(z))
        return np.where(signs == 0, stick, signs * z[self.sites :])

    def switched(
        self, z: FloatArray, dense: Any, t: float, modes: IntArray
    ) -> tuple[FloatArray, list[tuple[int, int]]]:
        """Change in place the modes of the sites that have this event; return the events."""
        # Events that are simultaneous by symmetry differ by round-off, so look slightly ahead.
        now = self.distance(z, modes)
        speed = np.abs(self.distance(dense(t - 1e-6), modes) - now) / 1e-6
        due = np.flatnonzero((np.abs(now) <= _SIMULTANEOUS * (1.0 + speed)) & (speed > 0.0))
        kinds = []
        force = self.hold(z)
        for n in due:
            if modes[n] == 0:
                modes[n] = -1 if force[n] > 0.0 else 1
                kinds.append((int(n), ENDS))
            elif abs(force[n]) <= self.cell.mu_st:
                modes[n] = 0
                kinds.append((int(n), BEGINS))
            else:
                modes[n] = -modes[n]
                kinds.append((int(n), REVERSES))
            z[self.sites + n] = 0.0
        return z, kinds


def _earliest(law: _Law, dense: Any, modes: IntArray, low: float, high: float) -> float | None:
    """Return the earliest event in a step; a site that starts at zero must first leave it."""
    times = np.linspace(low, high, _CHECKS + 1)
    values = law.distance(dense(times), modes).T
    found = []
    for n in range(modes.size):
        if np.all(values[:, n] <= 0.0) and values[-1, n] < -_BEYOND:
            raise NoReferenceError(f"site {n + 1} starts on an event: start off it")
        for k in range(_CHECKS):
            if values[k, n] > 0.0 >= values[k + 1, n]:
                found.append(_located(law, dense, modes, n, low=times[k], high=times[k + 1]))
                break
    return min(found, default=None)


def _located(law: _Law, dense: Any, modes: IntArray, n: int, *, low: float, high: float) -> float:
    def value(t: float) -> float:
        return float(law.distance(dense(t), modes)[n])

    return float(brentq(value, low, high, xtol=1e-15, rtol=9e-16))
