"""The next order in eps, for the cell and for the chain, by both routes, for any chain."""

from __future__ import annotations

from dataclasses import replace

import sympy as sp

from derivations.algebra.amplitudes import (
    ChangeAmplitude,
    FindModulation,
    FundamentalOfAverage,
    NextHarmonics,
    Route,
    SeekCycles,
)
from derivations.algebra.equations import equation
from derivations.algebra.rearrangement import Divide, Take
from derivations.algebra.solution import SolveFor
from derivations.algebra.steps import Derivation, Step, ansatz, derived, model
from derivations.algebra.substitution import EliminatePowers, Substitute
from derivations.averaging.second_order_checks import SecondOrderChecks
from derivations.averaging.symbols import (
    amplitude,
    fundamental,
    phi,
    rho,
    size,
    square,
    turn,
    y_next,
)
from derivations.chain import PAPER, ChainModel
from derivations.multiple_scales.steps import chain as chain_step
from derivations.multiple_scales.steps import derive as derive_scales
from derivations.symbols import epsilon, i, n, omega, t


def derive(model: ChainModel = PAPER) -> Derivation:
    """Derive the second order on its own.

    Parameters
    ----------
    model : ChainModel
        The chain; that of Eq. (8) if left out.
    """
    start = chain_step(model)
    return Derivation("second-order", "Second order for the cell and the chain",
                      (start, *steps(model, start)))  # fmt: skip


def extended(derivation: Derivation, model: ChainModel = PAPER) -> Derivation:
    """Return a derivation of the chain carried on to second order.

    Parameters
    ----------
    derivation : Derivation
        Multiple scales or averaging, to first order.
    model : ChainModel
        Its chain.
    """
    start = derive_scales(model).numbered(8)
    return replace(derivation, steps=(*derivation.steps, *steps(model, start)))


def steps(given: ChainModel, chain: Step) -> tuple[Step, ...]:
    """Second order by both routes, and what it predicts.

    Parameters
    ----------
    given : ChainModel
        The chain.
    chain : Step
        The step of Eq. (8).
    """
    alone = given.cell()
    cell = model("cell", alone.equation(), "the isolated cell of (8), without springs",
                 check=SecondOrderChecks(alone).motion)  # fmt: skip
    routes = _routes("cell", cell, SecondOrderChecks(alone))
    return (cell, *routes, *_cycle(cell, routes[0], SecondOrderChecks(alone)),
            *_chain(chain, given))  # fmt: skip


def _routes(name: str, start: Step, checks: SecondOrderChecks) -> tuple[Step, ...]:
    scales = derived(f"modulation by multiple scales, {name}",
                     FindModulation(Route.MULTIPLE_SCALES, epsilon, amplitude), start,
                     check=checks.scales)  # fmt: skip
    averaged = derived(
        f"modulation by averaging, {name}",
        FindModulation(Route.AVERAGING, epsilon, phi),
        start,
        check=checks.averaging,
    )
    visible = derived(f"fundamental of the average, {name}",
                      FundamentalOfAverage(epsilon, phi, fundamental), start,
                      check=checks.fundamental)  # fmt: skip
    carried = derived(
        f"averaging in the amplitude of multiple scales, {name}",
        ChangeAmplitude(epsilon, phi, amplitude), averaged, visible, check=checks.scales,
        note="It is the same polynomial as by multiple scales",
    )  # fmt: skip
    return scales, averaged, visible, carried


def _cycle(cell: Step, scales: Step, checks: SecondOrderChecks) -> tuple[Step, ...]:
    harmonics = derived("next harmonics of the cell",
                        NextHarmonics(epsilon, amplitude, y_next, turn), cell,
                        check=checks.next_harmonics, note="E is e^(it)")  # fmt: skip
    seek = SeekCycles(epsilon, amplitude, square, omega, size)
    own = derived("cycles of the cell", (seek, Take(0)), scales,
                  check=checks.cycles, note="s is the square of the amplitude of y")  # fmt: skip
    frequency = derived("frequency of the cell",
                        (seek, Take(1)), scales,
                        check=checks.cell_frequency)  # fmt: skip
    reduced = derived("frequency of its cycles", EliminatePowers(square), frequency, own,
                      check=checks.cell_frequency)  # fmt: skip
    root = derived("fundamental of the cycles",
                   (seek, Take(2)), scales,
                   check=checks.cell_amplitude)  # fmt: skip
    return harmonics, own, frequency, reduced, root


def _chain(chain: Step, given: ChainModel) -> tuple[Step, ...]:
    checks = SecondOrderChecks(given)
    routes = _routes("chain", chain, checks)
    spin = sp.exp(-i * sp.pi * n / 2) * sp.exp(i * epsilon * given.total_coupling * t)
    shape = ansatz("quarter turns to second order", equation(amplitude(n, t), -i / 2 * rho(n, t)
                   * spin), "phase steps of -π/2; ρ holds what turns beyond them",
                   check=checks.turned)  # fmt: skip
    sites = tuple(n + at for at in range(-2 * given.reach, 2 * given.reach + 1))
    turned = derived(
        "chain in quarter turns to second order",
        (Substitute(index=n, at=sites), Divide(-i / 2 * spin), SolveFor(rho(n, t).diff(t))),
        routes[0], shape, check=checks.staggered,
        note="What is not real turns the phases and shifts the frequency",
    )  # fmt: skip
    return (*routes, shape, turned)
