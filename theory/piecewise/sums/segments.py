"""The two segments of the path for c > 3v; see ``theory.piecewise.sums.rules``."""

from __future__ import annotations

import cmath
import math
from typing import Any

from theory.piecewise.sums.arithmetic import (
    exponential,
    logarithm,
    modulus,
    over_root,
    quotient,
    remainder,
    size_of,
    square_root,
)
from theory.piecewise.sums.axis import EPS, SLOPE_SHARE, SLOWEST
from theory.piecewise.sums.poles import (
    TURN,
    bounded_exp,
    pole_correction,
    root_near,
    side_of,
    two_roots_near,
)

SEGMENT_TURN = cmath.exp(0.25j * math.pi)
"""Phase factor of dk/du where a segment begins."""
_BACK = cmath.exp(-0.75j * math.pi)  # -i/SEGMENT_TURN
_DEPTHS = 1.6, 1.0
"""Im u at which the integrand of the first and second segment, roots subtracted, is bounded."""
SEGMENT_SHARE = 0.4
"""Fraction of the tolerance that is allotted to each segment."""
CLEAR = 0.5
"""|e^z ∓ 1| above which a root is far enough from every node."""


def _segment_size(rho: float, twice_A_0: float, second: bool) -> float:
    """Bound (1/π) ∫|g̃| du along Im u = 1.6 or 1, where ``twice_A_0`` is |2A| at u = 0."""
    return (3.0 if not second else 4.0 if rho > 6.3 else 50.0) / (math.sqrt(rho) * twice_A_0)


def segment_nodes(
    tolerance: float, v: float, rho: float, twice_A_0: float, second: bool
) -> tuple[float, int, float]:
    """Return the step, the number of nodes, and the bound of the error, truncation at U included.

    Beyond u = U ≥ √3 the terms are below 2.7 (1 + 2Y) e^{-q - u²} √m/|A|.
    """
    size = _segment_size(rho, twice_A_0, second)
    exponent = logarithm(1.0 + max(1.5 * size / tolerance, 1.0))
    step = TURN * (_DEPTHS[1] if second else _DEPTHS[0]) / exponent
    m, q = 0.5 / rho, 0.5 / v
    U = math.sqrt(max(3.0, logarithm(1.0 + 4.0 / (math.sqrt(rho) * twice_A_0 * tolerance)) - q))
    count = math.ceil(U / step)
    U = count * step
    tail = 2.7 * math.sqrt(m) * (1.0 + 2.0 * m * U * U) * exponential(-q - U * U) / math.pi
    tail *= (step + 0.5 / U) / max(0.5 * twice_A_0, v * U * U)  # 1 - e^{-x} is at least x/(1 + x)
    return step, count, tolerance / 1.5 + tail  # size/(e^exponent - 1), and the part beyond U


def phase_rate(v: Any, c: Any, second: bool) -> Any:
    """Return the rate at which the phase of a segment and of its error turns with ln v or ln c."""
    return 1.0 + c / v if second else 1.0


def segment_term(E: complex, Y: float, A: complex) -> complex:
    """Return g = (S - 1)/(2A) dk/du up to a constant factor; k counts from its beginning."""
    F = 1.0 - E
    D = F * F + 4j * Y * E
    return over_root(E * (F - 2j * Y), D * A, Y)


def segment_slopes(
    E: complex, Y: float, A: complex, v: float, second: bool
) -> tuple[complex, complex, complex]:
    """Return g, -v² ∂g/∂v and ∂g/∂c at fixed nodes; see `segment_term`."""
    g = segment_term(E, Y, A)
    F = 1.0 - E
    D = F * F + 4j * Y * E
    S_a = over_root(E * (2j * Y * (1.0 + E * E) - F * F), D * D, Y)
    A_c = complex(2.0 * Y, 2.0 if second else 0.0)
    return g, S_a, quotient(S_a * (1.0 / v) - g, A) * A_c


def segment_width(v: float, c: float, step: float) -> float:
    """Return the constant factor of the terms, without ``SEGMENT_TURN``."""
    return 2.0 / math.pi * math.sqrt(0.5 * v / c) * step


def _on_a_segment(
    v: float, c: float, psi: float, second: bool, nodes: tuple[float, int, float], slopes: bool
) -> tuple[complex, complex, complex, float, float]:
    """Return (1/π)∫g du as a sum over the nodes of a segment, its derivatives, and sums of moduli.

    ``nodes`` contains the step, the number of nodes, and the position of the first one in steps,
    ½ or 0.
    """
    step, count, offset = nodes
    m = 0.5 * v / c
    phase = math.exp(-0.5 / v) * cmath.exp(-1j * psi)
    im_A = 2.0 * c if second else 0.0
    total, by_v, by_c, size, slope_size = 0j, 0j, 0j, 0.0, 0.0
    for j in range(count):
        u = (j + offset) * step
        square = u * u
        E, A = phase * math.exp(-square), complex(0.5 + v * square, im_A)
        weight = 0.5 if u == 0.0 else 1.0
        if slopes:
            g, g_v, g_c = segment_slopes(E, m * square, A, v, second)
            by_v += weight * g_v
            by_c += weight * g_c
            slope_size += weight * size_of(g_v)
        else:
            g = segment_term(E, m * square, A)
        total += weight * g
        size += weight * size_of(g)
    width = segment_width(v, c, step)
    factor = width * SEGMENT_TURN
    return (
        factor * total,
        -factor / (v * v) * by_v,
        factor * by_c,
        width * size,
        width * slope_size / v,
    )


