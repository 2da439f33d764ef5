"""Number of roots of (50) in a box, by the argument principle and without use of labels."""

from __future__ import annotations

import itertools
import math

import numpy as np

from theory.arrays import EPS, ComplexArray, FloatArray, IntArray
from theory.parameters import ParameterError
from theory.piecewise.dispersion import dispersion, dispersion_slope
from theory.piecewise.roots import checked_velocity_and_coupling, strip_bounds

_MAX_BISECTIONS = 200
_MAX_PIECES = 4_000_000


def height_above_roots(v: float, c: float, extent: float) -> float:
    """Return Y such that every root with |Re k| ≤ ``extent`` has |Im k| < Y.

    From there on |c (1 - cos k)| ≥ c (sinh|y| - 1) exceeds |½ - i v k| ≤ ½ + v (extent + |y|).
    """
    height = max(1.0, math.asinh(2.0 * v / c))  # there c cosh y > v, and the difference grows
    while c * (math.sinh(height) - 1.0) <= 0.5 + v * (extent + height):
        height += 0.5
    return height


def count_in_box(
    v: float, c: float, *, x_low: float, x_high: float, y_low: float, y_high: float
) -> int:
    """Return the number of roots in the open box, by the winding number of L along its edge.

    Each edge is divided until, on every piece, |Re L| or |Im L| at the middle exceeds the largest
    possible change of L over half the piece, rounding included. This change is at most
    h (|L_k| + h c cosh(Im k)), h being half the length, since |L_kk| ≤ c cosh(Im k). L then stays
    in a half-plane on the piece, and the change of its argument is determined exactly; no sampling
    density is assumed.

    Parameters
    ----------
    v, c : float
        Front velocity v̂ and coupling, dimensionless.
    x_low, x_high, y_low, y_high : float
        The box in the plane of k.

    Raises
    ------
    ParameterError
        If a root lies so near the edge that double precision cannot decide on which side it is, or
        if the box is empty or so tall that cosh(Im k) overflows.

    Examples
    --------
    >>> count_in_box(0.3, 0.5, x_low=-np.pi, x_high=np.pi, y_low=-10.0, y_high=10.0)
    2
    """
    v, c = checked_velocity_and_coupling(v, c)
    if not (x_low < x_high and y_low < y_high and max(abs(y_low), abs(y_high)) < 600):
        raise ParameterError(
            "box of k",
            (x_low, x_high, y_low, y_high),
            "of positive size with |Im k| < 600",
            "order its ends",
        )
    corners = box_corners(x_low, x_high, y_low, y_high)
    argument_change = sum(_argument_change(v, c, a, b) for a, b in itertools.pairwise(corners))
    return round(argument_change / (2.0 * math.pi))


def box_corners(x_low: float, x_high: float, y_low: float, y_high: float) -> list[complex]:
    """Return the corners of a box, anticlockwise, with the first one repeated at the end."""
    return [
        complex(x_low, y_low),
        complex(x_high, y_low),
        complex(x_high, y_high),
        complex(x_low, y_high),
        complex(x_low, y_low),
    ]


def box_of_strips(
    v: float, c: float, labels: IntArray, upper: bool
) -> tuple[float, float, float, float]:
    """Return a box that contains every root of the consecutive strips ``labels``, and no other."""
    low, high = strip_bounds(labels, upper)
    x_low, x_high = float(low.min()), float(high.max())
    height = height_above_roots(v, c, max(abs(x_low), abs(x_high)))
    return (x_low, x_high, 0.0, height) if upper else (x_low, x_high, -height, 0.0)


def count_in_strips(v: float, c: float, labels: IntArray, upper: bool) -> int:
    """Return the number of roots in the consecutive strips ``labels`` of one half-plane."""
    x_low, x_high, y_low, y_high = box_of_strips(v, c, labels, upper)
    return count_in_box(v, c, x_low=x_low, x_high=x_high, y_low=y_low, y_high=y_high)


def edge_pieces(
    v: float, c: float, start: complex, end: complex
) -> tuple[ComplexArray, ComplexArray]:
    """Return the ends of pieces of the edge on each of which L stays in a half-plane.

    Raises
    ------
    ParameterError
        If a root lies on the edge to within rounding.
    """
    pieces = max(4, math.ceil(abs(end - start)))
    ends: ComplexArray = np.asarray(start + (end - start) * np.arange(pieces + 1) / pieces)
    a, b = ends[:-1], ends[1:]
    resolved_a, resolved_b = [], []
    for _ in range(_MAX_BISECTIONS):
        middle = 0.5 * (a + b)
        margin = _distance_from_axes(middle, v, c)
        half = 0.5 * np.abs(b - a)
        curvature = c * np.cosh(np.maximum(np.abs(a.imag), np.abs(b.imag)))
        resolved = margin > half * (np.abs(dispersion_slope(middle, v, c)) + half * curvature)
        resolved_a.append(a[resolved])
        resolved_b.append(b[resolved])
        a, middle, b = a[~resolved], middle[~resolved], b[~resolved]
        if a.size == 0:
            return np.concatenate(resolved_a), np.concatenate(resolved_b)
        if np.any(margin[~resolved] <= 0.0) or a.size > _MAX_PIECES:
            break
        a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
    raise ParameterError(
        "box of k",
        f"an edge through {complex(a[0]):.6g}",
        "away from every root by more than rounding",
        "move the edge",
    )


def _argument_change(v: float, c: float, start: complex, end: complex) -> float:
    """Return the change of arg L along the straight edge from ``start`` to ``end``."""
    a, b = edge_pieces(v, c, start, end)
    return float(np.sum(np.angle(dispersion(b, v, c) / dispersion(a, v, c))))


def _distance_from_axes(k: ComplexArray, v: float, c: float) -> FloatArray:
    """Return max(|Re L|, |Im L|) minus rounding, within which distance L stays in a half-plane.

    The two parts are treated separately, since Re L can be accurate where v|k| or c dominates the
    rounding error of Im L; on the real axis Re L is exactly ½.
    """
    L = dispersion(k, v, c)
    sine_squared = np.abs(np.sin(0.5 * k) ** 2)
    real = 0.5 + c * np.abs(np.sin(k.real) * np.sinh(k.imag)) + v * np.abs(k.imag)
    imaginary = 2.0 * c * sine_squared + v * np.abs(k.real)
    rounding = 16.0 * EPS
    margin: FloatArray = np.maximum(
        np.abs(L.real) - rounding * real, np.abs(L.imag) - rounding * imaginary
    )
    return margin
