"""The periodised integral on a contour with equally many points on every scale of k.

The points follow tan(k/2) = e^{σ + iπ/4}, equispaced in σ. This contour leaves the real axis on the
side where Re A grows.

The poles of the integrand lie near Im σ = ±π/4 or farther off, so the trapezoidal rule with step h
errs by a multiple of e^{-π²/2h}. As v → ∞ they gather at k = i∞, with the residues of both
half-planes, -2 in all, and the multiple tends to 2. It was never seen above 2.02: an observation,
not a proof (``tests/test_theory_sums.py`` repeats it), and the bound charges twice as much at
least. What is left out at the ends is bounded by proof.

One pole of the integrand can come near it, or lie between it and the axis: minus a root below the
axis whose Re k is near -2c/v, where such roots turn away from the axis. By residues, a pole at σ_p
that belongs above the path makes the trapezoidal rule with step h wrong by

    t/(e^{-2πiσ_p/h} - 1),   t = 1/(k L_k) at that root,

wherever it lies, and this is taken away. Without it the rule converges geometrically to a wrong
number once the contour has passed the pole (v = 159.8, c = 214.9 is a case).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from theory.piecewise.dispersion import ComplexArray, FloatArray, dispersion_slope
from theory.piecewise.roots import labelled_roots

_MARGIN = 3.2
"""The step leaves e^{-3.2} of the tolerance for e^{-π²/2h}, of which up to 16 times is charged."""
_END = 1.4
"""The reach leaves about 0.16 of the tolerance for each end."""
_SLOWEST = 0.01
_CHUNK = 1 << 13
_EPS = float(np.finfo(float).eps)
_Number = TypeVar("_Number", np.float64, np.complex128)


@dataclass(frozen=True)
class GradedSum:
    """Trapezoidal sums on the contour, for n pairs (v, c).

    Attributes
    ----------
    sums : ndarray of complex, shape (1, n) or (3, n)
        (1/2π)∫G dk, and if asked for its derivatives by v and c.
    truncation : ndarray of float, shape (n,)
        Estimate that bounds the truncation of the first row.
    size : ndarray of float, shape (n,)
        Sum of the moduli of what was added up, for the rounding.
    points : int
        Points of the rule.
    """

    sums: ComplexArray
    truncation: FloatArray
    size: FloatArray
    points: int


@dataclass(frozen=True)
class GradedRule:
    """Points of the rule: ``left`` steps on the side of k = 0, ``right`` on that of k = π."""

    step: float
    left: int
    right: int

    @property
    def discretisation(self) -> float:
        """e^{-π²/2h}, the unit of the error at step h."""
        return math.exp(-0.5 * math.pi**2 / self.step)

    def ends(self, v: FloatArray, c: FloatArray) -> FloatArray:
        """Bound what the points left out would add.

        Beyond the last point |S| ≤ coth((½ - v y)/2v) with y = Im k ≤ √2 e^{-R} there, and 2A is at
        least 1 on the left and (1 - 4ic)/(1 + e^{-4R}) on the right; |sech| < 2e^{-|σ|}.
        """
        total = np.zeros(v.shape)
        for count, size in ((self.left, 1.0), (self.right, np.hypot(1.0, 4.0 * c))):
            decay = math.exp(-count * self.step)
            gap = 0.5 - math.sqrt(2.0) * decay * v
            total += 0.64 * decay / (np.tanh(0.5 * gap / v) * size)  # 0.64 > (2/π)(1 + e^{-4R})
        return total


def graded_rule(v: FloatArray, c: FloatArray, tolerance: float) -> GradedRule:
    """Return the points that give the tolerance at every (v, c).

    The step depends on the whole digits of the tolerance only, and the reach goes in leaps of four
    steps, so that the points are seldom computed anew.
    """
    wanted = math.log(10.0) * math.ceil(-math.log10(tolerance) - 1e-9)
    step = 0.5 * math.pi**2 / (wanted + _MARGIN)
    scale = np.log(4.0 * np.maximum(v, 0.25))
    left = float(scale.max()) + wanted + _END
    # The right end is smaller by |1 - 4ic|; but it must lie where the bound of the ends holds.
    right = float(np.max(scale + np.maximum(wanted - np.log(np.hypot(1.0, 4.0 * c)), 0.0))) + _END
    return GradedRule(step, 4 * math.ceil(left / step / 4.0), 4 * math.ceil(right / step / 4.0))


def graded_sum(v: FloatArray, c: FloatArray, tolerance: float, slopes: bool) -> GradedSum:
    """Return the integral of ``theory.piecewise.sums.integral`` on the graded contour.

    For the step, 4e^{-π²/2h} is charged, or four times the square of the difference between steps h
    and 2h if that is more: geometric convergence squares the error when the step is halved. That
    difference alone would be no bound, as it can be small by accident.

    Parameters
    ----------
    v, c : ndarray of float, shape (n,)
        Front velocity v̂ and coupling, dimensionless.
    tolerance : float
        Truncation error wanted.
    slopes : bool
        Also return the derivatives, with points for two digits more: at the same points v ∂Σ/∂v is
        some ten times less exact than Σ.
    """
    rule = graded_rule(v, c, max(0.01 * tolerance, 1e-15) if slopes else tolerance)
    count = rule.left + 1 + rule.right
    rows = max(1, _CHUNK // count)
    parts = [
        _trapezoidal(v[i : i + rows, None], c[i : i + rows, None], rule, slopes)
        for i in range(0, v.size, rows)
    ]
    sums, coarse, size = (np.concatenate(each, axis=-1) for each in zip(*parts, strict=True))
    poles = _departing_poles(v, c)
    sums[0] += poles.correction(rule.step)
    coarse += poles.correction(2.0 * rule.step)
    if slopes:
        sums[1:] += poles.correction_slopes(rule.step)
    off = np.maximum(np.abs(coarse - sums[0]) ** 2, rule.discretisation)
    truncation = 4.0 * off + rule.ends(v, c) + poles.uncertainty(rule.step)
    size += np.abs(poles.total(np.abs(poles.residue)))
    return GradedSum(sums, truncation, size, count)


def _trapezoidal(
    v: FloatArray, c: FloatArray, rule: GradedRule, slopes: bool
) -> tuple[ComplexArray, ComplexArray, FloatArray]:
    """Return the sums for columns v and c, that of the value with twice the step, and its size."""
    X, near, weight = _points(rule)
    right = slice(rule.left + 1, None)
    A = 0.5 - 2j * c * X
    F = -np.expm1(-A / v)
    E = 1.0 - F
    P = 1.0 + E
    square = F * F
    square[:, right] = P[:, right] ** 2
    D = square + (4.0 * near) * E  # F² + 4XE = (1 + E)² - 4(1 - X)E, without cancellation
    S = F * P / D
    G: npt.NDArray[np.complex128] = S / (2.0 * A)
    rows = [weighted(G, weight)]
    if slopes:
        square[:, : right.start] *= -1.0
        S_a = 2.0 * E * (square + 2.0 * near * (1.0 + E * E)) / (D * D)
        rows.append(weighted(S_a, weight) * (-0.5 / v[:, 0] ** 2))
        rows.append(weighted((S_a / v - S / A) * (-1j * X / A), weight))
    sums: ComplexArray = np.stack(rows)
    coarse: ComplexArray = 2.0 * weighted(G[:, ::2], weight[::2])
    return sums, coarse, weighted(np.abs(G), np.abs(weight))


def weighted(rows: npt.NDArray[_Number], weight: npt.NDArray[Any]) -> npt.NDArray[_Number]:
    """Return rows · weight, shape (n,); not by BLAS, whose threads cost more than they give."""
    result: npt.NDArray[_Number] = np.einsum("ij,j->i", rows, weight)
    return result


@lru_cache(maxsize=64)
def _points(rule: GradedRule) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Return X = T²/(1 + T²) at T = e^{σ + iπ/4}; X for σ ≤ 0 and X - 1 beyond; and the weights."""
    sigma = rule.step * np.arange(-rule.left, rule.right + 1)  # every other one includes σ = 0
    square = 1j * np.exp(-2.0 * np.abs(sigma))
    X = np.where(sigma > 0, 1.0 / (1.0 - square), square / (1.0 + square))
    near = np.where(sigma > 0, square / (1.0 - square), X)
    return X, near, (rule.step / np.pi) / np.cosh(sigma + 0.25j * np.pi)


