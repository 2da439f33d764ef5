"""The next order in eps, for the unit cell and for the chain, by both routes."""

from __future__ import annotations

import sys

import sympy as sp

from derivations import second_order_evidence as seen
from derivations.derivation import Derivation, Step, equation
from derivations.modulation import (
    Modulation,
    by_averaging,
    by_multiple_scales,
    in_scales_amplitude,
    same_polynomial,
)
from derivations.oscillator import van_der_pol
from derivations.second_order_symbols import (
    fundamental,
    phi_rate,
    r_far_left,
    r_far_right,
    r_left,
    r_n,
    r_rate,
    r_right,
    rate,
    size,
    square,
    turn,
    y_next,
)
from derivations.symbols import a, b, c, epsilon, omega


def derive() -> Derivation:
    """Second order on its own."""
    return Derivation("second-order", "Second order for the cell and the chain", steps())


def total(modulation: Modulation) -> sp.Expr:
    """``eps first + eps^2 second`` as an expression."""
    return epsilon * modulation.first_expr() + epsilon**2 * modulation.second_expr()


def frequency_shift(cell: Modulation) -> sp.Expr:
    """omega_2 of a cycle of the cell, in s = r^2 = 4 |A|^2, reduced by the cycle's own equation.

    On a cycle ``1 - a s/4 + b s^2/8 = 0``, so powers of s from the second on are eliminated.
    """
    amplitude = cell.ring.amplitudes[0]
    shift = sp.expand(cell.second_expr() / amplitude / sp.I)
    shift = shift.subs(amplitude, sp.sqrt(square) / 2).doit()
    own = sp.Poly(1 - a * square / 4 + b * square**2 / 8, square)
    return sp.factor(sp.rem(sp.Poly(sp.expand(shift), square), own).as_expr())


def staggered(chain: Modulation) -> sp.Expr:
    """Put real r_n for rho_n in the equation of ``2 i A_n = (-i)^n rho_n e^{i eps c t}``, n > 1."""
    reals = (r_far_left, r_left, r_n, r_right, r_far_right)
    put: dict[sp.Basic, sp.Expr] = {}
    for offset, (symbol, real) in enumerate(zip(chain.ring.amplitudes, reals, strict=True), -2):
        put[symbol] = (-sp.I / 2) * (-sp.I) ** offset * real
    found = (chain.first_expr() + epsilon * chain.second_expr()).subs(put)
    return sp.expand(sp.expand(found * 2 * sp.I) - sp.I * c * r_n)


def steps() -> tuple[Step, ...]:
    """Second order by both routes, and what it predicts."""
    out: list[Step] = []
    for coupled, name in ((False, "cell"), (True, "chain")):
        model = van_der_pol(coupled)
        scales, averaged = by_multiple_scales(model, 2), by_averaging(model, 2)
        first, second = in_scales_amplitude(averaged)
        if not (same_polynomial(first, scales.first) and same_polynomial(second, scales.second)):
            raise ArithmeticError(f"the two routes disagree for the {name}")
        shift = -averaged.ring.conjugate(averaged.correction.coefficient(-2))
        carried = (
            averaged.ring.as_expr(first) * epsilon + averaged.ring.as_expr(second) * epsilon**2
        )
        carried = carried.subs(
            dict(zip(averaged.ring.amplitudes, scales.ring.amplitudes, strict=True))
        )
        middle = averaged.ring.amplitudes[averaged.ring.reach]
        out += [
            Step(f"Multiple scales to second order, {name}: y = A e^{{it}} + c.c. + eps y1",
                 equation(rate, total(scales)), seen.scales(coupled)),
            Step(f"Averaging to second order, {name}: y' + i y = phi e^{{it}}, phi without its "
                 "oscillating part", equation(phi_rate, total(averaged)), seen.averaging(coupled)),
            Step(f"The amplitude of e^{{it}} in y itself, {name}", equation(
                fundamental, -sp.I / 2 * (middle + epsilon * averaged.ring.as_expr(shift))),
                 seen.fundamental(coupled)),
            Step(f"Averaging rewritten for A, {name}: the same polynomial as by multiple scales",
                 equation(rate, carried), seen.scales(coupled)),
        ]  # fmt: skip
        if not coupled:
            wave = sum(scales.ring.as_expr(value) * turn**m
                       for m, value in sorted(scales.correction.terms.items()))  # fmt: skip
            out += [
                Step("The next harmonics of the cell, E = e^{it}", equation(y_next, wave),
                     seen.next_harmonics),
                Step("Frequency of both cycles of the cell, s = r^2 with 1 - a s/4 + b s^2/8 = 0",
                     equation(omega, 1 + epsilon**2 * frequency_shift(scales)),
                     seen.cell_frequency),
                Step("Their fundamental amplitude has no correction of order eps",
                     equation(size, sp.sqrt(square) / 2), seen.cell_amplitude),
            ]  # fmt: skip
        else:
            out.append(
                Step("The chain in phase steps of -pi/2, a unit of eps, n > 1: what is not real "
                     "turns the phases and shifts the frequency",
                     equation(r_rate, staggered(scales)), seen.staggered))  # fmt: skip
    return tuple(out)


if __name__ == "__main__":
    from derivations.catalogue import main

    sys.exit(main("second-order"))
