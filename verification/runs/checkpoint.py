"""Checkpoints: a run of a chain is saved so that it can later continue bit for bit.

A checkpoint is an ``.npz`` file with the arrays that make up the state, everything that determines
the run (format, parameters, code, versions) and a digest of all this. The contents of the file
never decide how much memory is allocated: the run that resumes provides its own arrays, and each
array in the file must have the same type and shape. The digest protects against damage, not against
somebody who forges a file together with its digest; such a file can produce wrong numbers, but
cannot run code.
"""

from __future__ import annotations

import errno
import json
import math
import zipfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.lib import format as npy

from theory.arrays import AnyArray
from theory.parameters import ParameterError, RunError
from verification.execution.digest import digest_of_arrays
from verification.execution.files import file_error, sole_writer, writing
from verification.execution.interruption import Deferred, deferred_interrupts
from verification.execution.metadata import differences, installed_versions
from verification.execution.progress import ProgressCallback
from verification.execution.task import code_of
from verification.runs.integration import Integration

FORMAT = 3
"""Format of the file; files in another format are refused."""

SAVE_PERIOD = 5.0
"""Seconds between two checkpoints."""

SAVE_SHARE = 20.0
"""Smallest interval between two checkpoints, as a multiple of the time that writing one takes."""

_MAX_HEADER = 1_000_000
"""Largest size in bytes of the entry that describes the run."""

_DEPENDS_ON = ("python", "numpy", "scipy", "numba")
"""Packages whose versions may change the last bit of a run."""

_WRITTEN = "a checkpoint written by this toolkit"

Arrays = Mapping[str, AnyArray]


def run_to_end(
    integrations: Sequence[Integration],
    end: float,
    budget: int,
    checkpoint: Path | None,
    progress: ProgressCallback | None,
) -> float:
    """Advance integrations one after another to their end; return the seconds of earlier sessions.

    Parameters
    ----------
    integrations : sequence of Integration
        The integrations; the ``state_arrays`` of each are filled in place on resumption.
    end : float
        Their end time.
    budget : int
        Sites times steps between two readings of the clock.
    checkpoint : Path or None
        File into which they are saved every few seconds and when they are interrupted from the
        keyboard or by SIGTERM. If it exists, they are resumed from it and continue bit for bit.
    progress : callable or None
        See `verification.execution.progress.ProgressCallback`.

    Raises
    ------
    ParameterError
        If the checkpoint is damaged, or belongs to another run, code or version.
    FileError
        If the checkpoint cannot be written, or another run is writing to it.
    RunError
        If an integration does not advance.
    """
    begin = perf_counter()
    with sole_writer(checkpoint) if checkpoint else nullcontext():
        earlier_seconds = 0.0
        metadata = _metadata(integrations) if checkpoint else {}  # of the code as it is now
        if checkpoint is not None and checkpoint.exists():
            earlier_seconds = _resumed(checkpoint, integrations, metadata, end)

        def save() -> None:
            if checkpoint is not None:
                seconds = max(0.0, earlier_seconds + perf_counter() - begin)
                save_checkpoint(checkpoint, _arrays(integrations), metadata, seconds)

        _advance(integrations, end, budget, save if checkpoint else None, progress)
        save()
    return earlier_seconds


def _advance(
    integrations: Sequence[Integration],
    end: float,
    budget: int,
    save: Callable[[], None] | None,
    progress: ProgressCallback | None,
) -> None:
    """Advance to the end; save at intervals, and when interrupted between two pieces of work.

    An interrupt waits for the end of a piece: within one, the arrays are not a consistent state.
    """
    next_save = perf_counter() + SAVE_PERIOD
    with deferred_interrupts() if save is not None else nullcontext(Deferred()) as interrupts:
        for each in integrations:
            while not each.finished:
                before = each.time
                each.advance(budget)
                each.check_pace()
                if not (each.finished or each.time >= before):
                    raise RunError(
                        f"the run does not advance from time {before:g}: remove its checkpoint, if "
                        "it was resumed, or begin from another state."
                    )
                try:
                    interrupts.check()
                    if progress is not None:
                        progress(sum(one.time for one in integrations) / (len(integrations) * end))
                except KeyboardInterrupt:
                    if save is not None:
                        save()
                    raise
                if save is not None and perf_counter() > next_save:
                    started = perf_counter()
                    save()
                    next_save = perf_counter() + max(
                        SAVE_PERIOD, SAVE_SHARE * (perf_counter() - started)
                    )


def _resumed(
    path: Path, integrations: Sequence[Integration], metadata: Mapping[str, Any], end: float
) -> float:
    """Fill integrations from a checkpoint, and return the seconds spent in earlier sessions."""
    seconds = load_checkpoint(path, _arrays(integrations), metadata)
    for each in integrations:
        try:
            each.check_state()
        except ValueError as error:
            raise _refusal(path, f"a state of this run ({error})") from None
        if not 0.0 <= each.time <= end:  # with a time of NaN the run would never end
            raise _refusal(path, f"of a run with times from 0 to {end:g}, not {each.time:g}")
    return seconds


def _arrays(integrations: Iterable[Integration]) -> dict[str, AnyArray]:
    return {
        f"{i}.{name}": array
        for i, each in enumerate(integrations)
        for name, array in each.state_arrays.items()
    }


