"""Checks of the equation of motion and of its scaled form, Eqs. (1), (4), (5) and (7)."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np
import sympy as sp

from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import Point, Points, at_points, equals, value
from derivations.algebra.steps import Evidence
from derivations.friction import symbols as s
from derivations.friction.forces import (
    FrictionChecks,
    dimensional_numbers,
    displacements,
    number,
    pull,
)
from derivations.friction.model import PAPER, FrictionModel


def _shape(x: Any) -> Any:
    return np.tanh(x) + 0.4 * np.sin(1.7 * x)


def _scaled_point(chain: FrictionModel, rng: random.Random) -> tuple[dict[Any, Any], complex]:
    """Draw a state in scaled quantities, with Newton's law for it divided by F_N."""
    point: dict[Any, Any] = dict(dimensional_numbers(rng))
    inertia, ground = (number(q, point) for q in (chain.inertia, chain.stiffness))
    length, clock = point[s.F_N] / ground, math.sqrt(ground / inertia)
    displaced = displacements(chain, rng, s.y, s.t)
    speed, second, force = (rng.uniform(-1, 1) for _ in range(3))
    net = inertia * second + number(chain.damping, point) * speed
    net += pull(chain, displaced, s.y, s.t, point) - force
    own = s.y_tilde(s.n, s.tau)
    point |= {s.y_0: length, s.omega_n: clock, s.F_tilde: force / point[s.F_N],
              own.diff(s.tau): speed / (length * clock),
              own.diff(s.tau, 2): second / (length * clock**2),
              s.c: number(chain.springs[1], point) / ground,
              s.xi: number(chain.damping, point) / (2 * math.sqrt(ground * inertia))}  # fmt: skip
    for site, place in displaced.items():
        point[s.y_tilde(site.args[0], s.tau)] = place / length
    return point, net / point[s.F_N]


class ScalingChecks(FrictionChecks):
    """The checks of the equation of motion and of its scales, for one chain."""

    @equals("the forces of a potential energy, differentiated numerically")
    def newton(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Compare with the forces of a potential energy."""
        point: dict[Any, Any] = dict(dimensional_numbers(rng))
        displaced = displacements(self.chain, rng, s.y, s.t)
        speed, second, force = (rng.uniform(-1, 1) for _ in range(3))
        own = s.y(s.n, s.t)
        rest = (
            number(self.chain.inertia, point) * second + number(self.chain.damping, point) * speed
        )
        rest += pull(self.chain, displaced, s.y, s.t, point) - force
        point |= displaced
        point |= {own.diff(s.t): speed, own.diff(s.t, 2): second, s.F: force}
        return point, [rest]

    @staticmethod
    def scales(candidate: sp.Basic) -> Evidence:
        """Require one unit for each of displacement, time and force."""
        expected = {s.y(s.n, s.t): (s.y_tilde(s.n, s.tau), s.y_0), s.tau: (s.t, s.omega_n),
                  s.F: (s.F_tilde, s.F_N)}  # fmt: skip
        found = {part.lhs: part.rhs for part in parts_of(candidate)}
        holds = set(found) == set(expected) and all(
            value(found[own], {new: 1.7, unit: 2.3}) == value(new * unit, {new: 1.7, unit: 2.3})
            for own, (new, unit) in expected.items()
        )
        return Evidence(holds, "each quantity is the product of its unit and its scaled value")

    @staticmethod
    @at_points("a scaled motion differentiated numerically", tolerance=1e-8)
    def velocities() -> Points:
        """Differentiate a scaled motion numerically: a velocity is a displacement over a time."""
        length, clock, normal, step, at = 0.6, 1.3, 1.7, 1e-5, 0.4
        scaled = (_shape(at + step) - _shape(at - step)) / (2 * step)
        far, near = (length * _shape(at + sign * clock * step) for sign in (1, -1))
        moved = (far - near) / (2 * step)
        yield {s.omega_n: clock, s.y_0: length, s.F_N: normal, s.v_tilde_rel: scaled,
               s.v_rel: moved, s.v_tilde_0: scaled, s.v_0: moved, s.F_tilde: 0.3,
               s.F: 0.3 * normal}, [0, 0, 0]  # fmt: skip

    @staticmethod
    @at_points("sites at, below and above the speed of the belt")
    def relative() -> Points:
        """Compare with sites that move with the belt, rest, and move faster than it."""
        own = s.y_tilde(s.n, s.tau).diff(s.tau)
        for speed, expected in ((1.25, 0.0), (0.0, -1.25), (2.0, 0.75)):
            yield {own: speed, s.v_tilde_d: 1.25, s.v_tilde_rel: expected}, [0]

    def parameters(self, candidate: sp.Basic) -> Evidence:
        """Compare with the numbers of the caption, or with those of another chain."""
        caption = {s.mu_st: 1.0, s.mu_d: 0.5, s.v_tilde_0: 0.5, s.xi: 0.05}
        other = {own: float(given) for own, given in self.chain.parameters.items()}
        expected = caption if self.chain.parameters == PAPER.parameters else other
        found = {part.lhs: part.rhs for part in parts_of(candidate)}
        off = max(abs(float(found[own]) - expected[own]) for own in expected)
        complete = set(found) == set(expected)
        return Evidence(complete and off < 1e-12, "the numbers in the caption of Fig. 2")

    @equals("the dimensional equation divided by F_N")
    def in_scales(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Compare with the dimensional equation divided by F_N."""
        point, net = _scaled_point(self.chain, rng)
        return point, [net]

    @equals("the scales that reduce (1) to unit coefficients", parts=4)
    def units(self, rng: random.Random) -> Point:
        """Compare with the scales that make inertia and stiffness one."""
        return _scaled_point(self.chain, rng)[0]

    @staticmethod
    @at_points("radians of the free oscillation")
    def clock() -> Points:
        """Compare the phase at one value of t."""
        yield {s.t: 0.7, s.omega_n: 1.3, s.tau: 0.7 * 1.3}, [0]

    @equals("the scales that reduce (1) to unit coefficients", parts=5)
    def scaling(self, rng: random.Random) -> Point:
        """Compare all of (4)."""
        point, _ = _scaled_point(self.chain, rng)
        instant = rng.uniform(0.1, 1)
        return {**point, s.t: instant, s.tau: instant * point[s.omega_n]}
