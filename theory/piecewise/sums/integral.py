"""Σ(v, c) as one integral over a period, by the trapezoidal rule: fast at any v and c.

Summing the real-line integral -1 + (v/π)∫₀^∞ dk/(A² + v²k²) over all periods of A in closed form,

    Σ(v, c) = -1 + (1/2π) ∫_{-π}^{π} G dk,   G = [1/(2A)] sinh a/(cosh a - cos k),   a = A/v.

With X = sin²(k/2), A = ½ - 2icX, E = e^{-a}, F = 1 - E this is free of overflow and cancellation:

    sinh a/(cosh a - cos k) = F (2 - F)/[F² + 4X(1 - F)].

``theory.piecewise.sums.rules`` has the points. This module runs these rules over arrays. Values
for which points on the axis are enough are grouped by their number, and each group is one array, or
from where that saves time one compiled loop; the others are computed one by one.
"""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np
import numpy.typing as npt

from theory.parameters import within
from theory.piecewise.dispersion import ComplexArray, FloatArray
from theory.piecewise.roots import checked_velocity_and_coupling
from theory.piecewise.sums import axis, rules
from theory.piecewise.sums.beside_roots import means_of_block, sums_beside_roots
from theory.piecewise.sums.compiled import compiled_rules
from theory.piecewise.sums.result import KineticSum

MANY = 20_000
"""Values from which the compiled rules are taken; loading them takes half a second.

They differ from the plain ones by roundings. The choice therefore depends on the question alone:
what a process has computed before must not show in the last digit.
"""
SMALLEST, LARGEST = 1e-20, 1e20
"""Range of v and c in arrays: beyond, squares of what the rules compute leave that of numbers."""
_FEW_POINTS = 1000
"""Values whose numbers of points are rounded up to powers of two."""
_FEW_VALUES = 3
"""Values that are computed sooner one by one than as an array."""
_PIECE = 2**15
"""Points on the axis at a time."""


@dataclass(frozen=True)
class SumArray:
    """Σ at many (v, c), with derivatives.

    Attributes
    ----------
    value : ndarray of complex
        Σ(v, c), shape of the broadcast v and c.
    error : ndarray of float
        Bound on the error of ``value``.
    by_v, by_c : ndarray of complex or None
        ∂Σ/∂v and ∂Σ/∂c, if asked for.
    error_by_v, error_by_c : ndarray of float or None
        Bounds on their errors.
    points : ndarray of int
        Points of the trapezoidal rule at which the integrand was evaluated.
    """

    value: ComplexArray
    error: FloatArray
    by_v: ComplexArray | None
    by_c: ComplexArray | None
    error_by_v: FloatArray | None
    error_by_c: FloatArray | None
    points: npt.NDArray[np.int64]


