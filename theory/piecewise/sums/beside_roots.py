"""Many values of Σ at once by the rules that subtract roots: `segments.arch` and `corrected_axis`.

The few values for which the iteration to a root takes more than ``_MAX_STEPS`` steps are computed
one by one.
"""

from __future__ import annotations

import numpy as np

from theory.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from theory.piecewise.sums.axis import STEEPEST
from theory.piecewise.sums.compiled import CompiledRules
from theory.piecewise.sums.corrected_axis import corrected_errors
from theory.piecewise.sums.rules import fill

_MAX_STEPS = 6

Found = tuple[ComplexArray, FloatArray, FloatArray, BoolArray]
"""Σ and derivatives, error bounds, numbers of points, and where a root did not converge."""


def sums_beside_roots(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, fast: CompiledRules
) -> tuple[ComplexArray, FloatArray, IntArray]:
    """Return Σ and derivatives, their error bounds, each of shape (3, n), and numbers of points.

    This is for values for which the plain rule does not suffice. Without ``slopes`` the shapes are
    (1, n).
    """
    rows = 3 if slopes else 1
    values, errors = np.empty((rows, v.size), dtype=complex), np.empty((rows, v.size))
    points = np.empty(v.size, dtype=np.int64)
    steep = c > STEEPEST * v
    for rule, index in ((_arches, np.flatnonzero(steep)), (_axes, np.flatnonzero(~steep))):
        if not index.size:
            continue
        found = rule(v[index], c[index], tolerance, slopes, fast)
        values[:, index], errors[:, index], points[index], unconverged = found
        if unconverged.any():
            remaining = index[unconverged]
            found_singly = (
                np.empty((3, remaining.size), dtype=complex),
                np.empty((3, remaining.size)),
            )
            points_singly = np.empty(remaining.size, dtype=np.int64)
            fill(v[remaining], c[remaining], tolerance, slopes, *found_singly, points_singly)
            values[:, remaining], errors[:, remaining] = (
                found_singly[0][:rows],
                found_singly[1][:rows],
            )
            points[remaining] = points_singly
    return values, errors, points


def _bounds(
    v: FloatArray, c: FloatArray, bound: FloatArray, slope_bound: FloatArray, slopes: bool
) -> FloatArray:
    """Return the error bounds of Σ and, with ``slopes``, of its derivatives, as rows."""
    return np.stack([bound, slope_bound / v, slope_bound / c] if slopes else [bound])


def _arches(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, fast: CompiledRules
) -> Found:
    """Return the results of `segments.arch`."""
    found = np.empty((10, v.size))
    fast.arches(v, c, tolerance, slopes, _MAX_STEPS, found)
    bound, slope_bound, number, unconverged = found[6:]
    end = 6 if slopes else 2
    values = found[0:end:2] + 1j * found[1:end:2]
    return values, _bounds(v, c, bound, slope_bound, slopes), number, unconverged > 0.0


def _axes(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, fast: CompiledRules
) -> Found:
    """Return the results of `corrected_axis`."""
    found = np.empty((11, v.size))
    fast.corrections_on_axis(v, c, tolerance, slopes, _MAX_STEPS, found)
    poles, (count, truncation, unconverged) = found[:8], found[8:]
    rows = 3 if slopes else 1
    values, sizes = np.zeros((rows, v.size), dtype=complex), np.zeros((2, v.size))
    for number in np.unique(count):
        group = np.flatnonzero(count == number)
        values[:, group], sizes[:, group] = means_of_block(
            v[group], c[group], int(number), slopes, fast
        )
    values[0] -= 1.0
    values -= poles[0 : 2 * rows : 2] + 1j * poles[1 : 2 * rows : 2]
    rounding, slope_bound = corrected_errors(truncation, sizes[0], sizes[1], poles[6], poles[7])
    errors = _bounds(v, c, truncation + rounding, slope_bound, slopes)
    return values, errors, count / 2, unconverged > 0.0


def means_of_block(
    v: FloatArray, c: FloatArray, count: int, slopes: bool, fast: CompiledRules
) -> tuple[ComplexArray, FloatArray]:
    """Return the means of G, ∂G/∂v, ∂G/∂c over the points, and the rms of |G| and |∂G/∂ ln v|."""
    values, sizes = np.empty((3 if slopes else 1, v.size), dtype=complex), np.zeros((2, v.size))
    q = 0.5 / v
    re, im, squares = fast.block_values(v, c, count)
    values.real[0], values.imag[0], sizes[0] = q * re, q * im, q * np.sqrt(squares)
    if slopes:
        re, im, squares, re_c, im_c = fast.block_slopes(v, c, count)
        values[1], sizes[1] = -2.0 * q * q * (re + 1j * im), 2.0 * q * np.sqrt(squares)
        values[2] = q * q * (im_c - 1j * re_c)
    return values, sizes
