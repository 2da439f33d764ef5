"""Where a module may be changed: every expression that computes, and the formula it belongs to."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace

UNCHANGED_CALLS = frozenset(
    {
        "within",
        "count_within",
        "positive",
        "checked_eta",
        "ParameterError",
        "PrecisionError",
        "range",
        "lru_cache",
        "dataclass",
        "errstate",
        "catch_warnings",
    }
)
"""Calls that hold checks, messages and limits of loops."""

SETTINGS = frozenset(
    {"rtol", "atol", "xtol", "tol", "limit", "maxsize", "order", "digits", "maxiter", "options"}
)
"""Keyword arguments that tune a method."""

STATEMENTS = (ast.Assign, ast.AnnAssign, ast.AugAssign, ast.Return, ast.Expr)
"""Statements that may hold a formula."""

EQUATIONS = frozenset({"equation", "Eq", "Printed"})
"""Calls each of which is a formula by itself, within the list that holds it."""


DRAWS = frozenset({"uniform", "choice", "randint", "randrange", "sample", "gauss"})
"""Calls that choose where something is tried: no formula, whatever the numbers."""


@dataclass(frozen=True)
class Scope:
    """What surrounds a place: the function, the classes and functions, the formula, an index.

    ``stated``: a docstring around it states an equation.
    """

    function: str = "<module>"
    first_line: int = 0
    within: str = ""
    formula: int = 0
    index: bool = False
    stated: bool = False


@dataclass(frozen=True)
class Place:
    """Where an expression, or a statement like ``x += 1``, hangs."""

    parent: ast.AST
    field: str
    position: int | None
    node: ast.expr | ast.AugAssign
    scope: Scope


def places_of(tree: ast.AST, scope: Scope) -> Iterator[Place]:
    """Yield each expression that may be changed, with where it hangs, outermost first."""
    for field, value in ast.iter_fields(tree):
        if _left_alone(tree, field):
            continue
        entries = list(enumerate(value)) if isinstance(value, list) else [(None, value)]
        for position, node in entries:
            if not isinstance(node, ast.AST):
                continue
            inner = _inner(tree, field, node, scope)
            if isinstance(node, ast.expr | ast.AugAssign):
                yield Place(tree, field, position, node, inner)
            yield from places_of(node, inner)


def _inner(tree: ast.AST, field: str, node: ast.AST, scope: Scope) -> Scope:
    """Return what surrounds a node and all below it."""
    if isinstance(node, ast.ClassDef):
        stated = scope.stated or _states(node)
        return replace(scope, within=f"{scope.within}{node.name}.", stated=stated)
    if isinstance(node, ast.FunctionDef):
        name = f"{scope.within}{node.name}"
        start = min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])
        stated = scope.stated or _states(node)
        return Scope(name, scope.first_line or start, f"{name}.", stated=stated)
    if isinstance(node, STATEMENTS) or (
        isinstance(node, ast.Call) and scope.formula and called(node) in EQUATIONS
    ):
        return replace(scope, formula=10_000 * node.lineno + node.col_offset)
    if isinstance(tree, ast.Call) and called(tree) in DRAWS:
        return replace(scope, formula=0)
    if (isinstance(tree, ast.Subscript) and field == "slice") or (
        isinstance(tree, ast.BinOp) and isinstance(tree.op, ast.Pow) and field == "right"
    ):
        return replace(scope, index=True)
    return scope


def _states(node: ast.FunctionDef | ast.ClassDef) -> bool:
    """Return whether the docstring states an equation before its sections, or names one."""
    words = (ast.get_docstring(node) or "").split("Examples\n")[0]
    prose = words.split("Parameters\n")[0].split("Attributes\n")[0]
    return bool(re.search(r"\(\d\d?\)|Eqs?\. ?\(?\d", words) or re.search(r"\S = \S", prose))


def _left_alone(tree: ast.AST, field: str) -> bool:
    if isinstance(tree, ast.Raise | ast.Assert | ast.JoinedStr | ast.Import | ast.ImportFrom):
        return True
    if isinstance(tree, ast.FunctionDef):
        return field != "body"
    if isinstance(tree, ast.AnnAssign):
        return field != "value"
    if isinstance(tree, ast.ClassDef):
        return field != "body"
    if isinstance(tree, ast.keyword):
        return tree.arg in SETTINGS
    if isinstance(tree, ast.Call):
        return called(tree) in UNCHANGED_CALLS
    return False


def called(node: ast.Call) -> str:
    """Return the last name of what is called; empty if it has none."""
    if isinstance(node.func, ast.Attribute):
        return node.func.attr
    return node.func.id if isinstance(node.func, ast.Name) else ""
