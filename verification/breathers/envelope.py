"""Breathers of the averaged chain (43), solved exactly: φ_n(T) = φ_n e^{iΩT}.

The unknowns are Re φ_n, Im φ_n and Ω, with Im φ = 0 at the centre of the nucleus. A branch starts
from the anticontinuum limit c → 0 and is followed through its fold. Exponents are the eigenvalues λ
of the linearisation in the rotating frame, per unit of T; over a period of (8) they correspond to
multipliers e^{2πελ}.
"""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from theory.arrays import EPS, ComplexArray, FloatArray
from theory.averaged.breather import BreatherStatus, closed_form_fold
from theory.averaged.envelope import (
    coupling_matrix,
    envelope_rate,
    quarter_turn_jacobian,
    quarter_turn_phase,
    quarter_turn_rate,
)
from theory.cells.vdp import ETA_END
from theory.chains.ends import Ends
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VanDerPolChain
from theory.parameters import ParameterError, at_least
from verification.breathers.exponents import BreatherStability, exponents, rotating_jacobian, unpack
from verification.breathers.family import BreatherFamily, ReportCallback, silent
from verification.breathers.result import Breather, BreatherMethod, wave_error_of
from verification.continuation.branch import ContinuationBranch, Fold, FoldShift, fold_shift, trace
from verification.continuation.newton import (
    BranchPoint,
    NotConvergedError,
    System,
    solution_error,
    solve_at,
)

SMALLEST_ETA = 1e-6
"""Smallest η: below it, rounding of the cell's rate, 1/(2η) at the cycle, shifts folds by more than
the stated error."""


def start_of(
    chain: VanDerPolChain, nucleus: Nucleus, largest: float = 0.01, fraction: float = 0.25
) -> float:
    """Return the coupling at which branches leave the limit c → 0: a fraction of their fold.

    The fold of a single site goes to zero like √η, and agrees with that of the closed form to a few
    per cent. A site with an excited neighbour may be driven at first order in c, against a rate of
    the cell that vanishes like 1 - 8η where its cycles meet; the fold then vanishes likewise.

    Examples
    --------
    >>> from theory.chains.vdp import AveragedChain
    >>> [f"{start_of(AveragedChain(a=1, b=b, c=0), Nucleus(1)):.4f}" for b in (0.08, 1e-4)]
    ['0.0100', '0.0014']
    """
    fold = closed_form_fold(chain).c
    if nucleus.size > 1:
        fold = min(fold, 1.0 - chain.eta / ETA_END)
    return min(largest, fraction * fold)


