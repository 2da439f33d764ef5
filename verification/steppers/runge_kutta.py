"""Explicit Runge-Kutta steps, compiled for any right-hand side: DOP853 and the classical one.

The tableau is scipy's; each of its rows becomes a compiled closure over its nonzero weights. The
state is a row of length 2m (``active``); all quantities are dimensionless.

References
----------
E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I (1993), II.5, II.10.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache

import numpy as np
import numpy.typing as npt
from scipy.integrate import DOP853

from verification.execution.compiled import inner, njit
from verification.steppers.kernel import Slope, fast
from verification.steppers.rows import finite, largest

FloatArray = npt.NDArray[np.float64]

STAGES = DOP853.n_stages

Step = Callable[[FloatArray, FloatArray, int, int, float, FloatArray, FloatArray], None]
"""Of (state, parameters, left, right, h, K, out): put the state after h into ``out``.

The slopes stay in K, of shape (STAGES, 2m). ``out`` is also room for the stages and must not be the
state.
"""


def _weighted(
    weights: FloatArray,
) -> Callable[[FloatArray, float, FloatArray, FloatArray], None]:
    """Return compiled out = x + h Σ w_i K_i over the nonzero weights."""
    used = tuple(i for i, weight in enumerate(weights) if weight != 0.0)
    w = tuple(float(weights[i]) for i in used)
    count = len(used)

    @inner(error_model="numpy", fastmath={"contract"})
    def combine(x: FloatArray, h: float, K: FloatArray, out: FloatArray) -> None:
        for n in range(x.size):
            total = w[0] * K[used[0], n]
            for j in range(1, count):
                total += w[j] * K[used[j], n]
            out[n] = x[n] + h * total

    found: Callable[[FloatArray, float, FloatArray, FloatArray], None] = combine
    return found


_ROWS = [DOP853.A[i, :i] for i in range(1, STAGES)] + [DOP853.B]
_C1, _C2, _C3, _C4, _C5, _C6, _C7, _C8, _C9, _C10, _C11, _C12 = map(_weighted, _ROWS)
_FIFTH, _THIRD = _weighted(DOP853.E5[:STAGES]), _weighted(DOP853.E3[:STAGES])


_NODES = tuple(float(c) for c in DOP853.C[:STAGES])


@njit(forceinline=True, error_model="numpy")
def _put_cosines(p: FloatArray, place: int, count: int, later: float) -> None:
    """Put cos(ωt + phase) of the harmonic forces at a time within a step into the parameters.

    From ``place`` on they have the time at the beginning of the step, and ω, phase and cosine of
    each of ``count`` forces.
    """
    for k in range(count):
        at = place + 1 + 3 * k
        p[at + 2] = math.cos(p[at] * (p[place] + later) + p[at + 1])


@lru_cache(maxsize=64)
def dop853_step(slope: Slope, clock: tuple[int, int] = (0, 0)) -> Step:
    """Return one step of DOP853, of order 8, for a right-hand side.

    ``clock`` is the place of the time among the parameters, and the number of harmonic forces.
    """
    place, count = clock
    c = _NODES

    @fast
    def step(
        x: FloatArray,
        p: FloatArray,
        left: int,
        right: int,
        h: float,
        K: FloatArray,
        out: FloatArray,
    ) -> None:
        _put_cosines(p, place, count, 0.0)
        slope(x, p, left, right, K[0])
        _C1(x, h, K, out)
        _put_cosines(p, place, count, c[1] * h)
        slope(out, p, left, right, K[1])
        _C2(x, h, K, out)
        _put_cosines(p, place, count, c[2] * h)
        slope(out, p, left, right, K[2])
        _C3(x, h, K, out)
        _put_cosines(p, place, count, c[3] * h)
        slope(out, p, left, right, K[3])
        _C4(x, h, K, out)
        _put_cosines(p, place, count, c[4] * h)
        slope(out, p, left, right, K[4])
        _C5(x, h, K, out)
        _put_cosines(p, place, count, c[5] * h)
        slope(out, p, left, right, K[5])
        _C6(x, h, K, out)
        _put_cosines(p, place, count, c[6] * h)
        slope(out, p, left, right, K[6])
        _C7(x, h, K, out)
        _put_cosines(p, place, count, c[7] * h)
        slope(out, p, left, right, K[7])
        _C8(x, h, K, out)
        _put_cosines(p, place, count, c[8] * h)
        slope(out, p, left, right, K[8])
        _C9(x, h, K, out)
        _put_cosines(p, place, count, c[9] * h)
        slope(out, p, left, right, K[9])
        _C10(x, h, K, out)
        _put_cosines(p, place, count, c[10] * h)
        slope(out, p, left, right, K[10])
        _C11(x, h, K, out)
        _put_cosines(p, place, count, c[11] * h)
        slope(out, p, left, right, K[11])
        _C12(x, h, K, out)

    found: Step = step
    return found


@njit(cache=True, error_model="numpy", fastmath={"contract"})
def step_error(K: FloatArray, h: float, room: FloatArray, size: float) -> float:
    """Return DOP853's estimate of the local error, the largest over sites, relative to ``size``.

    It is e5²/√(e5² + e3²/100) and vanishes where e3 alone is huge, so that a step that explodes
    would pass: where e3 is as large as the state, the estimate is infinite. ``room`` has the shape
    (3, 2m); its last row must be zero.
    """
    five, three, zero = room[0], room[1], room[2]
    _FIFTH(zero, 1.0, K, five)
    _THIRD(zero, 1.0, K, three)
    e5, e3 = h * largest(five), h * largest(three)
    if not (finite(five) and finite(three)) or e3 >= size > 0.0:
        return math.inf
    if e5 == 0.0:
        return 0.0
    return e5 / size * (e5 / math.sqrt(e5 * e5 + 0.01 * e3 * e3))


@lru_cache(maxsize=64)
def classical_step(slope: Slope) -> Step:
    """Return one classical step of order 4 for a right-hand side; for benchmarks."""

    @fast
    def step(
        x: FloatArray,
        p: FloatArray,
        left: int,
        right: int,
        h: float,
        K: FloatArray,
        out: FloatArray,
    ) -> None:
        half, whole = 0.5 * h, h / 6.0
        k0, k1, k2, k3 = K[0], K[1], K[2], K[3]
        slope(x, p, left, right, k0)
        for n in range(x.size):
            out[n] = x[n] + half * k0[n]
        slope(out, p, left, right, k1)
        for n in range(x.size):
            out[n] = x[n] + half * k1[n]
        slope(out, p, left, right, k2)
        for n in range(x.size):
            out[n] = x[n] + h * k2[n]
        slope(out, p, left, right, k3)
        for n in range(x.size):
            out[n] = x[n] + whole * (k0[n] + 2.0 * (k1[n] + k2[n]) + k3[n])

    found: Step = step
    return found
