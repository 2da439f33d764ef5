"""Equations (31)-(42) as printed."""

from __future__ import annotations

import sympy as sp

from derivations import averaging_readings as readings
from derivations import linearisation
from derivations.averaging_evidence import separated_by_displacement
from derivations.averaging_symbols import A_n, phi, phi_rate, psi, psi_rate, y, y_rate, y_second
from derivations.derivation import equation
from derivations.printed import Printed, Reading, Verdict
from derivations.symbols import a, alpha_0, b, c, epsilon, i, k_1, k_2, n, omega, t

_own, _bar = psi[0], sp.conjugate(psi[0])
_p, _q = phi[0], sp.conjugate(phi[0])
_fast = sp.exp(-2 * i * omega * t)
_size = sp.Abs(phi[0])
_step = sp.exp(k_1 + i * k_2)
_lean = sp.exp(k_1) - sp.exp(-k_1)


def _mixed(offset: int) -> sp.Expr:
    return phi[offset] - sp.conjugate(phi[offset]) * _fast


def _bracket(square_sign: int) -> sp.Expr:
    """Return the damping bracket of (33); print has -1 for the sign of its last a-term."""
    up = sp.exp(2 * i * omega * t)
    second = _p**2 * up - 2 * _p * _q + square_sign * _q**2 * _fast
    fourth = _p**4 * up**2 - 4 * _p * _q * _p**2 * up + 6 * _p**2 * _q**2
    fourth += -4 * _p * _q * _q**2 * _fast + _q**4 * _fast**2
    return 1 + a * second / (4 * omega**2) + b * fourth / (16 * omega**4)


def _rotating(square_sign: int) -> sp.Eq:
    """(33); print has -1 for the sign of the last a-term."""
    return equation(
        phi_rate + i * omega * _p / 2 - i * omega * _q * _fast / 2
        - i * (1 + 2 * epsilon * c) * _mixed(0) / (2 * omega)
        + i * epsilon * c / (2 * omega) * (_mixed(-1) + _mixed(1))
        + epsilon * (_p + _q * _fast) / 2 * _bracket(square_sign), 0)  # fmt: skip


_DECAY = sp.Tuple(
    equation(2 / (c * _lean) * (sp.Rational(1, 2) - a * alpha_0**2 * sp.exp(2 * k_1 * n) / 8
                                + b * alpha_0**4 * sp.exp(4 * k_1 * n) / 16), -1),
    equation(k_2, -sp.pi / 2),
)  # fmt: skip
_BALANCE = equation(
    i * omega / 2 - i * (1 + 2 * epsilon * c) / (2 * omega)
    + i * epsilon * c / (2 * omega) * (1 / _step + _step)
    + epsilon * (sp.Rational(1, 2) - a * alpha_0**2 * sp.exp(2 * k_1 * n) / (8 * omega**2)
                 + b * alpha_0**4 * sp.exp(4 * k_1 * n) / (16 * omega**4)), 0,
)  # fmt: skip


def _phases(omega_of_bracket: sp.Expr) -> sp.Tuple:
    """(36), with 1 + eps c in the bracket as printed, or with 1."""
    size = alpha_0**2 * sp.exp(2 * k_1 * n)
    damped = sp.Rational(1, 2) - a * size / (8 * omega_of_bracket**2)
    damped += b * size**2 / (16 * omega_of_bracket**4)
    return sp.Tuple(
        equation(sp.sin(k_2), 2 * (1 + epsilon * c) / (c * _lean) * damped),
        equation(sp.cos(k_2), -epsilon * c / (sp.exp(k_1) + sp.exp(-k_1))),
    )


