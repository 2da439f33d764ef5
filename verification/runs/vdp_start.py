"""Starts of a run of Model II: which sites are displaced, how far, in which phase, how perturbed.

A start is Ψ = ẏ + iy of every site, shape (N,), complex; the envelope φ starts from the same.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError, within

ComplexArray = npt.NDArray[np.complex128]


def displaced(
    chain: VdpChain,
    sites: Sequence[int],
    displacement: float | None = None,
    steps: Sequence[int] | None = None,
) -> ComplexArray:
    """Return a start with some sites on a circle of radius ``displacement``, the others at rest.

    Parameters
    ----------
    chain : VdpChain
        Its number of sites, and its cells for the default.
    sites : sequence of int
        Sites, from 1 to N.
    displacement : float, optional
        |Ψ|, dimensionless; by default the stable cycle of one cell.
    steps : sequence of int, optional
        Phase of each site in quarters of a turn; by default 0, all displaced with ẏ = 0.

    Raises
    ------
    ParameterError
        If a site is not in the chain, or the displacement is needed and the cell has no cycle.

    Examples
    --------
    >>> chain = VdpChain(a=4, b=0.5, c=0.6, sites=3)
    >>> displaced(chain, [2], 6.0)
    array([0.+0.j, 0.+6.j, 0.+0.j])
    """
    if not sites:
        raise ParameterError("excited sites", "none", "at least one", "name a site from 1 to n")
    for site in sites:
        if not 1 <= site <= chain.sites:
            raise ParameterError(
                "excited site", site, f"from 1 to {chain.sites}", "name a site of the chain"
            )
    size = chain.stable_amplitude if displacement is None else displacement
    within("displacement", size, -1e3, 1e3)
    psi = np.zeros(chain.sites, dtype=complex)
    turns = steps if steps is not None else [0] * len(sites)
    for site, quarter in zip(sites, turns, strict=True):
        psi[site - 1] = size * (1j, -1.0, -1j, 1.0)[quarter % 4]
    return psi


def staggered_front(chain: VdpChain, filled: int) -> ComplexArray:
    """Return ``filled`` sites on the stable cycle, each a quarter of a turn behind the one before.

    Fronts of (8) and (43) lock to this phase step of -π/2 a site.

    Examples
    --------
    >>> start = staggered_front(VdpChain(a=4, b=0.5, c=0.6, sites=4), 3)
    >>> bool(abs(start / start[0] - [1, -1j, -1, 0]).max() < 1e-15)
    True
    """
    return displaced(chain, range(1, filled + 1), steps=[-n for n in range(filled)])


def perturbed(start: ComplexArray, size: float, seed: int) -> ComplexArray:
    """Return the start with complex normal noise of this size on every site, by a seed.

    Examples
    --------
    >>> noisy = perturbed(np.zeros(3, dtype=complex), 1e-6, seed=1)
    >>> bool(0 < abs(noisy).max() < 1e-5)
    True
    """
    random = np.random.default_rng(seed)
    noise = random.standard_normal((2, start.size))
    noisy: ComplexArray = start + size * (noise[0] + 1j * noise[1])
    return noisy
