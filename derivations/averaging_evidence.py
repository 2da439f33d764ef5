"""What Eqs. (31)-(38) are held against: Eq. (8) itself, averaged by equal samples in time."""

from __future__ import annotations

import cmath
import math
import random
from typing import Any

import numpy as np
import sympy as sp
from scipy.optimize import root

from derivations import averaging_symbols as under_test
from derivations.algebra.evidence import Point, equals, fast_average, vanishes_at
from derivations.symbols import a, alpha_0, b, c, epsilon, k_1, k_2, n, omega, t


def _numbers(rng: random.Random) -> dict[str, float]:
    return {"e": rng.uniform(0.05, 0.4), "a": rng.uniform(1, 3), "b": rng.uniform(0.2, 1),
            "c": rng.uniform(0.1, 0.6), "w": rng.uniform(0.8, 1.3)}  # fmt: skip


def _named(p: dict[str, float]) -> dict[Any, Any]:
    return {epsilon: p["e"], a: p["a"], b: p["b"], c: p["c"], omega: p["w"]}


def _complex(rng: random.Random) -> complex:
    return complex(rng.uniform(-1.2, 1.2), rng.uniform(-1.2, 1.2))


def _residual(own: Any, left: Any, right: Any, rate: Any, p: dict[str, float]) -> Any:
    """Eq. (8) for Psi = y' + i omega y at three sites; ``rate`` is dPsi/dt at the middle one."""
    y, velocity = own.imag / p["w"], own.real
    acceleration = rate.real  # the imaginary part of rate is omega y' for a true motion
    tension = p["e"] * p["c"] * (left.imag + right.imag - 2 * own.imag) / p["w"]
    drag = p["e"] * velocity * (1 + y**2 * (p["b"] * y**2 - p["a"]))
    # A rate that is not that of a true motion enters (32) as it stands.
    return acceleration + y - tension + drag + 1j * (rate.imag - p["w"] * velocity)


def _rotating_residual(values: list[complex], rate: complex, p: dict[str, float]) -> Any:
    """(33) as a function of time at frozen phi, phi_{n-1}, phi_{n+1} and phi'."""

    def at(when: Any) -> Any:
        turn = np.exp(1j * p["w"] * when)
        own, left, right = (value * turn for value in values)
        moving = rate * turn + 1j * p["w"] * own
        return _residual(own, left, right, moving, p) / turn

    return at


def direct_average(values: list[complex], rate: complex, p: dict[str, float]) -> complex:
    """Return the mean of (33) over a period 2 pi / omega, by direct sampling."""
    at = _rotating_residual(values, rate, p)
    return fast_average(lambda s: at(s / p["w"]))


def _complexified_point(rng: random.Random) -> Point:
    p = _numbers(rng)
    y, rate, second = (rng.uniform(-1, 1) for _ in range(3))
    return {**_named(p), under_test.y: y, under_test.y_rate: rate, under_test.y_second: second,
            under_test.psi[0]: complex(rate, p["w"] * y),
            under_test.psi_rate: complex(second, p["w"] * rate)}  # fmt: skip


def _complex_chain_point(rng: random.Random) -> tuple[Point, list[complex]]:
    p = _numbers(rng)
    own, left, right, rate = (_complex(rng) for _ in range(4))
    point = {**_named(p), under_test.psi[0]: own, under_test.psi[-1]: left,
             under_test.psi[1]: right, under_test.psi_rate: rate}  # fmt: skip
    return point, [_residual(own, left, right, rate, p)]


def _frozen(rng: random.Random) -> tuple[dict[Any, Any], list[complex], complex, dict[str, float]]:
    p = _numbers(rng)
    own, left, right, rate = (_complex(rng) for _ in range(4))
    point = {**_named(p), under_test.phi[0]: own, under_test.phi[-1]: left,
             under_test.phi[1]: right, under_test.phi_rate: rate}  # fmt: skip
    return point, [own, left, right], rate, p


