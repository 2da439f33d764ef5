"""Any polynomial cell: its averaged equation, amplitude, cycles, and the front that follows."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import sympy as sp

from derivations.algebra.amplitudes import FindModulation, Route
from derivations.algebra.equations import equation, parts_of
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.operations import Operation
from derivations.algebra.oscillation import RealAndImaginaryParts
from derivations.algebra.rearrangement import Divide, Take
from derivations.algebra.solution import SolveFor
from derivations.algebra.steps import Check, Derivation, Step, definition, derived, model
from derivations.algebra.substitution import Substitute
from derivations.averaging.second_order import steps as second_order
from derivations.averaging.symbols import phi, square
from derivations.cell.checks import CellChecks
from derivations.cell.cycles import limit_cycles, ratio_of_cycles, shown
from derivations.cell.symbols import angle, radius, ratio
from derivations.chain import ChainModel
from derivations.front.steps import derive as derive_front
from derivations.front.symbols import ratio as front_ratio
from derivations.front.symbols import v as v_hat
from derivations.symbols import c, epsilon, i, n, t


@dataclass(frozen=True, kw_only=True)
class AveragedCell:
    """The steps from the equation of motion to the amplitude of a cell.

    Attributes
    ----------
    steps : tuple of Step
        All of them.
    chain : Step
        The averaged chain.
    amplitude, frequency : Step
        Of the isolated cell.
    """

    steps: tuple[Step, ...]
    chain: Step
    amplitude: Step
    frequency: Step

    @property
    def damping_mean(self) -> sp.Expr:
        """H(s) of ``r' = -(eps r/2) H(r^2)``."""
        return damping_mean(self.amplitude.result)

    @property
    def shift_mean(self) -> sp.Expr:
        """Omega(s): the frequency is ``1 + eps Omega(r^2)``."""
        return sp.expand(self.frequency.result.rhs / epsilon).subs(radius, sp.sqrt(square))


def damping_mean(amplitude: sp.Basic) -> sp.Expr:
    """Return H(s) of an amplitude equation ``r' = -(eps r/2) H(r^2)``."""
    return sp.expand(-2 * amplitude.rhs / (epsilon * radius)).subs(radius, sp.sqrt(square))


@dataclass(frozen=True)
class FindCycles(Operation):
    """All amplitudes at which the amplitude of a cell stays constant."""

    phrase: ClassVar[str] = (
        "solve {sources} for constant amplitudes other than zero: the limit cycles"
    )

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``r_1 = …``, inner to outer."""
        (amplitude,) = sources
        cycles = limit_cycles(damping_mean(amplitude))
        return sp.Tuple(*(equation(sp.Symbol(f"r_{place}"), cycle.amplitude)
                          for place, cycle in enumerate(cycles, start=1)))  # fmt: skip


@dataclass(frozen=True)
class GrowthRates(Operation):
    """Growth rate of a small change of the amplitude of each cycle, a unit of eps t."""

    phrase: ClassVar[str] = "linearise {first} about {others}"

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``lambda_1 = …`` for the cycles of the second source."""
        amplitude, cycles = sources
        slope = sp.diff(amplitude.rhs.subs(radius, square) / epsilon, square)
        return sp.Tuple(*(
            equation(sp.Symbol(f"lambda_{place}"), sp.simplify(slope.subs(square, part.rhs)))
            for place, part in enumerate(parts_of(cycles), start=1)
        ))  # fmt: skip


