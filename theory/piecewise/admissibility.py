"""Whether a front obeys its own assumption (47): |φ| > φ_us behind and |φ| < φ_us ahead, for all ζ.

Far out a bound on the tails proves it (``front_profile.tail_bound``). Between, |φ|² - r² and its
exact slope, from (48), are taken at points a fraction of a site apart, and a cell is divided until
twice its slopes cannot bring it below zero by more than the tolerance, or a violation is seen.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from theory.piecewise.dispersion import ComplexArray, FloatArray
from theory.piecewise.profile import ProfileGrid, profile_slope, tail_bound
from theory.piecewise.sums.result import PrecisionError

_PER_SITE = 8
_TOLERANCE = 1e-11
_SHORTEST = 1e-7


@dataclass(frozen=True)
class Admissibility:
    """The verdict on assumption (47).

    Attributes
    ----------
    admissible : bool or None
        None where the tails reach too far to be followed (v or c above some 10⁴).
    fails_at : float or None
        The violation nearest ζ = 0 that was seen, in sites, to within an eighth of a site; 0 where
        the slope at ζ = 0 is already wrong; None if there is none.
    proven_beyond : tuple of float
        (Z₋, Z₊): for ζ < -Z₋ and ζ > Z₊ the tail bound proves (47).
    points : int
        Values of φ computed.
    """

    admissible: bool | None
    fails_at: float | None
    proven_beyond: tuple[float, float]
    points: int


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
    speed, retreating = abs(v), v < 0
    rate_behind, size_behind = tail_bound(speed, c, ahead=False)
    rate_ahead, size_ahead = tail_bound(speed, c, ahead=True)
    if retreating:
        rate_behind, rate_ahead = rate_ahead, rate_behind
        size_behind, size_ahead = size_ahead, size_behind
    left = max(1.0, math.ceil(math.log(max(size_behind / (1.0 - r), 1.0)) / rate_behind))
    right = max(1.0, math.ceil(math.log(max(size_ahead / r, 1.0)) / rate_ahead))
    try:
        grid = ProfileGrid.make(speed, c, max(left, right) + 2.0, _TOLERANCE)
    except PrecisionError:
        return Admissibility(None, None, (left, right), 0)
    shape = _Shape(grid, retreating)
    zeta, phi = shape.sampled(left + 1.0, right + 1.0)
    outer = slice(_PER_SITE, -_PER_SITE)
    slope = shape.slope(zeta[outer], phi[outer], phi[2 * _PER_SITE :] + phi[: -2 * _PER_SITE])
    fails_at, more = _first_violation(shape, zeta[outer], phi[outer], slope, r)
    points = grid.points * _PER_SITE + more
    return Admissibility(fails_at is None, fails_at, (left, right), points)


@dataclass(frozen=True)
class _Shape:
    """The front φ(ζ)/φ_s of either direction, on the quadrature of the advancing one."""

    grid: ProfileGrid
    retreating: bool

    @property
    def velocity(self) -> float:
        return -self.grid.v if self.retreating else self.grid.v

    def sampled(self, left: float, right: float) -> tuple[FloatArray, ComplexArray]:
        """Return ζ and φ at eight points a site from -left to right, both included."""
        zeta, phi = self.grid.on_lattice(_PER_SITE)
        if self.retreating:
            zeta, phi = -zeta[::-1], 1.0 - phi[::-1]
        kept = (zeta >= -left) & (zeta <= right)
        return zeta[kept], phi[kept]

    def at(self, zeta: FloatArray) -> ComplexArray:
        """Return φ at ζ, shape (n,)."""
        position = -zeta if self.retreating else zeta
        phi = self.grid.at(position)
        return 1.0 - phi if self.retreating else phi

    def slope(self, zeta: FloatArray, phi: ComplexArray, neighbours: ComplexArray) -> ComplexArray:
        """Return dφ/dζ; at ζ = 0 just ahead."""
        return profile_slope(zeta, phi, neighbours, self.velocity, self.grid.c)


def _first_violation(
    shape: _Shape, zeta: FloatArray, phi: ComplexArray, slope: ComplexArray, r: float
) -> tuple[float | None, int]:
    """Return the violation nearest 0, if any, and the further values of φ computed."""
    side = np.where(zeta < 0, 1.0, -1.0)  # g > 0 is what (47) asks for
    g = side * (np.abs(phi) ** 2 - r * r)
    d = side * 2.0 * np.real(np.conj(phi) * slope)
    origin = int(np.searchsorted(zeta, 0.0))
    # At ζ = 0 the threshold is crossed: g = 0, and the slope behind differs from the one ahead by
    # the jump of θ in (48). Where either has the wrong sign (47) fails at once.
    d_behind = -d[origin] + 2.0 * float(np.real(np.conj(phi[origin]) * (-0.5 / shape.velocity)))
    if d[origin] < 0 or d_behind > 0:
        return 0.0, 0
    g[origin] = 0.0
    ahead = _cells(zeta[origin:], g[origin:], d[origin:])
    behind = _cells(zeta[: origin + 1], g[: origin + 1], np.append(d[:origin], d_behind))
    cells = np.concatenate([behind, ahead], axis=1)
    wrong = zeta[g < -_TOLERANCE]
    worst = float(wrong[np.argmin(np.abs(wrong))]) if wrong.size else math.inf
    computed = 0
    while True:
        za, ga, da, zb, gb, db = cells
        width = zb - za
        steepest = np.maximum(np.abs(da), np.abs(db))
        # Less than the tolerance below zero is no violation: φ may rest at the threshold, v → 0.
        safe = np.minimum(ga, gb) - width * steepest > -_TOLERANCE
        # The cell that touches ζ = 0 rises from the threshold, monotonically.
        rising = ((za == 0.0) & (da > 0) & (db > 0)) | ((zb == 0.0) & (da < 0) & (db < 0))
        safe |= rising & (np.abs(da - db) < 0.5 * np.minimum(np.abs(da), np.abs(db)))
        open_ = ~safe & (np.minimum(ga, gb) >= -_TOLERANCE) & (width > _SHORTEST)
        open_ &= np.minimum(np.abs(za), np.abs(zb)) < abs(worst)
        cells = cells[:, open_]
        if cells.shape[1] == 0:
            return (None if worst == math.inf else worst), computed
        middle = 0.5 * (cells[0] + cells[3])
        whole = shape.at(np.concatenate([middle, middle + 1.0, middle - 1.0])).reshape(3, -1)
        computed += whole.size
        here, neighbours = whole[0], whole[1] + whole[2]
        side = np.where(middle < 0, 1.0, -1.0)
        g_middle = side * (np.abs(here) ** 2 - r * r)
        d_middle = shape.slope(middle, here, neighbours)
        d_middle = side * 2.0 * np.real(np.conj(here) * d_middle)
        wrong = middle[g_middle < -_TOLERANCE]
        if wrong.size:
            nearest = float(wrong[np.argmin(np.abs(wrong))])
            worst = nearest if abs(nearest) < abs(worst) else worst
        half = np.stack([middle, g_middle, d_middle])
        cells = np.concatenate(
            [np.concatenate([cells[:3], half]), np.concatenate([half, cells[3:]])], axis=1
        )


def _cells(zeta: FloatArray, g: FloatArray, d: FloatArray) -> FloatArray:
    ends = np.stack([zeta, g, d])
    return np.concatenate([ends[:, :-1], ends[:, 1:]])
