"""Whether a front obeys its own assumption (47): |φ| > φ_us behind and |φ| < φ_us ahead, for all ζ.

Far out a bound on the tails proves it. Between, |φ|² - r² and its exact slope, from (48), are taken
at points a fraction of a site apart, and a cell is divided until its slopes cannot bring it below
zero by more than the tolerance, or a violation is seen: those at its ends, twice, and with the sums
below also a bound on all within.

* Where the quadrature of ``theory.piecewise.profile`` is short, values come from it, over the whole
  way to where its ``tail_bound`` suffices.
* Where it is long, at strong coupling or high velocity, φ is the sum (49) over the roots, of which
  those with a label up to a few c/v are taken and the rest is bounded. Values are needed only
  within two sites of ζ = 0 and where margins are thin. Beyond, a few terms vary slowly, over
  about √c sites, and the sum of the moduli of all others falls with |ζ| (``_Side.proven``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from theory.piecewise.dispersion import ComplexArray, FloatArray
from theory.piecewise.profile import (
    ProfileGrid,
    profile_slope,
    required_points,
    smooth_number,
    tail_bound,
)
from theory.piecewise.roots import LARGEST, SMALLEST, IntArray, labelled_roots
from theory.piecewise.sums.integral import sums

TOLERANCE = 1e-11
"""What a front may violate (47) by unseen, in |φ/φ_s|²."""
_PER_SITE = 8
_SHORTEST = 1e-7
_NEGLIGIBLE = 1e-11
"""Sum of the moduli of terms that are left out as they are small."""
_ORDERS = 5
"""Times that what is left out of a sum is summed by parts."""
_LONGEST_GRID = 1200
"""Points of the quadrature from which the sum over roots is shorter."""
_NEAR = 2.0
"""Sites about ζ = 0 where values are always taken."""
_LABELS = 9.0
"""Largest label of a root, over c/v; a third of it beyond ``_FEW_LABELS``."""
_FEW_LABELS = 400
_SLOW = 24
"""Terms of each sum that are followed beyond ``_NEAR``."""
_MAX_CELLS = 20_000
_MAX_TERMS = 600_000_000
"""Terms added up for one front, some seconds: slow fronts at strong coupling have waves so short
that each site is divided into tens of thousands of cells."""
_AT_ONCE = 1 << 20
"""Exponentials held in memory."""
_VALUES_AT_ONCE = 1 << 16
"""Values of φ held at once, near the processor."""


@dataclass(frozen=True)
class Admissibility:
    """The verdict on assumption (47).

    Attributes
    ----------
    admissible : bool or None
        None where too many margins are too thin to be told, or |v| is beyond 1e12; ``reason`` says
        so.
    fails_at : float or None
        The violation nearest ζ = 0 that was seen, in sites, to within an eighth of a site; 0 where
        the slope at ζ = 0 is already wrong; None if there is none.
    proven_beyond : tuple of float
        (Z₋, Z₊): for ζ < -Z₋ and ζ > Z₊ the tail bound proves (47).
    points : int
        Values of φ computed.
    reason : str or None
        Why it is not decided.
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
        v < 0, is 1 - φ(-ζ) with φ that of -v.
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

    Fronts whose quadrature has the same number of points are looked at together.

    Parameters
    ----------
    v, c, r : ndarray of float, shape (n,)
        Front velocities v̂, couplings and thresholds.
    """
    verdicts: dict[int, Admissibility] = {}
    reach, points = _quadratures(v, c, r)
    for i in (points == 0).nonzero()[0].tolist():
        verdicts[i] = _check_by_roots(float(v[i]), float(c[i]), float(r[i]))
    kind = np.where(v < 0, -points, points)
    for alike in set(kind[points > 0].tolist()):
        (fronts,) = (kind == alike).nonzero()
        most = max(1, _VALUES_AT_ONCE // (_PER_SITE * abs(alike)))
        for first in range(0, fronts.size, most):
            some = fronts[first : first + most]
            column = np.abs(v[some, None]), c[some, None]
            shape = _Shape(ProfileGrid.of_points(*column, abs(alike), TOLERANCE), alike < 0)
            found = _check_on_grid(shape, r[some], reach[some])
            verdicts |= zip(some.tolist(), found, strict=True)
    return [verdicts[i] for i in range(v.size)]


def _quadratures(v: FloatArray, c: FloatArray, r: FloatArray) -> tuple[FloatArray, IntArray]:
    """Return the distances (Z₋, Z₊) beyond which tails prove (47), shape (n, 2), and the points.

    No points where the sum over roots is shorter, or where |v| is out of range.
    """
    speed = np.clip(np.abs(v), SMALLEST, LARGEST)
    tails = [tail_bound(_number(speed), _number(c), side) for side in (False, True)]
    rate, size = np.reshape(tails, (2, 2, v.size)).swapaxes(0, 1)
    slowest, largest = rate.min(axis=0), size.max(axis=0)
    backward = v < 0
    if backward.any():
        rate, size = (np.where(backward, row[::-1], row) for row in (rate, size))
    enough = np.log(np.maximum(size / np.array([1.0 - r, r]), 1.0)) / rate
    reach = np.maximum(1.0, np.ceil(enough)).T
    short = (30.0 / slowest <= _LONGEST_GRID) & (speed == np.abs(v))
    points = np.zeros(v.size, dtype=np.int64)
    extent = reach.max(axis=1)[short] + 2.0
    required = required_points(extent, TOLERANCE, slowest[short], largest[short])
    points[short] = smooth_number(np.maximum(required, 2.0 * extent + 2.0))
    return reach, points


def _number(column: FloatArray) -> Any:
    """Return an array of one number as that: functions of numbers are faster."""
    return column.item() if column.size == 1 else column


def _check_on_grid(shape: _Shape, r: FloatArray, reach: FloatArray) -> list[Admissibility]:
    """Decide by quadrature; ``reach`` are the distances (Z₋, Z₊) of each front, shape (n, 2)."""
    behind, ahead = (int(sites) + 1 for sites in reach.max(axis=0))
    zeta, phi = shape.on_lattice((behind, ahead))
    taken = zeta.size
    slope = shape.slope(
        zeta[_PER_SITE:-_PER_SITE],
        phi[:, _PER_SITE:-_PER_SITE],
        phi[:, 2 * _PER_SITE :] + phi[:, : -2 * _PER_SITE],
    )
    zeta, phi = zeta[_PER_SITE:-_PER_SITE], phi[:, _PER_SITE:-_PER_SITE]
    inside = (zeta >= -reach[:, :1]) & (zeta <= reach[:, 1:])
    fails_at, more = _first_violations(shape, zeta, (phi, slope), r, inside)
    points = taken + more
    return [
        Admissibility(place == math.inf, None if place == math.inf else place, (left, right), count)
        for place, (left, right), count in zip(
            fails_at.tolist(), reach.tolist(), points.tolist(), strict=True
        )
    ]


def _check_by_roots(v: float, c: float, r: float) -> Admissibility:
    """Decide by the sums over roots."""
    if not SMALLEST <= abs(v) <= LARGEST:
        reason = f"velocities beyond {LARGEST:g} are not looked at"
        return Admissibility(None, None, (math.inf, math.inf), 0, reason)
    shape = _SumShape.make(v, c)
    smallest = 0.02 * min(1.0, abs(v) / c)
    near = np.geomspace(smallest, _NEAR, 2 + math.ceil(3.0 * math.log(_NEAR / smallest)))
    zeta = np.concatenate([-near[::-1], [0.0], near])
    fails_at, points = _first_violation(shape, zeta, shape.with_slope(zeta), r)
    beyond = (shape.behind.reach(r)[1], shape.ahead.reach(r)[1])
    decided = points <= shape.max_values
    points += 3 * zeta.size
    if fails_at is not None:
        return Admissibility(False, fails_at, beyond, points)
    if not decided:
        reason = "the waves of the front are too short for its values to be summed everywhere"
        return Admissibility(None, None, beyond, points, reason)
    sides = [shape.behind.proven(r), shape.ahead.proven(r)]
    farther = []
    for side, sign in zip(sides, (-1.0, 1.0), strict=True):
        farther += [sign * side.fails_at] if side.fails_at is not None else []
        decided &= side.thin.shape[1] <= _MAX_CELLS
        if side.thin.size and side.thin.shape[1] <= _MAX_CELLS:
            ends = np.sort(sign * side.thin, axis=0)
            g, d = _margin(ends.ravel(), *shape.with_slope(ends.ravel()), r)
            pairs = np.stack([ends, g.reshape(2, -1), d.reshape(2, -1)])
            cells = np.concatenate([pairs[:, 0], pairs[:, 1]])
            owner = np.zeros(cells.shape[1], dtype=np.int64)
            found, more = _divide(shape, cells, owner, np.array([r]))
            decided &= more[0] <= shape.max_values
            points += int(more[0]) + 3 * ends.size
            farther += found[found < math.inf].tolist()
    if farther:
        return Admissibility(False, min(farther, key=abs), beyond, points)
    if decided and max(beyond) < math.inf:
        return Admissibility(True, None, beyond, points)
    reason = "margins are below the bound on the terms left out over too many sites"
    return Admissibility(None, None, beyond, points, reason)


@dataclass(frozen=True)
class _Proven:
    """What the bound on all but a few terms says of one side, at distances from ``_NEAR`` on.

    Attributes
    ----------
    fails_at : float or None
        Least distance at which (47) was seen to fail.
    thin : ndarray of float, shape (2, n)
        Stretches before it where the margin is within the bound, from and to.
    """

    fails_at: float | None
    thin: FloatArray


@dataclass(frozen=True)
class _Side:
    """φ/φ_s on one side of ζ = 0: limit + Σ_j terms_j e^{rates_j a}, a = |ζ|.

    Attributes
    ----------
    limit : float
        0 ahead, 1 behind.
    terms, rates : ndarray of complex, shape (n,)
        The largest at a = ``_NEAR`` first; Re rates < 0.
    tail : float
        Bound on the sum of the moduli of all that is left out, at a = 0.
    differences : ndarray of float, shape (m,)
        Sums of the moduli of first, second, … differences, over the label, of what is left out.
    slopes : tuple of ndarray of float, shapes (p,)
        Distances, ascending from 0, and a bound on |dφ/da| from each of them on.
    """

    limit: float
    terms: ComplexArray
    rates: ComplexArray
    tail: float
    differences: FloatArray
    slopes: tuple[FloatArray, FloatArray]

    @classmethod
    def make(cls, speed: float, c: float, upper: bool, limit: float) -> _Side:
        """Take the roots of one half-plane, those of the upper two thirds of labels in part.

        Where v|k| > 6c, |cos k| ≥ 5 and |L_k| ≥ v|k|/2, so that a term is below 1/(v k²) and falls
        with a faster than 9^{-a}. The part taken goes down to 0 smoothly, which leaves between the
        sites an error far below the sum of moduli.
        """
        most = _LABELS * c / speed
        most = max(64, math.ceil(max(min(most, _FEW_LABELS), most / 3.0)))
        labels = np.arange(-most, most + 1)
        k = labelled_roots(speed, c, labels, upper).k
        terms = (0.5j if limit == 1.0 else -0.5j) / (k * (speed + c * np.sin(k)))
        rates = 1j * k if upper else -1j * k
        t = np.clip(1.5 * np.abs(labels) / most - 0.5, 0.0, 1.0)
        left_out = t**5 * (126.0 - t * (420.0 - t * (540.0 - t * (315.0 - 70.0 * t))))
        rest = left_out * terms
        differences = _sums_of_differences(rest[most:]) + _sums_of_differences(rest[most::-1])
        terms = terms * (1.0 - left_out)
        order = np.argsort(-np.abs(terms) * np.exp(_NEAR * rates.real))
        tail = 1.0 / (math.pi**2 * speed * (most // 3 - 0.5))
        terms, rates = terms[order], rates[order]
        knots = np.append(0.0, np.geomspace(1e-3 * min(1.0, speed / c), _NEAR, 48))
        steep = np.concatenate(
            [np.exp(np.outer(some, rates.real)) @ np.abs(terms * rates) for some in knots[:, None]]
        )
        return cls(limit, terms, rates, tail, differences, (knots, steep))

    def steepness(self, a: FloatArray) -> FloatArray:
        """Return a bound on |dφ/da| from the distances a on."""
        knots, steep = self.slopes
        bound: FloatArray = steep[np.searchsorted(knots, a, side="right") - 1]
        return bound

    def error(self, a: FloatArray) -> FloatArray:
        """Bound what is left out at distances a.

        By moduli, and by summation by parts, |Σ b_n e^{2πina}| ≤ Σ|Δ^m b_n|/|2 sin πa|^m.
        """
        apart = np.maximum(2.0 * np.abs(np.sin(np.pi * a)), 1e-30)
        orders = np.arange(1, _ORDERS + 1)
        by_parts = np.min(self.differences / apart[..., None] ** orders, axis=-1)
        bound: FloatArray = np.minimum(self.tail * 9.0**-a, by_parts) + _NEGLIGIBLE
        return bound

    def at(self, a: FloatArray) -> ComplexArray:
        """Return φ/φ_s at distances a ≥ 0, without the tail, shape (n,)."""
        value = np.full(a.shape, self.limit, dtype=complex)
        order = np.argsort(a)
        size = np.abs(self.terms)
        negligible = 0.5 * _NEGLIGIBLE / self.terms.size
        for some in np.array_split(order, 1 + a.size * self.terms.size // _AT_ONCE + a.size // 32):
            if some.size:
                kept = size * np.exp(self.rates.real * a[some[0]]) > negligible
                value[some] += np.exp(np.outer(a[some], self.rates[kept])) @ self.terms[kept]
        return value

    def reach(self, r: float) -> tuple[float, float]:
        """Return how far to look, and from where on (47) is proven by the sum of all moduli."""
        room = r if self.limit == 0.0 else 1.0 - r
        size, decay = np.abs(self.terms), self.rates.real
        far = _NEAR
        tail = self.tail * 9.0**-_NEAR
        least = max(room - tail, tail)  # where the tail is no proof, a look at the rest
        while float(size @ np.exp(decay * far)) >= least:
            far *= 1.5
        return far, far if tail < 0.5 * room else math.inf

    def proven(self, r: float) -> _Proven:
        """Follow the few slow terms outwards: their slope and the other moduli bound |φ|."""
        far, none = self.reach(r)[0], np.empty((2, 0))
        if far == _NEAR:
            return _Proven(None, none)
        size, decay = np.abs(self.terms), self.rates.real
        knots = np.geomspace(_NEAR, far, 64)
        rest = np.exp(np.outer(knots, decay[_SLOW:])) @ size[_SLOW:]
        rest += self.tail * 9.0**-_NEAR
        terms, rates = self.terms[:_SLOW], self.rates[:_SLOW]
        steepness = np.abs(terms * rates)
        a, b = knots[:-1], knots[1:]
        nearest, thin = math.inf, [none]
        while a.size:
            middle, width = 0.5 * (a + b), b - a
            size_ = np.abs(self.limit + np.exp(np.outer(middle, rates)) @ terms)
            margin = size_ - r if self.limit else r - size_
            others = rest[np.searchsorted(knots, a, side="right") - 1]  # falls with a
            slope = np.exp(np.outer(a, rates.real)) @ steepness
            failed = margin + others < 0.0
            if failed.any():
                nearest = min(nearest, float(middle[failed].min()))
            open_ = (margin <= 0.5 * slope * width + others) & (a < nearest)
            short = width < 1.0 / _PER_SITE
            thin.append(np.stack([a, b])[:, open_ & short & ~failed])
            open_ &= ~short
            a, middle, b = a[open_], middle[open_], b[open_]
            a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
            if a.size > _MAX_CELLS:
                thin.append(np.stack([a, b]))
                break
        stretches = np.concatenate(thin, axis=1)
        stretches = stretches[:, stretches[0] < nearest]
        return _Proven(nearest if nearest < math.inf else None, stretches)


def _sums_of_differences(terms: ComplexArray) -> FloatArray:
    """Return Σ|Δ^m b_n| for each order, doubled for the factor that falls with n at a > 0."""
    found = []
    for _ in range(_ORDERS):
        # Beyond the last label they fall: their sum is the last one of an order lower.
        beyond = float(abs(terms[-1]))
        terms = np.diff(terms)
        found.append(2.0 * (float(np.abs(terms).sum()) + beyond))
    return np.array(found)


@dataclass(frozen=True)
class _SumShape:
    """The front φ(ζ)/φ_s of either direction, as sums over roots."""

    velocity: float
    c: float
    behind: _Side
    ahead: _Side
    at_origin: complex

    @classmethod
    def make(cls, v: float, c: float) -> _SumShape:
        """Sum over the roots of both half-planes."""
        speed, advancing = abs(v), v > 0
        at_origin = -0.5 * complex(sums(np.array([speed]), np.array([c]), 1e-14).value[0])
        return cls(
            v,
            c,
            _Side.make(speed, c, not advancing, 1.0),
            _Side.make(speed, c, advancing, 0.0),
            at_origin if advancing else 1.0 - at_origin,
        )

    @property
    def shortest(self) -> float:
        """Length of a cell that is not divided."""
        return _SHORTEST * min(1.0, abs(self.velocity) / self.c)

    @property
    def max_values(self) -> float:
        """Values of φ after which no cell is divided any more."""
        return _MAX_TERMS / (self.behind.terms.size + self.ahead.terms.size)

    def shorter_than_waves(self, owner: IntArray) -> FloatArray:
        """Return 0: terms of any wavelength are added up here."""
        return np.zeros(owner.shape)

    def tolerance(self, zeta: FloatArray, r: FloatArray) -> FloatArray:
        """Bound the error of |φ|² - r² near 0."""
        a = np.abs(zeta)
        error = np.where(zeta < 0, self.behind.error(a), self.ahead.error(a))
        return np.where(zeta == 0.0, _NEGLIGIBLE * r, 3.0 * r * error)

    def steepness(self, ends: FloatArray) -> FloatArray:
        """Bound |dφ/dζ| between pairs of positions on one side, shape (2, n)."""
        a = np.abs(ends).min(axis=0)
        behind = ends[0] < 0
        bound: FloatArray = np.where(behind, self.behind.steepness(a), self.ahead.steepness(a))
        return bound

    def at(self, zeta: FloatArray) -> ComplexArray:
        """Return φ at ζ, shape (n,)."""
        phi = np.full(zeta.shape, self.at_origin)
        for side, mine in ((self.behind, zeta < 0), (self.ahead, zeta > 0)):
            phi[mine] = side.at(np.abs(zeta[mine]))
        return phi

    def with_slope(
        self, zeta: FloatArray, front: IntArray | None = None
    ) -> tuple[ComplexArray, ComplexArray]:
        """Return φ and dφ/dζ at ζ; at ζ = 0 just ahead."""
        del front
        near = np.concatenate([zeta, zeta + 1.0, zeta - 1.0])
        here, after, before = self.at(near).reshape(3, -1)
        return here, profile_slope(zeta, here, after + before, self.velocity, self.c)


@dataclass(frozen=True)
class _Shape:
    """Fronts φ(ζ)/φ_s of either direction, on the quadrature of the advancing ones, a row each."""

    grid: ProfileGrid
    retreating: bool

    @property
    def velocity(self) -> FloatArray:
        """Velocities v̂, shape (n, 1)."""
        return np.asarray(-self.grid.v if self.retreating else self.grid.v)

    @property
    def shortest(self) -> float:
        """Length of a cell that is not divided."""
        return _SHORTEST

    @property
    def max_values(self) -> float:
        """Infinite: values cost little."""
        return math.inf

    def shorter_than_waves(self, owner: IntArray) -> FloatArray:
        """Return a sixth of the shortest wave of φ, e^{-ia f}: a turns by at most 2c/v a site."""
        length: FloatArray = np.abs(self.velocity[owner, 0]) / (2.0 * self.grid.c[owner, 0])
        return length

    def tolerance(self, zeta: FloatArray, r: FloatArray) -> float:
        """Bound the error of |φ|² - r² near 0."""
        del zeta, r
        return TOLERANCE

    def steepness(self, ends: FloatArray) -> None:
        """Return None: the slopes at the ends of a cell are what is known here."""
        del ends

    def on_lattice(self, sites: tuple[int, int] | None = None) -> tuple[FloatArray, ComplexArray]:
        """Return ζ and φ, shape (n, m), at eight points a site; see `ProfileGrid.on_lattice`."""
        if sites is not None and self.retreating:
            sites = sites[1], sites[0]
        zeta, phi = self.grid.on_lattice(_PER_SITE, sites)
        if self.retreating:
            zeta, phi = -zeta[::-1], 1.0 - phi[..., ::-1]
        return zeta, phi

    def slope(self, zeta: FloatArray, phi: ComplexArray, neighbours: ComplexArray) -> ComplexArray:
        """Return dφ/dζ of all fronts, shape (n, m); at ζ = 0 just ahead."""
        return profile_slope(zeta, phi, neighbours, self.velocity, self.grid.c)

    def with_slope(self, zeta: FloatArray, front: IntArray) -> tuple[ComplexArray, ComplexArray]:
        """Return φ and dφ/dζ at ζ, shape (m,), of one front each; at ζ = 0 just ahead."""
        phi, neighbours = self.grid.with_neighbours(-zeta if self.retreating else zeta, front)
        if self.retreating:
            phi, neighbours = 1.0 - phi, 2.0 - neighbours
        v, c = self.velocity[front, 0], self.grid.c[front, 0]
        return phi, profile_slope(zeta, phi, neighbours, v, c)


def _margin(
    zeta: FloatArray, phi: ComplexArray, slope: ComplexArray, r: float | FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return what (47) asks to be positive, |φ|² - r² behind and its negative ahead, and slope."""
    side = np.where(zeta < 0, 1.0, -1.0)
    return side * (np.abs(phi) ** 2 - r * r), side * 2.0 * (phi.conj() * slope).real


