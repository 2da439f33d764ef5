"""Test motions in two times, and random parameters of the assumed motion of the neighbours."""

from __future__ import annotations

import random
from collections.abc import Callable
from typing import Any

import mpmath as mp
import sympy as sp

from derivations.algebra.evidence import Point
from derivations.symbols import alpha_0, k_1, k_2, t_hat, tau


def wave_numbers(rng: random.Random, unit: float = 1.0) -> dict[sp.Symbol, float]:
    """Draw an amplitude in a given unit, a decay rate and a phase step."""
    return {k_1: rng.uniform(-2, -0.3), k_2: rng.uniform(-2, 2),
            alpha_0: unit * rng.uniform(0.5, 2)}  # fmt: skip


def first_motion(p: Any, q: Any) -> Any:
    """Return a fixed motion at the fast time p and the slow time q."""
    return mp.sin(1.1 * p + 0.3) * mp.exp(-0.7 * q) + 0.4 * mp.cos(2 * p) * (1 + q**2)


def second_motion(p: Any, q: Any) -> Any:
    """Return another one, for the correction of order ε."""
    return mp.cos(0.9 * p + 0.2) * (1 + 0.5 * q) + 0.3 * mp.sin(3 * p - q)


def partials(function: Callable[[Any, Any], Any], symbol: sp.Expr, p: Any, q: Any) -> Point:
    """Return a motion and its partial derivatives to second order, differentiated numerically."""
    point: dict[Any, Any] = {symbol: function(p, q)}
    for first, second in ((1, 0), (0, 1), (2, 0), (1, 1), (0, 2)):
        variables = [t_hat] * first + [tau] * second
        point[symbol.diff(*variables)] = mp.diff(function, (p, q), (first, second))
    return point
