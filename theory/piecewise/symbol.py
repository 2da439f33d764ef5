"""Symbol of the linearised switching times of a front of (44), and its zeros.

Let site n switch at T_n = n/v + d_n with small d_n. The response of the chain to the switching of a
site at distance k, a time s later, is ½φ_s G_k(s),

    G_k(s) = (-i)^k e^{-s/2 + ics} J_k(cs) = (1/2π) ∫ e^{iκk - A(κ)s} dκ,

so that φ_m at the moment of its own switching changes by -½φ_s Σ_k G_k(k/v)(d_{m-k} - d_m), and
remains at the threshold |φ| = |φ_us| to first order if

    Σ_{k ≥ 1} p_k (d_m - d_{m-k}) = 0,      p_k = ½ Re[e^{-i arg φ(0)} G_k(k/v)].

A perturbation d_m = z^m obeys D(z) = Σ p_k (1 - z^{-k}) = 0. The zero z = 1 corresponds to a shift
of the front in time. The front is linearly stable if every other zero, a *multiplier* per site, has
|z| < 1 and |φ| passes the threshold at a finite rate, Σ p_k > 0.

With w = 1/z, D = (1 - w) E(w), E(w) = Σ_j q_j w^j, q_j = Σ_{k > j} p_k. Zeros of E inside a circle
are counted by the winding number, on so many points that a Lipschitz bound excludes a miscount.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from theory.arrays import EPS, ComplexArray, FloatArray
from theory.piecewise.dispersion import onsite
from theory.piecewise.sums.rules import sum_at

_SMALLEST_TERM = 1e-30
"""e^{-K/2v} at the last term K; on the largest circle searched, that term is its square root."""
_MAX_PRODUCTS = 10_000_000
"""Largest product of the numbers of terms and of points of the mean over κ: at most some 20 ms."""
_MAX_POINTS = 1 << 20
_PIECE = 1 << 13
"""Number of points in one scalar product, for which BLAS starts no threads."""
_CIRCLES = 14
_LARGEST_LOGARITHM = 700.0
"""Logarithm of a number that does not overflow when multiplied by coefficients of E and summed."""


@dataclass(frozen=True)
class Symbol:
    """The polynomial E(w) of one front, from which the trivial zero w = 1 has been divided out.

    Attributes
    ----------
    q : ndarray of float, shape (K,)
        Its coefficients, dimensionless.
    uncertainty : float
        Bound on the error of E for |w| < e^{1/4v}, from rounding and omitted terms.
    spread : ndarray of float
        Bounds on the changes of the first coefficients over the velocities for which zeros are
        counted; empty for the given velocity alone.
    """

    q: FloatArray
    uncertainty: float
    spread: FloatArray = field(default_factory=lambda: np.empty(0))

    @classmethod
    def of(cls, v: float, c: float) -> Symbol | None:
        """Return E for the front of velocity v at coupling c; None if it has too many terms."""
        speed = abs(v)
        terms = terms_at(speed)
        points = _mean_points(terms, speed, c)
        if terms * points > _MAX_PRODUCTS:
            return None
        p = symbol_coefficients(v, c, terms, points)
        # Half a unit of rounding in each factor of u^k gives Σ_k k² e^{-k/4v}; the omitted terms
        # add e^{-K/4v} = 1e-15.
        return cls(np.cumsum(p[::-1])[::-1].copy(), EPS * (1.0 + 4.0 * speed) ** 3)

    def zeros_within(self, radius: float) -> int | None:
        """Return the number of zeros of E(w) in |w| < radius; None if one is too near the circle.

        The number is the same for all coefficients within ``spread``.

        With the radius ρ, there is none if |q_0| exceeds the sum of all other |q_j| ρ^j. Otherwise
        the winding number over M points is correct if |E| at each of them exceeds the largest
        change of E up to the midpoint between neighbours, which is half a step times the bound Σ j
        |q_j| ρ^{j-1} on |E'|.
        """
        order = np.arange(self.q.size)
        with np.errstate(over="ignore"):
            powers = radius**order
            scaled = self.q * powers
            sizes = np.abs(scaled)
            uncertainty = self.uncertainty + float(self.spread @ powers[: self.spread.size])
            if sizes[0] - uncertainty > np.sum(sizes[1:]):
                return 0
            lipschitz = float(np.sum(sizes * order)) / radius
        points = 1 << math.ceil(math.log2(8 * self.q.size))
        while points <= _MAX_POINTS:
            values = np.fft.rfft(scaled, points)  # the other half is complex conjugate
            smallest = float(np.abs(values).min()) - uncertainty
            if smallest <= 0.0:
                return None
            if smallest > lipschitz * math.pi * radius / points:
                turns = np.sum(np.angle(values[1:] / values[:-1])) / np.pi
                return abs(round(float(turns)))
            points *= 4
        return None

    def up_to(self, other: Symbol, factor: float) -> Symbol:
        """Return E with a spread of a multiple of the differences from those of another front."""
        count = min(self.q.size, other.q.size)
        return Symbol(self.q, self.uncertainty, factor * np.abs(other.q[:count] - self.q[:count]))

    def nearest_zero(self, reach: float) -> tuple[complex, float] | None:
        """Return the zero of E nearest w = 0 within ``reach``, and its error; or None.

        Newton's method starts from the minima of |E| on circles of increasing radius. A zero is
        accepted as the nearest if, by the winding number, there is none inside a circle that is
        smaller by a thousandth.
        """
        q, slope = self.q, _slope(self.q)
        count = 1 << math.ceil(math.log2(4 * q.size))
        for radius in np.geomspace(0.1, 1.0, _CIRCLES) * reach:
            values = np.abs(np.fft.ifft(q * radius ** np.arange(q.size), count))[: count // 2 + 1]
            padded = np.r_[np.inf, values, np.inf]
            minima = np.flatnonzero((values <= padded[:-2]) & (values <= padded[2:]))
            starts = radius * np.exp(2j * np.pi * minima[np.argsort(values[minima])[:6]] / count)
            zeros = _newton(q, slope, starts, reach)
            if zeros.size == 0:
                continue
            w = complex(zeros[np.argmin(np.abs(zeros))])
            if abs(w) <= 1.5 * radius and self.zeros_within(0.999 * abs(w)) == 0:
                value, derivative = (abs(_polynomial(each, w)[0]) for each in (q, slope))
                return w, 2.0 * (self.uncertainty + value) / derivative + 4.0 * EPS * abs(w)
        return None

    def zero_near(self, w: complex) -> complex:
        """Return the zero of E to which Newton's method converges from w; NaN if it does not."""
        zeros = _newton(self.q, _slope(self.q), np.array([w]), max(4.0, 2.0 * abs(w)))
        return complex(zeros[0]) if zeros.size else complex(math.nan)

    def slope_at(self, w: complex) -> float:
        """Return |E'(w)|."""
        return float(abs(_polynomial(_slope(self.q), w)[0]))


