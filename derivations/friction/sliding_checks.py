"""Checks of steady sliding and of cycles without stick, by forces, eigenvalues and orbits."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp

from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import Point, equals, slope_of, solved_for, value
from derivations.algebra.steps import Evidence
from derivations.friction import symbols as s
from derivations.friction.forces import (
    DYNAMIC,
    STATIC,
    FrictionChecks,
    displacements,
    force_at_velocity,
    number,
    pull,
)
from derivations.friction.model import FrictionModel

_SMALL = 1e-3


def _slipping_state(
    chain: FrictionModel, rng: random.Random, uniform: bool = False
) -> tuple[dict[Any, Any], list[complex]]:
    """Draw a state of the slipping chain, and the residual of its equation."""
    dimensional = {s.m: 1.0, s.d: 2 * 0.07, s.k: 1.0, s.eta_c: 0.3}
    ground, mass = (number(q, dimensional) for q in (chain.stiffness, chain.inertia))
    drag = number(chain.damping, dimensional) / math.sqrt(ground * mass)
    point: dict[Any, Any] = {s.xi: drag / 2, s.c: number(chain.springs[1], dimensional) / ground,
                             s.mu_st: STATIC, s.mu_d: DYNAMIC, **dimensional}  # fmt: skip
    displaced = displacements(chain, rng, s.y_tilde, s.tau)
    own = s.y_tilde(s.n, s.tau)
    if uniform:
        displaced = dict.fromkeys(displaced, displaced[own])
    belt, speed, second = rng.uniform(1, 2), rng.uniform(-1, 0.9), rng.uniform(-1, 1)
    scale = rng.uniform(0.4, 0.9)
    net = second + drag * speed
    net += pull(chain, displaced, s.y_tilde, s.tau, dimensional) / ground
    net -= force_at_velocity(chain, belt, speed, scale)
    point |= displaced
    point |= {own.diff(s.tau): speed, own.diff(s.tau, 2): second, s.v_tilde_d: belt,
              s.v_tilde_0: scale}  # fmt: skip
    return point, [net]


def _drag(chain: FrictionModel, point: Point) -> Callable[[float], float]:
    """Return damping and friction as a function of velocity, in scaled quantities."""

    def total(speed: float) -> float:
        force = force_at_velocity(chain, point[s.v_tilde_d], speed, point[s.v_tilde_0])
        return 2 * float(point[s.xi]) * speed - float(force)

    return total


def _power(chain: FrictionModel, point: Point, size: float) -> float:
    """Return the mean of force times velocity over the phase, by equal samples."""
    total = 0.0
    samples = 64
    for place in range(samples):
        speed = size * math.cos(2 * math.pi * place / samples)
        total += _drag(chain, point)(speed) * speed / samples
    return total


def _without_integrals(candidate: sp.Basic) -> sp.Basic:
    """Replace integrals over a period by sums over equal steps, exact to rounding here."""
    count = 48
    rules = {}
    for integral in candidate.atoms(sp.Integral):
        (phase, low, high) = integral.limits[0]
        step = (high - low) / count
        places = [(low + (place + sp.Rational(1, 3)) * step).evalf() for place in range(count)]
        rules[integral] = step.evalf() * sum(
            integral.function.xreplace({phase: at}) for at in places
        )
    return candidate.xreplace(rules)


@lru_cache(maxsize=8)
def _energy_lost(decay: Callable[[sp.Expr], sp.Expr], size: float) -> float:
    """Return the energy lost in one turn of a cell with weak forces, for the caller's numbers."""
    static, dynamic, scale, drag, belt = STATIC, DYNAMIC, 0.6, 0.05, 1.3

    def total(speed: float) -> float:
        fallen = float(decay(sp.Float(abs(speed - belt) / scale)))
        return 2 * drag * speed - dynamic - (static - dynamic) * fallen

    rest = total(0.0)

    def rates(_: float, state: Any) -> list[float]:
        return [state[1], -state[0] - _SMALL * (total(float(state[1])) - rest)]

    run = solve_ivp(rates, (0, 2 * math.pi), [0.0, size], rtol=1e-9, atol=1e-11)
    return size**2 / 2 - float(run.y[0, -1] ** 2 + run.y[1, -1] ** 2) / 2


def _first_order_error(chain: FrictionModel, candidate: sp.Basic) -> float:
    """Compare the energy change in one turn, with weak forces scaled by 1/1000, with the mean."""
    small, size = _SMALL, 0.8
    point: dict[Any, Any] = {s.mu_st: STATIC, s.mu_d: DYNAMIC, s.v_tilde_0: 0.6, s.xi: 0.05,
                             s.v_tilde_d: 1.3, s.R: size}  # fmt: skip
    lost = _energy_lost(chain.decay, size)
    mean = value(candidate.lhs, point).real - value(candidate.rhs, point).real
    return float(abs(lost / (2 * math.pi * small) / mean - 1))


