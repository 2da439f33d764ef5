"""Omissions in the sum (53), the kinetic relation (54) and assumption (47)."""

from __future__ import annotations

import math
from collections.abc import Iterator

import mpmath as mp
import numpy as np

from theory.arrays import EPS, ComplexArray, FloatArray
from theory.cells.vdp import threshold_ratio
from theory.parameters import ParameterError
from theory.piecewise.admissibility import TOLERANCE, check_admissible
from theory.piecewise.branch_search import all_velocities
from theory.piecewise.folds import fold_couplings
from theory.piecewise.limits import static_sum
from theory.piecewise.profile import ProfileGrid
from theory.piecewise.roots import labelled_roots
from theory.piecewise.sums.axis import plain_points
from theory.piecewise.sums.integral import sums
from theory.piecewise.sums.series import RootSeries, sum_by_roots, tail_sum
from verification.work_reduction.comparison import Comparison, timed

_TAIL_DIGITS = 15
_PIECE = 4096
_FINE = 1024
"""Values per site from which the curvature of the shape is taken."""


def few_roots(v: float = 0.3, c: float = 0.5, digits: int = 6) -> Comparison:
    """Sum the roots near the singularities, plus the tail; or all, one by one, until 10^-digits.

    The truncated series also lacks a tail, which is added before the two are compared.
    """
    few = sum_by_roots(v, c, digits)
    # Far out a term is 1/(v k²), k = 2πν: beyond M on both sides they add up to 1/(2π²vM).
    most = math.ceil(10.0**digits / (2.0 * math.pi**2 * v))
    labels = np.arange(-most, most + 1)
    roots = labelled_roots(v, c, labels, True)
    slope = -1j * (v + c * np.sin(roots.k))
    terms = 1.0 / (roots.k * slope)
    terms[[0, -1]] *= 0.5
    value = complex(math.fsum(terms.real), math.fsum(terms.imag))
    relative = 1.0 / np.abs(roots.k) + c * np.cosh(roots.k.imag) / np.abs(slope)
    rounding = float(np.sum(np.abs(terms) * (relative * roots.radius + 4.0 * EPS)))
    with mp.workdps(30):
        series = RootSeries(mp.mpf(v), mp.mpf(c), 1)
        for label, side in ((-most, -1), (most, 1)):
            rest, missed = tail_sum(series, label, side, 3)
            value += complex(rest)
            rounding += float(missed)
    changed = abs(few.value - value)
    return Comparison(few.terms, labels.size, changed, few.error + rounding)


def few_tail_terms(v: float = 0.3, c: float = 0.5, label: int = 9) -> Comparison:
    """Use as many orders of one tail as 15 digits need, or as 60 digits need; times in ms."""
    with mp.workdps(2 * _TAIL_DIGITS):
        series = RootSeries(mp.mpf(v), mp.mpf(c), 1)
        few, spent = timed(lambda: tail_sum(series, label, 1, 25))
        many, whole = timed(lambda: tail_sum(series, label, 1, 80))
        changed = float(abs(few[0] - many[0]))
        return Comparison(1e3 * spent, 1e3 * whole, changed, float(few[1] + many[1]))


def few_points(c: float = 100.0, tolerance: float = 1e-13) -> Comparison:
    """Subtract the roots beside the path, or use the number of points that the strip requires.

    At 200 velocities each, at strong coupling; where few points suffice, nothing is subtracted.
    """
    v = np.geomspace(0.05, 5.0, 200)
    own = sums(v, c, tolerance)
    counts = [int(plain_points(float(each), c, tolerance)[0]) for each in v]
    plain = np.array([_plain_mean(float(each), c, n) for each, n in zip(v, counts, strict=True)])
    changed = np.abs(own.value - (plain - 1.0))
    # of the plain rule: its truncation error, and the rounding of terms of order one
    allowed = own.error + tolerance + 16.0 * EPS * (1.0 + np.abs(plain))
    worst = int(np.argmax(changed / allowed))
    return Comparison(
        float(own.points.sum()),
        0.5 * sum(counts),  # the other half is its mirror image
        float(changed[worst]),
        float(allowed[worst]),
    )


def _plain_mean(v: float, c: float, count: int) -> complex:
    """Return the mean of G of ``sums.integral`` over equispaced points on a period."""
    k = 2.0 * np.pi * (np.arange(count) + 0.5) / count
    X = np.sin(0.5 * k) ** 2
    A = 0.5 - 2j * c * X
    F = -np.expm1(-A / v)
    G: ComplexArray = F * (2.0 - F) / (F * F + 4.0 * X * (1.0 - F)) / (2.0 * A)
    return complex(G.mean())