_AVERAGED = (
    Printed(
        31, r"y_n = -i\frac{\Psi_n - \Psi_n^*}{2\omega},\ \dot y_n = \frac{\Psi_n + \Psi_n^*}{2},\ "
            r"\ddot y_n = \dot\Psi_n - i\omega\left(\frac{\Psi_n + \Psi_n^*}{2}\right)",
        sp.Tuple(equation(y, -i * (_own - _bar) / (2 * omega)), equation(y_rate, (_own + _bar) / 2),
                 equation(y_second, psi_rate - i * omega * (_own + _bar) / 2)),
        Verdict.DEFINITION, "The same as Psi = y' + i omega y; the third part follows.",
    ),
    Printed(
        32, r"\dot\Psi_n - i\omega\frac{\Psi_n + \Psi_n^*}{2} - i(1 + 2\varepsilon c)"
            r"\frac{\Psi_n - \Psi_n^*}{2\omega} + \frac{ic\varepsilon}{2\omega}(\Psi_{n-1} - "
            r"\Psi_{n-1}^* + \Psi_{n+1} - \Psi_{n+1}^*) + \varepsilon\frac{\Psi_n + \Psi_n^*}{2}"
            r"\left(1 + a\left(\frac{\Psi_n - \Psi_n^*}{2\omega}\right)^2 + "
            r"b\left(\frac{\Psi_n - \Psi_n^*}{2\omega}\right)^4\right)",
        psi_rate - i * omega * (_own + _bar) / 2 - i * (1 + 2 * epsilon * c) * (_own - _bar)
        / (2 * omega) + i * c * epsilon / (2 * omega)
        * (psi[-1] - sp.conjugate(psi[-1]) + psi[1] - sp.conjugate(psi[1]))
        + epsilon * (_own + _bar) / 2 * (1 + a * ((_own - _bar) / (2 * omega)) ** 2
                                         + b * ((_own - _bar) / (2 * omega)) ** 4),
        Verdict.MISPRINT,
        "The '= 0' is missing: an expression is printed, not an equation. Every term is right.",
    ),
    Printed(
        33, r"\dot\varphi_n + \frac{i\omega}{2}\varphi_n - \frac{i\omega\varphi_n^*e^{-2i\omega t}}"
            r"{2} - i(1 + 2\varepsilon c)\frac{\varphi_n - \varphi_n^*e^{-2i\omega t}}{2\omega} + "
            r"\frac{i\varepsilon c}{2\omega}(\varphi_{n-1} - \varphi_{n-1}^*e^{-2i\omega t} + "
            r"\varphi_{n+1} - \varphi_{n+1}^*e^{-2i\omega t}) + \varepsilon"
            r"\frac{\varphi_n + \varphi_n^*e^{-2i\omega t}}{2}\left(1 + a\frac{\varphi_n^2"
            r"e^{2i\omega t} - 2|\varphi_n|^2 - (\varphi_n^*)^2e^{-2i\omega t}}{4\omega^2} + "
            r"b\frac{\varphi_n^4e^{4i\omega t} - 4|\varphi_n|^2\varphi_n^2e^{2i\omega t} + "
            r"6|\varphi_n|^4 - 4|\varphi_n|^2(\varphi_n^*)^2e^{-2i\omega t} + (\varphi_n^*)^4"
            r"e^{-4i\omega t}}{16\omega^4}\right) = 0",
        _rotating(-1),
        Verdict.MISPRINT,
        "In the a-term the sign of (phi*)^2 e^{-2 i omega t} must be plus: it is a square.",
        "Nothing: this term has no mean, so (34) is the same with either sign.",
        slip=(-(_q**2) * _fast, _q**2 * _fast, _rotating(1)),
    ),
    Printed(
        34, r"\dot\varphi_n + i\left(\omega - \frac{1}{\omega}\right)\frac{\varphi_n}{2} - "
            r"\frac{i\varepsilon c}{2\omega}(2\varphi_n - \varphi_{n-1} - \varphi_{n+1}) + "
            r"\varepsilon\frac{\varphi_n}{2}\left(1 - a\frac{|\varphi_n|^2}{4\omega^2} + "
            r"b\frac{|\varphi_n|^4}{8\omega^4}\right) = 0",
        equation(phi_rate + i * (omega - 1 / omega) * _p / 2
                 - i * epsilon * c / (2 * omega) * (2 * _p - phi[-1] - phi[1])
                 + epsilon * _p / 2 * (1 - a * _size**2 / (4 * omega**2)
                                       + b * _size**4 / (8 * omega**4)), 0),
        Verdict.HOLDS, "Every term and sign, for any omega, when phi is frozen over the period.",
    ),
    Printed(
        35, r"\frac{i\omega}{2} - i(1+2\varepsilon c)\frac{1}{2\omega} + \frac{i\varepsilon c}"
            r"{2\omega}\left(e^{-(k_1+ik_2)} + e^{(k_1+ik_2)}\right) + \varepsilon\left(\frac12 - "
            r"a\frac{\alpha_0^2e^{2k_1n}}{8\omega^2} + b\frac{\alpha_0^4e^{4k_1n}}{16\omega^4}"
            r"\right) = 0",
        _BALANCE, Verdict.AMBIGUOUS,
        "n is left open while k_1 and k_2 are constants. The ansatz is written with n, not |n|: it "
        "is meant for n >= 1. Its alpha_0 is an amplitude of phi, omega times that of y: see (36).",
        "(36), (37), (38) and Fig. 8 inherit the open n.",
        (
            Reading("at one site n >= 1", _BALANCE, True, "the substitution is right"),
            Reading("at every n >= 1", _BALANCE, False,
                    "three sites force equal amplitudes: no decaying solution exists; what is true "
                    "instead are real amplitudes with phase steps of -pi/2 and a varying ratio",
                    readings.at_every_site),
        ),
    ),
    Printed(
        36, r"\sin k_2 = \frac{2(1+\varepsilon c)}{c(e^{k_1} - e^{-k_1})}\left(\frac12 - a"
            r"\frac{\alpha_0^2e^{2k_1n}}{8(1+\varepsilon c)^2} + b\frac{\alpha_0^4e^{4k_1n}}"
            r"{16(1+\varepsilon c)^4}\right),\ \cos k_2 = -\frac{\varepsilon c}{e^{k_1} "
            r"+ e^{-k_1}}",
        _phases(1 + epsilon * c), Verdict.INCONSISTENT,
        "The parts of (35) at the same single site n, with omega = 1 + eps c; right for alpha_0 as "
        "an amplitude of phi. By (31) |phi| = omega |y|, so this alpha_0 is omega times the "
        "alpha_0 of (9), (29) and (38), which is an amplitude of y.",
        "(35) in the same way. (29) and (36) may not be solved together as they stand at eps > 0; "
        "in the limit (37) the two are the same.",
        (
            Reading("alpha_0 as in (9), (29) and (38), an amplitude of y", _phases(1 + epsilon * c),
                    False, "the factors 1/(1 + eps c)^2 and 1/(1 + eps c)^4 are then too many",
                    separated_by_displacement),
            Reading("with alpha_0 of (9): without the factors 1/(1 + eps c)^2 and 1/(1 + eps c)^4, "
                    "and without 1/omega^2 and 1/omega^4 in (35)", _phases(sp.Integer(1)), True,
                    "one alpha_0 throughout", separated_by_displacement),
        ),
    ),
    Printed(
        37, r"\frac{2}{c(e^{k_1} - e^{-k_1})}\left(\frac12 - a\frac{\alpha_0^2e^{2k_1n}}{8} + "
            r"b\frac{\alpha_0^4e^{4k_1n}}{16}\right) = -1,\quad k_2 = -\frac{\pi}{2}",
        _DECAY, Verdict.AMBIGUOUS,
        "A site must be chosen before (29) and (37) can be solved. -pi/2 is the branch for k_1 < 0 "
        "and a positive bracket, that is below the unstable cycle.",
        "Fig. 8: alpha_0 and k_1. Against the averaged chain at a = 2.5, b = 0.5, c = 0.1.",
        readings.of_the_site(_DECAY),
    ),
    Printed(
        38, r"A_n = \alpha_0 e^{k_1|n|}", equation(A_n, alpha_0 * sp.exp(k_1 * sp.Abs(n))),
        Verdict.HOLDS,
        "The amplitude of (9), said again, with its one ratio of neighbours.",
    ),
)  # fmt: skip


