"""Checks of the steps of model I by energies, direct forces, eigenvalues and orbits."""

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
from derivations.algebra.evidence import (
    Point,
    Points,
    at_points,
    equals,
    slope_of,
    solved_for,
    value,
)
from derivations.algebra.steps import Evidence
from derivations.friction import symbols as s
from derivations.friction.model import PAPER, FrictionModel

_STATIC, _DYNAMIC, _SCALE = 0.9, 0.35, 0.7
_SPEEDS = (-1.3, -1e-9, 0.4, 2.0)


def _numbers(rng: random.Random) -> dict[sp.Basic, float]:
    """Return values of the dimensional quantities."""
    names = (s.m, s.d, s.k, s.eta_c, s.F_N, s.v_0)
    return {name: rng.uniform(0.5, 2) for name in names}


def _number(expression: Any, point: Point) -> float:
    return float(value(sp.sympify(expression), point).real)


def _size(chain: FrictionModel, speed: float, scale: float = _SCALE) -> float:
    """Return the friction coefficient at a speed, for the two limiting values of this file."""
    fallen = float(chain.decay(sp.Float(abs(speed) / scale)))
    return _DYNAMIC + (_STATIC - _DYNAMIC) * fallen


def _force(chain: FrictionModel, speed: float, scale: float = _SCALE) -> float:
    """Return the force on a slipping site for a normal force of one, as stated in the text."""
    return -math.copysign(_size(chain, speed, scale), speed)


def _sites(chain: FrictionModel, rng: random.Random, field: Any, time: Any) -> dict[Any, float]:
    reach = max(chain.springs)
    return {field(s.n + place, time): rng.uniform(-1, 1) for place in range(-reach, reach + 1)}


def _pull(chain: FrictionModel, displaced: dict[Any, float], field: Any, time: Any,
          point: Point) -> float:  # fmt: skip
    """Return the force of ground and springs on site n, from their potential energy."""

    def energy(own: float) -> float:
        total = _number(chain.stiffness, point) * own**2 / 2
        for distance, spring in chain.springs.items():
            for sign in (1, -1):
                other = displaced[field(s.n + sign * distance, time)]
                total += _number(spring, point) * (other - own) ** 2 / 2
        return total

    own = displaced[field(s.n, time)]
    return energy(own + 0.5) - energy(own - 0.5)  # exact for a quadratic energy


_SHARES = (sp.Rational(999, 1000), sp.Integer(1), sp.Rational(1001, 1000))
"""Fractions of the limit: below it, at it, above it."""


def _sticks(bound: sp.Basic, point: Point, force: sp.Symbol, limit: float) -> bool:
    """Whether a bound admits the limit, from which slip starts, and nothing beyond."""
    exact = {a: sp.nsimplify(v, rational=True) for a, v in point.items()}
    inside = bound.xreplace(exact)
    most = sp.nsimplify(limit, rational=True)
    found = [bool(inside.subs(force, most * share)) for share in _SHARES]
    return found == [True, True, False]


def _is_law(candidate: sp.Basic, point: Point, names: tuple[sp.Symbol, sp.Symbol],
            *, unit: float, limit: float, velocity: float) -> Evidence:  # fmt: skip
    """Judge (3) or (6): a force that opposes slip and its domain, the bound and its domain."""
    force, speed = names
    law, moving, bound, resting = parts_of(candidate)
    worst, size = 0.0, 0.61
    for fast in _SPEEDS:
        filled = {**point, speed: fast, s.mu(speed * velocity): size,
                  force: -math.copysign(unit * size, fast)}  # fmt: skip
        inside = law.xreplace(
            {
                own: sp.Float(size)
                for own in law.atoms(sp.Function)
                if own.func == s.mu and _argument(own, filled, fast * velocity)
            }
        )
        worst = max(worst, abs(value(inside.lhs, filled) - value(inside.rhs, filled)))
        weaker = {**filled, force: 0.9 * filled[force]}
        if abs(value(inside.lhs, weaker) - value(inside.rhs, weaker)) <= 1e-9:
            return Evidence(False, "it holds for another force as well, so it has no content")
    where = [bool(part.subs(speed, sp.Rational(fast))) for part in (moving, resting)
             for fast in (1, -1, 0)]  # fmt: skip
    if where != [True, True, False, False, False, True]:
        return Evidence(False, "slip and stick are not distinguished by the relative velocity")
    if worst > 1e-9:
        return Evidence(False, f"the force differs by {worst:.1e}")
    if not _sticks(bound, point, force, limit):
        return Evidence(False, "at the limit, where slip begins, it defines no force")
    return Evidence(
        True,
        "opposes slip at four velocities, and in stick allows the force up to the limit that slip "
        f"starts from, that included: {worst:.1e}",
    )


