"""Digests: of the code that a result depends on, of plain data, of arrays.

The code of a result is that of the module it comes from and of all of the toolkit's modules which
that one imports, directly or through others, found by reading import statements. Docstrings,
comments and line breaks do not count.

What a digest protects from: code, parameters, a truncated or damaged file that are taken for
others. What it does not: somebody who forges a file and its digest, which anybody can compute.
"""

from __future__ import annotations

import ast
import functools
import hashlib
import importlib.util
import io
import json
import os
import sys
import tokenize
from collections.abc import Collection, Iterable, Iterator, Mapping
from pathlib import Path
from types import CodeType
from typing import Any

import numpy as np
import numpy.typing as npt

SOURCES = ("theory", "derivations", "verification", "paper_checks", "benchmarks")
"""Packages whose code a result may depend on; ``fronts``, which only shows it, is not one."""

DRAWING = (
    "benchmarks.choice", "benchmarks.diagram", "benchmarks.growth_diagram", "benchmarks.tables",
)  # fmt: skip
"""Modules that show what was measured, and change nothing of it."""


def digest_of(data: object) -> str:
    """Return a digest of plain data: what JSON can hold, floats to the last bit.

    Examples
    --------
    >>> digest_of({"a": 1, "b": 2}) == digest_of({"b": 2, "a": 1})
    True
    """
    return hashlib.sha256(json.dumps(data, sort_keys=True).encode()).hexdigest()


def digest_of_arrays(arrays: Mapping[str, npt.NDArray[Any]]) -> str:
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
    """Return a digest of the names from a folder on, and of the contents, of files."""
    total = hashlib.sha256()
    for path in sorted(files):
        content = path.read_bytes()
        total.update(f"{path.relative_to(folder).as_posix()}\0{len(content)}\0".encode())
        total.update(content)
    return total.hexdigest()


def digest_of_code(
    modules: Iterable[str], packages: Collection[str] = SOURCES, without: Collection[str] = DRAWING
) -> str:
    """Return a digest of the code that modules depend on.

    Parameters
    ----------
    modules : iterable of str
        Dotted names.
    packages : collection of str, optional
        Top-level packages whose code counts.
    without : collection of str, optional
        Modules of it that do not count.

    Raises
    ------
    ValueError
        If there is no such module.
    """
    files: dict[str, Path] = {}
    for module in modules:
        found = closure(module, packages, without)
        if module not in found:
            raise ValueError(f"there is no module {module} whose code could be read")
        files |= found
    total = hashlib.sha256()
    for name, path in sorted(files.items()):
        total.update(f"{name}\0{essence(path)}\0".encode())
    return total.hexdigest()


def code_of_objects(objects: Iterable[object]) -> tuple[tuple[str, ...], str]:
    """Return the modules of functions, classes and instances, and a digest of their code.

    Code of no module that can be imported (a script, or what is typed into a session) counts by
    itself; what it calls there does not.

    Examples
    --------
    >>> code_of_objects([source_of])[0]
    ('verification.execution.digest',)
    """
    modules: set[str] = set()
    loose: list[Any] = []
    for each in objects:
        owner: Any = each if hasattr(each, "__qualname__") else type(each)
        name = owner.__module__
        if source_of(name) is None:
            loose.append([name, _loose(owner, name)])
        else:
            modules.add(name)
    packages = {*SOURCES, *(module.partition(".")[0] for module in modules)}
    return tuple(sorted(modules)), digest_of([digest_of_code(modules, packages), loose])


def _loose(owner: object, name: str) -> Any:
    file = getattr(sys.modules.get(name), "__file__", None)
    if file is not None and Path(file).is_file():
        return essence(Path(file))
    code = getattr(owner, "__code__", None)
    if code is not None:
        return _bytecode(code)
    methods = vars(owner).items() if isinstance(owner, type) else ()
    return [[key, _bytecode(m.__code__)] for key, m in methods if hasattr(m, "__code__")]


def _bytecode(code: CodeType) -> list[Any]:
    """Return what a function does, without its place."""
    constants = [_bytecode(c) if isinstance(c, CodeType) else repr(c) for c in code.co_consts]
    return [code.co_code.hex(), constants, list(code.co_names)]


def digest_of_packages(packages: Iterable[str]) -> str:
    """Return a digest of every Python file of some packages, wherever they are installed.

    Examples
    --------
    >>> digest_of_packages(["theory"]) == digest_of_packages(["theory"])
    True
    """
    found = {}
    for package in packages:
        home = source_of(package)
        if home is not None:
            found[package] = digest_of_files(home.parent, home.parent.rglob("*.py"))
    return digest_of(found)


