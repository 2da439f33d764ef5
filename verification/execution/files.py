"""Writing files completely or not at all; every file that the toolkit writes is written here.

A plain file is written next to its destination, flushed to disk and renamed, so that after a kill
or with a full disk a reader finds the old file or the new one, but never a part of one. A symbolic
link is kept, and the file it points to is written; a FIFO receives the content; a folder, a device
or a socket is refused and not touched. The only kind of folder that is written is a zarr store, by
the same rule.
"""

from __future__ import annotations

import csv
import errno
import io
import json
import os
import stat
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any, BinaryIO, TextIO

if sys.platform != "win32":  # on Windows, two writers of one file are not detected
    import fcntl

PREFIX = ".writing-"
"""Prefix of the names of files that are being written; a kill may leave one behind."""

ZARR_MARK = ".zgroup"
"""An entry that every zarr store has, and that no other folder has."""

_REMEDIES = {
    errno.ENOSPC: "free some space, or name a file on another disk",
    errno.EDQUOT: "free some space, or name a file on another disk",
    errno.EFBIG: "raise the limit on the size of files (ulimit -f), or name a file elsewhere",
    errno.EPIPE: "keep its reader open until everything is written",
    errno.EIO: "check the disk, or name a file on another one",
    errno.ELOOP: "repair the symbolic link, or name another file",
    errno.ENOENT: "create the folder first, or name another file",
}


class FileError(OSError):
    """A file that cannot be used; one sentence states which, why, and what to do.

    Parameters
    ----------
    path : Path
        The file.
    why : str
        What is wrong with it.
    remedy : str
        Remedy for the user.
    number : int, optional
        Error number of the system, `errno.EINVAL` if there was none.

    Attributes
    ----------
    quantity, value, allowed, remedy
        As in `theory.parameters.ParameterError`.

    Examples
    --------
    >>> print(FileError(Path("/dev/null"), "is a device", "name a file"))
    the file /dev/null is a device: name a file.
    """

    def __init__(self, path: Path, why: str, remedy: str, number: int = errno.EINVAL) -> None:
        super().__init__(number, why, str(path))
        self.quantity, self.value = "file", str(path)
        self.allowed, self.remedy = "a file that can be written", remedy

    def __str__(self) -> str:
        return f"the file {self.filename} {self.strerror}: {self.remedy}."

    def __reduce__(self) -> tuple[type[FileError], tuple[Path, str, str, int]]:
        number = errno.EINVAL if self.errno is None else self.errno
        return FileError, (Path(self.value), str(self.strerror), self.remedy, number)


def file_error(path: Path, error: OSError, verb: str = "written") -> FileError:
    """Return the sentence for a system error on reading or writing a file.

    Examples
    --------
    >>> print(file_error(Path("run.npz"), OSError(errno.ENOSPC, "No space left on device")))
    the file run.npz cannot be written: no space left on device: free some space, or name a file \
on another disk.
    """
    if isinstance(error, FileError):
        return error
    problem = error.strerror or str(error) or type(error).__name__
    problem = f"cannot be {verb}: {problem[:1].lower()}{problem[1:]}"
    number = errno.EIO if error.errno is None else error.errno
    return FileError(path, problem, _REMEDIES.get(number, "name another file"), number)


