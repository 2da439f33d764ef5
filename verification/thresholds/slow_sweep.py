"""Slow growth of the coupling until a prepared nucleus escapes, and the law of the delay.

A nucleus that follows a stable breather to its fold escapes late, by K rate^{2/3}; the coupling at
the fold is then the limit of zero rate. A nucleus that leaves the breather earlier, for instance
because it was perturbed, does not obey this law, and nothing is extrapolated.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from theory.arrays import ComplexArray, FloatArray
from theory.chains.vdp import VanDerPolChain
from theory.parameters import ParameterError, positive
from verification.runs.envelope_run import STEP, run_envelope
from verification.thresholds.escape import LOWEST, escape_range
from verification.thresholds.preparation import NucleusPreparation, hold
from verification.thresholds.result import Definition, Delay, Mechanism, Threshold, ThresholdMethod

START, END = 0.15, 0.6
"""First coupling tried for the start of a sweep, and coupling at which it is stopped."""
LOWER = 0.8
"""Factor by which the starting coupling is lowered until the nucleus holds, and once more."""
RATES = (4e-4, 2e-4, 1e-4, 5e-5, 2.5e-5)
SETTLING = 300.0
"""Slow time spent at the starting coupling before a sweep begins."""
LAW = 0.06
"""Largest deviation of the exponent from 2/3: twice the cube root of the slowest default rate."""


def sweep_envelope(
    chain: VanDerPolChain, preparation: NucleusPreparation, rate: float
) -> float | None:
    """Let c grow at dc/dT = rate from a settled nucleus; return c at escape, or None.

    Raises
    ------
    ParameterError
        If the nucleus escapes at every starting coupling from `LOWEST`.
    """
    positive("sweep rate", rate)
    here, phi = _settled(chain, preparation)
    run = run_envelope(
        here,
        phi,
        (END - here.c) / rate,
        rate=rate,
        watched=preparation.nucleus.outside(here.sites),
        limit=here.unstable_amplitude,
    )
    return run.coupling if run.escaped else None


def _settled(
    chain: VanDerPolChain, preparation: NucleusPreparation
) -> tuple[VanDerPolChain, ComplexArray]:
    """Return φ_n and the chain at a coupling below the first, from `START` downwards, that holds.

    Just above a fold a nucleus may hold for longer than it settles; `LOWER` times this lies below.
    """
    c = START
    while hold(chain, preparation, c, SETTLING).escaped:
        c *= LOWER
        if c < LOWEST:
            raise ParameterError(
                "nucleus", preparation.size, f"one that holds at some c from {LOWEST:g}",
                "take another size, a smaller perturbation, or change a or b",
            )  # fmt: skip
    c *= LOWER
    return preparation.chain(chain, c), hold(chain, preparation, c, SETTLING).phi


def fit_delay(rates: Sequence[float], escapes: Sequence[float], seconds: float) -> Delay:
    """Fit c = c_0 + K rate^{2/3} + K' rate, the delay at a fold, to rates in geometric sequence.

    Nothing is extrapolated if the couplings of escape do not decrease with the rate, or if the
    exponent differs from 2/3 by more than `LAW`: the nucleus then does not escape at a fold.

    Parameters
    ----------
    rates, escapes : sequence of float
        At least three values; the rates decrease by a constant factor.
    seconds : float, optional
        Run time of the sweeps, stored in the result.

    Examples
    --------
    >>> rates = [8e-3, 1e-3, 1.25e-4]
    >>> delay = fit_delay(rates, [0.2 + 0.5 * rate ** (2 / 3) for rate in rates], seconds=1.0)
    >>> round(delay.c_0, 12), round(delay.delay_exponent, 9)
    (0.2, 0.666666667)
    >>> print(fit_delay(rates, [0.2 + 5 * rate for rate in rates], seconds=1.0).c_0)
    None
    """
    speed = np.asarray(rates, dtype=float)
    c = np.asarray(escapes, dtype=float)
    steps = -np.diff(c)
    exponent = c_0 = error = None
    if (steps > 0.0).all():
        exponent = math.log(steps[-2] / steps[-1]) / math.log(speed[-2] / speed[-1])
    if exponent is not None and abs(exponent - 2.0 / 3.0) <= LAW:
        c_0, error = _extrapolated(speed, c)
    return Delay(
        rates=tuple(rates),
        escapes=tuple(escapes),
        c_0=c_0,
        error=error,
        delay_exponent=exponent,
        seconds=seconds,
    )


def _extrapolated(speed: FloatArray, c: FloatArray) -> tuple[float, float]:
    """Return c at zero rate, and its error: the next term of the law, and that of the escapes."""
    # At a fold the delay is K rate^{2/3}; the next term is linear in the rate.
    terms = np.column_stack([np.ones_like(speed), speed ** (2.0 / 3.0), speed])
    weights = np.linalg.inv(terms[-3:])[0]
    c_0 = float(weights @ c[-3:])
    next_term = abs(c_0 - float(np.linalg.solve(terms[-2:, :2], c[-2:])[0]))
    # An escape is noticed at the end of a step, so that each coupling is too large by up to a step.
    # The weights times the rates add up to zero, so that those of either sign make up one half.
    late = weights * speed[-3:] * STEP
    return c_0, next_term + 0.5 * float(np.abs(late).sum())


def measure_delay(chain: VanDerPolChain, preparation: NucleusPreparation) -> Delay:
    """Sweep the averaged chain at several rates and fit the delay.

    Raises
    ------
    ParameterError
        If the nucleus holds at no coupling, or does not escape in a sweep: near η = 1/8 it goes to
        rest where its breather ends.
    """
    started = time.perf_counter()
    escapes = []
    for rate in RATES:
        found = sweep_envelope(chain, preparation, rate)
        if found is None:
            raise ParameterError(
                "nucleus", preparation.size, f"one that escapes as c grows to {END:g}, and does "
                "not go to rest", "take the method envelope, which finds where its breather ends, "
                "or hold",
            )  # fmt: skip
        escapes.append(found)
    return fit_delay(RATES, escapes, time.perf_counter() - started)


def sweep_threshold(chain: VanDerPolChain, preparation: NucleusPreparation) -> Threshold:
    """Find the zero-rate limit of slow sweeps or, if there is none, hold the coupling constant.

    A nucleus that does not escape at a fold has no zero-rate limit that these sweeps could show;
    the threshold is then that of `escape_range`, with the sweeps included in the result.

    Raises
    ------
    ParameterError
        If the nucleus does not escape, or does not hold.
    """
    if preparation.perturbation > 0.0:
        # With noise the nucleus leaves the breather before its fold; a sweep would not show where.
        return escape_range(chain, preparation)
    delay = measure_delay(chain, preparation)
    if delay.c_0 is None or delay.error is None:
        held = escape_range(chain, preparation)
        return replace(held, delay=delay, seconds=held.seconds + delay.seconds)
    return Threshold(
        c_crit=delay.c_0,
        error=delay.error,
        method=ThresholdMethod.SWEEP,
        definition=Definition.EXISTENCE,
        mechanism=Mechanism.SLOW_SWEEP,
        model="averaged",
        nucleus=preparation.nucleus,
        sites=preparation.chain(chain, 0.0).sites,
        delay=delay,
        seconds=delay.seconds,
    )
