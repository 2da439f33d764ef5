"""Faults of the disk, injected at the n-th thing that is done to it: an error, or a kill.

What SQLite does is reached by its own means for that purpose, ``xSetSystemCall`` of its file
system; what Python does, by standing in for the functions that `verification.execution.files` uses.
A kill is played by copying the folder as it is at that moment, half of a write done; whoever looks
at the copy sees what the next process would see.
"""

from __future__ import annotations

import _sqlite3
import ctypes
import errno
import io
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

_WRITE = ctypes.CFUNCTYPE(
    ctypes.c_ssize_t, ctypes.c_int, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int64,
    use_errno=True,
)  # fmt: skip


class _FileSystem(ctypes.Structure):
    """``sqlite3_vfs``, of whose members only the last ones are used."""

    _fields_ = (
        ("version", ctypes.c_int), ("size", ctypes.c_int), ("longest", ctypes.c_int),
        ("next", ctypes.c_void_p), ("name", ctypes.c_char_p), ("data", ctypes.c_void_p),
        ("members", ctypes.c_void_p * 13),
        ("set", ctypes.CFUNCTYPE(
            ctypes.c_int, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)),
        ("get", ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_char_p)),
    )  # fmt: skip


class Disk:
    """A disk on which the n-th operation fails, or after which each is copied as for a kill.

    Parameters
    ----------
    folder : Path
        What is copied.
    fails : int, optional
        Number of the operation that fails, from 0; all later ones succeed.
    number : int, optional
        The error.
    copies : Path, optional
        Where the folder is copied to at each operation.
    """

    def __init__(
        self,
        folder: Path,
        *,
        fails: int | None = None,
        number: int = errno.EIO,
        copies: Path | None = None,
    ) -> None:
        self.folder, self.fails, self.number, self.copies = folder, fails, number, copies
        self.count = 0

    def fault(self) -> int:
        """Count an operation; return its error, or 0."""
        failing = self.count == self.fails
        if self.copies is not None:
            shutil.copytree(self.folder, self.copies / f"{self.count:04d}")
        self.count += 1
        return self.number if failing else 0

    def check(self) -> None:
        """Count an operation of Python; raise its error."""
        number = self.fault()
        if number:
            raise OSError(number, os.strerror(number))


@contextmanager
def injected(disk: Disk) -> Iterator[Disk]:
    """Let SQLite and `verification.execution.files` work on this disk."""
    with pytest.MonkeyPatch.context() as patch, _sqlite_on(disk):
        _python_on(disk, patch)
        yield disk


def _python_on(disk: Disk, patch: pytest.MonkeyPatch) -> None:
    usual_open, replace = Path.open, Path.replace

    class Written(io.FileIO):
        def write(self, data: Any, /) -> int:
            view = memoryview(data).cast("B")
            half = len(view) // 2
            done = super().write(view[:half])
            disk.check()  # half of it is there
            return done + super().write(view[half:])

    def opened(path: Path, mode: str = "r", *args: Any, **options: Any) -> Any:
        if disk.folder in path.parents and "w" in mode:
            return Written(path, "w")
        return usual_open(path, mode, *args, **options)

    def replaced(path: Path, target: Path) -> Path:
        disk.check()
        return replace(path, target)

    def synced(_: int) -> None:
        disk.check()  # and no more: a kill, unlike a power cut, leaves what was written

    patch.setattr(Path, "open", opened)
    patch.setattr(Path, "replace", replaced)
    patch.setattr("verification.execution.files.os.fsync", synced)


@contextmanager
def _sqlite_on(disk: Disk) -> Iterator[None]:
    library = ctypes.CDLL(_sqlite3.__file__)
    try:
        find = library.sqlite3_vfs_find
    except AttributeError:
        pytest.skip("this Python's SQLite does not show its file system")
    find.restype = ctypes.POINTER(_FileSystem)
    system = find(None)
    inner = system.contents
    name = next((name for name in (b"pwrite64", b"pwrite") if inner.get(system, name)), None)
    if name is None:
        pytest.skip("this SQLite does not write by pwrite")
    write = _WRITE(inner.get(system, name))

    def stand_in(handle: int, data: int, size: int, place: int) -> int:
        if write(handle, data, size // 2, place) < 0:
            return -1
        number = disk.fault()  # half of it is there
        if number:
            ctypes.set_errno(number)
            return -1
        return int(write(handle, data, size, place))

    standing = _WRITE(stand_in)
    inner.set(system, name, ctypes.cast(standing, ctypes.c_void_p))
    try:
        yield
    finally:
        inner.set(system, None, None)  # all as they were
