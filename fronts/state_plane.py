"""Maps of states over a plane of parameters: sweep, boundaries, picture, and what is told of them.

It is the same for every model; ``fronts.commands.map`` names the plane.
"""

from __future__ import annotations

import argparse
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

from fronts.interrupted import resumable_tables
from verification.execution.files import write_by
from verification.execution.progress import Progress

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from verification.execution.sweep import Task
    from verification.execution.table import Point, Table


@dataclass(frozen=True)
class Plane:
    """What is mapped: names of the axes in the table and in words, points, tasks."""

    name: str
    axes: tuple[str, str]
    titles: tuple[str, str]
    points: tuple[Point, ...]
    task: Task
    alone: Task
    workers: int | None


def map_plane(plane: Plane, options: argparse.Namespace) -> tuple[dict[str, object], Table]:
    """Sweep the plane, bisect its boundaries, draw it; return what is to be told, and the map."""
    from verification.maps.boundary import Bisection

    begin = perf_counter()
    tables = () if options.out is None else (options.out, boundary_path(options.out))
    with resumable_tables(*tables), _pool(plane.workers, len(plane.points)) as executor:
        states = swept("map", plane.task, plane.points, options.out, options.resume, executor)
        map_seconds = perf_counter() - begin
        boundary = None
        if options.refine > 0:
            bisection = Bisection(plane.alone, options.refine)
            boundary = _boundary(states, plane, bisection, options, executor)
    if options.picture is not None:
        write_by(options.picture, lambda path: _draw(path, plane, states, boundary))
    undecided = [
        {name: row[name] for name in (*plane.axes, "why", "above")}
        for row in states.rows()
        if row["label"] == "undecided"
    ]
    return {
        "model": plane.name,
        "points": len(states),
        "counts": states.counts("label"),
        "agreement": None,
        "undecided": undecided,
        "longest_time": float(states["time"].max()),
        "boundary_points": None if boundary is None else len(boundary),
        "resumed": states.resumed,
        "map_seconds": map_seconds,
        "seconds": perf_counter() - begin,
    }, states


def _pool(workers: int | None, points: int) -> AbstractContextManager[Executor | None]:
    """Return one pool for both sweeps, so that processes start and load compiled code once."""
    from verification.execution.pool import worker_count, worker_pool

    count = min(worker_count(workers), points)
    return worker_pool(count) if count > 1 else nullcontext()


def swept(
    name: str,
    task: Task,
    points: tuple[Point, ...],
    out: Path | None,
    resume: bool,
    executor: Executor | None,
) -> Table:
    """Sweep the points with a live line of progress."""
    from verification.execution.sweep import sweep

    with Progress(f"{name} of {len(points)} points") as shown:
        return sweep(
            task,
            points,
            out=out,
            resume=resume,
            workers=1,
            executor=executor,
            progress=shown.report,
        )


def boundary_path(out: Path) -> Path:
    """Return where the boundaries of a map go."""
    return out.with_name(f"{out.stem}-boundary.csv")


def _boundary(
    states: Table,
    plane: Plane,
    task: Task,
    options: argparse.Namespace,
    executor: Executor | None,
) -> Table:
    from verification.maps.boundary import boundary_lines

    lines = boundary_lines(states, plane.axes)
    out = None if options.out is None else boundary_path(options.out)
    return swept("boundary", task, lines, out, options.resume, executor)


def _draw(path: Path, plane: Plane, states: Table, boundary: Table | None) -> None:
    from paper_checks.pictures import new_axes, save
    from paper_checks.state_picture import draw_states

    figure, axes = new_axes("page", height=4.2, xlabel=plane.titles[0], ylabel=plane.titles[1])
    draw_states(axes, states, *plane.axes, boundary)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    save(path, figure)
