"""Symbols of the second order."""

from __future__ import annotations

import sympy as sp

rate = sp.Symbol("A'")
phi_rate, fundamental = sp.symbols(r"\varphi' A_1")
square = sp.Symbol("s", positive=True)
y_next, size = sp.symbols("y^{(1)} |A|")
turn = sp.Symbol("E")
r_n, r_left, r_right, r_far_left, r_far_right = sp.symbols(
    "r_n r_{n-1} r_{n+1} r_{n-2} r_{n+2}", real=True
)
r_rate = sp.Symbol("rho_n'")
