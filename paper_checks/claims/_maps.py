"""Common parts of Figs. 5 and 15: a map of labelled points and the boundaries between labels."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from verification.execution.table import Table

FEW = 0.05
"""Share of undecided points that does not affect the regions."""
REGIONS = ("front", "breather", "fixed point")


@dataclass(frozen=True, kw_only=True)
class LabelledMap:
    """The points of a map with their labels, and where the labels change."""

    states: Table
    boundary: Table

    @property
    def counts(self) -> dict[str, int]:
        """Number of points by label."""
        return dict(self.states.counts("label"))

    @property
    def points(self) -> int:
        """Number of points."""
        return len(self.states)

    @property
    def undecided(self) -> int:
        """Number of points in none of the three states."""
        return self.counts.get("undecided", 0)

    @property
    def highest(self) -> float:
        """Largest coupling of a breather."""
        return float(self.states["c"][self.states["label"] == "breather"].max(initial=0.0))
