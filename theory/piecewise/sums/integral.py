"""Σ(v, c) as one integral over a period, by the trapezoidal rule: fast at any v and c.

Summed over all periods of A in closed form, the real-line integral -1 + (v/π)∫₀^∞ dk/(A² + v²k²)
becomes

    Σ(v, c) = -1 + (1/2π) ∫_{-π}^{π} G dk,   G = [1/(2A)] sinh a/(cosh a - cos k),   a = A/v.

With X = sin²(k/2), A = ½ - 2icX, E = e^{-a}, F = 1 - E, it takes a form that is free of overflow
and cancellation:

    sinh a/(cosh a - cos k) = F (2 - F)/[F² + 4X(1 - F)].

``theory.piecewise.sums.rules`` contains the trapezoidal rules, and this module applies them to
arrays. Values for which the plain rule suffices are grouped by the number of points; each group is
computed as one array or, for many values, in one compiled loop. The others are computed one by one
or, for many values, in the compiled loops of ``theory.piecewise.sums.beside_roots``.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from time import perf_counter
from typing import Any

import numpy as np
import numpy.typing as npt

from theory.arrays import ComplexArray, FloatArray, IntArray
from theory.parameters import Range, with_ranges, within
from theory.piecewise.roots import PARAMETERS, checked_velocity_and_coupling
from theory.piecewise.sums import axis, rules
from theory.piecewise.sums.beside_roots import means_of_block, sums_beside_roots
from theory.piecewise.sums.compiled import CompiledRules, compiled_rules
from theory.piecewise.sums.result import KineticSum

MANY = 20_000
"""Number of values from which the compiled rules are used; importing numba takes half a second.

