"""Averaging of the chain, Eqs. (31)-(38) and (43), and its decaying solution, for any chain."""

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
from derivations.algebra.steps import Derivation, Draft
from derivations.algebra.substitution import Eliminate, Substitute, mirrored
from derivations.averaging.checks import AveragingChecks
from derivations.averaging.symbols import A_n, divided, phi, psi, r, square, squares
from derivations.chain import PAPER, ChainModel
from derivations.multiple_scales.steps import derive as derive_scales
from derivations.symbols import alpha_0, epsilon, i, k_1, k_2, n, omega, t, y

# Formatted by hand: name, operation, sources, then check, number and note.
# fmt: off


@lru_cache(maxsize=8)
def derive(model: ChainModel = PAPER) -> Derivation:
    """Derive Eqs. (31)-(38) and (43) for a chain.

    Parameters
    ----------
    model : ChainModel
        The chain; by default that of Eq. (8).

    Returns
    -------
    Derivation
    """
    draft, checks = Draft(derive_scales(model)), AveragingChecks(model)
    _to_average(draft, model, checks)
    _decaying(draft, model, checks)
    _at_sites(draft, model, checks)
    _quarter_turn(draft, model, checks)
    title = "Averaging of the chain and its decaying solution (31)-(38), (43)"
    return draft.finished("averaging", title)


def _sites(model: ChainModel) -> tuple[sp.Expr, ...]:
    return tuple(n + offset for offset in range(-model.reach, model.reach + 1))


def _to_average(draft: Draft, model: ChainModel, checks: AveragingChecks) -> None:
    own, sites = psi(n, t), _sites(model)
    velocity = (own + sp.conjugate(own)) / 2
    draft.definition("complex variable",
                     sp.Tuple(equation(y(n, t), -i * (own - sp.conjugate(own)) / (2 * omega)),
                              equation(y(n, t).diff(t), velocity),
                              equation(y(n, t).diff(t, 2), own.diff(t) - i * omega * velocity)),
                     "the complex variable Ψ = ẏ + iωy; the third part is the derivative of the "
                     "second", check=checks.complex_variable, number=31)
    draft.derived("complex chain", Substitute(index=n, at=sites), "chain",
                  "complex variable", check=checks.complex_chain, number=32)
    turn = sp.exp(i * omega * t)
    draft.definition("envelope", equation(psi(n, t), phi(n, t) * turn),
                     "the envelope of the oscillation", check=checks.envelope)
    draft.derived("chain in the rotating frame", (Substitute(index=n, at=sites), Divide(turn)),
                  "complex chain", "envelope", check=checks.rotating, number=33)
    draft.derived("averaged chain", Average(omega * t), "chain in the rotating frame",
                  check=checks.averaged, number=34)
    draft.derived("averaged chain at unit frequency", Substitute({omega: 1}), "averaged chain",
                  check=checks.averaged_at_unit, number=43)


def _decaying(draft: Draft, model: ChainModel, checks: AveragingChecks) -> None:
    wave = alpha_0 * sp.exp((k_1 + i * k_2) * n)
    draft.ansatz("decaying wave", equation(phi(n, t), wave),
                 "a steady state that decays along the chain", check=checks.wave)
    draft.derived("balance", (Substitute(index=n, at=_sites(model)), Divide(wave)),
                  "averaged chain", "decaying wave", check=checks.balance, number=35,
                  note="With constant k₁ and k₂ it can hold at one site")
    draft.derived("balance in parts", RealAndImaginaryParts(), "balance",
                  check=checks.parts)
    draft.derived("frequency by amplitude", Substitute(), "breather frequency",
                  "half the amplitude", check=checks.frequency)
    isolate = Isolate((k_2,), (sp.sin(k_2), sp.cos(k_2)))
    draft.derived("phase step at any frequency", isolate, "balance in parts",
                  check=checks.isolated)
    draft.derived("phase step", (Substitute(), Rewrite(Form.CANCELLED)),
                  "phase step at any frequency", "frequency by amplitude", check=checks.phases,
                  number=36)
    draft.derived("phase step by displacement", Substitute({alpha_0: omega * alpha_0}),
                  "balance in parts", check=checks.parts_by_displacement,
                  note="By (31) |φ| = ω|y|: with α₀ the amplitude of y, as in (9), "
                       "(29) and (38), φ has ωα₀")
    draft.derived("phase step as ε vanishes", Limit(epsilon, 0), "phase step",
                  check=checks.limit)
    if model.reach > 2:  # an equation of the third degree in cos k₂
        return
    draft.derived("branches of the phase step", (Take(1), SolveFor(k_2)),
                  "phase step as ε vanishes", check=checks.branches)
    rule = ("sin k₂ < 0, as k₁ < 0 and positive damping of the site require: below the unstable "
            "cycle; above it, up to the stable one, the other sign holds")
    draft.derived("branch of the phase step", Take(0, rule), "branches of the phase step",
                  check=checks.branch)
    draft.derived("decay at a site", (Take(0), Rewrite(Form.EXCHANGED)),
                  "phase step as ε vanishes", check=checks.swapped)
    draft.derived("decay at a site in the branch", Substitute(), "decay at a site",
                  "branch of the phase step", check=checks.quarter)
    draft.derived("second relation", Join(), "decay at a site in the branch",
                  "branch of the phase step", check=checks.second_relation, number=37)


