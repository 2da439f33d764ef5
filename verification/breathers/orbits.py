"""Exact periodic orbits by shooting with variational equations.

The unknowns are the state X(0) and the period; the equations are X(period) - X(0) = 0 and y = 0 at
the centre of the nucleus. Starting points come from the breather of the averaged chain, y = Im φ, ẏ
= Re φ. What differs for user-defined chains is in ``own``.
"""

from __future__ import annotations

import contextlib
import math
import time
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from theory.arrays import EPS, FloatArray
from theory.averaged.breather import BreatherStatus
from theory.averaged.envelope import coupling_matrix
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain, effective_epsilon
from theory.parameters import ParameterError
from verification.breathers.envelope import solve_envelope_breather, start_of
from verification.breathers.exponents import BreatherStability
from verification.breathers.family import BreatherFamily, ReportCallback, silent
from verification.breathers.floquet import floquet_multipliers
from verification.breathers.periodic_motion import SAMPLES, first_harmonics, largest_displacements
from verification.breathers.result import Breather, BreatherMethod, wave_error_of
from verification.continuation.branch import Fold, FoldShift, StepControl, fold_shift, trace
from verification.continuation.newton import (
    BranchPoint,
    NotConvergedError,
    System,
    solution_error,
    solve_at,
)
from verification.steppers.variational import STEPS, Flow, integrate_variations

STARTS = (0.05, 0.1, 0.15)
"""Couplings at which a branch of orbits may start from the averaged breather, in the order in which
they are tried: at small c, terms of order ε outweigh those that fix the phases inside a nucleus."""
FIRST_STEPS = StepControl(length=0.3)
_INCREMENT = 1e-6
"""Relative distance from an orbit at which the change of its monodromy matrix is measured."""
STIFFEST = 10.0
"""Largest ε max|damping| over the cycle for which orbits are sought."""


