"""Symbols of the multiple-scales calculation, beside those of the paper's model."""

from __future__ import annotations

import sympy as sp

from derivations.symbols import t_hat, tau

Y = sp.Function("y_0", real=True)(t_hat, tau)
Y0 = sp.Function("y_0^{(0)}", real=True)(t_hat, tau)
Y1 = sp.Function("y_0^{(1)}", real=True)(t_hat, tau)
A, A_rate = sp.symbols("A A'")
R_rate, theta_rate = sp.symbols("R' theta'", real=True)
loss = sp.Symbol("E", real=True)