def symbol_coefficients(v: float, c: float, terms: int, points: int | None) -> FloatArray:
    """Return p_1 … p_K of the symbol.

    Parameters
    ----------
    v, c : float
        Velocity v̂, negative where the excited state retreats, and coupling, dimensionless.
    terms : int
        K.
    points : int, optional
        Number of points of the mean over κ; by default so large that aliasing is below rounding.

    Returns
    -------
    ndarray of float, shape (K,)
        Dimensionless; accurate to rounding.

    Notes
    -----
    G_k(k/v) is the mean over a period of u^k, u = e^{iκ - A(κ)/v}, along any path. On the path
    κ = x + is(sin x + v/c), s = min(1, c/v), |u| ≤ e^{-1/2v}, with equality at the two saddle
    points on the axis. On the lines Im x = ±τ, |u| is larger by about e^{cτ²/v}, so that the error
    with N points in x is e^{kcτ²/v - Nτ}, which is least for τ = Nv/2kc (a test samples u on the
    lines).

    Examples
    --------
    >>> symbol_coefficients(0.3, 0.5, 2, points=None).round(6).tolist()
    [0.024735, 0.003119]
    """
    speed = abs(v)
    count = _mean_points(terms, speed, c) if points is None else points
    x, s = 2.0 * np.pi * np.arange(count) / count, min(1.0, c / speed)
    kappa = x + 1j * s * (np.sin(x) + speed / c)
    u = np.exp(1j * kappa - onsite(kappa, c) / speed)
    at_threshold = -0.5 * sum_at(speed, c, 1e-15, False)[0]
    if v < 0:  # 1 - φ advances, and |φ| falls below the threshold where its sites switch
        at_threshold = 1.0 - at_threshold
    rotation = cmath.exp(-1j * cmath.phase(at_threshold))
    weights = (1.0 + 1j * s * np.cos(x)) / count
    stride = math.ceil(math.sqrt(terms))  # each u^k is a product of two of about 2√K powers
    low_powers = _geometric(u, u, stride)
    high_powers = _geometric(weights.conj(), low_powers[-1].conj(), math.ceil(terms / stride))
    means = np.zeros((len(high_powers), stride), dtype=complex)
    for first in range(0, count, _PIECE):
        part = slice(first, first + _PIECE)
        means += np.vecdot(high_powers[:, None, part], low_powers[:, part])
    return 0.5 * np.real(rotation * means.ravel()[:terms])