def _jacobian_as_printed() -> sp.Eq:
    """(42) for N sites: a '1' too many in the bracket that multiplies x_{N+n}."""
    sites = linearisation.SITES
    x = linearisation.states(sites)
    matrix = sp.zeros(2 * sites, 2 * sites)
    for place in range(sites):
        own, rate = x[place], x[sites + place]
        matrix[place, sites + place] = 1
        matrix[sites + place, place] = (
            -1 - 2 * epsilon * c - epsilon * rate * (1 - 2 * a * own + 4 * b * own**3)
        )
        matrix[sites + place, sites + place] = -epsilon * (1 - a * own**2 + b * own**4)
        for other in ((place + 1) % sites, (place - 1) % sites):
            matrix[sites + place, other] = epsilon * c
    return equation(linearisation.jacobian_name, sp.ImmutableMatrix(matrix))


def _field_as_printed() -> sp.Eq:
    sites = linearisation.SITES
    x = linearisation.states(sites)
    rows = list(x[sites:])
    for place in range(sites):
        right, left = x[(place + 1) % sites], x[(place - 1) % sites]
        drag = epsilon * x[sites + place] * (1 - a * x[place] ** 2 + b * x[place] ** 4)
        rows.append(-x[place] - epsilon * c * (2 * x[place] - right - left) - drag)
    return equation(linearisation.field_name, sp.ImmutableMatrix(rows))


