"""Equations (43)-(54) as printed."""

from __future__ import annotations

import sympy as sp

from derivations import piecewise_front_evidence as seen
from derivations.averaging_symbols import phi as site_phi
from derivations.averaging_symbols import phi_rate
from derivations.derivation import equation
from derivations.front_readings import real_ratio
from derivations.front_symbols import (
    F,
    L,
    L_k,
    M_minus,
    M_plus,
    SumOver,
    a,
    b,
    c,
    epsilon,
    eta,
    k,
    n,
    phi,
    phi_s,
    phi_us,
    speed,
    t,
    v,
    zeta,
)
from derivations.printed import Printed, Reading, Verdict

i = sp.I
_own, _half = site_phi[0], sp.Rational(1, 2)
_springs = i * epsilon * c / 2 * (2 * _own - site_phi[-1] - site_phi[1])
_wave = sp.exp(i * k * zeta) / (k * L_k)
_total = SumOver(1 / (k * L_k), k, M_plus)
_dispersion = -i * v * k - 2 * i * c * sp.sin(k / 2) ** 2 + _half


def _lines(left: sp.Expr, right: sp.Expr) -> sp.Eq:
    branches = sp.Piecewise((_own, sp.Lt(left, right)), (_own - phi_s, sp.Gt(left, right)))
    return equation(phi_rate - _springs, -_half * epsilon * branches)


def _force(argument: sp.Expr) -> sp.Eq:
    return equation(F, -_half * epsilon * _own + _half * epsilon * phi_s
                    * sp.Heaviside(argument, _half))  # fmt: skip


def _set(sign: int) -> sp.Contains:
    side = sp.im(k) > 0 if sign > 0 else sp.im(k) < 0
    members = sp.ConditionSet(k, sp.And(sp.Eq(_dispersion, 0), side), sp.S.Complexes)
    return sp.Contains(k, members, evaluate=False)


_slope = equation(L_k, -1 / (2 * k) + 2 * i * c / k * sp.sin(k / 2) ** 2 - i * c * sp.sin(k))
_threshold = equation(_total, -2 * phi_us / phi_s)
_root = sp.sqrt(1 - 8 * eta)

