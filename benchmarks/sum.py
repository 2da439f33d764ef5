"""Σ(v, c) of Eq. (53): our methods, what a user would otherwise choose, and the promised speeds.

Methods based on the integral over k are compared with the series over the roots at 60 digits, and
methods based on the series with the integral. The other programs are one call of
``scipy.integrate.quad``, and cxroots (argument principle, subdivided boxes, Newton), an optional
extra, which is given the derivative and a box known to contain the roots of consecutive labels and
no others.
"""

from __future__ import annotations

import logging
import math
import statistics
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import mpmath as mp
import numpy as np

from benchmarks.record import Relation, Target, WorkPoint
from benchmarks.work_precision import (
    Effort,
    MethodAnswer,
    Prepared,
    Report,
    Setting,
    Style,
    WorkPrecision,
    distance,
    ratio_target,
)
from theory.piecewise.kinetic_relation import KineticRelation, trace_kinetic_relation
from theory.piecewise.root_count import height_above_roots
from theory.piecewise.roots import labelled_roots
from theory.piecewise.sums.bessel import sum_by_bessel
from theory.piecewise.sums.integral import MANY, sum_by_integral, sums
from theory.piecewise.sums.precise import precise_sum_by_integral
from theory.piecewise.sums.quadrature import sum_by_quadrature
from theory.piecewise.sums.result import KineticSum
from theory.piecewise.sums.series import RootSeries, sum_by_roots, tail_sum
from verification.piecewise.simulation import simulate_front
from verification.quantities.problems import Problem
from verification.references import piecewise

DIGITS = 60
BATCH_SIZE = MANY
BATCH, ONE_CALL, PRECISE = "integral, in a batch", "integral, one call", "integral, many digits"
SERIES, CUT_OFF = "root series", "root series, cut off"
BESSEL, PIECES = "Bessel series", "quadrature in pieces"
QUAD, WITH_TAIL, WITHOUT_TAIL = "scipy.integrate.quad", "cxroots, our tail", "cxroots, cut off"
_TAIL_DIGITS, _MAX_TAIL_TERMS = 15, 24
_ETA = 0.03125
_SEED = 20
_ROOT = Path(__file__).resolve().parent.parent


class MissedRootError(ArithmeticError):
    """A root finder did not return exactly one root per strip."""


def prepare(problem: Problem, quick: bool, report: Report) -> Prepared:
    """Return the settings of all methods and the agreement of the two references."""
    v, c = problem.v, problem.c
    series, integral = sum_by_roots(v, c, DIGITS).value, precise_sum_by_integral(v, c, DIGITS).value
    settings = [*_integrals(v, c, series), *_series(v, c, integral), *_peers(v, c, integral)]
    return Prepared(agreement=distance(series, integral), settings=settings)


def _integrals(v: float, c: float, true: Any) -> Iterator[Setting]:
    for tolerance in (1e-2, 1e-4, 1e-8, 1e-12, 1e-15):
        knob = f"tolerance {tolerance:g}"
        yield Setting(
            method=BATCH, knob=knob, evaluate=partial(_batch, v, c, tolerance), reference=true,
            batch=BATCH_SIZE, quick=1e-14 < tolerance < 1e-6,
        )  # fmt: skip
        single = _ours(sum_by_integral, v, c, tolerance)
        yield Setting(method=ONE_CALL, knob=knob, evaluate=single, reference=true)
    for digits in (15, 30, 50):
        yield Setting(
            method=PRECISE, knob=f"{digits} digits", reference=true, quick=digits < 50,
            evaluate=_ours(precise_sum_by_integral, v, c, digits),
        )  # fmt: skip
    for tolerance in (1e-4, 1e-8, 1e-12):
        yield Setting(
            method=PIECES, knob=f"tolerance {tolerance:g}", reference=true, quick=tolerance > 1e-9,
            evaluate=_ours(sum_by_quadrature, v, c, tolerance),
        )  # fmt: skip


