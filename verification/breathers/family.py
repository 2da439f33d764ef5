"""The contract of breathers that are solved for: solutions u of F(u, c) = 0 along a branch in c.

How to add a kind of chain
--------------------------
1. Derive a frozen dataclass from `BreatherFamily`, and name it in ``families``.
2. ``system`` returns F and its derivatives, ``start`` a solution at small c, and ``directly`` the
   solution at the coupling of the chain if it can be found without following the branch.
3. ``stability`` determines whether small perturbations of a solution grow, ``measured`` turns the
   solution into a `Breather`, and ``amplitudes`` computes its amplitudes alone.
"""

from __future__ import annotations

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, ClassVar, TypeAlias

from theory.arrays import FloatArray
from theory.averaged.breather import BreatherStatus
from theory.chains.nucleus import Nucleus
from theory.parameters import ParameterError
from verification.breathers.exponents import BreatherStability
from verification.breathers.result import Breather, BreatherMethod
from verification.continuation.branch import (
    ContinuationBranch,
    Fold,
    FoldShift,
    Monitor,
    StepControl,
    arrive,
    trace,
)
from verification.continuation.newton import PARAMETER_WEIGHT, BranchPoint, System

MAX_STEPS = 1000
"""Largest number of steps along a branch, some ten seconds; they suffice up to c of about 50."""
ReportCallback: TypeAlias = Callable[[float], None]
"""Called with the amount of work done since the last call, in units of one solution."""


def silent(done: float) -> None:
    """Report nothing."""


@dataclass(frozen=True)
class BreatherFamily(ABC):
    """The breathers of a chain with a given nucleus.

    Attributes
    ----------
    chain : VdpChain, AveragedChain or OscillatorChain
        The chain; its c is used by ``solve``, but not by a branch.
    nucleus : Nucleus
        Which sites oscillate, and with which phase steps.
    """

    method: ClassVar[BreatherMethod]
    steps_along: ClassVar[StepControl] = StepControl()

    chain: Any
    nucleus: Nucleus

    @property
    def unit(self) -> float:
        """Unit of the amplitudes in the unknowns."""
        return 1.0

    @property
    def centre(self) -> int:
        """The site at which the phase is fixed."""
        return self.nucleus.centre(self.chain.sites)

    @abstractmethod
    def system(self, refinement: int = 1) -> System:
        """Return F(u, c); ``refinement`` multiplies the integration steps, if there are any."""

    @abstractmethod
    def start(
        self, c_end: float, lowest: float = math.inf, report: ReportCallback = silent
    ) -> BranchPoint:
        """Return a solution at small c towards ``c_end``, at ``lowest`` if possible.

        If this takes a run of the chain, ``report`` is called as each part of it is completed.

        Raises
        ------
        ParameterError
            If no solution was found.
        """

    @abstractmethod
    def directly(self) -> BranchPoint | None:
        """Return the solution at the chain's coupling; None if it needs the branch."""

    @abstractmethod
    def stability(self, u: FloatArray, c: float, *, split: bool = True) -> BreatherStability:
        """Return the stability of a solution, split by reflection symmetry where there is one."""

    @abstractmethod
    def measured(self, point: BranchPoint, started: float, fold: Fold | None = None) -> Breather:
        """Return a solution as a breather, with its error as a solution of these equations."""

    @abstractmethod
    def amplitudes(self, u: FloatArray, c: float) -> FloatArray:
        """Return the largest displacement of every site of a solution, as `measured` does."""

    def finer(self) -> BreatherFamily:
        """Return the same breathers with twice the integration steps, if there are any."""
        return self

    @abstractmethod
    def step_error(self, fold: Fold) -> FoldShift:
        """Return the shifts of a fold by truncation in the integration, or by rounding of F."""

    def fold_error(self, fold: Fold) -> float:
        """Return the error of the coupling of a fold."""
        return fold.error + self.step_error(fold).parameter

    def step_control(self, c_end: float) -> StepControl:
        """Return how a branch is followed to its fold, or to a coupling.

        Branches of a mirror-symmetric nucleus are crossed by those that break the symmetry.
        """
        default = self.steps_along
        # A step changes c by no more than longest/PARAMETER_WEIGHT.
        needed = default.max_steps + math.ceil(PARAMETER_WEIGHT * c_end / default.longest)
        generic = not self.nucleus.mirrored(self.chain.sites)
        return replace(default, generic=generic, max_steps=min(needed, MAX_STEPS))

    def near_fold(self, c: float, fold: Fold | None) -> tuple[float | None, float]:
        """Return the error of a fold, if there is one, and that of a coupling.

        The latter is that of the fold within this error of the fold, and 0 elsewhere.
        """
        if fold is None:
            return None, 0.0
        error = self.fold_error(fold)
        return error, error if abs(fold.parameter - c) <= error else 0.0

    def monitor(self, u: FloatArray, c: float) -> tuple[float, float, float]:
        """Return the growth of all modes, of those with the breather's parity, and of the others.

        From each, the growth that counts as zero is subtracted. Without mirror symmetry the last
        two values repeat the first.
        """
        found = self.stability(u, c)
        own = found.growth if found.symmetric is None else found.symmetric
        other = found.growth if found.antisymmetric is None else found.antisymmetric
        return found.growth - found.marginal, own - found.marginal, other - found.marginal

    def reported_monitor(self, report: ReportCallback) -> Monitor:
        """Return ``monitor``, extended by a report at each call."""

        def reporting(u: FloatArray, c: float) -> tuple[float, ...]:
            report(1.0)
            return self.monitor(u, c)

        return reporting

    def branch(
        self,
        c_end: float = 2.0,
        *,
        monitored: bool = True,
        report: ReportCallback = silent,
    ) -> ContinuationBranch:
        """Follow the breather from small c through its fold, recording its growth if ``monitored``.

        If it is recorded, ``report`` is called with 1 at each solution.

        Raises
        ------
        ParameterError
            If no breather was found at small c.
        """
        monitor = self.reported_monitor(report) if monitored else None
        start = self.start(c_end, report=report)
        return trace(self.system(), start, c_end, monitor, self.step_control(c_end))

    def solve(self) -> Breather:
        """Solve for the breather at the coupling of the chain.

        Raises
        ------
        ParameterError
            If c = 0, the cell has no cycle, or the nucleus does not fit.
        NotConvergedError
            If c is too far along the branch.
        """
        started, c = time.perf_counter(), self.chain.c
        if c == 0:
            raise ParameterError("coupling c", 0, "positive for a breather", "give c > 0")
        point = self.directly()
        if point is not None:
            return self.measured(point, started)
        branch = self.branch(c, monitored=False)
        if branch.fold is not None and c > branch.fold.parameter:
            return Breather(
                chain=self.chain,
                nucleus=self.nucleus,
                method=self.method,
                status=BreatherStatus.NONE,
                fold=branch.fold.parameter,
                fold_error=self.fold_error(branch.fold),
                seconds=time.perf_counter() - started,
            )
        return self.measured(arrive(self.system(), branch, c), started, branch.fold)