@dataclass(frozen=True)
class RotatingWaves(BreatherFamily):
    """The breathers of the averaged chain.

    Examples
    --------
    >>> from theory.chains.vdp import AveragedChain
    >>> branch = RotatingWaves(AveragedChain(a=2.5, b=0.5, c=0, sites=15), Nucleus(1)).branch()
    >>> round(branch.fold.parameter, 6)
    0.190788
    """

    method = BreatherMethod.ENVELOPE

    chain: VanDerPolChain

    @property
    def unit(self) -> float:
        """Unit of φ: a power of 16 near the cycle's amplitude, so that scaling rounds nothing.

        It is 1 for cycles from 1 to 16. At every scale of a and b, residuals and steps along a
        branch are then of order one.
        """
        return float(16.0 ** round(math.log(self.chain.stable_amplitude / 4.0, 16.0)))

    @property
    def rate_unit(self) -> float:
        """Unit of φ', a power of 16: the cycle attracts at a rate of about 1/(2η)."""
        return float(16.0 ** max(round(math.log(0.02 / self.chain.eta, 16.0)), 0))

    def unpack(self, u: FloatArray) -> tuple[ComplexArray, float]:
        """Return φ and Ω from the unknowns."""
        phi, omega = unpack(u)
        return self.unit * phi, omega

    def system(self, refinement: int = 1) -> System:
        """Return F(u, c) with u = (Re φ, Im φ, Ω): φ' - iΩφ = 0 and Im φ = 0 at the centre.

        φ is in units of `unit`, and φ' in units of `unit` times `rate_unit`.
        """
        chain, sites, centre = self.chain, self.chain.sites, self.centre
        unit, rate_unit = self.unit, self.rate_unit
        matrix = coupling_matrix(sites, chain.ends)

        def system(u: FloatArray, c: float) -> tuple[FloatArray, FloatArray, FloatArray]:
            chain_at_c = replace(chain, c=abs(c))
            x, y, omega = u[:sites], u[sites:-1], u[-1]
            phi = np.asarray(unit * (x + 1j * y), dtype=complex)
            rate = (envelope_rate(phi, chain_at_c) - 1j * omega * phi) / (unit * rate_unit)
            value = np.concatenate([rate.real, rate.imag, [y[centre]]])
            jacobian = np.zeros((2 * sites + 1, 2 * sites + 1))
            jacobian[:-1, :-1] = rotating_jacobian(phi, omega, chain_at_c) / rate_unit
            jacobian[:-1, -1] = np.concatenate([y, -x]) / rate_unit
            jacobian[-1, sites + centre] = 1.0
            by_c = 0.5j * (matrix @ phi) / (unit * rate_unit)
            return value, jacobian, np.concatenate([by_c.real, by_c.imag, [0.0]])

        return system

    def start(
        self, c_end: float, lowest: float = math.inf, report: ReportCallback = silent
    ) -> BranchPoint:
        """Solve near c = 0, from the cycle of one cell on every excited site.

        Raises
        ------
        ParameterError
            If the nucleus is wider than the chain, the pattern has no breather near c = 0, or η is
            below `SMALLEST_ETA`.
        """
        chain, nucleus = self.chain, self.nucleus
        c = min(start_of(chain, nucleus), lowest)
        remedy = "take the closed form, whose relative difference is of order η there"
        at_least("eta = b/a^2", chain.eta, SMALLEST_ETA, remedy)
        phi = nucleus.envelope(chain)
        chain_at_c = replace(chain, c=c)
        excited = np.flatnonzero(phi)
        rates = envelope_rate(phi, chain_at_c)[excited] / phi[excited]
        omega = float(np.mean(rates.imag))
        # The neighbours at rest follow immediately: 0 = -(ic/2) φ_excited - φ/2 to leading order.
        for outside, inner in ((excited[0] - 1, excited[0]), (excited[-1] + 1, excited[-1])):
            if 0 <= outside < chain.sites:
                phi[outside] = -1j * c * phi[inner]
        guess = np.concatenate([phi.real / self.unit, phi.imag / self.unit, [omega]])
        try:
            point = solve_at(self.system(), guess, c)
        except NotConvergedError:
            point = None
        if point is None or _has_left_pattern(self.unpack(point.u)[0], phi, excited, chain):
            raise ParameterError(
                "pattern",
                repr(nucleus.pattern),
                "one whose sites can have a common frequency at small c",
                "name another pattern",
            )
        return point

    def directly(self) -> BranchPoint | None:
        """Return the start of the branch, unless it lies beyond the coupling of the chain."""
        c = self.chain.c
        return self.start(0.0, c) if c <= start_of(self.chain, self.nucleus) else None

    def stability(self, u: FloatArray, c: float, *, split: bool = True) -> BreatherStability:
        """Return the exponents, without bounds on their errors."""
        mirrored = split and self.nucleus.mirrored(self.chain.sites)
        chain_at_c = replace(self.chain, c=c)
        return exponents(*self.unpack(u), chain_at_c, mirrored, error=math.inf)

    def step_error(self, fold: Fold) -> FoldShift:
        """Return bounds on the shifts of a fold by the rounding of F."""
        phi, omega = self.unpack(fold.u)
        return fold_shift(self.system(), fold, self._f_rounding(phi, omega, fold.parameter))

    def amplitudes(self, u: FloatArray, c: float) -> FloatArray:
        """Return |φ| of every site."""
        found: FloatArray = np.abs(self.unpack(u)[0])
        return found

    def _f_rounding(self, phi: ComplexArray, omega: float, c: float) -> FloatArray:
        """Return the rounding error of F in `system`, from the sizes of its terms."""
        chain = self.chain
        square = np.abs(phi) ** 2
        rates = 0.5 + chain.a * square / 8.0 + chain.b * square**2 / 16.0
        springs = 0.5 * c * np.abs(coupling_matrix(chain.sites, chain.ends))
        rotation = springs + abs(omega) * np.eye(chain.sites)
        x, y = np.abs(phi.real), np.abs(phi.imag)
        terms = np.concatenate([rates * x + rotation @ y, rates * y + rotation @ x, [0.0]])
        return 4.0 * EPS * terms / (self.unit * self.rate_unit)

    def measured(self, point: BranchPoint, started: float, fold: Fold | None = None) -> Breather:
        """Return a solution; its error is that of Newton's method plus rounding."""
        chain_at_c = replace(self.chain, c=point.parameter)
        phi, omega = self.unpack(point.u)
        frequency = 1.0 + chain_at_c.eps * omega
        rounding = _rounding(phi, chain_at_c)
        f_bound = self._f_rounding(phi, omega, chain_at_c.c)
        fold_error, c_bound = self.near_fold(chain_at_c.c, fold)
        u_bound = solution_error(self.system(), point.u, chain_at_c.c, f_bound, c_bound)
        u_bound = max(u_bound, 2.0 * point.correction)
        # Ω is dimensionless: its rounding is the relative one of φ, and also that of the frequency.
        relative_bound = u_bound + rounding / float(np.abs(phi).max())
        error = u_bound * self.unit + rounding
        mirrored = self.nucleus.mirrored(chain_at_c.sites)
        stability = exponents(
            phi, omega, chain_at_c, mirrored, error=error, omega_error=relative_bound
        )
        return Breather(
            chain=chain_at_c,
            nucleus=self.nucleus,
            method=self.method,
            status=BreatherStatus.EXISTS,
            amplitudes=np.abs(phi),
            waves=phi,
            frequency=frequency,
            growth_error=stability.growth_error,
            error=error,
            frequency_error=chain_at_c.eps * relative_bound + EPS * frequency,
            wave_error=wave_error_of(error, phi, self.nucleus.outward(chain_at_c.sites)),
            residual=point.residual,
            fold=None if fold is None else fold.parameter,
            fold_error=fold_error,
            unknowns=np.append(self.unit * point.u[:-1], omega),
            stability=stability,
            seconds=time.perf_counter() - started,
        )


