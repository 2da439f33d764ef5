"""Error versus run time: measurement of our and other methods at test problems.

A file of this folder that defines ``BENCHMARK``, a :class:`WorkPrecision`, adds the benchmark of a
quantity of ``verification.quantities``. Methods take turns in one process, so that a slow minute of
a shared machine affects all of them equally. A time is the median over the repeated calls, in
seconds of processor time; the first call is reported separately.
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

from benchmarks.record import BenchmarkFailure, Relation, Target, WorkPoint
from verification.execution.time_limit import time_limit

if TYPE_CHECKING:
    from verification.quantities.problems import Problem

RESULTS = Path(__file__).resolve().parent / "results"

Report = Callable[[str], None]
"""Progress callback, called with a description of the current step."""

_COMPARED_DIGITS = 80
_MAX_REASON = 160


@dataclass(frozen=True, kw_only=True)
class MethodAnswer:
    """The result of one call of a method.

    Attributes
    ----------
    value : object
        A number, an array, or an object that the ``error`` of the benchmark compares.
    claimed : float or None
        The error bound that the method itself states; None where it states none.
    seconds : tuple of float
        Time of each call, if the method is timed in processes of its own; otherwise empty.
    defect : str
        What is wrong with the value apart from its error; listed as a failure.
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
        Name of the method, and the setting that trades error for time.
    evaluate : callable
        Function that does the complete computation from plain numbers.
    reference : object
        The true value, from a method that shares no code with this one.
    batch : int
        Number of evaluations in one call, by which times are divided.
    quick : bool
        Whether a quick run includes this setting.
    peer : bool
        Whether the method is that of another program.
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
        Total time of the repeated calls for each setting, provided that their number is between
        ``min_repeats`` and ``max_repeats``.
    min_repeats, max_repeats : int
        Least and largest number of repeated calls. A call that first takes longer than
        ``once_from`` is repeated once.
    once_from : float
        Time of a first call, in seconds.
    limit : float
        Time, in seconds, after which a single call is given up.
    """

    seconds: float = 1.0
    min_repeats: int = 3
    max_repeats: int = 51
    once_from: float = 2.0
    limit: float = 60.0

    def repeats(self, first: float) -> int:
        """Return the number of repeated calls after a first call that took ``first`` seconds."""
        if first > self.once_from:
            return 1
        return int(min(self.max_repeats, max(self.min_repeats, self.seconds / max(first, 1e-9))))


@dataclass(frozen=True, kw_only=True)
class Prepared:
    """One test problem that is ready for measurement.

    Attributes
    ----------
    agreement : float
        Distance between the two references that share no code.
    settings : sequence of Setting
        All methods at all their settings.
    failures : sequence of (str, str, str)
        Method, setting and reason for each setting that could not be prepared.
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
        Labels of the axes, and the caption.
    methods : mapping of str to (str, str)
        Colour and marker of each method.
    garbage : float
        Error above which a result counts as useless.
    floor : float
        Error at which smaller errors, including zero, are drawn, in a labelled strip.
    """

    xlabel: str
    ylabel: str
    caption: str
    methods: Mapping[str, tuple[str, str]]
    garbage: float
    floor: float = 1e-17


def distance(value: Any, reference: Any) -> float:
    """Return the largest |value - reference|; single numbers are subtracted with 80 digits.

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
    """Return no targets: no speed was promised."""
    return ()


