"""The store: finished results in one SQLite file, from which an interrupted computation continues.

A result that has been added survives the end of this process at any moment, and all but the most
recent ones survive a power failure. The file holds the identity of the computation (function,
parameters, code, versions); a file of any other computation is refused, or emptied if results are
cheap. Each row carries a digest of the identity, its key and its result; a damaged row is skipped
and computed again. This protects against accidents, not against somebody who forges rows together
with their digests.

Only one process can use it at a time: SQLite's lock is held as long as the store is open, and ends
with the process.
"""

from __future__ import annotations

import errno
import hashlib
import json
import logging
import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from typing import Any

from theory.parameters import ParameterError
from verification.execution.digest import digest_of
from verification.execution.files import FileError, check_writable, file_error, plain_file
from verification.execution.metadata import differences

FORMAT = 4
"""Format of the file; files in another format are refused."""

_SCHEMA = {
    "identity": "CREATE TABLE identity (text TEXT NOT NULL)",
    "results": (
        "CREATE TABLE results (key TEXT NOT NULL PRIMARY KEY, text TEXT NOT NULL, "
        "checksum TEXT NOT NULL) WITHOUT ROWID"
    ),
}
_SETTINGS = (
    "PRAGMA trusted_schema = OFF",
    "PRAGMA page_size = 1024",
    "PRAGMA locking_mode = EXCLUSIVE",  # before the first access: no file of shared memory then
    "PRAGMA journal_mode = WAL",
    "PRAGMA synchronous = NORMAL",
)
_READABLE = "SELECT sum(length(key) + length(text) + length(checksum)) FROM results"
_FULL = ("disk is full", "disk I/O error")

logger = logging.getLogger(__name__)


