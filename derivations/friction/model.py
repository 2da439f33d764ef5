"""The model from which the derivation of part 1 starts: a chain of sites with dry friction."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import sympy as sp

from derivations.algebra.equations import equation
from derivations.friction.symbols import F, d, eta_c, k, m, mu_d, mu_st, n, t, v_tilde_0, xi, y


def exponential(speed: sp.Expr) -> sp.Expr:
    """Return the decay function of Eq. (2): one at zero speed and zero at infinite speed."""
    return sp.exp(-speed)


@dataclass(frozen=True, kw_only=True)
class FrictionModel:
    """A friction chain, as described by Eqs. (1) and (2), with possible modifications.

    Attributes
    ----------
    inertia, damping, stiffness : Expr
        Coefficients of y'', y' and y.
    springs : mapping of int to Expr
        Stiffness of the springs to the neighbours at each distance.
    decay : callable
        Function by which friction decreases with the speed divided by ``v_0``.
    parameters : mapping of Symbol to Rational
        The numbers of Eq. (7).
    """

    inertia: sp.Expr = m
    damping: sp.Expr = d
    stiffness: sp.Expr = k
    springs: Mapping[int, sp.Expr] = field(default_factory=lambda: {1: eta_c})
    decay: Callable[[sp.Expr], sp.Expr] = exponential
    parameters: Mapping[sp.Symbol, sp.Expr] = field(default_factory=lambda: {
        mu_st: sp.Integer(1), mu_d: sp.Rational(1, 2), v_tilde_0: sp.Rational(1, 2),
        xi: sp.Rational(1, 20)})  # fmt: skip

    def newton(self) -> sp.Eq:
        """Return Newton's law for an interior site."""
        own = y(n, t)
        left = self.inertia * own.diff(t, 2) + self.damping * own.diff(t) + self.stiffness * own
        for distance, spring in self.springs.items():
            left += spring * (2 * own - y(n + distance, t) - y(n - distance, t))
        return equation(left, F)


PAPER = FrictionModel()
"""The chain of the paper."""
