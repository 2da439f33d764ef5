"""Σ(v, c) as one integral over a period, by the trapezoidal rule: fast, vectorised, any v and c.

Summing the real-line integral -1 + (v/π)∫₀^∞ dk/(A² + v²k²) over all periods of A in closed form,

    Σ(v, c) = -1 + (1/2π) ∫_{-π}^{π} G dk,   G = [1/(2A)] sinh a/(cosh a - cos k),   a = A/v.

With X = sin²(k/2), A = ½ - 2icX, E = e^{-a}, F = 1 - E this is free of overflow and cancellation:

    sinh a/(cosh a - cos k) = F (2 - F)/[F² + 4X(1 - F)].

Two sets of points serve all scenes. Equispaced points converge like e^{-Ns} in the root-free strip
|Im k| < s of ``theory.piecewise.dispersion``, and have a bound known beforehand. Where the strip is
narrow (large v or c) ``theory.piecewise.sums.graded_contour`` takes over.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from time import perf_counter

import numpy as np
import numpy.typing as npt

from theory.parameters import within
from theory.piecewise.dispersion import ComplexArray, FloatArray
from theory.piecewise.roots import checked_velocity_and_coupling
from theory.piecewise.sums.graded_contour import graded_sum, weighted
from theory.piecewise.sums.result import KineticSum

_EPS = float(np.finfo(float).eps)
_CHUNK = 1 << 13
_GRADED_CHUNK = 256
_PARTS = np.array([[0.75], [0.88], [0.95]])  # of the strip, on which G is bounded


@dataclass(frozen=True)
class SumArray:
    """Σ at many (v, c), with derivatives.

    Attributes
    ----------
    value : ndarray of complex
        Σ(v, c), shape of the broadcast v and c.
    error : ndarray of float
        Bound on the error of ``value``.
    by_v, by_c : ndarray of complex or None
        ∂Σ/∂v and ∂Σ/∂c, if asked for.
    points : ndarray of int
        Points of the trapezoidal rule at which the integrand was evaluated.
    """

    value: ComplexArray
    error: FloatArray
    by_v: ComplexArray | None
    by_c: ComplexArray | None
    points: npt.NDArray[np.int64]


def sum_by_integral(v: float, c: float, tolerance: float = 1e-13) -> KineticSum:
    """Return Σ(v, c) of Eq. (53) by the periodised integral.

    Parameters
    ----------
    v, c : float
        Front velocity v̂ and coupling, dimensionless, from 1e-12 to 1e12.
    tolerance : float
        Error wanted, from 1e-15 to 0.1; the error bound is its truncation plus rounding.

    Raises
    ------
    ParameterError
        If a parameter is out of range.

    Examples
    --------
    >>> result = sum_by_integral(0.3, 0.5)
    >>> bool(abs(result.value - (-0.28879675619025+0.45226875874939j)) < 1e-13)
    True
    """
    start = perf_counter()
    v, c = checked_velocity_and_coupling(v, c)
    many = sums(np.array([v]), np.array([c]), tolerance)
    seconds = perf_counter() - start
    value, error = complex(many.value[0]), float(many.error[0])
    return KineticSum(
        value=value, error=error, terms=int(many.points[0]), method="integral", seconds=seconds
    )


def sums(
    v: npt.ArrayLike, c: npt.ArrayLike, tolerance: float = 1e-13, slopes: bool = False
) -> SumArray:
    """Return Σ(v, c) for arrays of v and c, broadcast together.

    Parameters
    ----------
    v, c : array_like of float
        Positive; not checked one by one.
    tolerance : float
        Truncation error wanted, from 1e-15 to 0.1. Points are spent accordingly.
    slopes : bool
        Also return ∂Σ/∂v and ∂Σ/∂c.

    Raises
    ------
    ParameterError
        If the tolerance is out of range.
    """
    within("tolerance", tolerance, 1e-15, 0.1)
    v_, c_ = np.broadcast_arrays(np.asarray(v, dtype=float), np.asarray(c, dtype=float))
    shape = v_.shape
    v_, c_ = v_.ravel(), c_.ravel()
    points, bound = equispaced_points(v_, c_, tolerance)
    parts = 3 if slopes else 1
    values = np.empty((parts, v_.size), dtype=complex)
    error = np.empty(v_.size)
    used = np.empty(v_.size, dtype=np.int64)
    for count in np.unique(points):
        members = np.flatnonzero(points == count)
        size = max(1, _CHUNK // int(count)) if count else _GRADED_CHUNK
        for begin in range(0, members.size, size):
            some = members[begin : begin + size]
            v_some, c_some = v_[some], c_[some]
            if count:
                found = _equispaced(v_some, c_some, int(count), parts)
            else:
                found = _graded(v_some, c_some, tolerance, parts)
            values[:, some], error[some], used[some] = found
    error += np.where(points > 0, bound, 0.0)

    def shaped(array: ComplexArray) -> ComplexArray:
        return array.reshape(shape)

    return SumArray(
        shaped(values[0]) - 1.0,
        error.reshape(shape),
        shaped(values[1]) if slopes else None,
        shaped(values[2]) if slopes else None,
        used.reshape(shape),
    )


def equispaced_points(
    v: FloatArray, c: FloatArray, tolerance: float
) -> tuple[npt.NDArray[np.int64], FloatArray]:
    """Return the number N of equispaced points for a tolerance, and the bound they give.

    On |Im k| ≤ σ < s both Re A ≥ ½ - c sinh σ and Re(a ± ik) ≥ d/v with
    d = ½ - c sinh σ - vσ > 0, and sinh a/(cosh a - cos k) is the mean of coth((a ± ik)/2). So
    |G| ≤ M = coth(d/2v)/(1 - 2c sinh σ), and the trapezoidal rule errs by less than
    2M/(e^{Nσ} - 1). N is rounded up so that arrays fall into few groups; 0 where the other
    contour is faster, which needs points in proportion to the square of the digits.
    """
    strip = np.minimum(0.5 / (c + v), np.arcsinh(0.5 / c))
    for _ in range(4):  # from above, to within 0.03 per cent
        strip -= (c * np.sinh(strip) + v * strip - 0.5) / (c * np.cosh(strip) + v)
    sigma = _PARTS * strip
    gap = 0.5 - c * np.sinh(sigma)
    peak = 1.0 / (np.tanh(0.5 * (gap - v * sigma) / v) * 2.0 * gap)
    needed = np.log1p(2.0 * peak / tolerance) / sigma
    fewest = needed.argmin(axis=0), np.arange(v.size)
    best = needed[fewest]
    plain = best <= 100.0 + 1.3 * (4.0 - np.log(tolerance)) ** 2  # equal times, measured
    best = np.where(plain, best, 4.0)
    octave = 2.0 ** np.floor(np.log2(best))
    count = octave * np.ceil(4.0 * best / octave) / 4.0  # eighths, sixths … of a power of two
    count = np.maximum(8.0, 2.0 * np.ceil(count / 2.0))
    with np.errstate(over="ignore"):
        bound = np.where(plain, 2.0 * peak[fewest] / np.expm1(count * sigma[fewest]), 0.0)
    return np.where(plain, count, 0.0).astype(np.int64), bound


def _equispaced(
    v: FloatArray, c: FloatArray, count: int, parts: int
) -> tuple[ComplexArray, FloatArray, int]:
    """Return the mean of [G, ∂G/∂v, ∂G/∂c][:parts] over equispaced points of the real axis.

    With e = e^{-1/2v} and ψ = 2cX/v, multiplying by 2e throughout: sinh a → P - iQ and
    cosh a - cos k → U - iW. All real, since real arithmetic is what costs here.
    """
    X, weight = _equispaced_points(count)
    v, c = v[:, None], c[:, None]
    decay, gap = np.exp(-0.5 / v), -np.expm1(-0.5 / v)
    odd, even = gap * (1.0 + decay), 1.0 + decay * decay
    half_phase = (c / v) * X
    sine, cosine = np.sin(half_phase), np.cos(half_phase)
    square = sine * sine
    cos_psi, sin_psi = 1.0 - 2.0 * square, 2.0 * sine * cosine
    P, Q, W = odd * cos_psi, even * sin_psi, odd * sin_psi
    U = gap * gap - 2.0 * even * square + 4.0 * decay * X
    kappa = 4.0 * c * X  # 2A = 1 - i kappa
    size = U * U + W * W
    scale = 1.0 / (size * (1.0 + kappa * kappa))
    up, across = P * U + Q * W, P * W - Q * U
    real, imaginary = (up - kappa * across) * scale, (across + kappa * up) * scale
    sums_ = np.empty((parts, v.size), dtype=complex)
    sums_[0].real, sums_[0].imag = weighted(real, weight), weighted(imaginary, weight)
    magnitude = weighted(np.sqrt(real * real + imaginary * imaginary), weight)
    if parts > 1:
        turn = even * (2.0 * X + 2.0 * square - 4.0 * X * square) - gap * gap
        numerator = 2.0 * decay * (turn + 1j * (1.0 - 2.0 * X) * W)  # of dS/da, times (U - iW)²
        S_a = numerator * ((U + 1j * W) / size) ** 2
        two_A = 1.0 - 1j * kappa
        S = (up + 1j * across) / size
        sums_[1] = weighted(S_a, weight) * (-0.5 / v[:, 0] ** 2)
        sums_[2] = weighted((S_a / v - 2.0 * S / two_A) * (-2j * X / two_A), weight)
    return sums_, rounding_bound(magnitude, v[:, 0], c[:, 0]), X.size


def _graded(
    v: FloatArray, c: FloatArray, tolerance: float, parts: int
) -> tuple[ComplexArray, FloatArray, int]:
    found = graded_sum(v, c, tolerance, slopes=parts > 1)
    return found.sums, found.truncation + rounding_bound(found.size, v, c), found.points


def rounding_bound(size: FloatArray, v: FloatArray, c: FloatArray) -> FloatArray:
    """Bound the rounding of a sum of |G|: E = e^{-a} carries the rounding of the phase of a."""
    phase = np.exp(-0.5 / v) * np.sqrt(1.0 + c / v)
    rounding: FloatArray = 8.0 * _EPS * (size + 1.0) * (1.0 + phase)
    return rounding


@lru_cache(maxsize=64)
def _equispaced_points(count: int) -> tuple[FloatArray, FloatArray]:
    """Return sin²(k/2) on half a period, and weights that sum to one."""
    half = np.arange(count // 2 + 1)
    weight = np.full(half.size, 2.0 / count)
    weight[[0, -1]] = 1.0 / count
    return np.sin(np.pi * half / count) ** 2, weight
