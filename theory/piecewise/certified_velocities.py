"""Every velocity of (54), proven: an interval for each, and a proof that there is no other.

A front of velocity v > 0 obeys h(v) = 0 with h = |Σ(v, c) + s|² - 4r², s = 0; a front that retreats
with velocity -v obeys the same equation with s = 2. Two ranges are excluded without computing Σ:

* Small v. |Σ(v, c) - Σ(0⁺, c)| ≤ 2e/(1 - e), e = e^{-1/2v}
  (``theory.piecewise.limits.static_sum_distance``), so that there is no solution where this is less
  than the distance of |Σ(0⁺, c) + s| from 2r.
* Large v. As 1 = (v/π)∫₀^∞ dk/(¼ + v²k²), the real-line form is

      Σ = (v/π) ∫₀^∞ (u² + iu) dk/[(A² + v²k²)(¼ + v²k²)],   A = ½ - iu,   u = c(1 - cos k).

  With γ = max (1 - cos k)/k < 0.7247 and v > γc, |A² + v²k²| ≥ (1 - γc/v)(¼ + v²k²), and
  u ≤ ck²/2, u ≤ 2c give

      |Σ(v, c)| ≤ [c/(4v²) + 2c²/(3πv³)]/(1 - γc/v),

  which falls with v and grows with c. There is no solution where it is below 2r (s = 0) or 2 - 2r
  (s = 2).

Between these bounds the velocities are divided into cells, and Σ_v and h' are enclosed over each
whole cell V in ball arithmetic. A cell V with centre m contains no solution if ||Σ(m) + s| - 2r|
exceeds half its width times |Σ_v|, or |h(m)| exceeds half its width times |h'|. Otherwise, if
h' ≠ 0 on V, it contains at most one solution, and the signs of h at the ends decide whether it
does. In all other cases the cell is bisected. Each cell that contains a solution is then reduced by
interval Newton steps.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from theory.piecewise.certified_sum import BallSum, ball_static_sum, ball_sum, needed_points
from theory.piecewise.sums.result import PrecisionError

BITS = 110
"""Working precision of the search."""
MAX_WORK = 600_000
"""Largest number of values of the integrand in one proof: about eight seconds."""
_GAMMA = 0.7247
_MIN_RELATIVE_WIDTH = 1e-14
_RELATIVE_TOLERANCES = (1e-4, 1e-9, 1e-21)
_ROUND_UP = 1.0 + 1e-12
_MAX_POINTS = 20_000


class WorkLimitError(PrecisionError):
    """Raised where a proof would take more values of the integrand than allowed."""


@dataclass(frozen=True, kw_only=True)
class Enclosure:
    """An interval that provably contains a number.

    Attributes
    ----------
    lower, upper : float
        Its ends, dimensionless.
    """

    lower: float
    upper: float

    @classmethod
    def of(cls, ball: Any) -> Enclosure:
        """Return the smallest interval with double-precision ends that contains a ball."""
        return cls(
            lower=math.nextafter(float(ball.lower()), -math.inf),
            upper=math.nextafter(float(ball.upper()), math.inf),
        )

    def __contains__(self, value: float) -> bool:
        return self.lower <= value <= self.upper

    def mirrored(self) -> Enclosure:
        """Return the interval of the negatives."""
        return Enclosure(lower=-self.upper, upper=-self.lower)


@dataclass
class Relation:
    """h at one coupling, or over a ball of couplings, in ball arithmetic; counts evaluations.

    Attributes
    ----------
    flint : module
        python-flint.
    c, target : arb
        Coupling and 2r.
    shift : int
        s: 0, or 2 for fronts that retreat.
    work : int
        Number of values of the integrand so far.
    max_work : int
        Number of values beyond which `WorkLimitError` is raised.
    """

    flint: Any
    c: Any
    target: Any
    shift: int = 0
    work: int = 0
    max_work: int = MAX_WORK
    _signs: dict[float, int] = field(default_factory=dict)

    def sum(self, v: Any, tolerance: float, order: int = 0, c: Any = None) -> BallSum:
        """Return Σ and its derivatives up to ``order``, over the ball v and a ball of couplings."""
        c = self.c if c is None else c
        points, strip = needed_points(
            math.nextafter(float(v.upper()), math.inf),
            math.nextafter(float(c.upper()), math.inf),
            tolerance,
            order,
            math.nextafter(float(c.lower()), 0.0),
        )
        self.work += points // 2 * (1 + order)
        if points > _MAX_POINTS or self.work > self.max_work:
            raise WorkLimitError(f"it would take more than {self.max_work} values of the integrand")
        return ball_sum(self.flint, v, c, points, strip, order=order)

    def height(self, total: Any) -> Any:
        """Return h = |Σ + s|² - 4r² for a value of Σ."""
        value = total + self.shift
        return value.real**2 + value.imag**2 - self.target**2

    def slope(self, total: Any, by: Any) -> Any:
        """Return a derivative of h, given Σ and the same derivative of Σ."""
        value = total + self.shift
        return 2 * (value.real * by.real + value.imag * by.imag)

    def slope_bounds(
        self, low: float, high: float, resolution: float = math.inf
    ) -> tuple[Any, Any]:
        """Return enclosures of ∂h/∂v and |∂Σ/∂v| over all velocities from low to high.

        The truncation error is a small fraction of 2r, or ``resolution`` where that is smaller.
        """
        cell = self.flint.arb(low).union(self.flint.arb(high))
        tolerance = max(min(0.1 * self.tolerances[0], resolution), self.tolerances[-1])
        over_cell = self.sum(cell, tolerance, 1)
        return self.slope(over_cell.value, over_cell.by_v), abs(over_cell.by_v)

    def resolved(self, v: Any, c: Any = None) -> Any:
        """Return Σ with a truncation error far below ||Σ + s| - 2r|, if possible."""
        for tolerance in self.tolerances:
            value = self.sum(v, tolerance, c=c).value
            if abs(self.distance(value)) > 100.0 * tolerance:
                break
        return value

    @property
    def tolerances(self) -> list[float]:
        """Truncation errors of Σ that are tried in turn."""
        target = float(self.target)
        return [target * relative for relative in _RELATIVE_TOLERANCES]

    def distance(self, total: Any) -> Any:
        """Return |Σ + s| - 2r for a value of Σ."""
        return abs(total + self.shift) - self.target

    def sign(self, v: float) -> int:
        """Return the sign of h(v), or 0 if h(v) could not be distinguished from zero."""
        if v not in self._signs:
            h = self.distance(self.resolved(self.flint.arb(v)))
            self._signs[v] = 0 if h.contains(0) else 1 if h > 0 else -1
        return self._signs[v]


def static_distance(flint: Any, v: float) -> Any:
    """Return the bound 2e/(1 - e), e = e^{-1/2v}, on |Σ(v, c) - Σ(0⁺, c)|; it grows with v."""
    e = (-1 / (2 * flint.arb(v))).exp()
    return 2 * e / (1 - e)


def fast_bound(flint: Any, v: float, c: Any) -> Any:
    """Return the bound on |Σ(v, c)| at large v, which falls with v and grows with c.

    Returns
    -------
    arb
        Infinite where v ≤ γc, for which there is no such bound.
    """
    denominator = 1 - flint.arb(_GAMMA) * c / v
    if not denominator > 0:
        return flint.arb.pos_inf()
    v_ = flint.arb(v)
    return (c / (4 * v_**2) + 2 * c**2 / (3 * flint.arb.pi() * v_**3)) / denominator


def lowest_velocity(relation: Relation) -> float:
    """Return v below which no solution lies, by the bound at small v; 0 if the bound fails."""
    value = ball_static_sum(relation.flint, relation.c)
    gap = abs(relation.distance(value))
    distance = float(gap.lower())
    if not distance > 0.0:
        return 0.0
    v = 0.5 / math.log1p(2.0 / distance) * (1.0 - 1e-12)
    return v if static_distance(relation.flint, v) < gap else 0.0


def highest_velocity(relation: Relation) -> float:
    """Return v above which no solution lies, by the bound at large v."""
    flint, c = relation.flint, relation.c
    gap = abs(relation.shift - relation.target)
    high = float(c.upper()) + 1e-3
    while not fast_bound(flint, high, c) < gap:
        high *= 2.0
        if high > 1e300:
            raise WorkLimitError("no bound on the velocity was found")
    low = 0.5 * high
    for _ in range(6):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if fast_bound(flint, middle, c) < gap else (middle, high)
    return high


def prove_velocities(
    relation: Relation, progress: Callable[[float], None] | None = None
) -> tuple[list[Enclosure], list[tuple[float, float]]]:
    """Return an enclosure of every v > 0 with h(v) = 0, and the intervals left undecided.

    If no interval is left, each enclosure contains exactly one velocity, and there are no others.

    Parameters
    ----------
    relation : Relation
        The relation at one coupling.
    progress : callable, optional
        Called with the fraction of the range that is done.

    Raises
    ------
    WorkLimitError
        If the proof takes too long, as at strong coupling, where there are many resonances.
    """
    low, high = lowest_velocity(relation), highest_velocity(relation)
    if low == 0.0:
        return [], [(0.0, high)]
    found: list[Enclosure] = []
    undecided: list[tuple[float, float]] = []
    if low >= high:
        return found, undecided
    cells = [(low, high)]
    while cells:
        a, b = cells.pop()
        if progress is not None:
            progress(math.log(a / low) / math.log(high / low))
        try:
            roots = _roots_in_cell(relation, a, b)
        except WorkLimitError as limit:
            raise WorkLimitError(f"at |v| = {a:.6g} {limit}") from None
        middle = 0.5 * (a + b)
        if roots is not None:
            found += roots
        elif b - a < _MIN_RELATIVE_WIDTH * b:
            undecided.append((a, b))
        else:
            cells += [(middle, b), (a, middle)]
    return found, _joined(undecided)


def _roots_in_cell(relation: Relation, a: float, b: float) -> list[Enclosure] | None:
    """Return the solution between a and b, if there is one, or None if that is not decided."""
    if b > 1.5 * a:
        return None
    slope, rate = relation.slope_bounds(a, b)
    if not rate.is_finite():
        return None
    middle = 0.5 * (a + b)
    half = (b - middle) * _ROUND_UP
    centre = relation.resolved(relation.flint.arb(middle))
    if abs(relation.distance(centre)) > half * rate or abs(relation.height(centre)) > half * abs(
        slope
    ):
        return []
    if slope.contains(0) or not relation.sign(a) or not relation.sign(b):
        return None
    if relation.sign(a) == relation.sign(b):
        return []
    return [enclose_root(relation, a, b, slope)]


def enclose_root(relation: Relation, low: float, high: float, slope: Any) -> Enclosure:
    """Return an enclosure of the only zero of h in a cell, by interval Newton steps.

    Parameters
    ----------
    relation : Relation
        The relation at one coupling.
    low, high : float
        Ends of the cell, at which h has different signs.
    slope : arb
        A ball that contains ∂h/∂v over the cell but not 0.
    """
    flint = relation.flint
    cell = flint.arb(low).union(flint.arb(high))
    for _ in range(12):
        middle = cell.mid()
        h = relation.height(relation.sum(middle, relation.tolerances[-1]).value)
        narrowed = (middle - h / slope).intersection(cell)
        settled = narrowed.rad() > 0.5 * cell.rad() or narrowed.rad() < 1e-17 * middle
        cell = narrowed
        if settled:
            break
        slope = _narrower(relation, cell, slope)
    return Enclosure.of(cell)


def _narrower(relation: Relation, cell: Any, slope: Any) -> Any:
    """Return ∂h/∂v over a cell, given an enclosure of it over a larger one."""
    over_cell = relation.sum(cell, relation.tolerances[1], 1)
    return relation.slope(over_cell.value, over_cell.by_v).intersection(slope)


def enclose_near(relation: Relation, v: float, error: float) -> Enclosure | None:
    """Return an enclosure of the only zero of h near v, or None if it could not be proven.

    Parameters
    ----------
    relation : Relation
        The relation at one coupling.
    v, error : float
        A computed velocity and its stated error.
    """
    for factor in (2.0, 1e2, 1e4):
        margin = factor * max(error, 4e-16 * v)
        low, high = v - margin, v + margin
        slope, _ = relation.slope_bounds(low, high)
        if not slope.contains(0) and relation.sign(low) * relation.sign(high) < 0:
            return enclose_root(relation, low, high, slope)
    return None


def _joined(cells: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return the cells with adjacent ones joined."""
    joined: list[tuple[float, float]] = []
    for low, high in cells:
        if joined and joined[-1][1] == low:
            joined[-1] = (joined[-1][0], high)
        else:
            joined.append((low, high))
    return joined
