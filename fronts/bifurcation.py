"""The bifurcation diagram of the friction cell as a result, for ``fronts cell friction``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from theory.parameters import count_within
from theory.result import Result, plain

if TYPE_CHECKING:
    from theory.cells.friction import FrictionCell
    from verification.cells.diagram import CellDiagram

MAX_VELOCITIES = 2000


@dataclass(frozen=True, kw_only=True, eq=False)
class Bifurcation(Result):
    """Both cycles and steady sliding of a friction cell over the velocity of its belt.

    Attributes
    ----------
    cell : FrictionCell
        The other parameters.
    diagram : CellDiagram
        Turning points of the cycles.
    """

    is_curve = True

    cell: FrictionCell
    diagram: CellDiagram

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row a velocity; nan where a cycle does not exist."""
        found = self.diagram
        return {
            "v_d": found.v_d,
            "sliding": found.sliding,
            "stable_min": found.stable[:, 0],
            "stable_max": found.stable[:, 1],
            "stick_time": found.stick_time,
            "unstable_min": found.unstable[:, 0],
            "unstable_max": found.unstable[:, 1],
        }

    def to_dict(self) -> dict[str, Any]:
        """Return both bounds of the belt velocity, the columns, and ``seconds``."""
        return {
            "hopf_velocity": plain(self.cell.hopf_velocity),
            "cycle_end_velocity": plain(self.diagram.end),
            **plain(self.columns()),
            "seconds": self.diagram.seconds,
        }


def bifurcation(
    cells: Sequence[FrictionCell], along: str, values: Sequence[float], **options: Any
) -> Bifurcation | None:
    """Return the diagram over the belt velocity; None along another parameter.

    Parameters
    ----------
    cells : sequence of FrictionCell
        One for each value.
    along : str
        The parameter in which they differ.
    values : sequence of float
        Its values.
    **options
        Of `verification.cells.cell.cell`; the diagram takes its tolerance.

    Returns
    -------
    Bifurcation or None

    Raises
    ------
    ParameterError
        If there are more than 2000 velocities.
    """
    if along != "v_d":
        return None
    from verification.cells.diagram import cell_diagram

    count_within("number of velocities", len(values), 2, MAX_VELOCITIES)
    found = cell_diagram(cells[0], values, options.get("tolerance", 1e-10))
    return Bifurcation(cell=cells[0], diagram=found)
