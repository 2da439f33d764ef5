"""The journal of a sweep: one checked line a finished point, usable after a kill at any moment.

The first line holds the stamp, every other one an index and a result, each as JSON with a checksum
in front. Lines are only ever appended. A last line without its end is cut off on opening; a line
whose checksum is wrong is passed over and its point computed again.
"""

from __future__ import annotations

import json
import logging
import os
import sys
import time
import zlib
from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Any

from theory.parameters import ParameterError
from verification.execution.table import Scalar

if sys.platform != "win32":  # there, two sweeps into one file are not told apart
    import fcntl

SYNC_PERIOD = 1.0
"""Seconds between two writes forced to the disk; a kill loses nothing, a power cut this much."""

logger = logging.getLogger(__name__)


def journal_path(out: Path) -> Path:
    """Return where the journal of the table ``out`` is.

    Examples
    --------
    >>> journal_path(Path("map.csv")).name
    'map.csv.part'
    """
    return out.with_name(out.name + ".part")


def checked_line(record: object) -> bytes:
    """Return a record as one line, its checksum first."""
    text = json.dumps(record, sort_keys=True, separators=(",", ":")).encode()
    return b"%08x %s\n" % (zlib.crc32(text), text)


def read_line(line: bytes) -> Any:
    """Return the record of a line.

    Raises
    ------
    ValueError
        If the checksum is wrong or missing.
    """
    check, _, text = line.rstrip(b"\n").partition(b" ")
    if check != b"%08x" % zlib.crc32(text):
        raise ValueError("checksum")
    return json.loads(text)


class Journal:
    """An open journal; a context manager that closes it and leaves the file.

    Parameters
    ----------
    path : Path
        The file; made if it does not exist.
    stamp : mapping
        What is being computed; a journal with another stamp is refused.
    total : int
        Number of points.
    resume : bool
        Whether a file that exists is gone on with.

    Attributes
    ----------
    finished : dict of int to mapping
        Results found in the file, by index of the point.

    Raises
    ------
    ParameterError
        If the file exists and ``resume`` is false, is in use, is no journal, or has another stamp.
    """

    def __init__(self, path: Path, stamp: Mapping[str, Any], total: int, resume: bool) -> None:
        self._path = path
        self.finished: dict[int, dict[str, Scalar]] = {}
        self._synced = time.perf_counter()
        # Opened for appending, the file is neither emptied nor overwritten by a second sweep.
        self._file = path.open("a+b")
        try:
            self._lock()
            self._file.seek(0)
            content = self._file.read()
            if content and not resume:
                raise self._refusal(
                    "left by an interrupted sweep",
                    "absent where a sweep begins",
                    "resume it (--resume), or remove it",
                )
            self._begin(content, checked_line(dict(stamp)), stamp, total)
        except BaseException:
            self._file.close()
            raise

    def __enter__(self) -> Journal:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def add(self, index: int, result: Mapping[str, Scalar]) -> None:
        """Append a finished point; it survives the end of this process."""
        self._file.write(checked_line({"index": index, "result": list(result.items())}))
        self._file.flush()
        if time.perf_counter() - self._synced > SYNC_PERIOD:
            os.fsync(self._file.fileno())
            self._synced = time.perf_counter()

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    def remove(self) -> None:
        """Close the file and delete it: the table is written."""
        self._path.unlink(missing_ok=True)
        self._file.close()

    def _begin(self, content: bytes, header: bytes, stamp: Mapping[str, Any], total: int) -> None:
        if header.startswith(content) and content != header:
            self._file.truncate(0)  # killed while the stamp was written, or new
            self._file.write(header)
            self._file.flush()
            return
        first, *lines = content.splitlines(keepends=True)
        try:
            found = read_line(first)
        except ValueError:
            found = None
        if not first.endswith(b"\n") or not isinstance(found, dict):
            raise self._refusal(
                "unreadable", "the journal of a sweep", "remove it, or give another --out"
            )
        if first != header:
            raise self._refusal(
                f"from another sweep (different: {_differences(found, stamp)})",
                "from this task with these parameters, points and versions",
                "remove it, or give another --out",
            )
        if lines and not lines[-1].endswith(b"\n"):
            logger.info("the last line of %s is half-written and is dropped", self._path)
            self._file.truncate(len(content) - len(lines.pop()))
        for number, line in enumerate(lines, start=2):
            try:
                record = read_line(line)
                index, result = int(record["index"]), dict(record["result"])
            except (ValueError, KeyError, TypeError):
                logger.warning("line %d of %s is damaged and is ignored", number, self._path)
                continue
            if 0 <= index < total:
                self.finished.setdefault(index, result)

    def _lock(self) -> None:
        if sys.platform == "win32":
            return
        try:
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            raise self._refusal(
                "in use", "free", "wait for the other sweep to end, or give another --out"
            ) from None

    def _refusal(self, value: str, allowed: str, remedy: str) -> ParameterError:
        return ParameterError(f"journal {self._path}", value, allowed, remedy)


def _differences(found: Mapping[str, Any], wanted: Mapping[str, Any]) -> str:
    """Return the names of the entries that differ, those of inner mappings with a dot."""
    names = []
    for name in sorted({*found, *wanted}):
        old, new = found.get(name), wanted.get(name)
        if isinstance(old, dict) and isinstance(new, dict):
            names += [
                f"{name}.{key}" for key in sorted({*old, *new}) if old.get(key) != new.get(key)
            ]
        elif old != new:
            names.append(name)
    return ", ".join(names)
