"""Progress of long computations on standard error.

In a terminal or a notebook a live line (by rich) shows what is running, what fraction is done, and
the time remaining. The first estimate appears with the second report, so that compilation, which is
over by the first one, does not count. Otherwise, as under ``nohup`` or in the log of another
program, a line is printed after ten seconds and then once a minute. A ``quiet`` progress, as for
``--json``, does not print the end of each step there.
"""

from __future__ import annotations

import io
import os
import sys
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, TextIO, TypeAlias

from theory.parameters import count_within, need_instance, truth

if TYPE_CHECKING:
    from rich.progress import Progress as Live
    from rich.progress import TaskID

ProgressCallback: TypeAlias = Callable[[float], None]
"""Called at intervals with the fraction done, from 0 to 1."""

PERIOD = 60.0
"""Seconds between two lines if there is no terminal."""

FIRST = 10.0
"""Seconds before the first of these lines."""

SETTLING = 1.0
"""Seconds of work before the remaining time is estimated."""


class Progress:
    """Progress of one computation, or of several successive ones.

    Parameters
    ----------
    name : str
        What is running.
    steps : int, optional
        Number of steps that are reported individually as they end; 0 for a fraction only.
    at_once : int, optional
        How many of them run in parallel; if more have begun, the others are waiting.
    quiet : bool, optional
        Whether to print no line for each step outside a terminal or a notebook.
    stream : file, optional
        Output stream; by default standard error.

    Examples
    --------
    >>> with Progress("map of 280 points", stream=io.StringIO()) as progress:
    ...     progress.report(0.5)
    """

    def __init__(
        self,
        name: str,
        *,
        steps: int = 0,
        at_once: int = 1,
        quiet: bool = False,
        stream: TextIO | None = None,
    ) -> None:
        need_instance("name", name, (str,), "say what is running")
        self._name, self._quiet = name, truth("quiet", quiet)
        self._steps = count_within("steps", steps, 0, sys.maxsize)
        self._at_once = count_within("steps at once", at_once, 1, sys.maxsize)
        if stream is not None and not hasattr(stream, "write"):
            need_instance("stream", stream, (io.TextIOBase,), "give sys.stderr, or leave it out")
        self._stream = stream or sys.stderr or io.StringIO()
        self._live: tuple[Live, TaskID] | None = None
        self._logs = _is_of_system(self._stream)
        self._remaining = Remaining()
        self._begin = time.monotonic()
        self._next_line = self._begin + FIRST
        self._running: dict[str, float] = {}
        self._lock = threading.Lock()
        self.finished = 0
        """Number of steps that have ended."""

    def __enter__(self) -> Progress:
        if _in_notebook() or (not self._stream.closed and self._stream.isatty()):
            line = _live_line(self._stream)
            self._live = line, line.add_task(self._name, total=1.0, left="")
            line.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live is not None:
            self._live[0].stop()
            self._live = None

    def report(self, fraction: float) -> None:
        """Show the fraction done; may be called as often as is convenient."""
        self._remaining.add(fraction)
        if self._live is not None:
            line, task = self._live
            line.update(task, completed=fraction, left=self._left())
        elif self._logs and time.monotonic() >= self._next_line:
            self._next_line = time.monotonic() + PERIOD
            self._print(f"{self._name}: {100.0 * fraction:.0f} %{self._left()}")

    def begin(self, step: str) -> None:
        """Record that a step has begun, or is waiting for a free process."""
        with self._lock:
            self._running[step] = time.monotonic()
            self._describe()

    def end(self, step: str, message: str, *, computed: bool = True) -> None:
        """Print that a step has ended, and how.

        A step that was read from a store rather than computed does not affect the estimated pace.
        """
        with self._lock:
            if not computed:
                self._remaining = Remaining()
            self._running.pop(step, None)
            self.finished += 1
            digits = len(str(self._steps))
            elapsed = time.monotonic() - self._begin
            if self._live is not None or not self._quiet:
                self._print(
                    f"[{self.finished:{digits}}/{self._steps}] {elapsed:7.1f} s  {step}: {message}"
                )
            self._describe()
        if self._live is not None or self._quiet:
            self.report(self.finished / max(self._steps, 1))

    def _left(self) -> str:
        left = self._remaining.seconds
        return "" if left is None else f", about {left:.0f} s left"

    def _describe(self) -> None:
        if self._live is None:
            return
        first = next(iter(self._running), self._name)
        others = min(len(self._running), self._at_once) - 1
        name = f"{first} and {others} more" if others > 0 else first
        line, task = self._live
        line.update(task, description=name, refresh=True)

    def _print(self, message: str) -> None:
        if self._live is not None:
            line, _ = self._live
            line.console.print(message, markup=False, highlight=False, soft_wrap=True)
        else:
            print(message, file=self._stream, flush=True)


def of_part(progress: ProgressCallback | None, part: int, parts: int) -> ProgressCallback:
    """Return the progress callback for one of several parts that take equally long.

    Examples
    --------
    >>> of_part(print, 1, 4)(0.5)
    0.375
    """
    return lambda fraction: None if progress is None else progress((part + fraction) / parts)


class Remaining:
    """Estimate of the time remaining, from the reports after the first one.

    What happens before the first report (starting, compiling, reading the results of an earlier
    run) is not included in the pace of the work.

    Examples
    --------
    >>> clock = iter([100.0, 101.0, 103.0]).__next__
    >>> left = Remaining(clock)
    >>> left.add(0.25), left.seconds
    (None, None)
    >>> left.add(0.50), left.seconds
    (None, 2.0)
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._first: tuple[float, float] | None = None
        self.seconds: float | None = None
        """Time remaining; None while nothing can be said."""

    def add(self, fraction: float) -> None:
        """Record the fraction done by now."""
        if self._first is None:
            if fraction > 0.0:
                self._first = self._clock(), fraction
            return
        begin, done = self._first
        spent = self._clock() - begin
        if fraction > done and spent >= SETTLING:
            self.seconds = max(0.0, spent * (1.0 - fraction) / (fraction - done))


def _live_line(stream: TextIO) -> Live:
    # Imported here, because no command without a terminal or a notebook needs it.
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(bar_width=20),
        TextColumn("{task.percentage:.0f} %{task.fields[left]}", markup=False),
        TimeElapsedColumn(),
        console=Console(file=stream),
        transient=True,
        refresh_per_second=2,
    )


def _is_of_system(stream: TextIO) -> bool:
    """Whether a stream is a file, a pipe or a socket, rather than an object of this process."""
    try:
        os.fstat(stream.fileno())
    except (OSError, ValueError):  # closed, or not an object of the system
        return False
    return True


def _in_notebook() -> bool:
    """Whether this runs in a Jupyter kernel."""
    found = sys.modules.get("IPython")
    shell = None if found is None else found.get_ipython()
    return type(shell).__name__ == "ZMQInteractiveShell"
