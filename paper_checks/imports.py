"""Which of the toolkit's files a module depends on, found by reading import statements."""

from __future__ import annotations

import ast
import hashlib
import importlib.util
from collections.abc import Collection, Iterator
from pathlib import Path


def closure(module: str, packages: Collection[str]) -> dict[str, Path]:
    """Return the files that a module imports, itself included, directly or through others.

    Imports inside functions count; those under ``if TYPE_CHECKING`` do not. A module that
    imports by computed names counts as importing all of its package.

    Parameters
    ----------
    module : str
        Dotted name.
    packages : collection of str
        Top-level packages that are followed; all others are left out.

    Returns
    -------
    dict of str to Path
        By dotted name, sorted.

    Examples
    --------
    >>> list(closure("theory.unit_cell", ["theory"]))
    ['theory', 'theory.parameters', 'theory.unit_cell']
    """
    found: dict[str, Path] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        if name in found or name.partition(".")[0] not in packages:
            continue
        path = _file(name)
        if path is None:
            continue
        found[name] = path
        parent = name.rpartition(".")[0]
        if parent:
            waiting.append(parent)
        tree = _tree(path)
        is_package = path.name == "__init__.py"
        waiting.extend(_names(tree, name if is_package else parent))
        if any(_computed(node) for node in ast.walk(tree)):
            waiting.extend(_all_of(name.partition(".")[0]))
    return dict(sorted(found.items()))


def digest(module: str, packages: Collection[str]) -> str:
    """Return a digest of the text of all files in the `closure` of a module."""
    total = hashlib.sha256()
    for name, path in closure(module, packages).items():
        content = path.read_bytes().replace(b"\r\n", b"\n")
        total.update(f"{name}\0{len(content)}\0".encode())
        total.update(content)
    return total.hexdigest()


def _file(name: str) -> Path | None:
    """Return the file of a module, found without running any code but the package's own."""
    top, *rest = name.split(".")
    spec = importlib.util.find_spec(top)
    for folder in spec.submodule_search_locations or () if spec else ():
        place = Path(folder, *rest)
        for path in (place / "__init__.py", place.with_suffix(".py")):
            if path.is_file():
                return path
    return None


def _tree(path: Path) -> ast.Module:
    return ast.parse(path.read_bytes(), str(path))


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
    home = _file(package)
    if home is None:
        return
    for path in home.parent.rglob("*.py"):
        parts = [package, *path.relative_to(home.parent).with_suffix("").parts]
        yield ".".join(part for part in parts if part != "__init__")
