"""The map of states behind ``fronts map``: resumable and, for (8), compared with the average."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from fronts.answer import UsageError
from fronts.interrupted import resumable_tables
from theory.chains.chain import Chain
from theory.chains.nucleus import Nucleus
from theory.chains.vdp import VdpChain
from theory.parameters import ParameterError
from verification.execution.pool import cluster
from verification.execution.progress import ProgressCallback
from verification.maps.state_map import StateMap, boundary_path, state_map
from verification.maps.task import StateTask
from verification.runs.excite import StartPoint

MAX_POINTS = 100_000


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
) -> StateMap:
    """Return the state of a chain over a plane of its parameters.

    Parameters
    ----------
    chain : Chain
        The chain with the parameters that do not vary.
    axes : mapping of str to sequence of float
        Values of one or more parameters.
    nucleus : Nucleus, optional
        Excited sites; by default those of the paper's figure.
    displacement : float, optional
        Displacement of the excited sites; by default 6 for a Van der Pol chain, otherwise that of
        the excited state of a single cell.
    start_point : StartPoint, optional
        Point of the cycle from which excited sites of the friction chain start.
    end : float, optional
        End time; a state that is found only after half of it does not count (default 2000 in slow
        time eps t, for the friction chain 20000 in tau).
    refine : float, optional
        Bisect boundaries down to this fraction of the grid spacing; 0 for no bisection.
    workers : int, optional
        Number of processes; by default 1 for the averaged chain, otherwise one per core.
    scheduler : str, optional
        Address of a dask scheduler, as in tcp://host:8786, whose workers compute the points.
    out : Path, optional
        Table that can be resumed.
    resume : bool, optional
        Continue from OUT.part, which an interrupted run has left beside --out.
    held : str, optional
        Which of a and b is kept constant while η varies.
    amplitudes : bool, optional
        Store the amplitude of every site at the end of each run too, as one array per point; needs
        a file that ends in .zarr or .npz.
    progress : callable, optional
        Called with the fraction done.

    Returns
    -------
    StateMap
        The map; for (8) it includes a comparison with the averaged chain.

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
            "--workers counts processes of this machine: leave it out with --scheduler."
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
    if not isinstance(chain, VdpChain):
        return found
    average = replace(task, chain=chain.averaged(), amplitudes=False)
    agreement = found.agreement(state_map(average, refine=0.0, workers=1, **values))
    return replace(found, averaged=agreement)


def _check_resumption(out: Path | None, resume: bool) -> None:
    if resume and out is None:
        raise UsageError(
            "--resume needs --out with a .csv or .zarr file, the file of the interrupted run."
        )
    if out is None:
        return
    from verification.execution.sweep import part_path

    part = part_path(boundary_path(out))
    # checked before the map overwrites the results of an interrupted run
    if part.exists() and not resume:
        raise UsageError(f"{part} was left by an interrupted run: give --resume, or remove it.")
