"""Many values of Σ at once by the rules that subtract roots: `segments.arch` and `corrected_axis`.

Each value is independent of the others in its block. The few values for which the iteration to a
root takes more than ``_MAX_STEPS`` steps are computed one by one.
"""

from __future__ import annotations

import numpy as np

from theory.arrays import BoolArray, ComplexArray, FloatArray, IntArray
from theory.piecewise.sums.axis import EPS, SLOWEST, STEEPEST
from theory.piecewise.sums.compiled import CompiledRules
from theory.piecewise.sums.corrected_axis import PAIR_FROM, corrected_errors
from theory.piecewise.sums.rules import fill
from theory.piecewise.sums.segments import CLEAR

_MAX_STEPS = 6
_SIZE = 2048
"""Number of values in one block, so that their tables fit the processor's cache."""

Found = tuple[ComplexArray, FloatArray, FloatArray, BoolArray]
"""Σ and derivatives, error bounds, numbers of points, and where a root did not converge."""


def sums_beside_roots(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, fast: CompiledRules
) -> tuple[ComplexArray, FloatArray, IntArray]:
    """Return Σ and derivatives, their error bounds, each of shape (3, n), and numbers of points.

    Meant for values for which the plain rule does not suffice.
    The shapes are (1, n) without ``slopes``.
    """
    rows = 3 if slopes else 1
    values, errors = np.empty((rows, v.size), dtype=complex), np.empty((rows, v.size))
    points = np.empty(v.size, dtype=np.int64)
    steep = c > STEEPEST * v
    for rule, mine in ((_arches, np.flatnonzero(steep)), (_axes, np.flatnonzero(~steep))):
        for first in range(0, mine.size, _SIZE):
            some = mine[first : first + _SIZE]
            found = rule(v[some], c[some], tolerance, slopes, fast)
            values[:, some], errors[:, some], points[some], unconverged = found
            if unconverged.any():
                left = some[unconverged]
                alone = np.empty((3, left.size), dtype=complex), np.empty((3, left.size))
                number = np.empty(left.size, dtype=np.int64)
                fill(v[left], c[left], tolerance, slopes, *alone, number)
                values[:, left], errors[:, left] = alone[0][:rows], alone[1][:rows]
                points[left] = number
    return values, errors, points


def _bounds(
    v: FloatArray, c: FloatArray, bound: FloatArray, rough: FloatArray, slopes: bool
) -> FloatArray:
    """Return the error bounds of Σ and, with ``slopes``, of its derivatives, as rows."""
    return np.stack([bound, rough / v, rough / c] if slopes else [bound])


def _arches(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, fast: CompiledRules
) -> Found:
    """Return the results of `segments.arch`."""
    rows, bounds = np.zeros((6, v.size)), np.full((2, v.size), 8.0 * EPS)
    number, unconverged = np.zeros(v.size), np.zeros(v.size)
    plan, parts, sums = np.empty((4, v.size)), np.empty((4, v.size)), np.empty((8, v.size))
    for second in (False, True):
        fast.plan_segments(v, c, tolerance, slopes, second, plan)
        if not second:
            fast.static_parts(v, c, plan[0], parts)
        offset, taken = _roots_beside(v, c, plan, second, slopes, unconverged, fast)
        fast.add_all_nodes(v, c, plan, offset, second, slopes, sums)
        fast.add_segment(v, c, plan, sums, taken, second, rows, bounds)
        if slopes:
            fast.add_segment_slopes(v, c, plan, sums, taken, second, rows)
        number += plan[1]
    rows[0] -= 1.0
    rows[0:2] += parts[0:2]
    rows[4:6] += parts[2:4]
    end = 6 if slopes else 2
    values = rows[0:end:2] + 1j * rows[1:end:2]
    errors = _bounds(v, c, bounds[0], bounds[1], slopes)
    return values, errors, number, unconverged > 0.0


def _roots_beside(
    v: FloatArray, c: FloatArray, plan: FloatArray, second: bool, slopes: bool,
    unconverged: FloatArray, fast: CompiledRules,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Return the position of the first node in steps, and the pole corrections of one segment."""
    step, psi = plan[0], plan[3]
    n = v.size
    q, rho, near = 0.5 / v, c / v, (v >= SLOWEST).astype(float)
    roots, powers, turns = np.empty((2, 6, n)), np.empty((2, 3, n)), np.empty((2, 2, n))
    halfway, whole = np.ones(n), np.ones(n)
    fast.start_roots(q, psi, rho, roots)
    for at, power, turn in zip(roots, powers, turns, strict=True):
        moving = near.copy()
        fast.converge(at, q, psi, rho, moving, _MAX_STEPS)
        np.maximum(unconverged, moving, out=unconverged)
        fast.exponents_on_segments(rho, step, at, power, turn)
        fast.exponentials(power)
        if second:
            fast.clearances(power, halfway, whole)
    offset = np.where((halfway < CLEAR) & (whole > halfway), 0.0, 0.5)
    poles, sign = np.zeros((8, n)), np.where(offset > 0.0, -1.0, 1.0)
    along = 2.0 * rho - psi if second else np.zeros(n)
    for at, power, turn in zip(roots, powers, turns, strict=True):
        root = (at, along, power, turn, sign, near, poles)
        fast.add_pole_corrections(v, c, *root)
        if slopes:
            fast.add_pole_correction_slopes(v, c, *root)
    return offset, poles


def _axes(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, fast: CompiledRules
) -> Found:
    """Return the results of `corrected_axis`."""
    n = v.size
    q, rho = 0.5 / v, c / v
    equation = q, np.zeros(n), rho
    every, paired = np.ones(n), (rho > PAIR_FROM).astype(float)
    roots, unconverged = np.empty((3, 6, n)), np.zeros(n)
    fast.start_roots(*equation, roots[:2])
    roots[1:, :2] = roots[0, :2]  # used where no pair is subtracted
    fast.start_resonant_pairs(q, rho, roots)
    taken = [(roots[0], every), (roots[1], paired), (roots[2], paired)][: 3 if paired.any() else 1]
    for at, required in taken:
        moving = required.copy()
        fast.converge(at, *equation, moving, _MAX_STEPS)
        np.maximum(unconverged, moving, out=unconverged)
    plan = np.empty((2, n))
    fast.plan_axis(v, c, tolerance, roots, plan)
    count, truncation = plan
    rows = 3 if slopes else 1
    values, sizes, poles = np.zeros((rows, n), dtype=complex), np.zeros((2, n)), np.zeros((8, n))
    for at, required in taken:
        power, turn = np.empty((3, n)), np.empty((2, n))
        fast.exponents_on_axis(count, at, power, turn)
        fast.exponentials(power)
        root = (at, np.zeros(n), power, turn, np.full(n, -1.0), required, poles)
        fast.add_pole_corrections(v, c, *root)
        if slopes:
            fast.add_pole_correction_slopes(v, c, *root)
    for number in np.unique(count):
        some = np.flatnonzero(count == number)
        values[:, some], sizes[:, some] = means_of_block(
            v[some], c[some], int(number), slopes, fast
        )
    values[0] -= 1.0
    values -= poles[0 : 2 * rows : 2] + 1j * poles[1 : 2 * rows : 2]
    rounding, rough = corrected_errors(truncation, sizes[0], sizes[1], poles[6], poles[7])
    errors = _bounds(v, c, truncation + rounding, rough, slopes)
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
