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
from theory.result import Result, plain
from verification.cells.friction import cycle_velocities
from verification.cells.friction_cycles import check_slip_cycles, stick_slip_once, unstable_once
from verification.cells.result import TOLERANCE

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
        y of steady sliding.
    stable, unstable : ndarray, shape (M, 2)
        Smallest and largest y of the cycles; nan where there is none, as for an unstable one under
        Coulomb's law.
    stick_time : ndarray, shape (M,)
        Duration of stick on the stable cycle.
    multiplier : ndarray, shape (M,)
        Multiplier of the unstable cycle.
    end : float
        Velocity at which both cycles end; infinite if they never do, 0 if there are none.
    seconds : float
        Run time.
    """

    is_curve = True

    cell: FrictionCell
    v_d: FloatArray
    sliding: FloatArray
    stable: FloatArray
    unstable: FloatArray
    stick_time: FloatArray
    multiplier: FloatArray
    end: float
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
            "unstable_min": self.unstable[:, 0],
            "unstable_max": self.unstable[:, 1],
        }

    def to_dict(self) -> dict[str, Any]:
        """Return the two limits of the belt velocity, the columns, and ``seconds``."""
        return {
            "hopf_velocity": plain(self.hopf_velocity),
            "cycle_end_velocity": plain(self.end),
            **plain(self.columns()),
            "seconds": self.seconds,
        }


def cell_diagram(
    cell: FrictionCell, velocities: Sequence[float], tolerance: float = TOLERANCE
) -> Bifurcation:
    """Return both cycles at every belt velocity, with the other parameters as in ``cell``.

    Examples
    --------
    >>> diagram = cell_diagram(FrictionCell(), [1.0, 1.25, 3.0])
    >>> np.isnan(diagram.stable[:, 0]).tolist(), np.isnan(diagram.unstable[:, 0]).tolist()
    ([False, False, True], [True, False, True])
    """
    begin = perf_counter()
    count = len(velocities)
    stable, unstable = np.full((count, 2), np.nan), np.full((count, 2), np.nan)
    stick, growth, sliding = np.full(count, np.nan), np.full(count, np.nan), np.zeros(count)
    first, end = cycle_velocities(cell, tolerance)
    smooth = cell.law is not FrictionLaw.COULOMB
    for i, v_d in enumerate(velocities):
        here = replace(cell, v_d=v_d)
        sliding[i] = here.steady_sliding
        if here.law is FrictionLaw.STRIBECK:
            check_slip_cycles(here, tolerance)
        cycle = stick_slip_once(here, tolerance) if first <= v_d < end else None
        if cycle is None:
            continue
        stable[i], stick[i] = (cycle.min, cycle.max), cycle.stick_time
        other = unstable_once(here, tolerance) if smooth else None
        if other is not None:
            unstable[i] = other.min, other.max
            growth[i] = np.nan if other.multiplier is None else other.multiplier
    return Bifurcation(
        cell=cell,
        v_d=np.asarray(velocities, dtype=float),
        sliding=sliding,
        stable=stable,
        unstable=unstable,
        stick_time=stick,
        multiplier=growth,
        end=end,
        seconds=perf_counter() - begin,
    )


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
        Options of `verification.cells.cell.cell`; the diagram uses its tolerance.

    Raises
    ------
    ParameterError
        If there are more than 2000 velocities.
    """
    if along != "v_d":
        return None
    count_within("number of velocities", len(values), 2, MAX_VELOCITIES)
    return cell_diagram(cells[0], values, options.get("tolerance", TOLERANCE))
