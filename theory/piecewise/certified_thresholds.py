"""c_pin, c_retreat and c_fold of one η, each proven to lie in an interval.

c_pin and c_retreat have closed forms (``theory.piecewise.limits``), which are evaluated in balls.

c_fold is the infimum of the couplings at which a front moves. A single value proves that it is
below some c₊, namely |Σ(v, c₊)| > 2r at some v, since |Σ| → 0 as v → ∞. That it is above some c₋
requires a proof that |Σ(v, c)| < 2r for all v > 0 and 0 < c ≤ c₋:

* For c ≤ c₀ with 8c₀(1 + 2c₀) < 2r: in the real-line form of Σ given in
  ``theory.piecewise.certified_velocities``, the first factor of the denominator is at least ¼, and
  |u² + iu| ≤ 2c(1 + 2c).
* For v below or above the bounds of that module at c₋. They hold for c < c₋ too: |Σ(0⁺, c)| grows
  with c, since 2r² = p(p - 1)/(2p² - 1) grows with p, and p with c (``limits.pinning_coupling``).
* At c = c₋: the mean-value form of |Σ|² - 4r² is negative on every cell of v.
* The remaining region is divided into boxes. On each box either |Σ| < 2r, by the derivatives over
  the box, or ∂|Σ|²/∂c > 0; in the latter case |Σ| < 2r follows from the adjacent boxes at larger c
  and ultimately from c = c₋.
"""

from __future__ import annotations

import math
from typing import Any

from theory.piecewise.certified_sum import ball_static_sum
from theory.piecewise.certified_velocities import (
    Enclosure,
    Relation,
    WorkLimitError,
    fast_bound,
    highest_velocity,
    lowest_velocity,
    static_distance,
)
from theory.piecewise.folds import fold_coupling
from theory.piecewise.limits import ETA_PIN_END

_CLOSED_BITS = 320
_MIN_RELATIVE_WIDTH = 1e-12
_ROUND_UP = 1.0 + 1e-12
_WIDENING_FACTORS = (1.0, 10.0, 100.0)
_MIN_RELATIVE_ERROR = 1e-15


def ball_ratio(flint: Any, eta: float) -> Any:
    """Return r(η) = √(8η)/(1 + √(1 - 8η)) as a ball, with η as the exact binary number."""
    eta_ = flint.arb(eta)
    return (8 * eta_).sqrt() / (1 + (1 - 8 * eta_).sqrt())


def enclose_static_end(flint: Any, eta: float) -> Enclosure | None:
    """Return an interval that contains c_pin(η) or, for η > 2/25, c_retreat(η).

    Both are ½ p √(p² - 1) with |1 - 4r²| p² ∓ p ± 2r² = 0, p > 1.

    Returns
    -------
    Enclosure or None
        None where the ball is unbounded, because η is within rounding of 2/25.
    """
    with flint.ctx.workprec(_CLOSED_BITS):
        r2 = ball_ratio(flint, eta) ** 2
        gap = 1 - 4 * r2
        if gap.contains(0):
            return None
        p = (1 + (1 - 8 * r2 * gap).sqrt()) / (2 * abs(gap))
        return Enclosure.of(p * (p * p - 1).sqrt() / 2)


def enclose_fold(flint: Any, eta: float, pin: Enclosure) -> Enclosure | None:
    """Return an interval that contains c_fold(η), η < 2/25, or None if it could not be proven.

    Parameters
    ----------
    flint : module
        python-flint; its working precision is the caller's.
    eta : float
        η = b/a².
    pin : Enclosure
        Enclosure of c_pin at this η.

    Raises
    ------
    WorkLimitError
        If the proof takes too long, as at strong coupling; the message names the couplings and
        velocities concerned.
    """
    fold = fold_coupling(eta) if eta < ETA_PIN_END else None
    if fold is None:
        return None
    target = 2 * ball_ratio(flint, eta)
    for factor in _WIDENING_FACTORS:
        margin = factor * max(fold.error, _MIN_RELATIVE_ERROR * fold.value)
        low = min(fold.value, pin.lower) - margin
        if low > 0.0 and _never_moves(flint, low, target, fold.velocity):
            break
    else:
        return None
    for factor in _WIDENING_FACTORS if fold.velocity > 0.0 else ():
        high = fold.value + factor * max(fold.error, _MIN_RELATIVE_ERROR * fold.value)
        relation = Relation(flint, flint.arb(high), target)
        if relation.sign(fold.velocity) > 0:
            return Enclosure(lower=low, upper=min(high, pin.upper))
    return Enclosure(lower=low, upper=pin.upper)  # beyond c_pin |Σ(0⁺)| > 2r


def _never_moves(flint: Any, c: float, target: Any, peak: float) -> bool:
    """Return whether |Σ(v, c')| < 2r is proven for all v > 0 and 0 < c' ≤ c.

    ``peak`` is the approximate velocity at which |Σ(v, c)| is largest, 0 if that is at v = 0.
    """
    relation = Relation(flint, flint.arb(c), target)
    low, high = lowest_velocity(relation), highest_velocity(relation)
    if low == 0.0 or not abs(ball_static_sum(flint, relation.c)) < target:
        return False
    smallest = 0.5 * c
    while not 8 * flint.arb(smallest) * (1 + 2 * flint.arb(smallest)) < target:
        smallest *= 0.5
    if low >= high:
        return True
    part = f"at c = {c:.6g}"
    try:
        if not _below_on_line(relation, low, high, peak):
            return False
        part = f"for c from {smallest:.3g} to {c:.6g}"
        return _below_on_boxes(relation, (low, high), (smallest, c))
    except WorkLimitError as limit:
        reach = f"v from {low:.3g} to {high:.3g}"
        raise WorkLimitError(f"to show |Sum| < 2r {part} and {reach}, {limit}") from None


