"""Results for one isolated oscillator: its cycles, their stability, the basin of rest."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

from theory.cells.friction import FrictionCell
from theory.result import Result
from theory.status import Status

TOLERANCE = 1e-12
"""Default tolerance of a cell and of a curve of cells."""


class CellStatus(Status):
    """Which states of a cell are stable."""

    BISTABLE = "bistable", "the equilibrium and the large cycle are both stable."
    CYCLE = "stick-slip only", "the stick-slip cycle is stable, steady sliding is not."
    SLIDING = "steady sliding only", "steady sliding is stable, and there is no stick-slip cycle."
    REST = "rest only", "rest is stable, and there is no cycle."
    OSCILLATION = "cycle only", "the cycle is stable, rest is not."
    MULTISTABLE = "multistable", "rest and more than one cycle are stable."
    CYCLES = "cycles only", "more than one cycle is stable, rest is not."
    SEMISTABLE = (
        "semistable cycle",
        "rest is stable, and the two cycles are one: it attracts from outside only.",
    )


@dataclass(frozen=True, kw_only=True)
class CellCycle(Result):
    """A cycle of one cell; all quantities dimensionless.

    Attributes
    ----------
    max, min : float
        Largest and smallest y.
    period : float
        In the time unit of the model, τ for (5) or t for (8).
    stick_time, slip_time : float
        Durations of stick and of slip; 0 and the period if the cell does not stick.
    speed : float or None
        Largest ẏ; equal to v_d if the cycle sticks and never slips forwards. None if not measured.
    multiplier : float or None
        Factor by which a deviation grows in one period: of smooth cells by the divergence of the
        flow along the cycle, of the friction cell from finite differences. 0 if the cycle sticks,
        None if the differences do not resolve it, or if it leaves double precision.
    multiplier_error : float or None
        Bound on the error of the multiplier: its change with the tolerance and with the step of the
        differences, and what the errors of the cycle or of both ends of a turn make of it. None if
        there is no multiplier.
    averaged : float or None
        Largest y as ε → 0: in closed form for (8), otherwise from the energy lost in one turn.
    error : float
        Largest difference of any of these, except the multiplier, from a computation at a hundred
        times the tolerance, of smooth cells from one at ten times it as well; at least round-off.
    """

    derived: ClassVar[tuple[str, ...]] = ("amplitude",)

    max: float
    min: float
    period: float
    stick_time: float = 0.0
    slip_time: float
    speed: float | None = None
    multiplier: float | None = None
    multiplier_error: float | None = None
    averaged: float | None = None
    error: float

    @property
    def amplitude(self) -> float:
        """Half of max - min."""
        return 0.5 * (self.max - self.min)


@dataclass(frozen=True, kw_only=True)
class Cell(Result):
    """The possible states of one cell.

    Attributes
    ----------
    model : str
        "friction", "vdp", "averaged" or "chain".
    parameters : dict of str to float
        Parameters of the cell.
    status : CellStatus
        Which states are stable.
    steady_sliding : float or None
        y of steady sliding, to rounding; None for cells without a belt, which rest at y = 0.
    effective_damping : float
        Linear damping about rest, to rounding; rest is stable where this is positive.
    stable_cycle, unstable_cycle : CellCycle or None
        The large cycle and the one that separates the basins, where they exist. If the two coincide
        in a semistable cycle, it is ``unstable_cycle``.
    seconds : float
        Run time.
    """

    derived: ClassVar[tuple[str, ...]] = ("basin", "error")

    model: str
    parameters: dict[str, Any]
    status: CellStatus
    steady_sliding: float | None
    effective_damping: float
    stable_cycle: CellCycle | None
    unstable_cycle: CellCycle | None
    seconds: float

    def to_dict(self) -> dict[str, Any]:
        """Return the result for JSON: the same keys for every model."""
        names = ("hopf_velocity", "cycle_begin_velocity", "cycle_end_velocity", "cycle_end_error")
        found = {**dict.fromkeys(names), **super().to_dict()}
        if {"a", "b"} <= {*self.parameters}:
            found["eta"] = self.parameters["b"] / self.parameters["a"] ** 2
        return found

    @property
    def basin(self) -> tuple[float, float] | None:
        """Range of y from which the cell, released with ẏ = 0, goes to rest.

        None if there is no such y; infinite if the cell goes to rest from every y.
        """
        if self.status in (CellStatus.SLIDING, CellStatus.REST):
            return -math.inf, math.inf
        if self.unstable_cycle is None or self.status is CellStatus.CYCLES:
            return None
        return self.unstable_cycle.min, self.unstable_cycle.max

    @property
    def error(self) -> float:
        """Largest of the errors; infinite if one is unknown."""
        return max(
            (each.error for each in (self.stable_cycle, self.unstable_cycle) if each), default=0.0
        )


@dataclass(frozen=True, kw_only=True)
class OwnCell(Cell):
    """The possible states of a user-defined cell.

    Attributes
    ----------
    cycles : tuple of CellCycle
        All cycles, from the inside outwards. ``unstable_cycle`` is the innermost unstable one,
        ``stable_cycle`` the next stable one outside it, as for the `stable_amplitude` of the chain,
        or the only stable one.
    """

    cycles: tuple[CellCycle, ...]

    @property
    def error(self) -> float:
        """Largest of the errors."""
        return max((each.error for each in self.cycles), default=0.0)


@dataclass(frozen=True, kw_only=True)
class BeltCell(Cell):
    """The possible states of one friction cell, and the belt velocities at which they exist.

    Attributes
    ----------
    cell : FrictionCell
        The same parameters as a `FrictionCell`.
    hopf_velocity : float
        Belt velocity above which steady sliding is stable, to rounding; infinite if it never is
        (ξ = 0), 0 if it always is, as under Coulomb's law.
    cycle_begin_velocity : float
        Belt velocity at which the stick-slip cycle begins by grazing; 0 except under Stribeck's
        law.
    cycle_end_velocity : float
        Belt velocity at which both cycles end by grazing; infinite if they never do (ξ = 0), 0 if
        there is no cycle at any velocity.
    cycle_end_error : float
        The larger of the two velocities' differences from a computation at a hundred times the
        tolerance, but at least the effect of round-off on the velocity of the end.
    grazing : tuple of float or None
        Under Coulomb's law: turning points of the slip that just touches the velocity of the belt,
        to rounding.
        It is not a cycle, but motion that starts inside it ends in steady sliding, and motion that
        starts outside sticks.
    """

    cell: FrictionCell = field(metadata={"json": None})
    hopf_velocity: float
    cycle_begin_velocity: float
    cycle_end_velocity: float
    cycle_end_error: float
    grazing: tuple[float, float] | None = field(metadata={"json": None})

    @property
    def basin(self) -> tuple[float, float] | None:
        """Range of y that leads to steady sliding when released with ẏ = 0; see `Cell.basin`."""
        return self.grazing or super().basin

    @property
    def error(self) -> float:
        """Largest of the errors; infinite if one is unknown."""
        return max(self.cycle_end_error, super().error)