@dataclass(frozen=True)
class _Poles:
    """Roots below the axis near Re k = -2c/v, for those of n scenes where they matter.

    ``here`` has shape (n,), the others shape (m, 3), m the number of such scenes.
    """

    here: npt.NDArray[np.bool_]
    v: FloatArray
    c: FloatArray
    k: ComplexArray

    @cached_property
    def slope(self) -> ComplexArray:
        """L_k."""
        return dispersion_slope(self.k, self.v, self.c)

    @cached_property
    def residue(self) -> ComplexArray:
        """The term 1/(k L_k) of the series."""
        term: ComplexArray = 1.0 / (self.k * self.slope)
        return term

    @cached_property
    def sigma(self) -> ComplexArray:
        """Where it is: log tan(-k/2) - iπ/4."""
        place: ComplexArray = np.log(np.tan(-0.5 * self.k)) - 0.25j * np.pi
        return place

    def weight(self, step: float) -> ComplexArray:
        """1/(e^{-2πiσ_p/h} - 1)."""
        weight: ComplexArray = 1.0 / np.expm1(-2j * np.pi / step * self.sigma)
        return weight

    def total(self, each: ComplexArray | FloatArray) -> ComplexArray:
        """Sum over the three roots; zero where there are none. Shape (n,)."""
        result = np.zeros(self.here.shape, dtype=complex)
        result[self.here] = each.sum(axis=1)
        return result

    def correction(self, step: float) -> ComplexArray:
        return self.total(self.residue * self.weight(step))

    def uncertainty(self, step: float) -> FloatArray:
        """Bound what rounding of the pole does, here and in the integrand beside it.

        The root is uncertain by the rounding of v k over L_k, σ_p by that over |sin k|. The sum of
        |t| h/|σ_j - σ_p|² over the points is what a shift of the pole does to the integrand.
        """
        slope, weight = np.abs(self.slope), np.abs(self.weight(step))
        sigma = self.sigma
        k_shift = 16.0 * _EPS * np.abs(self.k) * (1.0 + self.v / slope)
        beside = np.pi / np.hypot(sigma.imag, step) + 2.0 * np.pi / step * weight * (1.0 + weight)
        shift = beside / np.abs(np.sin(self.k)) + weight * self.c / slope
        return self.total(np.abs(self.residue) * k_shift * shift).real

    def correction_slopes(self, step: float) -> ComplexArray:
        """Return its derivatives by v and c, through the root: L_k dk = -dL. Shape (2, n)."""
        k, slope, weight = self.k, self.slope, self.weight(step)
        sine, cosine = np.sin(k), np.cos(k)

        def through(k_shift: ComplexArray, slope_shift: ComplexArray) -> ComplexArray:
            slope_change = slope_shift - 1j * self.c * cosine * k_shift
            residue_change = -self.residue * (k_shift / k + slope_change / slope)
            weight_change = weight * (1.0 + weight) * (2j * np.pi / step) * k_shift / sine
            return self.total(residue_change * weight + self.residue * weight_change)

        by_v = through(1j * k / slope, np.full(k.shape, -1j))
        return np.stack([by_v, through(1j * (1.0 - cosine) / slope, -1j * sine)])


