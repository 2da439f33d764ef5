"""Every velocity of (54) proven: where each lies, and that there is no other.

A front of velocity v > 0 obeys h(v) = 0 with h = |Σ(v, c) + s|² - 4r², s = 0; a front that retreats
with velocity -v obeys it with s = 2. Where no solution can lie, without computing Σ:

* Small v. |Σ(v, c) - Σ(0⁺, c)| ≤ 2e/(1 - e), e = e^{-1/2v}
  (``theory.piecewise.limits.static_sum_distance``), so none where this is below the distance of
  |Σ(0⁺, c) + s| from 2r.
* Large v. As 1 = (v/π)∫₀^∞ dk/(¼ + v²k²), the real-line form is

      Σ = (v/π) ∫₀^∞ (u² + iu) dk/[(A² + v²k²)(¼ + v²k²)],   A = ½ - iu,   u = c(1 - cos k).

  With γ = max (1 - cos k)/k < 0.7247 and v > γc, |A² + v²k²| ≥ (1 - γc/v)(¼ + v²k²), and
  u ≤ ck²/2, u ≤ 2c give

      |Σ(v, c)| ≤ [c/(4v²) + 2c²/(3πv³)]/(1 - γc/v),

  which falls with v and grows with c. None where it is below 2r (s = 0) or 2 - 2r (s = 2).

Between these bounds the velocities are divided into cells, and Σ_v and h' are enclosed over all of
each cell V in ball arithmetic. V of centre m holds no velocity if ||Σ(m) + s| - 2r| exceeds half
its width times |Σ_v|, or |h(m)| half its width times |h'|. Otherwise h' ≠ 0 leaves at most one, and
the signs at the ends say whether. Else the cell is halved. Interval Newton steps then shrink each
cell that holds one.
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
"""Values of the integrand that one proof may take: some eight seconds."""
_GAMMA = 0.7247
_NARROWEST = 1e-14
_RELATIVE_TOLERANCES = (1e-4, 1e-9, 1e-21)
_ROUNDED = 1.0 + 1e-12
_MAX_POINTS = 20_000


class WorkLimitError(PrecisionError):
    """A proof that would take more values of the integrand than it may."""


@dataclass(frozen=True, kw_only=True)
class Enclosure:
    """An interval that provably holds a number.

    Attributes
    ----------
    lower, upper : float
        Its ends, dimensionless.
    """

    lower: float
    upper: float

    @classmethod
    def of(cls, ball: Any) -> Enclosure:
        """Return the interval of doubles about a ball."""
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
    """h at one coupling, or over a ball of couplings, in ball arithmetic; counts its work.

    Attributes
    ----------
    flint : module
        python-flint.
    c, target : arb
        Coupling and 2r.
    shift : int
        0, or 2 for fronts that retreat.
    work : int
        Values of the integrand so far.
    most_work : int
        After so many, `WorkLimitError` is raised.
    """

    flint: Any
    c: Any
    target: Any
    shift: int = 0
    work: int = 0
    most_work: int = MAX_WORK
    _signs: dict[float, int] = field(default_factory=dict)

    def sum(self, v: Any, tolerance: float, order: int = 0, c: Any = None) -> BallSum:
        """Return Σ, and by order its derivatives, over the ball v and a ball of couplings."""
        c = self.c if c is None else c
        points, strip = needed_points(
            math.nextafter(float(v.upper()), math.inf),
            math.nextafter(float(c.upper()), math.inf),
            tolerance,
            order,
            math.nextafter(float(c.lower()), 0.0),
        )
        self.work += points // 2 * (1 + order)
        if points > _MAX_POINTS or self.work > self.most_work:
            raise WorkLimitError(
                f"it would take more than {self.most_work} values of the integrand"
            )
        return ball_sum(self.flint, v, c, points, strip, order=order)

    def height(self, total: Any) -> Any:
        """Return h = |Σ + s|² - 4r² of a value of Σ."""
        value = total + self.shift
        return value.real**2 + value.imag**2 - self.target**2

    def slope(self, total: Any, by: Any) -> Any:
        """Return the derivative of h from Σ and its derivative."""
        value = total + self.shift
        return 2 * (value.real * by.real + value.imag * by.imag)

    def steepness(self, low: float, high: float, least: float = math.inf) -> tuple[Any, Any]:
        """Return ∂h/∂v and |∂Σ/∂v| over all velocities from low to high.

        They are truncated to within a part of 2r, or ``least`` where that is smaller.
        """
        cell = self.flint.arb(low).union(self.flint.arb(high))
        tolerance = max(min(0.1 * self.tolerances[0], least), self.tolerances[-1])
        wide = self.sum(cell, tolerance, 1)
        return self.slope(wide.value, wide.by_v), abs(wide.by_v)

    def resolved(self, v: Any, c: Any = None) -> Any:
        """Return Σ so well that its distance from a solution is not lost in the truncation."""
        for tolerance in self.tolerances:
            value = self.sum(v, tolerance, c=c).value
            if abs(self.distance(value)) > 100.0 * tolerance:
                break
        return value

    @property
    def tolerances(self) -> list[float]:
        """Truncation errors of Σ tried one after the other."""
        target = float(self.target)
        return [target * relative for relative in _RELATIVE_TOLERANCES]

    def distance(self, total: Any) -> Any:
        """Return |Σ + s| - 2r of a value of Σ."""
        return abs(total + self.shift) - self.target

    def sign(self, v: float) -> int:
        """Return the sign of h(v), 0 if it could not be told from zero."""
        if v not in self._signs:
            h = self.distance(self.resolved(self.flint.arb(v)))
            self._signs[v] = 0 if h.contains(0) else 1 if h > 0 else -1
        return self._signs[v]


def static_distance(flint: Any, v: float) -> Any:
    """Return the bound 2e/(1 - e), e = e^{-1/2v}, on |Σ(v, c) - Σ(0⁺, c)|; it grows with v."""
    e = (-1 / (2 * flint.arb(v))).exp()
    return 2 * e / (1 - e)


def fast_bound(flint: Any, v: float, c: Any) -> Any:
    """Return the bound on |Σ(v, c)| at large v; it falls with v, grows with c, and may not exist.

    Returns
    -------
    arb
        Infinite where v ≤ γc.
    """
    rest = 1 - flint.arb(_GAMMA) * c / v
    if not rest > 0:
        return flint.arb.pos_inf()
    v_ = flint.arb(v)
    return (c / (4 * v_**2) + 2 * c**2 / (3 * flint.arb.pi() * v_**3)) / rest


def lowest_velocity(relation: Relation) -> float:
    """Return v below which no solution lies, by the bound at small v; 0 if it fails."""
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
    room = abs(relation.shift - relation.target)
    high = float(c.upper()) + 1e-3
    while not fast_bound(flint, high, c) < room:
        high *= 2.0
        if high > 1e300:
            raise WorkLimitError("no bound on the velocity was found")
    low = 0.5 * high
    for _ in range(6):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if fast_bound(flint, middle, c) < room else (middle, high)
    return high


def prove_velocities(
    relation: Relation, progress: Callable[[float], None] | None = None
) -> tuple[list[Enclosure], list[tuple[float, float]]]:
    """Return an enclosure of every v > 0 with h(v) = 0, and the intervals left undecided.

    If no interval is left, the velocities are exactly so many, one in each enclosure.

    Parameters
    ----------
    relation : Relation
        At one coupling.
    progress : callable, optional
        Called with the fraction of the cells done.

    Raises
    ------
    WorkLimitError
        If the proof takes too long: strong coupling, where resonances are many.
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
        elif b - a < _NARROWEST * b:
            undecided.append((a, b))
        else:
            cells += [(middle, b), (a, middle)]
    return found, _joined(undecided)