class SlidingChecks(FrictionChecks):
    """The checks of the slipping chain, for one chain."""

    @equals("the forces on a slipping site")
    def slipping(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Compare with all forces on a site, from energies and the force law."""
        return _slipping_state(self.chain, rng)

    @equals("the forces when all sites agree")
    def cell(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Compare with the same for sites that move alike, without numbers for neighbours."""
        point, rest = _slipping_state(self.chain, rng, True)
        own = s.y_tilde(s.n, s.tau)
        return {q: each for q, each in point.items() if q.func != own.func or q == own}, rest

    @equals("the friction force at the speed of the belt")
    def sliding(self, rng: random.Random) -> Point:
        """Compare with the rest position, at which ground spring and friction balance."""
        point, _ = _slipping_state(self.chain, rng)
        return {**point, s.y_star: -_drag(self.chain, point)(0.0)}

    @equals("forces differentiated numerically", tolerance=1e-7)
    def linear(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Compare with the change of all forces for a small deviation."""
        point, _ = _slipping_state(self.chain, rng)
        small = displacements(self.chain, rng, s.z, s.tau)
        speed, second = rng.uniform(-1, 1), rng.uniform(-1, 1)
        dimensional = {q: point[q] for q in (s.m, s.d, s.k, s.eta_c)}
        ground = number(self.chain.stiffness, dimensional)
        own = s.z(s.n, s.tau)
        net = second + slope_of(_drag(self.chain, point)) * speed
        net += pull(self.chain, small, s.z, s.tau, dimensional) / ground
        return {**point, **small, own.diff(s.tau): speed, own.diff(s.tau, 2): second}, [net]

    @equals("eigenvalues of a ring, found numerically", tolerance=1e-6)
    def waves(self, rng: random.Random) -> Point:
        """Compare with the eigenvalues of a ring of sites, found numerically."""
        sites = 9
        point, _ = _slipping_state(self.chain, rng)
        dimensional = {q: point[q] for q in (s.m, s.d, s.k, s.eta_c)}
        ground = number(self.chain.stiffness, dimensional)
        springs = np.eye(sites)
        for distance, spring in self.chain.springs.items():
            relative = number(spring, dimensional) / ground
            ahead = np.roll(np.eye(sites), distance, axis=1)
            springs = springs + relative * (2 * np.eye(sites) - ahead - ahead.T)
        drag = slope_of(_drag(self.chain, point)) * np.eye(sites)
        block = np.block([[np.zeros((sites, sites)), np.eye(sites)], [-springs, -drag]])
        values, vectors = np.linalg.eig(block)
        # The Fourier transform of an eigenvector peaks at its wavenumber, up to a sign.
        place = rng.randrange(2 * sites)
        spectrum = np.abs(np.fft.fft(vectors[:sites, place]))
        return {**point, s.rate: complex(values[place]),
                s.q: 2 * math.pi * int(spectrum.argmax()) / sites}  # fmt: skip

    @equals("the forces differentiated numerically", tolerance=1e-7)
    def damping(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Compare with the slope of all velocity-dependent forces."""
        point, _ = _slipping_state(self.chain, rng)
        return point, [slope_of(_drag(self.chain, point))]

    def hopf(self, candidate: sp.Basic) -> Evidence:
        """Require the slope of the forces to vanish and change sign at each velocity found."""
        worst, kept = 0.0, 0
        for static, fall, scale, drag in ((1.0, 0.5, 0.5, 0.05), (0.9, 0.55, 0.7, 0.04)):
            point: dict[Any, Any] = {s.mu_st: static, s.mu_d: static - fall, s.v_tilde_0: scale,
                                     s.xi: drag}  # fmt: skip
            for part in parts_of(candidate):
                belt = complex(solved_for(part, s.v_hopf, point))
                if abs(belt.imag) > 1e-12 or belt.real <= 0:
                    continue

                def total(speed: float, at: float = belt.real, given: Any = point) -> float:
                    fallen = float(self.chain.decay(sp.Float((at - speed) / given[s.v_tilde_0])))
                    fall_ = given[s.mu_st] - given[s.mu_d]
                    return float(2 * given[s.xi] * speed - fall_ * fallen)

                kept += 1
                worst = max(worst, abs(slope_of(total)))
        return Evidence(
            kept >= 2 and worst < 1e-7,
            f"slope of the forces at {kept} such velocities: at most {worst:.1e}",
        )

    @equals("the power sampled over a period", tolerance=1e-7)
    def _sampled_balance(self, rng: random.Random) -> tuple[Point, list[complex]]:
        point, _ = _slipping_state(self.chain, rng)
        size = rng.uniform(0.2, 0.9) * point[s.v_tilde_d]
        return {**point, s.R: size}, [_power(self.chain, point, size)]

    def balance(self, candidate: sp.Basic) -> Evidence:
        """Compare with the sampled mean power, and with one period of a weakly damped cell."""
        candidate = _without_integrals(candidate)
        found = self._sampled_balance(candidate)
        if not found.holds:
            return found
        worst = _first_order_error(self.chain, candidate)
        return Evidence(worst < 0.02, f"{found.statement}; energy lost by a weakly damped cell in "
                                      f"one period: within {worst:.1%}")  # fmt: skip

    @equals("the power sampled over a period that grazes the belt", tolerance=1e-7)
    def _sampled_bound(self, rng: random.Random) -> tuple[Point, list[complex]]:
        point, _ = _slipping_state(self.chain, rng)
        return point, [_power(self.chain, point, point[s.v_tilde_d])]

    def bound(self, candidate: sp.Basic) -> Evidence:
        """Compare with the same where the largest velocity is that of the belt."""
        return self._sampled_bound(_without_integrals(candidate))