def solve_envelope_breather(chain: VanDerPolChain, nucleus: Nucleus) -> Breather:
    """Solve the averaged breather at the coupling of ``chain``.

    Raises
    ------
    ParameterError
        If c = 0, the cell has no cycle, or the nucleus does not fit.

    Examples
    --------
    >>> from theory.chains.vdp import VdpChain
    >>> found = solve_envelope_breather(VdpChain(a=2.5, b=0.5, c=0.1, sites=15), Nucleus(1))
    >>> round(float(found.amplitudes[7]), 6), round(float(found.unknowns[-1]), 12)
    (2.818455, 0.1)
    """
    return RotatingWaves(chain, nucleus).solve()


def _rounding(phi: ComplexArray, chain: VanDerPolChain) -> float:
    """Return the effect of rounding in the damping on an amplitude; it grows as the cycles meet."""
    gap = max(1.0 - 8.0 * chain.eta, 1e-16)
    return 8.0 * float(EPS * np.abs(phi).max()) * (1.0 + 1.0 / math.sqrt(gap))


def quarter_turn_branch(chain: VanDerPolChain, nucleus: Nucleus) -> ContinuationBranch:
    """Follow the same branch in the real reduction to quarter-turn phase steps.

    For patterns of ``+`` and ``-`` only. With half the unknowns and neither frequency nor phase
    condition, this is an independent computation of the fold.

    Raises
    ------
    ParameterError
        If the pattern has a step other than ±π/2, or the nucleus is at an edge.
    """
    if set(nucleus.pattern) - {"+", "-"} or nucleus.first(chain.sites) == 0:
        raise ParameterError(
            "pattern",
            repr(nucleus.pattern),
            "of steps + and - in the bulk for the reduction of quarter-turn phase steps",
            "use the full envelope",
        )
    free = replace(chain, ends=Ends.FREE)

    def system(r: FloatArray, c: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        chain_at_c = replace(free, c=abs(c))
        uncoupled = quarter_turn_rate(r, replace(free, c=0.0))
        by_c = quarter_turn_rate(r, replace(free, c=1.0)) - uncoupled
        return quarter_turn_rate(r, chain_at_c), quarter_turn_jacobian(r, chain_at_c), by_c

    # In the frame of `envelope` φ is real at the centre; here it is rotated so that r is real too.
    rotated = nucleus.envelope(chain) / quarter_turn_phase(chain.sites)
    r = (rotated / quarter_turn_phase(chain.sites)[nucleus.centre(chain.sites)].conj()).real
    return trace(system, solve_at(system, r, start_of(chain, nucleus)), 2.0)


def _has_left_pattern(
    phi: ComplexArray, guess: ComplexArray, excited: NDArray[np.intp], chain: VanDerPolChain
) -> bool:
    """Return whether the solution is no longer the one from which the branch started."""
    return bool(np.abs(phi[excited] - guess[excited]).max() > 0.3 * chain.stable_amplitude)
