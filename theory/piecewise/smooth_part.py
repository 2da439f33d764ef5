"""The smooth part of Σ(v, c), and the height of its oscillations, which a search may then skip.

On the path of ``theory.piecewise.sums.rules`` for c > 3v, from k = 0 to π/2 + i∞ and back to π,

    Σ = -1 + 1/√(1 - 4ic) + (1/π)∫g du + oscillations,

where the integral extends over the first segment. Only the second segment, which gives the
oscillations, contains the phase c/v of e^{-a}; the integral over the first varies smoothly with v.
"""

from __future__ import annotations

import math

import numpy as np

from theory.arrays import ComplexArray, FloatArray
from theory.piecewise.limits import static_sum
from theory.piecewise.sums.segments import SEGMENT_TURN

_NODES = 72
"""Nodes of the integral over the first segment."""
_INACCURACY = 1e-5
"""Bound on the relative error of that integral: twice the largest error found by sampling."""
_ROUNDING = 1e-14
"""Bound on the rounding error of Σ and of its smooth part."""
_AT_ONCE = 256
"""Number of values whose nodes fit the processor's cache."""
_HIGHEST = 2.0
"""Bound on the height of these oscillations in units of max(√v, v) e^{-1/2v}/c^{3/2}: four times
the largest height sampled."""
WEAKEST = 2.0
"""Weakest coupling at which these bounds were sampled."""


def smooth_part_of_sum(v: FloatArray, c: FloatArray) -> tuple[ComplexArray, FloatArray]:
    """Return Σ without its oscillations, and a bound on its distance from Σ, errors included.

    The bound was found by sampling over the range below, which a test repeats.

    Parameters
    ----------
    v, c : ndarray of float, shape (n,)
        Front velocity v̂ and coupling, 2 ≤ c, v ≤ c/3.

    Examples
    --------
    >>> smooth, height = smooth_part_of_sum(np.array([3.0]), np.array([100.0]))
    >>> bool(abs(smooth[0] - (-0.7725842 + 0.2091617j)) < height[0] < 0.01)
    True
    """
    values = np.empty(v.size, dtype=complex)
    for begin in range(0, v.size, _AT_ONCE):
        some = slice(begin, begin + _AT_ONCE)
        values[some] = _first_segment(v[some], c[some])
    height = _HIGHEST * np.maximum(np.sqrt(v), v) * np.exp(-0.5 / v) / c**1.5
    height += _INACCURACY * np.abs(values) + _ROUNDING
    return values + static_sum(c), height


def _first_segment(v: FloatArray, c: FloatArray) -> ComplexArray:
    """Return (1/π)∫g du over the first segment."""
    # g varies where u² is about 1/2v and u about √(c/8v³); at u = 5.5 it is negligible.
    lowest = np.log(np.minimum(1.0, np.sqrt(np.minimum(0.5 / v, c / (8.0 * v**3))))) - 8.0
    step = (1.7 - lowest) / (_NODES - 1)
    u = np.exp(lowest[:, None] + step[:, None] * np.arange(_NODES))
    square = u * u
    u[:, 0] /= -np.expm1(-step)  # stands for all nodes before it too, where g is equal
    Y = (0.5 * v / c)[:, None] * square
    E = np.exp((-0.5 / v)[:, None] - square)
    F = 1.0 - E
    root = np.sqrt(0.5 + 0.5 * np.sqrt(1.0 + Y * Y))  # Re √(1 - iY); Im is -Y/2 over it
    denominator = (F * F + 4j * Y * E) * (root - 0.5j * Y / root)
    g = (F - 2j * Y) / denominator * (u * E / (0.5 + v[:, None] * square))
    total: ComplexArray = 2.0 / math.pi * SEGMENT_TURN * np.sqrt(0.5 * v / c) * step * g.sum(axis=1)
    return total
