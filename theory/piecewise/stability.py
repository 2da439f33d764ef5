"""Linear stability of the fronts of (44), from the zeros of the symbol of their switching times.

Let site n switch at T_n = n/v + d_n with small d_n. The chain responds to a switched site at
distance k, a time s later, by ½φ_s G_k(s),

    G_k(s) = (-i)^k e^{-s/2 + ics} J_k(cs) = (1/2π) ∫ e^{iκk - A(κ)s} dκ,

so that φ_m, at the moment of its own switching, changes by -½φ_s Σ_k G_k(k/v)(d_{m-k} - d_m), and
stays on the threshold |φ| = |φ_us| to first order if

    Σ_{k ≥ 1} p_k (d_m - d_{m-k}) = 0,      p_k = ½ Re[e^{-i arg φ(0)} G_k(k/v)].

A disturbance d_m = z^m obeys D(z) = Σ p_k (1 - z^{-k}) = 0. The zero z = 1 is a shift of the front
in time. The front is linearly stable if every other zero, a *multiplier* per site, has |z| < 1 and
|φ| passes the threshold at a finite rate, Σ p_k > 0.

With w = 1/z, D = (1 - w) E(w), E(w) = Σ_j q_j w^j, q_j = Σ_{k > j} p_k. Zeros of E inside a circle
are counted by its winding number, on so many points that a Lipschitz bound excludes a miscount.
"""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from theory.cells.vdp import ETA_END, SMALLEST_ETA, threshold_ratio
from theory.parameters import number, within
from theory.piecewise.admissibility import TOLERANCE, check_admissible
from theory.piecewise.branch_search import all_velocities
from theory.piecewise.dispersion import FloatArray, onsite
from theory.piecewise.folds import fold_coupling
from theory.piecewise.sums.rules import sum_at

_EPS = float(np.finfo(float).eps)
_SMALLEST_TERM = 1e-30
"""e^{-K/2v} of the last term; on the largest circle searched its root remains."""
_MAX_PRODUCTS = 30_000_000
"""Terms times points of the mean over κ, at most: about a third of a second."""
_MAX_POINTS = 1 << 20
_AT_ONCE = 1 << 16
"""Powers of u that are held in memory."""
_SCAN = 1.03
"""Factor between the couplings at which stability is tried."""
_NARROW = 1e-5
"""Relative width of the bracket of c_stable at which bisection ends."""
_FOLD_ERROR = 1e-11
"""Relative error of a fold, where |Σ| and 2r touch to within 1e-13."""
_ROOM = 1e-9
"""A multiplier so near the unit circle is not decided."""
_CIRCLES = 14
_LARGEST_LOGARITHM = 700.0
"""Of a number that, times coefficients of E and their count, does not overflow."""


@dataclass(frozen=True, kw_only=True)
class FrontStability:
    """Linear stability of one travelling front.

    Attributes
    ----------
    floor : float
        e^{-1/4v}, below which no multiplier is looked for; the memory of earlier switchings fades
        like its square.
    terms : int
        Terms p_k of the symbol.
    stable : bool or None
        Whether every disturbance of the switching times decays; None where it was not decided:
        a multiplier lies on the unit circle to within rounding, the series is too long (v above
        some tens), or its terms are below the smallest number (v below 7e-4).
    multiplier : float or None
        Largest modulus of a multiplier per site other than the trivial one; None where all are
        below ``floor``, or none could be told.
    angle : float or None
        Its argument, in radians per site from 0 to π; π is a disturbance that alternates.
    error : float or None
        Bound on the error of ``multiplier``.
    """

    floor: float
    terms: int
    stable: bool | None = None
    multiplier: float | None = None
    angle: float | None = None
    error: float | None = None


