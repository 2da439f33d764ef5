"""Many values of Σ by the rules that subtract roots, written for compilation.

The values are divided into blocks whose tables fit the processor's cache. The loop over the values
of a block is the innermost one; it is free of branches and calls, and thus vectorised.
``theory.piecewise.sums.beside_roots`` calls `arches` and `corrections_on_axis`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from theory.piecewise.sums.arithmetic import (
    cosine_and_sine,
    exponential,
    modulus,
    sine_and_cosine_near,
    size_of,
)
from theory.piecewise.sums.axis import BLOCK, EPS, SLOWEST
from theory.piecewise.sums.corrected_axis import (
    PAIR_FROM,
    points_beside_roots,
    points_off_roots,
    strip_of_remainder,
    truncation_beside_roots,
)
from theory.piecewise.sums.poles import (
    has_converged,
    pair_of_the_parabola,
    pole_correction,
    resonant_pair,
    side_of,
    step_to_root,
    two_roots_near,
)
from theory.piecewise.sums.segments import (
    CLEAR,
    SEGMENT_SHARE,
    SEGMENT_TURN,
    clearance_of,
    phase_rate,
    second_phase,
    segment_errors,
    segment_nodes,
    segment_slopes,
    segment_term,
    segment_unit,
    segment_width,
    static_part,
)

if TYPE_CHECKING:
    from theory.arrays import FloatArray

_LARGEST_GROWTH = 100.0
"""Largest exponent z used in e^z; beyond it the pole correction is zero."""


def arches(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, steps: int, found: FloatArray
) -> None:
    """Write the results of `segments.arch` as rows.

    They are Re and Im of Σ, ∂Σ/∂v and ∂Σ/∂c; the error bounds of Σ and of v ∂Σ/∂v and c ∂Σ/∂c; the
    number of nodes; and 1 where a root did not converge in the given number of ``steps``.
    """
    n = min(BLOCK, v.size)
    plan, parts, rows = np.empty((4, n)), np.empty((4, n)), np.empty((10, n))
    nodes, sums, poles = np.empty((6, n)), np.empty((8, n)), np.empty((8, n))
    roots, equation = np.empty((2, 11, n)), np.empty((7, n))
    for start in range(0, v.size, n):
        first = min(start, v.size - n)  # the last two blocks may overlap
        some_v, some_c = v[first : first + n], c[first : first + n]
        fill(rows, 0.0)
        for segment in range(2):
            second = segment == 1
            plan_segments(some_v, some_c, tolerance, slopes, second, plan)
            if not second:
                static_parts(some_v, some_c, plan[0], parts)
            offset = corrections_on_segment(
                some_v, some_c, plan, second, slopes, steps, roots, equation, poles, rows[9]
            )
            add_all_nodes(some_v, some_c, plan, offset, second, slopes, nodes, sums)
            add_segment(some_v, some_c, plan, sums, poles, second, rows)
            if slopes:
                add_segment_slopes(some_v, some_c, plan, sums, poles, second, rows)
        for i in range(n):
            rows[0, i] += parts[0, i] - 1.0
            rows[1, i] += parts[1, i]
            rows[4, i] += parts[2, i]
            rows[5, i] += parts[3, i]
            rows[6, i] += 8.0 * EPS
            rows[7, i] += 8.0 * EPS
        write(rows, found, first)


def corrections_on_segment(
    v: FloatArray, c: FloatArray, plan: FloatArray, second: bool, slopes: bool, steps: int,
    roots: FloatArray, equation: FloatArray, poles: FloatArray, unconverged: FloatArray,
) -> FloatArray:  # fmt: skip
    """Write the pole corrections of one segment; return the position of its first node in steps."""
    step, psi = plan[0], plan[3]
    q, rho, subtracted, active = equation[0], equation[1], equation[2], equation[3]
    origin, sign = equation[4], equation[5]
    offset: FloatArray = equation[6]
    for i in range(v.size):
        q[i], rho[i] = 0.5 / v[i], c[i] / v[i]
        subtracted[i] = 1.0 if v[i] >= SLOWEST else 0.0
        origin[i] = 2.0 * rho[i] - psi[i] if second else 0.0
    start_roots(q, psi, rho, roots)
    fill(poles, 1.0)  # its first two rows hold the clearances of a root that is far away
    for root in range(2):
        table, power, turn = roots[root, :6], roots[root, 6:9], roots[root, 9:]
        converge(table, q, psi, rho, subtracted, steps, active, unconverged)
        exponents_on_segments(rho, step, table, power, turn)
        exponentials(power)
        if second:
            clearances(power, poles[0], poles[1])
    for i in range(v.size):
        at_0 = poles[0, i] < CLEAR and poles[1, i] > poles[0, i]
        offset[i], sign[i] = (0.0, 1.0) if at_0 else (0.5, -1.0)
    fill(poles, 0.0)
    for root in range(2):
        table, power, turn = roots[root, :6], roots[root, 6:9], roots[root, 9:]
        add_pole_corrections(v, c, table, origin, power, turn, sign, subtracted, poles)
        if slopes:
            add_pole_correction_slopes(v, c, table, origin, power, turn, sign, subtracted, poles)
    return offset


def corrections_on_axis(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, steps: int, found: FloatArray
) -> None:
    """Write the pole corrections of `corrected_axis` as rows.

    They are the eight of `add_pole_corrections`; the number of points; the truncation error; and 1
    where a root did not converge in the given number of ``steps``.
    """
    n = min(BLOCK, v.size)
    rows, roots, equation = np.empty((11, n)), np.empty((3, 11, n)), np.empty((7, n))
    q, rho, always, paired = equation[0], equation[1], equation[2], equation[3]
    active, zero, sign = equation[4], equation[5], equation[6]
    for start in range(0, v.size, n):
        first = min(start, v.size - n)  # the last two blocks may overlap
        some_v, some_c = v[first : first + n], c[first : first + n]
        fill(rows, 0.0)
        for i in range(n):
            q[i], rho[i] = 0.5 / some_v[i], some_c[i] / some_v[i]
            always[i], zero[i], sign[i] = 1.0, 0.0, -1.0
            paired[i] = 1.0 if rho[i] > PAIR_FROM else 0.0
        start_roots(q, zero, rho, roots)
        for i in range(n):  # used where no pair is subtracted
            roots[1, 0, i] = roots[2, 0, i] = roots[0, 0, i]
            roots[1, 1, i] = roots[2, 1, i] = roots[0, 1, i]
        start_resonant_pairs(q, rho, roots)
        number = 3 if paired.max() > 0.0 else 1
        for root in range(number):
            taken = always if root == 0 else paired
            converge(roots[root, :6], q, zero, rho, taken, steps, active, rows[10])
        plan_axis(some_v, some_c, tolerance, roots, rows[8:10])
        for root in range(number):
            taken = always if root == 0 else paired
            table, power, turn = roots[root, :6], roots[root, 6:9], roots[root, 9:]
            exponents_on_axis(rows[8], table, power, turn)
            exponentials(power)
            add_pole_corrections(some_v, some_c, table, zero, power, turn, sign, taken, rows)
            if slopes:
                add_pole_correction_slopes(
                    some_v, some_c, table, zero, power, turn, sign, taken, rows
                )
        write(rows, found, first)


def fill(table: FloatArray, value: float) -> None:
    """Write one value everywhere, by loops: compiling assignments to slices takes seconds."""
    for row in range(table.shape[0]):
        for i in range(table.shape[1]):
            table[row, i] = value


def write(rows: FloatArray, found: FloatArray, first: int) -> None:
    """Write the rows of a block into those of all values."""
    for row in range(rows.shape[0]):
        for i in range(rows.shape[1]):
            found[row, first + i] = rows[row, i]


def plan_segments(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, second: bool, plan: FloatArray
) -> None:
    """Write step, number of nodes, truncation error and phase of one segment as rows."""
    for i in range(v.size):
        required = SEGMENT_SHARE * tolerance / (phase_rate(v[i], c[i], second) if slopes else 1.0)
        twice_A_0 = 2.0 * modulus(complex(0.5, 2.0 * c[i])) if second else 1.0
        step, count, truncation = segment_nodes(required, v[i], c[i] / v[i], twice_A_0, second)
        plan[0, i], plan[1, i], plan[2, i] = step, count, truncation
        plan[3, i] = second_phase(v[i], c[i]) if second else 0.0


def start_roots(q: FloatArray, psi: FloatArray, rho: FloatArray, pair: FloatArray) -> None:
    """Write the starting points of two roots into the first two rows of each table."""
    n = q.size
    nearly_double = pair[0, 2]
    for i in range(n):
        one, other, close = pair_of_the_parabola(q[i], psi[i], rho[i])
        pair[0, 0, i], pair[0, 1, i] = one.real, one.imag
        pair[1, 0, i], pair[1, 1, i] = other.real, other.imag
        nearly_double[i] = 1.0 if close else 0.0
    for i in range(n):
        if nearly_double[i] > 0.0:
            one, other = two_roots_near(q[i], psi[i], rho[i])
            pair[0, 0, i], pair[0, 1, i] = one.real, one.imag
            pair[1, 0, i], pair[1, 1, i] = other.real, other.imag


def halves(table: FloatArray) -> None:
    """Write sin(p/2) and cos(p/2) into the rows below p."""
    p_re, p_im, sine_re, sine_im, cosine_re, cosine_im = (
        table[0], table[1], table[2], table[3], table[4], table[5],
    )  # fmt: skip
    for i in range(table.shape[1]):
        sine, cosine = sine_and_cosine_near(complex(0.5 * p_re[i], 0.5 * p_im[i]))
        sine_re[i], sine_im[i] = sine.real, sine.imag
        cosine_re[i], cosine_im[i] = cosine.real, cosine.imag


def step_all(
    table: FloatArray, q: FloatArray, psi: FloatArray, rho: FloatArray, active: FloatArray
) -> None:
    """Take one step towards each root that is still moving; mark converged roots as not moving."""
    p_re, p_im, sine_re, sine_im, cosine_re, cosine_im = (
        table[0], table[1], table[2], table[3], table[4], table[5],
    )  # fmt: skip
    for i in range(q.size):
        p = complex(p_re[i], p_im[i])
        sine, cosine = complex(sine_re[i], sine_im[i]), complex(cosine_re[i], cosine_im[i])
        step, abs_slope = step_to_root(p, sine, cosine, q[i], psi[i], rho[i])
        p += active[i] * step
        p_re[i], p_im[i] = p.real, p.imag
        active[i] = 0.0 if has_converged(p, step, abs_slope, rho[i]) else active[i]


def converge(
    table: FloatArray, q: FloatArray, psi: FloatArray, rho: FloatArray, required: FloatArray,
    steps: int, active: FloatArray, unconverged: FloatArray,
) -> None:  # fmt: skip
    """Iterate to the required roots; write p, sin(p/2), cos(p/2), and which did not converge."""
    for i in range(q.size):
        active[i] = required[i]
    halves(table)
    for _ in range(steps):
        step_all(table, q, psi, rho, active)
        halves(table)
        if active.max() == 0.0:
            return
    for i in range(q.size):
        unconverged[i] = max(unconverged[i], active[i])


def exponents_on_segments(
    rho: FloatArray, step: FloatArray, table: FloatArray, power: FloatArray, turn: FloatArray
) -> None:
    """Write Re and Im of z and of its derivative by p as rows; see `segments`."""
    for i in range(rho.size):
        unit = segment_unit(rho[i], step[i], side_of(table[1, i]))
        exponent = unit * complex(table[2, i], table[3, i])
        power[0, i], power[1, i] = exponent.real, exponent.imag
        dz_dp = 0.5 * unit * complex(table[4, i], table[5, i])
        turn[0, i], turn[1, i] = dz_dp.real, dz_dp.imag


def exponents_on_axis(
    count: FloatArray, table: FloatArray, power: FloatArray, turn: FloatArray
) -> None:
    """Write Re and Im of z and of its derivative by p as rows; see `corrected_axis`."""
    for i in range(count.size):
        turn[0, i], turn[1, i] = 0.0, -side_of(table[1, i]) * count[i]
        power[0, i], power[1, i] = -turn[1, i] * table[1, i], turn[1, i] * table[0, i]


def exponentials(z: FloatArray) -> None:
    """Replace Re and Im of z by those of e^z."""
    re, im, size = z[0], z[1], z[2]
    for i in range(re.size):
        size[i] = exponential(min(re[i], _LARGEST_GROWTH))
    for i in range(re.size):
        x, y = cosine_and_sine(im[i])
        re[i], im[i] = size[i] * x, size[i] * y


def clearances(power: FloatArray, halfway: FloatArray, whole: FloatArray) -> None:
    """Lower the clearances to that of a root, for nodes that begin half a step from 0, and at 0."""
    for i in range(halfway.size):
        exponential_z = complex(power[0, i], power[1, i])
        halfway[i] = min(halfway[i], clearance_of(exponential_z, -1.0))
        whole[i] = min(whole[i], clearance_of(exponential_z, 1.0))


def add_pole_corrections(
    v: FloatArray, c: FloatArray, table: FloatArray, origin: FloatArray, power: FloatArray,
    turn: FloatArray, sign: FloatArray, required: FloatArray, poles: FloatArray,
) -> None:  # fmt: skip
    """Add Re and Im of the effect of one root per value, where required, and its rounding error."""
    re, im, shifts = poles[0], poles[1], poles[6]
    p_re, p_im, s_re, s_im, c_re, c_im = table[0], table[1], table[2], table[3], table[4], table[5]
    power_re, power_im, turn_re, turn_im = power[0], power[1], turn[0], turn[1]
    for i in range(v.size):
        root = complex(p_re[i], p_im[i]), complex(s_re[i], s_im[i]), complex(c_re[i], c_im[i])
        value, _, _, shift, _ = pole_correction(
            root, complex(p_re[i] + origin[i], p_im[i]), v[i], c[i],
            complex(power_re[i], power_im[i]), complex(turn_re[i], turn_im[i]), sign[i],
        )  # fmt: skip
        side = required[i] * side_of(p_im[i])
        re[i] += side * value.real
        im[i] += side * value.imag
        shifts[i] += required[i] * shift


def add_pole_correction_slopes(
    v: FloatArray, c: FloatArray, table: FloatArray, origin: FloatArray, power: FloatArray,
    turn: FloatArray, sign: FloatArray, required: FloatArray, poles: FloatArray,
) -> None:  # fmt: skip
    """Add the derivatives of the effect of one root per value, where required, and their errors."""
    v_re, v_im, by_re, by_im, gains = poles[2], poles[3], poles[4], poles[5], poles[7]
    p_re, p_im, s_re, s_im, c_re, c_im = table[0], table[1], table[2], table[3], table[4], table[5]
    power_re, power_im, turn_re, turn_im = power[0], power[1], turn[0], turn[1]
    for i in range(v.size):
        root = complex(p_re[i], p_im[i]), complex(s_re[i], s_im[i]), complex(c_re[i], c_im[i])
        _, by_v, by_c, _, gain = pole_correction(
            root, complex(p_re[i] + origin[i], p_im[i]), v[i], c[i],
            complex(power_re[i], power_im[i]), complex(turn_re[i], turn_im[i]), sign[i],
        )  # fmt: skip
        side = required[i] * side_of(p_im[i])
        v_re[i] += side * by_v.real
        v_im[i] += side * by_v.imag
        by_re[i] += side * by_c.real
        by_im[i] += side * by_c.imag
        gains[i] += required[i] * gain


def start_nodes(
    v: FloatArray, c: FloatArray, psi: FloatArray, step: FloatArray, offset: FloatArray,
    table: FloatArray,
) -> None:  # fmt: skip
    """Write Re, Im of e^{-a} at u = 0, e^{-u²} at the first node, its factors, and v/2c, as rows.

    The first node lies half a step from u = 0, or at u = 0. From each node to the next, e^{-u²} is
    multiplied by the fourth row, and the fourth row by the fifth. The rounding errors of these
    products accumulate where e^{-u²} is small.
    """
    for i in range(v.size):
        decay, gauss = exponential(-0.5 / v[i]), exponential(-0.25 * step[i] * step[i])
        x, y = cosine_and_sine(psi[i])
        table[0, i], table[1, i] = decay * x, -decay * y
        fourth = gauss * gauss * gauss * gauss
        table[2, i] = gauss if offset[i] > 0.0 else 1.0
        table[3, i] = fourth * fourth if offset[i] > 0.0 else fourth
        table[4, i] = fourth * fourth
        table[5, i] = 0.5 * v[i] / c[i]


def next_nodes(table: FloatArray) -> None:
    """Advance to the next node; see `start_nodes`."""
    gauss, factor, second = table[2], table[3], table[4]
    for i in range(gauss.size):
        gauss[i] *= factor[i]
        factor[i] *= second[i]


def _node(
    j: int, v: float, im_A: float, m: float, step: float, offset: float, count: float
) -> tuple[float, complex, float]:
    """Return Y, A and the weight of the term at a node."""
    u = (j + offset) * step
    square = u * u
    weight = (0.5 if u == 0.0 else 1.0) * (1.0 if j < count else 0.0)
    return m * square, complex(0.5 + v * square, im_A), weight


def add_nodes(
    j: int, v: FloatArray, c: FloatArray, step: FloatArray, offset: FloatArray, count: FloatArray,
    table: FloatArray, second: bool, sums: FloatArray,
) -> None:  # fmt: skip
    """Add Re and Im of g, and |g|, at node j."""
    phase_re, phase_im, gauss, m = table[0], table[1], table[2], table[5]
    re, im, size = sums[0], sums[1], sums[2]
    for i in range(v.size):
        im_A = 2.0 * c[i] if second else 0.0
        Y, A, weight = _node(j, v[i], im_A, m[i], step[i], offset[i], count[i])
        g = segment_term(complex(phase_re[i] * gauss[i], phase_im[i] * gauss[i]), Y, A)
        re[i] += weight * g.real
        im[i] += weight * g.imag
        size[i] += weight * size_of(g)


def add_node_slopes(
    j: int, v: FloatArray, c: FloatArray, step: FloatArray, offset: FloatArray, count: FloatArray,
    table: FloatArray, second: bool, sums: FloatArray,
) -> None:  # fmt: skip
    """Add Re and Im of the derivatives of g, and the modulus of that by v, at node j."""
    phase_re, phase_im, gauss, m = table[0], table[1], table[2], table[5]
    for i in range(v.size):
        im_A = 2.0 * c[i] if second else 0.0
        Y, A, weight = _node(j, v[i], im_A, m[i], step[i], offset[i], count[i])
        E = complex(phase_re[i] * gauss[i], phase_im[i] * gauss[i])
        _, g_v, g_c = segment_slopes(E, Y, A, v[i], second)
        sums[3, i] += weight * g_v.real
        sums[4, i] += weight * g_v.imag
        sums[5, i] += weight * size_of(g_v)
        sums[6, i] += weight * g_c.real
        sums[7, i] += weight * g_c.imag


def add_all_nodes(
    v: FloatArray, c: FloatArray, plan: FloatArray, offset: FloatArray, second: bool, slopes: bool,
    table: FloatArray, sums: FloatArray,
) -> None:  # fmt: skip
    """Write the sums of g, and with ``slopes`` of its derivatives, over the nodes of a segment.

    ``plan`` is that of `plan_segments`, ``table`` that of `start_nodes`.
    """
    step, count, psi = plan[0], plan[1], plan[3]
    fill(sums, 0.0)
    start_nodes(v, c, psi, step, offset, table)
    for j in range(int(count.max())):
        add_nodes(j, v, c, step, offset, count, table, second, sums)
        if slopes:
            add_node_slopes(j, v, c, step, offset, count, table, second, sums)
        next_nodes(table)


def add_segment(
    v: FloatArray, c: FloatArray, plan: FloatArray, sums: FloatArray, corrections: FloatArray,
    second: bool, rows: FloatArray,
) -> None:  # fmt: skip
    """Add Re and Im of the contribution of one segment to Σ, its error bounds and its nodes.

    ``sums`` holds the sums over the nodes, and ``corrections`` the pole corrections, which are
    subtracted. For the second segment the complex conjugate is added.
    """
    step, truncation = plan[0], plan[2]
    conjugation = -1.0 if second else 1.0
    for i in range(v.size):
        width = segment_width(v[i], c[i], step[i])
        term = width * SEGMENT_TURN * complex(sums[0, i], sums[1, i])
        rows[0, i] += term.real - corrections[0, i]
        rows[1, i] += conjugation * (term.imag - corrections[1, i])
        size, slope_size = width * sums[2, i], width * sums[5, i] / v[i]
        rounding, slope_bound = segment_errors(
            v[i],
            c[i],
            second,
            truncation[i],
            size,
            slope_size,
            corrections[6, i],
            corrections[7, i],
        )
        rows[6, i] += truncation[i] + rounding
        rows[7, i] += slope_bound
        rows[8, i] += plan[1, i]


def add_segment_slopes(
    v: FloatArray, c: FloatArray, plan: FloatArray, sums: FloatArray, corrections: FloatArray,
    second: bool, rows: FloatArray,
) -> None:  # fmt: skip
    """Add Re and Im of the contribution of one segment to the derivatives of Σ; `add_segment`."""
    step = plan[0]
    conjugation = -1.0 if second else 1.0
    for i in range(v.size):
        width = segment_width(v[i], c[i], step[i])
        by_v = -width / (v[i] * v[i]) * SEGMENT_TURN * complex(sums[3, i], sums[4, i])
        by_c = width * SEGMENT_TURN * complex(sums[6, i], sums[7, i])
        rows[2, i] += by_v.real - corrections[2, i]
        rows[3, i] += conjugation * (by_v.imag - corrections[3, i])
        rows[4, i] += by_c.real - corrections[4, i]
        rows[5, i] += conjugation * (by_c.imag - corrections[5, i])


def static_parts(v: FloatArray, c: FloatArray, step: FloatArray, parts: FloatArray) -> None:
    """Write Re and Im of the results of `segments.static_part` as rows."""
    for i in range(v.size):
        static, by_c = static_part(v[i], c[i], step[i])
        parts[0, i], parts[1, i], parts[2, i], parts[3, i] = (
            static.real, static.imag, by_c.real, by_c.imag,
        )  # fmt: skip


def start_resonant_pairs(q: FloatArray, rho: FloatArray, roots: FloatArray) -> None:
    """Write the starting points of the resonant pair, where it is subtracted."""
    for i in range(q.size):
        if rho[i] > PAIR_FROM:
            above, below = resonant_pair(q[i], rho[i])
            roots[1, 0, i], roots[1, 1, i] = above.real, above.imag
            roots[2, 0, i], roots[2, 1, i] = below.real, below.imag


def plan_axis(
    v: FloatArray, c: FloatArray, tolerance: float, roots: FloatArray, plan: FloatArray
) -> None:
    """Write the number of points on the axis, and the truncation error, as rows."""
    for i in range(v.size):
        depth, bound = strip_of_remainder(v[i], c[i])
        count = points_beside_roots(bound, tolerance, depth)
        if c[i] / v[i] > PAIR_FROM:
            above = complex(roots[1, 0, i], roots[1, 1, i])
            count = points_off_roots(above, complex(roots[2, 0, i], roots[2, 1, i]), count)
        plan[0, i], plan[1, i] = count, truncation_beside_roots(bound, count, depth)
