"""One point of the robustness table: compute, compare with another method, classify the outcome."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from theory.parameters import ParameterError, RunError
from theory.piecewise.sums.result import PrecisionError
from verification.execution.columns import Scalar
from verification.execution.points import Point
from verification.execution.time_limit import TimeIsUpError, time_limit
from verification.quantities.quantity import (
    MAX_UNCERTAINTY,
    Computation,
    ReferenceCheck,
    StatedValue,
)
from verification.quantities.registry import computation_named
from verification.references import pace
from verification.references.pace import NoReferenceError

SLACK = 5.0
"""Multiple of its time limit after which a value is abandoned."""
SLOWNESS = 1.0
"""Factor on all time limits, for machines slower than the one for which they were set."""


class PointOutcome(StrEnum):
    """The outcome of one point."""

    RIGHT = "right"
    """Within the stated error."""

    REFUSED = "refused"
    """Refused with one sentence that says why and what to do."""

    UNDECIDED = "undecided"
    """Not refuted, but the reference is too uncertain to confirm; see `MAX_UNCERTAINTY`."""

    UNCHECKED = "unchecked"
    """A finite value with an error, but no other method to compare it with."""

    EXCEEDED = "exceeded"
    """Farther from the reference than the stated error."""

    NAN = "nan"
    CRASH = "crash"
    SLOW = "slow"


BAD = (PointOutcome.EXCEEDED, PointOutcome.NAN, PointOutcome.CRASH, PointOutcome.SLOW)
"""Outcomes that must not occur."""


@dataclass(frozen=True)
class RobustnessTask:
    """The task of the sweep; a point is specified by a computation and a number.

    Attributes
    ----------
    seed : int
        Seed of the random points.
    """

    seed: int = 0

    def __call__(self, point: Point) -> Mapping[str, Scalar]:
        """Return the parameters, the outcome and the data on which it is based."""
        computation = computation_named(str(point["quantity"]))
        values = computation.point(self.seed, int(point["number"]))
        found = judge(computation, values)
        return {
            "values": " ".join(f"{name}={value!r}" for name, value in values.items()),
            **found,
        }


def judge(computation: Computation, values: Mapping[str, float]) -> dict[str, Scalar]:
    """Return outcome, stated error, distance, uncertainty and name of the reference, seconds.

    Times are processor times, so that the other load of the machine does not affect the outcome.
    """
    begin, limit = time.process_time(), SLOWNESS * computation.seconds

    def spent() -> float:
        return time.process_time() - begin

    try:
        with time_limit(SLACK * limit, of_processor=True):
            stated = computation.compute(values)
    except TimeIsUpError:
        return _row(PointOutcome.SLOW, "given up", seconds=spent())
    except (ParameterError, PrecisionError, RunError) as error:
        clear = is_clear(str(error))
        return _row(
            PointOutcome.REFUSED if clear else PointOutcome.CRASH, str(error), seconds=spent()
        )
    except Exception as error:
        return _row(PointOutcome.CRASH, f"{type(error).__name__}: {error}", seconds=spent())
    seconds = spent()
    if not _finite(stated):
        return _row(
            PointOutcome.NAN, f"{stated.value} with error {stated.error}", stated, seconds=seconds
        )
    if seconds > limit:
        return _row(PointOutcome.SLOW, f"limit {limit:g} s", stated, seconds=seconds)
    try:
        with time_limit(pace.MAX_SECONDS, of_processor=True):
            check = computation.check(values, stated)
    except (NoReferenceError, ParameterError, PrecisionError, TimeIsUpError) as error:
        return _row(PointOutcome.UNCHECKED, str(error), stated, seconds=seconds)
    except Exception as error:  # a defect of the table itself
        said = f"in the reference: {type(error).__name__}: {error}"
        return _row(PointOutcome.CRASH, said, stated, seconds=seconds)
    return _row(compared(stated.error, check), stated.note, stated, check, seconds=seconds)


def compared(error: float, check: ReferenceCheck) -> PointOutcome:
    """Return the outcome for a stated error according to a reference.

    Examples
    --------
    >>> [
    ...     str(compared(1.0, ReferenceCheck(distance=d, uncertainty=u, method="another")))
    ...     for d, u in ((1.4, 0.5), (0.1, 0.6), (1.7, 0.6))
    ... ]
    ['right', 'undecided', 'exceeded']
    """
    if not check.distance <= error + check.uncertainty:
        return PointOutcome.EXCEEDED
    return (
        PointOutcome.RIGHT
        if check.uncertainty <= MAX_UNCERTAINTY * error
        else PointOutcome.UNDECIDED
    )


def is_clear(message: str) -> bool:
    """Return whether a refusal is a single sentence of at most three hundred characters.

    Examples
    --------
    >>> is_clear("eta = 0.2 is too large; take less."), is_clear("")
    (True, False)
    """
    return 20 < len(message) < 300 and message.endswith(".") and "\n" not in message


def _finite(stated: StatedValue) -> bool:
    if not math.isfinite(stated.error) or stated.error < 0:
        return False
    if stated.value is None:
        return True
    if hasattr(stated.value, "ae"):  # an mpmath number
        return math.isfinite(abs(complex(stated.value)))
    return bool(np.all(np.isfinite(stated.value)))


def _row(
    outcome: PointOutcome,
    said: str,
    stated: StatedValue | None = None,
    check: ReferenceCheck | None = None,
    *,
    seconds: float,
) -> dict[str, Scalar]:
    return {
        "outcome": str(outcome),
        "stated": stated.error if stated else math.nan,
        "distance": check.distance if check else math.nan,
        "uncertainty": check.uncertainty if check else math.nan,
        "by": _for_csv(check.method) if check else "-",
        "seconds": seconds,
        "said": _for_csv(said) or "-",
    }


def _for_csv(said: str) -> str:
    """Return a text without characters that a table of comma-separated values would misread."""
    return " ".join("".join("'" if x == '"' else ";" if x in ",#" else x for x in said).split())
