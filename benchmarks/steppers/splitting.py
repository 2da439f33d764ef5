"""A compiled splitting for nearly integrable systems: SABA of Laskar and Robutel for (8).

The harmonic motion and the perturbation (coupling and damping at fixed y, an affine equation for
ẏ) are each solved exactly; the error is O(ε h^{2n}) + O(ε² h²). The method is stable at any
displacement, but grossly inaccurate at a large one. It is included for comparison, and is the
fastest only where ε is very small.
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np

from theory.arrays import FloatArray
from verification.execution.compiled import outer


@outer(cache=True, error_model="numpy")
def split_steps(
    state: FloatArray,
    parameters: FloatArray,
    periodic: bool,
    h: float,
    steps: int,
    drifts: FloatArray,
    kicks: FloatArray,
) -> None:
    """Advance the state (y, ẏ), shape (2, N), by alternating exact rotations and exact kicks.

    Parameters
    ----------
    state : ndarray, shape (2, N)
        Initial state, which is overwritten.
    parameters : ndarray, shape (4,)
        a, b, c, ε.
    periodic : bool
        Whether the chain is a ring.
    h, steps
        Length and number of steps.
    drifts, kicks : ndarray, shapes (n + 1,), (n,)
        Fractions of a step (:func:`saba`).
    """
    a, b, c, eps = parameters[0], parameters[1], parameters[2], parameters[3]
    sites = state.shape[1]
    last = sites - 1
    y, w = state[0], state[1]
    for _ in range(steps):
        for i in range(drifts.size):
            cosine, sine = math.cos(h * drifts[i]), math.sin(h * drifts[i])
            for n in range(sites):
                y[n], w[n] = cosine * y[n] + sine * w[n], cosine * w[n] - sine * y[n]
            if i == kicks.size:
                break
            for n in range(sites):
                before = y[n - 1] if n > 0 else (y[last] if periodic else y[0])
                after = y[n + 1] if n < last else (y[0] if periodic else y[last])
                pull = c * (2.0 * y[n] - before - after)
                square = y[n] * y[n]
                damping = 1.0 - a * square + b * square * square
                x = -eps * h * kicks[i] * damping
                grown = math.expm1(x)
                share = grown / x if x != 0.0 else 1.0
                w[n] += grown * w[n] - eps * h * kicks[i] * share * pull


@lru_cache(maxsize=8)
def saba(stages: int) -> tuple[FloatArray, FloatArray]:
    """Return drifts and kicks of SABA_n: spacings and weights of Gauss-Legendre nodes on [0, 1].

    Examples
    --------
    >>> drifts, kicks = saba(2)
    >>> drifts.round(6), kicks
    (array([0.211325, 0.57735 , 0.211325]), array([0.5, 0.5]))
    """
    nodes, weights = np.polynomial.legendre.leggauss(stages)
    edges = np.concatenate([[0.0], 0.5 * (nodes + 1.0), [1.0]])
    return np.diff(edges), 0.5 * weights