def check_writable(path: Path) -> None:
    """Refuse, before any work is done, a file that could not be written; nothing is left behind.

    Writing to the folder is tried out, since permissions do not show whether a file system refuses.

    Raises
    ------
    FileError
        If it is a folder, a device or a socket, its folder is missing, or it is not writable.
    """
    target = _target(path)
    if target is None:
        return
    if target.exists() and not os.access(target, os.W_OK):
        raise FileError(path, "cannot be written: no permission", "name another file", errno.EACCES)
    import tempfile  # here and below, because most commands write no file

    try:
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=PREFIX)
        os.close(handle)
        Path(name).unlink()
    except OSError as error:
        raise file_error(path, error) from None


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file, completely or not at all.

    Raises
    ------
    FileError
        If this is not possible; an existing file is then left intact.
    """
    with writing(path) as file:
        file.write(content)


def write_text(path: Path, text: str) -> None:
    """Write a text in UTF-8 with single-character line ends; otherwise as `write_bytes`."""
    write_bytes(path, text.encode())


def write_json(path: Path, payload: Mapping[str, Any]) -> None:
    """Write a JSON object, which must not contain NaN; otherwise as `write_bytes`."""
    write_text(path, json.dumps(payload, indent=1, ensure_ascii=False, allow_nan=False) + "\n")


def write_csv(file: TextIO, names: Iterable[str], rows: Iterable[Iterable[object]]) -> None:
    r"""Write a line of names and a line for each row.

    Floats are written with enough digits to be read back exactly; None is an empty cell.

    Examples
    --------
    >>> text = io.StringIO()
    >>> write_csv(text, ["c", "v", "odd"], [(0.1, None, True), (1, 0.5, "by hand, twice")])
    >>> text.getvalue()
    'c,v,odd\n0.1,,True\n1,0.5,"by hand, twice"\n'
    """
    writer = csv.writer(file, lineterminator="\n")
    writer.writerow(names)
    writer.writerows(rows)


def write_by(path: Path, write: Callable[[Path], object]) -> None:
    """Write a file by a function that takes a path, such as ``savefig``.

    Parameters
    ----------
    path : Path
        The file.
    write : callable
        Fills the file at the given path, which has the same suffix, or creates a folder there.

    Raises
    ------
    FileError
        If this is not possible; what was there before is then left intact.
    """
    target = _target(path)
    if target is None:
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            part = Path(folder, path.name)
            write(part)
            _pass_on(path, part.read_bytes())
        return
    with _replacing(path, target) as part:
        write(part)
        if part.is_file():
            with part.open("rb") as file:
                os.fsync(file.fileno())


@contextmanager
def writing(path: Path) -> Iterator[BinaryIO]:
    """Open a file for writing; it replaces the old one, whole, if the block ends without an error.

    Raises
    ------
    FileError
        If this is not possible; what was there before is then left intact.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with writing(Path(folder, "a")) as file:
    ...         _ = file.write(b"whole")
    ...     Path(folder, "a").read_text()
    'whole'
    """
    target = _target(path)
    if target is None:
        buffer = io.BytesIO()
        yield buffer
        _pass_on(path, buffer.getvalue())
        return
    with _replacing(path, target) as part, part.open("wb") as file:
        yield file
        file.flush()
        os.fsync(file.fileno())


@contextmanager
def sole_writer(path: Path) -> Iterator[None]:
    """Prevent other processes from writing a file for the duration of the block.

    The lock is on a file ``<name>.lock`` next to it, since the file itself is replaced when it is
    written. It ends with the process that holds it, however that ends.

    Raises
    ------
    FileError
        If another run holds the file, or the lock cannot be made.
    """
    if sys.platform == "win32":
        yield
        return
    target = plain_file(path)
    lock = target.with_name(target.name + ".lock")
    handle = _locked(path, lock)
    try:
        yield
    finally:
        with suppress(OSError):
            lock.unlink()  # while still held: a process that opens it now gets another file
        os.close(handle)


def plain_file(path: Path) -> Path:
    """Return the plain file to which a path leads through symbolic links, existing or not.

    Raises
    ------
    FileError
        If it exists and is not a plain file, or there is no folder for it.
    """
    target = _target(path)
    if target is None:
        raise FileError(path, "is a FIFO, from which nothing can be resumed", "name a file")
    return target


def _locked(path: Path, lock: Path) -> int:
    while True:
        try:
            handle = os.open(lock, os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_NONBLOCK, 0o666)
        except OSError as error:
            raise file_error(lock, error) from None
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
            with suppress(OSError):
                if os.path.samestat(os.fstat(handle), os.stat(lock)):
                    return handle
        except OSError:
            os.close(handle)
            raise FileError(
                path,
                "is in use by another run",
                "wait until that run has ended, or name another file",
                errno.EBUSY,
            ) from None
        os.close(handle)  # its holder has just removed it


def _target(path: Path) -> Path | None:
    """Return the plain file to which a path leads, existing or not; None for a FIFO."""
    try:
        mode = path.stat().st_mode
    except FileNotFoundError:
        target = Path(os.path.realpath(path))
        if not target.parent.is_dir():
            why = f"cannot be written: the folder {target.parent} does not exist"
            raise FileError(path, why, "create the folder first", errno.ENOENT) from None
        return target
    except (OSError, ValueError) as error:
        cause = error if isinstance(error, OSError) else OSError(errno.EINVAL, str(error))
        raise file_error(path, cause) from None
    if stat.S_ISREG(mode):
        return Path(os.path.realpath(path))
    if stat.S_ISFIFO(mode):
        if path.suffix.lower() == ".zarr":
            raise FileError(path, "is a FIFO, which cannot hold a zarr store", "name another file")
        return None
    if stat.S_ISDIR(mode):
        if (path / ZARR_MARK).is_file():
            return Path(os.path.realpath(path))
        raise FileError(path, "is a folder", "name a file in it", errno.EISDIR)
    kind = "a socket" if stat.S_ISSOCK(mode) else "a device"
    raise FileError(path, f"is {kind}", "name a file")


@contextmanager
def _replacing(path: Path, target: Path) -> Iterator[Path]:
    """Provide a neighbour with the same suffix; it is renamed if the block ends without error."""
    import shutil
    import tempfile

    part = None
    try:
        mode = target.stat().st_mode & 0o777 if target.exists() else 0o666 & ~_umask()
        if target.exists() and not os.access(target, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=PREFIX, suffix=target.suffix)
        os.close(handle)
        part = Path(name)
        yield part
        if part.is_file():
            part.chmod(mode)
        # a folder cannot replace a file, nor a file or a folder one that is not empty
        if target.is_dir() or (part.is_dir() and target.exists()):
            target.rename(part.with_suffix(".old"))
        part.replace(target)
        _sync_folder(target.parent)
    except OSError as error:
        raise file_error(path, error) from None
    finally:
        if part is not None:
            old = part.with_suffix(".old")
            if old.exists() and not target.exists():  # the new one did not take its place
                old.rename(target)
            for left in (part, old):
                shutil.rmtree(left, ignore_errors=True)
                with suppress(OSError):
                    left.unlink()


def _pass_on(path: Path, content: bytes) -> None:
    try:
        with path.open("wb") as file:
            file.write(content)
    except OSError as error:
        raise file_error(path, error) from None


def _sync_folder(folder: Path) -> None:
    """Flush the new name to disk, if the system supports this."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
