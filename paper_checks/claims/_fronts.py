"""What Figs. 12-14 share: their parameters, fronts by scipy alone, and waves about rest."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

A, B, EPS = 4.0, 0.5, 0.01
"""Parameters of Figs. 12 and 13."""

Real = NDArray[np.float64]


def arrivals_of_chain(c: float, sites: int, end: float, level: float, start: float) -> Real:
    """Return when |Ψ| first reaches a level in (8), free ends, the first site displaced.

    scipy's DOP853 in pieces of half a period, each searched between its steps.
    """
    from scipy.integrate import solve_ivp
    from scipy.optimize import brentq

    from theory.chains.vdp import VdpChain
    from verification.references.equations import full_rate

    rate = full_rate(VdpChain(a=A, b=B, c=c, eps=EPS, sites=sites))
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


def _above(time: float, path: Any, places: list[int], level: float) -> float:
    """Return by how much the part of the state at these places is larger than the level."""
    return float(np.linalg.norm(path(time)[places]) - level)


def wave_velocity(c: float, eps: float = EPS) -> float:
    """Return the largest group velocity of waves of (8) about rest, per unit of slow time.

    Without damping ω² = 1 + 2εc(1 - cos q), and dω/dq is at most (√(1 + 4εc) - 1)/2.

    Examples
    --------
    >>> round(wave_velocity(100.0), 4), round(wave_velocity(1.0, 1e-9), 6)
    (61.8034, 1.0)
    """
    # (√(1 + 4εc) - 1)/(2ε), written without a difference of nearly equal numbers.
    return float(2.0 * c / (np.sqrt(1.0 + 4.0 * eps * c) + 1.0))


def velocity_on_few_sites(c: float, sites: int = 160, filled: int = 40) -> float:
    """Return v̂ of a front of (8), timed over the last half of a short chain.

    scipy's DOP853 on a free chain, its first sites on the cycle, each a quarter of a turn behind
    the one before. For strong coupling; a weak one takes long, since a run is sites/(ε v̂) long.

    Raises
    ------
    ArithmeticError
        If the front does not come to the end.
    """
    from scipy.integrate import solve_ivp

    from theory.chains.vdp import VdpChain
    from verification.references.equations import full_rate

    chain = VdpChain(a=A, b=B, c=c, eps=EPS, sites=sites)
    on_cycle, level = chain.stable_amplitude, chain.unstable_amplitude
    x = np.zeros(2 * sites)
    turn = 0.5 * np.pi * np.arange(filled)
    x[:filled], x[sites : sites + filled] = on_cycle * np.cos(turn), on_cycle * np.sin(turn)
    end = 1.5 * (sites - filled) / (EPS * wave_velocity(c))
    run = solve_ivp(
        full_rate(chain), (0.0, end), x, method="DOP853", rtol=1e-7, atol=1e-8, max_step=0.5
    )
    size = np.hypot(run.y[:sites], run.y[sites:])
    watched = np.arange((sites + filled) // 2, sites - 8)
    if np.any(size[watched].max(axis=1) < level):
        raise ArithmeticError(f"the front of (8) at c = {c:g} does not come to its end")
    arrivals = []
    for n in watched:
        first = int(np.argmax(size[n] > level))
        arrivals.append(np.interp(level, size[n, first - 1 : first + 1], run.t[first - 1 :][:2]))
    return float(1.0 / np.polyfit(np.arange(len(arrivals)), arrivals, 1)[0] / EPS)


def staggered_velocity(a: float, b: float, c: float, sites: int = 60) -> float:
    """Return v̂ of the front of r_n' = (c/2)(r_{n-1} - r_{n+1}) - (r_n/2)(1 - ar²/4 + br⁴/8).

    This is (43) on φ_n = (-i)^n r_n e^{icT}, r real, with the cycle before the first site: half of
    the unknowns, no complex number, and scipy's stepper.
    """
    from scipy.integrate import solve_ivp

    from theory.chains.vdp import AveragedChain
    from verification.references.equations import quarter_turn_rate

    chain = AveragedChain(a=a, b=b, c=c, sites=sites)
    on_cycle, level = chain.stable_amplitude, chain.unstable_amplitude
    free = quarter_turn_rate(chain)

    def rate(t: float, r: Real) -> Real:
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
        if np.all(run.y[watched, -1] > level):
            break
        end *= 2.0
        if end > 100.0 * sites / c:
            raise ArithmeticError(f"the staggered front at c = {c:g} does not come to its end")
    return passage_velocity(run, watched, level)


def passage_velocity(run: Any, watched: Iterable[int], level: float) -> float:
    """Return the velocity at which a run of scipy takes consecutive sites above a level."""
    from scipy.optimize import brentq

    arrivals = []
    for n in watched:
        first = int(np.argmax(run.y[n] > level))
        low, high = run.t[first - 1], run.t[first]
        arrivals.append(brentq(_above, low, high, (run.sol, [n], level)))
    return float(1.0 / np.polyfit(np.arange(len(arrivals)), arrivals, 1)[0])


def sum_on_the_line(v: float, c: float, periods: int = 400) -> tuple[complex, float]:
    """Return Σ = -1 + (v/π) ∫₀^∞ dk/(A² + v²k²) by scipy's quadrature, and a bound on its error.

    A = ½ - ic(1 - cos k). One period of A at a time; beyond the last, at K, the rest is 1/(v²K)
    to within max|A|²/(3v⁴K³).
    """
    from scipy.integrate import quad

    def integrand(k: float) -> complex:
        onsite = 0.5 - 1j * c * (1.0 - np.cos(k))
        return complex(1.0 / (onsite**2 + (v * k) ** 2))

    total, error = 0j, 0.0
    for n in range(periods):
        value, off = quad(integrand, 2.0 * np.pi * n, 2.0 * np.pi * (n + 1), complex_func=True,
                          epsabs=1e-13, epsrel=1e-12)  # fmt: skip
        total, error = total + value, error + abs(off)
    end = 2.0 * np.pi * periods
    rest = (0.25 + 4.0 * c**2) / (3.0 * v**4 * end**3)
    return -1.0 + v / np.pi * (total + 1.0 / (v**2 * end)), v / np.pi * (error + rest)
