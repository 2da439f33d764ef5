"""Numerical values for the front that do not come from its formulas.

Roots are found by iteration and counted by a winding number. The profile is computed from the
switching history of the sites and the response of the undriven chain, without roots or contours.
All quantities are dimensionless; v stands for the paper's velocity divided by eps.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from scipy.integrate import IntegrationWarning, quad

from derivations.algebra.evidence import Point, value
from derivations.algebra.sums import SumOver
from derivations.front import symbols as s

COUNT = 4000
"""Number of roots on either side of the imaginary axis; the sum is then known to about 1e-4 / v,
and extrapolation in the number of roots improves this to 1e-9."""
WAVES = (256, 1024)
"""Smallest numbers of wavenumbers of the response at weak and at strong coupling; the chain is then
periodic with this number of sites."""
REACH = 25
"""Number of these sites per site reached by a static response, about √(coupling/decay)."""

_PERIODS = (50, 100, 200, 400, 800)
"""Periods up to which integrals over k are computed before they are extrapolated."""


@dataclass(frozen=True)
class Lattice:
    """The linear part of (44): decay at rest and springs.

    Attributes
    ----------
    decay : float
        Rate at which a site at rest decays, per unit of eps t.
    springs : tuple of float
        c w_j, beginning with the nearest neighbours.
    """

    decay: float
    springs: tuple[float, ...]

    def on_site(self, k: Any) -> Any:
        """A(k), shape of ``k``: decay and springs for the wave e^{ikn}, from its neighbours."""
        total = self.decay + 0j
        for _, spring, ahead, back in self._neighbours(k):
            total = total - 0.5j * spring * (2 - ahead - back)
        return total

    def _neighbours(self, k: Any) -> Iterator[tuple[int, float, Any, Any]]:
        """Each distance with its spring, and the wave e^{ikn} at the sites that it couples."""
        next_ahead, next_back = np.exp(1j * k), np.exp(-1j * k)
        ahead = back = 1.0
        for distance, spring in enumerate(self.springs, start=1):
            ahead, back = ahead * next_ahead, back * next_back
            yield distance, spring, ahead, back

    def dispersion(self, k: Any, v: float) -> Any:
        """L(k), shape of ``k``."""
        return self.on_site(k) - 1j * v * k

    def slope(self, k: Any, v: float) -> Any:
        """dL/dk, by exponentials."""
        total = -1j * v + 0 * k
        for distance, spring, ahead, back in self._neighbours(k):
            total = total - 0.5 * spring * distance * (ahead - back)
        return total

    def newton(self, k: Any, v: float) -> Any:
        """L/(dL/dk), shape of ``k``: a Newton step, with each exponential computed once."""
        value, slope = self.decay - 1j * v * k, -1j * v + 0 * k
        for distance, spring, ahead, back in self._neighbours(k):
            value = value - 0.5j * spring * (2 - ahead - back)
            slope = slope - 0.5 * spring * distance * (ahead - back)
        return value / slope


@lru_cache(maxsize=64)
def roots(lattice: Lattice, v: float, count: int = COUNT, upper: bool = True) -> Any:
    """Return the roots of one half-plane, from left to right.

    There are about ``count`` on either side of the imaginary axis: near the origin they are found
    by Newton's method from a grid, farther out by their labels. For strong springs the labels must
    begin farther out. A winding number shows that none is missing, up to twice the distance at
    which labels begin.

    Raises
    ------
    ArithmeticError
        If the number of roots disagrees, wherever labels begin.
    """
    sign = 1.0 if upper else -1.0
    by_label = _roots_by_label(lattice, v, count, sign)
    for periods in (4, 8, 16, 32):
        edge = 2 * np.pi * periods + 0.3
        found = np.concatenate(
            [_roots_near_origin(lattice, v, edge, sign), by_label[np.abs(by_label.real) >= edge]]
        )
        inside = np.count_nonzero(np.abs(found.real) < 2 * edge)
        expected = count_between(lattice, v, -2 * edge, 2 * edge, upper)
        if inside == expected and _are_zeros(found, lattice, v).all():
            return found[np.argsort(found.real)]
    raise ArithmeticError(f"{inside} roots near the origin, the winding number is {expected}")


def _are_zeros(k: Any, lattice: Lattice, v: float) -> Any:
    size = 2 * lattice.decay + v * np.abs(k)
    return np.isfinite(k) & (np.abs(lattice.dispersion(k, v)) < 1e-8 * size)


def _roots_near_origin(lattice: Lattice, v: float, edge: float, sign: float) -> Any:
    """Apply Newton's method from a grid; return each root once."""
    columns = np.linspace(-edge - 1, edge + 1, round(6.3 * edge))
    heights = np.geomspace(0.02, 9, 14)
    k = (columns[:, None] + 1j * sign * heights[None, :]).ravel()
    with np.errstate(all="ignore"):
        active = np.arange(k.size)
        for _ in range(25):
            steps = lattice.newton(k[active], v)
            k[active] -= steps
            active = active[np.abs(steps) > 1e-15 * np.abs(k[active])]  # also drops NaN
        converged = _are_zeros(k, lattice, v)
    k = k[converged & (sign * k.imag > 0) & (np.abs(k.real) < edge)]
    found: list[complex] = []
    for each in k:
        if all(abs(each - other) > 1e-6 for other in found):
            found.append(complex(each))
    return np.array(found)


