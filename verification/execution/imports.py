"""Which modules a module imports, and what their code does, by reading without running it."""

from __future__ import annotations

import ast
import functools
import importlib.util
import os
import sys
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path

SOURCES = ("theory", "derivations", "verification", "paper_checks", "benchmarks")
"""Packages whose code a result may depend on; ``fronts`` only displays results and is not one."""

Imported = tuple[Path | None, tuple[str, ...]]
"""The file of a module, if it has one, and what it may import directly, including its package."""

_NO_CODE = ("ctx", "kind", "type_comment")


def closure(
    module: str,
    packages: Collection[str],
    without: Collection[str] = (),
    known: dict[str, Imported] | None = None,
    *,
    users: bool = False,
) -> dict[str, Path]:
    """Return the files that a module imports directly or indirectly, including itself.

    Imports inside functions count; those under ``if TYPE_CHECKING`` do not. A module that imports
    computed names counts as importing its whole package, except tests.

    Parameters
    ----------
    module : str
        Dotted name.
    packages : collection of str
        Top-level packages that are followed; all others are ignored.
    without : collection of str, optional
        Modules that are ignored, and not followed.
    known : dict, optional
        Direct imports of modules, filled by one call and used by the next: for many modules.
    users : bool, optional
        Whether to follow the files of a user as well.

    Returns
    -------
    dict of str to Path
        Files by dotted name, sorted.

    Examples
    --------
    >>> list(closure("theory.cells.vdp", ["theory"]))
    ['theory', 'theory.cells', 'theory.cells.vdp', 'theory.parameters']
    """
    found: dict[str, Path] = {}
    known = {} if known is None else known
    waiting = [module]
    while waiting:
        name = waiting.pop()
        top = name.partition(".")[0]
        if name in found or name in without:
            continue
        of_a_user = users and not (is_ours(top) or is_library(top))
        if top not in packages and not of_a_user:
            continue
        if name not in known:
            known[name] = _imported(name)
        path, names = known[name]
        if path is not None:
            found[name] = path
            waiting.extend(names)
    return dict(sorted(found.items()))


def _imported(name: str) -> Imported:
    path = source_of(name)
    if path is None:
        return None, ()
    parent = name.rpartition(".")[0]
    names, computed = imports_of(path, name if path.name == "__init__.py" else parent)
    below = _modules_below(name.partition(".")[0]) if computed else ()
    return path, (*filter(None, [parent]), *names, *below)


def source_of(name: str) -> Path | None:
    """Return the file of a module, found without running any code but that of the package itself.

    A package that Python does not find is looked for next to this one, as in a source tree.

    Examples
    --------
    >>> source_of("theory.no_such_module")
    """
    top, *rest = name.split(".")
    if top == "__main__":  # a script, or code typed into a session
        return None
    try:
        spec = importlib.util.find_spec(top)
    except ValueError:  # a session, or a script as seen by a worker process
        return None
    homes = list(spec.submodule_search_locations or ()) if spec else []
    if spec and not rest and spec.origin and spec.origin.endswith(".py"):
        return Path(spec.origin)
    for folder in homes or [str(Path(__file__).parents[2] / top)]:
        # Called hundreds of times per digest; os.path is faster.
        place = os.path.join(folder, *rest)
        for path in (os.path.join(place, "__init__.py"), f"{place}.py"):
            if os.path.isfile(path):
                return Path(path)
    return None


@functools.lru_cache(maxsize=4096)
def is_library(name: str) -> bool:
    """Return whether a module is of the standard library or installed, but not of this project.

    Its code is determined by its version. All others, and scripts, are files of a user.

    Examples
    --------
    >>> [is_library(name) for name in ("math", "numpy.linalg", "theory.cells.vdp", "__main__")]
    [True, True, False, False]
    >>> is_library("a_file_that_is_gone")
    False
    """
    top = name.partition(".")[0]
    if is_ours(top) or top in ("__main__", "__mp_main__"):
        return False
    if top in sys.stdlib_module_names:
        return True
    try:
        spec = importlib.util.find_spec(top)
    except (ImportError, ValueError):  # a session, or a script as seen by a worker process
        return False
    places = [spec.origin or "", *(spec.submodule_search_locations or ())] if spec else []
    return any(_INSTALLED & {*Path(each).parts} for each in places)


