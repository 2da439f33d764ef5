"""What Eqs. (43)-(54) are held against: direct averages, the time-domain front, found roots."""

from __future__ import annotations

import cmath
import math
import random
from functools import lru_cache
from typing import Any

import mpmath as mp
import numpy as np
import sympy as sp
from scipy.optimize import brentq

from derivations import front_numbers as numbers
from derivations import front_symbols as s
from derivations.algebra.evidence import Point, equals, parts_of, solved_for, value, vanishes_at
from derivations.averaging_evidence import direct_average
from derivations.averaging_symbols import phi as site_phi
from derivations.averaging_symbols import phi_rate as site_rate
from derivations.derivation import Evidence

_SCENES = ((0.5, 0.5), (1.3, 0.4), (0.7, 0.9))
"""Pairs of velocity and coupling, slow to fast, where the time-domain profile is quick."""


def _complex(rng: random.Random, size: float = 1.0) -> complex:
    return size * complex(rng.uniform(-1, 1), rng.uniform(-1, 1))


def _cell(rng: random.Random) -> dict[str, float]:
    return {"e": rng.uniform(0.05, 0.3), "a": rng.uniform(2.5, 4), "b": rng.uniform(0.3, 0.7),
            "c": rng.uniform(0.1, 0.8), "w": 1.0}  # fmt: skip


def _sites(values: list[complex], rate: complex, p: dict[str, float]) -> dict[Any, Any]:
    return {site_phi[0]: values[0], site_phi[-1]: values[1],
            site_phi[1]: values[2], site_rate: rate, s.epsilon: p["e"],
            s.a: p["a"], s.b: p["b"], s.c: p["c"]}  # fmt: skip


def _rotating(values: list[complex], rate: complex, p: dict[str, float]) -> complex:
    return direct_average(values, rate, p)


def _averaged_point(rng: random.Random) -> tuple[Point, list[complex]]:
    p, rate = _cell(rng), _complex(rng)
    values = [_complex(rng, 1.5) for _ in range(3)]
    return _sites(values, rate, p), [_rotating(values, rate, p)]


def _two_lines_point(rng: random.Random) -> tuple[Point, list[complex]]:
    """Linearise the direct average at rest; beyond the threshold, the same about phi_s."""
    p, rate = _cell(rng), _complex(rng)
    cycle = 3 * cmath.exp(1j * rng.uniform(0, 6))
    excited = rng.random() < 0.5
    shift = cycle if excited else 0
    own = (2.1 if excited else 1.9) * cmath.exp(1j * rng.uniform(0, 6))
    values = [own, _complex(rng), _complex(rng)]
    tiny = 1e-5  # cubic terms are 1e-9 of the linear ones
    linear = _rotating([tiny * (q - shift) for q in values], tiny * rate, p) / tiny
    point = _sites(values, rate, p)
    return {**point, s.phi_s: cycle, s.phi_us: 2 * cmath.exp(1j)}, [linear]


def _force_point(rng: random.Random) -> Point:
    p, target = _cell(rng), _complex(rng, 4)
    size = rng.choice([0.6, 1.6])
    own = size * cmath.exp(1j * rng.uniform(0, 6))
    force = -p["e"] / 2 * (own - target if size > 1 else own)
    return {s.epsilon: p["e"], site_phi[0]: own, s.phi_s: target,
            s.phi_us: 1j, s.F: force}  # fmt: skip


def _wave(z: Any) -> Any:
    return mp.tanh(1 - z) * mp.exp(0.4j * z) + 0.3 * mp.sin(z)


def _moving_point(rng: random.Random) -> Point:
    place, when, fast = rng.randrange(-3, 4), rng.uniform(0, 2), rng.uniform(0.3, 1)

    def seen_at(site: int) -> complex:
        return complex(_wave(site - fast * when))

    here = place - fast * when
    point: dict[Any, Any] = {s.n: place, s.t: when, s.speed: fast, s.zeta: here}
    for offset in (-1, 0, 1):
        point[site_phi[offset]] = seen_at(place + offset)
        point[s.phi(s.zeta + offset)] = complex(_wave(here + offset))
    return point


