"""Progress of a long command on standard error, and what is left of it if it is interrupted."""

from __future__ import annotations

import shutil
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from types import TracebackType
from typing import TextIO

PERIOD = 0.5
"""Seconds between two refreshes of the live line."""


class Progress:
    """Print one line a finished step; in a terminal also what is running and for how long.

    Parameters
    ----------
    total : int
        Number of steps.
    stream : file, optional
        By default standard error.
    """

    def __init__(self, total: int, stream: TextIO | None = None) -> None:
        self._stream = stream or sys.stderr
        self._live = self._stream.isatty()
        self._total = total
        self._finished = 0
        self._running: dict[str, float] = {}
        self._begin = time.perf_counter()
        self._lock = threading.Lock()
        self._stop = threading.Event()
        self._ticker = threading.Thread(target=self._tick, daemon=True)

    def __enter__(self) -> Progress:
        if self._live:
            self._ticker.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._stop.set()
        if self._live:
            self._ticker.join()
            self._clear()

    @property
    def finished(self) -> int:
        """Number of steps finished so far."""
        return self._finished

    def begin(self, name: str) -> None:
        """Note that a step has begun or waits for a free process."""
        with self._lock:
            self._running[name] = time.perf_counter()
            self._show()

    def end(self, name: str, text: str) -> None:
        """Print that a step has ended, and how."""
        with self._lock:
            self._running.pop(name, None)
            self._finished += 1
            if self._live:
                self._clear()
            elapsed = time.perf_counter() - self._begin
            digits = len(str(self._total))
            counter = f"[{self._finished:{digits}}/{self._total}]"
            print(f"{counter} {elapsed:7.1f} s  {name}: {text}", file=self._stream, flush=True)
            self._show()

    def _tick(self) -> None:
        while not self._stop.wait(PERIOD):
            with self._lock:
                self._show()

    def _show(self) -> None:
        if not self._live or not self._running:
            return
        first = next(iter(self._running))
        others = len(self._running) - 1
        elapsed = time.perf_counter() - self._running[first]
        text = f"... {first} ({elapsed:.0f} s)" + (f" and {others} more" if others else "")
        columns = shutil.get_terminal_size().columns
        self._stream.write(f"\r\x1b[K{text[: columns - 1]}")
        self._stream.flush()

    def _clear(self) -> None:
        self._stream.write("\r\x1b[K")
        self._stream.flush()


class Interrupted(KeyboardInterrupt):
    """An interruption whose message says what is kept and how to go on."""


@contextmanager
def kept(said: Callable[[], str]) -> Iterator[None]:
    """Let an interruption inside say what is kept; an empty text says that nothing is.

    Examples
    --------
    >>> try:
    ...     with kept(lambda: "run.npz is kept"):
    ...         raise KeyboardInterrupt
    ... except Interrupted as interrupted:
    ...     print(interrupted)
    run.npz is kept
    """
    try:
        yield
    except KeyboardInterrupt:
        raise Interrupted(said()) from None


def kept_by_journal(*outs: Path | None) -> AbstractContextManager[None]:
    """Let an interruption of sweeps into these tables name the journals that are left."""

    def said() -> str:
        from verification.execution.journal import journal_path

        left = [path for out in outs if out is not None for path in [journal_path(out)]]
        names = " and ".join(str(path) for path in left if path.exists())
        return f"{names} is kept: the same command with --resume goes on from it" if names else ""

    return kept(said)


def kept_by_checkpoint(checkpoint: Path | None) -> AbstractContextManager[None]:
    """Let an interruption of a run name its checkpoint, if it has been written."""

    def said() -> str:
        if checkpoint is None or not checkpoint.exists():
            return ""
        return f"{checkpoint} is kept: the same command with this --checkpoint goes on from it"

    return kept(said)


class Fraction:
    """A live line with the fraction of one long step and the time left; silent without a terminal.

    Parameters
    ----------
    name : str
        What is running.
    stream : file, optional
        By default standard error.
    """

    def __init__(self, name: str, stream: TextIO | None = None) -> None:
        self._name = name
        self._stream = stream or sys.stderr
        self._live = self._stream.isatty()
        self._begin = self._shown = time.perf_counter()

    def __enter__(self) -> Fraction:
        return self

    def __exit__(self, *_: object) -> None:
        if self._live:
            self._stream.write("\r\x1b[K")
            self._stream.flush()

    def show(self, fraction: float) -> None:
        """Refresh the line, at most twice a second."""
        now = time.perf_counter()
        if not self._live or now - self._shown < PERIOD:
            return
        self._shown = now
        columns = shutil.get_terminal_size().columns
        text = f"... {self._name}: {100 * fraction:.0f} %"
        if fraction > 0:  # before, nothing is known of the time it takes
            left = (now - self._begin) * (1.0 - fraction) / fraction
            text += f", about {left:.0f} s left"
        self._stream.write(f"\r\x1b[K{text[: columns - 1]}")
        self._stream.flush()
