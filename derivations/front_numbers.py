"""Numbers for the front that do not come from its formulas.

Roots are found strip by strip; the count of roots is a winding number; the profile is built in
the time domain from Bessel functions, so it knows neither roots nor contours. All quantities are
dimensionless; v stands for the paper's velocity over eps.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp
from scipy.integrate import IntegrationWarning, quad
from scipy.special import jv

from derivations import front_symbols as s
from derivations.algebra.evidence import Point, value

STRIPS = 4000
"""Strips on either side of the imaginary axis; the sum is then known to about 1e-4 / v and
extrapolation in the number of strips brings it to 1e-7."""


def dispersion(k: Any, v: float, c: float) -> Any:
    """L(k) by its exponentials, shape of ``k``."""
    return 0.5 - 1j * v * k - 1j * c + 0.5j * c * (np.exp(1j * k) + np.exp(-1j * k))


@lru_cache(maxsize=64)
def roots(v: float, c: float, strips: int = STRIPS, upper: bool = True) -> Any:
    """One root in each strip, in order of the strips: shape (2 strips,).

    Raises
    ------
    ArithmeticError
        If a root was not found in its strip.
    """
    places = np.arange(-strips, strips)
    if upper:
        low, high = 2 * np.pi * places - np.pi, 2 * np.pi * places + 0.0
    else:
        low = np.where(places < 0, 2 * np.pi * places, 2 * np.pi * places - np.pi)
        low[places == 0] = 0.0
        high = np.where(places < 0, low + 2 * np.pi, low + 2 * np.pi)
        high[places == 0] = np.pi
    sign = 1.0 if upper else -1.0
    found = np.full(places.shape, np.nan + 0j)
    for part in (0.5, 0.25, 0.75, 0.05, 0.95):
        for start in (0.3, 1.5, 4.0, 9.0, 0.05):
            open_ = np.isnan(found)
            if not open_.any():
                break
            k = low[open_] + part * (high[open_] - low[open_]) + 1j * sign * start
            k = _newton(_settle(k, (low[open_], high[open_]), v, c, sign), v, c)
            good = (np.abs(dispersion(k, v, c)) < 1e-9 * (1 + v * np.abs(k))) & (sign * k.imag > 0)
            good &= (k.real > low[open_]) & (k.real < high[open_])
            found[np.flatnonzero(open_)[good]] = k[good]
    if np.isnan(found).any():
        raise ArithmeticError("a strip in which no root was found")
    return found


def _settle(k: Any, strip: tuple[Any, Any], v: float, c: float, sign: float) -> Any:
    """Iterate ``e^{-i sign k} = P(k)`` a few times, with the phase taken inside the strip."""
    low, high = strip
    for _ in range(8):
        q = 1 + v * k / c + 0.5j / c
        root = np.sqrt(q * q - 1)
        big = np.where(np.abs(q + root) > 1, q + root, q - root)
        phase = -sign * np.angle(big)
        phase = low + np.mod(phase - low, 2 * np.pi)
        phase = np.where(phase > high, (low + high) / 2, phase)
        k = phase + 1j * sign * np.maximum(np.log(np.abs(big)), 1e-3)
    return k


def _newton(k: Any, v: float, c: float) -> Any:
    with np.errstate(all="ignore"):
        for _ in range(12):
            k = k + dispersion(k, v, c) / (1j * v + 1j * c * np.sin(k))
    return np.where(np.isfinite(k), k, 0)


def count_in_strip(left: float, right: float, upper: bool, v: float, c: float) -> int:
    """Return the number of roots in a half-infinite strip: the winding number of L around it."""
    height = 5.0
    while c * np.exp(height) < 20 * (1 + c + v * (abs(left) + abs(right) + height)):
        height += 1.0
    sign = 1.0 if upper else -1.0
    along, up = np.linspace(left, right, 4001), np.linspace(0, height, 4001)
    path = [along, right + 1j * sign * up, along[::-1] + 1j * sign * height,
            left + 1j * sign * up[::-1]]  # fmt: skip
    angles = np.unwrap(np.angle(dispersion(np.concatenate(path), v, c)))
    return round(sign * float(angles[-1] - angles[0]) / (2 * np.pi))


@lru_cache(maxsize=256)
def profile(zeta: float, v: float, c: float) -> complex:
    """phi(zeta)/phi_s from the history of the sites that have switched, by Bessel functions.

    Site m places behind has been driven for a time (m - zeta)/v; its answer spreads as
    ``(-i)^|m| e^{-s/2 + ics} J_|m|(cs)``.
    """
    memory = 80.0  # e^{-memory/2} is below rounding
    nodes, weights = np.polynomial.legendre.leggauss(10)
    total = 0j
    for place in range(int(np.floor(zeta)) + 1, int(c * memory + 40)):
        end = min((place - zeta) / v, memory)
        panels = max(int(np.ceil(end * (1 + c))), 1)
        edges = np.linspace(0, end, panels + 1)
        half = np.diff(edges)[:, None] / 2
        s_ = edges[:-1, None] + half * (1 + nodes)
        kernel = np.exp((-0.5 + 1j * c) * s_) * jv(abs(place), c * s_)
        total += 0.5 * (-1j) ** abs(place) * complex((half * weights * kernel).sum())
        if end >= memory and abs(place) > c * memory + 30:
            break
    return total


def kinetic_sum(v: float, c: float) -> complex:
    """Return the sum of (53), from the profile at the front."""
    return -2 * profile(0.0, v, c)


def evaluated(expression: sp.Basic, point: Point, strips: int = STRIPS) -> complex:
    """Return a number, with sums over roots summed and integrals integrated numerically."""
    v, c = float(point[s.v]), float(point[s.c])
    expression = expression.xreplace({node: _sum_over(node, point, v, c, strips)
                                      for node in expression.atoms(s.SumOver)})  # fmt: skip
    expression = expression.xreplace({node: _integral(node, point)
                                      for node in expression.atoms(sp.Integral)})  # fmt: skip
    return complex(value(expression, point))


def _sum_over(node: sp.Basic, point: Point, v: float, c: float, strips: int) -> sp.Expr:
    term, _, which = node.args
    slope = {s.L_k: s.SLOPE}
    rest = {q: sp.sympify(given) for q, given in point.items() if q != s.k}
    function = sp.lambdify(s.k, term.xreplace(slope).xreplace(rest), "numpy")
    found = roots(v, c, strips, which == s.M_plus)
    terms = function(found)
    # Partial sums over strips -m .. m-1 behave like S + p/m + q/m^2: two extrapolations.
    sums = [terms[strips - m : strips + m].sum() for m in (strips // 4, strips // 2, strips)]
    once = [2 * sums[1] - sums[0], 2 * sums[2] - sums[1]]
    return sp.sympify(complex((4 * once[1] - once[0]) / 3))


def _integral(node: Any, point: Point) -> sp.Expr:
    (variable, low, high), rest = node.limits[0], dict(point)
    rest.pop(variable, None)
    integrand = node.function.xreplace({q: sp.sympify(given) for q, given in rest.items()})
    function = sp.lambdify(variable, integrand, "numpy")
    start, end = float(low), float(high) if high != sp.oo else np.inf

    def part_of(name: str) -> Callable[[float], float]:
        return lambda q: float(getattr(complex(function(q)), name))

    with warnings.catch_warnings():
        warnings.simplefilter("error", IntegrationWarning)
        try:
            parts = [quad(part_of(name), start, end, limit=400, epsabs=1e-11)[0]
                     for name in ("real", "imag")]  # fmt: skip
        except IntegrationWarning:
            raise ArithmeticError("an integral did not converge") from None
    return sp.sympify(complex(*parts))
