"""Model II: the chain of generalised Van der Pol oscillators (Eq. 8) and its averaged form (34).

    ÿ_n + y_n + εc(2y_n - y_{n-1} - y_{n+1}) + ε ẏ_n (1 - a y_n² + b y_n⁴) = 0            (8)

With Ψ = ẏ + iy = φ e^{it}, so that y = Im Ψ, averaging over a period gives in slow time T = εt

    φ_n' = (ic/2)(2φ_n - φ_{n-1} - φ_{n+1}) - (φ_n/2)(1 - a|φ_n|²/4 + b|φ_n|⁴/8).    (43)

The scaling y → y√a turns (a, b) into (1, η), η = b/a², in both.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from theory.cells.vdp import ETA_END, eta_from_damping
from theory.parameters import ParameterError, count_within, positive, within

MOST_SITES = 1_000_000


class Ends(StrEnum):
    """What the end sites are coupled to."""

    FREE = "free"
    """One neighbour only: the coupling term of site 1 is y_1 - y_2."""

    PERIODIC = "periodic"
    """Each other, as in (40)."""


@dataclass(frozen=True)
class VdpChain:
    """Parameters of (8); dimensionless, checked once.

    Attributes
    ----------
    a, b : float
        Damping coefficients, positive.
    c : float
        Coupling, zero or positive.
    eps : float
        Small parameter ε, from 1e-9 to 10. The averaged chain does not depend on it.
    sites : int
        Number of oscillators N, from 2 to 1 000 000.
    ends : Ends
        Free or periodic.

    Raises
    ------
    ParameterError
        If one is out of range.

    Examples
    --------
    >>> chain = VdpChain(a=4, b=0.5, c=0.6)
    >>> chain.eta, round(chain.stable_amplitude, 6), round(chain.unstable_amplitude, 6)
    (0.03125, 3.863703, 1.035276)
    """

    a: float
    b: float
    c: float
    eps: float = 0.01
    sites: int = 31
    ends: Ends = Ends.FREE

    def __post_init__(self) -> None:
        eta_from_damping(self.a, self.b)
        within("coupling c", self.c, 0.0, 1e6, "give a coupling that is zero or positive")
        positive("small parameter eps", self.eps)
        within("small parameter eps", self.eps, 1e-9, 10.0)
        count_within("number of sites n", self.sites, 2, MOST_SITES)
        object.__setattr__(self, "ends", Ends(self.ends))

    @property
    def eta(self) -> float:
        """η = b/a²."""
        return self.b / self.a**2

    @property
    def bistable(self) -> bool:
        """Whether a cell alone has two cycles, 8b < a²."""
        return self.eta < ETA_END

    @property
    def stable_amplitude(self) -> float:
        """|φ_s| = √[(a/b)(1 + √(1 - 8η))], of y on the stable cycle of one cell to O(ε)."""
        self._need_cycles()
        return math.sqrt(self.a / self.b * (1.0 + math.sqrt(1.0 - 8.0 * self.eta)))

    @property
    def unstable_amplitude(self) -> float:
        """|φ_us| = √[(a/b)(1 - √(1 - 8η))] = √[(8/a)/(1 + √(1 - 8η))]."""
        self._need_cycles()
        return math.sqrt(8.0 / self.a / (1.0 + math.sqrt(1.0 - 8.0 * self.eta)))

    def _need_cycles(self) -> None:
        if not self.bistable:
            raise ParameterError(
                "eta = b/a^2",
                f"{self.eta:.6g}",
                "below 1/8 where the two limit cycles are needed",
                "take a larger a or a smaller b",
            )


def effective_epsilon(chain: VdpChain) -> float:
    """Return ε max|1 - a y² + b y⁴| over the stable cycle, which governs the error of averaging.

    The maximum is at the turning points, y² = |φ_s|²: (1 + 7s)/(1 - s) with s = √(1 - 8η). Where
    the damping is most negative, y² = a/2b, it is (1 + s²)/(1 - s²), never more.

    Examples
    --------
    >>> round(effective_epsilon(VdpChain(a=4, b=0.5, c=0.6)), 3)
    0.527
    """
    turning = chain.stable_amplitude**2
    return chain.eps * (1.0 - chain.a * turning + chain.b * turning**2)
