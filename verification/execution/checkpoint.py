"""Running lanes to their end, with a file to go on from: the same for both models.

The file is written whole or not at all, and read only by the run it belongs to.
"""

from __future__ import annotations

import json
import os
import tempfile
import zipfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from time import perf_counter
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from theory.parameters import ParameterError, within

_FORMAT = 2
_SAVE_SECONDS = 5.0

MOST_NUMBERS = 10**8
"""Samples times sites that a run may keep: some gigabytes."""


class Lane(Protocol):
    """A run at one tolerance."""

    @property
    def kept(self) -> Mapping[str, npt.NDArray[Any]]:
        """The arrays that make up its state; filled in place when it is resumed."""

    @property
    def stamp(self) -> Mapping[str, float | int | str | bool]:
        """What decides it, to be held against a checkpoint."""

    @property
    def time(self) -> float:
        """Time reached."""

    @property
    def finished(self) -> bool:
        """Whether it has reached its end."""

    def go_on(self, budget: int) -> None:
        """Step until the end, or until some ``budget`` of sites times steps is spent."""


def check_samples(samples: float, sites: int) -> None:
    """Refuse more samples than memory has room for.

    Raises
    ------
    ParameterError
        If there are fewer than 2, or samples times sites is above ``MOST_NUMBERS``.
    """
    within("number of samples", samples, 2, 1_000_000)
    most = MOST_NUMBERS // sites
    if samples > most:
        raise ParameterError(
            "number of samples", samples, f"at most {most} for {sites} sites", "keep fewer samples"
        )


def run_through(
    lanes: Sequence[Lane],
    end: float,
    budget: int,
    checkpoint: Path | None = None,
    progress: Callable[[float], None] | None = None,
) -> float:
    """Run the lanes, one after another, to their end; return the seconds of earlier runs.

    Parameters
    ----------
    lanes : sequence of Lane
        The runs.
    end : float
        Their end time.
    budget : int
        Sites times steps between two looks at the clock.
    checkpoint : Path, optional
        File in which the lanes are kept every few seconds and when they are interrupted. If it
        exists, they go on from it, to the same bits.
    progress : callable, optional
        Told the fraction done, now and then.

    Raises
    ------
    ParameterError
        If the checkpoint belongs to another run.
    """
    begin = saved = perf_counter()
    spent = 0.0
    if checkpoint is not None and checkpoint.exists():
        spent = read_checkpoint(checkpoint, lanes)

    def keep() -> None:
        if checkpoint is not None:
            write_checkpoint(checkpoint, lanes, spent + perf_counter() - begin)

    try:
        for lane in lanes:
            while not lane.finished:
                lane.go_on(budget)
                if progress is not None:
                    progress(sum(each.time for each in lanes) / (len(lanes) * end))
                if perf_counter() - saved > _SAVE_SECONDS:
                    keep()
                    saved = perf_counter()
    except KeyboardInterrupt:
        keep()
        raise
    keep()
    return spent


def write_checkpoint(path: Path, lanes: Sequence[Lane], seconds: float) -> None:
    """Write the lanes and the seconds spent so far; an older file is replaced at once."""
    arrays: dict[str, Any] = {
        f"{i}.{name}": kept for i, lane in enumerate(lanes) for name, kept in lane.kept.items()
    }
    stamp = json.dumps({"format": _FORMAT, "lanes": [dict(lane.stamp) for lane in lanes]})
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=".writing-", suffix=".npz")
    try:
        with os.fdopen(handle, "wb") as file:
            np.savez(file, stamp=np.array(stamp), seconds=np.array(seconds), **arrays)
        Path(name).replace(path)
    finally:
        Path(name).unlink(missing_ok=True)


def read_checkpoint(path: Path, lanes: Sequence[Lane]) -> float:
    """Fill the lanes from the file and return the seconds spent before.

    Raises
    ------
    ParameterError
        If the file is no checkpoint, or of another run; it names what differs.
    """
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            stamp = json.loads(str(file["stamp"]))
            stored = {name: file[name] for name in file.files}
    except (OSError, ValueError, KeyError, zipfile.BadZipFile, EOFError):
        raise ParameterError(
            "checkpoint", path, "a file written by an earlier run", "name another file"
        ) from None
    ours = {"format": _FORMAT, "lanes": [dict(lane.stamp) for lane in lanes]}
    if stamp != ours:
        raise ParameterError(
            "checkpoint", path, f"of a run with the same parameters ({_differences(stamp, ours)})",
            "repeat those parameters, or name another file",
        )  # fmt: skip
    for i, lane in enumerate(lanes):
        for name, kept in lane.kept.items():
            kept[...] = stored[f"{i}.{name}"]
    return float(stored["seconds"])


def _differences(stamp: dict[str, object], ours: dict[str, object]) -> str:
    """Say which parameters differ, as ``c: 0.5 there, 0.6 here``."""
    theirs, own = stamp.get("lanes"), ours["lanes"]
    if not isinstance(theirs, list) or not isinstance(own, list) or len(theirs) != len(own):
        return "another kind of run"
    found = {
        f"{key}: {one.get(key)} there, {other[key]} here"
        for one, other in zip(theirs, own, strict=True)
        for key in other
        if one.get(key) != other[key]
    }
    return "; ".join(sorted(found)) or "another version"