def _front_point(rng: random.Random) -> tuple[Point, list[complex]]:
    """(44) over eps for a travelling test wave, on the branch that the sign of zeta selects."""
    p, fast, target = _cell(rng), rng.uniform(0.3, 1), _complex(rng)
    here = rng.choice([-0.7, 0.6])
    values = [complex(_wave(here + offset)) for offset in (0, -1, 1)]
    rate = complex(mp.diff(lambda when: _wave(here - p["e"] * fast * when), 0))
    pull = values[0] - (target if here < 0 else 0)
    springs = 1j * p["e"] * p["c"] / 2 * (2 * values[0] - values[1] - values[2])
    point: dict[Any, Any] = {s.v: fast, s.c: p["c"], s.phi_s: target, s.zeta: here}
    point[s.phi(s.zeta).diff(s.zeta)] = complex(mp.diff(_wave, here))
    for offset, found in zip((0, -1, 1), values, strict=True):
        point[s.phi(s.zeta + offset)] = found
    return point, [(rate - springs + p["e"] / 2 * pull) / p["e"]]


@lru_cache(maxsize=1)
def figure_16() -> tuple[float, float, float]:
    """Velocity, coupling and ratio of the cycles in Fig. 16, from the time-domain profile."""
    squares = np.roots([0.5 / 8, -4 / 4, 1.0]).real
    r, spring = math.sqrt(squares.min() / squares.max()), 0.5
    fast = brentq(lambda q: abs(numbers.kinetic_sum(q, spring)) - 2 * r, 0.3, 2.0, xtol=1e-10)
    return float(fast), spring, r


def admissible(candidate: sp.Basic) -> Evidence:
    """Check that the two sides agree at each of a row of places of the front of Fig. 16."""
    fast, spring, r = figure_16()
    places = [-4.3, -2.0, -1.2, -0.5, -0.1, 0.1, 0.5, 1.2, 2.0, 4.3]
    for place in places:
        own = abs(numbers.profile(place, fast, spring))
        found = candidate.xreplace({
            s.phi(s.zeta): sp.Float(own), s.phi_us: sp.Float(r), s.zeta: sp.Float(place),
        })  # fmt: skip
        if found != sp.true:
            return Evidence(False, f"not so at zeta = {place}: |phi/phi_s| = {own:.4f}")
    return Evidence(True, f"so at {len(places)} places of the front with v_hat = {fast:.6f}")


def profile(candidate: sp.Basic) -> Evidence:
    """Against the front built in the time domain, at both signs of zeta."""
    (_, right), worst = candidate.args, 0.0
    target = 0.8 - 0.4j
    for place, (fast, spring) in zip((-1.5, -0.4, 0.3, 1.5), (*_SCENES, (0.5, 0.5)), strict=True):
        exact = target * numbers.profile(place, fast, spring)
        point: dict[Any, Any] = {s.v: fast, s.c: spring, s.phi_s: target}
        branch = right.xreplace({s.zeta: sp.Float(place)})
        series = sp.sympify(numbers.evaluated(branch, {**point, s.zeta: place}))
        stated = candidate.xreplace({right: series})
        worst = max(worst, abs(solved_for(stated, s.phi(s.zeta), {s.zeta: place}) - exact))
    # Extrapolated series of 8000 roots: good to about 1e-10.
    return Evidence(worst < 1e-7, f"the front in the time domain: off by at most {worst:.1e}")


def _dispersion_point(rng: random.Random) -> Point:
    fast, spring = rng.uniform(0.3, 1.5), rng.uniform(0.2, 1)
    number = complex(rng.uniform(-3, 3), rng.uniform(-1, 1))

    def wave(z: Any) -> Any:
        return mp.exp(1j * number * z)

    left = -fast * mp.diff(wave, 0.3) + wave(0.3) / 2
    left -= 0.5j * spring * (2 * wave(0.3) - wave(1.3) - wave(-0.7))
    return {s.v: fast, s.c: spring, s.k: number, s.L: complex(left / wave(0.3))}


