"""Model I, the chain (Eq. 5): parameters, end conditions, linear waves about steady sliding.

ÿ_n + 2ξẏ_n + y_n + c(2y_n - y_{n+1} - y_{n-1}) = F(ẏ_n - v_d)                        (5)
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from enum import StrEnum

from theory.cells.friction import FrictionCell
from theory.parameters import count_within, within

MOST_SITES = 1_000_000


class FrictionEnds(StrEnum):
    """What (5) means at the ends; the paper says free, its formula says another thing."""

    FREE = "free"
    """One neighbour: the coupling of site 1 is c(y_1 - y_2)."""

    LITERAL = "literal"
    """(5) as it stands with the missing neighbours zero: c(2y_1 - y_2), a spring to a wall."""


@dataclass(frozen=True)
class FrictionChain:
    """Parameters of (5); dimensionless, checked once.

    Attributes
    ----------
    c : float
        Coupling, from 0 to 1e6.
    cell : FrictionCell
        One oscillator.
    sites : int
        Number of oscillators, from 1 to 1 000 000.
    ends : FrictionEnds
        End condition.

    Raises
    ------
    ParameterError
        If one is out of range.

    Examples
    --------
    >>> FrictionChain(0.02).sites, round(FrictionChain(2.0).largest_group_velocity, 12)
    (31, 1.0)
    """

    c: float
    cell: FrictionCell = field(default_factory=FrictionCell)
    sites: int = 31
    ends: FrictionEnds = FrictionEnds.FREE

    def __post_init__(self) -> None:
        within("coupling c", self.c, 0.0, 1e6, "give a coupling that is zero or positive")
        count_within("number of sites n", self.sites, 1, MOST_SITES)
        object.__setattr__(self, "ends", FrictionEnds(self.ends))

    @property
    def largest_group_velocity(self) -> float:
        """(√(1 + 4c) - 1)/2, of the waves ω² = 1 + 4c sin²(q/2) about steady sliding, undamped."""
        return 2.0 * self.c / (math.sqrt(1.0 + 4.0 * self.c) + 1.0)