def sum_by_integral(v: float, c: float, tolerance: float = 1e-13) -> KineticSum:
    """Return Σ(v, c) of Eq. (53) by the periodised integral.

    Parameters
    ----------
    v, c : float
        Front velocity v̂ and coupling, dimensionless, from 1e-12 to 1e12.
    tolerance : float
        Required error, from 1e-15 to 0.1; the error bound is its truncation plus rounding.

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
    within("tolerance", tolerance, 1e-15, 0.1)
    value, _, _, truncation, rounding, _, points = rules.sum_at(v, c, tolerance, False)
    return KineticSum(
        value=value,
        error=truncation + rounding,
        terms=points,
        method="integral",
        seconds=perf_counter() - start,
    )


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
        Front velocity v̂ and coupling, dimensionless, from 1e-20 to 1e20.
    tolerance : float
        Required truncation error, from 1e-15 to 0.1. Points are spent accordingly.
    slopes : bool
        Also return ∂Σ/∂v and ∂Σ/∂c.
    compiled : bool, optional
        Whether to take the compiled rules; by default from ``MANY`` values on.

    Raises
    ------
    ParameterError
        If the tolerance, or any v or c, is out of range.
    """
    within("tolerance", tolerance, 1e-15, 0.1)
    v_, c_ = np.asarray(v, dtype=float), np.asarray(c, dtype=float)
    for name, given in (("velocity v", v_), ("coupling c", c_)):
        for extreme in (given.min(), given.max()) if given.size else ():
            within(name, float(extreme), SMALLEST, LARGEST, "use a limit formula beyond")
    v_, c_ = np.broadcast_arrays(v_, c_)
    shape = v_.shape
    v_, c_ = v_.ravel(), c_.ravel()
    fast = compiled_rules() if (v_.size >= MANY if compiled is None else compiled) else None
    if v_.size <= _FEW_VALUES and not fast:
        found = _one_by_one(v_, c_, tolerance, slopes)
        return _as_array(*found, shape, slopes)
    points, truncation = axis.plan(v_, c_, tolerance)
    if v_.size < _FEW_POINTS and not fast:  # more points cost less than more groups
        power = np.exp2(np.ceil(np.log2(np.maximum(points, 1))))
        more = np.maximum(points, np.minimum(power, axis.MAX_PLAIN))
        points = np.where(points, more, 0.0).astype(np.int64)
    # sixteen bits are sorted in linear time, and no plain rule has as many points
    order = np.argsort(points.astype(np.int16), kind="stable")
    counts, first = np.unique(points[order], return_index=True)
    v_, c_, truncation = v_[order], c_[order], truncation[order]
    rows = 3 if slopes else 1
    values, errors = np.empty((rows, v_.size), dtype=complex), np.empty((rows, v_.size))
    ends = np.append(first, v_.size)[1:]
    for count, start, end in zip(counts.tolist(), first, ends, strict=True):
        part = slice(start, end)
        at = v_[part], c_[part]
        if count and (fast or end - start > _FEW_VALUES):
            sums_, bounds = _plain(*at, truncation[part], count, slopes=slopes, fast=fast)
            points[order[part]] = count // 2
        else:
            sums_, bounds, points[order[part]] = (
                sums_beside_roots(*at, tolerance, slopes, fast)
                if fast
                else _one_by_one(*at, tolerance, slopes)
            )
        values[:, part], errors[:, part] = sums_[:rows], bounds[:rows]
    in_order, errors_in_order = np.empty_like(values), np.empty_like(errors)
    in_order[:, order], errors_in_order[:, order] = values, errors
    return _as_array(in_order, errors_in_order, points, shape, slopes)


def _as_array(
    values: ComplexArray, errors: FloatArray, points: npt.NDArray[np.int64],
    shape: tuple[int, ...], slopes: bool,
) -> SumArray:  # fmt: skip
    values_, errors_ = (rows.reshape(len(rows), *shape) for rows in (values, errors))
    points = points.reshape(shape)
    if not slopes:
        return SumArray(values_[0], errors_[0], None, None, None, None, points)
    value, by_v, by_c = values_
    error, error_by_v, error_by_c = errors_
    return SumArray(value, error, by_v, by_c, error_by_v, error_by_c, points)


def _plain(
    v: FloatArray, c: FloatArray, truncation: FloatArray, count: int, *, slopes: bool,
    fast: dict[str, Any] | None,
) -> tuple[ComplexArray, FloatArray]:  # fmt: skip
    """Return Σ and derivatives with no root taken away, and their error bounds, shapes (3, n)."""
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
    rounding, rough = axis.plain_errors(v, c, truncation, *sizes)
    bounds = [truncation + rounding, rough / v, rough / c] if slopes else [truncation + rounding]
    return values, np.stack(bounds)


def _one_by_one(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool
) -> tuple[ComplexArray, FloatArray, npt.NDArray[np.int64]]:
    """Return Σ, derivatives and error bounds, shapes (3, n), and points, by any rule."""
    values, errors = np.empty((3, v.size), dtype=complex), np.empty((3, v.size))
    points = np.empty(v.size, dtype=np.int64)
    rules.fill(v, c, tolerance, slopes, values, errors, points)
    return values, errors, points
