"""The contract of a quantity, which everything that is computed, checked and timed fulfils."""

from __future__ import annotations

import itertools
import math
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Self, TypeAlias

import numpy as np

from verification.quantities.problems import PROBLEMS, Problem, timed

Values: TypeAlias = dict[str, float]
"""Parameters by name; whole numbers are given as floats."""

BAD_EVERY = 20
"""One point out of this number has a value that is not allowed."""

MAX_CORNERS = 64

MAX_UNCERTAINTY = 0.5
"""Largest uncertainty of a reference that may confirm a value, relative to the stated error.

Let t be the true error, e the stated one, and let the reference be within u of the true value. Then
the distance from the reference is at least t - u, and if it is larger than e + u the stated error
is exceeded. An error understated by a factor of two, t > 2e, is therefore certain to be detected if
2e - u ≥ e + u, that is, u ≤ e/2. A less certain reference may still refute a value, but cannot
confirm it."""


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A computable quantity, with all that tests, benchmarks and report need to know of it.

    How to register a new quantity:

    1. Write a module of ``verification.quantities`` with ``QUANTITIES``, a tuple of quantities; the
       registry finds it. No other change is needed: the robustness table (``fronts stress``),
       the tests of the table, and the report's list of test problems iterate over the registry.
    2. Choose its family of test problems in ``verification.quantities.problems``, or add one.
    3. State by which independent method its true value is known there, and to what accuracy.
       Equations and formulas of a reference belong in ``verification.references``, which uses
       scipy and mpmath but no code of the methods tested.
    4. Write one :class:`Computation` for each method or model that the toolkit offers: its
       parameters over all decades in which it is defined, a function that returns the value with
       its stated error, and a check by code that this function does not use.
    5. To have its error measured against run time, write a module of ``benchmarks`` that exposes
       ``BENCHMARK``, a ``benchmarks.work_precision.WorkPrecision`` of the same name, with methods
       and peers; :attr:`default` is one of its methods.

    Attributes
    ----------
    name : str
        Name on the command line; the record of its benchmark is ``<name>.json``.
    title : str
        A description in a few words.
    equation : str
        Numbers of the equations of the paper that define it.
    problems : str
        Family of its test problems.
    reference : str
        The method that it is compared with at the test problems; it shares no code with ours.
    accuracy : float
        Largest difference between the two references at any timed problem, and of the check of the
        robustness table at any other problem within its reach; in the unit of the quantity.
    default : str
        The method that the toolkit uses by default.
    useful : (float, float) or None
        Smallest and largest error that a user is likely to ask for; None where nothing is timed.
    computations : tuple of Computation
        Rows of the robustness table; none for a quantity of symbols.
    """

    name: str
    title: str
    equation: str
    problems: str
    reference: str
    accuracy: float
    default: str
    useful: tuple[float, float] | None = None
    computations: tuple[Computation, ...] = ()

    @property
    def test_problems(self) -> tuple[Problem, ...]:
        """All test problems of the quantity."""
        return PROBLEMS[self.problems]

    @property
    def timed_problems(self) -> tuple[Problem, ...]:
        """The test problems at which error is measured against run time."""
        return timed(self.problems) if self.useful else ()


@dataclass(frozen=True, kw_only=True)
class Axis:
    """One parameter, sampled over all decades in which it is defined.

    Attributes
    ----------
    name : str
        Its symbol.
    low, high : float
        Ends of its range, both positive.
    whole : bool
        Whether only whole numbers are allowed.
    near : tuple of float
        Values that one point in four approaches, on either side, to within ``closest``.
    closest : float
        Smallest relative distance of these approaches.
    """

    name: str
    low: float
    high: float
    whole: bool = False
    near: tuple[float, ...] = ()
    closest: float = 1e-12

    def draw(self, rng: np.random.Generator) -> float:
        """Return a random value; all decades are equally likely.

        Examples
        --------
        >>> axis = Axis(name="c", low=1e-8, high=1e8)
        >>> axis.low <= axis.draw(np.random.default_rng(1)) <= axis.high
        True
        """
        if self.near and rng.random() < 0.25:
            centre = self.near[int(rng.integers(len(self.near)))]
            away = math.exp(rng.uniform(math.log(self.closest), math.log(0.1)))
            return float(centre * (1.0 + away * float(rng.choice([-1.0, 1.0]))))
        value = math.exp(rng.uniform(math.log(self.low), math.log(self.high)))
        value = min(max(value, self.low), self.high)
        return float(round(value)) if self.whole else value

    def ends(self) -> tuple[float, ...]:
        """Return the values used for corners."""
        beside = [c * (1.0 + s * self.closest) for c in self.near for s in (-1.0, 1.0)]
        return (self.low, self.high, *beside)

    def middle(self) -> float:
        """Return the geometric mean of the range."""
        value = math.sqrt(self.low * self.high)
        return float(round(value)) if self.whole else value

    def bad(self, rng: np.random.Generator) -> float:
        """Return a value that is not allowed, or is beyond the range of the sweep."""
        beyond = (0.0, -1.0, math.nan, math.inf, self.low * 1e-9, self.high * 1e9)
        return beyond[int(rng.integers(len(beyond)))]


@dataclass(frozen=True, kw_only=True)
class StatedValue:
    """A value stated by the toolkit.

    Attributes
    ----------
    value : object
        A number, complex number, array or mpmath number; None if there is no value to state.
    error : float
        The stated error.
    note : str
        A remark, for example that the precision was raised.
    extra : object
        Further data that the check needs.
    """

    value: Any
    error: float
    note: str = ""
    extra: Any = None

    @classmethod
    def of(cls, found: Any, value: Any, note: str = "") -> Self:
        """Return a value of a result (None if there is none) with the error of the result."""
        error = 0.0 if value is None else found.error
        return cls(value=value, error=error, note=note, extra=found)


@dataclass(frozen=True, kw_only=True)
class ReferenceCheck:
    """The comparison of a stated value with another method.

    Attributes
    ----------
    distance : float
        Distance from the reference, in the units of the stated error.
    uncertainty : float
        Error of the reference.
    method : str
        Name of the other method.
    """

    distance: float
    uncertainty: float = 0.0
    method: str

    @classmethod
    def exact(cls, held: bool, *, method: str) -> Self:
        """Return the check of a method that can only tell right from wrong."""
        return cls(distance=0.0 if held else math.inf, method=method)


@dataclass(frozen=True, kw_only=True)
class Computation:
    """One method or model of a quantity, and the points at which it is tested.

    Attributes
    ----------
    name, title : str
        Its name and one line about it.
    axes : tuple of Axis
        Its parameters.
    compute : callable
        Maps the parameters to a `StatedValue`. A refusal is a `ParameterError` or an
        ``ArithmeticError`` of the toolkit.
    check : callable
        Maps the parameters and the stated value to a `ReferenceCheck`, by code that ``compute``
        does not use; raises `NoReferenceError` where no reference is available.
    seconds : float
        Time allowed for one value.
    share : float
        Relative number of points; costly computations get fewer.
    problems : str
        Family of test problems that are among its points; empty if there is none.
    limits : str
        Why a range ends before that of its parameter does; empty if none does.
    """

    name: str
    title: str
    axes: tuple[Axis, ...]
    compute: Callable[[Mapping[str, float]], StatedValue]
    check: Callable[[Mapping[str, float], StatedValue], ReferenceCheck]
    seconds: float
    share: float = 1.0
    problems: str = ""
    limits: str = ""

    @cached_property
    def fixed_points(self) -> tuple[Values, ...]:
        """Return test problems in its ranges, then corners; an even selection if more than 64."""
        middle = {axis.name: axis.middle() for axis in self.axes}
        ranges = {axis.name: axis for axis in self.axes}
        points = []
        for problem in PROBLEMS.get(self.problems, ()):
            mine = {name: value for name, value in problem.values.items() if name in ranges}
            if all(ranges[x].low <= value <= ranges[x].high for x, value in mine.items()):
                points.append({**middle, **mine})
        corners = list(itertools.product(*(axis.ends() for axis in self.axes)))
        some = np.unique(np.linspace(0, len(corners) - 1, MAX_CORNERS).astype(int))
        points += [dict(zip(ranges, corners[i], strict=True)) for i in some]
        return tuple(points)

    def point(self, seed: int, index: int) -> Values:
        """Return the point with the given number: fixed and random ones alternate, reproducibly."""
        if not self.is_random(index):
            return dict(self.fixed_points[index // 2])
        rng = np.random.default_rng([seed, zlib.crc32(self.name.encode()), index])
        values = {axis.name: axis.draw(rng) for axis in self.axes}
        if index % BAD_EVERY == BAD_EVERY - 1:
            axis = self.axes[int(rng.integers(len(self.axes)))]
            values[axis.name] = axis.bad(rng)
        return values

    def is_random(self, index: int) -> bool:
        """Return whether the point of this number is random: every second one, at the end all.

        Examples
        --------
        >>> from verification.quantities.registry import computation_named
        >>> computation = computation_named("c-pin")
        >>> [computation.is_random(number) for number in (0, 1, 2, 3, 10_000)]
        [False, True, False, True, True]
        """
        return index % 2 == 1 or index // 2 >= len(self.fixed_points)


def axes(**ranges: tuple[float, float]) -> tuple[Axis, ...]:
    """Return an axis for each range; if both ends are integers, only whole numbers are allowed.

    Examples
    --------
    >>> [(axis.name, axis.whole) for axis in axes(c=(1e-8, 10.0), sites=(2, 10_000))]
    [('c', False), ('sites', True)]
    """
    return tuple(
        Axis(
            name=name, low=float(low), high=float(high),
            whole=isinstance(low, int) and isinstance(high, int),
        )
        for name, (low, high) in ranges.items()
    )  # fmt: skip


def whole(number: float) -> Any:
    """Return a whole number as int, and any other unchanged, to be refused by the toolkit."""
    return int(number) if math.isfinite(number) else number
