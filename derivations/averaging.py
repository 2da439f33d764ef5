"""Model II by averaging, Eqs. (31)-(38), and the exact reduction with phase steps of -pi/2."""

from __future__ import annotations

import sys

import sympy as sp

from derivations import averaging_evidence as seen
from derivations.algebra.harmonics import HarmonicRing, Harmonics
from derivations.averaging_symbols import (
    OFFSETS,
    A_n,
    h,
    phi,
    phi_rate,
    psi,
    psi_rate,
    r,
    r0,
    r0_rate,
    r1,
    r_rate,
    s,
    y,
    y_rate,
    y_second,
)
from derivations.derivation import Derivation, Step, equation
from derivations.symbols import a, alpha_0, b, c, epsilon, i, k_1, k_2, n, omega, t


def derive(order: int = 1) -> Derivation:
    """Eqs. (31)-(38); with ``order=2`` also the next order of the cell and the chain."""
    steps = _to_average() + _decaying() + _staggered()
    if order == 2:
        from derivations import second_order

        steps += second_order.steps()
    return Derivation("averaging", "Averaging of the chain and its decaying solution (31)-(38)",
                      steps)  # fmt: skip


def displacement(value: sp.Expr) -> sp.Expr:
    """Y from Psi (Eq. 31)."""
    return -i * (value - sp.conjugate(value)) / (2 * omega)


def complex_form() -> sp.Expr:
    """Return the left side of Eq. (32)."""
    own = psi[0]
    velocity = (own + sp.conjugate(own)) / 2
    wave = (own - sp.conjugate(own)) / (2 * omega)
    neighbours = sum(psi[o] - sp.conjugate(psi[o]) for o in (-1, 1))
    left = psi_rate - i * omega * velocity - i * (1 + 2 * epsilon * c) * wave
    left += i * epsilon * c / (2 * omega) * neighbours
    # y^2 = -wave^2 and y^4 = wave^4.
    return left + epsilon * velocity * (1 + a * wave**2 + b * wave**4)


def rotating_form() -> sp.Expr:
    """Return the left of (33): (32) at ``Psi = phi e^{i omega t}``, divided by that phase."""
    turn = sp.exp(i * omega * t)
    bar = sp.conjugate(phi[0])
    mixed = {o: phi[o] - sp.conjugate(phi[o]) / turn**2 for o in OFFSETS}
    velocity = (phi[0] + bar / turn**2) / 2
    square = sp.expand((phi[0] * turn - bar / turn) ** 2)
    fourth = sp.expand((phi[0] * turn - bar / turn) ** 4)
    left = phi_rate + i * omega * phi[0] - i * omega * velocity
    left -= i * (1 + 2 * epsilon * c) * mixed[0] / (2 * omega)
    left += i * epsilon * c / (2 * omega) * (mixed[-1] + mixed[1])
    factor = 1 + a * square / (4 * omega**2) + b * fourth / (16 * omega**4)
    return left + epsilon * velocity * factor


def averaged_form() -> sp.Expr:
    """Return the left side of Eq. (34): the mean of (33) over the fast period, by the algebra."""
    inverse = sp.Symbol("w", positive=True)  # 1/omega
    ring = HarmonicRing(tuple(phi[o] for o in OFFSETS), (a, b, c, epsilon, omega, inverse))
    turned = {o: Harmonics(ring, {1: ring.amplitude(o)}) for o in OFFSETS}
    velocity = (turned[0] + turned[0].conjugate()).scaled(ring.element(sp.Rational(1, 2)))
    over = ring.element(-sp.I * inverse / 2)
    position = {o: (turned[o] - turned[o].conjugate()).scaled(over) for o in OFFSETS}
    own = position[0]
    factor = own**0 - (own**2).scaled(ring.element(a)) + (own**4).scaled(ring.element(b))
    springs = own.scaled(2) - position[-1] - position[1]
    rest = velocity.scaled(ring.element(-sp.I * omega)) + own
    rest = rest + turned[0].scaled(ring.element(sp.I * omega))
    rest = rest + springs.scaled(ring.element(epsilon * c))
    rest = rest + (velocity * factor).scaled(ring.element(epsilon))
    mean = ring.as_expr(rest.turned(-1).coefficient(0)).subs(inverse, 1 / omega)
    size = sp.Abs(phi[0])
    differences = 2 * phi[0] - phi[-1] - phi[1]
    amplitude = 1 - a * size**2 / (4 * omega**2) + b * size**4 / (8 * omega**4)
    collected = i * (omega - 1 / omega) * phi[0] / 2 - i * epsilon * c / (2 * omega) * differences
    collected += epsilon * phi[0] / 2 * amplitude
    plain = collected.subs(size, sp.sqrt(phi[0] * sp.conjugate(phi[0])))
    if sp.expand(mean - plain) != 0:
        raise ArithmeticError("the average was collected wrongly")
    return phi_rate + collected


