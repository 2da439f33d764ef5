"""A limit to what a computation may take."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

AGAIN = 1.0
"""Seconds between two alarms. Where the first one rings in a callback of the interpreter, as of its
collector of garbage, the exception is printed and dropped, and the block would run without end."""


class TimeIsUpError(Exception):
    """A computation that took longer than it was given."""


@contextmanager
def time_limit(seconds: float, *, of_processor: bool = False) -> Iterator[None]:
    """Raise `TimeIsUpError` in the block after so long; only in the main thread, with alarms.

    Parameters
    ----------
    seconds : float
        On the clock.
    of_processor : bool, optional
        Of this process's processor time, in which what else the machine does has no part.
    """
    here = threading.current_thread() is threading.main_thread()
    if not here or not hasattr(signal, "setitimer"):
        yield
        return

    def ring(*_: object) -> None:
        raise TimeIsUpError(f"not done within {seconds:g} s")

    alarm = signal.SIGPROF if of_processor else signal.SIGALRM
    timer = signal.ITIMER_PROF if of_processor else signal.ITIMER_REAL
    before = signal.signal(alarm, ring)
    signal.setitimer(timer, seconds, AGAIN)
    try:
        yield
    finally:
        signal.setitimer(timer, 0.0)
        signal.signal(alarm, before)
