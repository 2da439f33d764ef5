"""Both cycles of the friction cell over the belt velocity: the bifurcation diagram."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from theory.cells.friction import FrictionCell
from verification.cells.friction_cycles import stick_slip_once, unstable_once
from verification.cells.friction_orbits import cycle_end_velocity

FloatArray = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Continuation:
    """Both cycles over the belt velocity.

    Attributes
    ----------
    v_d : ndarray, shape (M,)
        Belt velocities.
    sliding : ndarray, shape (M,)
        y of steady sliding.
    stable, unstable : ndarray, shape (M, 2)
        Smallest and largest y of the cycles; nan where there is none.
    stick_time : ndarray, shape (M,)
        Of the stable cycle.
    multiplier : ndarray, shape (M,)
        Of the unstable cycle.
    end : float
        Velocity at which both cycles end; infinite if they never do, 0 if there are none.
    """

    v_d: FloatArray
    sliding: FloatArray
    stable: FloatArray
    unstable: FloatArray
    stick_time: FloatArray
    multiplier: FloatArray
    end: float


def continue_cycles(
    cell: FrictionCell, velocities: Sequence[float], tolerance: float = 1e-10
) -> Continuation:
    """Return both cycles at every belt velocity, the other parameters as in ``cell``.

    Examples
    --------
    >>> diagram = continue_cycles(FrictionCell(), [1.0, 1.25, 3.0])
    >>> np.isnan(diagram.stable[:, 0]).tolist(), np.isnan(diagram.unstable[:, 0]).tolist()
    ([False, False, True], [True, False, True])
    """
    count = len(velocities)
    stable, unstable = np.full((count, 2), np.nan), np.full((count, 2), np.nan)
    stick, growth, sliding = np.full(count, np.nan), np.full(count, np.nan), np.zeros(count)
    end = cycle_end_velocity(cell, tolerance)
    for i, v_d in enumerate(velocities):
        here = replace(cell, v_d=v_d)
        sliding[i] = here.steady_sliding
        cycle = stick_slip_once(here, tolerance) if v_d < end else None
        if cycle is None:
            continue
        stable[i], stick[i] = (cycle.min, cycle.max), cycle.stick_time
        other = unstable_once(here, tolerance) if here.effective_damping > 0.0 else None
        if other is not None:
            unstable[i], growth[i] = (other.min, other.max), other.multiplier
    return Continuation(
        np.asarray(velocities, dtype=float), sliding, stable, unstable, stick, growth, end
    )
