"""Checks of the friction law, Eqs. (2), (3) and (6), by direct forces."""

from __future__ import annotations

import math
import random

import sympy as sp

from derivations.algebra.equations import parts_of
from derivations.algebra.evidence import Point, Points, at_points, equals, value
from derivations.algebra.steps import Evidence
from derivations.friction import symbols as s
from derivations.friction.forces import (
    DYNAMIC,
    SCALE,
    STATIC,
    FrictionChecks,
    coefficient_at,
    force_at_velocity,
    slip_force,
)

_SPEEDS = (-1.3, -1e-9, 0.4, 2.0)
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


def _units() -> dict[sp.Basic, float]:
    """Return units in which v_0 differs from one in the scaled velocity."""
    return {s.omega_n: 1.3, s.y_0: 0.6, s.v_0: SCALE, s.v_tilde_0: SCALE / (1.3 * 0.6),
            s.mu_st: STATIC, s.mu_d: DYNAMIC}  # fmt: skip


class LawChecks(FrictionChecks):
    """The checks of the friction law, for one chain."""

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
        values = {s.mu_st: STATIC, s.mu_d: DYNAMIC, s.v_0: SCALE}
        for speed in (0.3, 0.0, 1e6 * SCALE, SCALE, -SCALE):
            yield {**values, s.v_rel: speed, s.mu(s.v_rel): coefficient_at(self.chain, speed)}, [0]

    @staticmethod
    def law(candidate: sp.Basic) -> Evidence:
        """Judge the force (3) with normal force 1.7."""
        point = {s.mu_st: STATIC, s.F_N: 1.7}
        return _is_law(candidate, point, (s.F, s.v_rel),
                       unit=1.7, limit=STATIC * 1.7, velocity=1.0)  # fmt: skip

    @staticmethod
    def scaled_law(candidate: sp.Basic) -> Evidence:
        """Judge (6): the force of (3) over F_N, with the dimensional velocity in mu only."""
        if candidate.replace(s.mu, lambda _: sp.S.One).has(s.F_N, s.omega_n, s.y_0):
            return Evidence(False, "a quantity with a dimension occurs outside mu")
        point = {s.mu_st: STATIC, s.F_N: 1.7, s.omega_n: 1.3, s.y_0: 0.6}
        return _is_law(candidate, point, (s.F_tilde, s.v_tilde_rel),
                       unit=1.0, limit=STATIC, velocity=1.3 * 0.6)  # fmt: skip

    @staticmethod
    def force_of_slip(candidate: sp.Basic) -> Evidence:
        """Judge the first part of (6) alone."""
        whole = sp.Tuple(candidate, sp.Ne(s.v_tilde_rel, 0), sp.Abs(s.F_tilde) <= s.mu_st,
                         sp.Eq(s.v_tilde_rel, 0))  # fmt: skip
        return LawChecks.scaled_law(whole)

    @equals("the dimensional force over F_N", count=6)
    def slip(self, rng: random.Random) -> Point:
        """Compare with the dimensional force over F_N, at the same physical velocities."""
        speed = rng.choice([-1.3, -0.2, 0.4, 2.0])
        return {
            **_units(),
            s.v_tilde_rel: speed / (1.3 * 0.6),
            s.F_tilde: slip_force(self.chain, speed),
        }

    @equals("the dimensional force over F_N, of sites slower than the belt")
    def backwards(self, rng: random.Random) -> Point:
        """Compare with the same at negative velocities only."""
        speed = -rng.uniform(0.1, 2)
        return {
            **_units(),
            s.v_tilde_rel: speed / (1.3 * 0.6),
            s.F_tilde: slip_force(self.chain, speed),
        }

    @equals("the force at the difference of the two speeds")
    def at_velocity(self, rng: random.Random) -> Point:
        """Compare with the force on a site slower than the belt."""
        belt, speed, scale = rng.uniform(1, 2), rng.uniform(-1, 0.9), rng.uniform(0.4, 0.9)
        return {s.v_tilde_d: belt, s.v_tilde_0: scale, s.mu_st: STATIC, s.mu_d: DYNAMIC,
                s.y_tilde(s.n, s.tau).diff(s.tau): speed,
                s.F_tilde: force_at_velocity(self.chain, belt, speed, scale)}  # fmt: skip
