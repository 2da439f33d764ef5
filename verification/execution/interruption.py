"""Interrupts: SIGTERM is treated like one from the keyboard, and work is saved before the end."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from theory.interruption import handled


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
    with handled(usual | {signal.SIGINT: signal.default_int_handler}, deferred.note):
        yield deferred


@contextmanager
def terminated_as_interrupted() -> Iterator[None]:
    """Within the block, raise `Terminated` where a SIGTERM or SIGHUP would end the process."""
    with handled(dict.fromkeys(ENDING, signal.SIG_DFL), _raise):
        yield


def _raise(number: int, _: FrameType | None) -> None:
    # A second signal during the handling of the first must not cut the saving short.
    signal.signal(number, signal.SIG_IGN)
    raise _interrupt(number)


def _interrupt(number: int) -> KeyboardInterrupt:
    return KeyboardInterrupt() if number == signal.SIGINT else Terminated()
