"""A breather by direct integration of (8) or (43): run until nothing changes, then measure.

The run starts from a nucleus near the cycle, with seeded noise, so that the breather found survives
a small perturbation without symmetry. A run that does not settle in time is reported as such.
"""

from __future__ import annotations

import math
import time

import numpy as np

from theory.arrays import ComplexArray, FloatArray
from theory.averaged.breather import BreatherStatus
from theory.averaged.envelope import envelope_rate
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VanDerPolChain, VdpChain, effective_epsilon
from theory.parameters import ParameterError
from verification.breathers.orbits import Orbits
from verification.breathers.periodic_motion import SAMPLES, first_harmonics, largest_displacements
from verification.breathers.result import Breather, BreatherMethod, wave_error_of
from verification.runs.envelope_run import run_envelope
from verification.steppers.variational import integrate_chain

STEPS, ORDER = 20, 18
"""Taylor steps per period where damping is weak, and their order."""
STIFFEST = 6.0
"""Largest ε max|damping| to which the number of steps is adapted."""
NOISE = 1e-6
"""Standard deviation of the noise on the start: every y and ẏ, or both parts of every φ_n."""
LARGEST_EPS = 0.2
"""Largest ε: beyond it the step is too long for the transients."""
SLOW_TIME, TOLERANCE = 1500.0, 1e-8
"""Longest run in T = εt, and the drift per unit T below which the state counts as settled."""
BLOCK = 5.0
"""Slow time between two checks of the state."""


def run_breather(
    chain: VdpChain,
    nucleus: Nucleus,
    *,
    tolerance: float = TOLERANCE,
    seed: int = 0,
) -> Breather:
    """Integrate (8) from a prepared nucleus until the motion is periodic.

    Parameters
    ----------
    chain : VdpChain
        ε at most 0.2.
    nucleus : Nucleus
        Excited sites and their phases at the start.
    tolerance : float, optional
        Drift per unit T below which the state counts as settled.
    seed : int, optional
        Seed of the noise on the start.

    Returns
    -------
    Breather
        The final state: settled, unsettled, escaped or died. Its drift is the largest change of the
        state from one period to the next, divided by ε period.

    Raises
    ------
    ParameterError
        If ε is too large for the step, the cell has no cycle, or the nucleus does not fit.

    Examples
    --------
    >>> run = run_breather(VdpChain(a=2.5, b=0.5, c=0.1, sites=7), Nucleus(1))
    >>> run.status.value, round(run.frequency, 6)
    ('settled', 1.000985)
    """
    started = time.perf_counter()
    if chain.eps > LARGEST_EPS:
        raise ParameterError(
            "small parameter eps", chain.eps, f"at most {LARGEST_EPS:g} for this step", "use orbit"
        )
    sites, outside = chain.sites, nucleus.outside(chain.sites)
    phi = nucleus.envelope(chain)
    state = np.concatenate([phi.imag, phi.real])
    state = state + NOISE * np.random.default_rng(seed).normal(size=2 * sites)
    # A block lasts a few units of slow time and is a whole number of revolutions.
    periods = max(1, round(BLOCK / (2.0 * math.pi * chain.eps)))
    steps = _steps(chain)
    period, elapsed = 2.0 * math.pi, 0.0
    drifts: list[float] = []
    status = BreatherStatus.UNSETTLED
    while status is BreatherStatus.UNSETTLED and elapsed * chain.eps < SLOW_TIME:
        state = integrate_chain(chain, state, periods * period, periods * steps, ORDER).state
        elapsed += periods * period
        amplitude = np.hypot(state[:sites], state[sites:])
        if amplitude[outside].max(initial=0.0) > chain.unstable_amplitude:
            status = BreatherStatus.ESCAPED
            break
        period, drift = _period(chain, state, period, 2 * steps)
        drifts.append(drift)
        if drift < tolerance:
            status = BreatherStatus.SETTLED
    samples = integrate_chain(chain, state, period, max(SAMPLES, 2 * steps)).samples
    return _at_end(
        chain,
        nucleus,
        status,
        drifts,
        waves=first_harmonics(samples),
        amplitudes=largest_displacements(samples),
        frequency=2.0 * math.pi / period,
        elapsed=elapsed,
        started=started,
    )