def _at_sites(draft: Draft, model: ChainModel, checks: AveragingChecks) -> None:
    """Derive what the decaying wave implies at several sites."""
    draft.derived("amplitudes", CompareFundamental(omega * t, A_n), "breather",
                  check=checks.amplitude, number=38)
    draft.definition("square of the amplitude", equation(square, alpha_0**2 * sp.exp(2 * k_1 * n)),
                     "the square of the amplitude of φ at site n", check=checks.square)
    draft.derived("damping of a site", Take(0), "balance in parts", check=checks.real_part)
    draft.derived("damping by amplitude", Eliminate((sp.exp(2 * k_1 * n),)), "damping of a site",
                  "square of the amplitude", check=checks.real_part)
    degree = max(model.damping) // 2
    draft.derived("two sites", DividedDifference(square, squares[:2], divided),
                  "damping by amplitude", check=checks.divided(2),
                  note="(35) at both sites demands that it vanishes")
    if degree <= 1:
        return
    draft.derived("too many sites", DividedDifference(square, squares[: degree + 1], divided),
                  "damping by amplitude", check=checks.divided(degree + 1),
                  note="(35) at all of them demands that it vanishes, and it "
                       "cannot: no decaying wave with constant k₁ solves (34)")


def _quarter_turn(draft: Draft, model: ChainModel, checks: AveragingChecks) -> None:
    turn = sp.exp(-i * sp.pi * n / 2) * sp.exp(i * epsilon * model.total_coupling * t)
    draft.ansatz("quarter-turn phase steps", equation(phi(n, t), r(n, t) * turn),
                 "the correct solution: phase steps of -π/2 from site to site, n ≥ 0",
                 check=checks.turned)
    unknown = r(n, t).diff(t)
    draft.derived("amplitudes in quarter turns",
                  (Substitute(index=n, at=_sites(model)), Divide(turn), SolveFor(unknown)),
                  "averaged chain at unit frequency", "quarter-turn phase steps",
                  check=checks.quarter_turn,
                  note="Springs to odd neighbours have real coefficients: real r remain real")
    draft.derived("averaged centre", (Substitute({n: 0}), mirrored(phi, t, model.reach)),
                  "averaged chain at unit frequency",
                  check=checks.averaged_centre)
    places = tuple(range(model.reach + 1))
    draft.derived("centre in quarter turns",
                  (Substitute(index=n, at=places), Divide(turn.subs(n, 0)),
                   SolveFor(unknown.subs(n, 0))),
                  "averaged centre", "quarter-turn phase steps",
                  check=checks.quarter_turn_centre)
    draft.ansatz("tail", equation(r(n, t), alpha_0 * sp.exp(k_1 * n)), "a small steady tail",
                 check=checks.tail_wave)
    draft.derived("decay of the tail",
                  (Substitute(index=n, at=_sites(model)), Divide(alpha_0 * sp.exp(k_1 * n)),
                   Limit(alpha_0, 0)), "amplitudes in quarter turns", "tail",
                  check=checks.tail)
