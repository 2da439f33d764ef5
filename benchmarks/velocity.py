"""The front velocity v̂(c, η) of Eq. (54), compared with what a user would write for one branch.

The value is the velocity of the fastest branch. scipy's ``brentq`` with ``quad`` or with the
truncated printed series, and mpmath's ``findroot`` with the series and its tail, are given an
interval that contains this root and no other, or an initial value near it; our methods are given
nothing and return every branch. The references are the two evaluations of Σ to 30 digits, each
with mpmath's secant method; methods based on the integral are compared with the series, and
methods based on the series with the integral.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import mpmath as mp
import numpy as np

from benchmarks.work_precision import (
    Effort,
    MethodAnswer,
    Prepared,
    Report,
    Setting,
    Style,
    WorkPrecision,
    distance,
)
from theory.cells.vdp import threshold_ratio
from theory.piecewise.branch_search import all_velocities
from theory.piecewise.kinetic_relation import kinetic_relation, trace_kinetic_relation
from theory.piecewise.roots import labelled_roots
from theory.piecewise.sums.precise import precise_sum_by_integral
from theory.piecewise.sums.series import sum_by_roots
from verification.quantities.problems import Problem
from verification.references import piecewise

ALL, BATCH, BARE = "kinetic relation", "kinetic relation, in a batch", "branches alone"
QUAD, CUT, SERIES = "brentq over quad", "brentq over the series cut off", "findroot over the series"
DIGITS = 30
MANY = 100

Interval = tuple[float, float, float]
"""The two ends of an interval, and an initial value near the root between them."""


def prepare(problem: Problem, quick: bool, report: Report) -> Prepared:
    """Return the settings of all methods and the agreement of the two references."""
    c, eta = problem.c, problem["eta"]
    bracket = interval(c, eta)
    by_series, by_integral = references(c, eta, bracket)
    settings = [*_ours(c, eta, by_series), *_peers(c, eta, bracket, by_series, by_integral)]
    return Prepared(agreement=distance(by_series, by_integral), settings=settings)


def interval(c: float, eta: float) -> Interval:
    """Return an interval with the fastest branch and no other, and an initial value near it."""
    found = kinetic_relation(c, eta).branches
    fastest = found[-1].v
    low = 0.5 * fastest if len(found) == 1 else 0.5 * (found[-2].v + fastest)
    return low, 1.5 * fastest, 1.01 * fastest


def references(c: float, eta: float, bracket: Interval) -> tuple[Any, Any]:
    """Return the velocity to 30 digits, by the series and by the integral."""
    near = bracket[2]

    def solve(total: Callable[..., Any]) -> Any:
        with mp.workdps(DIGITS + 5):
            target = 2 * piecewise.threshold_ratio(eta)
            return mp.findroot(
                lambda v: abs(total(v, mp.mpf(c), DIGITS).value) - target,
                (mp.mpf(near) / mp.mpf("1.01"), mp.mpf(near)),
                solver="secant",
                tol=mp.mpf(10) ** (-2 * DIGITS + 10),
                verify=False,
            )

    return solve(sum_by_roots), solve(precise_sum_by_integral)


def _ours(c: float, eta: float, true: Any) -> Iterator[Setting]:
    yield Setting(method=ALL, knob="as it is", evaluate=partial(_relation, c, eta), reference=true)
    yield Setting(
        method=BATCH, knob=f"{MANY} couplings", evaluate=partial(_batch, c, eta), reference=true,
        batch=MANY,
    )  # fmt: skip
    for refine in (1.0, 4.0):
        yield Setting(
            method=BARE, knob=f"first points divided by {refine:g}",
            evaluate=partial(_bare, c, eta, refine), reference=true,
        )  # fmt: skip


def _peers(
    c: float, eta: float, bracket: Interval, by_series: Any, by_integral: Any
) -> Iterator[Setting]:
    for k in (4, 8, 12):
        yield Setting(
            method=QUAD, knob=f"tolerance 1e-{k}", reference=by_series, quick=k < 9, peer=True,
            evaluate=partial(_by_quad, c, eta, bracket, 10.0**-k),
        )  # fmt: skip
    for count in (21, 201, 2001):
        yield Setting(
            method=CUT, knob=f"{count} roots", reference=by_integral, peer=True,
            evaluate=partial(_cut_off, c, eta, bracket, count),
        )  # fmt: skip
    for digits in (6, 10, 15, 25):
        yield Setting(
            method=SERIES, knob=f"{digits} digits", reference=by_integral, quick=digits < 12,
            peer=True, evaluate=partial(_by_series, c, eta, bracket, digits),
        )  # fmt: skip


def _relation(c: float, eta: float) -> MethodAnswer:
    branch = kinetic_relation(c, eta).branches[-1]
    return MethodAnswer(value=branch.v, claimed=branch.error)


def _batch(c: float, eta: float) -> MethodAnswer:
    """Return v at the first coupling of a batch that spans one per cent."""
    branch = trace_kinetic_relation(c * np.geomspace(1.0, 1.01, MANY), eta)[0].branches[-1]
    return MethodAnswer(value=branch.v, claimed=branch.error)


def _bare(c: float, eta: float, refine: float) -> MethodAnswer:
    found = all_velocities(np.array([c]), np.array([2.0 * threshold_ratio(eta)]), refine=refine)
    return MethodAnswer(value=float(found.v[-1]), claimed=float(found.error[-1]))


def _by_quad(c: float, eta: float, bracket: Interval, tolerance: float) -> MethodAnswer:
    from scipy.optimize import brentq

    target = 2.0 * threshold_ratio(eta)

    def relation(v: float) -> float:
        # The tolerance of Σ is that of the integral times v/π.
        value, _ = piecewise.sum_by_quadrature(v, c, 0.1 * tolerance, 2000)
        return abs(value) - target

    return MethodAnswer(value=float(brentq(relation, *bracket[:2], xtol=tolerance)))


def _cut_off(c: float, eta: float, bracket: Interval, count: int) -> MethodAnswer:
    from scipy.optimize import brentq

    target = 2.0 * threshold_ratio(eta)
    labels = np.arange(count) - count // 2

    def relation(v: float) -> float:
        k = labelled_roots(float(v), c, labels, upper=True).k
        return float(abs(np.sum(1.0 / (-1j * k * (v + c * np.sin(k)))))) - target

    return MethodAnswer(value=float(brentq(relation, *bracket[:2], xtol=1e-13)))


def _by_series(c: float, eta: float, bracket: Interval, digits: int) -> MethodAnswer:
    with mp.workdps(digits + 5):
        target = 2 * piecewise.threshold_ratio(eta)
        value = mp.findroot(
            lambda v: abs(sum_by_roots(v, mp.mpf(c), max(digits, 16)).value) - target,
            mp.mpf(bracket[2]),
            tol=mp.mpf(10) ** (-2 * digits),
            verify=False,
        )
    return MethodAnswer(value=value)


_ONE = "one branch in a given interval; the default finds all branches without one"

BENCHMARK = WorkPrecision(
    name="velocity",
    prepare=prepare,
    effort=Effort(limit=30.0),
    quick_effort=Effort(seconds=0.1, min_repeats=1, max_repeats=9, once_from=0.5, limit=10.0),
    quick_problems=2,
    style=Style(
        xlabel="error of v (right is better)",
        ylabel="processor seconds per velocity",
        caption="Error against run time of the front velocity. Our methods return every branch; "
        "the others were given an interval with one. Grey: not a velocity.",
        methods={
            ALL: ("blue", "o"),
            BATCH: ("blue", "P"),
            BARE: ("sky", "o"),
            QUAD: ("orange", "v"),
            CUT: ("vermilion", "x"),
            SERIES: ("green", "^"),
        },
        garbage=0.1,
        floor=1e-30,
    ),
    variants=(BATCH, BARE),
    others={QUAD: _ONE, CUT: _ONE, SERIES: _ONE},
    first={
        ALL: partial(kinetic_relation, 0.5, 0.03125),
        QUAD: partial(_by_quad, 0.5, 0.03125, (0.15, 0.45, 0.3), 1e-8),
    },
)
