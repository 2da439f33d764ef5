"""The front velocity v̂(c, η) of Eq. (54) beside what a user would put together for one branch.

The value is the fastest branch. scipy's ``brentq`` over ``quad`` and over the printed series cut
off, and mpmath's ``findroot`` over the series with its tail, are told an interval that holds this
root and no other, or a start near it; ours are told nothing and return every branch. The references
are the two 30-digit evaluations of Σ, each with a secant of mpmath; methods on the integral are
held against the series and the other way round.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from time import process_time
from typing import TYPE_CHECKING, Any

import mpmath as mp
import numpy as np

from benchmarks.quantity import Quantity, Tell
from benchmarks.record import Failure, Record, WorkPoint, stamped
from benchmarks.runner import Answer, Contender, Effort, distance, measure_side_by_side
from theory.cells.vdp import threshold_ratio
from theory.piecewise.branch_search import all_velocities
from theory.piecewise.kinetic_relation import kinetic_relation, trace_kinetic_relation
from theory.piecewise.roots import labelled_roots
from theory.piecewise.sums.precise import precise_sum_by_integral
from theory.piecewise.sums.series import sum_by_roots
from verification.quantities.scenes import timed

if TYPE_CHECKING:
    from benchmarks.diagram import Style

ALL, BATCH, BARE = "kinetic relation", "kinetic relation, in a batch", "branches alone"
QUAD, CUT, SERIES = "brentq over quad", "brentq over the series cut off", "findroot over the series"
DIGITS = 30
MANY = 100


def measure(quick: bool, tell: Tell) -> Record:
    """Measure every method at every scene."""
    points: list[WorkPoint] = []
    failures: list[Failure] = []
    agreement = {}
    effort = Effort(0.1, 1, 9, 0.5, 10.0) if quick else Effort(1.0, 3, 51, 2.0, 30.0)
    for scene in timed("velocity")[: 2 if quick else None]:
        name = scene.name
        tell(f"velocity at the scene {name}")
        c, eta = scene.values["c"], scene.values["eta"]
        bracket = interval(c, eta)
        by_series, by_integral = references(c, eta, bracket)
        agreement[name] = distance(by_series, by_integral)
        rows = [
            each
            for each in contenders(c, eta, bracket, by_series, by_integral)
            if each.quick or not quick
        ]
        done, failed = measure_side_by_side("velocity", name, rows, effort, process_time)
        points += done
        failures += failed
    command = "fronts bench velocity" + " --quick" * quick
    return stamped(command, agreement, points, failures)


def interval(c: float, eta: float) -> tuple[float, float, float]:
    """Return an interval with the fastest branch and no other one, and a start near it."""
    found = kinetic_relation(c, eta).branches
    fastest = found[-1].v
    low = 0.5 * fastest if len(found) == 1 else 0.5 * (found[-2].v + fastest)
    return low, 1.5 * fastest, 1.01 * fastest


def references(c: float, eta: float, bracket: tuple[float, float, float]) -> tuple[Any, Any]:
    """Return the velocity to 30 digits, by the series and by the integral."""
    near = bracket[2]

    def solve(total: Callable[..., Any]) -> Any:
        with mp.workdps(DIGITS + 5):
            target = 2 * exact_ratio(eta)
            return mp.findroot(
                lambda v: abs(total(v, mp.mpf(c), DIGITS).value) - target,
                (mp.mpf(near) / mp.mpf("1.01"), mp.mpf(near)),
                solver="secant",
                tol=mp.mpf(10) ** (-2 * DIGITS + 10),
                verify=False,
            )

    return solve(sum_by_roots), solve(precise_sum_by_integral)


def exact_ratio(eta: float) -> Any:
    """Return r(η) = |φ_us|/|φ_s| at the current precision."""
    root = mp.sqrt(1 - 8 * mp.mpf(eta))
    return mp.sqrt((1 - root) / (1 + root))


def contenders(
    c: float, eta: float, bracket: tuple[float, float, float], by_series: Any, by_integral: Any
) -> Iterator[Contender]:
    """Yield every method at every setting."""
    yield Contender(ALL, "as it is", partial(_relation, c, eta), by_series)
    yield Contender(BATCH, f"{MANY} couplings", partial(_batch, c, eta), by_series, MANY)
    for refine in (1.0, 4.0):
        yield Contender(
            BARE, f"first points divided by {refine:g}", partial(_bare, c, eta, refine), by_series
        )
    for k in (4, 8, 12):
        yield Contender(
            QUAD, f"tolerance 1e-{k}", partial(_by_quad, c, eta, bracket, 10.0**-k), by_series,
            quick=k < 9, peer=True,
        )  # fmt: skip
    for count in (21, 201, 2001):
        yield Contender(
            CUT, f"{count} roots", partial(_cut_off, c, eta, bracket, count), by_integral, peer=True
        )
    for digits in (6, 10, 15, 25):
        yield Contender(
            SERIES, f"{digits} digits", partial(_by_series, c, eta, bracket, digits), by_integral,
            quick=digits < 12, peer=True,
        )  # fmt: skip


def _relation(c: float, eta: float) -> Answer:
    branch = kinetic_relation(c, eta).branches[-1]
    return Answer(branch.v, branch.error)


def _batch(c: float, eta: float) -> Answer:
    """Return the first of many couplings that go up by one per cent."""
    many = trace_kinetic_relation(c * np.geomspace(1.0, 1.01, MANY), eta)
    return Answer(many[0].branches[-1].v, many[0].branches[-1].error)


def _bare(c: float, eta: float, refine: float) -> Answer:
    found = all_velocities(np.array([c]), np.array([2.0 * threshold_ratio(eta)]), refine=refine)
    return Answer(float(found.v[-1]), float(found.error[-1]))


def _by_quad(c: float, eta: float, bracket: tuple[float, float, float], tolerance: float) -> Answer:
    import math

    from scipy.integrate import quad
    from scipy.optimize import brentq

    target = 2.0 * threshold_ratio(eta)

    def relation(v: float) -> float:
        def integrand(k: float) -> complex:
            onsite = 0.5 - 1j * c * (1.0 - math.cos(k))
            return 1.0 / (onsite * onsite + v * v * k * k)

        value, _ = quad(
            integrand, 0.0, math.inf, complex_func=True, epsabs=0.1 * tolerance, epsrel=0.0,
            limit=2000,
        )  # fmt: skip
        return abs(complex(value) * v / math.pi - 1.0) - target

    return Answer(float(brentq(relation, *bracket[:2], xtol=tolerance)), None)


def _cut_off(c: float, eta: float, bracket: tuple[float, float, float], count: int) -> Answer:
    from scipy.optimize import brentq

    target = 2.0 * threshold_ratio(eta)
    labels = np.arange(count) - count // 2

    def relation(v: float) -> float:
        k = labelled_roots(float(v), c, labels, upper=True).k
        return float(abs(np.sum(1.0 / (-1j * k * (v + c * np.sin(k)))))) - target

    return Answer(float(brentq(relation, *bracket[:2], xtol=1e-13)), None)


def _by_series(c: float, eta: float, bracket: tuple[float, float, float], digits: int) -> Answer:
    with mp.workdps(digits + 5):
        target = 2 * exact_ratio(eta)
        value = mp.findroot(
            lambda v: abs(sum_by_roots(v, mp.mpf(c), max(digits, 16)).value) - target,
            mp.mpf(bracket[2]),
            tol=mp.mpf(10) ** (-2 * digits),
            verify=False,
        )
    return Answer(value, None)


def style() -> Style:
    """Return how the diagram is drawn."""
    from benchmarks.diagram import Style

    return Style(
        "error of v (right is better)",
        "processor seconds a velocity",
        "Error against run time of the front velocity. Ours return every branch; the others were "
        "told an interval with one. Grey: not a velocity.",
        {
            ALL: ("blue", "o"),
            BATCH: ("blue", "P"),
            BARE: ("sky", "o"),
            QUAD: ("orange", "v"),
            CUT: ("vermilion", "x"),
            SERIES: ("green", "^"),
        },
        0.1,
        1e-30,
    )


_ONE = "one branch in an interval that it is told; the default finds all branches, told nothing"

BENCHMARK = Quantity(
    "velocity",
    "front velocity of Eq. (54)",
    ALL,
    (1e-12, 1e-2),
    measure,
    style,
    (BATCH, BARE),
    {QUAD: _ONE, CUT: _ONE, SERIES: _ONE},
    first={
        ALL: partial(kinetic_relation, 0.5, 0.03125),
        QUAD: partial(_by_quad, 0.5, 0.03125, (0.15, 0.45, 0.3), 1e-8),
    },
)
