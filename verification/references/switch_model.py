"""The friction chain as integrated in the paper: switch model, stick band, trapezoidal rule.

The switch model of Leine et al. replaces |v_rel| = 0 by |v_rel| < band and has three right-hand
sides:

    slip         |v_rel| > band             v̇ = F(v_rel) - (2ξv + y + c(…))
    transition   within, |static| > μ_st    v̇ = ±μ_st - (2ξv + y + c(…))
    stick        within, else               ẏ = v_d, v̇ = -v_rel

They are integrated by the trapezoidal rule (MATLAB's ode23t, "without numerical damping"), with
fixed steps or with steps chosen from an error estimate; the jumps of the right-hand side are not
located. The resulting error is not controlled; it is reported relative to the event-exact runs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from time import perf_counter
from typing import NamedTuple

import numpy as np

from theory.arrays import FloatArray, IntArray
from theory.cells.friction_law import FrictionLaw
from theory.chains.ends import Ends
from theory.chains.friction import FrictionChain
from theory.parameters import ParameterError, positive, within
from verification.execution.compiled import inner, outer

PAPER_BAND = 1e-4
_ITERATIONS = 50
_CONVERGED = 1e-13
_SHORTEST = 1e-12


@dataclass(frozen=True)
class SwitchRun:
    """The result of a run of the switch model.

    Attributes
    ----------
    times : ndarray, shape (M,)
        τ of the samples.
    y, velocity : ndarray, shape (M, N)
        State at those times, by cubic interpolation within a step.
    arrivals : ndarray, shape (N,)
        End of the first step that ended in the stick mode; nan if there was none.
    steps, rejected, unconverged : int
        Steps accepted, steps rejected, and steps whose implicit equation did not converge.
    reached : float
        τ reached; below the end if the steps became too short or the state overflowed.
    seconds : float
        Run time.
    """

    times: FloatArray
    y: FloatArray
    velocity: FloatArray
    arrivals: FloatArray
    steps: int
    rejected: int
    unconverged: int
    reached: float
    seconds: float

    @property
    def period(self) -> float:
        """Mean time between maxima of y of the first site, over the second half of the run."""
        v = self.velocity[:, 0]
        k = np.flatnonzero((v[:-1] > 0.0) & (v[1:] <= 0.0))
        turns = self.times[k] + v[k] / (v[k] - v[k + 1]) * (self.times[1] - self.times[0])
        half = turns.size // 2
        return float((turns[-1] - turns[half]) / (turns.size - 1 - half))


def run_switch(
    chain: FrictionChain,
    start: FloatArray,
    t_end: float,
    *,
    step: float | None = None,
    relative: float = 1e-3,
    absolute: float = 1e-6,
    band: float = PAPER_BAND,
    samples: int = 201,
) -> SwitchRun:
    """Run the switch model from τ = 0 to ``t_end``.

    Parameters
    ----------
    chain : FrictionChain
        Parameters of (5).
    start : ndarray, shape (2, N)
        y and ẏ.
    t_end : float
        τ, positive.
    step : float, optional
        Fixed step, at most 1/(√(1 + 4c) + 2ξ); by default the step is chosen by the tolerances.
    relative, absolute : float
        Tolerances of the adaptive step control; by default those of MATLAB, as the paper names
        none.
    band : float
        Half-width of the stick band in v_rel, positive.
    samples : int
        Number of states sampled, evenly spaced.

    Raises
    ------
    ParameterError
        If a parameter is out of range.

    Examples
    --------
    >>> chain = FrictionChain(c=0.02, sites=3)
    >>> run = run_switch(chain, np.array([[2.0, 0.5, 0.5], [0.0, 0.0, 0.0]]), 20.0, step=0.01)
    >>> run.steps, bool(run.arrivals[0] < 5)
    (2000, True)
    """
    begin = perf_counter()
    positive("end time tau", t_end)
    positive("stick band", band, "give a positive width of the band")
    within("relative tolerance", relative, 1e-13, 1e-1)
    positive("absolute tolerance", absolute)
    within("number of samples", samples, 2, 1_000_000)
    cell = chain.cell
    if cell.law is not FrictionLaw.EXPONENTIAL or cell.viscous != 0.0:
        raise ParameterError(
            "friction law", f"{cell.law} with a viscous part of {cell.viscous:g}",
            "exponential without a viscous part", "take the law of the paper, (2)",
        )  # fmt: skip
    # The implicit equation is solved by iteration, each of which multiplies the error by half a
    # step times the fastest rate of the chain; if this is a half or less, fifty iterations suffice.
    longest = min(t_end, 1.0 / (math.sqrt(1.0 + 4.0 * chain.c) + 2.0 * cell.xi))
    if step is not None and not 0.0 < step <= longest:
        raise ParameterError(
            "step", step, f"positive, at most {longest:.3g}", "give a smaller step"
        )
    law = np.array([cell.mu_st, cell.mu_d, cell.v0, cell.xi, cell.v_d, chain.c, band])
    fixed = 0.0 if step is None else t_end / math.ceil(t_end / step - 1e-9)
    rule = _Rule(law, chain.ends is Ends.FREE, t_end, fixed, relative, absolute)
    kept = np.zeros((samples, 2, chain.sites))
    counters = np.zeros(4, dtype=np.int64)
    arrivals = np.full(chain.sites, np.nan)
    record = _Record(np.linspace(0.0, t_end, samples), kept, arrivals, counters)
    reached = _trapezoid(rule, np.array(start, dtype=float), record)
    return SwitchRun(
        record.times, kept[:, 0], kept[:, 1], arrivals, int(counters[0]), int(counters[1]),
        int(counters[2]), float(reached), perf_counter() - begin,
    )  # fmt: skip


class _Rule(NamedTuple):
    """Parameters; whether ends are free; the end; the fixed step, 0 for adaptive; tolerances."""

    law: FloatArray
    free: bool
    t_end: float
    fixed: float
    relative: float
    absolute: float


class _Record(NamedTuple):
    """Times and states of samples; arrivals; counts of steps, rejected, unconverged, samples."""

    times: FloatArray
    states: FloatArray
    arrivals: FloatArray
    counters: IntArray


@inner()
def _right_side(
    z: FloatArray, parameters: FloatArray, free: bool, out: FloatArray, sticks: IntArray
) -> None:
    """Put the derivative of z, shape (2, N), into out, and record which sites are in stick."""
    mu_st, mu_d, v0, xi, v_d, c, band = parameters
    last = z.shape[1] - 1
    for n in range(last + 1):
        y, v = z[0, n], z[1, n]
        bend = 0.0
        if n > 0:
            bend += y - z[0, n - 1]
        elif not free:
            bend += y
        if n < last:
            bend += y - z[0, n + 1]
        elif not free:
            bend += y
        load = 2.0 * xi * v + y + c * bend
        slip = v - v_d
        sticks[n] = 0
        out[0, n] = v
        if abs(slip) > band:
            friction = mu_d + (mu_st - mu_d) * math.exp(-abs(slip) / v0)
            out[1, n] = (-friction if slip > 0.0 else friction) - load
        elif abs(load) > mu_st:
            out[1, n] = (mu_st if load > 0.0 else -mu_st) - load
        else:
            out[0, n] = v_d
            out[1, n] = -slip
            sticks[n] = 1


Pair = tuple[FloatArray, FloatArray]
"""States or their derivatives at the beginning and the end of a step, each of shape (2, N)."""


@inner()
def _solve_step(
    rule: _Rule, z: FloatArray, now: FloatArray, h: float, sticks: IntArray
) -> tuple[FloatArray, FloatArray, float]:
    """Return the state after h, its derivative, and the last change in the iteration."""
    following, later = np.empty(z.shape), np.zeros(z.shape)
    for i in range(2):  # whole arrays would take longer to compile than all of this module
        for n in range(z.shape[1]):
            following[i, n] = z[i, n] + h * now[i, n]
    change = math.inf
    for _ in range(_ITERATIONS):
        _right_side(following, rule.law, rule.free, later, sticks)
        change = 0.0
        for i in range(2):
            for n in range(z.shape[1]):
                value = z[i, n] + 0.5 * h * (now[i, n] + later[i, n])
                change = max(change, abs(value - following[i, n]))
                following[i, n] = value
        if not change > _CONVERGED:
            break
    _right_side(following, rule.law, rule.free, later, sticks)
    return following, later, change


@inner()
def _error_of_step(
    rule: _Rule, states: Pair, before: FloatArray, slopes: Pair, lengths: tuple[float, float]
) -> float:
    """Return h³/12 times the third derivative, relative to the tolerance.

    ``before`` is the derivative at the beginning of the preceding step; ``lengths`` are those of
    that step (0 if there is none) and of this one.
    """
    past, h = lengths
    worst = 0.0
    for i in range(2):
        for n in range(before.shape[1]):
            third = (slopes[1][i, n] - slopes[0][i, n]) / h
            if past > 0.0:
                third = 2.0 * (third - (slopes[0][i, n] - before[i, n]) / past) / (h + past)
            size = rule.absolute + rule.relative * max(abs(states[0][i, n]), abs(states[1][i, n]))
            worst = max(worst, abs(third) * h**3 / 12.0 / size)
    return worst


@inner()
def _take_samples(
    record: _Record, states: Pair, slopes: Pair, step: tuple[float, float], last: bool
) -> None:
    """Take the samples within the step (t, h), at the last step all that remain, by cubics."""
    times, counters = record.times, record.counters
    t, h = step
    while counters[3] < times.size and (times[counters[3]] <= t + h or last):
        s = min(1.0, (times[counters[3]] - t) / h)
        a, b = (1.0 + 2.0 * s) * (1.0 - s) ** 2, s * (1.0 - s) ** 2
        for i in range(2):
            for n in range(states[0].shape[1]):
                record.states[counters[3], i, n] = (
                    a * states[0][i, n]
                    + b * h * slopes[0][i, n]
                    + (1.0 - a) * states[1][i, n]
                    + s * s * (s - 1.0) * h * slopes[1][i, n]
                )
        counters[3] += 1


@inner()
def _note_arrivals(arrivals: FloatArray, sticks: IntArray, t: float) -> None:
    for n in range(sticks.size):
        if sticks[n] == 1 and math.isnan(arrivals[n]):
            arrivals[n] = t


@outer(cache=True)
def _trapezoid(rule: _Rule, z: FloatArray, record: _Record) -> float:
    """Integrate from the state z; return the time reached."""
    sticks = np.zeros(z.shape[1], dtype=np.int64)
    now, before = np.zeros(z.shape), np.zeros(z.shape)
    _right_side(z, rule.law, rule.free, now, sticks)
    _note_arrivals(record.arrivals, sticks, 0.0)
    t, past, fixed = 0.0, 0.0, rule.fixed
    h = fixed if fixed > 0.0 else 1e-4
    while t < rule.t_end:
        h = min(h, rule.t_end - t) if fixed == 0.0 else fixed
        if h < _SHORTEST and rule.t_end - t > _SHORTEST:
            return t
        following, later, change = _solve_step(rule, z, now, h, sticks)
        if not math.isfinite(change):
            return t
        record.counters[2] += change > _CONVERGED
        factor = 1.0
        if fixed == 0.0:
            worst = _error_of_step(rule, (z, following), before, (now, later), (past, h))
            factor = 0.9 * worst ** (-1.0 / 3.0) if worst > 0.0 else 5.0
            factor = min(5.0, max(0.2, factor))
            if worst > 1.0:
                record.counters[1] += 1
                h *= min(factor, 0.9)
                continue
        # Fixed steps add up to the end except for round-off.
        last = t + h >= rule.t_end - 0.5 * fixed
        _take_samples(record, (z, following), (now, later), (t, h), last)
        t = rule.t_end if last else t + h
        record.counters[0] += 1
        _note_arrivals(record.arrivals, sticks, t)
        z, before, now = following, now, later
        past = h
        h = fixed if fixed > 0.0 else h * factor
    return t
