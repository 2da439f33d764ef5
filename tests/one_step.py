"""Steps of the compiled loop of smooth chains for sites whose motion is known.

Each component of the state is a cubic polynomial of the time since the beginning of a step, whose
coefficients stand in the place of the parameters of a chain. A Runge-Kutta method would follow it
exactly, and its slopes are those at the nodes of DOP853; what may be added to these is an error.
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
from scipy.integrate import DOP853

from theory.arrays import AnyArray
from verification.steppers import smooth
from verification.steppers.active import FREE
from verification.steppers.runge_kutta import STAGES, STEP_SIGNATURE
from verification.steppers.smooth import LoopState, LoopTask
from verification.steppers.specialise import pointer, source_mark

TAKEN, LEFT, RIGHT = 0, 1, 2
"""Places in `marks`: the number of steps taken so far, and what lies beyond both ends."""


def _cubic(  # noqa: PLR0917  (as a Step)
    x: Any, p: Any, left: int, right: int, h: float, K: Any, out: Any
) -> None:
    size = x.size
    nodes, errors = 3 * size + 3, 3 * size + 3 + K.shape[0]
    for n in range(size):
        v, a, j = p[n], p[size + n], p[2 * size + n]
        for i in range(K.shape[0]):
            t = p[nodes + i] * h
            K[i, n] = v + t * (2.0 * a + 3.0 * t * j) + (n + 1) * p[errors + i]
        out[n] = x[n] + h * (v + h * (a + h * j))
    p[3 * size] += 1.0
    p[3 * size + 1], p[3 * size + 2] = left, right


def compiled_condition(condition: smooth.Condition) -> Any:
    """Return a stop condition as `steps` takes it; it is compiled by then."""
    return pointer(condition, smooth._STOP, source_mark(condition))


_STEP = pointer(_cubic, STEP_SIGNATURE, source_mark(_cubic))
_NEVER = compiled_condition(smooth._never)


def steps(  # noqa: PLR0913  (all but two by name)
    state: Any,
    motion: Any = (),
    *,
    count: int = 1,
    window: tuple[int, int] | None = None,
    clock: Any = (0.0, 0.0, 0.0, 0.0, 0.0),
    arrivals: Any = None,
    memory: Any = (0.0,),
    watch: Any = _NEVER,
    step: Any = _STEP,
    errors: Any = 0.0,
    **task: Any,
) -> Any:
    """Take steps, by default one of length 1 from time 0; return all that the loop has changed.

    Parameters
    ----------
    state : array_like, shape (2, N)
        Displacements and velocities of all sites.
    motion : array_like, shape (up to 3, 2, m)
        Coefficients of t, t² and t³ for the sites of the window; 0 if they are not given.
    count : int
        Largest number of steps.
    window : tuple of int, optional
        First site that is stepped, and the last one plus one; by default all.
    clock, arrivals, memory, **task
        Of the loop (``smooth.LoopState``, ``smooth.LoopTask``).
    watch, step
        The stop condition, from `compiled_condition`, and the compiled step of a chain in place of
        the known motion.
    errors : array_like, shape (STAGES,), optional
        Added to the slope of each stage, once to the first component, twice to the second.
    """
    whole: AnyArray = np.array(state, dtype=float, order="C")
    low, high = window or (0, whole.shape[1])
    coefficients = np.zeros((3, 2, high - low))
    if len(motion):
        coefficients[: len(motion)] = motion
    given: dict[str, Any] = {
        "parameters": np.concatenate(
            [coefficients.ravel(), np.zeros(3), DOP853.C[:STAGES], np.zeros(STAGES) + errors]
        ),
        "first": FREE, "end": 1e9, "tolerance": 0.0, "shortest": 0.0, "longest": 1.0,
        "review": 0.0, "rest": -1.0, "margin": 4, "level": math.inf, "trailing": 0,
        "times": np.zeros(0), "clock_place": -1, "least_size": 1e-290,
    } | task  # fmt: skip
    given.setdefault("drift", np.zeros(given["parameters"].size))
    given["times"] = np.asarray(given["times"], dtype=float)
    counters = np.zeros(7, dtype=np.int64)
    counters[:2] = low, high
    spare = np.append(np.array(clock, dtype=float), math.nan)  # what is read beyond the end
    run = LoopState(
        state=whole,
        clock=spare[:5],
        counters=counters,
        arrivals=np.full(whole.shape[1], math.nan) if arrivals is None else np.array(arrivals),
        samples=np.full((given["times"].size, *whole.shape), math.nan),
        memory=np.array(memory, dtype=float),
    )
    ready = LoopTask(**given)
    rows = smooth._rows_of(ready, run)
    for each in (rows.new, rows.inside, rows.K):
        each[...] = math.nan
    rows.work[...] = -1.0
    code = smooth._advance(step, watch, ready, run, rows, count)
    marks = rows.p[coefficients.size :][:3]
    return SimpleNamespace(code=code, rows=rows, p=rows.p, marks=marks, **run._asdict())
