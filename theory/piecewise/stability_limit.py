"""c_stable, the coupling at which the fastest admissible front of (44) first loses stability."""

from __future__ import annotations

import cmath
import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from theory.arrays import EPS
from theory.cells.vdp import ETA_END, SMALLEST_ETA, threshold_ratio
from theory.parameters import within
from theory.piecewise.admissibility import TOLERANCE, check_admissible
from theory.piecewise.branch_search import all_velocities
from theory.piecewise.folds import fold_coupling
from theory.piecewise.symbol import Symbol

_MAX_COUPLING = 60.0
"""Largest coupling examined."""
_SCAN_FACTOR = 1.03
"""Factor between successive couplings at which stability is determined."""
_BRACKET_WIDTH = 1e-5
"""Relative width of the bracket of c_stable at which bisection ends."""
_FOLD_ERROR = 1e-11
"""Relative error of a fold, where |Σ| and 2r touch to within 1e-13."""


@dataclass(frozen=True, kw_only=True)
class StabilityLimit:
    """The coupling at which, for one η, the fastest admissible front first loses stability.

    Attributes
    ----------
    c : float or None
        c_stable, dimensionless; None where there is none, for the given ``reason``.
    error : float or None
        Bound on its error.
    v : float or None
        Velocity v̂ at c_stable.
    angle : float or None
        Argument of the multiplier that leaves the unit circle, in radians per site; 0 where the
        stable branch ends, in a fold or because (47) ceases to hold, or where an unstable, faster
        branch begins.
    reason : str or None
        Why there is no c_stable.
    """

    c: float | None = None
    error: float | None = None
    v: float | None = None
    angle: float | None = None
    reason: str | None = None


@lru_cache(maxsize=256)
def stability_limit(eta: float) -> StabilityLimit:
    """Return c_stable(η), the coupling up to which the fastest admissible front is linearly stable.

    Parameters
    ----------
    eta : float
        η = b/a², dimensionless, 0 < η < 2/25.

    Returns
    -------
    StabilityLimit

    Raises
    ------
    ParameterError
        If η is out of range.

    Notes
    -----
    Starting at c_fold, couplings 3 % apart up to 60 are examined; a loss of stability over a
    shorter interval may be missed. Beyond c_stable fronts may regain and lose stability. Couplings
    at which no front is admissible are skipped, since no front becomes unstable there.

    Examples
    --------
    >>> limit = stability_limit(0.03125)
    >>> round(limit.c, 6), limit.error < 1e-10
    (2.405932, True)
    """
    within("eta = b/a^2", eta, SMALLEST_ETA, ETA_END)
    fold = fold_coupling(eta)
    if fold is None:
        return StabilityLimit(reason=f"no front advances at eta = {eta:.12g}")
    if fold.value >= _MAX_COUPLING:
        return StabilityLimit(reason=f"c_fold = {fold.value:.6g} is not below {_MAX_COUPLING:g}")
    r = threshold_ratio(eta)
    count = 2 + math.ceil(math.log(_MAX_COUPLING / fold.value) / math.log(_SCAN_FACTOR))
    previous = None
    for c in np.geomspace(fold.value * (1.0 + 1e-3), _MAX_COUPLING, count).tolist():
        current = _LeadingFront.at(c, r)
        if current.unstable is None:
            return StabilityLimit(reason=f"at c = {c:.6g} {current.reason}")
        if current.unstable and previous is None:
            return StabilityLimit(reason=f"just above c_fold, at c = {c:.6g}, no front is stable")
        if current.unstable and previous is not None:
            return _crossing(previous, current, r)
        previous = current
    reason = f"the fastest front is stable at all couplings up to {_MAX_COUPLING:g}"
    return StabilityLimit(reason=reason)


@dataclass(frozen=True)
class _LeadingFront:
    """The fastest admissible front at one coupling, its symbol, and whether it is unstable.

    Where there is no such front, v is NaN and ``unstable`` is false; where stability is not
    decided, ``unstable`` is None and ``reason`` says why.
    """

    c: float
    v: float = math.nan
    error: float = math.nan
    solutions: int = 0
    symbol: Symbol | None = None
    unstable: bool | None = False
    reason: str = ""

    @classmethod
    def at(cls, c: float, r: float, slack: float = 0.0) -> _LeadingFront:
        """Return the fastest front at coupling c, with r + ``slack`` as the threshold in (47)."""
        found = all_velocities(np.array([c]), np.array([2.0 * r]))
        none = cls(c, solutions=found.v.size)
        for v, error in zip(found.v[::-1].tolist(), found.error[::-1].tolist(), strict=True):
            verdict = check_admissible(v, c, r + slack)
            if verdict.admissible is None:
                return replace(none, unstable=None, reason=f"admissibility: {verdict.reason}")
            if verdict.admissible:
                return replace(none, v=v, error=error)._with_symbol()
        return none

    def _with_symbol(self) -> _LeadingFront:
        symbol = Symbol.of(self.v, self.c)
        if symbol is None:
            return replace(self, unstable=None, reason="the symbol of the front is too long")
        inside = symbol.zeros_within(1.0)
        if inside is None:
            return replace(
                self, symbol=symbol, unstable=None, reason="a multiplier is on the unit circle"
            )
        return replace(self, symbol=symbol, unstable=inside > 0)


