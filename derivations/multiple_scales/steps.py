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
from derivations.multiple_scales import definition_checks as definitions
from derivations.multiple_scales.resonance_checks import ResonanceChecks
from derivations.multiple_scales.symbols import Y_0, Y_1, A, R_slow, Y, theta_slow
from derivations.multiple_scales.two_times_checks import TwoTimesChecks
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
    draft, resonance = Draft(), ResonanceChecks(model)
    _to_orders(draft, model, TwoTimesChecks(model))
    _to_amplitudes(draft, resonance)
    _self_consistent(draft, resonance)
    _to_breather(draft, model, resonance)
    return draft.finished("multiple-scales", "Multiple scales for the central particle (8)-(30)")


def _to_orders(draft: Draft, given: ChainModel, two_times: TwoTimesChecks) -> None:
    draft.model("chain", given.equation(), "the chain of self-excited oscillators",
                check=two_times.chain, number=8)
    wave = alpha_0 * sp.exp(k_1 * sp.Abs(n)) * sp.sin(omega * t + k_2 * sp.Abs(n))
    draft.ansatz("breather", equation(y(n, t), wave),
                 "the same decay rate and phase step at every site", check=definitions.ansatz,
                 number=9)
    neighbours = tuple(range(1, given.reach + 1))
    draft.derived("centre", (Substitute({n: 0}), mirrored(y, t, given.reach)), "chain",
                  check=two_times.centre, number=10)
    draft.derived("forced centre", Substitute(index=n, at=neighbours), "centre", "breather",
                  check=two_times.forced, number=11)
    draft.ansatz("frequency", equation(omega, 1 + epsilon * omega_1 + epsilon**2 * omega_2),
                 "expand the frequency in ε", check=definitions.frequency, number=12)
    draft.definition("time scales",
                     sp.Tuple(equation(t_hat, omega * t), equation(tau, epsilon * t)),
                     "a fast time and a slow time", check=definitions.times, number=13)
    draft.derived("chain rule", DifferentiateInScales(y(0, t), Y, t), "time scales",
                  check=definitions.chain_rule, number=14)
    draft.derived("centre in two times", RescaleTime(y(0, t), Y, t), "forced centre", "time scales",
                  "chain rule", check=two_times.in_two_times)
    draft.derived("centre to order eps", Truncate(epsilon, 1), "centre in two times",
                  check=two_times.two_times, number=15, note="ω is left as it is")
    draft.derived("centre with the frequency expanded", (Substitute(), Truncate(epsilon, 1)),
                  "centre to order eps", "frequency", check=two_times.expanded, number=16)
    draft.ansatz("expansion", equation(Y, Y_0 + epsilon * Y_1), "expand the solution in ε",
                 check=definitions.expansion, number=17)
    draft.derived("centre with the solution expanded", Substitute(),
                  "centre with the frequency expanded", "expansion",
                  check=two_times.solution_put)
    draft.derived("order 1", CollectPower(epsilon, 0), "centre with the solution expanded",
                  check=two_times.order_zero, number=18)
    draft.derived("order eps", CollectPower(epsilon, 1, Y_1), "centre with the solution expanded",
                  check=two_times.order_one, number=19)
    draft.derived("free oscillation", SolveOscillator(t_hat, A), "order 1",
                  check=definitions.free_solution, number=20)


def _to_amplitudes(draft: Draft, resonance: ResonanceChecks) -> None:
    turn = sp.exp(i * theta_slow)
    draft.derived("secular condition", RemoveSecularTerms(t_hat, Y_1), "order eps",
                  "free oscillation", check=resonance.secular, number=21)
    draft.definition("polar form", equation(A, R_slow * turn),
                     "modulus and argument of the amplitude", check=definitions.polar,
                     number=22)
    draft.derived("secular condition in polar form", (Substitute(), Divide(turn)),
                  "secular condition", "polar form", check=resonance.secular_polar,
                  number=23)
    draft.derived("amplitude and phase", RealAndImaginaryParts(imaginary_first=True),
                  "secular condition in polar form", check=resonance.parts, number=24)
    draft.derived("steady amplitude and phase", Substitute({R_slow: R, theta_slow: theta}),
                  "amplitude and phase", check=resonance.steady_parts, number=25)