def closure(
    module: str, packages: Collection[str] = SOURCES, without: Collection[str] = ()
) -> dict[str, Path]:
    """Return the files that a module imports, itself included, directly or through others.

    Imports inside functions count; those under ``if TYPE_CHECKING`` do not. A module that
    imports by computed names counts as importing all of its package.

    Parameters
    ----------
    module : str
        Dotted name.
    packages : collection of str, optional
        Top-level packages that are followed; all others are left out.
    without : collection of str, optional
        Modules that are left out, and not followed.

    Returns
    -------
    dict of str to Path
        By dotted name, sorted.

    Examples
    --------
    >>> list(closure("theory.cells.vdp", ["theory"]))
    ['theory', 'theory.cells', 'theory.cells.vdp', 'theory.parameters']
    """
    found: dict[str, Path] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name in found or name in without or name.partition(".")[0] not in packages:
            continue
        path = source_of(name)
        if path is None:
            continue
        found[name] = path
        parent = name.rpartition(".")[0]
        if parent:
            waiting.append(parent)
        names, computed = imports_of(path, name if path.name == "__init__.py" else parent)
        waiting.extend(names)
        if computed:
            waiting.extend(_all_of(name.partition(".")[0]))
    return dict(sorted(found.items()))


def essence(path: Path) -> str:
    """Return the code of a file without docstrings, comments, blank lines and line breaks.

    It is the same on every version of Python, which the text of a syntax tree is not.
    """
    status = path.stat()
    return _essence(path, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=4096)
def _essence(path: Path, _changed: int, _size: int) -> str:
    text = path.read_bytes().decode().replace("\r\n", "\n")
    documented = _docstrings(ast.parse(text))
    lines = text.splitlines(keepends=True)
    kept: list[str] = []
    after_docstring = False
    opened: list[tuple[int, int]] = []  # where f-strings began, which newer Pythons take apart
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        kind = tokenize.tok_name[token.type]
        if kind == "FSTRING_START":
            opened.append(token.start)
        elif kind == "FSTRING_END":
            begin = opened.pop()
            if not opened:
                kept.append(_between(lines, begin, token.end))
        elif token.start in documented:
            after_docstring = True
        elif opened or kind in ("COMMENT", "NL", "ENDMARKER"):
            continue
        elif after_docstring and kind == "NEWLINE":
            after_docstring = False
        elif kind in ("INDENT", "DEDENT", "NEWLINE"):
            kept.append(kind)
        else:
            kept.append(token.string)
    return "\0".join(kept)


def _docstrings(tree: ast.Module) -> set[tuple[int, int]]:
    """Return line and column of every string that stands alone as a statement."""
    alone = (node.value for node in ast.walk(tree) if isinstance(node, ast.Expr))
    return {
        (node.lineno, node.col_offset)
        for node in alone
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }


def _between(lines: list[str], begin: tuple[int, int], end: tuple[int, int]) -> str:
    (first, left), (last, right) = begin, end
    if first == last:
        return lines[first - 1][left:right]
    return "".join([lines[first - 1][left:], *lines[first : last - 1], lines[last - 1][:right]])


def source_of(name: str) -> Path | None:
    """Return the file of a module, found without running any code but the package's own.

    A package that Python does not find is looked for beside this one, as in a source tree.

    Examples
    --------
    >>> source_of("theory.no_such_module")
    """
    top, *rest = name.split(".")
    if top == "__main__":  # a script, or what is typed into a session
        return None
    spec = importlib.util.find_spec(top)
    homes = list(spec.submodule_search_locations or ()) if spec else []
    if spec and not homes and not rest and spec.origin and spec.origin.endswith(".py"):
        return Path(spec.origin)
    for folder in homes or [str(Path(__file__).parents[2] / top)]:
        # Asked hundreds of times a digest: os.path, for speed.
        place = os.path.join(folder, *rest)
        for path in (os.path.join(place, "__init__.py"), f"{place}.py"):
            if os.path.isfile(path):
                return Path(path)
    return None


def imports_of(path: Path, package: str) -> tuple[tuple[str, ...], bool]:
    """Return what may be modules that a file imports, and whether it imports computed names.

    Parameters
    ----------
    path : Path
        The file.
    package : str
        Dotted name of the package it is in, for relative imports.
    """
    status = path.stat()
    return _imports_of(path, package, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=4096)
def _imports_of(
    path: Path, package: str, _changed: int, _size: int
) -> tuple[tuple[str, ...], bool]:
    tree = ast.parse(path.read_bytes(), str(path))
    names = tuple(dict.fromkeys(_names(tree, package)))
    return names, any(_computed(node) for node in ast.walk(tree))


def _names(tree: ast.Module, package: str) -> Iterator[str]:
    """Every name that may be a module; what is none is dropped later."""
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            waiting.extend(node.orelse)
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            home = node.module or ""
            if node.level:
                base = package.split(".")[: len(package.split(".")) - node.level + 1]
                home = ".".join([*base, *filter(None, [node.module])])
            yield home
            yield from (f"{home}.{alias.name}" for alias in node.names)
        waiting.extend(ast.iter_child_nodes(node))


def _computed(node: ast.AST) -> bool:
    if not isinstance(node, ast.Call):
        return False
    called = node.func
    name = called.attr if isinstance(called, ast.Attribute) else getattr(called, "id", "")
    return name in ("import_module", "__import__")


def _all_of(package: str) -> Iterator[str]:
    home = source_of(package)
    if home is None:
        return
    for path in home.parent.rglob("*.py"):
        parts = [package, *path.relative_to(home.parent).with_suffix("").parts]
        yield ".".join(part for part in parts if part != "__init__")
