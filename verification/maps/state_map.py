"""``state_map``: the state of a chain over a grid of its parameters, and where the state changes.

How the state of one point is determined is described in ``task``.

Where, in Fig. 5, one excited site goes to rest although fronts exist, a wider nucleus shows that
this is a failure to nucleate and not an absence of fronts.
"""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np

from theory.chains.chain import Chain
from theory.parameters import ParameterError, file_path, need_instance, within
from theory.result import Result
from verification.execution.columns import Scalar
from verification.execution.pool import worker_count, worker_pool
from verification.execution.progress import ProgressCallback
from verification.execution.sweep import sweep
from verification.execution.table import ARRAY_FORMATS, Table
from verification.maps.boundary import TOLERANCES, Bisection, boundary_lines
from verification.maps.state import State
from verification.maps.task import HELD, StateTask, state_points, whole_axes

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, kw_only=True)
class Agreement(Result):
    """Comparison of two maps of the same points.

    Attributes
    ----------
    same : int
        Number of points that have the same state in both, undecided or not.
    total : int
        Number of points.
    differing : tuple of dict
        The other points: coordinates and the two states.
    contradicting : int
        Number of differing points at which both maps are decided.
    """

    same: int
    total: int
    differing: tuple[dict[str, Scalar], ...]
    contradicting: int


def compare(first: Table, second: Table, axes: Sequence[str] = ("eta", "c")) -> Agreement:
    """Count the points at which two maps have the same state.

    Parameters
    ----------
    first, second : Table
        Maps of the same points.
    axes : sequence of str, optional
        Names of the coordinates.

    Raises
    ------
    ValueError
        If the maps are not over the same points.
    """
    if not all(np.array_equal(first[name], second[name]) for name in axes):
        raise ValueError("the two maps are not over the same points.")
    differing: list[dict[str, Scalar]] = [
        {**{name: one[name] for name in axes}, "first": one["label"], "second": two["label"]}
        for one, two in zip(first.rows(), second.rows(), strict=True)
        if one["label"] != two["label"]
    ]
    undecided = str(State.UNDECIDED)
    contradicting = sum(undecided not in (row["first"], row["second"]) for row in differing)
    return Agreement(
        same=len(first) - len(differing),
        total=len(first),
        differing=tuple(differing),
        contradicting=contradicting,
    )


