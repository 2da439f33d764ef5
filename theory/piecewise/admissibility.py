"""Whether a front obeys its own assumption (47): |φ| > φ_us behind and |φ| < φ_us ahead, for all ζ.

Far from ζ = 0 a bound on the tails proves it. In between, |φ|² - r² is evaluated at points a
fraction of a site apart. Each cell between two points is bisected until the margin of (47) cannot
fall below zero within it by more than the tolerance, or until a violation is found.

* Where the quadrature of ``theory.piecewise.profile`` needs few points, it provides values and
  slopes at all ζ up to where ``tail_bound`` suffices. It is assumed that the slopes within a cell
  are at most twice those at its ends.
* Where it needs many points, at strong coupling or high velocity, values within two sites of ζ = 0
  and wherever margins are thin come from ``theory.piecewise.steepest_descent``, with a bound on how
  far φ departs from its chord within a cell. Elsewhere φ is the sum (49) over the roots: a few
  terms vary slowly, over about √c sites, and the sum of the moduli of all others falls with |ζ|
  (``far_field``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from theory.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from theory.piecewise.far_field import MAX_CELLS, NEAR, FarField
from theory.piecewise.profile import (
    ProfileGrid,
    profile_slope,
    required_points,
    smooth_number,
    tail_bound,
)
from theory.piecewise.roots import PARAMETERS
from theory.piecewise.steepest_descent import NearShape

TOLERANCE = 1e-11
"""Largest violation of (47), in |φ/φ_s|², that may go undetected."""
_PER_SITE = 8
_SHORTEST = 1e-7
_LONGEST_GRID = 1200
"""Number of quadrature points above which steepest descent is faster."""
_MAX_LABEL = 10**10
"""Largest label of a root, about c/v; at larger c/v the phases c/v lose too many digits."""
_VALUES_AT_ONCE = 1 << 16
"""Number of values of φ held at once, so that they fit the processor's cache."""


@dataclass(frozen=True)
class Admissibility:
    """The verdict on assumption (47).

    Attributes
    ----------
    admissible : bool or None
        Whether (47) holds; None where too many margins are too thin to decide, or |v| or c/|v| is
        out of range, as ``reason`` says.
    fails_at : float or None
        A position ζ, in sites, at which (47) is violated: the one nearest 0 of those examined, at
        least eight to a site unless steepest descent is used; 0 where the slope at ζ = 0 already
        has the wrong sign; None if there is no violation.
    proven_beyond : tuple of float
        (Z₋, Z₊): for ζ < -Z₋ and ζ > Z₊ the tail bound proves (47).
    points : int
        Number of values of φ computed.
    reason : str or None
        Why ``admissible`` is not decided.
    """

    admissible: bool | None
    fails_at: float | None
    proven_beyond: tuple[float, float]
    points: int
    reason: str | None = None


def check_admissible(v: float, c: float, r: float) -> Admissibility:
    """Decide whether the front of velocity v satisfies (47) for every ζ.

    Parameters
    ----------
    v, c : float
        Front velocity v̂, a solution of (54), and coupling. The shape of a retreating front,
        v < 0, is 1 - φ(-ζ), where φ is the shape at velocity -v.
    r : float
        Threshold |φ_us|/|φ_s|, 0 < r < 1.

    Examples
    --------
    >>> check_admissible(0.3009923508929, 0.5, 0.2679491924311227).admissible
    True
    """
    (verdict,) = check_fronts(np.array([v]), np.array([c]), np.array([r]))
    return verdict


