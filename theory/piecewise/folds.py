"""The onset of moving fronts: the fold c_fold(η) ≤ c_pin(η), and η_fold(c).

Static fronts end at c_pin (``theory.piecewise.limits``). Moving fronts begin where max_v |Σ(v, c)|
first reaches 2r. This maximum may exceed |Σ(0⁺, c)|; then c_fold < c_pin, two moving branches
meet at c_fold, and between the two couplings a front at rest stays at rest and a moving one keeps
moving (hysteresis).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from theory.arrays import FloatArray
from theory.cells.vdp import bistable_eta, eta_from_ratio, threshold_ratio
from theory.parameters import with_ranges, within
from theory.piecewise.limits import COUPLINGS, pinning_coupling, pinning_eta, static_sum
from theory.piecewise.sums.integral import sums

_SLOWEST = 0.018
"""Velocity below which |Σ| is within 1e-12 of its limit at v = 0."""

LAST_FOLD = 2.0
"""Coupling from which no fold is searched for; no maximum of |Σ| exceeds Σ(0⁺) for c above 0.9."""

_EXCESS = 2e-13
_STEP = 1e-5
"""Step in ln v and ln c for differences of slopes, which are accurate to 1e-12."""


@dataclass(frozen=True)
class KineticFold:
    """The onset of moving fronts.

    Attributes
    ----------
    value : float
        c_fold at given η, or η_fold at given c; dimensionless.
    error : float
        Bound on its error.
    velocity : float
        Velocity v̂ at the fold; 0 where the fold coincides with pinning.
    """

    value: float
    error: float
    velocity: float


def fold_coupling(eta: float) -> KineticFold | None:
    """Return c_fold(η), below which no front of (44) moves steadily.

    Parameters
    ----------
    eta : float
        η = b/a², dimensionless, 0 < η ≤ 1/8.

    Returns
    -------
    KineticFold or None
        ``velocity`` is 0 and c_fold = c_pin where, to within the stated error, no moving front
        exists below c_pin. None for η ≥ 2/25, where no front advances.

    Examples
    --------
    >>> fold = fold_coupling(0.03125)
    >>> fold.value < pinning_coupling(0.03125) and fold.error < 1e-11
    True
    """
    return fold_couplings([bistable_eta(eta)])[0]


def fold_couplings(eta: npt.ArrayLike) -> list[KineticFold | None]:
    """Return :func:`fold_coupling` for many η at once.

    At the fold |Σ| = 2r and ∂|Σ|/∂v = 0. These equations are solved starting from each maximum at
    c_pin, and the smallest c is the fold; near c = 0.82 two maxima are equally high.
    """
    etas = np.atleast_1d(np.asarray(eta, dtype=float)).tolist()
    pins = [pinning_coupling(value) for value in etas]
    folds = [None if pin is None else KineticFold(pin, _pinned_error(pin), 0.0) for pin in pins]
    start = {i: _maxima(pin) for i, pin in enumerate(pins) if pin is not None and pin < LAST_FOLD}
    owners = [i for i, maxima in start.items() for _ in maxima]
    if not owners:
        return folds
    target = np.array([2.0 * threshold_ratio(etas[i]) for i in owners])
    t = np.concatenate(list(start.values()))
    c = np.array([pins[i] for i in owners], dtype=float)
    t, c = _refined_maxima(t, c, target)
    height, _, by_c, error = _modulus_and_slopes(t, c)
    # The height is stationary in v, so only its own error matters.
    half_width = 2.0 * (np.abs(height - target) + error) / by_c
    for i, c_, e_, v_ in zip(
        owners, c.tolist(), half_width.tolist(), np.exp(t).tolist(), strict=True
    ):
        lowest = folds[i]
        if lowest is not None and c_ < lowest.value - e_:
            folds[i] = KineticFold(c_, e_, v_)
    return folds


@with_ranges(couplings=COUPLINGS)
def fold_eta(c: float) -> KineticFold:
    """Return η_fold(c), above which no front of (44) moves steadily at this coupling.

    Raises
    ------
    ParameterError
        If the coupling is not {couplings}.

    Examples
    --------
    >>> fold = fold_eta(fold_coupling(0.03125).value)
    >>> abs(fold.value - 0.03125) < 1e-12
    True
    """
    c = within("coupling c", c, *COUPLINGS)
    maxima = _maxima(c) if 1e-12 <= c < LAST_FOLD else np.empty(0)
    if maxima.size == 0:
        return KineticFold(pinning_eta(c), 1e-15 + (_EXCESS if c < LAST_FOLD else 0.0), 0.0)
    t = maxima[:1]
    height, _, _, error = (float(row[0]) for row in _modulus_and_slopes(t, np.array([c])))
    r = 0.5 * height
    by_r = r * (1.0 - r * r) / (1.0 + r * r) ** 3
    return KineticFold(eta_from_ratio(r), by_r * error + 1e-16, math.exp(t[0]))


def _pinned_error(pin: float) -> float:
    """Bound the error of a fold at pinning: rounding, and maxima too low to be detected."""
    rounding = 4e-16 * pin
    if pin >= LAST_FOLD:
        return rounding
    slope = (abs(static_sum(1.001 * pin)) - abs(static_sum(pin))) / (0.001 * pin)
    return rounding + 2.0 * _EXCESS / slope


def _maxima(c: float) -> FloatArray:
    """Return ln v of the maxima of |Σ(v, c)| above the static limit, the highest first."""
    fastest = 2.0 * math.sqrt(c) + 1.0
    spacing = math.pi / (4.0 * c + 1.0) / 2.0
    equispaced = 1.0 / np.arange(1.0 / fastest, 1.0 / _SLOWEST, spacing)
    v = np.sort(np.concatenate([equispaced, np.geomspace(_SLOWEST, fastest, 60)]))
    size = np.abs(sums(v, c, 1e-14).value)
    static = abs(static_sum(c))
    # Heights are compared at the refined maxima, since the scan may miss the top of some.
    rises = np.diff(size) > 0
    peaks = np.flatnonzero(rises[:-1] & ~rises[1:]) + 1
    peaks = peaks[np.abs(size[peaks] - static) > _EXCESS]  # smaller differences are rounding
    couplings = np.full(peaks.shape, c)
    t, _ = _refined_maxima(np.log(v[peaks]), couplings)
    height = _modulus_and_slopes(t, couplings)[0]
    order = np.argsort(-height)
    return t[order[height[order] > static + _EXCESS]]


def _refined_maxima(
    t: FloatArray, c: FloatArray, target: FloatArray | None = None
) -> tuple[FloatArray, FloatArray]:
    """Return ln v and c of the maxima of |Σ| over v near t, at fixed c or of height ``target``.

    Newton's method is applied to ∂|Σ|/∂t = 0 and, if there is a ``target``, |Σ| = target. Second
    derivatives are differences of first ones.
    """
    for _ in range(20):
        points = np.concatenate([t, t + _STEP, t]), np.concatenate([c, c, c * (1.0 + _STEP)])
        rows = (row.reshape(3, -1) for row in _modulus_and_slopes(*points))
        (height, _, _), (slope, slope_at_t_step, slope_at_c_step), (by_c, _, _), _ = rows
        curvature = np.minimum((slope_at_t_step - slope) / _STEP, -1e-300)
        dc = np.zeros_like(c)
        if target is not None:
            dc = (target - height) / by_c  # the height is stationary in v
            slope = slope + (slope_at_c_step - slope) / (_STEP * c) * dc
        step = np.clip(slope / curvature, -0.05, 0.05)
        t, c = t - step, c + dc
        if np.all(np.abs(step) < 1e-7) and np.all(np.abs(dc) < 1e-8 * c):
            break  # the remaining error is of the order of their squares, or 1e-5 of the step
    return t, c


def _modulus_and_slopes(
    t: FloatArray, c: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return |Σ|, d|Σ|/dt, ∂|Σ|/∂c and the error of |Σ| at v = e^t."""
    v = np.exp(t)
    found = sums(v, c, 1e-14, slopes=True)
    assert found.by_v is not None
    assert found.by_c is not None
    size = np.abs(found.value)
    direction = np.conj(found.value) / size
    by_t = v * np.real(direction * found.by_v)
    return size, by_t, np.real(direction * found.by_c), found.error