def front_stability(v: float, c: float) -> FrontStability:
    """Return the linear stability of the front of velocity v (a solution of Eq. 54).

    Parameters
    ----------
    v, c : float
        Front velocity v̂ (negative where the excited state retreats) and coupling, dimensionless.

    Returns
    -------
    FrontStability

    Raises
    ------
    ParameterError
        If a parameter is out of range.

    Notes
    -----
    The answer is about small disturbances of the switching times and presupposes (47).

    Examples
    --------
    >>> front_stability(0.300992350758521, 0.5).stable
    True
    """
    v = number("velocity v", v)
    speed = within("velocity |v|", abs(v), 1e-12, 1e12)
    c = within("coupling c", c, 1e-12, 1e12)
    terms = _terms(speed)
    found = FrontStability(floor=math.exp(-0.25 / speed), terms=terms)
    points = _mean_points(terms, speed, c)
    if terms * points > _MAX_PRODUCTS:
        return found
    p = symbol_coefficients(v, c, terms, points)
    q = np.cumsum(p[::-1])[::-1].copy()
    uncertainty = _uncertainty(speed)
    if abs(q[0]) <= uncertainty * math.exp(-0.5 / speed):  # |p_k| ≤ e^{-k/2v}, to rounding
        return found
    if q[0] < 0.0:
        return replace(found, stable=False)
    if _zeros_within(q, 1.0 / found.floor, uncertainty) == 0:
        return replace(found, stable=True)
    inside = _zeros_within(q, 1.0 - _ROOM, uncertainty)
    outside = _zeros_within(q, 1.0 + _ROOM, uncertainty)
    found = replace(found, stable=None if inside is None or inside != outside else inside == 0)
    nearest = _nearest_zero(q, 1.0 / found.floor, uncertainty)
    if nearest is None:
        return found
    w, error = nearest
    modulus = 1.0 / abs(w)
    return replace(found, multiplier=modulus, angle=abs(cmath.phase(w)), error=error * modulus**2)


@dataclass(frozen=True, kw_only=True)
class StabilityLimit:
    """Where the fastest admissible front of one η first loses stability as c grows.

    Attributes
    ----------
    c : float or None
        c_stable, dimensionless; None where there is none, and ``reason`` says why.
    error : float or None
        Bound on its error.
    v : float or None
        Velocity v̂ there.
    angle : float or None
        Argument of the multiplier that leaves the unit circle, in radians per site; 0 where the
        branch ends, in a fold or because (47) ceases to hold, or an unstable one begins.
    reason : str or None
        Why there is no c_stable.
    """

    c: float | None = None
    error: float | None = None
    v: float | None = None
    angle: float | None = None
    reason: str | None = None


@lru_cache(maxsize=256)
def stability_limit(eta: float, farthest: float = 60.0) -> StabilityLimit:
    """Return c_stable(η): up to there the fastest admissible front is linearly stable.

    Parameters
    ----------
    eta : float
        η = b/a², dimensionless, 0 < η < 2/25.
    farthest : float
        Largest coupling looked at. Fronts may regain and lose stability beyond c_stable.

    Returns
    -------
    StabilityLimit

    Raises
    ------
    ParameterError
        If η or the largest coupling is out of range.

    Notes
    -----
    From c_fold on, couplings 3 % apart are looked at; a loss of stability over a shorter interval
    may be missed. Couplings at which no front is admissible are passed over: no front is lost there
    by its own instability.

    Examples
    --------
    >>> limit = stability_limit(0.03125)
    >>> round(limit.c, 6), limit.error < 1e-10
    (2.405932, True)
    """
    within("eta = b/a^2", eta, SMALLEST_ETA, ETA_END)
    within("largest coupling", farthest, 1e-8, 100.0)
    fold = fold_coupling(eta)
    if fold is None:
        return StabilityLimit(reason=f"no front advances at eta = {eta:.12g}")
    if fold.value >= farthest:
        return StabilityLimit(reason=f"c_fold = {fold.value:.6g} is not below {farthest:g}")
    r = threshold_ratio(eta)
    count = 2 + math.ceil(math.log(farthest / fold.value) / math.log(_SCAN))
    before = None
    for c in np.geomspace(fold.value * (1.0 + 1e-3), farthest, count).tolist():
        here = _Leading.at(c, r)
        if here.unstable is None:
            return StabilityLimit(reason=f"at c = {c:.6g} {here.reason}")
        if here.unstable and before is None:
            return StabilityLimit(reason=f"just above c_fold, at c = {c:.6g}, no front is stable")
        if here.unstable and before is not None:
            return _crossing(before, here, r)
        before = here
    return StabilityLimit(reason=f"the fastest front is stable at all couplings up to {farthest:g}")


