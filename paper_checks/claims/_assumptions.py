"""Whether what an equation assumes is the case: by the breather and the fronts, not by its kind."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from paper_checks.claims._breathers import EPS, A, B

if TYPE_CHECKING:
    from verification.breathers.envelope import EnvelopeBreather

C, SITES = 0.1, 15
"""The breather of Fig. 7."""
SAME = 0.01
"""Ratios of neighbours that differ by less than this part count as one."""
SMALL = 0.1
"""What is below this part of c counts as small beside it."""
FRONTS = ((0.5, 0.03125), (10.0, 0.03125))
"""(c, η) of Fig. 16, and of a front far beyond its coupling."""


@lru_cache(maxsize=1)
def _breather() -> EnvelopeBreather:
    from theory.chains.nucleus import Nucleus
    from theory.chains.vdp import VdpChain
    from verification.breathers.envelope import solve_envelope_breather

    return solve_envelope_breather(VdpChain(a=A, b=B, c=C, eps=EPS, sites=SITES), Nucleus(1))


def one_decay() -> tuple[bool, str]:
    """Compare the ratios of neighbours, outwards from the centre of the averaged breather."""
    tail = np.abs(_breather().phi[SITES // 2 : SITES // 2 + 4])
    ratios = tail[1:] / tail[:-1]
    spread = float(ratios.max() / ratios.min() - 1.0)
    words = ", ".join(f"{ratio:.4f}" for ratio in ratios)
    return spread < SAME, (
        f"in the averaged breather at c = {C:g} the ratios of neighbours are {words}: they differ "
        f"by {100 * spread:.1f} %, where one decay would give one ratio"
    )


def small_detuning() -> tuple[bool, str]:
    """Compare ω_1 with c, in the averaged chain and on the periodic orbit of (8)."""
    from theory.chains.nucleus import Nucleus
    from theory.chains.vdp import VdpChain
    from verification.breathers.orbits import solve_orbit

    averaged = abs(_breather().omega - C) / C
    orbit = solve_orbit(VdpChain(a=A, b=B, c=C, eps=EPS, sites=SITES), Nucleus(1))
    full = abs((orbit.frequency - 1.0) / EPS - C) / C
    return max(averaged, full) < SMALL, (
        f"at c = {C:g} |δ|/c is {averaged:.0e} in the averaged chain and {full:.4f} on the orbit "
        f"of (8) at ε = {EPS:g}"
    )


def always_admissible() -> tuple[bool, str]:
    """Look whether every solution of (54) at two couplings satisfies (47)."""
    from theory.piecewise.kinetic_relation import kinetic_relation

    found = [
        (c, branch.v, branch.admissible)
        for c, eta in FRONTS
        for branch in kinetic_relation(c, eta).branches
    ]
    words = "; ".join(
        f"v = {v:.6f} at c = {c:g} {'satisfies' if good else 'fails'} it" for c, v, good in found
    )
    return all(good for _, _, good in found), f"of the solutions of (54) at η = 0.03125, {words}"


ASSUMED: dict[int, Callable[[], tuple[bool, str]]] = {
    9: one_decay,
    27: small_detuning,
    38: one_decay,
    47: always_admissible,
}
"""Equations that assume more than their derivation checks."""
