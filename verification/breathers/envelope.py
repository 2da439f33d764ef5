"""Breathers of the averaged chain (43), solved exactly: φ_n(T) = φ_n e^{iΩT}.

The unknowns are Re φ_n, Im φ_n and Ω, with Im φ = 0 at the centre of the nucleus. A branch starts
from the anticontinuum limit c → 0 and is followed through its fold. Exponents are eigenvalues λ of
the linearisation in the rotating frame, per unit of T; over a period of (8) they give
multipliers e^{2πελ}.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from theory.averaged.breather import BreatherStatus
from theory.averaged.envelope import (
    coupling_matrix,
    envelope_rate,
    staggered_jacobian,
    staggered_phase,
    staggered_rate,
)
from theory.chains.ends import Ends
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VanDerPolChain
from theory.parameters import ParameterError, RunError
from verification.breathers.exponents import (
    Exponents,
    exponents,
    rotating_jacobian,
    stability_monitor,
    unpack,
)
from verification.continuation.branch import Branch, Fold, arrive, trace
from verification.continuation.newton import BranchPoint, NotConvergedError, System, solve_at

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

START = 0.01
"""Coupling at which branches leave the anticontinuum limit."""


@dataclass(frozen=True, kw_only=True)
class EnvelopeBreather:
    """A breather of the averaged chain, solved; `Breather` has what every method gives.

    Attributes
    ----------
    status : BreatherStatus
        By default, as all other fields are by default, that there is none: the branch folds below
        this coupling.
    phi : complex array, shape (N,)
        φ_n; empty if there is none.
    detuning : float or None
        Ω per unit T; None if there is no breather.
    exponents : Exponents or None
        Stability.
    fold : Fold or None
        Where the branch ends, if that was reached.
    error : float
        Estimated error of φ and Ω: the Newton step that would come next.
    residual : float
        Largest entry of the equations.
    seconds : float
        Wall-clock time.
    """

    status: BreatherStatus = BreatherStatus.NONE
    phi: Complex = field(default_factory=lambda: np.empty(0, dtype=complex))
    detuning: float | None = None
    exponents: Exponents | None = None
    fold: Fold | None
    error: float = math.inf
    residual: float = math.inf
    seconds: float

    @property
    def omega(self) -> float:
        """Ω per unit T; the frequency in t is 1 + εΩ.

        Raises
        ------
        RunError
            If there is no breather.
        """
        if self.detuning is None:
            raise RunError(BreatherStatus.NONE.sentence)
        return self.detuning


def rotating_system(chain: VanDerPolChain, centre: int) -> System:
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


def start_of_branch(chain: VanDerPolChain, nucleus: Nucleus, c: float = START) -> BranchPoint:
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
            "one a steady breather can have at small c (see theory.chains.nucleus.py)",
            "name another pattern",
        )
    return point


def envelope_branch(
    chain: VanDerPolChain, nucleus: Nucleus, c_end: float = 2.0, *, monitored: bool = True
) -> Branch:
    """Follow the breather from c → 0 through its fold, with its growth rates if ``monitored``.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> branch = envelope_branch(VdpChain(a=2.5, b=0.5, c=0, sites=15), Nucleus(1))
    >>> round(branch.fold.c, 6)
    0.190788
    """
    start = start_of_branch(chain, nucleus)
    system = rotating_system(chain, nucleus.centre(chain.sites))
    monitor = stability_monitor(chain, nucleus) if monitored else None
    return trace(system, start, c_end, monitor)


def solve_envelope_breather(chain: VanDerPolChain, nucleus: Nucleus) -> EnvelopeBreather:
    """Solve the averaged breather at the coupling of ``chain``.

    Raises
    ------
    ParameterError
        If c = 0, the cell has no cycle, or the nucleus does not fit.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
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
            return EnvelopeBreather(fold=fold, seconds=time.perf_counter() - started)
        point = arrive(system, branch, chain.c)
    return describe_envelope(chain, nucleus, point, started, fold)


def describe_envelope(
    chain: VanDerPolChain,
    nucleus: Nucleus,
    point: BranchPoint,
    started: float,
    fold: Fold | None = None,
) -> EnvelopeBreather:
    """Measure a breather that has been solved for: exponents and error."""
    here = replace(chain, c=point.c)
    phi, omega = unpack(point.u)
    return EnvelopeBreather(
        status=BreatherStatus.EXISTS,
        phi=phi,
        detuning=omega,
        exponents=exponents(phi, omega, here, nucleus.mirrored(chain.sites)),
        fold=fold,
        error=2.0 * point.correction + _rounding(phi, here),
        residual=point.residual,
        seconds=time.perf_counter() - started,
    )


def _rounding(phi: Complex, chain: VanDerPolChain) -> float:
    """Return what rounding of the damping does to an amplitude: it cancels as the cycles meet."""
    gap = max(1.0 - 8.0 * chain.eta, 1e-16)
    return 8.0 * float(np.finfo(float).eps * np.abs(phi).max()) * (1.0 + 1.0 / math.sqrt(gap))


def staggered_branch(chain: VanDerPolChain, nucleus: Nucleus, c_end: float = 2.0) -> Branch:
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


def _left_pattern(
    u: Real, guess: Complex, excited: NDArray[np.intp], chain: VanDerPolChain
) -> bool:
    """Whether the solution is not the one that was started from."""
    phi, _ = unpack(u)
    return bool(np.abs(phi[excited] - guess[excited]).max() > 0.3 * chain.stable_amplitude)