def _roots_by_label(lattice: Lattice, v: float, count: int, sign: float) -> Any:
    """Solve for the growing exponential, with a label for the sheet of the logarithm."""
    reach = len(lattice.springs)
    labels = np.arange(-count * reach, count * reach + 1)
    labels = labels[np.abs(labels) > 2 * reach]
    outermost = lattice.springs[-1]
    k = 2 * np.pi * labels / reach + 1j * sign * np.log(2 + np.abs(labels)) / reach
    for _ in range(25):
        previous = k
        dominant = 0.5j * outermost * np.exp(-1j * sign * reach * k)
        others = -(lattice.dispersion(k, v) - dominant) / (0.5j * outermost)
        k = 1j * sign / reach * (np.log(-1j * others) + 1j * np.pi / 2 - 2j * np.pi * sign * labels)
        if np.all(np.abs(k - previous) < 1e-9 * np.abs(k)):  # Newton's method does the rest
            break
    for _ in range(3):
        k = k - lattice.newton(k, v)
    return k


def count_between(lattice: Lattice, v: float, left: float, right: float, upper: bool) -> int:
    """Return the number of roots in a half-infinite strip: the winding number of L around it."""
    sign, reach, outermost = (
        (1.0 if upper else -1.0),
        len(lattice.springs),
        abs(lattice.springs[-1]),
    )
    height = 2.0
    size = 1 + sum(map(abs, lattice.springs)) * np.exp((reach - 1) * 2.0)
    span = abs(left) + abs(right)
    while outermost * np.exp(reach * height) < 20 * (
        size * np.exp((reach - 1) * (height - 2.0)) + v * (span + height)
    ):
        height += 0.5
    points = 4001 + int(200 * (right - left) * reach)
    horizontal, vertical = np.linspace(left, right, points), np.linspace(0, height, 4001)
    path = [horizontal, right + 1j * sign * vertical, horizontal[::-1] + 1j * sign * height,
            left + 1j * sign * vertical[::-1]]  # fmt: skip
    angles = np.unwrap(np.angle(lattice.dispersion(np.concatenate(path), v)))
    return round(sign * float(angles[-1] - angles[0]) / (2 * np.pi))


