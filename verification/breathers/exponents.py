"""Stability of a breather: exponents of the averaged chain, and the split of modes by reflection.

Exponents are eigenvalues λ of (43) linearised in the frame rotating at Ω, per unit of T; over a
period of (8) they give multipliers e^{2πελ} to leading order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from theory.arrays import ComplexArray, FloatArray
from theory.averaged.envelope import envelope_jacobian
from theory.chains.vdp import VanDerPolChain

MARGINAL = 1e-9
"""Growth rates below this count as zero: round-off in an eigenvalue that is exactly zero."""


@dataclass(frozen=True, kw_only=True)
class BreatherStability:
    """Stability of a breather against small perturbations.

    Attributes
    ----------
    values : complex array, shape (2N,)
        Floquet multipliers by descending modulus or, for (43), exponents by descending real part.
    trivial : float
        Distance of the trivial (phase) multiplier from 1, or of the trivial exponent from 0.
    leader : complex
        The nontrivial multiplier or exponent that grows fastest.
    growth : float
        Its growth rate per unit of slow time T.
    frequency : float
        The absolute value of the imaginary part of that rate.
    symmetric, antisymmetric : float or None
        Largest growth, without the trivial mode, among modes of the breather's own parity under
        reflection and of the opposite parity; None if the breather is not mirror-symmetric.
    marginal : float
        Growth rate up to which a mode counts as not growing: round-off of an exact zero.
    error : float
        Bound on the distance of each computed value from an exact one; infinite if it was not
        computed.
    growth_error : float
        The same for ``growth``; also infinite where a multiplier may be zero.
    """

    values: ComplexArray
    trivial: float
    leader: complex
    growth: float
    frequency: float
    symmetric: float | None
    antisymmetric: float | None
    marginal: float
    error: float
    growth_error: float

    @property
    def stable(self) -> bool:
        """Whether no perturbation grows."""
        return self.growth <= self.marginal


def rotating_jacobian(phi: ComplexArray, omega: float, chain: VanDerPolChain) -> FloatArray:
    """Return the Jacobian of φ' - iΩφ in (Re φ, Im φ), shape (2N, 2N)."""
    turn = omega * np.eye(chain.sites)
    zero = np.zeros_like(turn)
    turned: FloatArray = envelope_jacobian(phi, chain) + np.block([[zero, turn], [-turn, zero]])
    return turned


def exponents(
    phi: ComplexArray,
    omega: float,
    chain: VanDerPolChain,
    mirrored: bool = False,
    *,
    error: float = 0.0,
    omega_error: float = 0.0,
) -> BreatherStability:
    """Return the eigenvalues of the linearisation, split by parity if ``mirrored``.

    Their error bounds follow from the errors of φ and Ω, as those of multipliers do. They are
    infinite, and eigenvectors are not computed, if ``error`` is.
    """
    jacobian, bound = rotating_jacobian(phi, omega, chain), math.inf
    if error < math.inf:
        off = omega_error + _bend(np.abs(phi), chain) * error
        bound = eigenvalue_bound(jacobian, np.linalg.eig(jacobian)[1], off)
    if not mirrored:
        values = np.asarray(np.linalg.eigvals(jacobian), dtype=complex)
        values = values[np.argsort(-values.real, kind="stable")]
        symmetric = antisymmetric = None
        rest = np.delete(values, int(np.abs(values).argmin()))
    else:
        parity = 1 if np.abs(phi + phi[::-1]).sum() > np.abs(phi - phi[::-1]).sum() else -1
        even = split_eigenvalues(jacobian, parity)
        odd = split_eigenvalues(jacobian, -parity)
        values = np.concatenate([even, odd])
        values = values[np.argsort(-values.real, kind="stable")]
        # The phase mode iφ has the parity of φ.
        even = np.delete(even, int(np.abs(even).argmin()))
        symmetric, antisymmetric = float(even.real.max()), float(odd.real.max())
        rest = np.concatenate([even, odd])
    leader = rest[int(rest.real.argmax())]
    return BreatherStability(
        values=values,
        trivial=float(np.abs(values).min()),
        leader=complex(leader),
        growth=float(leader.real),
        frequency=float(abs(leader.imag)),
        symmetric=symmetric,
        antisymmetric=antisymmetric,
        marginal=MARGINAL,
        error=bound,
        growth_error=bound,
    )


def _bend(size: FloatArray, chain: VanDerPolChain) -> float:
    """Return a bound on the second derivatives of -φ (1 - a|φ|²/4 + b|φ|⁴/8)/2."""
    largest = float(size.max())
    return largest * (0.75 * chain.a + 1.25 * chain.b * largest**2)


def eigenvalue_bound(matrix: FloatArray, vectors: ComplexArray, error: float) -> float:
    """Return a bound on the distance of eigenvalues of an n × n matrix from those of the exact one.

    With δ the error of the matrix in the spectral norm and V its eigenvectors, the bounds are
    cond(V) δ (Bauer and Fike 1960) and (2‖M‖ + δ)^{1-1/n} δ^{1/n} (Elsner 1985). The rounding of
    LAPACK is equivalent to a perturbation of the matrix by n units in the last place.
    """
    size = len(matrix)
    norm = float(np.linalg.norm(matrix))
    off = size * (error + float(np.finfo(float).eps) * norm)
    elsner = (2.0 * norm + off) ** (1.0 - 1.0 / size) * off ** (1.0 / size)
    with np.errstate(over="ignore"):  # eigenvectors may be dependent to the last bit
        return float(min(float(np.linalg.cond(vectors)) * off, elsner))


def split_eigenvalues(matrix: FloatArray, parity: int) -> ComplexArray:
    """Return the eigenvalues of a (2N, 2N) matrix on vectors of one parity under n → N+1-n.

    Parameters
    ----------
    matrix : float array, shape (2N, 2N)
        Two blocks of N sites each; commutes with the reflection.
    parity : int
        +1 or -1.
    """
    basis = parity_basis(matrix.shape[0] // 2, parity)
    return np.asarray(np.linalg.eigvals(basis @ matrix @ basis.T), dtype=complex)


def parity_basis(sites: int, parity: int) -> FloatArray:
    """Return orthonormal rows that span the vectors (y, v) of one parity, shape (~N, 2N).

    Examples
    --------
    >>> parity_basis(3, -1).round(3).tolist()
    [[0.707, 0.0, -0.707, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.707, 0.0, -0.707]]
    """
    unit = np.eye(sites)
    half = np.array(
        [unit[n] + parity * unit[sites - 1 - n] for n in range((sites + (parity > 0)) // 2)]
    )
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    zero = np.zeros_like(half)
    return np.block([[half, zero], [zero, half]])


def unpack(u: FloatArray) -> tuple[ComplexArray, float]:
    """Return φ and Ω from the unknowns of a breather of (43)."""
    sites = (len(u) - 1) // 2
    return u[:sites] + 1j * u[sites:-1], float(u[-1])
