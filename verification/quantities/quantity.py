"""What the stability table knows of a quantity, and the points at which it is tried."""

from __future__ import annotations

import itertools
import math
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np

from verification.quantities.scenes import scenes_of

Values: TypeAlias = dict[str, float]
"""Parameters by name; counts as whole floats."""

BAD_EVERY = 20
"""One point in so many has a value that is not allowed."""

MOST_CORNERS = 64


@dataclass(frozen=True)
class Axis:
    """One parameter, tried over all decades in which it is defined.

    Attributes
    ----------
    name : str
        Its symbol.
    low, high : float
        Ends of its range; positive.
    whole : bool
        Only whole numbers.
    near : tuple of float
        Values that are also approached, to within ``closest`` on both sides, by one point in four.
    closest : float
        Relative distance of the nearest approach.
    """

    name: str
    low: float
    high: float
    whole: bool = False
    near: tuple[float, ...] = ()
    closest: float = 1e-12

    def draw(self, rng: np.random.Generator) -> float:
        """Return a value at random, each decade as likely as any other.

        Examples
        --------
        >>> axis = Axis("c", 1e-8, 1e8)
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
        """Return the values that corners are made of."""
        beside = [c * (1.0 + s * self.closest) for c in self.near for s in (-1.0, 1.0)]
        return (self.low, self.high, *beside)

    def bad(self, rng: np.random.Generator) -> float:
        """Return a value that is not allowed, or beyond the range that is swept."""
        beyond = (0.0, -1.0, math.nan, math.inf, self.low * 1e-9, self.high * 1e9)
        return beyond[int(rng.integers(len(beyond)))]


@dataclass(frozen=True)
class Claim:
    """What the toolkit says.

    Attributes
    ----------
    value : object
        One number, complex number, array or mpmath number.
    error : float
        The error it states.
    note : str
        What it says beside, as that precision was raised.
    extra : object
        Whatever the check needs.
    """

    value: Any
    error: float
    note: str = ""
    extra: Any = None


@dataclass(frozen=True)
class Check:
    """What another method says of the claim.

    Attributes
    ----------
    distance : float
        Distance from the reference, in the units of the stated error.
    uncertainty : float
        Error of the reference.
    by : str
        Which method.
    """

    distance: float
    uncertainty: float
    by: str


class NoReferenceError(ArithmeticError):
    """No other method reaches this point."""


@dataclass(frozen=True)
class Quantity:
    """One row of the table.

    Attributes
    ----------
    name, what : str
        Its name and one line about it.
    axes : tuple of Axis
        Its parameters.
    compute : callable
        From the parameters to a `Claim`. A refusal is a `ParameterError` or an ``ArithmeticError``
        of the toolkit.
    check : callable
        From the parameters and the claim to a `Check`, by code that the claim does not use.
    seconds : float
        Time that one value may take.
    share : float
        How many points it gets beside the others; costly ones get fewer.
    scenes : str
        Name of its scenes in ``verification.quantities.scenes``.
    ends : str
        Why a range ends before its parameter does; empty if none does.
    """

    name: str
    what: str
    axes: tuple[Axis, ...]
    compute: Callable[[Mapping[str, float]], Claim]
    check: Callable[[Mapping[str, float], Claim], Check]
    seconds: float
    share: float = 1.0
    scenes: str = ""
    ends: str = ""

    def fixed_points(self) -> list[Values]:
        """Return named scenes in its ranges, then the corners; of more than 64 some, evenly."""
        return list(self._fixed)

    @cached_property
    def _fixed(self) -> tuple[Values, ...]:
        names = [axis.name for axis in self.axes]
        middle = {axis.name: self._plain(axis) for axis in self.axes}
        ranges = {axis.name: axis for axis in self.axes}
        points = []
        for scene in scenes_of(self.scenes):
            mine = {name: value for name, value in scene.items() if name in names}
            if all(ranges[x].low <= value <= ranges[x].high for x, value in mine.items()):
                points.append({**middle, **mine})
        corners = list(itertools.product(*(axis.ends() for axis in self.axes)))
        some = np.unique(np.linspace(0, len(corners) - 1, MOST_CORNERS).astype(int))
        points += [dict(zip(names, corners[i], strict=True)) for i in some]
        return tuple(points)

    def point(self, seed: int, index: int) -> Values:
        """Return the point of that number: fixed and random ones in turn, reproducibly."""
        if not self.is_random(index):
            return dict(self._fixed[index // 2])
        rng = np.random.default_rng([seed, zlib.crc32(self.name.encode()), index])
        values = {axis.name: axis.draw(rng) for axis in self.axes}
        if index % BAD_EVERY == BAD_EVERY - 1:
            axis = self.axes[int(rng.integers(len(self.axes)))]
            values[axis.name] = axis.bad(rng)
        return values

    def is_random(self, index: int) -> bool:
        """Tell whether the point of that number is at random: every other one, and all in the end.

        Examples
        --------
        >>> from verification.quantities.discover import quantity_named
        >>> quantity = quantity_named("c-pin")
        >>> [quantity.is_random(number) for number in (0, 1, 2, 3, 10_000)]
        [False, True, False, True, True]
        """
        return index % 2 == 1 or index // 2 >= len(self._fixed)

    @staticmethod
    def _plain(axis: Axis) -> float:
        value = math.sqrt(axis.low * axis.high)
        return float(round(value)) if axis.whole else value


def whole(number: float) -> Any:
    """Return a whole number as int; what is none as it is, for the toolkit to refuse."""
    return int(number) if math.isfinite(number) else number
