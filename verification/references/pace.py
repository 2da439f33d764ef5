"""Runs of scipy to their end, and when one gives up: as soon as it would take longer than it may.

How many steps a chain needs cannot be told from its parameters to within a factor of thirty, so
that no limit of radians or steps is a limit of time. What a run has covered so far tells.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

from theory.arrays import AnyArray

MAX_SECONDS = 10.0
"""Processor seconds of one check: were one in fifteen as slow as that, a thousand points would take
ten minutes more."""

_FIRST = 0.05
"""Share of them for the beginning, where steps may be short."""


class NoReferenceError(ArithmeticError):
    """A reference does not reach this point; the message says why."""


class TooSlowError(NoReferenceError):
    """It would not be over in time."""


class Pace:
    """The clock of one run, begun when it is made."""

    def __init__(self) -> None:
        self._begin = time.process_time()

    def check(self, covered: float) -> None:
        """Go on, with that share of the run behind it.

        Raises
        ------
        TooSlowError
            If the run would take more than `MAX_SECONDS`.
        """
        if time.process_time() - self._begin > MAX_SECONDS * (_FIRST + covered):
            raise TooSlowError(f"too stiff or too long for a reference of {MAX_SECONDS:g} s")


def paced(rate: Callable[..., Any], end: float) -> Callable[..., Any]:
    """Return a right side that refuses to go on at too slow a pace from zero to the end.

    Examples
    --------
    >>> paced(lambda t, y: -y, 1.0)(0.5, 2.0)
    -2.0
    """
    pace = Pace()

    def checked(t: float, state: Any) -> Any:
        pace.check(abs(t / end))
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
