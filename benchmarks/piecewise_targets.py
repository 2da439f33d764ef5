"""The speeds promised for the piecewise-linear front, each measured; a missed one says so."""

from __future__ import annotations

import statistics
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from time import perf_counter, process_time
from typing import Any, Literal

import numpy as np

from benchmarks.piecewise_sum import exact_sum
from benchmarks.record import Target, WorkPoint
from benchmarks.runner import distance
from theory.piecewise.kinetic_relation import KineticRelation, trace_kinetic_relation
from theory.piecewise.roots import labelled_roots
from theory.piecewise.sums.integral import sums
from verification.piecewise.simulation import simulate_front

Relation = Literal["at least", "below", "no target"]

_ETA = 0.03125
_SEED = 20
_ROOT = Path(__file__).resolve().parent.parent
_OURS = ("integral, in a batch", "integral, one call")


def ratio_targets(points: Sequence[WorkPoint], scene: str) -> tuple[Target, ...]:
    """Return how much faster the integral is than the peers at equal error.

    For each setting of a peer, ours is the fastest setting with no more error; the smallest ratio
    over the peer's settings is the one reported. The promise spoke of arrays; what one call gains
    stands beside it.
    """
    rows = []
    for peer, tail, limit in (
        ("scipy.integrate.quad", "", 200.0),
        ("cxroots", ", our tail", 1e4),
        ("cxroots", ", cut off", 1e4),
    ):
        if not any(p.scene == scene and p.method == peer + tail for p in points):
            continue  # it failed, and is listed there, or was not asked for
        for ours in _OURS:
            claim = f"{ours}, against {peer}{tail}, {scene} scene, equal error"
            promised = limit if ours == _OURS[0] else None
            rows.append(_ratio(points, scene, ours, peer + tail, claim, promised))
    return tuple(rows)


def _ratio(
    points: Sequence[WorkPoint], scene: str, ours: str, peer: str, claim: str, limit: float | None
) -> Target:
    here = [point for point in points if point.scene == scene]
    relation: Relation = "no target" if limit is None else "at least"
    pairs = []
    for theirs in (point for point in here if point.method == peer):
        good = [p for p in here if p.method == ours and p.error <= theirs.error]
        if good:
            fastest = min(good, key=lambda p: p.seconds)
            pairs.append((theirs.seconds / fastest.seconds, theirs, fastest))
    if not pairs:
        return Target(
            claim,
            None,
            relation,
            limit,
            "times faster",
            f"ours never reached the error of {peer}",
        )
    ratio, theirs, fastest = min(pairs, key=lambda row: row[0])
    detail = (
        f"{peer} ({theirs.knob}): {theirs.seconds:.3g} s, error {theirs.error:.1e}; "
        f"{ours} ({fastest.knob}): {fastest.seconds:.3g} s, error {fastest.error:.1e}"
    )
    return Target(claim, ratio, relation, limit, "times faster", detail)


def batch_target(quick: bool) -> Target:
    """Return evaluations of Σ a second at 1e-12 for random v, c from 0.3 to 3."""
    random = np.random.default_rng(_SEED)
    v, c = np.exp(random.uniform(np.log(0.3), np.log(3.0), (2, 20_000)))
    cpu, start = process_time(), perf_counter()
    found = sums(v, c, 1e-12)
    cores = (process_time() - cpu) / (perf_counter() - start)
    _, seconds = _timed(lambda: sums(v, c, 1e-12), 3 if quick else 15)
    checked = range(3 if quick else 20)
    worst = max(distance(found.value[i], exact_sum(float(v[i]), float(c[i]))) for i in checked)
    detail = (
        f"20000 random pairs, seed {_SEED}; worst of {len(checked)} errors {worst:.1e}, largest "
        f"bound {found.error.max():.1e}; {np.mean(found.points):.0f} points each; "
        f"{cores:.2f} cores busy"
    )
    return Target("sum, vectorised, v and c from 0.3 to 3", v.size / seconds, "at least", 1e5,
                  "evaluations a second", detail)  # fmt: skip


def other_targets(quick: bool) -> tuple[Target, ...]:
    """Return the curve, the command, the roots and the direct simulation."""
    repeats = 3 if quick else 9
    labels = np.arange(-1000, 1000)
    return (
        _curve(1 if quick else 5),
        _command(repeats),
        _target("2000 labelled roots", lambda: labelled_roots(0.3, 0.5, labels, True), repeats,
                0.05, "v = 0.3, c = 0.5, upper half-plane"),
        _certified(labels, 1 if quick else 5),
        _simulation(repeats),
    )  # fmt: skip


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
    return Target("curve of 1000 couplings, all branches, admissibility", seconds, "below", 2.0,
                  "s", detail)  # fmt: skip


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


def _certified(labels: Any, repeats: int) -> Target:
    from theory.parameters import ParameterError
    from theory.piecewise.certified_roots import certify_roots

    try:
        return _target("2000 certified roots", lambda: certify_roots(0.3, 0.5, labels, True),
                       repeats, 1.0, "enclosed and counted in ball arithmetic")  # fmt: skip
    except ParameterError as error:
        return Target("2000 certified roots", None, "below", 1.0, "s", str(error))


def _simulation(repeats: int) -> Target:
    run = simulate_front(0.5, _ETA)
    detail = f"c = 0.5, eta = {_ETA}: {run.status.value}, {run.events} switchings"
    return _target("direct simulation of a front until steady",
                   lambda: simulate_front(0.5, _ETA), repeats, None, detail)  # fmt: skip


def _target(
    claim: str, call: Callable[[], Any], repeats: int, limit: float | None, detail: str
) -> Target:
    first, seconds = _timed(call, repeats)
    relation: Relation = "no target" if limit is None else "below"
    return Target(claim, seconds, relation, limit, "s", f"{detail}; first call {first:.3g} s")


def _timed(call: Callable[[], Any], repeats: int) -> tuple[float, float]:
    """Return seconds of the first call, and the median of ``repeats`` more."""
    times = []
    for _ in range(repeats + 1):
        start = perf_counter()
        call()
        times.append(perf_counter() - start)
    return times[0], statistics.median(times[1:])
