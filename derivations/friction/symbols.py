"""Symbols of model I, and their notation in the paper."""

from __future__ import annotations

import sympy as sp

from derivations.transcription.latex_reader import Notation

n = sp.Symbol("n", integer=True)
t, tau = sp.symbols("t tau", real=True)
m, d, k, eta_c, F_N, v_0, omega_n, y_0 = sp.symbols(
    "m d k eta_c F_N v_0 omega_n y_0", positive=True
)
c, xi, mu_st, mu_d, v_tilde_0 = sp.symbols(r"c xi mu_st mu_d \tilde{v}_0", positive=True)
v_rel, v_tilde_rel = sp.symbols(r"v_rel \tilde{v}_{rel}", real=True)
v_tilde_d = sp.Symbol(r"\tilde{v}_d", positive=True)
v_hopf = sp.Symbol(r"\tilde{v}_H", positive=True)
F, F_tilde, y_star = sp.symbols(r"F \tilde{F} \tilde{y}_*", real=True)
mu = sp.Function("mu", positive=True)
mu_far, mu_fall = sp.symbols("mu_infinity mu_1", real=True)
y = sp.Function("y", real=True)
"""Displacement ``y(n, t)``."""
y_tilde = sp.Function(r"\tilde{y}", real=True)
"""Scaled displacement ``y_tilde(n, tau)``."""
z = sp.Function("z", real=True)
"""Deviation from steady sliding, ``z(n, tau)``."""
q = sp.Symbol("q", real=True)
rate = sp.Symbol("lambda")
R = sp.Symbol("R", positive=True)
s = sp.Symbol("s", real=True)

_SITES = {"n": n, "n+1": n + 1, "n-1": n - 1}
NOTATION = Notation(
    names={
        "m": m, "d": d, "k": k, "c": c, "t": t, r"\tau": tau, r"\xi": xi, r"\eta_{c}": eta_c,
        r"\omega_{n}": omega_n, "y_{0}": y_0, "F_{N}": F_N, "v_{0}": v_0,
        r"\mu_{st}": mu_st, r"\mu_{d}": mu_d, "v_{rel}": v_rel,
        r"\tilde{v}_{rel}": v_tilde_rel, r"\tilde{v}_{0}": v_tilde_0, "F": F, r"\tilde{F}": F_tilde,
        "v_{rel,n}": v_rel, r"\tilde{v}_{rel,n}": v_tilde_rel,
        **{f"y_{{{name}}}": y(place, t) for name, place in _SITES.items()},
        "y'_{n}": y(n, t).diff(t), "y''_{n}": y(n, t).diff(t, 2),
        **{rf"\tilde{{y}}_{{{name}}}": y_tilde(place, tau) for name, place in _SITES.items()},
        r"\dot{\tilde{y}}_{n}": y_tilde(n, tau).diff(tau),
        r"\ddot{\tilde{y}}_{n}": y_tilde(n, tau).diff(tau, 2),
    },
    functions={r"\mu": mu, "F": lambda _: F, r"\tilde{F}": lambda _: F_tilde},
)  # fmt: skip
"""The force of (1) and (5) is that of (3) and (6) at the site's own velocity: one symbol."""