def _first_violation(
    shape: _Shape | _SumShape, zeta: FloatArray, values: tuple[ComplexArray, ComplexArray], r: float
) -> tuple[float | None, int]:
    """Return the violation nearest 0 of one front, if any, and the further values of φ computed."""
    rows = values[0][None], values[1][None]
    inside = np.ones((1, zeta.size), dtype=bool)
    fails_at, more = _first_violations(shape, zeta, rows, np.array([r]), inside)
    return (None if fails_at[0] == math.inf else float(fails_at[0])), int(more[0])


def _first_violations(
    shape: _Shape | _SumShape, zeta: FloatArray, values: tuple[ComplexArray, ComplexArray],
    r: FloatArray, inside: npt.NDArray[np.bool_],
) -> tuple[FloatArray, IntArray]:  # fmt: skip
    """Return the violation nearest 0 of each front, or ∞, and the further values of φ computed.

    ``values`` are φ and its slope at ζ, which ascends through 0, shape (n, m); what is not
    ``inside`` is not looked at.
    """
    phi, slope = values
    g, d = _margin(zeta, phi, slope, r[:, None])
    origin = int(np.searchsorted(zeta, 0.0))
    # At ζ = 0 the threshold is crossed: g = 0, and the slope behind differs from the one ahead by
    # the jump of θ in (48). Where either has the wrong sign (47) fails at once.
    jump = (phi[:, origin].conj() * (-0.5 / np.ravel(shape.velocity))).real
    d_behind = -d[:, origin] + 2.0 * jump
    wrong = (d[:, origin] < 0) | (d_behind > 0)
    g[:, origin] = 0.0
    end = d.copy()  # slopes at the right end of a cell
    end[:, origin] = d_behind
    owner, cell = (inside[:, :-1] & inside[:, 1:] & ~wrong[:, None]).nonzero()
    here = owner * zeta.size + cell  # of rows one after the other
    cells = np.array(
        [
            zeta.take(cell), g.take(here), d.take(here),
            zeta.take(cell + 1), g.take(here + 1), end.take(here + 1),
        ]
    )  # fmt: skip
    fails_at, computed = _divide(shape, cells, owner, r)
    fails_at[wrong] = 0.0
    return fails_at, computed


