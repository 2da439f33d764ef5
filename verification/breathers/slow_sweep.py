"""Slow growth of the coupling until a prepared nucleus escapes, and the law of its delay.

A nucleus that follows a stable breather to its fold escapes late by K rate^{2/3}; the coupling of
the fold is then the limit of rate zero. A nucleus that leaves the breather earlier, for instance
because it was perturbed, obeys no such law, and nothing is extrapolated.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError, positive
from verification.breathers.nucleation import Preparation
from verification.runs.envelope_run import run_envelope

SETTLING = 300.0
"""Slow time at the starting coupling before a sweep begins."""
LAW = 0.06
"""Largest departure of the exponent from 2/3: twice the cube root of the slowest default rate."""


@dataclass(frozen=True)
class Delay:
    """Couplings of escape in slow sweeps, and the law of delay fitted to them.

    Attributes
    ----------
    rates : tuple of float
        dc/dT, falling.
    escapes : tuple of float
        c at which the nucleus escaped, for each rate.
    c_0 : float or None
        Extrapolation to rate zero by c_0 + K rate^{2/3} + K' rate through the three slowest; None
        where the escapes do not follow this law.
    error : float or None
        How far it is from the extrapolation without K' through the two slowest.
    exponent : float
        ln((c₁ - c₂)/(c₂ - c₃))/ln(ratio of rates) of the three slowest: 2/3 at a fold; not a
        number where the escapes do not fall with the rate.
    seconds : float
        Wall-clock time.
    """

    rates: tuple[float, ...]
    escapes: tuple[float, ...]
    c_0: float | None
    error: float | None
    exponent: float
    seconds: float


def sweep_envelope(
    chain: VdpChain,
    preparation: Preparation,
    rate: float,
    start: float = 0.15,
    end: float = 0.6,
) -> float | None:
    """Let c grow at dc/dT = rate from a settled nucleus; return c at escape, or None."""
    positive("sweep rate", rate)
    here = preparation.chain(chain, start)
    watch, limit = preparation.outside(here), here.unstable_amplitude
    settled = run_envelope(here, preparation.start(here), SETTLING, watched=watch, limit=limit)
    if settled.escaped:
        return start
    run = run_envelope(
        here, settled.phi, (end - start) / rate, rate=rate, watched=watch, limit=limit
    )
    return run.coupling if run.escaped else None


def fit_delay(rates: Sequence[float], escapes: Sequence[float], seconds: float = 0.0) -> Delay:
    """Fit c = c_0 + K rate^{2/3} + K' rate, the delay at a fold, to rates in one ratio.

    There is no extrapolation where the escapes do not fall with the rate, or the exponent is
    farther than `LAW` from 2/3: the nucleus then does not escape at a fold it follows.

    Parameters
    ----------
    rates, escapes : sequence of float
        At least three, rates falling by a constant factor.
    seconds : float, optional
        Time the sweeps took, passed on.

    Examples
    --------
    >>> rates = [8e-3, 1e-3, 1.25e-4]
    >>> delay = fit_delay(rates, [0.2 + 0.5 * rate ** (2 / 3) for rate in rates])
    >>> round(delay.c_0, 12), round(delay.exponent, 9)
    (0.2, 0.666666667)
    >>> print(fit_delay(rates, [0.2 + 5 * rate for rate in rates]).c_0)
    None
    """
    speed = np.asarray(rates, dtype=float)
    c = np.asarray(escapes, dtype=float)
    steps = -np.diff(c)
    exponent = math.nan
    if (steps > 0.0).all():
        exponent = math.log(steps[-2] / steps[-1]) / math.log(speed[-2] / speed[-1])
    if not abs(exponent - 2.0 / 3.0) <= LAW:
        return Delay(tuple(rates), tuple(escapes), None, None, exponent, seconds)
    # At a fold the delay is K rate^{2/3}; the next term is of first order in the rate.
    terms = np.column_stack([np.ones_like(speed), speed ** (2.0 / 3.0), speed])
    c_0 = float(np.linalg.solve(terms[-3:], c[-3:])[0])
    error = abs(c_0 - float(np.linalg.solve(terms[-2:, :2], c[-2:])[0]))
    return Delay(tuple(rates), tuple(escapes), c_0, error, exponent, seconds)


def measure_delay(
    chain: VdpChain,
    preparation: Preparation,
    rates: Sequence[float] = (4e-4, 2e-4, 1e-4, 5e-5, 2.5e-5),
    start: float = 0.15,
) -> Delay:
    """Sweep the averaged chain at several rates and fit the delay.

    Raises
    ------
    ParameterError
        If a sweep does not escape.
    """
    started = time.perf_counter()
    escapes = []
    for rate in rates:
        found = sweep_envelope(chain, preparation, rate, start)
        if found is None:
            raise ParameterError(
                "sweep rate", rate, "such that the nucleus escapes", "hold c instead"
            )
        escapes.append(found)
    return fit_delay(rates, escapes, time.perf_counter() - started)
