"""What Eqs. (8)-(20) are held against: forces and numerical derivatives.

Nothing here is symbolic. Test motions are fixed smooth functions; parameters are random.
"""

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
    has_order,
    residual,
    solved_for,
    vanishes_at,
)
from derivations.derivation import Evidence
from derivations.symbols import (
    a,
    alpha_0,
    b,
    c,
    epsilon,
    k_1,
    k_2,
    n,
    omega,
    omega_1,
    omega_2,
    site,
    t,
    t_hat,
    tau,
)


def _chain_force(y: Any, left: Any, right: Any, rate: Any, p: Any) -> Any:
    """Return what (8) says besides y'': springs as tensions, damping factored in y^2."""
    tension = p["e"] * p["c"] * ((right - y) - (y - left))
    return y - tension + p["e"] * rate * (1 + y**2 * (p["b"] * y**2 - p["a"]))


def parameters(rng: random.Random) -> dict[str, float]:
    """Draw numbers for the coefficients and the assumed wave."""
    return {"e": rng.uniform(0.1, 0.5), "a": rng.uniform(1, 3), "b": rng.uniform(0.2, 1),
            "c": rng.uniform(0.1, 0.6), "k1": rng.uniform(-2, -0.3), "k2": rng.uniform(-2, 2),
            "alpha": rng.uniform(0.5, 2)}  # fmt: skip


def named(p: dict[str, Any]) -> dict[Any, Any]:
    """Return the numbers under the symbols of the paper."""
    return {epsilon: p["e"], a: p["a"], b: p["b"], c: p["c"], k_1: p["k1"], k_2: p["k2"],
            alpha_0: p["alpha"]}  # fmt: skip


def _chain_point(rng: random.Random) -> tuple[Point, list[complex]]:
    p = parameters(rng)
    y, left, right, rate, second = (rng.uniform(-1, 1) for _ in range(5))
    point = {**named(p), site(): y, site(-1): left, site(1): right, site().diff(t): rate,
             site().diff(t, 2): second}  # fmt: skip
    return point, [second + _chain_force(y, left, right, rate, p)]


def _central_point(rng: random.Random) -> tuple[Point, list[complex]]:
    p = parameters(rng)
    y, side, rate, second, when, w = (rng.uniform(0.2, 1) for _ in range(6))
    own = site(0, index="")
    point = {**named(p), own: y, site(1, index=""): side, own.diff(t): rate,
             own.diff(t, 2): second, t: when, omega: w}  # fmt: skip
    return point, [second + _chain_force(y, side, side, rate, p)]


def _forced_point(rng: random.Random) -> tuple[Point, list[complex]]:
    point, _ = _central_point(rng)
    numbers = {str(key): given for key, given in point.items()}
    p = {"e": point[epsilon], "a": point[a], "b": point[b], "c": point[c]}
    phase = numbers["omega"] * numbers["t"] + numbers["k_2"]
    side = (numbers["alpha_0"] * cmath.exp(numbers["k_1"] + 1j * phase)).imag
    own = site(0, index="")
    y, rate = point[own], point[own.diff(t)]
    return point, [point[own.diff(t, 2)] + _chain_force(y, side, side, rate, p)]


def _ansatz_point(rng: random.Random) -> Point:
    place, when, w = rng.choice([-3, -1, 2]), rng.uniform(0, 1), rng.uniform(0.5, 1.5)
    p = parameters(rng)
    y = (cmath.exp(1j * w * when) * cmath.exp(p["k1"] + 1j * p["k2"]) ** abs(place)).imag
    return {**named(p), n: place, t: when, omega: w, site(): p["alpha"] * y}


chain = equals(_chain_point, "the forces of springs and damper")
ansatz = vanishes_at(_ansatz_point, "a motion that is multiplied by one complex factor a site")
symmetric = equals(_central_point, "Eq. (8) with equal neighbours")
forced = equals(_forced_point, "Eq. (8) with the assumed neighbours")


def _test_motion(p: Any, q: Any) -> Any:
    return mp.sin(1.1 * p + 0.3) * mp.exp(-0.7 * q) + 0.4 * mp.cos(2 * p) * (1 + q**2)


def _second_motion(p: Any, q: Any) -> Any:
    return mp.cos(0.9 * p + 0.2) * (1 + 0.5 * q) + 0.3 * mp.sin(3 * p - q)


def _partials(function: Callable[[Any, Any], Any], symbol: sp.Expr, p: Any, q: Any) -> Point:
    point: dict[Any, Any] = {symbol: function(p, q)}
    for first, second in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2)):
        variables = [t_hat] * first + [tau] * second
        found = mp.diff(function, (p, q), (first, second))
        point[symbol.diff(*variables)] = found
    return point


def _times_point(rng: random.Random) -> Point:
    period, scale, when = rng.uniform(4, 8), rng.uniform(5, 20), rng.uniform(0, 3)
    return {t: when, omega: 2 * math.pi / period, epsilon: 1 / scale,
            t_hat: 2 * math.pi * when / period, tau: when / scale}  # fmt: skip


