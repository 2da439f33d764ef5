"""Any polynomial cell: its averaged equation, amplitude, cycles, and the resulting front."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.amplitudes import FindModulation, Route
from derivations.algebra.equations import equation
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.operations import Operation
from derivations.algebra.oscillation import RealAndImaginaryParts
from derivations.algebra.rearrangement import Divide, Take
from derivations.algebra.solution import SolveFor
from derivations.algebra.steps import Check, Derivation, Draft
from derivations.algebra.substitution import Substitute, alike
from derivations.averaging.cycles import (
    FindCycles,
    GrowthRates,
    RatioOfCycles,
    damping_mean,
    limit_cycles,
    ratio_of_cycles,
    shown,
)
from derivations.averaging.second_order import steps as second_order
from derivations.averaging.symbols import angle, phi, radius, ratio, square
from derivations.cell.checks import CellChecks
from derivations.chain import ChainModel
from derivations.front.steps import derive as derive_front
from derivations.front.symbols import ratio as front_ratio
from derivations.front.symbols import v as v_hat
from derivations.symbols import c, epsilon, i, n, t

# Formatted by hand: name, operation, sources, then check, number and note.
# fmt: off


def shift_mean(frequency: sp.Basic) -> sp.Expr:
    """Return Omega(s) of the frequency ``1 + eps Omega(r^2)``, from ``psi' = eps Omega(r^2)``."""
    return sp.expand(frequency.rhs / epsilon).subs(radius, sp.sqrt(square))


def derive(given: ChainModel, order: int = 1, *, front: bool = True) -> Derivation:
    """Derive average, amplitude, cycles and their stability, and the front that follows from them.

    Parameters
    ----------
    given : ChainModel
        The cell in its chain.
    order : {1, 2}
        With 2, the second order of the cell and the chain is added.
    front : bool
        Whether the kinetic relation of a bistable cell is added, if cells are coupled.
    """
    draft = Draft(derive_front())
    _average(draft, given)
    _cycles(draft, given, front=front and given.coupling != 0)
    if order == 2:
        second_order(draft, given, "cell in its chain")
    title = f"Averaged equation of the cell with damping {shown(given.damping)}"
    return draft.finished("cell", title)


def _average(draft: Draft, given: ChainModel) -> None:
    """Derive the averaged chain, and amplitude and frequency of its isolated cell."""
    checks = CellChecks(given)
    draft.model("cell in its chain", given.equation(), "the oscillator in its chain",
                check=checks.motion)
    average = FindModulation(Route.AVERAGING, epsilon, phi, order=1)
    draft.derived("averaged cell in its chain", average, "cell in its chain",
                  check=checks.averaged)
    cell = "averaged cell in its chain"
    if given.reach > 0:
        cell = "averaged cell"
        draft.derived(cell, alike(phi, n, t, given.reach), "averaged cell in its chain",
                      check=CellChecks(given.cell()).averaged)
    turn = sp.exp(i * angle)
    draft.definition("amplitude and phase of the cell", equation(phi(n, t), radius * turn),
                     "amplitude and phase", check=checks.polar)
    draft.derived("cell in real and imaginary parts",
                  (Substitute(), Divide(turn), RealAndImaginaryParts()), cell,
                  "amplitude and phase of the cell", check=checks.parts)
    draft.derived("amplitude of the cell", (Take(0), SolveFor(radius.diff(t))),
                  "cell in real and imaginary parts", check=checks.amplitude)
    draft.derived("frequency shift of the cell", (Take(1), SolveFor(angle.diff(t))),
                  "cell in real and imaginary parts", check=checks.frequency,
                  note="The frequency of the cell is 1 plus this")


def _cycles(draft: Draft, given: ChainModel, *, front: bool) -> None:
    """Derive what follows from the cycles, if they have a closed form and the cell is bistable."""
    checks, mean = CellChecks(given), damping_mean(draft["amplitude of the cell"].result)
    try:
        known = limit_cycles(mean)
    except DerivationInputError:
        return
    if not known:
        return
    draft.derived("cycles", FindCycles(), "amplitude of the cell", check=checks.cycles(known),
                  note="Each exists where its amplitude is real")
    kinds = ", ".join(cycle.stability or "stable where negative" for cycle in known)
    draft.derived("growth rates", GrowthRates(epsilon), "amplitude of the cell", "cycles",
                  check=checks.growth(known), note=f"In order: {kinds}")
    try:
        ratio_of_cycles(mean, known, given.damping)
    except DerivationInputError:
        return
    draft.derived("ratio of the cycles", RatioOfCycles(), "amplitude of the cell",
                  check=checks.ratio(known))
    if front:
        _front(draft, given, mean.subs(square, 0), checks.relation(known))


def _front(draft: Draft, given: ChainModel, rest: sp.Expr, check: Check) -> None:
    """Insert the cell into (54), with its damping at rest in place of the one in (44)."""
    note = "M⁺ holds the roots of (50) in the upper half-plane"
    if shift_mean(draft["frequency shift of the cell"].result).has(square):
        note += "; the dependence of the frequency on amplitude is left out"
    put: tuple[Operation, ...] = (Substitute({front_ratio: ratio}),)
    scaled_by = ((v_hat, v_hat / rest), (c, given.coupling / rest))
    scales = {own: value for own, value in scaled_by if own != value}
    if scales:
        put += (Substitute(scales, meaning="in units of the damping at rest"),)
    draft.derived("kinetic relation at this damping", put, "relation by the ratio",
                  "slope of the dispersion", check=check)
    draft.derived("kinetic relation of the cell", Substitute(), "kinetic relation at this damping",
                  "ratio of the cycles", check=check, note=note)