EQUATIONS = (
    Printed(
        43, r"\dot\varphi_n - \frac{i\varepsilon c}{2}(2\varphi_n - \varphi_{n-1} - \varphi_{n+1}) "
            r"+ \varepsilon\frac{\varphi_n}{2}\left(1 - a\frac{|\varphi_n|^2}{4} + "
            r"b\frac{|\varphi_n|^4}{8}\right) = 0",
        equation(phi_rate - _springs + epsilon * _own / 2
                 * (1 - a * sp.Abs(_own) ** 2 / 4 + b * sp.Abs(_own) ** 4 / 8), 0),
        Verdict.HOLDS, "(34) at omega = 1; another omega only turns the frame.",
    ),
    Printed(
        44, r"\dot\varphi_n - \frac{i\varepsilon c}{2}(2\varphi_n - \varphi_{n-1} - \varphi_{n+1}) "
            r"= -\frac12\varepsilon\begin{cases}\varphi_n, & \varphi_n < \varphi_{us} \\ "
            r"\varphi_n - \varphi_s, & \varphi_n > \varphi_{us}\end{cases}",
        _lines(_own, phi_us), Verdict.AMBIGUOUS,
        "An inequality between complex numbers has no meaning. The model also fixes the phase of "
        "phi_s, which (43) leaves free, and gives the cycle the decay rate of the rest state; in "
        "(43) it is s sqrt(a^2 - 8 b) / 4 with s = |phi_s|^2.",
        "(45), (47), (53), (54): the reading decides which kinetic relation follows.",
        (
            Reading("|phi_n| against |phi_us|", _lines(sp.Abs(_own), sp.Abs(phi_us)), True,
                    "both equilibria for every phase of the cycle; leads to |Sum| = 2 r, (54)"),
            Reading("real parts", _lines(sp.re(_own), sp.re(phi_us)), False,
                    "a cycle of the wrong phase counts as at rest; would lead to a relation for "
                    "Re Sum instead of (54)"),
        ),
    ),
    Printed(
        45, r"F = -\frac12\varepsilon\varphi_n + \frac12\varepsilon\varphi_s\theta(\varphi_n - "
            r"\varphi_{us})",
        _force(_own - phi_us), Verdict.AMBIGUOUS,
        "The right side of (44) with a step function: the same, and with the same comparison of "
        "complex numbers. The letter F is the friction force in model I.",
        "(48).",
        (
            Reading("step at |phi_n| = |phi_us|", _force(sp.Abs(_own) - sp.Abs(phi_us)), True,
                    "identical with (44) read by modulus"),
            Reading("step in the real part", _force(sp.re(_own - phi_us)), False,
                    "differs from (44) read by modulus"),
        ),
    ),
    Printed(
        46, r"\varphi_n = \varphi(n - vt) = \varphi(\zeta),\ \varphi_{n+1} = \varphi(\zeta + 1),\ "
            r"\varphi_{n-1} = \varphi(\zeta - 1)",
        sp.Tuple(equation(zeta, n - speed * t), equation(_own, phi(zeta)),
                 equation(site_phi[1], phi(zeta + 1)), equation(site_phi[-1], phi(zeta - 1))),
        Verdict.DEFINITION,
        "A travelling wave that does not turn its phase on the way; the fixed phase of phi_s in "
        "(44) forces that.",
    ),
    Printed(
        47, r"\varphi_n > \varphi_{us} \Leftrightarrow \zeta < 0",
        sp.Equivalent(sp.Abs(phi(zeta)) > sp.Abs(phi_us), zeta < 0), Verdict.ASSUMPTION,
        "To be checked for each solution. Read by modulus, as (44). It holds for the front of "
        "Fig. 16.",
        "(48)-(54); fronts that fail it are to be dropped.",
    ),
    Printed(
        48, r"-\hat v\dot\varphi(\zeta) - \frac{ic}{2}[2\varphi(\zeta) - \varphi(\zeta+1) - "
            r"\varphi(\zeta-1)] + \frac12\varphi = \frac12\varphi_s\theta(-\zeta)",
        equation(-v * phi(zeta).diff(zeta)
                 - i * c / 2 * (2 * phi(zeta) - phi(zeta + 1) - phi(zeta - 1)) + phi(zeta) / 2,
                 phi_s * sp.Heaviside(-zeta, _half) / 2),
        Verdict.HOLDS, "With v = eps v_hat; the dot is now d/dzeta.",
    ),
    Printed(
        49, r"\varphi(\zeta) = \varphi_s + \frac12\varphi_s\sum_{k\in M^-}\frac{e^{ik\zeta}}"
            r"{kL_k},\ \zeta < 0;\quad -\frac12\varphi_s\sum_{k\in M^+}\frac{e^{ik\zeta}}{kL_k},\ "
            r"\zeta > 0",
        equation(phi(zeta), sp.Piecewise(
            (phi_s + _half * phi_s * SumOver(_wave, k, M_minus), zeta < 0),
            (-_half * phi_s * SumOver(_wave, k, M_plus), zeta > 0))),
        Verdict.HOLDS, "Both signs, for v > 0. The series converges only like 1/N at zeta = 0.",
    ),
    Printed(
        50, r"L(k) = -i\hat vk - 2ic\sin^2\frac k2 + \frac12", equation(L, _dispersion),
        Verdict.HOLDS, "The symbol of the left side of (48).",
    ),
    Printed(
        51, r"L_k(k) = -\frac{1}{2k} + \frac{2ic}{k}\sin^2\frac k2 - ic\sin k", _slope,
        Verdict.AMBIGUOUS,
        "Called the derivative of L, it is so only where L = 0.",
        "Nothing: (49), (53) and (54) use it on the roots only.",
        (
            Reading("for every k", _slope, False, "the derivative is -i v_hat - i c sin k",
                    seen.slope),
            Reading("on the roots of L", _slope, True,
                    "the same number there, with v_hat eliminated", seen.slope_on_roots),
        ),
    ),
    Printed(
        52, r"M^\pm = \{k : L(k) = 0,\ \mathrm{Im}\,k \gtrless 0\}", sp.Tuple(_set(1), _set(-1)),
        Verdict.DEFINITION, "No root is real and none is double, so the two sets are all roots.",
    ),
    Printed(
        53, r"\sum_{k\in M^+}\frac{1}{kL_k} = -\frac{2\varphi_{us}}{\varphi_s}", _threshold,
        Verdict.AMBIGUOUS,
        "Sign and factor are right. But it is one complex equation, two real ones, for the single "
        "unknown v_hat.",
        "(54) and Figs. 16-18.",
        (
            Reading("the phase of phi_us is free and comes out of (53)", _threshold, True,
                    "the modulus alone fixes v_hat: (54)"),
            Reading("phi_us / phi_s is real and positive, as both on one line in (44)", _threshold,
                    False, "no solution in general: the sum is not real and negative on (54)",
                    real_ratio),
        ),
    ),
    Printed(
        54, r"\left|\sum_{k\in M^+}\frac{1}{kL_k}\right| = \frac{2|\varphi_{us}|}{|\varphi_s|} = "
            r"2\sqrt{\frac{1-\sqrt{1-8\eta}}{1+\sqrt{1-8\eta}}},\quad \eta\equiv\frac{b}{a^2}",
        sp.Tuple(equation(sp.Abs(_total), 2 * sp.Abs(phi_us) / sp.Abs(phi_s)),
                 equation(2 * sp.Abs(phi_us) / sp.Abs(phi_s),
                          2 * sp.sqrt((1 - _root) / (1 + _root))),
                 equation(eta, b / a**2)),
        Verdict.HOLDS,
        "By modulus, for eta < 1/8. Several v_hat can solve it; (47) chooses.",
    ),
)  # fmt: skip
