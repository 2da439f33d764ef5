"""Runs of scipy to their end, abandoned as soon as they would take longer than allowed.

How many steps a chain needs cannot be predicted from its parameters to within a factor of thirty,
so a limit on phase or steps is not a limit on time. The progress of a run so far does predict it.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from theory.arrays import AnyArray

MAX_SECONDS = 10.0
"""Processor seconds allowed for one check. If one check in fifteen takes that long, a thousand
points take ten minutes more."""

_FIRST = 0.05
"""Fraction of this time reserved for the beginning, where steps may be short."""


class NoReferenceError(ArithmeticError):
    """No reference is available at this point; the message says why."""


class TooSlowError(NoReferenceError):
    """The run would not finish in time."""


class Pace:
    """The clock of one run, started when the object is created."""

    def __init__(self) -> None:
        self._begin = time.process_time()

    def check(self, covered: float) -> None:
        """Continue after the given fraction of the run.

        Raises
        ------
        TooSlowError
            If the run would take more than `MAX_SECONDS`.
        """
        if time.process_time() - self._begin > MAX_SECONDS * (_FIRST + covered):
            raise TooSlowError(f"too stiff or too long for a reference of {MAX_SECONDS:g} s")


def paced(rate: Callable[..., Any], end: float) -> Callable[..., Any]:
    """Return a right-hand side that aborts a run from zero to the end if it is too slow.

    Examples
    --------
    >>> paced(lambda t, y: -y, 1.0)(0.5, 2.0)
    -2.0
    """
    pace = Pace()

    def checked(t: float, state: Any) -> Any:
        pace.check(t / end)
        return rate(t, state)

    return checked


def last_state(
    rate: Callable[..., Any], end: float, start: Any, rtol: float, atol: float, **options: Any
) -> AnyArray:
    """Return the state at the end by ``scipy.integrate.solve_ivp`` from zero, DOP853 by default.

    Raises
    ------
    NoReferenceError
        If scipy does not reach the end.

    Examples
    --------
    >>> bool(abs(last_state(lambda t, y: -y, 1.0, [1.0], 1e-9, 1e-12)[0] - 1.0 / np.e) < 1e-9)
    True
    """
    from scipy.integrate import solve_ivp

    options = {"method": "DOP853", "rtol": rtol, "atol": atol, **options}
    run = solve_ivp(rate, (0.0, end), start, **options)
    if not run.success:
        raise NoReferenceError(run.message)
    return np.asarray(run.y[:, -1])
