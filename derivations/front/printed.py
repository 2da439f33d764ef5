"""Equations (44)-(54) as printed."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.equations import equation
from derivations.algebra.sums import SumOver
from derivations.chain import PAPER
from derivations.front import readings
from derivations.front.checks_profile import ProfileChecks
from derivations.front.symbols import (
    F,
    L,
    L_k,
    M_minus,
    M_plus,
    eta,
    k,
    phi,
    phi_s,
    phi_us,
    speed,
    v,
    zeta,
)
from derivations.printing import EquationReading, EquationVerdict, PrintedEquation
from derivations.symbols import a, b, c, epsilon, i, n, t

_half = sp.Rational(1, 2)
_own, _left, _right = phi(n, t), phi(n - 1, t), phi(n + 1, t)
_springs = i * epsilon * c / 2 * (2 * _own - _left - _right)
_wave = sp.exp(i * k * zeta) / (k * L_k)
_total = SumOver(1 / (k * L_k), k, M_plus)
_root = sp.sqrt(1 - 8 * eta)
_checks = ProfileChecks(PAPER)


def _lines(left: sp.Expr, right: sp.Expr) -> sp.Eq:
    """Return (44) with the switch where one quantity passes another."""
    branches = sp.Piecewise(
        (_own, sp.Lt(left, right, evaluate=False)),
        (_own - phi_s, sp.Gt(left, right, evaluate=False)),
        evaluate=False,
    )
    return equation(_own.diff(t) - _springs, -_half * epsilon * branches)


def _force(argument: sp.Expr) -> sp.Eq:
    """Return (45) with the step function of a quantity."""
    return equation(F, -_half * epsilon * _own
                    + _half * epsilon * phi_s * sp.Heaviside(argument, _half))  # fmt: skip


def _passage(left: sp.Expr, right: sp.Expr) -> sp.Basic:
    return sp.Equivalent(sp.Gt(left, right, evaluate=False), sp.Lt(zeta, 0, evaluate=False),
                         evaluate=False)  # fmt: skip


def _set(side: type[sp.Rel]) -> sp.ConditionSet:
    condition = sp.And(equation(L(k), 0), side(sp.im(k), 0, evaluate=False), evaluate=False)
    return sp.ConditionSet(k, condition, sp.S.Complexes)


_place = n - speed * t
_slope = equation(L_k, -1 / (2 * k) + 2 * i * c / k * sp.sin(k / 2) ** 2 - i * c * sp.sin(k))
_threshold = equation(_total, -2 * phi_us / phi_s)
_modulus = ((r"\varphi_n < \varphi_{us}", r"|\varphi_n| < |\varphi_{us}|"),
            (r"\varphi_n > \varphi_{us}", r"|\varphi_n| > |\varphi_{us}|"))  # fmt: skip

EQUATIONS = (
    PrintedEquation(
        number=44,
        latex=r"\dot{\varphi}_n - \frac{i\varepsilon c}{2}\left(2\varphi_n - \varphi_{n-1} - "
              r"\varphi_{n+1}\right) = -\frac{1}{2}\varepsilon \begin{cases} \varphi_n, & "
              r"\varphi_n < \varphi_{us} \\ \varphi_n - \varphi_s, & \varphi_n > \varphi_{us} "
              r"\end{cases}",
        expression=_lines(_own, phi_us), verdict=EquationVerdict.AMBIGUOUS,
        note="An inequality between complex numbers has no meaning. The model also fixes the phase "
             "of φ_s, which (43) leaves free, and gives the cycle the decay rate of the rest "
             "state; in (43) it is s √(a^2 - 8 b) / 4 with s = |φ_s|^2.",
        affects="(45), (47), (53), (54): the reading decides which kinetic relation follows.",
        readings=(
            EquationReading(
                "|φ_n| against |φ_us|", _lines(sp.Abs(_own), sp.Abs(phi_us)), True,
                "both equilibria for every phase of the cycle; leads to |Sum| = 2 r, (54)"),
            EquationReading(
                "real parts", _lines(sp.re(_own), sp.re(phi_us)), False,
                "a cycle of the wrong phase counts as at rest; would lead to a relation for "
                "Re Sum instead of (54)"),
        ),
        amendments=_modulus,
    ),
    PrintedEquation(
        number=45,
        latex=r"F = -\frac{1}{2}\varepsilon\varphi_n + \frac{1}{2}\varepsilon\varphi_s \theta\left("
              r"\varphi_n - \varphi_{us}\right)",
        expression=_force(_own - phi_us), verdict=EquationVerdict.AMBIGUOUS,
        note="The right side of (44) with a step function: the same, and with the same comparison "
             "of complex numbers. The letter F is the friction force in model I.",
        affects="(48).",
        readings=(
            EquationReading(
                "step at |φ_n| = |φ_us|", _force(sp.Abs(_own) - sp.Abs(phi_us)), True,
                "identical with (44) read by modulus"),
            EquationReading("step in the real part", _force(sp.re(_own - phi_us)), False,
                            "differs from (44) read by modulus"),
        ),
        amendments=((r"\varphi_n - \varphi_{us}", r"|\varphi_n| - |\varphi_{us}|"),),
    ),
    PrintedEquation(
        number=46,
        latex=r"\begin{aligned} \varphi_n &= \varphi(n - vt) = \varphi(\zeta) \\ \varphi_{n+1} &= "
              r"\varphi(n - vt + 1) = \varphi(\zeta + 1) \\ \varphi_{n-1} &= \varphi(n - vt - 1) = "
              r"\varphi(\zeta - 1) \end{aligned}",
        expression=sp.Tuple(
            equation(_own, phi(_place)), equation(phi(_place), phi(zeta)),
            equation(_right, phi(_place + 1)), equation(phi(_place + 1), phi(zeta + 1)),
            equation(_left, phi(_place - 1)), equation(phi(_place - 1), phi(zeta - 1))),
        verdict=EquationVerdict.DEFINITION,
        note="A travelling wave with a phase that does not rotate; the fixed phase of φ_s "
             "in (44) forces that.",
    ),
    PrintedEquation(
        number=47,
        latex=r"\varphi_n > \varphi_{us} \Leftrightarrow \zeta < 0",
        expression=_passage(_own, phi_us), verdict=EquationVerdict.ASSUMPTION,
        note="To be checked for each solution. Read by modulus, as (44). It holds for the front of "
             "Fig. 16.",
        affects="(48)-(54); fronts that violate it must be discarded.",
        amendments=((r"\varphi_n > \varphi_{us}", r"|\varphi_n| > |\varphi_{us}|"),),
    ),
    PrintedEquation(
        number=48,
        latex=r"-\hat{v}\dot{\varphi}(\zeta) - \frac{ic}{2}\left[2\varphi(\zeta) - \varphi(\zeta + "
              r"1) - \varphi(\zeta - 1)\right] + \frac{1}{2}\varphi = \frac{1}{2}\varphi_s "
              r"\theta(-\zeta)",
        expression=equation(
            -v * phi(zeta).diff(zeta)
            - i * c / 2 * (2 * phi(zeta) - phi(zeta + 1) - phi(zeta - 1)) + phi(zeta) / 2,
            phi_s * sp.Heaviside(-zeta, _half) / 2),
        verdict=EquationVerdict.HOLDS,
        note="With v = ε v̂; the dot is now d/dζ.",
    ),
    PrintedEquation(
        number=49,
        latex=r"\varphi(\zeta) = \begin{cases} \varphi_s + \dfrac{1}{2}\varphi_s \sum_{k \in M^-} "
              r"\dfrac{e^{ik\zeta}}{kL_k} & \zeta < 0 \\ -\dfrac{1}{2}\varphi_s \sum_{k \in M^+} "
              r"\dfrac{e^{ik\zeta}}{kL_k} & \zeta > 0 \end{cases}",
        expression=equation(phi(zeta), sp.Piecewise(
            (phi_s + _half * phi_s * SumOver(_wave, k, M_minus), zeta < 0),
            (-_half * phi_s * SumOver(_wave, k, M_plus), zeta > 0))),
        verdict=EquationVerdict.HOLDS,
        note="Both signs, for v > 0. The series converges only like 1/N at ζ = 0.",
    ),
    PrintedEquation(
        number=50,
        latex=r"L(k) = -i\hat{v}k - 2ic\sin^2\dfrac{k}{2} + \dfrac{1}{2}",
        expression=equation(L(k), -i * v * k - 2 * i * c * sp.sin(k / 2) ** 2 + _half),
        verdict=EquationVerdict.HOLDS, note="The symbol of the left side of (48).",
    ),
    PrintedEquation(
        number=51,
        latex=r"L_k(k) = -\dfrac{1}{2k} + \dfrac{2ic}{k}\sin^2\dfrac{k}{2} - ic\sin k",
        expression=_slope, verdict=EquationVerdict.AMBIGUOUS,
        note="Called the derivative of L, it is so only where L = 0.",
        affects="Nothing: (49), (53) and (54) use it on the roots only.",
        readings=(
            EquationReading("for every k", _slope, False, "the derivative is -i v̂ - i c sin k",
                            _checks.slope),
            EquationReading("on the roots of L", _slope, True,
                            "the same number there, with v̂ eliminated", _checks.slope_on_roots),
        ),
    ),
    PrintedEquation(
        number=52,
        latex=r"\begin{aligned} M^+ &= \{k : L(k) = 0,\ \mathrm{Im}\,k > 0\} \\ M^- &= \{k : L(k) "
              r"= 0,\ \mathrm{Im}\,k < 0\} \end{aligned}",
        expression=sp.Tuple(equation(M_plus, _set(sp.Gt)), equation(M_minus, _set(sp.Lt))),
        verdict=EquationVerdict.DEFINITION,
        note="No root is real and none is double, so the two sets are all roots.",
    ),
    PrintedEquation(
        number=53,
        latex=r"\sum_{k \in M^+} \dfrac{1}{kL_k} = -\dfrac{2\varphi_{us}}{\varphi_s}",
        expression=_threshold, verdict=EquationVerdict.AMBIGUOUS,
        note="Sign and factor are right. But it is one complex equation, two real ones, for the "
             "single unknown v̂.",
        affects="(54) and Figs. 16-18.",
        readings=(
            EquationReading("the phase of φ_us is free and comes out of (53)", _threshold, True,
                            "the modulus alone fixes v̂: (54)"),
            EquationReading(
                "φ_us / φ_s is real and positive, as both on one line in (44)", _threshold,
                False, "no solution in general: the sum is not real and negative on (54)",
                readings.real_ratio),
        ),
    ),
    PrintedEquation(
        number=54,
        latex=r"\left|\sum_{k \in M^+} \dfrac{1}{kL_k}\right| = \dfrac{2|\varphi_{us}|}"
              r"{|\varphi_s|} = 2\sqrt{\dfrac{1-\sqrt{1-8\eta}}{1+\sqrt{1-8\eta}}},\quad \eta "
              r"\equiv \dfrac{b}{a^2}",
        expression=sp.Tuple(
            equation(sp.Abs(_total), 2 * sp.Abs(phi_us) / sp.Abs(phi_s)),
            equation(2 * sp.Abs(phi_us) / sp.Abs(phi_s), 2 * sp.sqrt((1 - _root) / (1 + _root))),
            equation(eta, b / a**2)),
        verdict=EquationVerdict.HOLDS,
        note="By modulus, for η < 1/8. Several v̂ can solve it; (47) selects one.",
    ),
)  # fmt: skip
