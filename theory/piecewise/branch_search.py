"""Every solution v of |Σ(v, c)| = 2r, for many couplings at once, without missing a pair at a fold.

A front that retreats with velocity -v obeys |Σ₋(v, c)| = |2 + Σ(v, c)| = 2r, since v → -v turns
the roots k into -k and exchanges the half-planes. Both equations have the form |Σ + shift| = 2r
with shift 0 or 2. The search works on g(ln v) = |Σ + shift| - 2r with its exact derivative. It
starts from the points of ``theory.piecewise.first_points`` and bisects each cell until one of three
conditions holds: g cannot vanish inside even if its slope is twice the largest of those at the ends
and of the chord (the cell is dropped); g is monotone (one solution if it changes sign, none if
not); or the cell is as short as rounding allows (a fold to within rounding).
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from itertools import pairwise

import numpy as np

from theory.arrays import EPS, BoolArray, FloatArray, IntArray
from theory.piecewise.first_points import MAX_POINTS, first_points
from theory.piecewise.sums.axis import STEEPEST
from theory.piecewise.sums.integral import MANY, sums_of_pairs

_TOLERANCE = 1e-14
_SHORTEST = 1e-10
_LONG_AXIS = 4.0
"""Coupling above which the rule on the axis needs more points than `axis.MAX_PLAIN`."""
_ARCH = 4
"""Extra cost of a value by the rule for c > 3v, in units of the cost by the rule on the axis."""


@dataclass(frozen=True, kw_only=True)
class Solutions:
    """Solutions of the kinetic relation for all cases in one list, ascending in (case, v).

    Attributes
    ----------
    case : ndarray of int, shape (n,)
        Index of the coupling to which each solution belongs.
    v, error : ndarray of float, shape (n,)
        Velocity v̂ and its error bound.
    slope : ndarray of float, shape (n,)
        ∂|Σ + shift|/∂v.
    by_coupling : ndarray of float, shape (n,)
        ∂|Σ + shift|/∂c.
    error_along_coupling, error_along_target : ndarray of float, shape (n,)
        Bounds on the errors of ∂v/∂c = -by_coupling/slope and ∂v/∂target = 1/slope; infinite where
        the slope may vanish within the error of v, as near a fold, or where v tends to zero.
    evaluations : int
        Number of values of Σ computed, over all cases.
    """

    case: IntArray
    v: FloatArray
    error: FloatArray
    slope: FloatArray
    by_coupling: FloatArray
    error_along_coupling: FloatArray
    error_along_target: FloatArray
    evaluations: int


@dataclass
class _Relation:
    """g and its derivatives by t = ln v and c, for pieces of cases; counts the evaluations."""

    case: IntArray
    c: FloatArray
    target: FloatArray
    shift: float
    many: bool
    evaluations: int = 0

    def __call__(self, piece: IntArray, t: FloatArray) -> FloatArray:
        """Return g, ∂g/∂t, the error of g, ∂g/∂c, and the errors of both slopes, shape (6, n)."""
        self.evaluations += t.size
        v = np.exp(t)
        values, errors, _ = sums_of_pairs(v, self.c[piece], _TOLERANCE, True, self.many)
        value, derivatives = values[0] + self.shift, values[1:]
        modulus = np.abs(value)
        inverse = 1.0 / np.maximum(modulus, 1e-300)
        found = np.empty((6, t.size))
        np.subtract(modulus, self.target[piece], out=found[0])
        found[2] = errors[0]
        found[1:4:2] = (value.conj() * inverse * derivatives).real
        found[4:] = errors[1:] + 2.0 * errors[0] * inverse * np.abs(derivatives)
        found[1:5:3] *= v
        return found


def all_velocities(
    c: FloatArray, target: FloatArray, retreating: bool = False, refine: float = 1.0
) -> Solutions:
    """Return every v > 0 with |Σ(v, c)| = target, for each pair of c and target.

    Parameters
    ----------
    c, target : ndarray of float, shape (n,)
        Couplings, and right sides 2r of (54), between 0 and 2.
    retreating : bool
        Solve |2 + Σ(v, c)| = target instead; the front's velocity is then -v.
    refine : float
        Divisor of the spacing of the first points; 1 suffices, and tests compare with 4.

    Raises
    ------
    PrecisionError
        If a coupling needs more than ``MAX_POINTS`` points: c above 10⁸ and η near 2/25.
    """
    shift = 2.0 if retreating else 0.0
    case, piece, t = first_points(c, target, shift, refine)
    # Finding the solutions then takes about as many values again.
    coupling = c[case[piece]]
    costly = (coupling > _LONG_AXIS) & (coupling > STEEPEST * np.exp(t))
    many = 2 * (t.size + _ARCH * int(np.count_nonzero(costly))) >= MANY
    relation = _Relation(case, c[case], target[case], shift, many=many)
    if t.size <= MAX_POINTS:
        return _solve(relation, piece, t)
    # solve groups of pieces whose points make up an array of moderate size
    last = np.cumsum(np.bincount(piece, minlength=case.size))
    cuts = np.searchsorted(piece, np.flatnonzero(np.diff(last // MAX_POINTS)) + 1).tolist()
    parts = pairwise([0, *cuts, t.size])
    found = [_solve(relation, piece[begin:end], t[begin:end]) for begin, end in parts]
    columns = [each.name for each in fields(Solutions) if each.name != "evaluations"]
    return Solutions(
        **{name: np.concatenate([getattr(some, name) for some in found]) for name in columns},
        evaluations=relation.evaluations,
    )


def _solve(relation: _Relation, piece: IntArray, t: FloatArray) -> Solutions:
    """Return the solutions on some pieces, starting from points t that ascend in each piece."""
    (left_ends,) = (piece[1:] == piece[:-1]).nonzero()
    ends = np.array([t, *relation(piece, t)[:3]])
    cells = np.concatenate([ends.take(left_ends, axis=1), ends.take(left_ends + 1, axis=1)])
    owner, brackets = _brackets(relation, piece[left_ends], cells)
    return _polish(relation, owner, brackets)


def _brackets(
    relation: _Relation, owner: IntArray, cells: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Bisect cells (rows t, g, dg/dt, error at both ends) until each holds one solution or none."""
    done_owner, done_cells = [], []
    while owner.size:
        ta, ga, da, ea, tb, gb, db, eb = cells
        _, abs_g_a, abs_slope_a, _, _, abs_g_b, abs_slope_b, _ = np.abs(cells)
        width = tb - ta
        # Where g is below its rounding error its sign means nothing; see `_distinct`.
        sign_change = (ga > 0) != (gb > 0)
        smallest_slope = np.minimum(abs_slope_a, abs_slope_b)
        # The slope of the cubic through the ends, even if twice as far from linear, keeps its sign.
        monotone = (da > 0) == (db > 0)
        # If g changes by less than its error over the cell, smaller cells show nothing more.
        short = monotone & (width * np.maximum(abs_slope_a, abs_slope_b) < np.minimum(ea, eb))
        short |= width < _SHORTEST
        monotone &= 3.0 * np.abs(gb - ga - 0.5 * width * (da + db)) < width * smallest_slope
        largest_slope = np.maximum(np.maximum(abs_slope_a, abs_slope_b), np.abs(gb - ga) / width)
        no_zero = abs_g_a + abs_g_b > 2.0 * width * largest_slope
        # There the inverse function t(g) is nearly a cubic.
        one_zero = monotone & (np.abs(da - db) < 2.0 * smallest_slope)
        (found,) = (sign_change & (one_zero | short)).nonzero()
        done_owner.append(owner.take(found))
        done_cells.append(cells.take(found, axis=1))
        # A short cell without change of sign, zero at an end to within rounding, is an exact fold.
        if short.nonzero()[0].size:
            zero = np.minimum(abs_g_a - ea, abs_g_b - eb) <= 0
            (touches,) = (short & ~sign_change & zero).nonzero()
            # One per case and round is enough, since its neighbours belong to the same fold.
            touches = touches[np.unique(owner[touches], return_index=True)[1]]
            done_owner.append(owner[touches])
            done_cells.append(cells[:, touches])
        # The remaining cells are not short, and may have any number of solutions.
        (undecided,) = (~(short | np.where(sign_change, one_zero, monotone | no_zero))).nonzero()
        owner, cells = owner.take(undecided), cells.take(undecided, axis=1)
        if owner.size:
            middle = np.empty((4, owner.size))
            middle[0] = 0.5 * (cells[0] + cells[4])
            middle[1:] = relation(owner, middle[0])[:3]
            cells = np.concatenate(
                [np.concatenate([cells[:4], middle]), np.concatenate([middle, cells[4:]])], axis=1
            )
            owner = np.concatenate([owner, owner])
    return np.concatenate(done_owner), np.concatenate(done_cells, axis=1)


