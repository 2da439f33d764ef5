"""Times at which the sites of a chain pass a level, and hence front velocities, by scipy alone."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from scipy.integrate import DOP853, solve_ivp
from scipy.optimize import brentq

from theory.arrays import FloatArray
from theory.chains.vdp import AveragedChain, VdpChain
from verification.references.equations import Rate, full_rate, quarter_turn_rate


def arrivals_of_chain(chain: VdpChain, end: float, level: float, start: float) -> FloatArray:
    """Return when |Ψ| first reaches a level in (8), with the first site displaced.

    scipy's DOP853 integrates pieces of half a period, each of which is searched between its steps.
    """
    rate, sites = full_rate(chain), chain.sites
    x = np.zeros(2 * sites)
    x[0] = start
    arrivals = np.full(sites, np.nan)
    arrivals[0] = 0.0
    begin = 0.0
    while begin < end and np.isnan(arrivals).any():
        run = solve_ivp(
            rate,
            (begin, begin + np.pi),
            x,
            method="DOP853",
            rtol=1e-8,
            atol=1e-9,
            dense_output=True,
        )
        for n in np.flatnonzero(np.isnan(arrivals)):
            high = np.flatnonzero(np.hypot(run.y[n], run.y[n + sites]) >= level)
            if high.size:
                last = max(int(high[0]), 1)
                arrivals[n] = brentq(
                    _above, run.t[last - 1], run.t[last], (run.sol, [n, n + sites], level)
                )
        begin, x = run.t[-1], run.y[:, -1]
    return arrivals


def arrivals_by_scipy(
    rate: Rate,
    start: FloatArray,
    *,
    amplitude: Callable[[FloatArray], FloatArray],
    level: float,
    watched: slice,
    rtol: float,
    atol: float,
    end: float = np.inf,
    each_step: Callable[[float, FloatArray], None] = lambda t, times: None,
) -> FloatArray:
    """Return when the amplitude of each watched site first exceeds a level, by scipy's DOP853.

    Parameters
    ----------
    rate : callable
        Right-hand side for scipy.
    start : ndarray
        State at time zero.
    amplitude : callable
        Maps a state to the amplitudes of the sites.
    level : float
        The level; sites above it at the start are reached at time zero.
    watched : slice
        Sites that are to be reached; nan for those that are not reached by the end.
    rtol, atol : float
        Tolerances.
    end : float, optional
        Latest time.
    each_step : callable, optional
        Called after each step with the time and the arrivals at all sites; may raise.
    """
    solver = DOP853(rate, 0.0, start, end, rtol=rtol, atol=atol)
    times = np.full(amplitude(start).size, np.nan)
    while solver.status == "running" and np.isnan(times[watched]).any():
        with np.errstate(all="ignore"):  # scipy tries steps that overflow
            solver.step()
        for site in np.flatnonzero((amplitude(solver.y) > level) & np.isnan(times)).tolist():
            path = solver.dense_output()

            def above(t: float, path: Any = path, site: int = site) -> float:
                return float(amplitude(path(t))[site] - level)

            first = solver.t_old
            times[site] = first if above(first) >= 0.0 else brentq(above, first, solver.t)
        each_step(solver.t, times)
    return times[watched]


def mean_interval(times: FloatArray) -> float:
    """Return the mean of the intervals with the weights e^{-1/s(1-s)}, 0 < s < 1.

    Examples
    --------
    >>> n = np.arange(60)
    >>> abs(mean_interval(2.0 * n + 0.1 * np.cos(n)) - 2.0) < 1e-5
    True
    """
    intervals = np.diff(times)
    s = np.arange(1, intervals.size + 1) / (intervals.size + 1)
    return float(np.average(intervals, weights=np.exp(-1.0 / (s * (1.0 - s)))))


def velocity_on_few_sites(chain: VdpChain, filled: int = 40) -> float:
    """Return v̂ of a front of (8), measured over the last half of a short chain.

    The chain is integrated by scipy's DOP853, with its first sites on the cycle, each a quarter of
    a turn behind the preceding one. Suitable for strong coupling; at weak coupling it is slow,
    since a run has a length of sites/(ε v̂).

    Raises
    ------
    ArithmeticError
        If the front does not reach the end.
    """
    sites, on_cycle, level = chain.sites, chain.stable_amplitude, chain.unstable_amplitude
    x = np.zeros(2 * sites)
    turn = 0.5 * np.pi * np.arange(filled)
    x[:filled], x[sites : sites + filled] = on_cycle * np.cos(turn), on_cycle * np.sin(turn)
    end = 1.5 * (sites - filled) / (chain.eps * wave_velocity(chain.c, chain.eps))
    run = solve_ivp(
        full_rate(chain), (0.0, end), x, method="DOP853", rtol=1e-7, atol=1e-8, max_step=0.5
    )
    size = np.hypot(run.y[:sites], run.y[sites:])
    watched = np.arange((sites + filled) // 2, sites - 8)
    if np.any(size[watched].max(axis=1) < level):
        raise ArithmeticError(f"the front of (8) at c = {chain.c:g} does not come to its end")
    arrivals = []
    for n in watched:
        first = int(np.argmax(size[n] > level))
        arrivals.append(np.interp(level, size[n, first - 1 : first + 1], run.t[first - 1 :][:2]))
    return float(1.0 / np.polyfit(np.arange(len(arrivals)), arrivals, 1)[0] / chain.eps)


def wave_velocity(c: float, eps: float) -> float:
    """Return the largest group velocity of waves of (8) about rest, per unit of slow time.

    Without damping ω² = 1 + 2εc(1 - cos q), and dω/dq is at most (√(1 + 4εc) - 1)/2.

    Examples
    --------
    >>> round(wave_velocity(100.0, 0.01), 4), round(wave_velocity(1.0, 1e-9), 6)
    (61.8034, 1.0)
    """
    # (√(1 + 4εc) - 1)/(2ε), written without a difference of nearly equal numbers.
    return float(2.0 * c / (np.sqrt(1.0 + 4.0 * eps * c) + 1.0))


def quarter_turn_velocity(a: float, b: float, c: float, sites: int = 60) -> float:
    """Return v̂ of the front of r_n' = (c/2)(r_{n-1} - r_{n+1}) - (r_n/2)(1 - ar²/4 + br⁴/8).

    This is (43) with φ_n = (-i)^n r_n e^{icT}, r real, and the cycle to the left of the first site:
    half the unknowns, no complex numbers, and scipy's stepper. The velocity is that over the second
    half of the sites.

    Raises
    ------
    ArithmeticError
        If the front does not reach the end, or is in the second half before T = 2, the relaxation
        time of the rest state, when its velocity still changes.
    """
    chain = AveragedChain(a=a, b=b, c=c, sites=sites)
    on_cycle, level = chain.stable_amplitude, chain.unstable_amplitude
    free = quarter_turn_rate(chain)

    def rate(t: float, r: FloatArray) -> FloatArray:
        out = free(t, r)
        out[0] += 0.5 * c * on_cycle
        return out

    start = np.where(np.arange(sites) < sites // 4, on_cycle, 0.0)
    end = sites / c
    while True:
        run = solve_ivp(
            rate, (0.0, end), start, method="DOP853", rtol=1e-9, atol=1e-10, dense_output=True
        )
        watched = np.arange(sites // 2, sites - 4)
        # Beside the free end, sites that the front has passed may return below the level.
        if np.all(run.y[watched].max(axis=1) > level):
            break
        end *= 2.0
        if end > 100.0 * sites / c:
            raise ArithmeticError(f"the front of quarter-turn phase step at c = {c:g} does not end")
    if run.t[np.argmax(run.y[watched[0]] > level)] < 2.0:
        raise ArithmeticError(f"the front at c = {c:g} has not settled on {sites} sites: take more")
    return passage_velocity(run, watched, level)


def passage_velocity(run: Any, watched: Iterable[int], level: float) -> float:
    """Return the velocity at which consecutive sites pass a level in a run of scipy."""
    arrivals = []
    for n in watched:
        first = int(np.argmax(run.y[n] > level))
        low, high = run.t[first - 1], run.t[first]
        arrivals.append(brentq(_above, low, high, (run.sol, [n], level)))
    return float(1.0 / np.polyfit(np.arange(len(arrivals)), arrivals, 1)[0])


def _above(time: float, path: Any, places: list[int], level: float) -> float:
    """Return by how much the part of the state at these indices exceeds the level."""
    return float(np.linalg.norm(path(time)[places]) - level)
