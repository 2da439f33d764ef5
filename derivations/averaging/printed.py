"""Eqs. (31)-(38) and (43) as printed."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.equations import equation
from derivations.averaging import readings
from derivations.averaging.checks import AveragingChecks
from derivations.averaging.symbols import A_n, phi, psi
from derivations.chain import PAPER
from derivations.printing import EquationReading, EquationVerdict, PrintedEquation
from derivations.symbols import a, alpha_0, b, c, epsilon, i, k_1, k_2, n, omega, t, y

_Psi, _bar = psi(n, t), sp.conjugate(psi(n, t))
_p, _q = phi(n, t), sp.conjugate(phi(n, t))
_left, _right = phi(n - 1, t), phi(n + 1, t)
_fast = sp.exp(-2 * i * omega * t)
_size = sp.Abs(_p)
_step = sp.exp(k_1 + i * k_2)
_lean = sp.exp(k_1) - sp.exp(-k_1)


def _mixed(value: sp.Expr) -> sp.Expr:
    return value - sp.conjugate(value) * _fast


def _bracket(square_sign: int) -> sp.Expr:
    """Return the damping bracket of (33); in print the sign of its last a-term is -1."""
    up = sp.exp(2 * i * omega * t)
    second = _p**2 * up - 2 * _p * _q + square_sign * _q**2 * _fast
    fourth = _p**4 * up**2 - 4 * _p * _q * _p**2 * up + 6 * _p**2 * _q**2
    fourth += -4 * _p * _q * _q**2 * _fast + _q**4 * _fast**2
    return 1 + a * second / (4 * omega**2) + b * fourth / (16 * omega**4)


def _rotating(square_sign: int) -> sp.Eq:
    """Return (33); in print the sign of the last a-term is -1."""
    return equation(
        _p.diff(t) + i * omega * _p / 2 - i * omega * _q * _fast / 2
        - i * (1 + 2 * epsilon * c) * _mixed(_p) / (2 * omega)
        + i * epsilon * c / (2 * omega) * (_mixed(_left) + _mixed(_right))
        + epsilon * (_p + _q * _fast) / 2 * _bracket(square_sign))  # fmt: skip


_DECAY = sp.Tuple(
    equation(2 / (c * _lean) * (sp.Rational(1, 2) - a * alpha_0**2 * sp.exp(2 * k_1 * n) / 8
                                + b * alpha_0**4 * sp.exp(4 * k_1 * n) / 16), -1),
    equation(k_2, -sp.pi / 2),
)  # fmt: skip
_BALANCE = equation(
    i * omega / 2 - i * (1 + 2 * epsilon * c) / (2 * omega)
    + i * epsilon * c / (2 * omega) * (1 / _step + _step)
    + epsilon * (sp.Rational(1, 2) - a * alpha_0**2 * sp.exp(2 * k_1 * n) / (8 * omega**2)
                 + b * alpha_0**4 * sp.exp(4 * k_1 * n) / (16 * omega**4)),
)  # fmt: skip
_FAR = sp.Tuple(*(part.subs({sp.exp(2 * k_1 * n): 0, sp.exp(4 * k_1 * n): 0}) for part in _DECAY))
_BY_DISPLACEMENT = AveragingChecks(PAPER).phases_by_displacement


def _phases(omega_of_bracket: sp.Expr) -> sp.Tuple:
    """Return (36), with 1 + eps c in the bracket as printed, or with 1."""
    size = alpha_0**2 * sp.exp(2 * k_1 * n)
    damped = sp.Rational(1, 2) - a * size / (8 * omega_of_bracket**2)
    damped += b * size**2 / (16 * omega_of_bracket**4)
    return sp.Tuple(
        equation(sp.sin(k_2), 2 * (1 + epsilon * c) / (c * _lean) * damped),
        equation(sp.cos(k_2), -epsilon * c / (sp.exp(k_1) + sp.exp(-k_1))),
    )


_TO_AVERAGE = (
    PrintedEquation(
        number=31,
        latex=r"y_n = -i\frac{\Psi_n - \Psi_n^*}{2\omega}, \quad \dot{y}_n = \frac{\Psi_n + "
              r"\Psi_n^*}{2}, \quad \ddot{y}_n = \dot{\Psi}_n - i\omega\left(\frac{\Psi_n + "
              r"\Psi_n^*}{2}\right)",
        expression=sp.Tuple(
            equation(y(n, t), -i * (_Psi - _bar) / (2 * omega)),
            equation(y(n, t).diff(t), (_Psi + _bar) / 2),
            equation(y(n, t).diff(t, 2), _Psi.diff(t) - i * omega * (_Psi + _bar) / 2)),
        verdict=EquationVerdict.DEFINITION,
        note="The same as Ψ = y' + i ω y; the third part follows.",
    ),
    PrintedEquation(
        number=32,
        latex=r"\begin{aligned}&\dot{\Psi}_n - i\omega\left(\frac{\Psi_n + \Psi_n^*}{2}\right) - "
              r"i(1 + 2\varepsilon c)\left(\frac{\Psi_n - \Psi_n^*}{2\omega}\right) \\ &+ "
              r"\frac{ic\varepsilon}{2\omega}\left(\Psi_{n-1} - \Psi_{n-1}^* + \Psi_{n+1} - "
              r"\Psi_{n+1}^*\right) + \varepsilon\frac{\Psi_n + \Psi_n^*}{2}\left(1 + "
              r"a\left(\frac{\Psi_n - \Psi_n^*}{2\omega}\right)^2 + b\left(\frac{\Psi_n - "
              r"\Psi_n^*}{2\omega}\right)^4\right)\end{aligned}",
        expression=_Psi.diff(t) - i * omega * (_Psi + _bar) / 2
        - i * (1 + 2 * epsilon * c) * (_Psi - _bar) / (2 * omega)
        + i * c * epsilon / (2 * omega)
        * (psi(n - 1, t) - sp.conjugate(psi(n - 1, t)) + psi(n + 1, t)
           - sp.conjugate(psi(n + 1, t)))
        + epsilon * (_Psi + _bar) / 2 * (1 + a * ((_Psi - _bar) / (2 * omega)) ** 2
                                         + b * ((_Psi - _bar) / (2 * omega)) ** 4),
        verdict=EquationVerdict.MISPRINT,
        note="The '= 0' is missing: an expression is printed, not an equation. Every term is "
             "right.",
        amendments=((r"^4\right)\end{aligned}", r"^4\right) = 0\end{aligned}"),),
    ),
    PrintedEquation(
        number=33,
        latex=r"\begin{aligned}&\dot{\varphi}_n + \frac{i\omega}{2}\varphi_n - \frac{i\omega "
              r"\varphi_n^* e^{-2i\omega t}}{2} - i(1 + 2\varepsilon c)\left(\frac{\varphi_n - "
              r"\varphi_n^* e^{-2i\omega t}}{2\omega}\right) \\ &+ \frac{i\varepsilon c}{2\omega}"
              r"\left(\varphi_{n-1} - \varphi_{n-1}^* e^{-2i\omega t} + \varphi_{n+1} - "
              r"\varphi_{n+1}^* e^{-2i\omega t}\right) \\ &+ \varepsilon\frac{\varphi_n + "
              r"\varphi_n^* e^{-2i\omega t}}{2}\left(\begin{aligned}&1 + a\frac{\varphi_n^2 "
              r"e^{2i\omega t} - 2|\varphi_n|^2 - \left(\varphi_n^*\right)^2 e^{-2i\omega t}}"
              r"{4\omega^2} \\ &+ b\frac{\varphi_n^4 e^{4i\omega t} - 4|\varphi_n|^2 \varphi_n^2 "
              r"e^{2i\omega t} + 6|\varphi_n|^4 - 4|\varphi_n|^2 \left(\varphi_n^*\right)^2 "
              r"e^{-2i\omega t} + \left(\varphi_n^*\right)^4 e^{-4i\omega t}}{16\omega^4}"
              r"\end{aligned}\right) = 0\end{aligned}",
        expression=_rotating(-1),
        verdict=EquationVerdict.MISPRINT,
        note="In the a-term the sign of (φ*)^2 e^{-2 i ω t} must be plus: it is a square.",
        affects="Nothing: this term has no mean, so (34) is the same with either sign.",
        slip=(-(_q**2) * _fast, _q**2 * _fast, _rotating(1)),
        amendments=((r"2|\varphi_n|^2 - \left(", r"2|\varphi_n|^2 + \left("),),
    ),
    PrintedEquation(
        number=34,
        latex=r"\dot{\varphi}_n + i\left(\omega - \frac{1}{\omega}\right)\frac{\varphi_n}{2} - "
              r"\frac{i\varepsilon c}{2\omega}(2\varphi_n - \varphi_{n-1} - \varphi_{n+1}) + "
              r"\varepsilon\frac{\varphi_n}{2}\left(1 - a\frac{|\varphi_n|^2}{4\omega^2} + "
              r"b\frac{|\varphi_n|^4}{8\omega^4}\right) = 0",
        expression=equation(
            _p.diff(t) + i * (omega - 1 / omega) * _p / 2
            - i * epsilon * c / (2 * omega) * (2 * _p - _left - _right)
            + epsilon * _p / 2 * (1 - a * _size**2 / (4 * omega**2)
                                  + b * _size**4 / (8 * omega**4))),
        verdict=EquationVerdict.HOLDS,
        note="Every term and sign, for any ω, when φ is frozen over the period.",
    ),
    PrintedEquation(
        number=43,
        latex=r"\dot{\varphi}_n - \frac{i\varepsilon c}{2}\left(2\varphi_n - \varphi_{n-1} - "
              r"\varphi_{n+1}\right) + \varepsilon \frac{\varphi_n}{2}\left(1 - "
              r"a\frac{|\varphi_n|^2}{4} + b\frac{|\varphi_n|^4}{8}\right) = 0",
        expression=equation(
            _p.diff(t) - i * epsilon * c / 2 * (2 * _p - _left - _right)
            + epsilon * _p / 2 * (1 - a * _size**2 / 4 + b * _size**4 / 8)),
        verdict=EquationVerdict.HOLDS,
        note="(34) at ω = 1.",
    ),
)  # fmt: skip

_DECAYING = (
    PrintedEquation(
        number=35,
        latex=r"\begin{aligned}&\frac{i\omega}{2} - i(1+2\varepsilon c)\left(\frac{1}{2\omega}"
              r"\right) \\ &+ \frac{i\varepsilon c}{2\omega}\left(e^{-(k_1+ik_2)} + e^{(k_1+ik_2)}"
              r"\right) + \varepsilon\left(\frac{1}{2} - a\frac{\alpha_0^2 e^{2k_1 n}}{8\omega^2} "
              r"+ b\frac{\alpha_0^4 e^{4k_1 n}}{16\omega^4}\right) = 0\end{aligned}",
        expression=_BALANCE,
        verdict=EquationVerdict.AMBIGUOUS,
        note="n is left open while k_1 and k_2 are constants. The ansatz is written with n, not "
             "|n|: it is meant for n ≥ 1. Its α_0 is an amplitude of φ, ω times that of "
             "y: see (36).",
        affects="(36), (37), (38) and Fig. 8 inherit the open n.",
        readings=(
            EquationReading("at one site n ≥ 1", _BALANCE, True, "the substitution is right"),
            EquationReading(
                "at every n ≥ 1", _BALANCE, False,
                "three sites require equal amplitudes: no decaying solution exists; what is true "
                "instead are real amplitudes with phase steps of -π/2 and a varying ratio",
                readings.at_every_site),
        ),
    ),
    PrintedEquation(
        number=36,
        latex=r"\begin{aligned}\sin k_2 &= \frac{2(1+\varepsilon c)}{c(e^{k_1} - e^{-k_1})}"
              r"\left(\frac{1}{2} - a\frac{\alpha_0^2 e^{2k_1 n}}{8(1+\varepsilon c)^2} + "
              r"b\frac{\alpha_0^4 e^{4k_1 n}}{16(1+\varepsilon c)^4}\right) \\ \cos k_2 &= "
              r"-\frac{\varepsilon c}{(e^{k_1} + e^{-k_1})}\end{aligned}",
        expression=_phases(1 + epsilon * c),
        verdict=EquationVerdict.INCONSISTENT,
        note="The parts of (35) at the same single site n, with ω = 1 + ε c; right for "
             "α_0 as an amplitude of φ. By (31) |φ| = ω |y|, so this α_0 is ω "
             "times the α_0 of (9), (29) and (38), which is an amplitude of y.",
        affects="(35) in the same way. (29) and (36) may not be solved together as they stand at "
                "ε > 0; in the limit (37) the two are the same.",
        readings=(
            EquationReading(
                "α_0 as in (9), (29) and (38), an amplitude of y", _phases(1 + epsilon * c),
                False, "the factors 1/(1 + ε c)^2 and 1/(1 + ε c)^4 are then too many",
                _BY_DISPLACEMENT),
            EquationReading(
                "with α_0 of (9): without the factors 1/(1 + ε c)^2 and 1/(1 + ε c)^4, "
                "and without 1/ω^2 and 1/ω^4 in (35)", _phases(sp.Integer(1)), True,
                "one α_0 throughout", _BY_DISPLACEMENT),
        ),
    ),
    PrintedEquation(
        number=37,
        latex=r"\frac{2}{c(e^{k_1} - e^{-k_1})}\left(\frac{1}{2} - a\frac{\alpha_0^2 e^{2k_1 n}}"
              r"{8} + b\frac{\alpha_0^4 e^{4k_1 n}}{16}\right) = -1, \quad k_2 = -\frac{\pi}{2}",
        expression=_DECAY,
        verdict=EquationVerdict.AMBIGUOUS,
        note="A site must be chosen before (29) and (37) can be solved. -π/2 is the branch for "
             "k_1 < 0 and a positive bracket, that is below the unstable cycle.",
        affects="Fig. 8: α_0 and k_1. Against the averaged chain at a = 2.5, b = 0.5, c = 0.1.",
        readings=(
            EquationReading("n = 0, the centre", _DECAY.subs(n, 0), False,
                            "with (29) no solution: its bracket is negative on the cycle",
                            readings.solved_with_29(0)),
            EquationReading("n = 1, the first neighbour", _DECAY.subs(n, 1), True,
                            "the reading that agrees with the close match claimed for Fig. 8",
                            readings.solved_with_29(1)),
            EquationReading("n large, the linear tail", _FAR, False,
                            "right for the tail, 2 c sinh k_1 = -1, but not for the neighbour",
                            readings.solved_with_29(None)),
        ),
        amendments=(("e^{2k_1 n}", "e^{2k_1}"), ("e^{4k_1 n}", "e^{4k_1}")),
    ),
    PrintedEquation(
        number=38,
        latex=r"A_n = \alpha_0 e^{k_1|n|}",
        expression=equation(A_n, alpha_0 * sp.exp(k_1 * sp.Abs(n))),
        verdict=EquationVerdict.HOLDS,
        note="The amplitude of (9) again, with its constant ratio of neighbours.",
    ),
)  # fmt: skip

EQUATIONS = _TO_AVERAGE + _DECAYING
