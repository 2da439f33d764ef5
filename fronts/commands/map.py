"""``fronts map MODEL``: the state of a chain over a plane of parameters, one function a model."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from fronts.answer import Answer, UsageError
from fronts.arguments import MOST_POINTS, check_writable, real, real_or_range, write_whole
from fronts.progress import Fraction

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from verification.sweep import Task
    from verification.table import Point, Table

EXAMPLE = """examples:
  fronts map vdp --eta 0.01:0.14:7 --c 0.05:1:7 --model envelope
  fronts map vdp --eta 0.01:0.14:14 --c 0.05:1:20 --model envelope --out map.csv --picture map.png
  fronts map vdp --eta 0.01:0.14:14 --c 0.05:1:20 --model full --refine 0 --out map.csv --resume

The paper does not say which of a and b is the same for all eta: b = 0.5 is held, unless --a or
another --b is given. OUT.json has parameters and versions; OUT-boundary.csv has the boundaries."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts map``."""
    parser.add_argument("chain", choices=sorted(MODELS), help="the chain to run")
    parser.add_argument("--eta", type=real_or_range, required=True, help="b/a^2, or low:high:count")
    parser.add_argument(
        "--c", type=real_or_range, required=True, help="coupling, or low:high:count"
    )
    parser.add_argument(
        "--model", choices=("full", "envelope"), default="full", help="Eq. 8, or its average 43"
    )
    held = parser.add_mutually_exclusive_group()
    held.add_argument("--a", type=real, help="hold a at this value; b = eta a^2")
    held.add_argument("--b", type=real, help="hold b at this value; a = sqrt(b/eta) (default 0.5)")
    parser.add_argument("--n", type=int, default=16, help="number of oscillators (default 16)")
    parser.add_argument("--eps", type=real, default=0.01, help="small parameter (default 0.01)")
    parser.add_argument(
        "--displacement", type=real, default=6.0, help="of the last site (default 6)"
    )
    parser.add_argument(
        "--end",
        type=real,
        default=2000.0,
        help="end in slow time eps t; a label found after half of it does not count (default 2000)",
    )
    parser.add_argument(
        "--refine",
        type=real,
        default=0.0625,
        help="bisect boundaries to this part of the grid's spacing; 0 leaves them (default 1/16)",
    )
    parser.add_argument("--out", type=Path, help="write the map to a .csv file")
    parser.add_argument("--picture", type=Path, help="draw the map")
    parser.add_argument(
        "--workers", type=int, help="processes (default: 1 for the envelope, else one a core)"
    )
    parser.add_argument(
        "--resume", action="store_true", help="go on from the journal OUT.part of a killed run"
    )


def run(options: argparse.Namespace) -> Answer:
    """Run the model that was named."""
    return MODELS[options.chain](options)


def _values(option: str, given: float | tuple[float, float, int]) -> list[float]:
    if not isinstance(given, tuple):
        return [given]
    low, high, count = given
    if not low < high:
        raise UsageError(f"{option} {low:g}:{high:g}:{count} must rise: give low:high:count.")
    # Rounded, so that 0.01:0.14:14 has 0.03 and not 0.030000000000000002.
    return [float(f"{value:.15g}") for value in np.linspace(low, high, count)]


