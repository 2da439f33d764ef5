"""Work reduction of the process itself: workers that would not be used, libraries that are not."""

from __future__ import annotations

import json
import subprocess
import sys
from time import perf_counter

import numpy as np

from theory.piecewise.limits import pinning_coupling
from verification.execution.pool import worker_pool
from verification.execution.sweep import sweep
from verification.execution.table import Point, Scalar, grid
from verification.work_reduction.comparison import Comparison, timed

LIBRARIES = ("scipy.integrate", "sympy", "matplotlib.pyplot", "mpmath", "numba")
"""What ``fronts kinetic`` could import and does not."""
_ASKED = "['kinetic', '--c', '0.5', '--eta', '0.03125', '--json']"


def pinned(point: Point) -> dict[str, Scalar]:
    """Return c_pin at a point: a task as short as any."""
    return {"c_pin": pinning_coupling(point.number("eta")) or 0.0}


def no_more_workers_than_points(points: int = 1) -> Comparison:
    """Ask two workers for one point, which is computed here, and hand it to a process, in s."""
    asked = grid(eta=np.linspace(0.01, 0.05, points))
    here, spent = timed(lambda: sweep(pinned, asked, workers=2 if points == 1 else 1))
    begin = perf_counter()
    with worker_pool(2) as pool:
        there = sweep(pinned, asked, executor=pool)
    whole = perf_counter() - begin
    changed = float(np.abs(here["c_pin"] - there["c_pin"]).max())
    return Comparison(spent, whole, changed, 0.0)


def imports_not_made(times: int = 2) -> Comparison:
    """Ask ``fronts kinetic`` for one velocity, and again with every library imported first."""
    few, spent = timed(lambda: _velocity(()), times)
    many, whole = timed(lambda: _velocity(LIBRARIES), times)
    return Comparison(spent, whole, abs(few - many), 0.0)


def _velocity(libraries: tuple[str, ...]) -> float:
    code = f"from fronts.cli import main; raise SystemExit(main({_ASKED}))"
    first = "".join(f"import {library}; " for library in libraries)
    done = subprocess.run(
        [sys.executable, "-c", first + code], check=True, capture_output=True, text=True
    )
    return float(json.loads(done.stdout)["branches"][0]["v"])
