"""What nuclei do when prepared as in section 2.2: in phase, near the cycle, at rest around.

Runs are of the averaged chain (43), in slow time; `sweep_chain` runs (8) itself. A nucleus *holds*
while every site outside it stays below the unstable cycle |φ_us|, and *escapes* when one passes.
A perturbation is seeded noise, the same relative size in both parts of every φ_n.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from theory.parameters import ParameterError, positive
from theory.vdp_chain import VdpChain
from verification.integrators.envelope_run import EnvelopeRun, run_envelope
from verification.integrators.variational import integrate_chain
from verification.nucleus import MARGIN, Nucleus, Place, sites_for

Complex = NDArray[np.complex128]

SETTLING = 300.0
"""Slow time at the starting coupling before a sweep begins."""
CHAIN_STEPS, CHAIN_ORDER = 14, 16
"""Taylor steps a period and order for runs of (8): 1e-8 a period at ε = 0.01."""


@dataclass(frozen=True)
class Preparation:
    """The start of a run.

    Attributes
    ----------
    size : int
        Excited sites, all in phase.
    place : Place
        Middle or edge of the chain.
    perturbation : float
        Standard deviation of the noise added to both parts of every φ_n; 0 for none.
    seed : int
        Seed of the noise.
    """

    size: int
    place: Place = Place.BULK
    perturbation: float = 0.0
    seed: int = 0

    def chain(self, chain: VdpChain, c: float) -> VdpChain:
        """Return the chain with `MARGIN` sites around the nucleus."""
        return replace(chain, sites=sites_for(self.size, MARGIN), c=c)

    def start(self, chain: VdpChain) -> Complex:
        """Return φ_n at T = 0, shape (N,)."""
        nucleus = Nucleus(self.size, "0" * (self.size - 1), self.place)
        phi = nucleus.envelope(chain)
        if self.perturbation > 0.0:
            noise = np.random.default_rng(self.seed).normal(size=(2, chain.sites))
            phi = phi + self.perturbation * (noise[0] + 1j * noise[1])
        return phi

    def outside(self, chain: VdpChain) -> NDArray[np.bool_]:
        """Return which sites are not excited."""
        first = Nucleus(self.size, "0" * (self.size - 1), self.place).first(chain.sites)
        mask = np.ones(chain.sites, dtype=np.bool_)
        mask[first : first + self.size] = False
        return mask


@dataclass(frozen=True)
class EscapeThreshold:
    """Smallest coupling found at which a prepared nucleus escapes.

    Attributes
    ----------
    c : float
        Middle of the last bracket.
    error : float
        Half the bracket, plus how much ``c`` falls when the runs are twice as long.
    duration : float
        Slow time of the longer runs.
    runs : int
        Runs made.
    seconds : float
        Wall-clock time.
    """

    c: float
    error: float
    duration: float
    runs: int
    seconds: float


@dataclass(frozen=True)
class Delay:
    """Couplings of escape in slow sweeps, and the law of delay fitted to them.

    Attributes
    ----------
    rates : tuple of float
        dc/dT, falling.
    escapes : tuple of float
        c at which the nucleus escaped, for each rate.
    c_0 : float
        Extrapolation to rate zero by c_0 + K rate^{2/3} + K' rate through the three slowest.
    error : float
        How far it is from the extrapolation without K' through the two slowest.
    exponent : float
        ln((c₁ - c₂)/(c₂ - c₃))/ln(ratio of rates) of the three slowest: 2/3 at a fold.
    seconds : float
        Wall-clock time.
    """

    rates: tuple[float, ...]
    escapes: tuple[float, ...]
    c_0: float
    error: float
    exponent: float
    seconds: float


def hold(chain: VdpChain, preparation: Preparation, c: float, duration: float) -> EnvelopeRun:
    """Run the averaged chain at a coupling until it escapes or the time is over.

    Examples
    --------
    >>> hold(VdpChain(a=2.5, b=0.5, c=0), Preparation(1), 0.2, 200.0).escaped
    True
    """
    here = preparation.chain(chain, c)
    return run_envelope(
        here,
        preparation.start(here),
        duration,
        watched=preparation.outside(here),
        limit=here.unstable_amplitude,
    )


def phase_steps(run: EnvelopeRun, preparation: Preparation) -> NDArray[np.float64]:
    """Return the phase steps inside the nucleus in units of π, from -1 to 1."""
    core = run.phi[~preparation.outside(VdpChain(1, 0.1, 0, sites=len(run.phi)))]
    return np.asarray(np.angle(core[1:] / core[:-1]) / np.pi, dtype=float)


def escape_threshold(
    chain: VdpChain,
    preparation: Preparation,
    low: float = 0.15,
    high: float = 0.25,
    duration: float = 2000.0,
    tolerance: float = 1e-6,
) -> EscapeThreshold:
    """Bisect for the coupling at which the prepared nucleus escapes within a time.

    Runs near a fold pass it ever more slowly, c - c_fold ~ duration⁻², so the bisection is done
    with ``duration`` and with half of it, and the difference is part of the error.

    Raises
    ------
    ParameterError
        If the nucleus escapes at ``low`` or holds at ``high``.
    """
    started = time.perf_counter()
    runs = 0

    def bisect(length: float) -> float:
        nonlocal runs
        below, above = low, high
        for c, wanted in ((below, False), (above, True)):
            runs += 1
            if hold(chain, preparation, c, length).escaped is not wanted:
                raise ParameterError(
                    "bracket",
                    f"[{low}, {high}]",
                    "such that the nucleus holds at its lower end and escapes at its upper end",
                    "widen it",
                )
        while above - below > tolerance:
            runs += 1
            middle = 0.5 * (below + above)
            if hold(chain, preparation, middle, length).escaped:
                above = middle
            else:
                below = middle
        return 0.5 * (below + above)

    short, c = bisect(0.5 * duration), bisect(duration)
    error = 0.5 * tolerance + abs(short - c)
    return EscapeThreshold(c, error, duration, runs, time.perf_counter() - started)


def sweep_envelope(
    chain: VdpChain,
    preparation: Preparation,
    rate: float,
    start: float = 0.15,
    end: float = 0.3,
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


def sweep_chain(
    chain: VdpChain,
    preparation: Preparation,
    rate: float,
    start: float = 0.18,
    end: float = 0.3,
) -> float | None:
    """Do the same in the chain (8), as the paper does: rate is dc/d(εt), one step of c a period."""
    positive("sweep rate", rate)
    here = preparation.chain(chain, start)
    outside, limit = preparation.outside(here), here.unstable_amplitude
    phi = preparation.start(here)
    state = np.concatenate([phi.imag, phi.real])
    period, c = 2.0 * math.pi, start
    periods = math.ceil(SETTLING / (chain.eps * period))
    flow = integrate_chain(here, state, periods * period, periods * CHAIN_STEPS, CHAIN_ORDER)
    state = flow.state
    while c < end:
        state = integrate_chain(replace(here, c=c), state, period, CHAIN_STEPS, CHAIN_ORDER).state
        amplitude = np.hypot(state[: here.sites], state[here.sites :])
        if float(amplitude[outside].max()) > limit:
            return c
        c += rate * chain.eps * period
    return None


def fit_delay(rates: Sequence[float], escapes: Sequence[float], seconds: float = 0.0) -> Delay:
    """Fit c = c_0 + K rate^{2/3} + K' rate, the delay at a fold, to rates in one ratio.

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
    """
    speed = np.asarray(rates, dtype=float)
    c = np.asarray(escapes, dtype=float)
    # At a fold the delay is K rate^{2/3}; the next term is of first order in the rate.
    terms = np.column_stack([np.ones_like(speed), speed ** (2.0 / 3.0), speed])
    c_0 = float(np.linalg.solve(terms[-3:], c[-3:])[0])
    error = abs(c_0 - float(np.linalg.solve(terms[-2:, :2], c[-2:])[0]))
    ratio = (c[-3] - c[-2]) / (c[-2] - c[-1])
    exponent = math.log(ratio) / math.log(speed[-2] / speed[-1]) if ratio > 0 else math.nan
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
            raise ParameterError("sweep rate", rate, "one at which the nucleus escapes", "go on")
        escapes.append(found)
    return fit_delay(rates, escapes, time.perf_counter() - started)