def is_ours(name: str) -> bool:
    """Return whether a module is of this project."""
    return name.partition(".")[0] in (*SOURCES, "fronts")


_INSTALLED = {"site-packages", "dist-packages"}


def imports_of(path: Path, package: str) -> tuple[tuple[str, ...], bool]:
    """Return the names a file imports that may be modules, and whether it imports computed names.

    Parameters
    ----------
    path : Path
        The file.
    package : str
        Dotted name of the package it is in, for relative imports.
    """
    source = _source(path)
    found: dict[str, None] = {}
    for level, module, members in source.imports:
        above = package.split(".")[: 1 - level or None] if level else []
        home = ".".join([*above, *filter(None, [module])])
        found |= dict.fromkeys((home, *(f"{home}.{member}" for member in members)))
    return tuple(found), source.computed


def content_of_file(path: Path) -> str:
    """Return what a file does, see `shape`; cached as long as the file does not change."""
    return _source(path).code


@dataclass(frozen=True, kw_only=True)
class _Source:
    """Contents of a file: code, imports (level, module, members), whether names are computed.

    Attributes
    ----------
    code : str
        What it does, see `shape`.
    imports : tuple of (int, str or None, tuple of str)
        Dots of a relative import, module, and imported names, which may be modules.
    computed : bool
        Whether it imports computed names.
    """

    code: str
    imports: tuple[tuple[int, str | None, tuple[str, ...]], ...]
    computed: bool


def _source(path: Path) -> _Source:
    status = path.stat()
    return _read(path, status.st_mtime_ns, status.st_size)


@functools.lru_cache(maxsize=4096)
def _read(path: Path, _changed: int, _size: int) -> _Source:
    text = path.read_bytes()
    tree = ast.parse(text, str(path))
    return _Source(
        code=shape(tree),
        imports=tuple(_imports(tree, conditional=b"TYPE_CHECKING" in text)),
        # Both are searched for in few files only: doing so in all of them takes half of the time
        # for a digest.
        computed=any(name in text for name in (b"import_module", b"__import__"))
        and _imports_by_computed_name(tree),
    )


def _imports(
    tree: ast.Module, conditional: bool
) -> Iterator[tuple[int, str | None, tuple[str, ...]]]:
    """Yield names that may be modules, wherever they are imported; others are dropped later.

    ``conditional`` is whether some may be under ``if TYPE_CHECKING``.
    """
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        if conditional and isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            waiting.extend(node.orelse)
            continue
        if isinstance(node, ast.Import):
            yield from ((0, alias.name, ()) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.level, node.module, tuple(alias.name for alias in node.names)
        for block in ("body", "orelse", "finalbody", "handlers", "cases"):
            waiting.extend(getattr(node, block, ()))


def _imports_by_computed_name(tree: ast.Module) -> bool:
    called = (node.func for node in ast.walk(tree) if isinstance(node, ast.Call))
    names = (each.attr if isinstance(each, ast.Attribute) else getattr(each, "id", "")
             for each in called)  # fmt: skip
    return any(name in ("import_module", "__import__") for name in names)


def shape(node: ast.AST) -> str:
    """Return what code does: its syntax tree without positions, docstrings, comments and layout.

    Unlike the result of `ast.dump`, it is the same on every version of Python.

    Examples
    --------
    >>> shape(ast.parse("x = (1+2)  # one")) == shape(ast.parse("x = 1 + 2"))
    True
    """
    parts: list[str] = []
    for name in node._fields:
        value = getattr(node, name, None)
        if value is None or value == [] or name in _NO_CODE:
            continue
        several = value if isinstance(value, list) else [value]
        inner = [
            shape(each) if isinstance(each, ast.AST) else repr(each)
            for each in several
            if not _is_text(each)
        ]
        parts.append(f"{name}=[{','.join(inner)}]")
    return f"{type(node).__name__}({';'.join(parts)})"


def _is_text(node: object) -> bool:
    """Return whether a statement consists of a string only, like a docstring."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _modules_below(package: str) -> Iterator[str]:
    """Yield the dotted names of all modules of a package except tests."""
    home = source_of(package)
    if home is None:
        return
    for path in home.parent.rglob("*.py"):
        if path.match("test_*.py"):
            continue
        parts = [package, *path.relative_to(home.parent).with_suffix("").parts]
        yield ".".join(part for part in parts if part != "__init__")
