"""Model I, one cell (Eqs. 2-7): friction law, steady sliding, its stability, the stick phase.

    ÿ + 2ξẏ + y = F(ẏ - v_d),   F = -sgn(v_rel) μ(v_rel) in slip,  |F| ≤ μ_st in stick.

All quantities are dimensionless (Eq. 4).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from theory.parameters import ParameterError, real_number

LARGEST = 1e300
"""Largest velocity or coefficient: beyond, sums of them would leave double precision."""


@dataclass(frozen=True, kw_only=True)
class FrictionCell:
    """Parameters of one friction-excited oscillator; by default those of (7) at v_d = 1.25.

    Attributes
    ----------
    v_d : float
        Velocity of the belt, positive.
    mu_st, mu_d : float
        Static and dynamic friction coefficients, μ_st > μ_d ≥ 0.
    v0 : float
        Reference velocity of (2), positive.
    xi : float
        Damping ratio, zero or positive.

    Raises
    ------
    ParameterError
        If one is out of range.

    Examples
    --------
    >>> cell = FrictionCell()
    >>> round(cell.steady_sliding, 6), round(cell.hopf_velocity, 6), cell.release
    (0.541042, 1.151293, 0.875)
    """

    v_d: float = 1.25
    mu_st: float = 1.0
    mu_d: float = 0.5
    v0: float = 0.5
    xi: float = 0.05

    def __post_init__(self) -> None:
        def check(name: str, quantity: str, low: float, high: float, remedy: str) -> float:
            number = real_number(quantity, getattr(self, name), low, high, remedy)
            object.__setattr__(self, name, number)
            return number

        remedy = "give a positive number"
        names = (
            ("v_d", "belt velocity v_d"),
            ("mu_st", "static friction mu_st"),
            ("v0", "reference velocity v0"),
        )
        for name, quantity in names:
            if check(name, quantity, 0.0, LARGEST, remedy) == 0.0:
                raise ParameterError(quantity, 0, "positive", remedy)
        check("mu_d", "dynamic friction mu_d", 0.0, 1e6, "give a value in this range")
        if not self.mu_d < self.mu_st:
            raise ParameterError(
                "static friction mu_st", self.mu_st, f"greater than mu_d = {self.mu_d:g}",
                "friction must fall with velocity for the cell to be excited",
            )  # fmt: skip
        remedy = "give a damping that is zero or positive"
        check("xi", "damping ratio xi", 0.0, 1e3, remedy)

    @property
    def steady_sliding(self) -> float:
        """Y of steady sliding, μ(v_d)."""
        return friction_coefficient(self, self.v_d)

    @property
    def effective_damping(self) -> float:
        """2ξ + μ'(v_d): steady sliding is stable where this is positive."""
        return 2.0 * self.xi + friction_slope(self, self.v_d)

    @property
    def hopf_velocity(self) -> float:
        """v₀ ln[(μ_st - μ_d)/(2ξv₀)], above which steady sliding is stable.

        0 if it is stable for every v_d, infinite if (ξ = 0) for none.
        """
        if self.xi == 0.0:
            return math.inf
        return self.v0 * max(0.0, math.log((self.mu_st - self.mu_d) / (2.0 * self.xi * self.v0)))

    @property
    def release(self) -> float:
        """Y at which stick ends when y moves with the belt: 2ξv_d + y = μ_st."""
        return self.mu_st - 2.0 * self.xi * self.v_d


def check_sliding_stable(cell: FrictionCell) -> None:
    """Refuse a belt so slow that sites at rest start by themselves.

    Raises
    ------
    ParameterError
        If v_d is not above the Hopf velocity.
    """
    if cell.v_d <= cell.hopf_velocity:
        raise ParameterError(
            "belt velocity v_d",
            cell.v_d,
            f"above {cell.hopf_velocity:.6g}, below which steady sliding is unstable and every "
            "site starts by itself",
            "take a larger v_d or more damping",
        )


def friction_coefficient(cell: FrictionCell, v_rel: float) -> float:
    """Return μ(v_rel) of (2), corrected: μ_d + (μ_st - μ_d) e^{-|v_rel|/v₀}.

    Print has μ_st in front, which contradicts both of its stated limits.

    Examples
    --------
    >>> friction_coefficient(FrictionCell(), 0.0)
    1.0
    """
    return cell.mu_d + (cell.mu_st - cell.mu_d) * math.exp(-abs(v_rel) / cell.v0)


def friction_slope(cell: FrictionCell, speed: float) -> float:
    """Return dμ/d|v_rel| at a speed |v_rel|; never positive."""
    return -(cell.mu_st - cell.mu_d) / cell.v0 * math.exp(-abs(speed) / cell.v0)


def friction_force(cell: FrictionCell, v_rel: float) -> float:
    """Return F of (6) in slip, v_rel ≠ 0.

    Raises
    ------
    ParameterError
        If v_rel is zero, where the force is whatever holds the site.

    Examples
    --------
    >>> friction_force(FrictionCell(), -1.25) == FrictionCell().steady_sliding
    True
    """
    if v_rel == 0.0:
        raise ParameterError(
            "relative velocity", v_rel, "different from zero", "in stick the force is what holds"
        )
    return -math.copysign(friction_coefficient(cell, v_rel), v_rel)


@dataclass(frozen=True)
class StickPhase:
    """A stick phase of one cell, in closed form.

    Attributes
    ----------
    begin, end : float
        y where it begins and where the cell is released.
    duration : float
        (end - begin)/v_d.
    """

    begin: float
    end: float
    duration: float


def stick_phase(cell: FrictionCell, y: float) -> StickPhase | None:
    """Return the stick phase that begins when ẏ reaches v_d at this y; None if none does.

    Examples
    --------
    >>> stick_phase(FrictionCell(), -0.375).duration
    1.0
    >>> stick_phase(FrictionCell(), 2.0) is None
    True
    """
    force = 2.0 * cell.xi * cell.v_d + y
    if abs(force) > cell.mu_st:
        return None
    return StickPhase(y, cell.release, (cell.release - y) / cell.v_d)
