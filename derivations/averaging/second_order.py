"""The next order in eps for the cell and for the chain, by both routes, for any chain."""

from __future__ import annotations

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
from derivations.algebra.steps import Derivation, Draft
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
from derivations.multiple_scales.steps import derive as derive_scales
from derivations.symbols import epsilon, i, n, omega, t

# Formatted by hand: name, operation, sources, then check, number and note.
# fmt: off


def derive(model: ChainModel = PAPER) -> Derivation:
    """Derive the second order on its own.

    Parameters
    ----------
    model : ChainModel
        The chain; by default that of Eq. (8).
    """
    scales = derive_scales(model)
    draft = Draft(scales)
    draft.add(scales.named("chain"))
    steps(draft, model)
    return draft.finished("second-order", "Second order for the cell and the chain")


def extended(derivation: Derivation, model: ChainModel = PAPER) -> Derivation:
    """Return a derivation of the chain extended to second order.

    Parameters
    ----------
    derivation : Derivation
        Multiple scales or averaging, to first order.
    model : ChainModel
        Its chain.
    """
    draft = Draft(derive_scales(model))
    draft.add(*derivation.steps)
    steps(draft, model)
    return draft.finished(derivation.key, derivation.title)


def steps(draft: Draft, given: ChainModel, chain: str = "chain") -> None:
    """Derive the second order by both routes, and its predictions.

    Parameters
    ----------
    draft : Draft
        The draft to which the steps are added.
    given : ChainModel
        The chain.
    chain : str
        Name of the step with Eq. (8).
    """
    alone = given.cell()
    checks = SecondOrderChecks(alone)
    draft.model("cell", alone.equation(), "the isolated cell of (8), without springs",
                check=checks.motion)
    _routes(draft, "cell", "cell", checks)
    _cycle(draft, checks)
    _chain(draft, given, chain)


def _routes(draft: Draft, name: str, start: str, checks: SecondOrderChecks) -> None:
    draft.derived(f"modulation by multiple scales, {name}",
                  FindModulation(Route.MULTIPLE_SCALES, epsilon, amplitude, 2), start,
                  check=checks.scales)
    draft.derived(f"modulation by averaging, {name}",
                  FindModulation(Route.AVERAGING, epsilon, phi, 2), start, check=checks.averaging)
    draft.derived(f"fundamental of the average, {name}",
                  FundamentalOfAverage(epsilon, phi, fundamental), start,
                  check=checks.fundamental)
    draft.derived(f"averaging in the amplitude of multiple scales, {name}",
                  ChangeAmplitude(epsilon, phi, amplitude), f"modulation by averaging, {name}",
                  f"fundamental of the average, {name}", check=checks.scales,
                  note="It is the same polynomial as by multiple scales")


def _cycle(draft: Draft, checks: SecondOrderChecks) -> None:
    scales = "modulation by multiple scales, cell"
    draft.derived("next harmonics of the cell", NextHarmonics(epsilon, amplitude, y_next, turn),
                  "cell", check=checks.next_harmonics, note="E is e^(it)")
    seek = SeekCycles(epsilon, amplitude, square, omega, size)
    draft.derived("cycles of the cell", (seek, Take(0)), scales, check=checks.cycles,
                  note="s is the square of the amplitude of y")
    draft.derived("frequency of the cell", (seek, Take(1)), scales,
                  check=checks.cell_frequency)
    draft.derived("frequency of its cycles", EliminatePowers(square), "frequency of the cell",
                  "cycles of the cell", check=checks.cell_frequency)
    draft.derived("fundamental of the cycles", (seek, Take(2)), scales,
                  check=checks.cell_amplitude)


def _chain(draft: Draft, given: ChainModel, chain: str) -> None:
    checks = SecondOrderChecks(given)
    _routes(draft, "chain", chain, checks)
    spin = sp.exp(-i * sp.pi * n / 2) * sp.exp(i * epsilon * given.total_coupling * t)
    draft.ansatz("quarter turns to second order",
                 equation(amplitude(n, t), -i / 2 * rho(n, t) * spin),
                 "phase steps of -π/2; ρ contains any further rotation",
                 check=checks.turned)
    sites = tuple(n + at for at in range(-2 * given.reach, 2 * given.reach + 1))
    draft.derived("chain in quarter turns to second order",
                  (Substitute(index=n, at=sites), Divide(-i / 2 * spin),
                   SolveFor(rho(n, t).diff(t))),
                  "modulation by multiple scales, chain", "quarter turns to second order",
                  check=checks.quarter_turn,
                  note="The imaginary part rotates the phases and shifts the frequency")