@dataclass(frozen=True)
class Orbits(BreatherFamily):
    """The periodic orbits of (8).

    Attributes
    ----------
    chain, nucleus
        As in `BreatherFamily`.
    steps : int or None
        Steps per period; by default as many as the chain needs.
    """

    method = BreatherMethod.ORBIT
    steps_along = FIRST_STEPS
    symmetric_chain: ClassVar[bool] = True
    """Whether the multipliers of a mirror-symmetric nucleus are split by parity."""

    chain: Any
    nucleus: Nucleus
    steps: int | None = None

    @property
    def count(self) -> int:
        """Steps per period."""
        return self.steps or steps_for(self.chain)

    def flow(self, c: float, start: FloatArray, duration: float, steps: int) -> Flow:
        """Return the motion from a start over a time, with its variations, in equal steps.

        Raises
        ------
        ParameterError
            If the motion grows without bound.
        """
        return integrate_variations(self.chain.replace(c=c), start, duration, steps)

    def rate(self, c: float, state: FloatArray) -> FloatArray:
        """Return the right-hand side of (40), the chain (8) as a first-order system.

        Examples
        --------
        >>> chain = VdpChain(a=2.5, b=0.5, c=0, sites=2)
        >>> Orbits(chain, Nucleus(1)).rate(0.1, np.array([1.0, 0.0, 0.0, 2.0])).tolist()
        [0.0, 2.0, -1.001, -0.019]
        """
        chain, sites = self.chain, self.chain.sites
        y, v = state[:sites], state[sites:]
        springs = coupling_matrix(sites, chain.ends) @ y
        damping = v * (1.0 - chain.a * y**2 + chain.b * y**4)
        return np.concatenate([v, -y - chain.eps * (c * springs + damping)])

    def system(self, refinement: int = 1, centre: int | None = None) -> System:
        """Return F(u, c) with u = (X, period): X(period) - X = 0 and y = 0 at the centre."""
        size, count = 2 * self.chain.sites, refinement * self.count
        site = self.centre if centre is None else centre

        def system(u: FloatArray, c: float) -> tuple[FloatArray, FloatArray, FloatArray]:
            try:
                flow = self.flow(abs(c), u[:-1], float(u[-1]), count)
            except ParameterError as error:
                raise NotConvergedError(str(error)) from None
            value = np.append(flow.state - u[:-1], u[site])
            jacobian = np.zeros((size + 1, size + 1))
            jacobian[:-1, :-1] = flow.monodromy - np.eye(size)
            jacobian[:-1, -1] = self.rate(abs(c), flow.state)
            jacobian[-1, site] = 1.0
            return value, jacobian, np.append(flow.by_c, 0.0)

        return system

    def start(
        self, c_end: float, lowest: float = math.inf, report: ReportCallback = silent
    ) -> BranchPoint:
        """Return an orbit at small c, from which the branch is followed down to ``lowest``."""
        point = self._first(c_end)
        if lowest < point.parameter:
            with contextlib.suppress(NotConvergedError):
                point = trace(self.system(), point, lowest, None, FIRST_STEPS).points[-1]
        return point

    def _first(self, c_end: float) -> BranchPoint:
        smallest = start_of(self.chain, self.nucleus, STARTS[0], 0.5)
        starts = (smallest, *STARTS[1:]) if c_end > smallest else (0.5 * c_end,)
        for start in starts:
            if start < c_end:
                # A later start, which the user did not choose, may lie beyond the fold of the
                # averaged breather.
                ignored = () if start == starts[0] else (ParameterError,)
                with contextlib.suppress(NotConvergedError, *ignored):
                    return replace(self, chain=self.chain.replace(c=start))._from_small_eps()
        raise ParameterError(
            "small parameter eps",
            self.chain.eps,
            f"small enough for an orbit with the pattern '{self.nucleus.pattern}'",
            "take a smaller eps, or another pattern",
        )

    def _from_small_eps(self, halvings: int = 5) -> BranchPoint:
        """Solve from the averaged breather or, if that is too far, from the orbit at half ε."""
        system = self.system()
        try:
            return solve_at(system, orbit_guess(self.chain, self.nucleus), self.chain.c)
        except NotConvergedError:
            if not halvings:
                raise
        at_half_eps = replace(self, chain=self.chain.replace(eps=0.5 * self.chain.eps))
        return solve_at(system, at_half_eps._from_small_eps(halvings - 1).u, self.chain.c)

    def directly(self) -> BranchPoint | None:
        """Return the orbit near the averaged breather; None if that is too near its fold."""
        system = self.system()
        try:
            return solve_at(system, orbit_guess(self.chain, self.nucleus), self.chain.c)
        except (NotConvergedError, ParameterError):
            return None

    def stability(self, u: FloatArray, c: float, *, split: bool = True) -> BreatherStability:
        """Return the multipliers."""
        period = float(u[-1])
        matrix = self.flow(c, u[:-1], period, self.count).monodromy
        parity = self._parity(u[:-1]) if split else 0
        return floquet_multipliers(matrix, period, self.chain.eps, parity=parity)

    def amplitudes(self, u: FloatArray, c: float) -> FloatArray:
        """Return the largest displacement of every site over a period."""
        fine = self.flow(c, u[:-1], float(u[-1]), max(SAMPLES, 2 * self.count))
        return self.unit * largest_displacements(fine.samples)

    def measured(self, point: BranchPoint, started: float, fold: Fold | None = None) -> Breather:
        """Return an orbit as a breather, with its error from a computation with twice the steps."""
        c, count = point.parameter, self.count
        state, period = point.u[:-1], float(point.u[-1])
        coarse = self.flow(c, state, period, count)
        fine = self.flow(c, state, period, max(SAMPLES, 2 * count))
        fold_error, c_bound = self.near_fold(c, fold)
        # Rounding errors of the steps add up at random; the residual may be small by chance.
        rounding = EPS * math.sqrt(2 * count) * float(np.abs(state).max())
        error = solution_error(self.system(2), point.u, c, rounding, c_bound) + point.correction
        of_step = float(np.abs(fine.monodromy - coarse.monodromy).max())
        stability = floquet_multipliers(
            fine.monodromy,
            period,
            self.chain.eps,
            parity=self._parity(state) if self.symmetric_chain else 0,
            error=of_step + self._monodromy_error(point, error, coarse.monodromy),
        )
        frequency = 2.0 * math.pi / period
        waves = self.unit * first_harmonics(fine.samples)
        centre = self.nucleus.outward(self.chain.sites)
        return Breather(
            chain=self.chain.replace(c=c),
            nucleus=self.nucleus,
            method=self.method,
            status=BreatherStatus.EXISTS,
            amplitudes=self.unit * largest_displacements(fine.samples),
            waves=waves,
            frequency=frequency,
            growth_error=stability.growth_error if stability.growth_error < math.inf else None,
            error=self.unit * error,
            frequency_error=frequency * error / period,
            wave_error=wave_error_of(self.unit * error * max(1.0, 1.0 / frequency), waves, centre),
            residual=self.unit * float(np.abs(coarse.state - state).max()),
            fold=None if fold is None else fold.parameter,
            fold_error=fold_error,
            unknowns=np.append(self.unit * state, period),
            stability=stability,
            seconds=time.perf_counter() - started,
        )

    def _monodromy_error(self, point: BranchPoint, error: float, matrix: FloatArray) -> float:
        """Return the changes of the monodromy matrix with the errors of an orbit.

        They are that of the next Newton step at half the integration step, and that of the whole
        error, rounding included, in the direction in which the orbit is determined worst.
        """
        u, c = point.u, point.parameter
        value, jacobian, _ = self.system(2)(u, c)
        direction = np.linalg.svd(jacobian)[2][-1]
        direction /= float(np.abs(direction).max())
        size = np.append(np.full(u.size - 1, np.abs(u[:-1]).max()), u[-1])
        distance = _INCREMENT * float((size / np.maximum(np.abs(direction), 1e-300)).min())
        changes = []
        for other in (u - np.linalg.solve(jacobian, value), u + distance * direction):
            flow = self.flow(c, other[:-1], float(other[-1]), self.count)
            changes.append(float(np.abs(flow.monodromy - matrix).max()))
        return changes[0] + changes[1] * error / distance

    def finer(self) -> Orbits:
        """Return the same orbits with twice the integration steps."""
        return replace(self, steps=2 * self.count)

    def step_error(self, fold: Fold) -> FoldShift:
        """Return the shift of the fold when the step is halved."""
        value = self.system(2)(fold.u, fold.parameter)[0]
        return fold_shift(self.system(), fold, np.abs(value))

    def _parity(self, state: FloatArray) -> int:
        sites = self.chain.sites
        if not self.nucleus.mirrored(sites):
            return 0
        y, v = state[:sites], state[sites:]
        even = np.abs(y + y[::-1]).sum() + np.abs(v + v[::-1]).sum()
        odd = np.abs(y - y[::-1]).sum() + np.abs(v - v[::-1]).sum()
        return 1 if even > odd else -1