def _chain_rule_point(rng: random.Random) -> Point:
    w, e, when = (mp.mpf(rng.uniform(0.3, 1.5)) for _ in range(3))
    own = site(0, index="")

    def motion(s: Any) -> Any:
        return _test_motion(w * s, e * s)

    return {own.diff(t): mp.diff(motion, when), own.diff(t, 2): mp.diff(motion, when, 2),
            **_partials(_test_motion, under_test.Y, w * when, e * when), omega: w,
            epsilon: e}  # fmt: skip


times = vanishes_at(_times_point, "time counted in periods and in units of 1/eps", parts=2)
chain_rule = vanishes_at(_chain_rule_point, "numerical derivatives of a test motion", parts=2,
                         tolerance=1e-8)  # fmt: skip

_W1, _W2 = mp.mpf("0.37"), mp.mpf("-0.23")
_FIXED = {"a": mp.mpf("1.9"), "b": mp.mpf("0.6"), "c": mp.mpf("0.45"), "k1": mp.mpf("-0.8"),
          "k2": mp.mpf("0.9"), "alpha": mp.mpf("1.3")}  # fmt: skip
_AT = (mp.mpf("0.8"), mp.mpf("0.35"))


def _exact_residual(motion: Callable[[Any, Any, Any], Any], e: Any) -> Any:
    """Eq. (11) for y = motion(omega s, eps s, eps), differentiated numerically along s."""
    w = 1 + e * _W1 + e**2 * _W2
    p, q = _AT

    def path(s: Any) -> Any:
        return motion(p + w * s, q + e * s, e)

    y, rate, second = path(mp.mpf(0)), mp.diff(path, 0), mp.diff(path, 0, 2)
    side = _FIXED["alpha"] * mp.exp(_FIXED["k1"]) * mp.sin(p + _FIXED["k2"])
    return second + _chain_force(y, side, side, rate, {**_FIXED, "e": e})


def _fixed_point(e: Any) -> dict[Any, Any]:
    w = 1 + e * _W1 + e**2 * _W2
    return {**named({**_FIXED, "e": e}), omega: w, omega_1: _W1, omega_2: _W2, t_hat: _AT[0],
            tau: _AT[1]}  # fmt: skip


def _two_times_error(candidate: sp.Basic, e: Any) -> Any:
    point = {**_fixed_point(e), **_partials(_test_motion, under_test.Y, *_AT)}
    found, _ = residual(candidate, point, 40)
    return found - _exact_residual(lambda p, q, _: _test_motion(p, q), e)


def _expanded_motion(p: Any, q: Any, e: Any) -> Any:
    return _test_motion(p, q) + e * _second_motion(p, q)


def _order_point(e: Any) -> dict[Any, Any]:
    return {**_fixed_point(e), **_partials(_test_motion, under_test.Y0, *_AT),
            **_partials(_second_motion, under_test.Y1, *_AT)}  # fmt: skip


def _order_zero_error(candidate: sp.Basic, e: Any) -> Any:
    return residual(candidate, _order_point(e), 40)[0] - _exact_residual(_expanded_motion, e)


def _order_one_error(candidate: sp.Basic, e: Any) -> Any:
    rest = _exact_residual(_expanded_motion, e) - _exact_residual(_expanded_motion, mp.mpf(0))
    return e * residual(candidate, _order_point(e), 40)[0] - rest


two_times = has_order(_two_times_error, 2, "difference from (11) for a test motion")
order_zero = has_order(_order_zero_error, 1, "difference from (11) for a test motion")
order_one = has_order(_order_one_error, 2, "difference from the change of (11) with eps")


def frequency(candidate: sp.Basic) -> Evidence:
    """Check the linear frequency at eps = 0, and the coefficients as derivatives in eps."""
    h = 1e-3
    down, middle, up = (
        solved_for(candidate, omega, {epsilon: e, omega_1: 0.7, omega_2: -0.4}).real
        for e in (-h, 0.0, h)
    )
    found = (middle - 1, (up - down) / (2 * h) - 0.7, (up - 2 * middle + down) / (2 * h**2) + 0.4)
    worst = max(map(abs, found))
    return Evidence(worst < 1e-8, f"1, omega_1, omega_2 recovered by differences to {worst:.1e}")


def expansion(candidate: sp.Basic) -> Evidence:
    """At eps = 0 the motion of order 1; its slope in eps the motion of order eps."""
    worst = 0.0
    for e in (0.0, 0.3):
        base = {epsilon: e, under_test.Y0: 0.7, under_test.Y1: -1.2, under_test.Y: 0.7 - 1.2 * e}
        worst = max(worst, abs(residual(candidate, base)[0]))
    return Evidence(worst < 1e-12, f"value and slope in eps recovered to {worst:.1e}")


def free_solution(candidate: sp.Basic) -> Evidence:
    """Real, 2 pi periodic with one harmonic, whose complex coefficient is A."""
    size = 0.6 - 0.8j
    found = np.array([
        solved_for(candidate, under_test.Y0, {t_hat: s, under_test.A: size})
        for s in 2 * np.pi * np.arange(8) / 8
    ])  # fmt: skip
    spectrum = np.fft.fft(found) / 8
    expected = np.zeros(8, complex)
    expected[1], expected[-1] = size, size.conjugate()
    worst = float(abs(spectrum - expected).max())
    return Evidence(worst < 1e-12, f"its Fourier coefficients are A and A*: off by {worst:.1e}")