def _distinct(
    relation: _Relation, owner: IntArray, cells: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Sort the brackets and merge neighbours between which g is zero to within rounding.

    Near a fold the computed g changes sign many times by rounding alone. A run of such brackets
    stands for a pair of solutions, the outermost two brackets, if g has the same sign on both sides
    of the run, and for one solution if not.
    """
    if owner.size < 2:
        return owner, cells
    order = np.lexsort((cells[0], owner))
    owner, cells = owner[order], cells[:, order]
    pairs = np.flatnonzero(owner[:-1] == owner[1:])
    g, _, e = relation(owner[pairs], 0.5 * (cells[4, pairs] + cells[0, pairs + 1]))[:3]
    within_rounding = np.maximum(np.abs(cells[5, pairs]), np.abs(cells[1, pairs + 1])) <= 2.0 * e
    joined = np.zeros(owner.size - 1, dtype=bool)
    joined[pairs] = within_rounding & (np.abs(g) <= 2.0 * e)
    selected: list[int] = []
    for run in np.split(np.arange(owner.size), np.flatnonzero(~joined) + 1):
        same_sign = (cells[1, run[0]] > 0) == (cells[5, run[-1]] > 0)
        selected += [run[0], run[-1]] if same_sign and run.size > 1 else [run[run.size // 2]]
    return owner[selected], cells[:, selected]


def _polish(relation: _Relation, owner: IntArray, cells: FloatArray) -> Solutions:
    """Refine each bracket to one solution, with its error and derivatives."""
    owner, cells = _distinct(relation, owner, cells)
    t, half_width, values = _refined(relation, owner, cells)
    v = np.exp(t)
    along_c, along_target = _errors_along(v, half_width, values)
    return Solutions(
        case=relation.case[owner],
        v=v,
        error=v * half_width,
        slope=values[1, 0] / v,
        by_coupling=values[3, 0],
        error_along_coupling=along_c,
        error_along_target=along_target,
        evaluations=relation.evaluations,
    )


def _refined(
    relation: _Relation, owner: IntArray, cells: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the zero of g in each bracket by cubic interpolation, its error, and the values.

    For the error and the values see `_confirmed_half_width`. The last step, after which g is zero
    to within rounding, is evaluated together with the points on both sides.
    """
    t = _crossing(cells)
    values = relation(owner, t)
    tried = False
    for _ in range(30):
        g, by_t, error = values[:3]
        below_zero = (g > 0) == (cells[1] > 0)
        discarded = np.where(below_zero, t - cells[0], cells[4] - t)
        new_end = np.array([t, g, by_t, error])
        np.copyto(cells[:4], new_end, where=below_zero)
        np.copyto(cells[4:], new_end, where=~below_zero)
        new = _crossing(cells)
        step, abs_slope = np.abs(new - t), np.where(by_t == 0, 1.0, np.abs(by_t))
        rounding = 4e-16 * np.maximum(1.0, np.abs(t)) + 0.5 * error / abs_slope
        unconverged = step > rounding
        (open_,) = unconverged.nonzero()
        if open_.size == 0:
            break
        t[open_] = new[open_]
        # The error is proportional to the squared distances from both ends: about step³/dropped².
        if not tried and (unconverged & (step**3 <= rounding * discarded**2)).all():
            half_width = _smallest_half_width(t, by_t, error)
            confirmed = _values_at(relation, owner, t, t - half_width, t + half_width)
            if _opposite_signs(confirmed).all():
                return t, half_width, confirmed
            values, tried = confirmed[:, 0], True
        else:
            values[:, open_] = relation(owner[open_], t[open_])
    return t, *_confirmed_half_width(relation, owner, t, values)


def _crossing(cells: FloatArray) -> FloatArray:
    """Return where the cubic t(g) through the ends of each cell, with their slopes, has g = 0.

    Where the result lies outside the cell, or does not exist because an end has no slope or both
    have the same g, the middle is used instead.
    """
    ta, ga, da, _, tb, gb, db, _ = cells
    width, rise = tb - ta, gb - ga
    with np.errstate(all="ignore"):
        s = -ga / rise
        start, end = rise / da - width, rise / db - width
        cubic = ta + s * (width + (1.0 - s) * ((1.0 - s) * start - s * end))
    inside: FloatArray = np.where((cubic >= ta) & (cubic <= tb), cubic, ta + 0.5 * width)
    return inside


def _smallest_half_width(t: FloatArray, by_t: FloatArray, g_bound: FloatArray) -> FloatArray:
    """Return the least distance from t, where |g| ≤ off, at which g may exceed its error."""
    rounding = 4.0 * EPS * np.maximum(1.0, np.abs(t))
    abs_slope = np.where(by_t == 0, 1e-300, np.abs(by_t))
    return np.minimum(rounding + 2.5 * g_bound / abs_slope, 1e-3)


def _confirmed_half_width(
    relation: _Relation, owner: IntArray, t: FloatArray, values: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return δ such that g has opposite signs, beyond its error, at t - δ and t + δ; and values.

    The values are those of the relation at t, t - δ and t + δ, shape (6, 3, n).
    """
    half_width = _smallest_half_width(t, values[1], np.abs(values[0]) + values[2])
    at_ends = _values_at(relation, owner, t - half_width, t + half_width)
    for _ in range(11):
        confirmed = _opposite_signs(at_ends)
        if confirmed.all():
            break
        half_width = np.where(confirmed, half_width, 2.0 * half_width)
        at_ends = _values_at(relation, owner, t - half_width, t + half_width)
    return half_width, np.concatenate([values[:, None], at_ends], axis=1)


def _opposite_signs(values: FloatArray) -> BoolArray:
    """Return whether g has opposite signs, beyond its error, at the last two places."""
    g, error = values[0, -2:], values[2, -2:]
    opposite: BoolArray = (np.abs(g) > error).all(axis=0) & ((g[0] > 0) != (g[1] > 0))
    return opposite


def _values_at(relation: _Relation, owner: IntArray, *places: FloatArray) -> FloatArray:
    """Return the values at several arrays of t, computed together, shape (6, places, n)."""
    together = relation(np.concatenate([owner] * len(places)), np.concatenate(places))
    return together.reshape(6, len(places), owner.size)


def _errors_along(
    v: FloatArray, half_width: FloatArray, values: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Bound the errors that ∂v/∂c and ∂v/∂target, computed at v, have at the true velocity.

    The true ln v lies within ``half_width`` of the computed one. There the derivatives of g are
    assumed to lie between those at the middle and at the ends, which are in ``values``.
    """
    derivatives, error = values[1:4:2], values[4:]
    slope_range, by_c_range = np.array(
        [(derivatives - error).min(axis=1), (derivatives + error).max(axis=1)]
    ).swapaxes(0, 1)
    nonzero = (slope_range[0] > 0) | (slope_range[1] < 0)
    inverse = v / np.where(nonzero, slope_range, 1.0)
    at_middle = v / np.where(nonzero, derivatives[0, 0], 1.0)
    # The term 1e-15 is the relative error of the factor v.
    rounding = (half_width + 1e-15) * np.abs(inverse).max(axis=0)
    along_target = np.abs(inverse - at_middle).max(axis=0) + rounding
    corners = inverse[:, None] * by_c_range
    along_c = np.abs(corners - at_middle * derivatives[1, 0]).max(axis=(0, 1))
    along_c += rounding * np.abs(by_c_range).max(axis=0)
    return np.where(nonzero, along_c, np.inf), np.where(nonzero, along_target, np.inf)