def _crossing(stable: _LeadingFront, unstable: _LeadingFront, r: float) -> StabilityLimit:
    """Return the coupling between two given ones at which the fastest front ceases to be stable.

    Bisection is used as long as stability is decided, then the secant method on ln |w| of the zero
    w that has entered the unit circle, which moves smoothly in so narrow an interval.
    """
    while unstable.c > stable.c * (1.0 + _BRACKET_WIDTH):
        middle = _LeadingFront.at(math.sqrt(stable.c * unstable.c), r)
        if middle.unstable is None:
            break
        stable, unstable = (stable, middle) if middle.unstable else (middle, unstable)
    if math.isnan(stable.v) or abs(unstable.v - stable.v) > 100.0 * _BRACKET_WIDTH * stable.v:
        return _end_of_branch(stable, unstable, r)
    unknown = StabilityLimit(reason=f"stability is lost near c = {stable.c:.6g}, but not smoothly")
    symbol = unstable.symbol
    nearest = None if symbol is None else symbol.nearest_zero(1.5)
    if symbol is None or nearest is None:
        return unknown
    current, w, slope = unstable, nearest[0], math.nan
    log_modulus, step = math.log(abs(w)), 0.5 * (unstable.c - stable.c)
    low, high = stable.c * (1.0 - _BRACKET_WIDTH), unstable.c * (1.0 + _BRACKET_WIDTH)
    for _ in range(20):
        next_front = _LeadingFront.at(min(max(current.c - step, low), high), r)
        if next_front.symbol is None or next_front.c == current.c:
            break
        symbol = next_front.symbol
        w = symbol.zero_near(w)
        next_log_modulus = math.log(abs(w))
        slope = (next_log_modulus - log_modulus) / (next_front.c - current.c)
        current, log_modulus = next_front, next_log_modulus
        step = log_modulus / slope
        if not abs(step) > 1e-13 * current.c:
            break
    shift = symbol.uncertainty / symbol.slope_at(w) + abs(log_modulus)
    error = 2.0 * shift / abs(slope) + 2.0 * current.error + 4.0 * EPS * current.c
    if not error < _BRACKET_WIDTH * current.c:
        return unknown
    return StabilityLimit(c=current.c, error=float(error), v=current.v, angle=abs(cmath.phase(w)))


def _end_of_branch(last: _LeadingFront, beyond: _LeadingFront, r: float) -> StabilityLimit:
    """Return the coupling between two given ones at which an unstable front becomes the fastest.

    Either the branch of the stable front ends, in a fold, where its multiplier is 1, or because
    (47) ceases to hold; or the branch of the unstable front begins. The number of solutions of (54)
    distinguishes a fold from a change of admissibility.
    """
    low, high = _bisected(last, beyond, r, 0.0)
    # Near a fold, g = |Σ| - 2r vanishes to within its own error in an interval of c of this width.
    error = (high.c - low.c) + _FOLD_ERROR * low.c
    if low.solutions == high.solutions:
        slack = 5.0 * TOLERANCE / r  # in |φ|², ten times the violation that may go undetected
        for each in (slack, -slack):
            ends = _bisected(last, beyond, r, each, low.c)
            error += max(abs(place.c - low.c) for place in ends)
        if error > 0.4 * (beyond.c - last.c):
            reason = f"margins of (47) are too thin near c = {low.c:.6g} to locate it"
            return StabilityLimit(reason=reason)
    v = high.v if math.isnan(low.v) else low.v
    return StabilityLimit(c=low.c, error=float(error), v=v, angle=0.0)


def _bisected(
    last: _LeadingFront, beyond: _LeadingFront, r: float, slack: float, c: float = math.nan
) -> tuple[_LeadingFront, _LeadingFront]:
    """Bisect until two couplings differ by rounding only, with r + ``slack`` in (47).

    If a coupling ``c`` is given, only the distance from it matters, and a hundredth of it suffices.
    """
    low, high = last, beyond
    while high.c - low.c > 4.0 * EPS * high.c:
        if high.c - low.c < 0.01 * abs(low.c - c):
            break
        middle = _LeadingFront.at(0.5 * (low.c + high.c), r, slack)
        if not low.c < middle.c < high.c:
            break
        if abs(middle.v - beyond.v) < (math.inf if math.isnan(last.v) else abs(middle.v - last.v)):
            high = middle
        else:
            low = middle
    return low, high
