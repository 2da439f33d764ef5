"""Starting points of the search for solutions of |Σ(v, c)| = 2r, so dense that none is missed.

The spacing of the points follows the scales of g(ln v) = |Σ + shift| - 2r: the exponentially small
oscillations in 1/v at small v, and the resonances at large c. The points lie between bounds outside
of which there is no solution and, where there are many oscillations, only where g can reach zero
(``theory.piecewise.smooth_part``).
"""

from __future__ import annotations

import math

import numpy as np

from theory.arrays import FloatArray, IntArray
from theory.piecewise.limits import resonance_number, resonant_velocities, static_sum
from theory.piecewise.smooth_part import WEAKEST, smooth_part_of_sum
from theory.piecewise.sums.result import PrecisionError

_MAX_SPACING = 0.25
_MANY_OSCILLATIONS = 64
"""Number of points, a few for each oscillation, above which the parts of the range in which these
matter are determined first."""
_INTERVAL_LENGTH, _PARTS = 2.0, 8
"""Length of the intervals of ln v that are examined first, and number of parts of each."""
_FEW_POINTS = 4.0
"""Number of points of an interval at or below which it is not divided further."""
_GRADING = 4.0
"""Ratio of the distances of successive points beside a resonance, where g varies as a power of the
distance."""
MAX_POINTS = 200_000
"""Largest number of starting points for one coupling: about ten seconds."""
NEAREST_TO_PINNING = 1e-12
"""Solutions with |Σ| nearer than this to its limit at v = 0 are not searched for (v < 0.018)."""


def first_points(
    c: FloatArray, target: FloatArray, shift: float, refine: float
) -> tuple[IntArray, IntArray, FloatArray]:
    """Return pieces of the range between the bounds, and points t = ln v spaced by the scales of g.

    The results are the case of each piece, the piece of each point, and t, which ascends within
    each piece. Between pieces there is no solution.
    """
    low = _lowest_velocities(c, target, shift)
    high = np.maximum(_highest_velocities(c, np.abs(target - shift)), 2.0 * low)
    fine = math.pi / (4.0 * c + 1.0) / refine  # spacing in 1/v
    spacing = np.full(c.size, _MAX_SPACING / refine)
    transition = np.minimum(np.maximum(spacing / fine, low), high)
    low, transition, high = np.log(low), np.log(transition), np.log(high)
    owner, begin, end = _where_oscillations_matter(c, target, shift, (low, transition, fine))
    lowest_inverse, highest_inverse = np.exp(-end), np.exp(-begin)
    _refuse_too_many(c, target, owner, (highest_inverse - lowest_inverse) / fine[owner])
    all_cases = np.arange(c.size)
    # below ``transition`` points are equally spaced in 1/v, above it in ln v
    ranges = (lowest_inverse, transition), (highest_inverse, high), (fine[owner], spacing)
    interval, x = _spaced(*(np.concatenate(pair) for pair in ranges))
    below = slice(int(interval.searchsorted(owner.size)))
    x[below] = -np.log(x[below])
    owner, begin, end = (
        np.concatenate(pair) for pair in ((owner, all_cases), (begin, transition), (end, high))
    )
    resonant_interval, resonant_points = _resonances(c[owner], (begin, end), fine[owner], refine)
    order = np.lexsort((begin, owner))
    starts_piece = np.ones(owner.size, dtype=bool)
    starts_piece[1:] = (owner[order[1:]] != owner[order[:-1]]) | (
        begin[order[1:]] > end[order[:-1]]
    )
    piece = np.empty(owner.size, dtype=np.int64)
    piece[order] = np.cumsum(starts_piece) - 1
    piece_of_point = piece[np.concatenate([interval, resonant_interval])]
    t = np.concatenate([x, resonant_points])
    ascending = np.lexsort((t, piece_of_point))
    piece_of_point, t = piece_of_point[ascending], t[ascending]
    distinct = np.ones(t.size, dtype=bool)
    distinct[1:] = (t[1:] > t[:-1]) | (piece_of_point[1:] > piece_of_point[:-1])
    return owner[order[starts_piece]], piece_of_point[distinct], t[distinct]


