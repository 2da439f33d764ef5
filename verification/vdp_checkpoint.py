"""A run of Model II on disk: written whole or not at all, read only by the run it belongs to."""

from __future__ import annotations

import json
import os
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from theory.parameters import ParameterError
from verification.vdp_lane import Lane

_FORMAT = 1


def write_checkpoint(path: Path, lanes: Sequence[Lane], seconds: float) -> None:
    """Write the lanes and the seconds spent so far; an older file is replaced at once."""
    arrays = {
        f"{i}.{name}": kept for i, lane in enumerate(lanes) for name, kept in lane.kept.items()
    }
    stamp = json.dumps({"format": _FORMAT, "lanes": [lane.stamp for lane in lanes]})
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=".writing-", suffix=".npz")
    try:
        with os.fdopen(handle, "wb") as file:
            np.savez(file, stamp=np.array(stamp), seconds=np.array(seconds), **arrays)  # type: ignore[arg-type]
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
    ours = {"format": _FORMAT, "lanes": [lane.stamp for lane in lanes]}
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
