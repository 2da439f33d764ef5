"""A time limit for a computation."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager

AGAIN = 1.0
"""Seconds between two alarms. If the first alarm occurs in a callback of the interpreter, such as
its garbage collector, the exception is printed and dropped, and the block would run on without
end."""


class TimeIsUpError(Exception):
    """A computation took longer than its time limit."""


@contextmanager
def time_limit(seconds: float, *, of_processor: bool = False) -> Iterator[None]:
    """Raise `TimeIsUpError` in the block after this time; only in the main thread, with alarms.

    Parameters
    ----------
    seconds : float
        Time limit on the clock.
    of_processor : bool, optional
        Whether to count only the processor time of this process, so that other load has no effect.
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