def _to_average() -> tuple[Step, ...]:
    own, bar = psi[0], sp.conjugate(psi[0])
    return (
        Step("Complex variable Psi = y' + i omega y", sp.Tuple(
            equation(y, displacement(own)), equation(y_rate, (own + bar) / 2),
            equation(y_second, psi_rate - i * omega * (own + bar) / 2)), seen.complexified, 31),
        Step("Put (31) into (8)", equation(complex_form(), 0), seen.complex_chain, 32),
        Step("Psi = phi e^{i omega t}, divided by e^{i omega t}", equation(rotating_form(), 0),
             seen.rotating, 33),
        Step("Average over the fast period at frozen phi", equation(averaged_form(), 0),
             seen.averaged, 34),
    )  # fmt: skip


def _decaying() -> tuple[Step, ...]:
    step = sp.exp(k_1 + i * k_2)
    size = alpha_0**2 * sp.exp(2 * k_1 * n)
    damped = sp.Rational(1, 2) - a * size / (8 * omega**2) + b * size**2 / (16 * omega**4)
    balance = i * omega / 2 - i * (1 + 2 * epsilon * c) / (2 * omega) + epsilon * damped
    balance += i * epsilon * c / (2 * omega) * (1 / step + step)
    # Real and imaginary parts are linear in sin k_2 and cos k_2.
    wave, lean = sp.exp(k_1) + sp.exp(-k_1), sp.exp(k_1) - sp.exp(-k_1)
    first = 1 + epsilon * c
    sine = 2 * first / (c * lean) * damped.subs(omega, first)
    detuning = sp.expand(1 + 2 * epsilon * c - first**2)
    cosine = detuning / (epsilon * c * wave)
    limit = sine.subs(epsilon, 0)
    quadratic = [sp.Rational(1, 2) - a * q / 8 + b * q**2 / 16 for q in s]
    two = sp.factor(quadratic[0] - quadratic[1])
    three = sp.factor(
        sp.cancel((quadratic[0] - quadratic[1]) / (s[0] - s[1]))
        - sp.cancel((quadratic[0] - quadratic[2]) / (s[0] - s[2]))
    )
    return (
        Step("Steady decay phi_n = alpha_0 e^{(k_1 + i k_2) n} in (34), divided by phi_n; "
             "valid at one site n >= 1", equation(balance, 0), seen.decaying, 35),
        Step("Two sites n and m, with s_n = alpha_0^2 e^{2 k_1 n}: (35) holds at both only if "
             "s_n + s_m = 2 a / b", equation(h[0] - h[1], two), seen.two_sites),
        Step("Three sites: (35) at all of them needs s_m = s_p, so no decaying solution exists",
             equation((h[0] - h[1]) / (s[0] - s[1]) - (h[0] - h[2]) / (s[0] - s[2]), three),
             seen.three_sites),
        Step("Real and imaginary parts of (35) with omega = 1 + eps c", sp.Tuple(
            equation(sp.sin(k_2), sine), equation(sp.cos(k_2), cosine)), seen.separated, 36),
        Step("The limit eps -> 0, k_1 < 0 (at site n)", sp.Tuple(
            equation(limit, -1), equation(k_2, -sp.pi / 2)), seen.limit, 37),
        Step("The amplitude of the assumed solution (9)",
             equation(A_n, alpha_0 * sp.exp(k_1 * sp.Abs(n))), seen.amplitude, 38),
    )  # fmt: skip


def _staggered() -> tuple[Step, ...]:
    # phi_n = (-i)^n r_n e^{i eps c t} in (34) at omega = 1, divided by its phase and by eps.
    factor = 1 - a * r[0] ** 2 / 4 + b * r[0] ** 4 / 8
    springs = i * c / 2 * (2 * r[0] - i * r[-1] + i * r[1])  # (-i)^{-1} = i, (-i)^{+1} = -i
    rate = sp.expand(springs - i * c * r[0])
    middle = sp.expand(i * c / 2 * (2 * r0 + 2 * i * r1) - i * c * r0)
    own = 1 - a * r0**2 / 4 + b * r0**4 / 8
    return (
        Step("What is true instead: with phase steps of -pi/2, phi_n = (-i)^{|n|} r_n e^{i eps c t}"
             ", the r_n stay real; prime is d/d(eps t)",
             equation(r_rate, rate - r[0] * factor / 2), seen.staggered),
        Step("The same at the centre", equation(r0_rate, middle - r0 * own / 2),
             seen.staggered_centre),
        Step("The linear tail of a steady breather decays at its own rate",
             equation(sp.sinh(k_1), -1 / (2 * c)), seen.tail),
    )  # fmt: skip


if __name__ == "__main__":
    from derivations.catalogue import main

    sys.exit(main("averaging"))