@lru_cache(maxsize=512)
def profile(lattice: Lattice, zeta: float, v: float) -> complex:
    """Return phi(zeta)/phi_s from the history of the sites that have switched.

    The site m places behind has been driven for a time (m - zeta)/v. Its contribution is the
    response of the undriven chain, summed over plane waves. For each wave, the remainder of the
    initial state decreases by the same factor from site to site.
    """
    pull = sum(j * j * abs(spring) for j, spring in enumerate(lattice.springs, start=1))
    count = WAVES[sum(map(abs, lattice.springs)) > 8 * lattice.decay]
    while count < REACH * math.sqrt(pull / lattice.decay):
        count *= 2
    k = 2 * np.pi * np.arange(count) / count
    decay = lattice.on_site(k)
    sites = np.arange(int(np.floor(zeta)) + 1, count // 2)
    static = np.fft.ifft(1 / decay)[sites].sum()
    factor = np.exp(1j * k - decay / v)
    first = np.exp(1j * sites[0] * k - (sites[0] - zeta) / v * decay) / decay
    transient = (first * (1 - factor**sites.size) / (1 - factor)).mean()
    return complex(lattice.decay * (static - transient))


def kinetic_sum(lattice: Lattice, v: float) -> complex:
    """Return the sum of (53), computed from the profile at the front."""
    return -profile(lattice, 0.0, v) / lattice.decay


def evaluated(expression: sp.Basic, point: Point, lattice: Lattice, v: float) -> complex:
    """Return a number, with sums over roots and integrals evaluated numerically."""
    expression = expression.xreplace({node: _sum_over(node, point, lattice, v)
                                      for node in expression.atoms(SumOver)})  # fmt: skip
    expression = expression.xreplace({node: _integral(node, point)
                                      for node in expression.atoms(sp.Integral)})  # fmt: skip
    return complex(value(expression, point))


def _sum_over(node: sp.Basic, point: Point, lattice: Lattice, v: float) -> sp.Expr:
    term, _, which = node.args
    values = {q: sp.sympify(given) for q, given in point.items() if q not in (s.k, s.L_k)}
    function = sp.lambdify((s.k, s.L_k), term.xreplace(values), "numpy")
    found = roots(lattice, v, upper=which == s.M_plus)
    terms = function(found, lattice.slope(found, v))
    # Partial sums between -edge and edge behave like S + p/edge + q/edge²: extrapolate twice.
    reach = len(lattice.springs)
    sums = []
    for count in (COUNT // 4, COUNT // 2, COUNT):
        middle = int(np.searchsorted(found.real, 0.0))
        half = (count - 20) * reach
        sums.append(terms[max(middle - half, 0) : middle + half].sum())
    edges = [count - 20 for count in (COUNT // 4, COUNT // 2, COUNT)]
    return sp.sympify(_extrapolated(sums, edges))


def _extrapolated(sums: Sequence[complex], ends: Sequence[float]) -> complex:
    """Return I if sums up to e are I + p/e + q/e² and so on, to as many terms as there are sums."""
    powers = np.vander(1.0 / np.asarray(ends), increasing=True)
    return complex(np.linalg.solve(powers, np.array(sums))[0])


def _integral(node: Any, point: Point) -> sp.Expr:
    (variable, low, high), values = node.limits[0], dict(point)
    values.pop(variable, None)
    integrand = node.function.xreplace({q: sp.sympify(given) for q, given in values.items()})
    function = sp.lambdify(variable, integrand, "numpy")
    if (low, high) == (0, sp.oo):
        return sp.sympify(_to_infinity(function))
    start, end = float(low), float(high)

    with warnings.catch_warnings():
        warnings.simplefilter("error", IntegrationWarning)
        try:
            found = quad(function, start, end, limit=400, epsabs=1e-11, complex_func=True)[0]
        except IntegrationWarning:
            raise ArithmeticError("an integral did not converge") from None
    return sp.sympify(complex(found))


def _to_infinity(function: Callable[[Any], Any]) -> complex:
    """Return the integral from 0 of a function that decays like 1/k² and contains cosines of k.

    Up to 2πM it is I + p/M + q/M² and so on. It is computed for several M by Gauss's rule on parts
    of a period, which are halved until the result no longer changes; it must not depend on the
    smallest M either.
    """
    previous = _in_parts(function, 8)
    for parts in (16, 32, 64):
        sums = _in_parts(function, parts)
        found = _extrapolated(sums, _PERIODS)
        tolerance = 1e-8 * abs(found)
        if abs(found - _extrapolated(previous, _PERIODS)) <= tolerance:
            if abs(found - _extrapolated(sums[1:], _PERIODS[1:])) <= 10 * tolerance:
                return found
            break
        previous = sums
    raise ArithmeticError("an integral did not converge")


def _in_parts(function: Callable[[Any], Any], parts: int) -> list[complex]:
    """Return the integral up to each number of periods, with each period cut into equal parts."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    half = math.pi / parts
    middles = half * (2.0 * np.arange(parts * _PERIODS[-1]) + 1.0)
    values = function(middles[:, None] + half * nodes) @ weights * half
    return [complex(values[: parts * count].sum()) for count in _PERIODS]
