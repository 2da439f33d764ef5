"""Equations (1)-(7) as printed."""

from __future__ import annotations

import sympy as sp

from derivations.derivation import equation
from derivations.friction import (
    F_N,
    F,
    F_tilde,
    X,
    Y,
    c,
    d,
    eta_c,
    k,
    m,
    mu,
    mu_d,
    mu_st,
    omega_n,
    t,
    tau,
    v_0,
    v_rel,
    v_tilde_0,
    v_tilde_rel,
    xi,
    y_0,
)
from derivations.printed import Printed, Reading, Verdict


def _friction(speed: sp.Symbol, scale: sp.Symbol) -> sp.Expr:
    """Mu as its two limits require; (3) and (6) only refer to it."""
    return mu_d + (mu_st - mu_d) * sp.exp(-sp.Abs(speed) / scale)


def _scaled(scale: sp.Symbol, *, closed: bool = False) -> sp.Tuple:
    law = -sp.sign(v_tilde_rel) * _friction(v_tilde_rel, scale)
    bound = sp.Le if closed else sp.Lt
    return sp.Tuple(equation(F_tilde, law), bound(sp.Abs(F_tilde), mu_st))


EQUATIONS = (
    Printed(
        1, r"my''_n + dy'_n + ky_n + \eta_c(2y_n - y_{n+1} - y_{n-1}) = F(v_{rel,n})",
        equation(m * Y[1].diff(t, 2) + d * Y[1].diff(t) + k * Y[1]
                 + eta_c * (2 * Y[1] - Y[2] - Y[0]), F),
        Verdict.DEFINITION,
        "The model, for a site with two neighbours. The text asks for free ends: sites 1 and N_dof "
        "then have one spring each; leaving out only the missing y would hold the ends. The text "
        "calls the coupling spring c here; c is the ratio of (4).",
    ),
    Printed(
        2, r"\mu(v_{rel}) = \mu_{st} + (\mu_{st} - \mu_d)e^{-|v_{rel}|/v_0}",
        equation(mu, mu_st + (mu_st - mu_d) * sp.exp(-sp.Abs(v_rel) / v_0)),
        Verdict.MISPRINT,
        "The first mu_st must be mu_d. As printed mu(0) = 2 mu_st - mu_d and mu tends to mu_st; "
        "the text below states mu(0) = mu_st and mu(infinity) = mu_d.",
        "(3), (6) and all of model I use mu: the steady state, its stability and Figs. 2-6. With "
        "the printed sign the slip force at rest would also exceed the stick limit of (3).",
    ),
    Printed(
        3, r"F = -\mathrm{sgn}(v_{rel}) F_N \mu(v_{rel}),\ v_{rel} \neq 0;\quad "
           r"|F| < \mu_{st} F_N,\ v_{rel} = 0",
        sp.Tuple(equation(F, -sp.sign(v_rel) * F_N * _friction(v_rel, v_0)),
                 sp.Lt(sp.Abs(F), mu_st * F_N)),
        Verdict.MISPRINT,
        "The bound must include equality: at the instant of breaking away |F| = mu_st F_N, the "
        "value from which slip goes on, and as printed there is no law for it. mu is that of the "
        "corrected (2).",
        "(6). In a run nothing: the instant has no duration.",
    ),
    Printed(
        4, r"\omega_n = \sqrt{k/m},\ y_0 = F_N/k,\ c = \eta_c/k,\ \xi = \frac{d}{2\sqrt{dm}},\ "
           r"\tau = \omega_n t",
        sp.Tuple(equation(omega_n, sp.sqrt(k / m)), equation(y_0, F_N / k),
                 equation(c, eta_c / k), equation(xi, d / (2 * sp.sqrt(d * m))),
                 equation(tau, omega_n * t)),
        Verdict.MISPRINT,
        "xi must be d / (2 sqrt(k m)): only then is 2 xi the coefficient in (5); as printed it is "
        "not even dimensionless.",
        "(5) and (7): a dimensional damper read off xi = 0.05 would be wrong. Nothing in the "
        "dimensionless equations changes. The text below (5) writes x_0 for y_0.",
    ),
    Printed(
        5, r"\ddot{\tilde y}_n + 2\xi\dot{\tilde y}_n + \tilde y_n + c(2\tilde y_n - "
           r"\tilde y_{n+1} - \tilde y_{n-1}) = \tilde F(\tilde v_{rel,n})",
        equation(X[1].diff(tau, 2) + 2 * xi * X[1].diff(tau) + X[1]
                 + c * (2 * X[1] - X[2] - X[0]), F_tilde),
        Verdict.HOLDS,
        "Follows from (1) with the corrected xi and with x_0 below it read as y_0. Free ends as "
        "under (1).",
    ),
    Printed(
        6, r"\tilde F = -\mathrm{sgn}(\tilde v_{rel})\mu(\tilde v_{rel}),\ \tilde v_{rel}\neq 0;"
           r"\quad |\tilde F| < \mu_{st},\ \tilde v_{rel} = 0",
        _scaled(v_0),
        Verdict.AMBIGUOUS,
        "mu of (2) contains v_0; at the scaled velocity it must contain the scaled v_0. The bound "
        "must include equality, as in (3).",
        "All numbers of model I: they use the scaled v_0 = 0.5 of (7).",
        (
            Reading("the same function mu, with the dimensional v_0", _scaled(v_0, closed=True),
                    False,
                    "right only if omega_n y_0 = 1"),
            Reading("mu with v_0 / (omega_n y_0) in the place of v_0",
                    _scaled(v_tilde_0, closed=True), True,
                    "(6) is (3) divided by F_N; (7) names this scaled velocity"),
        ),
    ),
    Printed(
        7, r"\mu_{st}=1;\ \mu_d=0.5;\ \tilde v_0=0.5;\ \xi=0.05",
        sp.Tuple(equation(mu_st, 1), equation(mu_d, sp.Rational(1, 2)),
                 equation(v_tilde_0, sp.Rational(1, 2)), equation(xi, sp.Rational(1, 20))),
        Verdict.DEFINITION,
        "The parameters of model I. With them steady sliding is stable from v_d = 0.5 ln 10 = "
        "1.151 on, so 1.25 is in the bistable range, as Fig. 2 says.",
    ),
)  # fmt: skip
