"""A map of states as a result with its picture and its comparison, for ``fronts map``."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fronts.answer import UsageError
from fronts.interrupted import resumable_tables
from theory.chains.chain import Chain
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from theory.result import Result
from verification.execution.pool import cluster
from verification.execution.progress import ProgressCallback
from verification.maps.state_map import Agreement, StateMap, StateTask, boundary_path, state_map
from verification.runs.excite import StartPoint

if TYPE_CHECKING:
    import xarray as xr

    from verification.execution.table import Table

MAX_POINTS = 100_000


@dataclass(frozen=True, kw_only=True)
class ComparedMap(Result):
    """A map of states, and of (8) how many points of it the averaged chain names alike.

    Attributes
    ----------
    found : StateMap
        The map.
    held : mapping of str to float, or None
        Which of a and b is the same for all η, where η is an axis.
    agreement : Agreement or None
        Comparison with the averaged chain.
    """

    found: StateMap
    held: Mapping[str, float] | None
    agreement: Agreement | None

    @property
    def boundary(self) -> Table | None:
        """Where states change, if that was bisected."""
        return self.found.boundary

    def columns(self) -> dict[str, np.ndarray]:
        """Return one row a point."""
        return self.found.columns()

    def arrays(self) -> dict[str, np.ndarray]:
        """Return one row a point, with those columns whose cells are arrays."""
        return dict(self.found.states.arrays)

    def to_xarray(self) -> xr.Dataset:
        """Return the states over the axes."""
        return self.found.to_xarray()

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers of points by state, what is undecided, and the run times."""
        found = self.found
        compared = None
        if self.agreement is not None:
            compared = {"with": "averaged", **self.agreement.to_dict()}
        payload = {
            "model": found.task.chain.model,
            "points": len(found.states),
            "counts": found.counts,
            "agreement": compared,
            "undecided": found.undecided,
            "longest_time": float(found.states["time"].max()),
            "boundary_points": None if found.boundary is None else len(found.boundary),
            "resumed": found.states.resumed,
            "map_seconds": found.map_seconds,
            "seconds": found.seconds,
        }
        return payload if self.held is None else payload | {"held": dict(self.held)}


def mapped(  # noqa: PLR0913  (options of a command, by name)
    chain: Chain,
    axes: Mapping[str, Sequence[float]],
    *,
    nucleus: Nucleus | None = None,
    displacement: float | None = None,
    start_point: StartPoint = StartPoint.MAXIMUM,
    end: float | None = None,
    refine: float = 1.0 / 16.0,
    workers: int | None = None,
    scheduler: str | None = None,
    out: Path | None = None,
    resume: bool = False,
    held: str = "b",
    amplitudes: bool = False,
    progress: ProgressCallback | None = None,
) -> ComparedMap:
    """Return the state of a chain over a plane of its parameters.

    Parameters
    ----------
    chain : Chain
        What is the same everywhere.
    axes : mapping of str to sequence of float
        Values of one or two parameters.
    nucleus : Nucleus, optional
        Excited sites; by default those of the paper's figure.
    displacement : float, optional
        Of the excited sites; by default 6 of a Van der Pol chain, else the excited state of one
        cell.
    start_point : StartPoint, optional
        Point of the cycle from which excited sites of the friction chain start.
    end : float, optional
        End time; a label found after half of it does not count (2000 in slow time eps t, of the
        friction chain 20000 in tau).
    refine : float, optional
        Bisect boundaries to this part of the grid's spacing; 0 leaves them.
    workers : int, optional
        Processes, by default one a core, of the averaged chain 1.
    scheduler : str, optional
        Address of a dask scheduler, as in tcp://host:8786, whose workers compute the points.
    out : Path, optional
        Table that can be resumed.
    resume : bool, optional
        Go on from OUT.part, which a killed run has left beside --out.
    held : str, optional
        Which of a and b is the same for all η.
    amplitudes : bool, optional
        Keep the amplitude of every site at the end of each run, too: an array a point, for a file
        that ends in .zarr or .npz.
    progress : callable, optional
        Called with the fraction done.

    Returns
    -------
    ComparedMap

    Raises
    ------
    ParameterError
        If a value is out of range or the points are too many.
    MissingPackageError
        If a scheduler is named and dask.distributed is not installed.
    UsageError
        If an interrupted run would be overwritten, there is nothing to resume, or both workers and
        a scheduler are given.
    """
    count = int(np.prod([len(values) for values in axes.values()]))
    if count > MAX_POINTS:
        raise ParameterError("points of the map", count, f"at most {MAX_POINTS}", "take fewer")
    _check_resumption(out, resume)
    if scheduler is not None and workers is not None:
        raise UsageError(
            "--workers counts processes of this machine: leave it out beside --scheduler."
        )
    task = StateTask(
        chain=chain, held=held, nucleus=nucleus, displacement=displacement, point=start_point,
        end=end, amplitudes=amplitudes,
    )  # fmt: skip
    if workers is None and chain.model == "averaged":
        workers = 1
    tables = () if out is None else (out, boundary_path(out))
    values: dict[str, Any] = dict(axes)
    pool: AbstractContextManager[Executor | None] = (
        nullcontext() if scheduler is None else cluster(scheduler)
    )
    with resumable_tables(*tables), pool as executor:
        found = state_map(
            task,
            refine=refine,
            workers=workers,
            executor=executor,
            out=out,
            resume=resume,
            progress=progress,
            **values,
        )
    agreement = None
    if isinstance(chain, VdpChain):
        average = dataclasses.replace(task, chain=chain.averaged(), amplitudes=False)
        agreement = found.agreement(state_map(average, refine=0.0, workers=1, **values))
    named = {held: float(getattr(chain, held))} if "eta" in axes else None
    return ComparedMap(found=found, held=named, agreement=agreement)


def _check_resumption(out: Path | None, resume: bool) -> None:
    if resume and out is None:
        raise UsageError(
            "--resume needs --out with a .csv or .zarr file: what can be resumed is beside it."
        )
    if out is None:
        return
    from verification.execution.sweep import part_path

    part = part_path(boundary_path(out))
    # Before the map overwrites what an interrupted run has finished.
    if part.exists() and not resume:
        raise UsageError(f"{part} is left by an interrupted run: --resume it, or remove it.")
