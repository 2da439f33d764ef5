"""Many values of Σ at once where roots are taken away: `legs.arch` and `corrected_axis` in loops.

What a value becomes does not depend on those beside it. The few whose roots take more than
``_MAX_STEPS`` steps are computed one by one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from theory.piecewise.dispersion import ComplexArray, FloatArray
from theory.piecewise.sums.axis import EPS, SLOWEST, STEEPEST
from theory.piecewise.sums.corrected_axis import PAIR_FROM, corrected_errors
from theory.piecewise.sums.legs import CLEAR, leg_errors, leg_weight
from theory.piecewise.sums.rules import fill

_MAX_STEPS = 6
_SIZE = 2048
"""Values in one block: their tables stay near the processor."""

Found = tuple[ComplexArray, FloatArray, FloatArray, npt.NDArray[np.bool_]]
"""Σ and derivatives, error bounds, numbers of points, and which roots did not settle."""


def sums_beside_roots(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, fast: dict[str, Any]
) -> tuple[ComplexArray, FloatArray, npt.NDArray[np.int64]]:
    """Return Σ, derivatives and error bounds, shapes (3, n), and numbers of points.

    For values for which the axis alone is not enough; ``fast`` are the compiled rules.
    """
    rows = 3 if slopes else 1
    values, errors = np.empty((rows, v.size), dtype=complex), np.empty((rows, v.size))
    points = np.empty(v.size, dtype=np.int64)
    steep = c > STEEPEST * v
    for rule, mine in ((_arches, np.flatnonzero(steep)), (_axes, np.flatnonzero(~steep))):
        for first in range(0, mine.size, _SIZE):
            some = mine[first : first + _SIZE]
            found = rule(v[some], c[some], tolerance, slopes, fast)
            values[:, some], errors[:, some], points[some], unsettled = found
            if unsettled.any():
                left = some[unsettled]
                alone = np.empty((3, left.size), dtype=complex), np.empty((3, left.size))
                number = np.empty(left.size, dtype=np.int64)
                fill(v[left], c[left], tolerance, slopes, *alone, number)
                values[:, left], errors[:, left] = alone[0][:rows], alone[1][:rows]
                points[left] = number
    return values, errors, points


def _bounds(
    v: FloatArray, c: FloatArray, bound: FloatArray, rough: FloatArray, slopes: bool
) -> FloatArray:
    """Return the bounds of Σ, and with slopes of its derivatives, as rows."""
    return np.stack([bound, rough / v, rough / c] if slopes else [bound])


def _arches(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, fast: dict[str, Any]
) -> Found:
    """Return what `legs.arch` does."""
    rows = 3 if slopes else 1
    values, bounds = np.zeros((rows, v.size), dtype=complex), np.full((2, v.size), 8.0 * EPS)
    number, unsettled = np.zeros(v.size), np.zeros(v.size)
    for second in (False, True):
        plan = np.empty((4, v.size))
        fast["plan_legs"](v, c, tolerance, slopes, second, plan)
        step, count, truncation, _ = plan
        if not second:
            parts = np.empty((4, v.size))
            fast["still_parts"](v, c, step, parts)
        offset, taken = _roots_beside(v, c, plan, second, slopes, unsettled, fast)
        sums = _nodes_on_legs(v, c, plan, offset, second, slopes, fast)
        weight = leg_weight(v, c, step)
        width = np.abs(weight)
        turn = -1j if second else 1j  # of the second leg the conjugate is added
        factors = (weight, -weight / (v * v), weight) if slopes else (weight,)
        for row, factor in enumerate(factors):
            term = (sums[3 * row] + 1j * sums[3 * row + 1]) * factor
            values[row] += term.real - taken[2 * row] + turn * (term.imag - taken[2 * row + 1])
        size, steep = width * sums[2], width * sums[5] / v
        rounding, rough = leg_errors(v, c, second, truncation, size, steep, taken[6], taken[7])
        bounds[0] += truncation + rounding
        bounds[1] += rough
        number += count
    values[0] += parts[0] - 1.0 + 1j * parts[1]
    if slopes:
        values[2] += parts[2] + 1j * parts[3]
    return values, _bounds(v, c, bounds[0], bounds[1], slopes), number, unsettled > 0.0


def _nodes_on_legs(
    v: FloatArray, c: FloatArray, plan: FloatArray, offset: FloatArray, second: bool,
    slopes: bool, fast: dict[str, Any],
) -> FloatArray:  # fmt: skip
    """Return Re and Im of the sum of g, Σ|g|, and the like of the derivatives, as rows."""
    step, count, _, psi = plan
    at, sums = np.empty((5, v.size)), np.zeros((8, v.size))
    fast["start_nodes"](v, psi, step, offset, at)
    for j in range(int(count.max(initial=0.0))):
        fast["add_nodes"](j, v, c, step, offset, count, at, second, sums)
        if slopes:
            fast["add_node_slopes"](j, v, c, step, offset, count, at, second, sums)
        fast["next_nodes"](at)
    return sums


def _roots_beside(
    v: FloatArray, c: FloatArray, plan: FloatArray, second: bool, slopes: bool,
    unsettled: FloatArray, fast: dict[str, Any],
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Return the place of the first node in steps, and the effects of the roots beside one leg."""
    step, psi = plan[0], plan[3]
    n = v.size
    q, rho, near = 0.5 / v, c / v, (v >= SLOWEST).astype(float)
    roots, powers, turns = np.empty((2, 6, n)), np.empty((2, 3, n)), np.empty((2, 2, n))
    halfway, whole = np.ones(n), np.ones(n)
    fast["start_roots"](q, psi, rho, roots)
    for at, power, turn in zip(roots, powers, turns, strict=True):
        _settle(at, (q, psi, rho), near, unsettled, fast)
        fast["exponents_on_legs"](rho, step, at, power, turn)
        fast["exponentials"](power)
        if second:
            fast["clearances"](power, halfway, whole)
    offset = np.where((halfway < CLEAR) & (whole > halfway), 0.0, 0.5)
    effects, sign = np.zeros((8, n)), np.where(offset > 0.0, -1.0, 1.0)
    along = 2.0 * rho - psi if second else np.zeros(n)
    for at, power, turn in zip(roots, powers, turns, strict=True):
        root = (at, along, power, turn, sign, near, effects)
        fast["add_effects"](v, c, *root)
        if slopes:
            fast["add_effect_slopes"](v, c, *root)
    return offset, effects