def _room(zeta: FloatArray, g: FloatArray, r: FloatArray) -> FloatArray:
    """Return ||φ| - r| where (47) holds, less than 0 where it does not."""
    side = np.where(zeta < 0, 1.0, -1.0)
    room: FloatArray = side * (np.sqrt(np.maximum(r * r + side * g, 0.0)) - r)
    return room


def _divide(
    shape: _Shape | _SumShape, cells: FloatArray, owner: IntArray, r: FloatArray
) -> tuple[FloatArray, IntArray]:
    """Divide cells (rows ζ, g, dg/dζ at both ends) until each is safe or a violation is seen.

    Less than the tolerance below zero is no violation: φ may rest at the threshold, v → 0.
    ``owner`` is the front of each cell; returned are the violation nearest 0 of each, or ∞, and the
    values of φ computed: more than ``max_values`` where cells are left.
    """
    computed, worst = np.zeros(r.size, dtype=np.int64), np.full(r.size, math.inf)
    while True:
        zeta, r_ = cells[::3], r[owner]
        tolerance = shape.tolerance(zeta, r_)
        _note(zeta, cells[1::3] < -tolerance, owner, worst)
        g, width = cells[1::3] + tolerance, zeta[1] - zeta[0]
        least = np.minimum(g[0], g[1])
        safe = least > width * np.maximum(*np.abs(cells[2::3]))
        steepness = shape.steepness(zeta)
        if steepness is not None:
            safe &= _room(zeta, g, r_).sum(axis=0) > width * steepness
        (open_,) = (~safe & (least >= 0.0) & (width > shape.shortest)).nonzero()
        nearest = np.minimum(*np.abs(zeta.take(open_, axis=1)))
        open_ = open_[nearest < np.abs(worst[owner[open_]])]
        cells, owner = cells.take(open_, axis=1), owner.take(open_)
        short = (width[open_] < shape.shorter_than_waves(owner)) & (least[open_] > 0.0)
        (left,) = (~_between_its_ends(cells, short)).nonzero()
        cells, owner = cells.take(left, axis=1), owner.take(left)
        if owner.size == 0:
            return worst, computed
        computed += 3 * np.bincount(owner, minlength=r.size)
        if computed.max() > shape.max_values:
            return worst, computed
        middle = 0.5 * (cells[0] + cells[3])
        half = np.array([middle, *_margin(middle, *shape.with_slope(middle, owner), r[owner])])
        cells = np.concatenate(
            [np.concatenate([cells[:3], half]), np.concatenate([half, cells[3:]])], axis=1
        )
        owner = np.concatenate([owner, owner])