def _argument(own: sp.Basic, point: Point, expected: float) -> bool:
    return bool(abs(value(own.args[0], point).real - expected) < 1e-12)


def _shape(x: Any) -> Any:
    return np.tanh(x) + 0.4 * np.sin(1.7 * x)


def _scaled_point(chain: FrictionModel, rng: random.Random) -> tuple[dict[Any, Any], complex]:
    """Draw a state in scaled quantities, with Newton's law for it divided by F_N."""
    point: dict[Any, Any] = dict(_numbers(rng))
    inertia, ground = (_number(q, point) for q in (chain.inertia, chain.stiffness))
    length, clock = point[s.F_N] / ground, math.sqrt(ground / inertia)
    displaced = _sites(chain, rng, s.y, s.t)
    speed, second, force = (rng.uniform(-1, 1) for _ in range(3))
    net = inertia * second + _number(chain.damping, point) * speed
    net += _pull(chain, displaced, s.y, s.t, point) - force
    own = s.y_tilde(s.n, s.tau)
    point |= {s.y_0: length, s.omega_n: clock, s.F_tilde: force / point[s.F_N],
              own.diff(s.tau): speed / (length * clock),
              own.diff(s.tau, 2): second / (length * clock**2),
              s.c: _number(chain.springs[1], point) / ground,
              s.xi: _number(chain.damping, point) / (2 * math.sqrt(ground * inertia))}  # fmt: skip
    for site, place in displaced.items():
        point[s.y_tilde(site.args[0], s.tau)] = place / length
    return point, net / point[s.F_N]


def _units() -> dict[sp.Basic, float]:
    """Return units in which v_0 differs from one in the scaled velocity."""
    return {s.omega_n: 1.3, s.y_0: 0.6, s.v_0: _SCALE, s.v_tilde_0: _SCALE / (1.3 * 0.6),
            s.mu_st: _STATIC, s.mu_d: _DYNAMIC}  # fmt: skip


def _slipping_force(chain: FrictionModel, belt: float, speed: Any, scale: float) -> Any:
    """Return the friction on a site slower than the belt, in scaled quantities."""
    return -_force(chain, belt - speed, scale)


def _slipping_state(
    chain: FrictionModel, rng: random.Random, uniform: bool = False
) -> tuple[dict[Any, Any], list[complex]]:
    """Draw a state of the slipping chain, and the residual of its equation."""
    dimensional = {s.m: 1.0, s.d: 2 * 0.07, s.k: 1.0, s.eta_c: 0.3}
    ground, mass = (_number(q, dimensional) for q in (chain.stiffness, chain.inertia))
    drag = _number(chain.damping, dimensional) / math.sqrt(ground * mass)
    point: dict[Any, Any] = {s.xi: drag / 2, s.c: _number(chain.springs[1], dimensional) / ground,
                             s.mu_st: _STATIC, s.mu_d: _DYNAMIC, **dimensional}  # fmt: skip
    displaced = _sites(chain, rng, s.y_tilde, s.tau)
    own = s.y_tilde(s.n, s.tau)
    if uniform:
        displaced = dict.fromkeys(displaced, displaced[own])
    belt, speed, second = rng.uniform(1, 2), rng.uniform(-1, 0.9), rng.uniform(-1, 1)
    scale = rng.uniform(0.4, 0.9)
    net = second + drag * speed
    net += _pull(chain, displaced, s.y_tilde, s.tau, dimensional) / ground
    net -= _slipping_force(chain, belt, speed, scale)
    point |= displaced
    point |= {own.diff(s.tau): speed, own.diff(s.tau, 2): second, s.v_tilde_d: belt,
              s.v_tilde_0: scale}  # fmt: skip
    return point, [net]