def _slope_point(rng: random.Random, on_root: bool = False) -> Point:
    fast, spring = rng.choice(_SCENES)
    number = complex(rng.uniform(-3, 3), rng.uniform(-1, 1))
    if on_root:
        number = complex(rng.choice(list(numbers.roots(fast, spring, 5))))
    slope = complex(mp.diff(lambda q: mp.mpf(1) / 2 - 1j * fast * q - 1j * spring * (1 - mp.cos(q)),
                            number))  # fmt: skip
    return {s.v: fast, s.c: spring, s.k: number, s.L_k: slope}


def root_sets(candidate: sp.Basic) -> Evidence:
    """Roots found strip by strip are members; roots of the other half-plane are not."""
    fast, spring = _SCENES[0]
    for place, member in enumerate(parts_of(candidate)):
        condition = member.args[1].condition
        relation = next(q for q in condition.args if isinstance(q, sp.Equality))
        others = sp.And(*(q for q in condition.args if q != relation))
        for upper in (True, False):
            for number in numbers.roots(fast, spring, 3, upper):
                point = {s.k: complex(number), s.v: fast, s.c: spring}
                left = value(relation.lhs - relation.rhs, point)
                inside = abs(left) < 1e-9 and bool(others.subs(s.k, sp.sympify(complex(number))))
                if inside != (upper == (place == 0)):
                    return Evidence(False, f"wrong about the root {complex(number):.4f}")
    return Evidence(True, "twelve roots found strip by strip are sorted correctly")


def threshold(candidate: sp.Basic) -> Evidence:
    """With phi_us taken from the time-domain profile at the front."""
    worst, target = 0.0, 0.7 + 1.1j
    for fast, spring in _SCENES:
        point = {s.v: fast, s.c: spring, s.phi_s: target,
                 s.phi_us: target * numbers.profile(0.0, fast, spring)}  # fmt: skip
        left, right = candidate.args
        worst = max(worst, abs(numbers.evaluated(left - right, point)))
    return Evidence(worst < 1e-7, f"phi(0) in the time domain: off by at most {worst:.1e}")


def relation(candidate: sp.Basic) -> Evidence:
    """Check the modulus of (53) on the front, and the two cycles of the direct average."""
    pieces = parts_of(candidate)
    if len(pieces) != 3:
        return Evidence(False, "three equations are expected")
    first = threshold(pieces[0])
    if not first.holds:
        return first
    worst = 0.0
    for linear, quintic in ((4.0, 0.5), (2.5, 0.5), (3.1, 0.7)):
        p = {"e": 1.0, "a": linear, "b": quintic, "c": 0.0, "w": 1.0}

        def rate(size: float, p: dict[str, float] = p) -> float:
            return direct_average([complex(size), 0, 0], 0, p).real / size

        valley = brentq(lambda q, rate=rate: rate(q + 1e-4) - rate(q - 1e-4), 0.2, 30.0)
        inner, outer = brentq(rate, 1e-6, valley), brentq(rate, valley, 60.0)
        point = {s.a: linear, s.b: quintic, s.eta: quintic / (linear * linear),
                 s.phi_us: inner * 1j, s.phi_s: outer * cmath.exp(0.3j)}  # fmt: skip
        for piece in pieces[1:]:
            worst = max(worst, abs(value(piece.lhs, point) - value(piece.rhs, point)))
    return Evidence(
        worst < 1e-9,
        f"{first.statement}; cycles of the direct average: off by at most {worst:.1e}",
    )


averaged = equals(_averaged_point, "Eq. (8) averaged by direct sampling")
two_lines = equals(_two_lines_point, "the direct average linearised at rest, and its translate",
                   count=8, tolerance=1e-7)  # fmt: skip
force = vanishes_at(_force_point, "the two branches of (44), taken one at a time", count=6)
moving = vanishes_at(_moving_point, "a wave watched at fixed sites", parts=4)
front = equals(_front_point, "(44) over eps for a travelling test wave", count=6, tolerance=1e-8)
dispersion = vanishes_at(_dispersion_point, "(48) applied to e^{ik zeta}, numerically",
                         tolerance=1e-8)  # fmt: skip
slope = vanishes_at(_slope_point, "numerical derivatives of L at any k", tolerance=1e-8)
slope_on_roots = vanishes_at(lambda rng: _slope_point(rng, on_root=True),
                             "numerical derivatives of L at its roots", tolerance=1e-8)  # fmt: skip
