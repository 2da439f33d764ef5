"""The speed of the averaged front at strong coupling, by matched asymptotics.

Outside the front the envelope is constant: the cycle behind, rest ahead. The lattice carries
disturbances at its group velocity, which is largest for one particular wave; the front locks to
that wave, for which dispersion begins only at the third derivative. Inside the front, over a length
that grows like the cube root of the coupling, third-order dispersion balances the local gain. The
result is an equation without parameters other than those of the cell. That it has a solution from
the cycle to rest for a single value of κ is not derived here; the argument is that in the
three-dimensional flow a plane of solutions leaves the cycle and a line of solutions enters rest, so
that one parameter is fixed. κ is found by solving this inner problem numerically.
"""

from __future__ import annotations

import sympy as sp

from derivations.algebra.dispersion import AtFastestWave, EnvelopeOfWave, FastestWave
from derivations.algebra.equations import equation
from derivations.algebra.expansion import Limit, Linearise
from derivations.algebra.lattice import InsertPlaneWave
from derivations.algebra.oscillation import RealAndImaginaryParts
from derivations.algebra.rearrangement import Differentiate, Divide, Form, Rewrite, Take
from derivations.algebra.solution import PrescribeCoefficients, SolveFor
from derivations.algebra.steps import Draft
from derivations.algebra.substitution import EnterMovingFrame, Substitute
from derivations.chain import ChainModel
from derivations.front.checks_strong import StrongChecks
from derivations.front.symbols import (
    deviation_field,
    envelope,
    inner,
    inner_position,
    kappa_front,
    length,
    position,
    profile,
    q,
    radius,
    speed,
    v,
    w_1,
    w_2,
    w_3,
    w_3_size,
)
from derivations.symbols import epsilon, i, n, omega, t, y

# Formatted by hand: name, operation, sources, then check, number and note.
# fmt: off


def steps(draft: Draft, chain: ChainModel) -> None:
    """Derive the law for the speed from (8) and the cell of (43)."""
    checks = StrongChecks(chain)
    draft.definition("rest", equation(y(n, t), 0), "the chain at rest",
                     check=checks.rest)
    draft.derived("chain near rest", Linearise({y: deviation_field}), "chain", "rest",
                  check=checks.chain_near_rest)
    draft.derived("linear waves",
                  (InsertPlaneWave(deviation_field, -i * omega, q), RealAndImaginaryParts(),
                   Take(0), SolveFor(omega**2)), "chain near rest", check=checks.linear_waves,
                  note="the imaginary part, the damping, is part of the local rate")
    draft.derived("derivatives of the frequency",
                  Differentiate(omega, q, (w_1, w_2, w_3)), "linear waves",
                  check=checks.frequency_derivatives)
    _outer(draft, checks)
    if chain.nearest_pull and chain.is_scaled_by_c:
        _law(draft, checks)


def _outer(draft: Draft, checks: StrongChecks) -> None:
    draft.derived("local rate of the envelope",
                  Substitute({radius: envelope}, meaning="at each place"), "amplitude of the cell",
                  check=checks.local_rate,
                  note="the phase of the carrier drops out: the envelope is real")
    draft.derived("envelope of the fastest wave",
                  EnvelopeOfWave(envelope, position, t, (w_1, 0, w_3)),
                  "local rate of the envelope", check=checks.modulated,
                  note="the second derivative vanishes where the group velocity is largest")
    moving = profile((position - speed * t) / length)
    draft.ansatz("inner scale", sp.Tuple(equation(envelope, moving), equation(moving, inner)),
                 "a front of a length still unknown", check=checks.inner_scale)
    draft.derived("front in the inner scale", EnterMovingFrame(position, t),
                  "envelope of the fastest wave", "inner scale",
                  check=checks.inner_frame)
    draft.definition("speed and dispersion",
                     sp.Tuple(equation(speed, epsilon * v), equation(w_3, -w_3_size)),
                     "the speed per unit of εt; the third derivative is negative at "
                     "a maximum of the second", check=checks.sizes)
    draft.derived("inner front", (Substitute(), Divide(epsilon)), "front in the inner scale",
                  "speed and dispersion", check=checks.inner_named)
    demands = (((inner.diff((inner_position, 3)),), sp.S.One),
               ((inner.diff(inner_position),), -kappa_front))
    draft.derived("speed by the group velocity",
                  (Rewrite(Form.ON_THE_LEFT), PrescribeCoefficients(demands, (length, v))),
                  "inner front", check=checks.speed_law,
                  note="the coefficients of the third and the first derivative become 1 and -κ")
    draft.derived("inner problem",
                  (Substitute(), Rewrite(Form.SIMPLIFIED), Rewrite(Form.ON_THE_LEFT)),
                  "inner front", "speed by the group velocity", check=checks.inner_problem,
                  note="κ is the value for which a solution joins the cycle at -∞ "
                       "with rest at +∞; it is found numerically")


def _law(draft: Draft, checks: StrongChecks) -> None:
    """Derive the closed form for springs between nearest neighbours."""
    draft.derived("fastest wave", FastestWave(omega, q), "derivatives of the frequency",
                  "linear waves", check=checks.fastest)
    draft.derived("largest group velocity", AtFastestWave(omega, q),
                  "derivatives of the frequency", "linear waves", "fastest wave",
                  check=checks.largest_group_velocity)
    draft.derived("size of the dispersion",
                  (Substitute({w_3: -w_3_size}), SolveFor((w_1, w_3_size))),
                  "largest group velocity", check=checks.dispersion_size)
    draft.derived("speed in terms of the length", Take(1), "speed by the group velocity",
                  check=checks.speed_alone)
    draft.derived("speed of the front", Substitute(), "speed in terms of the length",
                  "size of the dispersion", check=checks.closed_law)
    draft.derived("speed of the averaged front", (Limit(epsilon, 0), Rewrite(Form.SHORT_ROOTS)),
                  "speed of the front", check=checks.weak_law)
