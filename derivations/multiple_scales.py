"""Model II by multiple scales, Eqs. (8)-(30): the central particle of the breather."""

from __future__ import annotations

import sys

import sympy as sp

from derivations import multiple_scales_evidence as seen
from derivations import secular_evidence as secular
from derivations.algebra.harmonics import HarmonicRing, Harmonics
from derivations.derivation import Derivation, Step, equation
from derivations.multiple_scales_symbols import (
    Y0,
    Y1,
    A,
    A_rate,
    R_rate,
    Y,
    loss,
    theta_rate,
)
from derivations.symbols import (
    R,
    a,
    alpha_0,
    b,
    c,
    damping_factor,
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


def chain() -> sp.Eq:
    """Eq. (8)."""
    own, rate = site(), site().diff(t)
    left = own.diff(t, 2) + own + epsilon * c * (2 * own - site(-1) - site(1))
    return equation(left + epsilon * rate * damping_factor(own), 0)


def central(y: sp.Expr, neighbour: sp.Expr, first: sp.Expr, second: sp.Expr) -> sp.Expr:
    """Left side of Eq. (10) for given y, its neighbour, and its derivatives."""
    return second + y + 2 * epsilon * c * (y - neighbour) + epsilon * first * damping_factor(y)


def derive(order: int = 1) -> Derivation:
    """Eqs. (8)-(30); with ``order=2`` also the next order of the cell and the chain."""
    steps = _to_orders() + _to_amplitudes() + _to_breather()
    if order == 2:
        from derivations import second_order

        steps += second_order.steps()
    return Derivation("multiple-scales", "Multiple scales for the central particle (8)-(30)", steps)


def _slow(function: sp.Expr) -> sp.Expr:
    """d/dt of a function of t_hat = omega t and tau = eps t."""
    return omega * function.diff(t_hat) + epsilon * function.diff(tau)


def _to_orders() -> tuple[Step, ...]:
    y0 = site(0, index="")
    ansatz = alpha_0 * sp.exp(k_1 * sp.Abs(n)) * sp.sin(omega * t + k_2 * sp.Abs(n))
    neighbour = ansatz.subs(n, 1)
    fast_neighbour = neighbour.subs(omega * t, t_hat)
    symmetric = central(y0, site(1, index=""), y0.diff(t), y0.diff(t, 2))
    first, second = _slow(Y), sp.expand(_slow(_slow(Y)))
    # (14) in (11); the only O(eps^2) term is eps^2 y_tautau, and one inside eps times the rate.
    two_times = central(Y, fast_neighbour, omega * Y.diff(t_hat),
                        second - epsilon**2 * Y.diff(tau, 2))  # fmt: skip
    # In powers of omega: omega^2 is 1 + 2 eps omega_1, and omega only multiplies eps.
    curvature = sp.diff(two_times, omega, 2) / 2
    linear = sp.diff(two_times, omega).subs(omega, 0)
    expanded = (1 + 2 * epsilon * omega_1) * curvature + linear + two_times.subs(omega, 0)
    full = expanded.subs(Y, Y0 + epsilon * Y1).doit()
    order_0 = full.subs(epsilon, 0)
    order_1 = sp.diff(full, epsilon).subs(epsilon, 0).doit()
    kept = Y1.diff(t_hat, 2) + Y1
    right = -2 * omega_1 * Y0.diff(t_hat, 2) - 2 * Y0.diff(t_hat, tau)
    right += -2 * c * (Y0 - fast_neighbour) - Y0.diff(t_hat) * damping_factor(Y0)
    if sp.expand(order_1 - kept + right) != 0:
        raise ArithmeticError("the orders in eps were collected wrongly")
    return (
        Step("The chain", chain(), seen.chain, 8),
        Step("Assume the same decay rate and phase step at every site",
             equation(site(), ansatz), seen.ansatz, 9),
        Step("Site 0 with symmetric neighbours, y_1 = y_{-1}", equation(symmetric, 0),
             seen.symmetric, 10),
        Step("Put the assumed neighbour in", equation(
            central(y0, neighbour, y0.diff(t), y0.diff(t, 2)), 0), seen.forced, 11),
        Step("Expand the frequency", equation(
            omega, 1 + epsilon * omega_1 + epsilon**2 * omega_2), seen.frequency, 12),
        Step("A fast time and a slow time", sp.Tuple(
            equation(t_hat, omega * t), equation(tau, epsilon * t)), seen.times, 13),
        Step("Derivatives by the chain rule", sp.Tuple(
            equation(y0.diff(t), first), equation(y0.diff(t, 2), second)), seen.chain_rule, 14),
        Step("Put (14) into (11), without O(eps^2)", equation(two_times, 0), seen.two_times, 15),
        Step("Put (12) in, without O(eps^2)", equation(expanded, 0), seen.two_times, 16),
        Step("Expand the solution", equation(Y, Y0 + epsilon * Y1), seen.expansion, 17),
        Step("Order 1", equation(order_0, 0), seen.order_zero, 18),
        Step("Order eps", equation(kept, right), seen.order_one, 19),
        Step("The solution of (18), with a slowly varying complex amplitude",
             equation(Y0, A * sp.exp(i * t_hat) + sp.conjugate(A) * sp.exp(-i * t_hat)),
             seen.free_solution, 20),
    )  # fmt: skip


def secular_condition() -> sp.Expr:
    """Minus the coefficient of ``e^{i t_hat}`` on the right of (19), by the harmonic algebra."""
    phase, growth = sp.symbols("P K")
    ring = HarmonicRing((A, A_rate, phase), (a, alpha_0, b, c, growth, omega_1))
    amplitude, rate, turn = ring.ring.gens[:3]
    y0 = Harmonics(ring, {1: amplitude, -1: ring.conjugate(amplitude)})
    slow = Harmonics(ring, {1: rate, -1: ring.conjugate(rate)})
    over_2i = ring.element(-sp.I / 2)
    sine = Harmonics(ring, {1: turn * over_2i, -1: -ring.conjugate(turn) * over_2i})
    factor = (y0**2).scaled(ring.element(-a)) + (y0**4).scaled(ring.element(b)) + y0**0
    drive = y0 - sine.scaled(ring.element(alpha_0 * growth))
    right = y0.fast_derivative().fast_derivative().scaled(ring.element(-2 * omega_1))
    right = right + slow.fast_derivative().scaled(-2) + drive.scaled(ring.element(-2 * c))
    right = right - y0.fast_derivative() * factor
    condition = ring.as_expr(-right.coefficient(1))
    return condition.xreplace({phase: sp.exp(i * k_2), growth: sp.exp(k_1)})


def _to_amplitudes() -> tuple[Step, ...]:
    condition = secular_condition()
    turn = sp.exp(i * theta)
    growth, lag, cosine, sine = sp.symbols("K lag cosine sine", real=True)
    polar = condition.xreplace({
        sp.exp(k_1): growth, sp.exp(i * k_2): lag * turn, A: R * turn,
        sp.conjugate(A): R / turn, A_rate: (R_rate + i * R * theta_rate) * turn,
    })  # fmt: skip
    polar = sp.expand(polar / turn)
    parts = sp.expand(polar.subs(lag, cosine + i * sine))
    back = {cosine: sp.cos(k_2 - theta), sine: sp.sin(k_2 - theta), growth: sp.exp(k_1)}
    imaginary, real = (parts.coeff(i, power).subs(back) for power in (1, 0))
    both = sp.Tuple(equation(imaginary, 0), equation(real, 0))
    polar = polar.subs({lag: sp.exp(i * (k_2 - theta)), growth: sp.exp(k_1)})
    steady = both.subs({R_rate: 0, theta_rate: 0})
    return (
        Step("No secular terms: the coefficient of e^{i t} in (19) vanishes",
             equation(condition, 0), secular.secular, 21),
        Step("Polar form of the amplitude", equation(A, R * turn), secular.polar, 22),
        Step("Put (22) into (21) and divide by e^{i theta}", equation(polar, 0),
             secular.secular_polar, 23),
        Step("Imaginary and real parts", both, secular.secular_parts, 24),
        Step("Steady state", steady, secular.steady_parts, 25),
    )  # fmt: skip


def _to_breather() -> tuple[Step, ...]:
    # (25) divided by R with alpha_0 = 2 R gives the two trigonometric functions; square and add.
    damped = -2 * R**4 * b + R**2 * a - 1
    modulus = equation(4 * c**2 * sp.exp(2 * k_1), damped**2 + 4 * (c - omega_1) ** 2)
    neglected = equation(4 * c**2 * sp.exp(2 * k_1), damped**2)
    amplitude = sp.expand((damped / (2 * c)).subs(R, alpha_0 / 2) * 16 * c) / (16 * c)
    return (
        Step("With alpha_0 = 2 R, square and add: the phase k_2 - theta drops out",
             modulus, secular.modulus, 26),
        Step("Assume that the frequency is close to 1 + eps c",
             equation(omega_1, c + delta), secular.close_frequency, 27),
        Step("What delta is, before it is neglected",
             equation(delta, -c * sp.exp(k_1) * sp.sin(k_2 - theta)), secular.close_frequency),
        Step("Put (27) into (26) and neglect delta^2", neglected, secular.neglected, 28),
        Step("What neglecting costs: relative error E of (28). Small needs delta << c e^{k_1}, "
             "not only delta << c", equation(loss, (delta / c) ** 2 * sp.exp(-2 * k_1)),
             secular.cost),
        Step("The positive root of (28), with R = alpha_0/2",
             equation(sp.exp(k_1), amplitude), secular.decay, 29),
        Step("The frequency to first order; delta = 0 when k_2 - theta = 0 as at k_2 = -pi/2",
             equation(omega, 1 + epsilon * c), secular.breather_frequency, 30),
    )  # fmt: skip


if __name__ == "__main__":
    from derivations.catalogue import main

    sys.exit(main("multiple-scales"))
