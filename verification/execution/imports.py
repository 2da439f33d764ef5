"""Which modules a module imports, found by reading import statements and running none of it."""

from __future__ import annotations

import ast
import functools
import importlib.util
import os
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TypeGuard

SOURCES = ("theory", "derivations", "verification", "paper_checks", "benchmarks")
"""Packages whose code a result may depend on; ``fronts``, which only shows it, is not one."""


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
            waiting.extend(modules_below(name.partition(".")[0]))
    return dict(sorted(found.items()))


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
    return names, imports_by_computed_name(tree)


def _names(tree: ast.Module, package: str) -> Iterator[str]:
    """Every name that may be a module; what is none is dropped later."""
    waiting: list[ast.AST] = [tree]
    while waiting:
        node = waiting.pop()
        if is_for_types(node):
            waiting.extend(node.orelse)
            continue
        if isinstance(node, ast.ImportFrom):
            yield home_of(node, package)
        yield from names_imported(node, package).values()
        waiting.extend(ast.iter_child_nodes(node))


def is_for_types(node: ast.AST) -> TypeGuard[ast.If]:
    """Tell whether a statement is ``if TYPE_CHECKING``."""
    return isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test)


def home_of(node: ast.ImportFrom, package: str) -> str:
    """Return the dotted name after ``from``; ``package`` is the one that holds the statement."""
    if not node.level:
        return node.module or ""
    base = package.split(".")[: len(package.split(".")) - node.level + 1]
    return ".".join([*base, *filter(None, [node.module])])


def names_imported(node: ast.AST, package: str) -> dict[str, str]:
    """Return what an import statement imports, dotted, by the names that it gets here."""
    if isinstance(node, ast.Import):
        return {alias.asname or alias.name: alias.name for alias in node.names}
    if isinstance(node, ast.ImportFrom):
        home = home_of(node, package)
        return {alias.asname or alias.name: f"{home}.{alias.name}" for alias in node.names}
    return {}


def imports_by_computed_name(tree: ast.AST) -> bool:
    """Tell whether some code imports modules by names that it computes."""
    called = (node.func for node in ast.walk(tree) if isinstance(node, ast.Call))
    names = (each.attr if isinstance(each, ast.Attribute) else getattr(each, "id", "")
             for each in called)  # fmt: skip
    return any(name in ("import_module", "__import__") for name in names)


def modules_below(package: str) -> Iterator[str]:
    """Yield the dotted names of all modules of a package."""
    home = source_of(package)
    if home is None:
        return
    for path in home.parent.rglob("*.py"):
        parts = [package, *path.relative_to(home.parent).with_suffix("").parts]
        yield ".".join(part for part in parts if part != "__init__")
