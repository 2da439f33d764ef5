"""Both cycles of the friction cell over the belt velocity: the bifurcation diagram."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter

import numpy as np
import numpy.typing as npt

from theory.cells.friction import FrictionCell
from theory.cells.friction_law import FrictionLaw
from theory.result import Result
from verification.cells.friction import cycle_velocities
from verification.cells.friction_cycles import check_slip_cycles, stick_slip_once, unstable_once

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class CellDiagram(Result):
    """Both cycles over the belt velocity.

    Attributes
    ----------
    v_d : ndarray, shape (M,)
        Belt velocities.
    sliding : ndarray, shape (M,)
        y of steady sliding.
    stable, unstable : ndarray, shape (M, 2)
        Smallest and largest y of the cycles; nan where there is none, as an unstable one under
        Coulomb's law.
    stick_time : ndarray, shape (M,)
        Of the stable cycle.
    multiplier : ndarray, shape (M,)
        Of the unstable cycle.
    end : float
        Velocity at which both cycles end; infinite if they never do, 0 if there are none.
    seconds : float
        Run time.
    """

    v_d: FloatArray = field(metadata={"axis": "v_d"})
    sliding: FloatArray = field(metadata={"dims": ("v_d",)})
    stable: FloatArray = field(metadata={"dims": ("v_d", "end")})
    unstable: FloatArray = field(metadata={"dims": ("v_d", "end")})
    stick_time: FloatArray = field(metadata={"dims": ("v_d",)})
    multiplier: FloatArray = field(metadata={"dims": ("v_d",)})
    end: float
    seconds: float


def cell_diagram(
    cell: FrictionCell, velocities: Sequence[float], tolerance: float = 1e-10
) -> CellDiagram:
    """Return both cycles at every belt velocity, the other parameters as in ``cell``.

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
        separated = smooth and here.effective_damping > 0.0
        other = unstable_once(here, tolerance) if separated else None
        if other is not None:
            unstable[i] = other.min, other.max
            growth[i] = np.nan if other.multiplier is None else other.multiplier
    return CellDiagram(
        v_d=np.asarray(velocities, dtype=float),
        sliding=sliding,
        stable=stable,
        unstable=unstable,
        stick_time=stick,
        multiplier=growth,
        end=end,
        seconds=perf_counter() - begin,
    )
