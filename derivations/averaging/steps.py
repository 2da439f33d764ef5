"""Averaging of the chain, Eqs. (31)-(38) and (43), and what decays along it, for any chain."""

from __future__ import annotations

from functools import lru_cache

import sympy as sp

from derivations.algebra.equations import equation
from derivations.algebra.expansion import Limit
from derivations.algebra.oscillation import Average, CompareFundamental, RealAndImaginaryParts
from derivations.algebra.rearrangement import (
    Divide,
    DividedDifference,
    Form,
    Isolate,
    Join,
    Rewrite,
    Take,
)
from derivations.algebra.solution import SolveFor
from derivations.algebra.steps import Derivation, Step, ansatz, definition, derived
from derivations.algebra.substitution import Eliminate, Substitute, mirrored
from derivations.averaging.checks import Checks
from derivations.averaging.symbols import A_n, divided, phi, psi, r, square, squares
from derivations.chain import PAPER, ChainModel
from derivations.multiple_scales.steps import derive as derive_scales
from derivations.symbols import alpha_0, epsilon, i, k_1, k_2, n, omega, t, y


@lru_cache(maxsize=8)
def derive(model: ChainModel = PAPER) -> Derivation:
    """Derive Eqs. (31)-(38) and (43) for a chain.

    Parameters
    ----------
    model : ChainModel
        The chain; that of Eq. (8) if left out.

    Returns
    -------
    Derivation
    """
    checks = Checks(model)
    scales = derive_scales(model)
    averages = _to_average(model, scales, checks)
    decaying = _decaying(model, scales, averages, checks)
    steps = (*averages, *decaying, *_at_sites(model, scales.numbered(9), decaying[2], checks),
             *_staggered(model, averages, checks))  # fmt: skip
    title = "Averaging of the chain and its decaying solution (31)-(38), (43)"
    return Derivation("averaging", title, steps)


def _sites(model: ChainModel) -> tuple[sp.Expr, ...]:
    return tuple(n + offset for offset in range(-model.reach, model.reach + 1))


def _to_average(model: ChainModel, scales: Derivation, checks: Checks) -> tuple[Step, ...]:
    own, sites = psi(n, t), _sites(model)
    velocity = (own + sp.conjugate(own)) / 2
    variable = definition(
        "complex variable",
        sp.Tuple(
            equation(y(n, t), -i * (own - sp.conjugate(own)) / (2 * omega)),
            equation(y(n, t).diff(t), velocity),
            equation(y(n, t).diff(t, 2), own.diff(t) - i * omega * velocity),
        ),
        "the complex variable Ψ = ẏ + iωy; the third part is the derivative of the second",
        check=checks.complex_variable, number=31,
    )  # fmt: skip
    chain = derived(
        "complex chain", Substitute(index=n, at=sites), scales.numbered(8), variable,
        check=checks.complex_chain, number=32,
    )  # fmt: skip
    turn = sp.exp(i * omega * t)
    frame = definition("envelope", equation(psi(n, t), phi(n, t) * turn),
                       "the envelope of the oscillation", check=checks.envelope)  # fmt: skip
    rotating = derived(
        "chain in the rotating frame", (Substitute(index=n, at=sites), Divide(turn)), chain, frame,
        check=checks.rotating, number=33,
    )  # fmt: skip
    averaged = derived("averaged chain", Average(omega * t), rotating, check=checks.averaged,
                       number=34)  # fmt: skip
    unit = derived("averaged chain at unit frequency", Substitute({omega: 1}), averaged,
                   check=checks.averaged_at_unit, number=43)  # fmt: skip
    return variable, chain, frame, rotating, averaged, unit