def _series(v: float, c: float, true: Any) -> Iterator[Setting]:
    for digits in (5, 10, 15, 30, 50):
        found = _ours(sum_by_roots, v, c, digits)
        yield Setting(method=SERIES, knob=f"{digits} digits", evaluate=found, reference=true)
    for roots in (100, 2_000, 50_000):
        yield Setting(
            method=CUT_OFF, knob=f"{roots} roots", reference=true, quick=roots < 50_000,
            evaluate=partial(_cut_off, v, c, roots),
        )  # fmt: skip
    for tolerance in (1e-4, 1e-8, 1e-12):
        yield Setting(
            method=BESSEL, knob=f"tolerance {tolerance:g}", reference=true, quick=c < 10.0,
            evaluate=_ours(sum_by_bessel, v, c, tolerance),
        )  # fmt: skip


def _peers(v: float, c: float, true: Any) -> Iterator[Setting]:
    for tolerance, limit in ((None, 50), (1e-8, 1_000), (1e-10, 10_000), (1e-12, 10_000)):
        knob = "defaults" if tolerance is None else f"tolerance {tolerance:g}, limit {limit}"
        evaluate = partial(_by_quad, v, c, tolerance, limit)
        yield Setting(method=QUAD, knob=knob, evaluate=evaluate, reference=true, peer=True)
    choices: tuple[tuple[str, dict[str, Any], tuple[int, ...]], ...] = (
        ("M=2", {"M": 2}, (1, 3, 6, 9)),
        ("romb, M=3", {"int_method": "romb", "M": 3}, (1, 3, 6)),
        ("defaults", {}, (1, 3)),
    )
    for name, options, reaches in choices:
        for reach in reaches:
            for tail in (True, False) if name == "M=2" else (True,):
                yield Setting(
                    method=WITH_TAIL if tail else WITHOUT_TAIL,
                    knob=f"{2 * reach + 1} roots, {name}",
                    evaluate=partial(_by_contour, v, c, reach, tail, options),
                    reference=true,
                    quick=reach == 1 and name == "M=2" and 0.1 < v < 1.0,
                    peer=True,
                )


def _ours(
    method: Callable[..., KineticSum], v: float, c: float, knob: float
) -> Callable[[], MethodAnswer]:
    def evaluate() -> MethodAnswer:
        result = method(v, c, knob)
        return MethodAnswer(value=result.value, claimed=result.error)

    return evaluate


def _batch(v: float, c: float, tolerance: float = 1e-12) -> MethodAnswer:
    """Return Σ(v, c), the first value of a batch whose velocities span one per cent."""
    many = sums(v * np.geomspace(1.0, 1.01, BATCH_SIZE), c, tolerance)
    return MethodAnswer(value=complex(many.value[0]), claimed=float(many.error[0]))


def _cut_off(v: float, c: float, count: int) -> MethodAnswer:
    """Return the printed series over ``count`` roots about the origin, without an error bound."""
    labels = np.arange(count) - count // 2
    k = labelled_roots(v, c, labels, upper=True).k
    return MethodAnswer(value=complex(np.sum(1.0 / (-1j * k * (v + c * np.sin(k))))))


def _by_quad(v: float, c: float, tolerance: float | None, limit: int) -> MethodAnswer:
    value, claimed = piecewise.sum_by_quadrature(v, c, tolerance, limit)
    return MethodAnswer(value=value, claimed=claimed)


