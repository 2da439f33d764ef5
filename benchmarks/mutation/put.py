"""Replacing a statement of an imported module by a changed one."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterable
from enum import EnumMeta
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

from benchmarks.mutation.entered import PACKAGES
from benchmarks.mutation.places import names_bound
from benchmarks.mutation.recompiled import made, python_function

_OF_ITS_OWN = frozenset({"__dict__", "__weakref__", "__module__", "__doc__", "__qualname__",
                         "__annotations__", "__abstractmethods__", "_abc_impl"})  # fmt: skip
"""Attributes that every class has of its own, and that a changed class statement leaves as is."""


def names_used_on_import(files: Iterable[Path]) -> frozenset[str]:
    """Return the names used by the statements of modules, outside the bodies of functions."""
    found: set[str] = set()

    def collect(node: ast.AST) -> None:
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Load):
            found.add(node.id)
        elif isinstance(node, ast.Attribute):
            found.add(node.attr)
        for field, value in ast.iter_fields(node):
            inside = isinstance(node, ast.FunctionDef | ast.Lambda) and field == "body"
            if inside or field in ("annotation", "returns"):
                continue
            for each in value if isinstance(value, list) else [value]:
                if isinstance(each, ast.AST):
                    collect(each)

    for file in files:
        collect(ast.parse(file.read_bytes()))
    return frozenset(found)


def libraries_of(files: Iterable[Path]) -> list[str]:
    """Return the third-party libraries that files import, also inside functions."""
    found: set[str] = set()
    for file in files:
        for node in ast.walk(ast.parse(file.read_bytes())):
            if isinstance(node, ast.Import):
                found.update(each.name for each in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                found.add(node.module)
    own = {*PACKAGES, "benchmarks", "tests", *sys.stdlib_module_names}
    return sorted(name for name in found if name.split(".")[0] not in own)


def put_statement(module: ModuleType, statement: ast.stmt) -> bool:
    """Run a changed statement of a module, and update its existing objects wherever imported.

    Returns
    -------
    bool
        Whether that was possible: it is not if a name would denote another class, or if the
        statement binds no name.
    """
    space = dict(vars(module))
    before = {name: space.get(name) for name in names_bound(statement)}
    code = compile(ast.Module([statement], []), str(module.__file__), "exec", dont_inherit=True)
    exec(code, space)
    changed = {name: (old, space[name]) for name, old in before.items() if space[name] is not old}
    return bool(changed) and all(_replaced(name, *both) for name, both in changed.items())


def _replaced(name: str, old: Any, new: Any) -> bool:
    if isinstance(old, FunctionType) and isinstance(new, FunctionType):
        return _function(old, new)
    if isinstance(old, type) and isinstance(new, type):
        return _class(old, new)
    spaces = [vars(other) for other in list(sys.modules.values()) if isinstance(other, ModuleType)]
    for space in (*spaces, *(python_function(each).__globals__ for each in made)):
        if space.get(name) is old:
            space[name] = new
    return True


def _function(old: Any, new: Any) -> bool:
    if not fits(old.__code__, new.__code__):
        return False
    old.__code__, old.__defaults__ = new.__code__, new.__defaults__
    old.__kwdefaults__ = new.__kwdefaults__
    return True


def _class(old: type, new: type) -> bool:
    if isinstance(old, EnumMeta):
        return False
    for name, value in vars(new).items():
        here = vars(old).get(name)
        if name in _OF_ITS_OWN or type(value).__name__ == "member_descriptor":
            continue
        if isinstance(here, FunctionType) and isinstance(value, FunctionType):
            if not _function(here, value):
                return False
        elif isinstance(value, classmethod | staticmethod):
            if here is None or not _function(here.__func__, value.__func__):
                return False
        else:
            type.__setattr__(old, name, value)
    return True


def fits(old: CodeType, new: CodeType) -> bool:
    """Return whether code is from the same place in a file, and captures the same names."""
    names = ("co_filename", "co_firstlineno", "co_qualname", "co_freevars")
    return all(getattr(old, name) == getattr(new, name) for name in names)


def differs(old: CodeType, new: CodeType) -> bool:
    """Return whether code is not the same, apart from the columns in which it is written."""
    return old.replace(co_linetable=b"") != new.replace(co_linetable=b"")
