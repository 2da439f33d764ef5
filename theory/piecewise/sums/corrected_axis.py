"""Points on the real axis, one or three roots subtracted; see ``theory.piecewise.sums.rules``."""

from __future__ import annotations

import cmath
import math
from typing import Any

from theory.piecewise.sums.axis import EPS, SLOPE_SHARE, axis_means
from theory.piecewise.sums.poles import (
    bounded_exp,
    pole_correction,
    resonant_pair,
    root_near,
    side_of,
    two_roots_near,
)

PAIR_FROM = 1.0
"""c/v above which the resonant pair of roots is subtracted too."""


def strip_of_remainder(v: float, c: float) -> tuple[float, float]:
    """Return σ and a bound of |G̃| on |Im k| = σ, G̃ being G with the roots subtracted."""
    rho = c / v
    if rho > PAIR_FROM:
        return math.acosh(9.0 / rho - 1.0) - 0.25, 1.0 / (1.0 + c)
    return math.acosh(1.7 / rho), 2.5 / (1.0 + c)


def points_beside_roots(bound: float, tolerance: float, depth: float) -> int:
    """Return N, a multiple of 4, such that the truncation error is at most the tolerance."""
    return max(8, 4 * math.ceil(0.25 * math.log1p(2.0 * bound / tolerance) / depth))


def truncation_beside_roots(bound: float, count: float, depth: float) -> float:
    """Return 2 bound/(e^{N depth} - 1), or a larger number where that is below 1e-300."""
    return 2.0 * bound / math.expm1(min(count * depth, 700.0))


def is_at_a_point(k: complex, count: int) -> bool:
    """Return whether a root k above the axis is so near a node that digits are lost."""
    # an exponent above ln 1.5 makes the exponential larger than 1.5
    return k.imag * count < 0.41 and abs(1.0 + cmath.exp(-1j * count * k)) < 0.5


def points_off_roots(above: complex, below: complex, count: int) -> int:
    """Return a number of points, at least ``count``, such that none is at a root of the pair."""
    for _ in range(4):
        if is_at_a_point(above, count) or is_at_a_point(-below, count):
            count += 4
    return count


def corrected_errors(
    truncation: Any, size: Any, slope_size: Any, shifts: Any, gains: Any
) -> tuple[Any, Any]:
    """Return bounds of the rounding error, and of the errors of the derivatives by ln v, ln c."""
    rounding = 8.0 * EPS * (size + 1.0 + shifts)
    return rounding, SLOPE_SHARE * truncation + 8.0 * EPS * (1.0 + slope_size + gains)


def corrected_axis(
    v: float, c: float, tolerance: float, slopes: bool
) -> tuple[complex, complex, complex, float, float, float, int]:
    """Return Σ by points on the real axis and the roots near it; see `rules.sum_at`."""
    rho, q = c / v, 0.5 / v
    nearest = root_near(two_roots_near(q, 0.0, rho)[0], q, 0.0, rho)
    depth, bound = strip_of_remainder(v, c)
    count = points_beside_roots(bound, tolerance, depth)
    above, below = nearest, nearest
    if rho > PAIR_FROM:
        first, second = resonant_pair(q, rho)
        above, below = root_near(first, q, 0.0, rho), root_near(second, q, 0.0, rho)
        count = points_off_roots(above[0], below[0], count)
    value, by_v, by_c, size, slope_size = axis_means(v, c, count, slopes)
    value -= 1.0
    shifts, gains = 0.0, 0.0
    for i in range(3 if rho > PAIR_FROM else 1):
        root = nearest if i == 0 else above if i == 1 else below
        side = side_of(root[0].imag)
        turn = -1j * side * count
        found = pole_correction(root, root[0], v, c, bounded_exp(turn * root[0]), turn, -1.0)
        value -= side * found[0]
        by_v -= side * found[1]
        by_c -= side * found[2]
        shifts += found[3]
        gains += found[4]
    truncation = truncation_beside_roots(bound, count, depth)
    rounding, slope_bound = corrected_errors(
        truncation, float(size), float(slope_size), shifts, gains
    )
    return value, by_v, by_c, truncation, rounding, slope_bound, count // 2