def _self_consistent(draft: Draft, resonance: ResonanceChecks) -> None:
    """Require site 0 to move as was assumed."""
    draft.derived("assumed motion of site 0", Substitute({n: 0}), "breather",
                  check=definitions.central_motion)
    draft.derived("assumed motion in two times", RescaleTime(y(0, t), Y, t),
                  "assumed motion of site 0", "time scales", check=definitions.central_motion)
    settled = (Substitute(), Substitute({R_slow: R, theta_slow: theta}))
    draft.derived("steady free oscillation", settled, "free oscillation", "polar form",
                  check=definitions.steady_oscillation)
    draft.derived("self-consistency", CompareFundamental(t_hat), "assumed motion in two times",
                  "steady free oscillation", check=definitions.match,
                  note="The paper uses the first part; the second fixes the phase, "
                       "θ = -π/2")
    draft.derived("amplitude of site 0", Take(0), "self-consistency",
                  check=definitions.doubled)
    draft.derived("own amplitude", (Substitute(), Divide(R)), "steady amplitude and phase",
                  "amplitude of site 0",
                  check=resonance.own)


def _to_breather(draft: Draft, given: ChainModel, resonance: ResonanceChecks) -> None:
    """Derive decay and frequency of the breather."""
    draft.derived("modulus", SquareAndAdd(theta), "own amplitude",
                  check=resonance.modulus, number=26)
    draft.derived("frequency with neighbours at rest",
                  (Take(1), Limit(k_1, -sp.oo), SolveFor(omega_1)), "own amplitude",
                  check=resonance.free_frequency)
    draft.derived("close frequency", (Substitute({omega_1: omega_1 - delta}), SolveFor(omega_1)),
                  "frequency with neighbours at rest", check=resonance.close_frequency, number=27,
                  assumes=True)
    draft.derived("detuning", (Take(1), SolveFor(omega_1)), "own amplitude",
                  check=resonance.detuning,
                  note="By (27) the addition to the frequency with neighbours at "
                       "rest is δ itself: it vanishes where the neighbours pull in "
                       "quadrature, k₂ - θ = 0 for the nearest ones")
    draft.derived("modulus with detuning", Substitute(), "modulus", "close frequency",
                  check=resonance.detuned)
    draft.derived("modulus without detuning", Truncate(delta, 1), "modulus with detuning",
                  check=resonance.neglected, number=28)
    draft.derived("relative error", Divide(), "modulus with detuning", check=resonance.cost,
                  note="The term with δ² is the relative error of (28): small "
                       "needs δ ≪ c e^(k₁), not only δ ≪ c")
    draft.derived("half the amplitude", SolveFor(R), "amplitude of site 0",
                  check=definitions.doubled)
    if any(power % 2 == 0 for power in given.damping):  # odd powers average to zero
        _decay(draft, given, resonance)
    draft.derived("frequency at no detuning", Substitute({delta: 0}), "close frequency",
                  check=resonance.free_frequency)
    draft.derived("breather frequency", (Substitute(), Truncate(epsilon, 1)), "frequency",
                  "frequency at no detuning", check=resonance.breather_frequency,
                  number=30)


def _decay(draft: Draft, given: ChainModel, resonance: ResonanceChecks) -> None:
    """Derive the decay of the breather for a cell that both gains and loses energy."""
    draft.derived("both signs of the decay",
                  (Divide(4 * given.coupling**2), Apply(Function.SQUARE_ROOT)),
                  "modulus without detuning", check=resonance.branches)
    draft.derived("loss of the cell", (Take(0), Limit(k_1, -sp.oo)), "own amplitude",
                  check=resonance.loss, note="with neighbours at rest")
    rule = ("e^(k₁) > 0 where the cell feeds energy into its motion, between its "
            "two cycles; the other sign holds where the cell loses energy")
    draft.derived("decay", SelectSign(rule), "both signs of the decay", "loss of the cell",
                  check=resonance.decay)
    draft.derived("decay of the amplitude", Substitute(), "decay", "half the amplitude",
                  check=resonance.decay, number=29)
