"""Measure several methods side by side: in one process, in turns, medians of repeated calls.

Taking turns spreads a slow minute of a shared machine over all methods alike.
"""

from __future__ import annotations

import signal
import statistics
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import mpmath as mp

from benchmarks.record import Failure, WorkPoint

_COMPARED_DIGITS = 80
_LONGEST_REASON = 160


@dataclass(frozen=True)
class Answer:
    """A value, and the error bound that the method itself claims."""

    value: Any
    claimed: float | None


@dataclass(frozen=True)
class Contender:
    """A method at one setting.

    Attributes
    ----------
    method, knob : str
        Names.
    evaluate : callable
        Compute it, all of it, from plain numbers.
    reference : complex or mpc
        The true value, from a method that shares no code with this one.
    batch : int
        Evaluations in one call; times are divided by it.
    quick : bool
        Whether a quick run includes it.
    peer : bool
        Not ours.
    """

    method: str
    knob: str
    evaluate: Callable[[], Answer]
    reference: Any
    batch: int = 1
    quick: bool = True
    peer: bool = False


@dataclass(frozen=True)
class Effort:
    """How long to measure.

    Attributes
    ----------
    seconds : float
        Of repeated calls for each contender, if that gives between ``fewest`` and ``most``.
    fewest, most : int
        Repeated calls. One whose first call took longer than ``patience`` is repeated once.
    patience : float
        Seconds.
    limit : float
        Seconds after which a single call is given up.
    """

    seconds: float = 2.0
    fewest: int = 3
    most: int = 101
    patience: float = 4.0
    limit: float = 90.0

    def repeats(self, first: float) -> int:
        """Return the number of repeated calls after a first call of that many seconds."""
        if first > self.patience:
            return 1
        return int(min(self.most, max(self.fewest, self.seconds / max(first, 1e-9))))


class TooSlowError(RuntimeError):
    """A call that was given up."""


def measure_side_by_side(
    quantity: str,
    scene: str,
    contenders: Sequence[Contender],
    effort: Effort,
    clock: Callable[[], float] = perf_counter,
) -> tuple[tuple[WorkPoint, ...], tuple[Failure, ...]]:
    """Return one point for each contender that gave a value, one failure for each that did not.

    Parameters
    ----------
    quantity, scene : str
        What is computed and where; copied into the points.
    contenders : sequence of Contender
        In the order in which they take turns.
    effort : Effort
        How long to measure.
    clock : callable
        Wall time in seconds.
    """
    failures: list[Failure] = []
    running: list[tuple[Contender, Answer, float, str, list[float]]] = []
    for each in contenders:
        try:
            answer, first, warned = _first_call(each, effort.limit, clock)
        except Exception as error:  # whatever a peer raises is its result
            failures.append(Failure(quantity, scene, each.method, each.knob, _reason(error)))
            continue
        running.append((each, answer, first, warned, []))
    rounds = max((effort.repeats(row[2]) for row in running), default=0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for turn in range(rounds):
            for each, _, first, _, times in running:
                if turn < effort.repeats(first):
                    start = clock()
                    each.evaluate()
                    times.append(clock() - start)
    points = tuple(
        WorkPoint(
            quantity,
            scene,
            each.method,
            each.knob,
            distance(answer.value, each.reference),
            answer.claimed,
            first / each.batch,
            statistics.median(times) / each.batch,
            len(times),
            warned,
        )
        for each, answer, first, warned, times in running
    )
    return points, tuple(failures)


def distance(value: Any, reference: Any) -> float:
    """Return |value - reference|, subtracted in 80 digits.

    Examples
    --------
    >>> distance(1.0, mp.mpf(1) + mp.mpf(2) ** -40) == 2.0**-40
    True
    """
    with mp.workdps(_COMPARED_DIGITS):
        return float(abs(mp.mpmathify(value) - mp.mpmathify(reference)))


def _first_call(
    contender: Contender, limit: float, clock: Callable[[], float]
) -> tuple[Answer, float, str]:
    with warnings.catch_warnings(record=True) as caught, time_limit(limit):
        warnings.simplefilter("always")
        start = clock()
        answer = contender.evaluate()
        seconds = clock() - start
    return answer, seconds, _short(str(caught[0].message)) if caught else ""


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Raise ``TooSlowError`` inside the block after so long, where the system has such an alarm."""
    if not hasattr(signal, "SIGALRM") or threading.current_thread() is not threading.main_thread():
        yield
        return

    def give_up(*_: object) -> None:
        raise TooSlowError(f"not done within {seconds:g} s")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def _reason(error: Exception) -> str:
    return _short(f"{type(error).__name__}: {error}")


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= _LONGEST_REASON else line[: _LONGEST_REASON - 1] + "…"
