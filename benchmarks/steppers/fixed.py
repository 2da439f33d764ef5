"""Equal steps of a smooth chain, all sites."""

from __future__ import annotations

import numpy as np

from theory.arrays import FloatArray
from theory.chains.chain import SmoothChain
from theory.chains.ends import Ends
from verification.execution.compiled import outer
from verification.steppers.active import FREE, RING
from verification.steppers.rows import put
from verification.steppers.runge_kutta import STAGES, Step, classical_step, dop853_step
from verification.steppers.smooth import compiled_step


def fixed_steps(chain: SmoothChain, state: FloatArray, h: float, steps: int, order: int) -> None:
    """Advance a state (y, w), shape (2, N), in place, by steps of length h of the kernel's time.

    Parameters
    ----------
    chain : SmoothChain
        Parameters.
    state : ndarray, shape (2, N)
        Overwritten.
    h, steps
        Length and number of steps.
    order : int
        8 for DOP853, or 4 for the classical step.
    """
    chain.check_unforced("equal steps")
    take_step = compiled_step(chain, {8: dop853_step, 4: classical_step}[order])
    code = RING if chain.ends is Ends.PERIODIC else FREE
    ends = (code, code) if chain.network is None else (0, chain.sites)
    x = np.ascontiguousarray(state).ravel()
    _advance(take_step, x, np.array(chain.kernel_parameters()), ends, float(h), steps)
    state[...] = x.reshape(state.shape)


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
