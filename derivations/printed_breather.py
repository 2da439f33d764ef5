"""Equations (8)-(30) as printed."""

from __future__ import annotations

import sympy as sp

from derivations.derivation import equation
from derivations.multiple_scales_symbols import Y0, Y1, A, A_rate, R_rate, Y, theta_rate
from derivations.printed import Printed, Verdict
from derivations.symbols import (
    R,
    a,
    alpha_0,
    b,
    c,
    delta,
    epsilon,
    i,
    k_1,
    k_2,
    n,
    omega,
    omega_1,
    omega_2,
    site,
    t,
    t_hat,
    tau,
    theta,
)

_y, _y0, _y1 = site(), site(0, index=""), site(1, index="")
_wave = alpha_0 * sp.exp(k_1) * sp.sin(omega * t + k_2)
_fast_wave = alpha_0 * sp.exp(k_1) * sp.sin(t_hat + k_2)
_lag = sp.exp(k_1) * alpha_0 * c


def _damping(y: sp.Expr) -> sp.Expr:
    return 1 - a * y**2 + b * y**4


_TO_ORDERS = (
    Printed(
        8, r"\ddot y_n + y_n + \varepsilon c(2y_n - y_{n-1} - y_{n+1}) + \varepsilon\dot y_n"
           r"(1 - ay_n^2 + by_n^4) = 0",
        equation(_y.diff(t, 2) + _y + epsilon * c * (2 * _y - site(-1) - site(1))
                 + epsilon * _y.diff(t) * _damping(_y), 0),
        Verdict.DEFINITION,
        "The model. The ends of the chain are not stated here; see (40). With y / sqrt(a) in the "
        "place of y only eta = b / a^2 is left of a and b.",
    ),
    Printed(
        9, r"y_n = \alpha_0 e^{k_1|n|}\sin(\omega t + k_2|n|)",
        equation(_y, alpha_0 * sp.exp(k_1 * sp.Abs(n)) * sp.sin(omega * t + k_2 * sp.Abs(n))),
        Verdict.ASSUMPTION,
        "Constant k_1 and k_2. No such motion solves the averaged chain at three or more sites; "
        "see (35).",
        "(11), (29), (35)-(38), Fig. 8.",
    ),
    Printed(
        10, r"\ddot y_0 + y_0 + 2\varepsilon c(y_0 - y_1) + \varepsilon\dot y_0"
            r"(1 - ay_0^2 + by_0^4) = 0",
        equation(_y0.diff(t, 2) + _y0 + 2 * epsilon * c * (_y0 - _y1)
                 + epsilon * _y0.diff(t) * _damping(_y0), 0),
        Verdict.HOLDS, "For a solution with y_1 = y_{-1}.",
    ),
    Printed(
        11, r"\ddot y_0 + y_0 + 2\varepsilon c(y_0 - \alpha_0 e^{k_1}\sin(\omega t + k_2)) + "
            r"\varepsilon\dot y_0(1 - ay_0^2 + by_0^4) = 0",
        equation(_y0.diff(t, 2) + _y0 + 2 * epsilon * c * (_y0 - _wave)
                 + epsilon * _y0.diff(t) * _damping(_y0), 0),
        Verdict.HOLDS, "(9) at n = 1 put into (10).",
    ),
    Printed(
        12, r"\omega = 1 + \varepsilon\omega_1 + \varepsilon^2\omega_2 + \ldots",
        equation(omega, 1 + epsilon * omega_1 + epsilon**2 * omega_2),
        Verdict.ASSUMPTION, "The expansion, kept here to the second order.",
    ),
    Printed(
        13, r"\hat t = \omega t,\quad \tau = \varepsilon t",
        sp.Tuple(equation(t_hat, omega * t), equation(tau, epsilon * t)),
        Verdict.DEFINITION, "The two times. In model I the letter tau means omega_n t.",
    ),
    Printed(
        14, r"\dot y_0 = \omega y_{\hat t} + \varepsilon y_\tau,\quad \ddot y_0 = \omega^2 "
            r"y_{\hat t\hat t} + 2\omega\varepsilon y_{\tau\hat t} + \varepsilon^2 y_{\tau\tau}",
        sp.Tuple(equation(_y0.diff(t), omega * Y.diff(t_hat) + epsilon * Y.diff(tau)),
                 equation(_y0.diff(t, 2), omega**2 * Y.diff(t_hat, 2)
                          + 2 * omega * epsilon * Y.diff(t_hat, tau)
                          + epsilon**2 * Y.diff(tau, 2))),
        Verdict.HOLDS, "The chain rule.",
    ),
    Printed(
        15, r"\omega^2 y_{\hat t\hat t} + 2\omega\varepsilon y_{\hat t\tau} + y_0 + 2\varepsilon c"
            r"(y_0 - \alpha_0 e^{k_1}\sin(\hat t + k_2)) + \varepsilon\omega y_{\hat t}"
            r"(1 - ay_0^2 + by_0^4) = 0",
        equation(omega**2 * Y.diff(t_hat, 2) + 2 * omega * epsilon * Y.diff(t_hat, tau) + Y
                 + 2 * epsilon * c * (Y - _fast_wave)
                 + epsilon * omega * Y.diff(t_hat) * _damping(Y), 0),
        Verdict.HOLDS,
        "Up to O(eps^2). (14) is put into (11), not into (10) as the text says.",
    ),
    Printed(
        16, r"(1 + 2\varepsilon\omega_1)y_{0,\hat t\hat t} + 2\varepsilon y_{0,\hat t\tau} + y_0 + "
            r"2\varepsilon c(y_0 - \alpha_0 e^{k_1}\sin(\hat t + k_2)) + \varepsilon y_{\hat t}"
            r"(1 - ay_0^2 + by_0^4) = 0",
        equation((1 + 2 * epsilon * omega_1) * Y.diff(t_hat, 2) + 2 * epsilon * Y.diff(t_hat, tau)
                 + Y + 2 * epsilon * c * (Y - _fast_wave)
                 + epsilon * Y.diff(t_hat) * _damping(Y), 0),
        Verdict.HOLDS, "Up to O(eps^2).",
    ),
    Printed(
        17, r"y_0 = y_0^{(0)} + \varepsilon y_0^{(1)} + \ldots",
        equation(Y, Y0 + epsilon * Y1), Verdict.ASSUMPTION, "The expansion of the solution.",
    ),
    Printed(
        18, r"y_{0,\hat t\hat t}^{(0)} + y_0^{(0)} = 0",
        equation(Y0.diff(t_hat, 2) + Y0, 0), Verdict.HOLDS, "Order 1 of (16).",
    ),
    Printed(
        19, r"y_{0,\hat t\hat t}^{(1)} + y_0^{(1)} = -2\omega_1 y_{0,\hat t\hat t}^{(0)} - "
            r"2y_{0,\hat t\tau}^{(0)} - 2c(y_0^{(0)} - \alpha_0 e^{k_1}\sin(\hat t + k_2)) - "
            r"y_{0,\hat t}^{(0)}(1 - a(y_0^{(0)})^2 + b(y_0^{(0)})^4)",
        equation(Y1.diff(t_hat, 2) + Y1,
                 -2 * omega_1 * Y0.diff(t_hat, 2) - 2 * Y0.diff(t_hat, tau)
                 - 2 * c * (Y0 - _fast_wave) - Y0.diff(t_hat) * _damping(Y0)),
        Verdict.HOLDS, "Order eps of (16).",
    ),
)  # fmt: skip