def _rotating_point(rng: random.Random) -> tuple[Point, list[complex]]:
    point, values, rate, p = _frozen(rng)
    when = rng.uniform(0, 6)
    return {**point, t: when}, [complex(_rotating_residual(values, rate, p)(when))]


def _averaged_point(rng: random.Random) -> tuple[Point, list[complex]]:
    point, values, rate, p = _frozen(rng)
    return point, [direct_average(values, rate, p)]


def _tail_numbers(rng: random.Random) -> tuple[dict[Any, Any], dict[str, float]]:
    p = _numbers(rng)
    p |= {"k1": rng.uniform(-1.2, -0.3), "k2": rng.uniform(-3, 3), "alpha": rng.uniform(1, 3),
          "n": rng.randrange(1, 4)}  # fmt: skip
    return {**_named(p), k_1: p["k1"], k_2: p["k2"], alpha_0: p["alpha"], n: int(p["n"])}, p


def _decaying_point(rng: random.Random) -> tuple[Point, list[complex]]:
    point, p = _tail_numbers(rng)
    values = [p["alpha"] * cmath.exp(complex(p["k1"], p["k2"]) * (p["n"] + o)) for o in (0, -1, 1)]
    return point, [direct_average(values, 0, p) / values[0]]


def damping_mean(size: float, p: dict[str, float]) -> float:
    """Return the damping part of the average at |phi|^2 = size, omega = 1, a unit of eps."""
    unit = {**p, "w": 1.0, "e": 1.0, "c": 0.0}
    return (direct_average([cmath.sqrt(size), 0, 0], 0, unit) / cmath.sqrt(size)).real


def _sites_point(rng: random.Random) -> Point:
    p = _numbers(rng)
    sizes = [rng.uniform(0.2, 1), rng.uniform(1.2, 2), rng.uniform(2.2, 3)]
    point: dict[Any, Any] = {**_named(p)}
    for size, found, symbol in zip(sizes, under_test.h, under_test.s, strict=True):
        point |= {symbol: size, found: damping_mean(size, p)}
    return point


def _separated_point(rng: random.Random, displacement: bool = False) -> Point:
    """Solve the direct average of the decaying motion for cos k_2 and sin k_2.

    alpha_0 is the amplitude of phi, or that of y, which is 1/omega of it.
    """
    point, p = _tail_numbers(rng)
    p["w"] = 1 + p["e"] * p["c"]
    size, shrink = p["alpha"] * math.exp(p["k1"] * p["n"]), math.exp(p["k1"])
    if displacement:
        size *= p["w"]

    def balance(cosine: float, sine: float) -> complex:
        step = complex(cosine, sine)
        values = [complex(size), size / shrink * step.conjugate(), size * shrink * step]
        return direct_average(values, 0, p)

    rest = balance(0, 0)
    columns = [balance(1, 0) - rest, balance(0, 1) - rest]
    matrix = np.array([[q.real for q in columns], [q.imag for q in columns]])
    cosine, sine = np.linalg.solve(matrix, [-rest.real, -rest.imag])
    del point[k_2], point[omega]
    return {**point, sp.sin(k_2): sine, sp.cos(k_2): cosine}


def _limit_point(rng: random.Random) -> Point:
    """At omega = 1 a motion rotating at eps c; solve for the a that makes it steady."""
    point, p = _tail_numbers(rng)
    p["w"] = 1.0
    values = [p["alpha"] * cmath.exp(complex(p["k1"], -math.pi / 2) * (p["n"] + o))
              for o in (0, -1, 1)]  # fmt: skip

    def balance(linear: float) -> complex:
        rate = 1j * p["e"] * p["c"] * values[0]
        return direct_average(values, rate, {**p, "a": linear}) / values[0]

    rest, slope = balance(0), balance(1) - balance(0)
    solved = -(rest / slope)
    if abs(solved.imag) > 1e-9:
        raise ArithmeticError("phase steps of -pi/2 do not balance")
    return {**point, a: solved.real, k_2: -math.pi / 2}