def double_precision(v: float = 0.3, c: float = 1000.0) -> Comparison:
    """Sum the roots to 15 digits in double precision, or entirely in mpmath; times in ms."""
    double, spent = timed(lambda: sum_by_roots(v, c, 15))
    precise, whole = timed(lambda: sum_by_roots(v, c, 16))
    changed = float(abs(mp.mpc(double.value) - precise.value))
    return Comparison(1e3 * spent, 1e3 * whole, changed, double.error + precise.error)


def few_values_of_the_shape(
    c: float = 0.5, eta: float = 0.03125, branch: int = 0, hidden: float = TOLERANCE
) -> Comparison:
    """Decide (47) by slopes, or by values so dense that no violation can lie between them.

    Between samples at a distance h a minimum is missed by at most h² max|g''|/8, g = |φ|² - r²;
    ``hidden`` is the largest amount that may be missed.
    """
    r = threshold_ratio(eta)
    v = float(all_velocities(np.array([c]), np.array([2.0 * r])).v[branch])
    verdict = check_admissible(v, c, r)
    left, right = verdict.proven_beyond
    grid = ProfileGrid.make(v, c, max(left, right) + 2.0, TOLERANCE)
    zeta, phi = grid.on_lattice(_FINE)
    # Without the kink at 0, beside which the curvature is largest.
    inside = (zeta > -left) & (zeta < right) & (np.abs(zeta) > 0.5 / _FINE)
    bend = float(np.abs(np.diff(np.abs(phi) ** 2, 2))[inside[1:-1]].max()) * float(_FINE) ** 2
    pieces = math.ceil(1.0 / math.sqrt(8.0 * hidden / bend) / _PIECE)
    m = np.arange(-left, right)
    worst = math.inf
    for phi in _shape(grid, m, pieces):
        g = np.abs(phi) ** 2 - r * r
        worst = min(worst, float(np.min(np.where(m[:, None] < 0, g, -g))))
    violation = max(0.0, -worst)
    agreed = verdict.admissible is (violation <= TOLERANCE)
    changed = (violation if verdict.admissible else 0.0) if agreed else math.inf
    values = pieces * _PIECE * m.size
    return Comparison(verdict.points, values, changed, TOLERANCE + grid.error)


def _shape(grid: ProfileGrid, m: FloatArray, pieces: int) -> Iterator[ComplexArray]:
    """Yield φ/φ_s at every site m plus a fraction of a site, shape (len(m), _PIECE).

    The bracket of ``ProfileGrid`` grows like e^{af}, by the same factor from piece to piece.
    """
    turn = np.exp(1j * np.outer(m, grid.k)) / (2.0 * grid.points)
    late = turn * grid.late
    still = 0.5 - (turn @ grid.static)[:, None]
    within = np.exp(np.outer(grid.a, np.arange(_PIECE) / (_PIECE * pieces)))
    for piece in range(pieces):
        yield still - (late * np.exp(-grid.a * (1.0 - piece / pieces))) @ within


def few_values_in_a_search(eta: float = 0.03125, above: float = 1e-8) -> Comparison:
    """Find every velocity just above c_fold by slopes, or by a scan that separates the closest.

    Velocities are compared through the cells of the scan in which g changes sign, whose width
    bounds their difference; if their numbers differ, the distance is infinite.
    """
    r = threshold_ratio(eta)
    (fold,) = fold_couplings([eta])
    if fold is None:
        raise ParameterError("eta", eta, "below 2/25", "take a fold of fronts that advance")
    c = fold.value * (1.0 + above)
    found = all_velocities(np.array([c]), np.array([2.0 * r]))
    low = 0.5 / math.log1p(2.0 / abs(abs(static_sum(c)) - 2.0 * r))
    high = 2.0 * c * (1.0 + 2.0 * c) / (2.0 * r)
    nearest = float(np.min(np.diff(np.log(found.v)), initial=1e-2))
    t = np.linspace(math.log(low), math.log(high), math.ceil(math.log(high / low) / nearest * 2.5))
    g = np.concatenate(
        [np.abs(sums(np.exp(part), c).value) - 2.0 * r for part in np.array_split(t, 16)]
    )
    changes = np.flatnonzero(np.diff(np.sign(g)))
    width = float(t[1] - t[0])
    changed = math.inf
    if changes.size == found.v.size:
        middle = 0.5 * (t[changes] + t[changes + 1])
        changed = float(np.max(np.abs(np.log(found.v) - middle), initial=0.0))
    return Comparison(found.evaluations, t.size, changed, width)
