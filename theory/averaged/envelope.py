"""The averaged chain, Eqs. (34) and (43) at ω = 1, in slow time T = εt.

    φ_n' = (ic/2)(2φ_n - φ_{n-1} - φ_{n+1}) - φ_n g(|φ_n|²),   g(s) = ½(1 - a s/4 + b s²/8)     (43)

A site at a free end has one neighbour: φ_1' = (ic/2)(φ_1 - φ_2) - φ_1 g(|φ_1|²).

**Quarter-turn reduction.** With φ_n = (-i)^n r_n e^{icT} the bulk equation has real coefficients,

    r_n' = (c/2)(r_{n-1} - r_{n+1}) - r_n g(r_n²),

so that real r_n (of either sign) remain real; every pattern of phase steps ±π/2 has this form. At a
free end the frequency shift of the site is c/2 instead of c, and a term -(ic/2) r_1 remains. There
the reduction is *not* exact: it omits rates up to (c/2) max(|r_1|, |r_N|), which are as small as
the tail of the breather.
"""

from __future__ import annotations

import numpy as np

from theory.arrays import ComplexArray, FloatArray
from theory.chains.ends import Ends
from theory.chains.vdp import VanDerPolChain
from theory.parameters import ParameterError


def damping(square: FloatArray, chain: VanDerPolChain) -> FloatArray:
    """Return g(|φ|²) = ½(1 - a|φ|²/4 + b|φ|⁴/8), the mean damping rate in (34); dimensionless.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> chain = VdpChain(a=2.5, b=0.5, c=0.1)
    >>> bool(abs(damping(chain.stable_amplitude**2, chain)) < 1e-15)
    True
    """
    return 0.5 * (1.0 - 0.25 * chain.a * square + 0.125 * chain.b * square**2)


def damping_slope(square: FloatArray, chain: VanDerPolChain) -> FloatArray:
    """Return dg/d(|φ|²) = ½(-a/4 + b|φ|²/4)."""
    return 0.125 * (chain.b * square - chain.a)


def coupling_matrix(sites: int, ends: Ends) -> FloatArray:
    """Return the matrix L of the springs in (8): (Ly)_n = 2y_n - y_{n-1} - y_{n+1}.

    Parameters
    ----------
    sites : int
        Number of sites N, at least 2.
    ends : Ends
        Boundary conditions; with free ends, sites 1 and N have one neighbour and 1 on the diagonal.

    Examples
    --------
    >>> coupling_matrix(3, Ends.FREE).astype(int).tolist()
    [[1, -1, 0], [-1, 2, -1], [0, -1, 1]]
    """
    matrix = 2.0 * np.eye(sites) - np.eye(sites, k=1) - np.eye(sites, k=-1)
    if ends is Ends.FREE:
        matrix[0, 0] = matrix[-1, -1] = 1.0
    else:
        matrix[0, -1] -= 1.0
        matrix[-1, 0] -= 1.0
    return matrix


def envelope_rate(phi: ComplexArray, chain: VanDerPolChain) -> ComplexArray:
    """Return φ' of (43), per unit of slow time T.

    Parameters
    ----------
    phi : complex array, shape (N,)
        Envelope φ_n of Ψ_n = ẏ_n + i y_n = φ_n e^{it}.
    chain : VdpChain or AveragedChain
        The chain, of which a, b, c and the ends are used; ε plays no role.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> chain = VdpChain(a=2.5, b=0.5, c=0.1, sites=3)
    >>> uniform = np.full(3, chain.stable_amplitude, dtype=complex)
    >>> bool(abs(envelope_rate(uniform, chain)).max() < 1e-14)
    True
    """
    springs = 2.0 * phi
    springs[1:] -= phi[:-1]
    springs[:-1] -= phi[1:]
    if chain.ends is Ends.FREE:
        springs[0] -= phi[0]
        springs[-1] -= phi[-1]
    else:
        springs[0] -= phi[-1]
        springs[-1] -= phi[0]
    return 0.5j * chain.c * springs - phi * damping(np.abs(phi) ** 2, chain)


def envelope_jacobian(phi: ComplexArray, chain: VanDerPolChain) -> FloatArray:
    """Return the real Jacobian of (43) in the unknowns (Re φ, Im φ).

    Returns
    -------
    float array, shape (2N, 2N)
        Rows and columns: Re φ_1 … Re φ_N, Im φ_1 … Im φ_N.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> envelope_jacobian(np.zeros(3, complex), VdpChain(a=2.5, b=0.5, c=0, sites=3))[0, 0]
    np.float64(-0.5)
    """
    sites = len(phi)
    x, y = phi.real, phi.imag
    square = x**2 + y**2
    g, slope = damping(square, chain), 2.0 * damping_slope(square, chain)
    springs = 0.5 * chain.c * coupling_matrix(sites, chain.ends)
    return np.block(
        [
            [-np.diag(g + slope * x * x), -springs - np.diag(slope * x * y)],
            [springs - np.diag(slope * x * y), -np.diag(g + slope * y * y)],
        ]
    )


def quarter_turn_phase(sites: int) -> ComplexArray:
    """Return (-i)^n for n = 0 … N-1, so that φ_n = (-i)^n r_n e^{icT}.

    Examples
    --------
    >>> [int(value) for value in (quarter_turn_phase(4) * [1, 1j, -1, -1j]).real]
    [1, 1, 1, 1]
    """
    return np.array([1, -1j, -1, 1j])[np.arange(sites) % 4]


def quarter_turn_rate(r: FloatArray, chain: VanDerPolChain) -> FloatArray:
    """Return r' of the reduction of (43) to quarter-turn phase steps, per unit T.

    Beyond a free end the chain is assumed to be at rest, and the end site to have the frequency
    shift of the bulk.

    Raises
    ------
    ParameterError
        If the ends are periodic and N is not a multiple of four, so that (-i)^n is not periodic.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> float(quarter_turn_rate(np.array([0.0, 0.0, 1.0]), VdpChain(a=2, b=0.5, c=0.2, sites=3))[1])
    -0.1
    """
    _need_closed(len(r), chain)
    left, right = _neighbours(r, chain.ends)
    return 0.5 * chain.c * (left - right) - r * damping(r**2, chain)


def quarter_turn_jacobian(r: FloatArray, chain: VanDerPolChain) -> FloatArray:
    """Return the Jacobian of `quarter_turn_rate`, shape (N, N)."""
    _need_closed(len(r), chain)
    sites = len(r)
    matrix = 0.5 * chain.c * (np.eye(sites, k=-1) - np.eye(sites, k=1))
    if chain.ends is Ends.PERIODIC:
        matrix[0, -1] += 0.5 * chain.c
        matrix[-1, 0] -= 0.5 * chain.c
    square = r**2
    return matrix - np.diag(damping(square, chain) + 2.0 * square * damping_slope(square, chain))


def _neighbours(r: FloatArray, ends: Ends) -> tuple[FloatArray, FloatArray]:
    left, right = np.roll(r, 1), np.roll(r, -1)
    if ends is Ends.FREE:
        left[0] = right[-1] = 0.0
    return left, right


def _need_closed(sites: int, chain: VanDerPolChain) -> None:
    if chain.ends is Ends.PERIODIC and sites % 4:
        raise ParameterError(
            "number of sites n",
            sites,
            "a multiple of 4 for phase steps of -pi/2 on a ring",
            "change n or take free ends",
        )