def _metadata(integrations: Sequence[Integration]) -> dict[str, Any]:
    # The equation of a user-defined chain may be in another module.
    owners = [*integrations, *(each.chain for each in integrations)]
    return {
        "integrations": {str(i): dict(each.metadata) for i, each in enumerate(integrations)},
        "code": code_of(*map(type, owners)).digest,
    }


def save_checkpoint(
    path: Path, arrays: Arrays, metadata: Mapping[str, Any], seconds: float
) -> None:
    """Write the state arrays and the metadata that determine them, completely or not at all.

    Parameters
    ----------
    path : Path
        The file.
    arrays : mapping of str to ndarray
        The state; arrays of objects are not allowed.
    metadata : mapping
        What determines the run, as JSON data; `load_checkpoint` requires the same.
    seconds : float
        Run time so far.

    Raises
    ------
    FileError
        If the file cannot be written; an older file is then left intact.
    """
    header = {
        "format": FORMAT,
        "metadata": {**_plain(metadata), "versions": _versions()},
        "seconds": float(seconds),
        "digest": digest_of_arrays(arrays),
    }
    with writing(path) as file, zipfile.ZipFile(file, "w", zipfile.ZIP_STORED) as box:
        # A fixed date in the entries, so that nothing depends on a clock that may be wrong.
        box.writestr(zipfile.ZipInfo("header.json"), json.dumps(header))
        for name, array in arrays.items():
            with box.open(zipfile.ZipInfo(f"{name}.npy"), "w", force_zip64=True) as entry:
                npy.write_array(entry, np.asarray(array, order="C"), allow_pickle=False)


def load_checkpoint(path: Path, arrays: Arrays, metadata: Mapping[str, Any]) -> float:
    """Fill arrays in place from a checkpoint, and return the seconds spent in earlier sessions.

    Parameters
    ----------
    path : Path
        The file.
    arrays : mapping of str to ndarray
        Arrays as for a new run; all of them are filled if all fit, otherwise none.
    metadata : mapping
        What determines the run that is to be resumed.

    Raises
    ------
    ParameterError
        If the file is not a checkpoint, is damaged, or belongs to another run, code or version; the
        message names what differs.
    FileError
        If the file cannot be read.
    """
    try:
        with path.open("rb") as file, zipfile.ZipFile(file) as archive:
            header = _header(archive)
            _check_header(path, header, metadata)
            found = {name: _read(archive, f"{name}.npy", like) for name, like in arrays.items()}
    except ParameterError:
        raise
    except OSError as error:
        if error.errno == errno.EINVAL:  # the file refers to a position beyond its own end
            raise _refusal(path, _WRITTEN) from None
        raise file_error(path, error, "read") from None
    except (ValueError, KeyError, TypeError, EOFError, RecursionError, NotImplementedError,
            RuntimeError, zipfile.BadZipFile, zipfile.LargeZipFile, OverflowError):  # fmt: skip
        raise _refusal(path, _WRITTEN) from None
    if digest_of_arrays(found) != header["digest"]:
        raise _refusal(path, "unchanged since it was written; its content is damaged")
    for name, array in arrays.items():
        array[...] = found[name]
    return float(header["seconds"])


def _header(archive: zipfile.ZipFile) -> dict[str, Any]:
    with archive.open("header.json") as entry:
        text = entry.read(_MAX_HEADER)
    header: dict[str, Any] = json.loads(text)
    if not isinstance(header["metadata"], dict):
        raise TypeError("header")
    seconds = header["seconds"]
    if isinstance(seconds, bool):  # other types that are not numbers cannot be compared with one
        raise TypeError("seconds")
    if not (0.0 <= seconds < math.inf and isinstance(header["digest"], str)):
        raise ValueError("seconds")
    return header


def _check_header(path: Path, header: Mapping[str, Any], metadata: Mapping[str, Any]) -> None:
    if header["format"] != FORMAT:
        raise _refusal(path, f"a checkpoint of format {FORMAT}")
    expected = {**_plain(metadata), "versions": _versions()}
    if header["metadata"] != expected:
        listed = differences(header["metadata"], expected)
        raise _refusal(
            path, f"of a run with the same parameters, code and versions ({listed})",
            "use the same ones, or name another file",
        )  # fmt: skip


def _read(archive: zipfile.ZipFile, name: str, template: AnyArray) -> AnyArray:
    """Read an array that must have the type and shape of a given one."""
    with archive.open(name) as entry:
        major = npy.read_magic(entry)
        read = npy.read_array_header_1_0 if major == (1, 0) else npy.read_array_header_2_0
        shape, fortran, dtype = read(entry)
        if shape != template.shape or dtype != template.dtype or fortran:
            raise ValueError("shape")
        entry.seek(0)
        found: AnyArray = npy.read_array(entry, allow_pickle=False)
        if entry.read(1):
            raise ValueError("length")
    return found


def _refusal(
    path: Path, allowed: str, remedy: str = "remove it, or name another file"
) -> ParameterError:
    return ParameterError("checkpoint", path, allowed, remedy)


def _plain(metadata: Mapping[str, Any]) -> dict[str, Any]:
    plain: dict[str, Any] = json.loads(json.dumps(dict(metadata)))
    return plain


def _versions() -> dict[str, str | None]:
    found = installed_versions(_DEPENDS_ON[1:])
    return {name: found[name] for name in _DEPENDS_ON}
