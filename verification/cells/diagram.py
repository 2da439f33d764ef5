"""Both cycles of the friction cell as functions of the belt velocity: the bifurcation diagram."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from time import perf_counter
from typing import Any

import numpy as np

from theory.arrays import BoolArray, FloatArray
from theory.cells.friction import FrictionCell
from theory.cells.friction_law import FrictionLaw
from theory.parameters import count_within
from theory.result import Result, json_value
from verification.cells.friction import cycle_limits, friction_cell
from verification.cells.result import TOLERANCE, CellCycle
from verification.execution.progress import ProgressCallback, of_part

MAX_VELOCITIES = 2000
"""Largest number of velocities in one diagram on the command line."""


@dataclass(frozen=True, kw_only=True)
class Bifurcation(Result):
    """Both cycles and steady sliding as functions of the belt velocity.

    Attributes
    ----------
    cell : FrictionCell
        The other parameters.
    v_d : ndarray, shape (M,)
        Belt velocities.
    sliding : ndarray, shape (M,)
        y of steady sliding, to rounding.
    stable, unstable : ndarray, shape (M, 2)
        Smallest and largest y of the cycles; nan where there is none, as for an unstable one under
        Coulomb's law.
    stable_error, unstable_error : ndarray, shape (M,)
        Errors of the cycles, as in `CellCycle`: of both turning points and of ``stick_time``.
    stick_time : ndarray, shape (M,)
        Duration of stick on the stable cycle.
    multiplier, multiplier_error : ndarray, shape (M,)
        Multiplier of the unstable cycle and its error; nan where it is not resolved.
    cycle_end_velocity, cycle_end_error : float
        Velocity at which both cycles end, and its error, as in `BeltCell`.
    seconds : float
        Run time.
    """

    is_curve = True

    cell: FrictionCell
    v_d: FloatArray
    sliding: FloatArray
    stable: FloatArray
    stable_error: FloatArray
    unstable: FloatArray
    unstable_error: FloatArray
    stick_time: FloatArray
    multiplier: FloatArray
    multiplier_error: FloatArray
    cycle_end_velocity: float
    cycle_end_error: float
    seconds: float

    @property
    def hopf_velocity(self) -> float:
        """Velocity above which steady sliding is stable; 0 under Coulomb's law."""
        return 0.0 if self.cell.law is FrictionLaw.COULOMB else self.cell.hopf_velocity

    @property
    def sliding_stable(self) -> BoolArray:
        """Whether steady sliding is stable at each velocity, shape (M,)."""
        margins = [replace(self.cell, v_d=float(each)).stability_margin for each in self.v_d]
        return np.array(margins) > 0.0

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row per velocity; nan where a cycle does not exist."""
        return {
            "v_d": self.v_d,
            "sliding": self.sliding,
            "stable_min": self.stable[:, 0],
            "stable_max": self.stable[:, 1],
            "stick_time": self.stick_time,
            "stable_error": self.stable_error,
            "unstable_min": self.unstable[:, 0],
            "unstable_max": self.unstable[:, 1],
            "unstable_error": self.unstable_error,
        }

    def to_dict(self) -> dict[str, Any]:
        """Return the limits of the belt velocity with their error, the columns, and ``seconds``."""
        return {
            "hopf_velocity": json_value(self.hopf_velocity),
            "cycle_end_velocity": json_value(self.cycle_end_velocity),
            "cycle_end_error": json_value(self.cycle_end_error),
            **json_value(self.columns()),
            "seconds": self.seconds,
        }


def cell_diagram(
    cell: FrictionCell,
    velocities: Sequence[float],
    tolerance: float = TOLERANCE,
    progress: ProgressCallback | None = None,
) -> Bifurcation:
    """Return both cycles at every belt velocity, with the other parameters as in ``cell``.

    Raises
    ------
    ParameterError
        If `verification.cells.friction.friction_cell` refuses one of the cells.

    Examples
    --------
    >>> diagram = cell_diagram(FrictionCell(), [1.0, 1.25, 3.0])
    >>> np.isnan(diagram.stable[:, 0]).tolist(), np.isnan(diagram.unstable[:, 0]).tolist()
    ([False, False, True], [True, False, True])
    """
    begin = perf_counter()
    limits = cycle_limits(cell, tolerance, of_part(progress, 0, 2))
    cells = []
    for at, v_d in enumerate(velocities):
        cells.append(friction_cell(replace(cell, v_d=v_d), tolerance, limits=limits))
        of_part(progress, 1, 2)((at + 1) / len(velocities))
    stable = [each.stable_cycle for each in cells]
    unstable = [each.unstable_cycle for each in cells]
    return Bifurcation(
        cell=cell,
        v_d=np.asarray(velocities, dtype=float),
        sliding=np.array([each.steady_sliding for each in cells]),
        stable=np.stack([_column(stable, "min"), _column(stable, "max")], axis=1),
        stable_error=_column(stable, "error"),
        unstable=np.stack([_column(unstable, "min"), _column(unstable, "max")], axis=1),
        unstable_error=_column(unstable, "error"),
        stick_time=_column(stable, "stick_time"),
        multiplier=_column(unstable, "multiplier"),
        multiplier_error=_column(unstable, "multiplier_error"),
        cycle_end_velocity=limits.end,
        cycle_end_error=limits.error,
        seconds=perf_counter() - begin,
    )


def _column(cycles: Sequence[CellCycle | None], name: str) -> FloatArray:
    """Return an attribute of each cycle; nan where there is no cycle, or it has none."""
    found = (None if each is None else getattr(each, name) for each in cycles)
    return np.array([np.nan if each is None else each for each in found])


def bifurcation(
    cells: Sequence[FrictionCell], along: str, values: Sequence[float], **options: Any
) -> Bifurcation | None:
    """Return the diagram of cells that differ in the belt velocity; None for another parameter.

    Parameters
    ----------
    cells : sequence of FrictionCell
        The cells at both ends of the values; the first has the other parameters.
    along : str
        The parameter in which they differ.
    values : sequence of float
        Values of this parameter.
    **options
        Options of `verification.cells.cell.cell`: the tolerance and the progress callback.

    Raises
    ------
    ParameterError
        If there are more than 2000 velocities.
    """
    if along != "v_d":
        return None
    count_within("number of velocities", len(values), 2, MAX_VELOCITIES)
    return cell_diagram(
        cells[0], values, options.get("tolerance", TOLERANCE), options.get("progress")
    )
