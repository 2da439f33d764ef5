"""Floquet multipliers of breathers of (8), along the exact orbit and along the sinusoids of (9).

The monodromy matrix is the derivative of the flow over one period (Eqs. 39-42). Along the exact
orbit one multiplier is exactly 1 (a shift in time). Along an approximate orbit none need be, so its
distance from 1 is stated with every verdict.
"""

from __future__ import annotations

import cmath
import math

import numpy as np

from theory.arrays import FloatArray
from theory.averaged.breather import ClosedFormBreather
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from verification.breathers.exponents import BreatherStability, modes_of
from verification.steppers.variational import STEPS, integrate_along_sinusoids

MARGINAL = 1e-8
"""Growth per unit T below which a multiplier counts as on the unit circle (round-off over ε)."""


def floquet_multipliers(
    monodromy: FloatArray,
    period: float,
    eps: float,
    *,
    parity: int,
    error: float = 0.0,
) -> BreatherStability:
    """Sort the eigenvalues of a monodromy matrix, and split them by parity.

    The growth rate of a multiplier is ln|μ|/(ε period), comparable with that of an exponent of
    (43). The errors of the multipliers are bounded by the theorem of Bauer and Fike or, where the
    eigenvectors are nearly dependent, of Elsner (``eigenvalue_bound``); the bound includes the
    estimated error of the monodromy matrix and the rounding of its eigenvalues.

    Parameters
    ----------
    monodromy : float array, shape (2N, 2N)
        Displacements first, then velocities.
    period : float
        Period in t.
    eps : float
        ε, for the rate per unit of T.
    parity : int
        Parity of the breather under reflection; 0 if it has none.
    error : float, optional
        Error of the entries of the matrix.

    Examples
    --------
    >>> found = floquet_multipliers(np.diag([1.0, 0.5]), 1.0, 0.1, parity=0)
    >>> found.trivial, round(found.growth, 3), found.stable
    (0.0, -6.931, True)
    """

    def rate(multiplier: complex) -> float:
        return math.log(max(abs(multiplier), 1e-300)) / (eps * period)

    def rate_error(multiplier: complex | None) -> float:
        ratio = found.error / abs(multiplier) if multiplier else math.inf
        return -math.log1p(-ratio) / (eps * period) if ratio < 1.0 else math.inf

    # The spectral norm of a matrix is at most its order times its largest entry.
    found = modes_of(
        monodromy, parity, trivial=1.0, size=np.abs, perturbation=len(monodromy) * error
    )
    leader = found.leader
    return BreatherStability(
        values=found.values,
        trivial=found.trivial,
        leader=leader,
        growth=rate(leader),
        frequency=abs(cmath.phase(leader)) / (eps * period),
        symmetric=None if found.symmetric is None else rate(found.symmetric),
        antisymmetric=None if found.antisymmetric is None else rate(found.antisymmetric),
        marginal=MARGINAL,
        error=found.error,
        growth_error=rate_error(leader),
        symmetric_error=rate_error(found.symmetric),
    )


def approximate_multipliers(
    chain: VdpChain,
    breather: ClosedFormBreather,
    *,
    misprinted: bool = False,
) -> BreatherStability:
    """Return the multipliers along y_n = α_0 e^{k_1|n|} sin(ωt + k_2|n|), as the paper does.

    Parameters
    ----------
    chain : VdpChain
        A chain with an odd number of sites; the breather is in the middle. The paper's ends are
        periodic.
    breather : ClosedFormBreather
        Amplitude, decay, frequency and phase step of (9).
    misprinted : bool, optional
        Use the Jacobian exactly as printed in (42).

    Raises
    ------
    ParameterError
        If the number of sites is even, there is no breather at this coupling, or ε is so large that
        variations along the sinusoids overflow within a period.
    """
    if chain.sites % 2 == 0:
        raise ParameterError("number of sites n", chain.sites, "odd here", "add a site")
    if breather.alpha_0 is None:
        raise ParameterError(
            "coupling c", chain.c, "below the fold of the closed form", "take a smaller coupling"
        )
    distance = np.abs(np.arange(chain.sites) - chain.sites // 2)
    amplitudes = breather.amplitudes(chain.sites)[distance]
    phases = breather.phase_step * distance
    matrices = [
        integrate_along_sinusoids(
            chain, amplitudes, phases, breather.frequency, misprinted=misprinted, steps=count
        ).monodromy
        for count in (STEPS, 2 * STEPS)
    ]
    if not all(np.isfinite(matrix).all() for matrix in matrices):
        raise ParameterError(
            "small parameter eps", chain.eps, "so small that variations stay finite over a period",
            "take a smaller eps, or a larger eta",
        )  # fmt: skip
    error = float(np.abs(matrices[1] - matrices[0]).max())
    return floquet_multipliers(
        matrices[1], 2.0 * math.pi / breather.frequency, chain.eps, parity=1, error=error
    )
