"""Tasks that test_sweep.py, and the processes it kills, import by name."""

from __future__ import annotations

import math
import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from theory.result import Result
from verification.execution.points import Grid, Point
from verification.execution.sweep import sweep


@dataclass(frozen=True)
class Slow:
    """Write one line a call into ``log``, so that a test can count what was computed."""

    log: str
    pause: float = 0.0
    factor: float = 1.0

    def __call__(self, point: Point) -> dict[str, float | str | bool | int]:
        time.sleep(self.pause)
        with Path(self.log).open("a", encoding="ascii") as file:
            file.write(f"{point['x']} {point['y']} {os.getpid()}\n")
        value = self.factor * math.sin(point.number("x")) / point.number("y")
        return {
            "value": value,
            "label": "large one" if value > 0.1 else "small",
            "count": int(10 * value),
            "odd": int(point.number("x")) % 2 == 1,
        }


@dataclass(frozen=True, kw_only=True)
class Sometimes(Result):
    """A result with entries that are nothing, or a list, at some points."""

    count: int | None
    odd: bool | None
    reason: str | None
    basin: list[float] | None
    never: float | None = None


def sometimes(point: Point) -> Sometimes:
    known = point["x"] in (1, 3)
    return Sometimes(
        count=int(point.number("x")) if known else None,
        odd=True if known else None,
        reason='one, "twice"' if known else None,
        basin=[0.0, 1.0] if point["x"] == 3 else None,
    )


@dataclass(frozen=True)
class Later:
    """`sometimes`, which fails at the last point until the file ``mark`` is there."""

    mark: str

    def __call__(self, point: Point) -> Sometimes:
        if point["x"] == 3 and not Path(self.mark).exists():
            raise ZeroDivisionError("not yet")
        return sometimes(point)


def kinetic(point: Point) -> Result:
    from fronts.piecewise.kinetic_relation import kinetic_relation

    return kinetic_relation(c=point.number("c"), eta=point.number("eta"))


def failing(point: Point) -> dict[str, float]:
    if point.number("x") in (2, 5):
        raise ZeroDivisionError("no such point")
    return {"value": point.number("x")}


def dying(point: Point) -> dict[str, float]:
    if point.number("x") == 4:
        os._exit(9)
    return {"value": point.number("x")}


@dataclass(frozen=True)
class Killed:
    """Kill the process in the middle of the sweep, once: ``mark`` says that it has happened."""

    mark: str

    def __call__(self, point: Point) -> dict[str, float]:
        time.sleep(0.02)
        if point.number("x") == 5 and not Path(self.mark).exists():
            Path(self.mark).touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return {"value": math.sin(point.number("x")) / point.number("y")}


@dataclass(frozen=True)
class Area:
    """Number and word over two axes; a line a call goes into ``log``."""

    log: str

    def __call__(self, point: Point) -> dict[str, float | str]:
        with Path(self.log).open("a", encoding="ascii") as file:
            file.write(f"{point['x']} {point['y']} {os.getpid()}\n")
        side = "high" if point.number("y") >= 0.5 else "low"
        return {"area": point.number("x") * point.number("y"), "side": side}


@dataclass(frozen=True)
class Shapes:
    """Arrays of two shapes beside a number and a word; a line a call goes into ``log``."""

    log: str
    ragged: bool = False

    def __call__(self, point: Point) -> dict[str, object]:
        with Path(self.log).open("a", encoding="ascii") as file:
            file.write(f"{point['x']} {point['y']} {os.getpid()}\n")
        x, y = point.number("x"), point.number("y")
        sites = 4 if self.ragged and (x, y) == (3.0, 2.5) else 3
        return {
            "profile": np.sin(x * np.arange(1, sites + 1)) / y,
            "counts": [[int(x), 1], [2, int(10 * y)]],
            "label": "large" if x > 5 else "small",
        }


def value(point: Point) -> dict[str, float | str]:
    return {"value": 1.0 / (0.1 + point.number("x")), "label": "small" * 20}


POINTS = Grid({"x": range(1, 11), "y": [1.5, 2.5]})


def main(out: str, log: str, workers: str) -> None:
    sweep(Slow(log, 0.1), POINTS, out=Path(out), workers=int(workers), resume=True)


def capped(point: Point, cap: Any) -> dict[str, float]:
    """Return the sign of a parameter of the function."""
    return {"sign": float(np.copysign(1.0, np.real(cap)))}


@dataclass(frozen=True, kw_only=True)
class Unbounded(Result):
    """A number of which no error is known."""

    value: float
    error: float


def unbounded(point: Point) -> Unbounded:
    """Return a result with an infinite error."""
    return Unbounded(value=point.number("c"), error=math.inf)
