"""Model I, the chain (Eq. 5): parameters, boundary conditions, linear waves about steady sliding.

ÿ_n + 2ξẏ_n + y_n + c(2y_n - y_{n+1} - y_{n-1}) = F(ẏ_n - v_d)                        (5)
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import cached_property
from typing import ClassVar

from theory.cells.friction import FrictionCell
from theory.cells.friction_law import FrictionLaw
from theory.chains.chain import COUPLING_RANGE, MAX_SITES, Chain, Site, parameter
from theory.chains.ends import Ends
from theory.parameters import ParameterError, Range, with_ranges

_SITES_RANGE = Range(1, MAX_SITES)


@with_ranges(coupling=COUPLING_RANGE, sites=_SITES_RANGE)
@dataclass(frozen=True, kw_only=True)
class FrictionChain(Chain, model="friction"):
    """Model I, Eq. (5): friction-excited oscillators; dimensionless.

    The motion is smooth only between transitions from stick to slip and back, and is therefore
    integrated from event to event. A site counts as reached when it first sticks.

    Attributes
    ----------
    c : float
        Coupling, {coupling}.
    v_d, mu_st, mu_d, v0, xi, v_s, viscous : float
        As in :class:`theory.cells.friction.FrictionCell`.
    law : FrictionLaw or str
        How friction decreases with velocity: ``exponential`` as in (2), ``stribeck`` or
        ``coulomb``.
    sites : int
        Number of oscillators, {sites}.
    ends : Ends
        Free, or literal: (5) as printed, with zero in place of the missing neighbours.

    Raises
    ------
    ParameterError
        If a parameter is out of range.

    Examples
    --------
    >>> FrictionChain(c=0.02).sites, round(FrictionChain(c=2.0).largest_group_velocity, 12)
    (31, 1.0)
    >>> FrictionChain(c=0.02, law="stribeck", v_s=0.3, viscous=0.01).cell.curve.scale
    0.3
    """

    allowed_ends: ClassVar[tuple[Ends, ...]] = (Ends.FREE, Ends.LITERAL)

    c: float = parameter("coupling, zero or positive", "c")
    v_d: float = parameter("velocity of the belt, positive", "v_d", FrictionCell.v_d)
    mu_st: float = parameter("static friction, above mu_d", "μ_st", FrictionCell.mu_st)
    mu_d: float = parameter("dynamic friction, not negative", "μ_d", FrictionCell.mu_d)
    v0: float = parameter("reference velocity of (2), positive", "v_0", FrictionCell.v0)
    xi: float = parameter("damping ratio, zero or positive", "ξ", FrictionCell.xi)
    law: FrictionLaw = parameter("how friction falls with velocity", "law", FrictionCell.law)
    v_s: float = parameter("velocity of Stribeck's law, positive", "v_s", FrictionCell.v_s)
    viscous: float = parameter("viscous part of friction", "κ", FrictionCell.viscous)
    sites: int = parameter("number of sites, from 1", "N", 31)
    ends: Ends = parameter(
        "free: one neighbour only; literal: the missing neighbours are 0, as (5) is printed",
        "ends",
        Ends.FREE,
    )

    def __post_init__(self) -> None:
        self._check_number("c", "coupling c", *COUPLING_RANGE)
        cell = self.cell
        for each in fields(cell):
            object.__setattr__(self, each.name, getattr(cell, each.name))
        self._check_count("sites", "number of sites n", *_SITES_RANGE)
        self._check_ends()

    @classmethod
    def of(
        cls, cell: FrictionCell, *, c: float, sites: int = 31, ends: Ends = Ends.FREE
    ) -> FrictionChain:
        """Return a chain of such cells.

        Examples
        --------
        >>> FrictionChain.of(FrictionCell(v_d=2.0), c=0.02, sites=5).v_d
        2.0
        """
        own = {each.name: getattr(cell, each.name) for each in fields(cell)}
        return cls(c=c, sites=sites, ends=ends, **own)

    @cached_property
    def cell(self) -> FrictionCell:
        """A single oscillator with these parameters."""
        own = {each.name: getattr(self, each.name) for each in fields(FrictionCell)}
        return FrictionCell(**own)

    @property
    def rest_state(self) -> Site:
        """The state of steady sliding, (μ(v_d), 0)."""
        return Site(self.cell.steady_sliding, 0.0)

    @property
    def stable_amplitude(self) -> float:
        """Half the range of y on the stick-slip cycle, which is not known in closed form.

        Raises
        ------
        ParameterError
            Always; ``verification.cells.friction_cycles`` computes the amplitude.
        """
        raise ParameterError(
            "amplitude of the stick-slip cycle", "asked of the chain", "computed from the cycle",
            "use verification.cells.friction_cycles.cycle_turning_points",
        )  # fmt: skip

    @property
    def unstable_amplitude(self) -> float:
        """v_d: a site whose velocity reaches that of the belt sticks and so counts as reached."""
        return self.v_d

    @property
    def largest_group_velocity(self) -> float:
        """(√(1 + 4c) - 1)/2, for undamped waves ω² = 1 + 4c sin²(q/2) about steady sliding."""
        return 2.0 * self.c / (math.sqrt(1.0 + 4.0 * self.c) + 1.0)