def _drag(chain: FrictionModel, point: Point) -> Callable[[float], float]:
    """Return damping and friction as a function of velocity, in scaled quantities."""

    def total(speed: float) -> float:
        force = _slipping_force(chain, point[s.v_tilde_d], speed, point[s.v_tilde_0])
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


_SMALL = 1e-3


@lru_cache(maxsize=8)
def _energy_lost(decay: Callable[[sp.Expr], sp.Expr], size: float) -> float:
    """Return the energy lost in one turn of a cell with weak forces, for the caller's numbers."""
    static, dynamic, scale, drag, belt = _STATIC, _DYNAMIC, 0.6, 0.05, 1.3

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
    point: dict[Any, Any] = {s.mu_st: _STATIC, s.mu_d: _DYNAMIC, s.v_tilde_0: 0.6, s.xi: 0.05,
                             s.v_tilde_d: 1.3, s.R: size}  # fmt: skip
    lost = _energy_lost(chain.decay, size)
    mean = value(candidate.lhs, point).real - value(candidate.rhs, point).real
    return float(abs(lost / (2 * math.pi * small) / mean - 1))


class FrictionChecks:
    """The checks of the derivation for one friction chain.

    Parameters
    ----------
    chain : FrictionModel
        The chain.
    """

    def __init__(self, chain: FrictionModel) -> None:
        self.chain = chain

    @equals("the forces of a potential energy, differentiated numerically")
    def newton(self, rng: random.Random) -> tuple[Point, list[complex]]:
        """Compare with the forces of a potential energy."""
        point: dict[Any, Any] = dict(_numbers(rng))
        displaced = _sites(self.chain, rng, s.y, s.t)
        speed, second, force = (rng.uniform(-1, 1) for _ in range(3))
        own = s.y(s.n, s.t)
        rest = (
            _number(self.chain.inertia, point) * second + _number(self.chain.damping, point) * speed
        )
        rest += _pull(self.chain, displaced, s.y, s.t, point) - force
        point |= displaced
        point |= {own.diff(s.t): speed, own.diff(s.t, 2): second, s.F: force}
        return point, [rest]

    @equals("the decay of the model between two values")
    def falling(self, rng: random.Random) -> Point:
        """Require friction to follow the decay of the model between any two values."""
        far, fall, scale, speed = (rng.uniform(0.3, 1.5) for _ in range(4))
        size = far + fall * float(self.chain.decay(sp.Float(speed / scale)))
        return {s.mu_far: far, s.mu_fall: fall, s.v_0: scale, s.v_rel: -speed,
                s.mu(s.v_rel): size}  # fmt: skip

    @staticmethod
    def limits(candidate: sp.Basic) -> Evidence:
        """Require the two limits stated in the text."""
        text = {"rest": s.mu_st, "speed": s.mu_d}
        rest, speed = parts_of(candidate)
        holds = rest == sp.Eq(s.mu(0), text["rest"], evaluate=False)
        holds = holds and speed == sp.Eq(s.mu(sp.oo), text["speed"], evaluate=False)
        return Evidence(holds, "μ(0) = μₛₜ and μ(∞) = μ_d, as stated below (2)")

    @at_points("the decay of the model from μₛₜ at rest to μ_d at great speed")
    def coefficient(self) -> Points:
        """Compare values at rest, at large speed and at one reference velocity."""
        values = {s.mu_st: _STATIC, s.mu_d: _DYNAMIC, s.v_0: _SCALE}
        for speed in (0.3, 0.0, 1e6 * _SCALE, _SCALE, -_SCALE):
            yield {**values, s.v_rel: speed, s.mu(s.v_rel): _size(self.chain, speed)}, [0]

    @staticmethod
    def law(candidate: sp.Basic) -> Evidence:
        """Judge the force (3) with normal force 1.7."""
        point = {s.mu_st: _STATIC, s.F_N: 1.7}
        return _is_law(candidate, point, (s.F, s.v_rel),
                       unit=1.7, limit=_STATIC * 1.7, velocity=1.0)  # fmt: skip

    @staticmethod
    def scaled_law(candidate: sp.Basic) -> Evidence:
        """Judge (6): the force of (3) over F_N, with the dimensional velocity in mu only."""
        if candidate.replace(s.mu, lambda _: sp.S.One).has(s.F_N, s.omega_n, s.y_0):
            return Evidence(False, "a quantity with a dimension occurs outside mu")
        point = {s.mu_st: _STATIC, s.F_N: 1.7, s.omega_n: 1.3, s.y_0: 0.6}
        return _is_law(candidate, point, (s.F_tilde, s.v_tilde_rel),
                       unit=1.0, limit=_STATIC, velocity=1.3 * 0.6)  # fmt: skip

    @staticmethod
    def force_of_slip(candidate: sp.Basic) -> Evidence:
        """Judge the first part of (6) alone."""
        whole = sp.Tuple(candidate, sp.Ne(s.v_tilde_rel, 0), sp.Abs(s.F_tilde) <= s.mu_st,
                         sp.Eq(s.v_tilde_rel, 0))  # fmt: skip
        return FrictionChecks.scaled_law(whole)

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

    @equals("the dimensional force over F_N", count=6)
    def slip(self, rng: random.Random) -> Point:
        """Compare with the dimensional force over F_N, at the same physical velocities."""
        speed = rng.choice([-1.3, -0.2, 0.4, 2.0])
        return {
            **_units(),
            s.v_tilde_rel: speed / (1.3 * 0.6),
            s.F_tilde: _force(self.chain, speed),
        }

    @equals("the dimensional force over F_N, of sites slower than the belt")
    def backwards(self, rng: random.Random) -> Point:
        """Compare with the same at negative velocities only."""
        speed = -rng.uniform(0.1, 2)
        return {
            **_units(),
            s.v_tilde_rel: speed / (1.3 * 0.6),
            s.F_tilde: _force(self.chain, speed),
        }

    @equals("the force at the difference of the two speeds")
    def at_velocity(self, rng: random.Random) -> Point:
        """Compare with the force on a site slower than the belt."""
        belt, speed, scale = rng.uniform(1, 2), rng.uniform(-1, 0.9), rng.uniform(0.4, 0.9)
        return {s.v_tilde_d: belt, s.v_tilde_0: scale, s.mu_st: _STATIC, s.mu_d: _DYNAMIC,
                s.y_tilde(s.n, s.tau).diff(s.tau): speed,
                s.F_tilde: _slipping_force(self.chain, belt, speed, scale)}  # fmt: skip

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
        small = _sites(self.chain, rng, s.z, s.tau)
        speed, second = rng.uniform(-1, 1), rng.uniform(-1, 1)
        dimensional = {q: point[q] for q in (s.m, s.d, s.k, s.eta_c)}
        ground = _number(self.chain.stiffness, dimensional)
        own = s.z(s.n, s.tau)
        net = second + slope_of(_drag(self.chain, point)) * speed
        net += _pull(self.chain, small, s.z, s.tau, dimensional) / ground
        return {**point, **small, own.diff(s.tau): speed, own.diff(s.tau, 2): second}, [net]

    @equals("eigenvalues of a ring, found numerically", tolerance=1e-6)
    def waves(self, rng: random.Random) -> Point:
        """Compare with the eigenvalues of a ring of sites, found numerically."""
        sites = 9
        point, _ = _slipping_state(self.chain, rng)
        dimensional = {q: point[q] for q in (s.m, s.d, s.k, s.eta_c)}
        ground = _number(self.chain.stiffness, dimensional)
        springs = np.eye(sites)
        for distance, spring in self.chain.springs.items():
            relative = _number(spring, dimensional) / ground
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

    dimensionless = in_scales
