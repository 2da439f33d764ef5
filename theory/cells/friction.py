"""Model I, a single cell (Eqs. 2-7): steady sliding, its stability, the stick phase.

    ÿ + 2ξẏ + y = F(ẏ - v_d),   F = -sgn(v_rel) μ(v_rel) in slip,  |F| ≤ μ_st in stick.

The friction law μ of the paper is (2); other laws are in ``theory.cells.friction_law``.

All quantities are dimensionless (Eq. 4).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from theory.cells.friction_law import FrictionCurve, FrictionLaw, UnstableSliding
from theory.parameters import ParameterError, real_number

LARGEST = 1e9
"""Largest velocity or coefficient; beyond it the rounding of y hides the cycles."""


@dataclass(frozen=True, kw_only=True)
class FrictionCell:
    """Parameters of a friction-excited oscillator; by default those of (7) at v_d = 1.25.

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
    law : FrictionLaw or str
        How friction decreases with velocity; by default as in (2).
    v_s : float
        Velocity of Stribeck's law, positive; used by the law ``stribeck`` only.
    viscous : float
        Coefficient κ of a viscous part κ|v_rel| of μ, zero or positive; used by every law.

    Raises
    ------
    ParameterError
        If a parameter is out of range, or does not belong to the chosen law.

    Examples
    --------
    >>> cell = FrictionCell()
    >>> round(cell.steady_sliding, 6), round(cell.hopf_velocity, 6), cell.release
    (0.541042, 1.151293, 0.875)
    >>> FrictionCell(law="coulomb").steady_sliding
    0.5
    """

    v_d: float = 1.25
    mu_st: float = 1.0
    mu_d: float = 0.5
    v0: float = 0.5
    xi: float = 0.05
    law: FrictionLaw = FrictionLaw.EXPONENTIAL
    v_s: float = 0.5
    viscous: float = 0.0

    def __post_init__(self) -> None:
        def check(name: str, quantity: str, low: float, high: float, remedy: str) -> float:
            number = real_number(quantity, getattr(self, name), low, high, remedy)
            object.__setattr__(self, name, number)
            return number

        remedy = "give a positive number in this range"
        names = (
            ("v_d", "belt velocity v_d"),
            ("mu_st", "static friction mu_st"),
            ("v0", "reference velocity v0"),
            ("v_s", "Stribeck velocity v_s"),
        )
        for name, quantity in names:
            if check(name, quantity, 0.0, LARGEST, remedy) == 0.0:
                raise ParameterError(quantity, 0, "positive", "give a positive number")
        check("mu_d", "dynamic friction mu_d", 0.0, 1e6, "give a value in this range")
        if not self.mu_d < self.mu_st:
            raise ParameterError(
                "static friction mu_st", self.mu_st, f"greater than mu_d = {self.mu_d:g}",
                "friction must fall with velocity for the cell to be excited",
            )  # fmt: skip
        check("xi", "damping ratio xi", 0.0, 1e3, "give a damping in this range")
        check("viscous", "viscous friction", 0.0, 1e3, "give a value in this range")
        self._check_law()

    def _check_law(self) -> None:
        """Store the law as a member; refuse a velocity that does not belong to it."""
        object.__setattr__(self, "law", FrictionLaw(self.law))
        for name, law in (("v0", FrictionLaw.EXPONENTIAL), ("v_s", FrictionLaw.STRIBECK)):
            if self.law is not law and getattr(self, name) != getattr(FrictionCell, name):
                raise ParameterError(
                    name, getattr(self, name), f"given with the law {law.value} only",
                    f"leave {name} out, or take that law",
                )  # fmt: skip

    @cached_property
    def curve(self) -> FrictionCurve:
        """The friction coefficient as a function of velocity, with its derivatives."""
        scale = self.v_s if self.law is FrictionLaw.STRIBECK else self.v0
        return FrictionCurve(
            law=self.law, mu_st=self.mu_st, mu_d=self.mu_d, scale=scale, viscous=self.viscous
        )

    @property
    def steady_sliding(self) -> float:
        """The displacement y in steady sliding, μ(v_d)."""
        return friction_coefficient(self, self.v_d)

    @property
    def effective_damping(self) -> float:
        """2ξ + μ'(v_d); steady sliding is stable where this is positive."""
        return 2.0 * self.xi + friction_slope(self, self.v_d)

    @property
    def unstable_sliding(self) -> UnstableSliding:
        """The interval of v_d in which steady sliding is unstable, with its error."""
        return self.curve.unstable_sliding(2.0 * self.xi)

    @property
    def hopf_velocity(self) -> float:
        """Velocity v_d above which steady sliding is stable: the larger root of 2ξ + μ'(v_d) = 0.

        For the law of (2) it is v₀ ln[(μ_st - μ_d)/((2ξ + κ)v₀)]. It is 0 if sliding is stable at
        every v_d, and infinite if sliding is never stable (2ξ + κ = 0).

        Raises
        ------
        ParameterError
            For Coulomb's law, which has no Hopf bifurcation.
        """
        if self.law is FrictionLaw.COULOMB:
            raise ParameterError(
                "Hopf velocity", "asked of Coulomb's law", "that of a law that falls with velocity",
                "steady sliding is stable at every v_d: mu does not fall while the cell slides",
            )  # fmt: skip
        return self.unstable_sliding.high

    @property
    def stability_margin(self) -> float:
        """Distance of v_d from the velocities at which steady sliding is unstable; at most v_d.

        It is zero or negative if v_d is one of these velocities.
        """
        low, high, _ = self.unstable_sliding
        return min(self.v_d, max(self.v_d - high, low - self.v_d) if high > 0.0 else self.v_d)

    @property
    def release(self) -> float:
        """Displacement y at which a site that moves with the belt is released: 2ξv_d + y = μ_st."""
        return self.mu_st - 2.0 * self.xi * self.v_d


