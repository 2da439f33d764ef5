"""What Eqs. (21)-(30) are held against: the resonant part of (19), averaged by direct sampling."""

from __future__ import annotations

import cmath
import math
import random
from collections.abc import Callable
from typing import Any

import mpmath as mp
import numpy as np
import sympy as sp

from derivations import multiple_scales_symbols as under_test
from derivations.algebra.evidence import (
    Point,
    equals,
    fast_average,
    has_order,
    residual,
    vanishes_at,
)
from derivations.multiple_scales_evidence import named, parameters
from derivations.symbols import (
    R,
    a,
    alpha_0,
    b,
    c,
    delta,
    epsilon,
    k_1,
    omega,
    omega_1,
    theta,
)


def _secular_integral(size: complex, rate: complex, w1: float, p: dict[str, float]) -> complex:
    """Minus the e^{it} Fourier coefficient of the right side of (19), by direct averaging."""

    def right(s: Any) -> Any:
        y = 2 * (size * np.exp(1j * s)).real
        first = 2 * (1j * size * np.exp(1j * s)).real
        mixed = 2 * (1j * rate * np.exp(1j * s)).real
        side = p["alpha"] * math.exp(p["k1"]) * np.sin(s + p["k2"])
        damping = first * (1 + y**2 * (p["b"] * y**2 - p["a"]))
        return 2 * w1 * y - 2 * mixed - 2 * p["c"] * (y - side) - damping

    return -fast_average(right, 1)


def _amplitude_numbers(rng: random.Random) -> tuple[dict[Any, Any], dict[str, float]]:
    p = parameters(rng)
    size, angle, grow, turn, w1 = (rng.uniform(0.3, 1.4) for _ in range(5))
    point = {**named(p), R: size, theta: angle, under_test.R_rate: grow,
             under_test.theta_rate: turn, omega_1: w1}  # fmt: skip
    return point, p


def _secular_point(rng: random.Random) -> tuple[Point, list[complex]]:
    point, p = _amplitude_numbers(rng)
    size = point[R] * cmath.exp(1j * point[theta])
    rate = complex(rng.uniform(-1, 1), rng.uniform(-1, 1))
    point |= {under_test.A: size, under_test.A_rate: rate}
    return point, [_secular_integral(size, rate, point[omega_1], p)]


def _turned(rng: random.Random, steady: bool = False) -> tuple[dict[Any, Any], complex]:
    point, p = _amplitude_numbers(rng)
    size = point[R] * cmath.exp(1j * point[theta])
    grow, turn = point[under_test.R_rate], point[under_test.theta_rate]
    rate = 0 if steady else (grow + 1j * point[R] * turn) * cmath.exp(1j * point[theta])
    found = _secular_integral(size, rate, point[omega_1], p)
    return point, found * cmath.exp(-1j * point[theta])


def _polar_form_point(rng: random.Random) -> Point:
    size, angle = rng.uniform(0.3, 2), rng.uniform(-3, 3)
    return {R: size, theta: angle, under_test.A: complex(size * math.cos(angle),
                                                         size * math.sin(angle))}  # fmt: skip


def _parts(steady: bool) -> Callable[[random.Random], tuple[Point, list[complex]]]:
    def draw(rng: random.Random) -> tuple[Point, list[complex]]:
        point, turned = _turned(rng, steady)
        return point, [turned.imag, turned.real]

    return draw


def _polar_point(rng: random.Random) -> tuple[Point, list[complex]]:
    point, turned = _turned(rng)
    return point, [turned]


_DIRECT = "the Fourier coefficient of (19) by direct averaging"
secular = equals(_secular_point, _DIRECT)
polar = vanishes_at(_polar_form_point, "modulus and argument")
secular_polar = equals(_polar_point, _DIRECT)
secular_parts = equals(_parts(steady=False), _DIRECT)
steady_parts = equals(_parts(steady=True), _DIRECT)


def _balanced(rng: random.Random, phase: float | None = None) -> dict[Any, Any]:
    """Numbers for which the direct average vanishes with alpha_0 = 2 R: the rest is solved for.

    The average is affine in b and in omega_1, so two evaluations a parameter give both.
    """
    p = parameters(rng)
    size, angle = rng.uniform(0.5, 1.2), rng.uniform(-3, 3)
    p["alpha"] = 2 * size
    p["k2"] = angle + (rng.uniform(0.4, 1.2) if phase is None else phase)
    amplitude = size * cmath.exp(1j * angle)

    def average(extra: float, w1: float) -> complex:
        return _secular_integral(amplitude, 0, w1, {**p, "b": extra}) * cmath.exp(-1j * angle)

    rest, by_b, by_w = average(0, 0), average(1, 0), average(0, 1)
    extra, w1 = -rest.imag / (by_b - rest).imag, -rest.real / (by_w - rest).real
    return {**named({**p, "b": extra}), R: size, theta: angle, omega_1: w1, delta: w1 - p["c"]}


def _cost_point(rng: random.Random) -> Point:
    point = _balanced(rng)
    size = 4 * point[c] ** 2 * math.exp(2 * point[k_1])
    damped = -2 * point[R] ** 4 * point[b] + point[R] ** 2 * point[a] - 1
    return {**point, under_test.loss: 1 - damped**2 / size}


def _neglected_error(candidate: sp.Basic, shift: Any) -> Any:
    """Return what (28) leaves at an exact balance with detuning ``shift``."""
    growth, size, linear, spring = mp.mpf("-0.7"), mp.mpf("0.9"), mp.mpf("2.1"), mp.mpf("0.4")
    drive = 2 * spring * mp.exp(growth)
    balance = mp.sqrt(drive**2 - 4 * shift**2)
    extra = (linear * size**2 - 1 - balance) / (2 * size**4)
    point = {k_1: growth, R: size, a: linear, b: extra, c: spring}
    return residual(candidate, point, 40)[0]


def _decay_point(rng: random.Random) -> Point:
    point = _balanced(rng, phase=0.0)
    return {**point, alpha_0: 2 * point[R], sp.exp(k_1): math.exp(point[k_1])}


def _breather_frequency_point(rng: random.Random) -> Point:
    point = _balanced(rng, phase=0.0)
    return {**point, omega: 1 + point[epsilon] * point[omega_1]}


_SOLVED = "amplitudes for which the direct average of (19) vanishes"
modulus = vanishes_at(_balanced, _SOLVED)
close_frequency = vanishes_at(_balanced, _SOLVED)
neglected = has_order(_neglected_error, 2, "what (28) leaves of (26), against delta")
cost = vanishes_at(_cost_point, _SOLVED)
decay = vanishes_at(_decay_point, _SOLVED + " at k_2 = theta")
breather_frequency = vanishes_at(_breather_frequency_point, _SOLVED + " at k_2 = theta")
