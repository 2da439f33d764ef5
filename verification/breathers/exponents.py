"""Stability of a breather: exponents of the averaged chain, and the split of modes by reflection.

Exponents are eigenvalues λ of (43) linearised in the frame rotating at Ω, per unit of T; over a
period of (8) they give multipliers e^{2πελ} to leading order.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from theory.arrays import EPS, ComplexArray, FloatArray
from theory.averaged.envelope import envelope_jacobian
from theory.chains.vdp import VanDerPolChain
from theory.result import Result

MARGINAL = 1e-9
"""Growth rates below this count as zero: round-off in an eigenvalue that is exactly zero."""


@dataclass(frozen=True, kw_only=True)
class BreatherStability(Result):
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
        reflection and of the opposite parity; None if the breather is not mirror-symmetric. Of the
        second no error is known.
    marginal : float
        Growth rate up to which a mode counts as not growing, round-off of an exact zero, unless its
        error is smaller.
    error : float
        Bound on the distances of all computed values from the exact ones, paired suitably; infinite
        if it was not computed.
    growth_error, symmetric_error : float
        The same for ``growth`` and ``symmetric``; also infinite where a multiplier may be zero.
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
    symmetric_error: float

    @property
    def stable(self) -> bool | None:
        """Whether no perturbation grows; None if the known error of the growth rate spans zero."""
        if self.marginal < self.growth_error < math.inf and abs(self.growth) <= self.growth_error:
            return None
        return self.growth <= min(self.marginal, self.growth_error)


def rotating_jacobian(phi: ComplexArray, omega: float, chain: VanDerPolChain) -> FloatArray:
    """Return the Jacobian of φ' - iΩφ in (Re φ, Im φ), shape (2N, 2N)."""
    rotation = omega * np.eye(chain.sites)
    zero = np.zeros_like(rotation)
    jacobian: FloatArray = envelope_jacobian(phi, chain) + np.block(
        [[zero, rotation], [-rotation, zero]]
    )
    return jacobian


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
    parity = 0
    if mirrored:  # the phase mode iφ has the parity of φ
        parity = 1 if np.linalg.norm(phi - phi[::-1]) < np.linalg.norm(phi) else -1
    # The error of φ is that of its real and of its imaginary part; sites do not affect one another.
    phi_bound = math.sqrt(2.0) * error
    perturbation = (
        omega_error
        + _second_derivative_bound(float(np.abs(phi).max()) + phi_bound, chain) * phi_bound
    )
    found = modes_of(
        rotating_jacobian(phi, omega, chain),
        parity,
        trivial=0.0,
        size=np.real,
        perturbation=perturbation,
    )
    return BreatherStability(
        values=found.values,
        trivial=found.trivial,
        leader=found.leader,
        growth=found.leader.real,
        frequency=abs(found.leader.imag),
        symmetric=None if found.symmetric is None else found.symmetric.real,
        antisymmetric=None if found.antisymmetric is None else found.antisymmetric.real,
        marginal=MARGINAL,
        error=found.error,
        growth_error=found.error,
        symmetric_error=found.error,
    )


def _second_derivative_bound(largest: float, chain: VanDerPolChain) -> float:
    """Return a bound on the second derivatives of -φ (1 - a|φ|²/4 + b|φ|⁴/8)/2 up to some |φ|."""
    return largest * (0.75 * chain.a + 1.25 * chain.b * largest**2)


@dataclass(frozen=True, kw_only=True)
class Modes:
    """Eigenvalues of a monodromy matrix or a Jacobian, split by parity.

    Attributes
    ----------
    values : complex array, shape (2N,)
        All of them by descending size.
    trivial : float
        Distance of the trivial one from its exact value.
    leader : complex
        The largest nontrivial one.
    symmetric, antisymmetric : complex or None
        The largest nontrivial one of the breather's own parity, and that of the other; None if they
        are not split.
    error : float
        Bound on the distances of all values from the exact ones, paired suitably.
    """

    values: ComplexArray
    trivial: float
    leader: complex
    symmetric: complex | None
    antisymmetric: complex | None
    error: float


