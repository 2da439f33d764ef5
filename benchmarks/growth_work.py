"""The kinds of work whose cost is measured at increasing sizes, with the expected exponents."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from theory.chains.friction import FrictionChain
from theory.chains.vdp import VdpChain
from theory.piecewise.branch_search import all_velocities
from theory.piecewise.sums.integral import sum_by_integral
from theory.piecewise.sums.precise import precise_sum_by_integral
from theory.piecewise.sums.series import sum_by_roots
from verification.execution.sweep import sweep
from verification.maps.task import StateTask, state_points
from verification.maps.vdp_rules import FIGURE_15
from verification.runs.excite import excite, excite_edge
from verification.runs.simulate import simulate


@dataclass(frozen=True)
class Work:
    """One kind of work.

    Attributes
    ----------
    name, size_name : str
        What is done, and what its size denotes.
    work : callable
        Function of the size that does the work.
    quick, full : tuple of float
        Sizes in a quick and in a full run, ascending.
    expected : float or None
        Exponent of time that the method should have; None if none follows from the method.
    why : str
        Reason for the expected exponent.
    remark : str
        Why the fitted exponent differs from it, where it does.
    repeats : int
        Number of calls of which the least time counts.
    wall : bool
        Whether wall-clock time is measured, for work in several processes.
    """

    name: str
    size_name: str
    work: Callable[[float], object]
    quick: tuple[float, ...]
    full: tuple[float, ...]
    expected: float | None
    why: str
    repeats: int = 2
    wall: bool = False
    remark: str = ""


def front(sites: float, *, behind: int = 24, full: bool = False) -> object:
    """Let a front of (43), or of (8) if ``full``, run through a chain of this length."""
    n = int(sites)
    chain = VdpChain(a=4.0, b=0.5, c=0.6, sites=n)
    filled = min(24, n // 2)
    return simulate(
        chain if full else chain.averaged(), excite_edge(chain, filled), n / 0.72 / chain.eps,
        tolerance=1e-6 if full else 1e-9, trailing_sites=min(behind, filled),
        estimate_error=False, samples=2,
    )  # fmt: skip


def friction_front(sites: float) -> object:
    chain = FrictionChain(c=0.05, sites=int(sites))
    return simulate(
        chain, excite(chain, [1]), sites / 0.0438, tolerance=1e-6, samples=2, estimate_error=False
    )


def friction_sites(sites: float) -> object:
    """Integrate a chain from random initial positions to τ = 20."""
    rng, n = np.random.default_rng(1), int(sites)
    start = np.array([rng.uniform(-1.0, 2.0, n), rng.uniform(-1.0, 1.0, n)])
    return simulate(FrictionChain(c=0.02, sites=n), start, 20.0, samples=2, estimate_error=False)


def series(digits: float) -> object:
    return sum_by_roots("0.3", "0.5", int(digits))


def integral(digits: float) -> object:
    return precise_sum_by_integral("0.3", "0.5", int(digits))


def slow_sum(inverse: float) -> object:
    return sum_by_integral(1.0 / inverse, 0.5)


def slow_front(inverse: float) -> object:
    """Solve for every v at which |Σ| equals its value at v = 1/inverse."""
    target = abs(sum_by_integral(1.0 / inverse, 0.5).value)
    return all_velocities(np.array([0.5]), np.array([target]))


def state_map(points: float, workers: float = 1, *, full: bool = False) -> object:
    """Compute a square map of the states of (43), or of (8) if ``full``."""
    side = math.isqrt(int(points))
    etas, couplings = np.linspace(0.01, 0.14, side), np.linspace(0.05, 1.0, side)
    task = StateTask(chain=FIGURE_15 if full else FIGURE_15.averaged())
    plane = state_points(task, {"eta": etas.tolist(), "c": couplings.tolist()})
    return sweep(task, plane, workers=int(workers))


WORKS = (
    Work(
        "front of (43), moving window", "sites", front, (10, 100, 1000, 3000),
        (10, 30, 100, 300, 1000, 3000, 10_000, 30_000, 100_000), 1.0,
        "the crossing time grows as N, the window is constant",
    ),
    Work(
        "front of (8), moving window", "sites", partial(front, full=True), (10, 100, 300),
        (10, 30, 100, 300, 1000, 3000, 10_000), 1.0,
        "the crossing time grows as N, the window is constant",
    ),
    Work(
        "front of (43), all sites", "sites", partial(front, behind=0), (50, 100, 200),
        (50, 100, 200, 400, 800, 1600), 2.0, "the crossing time and the number of sites grow as N",
    ),
    Work(
        "front of (5)", "sites", friction_front, (20, 40, 80),
        (20, 40, 80, 160, 320, 640, 1000), 2.0,
        "the crossing time grows as N and all sites behind continue to switch: N² events, each "
        "of which "
        "asks for new series at a few sites",
        remark="for few sites the constant cost of a frame is not negligible",
    ),
    Work(
        "random sites of (5)", "sites", friction_sites, (100, 300, 1000),
        (100, 300, 1000, 3000, 10_000), 1.0,
        "each event asks for new series at a few sites, however many there are",
    ),
    Work(
        "sum by the series", "digits", series, (15, 30, 60), (15, 30, 60, 120, 250), 3.0,
        "as many roots as digits, and Taylor products of as many terms: two powers, and the "
        "length of the numbers",
        remark="numbers of a few hundred digits are a few machine words long: what an "
        "operation costs hardly grows yet",
    ),
    Work(
        "sum by the integral, many digits", "digits", integral, (15, 30, 60),
        (15, 30, 60, 120, 250, 500), 2.0,
        "as many points as digits, each an exponential of so many digits",
        remark="as above; the exponent still rises with the digits",
    ),
    Work(
        "sum by the integral, double", "1/v", slow_sum, (1, 10, 100, 1000, 10_000),
        (1, 1e2, 1e4, 1e6, 1e8), 0.0, "the strip of analyticity stays open as v falls", 20,
    ),
    Work(
        "velocities near pinning", "1/v", slow_front, (3, 6, 12), (3, 6, 12, 24, 48), 1.0,
        "|Σ| oscillates in 1/v, and every oscillation is examined",
        remark="the overhead of arrays dominates; smaller v cannot be used, since below v = 1/54 "
        "|Σ| is flat to rounding",
    ),
    Work(
        "map of states, averaged, one worker", "points", state_map, (4, 16, 64),
        (16, 64, 256, 1024, 4096), 1.0, "the points are independent",
    ),
    Work(
        "map of states, averaged, 4096 points", "workers", partial(state_map, 4096),
        (1, 2), (1, 2), -1.0,
        "half the points per worker", 1, True,
        "a point takes a millisecond, and starting workers and transferring points cost more",
    ),
    Work(
        "map of states, (8), 144 points", "workers",
        partial(state_map, 144, full=True), (1, 2), (1, 2), -1.0,
        "half the points per worker", 1, True,
        "each worker takes a second to start, and the cores share their memory",
    ),
)  # fmt: skip
"""All kinds of work."""