def _between_its_ends(cells: FloatArray, short: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Return whether slopes that agree with each other and with the rise of g leave it between.

    They do in the cell that touches ζ = 0, where g rises from the threshold, and in ``short`` ones.
    """
    za, ga, da, zb, gb, db = cells
    width = zb - za
    both = da + db
    monotone = np.abs(da - db) < 0.5 * np.minimum(np.abs(da), np.abs(db))
    monotone &= np.abs(gb - ga - 0.5 * width * both) < 0.25 * width * np.abs(both)
    rising = ((za == 0.0) & (da > 0)) | ((zb == 0.0) & (db < 0))
    between: npt.NDArray[np.bool_] = monotone & (rising | short)
    return between


def _note(
    zeta: FloatArray, wrong: npt.NDArray[np.bool_], owner: IntArray, worst: FloatArray
) -> None:
    """Put the least |ζ| that is wrong, with its sign, where it is less than what is known.

    ``zeta`` and ``wrong`` have any number of rows, ``owner`` is that of each column.
    """
    found = wrong.nonzero()
    if found[0].size == 0:
        return
    places, owners = zeta[found], owner[found[-1]]
    order = np.lexsort((-places, -np.abs(places)))  # the nearest last, so that it stays
    nearer = order[np.abs(places[order]) < np.abs(worst[owners[order]])]
    worst[owners[nearer]] = places[nearer]
