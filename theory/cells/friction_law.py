"""Friction laws of Model I: the coefficient μ in slip as a function of the speed v = |v_rel|.

    exponential   μ = μ_d + (μ_st - μ_d) e^{-v/v₀} + κv      (2), corrected; κ = 0 in the paper
    stribeck      μ = μ_d + (μ_st - μ_d) e^{-(v/v_s)²} + κv
    coulomb       μ = μ_d + κv

In stick, under every law, friction takes the value that holds the site, up to μ_st. All quantities
are dimensionless.

References
----------
B. Armstrong-Hélouvry, P. Dupont, C. Canudas de Wit (1994), A survey of models, analysis tools and
compensation methods for the control of machines with friction.
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from typing import NamedTuple

from scipy.optimize import brentq

from theory.arrays import EPS
from theory.status import Status


class FrictionLaw(Status):
    """How the friction coefficient falls with the sliding speed."""

    EXPONENTIAL = "exponential", "It falls as exp(-v/v0) from mu_st to mu_d: Eq. (2)."
    STRIBECK = "stribeck", "It falls as exp(-(v/v_s)^2) from mu_st to mu_d: the Stribeck effect."
    COULOMB = "coulomb", "It is mu_d in slip whatever the speed, and up to mu_st in stick."


class UnstableSliding(NamedTuple):
    """Belt velocities between which steady sliding is unstable; both 0 if there are none.

    ``error`` bounds the error of both velocities.
    """

    low: float
    high: float
    error: float


@dataclass(frozen=True, kw_only=True)
class FrictionCurve:
    """The coefficient μ(v) of one law, and its derivative.

    Attributes
    ----------
    law : FrictionLaw
        Functional form.
    mu_st, mu_d : float
        Static and dynamic coefficient.
    scale : float
        v₀ or v_s; not used by Coulomb's law.
    viscous : float
        κ.

    Examples
    --------
    >>> curve = FrictionCurve(law=FrictionLaw.STRIBECK, mu_st=1.0, mu_d=0.5, scale=0.5, viscous=0.1)
    >>> curve.coefficient(0.0), round(curve.coefficient(0.5), 6), round(curve.slope(0.5), 6)
    (1.0, 0.73394, -0.635759)
    """

    law: FrictionLaw
    mu_st: float
    mu_d: float
    scale: float
    viscous: float = 0.0

    @property
    def drop(self) -> float:
        """μ_st - μ_d if μ falls continuously from stick to fast slip, and 0 if it jumps."""
        return 0.0 if self.law is FrictionLaw.COULOMB else self.mu_st - self.mu_d

    @property
    def steepest(self) -> float:
        """Largest rate of decrease of μ - κv: (μ_st - μ_d)/v₀, or (μ_st - μ_d)√(2/e)/v_s."""
        factor = math.sqrt(2.0 / math.e) if self.law is FrictionLaw.STRIBECK else 1.0
        return self.drop / self.scale * factor

    def coefficient(self, speed: float) -> float:
        """Return μ at a speed, zero or positive."""
        return self.mu_d + self.drop * self._falling(speed) + self.viscous * speed

    def slope(self, speed: float) -> float:
        """Return dμ/dv at a speed, zero or positive."""
        rate = -self.drop / self.scale * self._falling(speed)
        if self.law is FrictionLaw.STRIBECK:
            rate *= 2.0 * (speed / self.scale)
        return rate + self.viscous

    def curvature(self, speed: float) -> float:
        """Return d²μ/dv² at a speed, zero or positive."""
        if self.law is FrictionLaw.STRIBECK:
            u = speed / self.scale
            return self.drop * (4.0 * u * u - 2.0) * math.exp(-u * u) / self.scale**2
        return (self.viscous - self.slope(speed)) / self.scale

    def third_derivative(self, speed: float) -> float:
        """Return d³μ/dv³ at a speed, zero or positive.

        Examples
        --------
        >>> for law in FrictionLaw:
        ...     curve = FrictionCurve(law=law, mu_st=1.0, mu_d=0.5, scale=0.5)
        ...     below, above = (curve.curvature(0.7 + h) for h in (-1e-5, 1e-5))
        ...     print(abs((above - below) / 2e-5 - curve.third_derivative(0.7)) < 1e-8)
        True
        True
        True
        """
        if self.law is FrictionLaw.STRIBECK:
            u = speed / self.scale
            return self.drop * (12.0 - 8.0 * u * u) * u * math.exp(-u * u) / self.scale**3
        return -(self.viscous - self.slope(speed)) / self.scale**2

    def _falling(self, speed: float) -> float:
        u = speed / self.scale
        if self.law is FrictionLaw.STRIBECK:
            return math.exp(-u * u)
        return math.exp(-u)

    def unstable_sliding(self, damping: float) -> UnstableSliding:
        """Return the interval of v_d with damping + μ'(v_d) < 0, whose ends are Hopf bifurcations.

        For the exponential law it extends from 0 to v₀ ln[(μ_st - μ_d)/((2ξ + κ)v₀)]. For
        Stribeck's law the ends are the roots of x e^{-x²} = (2ξ + κ)v_s/(2(μ_st - μ_d)),
        x = v_d/v_s, on either side of x = 1/√2; they are found by bracketing, as roots of the
        logarithm of this equation.

        Parameters
        ----------
        damping : float
            2ξ, zero or positive.

        Examples
        --------
        >>> curve = FrictionCurve(law=FrictionLaw.STRIBECK, mu_st=1.0, mu_d=0.5, scale=0.5)
        >>> low, high, error = curve.unstable_sliding(0.1)
        >>> round(low, 6), round(high, 6), error < 1e-14
        (0.025063, 0.954201, True)
        """
        drag = damping + self.viscous
        if self.law is FrictionLaw.COULOMB:
            return UnstableSliding(0.0, 0.0, 0.0)
        if drag == 0.0:
            return UnstableSliding(0.0, math.inf, 0.0)
        if self.law is FrictionLaw.EXPONENTIAL:
            size = math.log((self.mu_st - self.mu_d) / (drag * self.scale))
            error = 4.0 * EPS * self.scale * (1.0 + abs(size))
            return UnstableSliding(0.0, self.scale * max(0.0, size), error)
        level = math.log(drag) + math.log(self.scale) - math.log(2.0 * self.drop)
        if level >= -0.5 * (1.0 + math.log(2.0)):
            return UnstableSliding(0.0, 0.0, 0.0)

        def excess(x: float) -> float:
            return math.log(x) - x * x - level

        middle, far = math.sqrt(0.5), 2.0 + math.sqrt(-level)
        near = max(0.5 * math.exp(level), sys.float_info.min)
        low, high = (
            float(brentq(excess, *ends, xtol=1e-300, rtol=4.0 * EPS))
            for ends in ((near, middle), (middle, far))
        )
        doubt = 8.0 * EPS * (1.0 + abs(level))
        slopes = (1.0 / low - 2.0 * low, 2.0 * high - 1.0 / high)
        error = max(2.0 * min(doubt / max(each, doubt), math.sqrt(doubt)) for each in slopes)
        error += 4.0 * EPS * high
        return UnstableSliding(self.scale * low, self.scale * high, self.scale * error)
