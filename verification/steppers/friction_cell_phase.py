"""One slip phase of one cell (Eq. 5 at c = 0), from a given state to its end condition.

The phase is continued smoothly beyond ẏ = v_d (the exponential continues to grow), so that "the
largest velocity after release" is a smooth function of the parameters even where the cycle ends.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from theory.arrays import FloatArray
from verification.execution.compiled import outer
from verification.steppers.friction_series import (
    MODE,
    POLYNOMIAL,
    RELEASED,
    TOLERANCE,
    V_D,
    Law,
    W,
    Y,
    expand,
    first_root,
    friction_inner,
    resolved,
    site_value,
    term_length,
    term_size,
    value_at,
)

HIGHEST, LOWEST, TOUCH, FASTEST, SLOWEST = 0, 1, 2, 3, 4
"""Ends of a phase: ẏ falls through 0; ẏ rises through 0; ẏ rises to v_d; ẏ stops rising; ẏ stops
falling. With the signs of y, w and v_d reversed it is a phase of forward slip."""

FAILED, ABANDONED = -1.0, -2.0
"""Times returned if the end does not follow, and if it was not reached within the longest time."""


class Creep(NamedTuple):
    """Where slip with ẏ ≤ v_d is known to approach steady sliding without turning.

    With u = μ(v_d) - y and a drag D(ẏ) = 2ξẏ + μ(v_d) - μ(v_d - ẏ), slip obeys u̇ = -ẏ and
    ẏ̇ = u - D. If D(ẏ)/ẏ ≥ 2 as far as the present u, no motion leaves the wedge between ẏ = 0 and
    ẏ = u: on ẏ = u, d(ẏ - u)/dτ = u - D + ẏ has the sign of -u. Steps limited by the stability of
    strong damping would otherwise follow the motion until the search is abandoned.

    Attributes
    ----------
    sliding : float
        μ(v_d).
    lowest : float
        Smallest y from which a motion inside the wedge does not reach ẏ = v_d.
    rising, falling : float
        Up to which |ẏ| ≤ v_d this holds for positive ẏ, and up to which |ẏ| for negative ẏ; may be
        infinite.
    """

    sliding: float
    lowest: float
    rising: float
    falling: float


class Phase(NamedTuple):
    """Specification of a slip phase.

    Attributes
    ----------
    numbers : ndarray
        ``friction_series.new_numbers`` for coupling 0.
    law : tuple
        ``friction_series.law_of``.
    work : ndarray
        ``friction_series.new_work``.
    released : bool
        Whether stick ends at τ = 0: ẇ then equals the drop of the friction force, 0 if continuous.
    end : int
        HIGHEST, LOWEST, TOUCH, FASTEST or SLOWEST.
    longest : float
        Time after which the search is abandoned.
    creep : Creep
        Where it is abandoned at once, since no end follows.
    """

    numbers: FloatArray
    law: Law
    work: FloatArray
    released: bool
    end: int
    longest: float
    creep: Creep


def follow(phase: Phase, y: float, w: float) -> tuple[float, float, float]:
    """Return τ, y and w = ẏ - v_d where a backward slip phase first meets its end condition.

    If it does not, they are FAILED or ABANDONED and the last state.

    Parameters
    ----------
    phase : Phase
        The phase.
    y, w : float
        State at τ = 0, which does not itself count as an end.
    """
    found = np.array([math.nan, y, w])
    _follow(phase, found)
    return float(found[0]), float(found[1]), float(found[2])


@outer(cache=True)
def _follow(phase: Phase, found: FloatArray) -> None:
    """Put τ, y and w at the end of the phase into ``found``, whose last two are the start."""
    numbers, law, work = phase.numbers, phase.law, phase.work
    end, longest = phase.end, phase.longest
    order, f = work.shape[1] - 1, work[POLYNOMIAL]
    series, site = np.zeros((3 + len(law), order + 1, 3)), np.zeros((11, 3))
    mode = np.zeros((6, 3), dtype=np.int64)
    mode[MODE, 1], mode[RELEASED, 1] = -1, 1 if phase.released else 0
    last = series.shape[2] - 1  # not constants, for which numba would compile separately
    t = 0.0
    armed = False  # whether f has been positive, or is positive just after the start
    while t < longest and not _creeps(phase.creep, found[1], found[2], numbers[V_D]):
        series[Y, 0, 1], series[W, 0, 1] = found[1], found[2]
        expand(series, site, mode, numbers, law, last - 1, last)
        mode[RELEASED, 1] = 0
        term, last_term = term_size(series, order - 1, 1), term_size(series, order, 1)
        if not math.isfinite(term + last_term):
            break
        h = term_length(term, last_term, order, numbers[TOLERANCE])
        h = resolved(series, numbers, law, 1, -1.0, min(h, 0.5))
        if t + h == t:
            break
        degree = _watched(series[W], numbers[V_D], end, f)
        if t == 0.0:
            for k in range(degree + 1):
                if f[k] != 0.0:
                    armed = f[k] > 0.0
                    break
        after = value_at(f, degree, h)
        root = first_root(work, degree, h) if armed or f[0] > 0.0 else math.inf
        h = min(root, h)
        found[1], found[2] = site_value(series[Y], 1, h), site_value(series[W], 1, h)
        if root == h:
            found[0] = t + root
            return
        armed = armed or after > 0.0
        t += h
    found[0] = FAILED if t < longest else ABANDONED


@friction_inner
def _creeps(creep: Creep, y: float, w: float, v_d: float) -> bool:
    """Return whether a motion approaches steady sliding from here without turning."""
    u, velocity = creep.sliding - y, w + v_d
    if 0.0 <= velocity <= u:
        return u < creep.rising and w <= 0.0 and y >= creep.lowest
    return -creep.falling < u <= velocity <= 0.0


@friction_inner
def _watched(w: FloatArray, v_d: float, end: int, f: FloatArray) -> int:
    """Put the function that changes sign from + to - at the end into f; return its degree."""
    degree = int(w.shape[0]) - 1
    sign = -1.0 if end in (LOWEST, TOUCH, SLOWEST) else 1.0
    if end in (FASTEST, SLOWEST):
        for k in range(degree):
            f[k] = sign * (k + 1) * w[k + 1, 1]
        return degree - 1
    for k in range(degree + 1):
        f[k] = sign * w[k, 1]
    if end in (HIGHEST, LOWEST):
        f[0] += sign * v_d
    return degree
