"""Integration of a smooth chain with steps of equal length, all sites active."""

from __future__ import annotations

from typing import Any

import numpy as np

from theory.arrays import FloatArray
from theory.chains.chain import SmoothChain
from theory.chains.ends import Ends
from verification.execution.compiled import outer
from verification.steppers.active import FREE, RING
from verification.steppers.kernel import fast, slope_mark, slope_of
from verification.steppers.rows import put
from verification.steppers.runge_kutta import STAGES, STEP_SIGNATURE, Step
from verification.steppers.smooth import compiled_step
from verification.steppers.specialise import pointer


def fixed_steps(chain: SmoothChain, state: FloatArray, h: float, steps: int, order: int) -> None:
    """Advance a state (y, w), shape (2, N), in place, by steps of length h in the kernel's time.

    Parameters
    ----------
    chain : SmoothChain
        The chain.
    state : ndarray, shape (2, N)
        Initial state, which is overwritten.
    h, steps
        Length and number of steps.
    order : int
        8 for DOP853, or 4 for the classical Runge-Kutta step.
    """
    chain.check_unforced("equal steps")
    take_step = {8: compiled_step, 4: _classical_step}[order](chain)
    code = RING if chain.ends is Ends.PERIODIC else FREE
    ends = (code, code) if chain.network is None else (0, chain.sites)
    x = np.ascontiguousarray(state).ravel()
    _advance(take_step, x, np.array(chain.kernel_parameters()), ends, float(h), steps)
    state[...] = x.reshape(state.shape)


def _classical_step(chain: SmoothChain) -> Any:
    """Return the classical step of order 4 for a chain, from disk if it is already compiled."""
    return pointer(_classical, STEP_SIGNATURE, slope_mark(chain), _slope=slope_of(chain))


def _slope(x: FloatArray, p: FloatArray, left: int, right: int, out: FloatArray) -> None:
    """Serve as a placeholder for the right-hand side with which the step is compiled."""
    raise NotImplementedError


@fast
def _classical(
    x: FloatArray, p: FloatArray, left: int, right: int, h: float, K: FloatArray, out: FloatArray
) -> None:
    half, whole = 0.5 * h, h / 6.0
    k0, k1, k2, k3 = K[0], K[1], K[2], K[3]
    _slope(x, p, left, right, k0)
    for n in range(x.size):
        out[n] = x[n] + half * k0[n]
    _slope(out, p, left, right, k1)
    for n in range(x.size):
        out[n] = x[n] + half * k1[n]
    _slope(out, p, left, right, k2)
    for n in range(x.size):
        out[n] = x[n] + h * k2[n]
    _slope(out, p, left, right, k3)
    for n in range(x.size):
        out[n] = x[n] + whole * (k0[n] + 2.0 * (k1[n] + k2[n]) + k3[n])


@outer(cache=True)
def _advance(
    take_step: Step,
    x: FloatArray,
    parameters: FloatArray,
    ends: tuple[int, int],
    h: float,
    steps: int,
) -> None:
    out = np.zeros(x.size)
    K = np.zeros((STAGES, x.size))
    for _ in range(steps):
        take_step(x, parameters, ends[0], ends[1], h, K, out)
        put(out, x)
