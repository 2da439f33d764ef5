"""Loops over many values of Σ by the rules that subtract roots, written for compilation.

The loop over values is the innermost one; it is free of branches and calls, and thus vectorised.
``theory.piecewise.sums.beside_roots`` combines the loops.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from theory.piecewise.sums.arithmetic import cosine_and_sine, modulus, sine_and_cosine_near, size_of
from theory.piecewise.sums.axis import BLOCK
from theory.piecewise.sums.corrected_axis import (
    PAIR_FROM,
    points_beside_roots,
    points_off_roots,
    strip_of_what_is_left,
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

_LARGEST_EXPONENT = 100.0
"""Largest exponent z used in e^z; beyond it the pole correction is zero."""


def plan_segments(
    v: FloatArray, c: FloatArray, tolerance: float, slopes: bool, second: bool, plan: FloatArray
) -> None:
    """Write step, number of nodes, truncation error and phase of one segment as rows."""
    for i in range(v.size):
        required = SEGMENT_SHARE * tolerance / (phase_rate(v[i], c[i], second) if slopes else 1.0)
        far = 2.0 * modulus(complex(0.5, 2.0 * c[i])) if second else 1.0
        step, count, truncation = segment_nodes(required, v[i], c[i] / v[i], far, second)
        plan[0, i], plan[1, i], plan[2, i] = step, count, truncation
        plan[3, i] = second_phase(v[i], c[i]) if second else 0.0


def start_roots(q: FloatArray, psi: FloatArray, rho: FloatArray, pair: FloatArray) -> None:
    """Write the starting points of two roots into the first two rows of each table."""
    n = q.size
    meet = pair[0, 2]
    for i in range(n):
        one, other, nearly = pair_of_the_parabola(q[i], psi[i], rho[i])
        pair[0, 0, i], pair[0, 1, i] = one.real, one.imag
        pair[1, 0, i], pair[1, 1, i] = other.real, other.imag
        meet[i] = 1.0 if nearly else 0.0
    for i in range(n):
        if meet[i] > 0.0:
            one, other = two_roots_near(q[i], psi[i], rho[i])
            pair[0, 0, i], pair[0, 1, i] = one.real, one.imag
            pair[1, 0, i], pair[1, 1, i] = other.real, other.imag


def halves(at: FloatArray) -> None:
    """Write sin(p/2) and cos(p/2) into the rows below p."""
    p_re, p_im, sine_re, sine_im, cosine_re, cosine_im = at[0], at[1], at[2], at[3], at[4], at[5]
    for i in range(at.shape[1]):
        sine, cosine = sine_and_cosine_near(complex(0.5 * p_re[i], 0.5 * p_im[i]))
        sine_re[i], sine_im[i] = sine.real, sine.imag
        cosine_re[i], cosine_im[i] = cosine.real, cosine.imag


def step_all(
    at: FloatArray, q: FloatArray, psi: FloatArray, rho: FloatArray, moving: FloatArray
) -> None:
    """Take one step towards each root that is still moving; mark converged roots as not moving."""
    p_re, p_im, sine_re, sine_im, cosine_re, cosine_im = at[0], at[1], at[2], at[3], at[4], at[5]
    for i in range(q.size):
        p = complex(p_re[i], p_im[i])
        sine, cosine = complex(sine_re[i], sine_im[i]), complex(cosine_re[i], cosine_im[i])
        step, steep = step_to_root(p, sine, cosine, q[i], psi[i], rho[i])
        p += moving[i] * step
        p_re[i], p_im[i] = p.real, p.imag
        moving[i] = 0.0 if has_converged(p, step, steep, rho[i]) else moving[i]


def converge(
    at: FloatArray, q: FloatArray, psi: FloatArray, rho: FloatArray, moving: FloatArray, steps: int
) -> None:
    """Iterate to the moving roots; write p, sin(p/2), cos(p/2), and which roots still move."""
    halves(at)
    for _ in range(steps):
        step_all(at, q, psi, rho, moving)
        halves(at)
        if moving.max() == 0.0:
            return


def exponents_on_segments(
    rho: FloatArray, step: FloatArray, at: FloatArray, power: FloatArray, turn: FloatArray
) -> None:
    """Write Re and Im of z and of its derivative by p as rows; see `segments`."""
    for i in range(rho.size):
        unit = segment_unit(rho[i], step[i], side_of(at[1, i]))
        exponent = unit * complex(at[2, i], at[3, i])
        power[0, i], power[1, i] = exponent.real, exponent.imag
        turned = 0.5 * unit * complex(at[4, i], at[5, i])
        turn[0, i], turn[1, i] = turned.real, turned.imag


def exponents_on_axis(
    count: FloatArray, at: FloatArray, power: FloatArray, turn: FloatArray
) -> None:
    """Write Re and Im of z and of its derivative by p as rows; see `corrected_axis`."""
    for i in range(count.size):
        turn[0, i], turn[1, i] = 0.0, -side_of(at[1, i]) * count[i]
        power[0, i], power[1, i] = -turn[1, i] * at[1, i], turn[1, i] * at[0, i]


def exponentials(z: FloatArray) -> None:
    """Replace Re and Im of z by those of e^z."""
    re, im, size = z[0], z[1], z[2]
    for i in range(re.size):
        size[i] = math.exp(min(re[i], _LARGEST_EXPONENT))
    for i in range(re.size):
        x, y = cosine_and_sine(im[i])
        re[i], im[i] = size[i] * x, size[i] * y


def clearances(power: FloatArray, halfway: FloatArray, whole: FloatArray) -> None:
    """Lower the clearances to that of a root, for nodes that begin half a step from 0, and at 0."""
    for i in range(halfway.size):
        grown = complex(power[0, i], power[1, i])
        halfway[i] = min(halfway[i], clearance_of(grown, -1.0))
        whole[i] = min(whole[i], clearance_of(grown, 1.0))


def add_pole_corrections(
    v: FloatArray, c: FloatArray, at: FloatArray, along: FloatArray, power: FloatArray,
    turn: FloatArray, sign: FloatArray, required: FloatArray, poles: FloatArray,
) -> None:  # fmt: skip
    """Add Re and Im of the effect of one root per value, where required, and its rounding error."""
    re, im, shifts = poles[0], poles[1], poles[6]
    p_re, p_im, s_re, s_im, c_re, c_im = at[0], at[1], at[2], at[3], at[4], at[5]
    power_re, power_im, turn_re, turn_im = power[0], power[1], turn[0], turn[1]
    for i in range(v.size):
        root = complex(p_re[i], p_im[i]), complex(s_re[i], s_im[i]), complex(c_re[i], c_im[i])
        value, _, _, shift, _ = pole_correction(
            root, complex(p_re[i] + along[i], p_im[i]), v[i], c[i],
            complex(power_re[i], power_im[i]), complex(turn_re[i], turn_im[i]), sign[i],
        )  # fmt: skip
        side = required[i] * side_of(p_im[i])
        re[i] += side * value.real
        im[i] += side * value.imag
        shifts[i] += required[i] * shift


def add_pole_correction_slopes(
    v: FloatArray, c: FloatArray, at: FloatArray, along: FloatArray, power: FloatArray,
    turn: FloatArray, sign: FloatArray, required: FloatArray, poles: FloatArray,
) -> None:  # fmt: skip
    """Add the derivatives of the effect of one root per value, where required, and their errors."""
    v_re, v_im, by_re, by_im, gains = poles[2], poles[3], poles[4], poles[5], poles[7]
    p_re, p_im, s_re, s_im, c_re, c_im = at[0], at[1], at[2], at[3], at[4], at[5]
    power_re, power_im, turn_re, turn_im = power[0], power[1], turn[0], turn[1]
    for i in range(v.size):
        root = complex(p_re[i], p_im[i]), complex(s_re[i], s_im[i]), complex(c_re[i], c_im[i])
        _, by_v, by_c, _, gain = pole_correction(
            root, complex(p_re[i] + along[i], p_im[i]), v[i], c[i],
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
    at: FloatArray,
) -> None:  # fmt: skip
    """Write Re, Im of e^{-a} at u = 0, e^{-u²} at the first node, its factors, and v/2c, as rows.

    The first node lies half a step from u = 0, or at u = 0. From each node to the next, e^{-u²} is
    multiplied by the fourth row, and the fourth row by the fifth. The rounding errors of these
    products accumulate where e^{-u²} is small.
    """
    for i in range(v.size):
        decay, gauss = math.exp(-0.5 / v[i]), math.exp(-0.25 * step[i] * step[i])
        x, y = cosine_and_sine(psi[i])
        at[0, i], at[1, i] = decay * x, -decay * y
        fourth = gauss * gauss * gauss * gauss
        at[2, i] = gauss if offset[i] > 0.0 else 1.0
        at[3, i] = fourth * fourth if offset[i] > 0.0 else fourth
        at[4, i] = fourth * fourth
        at[5, i] = 0.5 * v[i] / c[i]


def next_nodes(at: FloatArray) -> None:
    """Advance to the next node; see `start_nodes`."""
    gauss, factor, second = at[2], at[3], at[4]
    for i in range(gauss.size):
        gauss[i] *= factor[i]
        factor[i] *= second[i]


def _node(
    j: int, v: float, turned: float, m: float, step: float, offset: float, count: float
) -> tuple[float, complex, float]:
    """Return Y, A and the weight of the term at a node."""
    u = (j + offset) * step
    square = u * u
    share = (0.5 if u == 0.0 else 1.0) * (1.0 if j < count else 0.0)
    return m * square, complex(0.5 + v * square, turned), share


def add_nodes(
    j: int, v: FloatArray, c: FloatArray, step: FloatArray, offset: FloatArray, count: FloatArray,
    at: FloatArray, second: bool, sums: FloatArray,
) -> None:  # fmt: skip
    """Add Re and Im of g, and |g|, at node j."""
    phase_re, phase_im, gauss, m = at[0], at[1], at[2], at[5]
    re, im, size = sums[0], sums[1], sums[2]
    for i in range(v.size):
        turned = 2.0 * c[i] if second else 0.0
        Y, A, share = _node(j, v[i], turned, m[i], step[i], offset[i], count[i])
        g = segment_term(complex(phase_re[i] * gauss[i], phase_im[i] * gauss[i]), Y, A)
        re[i] += share * g.real
        im[i] += share * g.imag
        size[i] += share * size_of(g)


def add_node_slopes(
    j: int, v: FloatArray, c: FloatArray, step: FloatArray, offset: FloatArray, count: FloatArray,
    at: FloatArray, second: bool, sums: FloatArray,
) -> None:  # fmt: skip
    """Add Re and Im of the derivatives of g, and the modulus of that by v, at node j."""
    phase_re, phase_im, gauss, m = at[0], at[1], at[2], at[5]
    for i in range(v.size):
        turned = 2.0 * c[i] if second else 0.0
        Y, A, share = _node(j, v[i], turned, m[i], step[i], offset[i], count[i])
        E = complex(phase_re[i] * gauss[i], phase_im[i] * gauss[i])
        _, g_v, g_c = segment_slopes(E, Y, A, v[i], second)
        sums[3, i] += share * g_v.real
        sums[4, i] += share * g_v.imag
        sums[5, i] += share * size_of(g_v)
        sums[6, i] += share * g_c.real
        sums[7, i] += share * g_c.imag


def add_all_nodes(
    v: FloatArray, c: FloatArray, plan: FloatArray, offset: FloatArray, second: bool, slopes: bool,
    sums: FloatArray,
) -> None:  # fmt: skip
    """Write the sums of g, and with ``slopes`` of its derivatives, over the nodes of a segment.

    ``plan`` is that of `plan_segments`.
    """
    for first in range(0, v.size, BLOCK):
        part = slice(first, first + BLOCK)
        some_v, some_c, step, count = v[part], c[part], plan[0][part], plan[1][part]
        at, found = np.empty((6, some_v.size)), np.zeros((8, some_v.size))
        start_nodes(some_v, some_c, plan[3][part], step, offset[part], at)
        for j in range(int(count.max())):
            add_nodes(j, some_v, some_c, step, offset[part], count, at, second, found)
            if slopes:
                add_node_slopes(j, some_v, some_c, step, offset[part], count, at, second, found)
            next_nodes(at)
        for row in range(8):
            for i in range(some_v.size):
                sums[row, first + i] = found[row, i]


def add_segment(
    v: FloatArray, c: FloatArray, plan: FloatArray, sums: FloatArray, taken: FloatArray,
    second: bool, rows: FloatArray, bounds: FloatArray,
) -> None:  # fmt: skip
    """Add Re and Im of the contribution of one segment to Σ, and the error bounds.

    ``sums`` holds the sums over the nodes, and ``taken`` the pole corrections, to be subtracted.
    For the second segment the complex conjugate is added.
    """
    step, truncation = plan[0], plan[2]
    turn = -1.0 if second else 1.0
    for i in range(v.size):
        width = segment_width(v[i], c[i], step[i])
        term = width * SEGMENT_TURN * complex(sums[0, i], sums[1, i])
        rows[0, i] += term.real - taken[0, i]
        rows[1, i] += turn * (term.imag - taken[1, i])
        size, steep = width * sums[2, i], width * sums[5, i] / v[i]
        rounding, rough = segment_errors(
            v[i], c[i], second, truncation[i], size, steep, taken[6, i], taken[7, i]
        )
        bounds[0, i] += truncation[i] + rounding
        bounds[1, i] += rough


def add_segment_slopes(
    v: FloatArray, c: FloatArray, plan: FloatArray, sums: FloatArray, taken: FloatArray,
    second: bool, rows: FloatArray,
) -> None:  # fmt: skip
    """Add Re and Im of the contribution of one segment to the derivatives of Σ; `add_segment`."""
    step = plan[0]
    turn = -1.0 if second else 1.0
    for i in range(v.size):
        width = segment_width(v[i], c[i], step[i])
        by_v = -width / (v[i] * v[i]) * SEGMENT_TURN * complex(sums[3, i], sums[4, i])
        by_c = width * SEGMENT_TURN * complex(sums[6, i], sums[7, i])
        rows[2, i] += by_v.real - taken[2, i]
        rows[3, i] += turn * (by_v.imag - taken[3, i])
        rows[4, i] += by_c.real - taken[4, i]
        rows[5, i] += turn * (by_c.imag - taken[5, i])


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
        depth, bound = strip_of_what_is_left(v[i], c[i])
        count = points_beside_roots(bound, tolerance, depth)
        if c[i] / v[i] > PAIR_FROM:
            above = complex(roots[1, 0, i], roots[1, 1, i])
            count = points_off_roots(above, complex(roots[2, 0, i], roots[2, 1, i]), count)
        plan[0, i], plan[1, i] = count, 2.0 * bound / math.expm1(count * depth)
