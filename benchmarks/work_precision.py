"""Error against run time: the one engine that measures methods and peers at test problems.

A file of this folder that exposes ``BENCHMARK``, a :class:`WorkPrecision`, adds the benchmark of a
quantity of ``verification.quantities``. Methods take turns in one process, which spreads a slow
minute of a shared machine over all of them alike; a time is the median of the repeated calls in
processor seconds, and the first call stands apart.
"""

from __future__ import annotations

import math
import statistics
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING, Any

import mpmath as mp
import numpy as np

from benchmarks.record import BenchmarkFailure, Target, WorkPoint
from verification.execution.time_limit import time_limit

if TYPE_CHECKING:
    from verification.quantities.problems import Problem

RESULTS = Path(__file__).resolve().parent / "results"

Report = Callable[[str], None]
"""Progress callback: called with what is being done."""

_COMPARED_DIGITS = 80
_MAX_REASON = 160


@dataclass(frozen=True, kw_only=True)
class MethodAnswer:
    """What one call of a method gave.

    Attributes
    ----------
    value : object
        A number, an array, or what the ``error`` of the benchmark compares.
    claimed : float or None
        The error bound that the method itself states; None where it states none.
    seconds : tuple of float
        Of each call, where the method is timed in processes of its own; else empty.
    defect : str
        What is wrong with it beside its error; listed as a failure.
    """

    value: Any
    claimed: float | None = None
    seconds: tuple[float, ...] = ()
    defect: str = ""