def _amplitude_point(rng: random.Random) -> Point:
    point, p = _tail_numbers(rng)
    place = rng.choice([-2, 1, 3])
    # Two instants a quarter period apart give the amplitude of a sine.
    phase = rng.uniform(0, 3)
    quarter = [p["alpha"] * math.exp(p["k1"]) ** abs(place) * math.sin(phase + shift)
               for shift in (0, math.pi / 2)]  # fmt: skip
    return {**point, n: place, under_test.A_n: math.hypot(*quarter)}


def _staggered(rng: random.Random, centre: bool) -> tuple[Point, None]:
    p = _numbers(rng)
    p["w"] = 1.0
    own, left, right = (rng.uniform(0.2, 1.5) for _ in range(3))
    place = 0 if centre else 2
    left = right if centre else left
    phases = [(-1j) ** abs(place + o) for o in (0, -1, 1)]
    values = [q * phase for q, phase in zip((own, left, right), phases, strict=True)]
    rest = direct_average(values, 1j * p["e"] * p["c"] * values[0], p) / (p["e"] * phases[0])
    if abs(rest.imag) > 1e-9:
        raise ArithmeticError("the staggered amplitudes do not stay real")
    if centre:
        names = {under_test.r0: own, under_test.r1: right, under_test.r0_rate: -rest.real}
    else:
        names = {under_test.r[0]: own, under_test.r[-1]: left, under_test.r[1]: right,
                 under_test.r_rate: -rest.real}  # fmt: skip
    return {**_named(p), **names}, None


def _tail_point(rng: random.Random) -> Point:
    """Return the ratio of neighbours far out on a steady breather, found by Newton's method."""
    spring, linear, quintic, size = rng.uniform(0.08, 0.16), 2.5, 0.5, 16

    def drag(amplitude: float) -> float:
        square = amplitude**2
        return amplitude * (1 - linear * square / 4 + quintic * square**2 / 8) / 2

    def rates(q: Any) -> Any:
        out = np.empty(size)
        out[0] = -spring * q[1] - drag(q[0])
        for site in range(1, size):
            right = q[site + 1] if site + 1 < size else 0.0
            out[site] = spring / 2 * (q[site - 1] - right) - drag(q[site])
        return out

    start = 2.8 * (1.3 * spring) ** np.arange(size)
    found = root(rates, start, tol=1e-14).x
    return {c: spring, k_1: math.log(found[9] / found[8])}


_DIRECT = "Eq. (8) averaged by direct sampling"
complexified = vanishes_at(_complexified_point, "Psi = y' + i omega y", parts=3)
complex_chain = equals(_complex_chain_point, "Eq. (8) at three sites")
rotating = equals(_rotating_point, "Eq. (8) in the rotating frame")
averaged = equals(_averaged_point, _DIRECT)
decaying = equals(_decaying_point, _DIRECT)
two_sites = vanishes_at(_sites_point, "the averaged damping at two amplitudes, sampled")
three_sites = vanishes_at(_sites_point, "the averaged damping at three amplitudes, sampled")
separated = vanishes_at(_separated_point, _DIRECT + ", solved for the two phases", parts=2)
separated_by_displacement = vanishes_at(
    lambda rng: _separated_point(rng, displacement=True),
    _DIRECT + ", with alpha_0 the amplitude of y", parts=2,
)  # fmt: skip
limit = vanishes_at(_limit_point, _DIRECT + ", for phase steps of -pi/2", parts=2)
amplitude = vanishes_at(_amplitude_point, "the amplitude of the sine of (9)")
staggered = equals(lambda rng: _staggered(rng, centre=False), _DIRECT)
staggered_centre = equals(lambda rng: _staggered(rng, centre=True), _DIRECT)
# Site 9 is linear to about r^2 = 1e-14 and the Newton solution is good to 1e-13 of r_0.
tail = vanishes_at(_tail_point, "a steady breather of 16 sites", tolerance=1e-5)
