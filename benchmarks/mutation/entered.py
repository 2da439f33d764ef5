"""Which functions of the project are entered: each is compiled with an extra line that records it.

A tracer would make the many small calls of mpmath and SymPy several times slower. Nested functions
and lambdas count as the function that contains them. numba is given the code without that line.
"""

from __future__ import annotations

import ast
import builtins
import os
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType
from typing import Any

from benchmarks.mutation.places import outermost_functions
from benchmarks.mutation.recompiled import made, with_code

ENTER = "enter_function_of_the_project"
PACKAGES = ("theory", "derivations", "verification", "paper_checks", "fronts")
replaced: dict[str, CodeType] = {}
"""Code with which a module is imported instead of its own, by the module's path from the root."""

compiled: set[str] = set()
"""Functions passed to numba, including nested ones, as ``path:qualified name``."""


def install(root: Path) -> set[str]:
    """Make every module imported from now on record the functions entered; return their set.

    A name is ``path:qualified name`` of the outermost function.
    """
    names: set[str] = set()
    plain: dict[tuple[str, int, str], CodeType] = {}
    builtins.__dict__[ENTER] = names.add
    made: dict[str, CodeType] = {}
    own = SourceFileLoader.get_code

    def get_code(loader: Any, fullname: str) -> CodeType | None:
        path = loader.get_filename(fullname)
        relative = os.path.relpath(path, root)
        if relative in replaced:
            return replaced[relative]
        if relative.split(os.sep)[0] not in PACKAGES:
            return own(loader, fullname)
        if path not in made:  # a child that imports again has inherited it
            source = loader.get_data(path)
            for code in codes_in(compile(source, path, "exec", dont_inherit=True)):
                plain[path, code.co_firstlineno, code.co_qualname] = code
            made[path] = compile(naming(source, relative), path, "exec", dont_inherit=True)
        return made[path]

    SourceFileLoader.get_code = get_code  # type: ignore[assignment, method-assign]
    _compile_as_written(plain, names, root)
    return names


def _compile_as_written(
    plain: dict[tuple[str, int, str], CodeType], names: set[str], root: Path
) -> None:
    """Pass numba's dispatchers and C callbacks the code as written, and record the functions."""
    from numba.core.ccallback import CFunc
    from numba.core.dispatcher import Dispatcher

    def as_written(own: Any) -> Any:
        code = own.__code__
        written = plain.get((code.co_filename, code.co_firstlineno, code.co_qualname))
        if written is None or ENTER not in code.co_names:
            return own
        path = os.path.relpath(code.co_filename, root)
        names.add(f"{path}:{code.co_qualname.partition('.<locals>')[0]}")
        compiled.add(f"{path}:{code.co_qualname.replace('.<locals>', '')}")
        return with_code(own, written)

    def given_what_is_written(begin: Any) -> Any:
        def initialise(self: Any, py_func: Any, *more: Any, **options: Any) -> None:
            begin(self, as_written(py_func), *more, **options)
            made.append(self)

        return initialise

    for each in (Dispatcher, CFunc):
        each.__init__ = given_what_is_written(each.__init__)  # type: ignore[method-assign]


def naming(source: bytes, relative: str) -> ast.Module:
    """Return a module in which each function, and each lambda in one, first records its name."""
    tree = ast.parse(source)
    for name, top in list(outermost_functions(tree)):
        call = f"{ENTER}({f'{relative}:{name}'!r})"
        for node in ast.walk(top):
            if isinstance(node, ast.FunctionDef):
                place = 1 if ast.get_docstring(node) is not None else 0
                node.body.insert(place, ast.parse(call).body[0])
            elif isinstance(node, ast.Lambda):
                both = ast.Tuple([ast.parse(call, mode="eval").body, node.body], ast.Load())
                node.body = ast.Subscript(both, ast.Constant(1), ast.Load())
    return ast.fix_missing_locations(tree)


def codes_in(code: CodeType) -> list[CodeType]:
    """Return a code object and all code objects nested in it."""
    inner = [each for each in code.co_consts if isinstance(each, CodeType)]
    return [code, *(deeper for each in inner for deeper in codes_in(each))]
