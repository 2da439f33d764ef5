"""Interrupts from the keyboard that wait, as while numba compiles or loads a function."""

from __future__ import annotations

import functools
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import FrameType
from typing import Any


@functools.cache
def compile_uninterrupted() -> None:
    """Let an interrupt from the keyboard wait until numba has compiled or loaded a function.

    Where it ends the setting up of numba's tables of known functions, at the first such call in a
    process, every later one fails, as with "duplicate registration" or "generator raised
    StopIteration".
    """
    from numba.core.ccallback import CFunc
    from numba.core.dispatcher import Dispatcher

    for kind in (Dispatcher, CFunc):
        setattr(kind, "compile", _uninterrupted(kind.compile))  # noqa: B010


def _uninterrupted(compiling: Callable[..., Any]) -> Callable[..., Any]:
    @functools.wraps(compiling)
    def compiled(*given: Any, **named: Any) -> Any:
        with interrupted_afterwards():
            return compiling(*given, **named)

    return compiled


@contextmanager
def interrupted_afterwards() -> Iterator[None]:
    """Let interrupts from the keyboard within the block wait for its end, however many they are."""
    arrived: list[int] = []
    try:
        with handled(
            {signal.SIGINT: signal.default_int_handler}, lambda number, _: arrived.append(number)
        ):
            yield
    finally:
        if arrived:
            raise KeyboardInterrupt


@contextmanager
def handled(
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
