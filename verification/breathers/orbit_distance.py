"""How far a breather of a theory is from the true periodic orbit of (8)."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from verification.breathers.orbits import solve_orbit

Real = NDArray[np.float64]

REST = 14
"""Most sites at rest beside the nucleus that the orbit is solved with; beyond, all are small."""


@dataclass(frozen=True)
class OrbitDistance:
    """The difference to the periodic orbit; the orbit's own error is added.

    Attributes
    ----------
    amplitude : float
        Largest over the sites from the centre outwards, dimensionless.
    frequency : float
        In units of the cell's own frequency.
    seconds : float
        Wall-clock time.
    """

    amplitude: float
    frequency: float
    seconds: float


def distance_from_orbit(
    chain: VdpChain, nucleus: Nucleus, amplitudes: Real, frequency: float
) -> OrbitDistance | None:
    """Solve for the periodic orbit and compare; None if there is no orbit at this coupling.

    Parameters
    ----------
    chain : VdpChain
        The chain (8) that the theory is about.
    nucleus : Nucleus
        Which sites, and the pattern of phases.
    amplitudes : ndarray, shape (M,)
        max |y_n| by the theory, from site `Nucleus.outward` to the right.
    frequency : float
        By the theory.

    Raises
    ------
    ParameterError
        If the chain is too stiff for shooting.

    Examples
    --------
    >>> chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=15)
    >>> found = distance_from_orbit(chain, Nucleus(1), np.array([2.8184, 0.2948]), 1.001)
    >>> found.amplitude < 4e-4, found.frequency < 2e-5
    (True, True)
    """
    started = time.perf_counter()
    orbit = solve_orbit(replace(chain, sites=min(chain.sites, nucleus.size + REST)), nucleus)
    if not orbit.amplitudes.size:
        return None
    true = orbit.amplitudes[nucleus.outward(orbit.amplitudes.size) :]
    count = min(true.size, len(amplitudes))
    return OrbitDistance(
        float(np.abs(amplitudes[:count] - true[:count]).max()) + orbit.error,
        abs(frequency - orbit.frequency) + orbit.error,
        time.perf_counter() - started,
    )
