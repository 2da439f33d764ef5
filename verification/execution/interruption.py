"""Interrupts: SIGTERM is treated like one from the keyboard, and work is saved before the end."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import FrameType
from typing import Any


class Terminated(KeyboardInterrupt):
    """The process was asked to end (SIGTERM, or SIGHUP because its terminal was closed)."""


ENDING = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Signals that ask a process to end; SIGHUP does not exist on every system."""


class Deferred:
    """Interrupts that wait for a moment at which the state is consistent."""

    def __init__(self) -> None:
        self._number: int | None = None

    def check(self) -> None:
        """Raise the interrupt that has arrived since, if any.

        Raises
        ------
        KeyboardInterrupt
            `Terminated` if it did not come from the keyboard.
        """
        number, self._number = self._number, None
        if number is not None:
            raise _interrupt(number)

    def note(self, number: int, _: FrameType | None) -> None:
        """Handle a signal."""
        if self._number is not None:  # second request: interrupt at once, whatever the state
            raise _interrupt(number)
        self._number = number


@contextmanager
def deferred_interrupts() -> Iterator[Deferred]:
    """Let interrupts within the block wait for `Deferred.check`; a second one does not wait."""
    deferred = Deferred()
    usual: dict[int, Any] = dict.fromkeys(ENDING, signal.SIG_DFL)
    with _handled(usual | {signal.SIGINT: signal.default_int_handler}, deferred.note):
        yield deferred


@contextmanager
def interrupted_afterwards() -> Iterator[None]:
    """Let interrupts from the keyboard within the block wait for its end, however many they are."""
    arrived: list[int] = []
    try:
        with _handled(
            {signal.SIGINT: signal.default_int_handler}, lambda number, _: arrived.append(number)
        ):
            yield
    finally:
        if arrived:
            raise KeyboardInterrupt


@contextmanager
def terminated_as_interrupted() -> Iterator[None]:
    """Within the block, raise `Terminated` where a SIGTERM or SIGHUP would end the process."""
    with _handled(dict.fromkeys(ENDING, signal.SIG_DFL), _raise):
        yield


def _raise(number: int, _: FrameType | None) -> None:
    # A second signal during the handling of the first must not cut the saving short.
    signal.signal(number, signal.SIG_IGN)
    raise _interrupt(number)


def _interrupt(number: int) -> KeyboardInterrupt:
    return KeyboardInterrupt() if number == signal.SIGINT else Terminated()


@contextmanager
def _handled(
    usual: Mapping[int, Any], handler: Callable[[int, FrameType | None], Any]
) -> Iterator[None]:
    """Handle signals that have their default handlers; an ignored signal (nohup) stays ignored.

    Outside the main thread Python does not allow handlers to be set, and no signal arrives there.
    """
    ours: dict[int, Any] = {}
    if threading.current_thread() is threading.main_thread():
        ours = {number: was for number, was in usual.items() if signal.getsignal(number) is was}
    for number in ours:
        signal.signal(number, handler)
    try:
        yield
    finally:
        for number, was in ours.items():
            signal.signal(number, was)
