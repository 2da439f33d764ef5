"""Equations (1)-(7) as printed."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.equations import equation
from derivations.friction.symbols import (
    F_N,
    F,
    F_tilde,
    c,
    d,
    eta_c,
    k,
    m,
    mu,
    mu_d,
    mu_st,
    n,
    omega_n,
    t,
    tau,
    v_0,
    v_rel,
    v_tilde_0,
    v_tilde_rel,
    xi,
    y,
    y_0,
    y_tilde,
)
from derivations.printing import EquationReading, EquationVerdict, PrintedEquation

_own, _scaled = y(n, t), y_tilde(n, tau)


def _force(argument: sp.Expr, bound: type[sp.Rel]) -> sp.Tuple:
    """Return (6) with the friction coefficient of a velocity, and a strict or a closed bound."""
    return sp.Tuple(
        equation(F_tilde, -sp.sign(v_tilde_rel) * mu(argument)),
        sp.Ne(v_tilde_rel, 0, evaluate=False),
        bound(sp.Abs(F_tilde), mu_st, evaluate=False),
        equation(v_tilde_rel, 0),
    )


EQUATIONS = (
    PrintedEquation(
        number=1,
        latex=r"my''_n + dy'_n + ky_n + \eta_c(2y_n - y_{n+1} - y_{n-1}) = F(v_{rel,n})",
        expression=equation(
            m * _own.diff(t, 2) + d * _own.diff(t) + k * _own
            + eta_c * (2 * _own - y(n + 1, t) - y(n - 1, t)), F),
        verdict=EquationVerdict.DEFINITION,
        note="The model, for a site with two neighbours. The text asks for free ends: sites 1 and "
             "N_dof then have one spring each; leaving out only the missing y would hold the ends. "
             "The text calls the coupling spring c here; c is the ratio of (4).",
    ),
    PrintedEquation(
        number=2,
        latex=r"\mu(v_{rel}) = \mu_{st} + (\mu_{st} - \mu_d)e^{\left(-\frac{|v_{rel}|}{v_0}"
              r"\right)}",
        expression=equation(mu(v_rel), mu_st + (mu_st - mu_d) * sp.exp(-sp.Abs(v_rel) / v_0)),
        verdict=EquationVerdict.MISPRINT,
        note="The first μ_st must be μ_d. As printed μ(0) = 2 μ_st - μ_d and μ tends to "
             "μ_st; the text below states μ(0) = μ_st and μ(∞) = μ_d.",
        affects="(3), (6) and all of model I use μ: the steady state, its stability and Figs. "
                "2-6. With the printed sign the slip force at rest would also exceed the stick "
                "limit of (3).",
        amendments=((r"= \mu_{st}", r"= \mu_d"),),
    ),
    PrintedEquation(
        number=3,
        latex=r"\begin{cases} F = -\text{sgn}(v_{rel}) F_N \mu(v_{rel}) & v_{rel} \neq 0 \\ "
              r"|F| < \mu_{st} F_N & v_{rel} = 0 \end{cases}",
        expression=sp.Tuple(
            equation(F, -sp.sign(v_rel) * F_N * mu(v_rel)), sp.Ne(v_rel, 0, evaluate=False),
            sp.Lt(sp.Abs(F), mu_st * F_N, evaluate=False), equation(v_rel, 0)),
        verdict=EquationVerdict.MISPRINT,
        note="The bound must include equality: at the instant of breaking away |F| = μ_st F_N, "
             "the value at which slip begins, and as printed there is no law for it. μ is that "
             "of the corrected (2).",
        affects="(6). Simulations are not affected: the instant has no duration.",
        amendments=((r"|F| <", r"|F| \leq"),),
    ),
    PrintedEquation(
        number=4,
        latex=r"\omega_n = \sqrt{\frac{k}{m}}, \quad y_0 = \frac{F_N}{k}, \quad "
              r"c = \frac{\eta_c}{k}, \quad \xi = \frac{d}{2\sqrt{dm}}, \quad \tau = \omega_n t",
        expression=sp.Tuple(
            equation(omega_n, sp.sqrt(k / m)), equation(y_0, F_N / k), equation(c, eta_c / k),
            equation(xi, d / (2 * sp.sqrt(d * m))), equation(tau, omega_n * t)),
        verdict=EquationVerdict.MISPRINT,
        note="ξ must be d / (2 √(k m)): only then is 2 ξ the coefficient in (5); as printed "
             "it is not even dimensionless.",
        affects="(5) and (7): a dimensional damper read off ξ = 0.05 would be wrong. Nothing in "
                "the dimensionless equations changes. The text below (5) writes x_0 for y_0.",
        amendments=((r"\sqrt{dm}", r"\sqrt{km}"),),
    ),
    PrintedEquation(
        number=5,
        latex=r"\ddot{\tilde{y}}_n + 2\xi \dot{\tilde{y}}_n + \tilde{y}_n + c(2\tilde{y}_n - "
              r"\tilde{y}_{n+1} - \tilde{y}_{n-1}) = \tilde{F}(\tilde{v}_{rel,n})",
        expression=equation(
            _scaled.diff(tau, 2) + 2 * xi * _scaled.diff(tau) + _scaled
            + c * (2 * _scaled - y_tilde(n + 1, tau) - y_tilde(n - 1, tau)), F_tilde),
        verdict=EquationVerdict.HOLDS,
        note="Follows from (1) with the corrected ξ and with x_0 below it read as y_0. Free ends "
             "as under (1).",
    ),
    PrintedEquation(
        number=6,
        latex=r"\begin{cases} \tilde{F} = -\text{sgn}(\tilde{v}_{rel}) \mu(\tilde{v}_{rel}) & "
              r"\tilde{v}_{rel} \neq 0 \\ |\tilde{F}| < \mu_{st} & \tilde{v}_{rel} = 0 "
              r"\end{cases}",
        expression=_force(v_tilde_rel, sp.Lt),
        verdict=EquationVerdict.AMBIGUOUS,
        note="μ of (2) contains v_0; at the scaled velocity it must contain the scaled v_0. The "
             "bound must include equality, as in (3).",
        affects="All numbers of model I: they use the scaled v_0 = 0.5 of (7).",
        readings=(
            EquationReading(
                "the same function μ, with the dimensional v_0", _force(v_tilde_rel, sp.Le),
                False, "right only if ω_n y_0 = 1"),
            EquationReading("μ at the velocity ω_n y_0 times the scaled one, that is with "
                            "v_0 / (ω_n y_0) in the place of v_0",
                            _force(omega_n * y_0 * v_tilde_rel, sp.Le), True,
                            "(6) is (3) divided by F_N; (7) names this scaled velocity"),
        ),
        amendments=((r"\mu(\tilde{v}_{rel})", r"\mu(\omega_n y_0 \tilde{v}_{rel})"),
                    (r"|\tilde{F}| <", r"|\tilde{F}| \leq")),
    ),
    PrintedEquation(
        number=7,
        latex=r"\mu_{st}=1; \quad \mu_d=0.5; \quad \tilde{v}_0=0.5; \quad \xi=0.05;",
        expression=sp.Tuple(
            equation(mu_st, 1), equation(mu_d, sp.Rational(1, 2)),
            equation(v_tilde_0, sp.Rational(1, 2)), equation(xi, sp.Rational(1, 20))),
        verdict=EquationVerdict.DEFINITION,
        note="The parameters of model I. With them steady sliding is stable from v_d = 0.5 ln 10 = "
             "1.151 on, so 1.25 is in the bistable range, as Fig. 2 says.",
    ),
)  # fmt: skip
