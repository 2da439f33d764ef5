"""Symbols of the multiple-scales calculation, in addition to those of the paper's model."""

from __future__ import annotations

import sympy as sp

from derivations.symbols import t_hat, tau

Y = sp.Function("Y", real=True)(t_hat, tau)
"""y_0 as a function of the fast and the slow time."""
Y_0 = sp.Function("Y_0", real=True)(t_hat, tau)
Y_1 = sp.Function("Y_1", real=True)(t_hat, tau)
A = sp.Function("A")(tau)
R_slow = sp.Function("R", positive=True)(tau)
theta_slow = sp.Function("theta", real=True)(tau)
