"""The central particle of the breather by multiple scales, Eqs. (8)-(30), for any chain."""

from __future__ import annotations

from functools import lru_cache

import sympy as sp

from derivations.algebra.equations import equation
from derivations.algebra.expansion import CollectPower, DifferentiateInScales, Limit, Truncate
from derivations.algebra.oscillation import (
    CompareFundamental,
    RealAndImaginaryParts,
    RemoveSecularTerms,
    SquareAndAdd,
)
from derivations.algebra.rearrangement import Apply, Divide, Function, Take
from derivations.algebra.solution import SelectSign, SolveFor, SolveOscillator
from derivations.algebra.steps import Derivation, Draft
from derivations.algebra.substitution import RescaleTime, Substitute, mirrored
from derivations.chain import PAPER, ChainModel
from derivations.multiple_scales.checks import ScalesChecks
from derivations.multiple_scales.symbols import Y_0, Y_1, A, R_slow, Y, theta_slow
from derivations.symbols import (
    R,
    alpha_0,
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

# Formatted by hand: name, operation, sources, then check, number and note.
# fmt: off


@lru_cache(maxsize=8)
def derive(model: ChainModel = PAPER) -> Derivation:
    """Derive Eqs. (8)-(30) for a chain.

    Parameters
    ----------
    model : ChainModel
        The chain; by default that of Eq. (8).

    Returns
    -------
    Derivation
    """
    draft, checks = Draft(), ScalesChecks(model)
    _to_orders(draft, model, checks)
    _to_amplitudes(draft, checks)
    _self_consistent(draft, checks)
    _to_breather(draft, model, checks)
    return draft.finished("multiple-scales", "Multiple scales for the central particle (8)-(30)")


def _to_orders(draft: Draft, given: ChainModel, checks: ScalesChecks) -> None:
    draft.model("chain", given.equation(), "the chain of self-excited oscillators",
                check=checks.chain, number=8)
    wave = alpha_0 * sp.exp(k_1 * sp.Abs(n)) * sp.sin(omega * t + k_2 * sp.Abs(n))
    draft.ansatz("breather", equation(y(n, t), wave),
                 "the same decay rate and phase step at every site", check=checks.ansatz,
                 number=9)
    neighbours = tuple(range(1, given.reach + 1))
    draft.derived("centre", (Substitute({n: 0}), mirrored(y, t, given.reach)), "chain",
                  check=checks.centre, number=10)
    draft.derived("forced centre", Substitute(index=n, at=neighbours), "centre", "breather",
                  check=checks.forced, number=11)
    draft.ansatz("frequency", equation(omega, 1 + epsilon * omega_1 + epsilon**2 * omega_2),
                 "expand the frequency in ε", check=checks.frequency, number=12)
    draft.definition("time scales",
                     sp.Tuple(equation(t_hat, omega * t), equation(tau, epsilon * t)),
                     "a fast time and a slow time", check=checks.times, number=13)
    draft.derived("chain rule", DifferentiateInScales(y(0, t), Y, t), "time scales",
                  check=checks.chain_rule, number=14)
    draft.derived("centre in two times", RescaleTime(y(0, t), Y, t), "forced centre", "time scales",
                  "chain rule", check=checks.in_two_times)
    draft.derived("centre to order eps", Truncate(epsilon, 1), "centre in two times",
                  check=checks.two_times, number=15, note="ω is left as it is")
    draft.derived("centre with the frequency expanded", (Substitute(), Truncate(epsilon, 1)),
                  "centre to order eps", "frequency", check=checks.expanded, number=16)
    draft.ansatz("expansion", equation(Y, Y_0 + epsilon * Y_1), "expand the solution in ε",
                 check=checks.expansion, number=17)
    draft.derived("centre with the solution expanded", Substitute(),
                  "centre with the frequency expanded", "expansion",
                  check=checks.solution_put)
    draft.derived("order 1", CollectPower(epsilon, 0), "centre with the solution expanded",
                  check=checks.order_zero, number=18)
    draft.derived("order eps", CollectPower(epsilon, 1, Y_1), "centre with the solution expanded",
                  check=checks.order_one, number=19)
    draft.derived("free oscillation", SolveOscillator(t_hat, A), "order 1",
                  check=checks.free_solution, number=20)


def _to_amplitudes(draft: Draft, checks: ScalesChecks) -> None:
    turn = sp.exp(i * theta_slow)
    draft.derived("secular condition", RemoveSecularTerms(t_hat, Y_1), "order eps",
                  "free oscillation", check=checks.secular, number=21)
    draft.definition("polar form", equation(A, R_slow * turn),
                     "modulus and argument of the amplitude", check=checks.polar,
                     number=22)
    draft.derived("secular condition in polar form", (Substitute(), Divide(turn)),
                  "secular condition", "polar form", check=checks.secular_polar,
                  number=23)
    draft.derived("amplitude and phase", RealAndImaginaryParts(imaginary_first=True),
                  "secular condition in polar form", check=checks.parts, number=24)
    draft.derived("steady amplitude and phase", Substitute({R_slow: R, theta_slow: theta}),
                  "amplitude and phase", check=checks.steady_parts, number=25)


def _self_consistent(draft: Draft, checks: ScalesChecks) -> None:
    """Require site 0 to move as was assumed."""
    draft.derived("assumed motion of site 0", Substitute({n: 0}), "breather",
                  check=checks.central_motion)
    draft.derived("assumed motion in two times", RescaleTime(y(0, t), Y, t),
                  "assumed motion of site 0", "time scales", check=checks.central_motion)
    settled = (Substitute(), Substitute({R_slow: R, theta_slow: theta}))
    draft.derived("steady free oscillation", settled, "free oscillation", "polar form",
                  check=checks.steady_oscillation)
    draft.derived("self-consistency", CompareFundamental(t_hat), "assumed motion in two times",
                  "steady free oscillation", check=checks.match,
                  note="The paper uses the first part; the second fixes the phase, "
                       "θ = -π/2")
    draft.derived("amplitude of site 0", Take(0), "self-consistency",
                  check=checks.doubled)
    draft.derived("own amplitude", (Substitute(), Divide(R)), "steady amplitude and phase",
                  "amplitude of site 0",
                  check=checks.own)


def _to_breather(draft: Draft, given: ChainModel, checks: ScalesChecks) -> None:
    """Derive decay and frequency of the breather."""
    draft.derived("modulus", SquareAndAdd(theta), "own amplitude", check=checks.modulus, number=26)
    draft.derived("frequency with neighbours at rest",
                  (Take(1), Limit(k_1, -sp.oo), SolveFor(omega_1)), "own amplitude",
                  check=checks.free_frequency)
    draft.derived("close frequency", (Substitute({omega_1: omega_1 - delta}), SolveFor(omega_1)),
                  "frequency with neighbours at rest", check=checks.close_frequency, number=27,
                  assumes=True)
    draft.derived("detuning", (Take(1), SolveFor(omega_1)), "own amplitude", check=checks.detuning,
                  note="By (27) the addition to the frequency with neighbours at "
                       "rest is δ itself: it vanishes where the neighbours pull in "
                       "quadrature, k₂ - θ = 0 for the nearest ones")
    draft.derived("modulus with detuning", Substitute(), "modulus", "close frequency",
                  check=checks.detuned)
    draft.derived("modulus without detuning", Truncate(delta, 1), "modulus with detuning",
                  check=checks.neglected, number=28)
    draft.derived("relative error", Divide(), "modulus with detuning", check=checks.cost,
                  note="The term with δ² is the relative error of (28): small "
                       "needs δ ≪ c e^(k₁), not only δ ≪ c")
    draft.derived("half the amplitude", SolveFor(R), "amplitude of site 0", check=checks.doubled)
    if any(power % 2 == 0 for power in given.damping):  # odd powers average to zero
        _decay(draft, given, checks)
    draft.derived("frequency at no detuning", Substitute({delta: 0}), "close frequency",
                  check=checks.free_frequency)
    draft.derived("breather frequency", (Substitute(), Truncate(epsilon, 1)), "frequency",
                  "frequency at no detuning", check=checks.breather_frequency,
                  number=30)


def _decay(draft: Draft, given: ChainModel, checks: ScalesChecks) -> None:
    """Derive the decay of the breather for a cell that both gains and loses energy."""
    draft.derived("both signs of the decay",
                  (Divide(4 * given.coupling**2), Apply(Function.SQUARE_ROOT)),
                  "modulus without detuning", check=checks.branches)
    draft.derived("loss of the cell", (Take(0), Limit(k_1, -sp.oo)), "own amplitude",
                  check=checks.loss, note="with neighbours at rest")
    rule = ("e^(k₁) > 0 where the cell feeds energy into its motion, between its "
            "two cycles; the other sign holds where the cell loses energy")
    draft.derived("decay", SelectSign(rule), "both signs of the decay", "loss of the cell",
                  check=checks.decay)
    draft.derived("decay of the amplitude", Substitute(), "decay", "half the amplitude",
                  check=checks.decay, number=29)