def terms_at(speed: float) -> int:
    """Return K, the number of terms of the symbol at |v| = ``speed``."""
    return max(2, math.ceil(-2.0 * speed * math.log(_SMALLEST_TERM)))


def _mean_points(terms: int, speed: float, c: float) -> int:
    """Return N such that N²v/4Kc > 46.1, since e^{-46.1} is 1e-20; see `symbol_coefficients`."""
    return math.ceil(46.1 + 13.6 * math.sqrt(c * terms / speed))


def _newton(q: FloatArray, slope: FloatArray, starts: ComplexArray, reach: float) -> ComplexArray:
    """Return the zeros within ``reach`` to which Newton's method converges from given points.

    An iteration is abandoned beyond twice the reach, or where the highest power of w would
    overflow. It is abandoned at once where E' is almost zero, as at small v, where E is nearly
    constant.
    """
    farthest = min(2.0 * reach, math.exp(_LARGEST_LOGARITHM / q.size))
    w = np.array(starts, dtype=complex)
    step = np.full(w.shape, np.inf, dtype=complex)
    for _ in range(40):
        unconverged = np.flatnonzero(
            (np.abs(step) > 4.0 * EPS * np.abs(w)) & (np.abs(w) < farthest)
        )
        if unconverged.size == 0:
            break
        value, derivative = _polynomial(q, w[unconverged]), _polynomial(slope, w[unconverged])
        abandoned = np.abs(value) >= 4.0 * reach * np.abs(derivative)
        w[unconverged[abandoned]] = np.inf
        active = unconverged[~abandoned]
        step[active] = value[~abandoned] / derivative[~abandoned]
        w[active] -= step[active]
    zeros: ComplexArray = w[(np.abs(w) < reach) & (np.abs(step) < 1e-9 * np.abs(w))]
    return zeros


def _geometric(first: ComplexArray, ratio: ComplexArray, count: int) -> ComplexArray:
    """Return the first, the first times the ratio, times its square, …, as rows."""
    terms = np.empty((count, first.size), dtype=complex)
    terms[0] = first
    for before, term in pairwise(terms):
        np.multiply(before, ratio, out=term)
    return terms


def _polynomial(coefficients: FloatArray, w: ComplexArray | complex) -> ComplexArray:
    """Return Σ coefficients_j w^j."""
    powers = np.empty((coefficients.size, np.size(w)), dtype=complex)
    powers[0], powers[1:] = 1.0, w
    np.multiply.accumulate(powers, axis=0, out=powers)
    return coefficients.astype(complex) @ powers


def _slope(q: FloatArray) -> FloatArray:
    """Return the coefficients of E'."""
    return np.arange(1, q.size) * q[1:]
