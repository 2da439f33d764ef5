"""Exact periodic orbits of (8) at the parameters of Figs. 7 to 11, and common definitions."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from paper_checks.claims._breathers import EPS, A, B

if TYPE_CHECKING:
    from verification.breathers.result import Breather

SITES = 11
CENTRE = SITES // 2
SMALL = 0.1
"""Ratio below which one quantity counts as small compared with another, in every claim."""


@lru_cache(maxsize=64)
def orbit_of(c: float, eps: float = EPS) -> Breather:
    """Return the breather of one site in (8)."""
    from theory.chains.nucleus import Nucleus
    from theory.chains.vdp import VdpChain
    from verification.breathers.orbits import solve_orbit

    return solve_orbit(VdpChain(a=A, b=B, c=c, eps=eps, sites=SITES), Nucleus(1))


@lru_cache(maxsize=16)
def averaged_of(c: float) -> Breather:
    """Return the breather of one site in the averaged chain (43)."""
    from theory.chains.nucleus import Nucleus
    from theory.chains.vdp import VdpChain
    from verification.breathers.envelope import solve_envelope_breather

    return solve_envelope_breather(VdpChain(a=A, b=B, c=c, eps=EPS, sites=SITES), Nucleus(1))