def _vdp(options: argparse.Namespace) -> Answer:
    from theory.parameters import count_within, within
    from verification.boundary import Bisection
    from verification.journal import journal_path
    from verification.state_map import StateTask, compare, state_points
    from verification.vdp_run import Model

    if options.out is not None:
        check_writable(options.out, (".csv",))
        # Before the map overwrites what an interrupted run has finished.
        journal = journal_path(_boundary_path(options.out))
        if journal.exists() and not options.resume:
            raise UsageError(f"{journal} is left by an interrupted run: --resume it, or remove it.")
    if options.picture is not None:
        check_writable(options.picture, (".png", ".svg", ".pdf"), "--picture")
    if options.resume and options.out is None:
        raise UsageError("--resume needs --out: the journal is beside it.")
    within("part of the spacing, --refine,", options.refine, 0.0, 1.0)
    if options.workers is not None:
        count_within("workers", options.workers, 1, 1024)
    etas, couplings = _values("--eta", options.eta), _values("--c", options.c)
    if len(etas) * len(couplings) > MOST_POINTS:
        raise UsageError(f"{len(etas) * len(couplings)} points are more than {MOST_POINTS}.")
    points = state_points(etas, couplings)
    given_b = 0.5 if options.b is None else options.b
    task = StateTask(
        Model(options.model),
        held="b" if options.a is None else "a",
        value=given_b if options.a is None else options.a,
        sites=options.n,
        eps=options.eps,
        displacement=options.displacement,
        end=options.end,
    )
    for eta in etas:
        task.chain(eta, couplings[0])
    envelope = task.model is Model.ENVELOPE
    workers = 1 if envelope and options.workers is None else options.workers
    begin = perf_counter()
    with _pool(workers, len(points)) as executor:
        states = _sweep("map", task, points, options.out, options.resume, executor)
        map_seconds = perf_counter() - begin
        boundary = None
        if options.refine > 0:
            boundary = _boundary(states, Bisection(task.alone(), options.refine), options, executor)
    other = None if envelope else _sweep("envelope", task.averaged(), points, None, False, None)
    agreement = None if other is None else compare(states, other)
    if options.picture is not None:
        write_whole(options.picture, lambda path: _draw(path, states, boundary))
    undecided = [
        {name: row[name] for name in ("eta", "c", "why", "above")}
        for row in states.rows()
        if row["label"] == "undecided"
    ]
    payload: dict[str, object] = {
        "model": task.model.value,
        "held": {task.held: task.value},
        "points": len(states),
        "counts": states.counts("label"),
        "agreement": None
        if agreement is None
        else {
            "with": "envelope",
            "same": agreement.same,
            "total": agreement.total,
            "contradicting": agreement.contradicting,
            "differing": list(agreement.differing),
        },
        "undecided": undecided,
        "longest_time": float(states["time"].max()),
        "boundary_points": None if boundary is None else len(boundary),
        "resumed": states.resumed,
        "map_seconds": map_seconds,
        "seconds": perf_counter() - begin,
    }
    return Answer(payload, _in_words(payload))


def _pool(workers: int | None, points: int) -> AbstractContextManager[Executor | None]:
    """Return one pool for both sweeps, so that processes start and load compiled code once."""
    from verification.sweep import own_workers, workers_allowed

    count = min(workers_allowed() if workers is None else workers, points)
    return own_workers(count) if count > 1 else nullcontext()


def _sweep(
    name: str,
    task: Task,
    points: tuple[Point, ...],
    out: Path | None,
    resume: bool,
    executor: Executor | None,
) -> Table:
    from verification.sweep import sweep

    with Fraction(f"{name} of {len(points)} points") as shown:
        return sweep(
            task,
            points,
            out=out,
            resume=resume,
            workers=1,
            executor=executor,
            progress=lambda done, total, left: shown.show(done / max(total, 1)),
        )


def _boundary_path(out: Path) -> Path:
    return out.with_name(f"{out.stem}-boundary.csv")


def _boundary(
    states: Table, task: Task, options: argparse.Namespace, executor: Executor | None
) -> Table:
    from verification.boundary import boundary_lines

    lines = boundary_lines(states, ("eta", "c"))
    out = None if options.out is None else _boundary_path(options.out)
    return _sweep("boundary", task, lines, out, options.resume, executor)


def _draw(path: Path, states: Table, boundary: Table | None) -> None:
    from paper_checks.pictures import new_axes
    from paper_checks.state_picture import draw_states

    figure, axes = new_axes("page", height=4.2, xlabel="η = b/a²", ylabel="coupling c")
    draw_states(axes, states, "eta", "c", boundary)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    figure.savefig(path, dpi=200)


def _in_words(payload: Mapping[str, object]) -> str:
    counts, undecided, agreement = payload["counts"], payload["undecided"], payload["agreement"]
    assert isinstance(counts, dict)
    assert isinstance(undecided, list)
    lines = [f"{payload['points']} points, {payload['model']}:"]
    lines += [f"  {label:<12} {number}" for label, number in counts.items()]
    if isinstance(agreement, dict):
        lines.append(
            f"  the envelope gives the same label at {agreement['same']} of {agreement['total']}"
        )
        lines += [
            f"    eta = {row['eta']:g}, c = {row['c']:g}: {row['first']}, envelope {row['second']}"
            for row in agreement["differing"][:10]
        ]
    if undecided:
        places = ", ".join(f"({row['eta']:g}, {row['c']:g})" for row in undecided[:10])
        more = f" and {len(undecided) - 10} more" if len(undecided) > 10 else ""
        lines.append(f"  undecided at (eta, c) = {places}{more}")
    lines.append(f"  {payload['map_seconds']:.2f} s, with everything {payload['seconds']:.2f} s")
    return "\n".join(lines)


MODELS: dict[str, Callable[[argparse.Namespace], Answer]] = {"vdp": _vdp}
"""Chain and the function that maps it."""
