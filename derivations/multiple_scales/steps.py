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
from derivations.algebra.solution import SolveFor, SolveOscillator
from derivations.algebra.steps import Derivation, Step, ansatz, definition, derived, model
from derivations.algebra.substitution import RescaleTime, Substitute, mirrored
from derivations.chain import PAPER, ChainModel
from derivations.multiple_scales.checks import Checks
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


@lru_cache(maxsize=8)
def derive(model: ChainModel = PAPER) -> Derivation:
    """Derive Eqs. (8)-(30) for a chain.

    Parameters
    ----------
    model : ChainModel
        The chain; that of Eq. (8) if left out.

    Returns
    -------
    Derivation
    """
    checks = Checks(model)
    orders = _to_orders(model, checks)
    amplitudes = _to_amplitudes(orders, checks)
    consistent = _self_consistent(orders, amplitudes, checks)
    steps = (*orders, *amplitudes, *consistent, *_to_breather(model, orders, consistent, checks))
    return Derivation("multiple-scales", "Multiple scales for the central particle (8)-(30)", steps)


def chain(given: ChainModel, checks: Checks | None = None) -> Step:
    """Return the step of Eq. (8), from which all of part 2 follows."""
    return model(
        "chain", given.equation(), "the chain of self-excited oscillators",
        check=(checks or Checks(given)).chain, number=8,
    )  # fmt: skip


def breather_ansatz() -> Step:
    """Return the step of Eq. (9)."""
    wave = alpha_0 * sp.exp(k_1 * sp.Abs(n)) * sp.sin(omega * t + k_2 * sp.Abs(n))
    return ansatz(
        "breather", equation(y(n, t), wave), "the same decay rate and phase step at every site",
        check=Checks.ansatz, number=9,
    )  # fmt: skip


def _to_orders(given: ChainModel, checks: Checks) -> tuple[Step, ...]:
    first = chain(given, checks)
    wave = breather_ansatz()
    neighbours = tuple(range(1, given.reach + 1))
    centre = derived(
        "centre", (Substitute({n: 0}), mirrored(y, t, given.reach)), first,
        check=checks.centre, number=10,
    )  # fmt: skip
    forced = derived(
        "forced centre", Substitute(index=n, at=neighbours), centre, wave,
        check=checks.forced, number=11,
    )  # fmt: skip
    frequency = ansatz(
        "frequency", equation(omega, 1 + epsilon * omega_1 + epsilon**2 * omega_2),
        "expand the frequency in ε", check=checks.frequency, number=12,
    )  # fmt: skip
    scales = definition(
        "time scales", sp.Tuple(equation(t_hat, omega * t), equation(tau, epsilon * t)),
        "a fast time and a slow time", check=checks.times, number=13,
    )  # fmt: skip
    rates = derived(
        "chain rule", DifferentiateInScales(y(0, t), Y, t), scales,
        check=checks.chain_rule, number=14,
    )  # fmt: skip
    scaled = derived(
        "centre in two times", RescaleTime(y(0, t), Y, t), forced, scales, rates,
        check=checks.in_two_times,
    )  # fmt: skip
    truncated = derived(
        "centre to order eps", Truncate(epsilon, 1), scaled, check=checks.two_times, number=15,
        note="ω is left as it is",
    )  # fmt: skip
    expanded = derived(
        "centre with the frequency expanded", (Substitute(), Truncate(epsilon, 1)), truncated,
        frequency, check=checks.expanded, number=16,
    )  # fmt: skip
    solution = ansatz(
        "expansion", equation(Y, Y_0 + epsilon * Y_1), "expand the solution in ε",
        check=checks.expansion, number=17,
    )  # fmt: skip
    put = derived(
        "centre with the solution expanded", Substitute(), expanded, solution,
        check=checks.solution_put,
    )  # fmt: skip
    order_0 = derived("order 1", CollectPower(epsilon, 0), put, check=checks.order_zero, number=18)
    order_1 = derived(
        "order eps", CollectPower(epsilon, 1, Y_1), put, check=checks.order_one, number=19
    )
    free = derived(
        "free oscillation", SolveOscillator(t_hat, A), order_0,
        check=checks.free_solution, number=20,
    )  # fmt: skip
    return (first, wave, centre, forced, frequency, scales, rates, scaled, truncated, expanded,
            solution, put, order_0, order_1, free)  # fmt: skip