The compiled rules differ from the plain ones by rounding. The choice therefore depends on the
arguments alone, so that the last digit does not depend on what a process has computed before.
"""
TOLERANCES = Range(1e-15, 0.1)
IN_ARRAYS = Range(1e-20, 1e20)
"""Range of v and c in arrays; outside it intermediate squares would overflow or underflow."""
_FEW_POINTS = 1000
"""Number of values below which numbers of points are rounded up to powers of two."""
_POINTS_OF_A_GROUP = 4096
"""Number of points whose evaluation costs as much as the function calls of one more group."""
_FEW_VALUES = 3
"""Largest number of values for which computing one by one is faster than as groups of an array."""
_PIECE = 2**15
"""Number of points on the axis that are evaluated at a time."""

Rows = tuple[ComplexArray, FloatArray, IntArray]
"""Values and error bounds, one row each for Σ and its derivatives, and numbers of points."""


@dataclass(frozen=True, kw_only=True)
class SumArray:
    """Σ at many (v, c), with derivatives.

    Attributes
    ----------
    value : ndarray of complex
        Σ(v, c), shape of the broadcast v and c.
    error : ndarray of float
        Bound on the error of ``value``.
    by_v, by_c : ndarray of complex or None
        ∂Σ/∂v and ∂Σ/∂c, if requested.
    error_by_v, error_by_c : ndarray of float or None
        Bounds on their errors.
    points : ndarray of int
        Number of points at which the integrand was evaluated.
    """

    value: ComplexArray
    error: FloatArray
    by_v: ComplexArray | None
    by_c: ComplexArray | None
    error_by_v: FloatArray | None
    error_by_c: FloatArray | None
    points: IntArray


@with_ranges(parameters=PARAMETERS, tolerances=TOLERANCES)
def sum_by_integral(v: float, c: float, tolerance: float = 1e-13) -> KineticSum:
    """Return Σ(v, c) of Eq. (53) by the periodised integral.

    Parameters
    ----------
    v, c : float
        Front velocity v̂ and coupling, dimensionless, {parameters}.
    tolerance : float
        Required truncation error, {tolerances}; the error bound adds the rounding error.

    Raises
    ------
    ParameterError
        If a parameter is out of range.

    Examples
    --------
    >>> result = sum_by_integral(0.3, 0.5)
    >>> bool(abs(result.value - (-0.28879675619025+0.45226875874939j)) < 1e-13)
    True
    """
    start = perf_counter()
    v, c = checked_velocity_and_coupling(v, c)
    within("tolerance", tolerance, *TOLERANCES)
    value, _, _, truncation, rounding, _, points = rules.sum_at(v, c, tolerance, False)
    return KineticSum(
        value=complex(value),
        error=truncation + rounding,
        terms=points,
        method="integral",
        seconds=perf_counter() - start,
    )


@with_ranges(in_arrays=IN_ARRAYS, tolerances=TOLERANCES)
def sums(
    v: npt.ArrayLike,
    c: npt.ArrayLike,
    tolerance: float = 1e-13,
    slopes: bool = False,
    compiled: bool | None = None,
) -> SumArray:
    """Return Σ(v, c) for arrays of v and c, broadcast together.

    Parameters
    ----------
    v, c : array_like of float
        Front velocity v̂ and coupling, dimensionless, {in_arrays}.
    tolerance : float
        Required truncation error, {tolerances}; it determines the number of points.
    slopes : bool
        Also return ∂Σ/∂v and ∂Σ/∂c.
    compiled : bool, optional
        Whether to use the compiled rules; by default from ``MANY`` values on.

    Raises
    ------
    ParameterError
        If the tolerance, or any v or c, is out of range.
    """
    within("tolerance", tolerance, *TOLERANCES)
    v_, c_ = np.asarray(v, dtype=float), np.asarray(c, dtype=float)
    for name, given in (("velocity v", v_), ("coupling c", c_)):
        for extreme in (given.min(), given.max()) if given.size else ():
            within(name, float(extreme), *IN_ARRAYS)
    v_, c_ = np.broadcast_arrays(v_, c_)
    fast = v_.size >= MANY if compiled is None else compiled
    values, errors, points = sums_of_pairs(v_.ravel(), c_.ravel(), tolerance, slopes, fast)
    values = values.reshape(len(values), *v_.shape)
    errors = errors.reshape(len(errors), *v_.shape)
    return SumArray(
        value=values[0],
        error=errors[0],
        by_v=values[1] if slopes else None,
        by_c=values[2] if slopes else None,
        error_by_v=errors[1] if slopes else None,
        error_by_c=errors[2] if slopes else None,
        points=points.reshape(v_.shape),
    )


def sums_of_pairs(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, compiled: bool
) -> Rows:
    """Return Σ and its derivatives where v, c and the tolerance are known to be in range.

    This is `sums` without checks. The results are arrays of rows: Σ and, with ``slopes``, ∂Σ/∂v and
    ∂Σ/∂c, shape (1, n) or (3, n); bounds on their errors; and the numbers of points.
    """
    fast = compiled_rules() if compiled else None
    if 2 < v.size < _FEW_POINTS and not fast:  # two values are faster one by one
        # The bounds grow with v and with c, so that those of the largest hold for all values.
        largest = float(v.max()), float(c.max())
        count, truncation = axis.plain_points(*largest, tolerance)
        if v.size * count <= _POINTS_OF_A_GROUP and axis.is_plain(*largest, count):
            bounds = truncation, axis.slope_truncation(*largest, count) if slopes else 0.0
            together = _plain(v, c, int(count), bounds, slopes=slopes, fast=None)
            return *together, np.full(v.size, int(count) // 2)
    if v.size <= _FEW_VALUES and not fast:
        return _one_by_one(v, c, tolerance, slopes)
    points, truncation = axis.plan(v, c, tolerance)
    if v.size < _FEW_POINTS and not fast:  # more points cost less than more groups
        power_of_two = np.exp2(np.ceil(np.log2(np.maximum(points, 1))))
        if v.size * power_of_two.max() <= _POINTS_OF_A_GROUP:
            power_of_two = points.max()
        rounded_up = np.maximum(points, np.minimum(power_of_two, axis.MAX_PLAIN))
        points = np.where(points, rounded_up, 0.0).astype(np.int64)
    # 16-bit integers are sorted in linear time, and the plain rule never has more points than fit
    order = np.argsort(points.astype(np.int16), kind="stable")
    v, c, truncation, points = v[order], c[order], truncation[order], points[order]
    rows = 3 if slopes else 1
    values, errors = np.empty((rows, v.size), dtype=complex), np.empty((rows, v.size))
    ends = [*(np.flatnonzero(points[1:] != points[:-1]) + 1).tolist(), v.size] if v.size else []
    for start, end in pairwise([0, *ends]):
        part, count = slice(start, end), int(points[start])
        pairs = v[part], c[part]
        if count and (fast or end - start > _FEW_VALUES):
            bounds = truncation[part], axis.slope_truncation(*pairs, count) if slopes else 0.0
            values[:, part], errors[:, part] = _plain(
                *pairs, count, bounds, slopes=slopes, fast=fast
            )
            points[part] = count // 2
        else:
            values[:, part], errors[:, part], points[part] = (
                sums_beside_roots(*pairs, tolerance, slopes, fast)
                if fast
                else _one_by_one(*pairs, tolerance, slopes)
            )
    inverse_order = np.empty_like(order)
    inverse_order[order] = np.arange(order.size)
    return (
        values.take(inverse_order, axis=1),
        errors.take(inverse_order, axis=1),
        points.take(inverse_order),
    )


def _plain(
    v: FloatArray, c: FloatArray, count: int, truncation: tuple[Any, Any], *, slopes: bool,
    fast: CompiledRules | None,
) -> tuple[ComplexArray, FloatArray]:  # fmt: skip
    """Return Σ, derivatives and error bounds as rows, by the plain rule.

    ``truncation`` holds the bounds of the truncation errors of Σ and of its derivatives.
    """
    rows = 3 if slopes else 1
    if fast:
        values, sizes = means_of_block(v, c, count, slopes, fast)
    else:
        values, sizes = np.zeros((3, v.size), dtype=complex), np.zeros((2, v.size))
        piece = max(1, _PIECE // count)
        for start in range(0, v.size, piece):
            part = slice(start, start + piece)
            found = axis.axis_means(v[part, None], c[part, None], count, slopes)
            for row, column in zip((*values, *sizes), found, strict=True):
                row[part] = column
    values[0] -= 1.0
    rounding, slope_bound = axis.plain_errors(v, c, *sizes)
    bounds = [truncation[0] + rounding]
    if slopes:
        slope_bound += truncation[1]
        bounds += [slope_bound / v, slope_bound / c]
    return values[:rows], np.array(bounds)


def _one_by_one(v: FloatArray, c: FloatArray, tolerance: float, slopes: bool) -> Rows:
    """Return the results of `sums_of_pairs`, computed one by one with the rule each value needs."""
    rows = 3 if slopes else 1
    values, errors = np.empty((3, v.size), dtype=complex), np.empty((3, v.size))
    points = np.empty(v.size, dtype=np.int64)
    rules.fill(v, c, tolerance, slopes, values, errors, points)
    return values[:rows], errors[:rows], points
