"""Checks of the definitions and ansätze of Eqs. (9)-(25), which hold for every chain.

No symbolic computation is used. Test motions are fixed smooth functions; parameters are random.
"""

from __future__ import annotations

import cmath
import math
import random
from typing import Any

import mpmath as mp
import numpy as np
import sympy as sp

from derivations.algebra.evidence import Point, Points, at_points, equals, fast_average, solved_for
from derivations.algebra.steps import Evidence
from derivations.multiple_scales import symbols as own
from derivations.multiple_scales.motions import first_motion, partials, wave_numbers
from derivations.symbols import (
    R,
    alpha_0,
    epsilon,
    k_1,
    k_2,
    n,
    omega,
    omega_1,
    omega_2,
    t,
    t_hat,
    tau,
    theta,
    y,
)


@equals("a motion multiplied by one complex factor per site")
def ansatz(rng: random.Random) -> Point:
    """Compare the assumed motion with one that is multiplied by a complex factor per site."""
    place, when, w = rng.choice([-3, -1, 2]), rng.uniform(0, 1), rng.uniform(0.5, 1.5)
    wave = wave_numbers(rng)
    step = cmath.exp(complex(wave[k_1], wave[k_2]))
    value = wave[alpha_0] * (cmath.exp(1j * w * when) * step ** abs(place)).imag
    return {**wave, y(n, t): value, n: place, t: when, omega: w}


def frequency(candidate: sp.Basic) -> Evidence:
    """Check the linear frequency at ε = 0, and the coefficients as derivatives in ε."""
    h = 1e-3
    down, middle, up = (
        solved_for(candidate, omega, {epsilon: e, omega_1: 0.7, omega_2: -0.4}).real
        for e in (-h, 0.0, h)
    )
    found = (middle - 1, (up - down) / (2 * h) - 0.7,
             (up - 2 * middle + down) / (2 * h**2) + 0.4)  # fmt: skip
    worst = max(map(abs, found))
    return Evidence(worst < 1e-8, f"1, ω_1 and ω_2 recovered by differences to {worst:.1e}")


@equals("time counted in periods and in units of 1/ε", parts=2)
def times(rng: random.Random) -> Point:
    """Count time in periods and in units of 1/ε."""
    period, scale, when = rng.uniform(4, 8), rng.uniform(5, 20), rng.uniform(0, 3)
    return {t: when, omega: 2 * math.pi / period, epsilon: 1 / scale,
            t_hat: 2 * math.pi * when / period, tau: when / scale}  # fmt: skip


@equals("numerical derivatives of a test motion", parts=2, tolerance=1e-8)
def chain_rule(rng: random.Random) -> Point:
    """Differentiate a test motion numerically."""
    w, e, when = (mp.mpf(rng.uniform(0.3, 1.5)) for _ in range(3))

    def motion(s: Any) -> Any:
        return first_motion(w * s, e * s)

    own_rate = y(0, t).diff(t)
    return {own_rate.diff(t): mp.diff(motion, when, 2), own_rate: mp.diff(motion, when),
            **partials(first_motion, own.Y, w * when, e * when), omega: w,
            epsilon: e}  # fmt: skip


@at_points("the motion of order 1 at ε = 0, and its slope in ε")
def expansion() -> Points:
    """Require at ε = 0 the motion of order 1, and as its slope in ε the motion of order ε."""
    for e in (0.0, 0.3):
        yield {epsilon: e, own.Y_0: 0.7, own.Y_1: -1.2, own.Y: 0.7 - 1.2 * e}, None


def free_solution(candidate: sp.Basic) -> Evidence:
    """Require a real motion of one harmonic whose complex coefficient is A."""
    size = 0.6 - 0.8j
    return _one_harmonic(candidate, own.Y_0, {own.A: size}, size)


def steady_oscillation(candidate: sp.Basic) -> Evidence:
    """Require a real motion of one harmonic of modulus R and argument θ."""
    return _one_harmonic(candidate, own.Y_0, {R: 1.3, theta: 0.4}, 1.3 * cmath.exp(0.4j))


@at_points("a sine of amplitude α_0")
def central_motion() -> Points:
    """Require a sine of amplitude α_0 that starts at zero, in t or in the fast time."""
    for phase in (0.3, 1.7):
        exact = 1.7 * math.sin(phase)
        yield {alpha_0: 1.7, t_hat: phase, omega: 0.8, t: phase / 0.8, k_1: -0.4, k_2: 0.6,
               y(0, t): exact, own.Y: exact}, [0]  # fmt: skip


@equals("modulus and argument")
def polar(rng: random.Random) -> Point:
    """Compare the polar form with cosine and sine."""
    size, angle = rng.uniform(0.3, 2), rng.uniform(-3, 3)
    value = complex(size * math.cos(angle), size * math.sin(angle))
    return {own.R_slow: size, own.theta_slow: angle, own.A: value}


@at_points("the Fourier coefficient of a sine, sampled", parts=2)
def match() -> Points:
    """Compute the first Fourier coefficient of the assumed motion by sampling."""
    found = fast_average(lambda s: 1.7 * np.sin(s), 1)
    yield {alpha_0: 1.7, R: abs(found), theta: cmath.phase(found)}, None


@at_points("the amplitude of a sine, sampled", parts=1)
def doubled() -> Points:
    """Compute the modulus of the first Fourier coefficient of the assumed motion."""
    yield {alpha_0: 1.7, R: abs(fast_average(lambda s: 1.7 * np.sin(s), 1))}, None


def _one_harmonic(
    candidate: sp.Basic, unknown: sp.Expr, given: Point, coefficient: complex
) -> Evidence:
    samples = 2 * np.pi * np.arange(8) / 8
    found = np.array([solved_for(candidate, unknown, {**given, t_hat: s}) for s in samples])
    spectrum = np.fft.fft(found) / 8
    expected = np.zeros(8, complex)
    expected[1], expected[-1] = coefficient, coefficient.conjugate()
    worst = float(abs(spectrum - expected).max())
    return Evidence(worst < 1e-12, f"its Fourier coefficients are as named: off by {worst:.1e}")