def modes_of(
    matrix: FloatArray,
    parity: int,
    *,
    trivial: float,
    size: Callable[[ComplexArray], FloatArray],
    perturbation: float,
) -> Modes:
    """Return the eigenvalues of a matrix, sorted and split by parity, with their error.

    Parameters
    ----------
    matrix : float array, shape (2N, 2N)
        Two blocks of N sites each; commutes with the reflection n → N+1-n if ``parity`` is given.
    parity : int
        Parity of the breather, which is also that of the trivial mode; 0 if it has none.
    trivial : float
        Eigenvalue of the trivial mode of an exact breather.
    size : callable
        What the eigenvalues are sorted by.
    perturbation : float
        Error of the matrix in the spectral norm. No eigenvectors are computed if it is infinite.
    """

    def largest(among: ComplexArray) -> complex:
        return complex(among[int(size(among).argmax())])

    sites = len(matrix) // 2
    bases = (
        [parity_basis(sites, each) for each in (parity, -parity)]
        if parity
        else [np.eye(len(matrix))]
    )
    spectra = [_spectrum(basis @ matrix @ basis.T, perturbation) for basis in bases]
    values = np.concatenate([found for found, _ in spectra])
    own = spectra[0][0]
    trivial_index = int(np.abs(own - trivial).argmin())
    nontrivial = [np.delete(own, trivial_index), *(found for found, _ in spectra[1:])]
    symmetric, antisymmetric = map(largest, nontrivial) if parity else (None, None)
    return Modes(
        values=values[np.argsort(-size(values), kind="stable")],
        trivial=float(abs(own[trivial_index] - trivial)),
        leader=largest(np.concatenate(nontrivial)),
        symmetric=symmetric,
        antisymmetric=antisymmetric,
        error=max(error for _, error in spectra),
    )


def _spectrum(matrix: FloatArray, perturbation: float) -> tuple[ComplexArray, float]:
    """Return the eigenvalues of a matrix and their error, infinite if ``perturbation`` is."""
    if perturbation == math.inf:
        return np.asarray(np.linalg.eigvals(matrix), dtype=complex), math.inf
    values, vectors = np.linalg.eig(matrix)
    return np.asarray(values, dtype=complex), eigenvalue_bound(
        matrix, values, vectors, perturbation
    )


def eigenvalue_bound(
    matrix: FloatArray, values: ComplexArray, vectors: ComplexArray, perturbation: float
) -> float:
    """Return a bound on the distances of eigenvalues from those of the exact matrix, in pairs.

    With δ the error of the matrix in the spectral norm and V its eigenvectors, every exact
    eigenvalue lies in a disc about a computed one, of radius cond(V) δ (Bauer and Fike 1960) and of
    radius (2‖M‖ + δ)^{1-1/n} δ^{1/n} (Elsner 1985). By continuity, discs that are connected to one
    another contain as many exact eigenvalues as discs, but one of them may contain all. However
    they are paired, an exact eigenvalue is therefore no farther from its computed one than the
    radius plus the largest distance between the centres of connected discs. The rounding of LAPACK
    is equivalent to a perturbation of the matrix by n units in the last place.

    Parameters
    ----------
    matrix, values, vectors : array
        Computed n × n matrix, and its eigenvalues and eigenvectors.
    perturbation : float
        Error of the matrix in the spectral norm.

    Examples
    --------
    >>> pair = np.diag([1.0, 1.5])
    >>> [round(eigenvalue_bound(pair, np.diag(pair), np.eye(2), delta), 9) for delta in (0.2, 0.3)]
    [0.2, 0.8]
    """
    size = len(matrix)
    norm = float(np.linalg.norm(matrix))
    perturbation += size * EPS * norm
    elsner = (2.0 * norm + perturbation) ** (1.0 - 1.0 / size) * perturbation ** (1.0 / size)
    with np.errstate(over="ignore"):  # eigenvectors may be dependent to the last bit
        radius = float(min(float(np.linalg.cond(vectors)) * perturbation, elsner))
    distances = np.abs(np.subtract.outer(values, values))
    connected = distances <= 2.0 * radius
    for _ in range(size.bit_length()):  # through twice as many discs each time
        connected = connected.astype(float) @ connected > 0.0
    return radius + float(distances[connected].max())


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
    sites = len(u) // 2  # Ω is the last
    return u[:sites] + 1j * u[sites:-1], float(u[-1])