def check_fronts(v: FloatArray, c: FloatArray, r: FloatArray) -> list[Admissibility]:
    """Return :func:`check_admissible` for many fronts.

    Fronts whose quadratures have the same number of points are checked together.

    Parameters
    ----------
    v, c, r : ndarray of float, shape (n,)
        Front velocities v̂, couplings and thresholds.
    """
    verdicts: dict[int, Admissibility] = {}
    reach, points = _quadratures(v, c, r)
    for i in (points == 0).nonzero()[0].tolist():
        verdicts[i] = _check_by_descent(float(v[i]), float(c[i]), float(r[i]))
    signed_points = np.where(v < 0, -points, points)
    for shared_points in set(signed_points[points > 0].tolist()):
        (fronts,) = (signed_points == shared_points).nonzero()
        batch_size = max(1, _VALUES_AT_ONCE // (_PER_SITE * abs(shared_points)))
        for first in range(0, fronts.size, batch_size):
            batch = fronts[first : first + batch_size]
            column = np.abs(v[batch, None]), c[batch, None]
            shape = _Shape(
                ProfileGrid.of_points(*column, abs(shared_points), TOLERANCE), shared_points < 0
            )
            found = _check_on_grid(shape, r[batch], reach[batch])
            verdicts |= zip(batch.tolist(), found, strict=True)
    return [verdicts[i] for i in range(v.size)]


def _quadratures(v: FloatArray, c: FloatArray, r: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the distances (Z₋, Z₊) beyond which tails prove (47), shape (n, 2), and the points.

    The number of points is 0 where steepest descent is faster, or where |v| is out of range.
    """
    speed = np.minimum(np.maximum(np.abs(v), PARAMETERS.low), PARAMETERS.high)
    tails = [tail_bound(_number(speed), _number(c), side) for side in (False, True)]
    rate, prefactor = np.reshape(tails, (2, 2, v.size)).swapaxes(0, 1)
    slowest_rate, largest_prefactor = rate.min(axis=0), prefactor.max(axis=0)
    backward = v < 0
    if backward.any():
        rate, prefactor = (np.where(backward, row[::-1], row) for row in (rate, prefactor))
    required_distance = np.log(np.maximum(prefactor / np.array([1.0 - r, r]), 1.0)) / rate
    reach = np.maximum(1.0, np.ceil(required_distance)).T
    by_quadrature = (30.0 / slowest_rate <= _LONGEST_GRID) & (speed == np.abs(v))
    points = np.zeros(v.size, dtype=np.int64)
    extent = reach.max(axis=1)[by_quadrature] + 2.0
    required = required_points(
        extent, TOLERANCE, slowest_rate[by_quadrature], largest_prefactor[by_quadrature]
    )
    points[by_quadrature] = smooth_number(np.maximum(required, 2.0 * extent + 2.0))
    return reach, points


def _number(column: FloatArray) -> Any:
    """Return an array of one element as a number, for which functions are faster."""
    return column.item() if column.size == 1 else column


def _check_on_grid(shape: _Shape, r: FloatArray, reach: FloatArray) -> list[Admissibility]:
    """Decide by quadrature; ``reach`` holds (Z₋, Z₊) of each front, shape (n, 2)."""
    behind, ahead = (int(sites) + 1 for sites in reach.max(axis=0))
    zeta, phi = shape.on_lattice((behind, ahead))
    lattice_points = zeta.size
    slope = shape.slope(
        zeta[_PER_SITE:-_PER_SITE],
        phi[:, _PER_SITE:-_PER_SITE],
        phi[:, 2 * _PER_SITE :] + phi[:, : -2 * _PER_SITE],
    )
    zeta, phi = zeta[_PER_SITE:-_PER_SITE], phi[:, _PER_SITE:-_PER_SITE]
    inside = (zeta >= -reach[:, :1]) & (zeta <= reach[:, 1:])
    fails_at, bisection_points, _ = _first_violations(shape, zeta, (phi, slope), r, inside)
    points = lattice_points + bisection_points
    return [
        Admissibility(place == math.inf, None if place == math.inf else place, (left, right), count)
        for place, (left, right), count in zip(
            fails_at.tolist(), reach.tolist(), points.tolist(), strict=True
        )
    ]


def _check_by_descent(v: float, c: float, r: float) -> Admissibility:
    """Decide by steepest descent near ζ = 0, and by the sums over roots beyond."""
    reason = None
    if not PARAMETERS.low <= abs(v) <= PARAMETERS.high:
        reason = f"velocities above {PARAMETERS.high:g} are not examined"
    elif c > _MAX_LABEL * abs(v):
        reason = f"fronts with c/v above {_MAX_LABEL:g} are not examined"
    if reason is not None:
        return Admissibility(None, None, (math.inf, math.inf), 0, reason)
    shape = _Descent(NearShape(v, c))
    innermost = 0.02 * min(1.0, abs(v) / c)
    distances = np.geomspace(innermost, NEAR, 2 + math.ceil(3.0 * math.log(NEAR / innermost)))
    distances = np.union1d(distances, 1.0)  # so that no cell has a site in its interior
    zeta = np.concatenate([-distances[::-1], [0.0], distances])
    fails_at, points, decided = _first_violation(shape, zeta, r)
    speed, advancing = abs(v), v > 0
    behind = FarField.make(speed, c, not advancing, 1.0)
    ahead = FarField.make(speed, c, advancing, 0.0)
    beyond = (behind.reach(r)[1], ahead.reach(r)[1])
    if fails_at is not None:
        return Admissibility(False, fails_at, beyond, points)
    far_violations = []
    for side, sign in ((behind, -1.0), (ahead, 1.0)):
        proven = side.proven(r)
        far_violations += [sign * proven.fails_at] if proven.fails_at is not None else []
        if proven.thin.shape[1] > MAX_CELLS:
            decided = False
        elif proven.thin.size:
            found, evaluated, resolved = _along_stretches(shape, sign * proven.thin, r)
            decided &= resolved
            points += evaluated
            far_violations += [found] if found is not None else []
    if far_violations:
        return Admissibility(False, min(far_violations, key=abs), beyond, points)
    if decided and max(beyond) < math.inf:
        return Admissibility(True, None, beyond, points)
    reason = "margins are below the bound on the terms left out over too many sites"
    return Admissibility(None, None, beyond, points, reason)


def _along_stretches(shape: _Descent, ends: FloatArray, r: float) -> tuple[float | None, int, bool]:
    """Decide within intervals shorter than a site, given by their ends, shape (2, n)."""
    low, high = np.sort(ends, axis=0)
    site = np.ceil(low)
    crosses_site = (low < site) & (site < high)
    cells = np.stack(
        [
            np.append(low, site[crosses_site]),
            np.append(np.where(crosses_site, site, high), high[crosses_site]),
        ]
    )
    g, d = _margin(cells.ravel(), *shape.with_slope(cells.ravel()), r)
    pairs = np.stack([cells, g.reshape(2, -1), d.reshape(2, -1)])
    owner = np.zeros(cells.shape[1], dtype=np.int64)
    rows = np.concatenate([pairs[:, 0], pairs[:, 1]])
    found, evaluated, resolved = _divide(shape, rows, owner, np.array([r]))
    place = float(found[0])
    return (None if place == math.inf else place), int(evaluated[0]) + cells.size, bool(resolved[0])


@dataclass(frozen=True)
class _Descent:
    """The front φ(ζ)/φ_s of either direction, by steepest descent."""

    near: NearShape
    max_values: ClassVar[float] = 3 * MAX_CELLS
    """Number of values of φ after which no cell is divided any more."""
    values_each: ClassVar[int] = 1

    @property
    def velocity(self) -> float:
        """Velocity v̂."""
        return self.near.v

    @property
    def shortest(self) -> float:
        """Length of a cell that is not divided."""
        return _SHORTEST * min(1.0, abs(self.near.v) / self.near.c)

    def shorter_than_waves(self, owner: IntArray) -> FloatArray:
        """Return 0: for no cell do the slopes at its ends suffice to bound φ within."""
        return np.zeros(owner.shape)

    def tolerance(self, zeta: FloatArray, r: FloatArray) -> FloatArray:
        """Bound the error of |φ|² - r² near 0."""
        error = self.near.error(zeta.ravel()).reshape(zeta.shape)
        return np.maximum(3.0 * error, TOLERANCE) * r

    def safe(self, cells: FloatArray, g: FloatArray, r: FloatArray) -> BoolArray:
        """Return whether |φ| stays on its side of r, given how far it departs from the chord."""
        zeta = cells[::3]
        change, chord_deviation = self.near.spread(zeta)
        side = np.where(zeta.mean(axis=0) < 0.0, 1.0, -1.0)
        # |φ|² on the chord is convex: it is at most its larger end value, and at least the smaller
        # one minus a quarter of the squared change of φ.
        square = r * r + side * g.min(axis=0) - np.where(side > 0.0, 0.25 * change**2, 0.0)
        safe: BoolArray = side * (np.sqrt(np.maximum(square, 0.0)) - r) > chord_deviation
        return safe

    def with_slope(
        self, zeta: FloatArray, front: IntArray | None = None
    ) -> tuple[ComplexArray, ComplexArray]:
        """Return φ and dφ/dζ at ζ; at ζ = 0 the derivative just ahead."""
        del front
        return self.near.with_slope(zeta)


@dataclass(frozen=True)
class _Shape:
    """Fronts φ(ζ)/φ_s of either direction, one row each, by the quadrature for advancing fronts."""

    grid: ProfileGrid
    retreating: bool
    max_values: ClassVar[float] = math.inf
    values_each: ClassVar[int] = 3
    """Number of values of φ that are computed for one value with its slope."""

    @property
    def velocity(self) -> FloatArray:
        """Velocities v̂, shape (n, 1)."""
        return np.asarray(-self.grid.v if self.retreating else self.grid.v)

    @property
    def shortest(self) -> float:
        """Length of a cell that is not divided."""
        return _SHORTEST

    def shorter_than_waves(self, owner: IntArray) -> FloatArray:
        """Return a sixth of the shortest wavelength of φ, whose phase turns by 2c/v per site."""
        length: FloatArray = np.abs(self.velocity[owner, 0]) / (2.0 * self.grid.c[owner, 0])
        return length

    def tolerance(self, zeta: FloatArray, r: FloatArray) -> float:
        """Bound the error of |φ|² - r² near 0."""
        del zeta, r
        return TOLERANCE

    def safe(self, cells: FloatArray, g: FloatArray, r: FloatArray) -> BoolArray:
        """Return in which cells g stays positive, with slopes at most twice those at the ends."""
        del r
        safe: BoolArray = np.minimum(*g) > (cells[3] - cells[0]) * np.maximum(*np.abs(cells[2::3]))
        return safe

    def on_lattice(self, sites: tuple[int, int] | None = None) -> tuple[FloatArray, ComplexArray]:
        """Return ζ and φ, shape (n, m), at eight points a site; see `ProfileGrid.on_lattice`."""
        if sites is not None and self.retreating:
            sites = sites[1], sites[0]
        zeta, phi = self.grid.on_lattice(_PER_SITE, sites)
        if self.retreating:
            zeta, phi = -zeta[::-1], 1.0 - phi[..., ::-1]
        return zeta, phi

    def slope(self, zeta: FloatArray, phi: ComplexArray, neighbours: ComplexArray) -> ComplexArray:
        """Return dφ/dζ of all fronts, shape (n, m); at ζ = 0 the derivative just ahead."""
        return profile_slope(zeta, phi, neighbours, self.velocity, self.grid.c)

    def with_slope(self, zeta: FloatArray, front: IntArray) -> tuple[ComplexArray, ComplexArray]:
        """Return φ and dφ/dζ at ζ, shape (m,), of one front each; at ζ = 0 the slope just ahead."""
        phi, neighbours = self.grid.with_neighbours(-zeta if self.retreating else zeta, front)
        if self.retreating:
            phi, neighbours = 1.0 - phi, 2.0 - neighbours
        v, c = self.velocity[front, 0], self.grid.c[front, 0]
        return phi, profile_slope(zeta, phi, neighbours, v, c)


def _margin(
    zeta: FloatArray, phi: ComplexArray, slope: ComplexArray, r: float | FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the margin g of (47) and its slope: |φ|² - r² behind, and its negative ahead."""
    side = np.where(zeta < 0, 1.0, -1.0)
    return side * (np.abs(phi) ** 2 - r * r), side * 2.0 * (phi.conj() * slope).real


def _first_violation(shape: _Descent, zeta: FloatArray, r: float) -> tuple[float | None, int, bool]:
    """Return, of one front, the violation nearest 0, the number of values, and whether decided."""
    phi, slope = shape.with_slope(zeta)
    inside = np.ones((1, zeta.size), dtype=bool)
    values = phi[None], slope[None]
    fails_at, evaluated, decided = _first_violations(shape, zeta, values, np.array([r]), inside)
    place = float(fails_at[0])
    return None if place == math.inf else place, zeta.size + int(evaluated[0]), bool(decided[0])


def _first_violations(
    shape: _Shape | _Descent, zeta: FloatArray, values: tuple[ComplexArray, ComplexArray],
    r: FloatArray, inside: BoolArray,
) -> tuple[FloatArray, IntArray, BoolArray]:  # fmt: skip
    """Return the results of `_divide` for the cells between successive ζ.

    ``values`` holds φ and its slope, shape (n, m), at ζ, which ascends through 0; cells that are
    not ``inside`` are not checked.
    """
    phi, slope = values
    g, d = _margin(zeta, phi, slope, r[:, None])
    origin = int(np.searchsorted(zeta, 0.0))
    # At ζ = 0 the threshold is crossed: g = 0, and the slope behind differs from the one ahead
    # because of the jump of θ in (48). Where either slope has the wrong sign, (47) fails at once.
    jump = (phi[:, origin].conj() * (-0.5 / np.ravel(shape.velocity))).real
    d_behind = -d[:, origin] + 2.0 * jump
    wrong = (d[:, origin] < 0) | (d_behind > 0)
    g[:, origin] = 0.0
    right_slope = d.copy()  # slopes at the right end of a cell
    right_slope[:, origin] = d_behind
    owner, cell = (inside[:, :-1] & inside[:, 1:] & ~wrong[:, None]).nonzero()
    index = owner * zeta.size + cell  # index into the flattened rows
    cells = np.array(
        [
            zeta.take(cell), g.take(index), d.take(index),
            zeta.take(cell + 1), g.take(index + 1), right_slope.take(index + 1),
        ]
    )  # fmt: skip
    fails_at, evaluated, decided = _divide(shape, cells, owner, r)
    fails_at[wrong] = 0.0
    return fails_at, evaluated, decided


def _divide(
    shape: _Shape | _Descent, cells: FloatArray, owner: IntArray, r: FloatArray
) -> tuple[FloatArray, IntArray, BoolArray]:
    """Bisect cells (rows ζ, g, dg/dζ at both ends) until each is safe or a violation is found.

    A margin below zero by less than the tolerance is not a violation, since φ may rest at the
    threshold as v → 0. ``owner`` is the index of the front of each cell. The results, one for each
    front, are the violation nearest 0, or ∞; the number of values of φ computed; and whether the
    front was decided, that is, no cell was left when that number exceeded ``max_values``.
    """
    evaluated, nearest_violation = np.zeros(r.size, dtype=np.int64), np.full(r.size, math.inf)
    while True:
        zeta, r_ = cells[::3], r[owner]
        tolerance = shape.tolerance(zeta, r_)
        _record_violations(zeta, cells[1::3] < -tolerance, owner, nearest_violation)
        g, width = cells[1::3] + tolerance, zeta[1] - zeta[0]
        smallest_margin, safe = np.minimum(g[0], g[1]), shape.safe(cells, g, r_)
        (open_,) = (~safe & (smallest_margin >= 0.0) & (width > shape.shortest)).nonzero()
        distance = np.minimum(*np.abs(zeta.take(open_, axis=1)))
        open_ = open_[distance < np.abs(nearest_violation[owner[open_]])]
        cells, owner = cells.take(open_, axis=1), owner.take(open_)
        short = (width[open_] < shape.shorter_than_waves(owner)) & (smallest_margin[open_] > 0.0)
        (remaining,) = (~_positive_within(cells, short)).nonzero()
        cells, owner = cells.take(remaining, axis=1), owner.take(remaining)
        if owner.size == 0:
            return nearest_violation, evaluated, np.ones(r.size, dtype=bool)
        if evaluated.max() > shape.max_values:
            return nearest_violation, evaluated, np.bincount(owner, minlength=r.size) == 0
        evaluated += shape.values_each * np.bincount(owner, minlength=r.size)
        middle = 0.5 * (cells[0] + cells[3])
        midpoint = np.array([middle, *_margin(middle, *shape.with_slope(middle, owner), r[owner])])
        cells = np.concatenate(
            [np.concatenate([cells[:3], midpoint]), np.concatenate([midpoint, cells[3:]])], axis=1
        )
        owner = np.concatenate([owner, owner])


def _positive_within(cells: FloatArray, short: BoolArray) -> BoolArray:
    """Return in which cells g, positive at the ends or zero at ζ = 0, is positive in between.

    In a ``short`` cell this is concluded if the slopes agree with each other and with the change of
    g; in a cell that touches ζ = 0, if g/|ζ| would stay positive even if its slope were twice as
    large as the larger of its slope at the far end and that of its chord.
    """
    za, ga, da, zb, gb, db = cells
    width = zb - za
    slope_sum = da + db
    monotone = np.abs(da - db) < 0.5 * np.minimum(np.abs(da), np.abs(db))
    monotone &= np.abs(gb - ga - 0.5 * width * slope_sum) < 0.25 * width * np.abs(slope_sum)
    ahead, behind = za == 0.0, zb == 0.0
    start, end = np.where(ahead, da, -db), np.where(ahead, db, -da)  # rates away from ζ = 0
    rate = (ga + gb) / width
    rising = np.minimum(start, rate) > np.maximum(np.abs(end - rate), np.abs(rate - start))
    positive: BoolArray = (monotone & short) | (rising & (ahead | behind))
    return positive


def _record_violations(
    zeta: FloatArray, violated: BoolArray, owner: IntArray, nearest_violation: FloatArray
) -> None:
    """Record in ``nearest_violation`` the violation of each front that is nearest 0 so far.

    ``zeta`` and ``violated`` have any number of rows; ``owner`` gives the front of each column.
    """
    found = violated.nonzero()
    if found[0].size == 0:
        return
    places, owners = zeta[found], owner[found[-1]]
    order = np.lexsort((-places, -np.abs(places)))  # the nearest comes last and wins
    nearer = order[np.abs(places[order]) < np.abs(nearest_violation[owners[order]])]
    nearest_violation[owners[nearer]] = places[nearer]
