"""Initial value problems in extended precision: Gragg's midpoint rule, extrapolated.

The midpoint rule with n substeps and Gragg's smoothing has an error in even powers of 1/n (Gragg
1965; Hairer, Nørsett and Wanner, section II.9), so that eight columns of the Aitken-Neville scheme
give order sixteen. In numpy's long double, which has a 64-bit significand on most processors, a run
over several periods is accurate to about 1e-16 of its size, which is beyond what a run in double
precision can state. Any numbers that numpy holds as objects, such as those of mpmath, are treated
by the same code.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from theory.arrays import AnyArray
from verification.references.pace import Pace

Rate = Callable[[Any, AnyArray], AnyArray]

COLUMNS = 8
"""Number of columns of the scheme; the order is twice as large. With more columns, rounding errors,
which the scheme amplifies by a factor of a hundred here, outweigh the gain."""

TOLERANCE, LOOSER = 1e-17, 1e-16
"""Error per step, relative to the size of the state, of a reference and of the run with which it is
compared. Their difference is mainly the error of the latter, and both have independent rounding
errors."""

_ENLARGED = sum(
    math.prod(k * k / abs(k * k - j * j) for j in range(1, COLUMNS + 1) if j != k)
    for k in range(1, COLUMNS + 1)
)
"""Sum of the absolute weights with which the last entry of the scheme combines its rows."""

_SAFETY, _MIN_FACTOR, _MAX_FACTOR = 0.8, 0.1, 3.0


@dataclass(frozen=True, kw_only=True)
class PreciseState:
    """A state and its uncertainty.

    Attributes
    ----------
    value : ndarray
        The state in extended precision, in the shape of the start.
    uncertainty : float
        In the units of the state, maximum norm; for a single run, that of its rounding errors.
    """

    value: AnyArray
    uncertainty: float

    def beside(self, looser: Self) -> Self:
        """Return this state with its distance from that of another run in its uncertainty."""
        off = float(np.abs(self.value - looser.value).max(initial=0.0))
        return replace(self, uncertainty=off + self.uncertainty)


def precise_state(rate: Rate, start: AnyArray, end: float) -> PreciseState:
    """Return the state at the end of a run from zero in extended precision.

    Its uncertainty is the distance from a run at ten times the tolerance, which takes different
    steps, plus the rounding that may have accumulated at each step.

    Raises
    ------
    TooSlowError
        If the problem is too stiff for an explicit method.

    Examples
    --------
    >>> found = precise_state(lambda _, y: -y, np.array([1.0]), 1.0)
    >>> abs(float(found.value[0]) - math.exp(-1)) < 1e-16, found.uncertainty < 1e-16
    (True, True)
    """
    tight, looser = (integrate(rate, extended(start), end, each) for each in (TOLERANCE, LOOSER))
    return tight.beside(looser)


def extended(values: Any) -> AnyArray:
    """Return the same numbers in extended precision.

    Examples
    --------
    >>> extended([1.0]).dtype == np.longdouble, extended([1j]).dtype == np.clongdouble
    (True, True)
    """
    array = np.asarray(values)
    return array.astype(np.clongdouble if array.dtype.kind == "c" else np.longdouble)


def integrate(rate: Rate, start: AnyArray, end: float, tolerance: float) -> PreciseState:
    """Return the state at the end of a run from time zero, in the number type of the start.

    Its uncertainty includes rounding only: a unit in the last place of the largest size per step,
    amplified by the weights of the scheme.

    Parameters
    ----------
    rate : callable
        Right-hand side, a function of t and the state.
    start : ndarray
        Array of long doubles or of objects.
    end : float
        Time at the end; negative for a backward run.
    tolerance : float
        Estimated error per step relative to the largest size of the state so far.

    Raises
    ------
    TooSlowError
        If the steps become so small that the run would take too long: the problem is too stiff for
        an explicit method.
    """
    span, t = _as_time(start, end), _as_time(start, 0.0)
    state, taken, size, pace = start, 0, float(np.abs(start).max()), Pace()
    step = span / max(1.0, 2.0 * abs(float(span)))
    while abs(t) < abs(span):
        step = span - t if abs(step) >= abs(span - t) else step
        with np.errstate(all="ignore"):  # a step that overflows is rejected
            proposed, error = _step(rate, t, state, step)
        pace.check(float(t / span))
        allowed = tolerance * max(size, float(np.abs(proposed).max()))
        if error <= allowed:
            t, state, taken = t + step, proposed, taken + 1
            size = max(size, float(np.abs(state).max()))
        step = step * _change(error, allowed)
    unit = 0.0 if start.dtype == object else float(np.finfo(start.dtype).eps)
    return PreciseState(value=state, uncertainty=taken * unit * _ENLARGED * size)


def _as_time(start: AnyArray, t: float) -> Any:
    """Return a time in the number type of the state."""
    return abs(type(start.flat[0])(1)) * t


def _change(error: float, allowed: float) -> float:
    """Return the ratio of the next step to the one that had this error."""
    if error == 0.0:
        return _MAX_FACTOR
    share = allowed / error
    required: float = _SAFETY * share ** (1.0 / (2 * COLUMNS - 1)) if math.isfinite(share) else 0.0
    return min(_MAX_FACTOR, max(_MIN_FACTOR, required))


def _step(rate: Rate, t: Any, state: AnyArray, step: Any) -> tuple[AnyArray, float]:
    """Return the state after a step, and the difference of the last two entries of the scheme."""
    first = rate(t, state)
    row: list[AnyArray] = []
    for k in range(1, COLUMNS + 1):
        previous, row = row, [_midpoint(rate, t, state, first, step, substeps=2 * k)]
        for j, before in enumerate(previous, start=1):
            # Substeps 2k and 2(k - j): the weight 1/((n_k/n_{k-j})² - 1).
            fewer = (k - j) ** 2
            row.append(row[-1] + fewer * (row[-1] - before) / (k * k - fewer))
    return row[-1], float(np.abs(row[-1] - row[-2]).max())


def _midpoint(
    rate: Rate, t: Any, state: AnyArray, first: AnyArray, step: Any, *, substeps: int
) -> AnyArray:
    """Return the state after a step by the midpoint rule, smoothed.

    Arrays come first in products, because mpmath prints a number that is multiplied by one.
    """
    h = step / substeps
    twice = 2 * h
    before, here = state, state + first * h
    for i in range(1, substeps):
        before, here = here, before + rate(t + i * h, here) * twice
    out: AnyArray = (before + here + rate(t + step, here) * h) / 2
    return out