def _settle(
    at: FloatArray, equation: tuple[FloatArray, FloatArray, FloatArray], required: FloatArray,
    unsettled: FloatArray, fast: dict[str, Any],
) -> None:  # fmt: skip
    """Take steps to the roots that are required; write p, sin(p/2) and cos(p/2) as rows."""
    moving = required.copy()
    fast["halves"](at)
    for _ in range(_MAX_STEPS):
        fast["step_all"](at, *equation, moving)
        fast["halves"](at)
        if not moving.any():
            return
    np.maximum(unsettled, moving, out=unsettled)


def _axes(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, fast: dict[str, Any]
) -> Found:
    """Return what `corrected_axis` does."""
    n = v.size
    q, rho = 0.5 / v, c / v
    equation = q, np.zeros(n), rho
    every, paired = np.ones(n), (rho > PAIR_FROM).astype(float)
    roots, unsettled = np.empty((3, 6, n)), np.zeros(n)
    fast["start_roots"](*equation, roots[:2])
    roots[1:, :2] = roots[0, :2]  # where no pair is taken away
    fast["start_resonant_pairs"](q, rho, roots)
    taken = [(roots[0], every), (roots[1], paired), (roots[2], paired)][: 3 if paired.any() else 1]
    for at, required in taken:
        _settle(at, equation, required, unsettled, fast)
    plan = np.empty((2, n))
    fast["plan_axis"](v, c, tolerance, roots, plan)
    count, truncation = plan
    values, sizes, effects = np.zeros((3, n), dtype=complex), np.zeros((2, n)), np.zeros((8, n))
    for at, required in taken:
        power, turn = np.empty((3, n)), np.empty((2, n))
        fast["exponents_on_axis"](count, at, power, turn)
        fast["exponentials"](power)
        root = (at, np.zeros(n), power, turn, np.full(n, -1.0), required, effects)
        fast["add_effects"](v, c, *root)
        if slopes:
            fast["add_effect_slopes"](v, c, *root)
    for number in np.unique(count):
        some = np.flatnonzero(count == number)
        values[:, some], sizes[:, some] = means_of_block(
            v[some], c[some], int(number), slopes, fast
        )
    values[0] -= 1.0
    values -= effects[0:6:2] + 1j * effects[1:6:2]
    rounding, rough = corrected_errors(truncation, sizes[0], sizes[1], effects[6], effects[7])
    errors = _bounds(v, c, truncation + rounding, rough, slopes)
    return values[: errors.shape[0]], errors, count / 2, unsettled > 0.0


def means_of_block(
    v: FloatArray, c: FloatArray, count: int, slopes: bool, fast: dict[str, Any]
) -> tuple[ComplexArray, FloatArray]:
    """Return the means of G, ∂G/∂v, ∂G/∂c over the points, and rms of |G| and |∂G/∂ ln v|."""
    values, sizes = np.zeros((3, v.size), dtype=complex), np.zeros((2, v.size))
    q = 0.5 / v
    re, im, squares = fast["block_values"](v, c, count)
    values[0], sizes[0] = q * (re + 1j * im), q * np.sqrt(squares)
    if slopes:
        re, im, squares, re_c, im_c = fast["block_slopes"](v, c, count)
        values[1], sizes[1] = -2.0 * q * q * (re + 1j * im), 2.0 * q * np.sqrt(squares)
        values[2] = q * q * (im_c - 1j * re_c)
    return values, sizes