def _by_contour(
    v: float, c: float, reach: int, tail: bool, options: Mapping[str, Any]
) -> MethodAnswer:
    """Return Σ from the roots that cxroots finds in the strips -reach … reach above the axis.

    With ``tail``, the terms beyond are added by the Euler–Maclaurin tail of
    ``theory.piecewise.sums.series``, here also at labels closer to the singularities than that
    module allows; hence no bound is stated. ``options`` are passed to cxroots: M = 2, at most two
    roots per box, is the fastest choice found, and romb is the quadrature that tolerates roots near
    the edge of the box.

    Raises
    ------
    MissedRootError
        If cxroots does not return exactly one root per strip.
    """
    from cxroots import Rectangle

    logging.getLogger("cxroots").setLevel(logging.ERROR)
    left, right = -2.0 * math.pi * reach - math.pi, 2.0 * math.pi * reach
    box = Rectangle((left, right), (0.0, height_above_roots(v, c, -left)))

    def slope(k: Any) -> Any:
        return piecewise.dispersion_slope(v, c, k, np.sin)

    found = box.roots(lambda k: piecewise.dispersion(v, c, k, np.cos), slope, **options)
    k = np.array(found.roots, dtype=complex)
    labels = np.ceil(k.real / (2.0 * math.pi)).astype(int)  # Re k from 2πn - π to 2πn
    required = np.arange(-reach, reach + 1)
    if not np.array_equal(np.sort(labels), required):
        raise MissedRootError(f"{k.size} roots found, {required.size} exist in the box")
    terms = 1.0 / (k * slope(k))
    if not tail:
        return MethodAnswer(value=complex(np.sum(terms)))
    terms = np.where(np.abs(labels) == reach, 0.5 * terms, terms)  # the tail has the other half
    with mp.workdps(_TAIL_DIGITS + 15):
        whole = RootSeries(mp.mpf(v), mp.mpf(c), 1)
        rest = [tail_sum(whole, side * reach, side, _MAX_TAIL_TERMS) for side in (-1, 1)]
        return MethodAnswer(value=complex(sum(part for part, _ in rest)) + complex(np.sum(terms)))


def targets(points: Sequence[WorkPoint], quick: bool, report: Report) -> tuple[Target, ...]:
    """Return the speeds promised for the piecewise-linear front, with their measurements."""
    report("promised speeds")
    problems = dict.fromkeys(point.problem for point in points)
    ratios = [row for problem in problems for row in ratio_targets(points, problem)]
    repeats = 3 if quick else 9
    return (
        _batch_target(quick),
        _corners(3 if quick else 9),
        _one_call(200 if quick else 2_000),
        *ratios,
        _curve(1 if quick else 5),
        _one_point(20 if quick else 200),
        _command(repeats),
        _timed_target(
            "2000 labelled roots", lambda: labelled_roots(0.3, 0.5, _LABELS, True), repeats, 0.05,
            "v = 0.3, c = 0.5, upper half-plane",
        ),
        _certified(1 if quick else 5),
        _simulation(repeats),
    )  # fmt: skip


_LABELS = np.arange(-1000, 1000)


def ratio_targets(points: Sequence[WorkPoint], problem: str) -> tuple[Target, ...]:
    """Return the factor by which the integral is faster than other programs at equal error.

    The promise concerned arrays; the ratio for a single call is reported as well.
    """
    here = [point for point in points if point.problem == problem]
    return tuple(
        ratio_target(
            f"{ours}, against {name}, {problem} problem, equal error",
            [point for point in here if point.method == ours],
            peers,
            errors=(0.0, math.inf),
            limit=limit if ours == BATCH else None,
        )
        for name, limit in ((QUAD, 200.0), (WITH_TAIL, 1e4), (WITHOUT_TAIL, 1e4))
        if (peers := [point for point in here if point.method == name])  # failed ones are listed
        for ours in (BATCH, ONE_CALL)
    )