@dataclass(frozen=True, kw_only=True)
class WorkPrecision:
    """The benchmark of one quantity: our methods and those of other programs.

    Name, default method, useful errors, test problems and references are those of the quantity of
    that name in the registry (``benchmarks.registry.quantity_of``).

    Attributes
    ----------
    name : str
        Name of the quantity; the record is ``<name>.json``.
    prepare : callable
        Maps (problem, quick, report) to a :class:`Prepared`: references and settings.
    style : Style
        How the diagram is drawn; it names every method.
    error : callable
        Maps a value and its reference to the error; an exception is a failure of the method.
    effort, quick_effort : Effort
        How long to measure: within 3 minutes, or 20 s in a quick run, for all settings.
    quick_problems : int
        Number of test problems in a quick run.
    targets : callable
        Maps (points, quick, report) to the promised speeds.
    variants : tuple of str
        Variants of the default, such as one call instead of a batch; drawn, but not rivals.
    others : mapping of str to str
        Methods that solve another problem, each with that problem; drawn, but not rivals.
    reasons : mapping of str to str
        Rivals that are faster at some error, and why the default is nevertheless the default.
    first : mapping of str to callable
        A first call of the default and of each other program, made in a new process; the callable
        does the imports.
    code : tuple of str
        Modules that are measured but not imported by the benchmark itself.
    """

    name: str
    prepare: Callable[[Problem, bool, Report], Prepared]
    style: Style
    error: Callable[[Any, Any], float] = distance
    effort: Effort = Effort()
    quick_effort: Effort = Effort(
        seconds=0.1, min_repeats=1, max_repeats=9, once_from=0.5, limit=20.0
    )
    quick_problems: int = 1
    targets: Callable[[Sequence[WorkPoint], bool, Report], Sequence[Target]] = no_targets
    variants: tuple[str, ...] = ()
    others: Mapping[str, str] = field(default_factory=dict)
    reasons: Mapping[str, str] = field(default_factory=dict)
    first: Mapping[str, Callable[[], object]] = field(default_factory=dict)
    code: tuple[str, ...] = ()

    @property
    def module(self) -> str:
        """Dotted name of the module that defines the benchmark."""
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
    """Return one point for each setting that gave a value, and one failure for each other setting.

    Parameters
    ----------
    quantity, problem : str
        Names of the quantity and of the test problem, which are copied into the points.
    settings : sequence of Setting
        The settings, in the order in which they take turns.
    effort : Effort
        How long to measure.
    clock : callable
        Returns the time in seconds.
    error : callable
        Maps a value and its reference to the error.
    """
    failures: list[BenchmarkFailure] = []
    running: list[tuple[Setting, MethodAnswer, float, float, str, list[float]]] = []
    for each in settings:
        try:
            answer, first, warned = _first_call(each, effort.limit, clock)
            off = error(answer.value, each.reference)
        except Exception as reason:  # whatever another program raises is its result
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
    """Return the least factor by which our methods are faster than others at equal error.

    Each point of another program with an error from ``low`` to ``high`` is compared with our
    fastest point that is at least as accurate. The result is the factor, the other point and ours,
    or None if no pair can be compared.
    """
    factors = []
    for peer in peers:
        equal = [point for point in ours if point.error <= peer.error]
        if low <= peer.error <= high and equal:
            fastest = min(equal, key=lambda point: point.seconds)
            factors.append((peer.seconds / fastest.seconds, peer, fastest))
    return min(factors, default=None, key=lambda row: row[0])


def ratio_target(
    claim: str,
    ours: Sequence[WorkPoint],
    peers: Sequence[WorkPoint],
    *,
    errors: tuple[float, float],
    limit: float | None,
) -> Target:
    """Return the least factor by which our methods are faster at equal error, beside its limit.

    Parameters
    ----------
    claim : str
        What is claimed.
    ours, peers : sequence of WorkPoint
        As in :func:`least_factor`.
    errors : (float, float)
        Range of errors of the peers that are compared.
    limit : float or None
        The factor that was promised; None for no promise.
    """
    least = least_factor(ours, peers, *errors)
    detail = "ours never reached an error of theirs from {:g} to {:g}".format(*errors)
    if least is not None:
        detail = "least favourable: " + "; ours: ".join(
            f"{each.method}, {each.knob}: error {each.error:.1e} in {each.seconds:.2g} s"
            for each in least[1:]
        )
    relation: Relation = "no target" if limit is None else "at least"
    return Target(claim, None if least is None else least[0], relation, limit, "times", detail)
