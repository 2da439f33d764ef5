"""Where moving fronts begin: the fold c_fold(η) ≤ c_pin(η), and the same as functions of c.

Static fronts end at c_pin (``theory.limits``). Moving ones begin where max_v |Σ(v, c)| first
reaches 2r. That maximum may lie above |Σ(0⁺, c)|; then c_fold < c_pin, two moving branches meet at
c_fold, and between the two couplings a resting front stays and a moving one moves (hysteresis).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from theory.limits import pinning_coupling, pinning_eta, static_sum
from theory.parameters import positive
from theory.sum_integral import sums
from theory.unit_cell import eta_from_ratio, threshold_ratio

_SLOWEST = 0.018
"""At smaller v, |Σ| is within 1e-12 of its limit at v = 0."""


@dataclass(frozen=True)
class Fold:
    """The onset of moving fronts.

    Attributes
    ----------
    value : float
        c_fold at given η, or η_fold at given c; dimensionless.
    error : float
        Bound on its error.
    velocity : float
        Velocity at the fold; 0 where the fold is at pinning itself.
    """

    value: float
    error: float
    velocity: float


@dataclass(frozen=True)
class _Crest:
    """A maximum of |Σ| over v at one c: place, height less the static limit, ∂|Σ|/∂c, error."""

    v: float
    height: float
    by_c: float
    error: float


def fold_coupling(eta: float) -> Fold | None:
    """Return c_fold(η), below which no front of (44) moves steadily.

    Parameters
    ----------
    eta : float
        η = b/a², dimensionless, 0 < η ≤ 1/8.

    Returns
    -------
    Fold or None
        ``velocity`` is 0 and c_fold = c_pin where no moving front exists below c_pin to within
        1e-12. None for η ≥ 2/25, where |Σ| < 1 ≤ 2r for every v and c that was tried.

    Examples
    --------
    >>> fold = fold_coupling(0.03125)
    >>> fold.value < pinning_coupling(0.03125) and fold.error < 1e-11
    True
    """
    pin = pinning_coupling(eta)
    if pin is None:
        return None
    target = 2.0 * threshold_ratio(eta)
    static = Fold(pin, 4e-16 * pin, 0.0)
    crests = [crest for crest in _crests(pin) if crest.height - target > 2e-13]
    folds = [static]
    for crest in sorted(crests, key=lambda one: -one.height)[:3]:
        c, here = pin, crest
        for _ in range(30):
            step = (here.height - target) / here.by_c
            c -= step
            here = _climb(here.v, c)
            if abs(step) < 1e-14 * c:
                break
        # The height is stationary in v, so only its own error matters.
        error = 2.0 * (abs(here.height - target) + here.error) / here.by_c
        folds.append(Fold(c, error, here.v))
    return min(folds, key=lambda fold: fold.value)


def fold_eta(c: float) -> Fold:
    """Return η_fold(c), above which no front of (44) moves steadily at this coupling.

    Examples
    --------
    >>> fold = fold_eta(fold_coupling(0.03125).value)
    >>> abs(fold.value - 0.03125) < 1e-12
    True
    """
    c = positive("coupling c", c)
    crests = [crest for crest in _crests(c) if crest.height > abs(static_sum(c)) + 2e-13]
    if not crests:
        return Fold(pinning_eta(c), 1e-15, 0.0)
    highest = max(crests, key=lambda crest: crest.height)
    r = 0.5 * highest.height
    by_r = r * (1.0 - r * r) / (1.0 + r * r) ** 3
    return Fold(eta_from_ratio(r), by_r * highest.error + 1e-16, highest.v)


def _crests(c: float) -> list[_Crest]:
    """Return the local maxima of |Σ(v, c)| over v above the slowest one told apart."""
    fastest = 2.0 * math.sqrt(c) + 1.0
    wiggle = math.pi / (4.0 * c + 1.0) / 2.0
    even = 1.0 / np.arange(1.0 / fastest, 1.0 / _SLOWEST, wiggle)
    v = np.unique(np.concatenate([even, np.geomspace(_SLOWEST, fastest, 60)]))
    size, by_t, _, _ = _height(v, c)
    up = np.flatnonzero((by_t[:-1] > 0) & (by_t[1:] < 0))
    worth = up[np.maximum(size[up], size[up + 1]) > abs(static_sum(c)) * (1 - 1e-3)]
    return [_climb(float(math.sqrt(v[i] * v[i + 1])), c, v[i], v[i + 1]) for i in worth[-6:]]


def _climb(v: float, c: float, low: float | None = None, high: float | None = None) -> _Crest:
    """Return the maximum of |Σ| near v: d|Σ|/d ln v = 0 by the secant rule, kept in its bracket."""
    t = math.log(v)
    a = math.log(low) if low else t - 0.05
    b = math.log(high) if high else t + 0.05
    ends = _height(np.exp([a, b]), c)[1]
    for _ in range(40):
        if ends[0] > 0 > ends[1]:
            break
        a, b = a - 0.05 * (ends[0] <= 0), b + 0.05 * (ends[1] >= 0)
        ends = _height(np.exp([a, b]), c)[1]
    fa, fb = float(ends[0]), float(ends[1])
    for _ in range(60):
        t = 0.5 * (a + b) if fa == fb else b - fb * (b - a) / (fb - fa)
        t = min(max(t, a + 0.1 * (b - a)), b - 0.1 * (b - a))
        f = float(_height(np.exp([t]), c)[1][0])
        if f > 0:
            a, fa = t, f
        else:
            b, fb = t, f
        if b - a < 1e-9:  # the height is quadratic there: 1e-18
            break
    size, _, by_c, error = _height(np.exp([0.5 * (a + b)]), c)
    return _Crest(math.exp(0.5 * (a + b)), float(size[0]), float(by_c[0]), float(error[0]))


def _height(v: np.ndarray, c: float) -> tuple[np.ndarray, ...]:
    """Return |Σ|, d|Σ|/d ln v, ∂|Σ|/∂c and the error of |Σ|."""
    found = sums(v, c, 1e-14, slopes=True)
    assert found.by_v is not None
    assert found.by_c is not None
    size = np.abs(found.value)
    direction = np.conj(found.value) / size
    return (
        size,
        v * np.real(direction * found.by_v),
        np.real(direction * found.by_c),
        found.error,
    )