def _to_amplitudes(orders: tuple[Step, ...], checks: Checks) -> tuple[Step, ...]:
    *_, order_1, free = orders
    turn = sp.exp(i * theta_slow)
    secular = derived(
        "secular condition", RemoveSecularTerms(t_hat, Y_1), order_1, free,
        check=checks.secular, number=21,
    )  # fmt: skip
    polar = definition(
        "polar form", equation(A, R_slow * turn), "modulus and argument of the amplitude",
        check=checks.polar, number=22,
    )  # fmt: skip
    turned = derived(
        "secular condition in polar form", (Substitute(), Divide(turn)), secular, polar,
        check=checks.secular_polar, number=23,
    )  # fmt: skip
    both = derived(
        "amplitude and phase", RealAndImaginaryParts(imaginary_first=True), turned,
        check=checks.parts, number=24,
    )  # fmt: skip
    steady = derived(
        "steady amplitude and phase", Substitute({R_slow: R, theta_slow: theta}), both,
        check=checks.steady_parts, number=25,
    )  # fmt: skip
    return secular, polar, turned, both, steady


def _self_consistent(
    orders: tuple[Step, ...], amplitudes: tuple[Step, ...], checks: Checks
) -> tuple[Step, ...]:
    """Return what it means that site 0 moves as was assumed of it."""
    wave, scales, free = orders[1], orders[5], orders[-1]
    polar, steady = amplitudes[1], amplitudes[-1]
    central = derived("assumed motion of site 0", Substitute({n: 0}), wave,
                      check=checks.central_motion)  # fmt: skip
    rescaled = derived("assumed motion in two times", RescaleTime(y(0, t), Y, t), central, scales,
                       check=checks.central_motion)  # fmt: skip
    settled = (Substitute(), Substitute({R_slow: R, theta_slow: theta}))
    fundamental = derived("steady free oscillation", settled, free, polar,
                          check=checks.steady_oscillation)  # fmt: skip
    match = derived(
        "self-consistency", CompareFundamental(t_hat), rescaled, fundamental, check=checks.match,
        note="The paper uses the first part; the second fixes the phase, θ = -π/2",
    )  # fmt: skip
    doubled = derived("amplitude of site 0", Take(0), match, check=checks.doubled)
    own = derived("own amplitude", (Substitute(), Divide(R)), steady, doubled,
                  check=checks.own)  # fmt: skip
    return central, rescaled, fundamental, match, doubled, own


def _to_breather(
    given: ChainModel, orders: tuple[Step, ...], consistent: tuple[Step, ...], checks: Checks
) -> tuple[Step, ...]:
    """Return decay and frequency of the breather."""
    frequency, (*_, doubled, own) = orders[4], consistent
    modulus = derived("modulus", SquareAndAdd(theta), own, check=checks.modulus, number=26)
    free_frequency = derived(
        "frequency with neighbours at rest",
        (Take(1), Limit(k_1, -sp.oo), SolveFor(omega_1)), own, check=checks.free_frequency,
    )  # fmt: skip
    close = derived(
        "close frequency", (Substitute({omega_1: omega_1 - delta}), SolveFor(omega_1)),
        free_frequency, check=checks.close_frequency,
        number=27, assumes=True,
    )  # fmt: skip
    exact = derived(
        "detuning", (Take(1), SolveFor(omega_1)), own, check=checks.detuning,
        note="By (27) what is added to the frequency with neighbours at rest is δ itself: it "
        "vanishes where the neighbours pull in quadrature, k₂ - θ = 0 for the nearest ones",
    )  # fmt: skip
    detuned = derived("modulus with detuning", Substitute(), modulus, close,
                      check=checks.detuned)  # fmt: skip
    neglected = derived(
        "modulus without detuning", Truncate(delta, 1), detuned, check=checks.neglected,
        number=28,
    )  # fmt: skip
    cost = derived(
        "relative error", Divide(), detuned, check=checks.cost,
        note="The term with δ² is the relative error of (28): small needs δ ≪ c e^(k₁), not only "
        "δ ≪ c",
    )  # fmt: skip
    branches = derived(
        "both signs of the decay",
        (Divide(4 * given.coupling**2), Apply(Function.SQUARE_ROOT)),
        neglected,
        check=checks.branches,
    )
    halved = derived("half the amplitude", SolveFor(R), doubled, check=checks.doubled)
    rule = ("the minus sign: e^(k₁) > 0 where the cell feeds energy into its motion, between its "
            "two cycles; the plus sign holds where the cell loses energy")  # fmt: skip
    kept = derived("decay", Take(1, rule), branches, check=checks.decay_of_radius)
    decay = derived("decay of the amplitude", Substitute(), kept, halved,
                    check=checks.decay, number=29)  # fmt: skip
    undetuned = derived("frequency at no detuning", Substitute({delta: 0}), close,
                        check=checks.free_frequency)  # fmt: skip
    breather_frequency = derived(
        "breather frequency", (Substitute(), Truncate(epsilon, 1)), frequency, undetuned,
        check=checks.breather_frequency, number=30,
    )  # fmt: skip
    return (modulus, free_frequency, close, exact, detuned, neglected, cost, branches, halved, kept,
            decay, undetuned, breather_frequency)  # fmt: skip