def _spaced(begin: FloatArray, end: FloatArray, spacing: FloatArray) -> tuple[IntArray, FloatArray]:
    """Return interval numbers and points in them, ends included, at most ``spacing`` apart."""
    steps = 1 + np.ceil((end - begin) / spacing).astype(np.int64)
    count = steps + 1
    interval = np.arange(begin.size).repeat(count)
    first = count.cumsum() - count
    fraction = (np.arange(interval.size) - first[interval]) / steps[interval]
    return interval, (1.0 - fraction) * begin[interval] + fraction * end[interval]


def _resonances(
    c: FloatArray, bounds: tuple[FloatArray, FloatArray], fine: FloatArray, refine: float
) -> tuple[IntArray, FloatArray]:
    """Return intervals and ln v of points at and beside resonances narrower than the spacing.

    ``c``, ``bounds`` (in ln v) and ``fine`` are given for each interval.
    """
    empty = np.empty(0, dtype=np.int64), np.empty(0)
    if c.max(initial=0.0) <= 1.0:  # no resonance is narrow
        return empty
    # The width is above v/4c and has to be below v² fine, so that v is above 1/π.
    first = np.floor(resonance_number(np.exp(bounds[1]) / c)).clip(0.0)
    last = np.ceil(resonance_number(np.maximum(np.exp(bounds[0]), 1.0 / math.pi) / c))
    count = np.where(c > 1.0, last - first + 1.0, 0.0).clip(0.0).astype(np.int64)
    interval = np.arange(c.size).repeat(count)
    if interval.size == 0:
        return empty
    number = np.arange(interval.size) + (first - (count.cumsum() - count))[interval]
    centre, width = resonant_velocities(c[interval], number)
    ratio = np.minimum(_MAX_SPACING, centre * fine[interval] * refine) * centre / width
    (narrow,) = (ratio > 1.0).nonzero()
    interval = interval[narrow]
    centre, width, ratio = (row[narrow] for row in (centre, width, ratio))
    # On both sides, distances from one width to the spacing, by factors of `_GRADING`.
    pairs = 1 + (np.log(ratio) / math.log(_GRADING)).astype(np.int64)
    resonance = np.arange(interval.size).repeat(pairs)
    power = np.arange(resonance.size) - (pairs.cumsum() - pairs)[resonance]
    offset = width[resonance] / refine * _GRADING**power
    points = np.log(
        np.concatenate([centre, centre[resonance] - offset, centre[resonance] + offset])
    )
    interval = np.concatenate([interval, interval[resonance], interval[resonance]])
    inside = (points > bounds[0][interval]) & (points < bounds[1][interval])
    return interval[inside], points[inside]


