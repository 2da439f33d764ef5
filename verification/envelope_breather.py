"""Breathers of the averaged chain (43), solved exactly: φ_n(T) = φ_n e^{iΩT}.

The unknowns are Re φ_n, Im φ_n and Ω, with Im φ = 0 at the centre of the nucleus. A branch starts
from the anticontinuum limit c → 0 and is followed through its fold. Exponents are eigenvalues λ of
the linearisation in the rotating frame, per unit of T; over a period of (8) they give
multipliers e^{2πελ}.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from theory.breather import BreatherStatus
from theory.envelope import (
    coupling_matrix,
    envelope_jacobian,
    envelope_rate,
    staggered_defect,
    staggered_jacobian,
    staggered_phase,
    staggered_rate,
)
from theory.parameters import ParameterError
from theory.vdp_chain import Ends, VdpChain
from verification.continuation import (
    Branch,
    BranchPoint,
    Fold,
    Monitor,
    NotConvergedError,
    System,
    solve_at,
    trace,
)
from verification.nucleus import Nucleus

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

START = 0.01
"""Coupling at which branches leave the anticontinuum limit."""
MARGINAL = 1e-9
"""Growth rates below this count as zero: round-off of an eigenvalue that is exactly zero."""


@dataclass(frozen=True)
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


@dataclass(frozen=True)
class EnvelopeBreather:
    """A breather of the averaged chain.

    Attributes
    ----------
    status : BreatherStatus
        ``none`` if the branch folds below this coupling.
    phi : complex array, shape (N,)
        φ_n; empty if there is none.
    omega : float
        Ω per unit T; the frequency in t is 1 + εΩ.
    exponents : Exponents or None
        Stability.
    fold : Fold or None
        Where the branch ends, if that was reached.
    error : float
        Estimated error of φ: the last Newton correction.
    residual : float
        Largest entry of the equations.
    seconds : float
        Wall-clock time.
    """

    status: BreatherStatus
    phi: Complex
    omega: float
    exponents: Exponents | None
    fold: Fold | None
    error: float
    residual: float
    seconds: float


def rotating_system(chain: VdpChain, centre: int) -> System:
    """Return F(u, c) with u = (Re φ, Im φ, Ω): φ' - iΩφ = 0 and Im φ = 0 at the centre."""
    sites = chain.sites
    springs = coupling_matrix(sites, chain.ends)

    def system(u: Real, c: float) -> tuple[Real, Real, Real]:
        here = replace(chain, c=abs(c))
        x, y, omega = u[:sites], u[sites:-1], u[-1]
        phi = x + 1j * y
        rate = envelope_rate(phi, here) - 1j * omega * phi
        value = np.concatenate([rate.real, rate.imag, [y[centre]]])
        slope = np.zeros((2 * sites + 1, 2 * sites + 1))
        slope[:-1, :-1] = rotating_jacobian(phi, omega, here)
        slope[:-1, -1] = np.concatenate([y, -x])
        slope[-1, sites + centre] = 1.0
        by_c = 0.5j * (springs @ phi)
        return value, slope, np.concatenate([by_c.real, by_c.imag, [0.0]])

    return system


def rotating_jacobian(phi: Complex, omega: float, chain: VdpChain) -> Real:
    """Return the Jacobian of φ' - iΩφ in (Re φ, Im φ), shape (2N, 2N)."""
    turn = omega * np.eye(chain.sites)
    zero = np.zeros_like(turn)
    turned: Real = envelope_jacobian(phi, chain) + np.block([[zero, turn], [-turn, zero]])
    return turned