class Store:
    """An open store: a context manager that closes it and keeps the file.

    Parameters
    ----------
    path : Path
        The file; created if it does not exist.
    identity : mapping
        What is computed, as JSON data.
    resume : bool
        Whether to continue with an existing file; otherwise a file that contains results is
        refused.
    replace : bool, optional
        Empty a file that does not match instead of refusing it: for results that are cheap, or a
        file that belongs to the toolkit.

    Raises
    ------
    ParameterError
        If the file is not a store, belongs to another computation, or exists while ``resume`` is
        false.
    FileError
        If it is in use or cannot be written.

    Examples
    --------
    >>> import tempfile
    >>> folder = Path(tempfile.mkdtemp())
    >>> with Store(folder / "a", {"c": 0.5}, resume=False) as store:
    ...     store.add("7", [0.25])
    >>> with Store(folder / "a", {"c": 0.5}, resume=True) as store:
    ...     store.results
    ...     store.remove()
    {'7': [0.25]}
    """

    def __init__(
        self, path: Path, identity: Mapping[str, Any], *, resume: bool, replace: bool = False
    ) -> None:
        self._path = plain_file(path)
        self._identity = json.loads(json.dumps({"format": FORMAT, **identity}))
        self._start = hashlib.sha256(digest_of(self._identity).encode())
        check_writable(path)
        try:
            self._open(resume, replace)
        except (sqlite3.DatabaseError, UnicodeDecodeError) as error:
            self.close()
            if not replace or _cannot_write(error) or _in_use(error):
                raise self._sentence(error) from None
            self._delete()
            try:
                self._open(resume, replace)
            except (sqlite3.Error, UnicodeDecodeError) as again:
                self.close()
                raise self._sentence(again) from None
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Store:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def add(self, key: str, result: object) -> None:
        """Add a finished result; it survives the end of this process.

        Raises
        ------
        FileError
            If it cannot be written; earlier results are kept.
        """
        text = json.dumps(result)
        row = (key, text, self._checksum(key, text))
        try:
            self._connection.execute("INSERT OR REPLACE INTO results VALUES (?, ?, ?)", row)
        except sqlite3.Error as error:
            raise self._sentence(error) from None

    @cached_property
    def results(self) -> dict[str, Any]:
        """The results in the file when this is first accessed, by key."""
        return dict(self.read())

    def read(self) -> Iterator[tuple[str, Any]]:
        """Yield key and result of each row, one at a time in memory, skipping damaged ones.

        Raises
        ------
        ParameterError
            If the file is damaged.
        """
        try:
            rows = self._connection.execute("SELECT key, text, checksum FROM results")
            for key, text, checksum in rows:
                try:
                    if checksum != self._checksum(key, text):
                        raise ValueError("checksum")
                    result = json.loads(text)
                except (ValueError, TypeError, RecursionError):
                    logger.warning(
                        "the result %r in %s is damaged and is computed again", key, self._path
                    )
                    continue
                yield key, result
        except sqlite3.Error as error:
            raise self._sentence(error) from None

    def close(self) -> None:
        """Close the file and release the lock."""
        # What cannot be moved from the journal into the file now is moved when it is next opened.
        with suppress(sqlite3.Error, AttributeError):
            self._connection.close()

    def remove(self) -> None:
        """Close the file and delete it, once the results are stored elsewhere."""
        self._path.unlink(missing_ok=True)  # while the lock is held
        self.close()
        self._delete()

    def _delete(self) -> None:
        for ending in ("", "-wal", "-journal", "-shm"):
            self._path.with_name(self._path.name + ending).unlink(missing_ok=True)

    def _open(self, resume: bool, replace: bool) -> None:
        self._connection = sqlite3.connect(
            self._path, timeout=0.0, isolation_level=None, check_same_thread=False
        )
        for setting in _SETTINGS:
            self._connection.execute(setting)
        self._connection.execute("BEGIN EXCLUSIVE")
        tables = dict(self._connection.execute("SELECT name, sql FROM sqlite_master"))
        tables = {name: sql for name, sql in tables.items() if not name.startswith("sqlite_")}
        if not tables:
            self._begin()
        elif replace and not (resume and self._fits(tables)):
            for name in tables:
                if name in _SCHEMA:
                    self._connection.execute(f"DROP TABLE {name}")
            self._begin()
        else:
            self._check(tables, resume)
            # Every page is read now, while a file that cannot be read may still be replaced.
            self._connection.execute(_READABLE).fetchall()
        self._connection.execute("COMMIT")

    def _begin(self) -> None:
        for statement in _SCHEMA.values():
            self._connection.execute(statement)
        text = json.dumps(self._identity)
        self._connection.execute("INSERT INTO identity VALUES (?)", (text,))

    def _fits(self, tables: Mapping[str, str]) -> bool:
        try:
            self._check(tables, True)
        except ParameterError:
            return False
        return True

    def _check(self, tables: Mapping[str, str], resume: bool) -> None:
        if tables != _SCHEMA:  # views and triggers of others are never asked
            raise self._refusal("not one", "a file of finished results")
        rows = self._connection.execute("SELECT text FROM identity LIMIT 2").fetchall()
        try:
            (text,) = rows[0]
            found = json.loads(text)
        except (IndexError, ValueError, TypeError, RecursionError):
            found = None
        if len(rows) != 1 or not isinstance(found, dict):
            raise self._refusal("damaged", "a file of finished results")
        if not resume:
            raise ParameterError(
                f"store {self._path}", "left by an interrupted run", "absent when a run begins",
                "resume it (at the shell --resume), or remove it",
            )  # fmt: skip
        if digest_of(found) != digest_of(self._identity):
            changed = differences(found, self._identity)
            raise self._refusal(
                "of another run", f"of the same function, parameters, code and versions ({changed})"
            )

    def _checksum(self, key: str, text: str) -> str:
        total = self._start.copy()
        total.update(f"{key}\0{text}".encode(errors="surrogatepass"))
        return total.hexdigest()

    def _refusal(self, value: str, allowed: str) -> ParameterError:
        remedy = "remove it, or name another file"
        return ParameterError(f"store {self._path}", value, allowed, remedy)

    def _sentence(self, error: Exception) -> FileError | ParameterError:
        if _in_use(error):
            why, remedy = (
                "is in use by another run",
                "wait until that run has ended, or name another",
            )
            return FileError(self._path, why, remedy, errno.EBUSY)
        if _cannot_write(error):
            number = errno.ENOSPC if "full" in str(error) else errno.EIO
            return file_error(self._path, OSError(number, str(error)))
        return self._refusal(f"unreadable ({error})", "a file of finished results")


def _in_use(error: Exception) -> bool:
    return "locked" in str(error)


def _cannot_write(error: Exception) -> bool:
    message = str(error)
    return any(words in message for words in (*_FULL, "readonly", "unable to open"))