def _below_on_line(relation: Relation, low: float, high: float, peak: float) -> bool:
    """Return whether |Σ| < 2r is proven at the relation's coupling, for v from low to high."""
    cells = [(low, high)]
    if low < peak < high:
        left, right = _below_about_peak(relation, peak)
        cells = [(low, left), (right, high)]
    while cells:
        a, b = cells.pop()
        middle = 0.5 * (a + b)
        half = (b - middle) * _ROUND_UP
        if b < 1.5 * a:
            centre = relation.resolved(relation.flint.arb(middle))
            distance = relation.distance(centre)
            # at small v the distance is small, and the derivatives are exponentially small
            slope, rate = relation.slope_bounds(a, b, 0.1 * float(abs(distance).upper()) / half)
            if distance + half * rate < 0 or relation.height(centre) + half * abs(slope) < 0:
                continue
        if b - a < _MIN_RELATIVE_WIDTH * b:
            return False
        cells += [(middle, b), (a, middle)]
    return True


def _below_about_peak(relation: Relation, peak: float) -> tuple[float, float]:
    """Return an interval around the maximum of |Σ| on which |Σ| < 2r is proven, perhaps empty.

    Where ∂²|Σ|²/∂v² < 0, |Σ|² lies below each of its tangents. The tangent at the peak is nearly
    horizontal.
    """
    flint = relation.flint
    v = flint.arb(peak)
    half = 0.25 * peak
    while half > 1e-4 * peak:
        cell = flint.arb(peak - half).union(flint.arb(peak + half))
        if _slope_and_curvature(relation, cell)[1] < 0:
            break
        half *= 0.5
    else:
        return peak, peak
    for _ in range(6):
        slope, curvature = _slope_and_curvature(relation, v)
        v = (v - slope / curvature).mid()
    slope, _ = _slope_and_curvature(relation, v)
    maximum = relation.height(relation.sum(v, relation.tolerances[-1]).value)
    proven = bool(maximum + 2.0 * half * abs(slope) < 0)
    return (peak - half, peak + half) if proven else (peak, peak)


def _slope_and_curvature(relation: Relation, v: Any) -> tuple[Any, Any]:
    """Return ∂h/∂v and ∂²h/∂v²."""
    found = relation.sum(v, relation.tolerances[-1], 2)
    squares = found.by_v.real**2 + found.by_v.imag**2
    slope = relation.slope(found.value, found.by_v)
    return slope, 2 * squares + relation.slope(found.value, found.by_vv)


def _below_on_boxes(
    relation: Relation, velocities: tuple[float, float], couplings: tuple[float, float]
) -> bool:
    """Return whether |Σ| < 2r or ∂|Σ|²/∂c > 0 is proven on each box."""
    flint = relation.flint
    coarse = 1e-3 * float(relation.target)
    boxes = [(*velocities, *couplings)]
    while boxes:
        a, b, low, high = boxes.pop()
        middle, middle_c = 0.5 * (a + b), 0.5 * (low + high)
        if b - a < _MIN_RELATIVE_WIDTH * b and high - low < _MIN_RELATIVE_WIDTH * high:
            return False
        extent_v, extent_c = math.log(b / a), math.log(high / low)
        if _below_by_bounds(relation, a, b, high):
            continue
        if extent_v < 0.6 and extent_c < 0.7:
            v, c = flint.arb(a).union(flint.arb(b)), flint.arb(low).union(flint.arb(high))
            over_box = relation.sum(v, coarse, 1, c=c)
            if relation.slope(over_box.value, over_box.by_c) > 0:
                continue
            if over_box.by_v.is_finite() and over_box.by_c.is_finite():
                halves = (b - middle) * _ROUND_UP, (high - middle_c) * _ROUND_UP
                centre = relation.sum(flint.arb(middle), coarse, c=flint.arb(middle_c)).value
                rates = abs(over_box.by_v) * halves[0], abs(over_box.by_c) * halves[1]
                if relation.distance(centre) + rates[0] + rates[1] < 0:
                    continue
                changes = [
                    abs(relation.slope(over_box.value, by)) * half
                    for by, half in zip((over_box.by_v, over_box.by_c), halves, strict=True)
                ]
                if relation.height(centre) + changes[0] + changes[1] < 0:
                    continue
                extent_v, extent_c = (float(each.upper()) for each in changes)
        if extent_v >= extent_c:
            boxes += [(a, middle, low, high), (middle, b, low, high)]
        else:
            boxes += [(a, b, low, middle_c), (a, b, middle_c, high)]
    return True


def _below_by_bounds(relation: Relation, low: float, high: float, c: float) -> bool:
    """Return whether bounds at small and large v prove |Σ| < 2r for these v, up to coupling c."""
    flint, c_ = relation.flint, relation.flint.arb(c)
    slow = abs(ball_static_sum(flint, c_)) + static_distance(flint, high)
    return bool(slow < relation.target) or bool(fast_bound(flint, low, c_) < relation.target)
