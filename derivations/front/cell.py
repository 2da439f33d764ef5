"""The cell of the averaged chain: its two cycles, and what the model (44) retains of it."""

from __future__ import annotations

import sympy as sp

from derivations.algebra.equations import equation
from derivations.algebra.expansion import Linearise
from derivations.algebra.oscillation import RealAndImaginaryParts
from derivations.algebra.rearrangement import Divide, Form, Rewrite, Subtract, Take
from derivations.algebra.solution import SolveFor
from derivations.algebra.steps import Draft
from derivations.algebra.substitution import Eliminate, Substitute, TakeBranch, alike
from derivations.averaging.cycles import FindCycles, GrowthRates, RatioOfAmplitudes
from derivations.chain import ChainModel
from derivations.front.checks_cell import FrontCellChecks
from derivations.front.symbols import (
    deviation,
    eta,
    growth_inside,
    phase,
    phi,
    phi_s,
    phi_us,
    radial_rate,
    radius,
)
from derivations.symbols import i, n, t

# Formatted by hand: name, operation, sources, then check, number and note.
# fmt: off


def forcing_parameter(chain: ChainModel) -> sp.Expr | None:
    """Return ``h_0 h_2p / h_p²`` for a damping with powers 0, p, 2p; None for any other."""
    powers = sorted(chain.damping)
    if len(powers) != 3 or powers[0] != 0 or powers[2] != 2 * powers[1]:
        return None
    low, middle, top = (chain.damping[power] for power in powers)
    return low * top / middle**2


def eliminated(chain: ChainModel) -> tuple[sp.Symbol, ...]:
    """Return a symbol of the leading coefficient, which η replaces."""
    found = sorted(chain.damping[max(chain.damping)].free_symbols, key=str)
    return tuple(found[:1])


def steps(draft: Draft, chain: ChainModel) -> None:
    """Derive the ratio of the two cycles from (43), for a cell that has them in closed form."""
    checks = FrontCellChecks(chain)
    draft.derived("averaged cell", alike(phi, n, t, chain.reach),
                  "averaged chain at unit frequency", check=checks.averaged_cell)
    draft.definition("amplitude and phase", equation(phi(n, t), radius * sp.exp(i * phase)),
                     "modulus and argument of the envelope", check=checks.polar)
    draft.derived("averaged cell in parts",
                  (Substitute(), Divide(sp.exp(i * phase)), RealAndImaginaryParts()),
                  "averaged cell", "amplitude and phase", check=checks.cell_parts)
    draft.derived("amplitude of the cell", (Take(0), SolveFor(radius.diff(t))),
                  "averaged cell in parts", check=checks.amplitude_rate)
    draft.derived("phase of the cell", (Take(1), SolveFor(phase.diff(t))), "averaged cell in parts",
                  check=checks.phase_rate,
                  note="without nonlinear stiffness it is constant: no phase is preferred")
    forcing = forcing_parameter(chain)
    if forcing is None:
        return
    draft.derived("cycles", FindCycles((sp.Abs(phi_us), sp.Abs(phi_s))),
                  "amplitude of the cell", check=checks.cycles)
    growth = GrowthRates(names=(growth_inside, -radial_rate))
    draft.derived("radial decay on the cycle",
                  (growth, Take(1), SolveFor(radial_rate), Rewrite(Form.CANCELLED)),
                  "amplitude of the cell", "cycles", check=checks.radial_decay)
    draft.derived("ratio of the cycles", RatioOfAmplitudes(2), "cycles",
                  check=checks.ratio)
    draft.definition("forcing parameter", equation(eta, forcing),
                     "the coefficients that remain after amplitudes have been scaled",
                     check=checks.forcing)
    if eliminated(chain):
        draft.derived("ratio by η",
                      (Eliminate(eliminated(chain)), Rewrite(Form.SIMPLIFIED),
                       Rewrite(Form.SHORT_ROOTS)), "ratio of the cycles", "forcing parameter",
                      check=checks.ratio)


def comparison(draft: Draft, chain: ChainModel) -> None:
    """Derive what (44) retains of (43), and what it neglects."""
    checks = FrontCellChecks(chain)
    modulus, threshold = sp.Abs(phi(n, t)), sp.Abs(phi_us)
    below, above = (side(modulus, threshold) for side in (sp.Lt, sp.Gt))
    draft.derived("averaged chain near rest", Linearise({phi: phi}, at_rest=True),
                  "averaged chain at unit frequency",
                  check=checks.near_rest)
    draft.derived("two lines near rest", TakeBranch(below), "two lines",
                  check=checks.near_rest)
    draft.derived("kept at rest", Subtract(), "averaged chain near rest", "two lines near rest",
                  check=checks.nothing,
                  note="(44) has the rest state of (43), its decay and its springs")
    draft.definition("deviation from the cycle", equation(phi(n, t), phi_s * (1 + deviation)),
                     "a relative deviation: its real part is radial, its imaginary "
                     "part changes the phase", check=checks.shifted)
    draft.derived("two lines near the cycle",
                  (TakeBranch(above), alike(phi, n, t, chain.reach), Rewrite(Form.EXPANDED)),
                  "two lines", check=checks.upper)
    draft.derived("dropped on the cycle",
                  (Substitute(), Divide(phi_s), SolveFor(deviation.diff(t))),
                  "two lines near the cycle", "deviation from the cycle", check=checks.upper_decay,
                  note="(44) gives radius and phase the decay of the rest state; "
                       "in (43) the radius has the rate of 'radial decay on the "
                       "cycle' and the phase none: (44) fixes the phase of φ_s, "
                       "which (43) leaves free")
