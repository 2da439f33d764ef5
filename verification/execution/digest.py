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
import sys
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import chain
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

from theory.arrays import AnyArray
from verification.execution.imports import (
    SOURCES,
    closure,
    code_of,
    is_library,
    is_ours,
    source_of,
)

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
        total.update(f"{name}\0{code_of(path)}\0".encode())
    homes = {name: source_of(name) for name in {name.partition(".")[0] for name in found}}
    return _Known(digest=total.hexdigest(), homes=homes, places=places)


def code_of_objects(objects: Iterable[object]) -> tuple[tuple[str, ...], str]:
    """Return the modules of functions, classes, instances and modules, and a digest of their code.

    This project and the files of a user are included with all that they import of these; libraries
    are not, since their versions are recorded. Code that is in no importable module (a script, or
    code typed into a session) is included by itself, with all of this project, since what it calls
    there is not known.

    Examples
    --------
    >>> code_of_objects([digest_of])[0]
    ('verification.execution.digest',)
    """
    modules: set[str] = set()
    loose: list[Any] = []
    for each in objects:
        named = hasattr(each, "__qualname__") or isinstance(each, ModuleType)
        owner: Any = each if named else type(each)
        name = owner.__name__ if isinstance(owner, ModuleType) else owner.__module__
        if is_library(name) or (isinstance(owner, ModuleType) and is_ours(name)):
            continue  # a module of this project is used in a session, with which all of it counts
        if source_of(name) is None:
            loose.append([name, _loose(owner, name)])
        else:
            modules.add(name)
    if loose:
        loose.append(digest_of_packages((*SOURCES, "fronts")))
    packages = {*SOURCES, *(module.partition(".")[0] for module in modules)}
    return tuple(sorted(modules)), digest_of([digest_of_code(modules, packages, users=True), loose])


def _loose(owner: object, name: str) -> Any:
    file = getattr(sys.modules.get(name), "__file__", None) or ""
    if file.endswith(".py") and Path(file).is_file():
        return code_of(Path(file))
    code = getattr(owner, "__code__", None)
    if code is not None:
        return _bytecode(code)
    bases = owner.__mro__ if isinstance(owner, type) else ()
    return [
        [base.__qualname__, [[key, _defined(value)] for key, value in sorted(vars(base).items())
                             if not (key.startswith("__") and not callable(value))]]
        for base in bases if source_of(base.__module__) is None and not is_library(base.__module__)
    ]  # fmt: skip


def _defined(value: object) -> Any:
    """Return what a class defines by a name: the code of a function, or a plain value."""
    functions = list(_functions_of(value))
    if functions:
        return [[_bytecode(each.__code__), _text_of(each.__defaults__)] for each in functions]
    return _text_of(value)


def functions_of_class(kind: type) -> Iterator[FunctionType]:
    """Yield the functions that a class defines by itself, also as properties and class methods."""
    return chain.from_iterable(map(_functions_of, vars(kind).values()))


def _functions_of(value: object) -> Iterator[FunctionType]:
    inner = [getattr(value, name, None) for name in ("fget", "fset", "__func__", "func", "py_func")]
    for each in (value, *inner):
        if isinstance(each, FunctionType):
            yield each


def names_in(code: CodeType) -> tuple[str, ...]:
    """Return the global names and the attributes that code uses, and functions within it."""
    inner = [names_in(each) for each in code.co_consts if isinstance(each, CodeType)]
    return tuple(dict.fromkeys((*code.co_names, *chain.from_iterable(inner))))


def _bytecode(code: CodeType) -> list[Any]:
    """Return the bytecode of a function, independent of its location."""
    constants = [_bytecode(c) if isinstance(c, CodeType) else _text_of(c) for c in code.co_consts]
    return [code.co_code.hex(), constants, list(code.co_names)]


def _text_of(value: object) -> str:
    """Return the text of a plain value, the same in every process; of other objects their class.

    Examples
    --------
    >>> _text_of((1, {"b", "a"}, object()))
    "(1, {'a', 'b'}, <object>)"
    """
    if isinstance(value, tuple | list):
        return f"({', '.join(map(_text_of, value))})"
    if isinstance(value, set | frozenset):
        return f"{{{', '.join(sorted(map(_text_of, value)))}}}"
    plain = isinstance(value, bool | int | float | complex | str | bytes | type(None))
    return repr(value) if plain else f"<{type(value).__qualname__}>"


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
