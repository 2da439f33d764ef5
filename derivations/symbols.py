"""The paper's symbols for model II."""

from __future__ import annotations

import sympy as sp

a, b, c = sp.symbols("a b c", positive=True)
epsilon = sp.Symbol("epsilon", positive=True)
alpha_0, R = sp.symbols("alpha_0 R", positive=True)
k_1, k_2, theta = sp.symbols("k_1 k_2 theta", real=True)
omega = sp.Symbol("omega", positive=True)
omega_1, omega_2, delta = sp.symbols("omega_1 omega_2 delta", real=True)
t, t_hat, tau = sp.symbols(r"t \hat{t} tau", real=True)
n = sp.Symbol("n", integer=True)
i = sp.I


def damping_factor(y: sp.Expr) -> sp.Expr:
    """``1 - a y^2 + b y^4``, what multiplies ``eps y'`` in Eq. (8)."""
    return 1 - a * y**2 + b * y**4


def site(offset: int = 0, name: str = "y", index: str = "n") -> sp.Expr:
    """``y_{n+offset}(t)``; with ``index=""`` the site ``offset`` itself, as in ``y_0(t)``."""
    if index:
        place = index if offset == 0 else f"{{{index}{offset:+d}}}"
    else:
        place = str(offset) if offset >= 0 else f"{{{offset}}}"
    return sp.Function(f"{name}_{place}", real=True)(t)