def _batch_target(quick: bool) -> Target:
    """Return evaluations of Σ per second, at tolerance 1e-12, for random v, c from 0.3 to 3."""
    random = np.random.default_rng(_SEED)
    v, c = np.exp(random.uniform(np.log(0.3), np.log(3.0), (2, MANY)))
    cpu, start = process_time(), perf_counter()
    found = sums(v, c, 1e-12)
    cores = (process_time() - cpu) / (perf_counter() - start)
    _, seconds = _timed(lambda: sums(v, c, 1e-12), 3 if quick else 15)
    checked = range(3 if quick else 20)
    exact = [sum_by_roots(float(v[i]), float(c[i]), 30).value for i in checked]
    worst = max(distance(found.value[i], true) for i, true in zip(checked, exact, strict=True))
    detail = (
        f"{MANY} random pairs, seed {_SEED}; worst of {len(checked)} errors {worst:.1e}, largest "
        f"bound {found.error.max():.1e}; {np.mean(found.points):.0f} points each; "
        f"{cores:.2f} cores busy"
    )
    return Target("sum, vectorised, v and c from 0.3 to 3", v.size / seconds, "at least", 3e6,
                  "evaluations a second", detail)  # fmt: skip


def _corners(repeats: int) -> Target:
    """Return the largest cost at velocities of fronts, divided by that at an ordinary velocity.

    The velocities v are within a factor of three of V√c with V = 1, for c from 1e-8 to 1e8, and
    the number of values is the same for each c.
    """
    spread = np.geomspace(1.0 / 3.0, 3.0, MANY)
    near = 0.3 * np.geomspace(0.9, 1.1, spread.size)
    _, ordinary = _timed(partial(sums, near, 0.5, 1e-12), repeats)
    costs = {}
    for c in 10.0 ** np.arange(-8, 9):
        v = math.sqrt(c) * spread
        _, seconds = _timed(partial(sums, v, c, 1e-12), repeats)
        found = sums(v, c, 1e-12)
        costs[float(c)] = (seconds / ordinary, int(found.points.max()), float(found.error.max()))
    worst = max(costs, key=lambda c: costs[c][0])
    detail = (
        f"worst at c = {worst:g}, with {costs[worst][1]} points; largest bound "
        f"{max(error for _, _, error in costs.values()):.1e}; an ordinary value (v = 0.3, c = 0.5) "
        f"takes {1e6 * ordinary / spread.size:.2g} us"
    )
    return Target("sum along the velocities of fronts, c from 1e-8 to 1e8", costs[worst][0],
                  "below", 3.0, "times an ordinary value", detail)  # fmt: skip


def _one_call(repeats: int) -> Target:
    """Return the time of one value by the plain rules, for which numba is not loaded."""
    worst = 0.0
    for v, c in ((3.0, 0.3), (1.0, 1.0), (0.3, 0.5), (1.0, 2.5), (10.0, 100.0), (1e4, 1e8)):
        _, seconds = _timed(partial(sum_by_integral, v, c, 1e-12), repeats)
        worst = max(worst, seconds)
    _, seconds = _timed(partial(sum_by_integral, 0.3, 0.5, 1e-12), repeats)
    return Target("one value of the sum, v = 0.3, c = 0.5", 1e6 * seconds, "below", 20.0, "us",
                  f"the most expensive of six places takes {1e6 * worst:.3g} us")  # fmt: skip


def _curve(repeats: int) -> Target:
    couplings = np.linspace(0.3, 3.0, 1000)
    answers: list[KineticRelation] = []

    def trace() -> None:
        answers[:] = trace_kinetic_relation(couplings, _ETA)

    first, seconds = _timed(trace, repeats)
    branches = [branch for answer in answers for branch in answer.branches]
    judged = sum(branch.admissible is not None for branch in branches)
    detail = (
        f"c from 0.3 to 3, eta = {_ETA}; {len(branches)} branches, {judged} judged admissible or "
        f"not; first call {first:.3g} s"
    )
    return Target("curve of 1000 couplings, all branches, admissibility", seconds, "below", 0.1,
                  "s", detail)  # fmt: skip


def _one_point(repeats: int) -> Target:
    def solve() -> None:
        trace_kinetic_relation(0.5, _ETA)

    _, seconds = _timed(solve, repeats)
    return Target("all branches and admissibility at c = 0.5", 1e3 * seconds, "below", 1.0, "ms",
                  f"eta = {_ETA}; c_fold is computed when it is asked for")  # fmt: skip


