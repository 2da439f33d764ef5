"""Work reduction in the search for periodic orbits of (8)."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import least_squares

from theory.arrays import EPS, ComplexArray, FloatArray, IntArray
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from verification.breathers.orbits import STIFFEST, solve_orbit, steps_for
from verification.breathers.result import Breather
from verification.references.equations import damping, pull
from verification.steppers.variational import STEPS, integrate_variations
from verification.work_reduction.comparison import Comparison

_MAX_STEPS = STEPS + math.ceil(STEPS * STIFFEST)
"""The number that `steps_for` gives for the steepest cycle it accepts."""


def harmonics_not_solved_for(eps: float = 0.05, sites: int = 3) -> Comparison:
    """Solve for a state and a period, or for every odd harmonic of every site above rounding."""
    chain = VdpChain(a=2.5, b=0.5, c=0.1, eps=eps, sites=sites)
    orbit = solve_orbit(chain, Nucleus(1))
    assert orbit.error is not None
    samples = integrate_variations(chain, orbit.state, orbit.period, 256).samples[:, :sites]
    spectrum = np.fft.rfft(samples, axis=0) / len(samples)
    highest = int(np.flatnonzero(np.abs(spectrum).max(axis=1) > orbit.error)[-1])
    odd = np.arange(1, highest + 3, 2)
    period, rest = _balanced(chain, odd, 2.0 * spectrum[odd].T, orbit)
    unknowns = 2.0 * sites * odd.size + 1.0
    bound = orbit.error + rest
    return Comparison(2.0 * sites + 1.0, unknowns, float(abs(period - orbit.period)), bound)


def _balanced(
    chain: VdpChain, odd: IntArray, h: ComplexArray, orbit: Breather
) -> tuple[float, float]:
    """Return the period by harmonic balance, y = Re Σ h_j e^{ijωt}, and its own error.

    The initial guess is perturbed by a hundredth, so that the balance is found, not just confirmed.
    """
    count = 8 * odd.size
    waves = np.exp(2j * np.pi * np.outer(odd, np.arange(count)) / count)
    middle = chain.sites // 2
    h = h * np.exp(-1j * np.angle(h[middle, 0]) * odd)

    def parts(unknown: FloatArray) -> tuple[float, ComplexArray]:
        both = unknown[1:].reshape(2, *h.shape)
        return float(unknown[0]), both[0] + 1j * both[1]

    def rest(unknown: FloatArray) -> FloatArray:
        omega, now = parts(unknown)
        y, v = (now @ waves).real, (1j * omega * odd * now @ waves).real
        force = pull(y, chain.ends) * chain.c + v * damping(y, chain.a, chain.b)
        left = (-((omega * odd) ** 2) * now @ waves).real + y + chain.eps * force
        balance = left @ waves.conj().T / count
        return np.concatenate([[now[middle, 0].imag], balance.real.ravel(), balance.imag.ravel()])

    omega = 1.01 * (2.0 * math.pi / orbit.period)
    guess = np.concatenate([[omega], h.real.ravel(), h.imag.ravel()])
    found = least_squares(rest, guess, xtol=1e-15, ftol=1e-15, gtol=1e-15)
    # The residual of the balance, through the inverse of its slope, plus the last harmonic kept.
    missed = np.linalg.lstsq(np.asarray(found.jac), np.asarray(found.fun), rcond=None)[0]
    period = 2.0 * np.pi / found.x[0]
    last = float(np.abs(parts(found.x)[1][:, -1]).max())
    return period, float(period * (np.abs(missed).max() + last + 8.0 * EPS))


def fewer_steps(eta: float = 0.08, sites: int = 11) -> Comparison:
    """Take as many steps as this cycle needs, or as many as suffice for every chain."""
    chain = VdpChain(a=2.5, b=6.25 * eta, c=0.1, sites=sites)
    few = solve_orbit(chain, Nucleus(1))
    whole = solve_orbit(chain, Nucleus(1), steps=_MAX_STEPS)
    assert few.error is not None
    assert whole.error is not None
    changed = max(abs(few.period - whole.period), float(np.abs(few.state - whole.state).max()))
    return Comparison(steps_for(chain), _MAX_STEPS, changed, few.error + whole.error)
