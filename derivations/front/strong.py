"""The speed of the averaged front at strong coupling, by matched asymptotics.

Outside the front the envelope is constant: the cycle behind, rest ahead. The lattice carries
disturbances at its group velocity, which is largest at one wave; the front locks to that wave,
where dispersion begins only at the third derivative. Inside, over a length that grows like the
cube root of the coupling, third-order dispersion balances the local gain. What is left is an
equation without parameters but those of the cell. That it has a solution, from the cycle to rest,
for one value of κ only is not derived here: the three-dimensional flow has a plane of solutions
leaving the cycle and a line of solutions entering rest, so that one parameter is fixed; κ is found
by solving this inner problem numerically.
"""

from __future__ import annotations

import sympy as sp

from derivations.algebra.dispersion import (
    AtFastestWave,
    DifferentiateDispersion,
    EnvelopeOfWave,
    FastestWave,
)
from derivations.algebra.equations import equation
from derivations.algebra.expansion import Limit, Linearise
from derivations.algebra.lattice import InsertPlaneWave
from derivations.algebra.oscillation import RealAndImaginaryParts
from derivations.algebra.rearrangement import Divide, Form, Rewrite, Take
from derivations.algebra.solution import PrescribeCoefficients, SolveFor
from derivations.algebra.steps import Step, ansatz, definition, derived
from derivations.algebra.substitution import EnterMovingFrame, Substitute
from derivations.chain import ChainModel
from derivations.front.checks import Checks
from derivations.front.symbols import (
    deviation_field,
    envelope,
    inner,
    inner_place,
    kappa_front,
    length,
    place,
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
from derivations.multiple_scales.steps import chain as chain_step
from derivations.symbols import epsilon, i, n, omega, t, y


def steps(chain: ChainModel, cycles: dict[str, Step], checks: Checks) -> tuple[Step, ...]:
    """From (8) and the cell of (43) to the law for the speed."""
    base = chain_step(chain)
    rest = definition("rest", equation(y(n, t), 0), "the chain at rest", check=checks.rest)
    linear = derived("chain near rest", Linearise({y: deviation_field}), base, rest,
                     check=checks.chain_near_rest)  # fmt: skip
    waves = derived(
        "linear waves",
        (
            InsertPlaneWave(deviation_field, -i * omega, q),
            RealAndImaginaryParts(),
            Take(0),
            SolveFor(omega**2),
        ),
        linear,
        check=checks.linear_waves,
        note="the imaginary part, the damping, is part of the local rate",
    )
    slopes = derived("derivatives of the frequency",
                     DifferentiateDispersion(omega, q, (w_1, w_2, w_3)), waves,
                     check=checks.frequency_derivatives)  # fmt: skip
    outer = _outer(cycles, checks)
    found = [rest, linear, waves, slopes, *outer.values()]
    if chain.reach == 1 and chain.coupling.is_positive:
        found += _law(waves, slopes, outer["speed by the group velocity"], checks)
    return tuple(found)


def _outer(cycles: dict[str, Step], checks: Checks) -> dict[str, Step]:
    local = derived(
        "local rate of the envelope",
        Substitute({radius: envelope}, meaning="at each place"),
        cycles["amplitude of the cell"],
        check=checks.local_rate,
        note="the phase of the carrier drops out: the envelope is real",
    )
    modulated = derived(
        "envelope of the fastest wave",
        EnvelopeOfWave(envelope, place, t, (w_1, 0, w_3)),
        local,
        check=checks.modulated,
        note="the second derivative vanishes where the group velocity is largest",
    )
    moving = profile((place - speed * t) / length)
    shape = ansatz("inner scale", sp.Tuple(equation(envelope, moving), equation(moving, inner)),
        "a front of a length still unknown", check=checks.inner_scale)  # fmt: skip
    frame = derived("front in the inner scale", EnterMovingFrame(place, t, inner_place),
                    modulated, shape, check=checks.inner_frame)  # fmt: skip
    sizes = definition("speed and dispersion", sp.Tuple(
        equation(speed, epsilon * v), equation(w_3, -w_3_size)),
        "the speed a unit of εt; the third derivative is negative at a maximum of the second",
        check=checks.sizes)  # fmt: skip
    named = derived("inner front", (Substitute(), Divide(epsilon)), frame, sizes,
                    check=checks.inner_named)  # fmt: skip
    demands = (((inner.diff((inner_place, 3)),), sp.S.One),
               ((inner.diff(inner_place),), -kappa_front))  # fmt: skip
    law = derived(
        "speed by the group velocity",
        (Rewrite(Form.ON_THE_LEFT), PrescribeCoefficients(demands, (length, v))),
        named,
        check=checks.speed_law,
        note="the coefficients of the third and the first derivative become 1 and -κ",
    )
    problem = derived("inner problem", (Substitute(), Rewrite(Form.SIMPLIFIED),
                                         Rewrite(Form.ON_THE_LEFT)), named, law,
                      check=checks.inner_problem,
                      note="κ is the value for which a solution joins the cycle at -∞ with rest at "
                           "+∞; it is found numerically")  # fmt: skip
    steps = (local, modulated, shape, frame, sizes, named, law, problem)
    return {step.name: step for step in steps}


def _law(waves: Step, slopes: Step, law: Step, checks: Checks) -> list[Step]:
    """Return the closed form for springs between nearest neighbours."""
    fastest = derived("fastest wave", FastestWave(omega, q), slopes, waves,
                      check=checks.fastest)  # fmt: skip
    values = derived("largest group velocity", AtFastestWave(omega, q), slopes, waves, fastest,
                     check=checks.largest_group_velocity)  # fmt: skip
    size = derived(
        "size of the dispersion",
        (Substitute({w_3: -w_3_size}), SolveFor((w_1, w_3_size))),
        values,
        check=checks.dispersion_size,
    )
    alone = derived("speed in terms of the length", Take(1), law, check=checks.speed_alone)
    speed_law = derived("speed of the front", Substitute(), alone, size,
                        check=checks.closed_law)  # fmt: skip
    weak = derived(
        "speed of the averaged front",
        (Limit(epsilon, 0), Rewrite(Form.SHORT_ROOTS)),
        speed_law,
        check=checks.weak_law,
    )
    return [fastest, values, size, alone, speed_law, weak]