def run_averaged_breather(chain: VanDerPolChain, nucleus: Nucleus, *, seed: int) -> Breather:
    """Integrate (43) from a prepared nucleus until it rotates rigidly.

    The drift is max |φ_n' - iΩφ_n|, with Ω of the centre; it is computed from the equation and not
    from differences of states, so that it vanishes on a breather whatever the step of the run.

    Parameters
    ----------
    chain : VdpChain or AveragedChain
        The chain: a, b, c, ε and the ends.
    nucleus : Nucleus
        Excited sites and their phases at the start.
    seed : int
        Seed of the noise on the start.

    Returns
    -------
    Breather
        The final state: settled, unsettled, escaped or died. Its time is in t.

    Raises
    ------
    ParameterError
        If the cell has no cycle, or the nucleus does not fit.

    Examples
    --------
    >>> from theory.chains.vdp import AveragedChain
    >>> chain = AveragedChain(a=2.5, b=0.5, c=0.1, sites=7)
    >>> run = run_averaged_breather(chain, Nucleus(1), seed=0)
    >>> run.status.value, round(run.frequency, 6)
    ('settled', 1.001)
    """
    started = time.perf_counter()
    centre, outside = nucleus.centre(chain.sites), nucleus.outside(chain.sites)
    noise = np.random.default_rng(seed).normal(size=(2, chain.sites))
    phi = nucleus.envelope(chain) + NOISE * (noise[0] + 1j * noise[1])
    status, elapsed, drifts, rotation = BreatherStatus.UNSETTLED, 0.0, [], 0.0
    while elapsed < SLOW_TIME and status is BreatherStatus.UNSETTLED:
        run = run_envelope(chain, phi, BLOCK, watched=outside, limit=chain.unstable_amplitude)
        phi, elapsed = run.phi, elapsed + run.time
        rate = envelope_rate(phi, chain)
        rotation = float((rate[centre] / phi[centre]).imag)
        drifts.append(float(np.abs(rate - 1j * rotation * phi).max()))
        if run.escaped:
            status = BreatherStatus.ESCAPED
        elif drifts[-1] < TOLERANCE:
            status = BreatherStatus.SETTLED
    return _at_end(
        chain,
        nucleus,
        status,
        drifts,
        waves=phi,
        amplitudes=np.abs(phi),
        frequency=1.0 + chain.eps * rotation,
        elapsed=elapsed / chain.eps,
        started=started,
    )


def _at_end(
    chain: VanDerPolChain,
    nucleus: Nucleus,
    status: BreatherStatus,
    drifts: list[float],
    *,
    waves: ComplexArray,
    amplitudes: FloatArray,
    frequency: float,
    elapsed: float,
    started: float,
) -> Breather:
    """Return the breather at the end of a run, given the drift at the end of each block.

    Below the unstable cycle every amplitude decreases over a period, so that a run that has settled
    with every site below it has settled at rest.
    """
    settled = status is BreatherStatus.SETTLED
    if settled and amplitudes.max() < chain.unstable_amplitude:
        return Breather(
            chain=chain,
            nucleus=nucleus,
            method=BreatherMethod.SIMULATION,
            status=BreatherStatus.DIED,
            drift=drifts[-1],
            time=elapsed,
            seconds=time.perf_counter() - started,
        )
    error = _remaining_distance(drifts) if settled else math.inf
    known = math.isfinite(error)
    return Breather(
        chain=chain,
        nucleus=nucleus,
        method=BreatherMethod.SIMULATION,
        status=status,
        waves=waves,
        amplitudes=amplitudes,
        frequency=frequency if settled else None,
        error=error if known else None,
        wave_error=wave_error_of(error, waves, nucleus.outward(chain.sites)) if known else None,
        error_unknown="" if known else status.sentence,
        drift=drifts[-1] if drifts else None,
        time=elapsed,
        seconds=time.perf_counter() - started,
    )


def _steps(chain: VdpChain) -> int:
    """Return the Taylor steps per period: more where damping is strong.

    The drift is measured with half the step of the run. The final motion is exactly periodic for
    its own step only, so the truncation errors of the two must differ by less than the tolerance.
    """
    return STEPS + math.ceil(STEPS * min(effective_epsilon(chain), STIFFEST))


def _period(chain: VdpChain, state: FloatArray, guess: float, steps: int) -> tuple[float, float]:
    """Return the time after which the state comes closest to its initial value, and the drift."""
    period, orbits = guess, Orbits(chain, Nucleus(1))
    for _ in range(6):
        after = integrate_chain(chain, state, period, steps, ORDER).state
        rate = orbits.rate(chain.c, after)
        change = float(rate @ (after - state)) / float(rate @ rate)
        period -= change
        if abs(change) < 1e-13:
            break
    after = integrate_chain(chain, state, period, steps, ORDER).state
    return period, float(np.abs(after - state).max()) / (chain.eps * period)


def _remaining_distance(drifts: list[float]) -> float:
    """Return the distance of a run from its limit, for a drift that falls geometrically by block.

    The drift is the change of the state per unit of slow time at the end of each block. The result
    is infinite if there was only one block.
    """
    if len(drifts) < 2:
        return math.inf
    factor = min(drifts[-1] / max(drifts[-2], 1e-300), 0.99)
    return max(BLOCK * drifts[-1] / (1.0 - factor), 1e-12)
