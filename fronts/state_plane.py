"""Maps of states over a plane of parameters: files, picture, and what is reported of them.

It is the same for every model; ``fronts.commands.map`` names the plane.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from fronts.interrupted import resumable_tables
from verification.execution.files import write_by
from verification.execution.progress import Progress

if TYPE_CHECKING:
    from verification.maps.state_map import StateMap, StateTask


def map_plane(
    name: str,
    task: StateTask,
    axes: dict[str, list[float]],
    titles: tuple[str, str],
    options: argparse.Namespace,
) -> tuple[dict[str, object], StateMap]:
    """Map the plane and draw it; return what is to be reported, and the map."""
    from verification.maps.state_map import boundary_path, state_map

    tables = () if options.out is None else (options.out, boundary_path(options.out))
    with resumable_tables(*tables), Progress(f"map of {name}") as shown:
        found = state_map(
            task,
            refine=options.refine,
            workers=options.workers,
            out=options.out,
            resume=options.resume,
            progress=shown.report,
            **axes,
        )
    if options.picture is not None:
        write_by(options.picture, lambda path: _draw(path, found, titles))
    return {
        "model": name,
        "points": len(found.states),
        "counts": found.counts,
        "agreement": None,
        "undecided": found.undecided,
        "longest_time": float(found.states["time"].max()),
        "boundary_points": None if found.boundary is None else len(found.boundary),
        "resumed": found.states.resumed,
        "map_seconds": found.map_seconds,
        "seconds": found.seconds,
    }, found


def _draw(path: Path, found: StateMap, titles: tuple[str, str]) -> None:
    from paper_checks.pictures import new_axes, save
    from paper_checks.state_picture import draw_states

    figure, axes = new_axes("page", height=4.2, xlabel=titles[0], ylabel=titles[1])
    first, second = found.axes
    draw_states(axes, found.states, first, second, found.boundary)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
    save(path, figure)
