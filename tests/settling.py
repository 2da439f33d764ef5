"""Measurements of fronts whose runs are made up."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from verification.fronts.preparation import FrontPreparation, Settled, Trial
from verification.runs.integration import Integration


def prepared(begin: Callable[[float], Any], kind: Any = FrontPreparation, **given: Any) -> Any:
    """Return a measurement whose runs are begun by a function of the tolerance."""
    usual = {
        "excited": 5, "sites": 40, "max_sites": 40, "accuracy": 1e-3, "tolerance": 1e-8,
        "stall_time": 10.0, "settling_tolerance": 1e-3, "kind": Integration,
    }  # fmt: skip
    return kind(sized=lambda _: None, begin=lambda _, each: begin(each), **usual | given)


def settle(trial: Callable[[int], Trial], *, pinned_error: float = 0.0, **given: Any) -> Settled:
    """Measure a front by the trials of a function, which is called with the number of sites."""

    class MadeUp(FrontPreparation):
        def trial(self, sites: int, progress: object) -> Trial:
            return trial(sites)

    stall_time = 1.0 / pinned_error if pinned_error else math.inf
    found: Settled = prepared(lambda _: None, MadeUp, stall_time=stall_time, **given).settled(None)
    return found