def departing_labels(v: FloatArray, c: FloatArray) -> npt.NDArray[np.int64]:
    """Return the labels of the three roots below the axis nearest Re k = -2c/v, shape (n, 3)."""
    crossing = -(c / v) * (1.0 + np.cosh(np.minimum(0.5 / v, 30.0)))
    nearest = np.maximum(np.floor(crossing / (2.0 * np.pi)), -1e12)
    middle: npt.NDArray[np.int64] = np.minimum(nearest, -2.0).astype(np.int64)
    labels: npt.NDArray[np.int64] = middle[:, None] + np.array([-1, 0, 1], dtype=np.int64)
    return labels


def _departing_poles(v: FloatArray, c: FloatArray) -> _Poles:
    """Return the three roots below the axis whose strips are nearest Re k = -2c/v.

    The one in the strip (2πn, 2πn + 2π) leaves as its Re k passes (2n + 1)π, when
    v (2|n| - 1)π = c (1 + cosh(1/2v)) (fact 4 of ``theory.piecewise.dispersion``). For v > 6c all
    are too far from the contour to matter. For v < `_SLOWEST` the integrand is 1/(2A) to double
    precision, since Re A ≥ ½ on the contour and so |E| ≤ e^{-1/2v}; that has none of these poles.
    """
    here = (v < 6.0 * c) & (v > _SLOWEST)
    v_, c_ = np.repeat(v[here, None], 3, axis=1), np.repeat(c[here, None], 3, axis=1)
    labels = departing_labels(v[here], c[here])
    k = labelled_roots(v_.ravel(), c_.ravel(), labels.ravel(), upper=False).k
    return _Poles(here, v_, c_, k.reshape(labels.shape))