@dataclass(frozen=True, kw_only=True)
class StateMap(Result):
    """The states of a chain over a grid of parameters.

    Attributes
    ----------
    task : StateTask
        What was computed at each point.
    axes : tuple of str
        Names of the coordinates, the first one varying slowest.
    states : Table
        One row per point: the coordinates, ``label`` (a `State`), ``why`` (a `Reason`), ``time``,
        ``above``, ``reached`` where it is counted, ``steps`` and, if requested, ``amplitude``, an
        array over ``site``, with ``amplitude_time``, the end time of that run.
    boundary : Table or None
        One row for each line between neighbours whose states differ; see
        ``verification.maps.boundary.Bisection``.
    map_seconds, seconds : float
        Wall-clock time of the grid, and of everything.
    averaged : Agreement or None
        For (8), if requested: the comparison with the averaged chain.
    """

    task: StateTask
    axes: tuple[str, ...]
    states: Table
    boundary: Table | None
    map_seconds: float
    seconds: float
    averaged: Agreement | None = None

    @property
    def counts(self) -> dict[str, int]:
        """Number of points in each state."""
        return self.states.counts("label")

    @property
    def held(self) -> dict[str, Any]:
        """Parameters of the chain that are the same at every point."""
        varied = {"model", *self.axes}
        if "eta" in self.axes:
            varied |= {*HELD} - {self.task.held}
        parameters = self.task.chain.parameters().items()
        return {name: value for name, value in parameters if name not in varied}

    @property
    def undecided(self) -> list[dict[str, Scalar]]:
        """The undecided points, with the reason and the number of active sites."""
        return [
            {name: row[name] for name in (*self.axes, "why", "above")}
            for row in self.states.rows()
            if row["label"] == State.UNDECIDED
        ]

    def agreement(self, other: StateMap) -> Agreement:
        """Compare with another map of the same points."""
        return compare(self.states, other.states, self.axes)

    def columns(self) -> dict[str, np.ndarray]:
        """Return the columns of the table of states."""
        return self.states.columns()

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the table of states, with the columns that contain arrays."""
        return dict(self.states.arrays)

    def to_xarray(self) -> xr.Dataset:
        """Return the states over the axes as an xarray dataset."""
        return self.states.to_xarray()

    def to_dict(self) -> dict[str, Any]:
        """Return fixed parameters, points by state, undecided points and run times for JSON."""
        compared = None if self.averaged is None else self.averaged.to_dict()
        return {
            "model": self.task.chain.model,
            "axes": list(self.axes),
            "held": self.held,
            "points": len(self.states),
            "counts": self.counts,
            "agreement": compared and {"with": "averaged", **compared},
            "undecided": self.undecided,
            "longest_time": float(self.states["time"].max()),
            "boundary_points": None if self.boundary is None else len(self.boundary),
            "resumed": self.states.resumed,
            "map_seconds": self.map_seconds,
            "seconds": self.seconds,
        }


def state_map(
    what: Chain | StateTask,
    *,
    refine: float = 1.0 / 16.0,
    workers: int | None = None,
    executor: Executor | None = None,
    out: Path | str | None = None,
    resume: bool = False,
    progress: ProgressCallback | None = None,
    **axes: Sequence[float],
) -> StateMap:
    """Determine the state of a chain at every point of a grid (Figs. 5, 15).

    Where the state changes between neighbouring points, the boundary is bisected, except along
    parameters that are whole numbers. All parameters are dimensionless.

    Parameters
    ----------
    what : Chain or StateTask
        A chain, for the start and the times of the paper's figures; or a task with further options.
    refine : float, optional
        Boundaries are bisected to this fraction of the grid spacing, from 1e-9 to 1; 0 for no
        bisection.
    workers : int, optional
        Number of processes, by default one per available core.
    executor : concurrent.futures.Executor, optional
        Used instead of processes of its own, and left open; it may be that of a cluster, for
        instance.
    out : Path or str, optional
        File for the map, as in `sweep`: zarr or npz if there are amplitudes; for the boundaries,
        which are stored next to it, see `boundary_path`.
    resume : bool, optional
        Continue from what an interrupted map left beside ``out``.
    progress : callable, optional
        See ``verification.execution.progress.ProgressCallback``; for the map, then for its
        boundaries.
    **axes : sequence of float
        Values of parameters of the chain, by name; ``eta`` for a chain with a and b.

    Returns
    -------
    StateMap
        One row per point, and the boundaries.

    Raises
    ------
    ParameterError
        If there are no rules for the chain, an axis or a value does not fit it, or amplitudes are
        to be stored in a file format that has no arrays.

    Examples
    --------
    >>> from theory.chains.vdp import AveragedChain
    >>> chain = AveragedChain(a=4, b=0.5, c=0.6, sites=16)
    >>> found = state_map(chain, eta=[0.03, 0.13], c=[0.1, 0.6], workers=1, refine=0.25)
    >>> found.counts, len(found.boundary)
    ({'breather': 1, 'fixed point': 2, 'front': 1}, 3)
    """
    begin = perf_counter()
    need_instance("chain", what, (Chain, StateTask), "give one, as VdpChain(a=4, b=0.5, c=0.6)")
    task = what if isinstance(what, StateTask) else StateTask(chain=what)
    within("part of the spacing, refine,", refine, 0.0, 1.0)
    if refine > 0.0:
        within("part of the spacing, refine,", refine, *TOLERANCES, "or give 0 for no bisection")
    if not axes:
        raise ParameterError("axes", "none", "at least one", "name a parameter, as c=[0.1, 0.2]")
    out = None if out is None else file_path("out", out)
    if task.amplitudes and out is not None and out.suffix not in ARRAY_FORMATS:
        raise ParameterError(
            "file of a map with amplitudes", out, "a file that can hold arrays",
            "name a file ending in .zarr or .npz",
        )  # fmt: skip
    points = state_points(task, axes)
    processes = min(worker_count(workers), len(points))
    # One pool for both sweeps, so that processes start and load compiled code only once.
    pool_context: AbstractContextManager[Executor | None] = (
        nullcontext(executor) if executor is not None or processes <= 1 else worker_pool(processes)
    )
    with pool_context as pool:
        options: dict[str, Any] = {
            "resume": resume, "workers": 1, "executor": pool, "progress": progress,
        }  # fmt: skip
        dims = {"amplitude": "site"} if task.amplitudes else {}
        states = sweep(task, points, dims=dims, out=out, **options)
        map_seconds = perf_counter() - begin
        boundary = None
        if refine > 0.0:
            bisection = Bisection(task.alone(), refine, predictor=task.average())
            boundary_file = None if out is None else boundary_path(out)
            whole = whole_axes(task.chain)
            lines = boundary_lines(states, tuple(axes))
            between = [line for line in lines if line["along"] not in whole]
            boundary = sweep(bisection, between, out=boundary_file, **options)
    return StateMap(
        task=task,
        axes=tuple(axes),
        states=states,
        boundary=boundary,
        map_seconds=map_seconds,
        seconds=perf_counter() - begin,
    )


def boundary_path(out: Path) -> Path:
    """Return the path of the file for the boundaries of a map.

    Examples
    --------
    >>> boundary_path(Path("map.csv")).name
    'map-boundary.csv'
    """
    return out.with_name(f"{out.stem}-boundary{out.suffix}")
