"""Fronts of the averaged chain (43) at strong coupling: v = c + κ(η)(c/6)^{1/3} + O(c^{-1/3}).

On φ_n = (-i)^n r_n e^{icT} with r real, (43) is

    r_n' = (c/2)(r_{n-1} - r_{n+1}) - f(r_n),   f(r) = (r/2)(1 - a r²/4 + b r⁴/8).

Its linear waves r ~ e^{iqn} move at c cos q, fastest at q = 0. A front wide against the spacing
obeys r_T + c r_x + (c/6) r_xxx + f(r) = 0. With r(x - vT) and ξ = (x - vT)/(c/6)^{1/3}

    r''' - κ r' + f(r) = 0,   r(-∞) = r_s,   r(+∞) = 0,   κ = (v - c)/(c/6)^{1/3}.

At r = 0 one root of λ³ - κλ + ½ = 0 has negative real part, at r_s two roots of
λ³ - κλ + f'(r_s) = 0 have positive real part: a curve meets a surface in three dimensions, at
isolated κ. Since v - c grows more slowly than c, v is asymptotically linear in c, with slope one.

Where κ < 0 (η above 0.0567) the front is slower than c and overtaken by phase waves from behind;
the law is then that of a front with the staggered wave behind it for ever.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from theory.parameters import ParameterError, within
from theory.piecewise.dispersion import FloatArray

_SMALLEST_ETA = 1e-4
_LARGEST_ETA = 0.085
_SCAN = 80


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
        Width of the interval in which κ was enclosed, plus the effect of the start.
    """

    eta: float
    kappa: float
    error: float

    def velocity(self, c: float) -> float:
        """Return c + κ (c/6)^{1/3}; the next term is of order c^{-1/3}."""
        return c + self.kappa * math.cbrt(c / 6.0)

    def exponent(self, c: float) -> float:
        """Return d ln v/d ln c of this law; it tends to one."""
        width = self.kappa * math.cbrt(c / 6.0)
        return (c + width / 3.0) / (c + width)


@lru_cache(maxsize=256)
def strong_coupling_front(eta: float) -> StrongCouplingFront:
    """Return κ(η), by shooting backward from r = 0 and bisection on the side it leaves r_s.

    Parameters
    ----------
    eta : float
        η = b/a², from 1e-4 to 0.085. Beyond, the side on which the solution finally leaves does
        not tell on which side it left r_s, and the bisection would end at another front.

    Raises
    ------
    ParameterError
        If η is out of range.

    Examples
    --------
    >>> front = strong_coupling_front(0.03125)
    >>> round(front.kappa, 6), front.error < 1e-8
    (0.493112, True)
    """
    within("eta = b/a^2", eta, _SMALLEST_ETA, _LARGEST_ETA, "measure the front instead")
    # From far above, where the solution leaves upwards, down to the first κ where it does not.
    grid = np.linspace(2.0 + 0.5 * eta ** (-2.0 / 3.0), -1.0, _SCAN)
    below = next((i for i, k in enumerate(grid) if not _leaves_upwards(k, eta, 1e-7)), 0)
    if below == 0:
        raise ParameterError(
            "eta = b/a^2", eta, "one where a strongly coupled front is found", "try another eta"
        )
    ends = []
    for start in (1e-7, 1e-6):
        upper, lower = float(grid[below - 1]), float(grid[below])
        while upper - lower > 4e-12 * max(1.0, upper):
            middle = 0.5 * (lower + upper)
            if _leaves_upwards(middle, eta, start):
                upper = middle
            else:
                lower = middle
        ends.append(0.5 * (lower + upper))
    return StrongCouplingFront(eta, ends[0], 1e-10 + abs(ends[1] - ends[0]))


@dataclass(frozen=True)
class _Passes:
    """Event of scipy that ends the integration: r passes a value."""

    value: float
    terminal: bool = True

    def __call__(self, _: float, x: FloatArray) -> float:
        return float(x[0] - self.value)


def _leaves_upwards(kappa: float, eta: float, start: float) -> bool:
    """Tell on which side of r_s the solution that ends at r = 0 comes from."""
    from scipy.integrate import solve_ivp

    r_s = math.sqrt((1.0 + math.sqrt(1.0 - 8.0 * eta)) / eta)  # a = 1, b = η
    roots = np.roots([1.0, 0.0, -kappa, 0.5])
    rate = float(min(roots, key=lambda root: root.real).real)

    def backward(_: float, x: FloatArray) -> list[float]:
        r = x[0]
        f = 0.5 * r * (1.0 - r * r / 4.0 + eta * r**4 / 8.0)
        return [-x[1], -x[2], -(kappa * x[1] - f)]

    r = start * r_s
    solved = solve_ivp(
        backward,
        (0.0, 400.0),
        [r, rate * r, rate * rate * r],
        method="DOP853",
        rtol=1e-11,
        atol=1e-14 * r_s,
        events=(_Passes(1.4 * r_s), _Passes(-0.4 * r_s)),
    )
    return solved.t_events is not None and bool(solved.t_events[0].size)
