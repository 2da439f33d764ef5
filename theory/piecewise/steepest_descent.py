"""The shape of a front near ζ = 0 along a path of steepest descent: 500 points at any coupling.

With ζ = m + 1 - ρ, m an integer, 0 ≤ ρ ≤ 1, and a = A/v, the integral of
``theory.piecewise.profile`` is

    φ/φ_s = u_m - (1/4π) ∫ e^{ik(m+1)} e^{-aρ} / (A (1 - e^{ik-a})) dk

with u_m the static front, λ^{m+1}/(1+λ) for m ≥ -1 and 1 - λ^{-m}/(1+λ) for m < 0, where
λ = e^{ik₀} and k₀ is the zero of A with Im k₀ > 0. On the real axis the phase of the integrand
varies by about c/v. The path

    Im k = s (sin Re k + g)

crosses the axis at the saddle points of the phase and descends from both. With g = 0 they are those
of e^{-aρ}, at 0 and π; with g = v/c they are those of e^{ik-a}, which dominate where many sites
that have crossed the threshold act together, v > 2√c. Between axis and path |e^{ik-a}| < 1 (if g =
0, for s below 2c/v²), so that no pole is crossed except possibly k₀, whose residue is
λ^{m+1}/(1+λ). The Gauss–Legendre panels become shorter towards the saddle points.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from theory.arrays import ComplexArray, FloatArray
from theory.piecewise.dispersion import onsite

_POINTS = 16
"""Initial number of points of a panel."""
_MAX_POINTS = 100
_TOLERANCE = 1e-12
_AT_ONCE = 1 << 20
"""Largest number of exponentials held in memory."""


@dataclass(frozen=True)
class _Path:
    """The quadrature for one m: φ/φ_s = static - Σ weights e^{-aρ}.

    Attributes
    ----------
    static : complex
        u_m, minus the residue at k₀ if that pole is crossed.
    a, weights : ndarray of complex, shape (n,)
        A/v, and the integrand at ρ = 0 times the weights of the quadrature.
    """

    static: complex
    a: ComplexArray
    weights: ComplexArray

    @classmethod
    def make(cls, v: float, c: float, m: int, points: int) -> _Path:
        """Return the path with the given number of points per panel."""
        k_0 = _static_wave(c)
        g, s = _path_parameters(v, c, m, k_0)
        x, widths = _panels(v, c, g, points)
        k = x + 1j * s * (np.sin(x) + g)
        A = onsite(k, c)
        a = A / v
        weights: ComplexArray = widths * (1.0 + 1j * s * np.cos(x)) * np.exp(1j * k * (m + 1.0))
        weights /= 4.0 * math.pi * A * -np.expm1(1j * k - a)
        wave = np.exp(1j * k_0)
        static = wave ** abs(m + 1) / (1.0 + wave)
        if m < -1:
            static = 1.0 - wave * static
        if s * (math.sin(k_0.real) + g) > k_0.imag:
            static -= wave ** (m + 1) / (1.0 + wave)
        return cls(complex(static), a, weights)

    def at(self, rho: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return φ/φ_s and its derivative by ζ at distances ρ before the next site, shape (n,)."""
        value = np.empty((2, rho.size), dtype=complex)
        both = np.stack([self.weights, self.weights * self.a])
        rows = max(1, _AT_ONCE // self.a.size)
        for first in range(0, rho.size, rows):
            some = slice(first, first + rows)
            value[:, some] = both @ np.exp(np.outer(-self.a, rho[some]))
        return self.static - value[0], -value[1]

    def spread(self, rho: FloatArray) -> FloatArray:
        """Bound the change of φ/φ_s over pairs of ρ, shape (2, n), and its distance from a chord.

        The two bounds are returned as rows. Each exponential is bounded by its slope and its
        curvature, respectively, or by twice its modulus where that is less.
        """
        size, abs_a = np.abs(self.weights), np.abs(self.a)
        bounds = np.empty(rho.shape)
        rows = max(1, _AT_ONCE // self.a.size)
        for first in range(0, rho.shape[1], rows):
            some = slice(first, first + rows)
            low, high = rho[0, some], rho[1, some]
            largest = np.exp(np.maximum(*(np.outer(-self.a.real, end) for end in (low, high))))
            largest *= size[:, None]
            angle = np.outer(abs_a, np.abs(high - low))
            bounds[0, some] = np.einsum("ij,ij->j", largest, np.minimum(angle, 2.0))
            bounds[1, some] = np.einsum("ij,ij->j", largest, np.minimum(0.125 * angle**2, 2.0))
        return bounds


@dataclass(frozen=True)
class NearShape:
    """The front φ(ζ)/φ_s of either direction within a few sites of ζ = 0.

    The shape of a retreating front is 1 - φ(-ζ), where φ is the shape of the advancing one.

    Attributes
    ----------
    v, c : float
        Front velocity v̂, of either sign, and coupling.
    """

    v: float
    c: float
    _paths: dict[int, tuple[_Path, float]] = field(default_factory=dict, compare=False)

    def with_slope(self, zeta: FloatArray) -> tuple[ComplexArray, ComplexArray]:
        """Return φ/φ_s and its derivative at ζ, shape (n,); at ζ = 0 the derivative just ahead."""
        phi: ComplexArray = np.empty(zeta.shape, dtype=complex)
        slope = np.empty_like(phi)
        m, rho = self._sites(zeta, zeta)
        for site in np.unique(m).tolist():
            some = m == site
            phi[some], slope[some] = self._path(site)[0].at(rho[some])
        if self.v < 0:
            phi = 1.0 - phi
        return phi, slope

    def spread(self, ends: FloatArray) -> FloatArray:
        """Bound the change of φ/φ_s between pairs of ζ within one site, shape (2, n).

        The second row returned bounds its distance from the chord.
        """
        bounds = np.empty(ends.shape)
        m, rho = self._sites(ends.mean(axis=0), ends)
        for site in np.unique(m).tolist():
            some = m == site
            bounds[:, some] = self._path(site)[0].spread(rho[:, some])
        return bounds

    def error(self, zeta: FloatArray) -> FloatArray:
        """Estimate the error of φ/φ_s at ζ, shape (n,), as the change on adding half the points."""
        m = self._sites(zeta, zeta)[0]
        sites, which = np.unique(m, return_inverse=True)
        return np.array([self._path(site)[1] for site in sites.tolist()])[which]

    def _sites(self, zeta: FloatArray, ends: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return m at ζ and, relative to it, ρ at ``ends``, both for the advancing front."""
        if self.v < 0:
            m = np.ceil(-zeta) - 1.0
            return m, (m + 1.0) + ends
        m = np.floor(zeta)
        return m, (m + 1.0) - ends

    def _path(self, m: float) -> tuple[_Path, float]:
        """Return the path of one m and the error of its values."""
        site = int(m)
        if site not in self._paths:
            self._paths[site] = _accurate_path(abs(self.v), self.c, site)
        return self._paths[site]


def _accurate_path(v: float, c: float, m: int) -> tuple[_Path, float]:
    """Increase the number of points by half until the values settle; return the last change too."""
    rho = np.append(0.0, np.geomspace(min(0.5, v / c), 1.0, 6))
    points = _POINTS
    path = _Path.make(v, c, m, points)
    while True:
        points += points // 2
        coarse, path = path, _Path.make(v, c, m, points)
        error = float(np.abs(path.at(rho)[0] - coarse.at(rho)[0]).max())
        if error < _TOLERANCE or points >= _MAX_POINTS:
            return path, error


def _static_wave(c: float) -> complex:
    """Return k₀, the zero of A = ½ - 2ic sin²(k/2) above the axis."""
    k = 2.0 * np.arcsin(np.sqrt(-0.25j / c))
    return complex(k if k.imag > 0 else -k)


def _path_parameters(v: float, c: float, m: int, k_0: complex) -> tuple[float, float]:
    """Return g and s such that |e^{ik(m+1)}| stays moderate and the path does not come near k₀."""
    g = v / c if v * v > 4.0 * c else 0.0
    s = min(1.0, 4.0 / ((1.0 + abs(m + 1)) * (1.0 + g)), 1.0 / g if g else c / v**2)
    rise = math.sin(k_0.real) + g
    if s * rise < 2.0 * k_0.imag and rise > 0.0:
        s = min(s, 0.5 * k_0.imag / rise)
    return g, s


def _panels(v: float, c: float, g: float, points: int) -> tuple[FloatArray, FloatArray]:
    """Return the quadrature points Re k of a period, and their weights."""
    first = -math.asin(min(g, 1.0))
    second = math.pi - first if g < 1.0 else first + math.pi
    inner = min(1.0, math.sqrt(0.5 / c), _pole_distance(v, c, first))
    outer = min(1.0, math.sqrt(v / c), _pole_distance(v, c, second))
    edges = np.concatenate(
        [
            first + _graded(0.5 * (second - first), inner),
            second - _graded(0.5 * (second - first), outer)[::-1],
            second + _graded(0.5 * (first + 2.0 * math.pi - second), outer),
            first + 2.0 * math.pi - _graded(0.5 * (first + 2.0 * math.pi - second), inner)[::-1],
        ]
    )
    nodes, weights = _gauss(points)
    half, middle = 0.5 * np.diff(edges), 0.5 * (edges[1:] + edges[:-1])
    nonempty = half > 0.0
    x = middle[nonempty, None] + half[nonempty, None] * nodes
    return x.ravel(), np.outer(half[nonempty], weights).ravel()


@lru_cache(maxsize=8)
def _gauss(points: int) -> tuple[FloatArray, FloatArray]:
    """Return nodes and weights of a panel from -1 to 1."""
    nodes, weights = np.polynomial.legendre.leggauss(points)
    return nodes, weights


def _pole_distance(v: float, c: float, k: float) -> float:
    """Return the approximate distance of the nearest zero of 1 - e^{ik-a} from real k.

    It is very small where a saddle point is in resonance, k + (2c/v) sin²(k/2) = 2πn.
    """
    value = abs(np.expm1(1j * k - onsite(np.array(k + 0j), c) / v))
    slope, curvature = abs(1.0 + c / v * math.sin(k)), abs(c / v * math.cos(k))
    return float(2.0 * value / (slope + math.sqrt(slope**2 + 2.0 * curvature * value)))


def _graded(length: float, shortest: float) -> FloatArray:
    """Return 0, …, length, each panel as long as all before it."""
    panels = max(1, math.ceil(math.log2(length / shortest)) + 1)
    return np.append(0.0, length * 2.0 ** -np.arange(panels - 1.0, -1.0, -1.0))
