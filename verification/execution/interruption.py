"""SIGTERM treated as an interrupt from the keyboard, so that work is saved before the end."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType


class Terminated(KeyboardInterrupt):
    """The process was asked to end (SIGTERM, or its terminal was closed: SIGHUP)."""


SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name)
)  # SIGHUP is not on every system


@contextmanager
def interruptible() -> Iterator[None]:
    """Raise `Terminated` where a SIGTERM or SIGHUP would end the process, within the block.

    A signal that is ignored (``nohup``) or handled already is left as it is, and so is every
    signal outside of the main thread, where Python lets no handler be set.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    ours = [number for number in SIGNALS if signal.getsignal(number) is signal.SIG_DFL]
    for number in ours:
        signal.signal(number, _raise)
    try:
        yield
    finally:
        for number in ours:
            signal.signal(number, signal.SIG_DFL)


def _raise(number: int, _: FrameType | None) -> None:
    # A second signal while the first one is being served must not cut the saving short.
    signal.signal(number, signal.SIG_IGN)
    raise Terminated(signal.Signals(number).name)
