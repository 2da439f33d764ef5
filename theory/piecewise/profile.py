"""The shape φ(ζ) of the piecewise-linear front (Eq. 49), scaled by φ_s.

The contour integral from which (49) follows is periodised as in ``theory.piecewise.sums.integral``.
With ζ = m + f, m an integer and 0 ≤ f ≤ 1,

    φ/φ_s = -(1/4π) ∫ (e^{ikm}/A) [1/(1 - e^{-ik}) + e^{-a(1-f)} e^{ik}/(1 - e^{ik-a})] dk

over a period just above the real axis. With points midway between multiples of 2π/N, the pole at
k = 0 contributes exactly ½, and the trapezoidal rule converges like e^{-s(N - |m|)}, s being the
half-width of the root-free strip. At given f the values at all m form one Fourier transform.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from theory.arrays import EPS, ComplexArray, FloatArray, IntArray
from theory.parameters import ParameterError, Range, count_within, with_ranges, within
from theory.piecewise.dispersion import root_free_strip
from theory.piecewise.roots import checked_velocity_and_coupling, nearest_roots
from theory.piecewise.sums.result import PrecisionError
from theory.result import Result

MAX_POINTS = 1 << 21
TOLERANCES = Range(1e-14, 0.1)
_AT_ONCE = 1 << 18
"""Largest number of elements of an array in a sum that is computed in parts."""
_SMOOTH = np.unique([max(8, odd << power) for odd in (1, 3, 5, 9, 15) for power in range(1, 23)])
"""Even numbers with small prime factors, for which the Fourier transform is fast."""
_STEPS = 5
"""Number of Newton steps for the width of the root-free strip; the relative error is then 1e-7."""


@dataclass(frozen=True, kw_only=True)
class FrontShape(Result):
    """Values of the front's shape.

    Attributes
    ----------
    zeta : ndarray of float, shape (n,)
        Positions ζ = site - vT, in sites.
    phi : ndarray of complex, shape (n,)
        φ(ζ)/φ_s, dimensionless.
    error : float
        Bound on the error of every value.
    points : int
        Number of quadrature points, or of roots.
    """

    zeta: FloatArray = field(metadata={"axis": "zeta"})
    phi: ComplexArray = field(metadata={"dims": ("zeta",)})
    error: float
    points: int


@with_ranges(tolerances=TOLERANCES)
def front_profile(zeta: npt.ArrayLike, v: float, c: float, tolerance: float = 1e-12) -> FrontShape:
    """Return φ(ζ)/φ_s of Eq. (49) by the periodised integral.

    Parameters
    ----------
    zeta : array_like of float, shape (n,)
        Positions, in sites; finite.
    v, c : float
        Front velocity v̂ and coupling, dimensionless.
    tolerance : float
        Required error, {tolerances}.

    Raises
    ------
    ParameterError
        If a parameter is out of range.
    PrecisionError
        If more than two million points would be needed (v or c above some 10⁴).

    Examples
    --------
    >>> shape = front_profile([-40.0, 40.0], 0.3, 0.5)
    >>> bool(abs(shape.phi[0] - 1) < 1e-9 and abs(shape.phi[1]) < 1e-9)
    True
    """
    v, c = checked_velocity_and_coupling(v, c)
    within("tolerance", tolerance, *TOLERANCES)
    position = np.atleast_1d(np.asarray(zeta, dtype=float))
    if not np.all(np.isfinite(position)):
        raise ParameterError("position zeta", "nan or infinite", "finite", "give finite positions")
    if position.size == 0:
        return FrontShape(zeta=position, phi=np.empty(0, dtype=complex), error=0.0, points=0)
    grid = ProfileGrid.make(v, c, float(np.abs(np.floor(position)).max()) + 1.0, tolerance)
    phi = _on_equal_fractions(grid, position)
    if phi is None:
        phi = np.empty(position.shape, dtype=complex)
        rows = max(1, _AT_ONCE // grid.points)
        for begin in range(0, position.size, rows):
            some = slice(begin, begin + rows)
            phi[some] = grid.at(position[some])
    return FrontShape(zeta=position, phi=phi, error=grid.error, points=grid.points)


def _on_equal_fractions(grid: ProfileGrid, zeta: FloatArray) -> ComplexArray | None:
    """Return φ/φ_s if many positions have the same distance to the next site, else None.

    For the distinct sites and distances e^{ikm} and e^{-a(1 - f)} are computed once, and their
    products are summed as matrix products. Distances that differ by rounding are treated as equal,
    and the difference is corrected for to first order; its square is below 1e-18.
    """
    m = np.floor(zeta)
    distance = (m + 1.0) - zeta
    sites, row = np.unique(m, return_inverse=True)
    _, first, column = np.unique(np.round(distance, 12), return_index=True, return_inverse=True)
    deviation = distance - distance[first][column]
    largest_exponent = float(np.abs(deviation).max() * np.abs(grid.a).max())
    if sites.size * first.size > 2 * zeta.size or largest_exponent > 1e-9:
        return None
    total = np.zeros((2, sites.size, first.size), dtype=complex)
    width = max(1, _AT_ONCE // (sites.size + first.size))
    for begin in range(0, grid.points, width):
        part = slice(begin, begin + width)
        waves = grid.waves(sites, part)
        bracket = grid.bracket(distance[first], part)
        total[0] += waves @ bracket.T
        total[1] += waves @ ((grid.static[part] - bracket) * grid.a[part]).T
    phi: ComplexArray = total[0][row, column] + deviation * total[1][row, column]
    return 0.5 - phi / (2.0 * grid.points)


@dataclass(frozen=True)
class ProfileGrid:
    """The quadrature points for one or several fronts, and all quantities independent of ζ.

    Attributes
    ----------
    v, c : float, or ndarray of float, shape (n, 1)
        Front velocity v̂ and coupling.
    k : ndarray of float, shape (N,)
        Wave numbers 2π(j + ½)/N, between -π and π.
    a : ndarray of complex, shape (N,) or (n, N)
        A/v.
    static, late : ndarray of complex, shape (N,) or (n, N)
        The factor of e^{ikm} is static + late e^{-a(1 - f)}.
    error : float
        Bound on the error of values with |m| up to the required extent.
    """

    v: Any
    c: Any
    k: FloatArray
    a: ComplexArray
    static: ComplexArray
    late: ComplexArray
    error: float

    @property
    def points(self) -> int:
        """Number of points N."""
        return self.k.size

    @classmethod
    def make(cls, v: float, c: float, extent: float, tolerance: float) -> ProfileGrid:
        """Choose N such that the error of values with |m| ≤ ``extent`` is within the tolerance."""
        points, error = points_of_profile(v, c, extent, tolerance)
        return cls.of_points(v, c, points, error)

    @classmethod
    def of_points(cls, v: Any, c: Any, points: int, error: float) -> ProfileGrid:
        """Return the grid with this number of points, for numbers or for columns of v and c."""
        k, square, wave, static = _points_in_k(points)
        A = 0.5 - 1j * c * square
        a = A / v
        # 1 - e^{ik-a} = 1 - e^{-q} + 2e^{-q} sin²h - ie^{-q} sin 2h, q = Re a, h = Im (ik - a)/2
        q, turn = 0.5 / v, np.exp(0.5j * (k + (c / v) * square))
        late = wave / ((turn.imag * turn * (-2j * np.exp(-q)) - np.expm1(-q)) * A)
        return cls(v, c, k, a, static / A, late, error)

    def bracket(self, distance: FloatArray, part: slice = slice(None)) -> ComplexArray:
        """Return the factor of e^{ikm} for distances 1 - f to the next site, shape (n, N).

        The argument is the distance rather than f, whose rounding error would grow as 1/v.
        """
        factor: ComplexArray = np.exp(-self.a[part] * distance[:, None])
        factor *= self.late[part]
        factor += self.static[part]
        return factor

    def at(self, zeta: FloatArray) -> ComplexArray:
        """Return φ/φ_s at ζ, shape (n,)."""
        m = np.floor(zeta)
        return self.between(m, (m + 1.0) - zeta)

    def between(self, m: FloatArray, distance: FloatArray) -> ComplexArray:
        """Return φ/φ_s at a distance 0 ≤ ``distance`` ≤ 1 before the site m + 1, shape (n,)."""
        total: ComplexArray = np.sum(self.waves(m) * self.bracket(distance), axis=1)
        return 0.5 - total / (2.0 * self.points)

    def with_neighbours(
        self, zeta: FloatArray, front: IntArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """Return φ/φ_s at ζ, and the sum of its values at ζ ± 1, for the given front at each ζ."""
        m = np.floor(zeta)
        factor: ComplexArray = np.exp(-self.a[front] * ((m + 1.0) - zeta)[:, None])
        factor *= self.late[front]
        factor += self.static[front]
        factor *= self.waves(m)
        phi = 0.5 - np.sum(factor, axis=1) / (2.0 * self.points)
        return phi, 1.0 - factor @ np.cos(self.k) / self.points

    def waves(self, m: FloatArray, part: slice = slice(None)) -> ComplexArray:
        """Return e^{ikm}, shape (n, N)."""
        # k m modulo 2π is computed in integers: at m = 10⁴ the rounding of k m would be 10⁻¹².
        turns = np.outer(m.astype(np.int64), 2 * np.arange(self.points)[part] + 1)
        return _roots_of_unity(self.points)[turns % (2 * self.points)]

    def on_lattice(
        self, per_site: int, sites: tuple[int, int] | None = None
    ) -> tuple[FloatArray, ComplexArray]:
        """Return ζ and φ/φ_s at ``per_site`` points per site, by Fourier transform.

        ``sites`` gives the numbers of sites behind and ahead of ζ = 0, fewer than N/2; by default
        all |m| < N/2 are included. For several fronts, φ/φ_s has one row each.
        """
        points = self.points
        behind, ahead = sites or (points // 2, (points - 1) // 2)
        m = np.arange(-behind, ahead + 1)
        f = np.arange(per_site) / per_site
        # e^{-a(1 - f)} by repeated products, from the last point before the next site backwards
        shorter = np.exp(-self.a / per_site)
        factor = np.empty((*self.a.shape[:-1], per_site + 1, points), dtype=complex)
        factor[..., per_site, :] = self.static
        later = self.late
        for j in range(per_site - 1, -1, -1):
            later = np.multiply(later, shorter, out=factor[..., j, :])
        waves = np.fft.ifft(factor)[..., m % points]
        late, static = waves[..., :per_site, :], waves[..., per_site:, :]
        phi = 0.5 - 0.5 * np.exp(1j * np.pi * m / points) * (late + static)
        zeta = m[:, None] + f
        return zeta.ravel(), np.swapaxes(phi, -1, -2).reshape(*self.a.shape[:-1], -1)


def points_of_profile(v: float, c: float, extent: float, tolerance: float) -> tuple[int, float]:
    """Return N for which values with |m| ≤ ``extent`` err by at most the tolerance, and the bound.

    The N-point rule adds to the value at m those at m ± N, m ± 2N, … with alternating sign, their
    limits 1 and 0 subtracted, and |φ - limit| ≤ K e^{-σ|ζ|} (:func:`tail_bound`).

    Raises
    ------
    PrecisionError
        If more than two million points are needed.
    """
    (rate_behind, K_behind), (rate_ahead, K_ahead) = (
        tail_bound(v, c, ahead) for ahead in (False, True)
    )
    rate, prefactor = min(rate_behind, rate_ahead), max(K_behind, K_ahead)
    required = required_points(extent, tolerance, rate, prefactor)
    if required > MAX_POINTS:
        raise PrecisionError(
            f"the profile at v = {v:.6g}, c = {c:.6g} needs {required:.2g} quadrature points, "
            f"more than {MAX_POINTS}: take a smaller c."
        )
    points = int(smooth_number(max(required, 2 * math.ceil(extent) + 2)))
    truncation = 4.0 * prefactor * math.exp(-rate * (points - extent - 1.0))
    rounding = 8.0 * EPS * (4.0 + math.log(points)) * (1.0 + math.sqrt(1.0 + c / v))
    return points, truncation + rounding


def required_points(extent: Any, tolerance: float, rate: Any, prefactor: Any) -> Any:
    """Return the number of points for `points_of_profile`, for numbers or arrays of one shape.

    ``rate`` is the smaller σ of the two tails, and ``prefactor`` the larger K.
    """
    return extent + 1.0 + np.log(1.0 + 4.0 * prefactor / tolerance) / rate


def smooth_number(lower_bound: Any) -> Any:
    """Return the smallest fast even length of a transform, at least 8 and ``lower_bound``."""
    return _SMOOTH[np.searchsorted(_SMOOTH, lower_bound)]


@lru_cache(maxsize=32)
def _points_in_k(points: int) -> tuple[FloatArray, FloatArray, ComplexArray, ComplexArray]:
    """Return k, 1 - cos k, e^{ik} and 1/(1 - e^{-ik}), the last without cancellation."""
    # k runs from -π to π, so that its rounding error near the pole at k = 0 is relative.
    k = np.pi * _wrapped(2 * np.arange(points) + 1, points) / points
    return k, 2.0 * np.sin(0.5 * k) ** 2, np.exp(1j * k), 0.5 - 0.5j / np.tan(0.5 * k)


@lru_cache(maxsize=64)
def _roots_of_unity(points: int) -> ComplexArray:
    """Return e^{iπj/points} for j from 0 to twice the points."""
    table: ComplexArray = np.exp(1j * np.pi * _wrapped(np.arange(2 * points), points) / points)
    return table


def _wrapped(index: IntArray, points: int) -> IntArray:
    """Return integers modulo twice the points, from -points to points."""
    return (index + points) % (2 * points) - points


def tail_bound(v: Any, c: Any, ahead: bool) -> tuple[Any, Any]:
    """Return (σ, K) such that |φ/φ_s - limit| ≤ K e^{-σ|ζ|}: limit 0 ahead, 1 behind.

    K bounds (1/4π)∫ dk/(|k||L|) on the line Im k = ±σ, where |L| ≥ Re L ≥ d = ½ ± vσ - c sinh σ,
    and |L| ≥ v|x|/2 for x = Re k with |x| ≥ X = (2c (1 + cosh σ))/v.

    Parameters
    ----------
    v, c : float, or ndarray of float, shape (n,)
        Front velocity v̂ and coupling, both numbers or both arrays.
    ahead : bool
        Whether the bound is for the tail ahead, at ζ > 0, or for that behind.
    """
    xp, maximum = (np, np.maximum) if isinstance(v, np.ndarray) else (math, max)
    rate = 0.85 * (_strip_ahead(v, c) if ahead else root_free_strip(v, c))
    d = 0.5 + (v if ahead else -v) * rate - c * xp.sinh(rate)
    X = maximum(1.0, 2.0 * c * (1.0 + xp.cosh(rate)) / v)
    K = (2.0 * xp.asinh(X / rate) / d + 4.0 / (v * X)) / (4.0 * math.pi)
    return rate, K


def _strip_ahead(v: Any, c: Any) -> Any:
    """Return s with c sinh s - v s = ½; no root has 0 < Im k < s.

    As the function is convex, Newton's method converges to s from above. It starts from the smaller
    of two upper bounds, one from sinh s ≥ s + s³/6 and one from the exponential, improved by the
    fixed-point iteration of sinh s = (½ + vs)/c.
    """
    xp, minimum = (np, np.minimum) if isinstance(v, np.ndarray) else (math, min)
    excess = (abs(v - c) + (v - c)) / c
    s = minimum(
        1.0 + 2.0 * xp.log1p((2.0 + 4.0 * v) / c),
        xp.sqrt(3.0 * excess) + (3.0 / c) ** (1.0 / 3.0),
    )
    for _ in range(2):
        s = xp.asinh((0.5 + v * s) / c)
    for _ in range(_STEPS):
        s = s - (c * xp.sinh(s) - v * s - 0.5) / (c * xp.cosh(s) - v)
    return s


def profile_slope(
    zeta: FloatArray, phi: ComplexArray, neighbours: ComplexArray, v: Any, c: Any
) -> ComplexArray:
    """Return dφ/dζ, divided by φ_s, from the advance–delay equation (48) itself.

    v φ' = ½φ - ½θ(-ζ) - (ic/2)[2φ - φ(ζ+1) - φ(ζ-1)].

    Parameters
    ----------
    zeta, phi : ndarray, shapes (n,) and (n,) or (m, n)
        Positions and φ/φ_s there. At ζ = 0 the slope just ahead is returned.
    neighbours : ndarray of complex, shape of phi
        φ(ζ+1) + φ(ζ-1).
    v, c : float, or ndarray of float that broadcasts with phi
        Front velocity v̂ and coupling.
    """
    behind = np.where(zeta < 0, 0.5, 0.0)
    slope: ComplexArray = (0.5 * phi - behind - 0.5j * c * (2.0 * phi - neighbours)) / v
    return slope


def front_profile_by_roots(zeta: npt.ArrayLike, v: float, c: float, count: int) -> FrontShape:
    """Return φ(ζ)/φ_s by the series (49) as printed, over the ``count`` nearest roots.

    φ/φ_s = -½ Σ_{M⁺} e^{ikζ}/(kL_k) for ζ > 0 and 1 + ½ Σ_{M⁻} e^{ikζ}/(kL_k) for ζ < 0. The
    series converges like 1/count near ζ = 0.

    Raises
    ------
    ParameterError
        If a parameter is out of range.

    Examples
    --------
    >>> series = front_profile_by_roots([-1.5, 0.5], 0.3, 0.5, 2000)
    >>> integral = front_profile([-1.5, 0.5], 0.3, 0.5)
    >>> bool(np.all(abs(series.phi - integral.phi) <= series.error + integral.error))
    True
    """
    v, c = checked_velocity_and_coupling(v, c)
    count = count_within("root count", count, 10, 100_000)
    position = np.atleast_1d(np.asarray(zeta, dtype=float))
    phi = np.empty(position.shape, dtype=complex)
    error = 0.0
    for upper in (True, False):
        on_side = position >= 0 if upper else position < 0
        if not on_side.any():
            continue
        k = nearest_roots(v, c, count, upper).k
        residue = 1.0 / (-1j * k * (v + c * np.sin(k)))
        waves = np.exp(1j * np.outer(position[on_side], k))
        total = waves @ residue
        phi[on_side] = -0.5 * total if upper else 1.0 + 0.5 * total
        # Beyond the last root terms decay at least like 1/k², and there are two roots per period.
        last = float(np.max(np.abs(residue[-2:]) * np.abs(waves[:, -2:]).max(axis=0)))
        error = max(error, 2.0 * last * count / 2.0 + 1e-14)
    return FrontShape(zeta=position, phi=phi, error=error, points=count)
