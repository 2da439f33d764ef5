"""One step of DOP853, compiled for any right-hand side.

The tableau is scipy's; its nonzero weights become constants in a source text that is compiled. The
state is a row of length 2m (``active``); all quantities are dimensionless.

References
----------
E. Hairer, S. P. Nørsett, G. Wanner, Solving Ordinary Differential Equations I (1993), II.5, II.10.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache
from typing import Any

from numba import types
from scipy.integrate import DOP853

from theory.arrays import FloatArray
from verification.execution.compiled import inner
from verification.steppers.kernel import Slope, fast
from verification.steppers.rows import finite, largest

STAGES = DOP853.n_stages

Step = Callable[[FloatArray, FloatArray, int, int, float, FloatArray, FloatArray], None]
"""Function of (state, parameters, left, right, h, K, out): put the state after h into ``out``.

The slopes remain in K, of shape (STAGES, 2m). ``out`` is also the work space of the stages and
must not be the state.
"""
STEP_SIGNATURE: Any = types.void(
    types.float64[::1], types.float64[::1], types.intp, types.intp, types.float64,
    types.float64[:, ::1], types.float64[::1],
)  # fmt: skip
"""The same in numba's notation."""


_SMALL = 1e-150
"""A number whose square is still far from underflow."""
_ROWS = [*DOP853.A[1:STAGES, :STAGES], DOP853.B]


def _sum(weights: FloatArray) -> str:
    """Return the source text of Σ w_i K_i over the nonzero weights, at site n."""
    return " + ".join(f"{float(w)!r}*K[{i}, n]" for i, w in enumerate(weights) if w != 0.0)


def _compiled(text: list[str], **names: Any) -> Any:
    """Compile the function of a source text, in which the given names refer to other functions."""
    names["__name__"] = __name__
    exec(compile("\n".join(text), __file__, "exec"), names)  # code is stored for a file only
    return fast(names[text[0].partition("(")[0].removeprefix("def ")])


_stages = [
    _compiled(
        [
            f"def stage{i}(x, h, K, out):",
            "    for n in range(x.size):",
            f"        out[n] = x[n] + h*({_sum(row)})",
        ]
    )
    for i, row in enumerate(_ROWS)
]
"""Stages, compiled separately from the step because they are the same for all chains."""


@inner(forceinline=True, error_model="numpy")
def _put_cosines(p: FloatArray, place: int, count: int, later: float) -> None:
    """Put cos(ωt + phase) of the harmonic forces, at a time within a step, into the parameters.

    From ``place`` on, the parameters contain the time at the beginning of the step, and then ω,
    phase and cosine of each of ``count`` forces.
    """
    for k in range(count):
        at = place + 1 + 3 * k
        p[at + 2] = math.cos(p[at] * (p[place] + later) + p[at + 1])


@lru_cache(maxsize=64)
def dop853_step(slope: Slope, clock: tuple[int, int]) -> Step:
    """Return one step of DOP853, of order 8, for a right-hand side.

    ``clock`` gives the index of the time among the parameters, and the number of harmonic forces.
    """
    place, forces = clock
    text = ["def step(x, p, left, right, h, K, out):"]
    for i, node in enumerate(DOP853.C[:STAGES]):
        if forces:
            text += [f"    put_cosines(p, {place}, {forces}, {float(node)!r}*h)"]
        text += [
            f"    slope({'out' if i else 'x'}, p, left, right, K[{i}])",
            f"    stage{i}(x, h, K, out)",
        ]
    stages = {f"stage{i}": stage for i, stage in enumerate(_stages)}
    found: Step = _compiled(text, slope=slope, put_cosines=_put_cosines, **stages)
    return found


_estimates: Callable[[FloatArray, FloatArray, FloatArray], None] = _compiled(
    [
        "def estimates(K, five, three):",
        "    for n in range(five.size):",
        f"        five[n] = {_sum(DOP853.E5[:STAGES])}",
        f"        three[n] = {_sum(DOP853.E3[:STAGES])}",
    ]
)


@inner(error_model="numpy", fastmath={"contract"})
def step_error(K: FloatArray, h: float, work: FloatArray, size: float) -> float:
    """Return DOP853's estimate of the largest local error over the sites, relative to ``size``.

    The estimate is e5²/√(e5² + e3²/100). It vanishes where only e3 is huge, so that a diverging
    step would be accepted; if e3 is as large as the state, infinity is returned instead. ``work``
    has the shape (2, 2m).
    """
    five, three = work[0], work[1]
    _estimates(K, five, three)
    e5, e3 = h * largest(five), h * largest(three)
    if not (finite(five) and finite(three)) or e3 >= size > 0.0:
        return math.inf
    if e5 < _SMALL:
        return e5 / size  # which bounds the estimate
    return e5 / size * (e5 / math.sqrt(e5 * e5 + 0.01 * e3 * e3))
