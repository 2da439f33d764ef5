"""Time that the explorer takes for an update: ``python -m fronts.explore.update_time``.

An update computes what changes on the page when the coupling is varied: the point on the curve, the
shape of the front, the simulation of the chain, and the breather with its multipliers. The curve,
which is computed once for each η, and the map, which is computed only once, are not included. Times
are processor times.
"""

from __future__ import annotations

import argparse
from dataclasses import asdict, dataclass
from pathlib import Path
from statistics import median
from time import process_time

from fronts.explore.calls import MODELS, SLOW, Settings, calls, outcome
from verification.execution.imports import SOURCES
from verification.execution.metadata import Code, Metadata
from verification.execution.record import Record

COUPLINGS = tuple(round(0.01 * n, 2) for n in (*range(1, 26), *range(30, 101, 5)))
"""Couplings of the measurement, dense where there is a breather and near its fold."""
PACKAGES = (*SOURCES, "fronts")
RECORD = Path(__file__).parents[2] / "benchmarks" / "results" / "explorer.json"
"""File for the record, in the source tree."""


@dataclass(frozen=True, kw_only=True)
class UpdateTime:
    """Processor time of an update, for couplings that the page has not shown before.

    Attributes
    ----------
    median_ms, largest_ms : float
        Median and largest time, in milliseconds.
    slowest_c : float
        Coupling at which the update took longest.
    """

    median_ms: float
    largest_ms: float
    slowest_c: float


def measure(model: str, couplings: tuple[float, ...] = COUPLINGS) -> UpdateTime:
    """Measure updates for one model of the chain, after two updates that compile the code.

    Examples
    --------
    >>> found = measure("averaged", (0.3, 0.4))
    >>> 0.0 < found.median_ms <= found.largest_ms, found.slowest_c in (0.3, 0.4)
    (True, True)
    """
    for c in (0.12, 0.52):  # with a breather, and beyond its fold
        _seconds_of_update(Settings(c=c, model=model))
    taken = {c: 1e3 * _seconds_of_update(Settings(c=c, model=model)) for c in couplings}
    slowest = max(taken, key=lambda c: taken[c])
    return UpdateTime(
        median_ms=median(taken.values()), largest_ms=taken[slowest], slowest_c=slowest
    )


def _seconds_of_update(settings: Settings) -> float:
    begun = process_time()
    for name, call in calls(settings).items():
        if name not in SLOW:
            outcome(call)
    return process_time() - begun


def main() -> None:
    """Measure the times, print them, and store them if requested."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--record", action="store_true", help=f"into {RECORD.name}")
    options = parser.parse_args()
    found = {model: measure(model) for model in MODELS}
    for model, taken in found.items():
        print(
            f"{model}: {taken.median_ms:.0f} ms, at most {taken.largest_ms:.0f} ms "
            f"at c = {taken.slowest_c:g}"
        )
    if options.record:
        metadata = Metadata(
            command="python -m fronts.explore.update_time",
            code=Code.of(("fronts.explore.calls",), PACKAGES),
        )
        content = {"updates": {model: asdict(taken) for model, taken in found.items()}}
        Record(kind="explorer", content=content, metadata=metadata).save(RECORD)


if __name__ == "__main__":
    main()
