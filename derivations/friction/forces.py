"""Forces of model I as numbers, with which the checks compare its equations."""

from __future__ import annotations

import math
import random
from typing import Any

import sympy as sp

from derivations.algebra.evidence import Point, value
from derivations.friction import symbols as s
from derivations.friction.model import FrictionModel

STATIC, DYNAMIC, SCALE = 0.9, 0.35, 0.7
"""μ_st, μ_d and the reference velocity."""


def dimensional_numbers(rng: random.Random) -> dict[sp.Basic, float]:
    """Return values of the dimensional quantities."""
    names = (s.m, s.d, s.k, s.eta_c, s.F_N, s.v_0)
    return {name: rng.uniform(0.5, 2) for name in names}


def number(expression: Any, point: Point) -> float:
    """Return the value of an expression at a point."""
    return float(value(sp.sympify(expression), point).real)


def coefficient_at(chain: FrictionModel, speed: float, scale: float = SCALE) -> float:
    """Return the friction coefficient at a speed, for the two limiting values of this file."""
    fallen = float(chain.decay(sp.Float(abs(speed) / scale)))
    return DYNAMIC + (STATIC - DYNAMIC) * fallen


def slip_force(chain: FrictionModel, speed: float, scale: float = SCALE) -> float:
    """Return the force on a slipping site for a normal force of one, as stated in the text."""
    return -math.copysign(coefficient_at(chain, speed, scale), speed)


def force_at_velocity(chain: FrictionModel, belt: float, speed: Any, scale: float) -> Any:
    """Return the friction on a site slower than the belt, in scaled quantities."""
    return -slip_force(chain, belt - speed, scale)


def displacements(
    chain: FrictionModel, rng: random.Random, field: Any, time: Any
) -> dict[Any, float]:
    """Draw the displacements of a site and of all sites to which it is coupled."""
    reach = max(chain.springs)
    return {field(s.n + place, time): rng.uniform(-1, 1) for place in range(-reach, reach + 1)}


def pull(chain: FrictionModel, displaced: dict[Any, float], field: Any, time: Any,
         point: Point) -> float:  # fmt: skip
    """Return the force of ground and springs on site n, from their potential energy."""

    def energy(own: float) -> float:
        total = number(chain.stiffness, point) * own**2 / 2
        for distance, spring in chain.springs.items():
            for sign in (1, -1):
                other = displaced[field(s.n + sign * distance, time)]
                total += number(spring, point) * (other - own) ** 2 / 2
        return total

    own = displaced[field(s.n, time)]
    return energy(own + 0.5) - energy(own - 0.5)  # exact for a quadratic energy


class FrictionChecks:
    """Common part of the checks of model I.

    Parameters
    ----------
    chain : FrictionModel
        The chain.
    """

    def __init__(self, chain: FrictionModel) -> None:
        self.chain = chain
