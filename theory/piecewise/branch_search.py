"""Every solution v of |Σ(v, c)| = 2r, for many couplings at once, losing no pair at a fold.

A front that retreats with velocity -v obeys |Σ₋(v, c)| = |2 + Σ(v, c)| = 2r, since v → -v turns
the roots k into -k and exchanges the half-planes. Both are |Σ + shift| = 2r with shift 0 or 2.
The search works on g(ln v) = |Σ + shift| - 2r with its exact derivative, between bounds outside
of which no solution can lie. It starts from points spaced by the scales of g (the exponential
wiggles in 1/v at small v, the resonances at large c), and divides each cell until one
of three things holds: twice its slopes cannot bring g to zero inside (dropped); g changes sign
and is monotone (one solution); or the cell is as short as rounding allows (a fold to within
rounding).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from theory.piecewise.dispersion import FloatArray
from theory.piecewise.limits import resonant_velocities, static_sum, strong_coupling_sum
from theory.piecewise.sums.integral import MANY, sums
from theory.piecewise.sums.result import PrecisionError

IntArray = npt.NDArray[np.int64]

_TOLERANCE = 1e-14
_SHORTEST = 1e-10
_COARSEST = 0.25
MAX_POINTS = 200_000
"""Points of one coupling from which the search begins, at most: some ten seconds."""
NEAREST_TO_PINNING = 1e-12
"""Solutions that need |Σ| nearer than this to its limit at v = 0 are not looked for (v < 0.018)."""


@dataclass(frozen=True, kw_only=True)
class Solutions:
    """Solutions of the kinetic relation, of all scenes in one list, ascending in (scene, v).

    Attributes
    ----------
    scene : ndarray of int, shape (n,)
        Index of the coupling that each belongs to.
    v, error : ndarray of float, shape (n,)
        Velocity v̂ and its error bound.
    slope : ndarray of float, shape (n,)
        ∂|Σ + shift|/∂v.
    by_coupling : ndarray of float, shape (n,)
        ∂|Σ + shift|/∂c.
    error_along_coupling, error_along_target : ndarray of float, shape (n,)
        Bounds on the errors of ∂v/∂c = -by_coupling/slope and ∂v/∂target = 1/slope; infinite where
        the slope may vanish within the error of v, as beside a fold.
    evaluations : int
        Values of Σ computed, over all scenes.
    """

    scene: IntArray
    v: FloatArray
    error: FloatArray
    slope: FloatArray
    by_coupling: FloatArray
    error_along_coupling: FloatArray
    error_along_target: FloatArray
    evaluations: int


class _Values(NamedTuple):
    """g and bounds at some t = ln v, arrays of one shape."""

    g: FloatArray
    by_t: FloatArray
    error: FloatArray
    by_c: FloatArray
    error_by_t: FloatArray
    error_by_c: FloatArray


@dataclass
class _Relation:
    """g and its derivatives by t = ln v and c, for scenes of one c and target; counts its work."""

    c: FloatArray
    target: FloatArray
    shift: float
    many: bool
    evaluations: int = 0

    def __call__(self, scene: IntArray, t: FloatArray) -> _Values:
        """Return g, its derivatives, and bounds on their errors."""
        self.evaluations += t.size
        v, c = np.exp(t), self.c[scene]
        found = sums(v, c, _TOLERANCE, slopes=True, compiled=self.many)
        assert found.by_v is not None
        assert found.by_c is not None
        assert found.error_by_v is not None
        assert found.error_by_c is not None
        value = found.value + self.shift
        size = np.abs(value)
        inverse = 1.0 / np.where(size > 0, size, 1.0)
        direction, turned = np.conj(value) * inverse, 2.0 * found.error * inverse
        return _Values(
            g=size - self.target[scene],
            by_t=v * np.real(direction * found.by_v),
            error=found.error,
            by_c=np.real(direction * found.by_c),
            error_by_t=v * (found.error_by_v + turned * np.abs(found.by_v)),
            error_by_c=found.error_by_c + turned * np.abs(found.by_c),
        )


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
        Divides the spacing of the first points; 1 is enough, tests try 4.

    Raises
    ------
    PrecisionError
        If a coupling needs more than ``MAX_POINTS`` points: c above some 10⁴ and η near 2/25.
    """
    shift = 2.0 if retreating else 0.0
    starts = [
        _first_points(float(c_), float(target_), shift, refine)
        for c_, target_ in zip(c, target, strict=True)
    ]
    sizes = np.array([s.size for s in starts], dtype=np.int64)
    relation = _Relation(c, target, shift, many=sizes.sum() >= MANY)
    # so many scenes at a time that their points are one array of moderate size
    pieces = np.flatnonzero(np.diff(np.cumsum(sizes) // MAX_POINTS)) + 1
    scenes = np.split(np.arange(c.size), pieces)
    found = [_solve(relation, some, [starts[i] for i in some]) for some in scenes]
    columns = [each.name for each in fields(Solutions) if each.name != "evaluations"]
    return Solutions(
        **{name: np.concatenate([getattr(some, name) for some in found]) for name in columns},
        evaluations=relation.evaluations,
    )


def _solve(relation: _Relation, scenes: IntArray, starts: list[FloatArray]) -> Solutions:
    """Return the solutions of some scenes, each searched from its own points."""
    scene, t = np.repeat(scenes, [s.size for s in starts]), np.concatenate(starts)
    left = np.flatnonzero(scene[1:] == scene[:-1])
    ends = np.stack([t, *relation(scene, t)[:3]])
    cells = np.concatenate([ends[:, left], ends[:, left + 1]])
    owner, brackets = _brackets(relation, scene[left], cells)
    return _polish(relation, owner, brackets)


def _first_points(c: float, target: float, shift: float, refine: float) -> FloatArray:
    """Return ascending t = ln v between the bounds, spaced by the scales of g."""
    low = _lowest_velocity(c, target, shift)
    # |Σ| ≤ 2c(1 + 2c)/v: |¼ - A²| ≤ c(1 - cos k)(1 + 2c) and |A² + v²k²| ≥ ¼ on the real line.
    high = max(2.0 * c * (1.0 + 2.0 * c) / abs(target - shift), 2.0 * low)
    if high > 1e12:
        # From v = 3c on |A² + v²k²| also exceeds 0.36 v²k², whence |Σ| ≤ 1.1 c(1 + 2c)/v². So far
        # out the other bound would lead to where c/v is rounding.
        high = max(3.0 * c, 1.1 * math.sqrt(c * (1.0 + 2.0 * c) / abs(target - shift)), 2.0 * low)
    wiggle = math.pi / (4.0 * c + 1.0) / refine  # spacing in 1/v
    spacing = _COARSEST / refine
    turn = min(max(spacing / wiggle, low), high)
    logarithmic = np.linspace(
        math.log(turn), math.log(high), 2 + math.ceil(math.log(high / turn) / spacing)
    )
    points = [_wiggle_points(c, target, shift, low=low, turn=turn, wiggle=wiggle), logarithmic]
    if c > 100.0:
        rest = 2 + math.ceil(math.log(turn / low) / spacing)
        points.append(np.linspace(math.log(low), math.log(turn), rest))
    if c > 1.0:
        velocities, widths = resonant_velocities(c, min(12, 2 + int(c / (math.pi * low))))
        centre, width = np.array(velocities), np.array(widths) / refine
        near = np.concatenate([centre, centre - width, centre + width])
        points.append(np.log(near[(near > low) & (near < high)]))
    t: FloatArray = np.sort(np.concatenate(points))
    distinct: FloatArray = t[np.append(True, np.diff(t) > 0.0)]
    return distinct


def _wiggle_points(
    c: float, target: float, shift: float, *, low: float, turn: float, wiggle: float
) -> FloatArray:
    """Return t from ln low to ln turn, ``wiggle`` apart in 1/v, where wiggles matter.

    At c > 100 they are about v/c^{3/2} high: only where the smooth part, on a grid, is near 2r.
    """
    pieces = [(low, turn)]
    if c > 100.0:
        edge = np.geomspace(low, turn, 4000)
        smooth = np.abs(strong_coupling_sum(edge / math.sqrt(c)) + shift) - target
        near = np.abs(smooth) < 8.0 * edge / c**1.5 + 4.0 / math.sqrt(c)
        near |= np.diff(smooth > 0, append=smooth[-1] > 0)
        near[1:] |= near[:-1].copy()
        near[:-1] |= near[1:].copy()
        begin = np.flatnonzero(near & ~np.append(False, near[:-1]))
        end = np.flatnonzero(near & ~np.append(near[1:], False))
        pieces = list(zip(edge[begin].tolist(), edge[end].tolist(), strict=True))
    counts = [2 + math.ceil((1.0 / a - 1.0 / b) / wiggle) for a, b in pieces]
    if sum(counts) > MAX_POINTS:
        raise PrecisionError(
            f"the velocities at c = {c:.6g}, |Sum| = {target:.6g} need more than {MAX_POINTS} "
            "values of the sum to be told apart; simulate the front, or take a smaller c."
        )
    filled = [np.linspace(1.0 / a, 1.0 / b, n) for (a, b), n in zip(pieces, counts, strict=True)]
    return -np.log(np.concatenate(filled)) if filled else np.empty(0)


def _lowest_velocity(c: float, target: float, shift: float) -> float:
    """Return v below which Σ is too near Σ(0⁺) for a solution (exponentially flat in 1/v)."""
    gap = max(abs(abs(static_sum(c) + shift) - target), NEAREST_TO_PINNING)
    # The bound theory.piecewise.limits.static_sum_distance, 2e/(1 - e), equal to the gap.
    low = 0.5 / math.log1p(2.0 / gap)
    if c <= 3.0:
        return low
    high = math.sqrt(c)
    if _distance_on_contour(low, c) > 0.5 * gap:
        return low
    for _ in range(12):  # a sharper bound for large c, where the plain one costs many points
        middle = math.sqrt(low * high)
        if _distance_on_contour(middle, c) > 0.5 * gap:
            high = middle
        else:
            low = middle
    return low


_SIGMA = np.arange(-30.0, 30.0, 0.25)
_SQUARE = 1j * np.exp(2.0 * _SIGMA)
_X = _SQUARE / (1.0 + _SQUARE)
_LENGTH = 0.25 / np.abs(np.cosh(_SIGMA + 0.25j * np.pi)) / np.pi


def _distance_on_contour(v: float, c: float) -> float:
    """Return the bound of ``static_sum_distance`` pointwise on the path of ``sums.precise``."""
    A = 0.5 - 2j * c * _X
    e = np.exp(-A.real / v)
    return float(np.sum(_LENGTH * e * (np.abs(1.0 - 2.0 * _X) + e) / (np.abs(A) * (1.0 - e) ** 2)))


def _brackets(
    relation: _Relation, owner: IntArray, cells: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Divide cells (rows t, g, dg/dt, error at both ends) until each holds one solution or none."""
    done_owner, done_cells = [], []
    while owner.size:
        ta, ga, da, ea, tb, gb, db, eb = cells
        width = tb - ta
        # Where |Σ| is lost in rounding a sign means nothing.
        differ = (ga > 0) != (gb > 0)
        steepest = np.maximum(np.abs(da), np.abs(db))
        flattest = np.minimum(np.abs(da), np.abs(db))
        safe = ~differ & (np.minimum(np.abs(ga), np.abs(gb)) > width * steepest)
        monotone = differ & (np.sign(da) == np.sign(db)) & (np.abs(da - db) < 0.5 * flattest)
        monotone &= np.sign(da) == np.sign(gb - ga)
        short = width < _SHORTEST
        found = monotone | (short & differ)
        # A short cell of one sign whose end is zero to within rounding is a fold touched exactly.
        touched = short & ~differ & (np.minimum(np.abs(ga) - ea, np.abs(gb) - eb) <= 0)
        # One a scene and round is enough: its neighbours are the same fold.
        touches = np.flatnonzero(touched)
        touches = touches[np.unique(owner[touches], return_index=True)[1]]
        done_owner += [owner[found], owner[touches]]
        done_cells += [cells[:, found], cells[:, touches]]
        rest = ~(safe | found | short)
        owner, cells = owner[rest], cells[:, rest]
        if owner.size:
            middle_t = 0.5 * (cells[0] + cells[4])
            middle = np.stack([middle_t, *relation(owner, middle_t)[:3]])
            cells = np.concatenate(
                [np.concatenate([cells[:4], middle]), np.concatenate([middle, cells[4:]])], axis=1
            )
            owner = np.concatenate([owner, owner])
    return np.concatenate(done_owner), np.concatenate(done_cells, axis=1)


def _told_apart(
    relation: _Relation, owner: IntArray, cells: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Sort the brackets; of neighbours between which g is zero to within rounding keep the outer.

    Beside a fold the computed g changes sign many times over by rounding alone. A run of such
    brackets is a pair if g has the same sign on both sides of it, and one solution if not.
    """
    order = np.lexsort((cells[0], owner))
    owner, cells = owner[order], cells[:, order]
    if owner.size < 2:
        return owner, cells
    between = 0.5 * (cells[4, :-1] + cells[0, 1:])
    g, _, e = relation(owner[:-1], between)[:3]
    flat = np.maximum(np.abs(cells[5, :-1]), np.abs(cells[1, 1:])) <= 2.0 * e
    joined = (owner[:-1] == owner[1:]) & flat & (np.abs(g) <= 2.0 * e)
    kept: list[int] = []
    for run in np.split(np.arange(owner.size), np.flatnonzero(~joined) + 1):
        same = (cells[1, run[0]] > 0) == (cells[5, run[-1]] > 0)
        kept += [run[0], run[-1]] if same and run.size > 1 else [run[run.size // 2]]
    return owner[kept], cells[:, kept]


def _polish(relation: _Relation, owner: IntArray, cells: FloatArray) -> Solutions:
    """Refine each bracket by Newton kept inside it, then bound the error by a change of sign."""
    owner, cells = _told_apart(relation, owner, cells)
    ta, ga, _, _, tb, gb, _, _ = (row.copy() for row in cells)
    t = np.where(ga == gb, ta, ta - ga * (tb - ta) / np.where(ga == gb, 1.0, gb - ga))
    here = relation(owner, t)
    for _ in range(30):
        left = (here.g > 0) == (ga > 0)
        ta, tb = np.where(left, t, ta), np.where(left, tb, t)
        steep = np.where(here.by_t == 0, 1.0, here.by_t)
        newton = t - here.g / steep
        inside = (newton >= ta) & (newton <= tb) & (here.by_t != 0)
        new = np.where(inside, newton, 0.5 * (ta + tb))
        rounding = 4e-16 * np.maximum(1.0, np.abs(t)) + 0.5 * here.error / np.abs(steep)
        settled = np.abs(new - t) <= rounding
        if np.all(settled):
            break
        t = np.where(settled, t, new)
        here = relation(owner, t)
    spread, beside = _confirmed_spread(relation, owner, t, here)
    v = np.exp(t)
    along_c, along_target = _errors_along(v, spread, here, beside)
    return Solutions(
        scene=owner,
        v=v,
        error=v * spread,
        slope=here.by_t / v,
        by_coupling=here.by_c,
        error_along_coupling=along_c,
        error_along_target=along_target,
        evaluations=relation.evaluations,
    )


def _confirmed_spread(
    relation: _Relation, owner: IntArray, t: FloatArray, here: _Values
) -> tuple[FloatArray, tuple[_Values, _Values]]:
    """Return δ such that g at t - δ and t + δ differs in sign beyond its error, and both values."""
    floor = 4.0 * np.finfo(float).eps * np.maximum(1.0, np.abs(t))
    steep = np.where(here.by_t == 0, 1e-300, np.abs(here.by_t))
    spread = np.minimum(floor + 2.5 * (np.abs(here.g) + here.error) / steep, 1e-3)
    beside = relation(owner, t - spread), relation(owner, t + spread)
    for _ in range(11):
        below, above = beside
        sure = (np.abs(below.g) > below.error) & (np.abs(above.g) > above.error)
        sure &= (below.g > 0) != (above.g > 0)
        if np.all(sure):
            break
        spread = np.where(sure, spread, 2.0 * spread)
        beside = relation(owner, t - spread), relation(owner, t + spread)
    return spread, beside


def _errors_along(
    v: FloatArray, spread: FloatArray, here: _Values, beside: tuple[_Values, _Values]
) -> tuple[FloatArray, FloatArray]:
    """Bound the errors of ∂v/∂c and ∂v/∂target, computed at v, at the true velocity.

    That lies within the spread, where the derivatives of g are taken to be between those at its
    middle and its ends.
    """
    values = (here, *beside)
    steep = np.stack([each.by_t + s * each.error_by_t for each in values for s in (-1.0, 1.0)])
    by_c = np.stack([each.by_c + s * each.error_by_c for each in values for s in (-1.0, 1.0)])
    decided = (steep.min(axis=0) > 0) | (steep.max(axis=0) < 0)
    inverse = v / np.where(decided, np.stack([steep.min(axis=0), steep.max(axis=0)]), 1.0)
    middle = v / np.where(decided, here.by_t, 1.0)
    rounding = (spread + 1e-15) * np.abs(inverse).max(axis=0)  # and v itself changes by its error
    along_target = np.abs(inverse - middle).max(axis=0) + rounding
    corners = inverse[:, None] * np.stack([by_c.min(axis=0), by_c.max(axis=0)])
    along_c = np.abs(corners - middle * here.by_c).max(axis=(0, 1))
    along_c += rounding * np.abs(by_c).max(axis=0)
    return np.where(decided, along_c, np.inf), np.where(decided, along_target, np.inf)