@dataclass(frozen=True, kw_only=True)
class Setting:
    """A method at one setting.

    Attributes
    ----------
    method, knob : str
        Its name, and the setting that trades error for time.
    evaluate : callable
        Compute it, all of it, from plain numbers.
    reference : object
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
    evaluate: Callable[[], MethodAnswer]
    reference: Any
    batch: int = 1
    quick: bool = True
    peer: bool = False


@dataclass(frozen=True, kw_only=True)
class Effort:
    """How long to measure.

    Attributes
    ----------
    seconds : float
        Of repeated calls for each setting, if that gives between ``least`` and ``most``.
    least, most : int
        Repeated calls. One whose first call took longer than ``once_from`` is repeated once.
    once_from : float
        Seconds.
    limit : float
        Seconds after which a single call is given up.
    """

    seconds: float = 1.0
    least: int = 3
    most: int = 51
    once_from: float = 2.0
    limit: float = 60.0

    def repeats(self, first: float) -> int:
        """Return the number of repeated calls after a first call of that many seconds."""
        if first > self.once_from:
            return 1
        return int(min(self.most, max(self.least, self.seconds / max(first, 1e-9))))


@dataclass(frozen=True, kw_only=True)
class Prepared:
    """One test problem made ready to be measured.

    Attributes
    ----------
    agreement : float
        Distance between the two references that share no code.
    settings : sequence of Setting
        Every method at every setting.
    failures : sequence of (str, str, str)
        Method, setting and reason of what could not be made ready.
    """

    agreement: float
    settings: Sequence[Setting]
    failures: Sequence[tuple[str, str, str]] = ()


@dataclass(frozen=True, kw_only=True)
class Style:
    """How a diagram is drawn.

    Attributes
    ----------
    xlabel, ylabel, caption : str
        Texts.
    methods : mapping of str to (str, str)
        Colour and marker of each method.
    garbage : float
        Error beyond which a result is no answer.
    floor : float
        Errors below, and those of zero, are drawn there, in a strip that says so.
    """

    xlabel: str
    ylabel: str
    caption: str
    methods: Mapping[str, tuple[str, str]]
    garbage: float
    floor: float = 1e-17


def distance(value: Any, reference: Any) -> float:
    """Return the largest |value - reference|; of numbers subtracted in 80 digits.

    Raises
    ------
    ArithmeticError
        If it is not finite.

    Examples
    --------
    >>> distance(1.0, mp.mpf(1) + mp.mpf(2) ** -40) == 2.0**-40
    True
    >>> distance(np.array([1.0, 2.0]), np.array([1.0, 2.5]))
    0.5
    """
    if isinstance(value, np.ndarray):
        found = float(np.abs(value - reference).max())
    else:
        with mp.workdps(_COMPARED_DIGITS):
            found = float(abs(mp.mpmathify(value) - mp.mpmathify(reference)))
    if not math.isfinite(found):
        raise ArithmeticError("the result is not finite")
    return found


def no_targets(points: Sequence[WorkPoint], quick: bool, report: Report) -> Sequence[Target]:
    """Return nothing: no speed was promised."""
    return ()


@dataclass(frozen=True, kw_only=True)
class WorkPrecision:
    """The benchmark of one quantity: its methods and peers.

    Name, default method, useful errors, test problems and references are those of the quantity of
    that name in the registry (``benchmarks.registry.quantity_of``).

    Attributes
    ----------
    name : str
        Of the quantity; the record is ``<name>.json``.
    prepare : callable
        From (problem, quick, report) to references and settings.
    style : Style
        How the diagram is drawn; it names every method.
    error : callable
        From a value and its reference to the error; an exception is a failure of the method.
    effort, quick_effort : Effort
        How long to measure: within 3 minutes and within 20 s for all settings.
    quick_problems : int
        How many test problems a quick run takes.
    targets : callable
        From (points, quick, report) to speeds that were promised.
    variants : tuple of str
        The default in other dress, such as one call in place of a batch: drawn, and no rivals.
    others : mapping of str to str
        Methods that solve another problem, and which: drawn, and no rivals.
    reasons : mapping of str to str
        Rivals that are faster somewhere, and why the default is the default all the same.
    first : mapping of str to callable
        One first call of the default and of each peer, for a process of its own; imports inside.
    code : tuple of str
        Modules that are measured and that the benchmark does not import itself.
    """

    name: str
    prepare: Callable[[Problem, bool, Report], Prepared]
    style: Style
    error: Callable[[Any, Any], float] = distance
    effort: Effort = Effort()
    quick_effort: Effort = Effort(seconds=0.1, least=1, most=9, once_from=0.5, limit=20.0)
    quick_problems: int = 1
    targets: Callable[[Sequence[WorkPoint], bool, Report], Sequence[Target]] = no_targets
    variants: tuple[str, ...] = ()
    others: Mapping[str, str] = field(default_factory=dict)
    reasons: Mapping[str, str] = field(default_factory=dict)
    first: Mapping[str, Callable[[], object]] = field(default_factory=dict)
    code: tuple[str, ...] = ()

    @property
    def module(self) -> str:
        """Dotted name of the module that measures it."""
        return self.prepare.__module__


def measure_side_by_side(
    quantity: str,
    problem: str,
    settings: Sequence[Setting],
    *,
    effort: Effort,
    clock: Callable[[], float] = process_time,
    error: Callable[[Any, Any], float] = distance,
) -> tuple[tuple[WorkPoint, ...], tuple[BenchmarkFailure, ...]]:
    """Return one point for each setting that gave a value, one failure for each that did not.

    Parameters
    ----------
    quantity, problem : str
        What is computed and where; copied into the points.
    settings : sequence of Setting
        In the order in which they take turns.
    effort : Effort
        How long to measure.
    clock : callable
        Time in seconds.
    error : callable
        From a value and its reference to the error.
    """
    failures: list[BenchmarkFailure] = []
    running: list[tuple[Setting, MethodAnswer, float, float, str, list[float]]] = []
    for each in settings:
        try:
            answer, first, warned = _first_call(each, effort.limit, clock)
            off = error(answer.value, each.reference)
        except Exception as reason:  # whatever a peer raises is its result
            text = _short(f"{type(reason).__name__}: {reason}")
            failures.append(BenchmarkFailure(quantity, problem, each.method, each.knob, text))
            continue
        if answer.defect:
            failures.append(
                BenchmarkFailure(quantity, problem, each.method, each.knob, answer.defect)
            )
        first = answer.seconds[0] if answer.seconds else first
        running.append((each, answer, off, first, warned, list(answer.seconds)))
    waiting = [(each, first, times) for each, _, _, first, _, times in running if not times]
    rounds = max((effort.repeats(first) for _, first, _ in waiting), default=0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for turn in range(rounds):
            for each, first, times in waiting:
                if turn < effort.repeats(first):
                    start = clock()
                    each.evaluate()
                    times.append(clock() - start)
    points = tuple(
        WorkPoint(
            quantity, problem, each.method, each.knob, off, answer.claimed, first / each.batch,
            statistics.median(times) / each.batch, len(times), warned,
        )
        for each, answer, off, first, warned, times in running
    )  # fmt: skip
    return points, tuple(failures)


def _first_call(
    setting: Setting, limit: float, clock: Callable[[], float]
) -> tuple[MethodAnswer, float, str]:
    with warnings.catch_warnings(record=True) as caught, time_limit(limit):
        warnings.simplefilter("always")
        start = clock()
        answer = setting.evaluate()
        seconds = clock() - start
    return answer, seconds, _short(str(caught[0].message)) if caught else ""


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= _MAX_REASON else line[: _MAX_REASON - 1] + "…"


def least_factor(
    ours: Sequence[WorkPoint], peers: Sequence[WorkPoint], low: float, high: float
) -> tuple[float, WorkPoint, WorkPoint] | None:
    """Return the least factor of time by which ours beat the peers at equal error, and where.

    Each peer with an error from ``low`` to ``high`` is compared with the fastest of ours that is
    at least as exact: factor, the peer, ours. None if no pair can be compared.
    """
    factors = []
    for peer in peers:
        equal = [point for point in ours if point.error <= peer.error]
        if low <= peer.error <= high and equal:
            fastest = min(equal, key=lambda point: point.seconds)
            factors.append((peer.seconds / fastest.seconds, peer, fastest))
    return min(factors, default=None, key=lambda row: row[0])
