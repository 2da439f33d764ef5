"""Symbols of the piecewise-linear front, and a sum over the roots of its dispersion relation."""

from __future__ import annotations

from typing import Any

import sympy as sp

c, epsilon, eta, a, b = sp.symbols("c epsilon eta a b", positive=True)
v = sp.Symbol(r"\hat{v}", positive=True)
speed = sp.Symbol("v", positive=True)
k = sp.Symbol("k")
zeta, t, x, y = sp.symbols("zeta t x y", real=True)
n = sp.Symbol("n", integer=True)
phi_s, phi_us = sp.symbols(r"\varphi_s \varphi_us")
phi = sp.Function(r"\varphi")
L, L_k = sp.symbols("L L_k")
M_plus, M_minus = sp.symbols("M^+ M^-")
ratio = sp.Symbol("r", positive=True)
F = sp.Symbol("F")

DISPERSION = sp.Rational(1, 2) - sp.I * v * k - 2 * sp.I * c * sp.sin(k / 2) ** 2
"""L(k) of Eq. (50)."""
SLOPE = -sp.I * v - sp.I * c * sp.sin(k)
"""Its derivative with respect to k, for every k."""
ON_SITE = sp.Rational(1, 2) - sp.I * c * (1 - sp.cos(k))
"""A(k) = L(k) + i v k, even in k."""


class SumOver(sp.Expr):  # type: ignore[misc]
    """``sum of term over k in roots``; args are the term, k, and the name of the set."""

    def __new__(cls, term: Any, variable: Any, roots: Any) -> SumOver:
        """Hold the three parts unevaluated."""
        made = sp.Expr.__new__(cls, sp.sympify(term), variable, roots)
        return made  # type: ignore[no-any-return]

    @property
    def free_symbols(self) -> set[sp.Basic]:
        """Without the summation variable."""
        return set(self.args[0].free_symbols - {self.args[1]} | {self.args[2]})

    def _latex(self, printer: Any) -> str:
        term, variable, roots = (printer._print(part) for part in self.args)
        return rf"\sum_{{{variable} \in {roots}}} {term}"

    def _sympystr(self, printer: Any) -> str:
        term, variable, roots = (printer._print(part) for part in self.args)
        return f"Sum({term}, {variable} in {roots})"


def over_roots(numerator: sp.Expr | int, roots: sp.Symbol) -> SumOver:
    """Return the sum of ``numerator / (k L_k)`` over a set of roots."""
    return SumOver(numerator / (k * L_k), k, roots)
