"""Fronts of the averaged chain (43) at strong coupling: v = c + κ(η)(c/6)^{1/3} + O(c^{-1/3}).

With φ_n = (-i)^n r_n e^{icT} and r real, (43) is

    r_n' = (c/2)(r_{n-1} - r_{n+1}) - f(r_n),   f(r) = (r/2)(1 - a r²/4 + b r⁴/8).

Its linear waves r ~ e^{iqn} have the group velocity c cos q, which is largest at q = 0. A front
that is wide compared with the spacing obeys r_T + c r_x + (c/6) r_xxx + f(r) = 0. With r(x - vT)
and ξ = (x - vT)/(c/6)^{1/3} this becomes

    r''' - κ r' + f(r) = 0,   r(-∞) = r_s,   r(+∞) = 0,   κ = (v - c)/(c/6)^{1/3}.

At r = 0 one root of λ³ - κλ + ½ = 0 has negative real part, and at r_s two roots of
λ³ - κλ + f'(r_s) = 0 have positive real part: in the three-dimensional phase space a curve meets a
surface, which happens at isolated κ. Since v - c grows more slowly than c, v is asymptotically
linear in c, with slope one.

Where κ < 0 (η above 0.05667, `wave_fast_eta`), the front is slower than c and is overtaken by phase
waves from behind; the law then holds for a front behind which the wave with quarter-turn phase
steps extends without end.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache

import numpy as np
from scipy.linalg import solve_banded

from theory.arrays import FloatArray
from theory.cells.vdp import eta_of_fronts
from theory.parameters import Range, RunError, with_ranges

ETAS = Range(1e-4, 0.11)
"""Range of η in which κ is computed."""


@dataclass(frozen=True)
class StrongCouplingFront:
    """The law v = c + κ (c/6)^{1/3}.

    Attributes
    ----------
    eta : float
        η = b/a².
    kappa : float
        κ(η), dimensionless.
    error : float
        Bound on the error of κ, from a coarser grid and from rounding.
    """

    eta: float
    kappa: float
    error: float

    def velocity(self, c: float) -> float:
        """Return c + κ (c/6)^{1/3}; the next term is of order c^{-1/3}."""
        return c + self.kappa * math.cbrt(c / 6.0)

    def exponent(self, c: float) -> float:
        """Return d ln v/d ln c of this law, which tends to one."""
        width = self.kappa * math.cbrt(c / 6.0)
        return (c + width / 3.0) / (c + width)


@with_ranges(eta=ETAS)
@lru_cache(maxsize=256)
def strong_coupling_front(eta: float) -> StrongCouplingFront:
    """Return κ(η), by Newton's method on finite differences of high order.

    Lengths are in units of f'(r_s)^{-1/3}, in which the front changes little with η. The front is
    continued from the η at which κ is nearly zero, where Newton's method converges from a
    hyperbolic tangent.

    Parameters
    ----------
    eta : float
        η = b/a², {eta}.

    Raises
    ------
    ParameterError
        If η is out of range.
    RunError
        If Newton's method does not converge.

    References
    ----------
    B. Fornberg (1988), Generation of finite difference formulas on arbitrarily spaced grids, Math.
    Comp. 51, 699.

    Examples
    --------
    >>> front = strong_coupling_front(0.03125)
    >>> round(front.kappa, 10), front.error < 1e-10
    (0.4931123548, True)
    """
    eta_of_fronts(eta, ETAS)
    coarse, fine = (_followed(eta, spacing) for spacing in _SPACINGS)
    rounding = 1e-12 * max(1.0, abs(fine))
    return StrongCouplingFront(eta, fine, 2.0 * abs(fine - coarse) + rounding)


@lru_cache(maxsize=1)
def wave_fast_eta() -> tuple[float, float]:
    """Return the η at which κ = 0 and strongly coupled fronts are as fast as waves, and its error.

    At smaller η fronts outrun all waves; at larger η waves overtake them from behind.

    Examples
    --------
    >>> eta, error = wave_fast_eta()
    >>> round(eta, 9), error < 1e-11
    (0.056665326, True)
    """
    low, high = 0.0566, 0.0567
    for _ in range(8):  # secant method; κ is smooth
        one, two = strong_coupling_front(low), strong_coupling_front(high)
        slope = (two.kappa - one.kappa) / (high - low)
        low, high = high, high - two.kappa / slope
        if abs(high - low) < 1e-10:
            break
    last = strong_coupling_front(high)
    return high, (abs(last.kappa) + last.error) / abs(slope)


_SPACINGS = 0.175, 0.125
_EXTENT = 76.0
"""Half the length of the grid; the tails of the front decay at least like e^{-s/2}."""
_REACH = 6
"""Number of points on either side in a difference formula, whose error is of tenth order."""
_FIRST_ETA, _FACTOR = 0.0567, 1.5
"""η from which the front is continued, and initial factor between successive η."""


def _followed(eta: float, spacing: float) -> float:
    s = spacing * np.arange(-round(_EXTENT / spacing), round(_EXTENT / spacing) + 1)
    rho, kappa, current, factor = 0.5 * (1.0 - np.tanh(0.35 * s)), 0.0, _FIRST_ETA, _FACTOR
    found = _solved(current, rho, kappa, spacing)
    while found is not None and current != eta:
        rho, kappa = found
        target = min(current * factor, eta) if eta > current else max(current / factor, eta)
        solution = _solved(target, rho, kappa, spacing)
        if solution is not None:
            found, current = solution, target
        elif factor < 1.01:
            found = None
        else:
            factor = math.sqrt(factor)
    if found is None:
        raise RunError(f"no strongly coupled front was found at eta = {eta:.6g}: try another eta.")
    return found[1]


def _solved(
    eta: float, rho: FloatArray, kappa: float, spacing: float
) -> tuple[FloatArray, float] | None:
    """Solve the front equation for ρ = r/r_s and κ; return None where Newton's method fails."""
    root = math.sqrt(1.0 - 8.0 * eta)
    square, gamma = (1.0 + root) / eta, math.cbrt((1.0 + root) * root / (4.0 * eta))
    unstable, centre = math.sqrt((1.0 - root) / (1.0 + root)), rho.size // 2
    first = _odd_difference(1) * gamma / spacing
    third = _odd_difference(3) * (gamma / spacing) ** 3
    for _ in range(30):
        padded = np.concatenate([np.ones(_REACH), rho, np.zeros(_REACH)])
        slope = np.correlate(padded, first, "valid")
        r2 = square * rho * rho
        loss = 0.5 * rho * (1.0 - 0.25 * r2 + 0.125 * eta * r2 * r2)
        value = np.correlate(padded, third, "valid") - kappa * slope + loss
        bands = np.repeat((third - kappa * first)[::-1, None], rho.size, axis=1)
        bands[_REACH] += 0.5 - 0.375 * r2 + 0.3125 * eta * r2 * r2
        increment, by_kappa = solve_banded((_REACH, _REACH), bands, np.stack([value, -slope], 1)).T
        kappa_step = (rho[centre] - unstable - increment[centre]) / by_kappa[centre]
        increment += kappa_step * by_kappa
        size = max(float(np.abs(increment).max()), abs(kappa_step))
        if not math.isfinite(size):
            return None
        damping = min(1.0, 0.5 / size)
        rho, kappa = rho - damping * increment, kappa + damping * float(kappa_step)
        if size < 1e-9 * max(1.0, abs(kappa)):
            return rho, kappa
    return None


@lru_cache(maxsize=2)
def _odd_difference(order: int) -> FloatArray:
    """Return the weights of the points from -6 to 6 for a derivative of odd order, spacing one.

    The equations Σ_j 2 w_j j^{2i+1} = order! δ are solved in rational numbers, since a rounding
    error of a weight would act like a change of κ.
    """
    rows = [
        [Fraction(2 * j ** (2 * i + 1)) for j in range(1, _REACH + 1)]
        + [Fraction(math.factorial(order) if 2 * i + 1 == order else 0)]
        for i in range(_REACH)
    ]
    for i in range(_REACH):  # the leading minors of this matrix do not vanish
        rows[i] = [x / rows[i][i] for x in rows[i]]
        for k in range(_REACH):
            if k != i:
                rows[k] = [x - rows[k][i] * y for x, y in zip(rows[k], rows[i], strict=True)]
    right = [float(row[-1]) for row in rows]
    return np.array([*(-x for x in reversed(right)), 0.0, *right])
