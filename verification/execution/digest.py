"""Digests of the code that a result depends on, of plain data, and of arrays.

The code of a result is that of the modules it comes from and of all modules that these import.
Docstrings, comments and layout do not count.

A digest detects that code, parameters or a truncated or damaged file do not match. It does not
protect against somebody who forges a file together with its digest, which anybody can compute.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from theory.arrays import AnyArray
from verification.execution.imports import SOURCES, closure, content_of_file, source_of

DRAWING = (
    "benchmarks.choice", "benchmarks.diagram", "benchmarks.growth_diagram", "benchmarks.tables",
)  # fmt: skip
"""Modules that display measurements without affecting them."""


def digest_of(data: object) -> str:
    """Return a digest of plain data: anything JSON can hold, with floats to the last bit.

    Examples
    --------
    >>> digest_of({"a": 1, "b": 2}) == digest_of({"b": 2, "a": 1})
    True
    """
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def digest_of_arrays(arrays: Mapping[str, AnyArray]) -> str:
    """Return a digest of named arrays: names, types, shapes and every bit.

    Examples
    --------
    >>> import numpy as np
    >>> digest_of_arrays({"a": np.zeros(2)}) == digest_of_arrays({"a": -np.zeros(2)})
    False
    """
    total = hashlib.sha256()
    for name, array in sorted(arrays.items()):
        total.update(f"{name}\0{array.dtype.str}\0{array.shape}\0".encode())
        total.update(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data)
    return total.hexdigest()


def digest_of_files(folder: Path, files: Iterable[Path]) -> str:
    """Return a digest of the names (relative to a folder) and of the contents of files."""
    total = hashlib.sha256()
    for path in sorted(files):
        content = path.read_bytes()
        total.update(f"{path.relative_to(folder).as_posix()}\0{len(content)}\0".encode())
        total.update(content)
    return total.hexdigest()


def digest_of_code(
    roots: Iterable[str],
    packages: Collection[str] = SOURCES,
    without: Collection[str] = DRAWING,
    *,
    users: bool = False,
) -> str:
    """Return a digest of the code of modules and of everything they import.

    Parameters
    ----------
    roots : iterable of str
        Modules by their dotted names, or functions in them as ``package.module:function``.
    packages : collection of str, optional
        Top-level packages whose code counts.
    without : collection of str, optional
        Modules among them that do not count.
    users : bool, optional
        Whether the files of a user count too.

    Raises
    ------
    ValueError
        If one of the modules does not exist.
    """
    asked = (tuple(sorted({root.partition(":")[0] for root in roots})),
             frozenset(packages), frozenset(without), users)  # fmt: skip
    known = _KNOWN.get(asked)
    if known is None or not known.holds():
        known = _KNOWN[asked] = _read(*asked)
    return known.digest


@dataclass(frozen=True, kw_only=True)
class _Known:
    """A digest of code, with the state of the files from which it was read.

    Attributes
    ----------
    digest : str
        The digest.
    homes : dict of str to Path or None
        Where Python found the top-level packages.
    places : dict of str to (int, int)
        Modification time and size of each file and of each folder, since a file may appear or
        vanish.
    """

    digest: str
    homes: Mapping[str, Path | None]
    places: Mapping[str, tuple[int, int]]

    def holds(self) -> bool:
        """Return whether nothing has changed since then."""
        try:
            return (
                all(source_of(name) == home for name, home in self.homes.items())
                and {place: _state(place) for place in self.places} == self.places
            )
        except OSError:
            return False


_KNOWN: dict[tuple[tuple[str, ...], frozenset[str], frozenset[str], bool], _Known] = {}
"""Digests by request: finding the hundred files of a sweep again takes 10 ms per call."""


def _state(place: str) -> tuple[int, int]:
    status = os.stat(place)
    return status.st_mtime_ns, status.st_size


def _read(
    modules: tuple[str, ...], packages: frozenset[str], without: frozenset[str], users: bool
) -> _Known:
    found: dict[str, Path] = {}
    for module in modules:
        held = closure(module, packages, without, users=users)
        if module not in held:
            raise ValueError(f"there is no module {module} whose code could be read")
        found |= held
    places = {str(place): _state(str(place)) for path in found.values()
              for place in (path, path.parent)}  # fmt: skip
    total = hashlib.sha256()
    for name, path in sorted(found.items()):
        total.update(f"{name}\0{content_of_file(path)}\0".encode())
    homes = {name: source_of(name) for name in {name.partition(".")[0] for name in found}}
    return _Known(digest=total.hexdigest(), homes=homes, places=places)


def digest_of_packages(packages: Iterable[str]) -> str:
    """Return a digest of every Python file of the given packages, wherever they are installed.

    Examples
    --------
    >>> digest_of_packages(["theory"]) == digest_of_packages(["theory"])
    True
    """
    found = {}
    for package in packages:
        home = source_of(package)
        if home is not None:
            files = sorted(str(path) for path in home.parent.rglob("*.py"))
            found[package] = _digest_at(home.parent, tuple((each, _state(each)) for each in files))
    return digest_of(found)


@lru_cache(maxsize=64)
def _digest_at(folder: Path, files: tuple[tuple[str, tuple[int, int]], ...]) -> str:
    """Return the digest of files in their present state; reading them takes 40 ms."""
    return digest_of_files(folder, (Path(each) for each, _ in files))