def steps_for(chain: VdpChain) -> int:
    """Return the Taylor steps per period for errors near 1e-12; more for larger ε max|damping|.

    Raises
    ------
    ParameterError
        If ε max|damping| is above `STIFFEST`: shooting would take minutes.

    Examples
    --------
    >>> steps_for(VdpChain(a=2.5, b=0.5, c=0.1)), steps_for(VdpChain(a=4, b=0.5, c=0.1))
    (28, 37)
    """
    stiffness = effective_epsilon(chain)
    if stiffness > STIFFEST:
        raise ParameterError(
            "eps max|1 - a y^2 + b y^4|",
            f"{stiffness:.3g}",
            f"at most {STIFFEST:g} for a true orbit",
            "take a smaller eps, or a larger eta",
        )
    return STEPS + math.ceil(STEPS * stiffness)


def orbit_guess(chain: VdpChain, nucleus: Nucleus) -> FloatArray:
    """Return (X, period) from the breather of the averaged chain at this coupling.

    Raises
    ------
    ParameterError
        If the averaged chain has no such breather at this coupling.
    """
    found = solve_envelope_breather(chain, nucleus)
    if found.status is BreatherStatus.NONE:
        raise ParameterError(
            "coupling c", chain.c, "below the fold of the averaged breather",
            "take a smaller coupling",
        )  # fmt: skip
    return np.concatenate([found.waves.imag, found.waves.real, [found.period]])


def solve_orbit(chain: VdpChain, nucleus: Nucleus, *, steps: int | None = None) -> Breather:
    """Solve for the periodic orbit at the coupling of ``chain``.

    Parameters
    ----------
    chain : VdpChain
        Needs two cycles and c > 0.
    nucleus : Nucleus
        Which sites oscillate, and their pattern of phases.
    steps : int, optional
        Taylor steps per period; by default `steps_for`.

    Raises
    ------
    ParameterError
        If c = 0, the cell has no cycle, or the nucleus does not fit.

    Examples
    --------
    >>> orbit = solve_orbit(VdpChain(a=2.5, b=0.5, c=0.1, sites=11), Nucleus(1))
    >>> round(orbit.frequency, 6), orbit.stable, orbit.residual < 1e-11
    (1.000985, True, True)
    """
    return Orbits(chain, nucleus, steps).solve()