def segment_unit(rho: float, step: float, side: float) -> complex:
    """Return the factor of sin(p/2) in z, for roots above (side 1) or below the path (-1)."""
    return _BACK * (TURN * side / (step * math.sqrt(0.5 / rho)))


def clearance_of(power: complex, sign: float) -> float:
    """Return a measure of the distance of a root from the nearest node, 0 if it is on the node."""
    return modulus(sign * power - 1.0)


def _roots_on_a_segment(
    v: float, c: float, psi: float, second: bool, step: float, offset: float
) -> tuple[complex, complex, complex, float, float, float]:
    """Return the pole correction of the roots near a segment, to be subtracted, and derivatives.

    The last three results are the two rounding errors, and the clearance of the roots from the
    nodes, which is small where digits are lost.
    """
    rho, q = c / v, 0.5 / v
    sign = 1.0 if offset == 0.0 else -1.0
    value, by_v, by_c, shifts, gains, clearance = 0j, 0j, 0j, 0.0, 0.0, 1.0
    for start in two_roots_near(q, psi, rho):
        root = root_near(start, q, psi, rho)
        wave = root[0] + (2.0 * rho - psi) if second else root[0]
        side = side_of(root[0].imag)
        unit = segment_unit(rho, step, side)
        power = bounded_exp(unit * root[1])
        found = pole_correction(root, wave, v, c, power, 0.5 * unit * root[2], sign)
        clearance = min(clearance, clearance_of(power, sign))
        value += side * found[0]
        by_v += side * found[1]
        by_c += side * found[2]
        shifts += found[3]
        gains += found[4]
    return value, by_v, by_c, shifts, gains, clearance


def _segment(
    v: float, c: float, psi: float, second: bool, tolerance: float, slopes: bool
) -> tuple[complex, complex, complex, float, float, float, float, int]:
    """Return the segment's part of Σ, slopes, error bounds, step and number of nodes.

    ψ = 0 for the first segment.
    """
    A_0 = complex(0.5, 2.0 * c if second else 0.0)
    if slopes:
        tolerance /= phase_rate(v, c, second)
    step, count, truncation = segment_nodes(tolerance, v, c / v, 2.0 * abs(A_0), second)
    offset = 0.5
    corrections = (0j, 0j, 0j, 0.0, 0.0, 1.0)
    if v >= SLOWEST:
        corrections = _roots_on_a_segment(v, c, psi, second, step, offset)
        if second and corrections[5] < CLEAR:
            other = _roots_on_a_segment(v, c, psi, second, step, 0.0)
            if other[5] > corrections[5]:
                offset, corrections = 0.0, other
    value, by_v, by_c, size, slope_size = _on_a_segment(
        v, c, psi, second, (step, count, offset), slopes
    )
    bounds = segment_errors(
        v, c, second, truncation, size, slope_size, corrections[3], corrections[4]
    )
    return (
        value - corrections[0], by_v - corrections[1], by_c - corrections[2],
        truncation, bounds[0], bounds[1], step, count,
    )  # fmt: skip


def segment_errors(
    v: Any,
    c: Any,
    second: bool,
    truncation: Any,
    size: Any,
    slope_size: Any,
    shifts: Any,
    gains: Any,
) -> tuple[Any, Any]:
    """Return bounds of the rounding error of one segment, and of the errors of its derivatives."""
    phase_factor = 1.0 + 2.0 * c / v if second else 1.0
    slope_bound = SLOPE_SHARE * phase_rate(v, c, second) * truncation
    return 8.0 * EPS * (size * phase_factor + shifts), slope_bound + 8.0 * EPS * (
        slope_size * phase_factor + gains
    )


def static_part(v: float, c: float, step: float) -> tuple[complex, complex]:
    """Return 1/√(1 - 4ic) on the nodes of the first segment, and its derivative by c."""
    static = quotient(1.0 + 0j, square_root(1.0 - 4j * c))
    pole = math.pi / (step * math.sqrt(2.0 * v))  # from the pole of -1/2A at u = i/√(2v)
    decay = exponential(-2.0 * pole)
    tanh_pole = (1.0 - decay) / (1.0 + decay)
    # at fixed nodes this scales like c^{-1/2} and does not depend on v
    by_c = static * (
        2j * static * static * tanh_pole - 0.5 * pole / c * (1.0 - tanh_pole * tanh_pole)
    )
    return tanh_pole * static, by_c


def second_phase(v: float, c: float) -> float:
    """Return the phase ψ of e^{-a} on the second segment, from -π to π."""
    return remainder(2.0 * c / v, TURN) - math.pi


def arch(
    v: float, c: float, tolerance: float, slopes: bool
) -> tuple[complex, complex, complex, float, float, float, int]:
    """Return Σ by the two segments; see ``theory.piecewise.sums.rules.sum_at``."""
    first = _segment(v, c, 0.0, False, SEGMENT_SHARE * tolerance, slopes)
    second = _segment(v, c, second_phase(v, c), True, SEGMENT_SHARE * tolerance, slopes)
    static, by_c = static_part(v, c, first[6])
    return (
        static - 1.0 + first[0] + second[0].conjugate(),
        first[1] + second[1].conjugate(),
        by_c + first[2] + second[2].conjugate(),
        first[3] + second[3],
        8.0 * EPS + first[4] + second[4],
        8.0 * EPS + first[5] + second[5],
        first[7] + second[7],
    )