def _where_oscillations_matter(
    c: FloatArray, target: FloatArray, shift: float, scales: tuple[FloatArray, ...]
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Return cases and ends of the intervals of ln v, within bounds, that must be searched finely.

    ``scales`` holds the bounds in ln v and the spacing in 1/v. Where there are many oscillations,
    their height and the smooth part of g are evaluated on parts of intervals. Within a part, the
    smooth part of g is assumed to exceed its values at the ends by no more than it changes over
    this part or an adjacent one. Where g may then vanish, the part is divided in turn, unless it
    has few points, or the oscillations are higher than the smooth part throughout.
    """
    low, transition, fine = scales
    points = (np.exp(-low) - np.exp(-transition)) / fine
    many = (c > WEAKEST) & (points > _MANY_OSCILLATIONS)
    if not many.any():
        return np.arange(c.size), low, transition
    (few,) = (~many).nonzero()
    owners, begins, ends = [few], [low[few]], [transition[few]]
    (oscillating,) = many.nonzero()
    interval, t = _spaced(
        low[oscillating], transition[oscillating], np.full(oscillating.size, _INTERVAL_LENGTH)
    )
    (left_ends,) = (interval[1:] == interval[:-1]).nonzero()
    owner, begin, end = oscillating[interval[left_ends]], t[left_ends], t[left_ends + 1]
    fraction = np.linspace(0.0, 1.0, _PARTS + 1)[:, None]
    while owner.size:
        t = (1.0 - fraction) * begin + fraction * end
        sum_, height = smooth_part_of_sum(np.exp(t).ravel(), np.tile(c[owner], _PARTS + 1))
        g = np.abs(sum_ + shift).reshape(t.shape) - target[owner]
        change = np.pad(np.abs(np.diff(g, axis=0)), ((1, 1), (0, 0)))
        change = np.maximum(np.maximum(change[:-2], change[2:]), change[1:-1])
        height = height.reshape(t.shape)
        height = np.maximum(height[1:], height[:-1])
        smallest = np.minimum(np.abs(g[1:]), np.abs(g[:-1]))
        dominant = (smallest <= height).all(axis=0)
        part, column = ((smallest <= change + height) & ~dominant).nonzero()
        parts = owner[column], t[part, column], t[part + 1, column]
        done = ((np.exp(-begin) - np.exp(-end)) <= _FEW_POINTS * fine[owner])[column]
        owners += [owner[dominant], parts[0][done]]
        begins += [begin[dominant], parts[1][done]]
        ends += [end[dominant], parts[2][done]]
        owner, begin, end = (row[~done] for row in parts)
    return np.concatenate(owners), np.concatenate(begins), np.concatenate(ends)


def _refuse_too_many(
    c: FloatArray, target: FloatArray, owner: IntArray, points: FloatArray
) -> None:
    """Refuse a case that would need more than ``MAX_POINTS`` points."""
    (crowded,) = (np.bincount(owner, points, c.size) > MAX_POINTS).nonzero()
    if crowded.size:
        raise PrecisionError(
            f"the velocities at c = {c[crowded[0]]:.6g}, |Sum| = {target[crowded[0]]:.6g} need "
            f"more than {MAX_POINTS} values of the sum; simulate the front, or "
            "take a smaller c."
        )


def _highest_velocities(c: FloatArray, level: FloatArray) -> FloatArray:
    """Return v above which |Σ| is below ``level``.

    On the real line, with X = sin²(k/2) ≤ k²/4, |¼ - A²| ≤ 2c(1 + 2c)X, and |A² + v²k²| is at
    least ¼ and at least ¼ + (v² - c²)k². The first bound gives |Σ| ≤ 2c(1 + 2c)/v, the second
    |Σ| ≤ c(1 + 2c)/(2w(v + w)) with w² = v² - c².
    """
    size = c * (1.0 + 2.0 * c) / level
    return np.minimum(2.0 * size, np.sqrt(c * c + 0.25 * size))


def _lowest_velocities(c: FloatArray, target: FloatArray, shift: float) -> FloatArray:
    """Return v below which Σ is too near Σ(0⁺) for a solution (exponentially flat in 1/v)."""
    static = static_sum(c)
    gap = np.maximum(np.abs(np.abs(static + shift) - target), NEAREST_TO_PINNING)
    # theory.piecewise.limits.static_sum_distance, 2e/(1 - e), uses |1/2A| ≤ 1. The mean of |1/2A|
    # is at most the square root of that of |1/2A|² = Re 1/2A, which is Re(1 + Σ(0⁺)). At the v
    # returned the bound equals the gap.
    low = 0.5 / np.log1p(2.0 * np.sqrt(1.0 + static.real) / gap)
    # a sharper bound for large c, where the simple one would lead to many points
    (strong,) = (c > 3.0).nonzero()
    for batch in np.array_split(strong, 1 + c.size // 256) if strong.size else ():
        below, above, half = low[batch], np.sqrt(c[batch]), 0.5 * gap[batch]
        for _ in range(12 if batch.size else 0):
            middle = np.sqrt(below * above)
            exceeded = _distance_on_contour(middle, c[batch]) > half
            below, above = np.where(exceeded, below, middle), np.where(exceeded, middle, above)
        low[batch] = below
    return low


_SIGMA = np.arange(-30.0, 30.0, 0.25)
_SQUARE = 1j * np.exp(2.0 * _SIGMA)
_X = _SQUARE / (1.0 + _SQUARE)
_LENGTH = 0.25 / np.abs(np.cosh(_SIGMA + 0.25j * np.pi)) / np.pi


def _distance_on_contour(v: FloatArray, c: FloatArray) -> FloatArray:
    """Return a bound like ``static_sum_distance``, integrated on the path of ``sums.precise``."""
    A = 0.5 - 2j * c[:, None] * _X
    e = np.exp(-A.real / v[:, None])
    terms = e * (np.abs(1.0 - 2.0 * _X) + e) / (np.abs(A) * (1.0 - e) ** 2)
    bound: FloatArray = terms @ _LENGTH
    return bound
