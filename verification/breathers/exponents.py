"""Exponents of averaged breathers, and the split of modes by reflection.

Exponents are eigenvalues λ of (43) linearised in the frame rotating at Ω, per unit of T; over a
period of (8) they give multipliers e^{2πελ} to leading order.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from theory.averaged.envelope import envelope_jacobian
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VanDerPolChain
from verification.continuation.branch import Monitor

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

MARGINAL = 1e-9
"""Growth rates below this count as zero: round-off of an eigenvalue that is exactly zero."""


@dataclass(frozen=True, kw_only=True)
class Exponents:
    """Eigenvalues of the linearisation in the rotating frame.

    Attributes
    ----------
    values : complex array, shape (2N,)
        All of them, by falling real part.
    trivial : float
        Distance from zero of the one that belongs to the phase; it should be zero.
    growth : float
        Largest real part of the others.
    frequency : float
        Imaginary part, taken positive, of the one that grows fastest.
    symmetric, antisymmetric : float or None
        Largest real parts (trivial one apart) among modes of the breather's own parity under
        reflection and of the other one; None if the breather is not mirror-symmetric.
    """

    values: Complex
    trivial: float
    growth: float
    frequency: float
    symmetric: float | None
    antisymmetric: float | None

    @property
    def stable(self) -> bool:
        """Whether nothing grows."""
        return self.growth <= MARGINAL


def rotating_jacobian(phi: Complex, omega: float, chain: VanDerPolChain) -> Real:
    """Return the Jacobian of φ' - iΩφ in (Re φ, Im φ), shape (2N, 2N)."""
    turn = omega * np.eye(chain.sites)
    zero = np.zeros_like(turn)
    turned: Real = envelope_jacobian(phi, chain) + np.block([[zero, turn], [-turn, zero]])
    return turned


def exponents(
    phi: Complex, omega: float, chain: VanDerPolChain, mirrored: bool = False
) -> Exponents:
    """Return the eigenvalues of the linearisation, split by reflection if ``mirrored``."""
    jacobian = rotating_jacobian(phi, omega, chain)
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
    return Exponents(
        values=values,
        trivial=float(np.abs(values).min()),
        growth=float(leader.real),
        frequency=float(abs(leader.imag)),
        symmetric=symmetric,
        antisymmetric=antisymmetric,
    )


def split_eigenvalues(matrix: Real, parity: int) -> Complex:
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


def parity_basis(sites: int, parity: int) -> Real:
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


def unpack(u: Real) -> tuple[Complex, float]:
    """Return φ and Ω from the unknowns of `rotating_system`."""
    sites = (len(u) - 1) // 2
    return u[:sites] + 1j * u[sites:-1], float(u[-1])


def stability_monitor(chain: VanDerPolChain, nucleus: Nucleus) -> Monitor:
    """Return a monitor of (growth, even growth, odd growth) less `MARGINAL`.

    Without mirror symmetry the last two repeat the first.
    """
    mirrored = nucleus.mirrored(chain.sites)

    def monitor(u: Real, c: float) -> tuple[float, ...]:
        phi, omega = unpack(u)
        found = exponents(phi, omega, replace(chain, c=c), mirrored)
        even = found.growth if found.symmetric is None else found.symmetric
        odd = found.growth if found.antisymmetric is None else found.antisymmetric
        return found.growth - MARGINAL, even - MARGINAL, odd - MARGINAL

    return monitor