def _decaying(
    model: ChainModel, scales: Derivation, averages: tuple[Step, ...], checks: Checks
) -> tuple[Step, ...]:
    averaged = averages[4]
    wave = alpha_0 * sp.exp((k_1 + i * k_2) * n)
    decaying = ansatz("decaying wave", equation(phi(n, t), wave),
                      "a steady state that decays along the chain", check=checks.wave)  # fmt: skip
    balance = derived(
        "balance", (Substitute(index=n, at=_sites(model)), Divide(wave)), averaged, decaying,
        check=checks.balance, number=35, note="With constant k₁ and k₂ it can hold at one site",
    )  # fmt: skip
    parts = derived("balance in parts", RealAndImaginaryParts(), balance, check=checks.parts)
    frequency = derived(
        "frequency by amplitude", Substitute(), scales.numbered(30),
        scales.named("half the amplitude"), check=checks.frequency,
    )  # fmt: skip
    isolate = Isolate((k_2,), (sp.sin(k_2), sp.cos(k_2)))
    isolated = derived("phase step at any frequency", isolate, parts,
                       check=checks.isolated)  # fmt: skip
    phases = derived("phase step", (Substitute(), Rewrite(Form.CANCELLED)), isolated, frequency,
                     check=checks.phases, number=36)  # fmt: skip
    by_displacement = derived(
        "phase step by displacement", Substitute({alpha_0: omega * alpha_0}), parts,
        check=checks.parts_by_displacement,
        note="By (31) |φ| = ω|y|: with α₀ the amplitude of y, as in (9), (29) and (38), φ has ωα₀",
    )  # fmt: skip
    limit = derived("phase step as eps vanishes", Limit(epsilon, 0), phases,
                    check=checks.limit)  # fmt: skip
    branches = derived("branches of the phase step", (Take(1), SolveFor(k_2)), limit,
                       check=checks.branches)  # fmt: skip
    rule = ("sin k₂ < 0, as k₁ < 0 and positive damping of the site require: below the unstable "
            "cycle; above it, up to the stable one, the other sign holds")  # fmt: skip
    branch = derived("branch of the phase step", Take(0, rule), branches,
                     check=checks.branch)  # fmt: skip
    relation = derived(
        "decay at a site", (Take(0), Rewrite(Form.EXCHANGED)), limit, check=checks.swapped
    )
    quarter = derived("decay at a site in the branch", Substitute(), relation, branch,
                      check=checks.quarter)  # fmt: skip
    both = derived("second relation", Join(), quarter, branch, check=checks.second_relation,
                   number=37)  # fmt: skip
    return (decaying, balance, parts, frequency, isolated, phases, by_displacement, limit, branches,
            branch, relation, quarter, both)  # fmt: skip


def _at_sites(model: ChainModel, wave: Step, parts: Step, checks: Checks) -> tuple[Step, ...]:
    """Return what the decaying wave amounts to at several sites."""
    amplitude = derived("amplitudes", CompareFundamental(omega * t, A_n), wave,
                        check=checks.amplitude, number=38)  # fmt: skip
    size = definition("square of the amplitude", equation(square, alpha_0**2 * sp.exp(2 * k_1 * n)),
                      "the square of the amplitude of φ at site n",
                      check=checks.square)  # fmt: skip
    loss = derived("damping of a site", Take(0), parts, check=checks.real_part)
    by_size = derived(
        "damping by amplitude", Eliminate((sp.exp(2 * k_1 * n),)), loss, size, check=checks.by_size
    )
    degree = max(model.damping) // 2
    two = derived(
        "two sites", DividedDifference(square, squares[:2], divided), by_size,
        check=checks.divided(2), note="(35) at both sites demands that it vanishes",
    )  # fmt: skip
    found = (amplitude, size, loss, by_size, two)
    if degree <= 1:
        return found
    many = derived(
        "too many sites", DividedDifference(square, squares[: degree + 1], divided), by_size,
        check=checks.divided(degree + 1),
        note="(35) at all of them demands that it vanishes, and it cannot: no decaying wave "
        "with constant k₁ solves (34)",
    )  # fmt: skip
    return (*found, many)


def _staggered(model: ChainModel, averages: tuple[Step, ...], checks: Checks) -> tuple[Step, ...]:
    unit = averages[5]
    turn = sp.exp(-i * sp.pi * n / 2) * sp.exp(i * epsilon * model.total_coupling * t)
    shape = ansatz(
        "quarter-turn phase steps", equation(phi(n, t), r(n, t) * turn),
        "what is true instead: phase steps of -π/2 from site to site, n ≥ 0", check=checks.turned,
    )  # fmt: skip
    unknown = r(n, t).diff(t)
    along = derived(
        "amplitudes in quarter turns",
        (Substitute(index=n, at=_sites(model)), Divide(turn), SolveFor(unknown)), unit, shape,
        check=checks.staggered,
        note="Springs to odd neighbours have real coefficients: real r stay real",
    )  # fmt: skip
    middle = derived("averaged centre", (Substitute({n: 0}), mirrored(phi, t, model.reach)), unit,
                     check=checks.averaged_centre)  # fmt: skip
    places = tuple(range(model.reach + 1))
    centre = derived(
        "centre in quarter turns",
        (Substitute(index=n, at=places), Divide(turn.subs(n, 0)), SolveFor(unknown.subs(n, 0))),
        middle, shape, check=checks.staggered_centre,
    )  # fmt: skip
    tail = ansatz("tail", equation(r(n, t), alpha_0 * sp.exp(k_1 * n)),
                  "a small steady tail", check=checks.tail_wave)  # fmt: skip
    decay = derived(
        "decay of the tail",
        (Substitute(index=n, at=_sites(model)), Divide(alpha_0 * sp.exp(k_1 * n)),
         Limit(alpha_0, 0)),
        along, tail, check=checks.tail,
    )  # fmt: skip
    return shape, along, middle, centre, tail, decay
