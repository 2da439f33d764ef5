"""The location of the roots of the dispersion relation (52): short proofs for v, c > 0.

No root is real, since the real part of L on the real axis is the decay rate. No root is double:
where the slope vanishes, the wavenumber would have to lie between two of the lines Re k = -pi/2 + 2
pi m. Above the real axis there is one root in each strip from an odd to the next even multiple of
pi, and none from an even to the next odd one. Below the axis no such count holds for all velocities
and couplings, and none is claimed: there the number of roots in a strip is determined case by case,
and the sums over both half-planes are compared in 'both half-planes'.
"""

from __future__ import annotations

import sympy as sp

from derivations.algebra.oscillation import RealAndImaginaryParts
from derivations.algebra.rearrangement import Take
from derivations.algebra.roots import CountAbove
from derivations.algebra.solution import SolveFor
from derivations.algebra.steps import Draft
from derivations.algebra.substitution import Substitute
from derivations.chain import ChainModel
from derivations.front.checks_roots import RootChecks
from derivations.front.symbols import L_k, half_imag, half_real, k, turns, v, x, y
from derivations.front.symbols import height as kappa
from derivations.front.symbols import root_count as count
from derivations.symbols import i

# Formatted by hand: name, operation, sources, then check, number and note.
# fmt: off


def steps(draft: Draft, chain: ChainModel) -> None:
    """Derive the proofs.

    Parameters
    ----------
    draft : Draft
        A draft with the dispersion relation and its slope.
    chain : ChainModel
        The chain; the proofs are for nearest-neighbour springs that attract.
    """
    checks = RootChecks(chain)
    parts = RealAndImaginaryParts((half_real, half_imag))
    draft.derived("real axis", (Substitute({k: x}), parts), "dispersion",
                  check=checks.on_line(lambda point: point[x]),
                  note="the real part does not vanish: no root is real")
    if not chain.nearest_pull:
        return
    draft.derived("turning wavenumber", (Substitute({L_k: 0}), SolveFor(sp.sin(k))),
                  "slope of the dispersion", check=checks.turning,
                  note="its sine is real and negative: off the real axis Re k = "
                       "-π/2 + 2πm")
    at_turn = Substitute({k: -sp.pi / 2 + 2 * sp.pi * turns + i * kappa})
    draft.derived("velocity by the turning wavenumber", (at_turn, SolveFor(v)),
                  "turning wavenumber", check=checks.turning_velocity)
    draft.derived("dispersion at a turning wavenumber", (at_turn, Substitute(), parts),
                  "dispersion", "velocity by the turning wavenumber", check=checks.at_turning)
    draft.derived("no double root", (Take(1), Substitute({half_imag: 0}), SolveFor(turns)),
                  "dispersion at a turning wavenumber", check=checks.no_double,
                  note="1/4 - 1/(2π cosh κ) lies between 0.09 and 0.25 and is no integer")
    draft.derived("sides of the strips", (Substitute({k: turns * sp.pi + i * y}), parts),
                  "dispersion",
                  check=checks.on_line(lambda point: point[turns] * sp.pi + i * point[y]))
    draft.derived("one root from odd to even", CountAbove(k, -1, count), "dispersion", "real axis",
                  "sides of the strips", check=checks.number_in_strips(-1),
                  note="below the axis the number depends on v and c")
    draft.derived("no root from even to odd", CountAbove(k, 0, count), "dispersion", "real axis",
                  "sides of the strips", check=checks.number_in_strips(0))
