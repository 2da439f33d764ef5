"""The paper's symbols for model II, shared by its derivations."""

from __future__ import annotations

import sympy as sp

a, b, c = sp.symbols("a b c", positive=True)
epsilon = sp.Symbol("epsilon", positive=True)
alpha_0, R = sp.symbols("alpha_0 R", positive=True)
k_1, k_2, theta = sp.symbols("k_1 k_2 theta", real=True)
omega = sp.Symbol("omega", positive=True)
omega_1, omega_2, delta = sp.symbols("omega_1 omega_2 delta", real=True)
t, tau = sp.symbols("t tau", real=True)
t_hat = sp.Symbol("that", real=True)
n = sp.Symbol("n", integer=True)
i = sp.I

y = sp.Function("y", real=True)
"""Displacement; ``y(n, t)`` is that of site n at time t."""