def symbol_coefficients(v: float, c: float, terms: int, points: int | None = None) -> FloatArray:
    """Return p_1 … p_K of the symbol.

    Parameters
    ----------
    v, c : float
        Velocity v̂, negative where the excited state retreats, and coupling, dimensionless.
    terms : int
        K.
    points : int, optional
        Points of the mean over κ; so many by default that aliasing is below rounding.

    Returns
    -------
    ndarray of float, shape (K,)
        Dimensionless; accurate to rounding, since G_k(k/v) is the mean of u^k with
        u = e^{iκ - A(κ)/v} over equispaced κ, up to J_{N-k}(ck/v).

    Examples
    --------
    >>> symbol_coefficients(0.3, 0.5, 2).round(6).tolist()
    [0.024735, 0.003119]
    """
    speed = abs(v)
    count = _mean_points(terms, speed, c) if points is None else points
    kappa = 2.0 * np.pi * np.arange(count) / count
    u = np.exp(1j * kappa - onsite(kappa + 0j, c) / speed)
    at_threshold = -0.5 * sum_at(speed, c, 1e-15, False)[0]
    if v < 0:  # 1 - φ advances, and |φ| falls below the threshold where its sites switch
        at_threshold = 1.0 - at_threshold
    turn = cmath.exp(-1j * cmath.phase(at_threshold))
    means = np.empty(terms, dtype=complex)
    rows = min(terms, max(1, _AT_ONCE // count))
    powers = np.empty((rows, count), dtype=complex)
    before = np.ones_like(u)
    for first in range(0, terms, rows):
        some = powers[: terms - first]
        for power in some:
            before = np.multiply(before, u, out=power)
        means[first : first + rows] = np.add.reduce(some, axis=1)  # each alone takes twice as long
    coefficients: FloatArray = 0.5 * np.real(turn * (means / count))
    return coefficients


def _terms(speed: float) -> int:
    return max(2, math.ceil(-2.0 * speed * math.log(_SMALLEST_TERM)))


def _uncertainty(speed: float) -> float:
    """Bound what rounding of u^k, and the terms left out, change E by where |w| < e^{1/4v}.

    Σ_k k² e^{-k/4v} times half a unit of rounding; the terms left out add e^{-K/4v} = 1e-15.
    """
    return _EPS * (1.0 + 4.0 * speed) ** 3


def _mean_points(terms: int, speed: float, c: float) -> int:
    """Return N with |J_n(ck/v)| ≤ (w/n)^n below 1e-20, n = N - k, w = e ck/2v, for every k ≤ K.

    As (1 + x) ln(1 + x) ≥ x, the logarithm of the bound is at most w - n, and 1e-20 is e^{-46.1}.
    """
    return 1 << math.ceil(math.log2(terms + 46.1 + 0.5 * math.e * c * terms / speed))


def _zeros_within(q: FloatArray, radius: float, uncertainty: float) -> int | None:
    """Return the number of zeros of E(w) in |w| < radius; None if one is too near the circle.

    The winding number over M points is right if |E| at each of them exceeds what E can change by
    to the middle between neighbours, half a step times the bound Σ j |q_j| ρ^{j-1} of |E'|.
    """
    order = np.arange(q.size)
    with np.errstate(over="ignore"):
        scaled = q * radius**order
        slope = float(np.sum(np.abs(scaled) * order)) / radius
    points = 1 << math.ceil(math.log2(8 * q.size))
    while points <= _MAX_POINTS:
        values = np.fft.rfft(scaled, points)  # the other half are the complex conjugates
        least = float(np.abs(values).min()) - uncertainty
        if least <= 0.0:
            return None
        if least > slope * math.pi * radius / points:
            turns = np.sum(np.angle(values[1:] / values[:-1])) / np.pi
            return abs(round(float(turns)))
        points *= 4
    return None


def _nearest_zero(q: FloatArray, reach: float, uncertainty: float) -> tuple[complex, float] | None:
    """Return the zero of E nearest w = 0 within ``reach``, and its error; None if there is none.

    Newton starts from where |E| is least on circles of growing radius. A zero counts as the nearest
    once the winding number excludes any in a circle a thousandth smaller.
    """
    slope = _slope(q)
    count = 1 << math.ceil(math.log2(4 * q.size))
    for radius in np.geomspace(0.1, 1.0, _CIRCLES) * reach:
        values = np.abs(np.fft.ifft(q * radius ** np.arange(q.size), count))[: count // 2 + 1]
        beside = np.r_[np.inf, values, np.inf]
        least = np.flatnonzero((values <= beside[:-2]) & (values <= beside[2:]))
        starts = radius * np.exp(2j * np.pi * least[np.argsort(values[least])[:6]] / count)
        zeros = _newton(q, slope, starts, reach)
        if zeros.size == 0:
            continue
        w = complex(zeros[np.argmin(np.abs(zeros))])
        if abs(w) <= 1.5 * radius and _zeros_within(q, 0.999 * abs(w), uncertainty) == 0:
            value, derivative = (abs(_polynomial(each, w)[0]) for each in (q, slope))
            return w, 2.0 * (uncertainty + value) / derivative + 4.0 * _EPS * abs(w)
    return None


def _newton(
    q: FloatArray, slope: FloatArray, starts: npt.NDArray[np.complex128], reach: float
) -> npt.NDArray[np.complex128]:
    """Return the zeros within ``reach`` to which Newton's method goes from these points.

    A point is given up beyond twice the reach, or where its highest power would overflow. From a
    place where E' is next to nothing, as where v is small and E is constant, it is gone at once.
    """
    farthest = min(2.0 * reach, math.exp(_LARGEST_LOGARITHM / q.size))
    w = np.array(starts, dtype=complex)
    step = np.full(w.shape, np.inf, dtype=complex)
    for _ in range(40):
        moving = np.flatnonzero((np.abs(step) > 4.0 * _EPS * np.abs(w)) & (np.abs(w) < farthest))
        if moving.size == 0:
            break
        value, derivative = _polynomial(q, w[moving]), _polynomial(slope, w[moving])
        gone = np.abs(value) >= 4.0 * reach * np.abs(derivative)
        w[moving[gone]] = np.inf
        there = moving[~gone]
        step[there] = value[~gone] / derivative[~gone]
        w[there] -= step[there]
    zeros: npt.NDArray[np.complex128] = w[(np.abs(w) < reach) & (np.abs(step) < 1e-9 * np.abs(w))]
    return zeros


def _polynomial(
    coefficients: FloatArray, w: npt.NDArray[np.complex128] | complex
) -> npt.NDArray[np.complex128]:
    """Return Σ coefficients_j w^j."""
    powers = np.empty((coefficients.size, np.size(w)), dtype=complex)
    powers[0], powers[1:] = 1.0, w
    np.multiply.accumulate(powers, axis=0, out=powers)
    values: npt.NDArray[np.complex128] = coefficients.astype(complex) @ powers
    return values


@dataclass(frozen=True)
class _Leading:
    """The fastest admissible front at one coupling, its symbol, and whether it is unstable.

    Where there is none, v is NaN and nothing is unstable; where it is not decided, ``unstable`` is
    None and ``reason`` says why.
    """

    c: float
    v: float = math.nan
    error: float = math.nan
    solutions: int = 0
    q: FloatArray = field(default_factory=lambda: np.empty(0))
    unstable: bool | None = False
    reason: str = ""

    @classmethod
    def at(cls, c: float, r: float, slack: float = 0.0) -> _Leading:
        """Return it, where (47) is asked with r + ``slack``."""
        found = all_velocities(np.array([c]), np.array([2.0 * r]))
        none = cls(c, solutions=found.v.size)
        for v, error in zip(found.v[::-1].tolist(), found.error[::-1].tolist(), strict=True):
            verdict = check_admissible(v, c, r + slack)
            if verdict.admissible is None:
                return replace(none, unstable=None, reason=f"admissibility: {verdict.reason}")
            if verdict.admissible:
                return replace(none, v=v, error=error)._with_symbol()
        return none

    def _with_symbol(self) -> _Leading:
        terms = _terms(self.v)
        points = _mean_points(terms, self.v, self.c)
        if terms * points > _MAX_PRODUCTS:
            return replace(self, unstable=None, reason="the symbol of the front is too long")
        p = symbol_coefficients(self.v, self.c, terms, points)
        q = np.cumsum(p[::-1])[::-1].copy()
        inside = _zeros_within(q, 1.0, _uncertainty(self.v))
        if inside is None:
            return replace(self, q=q, unstable=None, reason="a multiplier is on the unit circle")
        return replace(self, q=q, unstable=inside > 0)

    def zero_near(self, w: complex) -> complex:
        """Return the zero of E to which Newton's method goes from w."""
        zeros = _newton(self.q, _slope(self.q), np.array([w]), 4.0)
        return complex(zeros[0]) if zeros.size else complex(math.nan)


def _crossing(stable: _Leading, unstable: _Leading, r: float) -> StabilityLimit:
    """Return where the fastest front ceases to be stable, between two couplings.

    Bisection as long as stability is decided, then the secant rule on ln |w| of the zero that has
    come inside, which moves smoothly in so narrow an interval.
    """
    while unstable.c > stable.c * (1.0 + _NARROW):
        middle = _Leading.at(math.sqrt(stable.c * unstable.c), r)
        if middle.unstable is None:
            break
        stable, unstable = (stable, middle) if middle.unstable else (middle, unstable)
    if math.isnan(stable.v) or abs(unstable.v - stable.v) > 100.0 * _NARROW * stable.v:
        return _end_of_branch(stable, unstable, r)
    unknown = StabilityLimit(reason=f"stability is lost near c = {stable.c:.6g}, but not smoothly")
    nearest = _nearest_zero(unstable.q, 1.5, _uncertainty(unstable.v))
    if nearest is None:
        return unknown
    here, w, slope = unstable, nearest[0], math.nan
    size, step = math.log(abs(w)), 0.5 * (unstable.c - stable.c)
    low, high = stable.c * (1.0 - _NARROW), unstable.c * (1.0 + _NARROW)
    for _ in range(20):
        following = _Leading.at(min(max(here.c - step, low), high), r)
        if following.q.size == 0 or following.c == here.c:
            break
        w = following.zero_near(w)
        new = math.log(abs(w))
        slope = (new - size) / (following.c - here.c)
        here, size = following, new
        step = size / slope
        if not abs(step) > 1e-13 * here.c:
            break
    derivative = abs(_polynomial(_slope(here.q), w)[0])
    shift = _uncertainty(here.v) / derivative + abs(size)
    error = 2.0 * shift / abs(slope) + 2.0 * here.error + 4.0 * _EPS * here.c
    if not error < _NARROW * here.c:
        return unknown
    return StabilityLimit(c=here.c, error=float(error), v=here.v, angle=abs(cmath.phase(w)))


def _end_of_branch(last: _Leading, beyond: _Leading, r: float) -> StabilityLimit:
    """Return where an unstable front becomes the fastest, between two couplings.

    The branch of the stable one ends in a fold, where its multiplier is 1, or (47) ceases to hold;
    or the unstable one begins. The number of solutions of (54) tells a fold from a change of
    admissibility.
    """
    low, high = _narrowed(last, beyond, r, 0.0)
    # Beside a fold g = |Σ| - 2r is zero to within its own error in an interval of c of that width.
    error = (high.c - low.c) + _FOLD_ERROR * low.c
    if low.solutions == high.solutions:
        slack = 5.0 * TOLERANCE / r  # in |φ|² ten times what may go undetected
        error += sum(abs(_narrowed(last, beyond, r, s)[0].c - low.c) for s in (slack, -slack))
        if error > 0.4 * (beyond.c - last.c):
            reason = f"margins of (47) are too thin near c = {low.c:.6g} to tell where it is"
            return StabilityLimit(reason=reason)
    at = high.v if math.isnan(low.v) else low.v
    return StabilityLimit(c=low.c, error=float(error), v=at, angle=0.0)


def _narrowed(
    last: _Leading, beyond: _Leading, r: float, slack: float
) -> tuple[_Leading, _Leading]:
    """Bisect to two couplings that rounding leaves apart, with r + ``slack`` in (47)."""
    low, high = last, beyond
    while high.c - low.c > 4.0 * _EPS * high.c:
        middle = _Leading.at(0.5 * (low.c + high.c), r, slack)
        if not low.c < middle.c < high.c:
            break
        if abs(middle.v - beyond.v) < (math.inf if math.isnan(last.v) else abs(middle.v - last.v)):
            high = middle
        else:
            low = middle
    return low, high


def _slope(q: FloatArray) -> FloatArray:
    """Return the coefficients of E'."""
    return np.arange(1, q.size) * q[1:]
