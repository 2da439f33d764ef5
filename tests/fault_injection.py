"""Faults injected at the n-th thing done: an error of the disk, a kill, an array without memory.

What SQLite does is reached by its own means for that purpose, ``xSetSystemCall`` of its file
system; what Python does, by standing in for the functions that `verification.execution.files` uses.
A kill is played by copying the folder as it is at that moment, half of a write done; whoever looks
at the copy sees what the next process would see. Memory runs out by NumPy's own means for that
purpose, a handler of the data of arrays (NEP 49).
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

import numpy as np
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
            file = Written(path, "w")
            return file if "b" in mode else io.TextIOWrapper(file, *args, **options)  # type: ignore[type-var]
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


class Memory:
    """Memory of which the n-th block of an array is refused.

    Parameters
    ----------
    fails : int, optional
        Number of the block, from 0; all later ones are given.
    least : int, optional
        Bytes from which on a block counts.
    """

    def __init__(self, *, fails: int | None = None, least: int = 0) -> None:
        self.fails, self.least = fails, least
        self.count = 0

    def refuses(self, size: int) -> bool:
        """Count a block if it is large; return whether it is the one that is refused."""
        if size < self.least:
            return False
        self.count += 1
        return self.count - 1 == self.fails


_MALLOC = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)
_CALLOC = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_size_t)
_REALLOC = ctypes.PYFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t)


class _Handler(ctypes.Structure):
    """``PyDataMem_Handler``; what it frees goes where it would without this."""

    _fields_ = (
        ("name", ctypes.c_char * 127), ("version", ctypes.c_uint8), ("context", ctypes.c_void_p),
        ("malloc", _MALLOC), ("calloc", _CALLOC), ("realloc", _REALLOC), ("free", ctypes.c_void_p),
    )  # fmt: skip


_HANDLERS: list[object] = []
"""All that were in use: an array that lives on refers to its own."""


@contextmanager
def limited(memory: Memory) -> Iterator[Memory]:
    """Let NumPy take the data of its arrays from this memory."""
    inside = ctypes.pythonapi.PyCapsule_GetPointer
    inside.restype, inside.argtypes = ctypes.c_void_p, (ctypes.py_object, ctypes.c_char_p)
    capsule = ctypes.pythonapi.PyCapsule_New
    capsule.restype = ctypes.py_object
    capsule.argtypes = (ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p)
    functions = ctypes.cast(
        inside(np._core._multiarray_umath._ARRAY_API, None),  # type: ignore[attr-defined]
        ctypes.POINTER(ctypes.c_void_p),
    )
    put = ctypes.PYFUNCTYPE(ctypes.py_object, ctypes.py_object)(functions[304] or 0)
    get = ctypes.PYFUNCTYPE(ctypes.py_object)(functions[305] or 0)
    usual = ctypes.cast(inside(get(), b"mem_handler"), ctypes.POINTER(_Handler)).contents

    def malloc(context: int, size: int) -> int | None:
        return None if memory.refuses(size) else usual.malloc(context, size)

    def calloc(context: int, count: int, size: int) -> int | None:
        return None if memory.refuses(count * size) else usual.calloc(context, count, size)

    def realloc(context: int, block: int, size: int) -> int | None:
        return None if memory.refuses(size) else usual.realloc(context, block, size)

    standing = _Handler.from_buffer_copy(usual)
    standing.malloc, standing.calloc = _MALLOC(malloc), _CALLOC(calloc)
    standing.realloc = _REALLOC(realloc)
    _HANDLERS.extend((standing, standing.malloc, standing.calloc, standing.realloc))
    before = put(capsule(ctypes.addressof(standing), b"mem_handler", None))
    try:
        yield memory
    finally:
        put(before)