def check_sliding_stable(cell: FrictionCell) -> None:
    """Refuse a belt velocity at which steady sliding is unstable and every site starts to move.

    Raises
    ------
    ParameterError
        If v_d is neither above the Hopf velocity nor below the range of instability, or if there is
        no damping at all and friction falls at every velocity.
    """
    if cell.unstable_sliding.high == math.inf:
        raise ParameterError(
            "damping ratio xi",
            cell.xi,
            "positive where friction has no viscous part, since steady sliding is unstable "
            "otherwise and every site starts by itself",
            "take more damping",
        )
    if cell.stability_margin <= 0.0:
        raise ParameterError(
            "belt velocity v_d",
            cell.v_d,
            f"above {cell.hopf_velocity:.6g}, below which steady sliding is unstable and every "
            "site starts by itself",
            "take a larger v_d or more damping",
        )


def friction_coefficient(cell: FrictionCell, v_rel: float) -> float:
    """Return μ(v_rel) in slip; (2), corrected, is μ_d + (μ_st - μ_d) e^{-|v_rel|/v₀}.

    As printed, (2) begins with μ_st, which contradicts both limits that the paper states.

    Examples
    --------
    >>> friction_coefficient(FrictionCell(), 0.0)
    1.0
    """
    return cell.curve.coefficient(abs(v_rel))


def friction_slope(cell: FrictionCell, speed: float) -> float:
    """Return dμ/d|v_rel| at a speed |v_rel|; without a viscous part it is never positive."""
    return cell.curve.slope(abs(speed))


def friction_force(cell: FrictionCell, v_rel: float) -> float:
    """Return F of (6) in slip, v_rel ≠ 0.

    Raises
    ------
    ParameterError
        If v_rel is zero: in stick the force takes whatever value holds the site.

    Examples
    --------
    >>> friction_force(FrictionCell(), -1.25) == FrictionCell().steady_sliding
    True
    """
    if v_rel == 0.0:
        raise ParameterError(
            "relative velocity",
            v_rel,
            "different from zero",
            "in stick the friction force is whatever balances the other forces",
        )
    return -math.copysign(friction_coefficient(cell, v_rel), v_rel)


@dataclass(frozen=True)
class StickPhase:
    """A stick phase of one cell, in closed form.

    Attributes
    ----------
    begin, end : float
        Displacement y at the beginning, and at the release of the cell.
    duration : float
        (end - begin)/v_d.
    """

    begin: float
    end: float
    duration: float


def stick_phase(cell: FrictionCell, y: float) -> StickPhase | None:
    """Return the stick phase that begins when ẏ reaches v_d at this y; None if the cell slips.

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