def _roots_in_cell(relation: Relation, a: float, b: float) -> list[Enclosure] | None:
    """Return the solutions between a and b, none or one, or None if it is not decided."""
    if b > 1.5 * a:
        return None
    slope, rate = relation.steepness(a, b)
    if not rate.is_finite():
        return None
    middle = 0.5 * (a + b)
    half = (b - middle) * _ROUNDED
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
    """Return where the one zero of h in a cell lies, by interval Newton steps.

    Parameters
    ----------
    relation : Relation
        At one coupling.
    low, high : float
        Ends of a cell over which ``slope``, a ball of ∂h/∂v, does not contain 0, and at whose ends
        h differs in sign.
    slope : arb
        That ball.
    """
    flint = relation.flint
    cell = flint.arb(low).union(flint.arb(high))
    for _ in range(12):
        middle = cell.mid()
        h = relation.height(relation.sum(middle, relation.tolerances[-1]).value)
        shrunk = (middle - h / slope).intersection(cell)
        settled = shrunk.rad() > 0.5 * cell.rad() or shrunk.rad() < 1e-17 * middle
        cell = shrunk
        if settled:
            break
        slope = _narrower(relation, cell, slope)
    return Enclosure.of(cell)


def _narrower(relation: Relation, cell: Any, slope: Any) -> Any:
    """Return ∂h/∂v over a cell inside of one where it is known already."""
    wide = relation.sum(cell, relation.tolerances[1], 1)
    return relation.slope(wide.value, wide.by_v).intersection(slope)


def enclose_near(relation: Relation, v: float, error: float) -> Enclosure | None:
    """Return where the one zero of h near v lies, or None if it could not be proven there.

    Parameters
    ----------
    relation : Relation
        At one coupling.
    v, error : float
        A computed velocity and its stated error.
    """
    for wider in (2.0, 1e2, 1e4):
        reach = wider * max(error, 4e-16 * v)
        low, high = v - reach, v + reach
        slope, _ = relation.steepness(low, high)
        if not slope.contains(0) and relation.sign(low) * relation.sign(high) < 0:
            return enclose_root(relation, low, high, slope)
    return None


def _joined(cells: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return touching cells as one."""
    joined: list[tuple[float, float]] = []
    for low, high in cells:
        if joined and joined[-1][1] == low:
            joined[-1] = (joined[-1][0], high)
        else:
            joined.append((low, high))
    return joined