def exponents(phi: Complex, omega: float, chain: VdpChain, mirrored: bool = False) -> Exponents:
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
        values,
        float(np.abs(values).min()),
        float(leader.real),
        float(abs(leader.imag)),
        symmetric,
        antisymmetric,
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
    sites = matrix.shape[0] // 2
    half = np.array(
        [
            np.eye(sites)[n] + parity * np.eye(sites)[sites - 1 - n]
            for n in range((sites + (parity > 0)) // 2)
        ]
    )
    half /= np.linalg.norm(half, axis=1, keepdims=True)
    zero = np.zeros_like(half)
    basis = np.block([[half, zero], [zero, half]])
    return np.asarray(np.linalg.eigvals(basis @ matrix @ basis.T), dtype=complex)


def start_of_branch(chain: VdpChain, nucleus: Nucleus, c: float = START) -> BranchPoint:
    """Solve near c = 0, from the cycle of one cell on every excited site.

    Raises
    ------
    ParameterError
        If the nucleus is wider than the chain, or the pattern has no breather near c = 0.
    """
    phi = nucleus.envelope(chain)
    centre = nucleus.centre(chain.sites)
    here = replace(chain, c=c)
    excited = np.flatnonzero(phi)
    rates = envelope_rate(phi, here)[excited] / phi[excited]
    omega = float(np.mean(rates.imag))
    # The neighbours at rest follow at once: 0 = -(ic/2) φ_excited - φ/2 to leading order.
    for side, inner in ((excited[0] - 1, excited[0]), (excited[-1] + 1, excited[-1])):
        if 0 <= side < chain.sites:
            phi[side] = -1j * c * phi[inner]
    guess = np.concatenate([phi.real, phi.imag, [omega]])
    try:
        point = solve_at(rotating_system(chain, centre), guess, c)
    except NotConvergedError:
        point = None
    if point is None or _left_pattern(point.u, phi, excited, chain):
        raise ParameterError(
            "pattern",
            repr(nucleus.pattern),
            "one that a steady breather can have at small c (see verification/nucleus.py)",
            "name another pattern",
        )
    return point


def stability_monitor(chain: VdpChain, nucleus: Nucleus) -> Monitor:
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


def envelope_branch(chain: VdpChain, nucleus: Nucleus, c_end: float = 2.0) -> Branch:
    """Follow the breather from c → 0 through its fold, with its growth rates monitored.

    Examples
    --------
    >>> branch = envelope_branch(VdpChain(a=2.5, b=0.5, c=0, sites=15), Nucleus(1))
    >>> round(branch.fold.c, 6)
    0.190788
    """
    start = start_of_branch(chain, nucleus)
    system = rotating_system(chain, nucleus.centre(chain.sites))
    return trace(system, start, c_end, stability_monitor(chain, nucleus))


def solve_envelope_breather(chain: VdpChain, nucleus: Nucleus) -> EnvelopeBreather:
    """Solve the averaged breather at the coupling of ``chain``.

    Raises
    ------
    ParameterError
        If c = 0, the cell has no cycle, or the nucleus does not fit.

    Examples
    --------
    >>> found = solve_envelope_breather(VdpChain(a=2.5, b=0.5, c=0.1, sites=15), Nucleus(1))
    >>> round(float(abs(found.phi[7])), 6), round(found.omega, 12)
    (2.818455, 0.1)
    """
    started = time.perf_counter()
    if chain.c == 0:
        raise ParameterError("coupling c", 0, "positive for a breather", "give c > 0")
    centre = nucleus.centre(chain.sites)
    system = rotating_system(chain, centre)
    fold = None
    if chain.c <= START:
        point = start_of_branch(chain, nucleus, chain.c)
    else:
        branch = trace(system, start_of_branch(chain, nucleus), chain.c)
        fold = branch.fold
        if fold is not None and chain.c > fold.c:
            empty = np.empty(0, dtype=complex)
            seconds = time.perf_counter() - started
            return EnvelopeBreather(
                BreatherStatus.NONE, empty, math.nan, None, fold, math.inf, math.inf, seconds
            )
        point = _arrive(system, branch, chain.c)
    phi, omega = unpack(point.u)
    stability = exponents(phi, omega, chain, nucleus.mirrored(chain.sites))
    seconds = time.perf_counter() - started
    return EnvelopeBreather(
        BreatherStatus.EXISTS,
        phi,
        omega,
        stability,
        fold,
        point.correction + point.residual,
        point.residual,
        seconds,
    )


def staggered_branch(chain: VdpChain, nucleus: Nucleus, c_end: float = 2.0) -> Branch:
    """Follow the same branch in the real staggered reduction (patterns of ``+`` and ``-`` only).

    Half the unknowns, no frequency and no phase condition: an independent computation of the fold.

    Raises
    ------
    ParameterError
        If the pattern has a step other than ±π/2, or the nucleus is at an edge.
    """
    if set(nucleus.pattern) - {"+", "-"} or nucleus.first(chain.sites) == 0:
        raise ParameterError(
            "pattern",
            repr(nucleus.pattern),
            "of steps + and - in the bulk for the staggered reduction",
            "use the full envelope",
        )
    free = replace(chain, ends=Ends.FREE)

    def system(r: Real, c: float) -> tuple[Real, Real, Real]:
        here = replace(free, c=abs(c))
        unit = staggered_rate(r, replace(free, c=1.0)) - staggered_rate(r, replace(free, c=0.0))
        return staggered_rate(r, here), staggered_jacobian(r, here), unit

    # Real at the centre in the frame of `envelope`; turned so that it is real in the staggered one.
    turned = nucleus.envelope(chain) / staggered_phase(chain.sites)
    r = (turned / staggered_phase(chain.sites)[nucleus.centre(chain.sites)].conj()).real
    return trace(system, solve_at(system, r, START), c_end)


def staggered_error(r: Real, chain: VdpChain) -> float:
    """Return what the reduction leaves out at the ends, relative to the largest amplitude."""
    return staggered_defect(r, chain) / float(np.abs(r).max())


def unpack(u: Real) -> tuple[Complex, float]:
    """Return φ and Ω from the unknowns of `rotating_system`."""
    sites = (len(u) - 1) // 2
    return u[:sites] + 1j * u[sites:-1], float(u[-1])


def _arrive(system: System, branch: Branch, c: float) -> BranchPoint:
    """Solve at c from the nearest point before the fold."""
    before = [point for point in branch.points[: len(branch.monitored)] if point.c <= c]
    nearest = before[-1]
    slope = nearest.tangent[-1] / 10.0
    guess = nearest.u + nearest.tangent[:-1] * (c - nearest.c) / slope if slope > 0 else nearest.u
    after = branch.fold if branch.fold is not None else branch.points[-1]
    if branch.fold is not None and after.c > nearest.c:
        # Across a fold u varies like the square root of the distance to it.
        share = 1.0 - math.sqrt(max(0.0, (after.c - c) / (after.c - nearest.c)))
        guess = nearest.u + share * (after.u - nearest.u)
    return solve_at(system, guess, c)


def _left_pattern(u: Real, guess: Complex, excited: NDArray[np.intp], chain: VdpChain) -> bool:
    """Whether the solution is not the one that was started from."""
    phi, _ = unpack(u)
    return bool(np.abs(phi[excited] - guess[excited]).max() > 0.3 * chain.stable_amplitude)