@dataclass(frozen=True)
class RatioOfCycles(Operation):
    """Ratio of the unstable to the stable cycle of a cell with two of them."""

    phrase: ClassVar[str] = "divide the unstable by the stable cycle of {sources}"

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``|phi_us|/|phi_s| = …``."""
        (amplitude,) = sources
        mean = damping_mean(amplitude)
        return equation(ratio, ratio_of_cycles(mean, limit_cycles(mean), {}))


def averaged_cell(given: ChainModel) -> AveragedCell:
    """Derive the averaged chain, and amplitude and frequency of its isolated cell."""
    checks = CellChecks(given)
    chain = model("cell in its chain", given.equation(), "the oscillator in its chain",
                  check=checks.motion)  # fmt: skip
    cell = model("isolated cell", given.cell().equation(), "the same without springs",
                 check=CellChecks(given.cell()).motion)  # fmt: skip
    average = FindModulation(Route.AVERAGING, epsilon, phi, order=1)
    averaged = derived("averaged cell in its chain", average, chain, check=checks.averaged)
    alone = derived("averaged cell", average, cell, check=CellChecks(given.cell()).averaged)
    turn = sp.exp(i * angle)
    polar = definition("amplitude and phase of the cell", equation(phi(n, t), radius * turn),
                       "amplitude and phase", check=checks.polar)  # fmt: skip
    parts = derived("cell in real and imaginary parts",
                    (Substitute(), Divide(turn), RealAndImaginaryParts()), alone, polar,
                    check=checks.parts)  # fmt: skip
    amplitude = derived("amplitude of the cell", (Take(0), SolveFor(radius.diff(t))), parts,
                        check=checks.amplitude)  # fmt: skip
    frequency = derived("frequency shift of the cell", (Take(1), SolveFor(angle.diff(t))), parts,
                        check=checks.frequency,
                        note="The frequency of the cell is 1 plus this")  # fmt: skip
    steps = (chain, cell, averaged, alone, polar, parts, amplitude, frequency)
    return AveragedCell(steps=steps, chain=averaged, amplitude=amplitude, frequency=frequency)


def derive(given: ChainModel, order: int = 1) -> Derivation:
    """Equation, average, amplitude, cycles, stability, and the front that follows from them.

    Parameters
    ----------
    given : ChainModel
        The cell in its chain.
    order : {1, 2}
        With 2 the second order of the cell and the chain follows.
    """
    found = averaged_cell(given)
    steps = (*found.steps, *_cycles(given, found))
    if order == 2:
        steps += second_order(given, found.steps[0])
    title = f"Averaged equation of the cell with damping {shown(given.damping)}"
    return Derivation("cell", title, steps)


def _cycles(given: ChainModel, found: AveragedCell) -> tuple[Step, ...]:
    """Derive what hangs on the cycles, as far as they have a closed form and are bistable."""
    checks, mean = CellChecks(given), found.damping_mean
    try:
        known = limit_cycles(mean)
    except DerivationInputError:
        return ()
    if not known:
        return ()
    cycles = derived("cycles", FindCycles(), found.amplitude, check=checks.cycles(known),
                     note="Each exists where its amplitude is real")  # fmt: skip
    kinds = ", ".join(cycle.stability or "stable where negative" for cycle in known)
    growth = derived("growth rates", GrowthRates(), found.amplitude, cycles,
                     check=checks.growth(known), note=f"In order: {kinds}")  # fmt: skip
    steps: tuple[Step, ...] = (cycles, growth)
    try:
        ratio_of_cycles(mean, known, given.damping)
    except DerivationInputError:
        return steps
    quotient = derived("ratio of the cycles", RatioOfCycles(), found.amplitude,
                       check=checks.ratio(known))  # fmt: skip
    note = "M⁺ holds the roots of (50) in the upper half-plane"
    if found.shift_mean.has(square):
        note += "; the dependence of the frequency on amplitude is left out"
    return (*steps, quotient, *_front(given, mean, quotient, checks.relation(known), note))


def _front(
    given: ChainModel, mean: sp.Expr, quotient: Step, check: Check, note: str
) -> tuple[Step, ...]:
    """Put the cell into (54): its damping at rest takes the place of one in (44)."""
    front, rest = derive_front(), mean.subs(square, 0)
    put = Substitute({front_ratio: ratio})
    scaled_by = ((v_hat, v_hat / rest), (c, given.coupling / rest))
    scales = {own: value for own, value in scaled_by if own != value}
    scaled = derived(
        "kinetic relation at this damping",
        (put, Substitute(scales, meaning="in units of the damping at rest")) if scales else put,
        front.named("relation by the ratio"), front.named("slope of the dispersion"), check=check,
    )  # fmt: skip
    relation = derived("kinetic relation of the cell", Substitute(), scaled, quotient, check=check,
                       note=note)  # fmt: skip
    return scaled, relation