_modulus = sp.conjugate(A) * A

_TO_BREATHER = (
    Printed(
        20, r"y_0^{(0)} = A(\tau)e^{i\hat t} + A(\tau)^* e^{-i\hat t}",
        equation(Y0, A * sp.exp(i * t_hat) + sp.conjugate(A) * sp.exp(-i * t_hat)),
        Verdict.HOLDS, "The real solution of (18).",
    ),
    Printed(
        21, r"2iA|A|^4b - iA|A|^2a + iA + 2cA + 2iA' - 2A\omega_1 + i\alpha_0 ce^{k_1}e^{ik_2} = 0",
        equation(2 * i * A * _modulus**2 * b - i * A * _modulus * a + i * A + 2 * c * A
                 + 2 * i * A_rate - 2 * A * omega_1 + i * _lag * sp.exp(i * k_2), 0),
        Verdict.HOLDS, "Minus the resonant coefficient of (19).",
    ),
    Printed(22, r"A = R\cdot e^{i\theta}", equation(A, R * sp.exp(i * theta)),
            Verdict.DEFINITION, "Modulus and argument."),
    Printed(
        23, r"2iR^5b - iR^3a + iR + 2cR + 2iR' - 2\theta'R - 2\omega_1R + "
            r"i\alpha_0 ce^{k_1}e^{i(k_2-\theta)} = 0",
        equation(2 * i * R**5 * b - i * R**3 * a + i * R + 2 * c * R + 2 * i * R_rate
                 - 2 * theta_rate * R - 2 * omega_1 * R + i * _lag * sp.exp(i * (k_2 - theta)), 0),
        Verdict.HOLDS, "(22) in (21).",
    ),
    Printed(
        24, r"2R^5b - R^3a + R + 2R' + \alpha_0 ce^{k_1}\cos(k_2-\theta) = 0;\quad "
            r"2cR - 2\theta'R - \alpha_0 ce^{k_1}\sin(k_2-\theta) - 2\omega_1R = 0",
        sp.Tuple(equation(2 * R**5 * b - R**3 * a + R + 2 * R_rate
                          + _lag * sp.cos(k_2 - theta), 0),
                 equation(2 * c * R - 2 * theta_rate * R - _lag * sp.sin(k_2 - theta)
                          - 2 * omega_1 * R, 0)),
        Verdict.HOLDS, "Imaginary part first, then the real part.",
    ),
    Printed(
        25, r"2R^5b - R^3a + R + \alpha_0 ce^{k_1}\cos(k_2-\theta) = 0;\quad "
            r"2cR - \alpha_0 ce^{k_1}\sin(k_2-\theta) - 2\omega_1R = 0",
        sp.Tuple(equation(2 * R**5 * b - R**3 * a + R + _lag * sp.cos(k_2 - theta), 0),
                 equation(2 * c * R - _lag * sp.sin(k_2 - theta) - 2 * omega_1 * R, 0)),
        Verdict.HOLDS,
        "Agreement with (9) at n = 0 also fixes theta = -pi/2, which the text does not use.",
    ),
    Printed(
        26, r"4c^2e^{2k_1} = (-2R^4b + R^2a - 1)^2 + 4(c - \omega_1)^2",
        equation(4 * c**2 * sp.exp(2 * k_1),
                 (-2 * R**4 * b + R**2 * a - 1) ** 2 + 4 * (c - omega_1) ** 2),
        Verdict.HOLDS,
        "Squaring drops the phase k_2 - theta and with it one equation; with theta = -pi/2 and "
        "k_2 = -pi/2 the pair (25) fixes omega_1 = c by itself and (27) is not needed.",
    ),
    Printed(
        27, r"\omega_1 = c + \delta;\quad \delta\ll c", equation(omega_1, c + delta),
        Verdict.ASSUMPTION,
        "delta = -c e^{k_1} sin(k_2 - theta), which is zero for phase steps of -pi/2. The "
        "condition that (28) needs is delta << c e^{k_1}, stronger than the one printed. The "
        "letter delta returns in (41) as a perturbation.",
        "(28)-(30).",
    ),
    Printed(
        28, r"4c^2e^{2k_1}\approx(-2R^4b + R^2a - 1)^2",
        equation(4 * c**2 * sp.exp(2 * k_1), (-2 * R**4 * b + R**2 * a - 1) ** 2),
        Verdict.HOLDS, "With a relative error of (delta / (c e^{k_1}))^2.",
    ),
    Printed(
        29, r"e^{k_1} = \frac{-\alpha_0^4b + 2\alpha_0^2a - 8}{16c}",
        equation(sp.exp(k_1), (-(alpha_0**4) * b + 2 * alpha_0**2 * a - 8) / (16 * c)),
        Verdict.HOLDS,
        "The root of (28) with k_2 = theta, positive when alpha_0 lies between the two cycles. It "
        "is exact for site 0 of the averaged chain, with e^{k_1} the ratio r_1 / r_0.",
    ),
    Printed(
        30, r"\omega = 1 + \varepsilon c", equation(omega, 1 + epsilon * c),
        Verdict.HOLDS, "To first order; the second order adds eps^2 omega_2 (see second-order).",
    ),
)  # fmt: skip

EQUATIONS = _TO_ORDERS + _TO_BREATHER
