"""Eqs. (8)-(30) as printed."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.equations import equation
from derivations.multiple_scales.symbols import Y_0, Y_1, A, R_slow, Y, theta_slow
from derivations.printing import EquationVerdict, PrintedEquation
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
    t,
    t_hat,
    tau,
    theta,
    y,
)

_y, _y0, _y1 = y(n, t), y(0, t), y(1, t)
_wave = alpha_0 * sp.exp(k_1) * sp.sin(omega * t + k_2)
_fast_wave = alpha_0 * sp.exp(k_1) * sp.sin(t_hat + k_2)
_lag = alpha_0 * c * sp.exp(k_1)
_size = sp.conjugate(A) * A
_damped = -2 * R**4 * b + R**2 * a - 1


def _damping(displacement: sp.Expr) -> sp.Expr:
    return 1 - a * displacement**2 + b * displacement**4


_TO_ORDERS = (
    PrintedEquation(
        number=8,
        latex=r"\ddot{y}_n + y_n + \varepsilon c(2y_n - y_{n-1} - y_{n+1}) + \varepsilon "
              r"\dot{y}_n(1 - ay_n^2 + by_n^4) = 0",
        expression=equation(
            _y.diff(t, 2) + _y + epsilon * c * (2 * _y - y(n - 1, t) - y(n + 1, t))
            + epsilon * _y.diff(t) * _damping(_y)),
        verdict=EquationVerdict.DEFINITION,
        note="The model. The ends of the chain are not stated here; see (40). With y / √(a) in "
             "place of y only η = b / a^2 remains of a and b.",
    ),
    PrintedEquation(
        number=9,
        latex=r"y_n = \alpha_0 e^{k_1 |n|} \sin(\omega t + k_2 |n|)",
        expression=equation(
            _y, alpha_0 * sp.exp(k_1 * sp.Abs(n)) * sp.sin(omega * t + k_2 * sp.Abs(n))),
        verdict=EquationVerdict.ASSUMPTION,
        note="Constant k_1 and k_2. No such motion solves the averaged chain at three or more "
             "sites; see (35).",
        affects="(11), (29), (35)-(38), Fig. 8.",
    ),
    PrintedEquation(
        number=10,
        latex=r"\ddot{y}_0 + y_0 + 2\varepsilon c(y_0 - y_1) + \varepsilon \dot{y}_0 "
              r"(1 - a y_0^2 + b y_0^4) = 0",
        expression=equation(_y0.diff(t, 2) + _y0 + 2 * epsilon * c * (_y0 - _y1)
                            + epsilon * _y0.diff(t) * _damping(_y0)),
        verdict=EquationVerdict.HOLDS,
        note="For a solution with y_1 = y_{-1}.",
    ),
    PrintedEquation(
        number=11,
        latex=r"\ddot{y}_0 + y_0 + 2\varepsilon c(y_0 - \alpha_0 e^{k_1} \sin(\omega t + k_2)) + "
              r"\varepsilon \dot{y}_0 (1 - a y_0^2 + b y_0^4) = 0",
        expression=equation(_y0.diff(t, 2) + _y0 + 2 * epsilon * c * (_y0 - _wave)
                            + epsilon * _y0.diff(t) * _damping(_y0)),
        verdict=EquationVerdict.HOLDS,
        note="(9) at n = 1 inserted into (10).",
    ),
    PrintedEquation(
        number=12,
        latex=r"\omega = 1 + \varepsilon \omega_1 + \varepsilon^2 \omega_2 + \ldots",
        expression=equation(omega, 1 + epsilon * omega_1 + epsilon**2 * omega_2),
        verdict=EquationVerdict.ASSUMPTION,
        note="The expansion, kept here to the second order.",
    ),
    PrintedEquation(
        number=13,
        latex=r"\hat{t} = \omega t, \quad \tau = \varepsilon t",
        expression=sp.Tuple(equation(t_hat, omega * t), equation(tau, epsilon * t)),
        verdict=EquationVerdict.DEFINITION,
        note="The two times. In model I the letter τ means ω_n t.",
    ),
    PrintedEquation(
        number=14,
        latex=r"\begin{aligned} \dot{y}_0 &= \omega y_{\hat{t}} + \varepsilon y_\tau \\ \ddot{y}_0 "
              r"&= \omega^2 y_{\hat{t}\hat{t}} + 2\omega\varepsilon y_{\tau \hat{t}} + "
              r"\varepsilon^2 y_{\tau\tau} \end{aligned}",
        expression=sp.Tuple(
            equation(_y0.diff(t), omega * Y.diff(t_hat) + epsilon * Y.diff(tau)),
            equation(_y0.diff(t, 2), omega**2 * Y.diff(t_hat, 2)
                     + 2 * omega * epsilon * Y.diff(tau, t_hat) + epsilon**2 * Y.diff(tau, 2))),
        verdict=EquationVerdict.HOLDS,
        note="The chain rule.",
    ),
    PrintedEquation(
        number=15,
        latex=r"\omega^2 y_{\hat{t}\hat{t}} + 2\omega\varepsilon y_{\hat{t}\tau} + y_0 + "
              r"2\varepsilon c(y_0 - \alpha_0 e^{k_1} \sin(\hat{t} + k_2)) + \varepsilon \omega "
              r"y_{\hat{t}} (1 - a y_0^2 + b y_0^4) = 0",
        expression=equation(
            omega**2 * Y.diff(t_hat, 2) + 2 * omega * epsilon * Y.diff(t_hat, tau) + Y
            + 2 * epsilon * c * (Y - _fast_wave) + epsilon * omega * Y.diff(t_hat) * _damping(Y)),
        verdict=EquationVerdict.HOLDS,
        note="Up to O(ε^2). (14) is inserted into (11), not into (10) as the text says.",
    ),
    PrintedEquation(
        number=16,
        latex=r"(1+2\varepsilon\omega_1)y_{0,\hat{t}\hat{t}} + 2\varepsilon y_{0,\hat{t}\tau} + "
              r"y_0 + 2\varepsilon c\left(y_0 - \alpha_0 e^{k_1}\sin(\hat{t}+k_2)\right) + "
              r"\varepsilon y_{\hat{t}}\left(1 - ay_0^2 + by_0^4\right) = 0",
        expression=equation(
            (1 + 2 * epsilon * omega_1) * Y.diff(t_hat, 2) + 2 * epsilon * Y.diff(t_hat, tau) + Y
            + 2 * epsilon * c * (Y - _fast_wave) + epsilon * Y.diff(t_hat) * _damping(Y)),
        verdict=EquationVerdict.HOLDS,
        note="Up to O(ε^2).",
    ),
    PrintedEquation(
        number=17,
        latex=r"y_0 = y_0^{(0)} + \varepsilon y_0^{(1)} + \ldots",
        expression=equation(Y, Y_0 + epsilon * Y_1),
        verdict=EquationVerdict.ASSUMPTION,
        note="The expansion of the solution.",
    ),
    PrintedEquation(
        number=18,
        latex=r"y_{0,\hat{t}\hat{t}}^{(0)} + y_0^{(0)} = 0",
        expression=equation(Y_0.diff(t_hat, 2) + Y_0),
        verdict=EquationVerdict.HOLDS,
        note="Order 1 of (16).",
    ),
    PrintedEquation(
        number=19,
        latex=r"y_{0,\hat{t}\hat{t}}^{(1)} + y_0^{(1)} = -2\omega_1 y_{0,\hat{t}\hat{t}}^{(0)} - "
              r"2y_{0,\hat{t}\tau}^{(0)} - 2c\left(y_0^{(0)} - \alpha_0 e^{k_1}\sin(\hat{t}+k_2)"
              r"\right) - y_{0,\hat{t}}^{(0)}\left(1 - a\left(y_0^{(0)}\right)^2 + "
              r"b\left(y_0^{(0)}\right)^4\right)",
        expression=equation(
            Y_1.diff(t_hat, 2) + Y_1,
            -2 * omega_1 * Y_0.diff(t_hat, 2) - 2 * Y_0.diff(t_hat, tau)
            - 2 * c * (Y_0 - _fast_wave) - Y_0.diff(t_hat) * _damping(Y_0)),
        verdict=EquationVerdict.HOLDS,
        note="Order ε of (16).",
    ),
    PrintedEquation(
        number=20,
        latex=r"y_0^{(0)} = A(\tau)e^{i\hat{t}} + A(\tau)^* e^{-i\hat{t}}",
        expression=equation(Y_0, A * sp.exp(i * t_hat) + sp.conjugate(A) * sp.exp(-i * t_hat)),
        verdict=EquationVerdict.HOLDS,
        note="The real solution of (18).",
    ),
)  # fmt: skip

_TO_BREATHER = (
    PrintedEquation(
        number=21,
        latex=r"2iA|A|^4 b - iA|A|^2 a + iA + 2cA + 2iA' - 2A\omega_1 + i\alpha_0 ce^{k_1}"
              r"e^{ik_2} = 0",
        expression=equation(
            2 * i * A * _size**2 * b - i * A * _size * a + i * A + 2 * c * A + 2 * i * A.diff(tau)
            - 2 * A * omega_1 + i * _lag * sp.exp(i * k_2)),
        verdict=EquationVerdict.HOLDS,
        note="Minus the resonant coefficient of (19).",
    ),
    PrintedEquation(
        number=22,
        latex=r"A = R \cdot e^{i\theta}",
        expression=equation(A, R_slow * sp.exp(i * theta_slow)),
        verdict=EquationVerdict.DEFINITION,
        note="Modulus and argument.",
    ),
    PrintedEquation(
        number=23,
        latex=r"2iR^5 b - iR^3 a + iR + 2cR + 2iR' - 2\theta' R - 2\omega_1 R + i\alpha_0 "
              r"ce^{k_1}e^{i(k_2-\theta)} = 0",
        expression=equation(
            2 * i * R_slow**5 * b - i * R_slow**3 * a + i * R_slow + 2 * c * R_slow
            + 2 * i * R_slow.diff(tau) - 2 * theta_slow.diff(tau) * R_slow - 2 * omega_1 * R_slow
            + i * _lag * sp.exp(i * (k_2 - theta_slow))),
        verdict=EquationVerdict.HOLDS,
        note="(22) in (21).",
    ),
    PrintedEquation(
        number=24,
        latex=r"\begin{cases} 2R^5 b - R^3 a + R + 2R' + \alpha_0 ce^{k_1}\cos(k_2-\theta) = 0 \\ "
              r"2cR - 2\theta' R - \alpha_0 ce^{k_1}\sin(k_2-\theta) - 2\omega_1 R = 0 \end{cases}",
        expression=sp.Tuple(
            equation(2 * R_slow**5 * b - R_slow**3 * a + R_slow + 2 * R_slow.diff(tau)
                     + _lag * sp.cos(k_2 - theta_slow)),
            equation(2 * c * R_slow - 2 * theta_slow.diff(tau) * R_slow
                     - _lag * sp.sin(k_2 - theta_slow) - 2 * omega_1 * R_slow)),
        verdict=EquationVerdict.HOLDS,
        note="Imaginary part first, then the real part.",
    ),
    PrintedEquation(
        number=25,
        latex=r"\begin{cases} 2R^5 b - R^3 a + R + \alpha_0 ce^{k_1}\cos(k_2-\theta) = 0 \\ "
              r"2cR - \alpha_0 ce^{k_1}\sin(k_2-\theta) - 2\omega_1 R = 0 \end{cases}",
        expression=sp.Tuple(
            equation(2 * R**5 * b - R**3 * a + R + _lag * sp.cos(k_2 - theta)),
            equation(2 * c * R - _lag * sp.sin(k_2 - theta) - 2 * omega_1 * R)),
        verdict=EquationVerdict.HOLDS,
        note="Agreement with (9) at n = 0 also fixes θ = -π/2, which the text does not use.",
    ),
    PrintedEquation(
        number=26,
        latex=r"4c^2 e^{2k_1} = \left(-2R^4 b + R^2 a - 1\right)^2 + 4\left(c - \omega_1\right)^2",
        expression=equation(4 * c**2 * sp.exp(2 * k_1), _damped**2 + 4 * (c - omega_1) ** 2),
        verdict=EquationVerdict.HOLDS,
        note="Squaring drops the phase k_2 - θ and with it one equation; with θ = -π/2 "
             "and k_2 = -π/2 the pair (25) fixes ω_1 = c by itself and (27) is not needed.",
    ),
    PrintedEquation(
        number=27,
        latex=r"\omega_1 = c + \delta; \quad \delta \ll c",
        expression=equation(omega_1, c + delta),
        verdict=EquationVerdict.ASSUMPTION,
        note="δ = -c e^{k_1} sin(k_2 - θ), which is zero for phase steps of -π/2. The "
             "condition that (28) needs is δ ≪ c e^{k_1}, stronger than the one printed. The "
             "letter δ returns in (41) as a perturbation.",
        affects="(28)-(30).",
    ),
    PrintedEquation(
        number=28,
        latex=r"4c^2 e^{2k_1} \approx \left(-2R^4 b + R^2 a - 1\right)^2",
        expression=equation(4 * c**2 * sp.exp(2 * k_1), _damped**2),
        verdict=EquationVerdict.HOLDS,
        note="With a relative error of (δ / (c e^{k_1}))^2.",
    ),
    PrintedEquation(
        number=29,
        latex=r"e^{k_1} = \frac{-\alpha_0^4 b + 2\alpha_0^2 a - 8}{16c}",
        expression=equation(sp.exp(k_1), (-(alpha_0**4) * b + 2 * alpha_0**2 * a - 8) / (16 * c)),
        verdict=EquationVerdict.HOLDS,
        note="The root of (28) with k_2 = θ, positive when α_0 lies between the two "
             "cycles. It is exact for site 0 of the averaged chain, with e^{k_1} the ratio "
             "r_1 / r_0.",
    ),
    PrintedEquation(
        number=30,
        latex=r"\omega = 1 + \varepsilon c",
        expression=equation(omega, 1 + epsilon * c),
        verdict=EquationVerdict.HOLDS,
        note="To first order; the second order adds ε^2 ω_2 (see second-order).",
    ),
)  # fmt: skip

EQUATIONS = _TO_ORDERS + _TO_BREATHER