def _command(repeats: int) -> Target:
    command = ["-m", "fronts", "kinetic", "--c", "0.5", "--eta", str(_ETA)]
    claim = "fronts kinetic --c 0.5 --eta 0.03125 from the shell"
    failed = ""

    def run() -> None:
        nonlocal failed
        done = subprocess.run(
            [sys.executable, *command], cwd=_ROOT, capture_output=True, text=True, check=False
        )
        failed = done.stderr.strip().splitlines()[-1][:120] if done.returncode else ""

    first, seconds = _timed(run, repeats)
    if failed:
        return Target(claim, None, "below", 0.8, "s", failed)
    return Target(claim, seconds, "below", 0.8, "s",
                  f"a new process each time; first {first:.3g} s")  # fmt: skip


def _certified(repeats: int) -> Target:
    from theory.parameters import ParameterError
    from theory.piecewise.certified_roots import certify_roots

    try:
        return _timed_target(
            "2000 certified roots", lambda: certify_roots(0.3, 0.5, _LABELS, True), repeats, 1.0,
            "enclosed and counted in ball arithmetic",
        )  # fmt: skip
    except ParameterError as error:
        return Target("2000 certified roots", None, "below", 1.0, "s", str(error))


def _simulation(repeats: int) -> Target:
    run = simulate_front(0.5, _ETA)
    detail = f"c = 0.5, eta = {_ETA}: {run.status.value}, {run.events} switchings"
    return _timed_target(
        "direct simulation of a front until steady", lambda: simulate_front(0.5, _ETA), repeats,
        None, detail,
    )  # fmt: skip


def _timed_target(
    claim: str, call: Callable[[], Any], repeats: int, limit: float | None, detail: str
) -> Target:
    first, seconds = _timed(call, repeats)
    relation: Relation = "no target" if limit is None else "below"
    return Target(claim, seconds, relation, limit, "s", f"{detail}; first call {first:.3g} s")


def _timed(call: Callable[[], Any], repeats: int) -> tuple[float, float]:
    """Return the time of the first call, and the median time of ``repeats`` more, in seconds."""
    times = []
    for _ in range(repeats + 1):
        start = perf_counter()
        call()
        times.append(perf_counter() - start)
    return times[0], statistics.median(times[1:])


BENCHMARK = WorkPrecision(
    name="sum",
    prepare=prepare,
    targets=targets,
    effort=Effort(seconds=2.0, max_repeats=101, once_from=4.0, limit=90.0),
    quick_effort=Effort(seconds=0.1, min_repeats=2, max_repeats=9, once_from=1.0, limit=10.0),
    quick_problems=3,
    style=Style(
        xlabel="error of Σ (right is better)",
        ylabel="seconds per evaluation",
        caption="Error against run time of Σ(v, c). Pale: settings surpassed by another one of "
        "the same method. Errors below 1e-16 cannot be seen in double precision.",
        methods={
            BATCH: ("blue", "o"),
            ONE_CALL: ("sky", "o"),
            PRECISE: ("blue", "P"),
            SERIES: ("vermilion", "s"),
            CUT_OFF: ("vermilion", "x"),
            BESSEL: ("green", "^"),
            PIECES: ("purple", "D"),
            QUAD: ("orange", "v"),
            WITH_TAIL: ("black", "X"),
            WITHOUT_TAIL: ("black", "+"),
        },
        garbage=math.inf,
        floor=1e-51,
    ),
    variants=(ONE_CALL,),
    first={
        BATCH: partial(_batch, 0.3, 0.5),
        QUAD: partial(_by_quad, 0.3, 0.5, 1e-8, 1_000),
        WITH_TAIL: partial(_by_contour, 0.3, 0.5, 1, True, {"M": 2}),
    },
)