def _field_with_open_ends() -> sp.Eq:
    """(40) with the spring between sites 1 and N taken away, and nothing else."""
    sites = linearisation.SITES
    x = linearisation.states(sites)
    rows = list(_field_as_printed().rhs)
    pull = epsilon * c * (x[0] - x[sites - 1])
    rows[sites] += pull
    rows[-1] -= pull
    return equation(linearisation.field_name, sp.ImmutableMatrix(rows))


def _change_of_first_row() -> sp.Eq:
    x, d = linearisation.states(3), linearisation.perturbations(3)
    row = d[0] * (-1 - 2 * epsilon * c - epsilon * x[3] * (-2 * a * x[0] + 4 * b * x[0] ** 3))
    row += epsilon * c * (d[1] + d[2]) - epsilon * d[3] * (1 - a * x[0] ** 2 + b * x[0] ** 4)
    return equation(sp.Symbol(r"\dot{\delta}_4"), row)


_LINEARISED = (
    Printed(
        39, r"X = \begin{pmatrix} Y \\ V\end{pmatrix},\ Y = (y_1, \ldots, y_N)^T,\ V = \dot Y",
        equation(linearisation.state_name,
                 sp.ImmutableMatrix(linearisation.states(linearisation.SITES))),
        Verdict.DEFINITION, "Displacements first, then velocities; shown for N = 4.",
    ),
    Printed(
        40, r"\dot X = f(X) = \begin{pmatrix} x_{N+1} \\ x_{N+2} \\ \vdots \\ -x_1 - \varepsilon "
            r"c(2x_1 - x_2 - x_N) - \varepsilon x_{N+1}(1 - ax_1^2 + bx_1^4) \\ -x_2 - \varepsilon "
            r"c(2x_2 - x_3 - x_1) - \varepsilon x_{N+2}(1 - ax_2^2 + bx_2^4) \\ \vdots \\ -x_N - "
            r"\varepsilon c(2x_N - x_1 - x_{N-1}) - \varepsilon x_{2N}(1 - ax_N^2 + bx_N^4)"
            r"\end{pmatrix}",
        _field_as_printed(), Verdict.INCONSISTENT,
        "The printed corners, like those of (42), close the chain to a ring; Figs. 12 and 15 state "
        "open ends, and (8) does not say.",
        "Fig. 9. For a breather far from the ends the difference is of the size of its tail.",
        (
            Reading("the open ends of Figs. 12 and 15", _field_as_printed(), False,
                    "the rows of sites 1 and N have a neighbour too many",
                    linearisation.matrix_check("free", 1)),
            Reading("for an open chain: rows -x_1 - eps c (x_1 - x_2) - ... and its mirror for N",
                    _field_with_open_ends(), True,
                    "what Figs. 12 and 15 need; uniform states are as on the ring",
                    linearisation.matrix_check("free", 1)),
        ),
    ),
    Printed(
        41, r"\dot{\hat X} + \dot\delta = J|_{X=\hat X}\,\delta + f(\hat X) + O(\delta^2)\ \to\ "
            r"\dot\delta = J|_{X=\hat X}\,\delta",
        _change_of_first_row(), Verdict.HOLDS,
        "Linearisation; shown for the row of site 1 with N = 3. The letter delta is that of (27).",
    ),
    Printed(
        42, r"J = \begin{pmatrix} 0_{N\times N} & I_{N\times N} \\ A_{N\times N} & B_{N\times N}"
            r"\end{pmatrix},\ A_{nn} = -1 - 2\varepsilon c - \varepsilon x_{N+n}(1 - 2ax_n + "
            r"4bx_n^3),\ A_{n,n\pm1} = A_{1N} = A_{N1} = \varepsilon c,\ B_{nn} = -\varepsilon"
            r"(1 - ax_n^2 + bx_n^4)",
        _jacobian_as_printed(), Verdict.MISPRINT,
        "The '1' in the bracket of A_nn must go: the derivative of 1 - a x^2 + b x^4 is "
        "-2 a x + 4 b x^3. All other entries agree, with the corners of the ring (40).",
        "Fig. 9 if the matrix was coded as printed. The extra term has no resonant mean, so it "
        "moves the multipliers at O(eps^2) only.",
    ),
)  # fmt: skip

EQUATIONS = _AVERAGED + _LINEARISED
