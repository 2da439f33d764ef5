"""Σ(v, c) by two trapezoidal rules whose cost depends on neither v nor c; one value at a time.

With X = sin²(k/2), A = ½ - 2icX and a = A/v, Σ = -1 + (1/2π)∫G dk over a period, where G = S/2A and
S = sinh a/(cosh a - cos k) (see ``theory.piecewise.sums.integral``). The effect of a root of (50)
near a path on the trapezoidal rule is known exactly: a pole u_p above a path with nodes (j + δ)h
changes the rule by 2πi Res/(e^{2πi(δ - u_p/h)} - 1). This is subtracted, and the number of points
is then determined by the remaining, more distant poles. With ρ = c/v:

* ρ ≤ 3: N points midway between multiples of 2π/N on the real axis. The root nearest k = -i/2v is
  subtracted and, for ρ > 1, also the pair of roots that meets where the front is in resonance with
  a linear wave. The remainder G̃ obeys |G̃| ≤ M/(1 + c) on the lines |Im k| = σ(ρ), with M = 1 if
  the pair is subtracted and M = 2.5 if not.
* ρ > 3: the path is deformed into the region where Re A grows. With X = iY, Y = u²v/2c ≥ 0,
  A = ½ + vu² is real, and S - 1 falls like e^{-u²}; k runs from 0 to π/2 + i∞. From there it
  returns to π along X = 1 - iȲ, where S is the same function except for a phase ψ = 2c/v - π of
  e^{-a}. The 1 that was subtracted from S contributes 1/√(1 - 4ic). Two roots lie nearest each of
  the two segments; after they are subtracted, the integral of the remainder along |Im u| = 1.6
  (first segment) or 1 (second segment) is below `_segment_size`.

The bounds on the remainders were found by sampling them over the whole range, which a test repeats;
given these bounds, the error bounds follow from the theorem on the trapezoidal rule in a strip.
Below v = 0.08 no root is near a path. For the plain rule on the real axis the bound is proved
(`plain_points`).

Everything here is plain Python for single numbers. Loops over many values, which are compiled
(``theory.piecewise.sums.compiled``), are in ``axis`` and in ``blocks``, and ``beside_roots``
combines those in ``blocks``.

References
----------
Trefethen, L. N. & Weideman, J. A. C. (2014), The exponentially convergent trapezoidal rule.
McNamee, J. (1964), Error-bounds for the evaluation of integrals by the Euler-Maclaurin formula and
by Gauss-type formulae.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from theory.piecewise.sums.axis import (
    STEEPEST,
    axis_means,
    is_plain,
    plain_errors,
    plain_points,
    slope_truncation,
)
from theory.piecewise.sums.corrected_axis import corrected_axis
from theory.piecewise.sums.segments import arch

if TYPE_CHECKING:
    from theory.arrays import ComplexArray, FloatArray, IntArray


def sum_at(
    v: float, c: float, tolerance: float, slopes: bool
) -> tuple[complex, complex, complex, float, float, float, int]:
    """Return Σ, ∂Σ/∂v, ∂Σ/∂c, three bounds, and the number of points.

    The bounds are those of the truncation of Σ, of its rounding, and of the errors of v ∂Σ/∂v and
    c ∂Σ/∂c.

    Parameters
    ----------
    v, c : float
        Front velocity v̂ and coupling, positive, dimensionless.
    tolerance : float
        Required truncation error of Σ.
    slopes : bool
        Whether the derivatives are required.
    """
    count, truncation = plain_points(v, c, tolerance)
    if is_plain(v, c, count):
        return _plain(v, c, int(count), truncation, slopes)
    if c > STEEPEST * v:
        return arch(v, c, tolerance, slopes)
    return corrected_axis(v, c, tolerance, slopes)


def fill(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, values: ComplexArray,
    errors: FloatArray, points: IntArray,
) -> None:  # fmt: skip
    """Write Σ, ∂Σ/∂v, ∂Σ/∂c into ``values``, their error bounds into ``errors``, shapes (3, n)."""
    for i in range(v.size):
        found = sum_at(float(v[i]), float(c[i]), tolerance, slopes)
        values[0, i], values[1, i], values[2, i] = found[0], found[1], found[2]
        errors[0, i] = found[3] + found[4]
        errors[1, i], errors[2, i] = found[5] / v[i], found[5] / c[i]
        points[i] = found[6]


def _plain(
    v: float, c: float, count: int, truncation: float, slopes: bool
) -> tuple[complex, complex, complex, float, float, float, int]:
    """Return Σ by the plain rule: points on the real axis, no root subtracted; see `sum_at`."""
    value, by_v, by_c, size, slope_size = axis_means(v, c, count, slopes)
    rounding, slope_bound = plain_errors(v, c, size, slope_size)
    if slopes:
        slope_bound += slope_truncation(v, c, count)
    return complex(value - 1.0), by_v, by_c, truncation, float(rounding), slope_bound, count // 2
