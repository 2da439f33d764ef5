"""The periodised integral on a contour with equally many points on every scale of k.

The points follow tan(k/2) = e^{σ + iπ/4}, equispaced in σ. This contour leaves the real axis on the
side where Re A grows, and some 700 points do for all v and c.

One pole of the integrand can come near it, or lie between it and the axis: minus a root below the
axis whose Re k is near -2c/v, where such roots turn away from the axis. By residues, a pole at σ_p
that belongs above the path makes the trapezoidal rule with step h wrong by

    t/(e^{-2πiσ_p/h} - 1),   t = 1/(k L_k) at that root,

wherever it lies, and this is taken away. Without it the rule converges geometrically to a wrong
number once the contour has passed the pole (v = 159.8, c = 214.9 is a case).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

from theory.dispersion import ComplexArray, FloatArray, dispersion_slope
from theory.roots import labelled_roots

STEP = 0.12
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


def graded_sum(v: FloatArray, c: FloatArray, slopes: bool) -> GradedSum:
    """Return the integral of ``theory.sum_integral`` on the graded contour.

    Geometric convergence squares the error when the step is halved, so the error at step h is
    about the square of the difference between steps h and 2h; 100 times that is charged.

    Parameters
    ----------
    v, c : ndarray of float, shape (n,)
        Front velocity v̂ and coupling, dimensionless.
    slopes : bool
        Also return the derivatives.
    """
    reach = 37.0 + max(0.0, float(np.log(4.0 * v.max())))
    X, weight = _points(round(reach / STEP))
    v_, c_ = v[:, None], c[:, None]
    A = 0.5 - 2j * c_ * X
    F = -np.expm1(-A / v_)
    E = 1.0 - F
    D = F * F + (4.0 * X) * E
    S = F * (1.0 + E) / D
    G = S / (2.0 * A)
    poles = _departing_poles(v, c)
    sums = np.empty((3 if slopes else 1, v.size), dtype=complex)
    sums[0] = weighted(G, weight) + poles.correction(STEP)
    if slopes:
        S_a = 2.0 * E * (2.0 * X * (1.0 + E * E) - F * F) / (D * D)
        by_v, by_c = poles.correction_slopes(STEP)
        sums[1] = weighted(S_a, weight) * (-0.5 / v**2) + by_v
        sums[2] = weighted((S_a / v_ - S / A) * (-1j * X / A), weight) + by_c
    coarse = 2.0 * weighted(G[:, ::2], weight[::2]) + poles.correction(2.0 * STEP)
    truncation = 100.0 * np.abs(coarse - sums[0]) ** 2 + poles.uncertainty(STEP)
    size = weighted(np.abs(G), np.abs(weight)) + np.abs(poles.total(np.abs(poles.residue)))
    return GradedSum(sums, truncation, size, X.size)


def weighted(rows: npt.NDArray[_Number], weight: npt.NDArray[Any]) -> npt.NDArray[_Number]:
    """Return rows · weight, shape (n,); not by BLAS, whose threads cost more than they give."""
    result: npt.NDArray[_Number] = np.einsum("ij,j->i", rows, weight)
    return result


@lru_cache(maxsize=16)
def _points(reach: int) -> tuple[ComplexArray, ComplexArray]:
    """Return sin²(k/2) = T²/(1 + T²) at T = e^{σ + iπ/4}, and weights h sech(σ + iπ/4)/π."""
    reach += reach % 2  # so that every other point includes the middle one
    sigma = STEP * np.arange(-reach, reach + 1)
    square = 1j * np.exp(-2.0 * np.abs(sigma))
    X = np.where(sigma > 0, 1.0 / (1.0 - square), square / (1.0 + square))
    return X, (STEP / np.pi) / np.cosh(sigma + 0.25j * np.pi)


@dataclass(frozen=True)
class _Poles:
    """Roots below the axis near Re k = -2c/v, for those of n scenes where they matter.

    ``here`` has shape (n,), the others shape (m, 3), m the number of such scenes.
    """

    here: npt.NDArray[np.bool_]
    v: FloatArray
    c: FloatArray
    k: ComplexArray

    @property
    def slope(self) -> ComplexArray:
        """L_k."""
        return dispersion_slope(self.k, self.v, self.c)

    @property
    def residue(self) -> ComplexArray:
        """The term 1/(k L_k) of the series."""
        term: ComplexArray = 1.0 / (self.k * self.slope)
        return term

    def weight(self, step: float) -> ComplexArray:
        """1/(e^{-2πiσ_p/h} - 1), σ_p = log tan(-k/2) - iπ/4."""
        sigma = np.log(np.tan(-0.5 * self.k)) - 0.25j * np.pi
        weight: ComplexArray = 1.0 / np.expm1(-2j * np.pi / step * sigma)
        return weight

    def total(self, each: ComplexArray | FloatArray) -> ComplexArray:
        """Sum over the three roots; zero where there are none. Shape (n,)."""
        result = np.zeros(self.here.shape, dtype=complex)
        result[self.here] = each.sum(axis=1)
        return result

    def correction(self, step: float) -> ComplexArray:
        return self.total(self.residue * self.weight(step))

    def uncertainty(self, step: float) -> FloatArray:
        """Bound what rounding of σ_p, and of the integrand beside it, does when a point is near."""
        weight = np.abs(self.weight(step))
        near = np.abs(self.residue) * weight * (1.0 + weight) * (2.0 * np.pi / step)
        return 128.0 * float(np.finfo(float).eps) * self.total(near).real

    def correction_slopes(self, step: float) -> tuple[ComplexArray, ComplexArray]:
        """Return its derivatives by v and c, through the root: L_k dk = -dL."""
        k, slope, weight = self.k, self.slope, self.weight(step)
        sine, cosine = np.sin(k), np.cos(k)

        def through(k_shift: ComplexArray, slope_shift: ComplexArray) -> ComplexArray:
            slope_change = slope_shift - 1j * self.c * cosine * k_shift
            residue_change = -self.residue * (k_shift / k + slope_change / slope)
            weight_change = weight * (1.0 + weight) * (2j * np.pi / step) * k_shift / sine
            return self.total(residue_change * weight + self.residue * weight_change)

        by_v = through(1j * k / slope, np.full(k.shape, -1j))
        return by_v, through(1j * (1.0 - cosine) / slope, -1j * sine)


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
    v (2|n| - 1)π = c (1 + cosh(1/2v)) (fact 4 of ``theory.dispersion``). For v > 4c all are too far
    from the contour to matter.
    """
    here = v < 4.0 * c
    v_, c_ = np.repeat(v[here, None], 3, axis=1), np.repeat(c[here, None], 3, axis=1)
    labels = departing_labels(v[here], c[here])
    k = labelled_roots(v_.ravel(), c_.ravel(), labels.ravel(), upper=False).k
    return _Poles(here, v_, c_, k.reshape(labels.shape))
