"""The places where a module may be changed: its computing expressions, with their functions."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass, replace

UNCHANGED_CALLS = frozenset(
    {
        "within",
        "count_within",
        "positive",
        "Range",
        "checked_eta",
        "ParameterError",
        "PrecisionError",
        "range",
        "lru_cache",
        "dataclass",
        "errstate",
        "catch_warnings",
        "info",
        "debug",
        "new_axes",
        "new_panels",
        "set_xticks",
        "set_yticks",
    }
)
"""Calls that contain checks, messages, logging, limits of loops and sizes of pictures; they are
left unchanged."""

SETTINGS = frozenset(
    {"limit", "maxsize", "order", "digits", "maxiter", "options", "repr", "strict"}
)
"""Keyword arguments that tune a method, set how an object is printed, or make `zip` strict."""

LOOKS = frozenset(
    {
        "alpha", "bbox_to_anchor", "clip_on", "columnspacing", "dpi", "fontsize", "lw", "ms",
        "ncols", "weight", "xticks", "yticks", "zorder",
    }
)  # fmt: skip
"""Keyword arguments for the looks of pictures, and for the order of claims in a report."""


@dataclass(frozen=True)
class Scope:
    """The context of a place: function, outermost function, name prefix, keyword, signature."""

    function: str = "<module>"
    outermost: str = ""
    within: str = ""
    keyword: str = ""
    default: bool = False


@dataclass(frozen=True)
class ExpressionPlace:
    """The place of an expression, or of a statement like ``x += 1``, in the syntax tree."""

    parent: ast.AST
    field: str
    position: int | None
    node: ast.expr | ast.AugAssign
    scope: Scope

    def put(self, node: ast.AST) -> None:
        """Put another node in this place."""
        if self.position is None:
            setattr(self.parent, self.field, node)
        else:
            getattr(self.parent, self.field)[self.position] = node


def places_of(tree: ast.AST, scope: Scope) -> Iterator[ExpressionPlace]:
    """Yield the place of each expression that may be changed, outermost first."""
    for field, value in ast.iter_fields(tree):
        if _left_alone(tree, field):
            continue
        entries = list(enumerate(value)) if isinstance(value, list) else [(None, value)]
        for position, node in entries:
            if not isinstance(node, ast.AST):
                continue
            inner = _inner(tree, node, scope)
            if isinstance(node, ast.expr | ast.AugAssign):
                yield ExpressionPlace(tree, field, position, node, inner)
            yield from places_of(node, inner)


def _inner(tree: ast.AST, node: ast.AST, scope: Scope) -> Scope:
    """Return the context of a node and of all nodes below it."""
    if isinstance(node, ast.ClassDef):
        return replace(scope, within=f"{scope.within}{node.name}.")
    if isinstance(node, ast.FunctionDef):
        name = f"{scope.within}{node.name}"
        return Scope(name, scope.outermost or name, f"{name}.")
    name = ""
    if isinstance(tree, ast.keyword):
        name = tree.arg or ""
    elif isinstance(tree, ast.Assign) and isinstance(tree.targets[0], ast.Name):
        name = tree.targets[0].id
    default = scope.default or isinstance(node, ast.arguments)
    if (name, default) == (scope.keyword, scope.default):
        return scope
    return replace(scope, keyword=name, default=default)


def _left_alone(tree: ast.AST, field: str) -> bool:
    if isinstance(
        tree, ast.Raise | ast.Assert | ast.JoinedStr | ast.Import | ast.ImportFrom | ast.arg
    ):
        return True
    if isinstance(tree, ast.FunctionDef):
        return field not in ("args", "body")
    if isinstance(tree, ast.AnnAssign):
        return field != "value"
    if isinstance(tree, ast.ClassDef):
        return field != "body"
    if isinstance(tree, ast.keyword):
        return tree.arg in SETTINGS or tree.arg in LOOKS
    if isinstance(tree, ast.Call):
        return called(tree) in UNCHANGED_CALLS
    return False


def called(node: ast.Call) -> str:
    """Return the last name in the called expression; empty if it has none."""
    if isinstance(node.func, ast.Attribute):
        return node.func.attr
    return node.func.id if isinstance(node.func, ast.Name) else ""


def outermost_functions(tree: ast.AST, within: str = "") -> Iterator[tuple[str, ast.FunctionDef]]:
    r"""Yield the functions and methods not nested in a function, with their qualified names.

    Examples
    --------
    >>> tree = ast.parse("def f():\n    def g(): pass\nclass C:\n    def m(self): pass")
    >>> [name for name, _ in outermost_functions(tree)]
    ['f', 'C.m']
    """
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef):
            yield f"{within}{node.name}", node
        else:
            inner = f"{within}{node.name}." if isinstance(node, ast.ClassDef) else within
            yield from outermost_functions(node, inner)


def names_bound(statement: ast.stmt) -> frozenset[str]:
    """Return the names that a statement of a module binds there.

    Examples
    --------
    >>> sorted(names_bound(ast.parse("A, B = 1, 2").body[0])), names_bound(ast.parse("f()").body[0])
    (['A', 'B'], frozenset())
    >>> sorted(names_bound(ast.parse("A = [x for x in range(3)]").body[0]))
    ['A']
    """
    if isinstance(statement, ast.FunctionDef | ast.ClassDef):
        return frozenset({statement.name})
    nodes = list(ast.walk(statement))
    inside = {
        id(name)
        for node in nodes
        if isinstance(node, ast.comprehension)
        for name in ast.walk(node.target)
    }
    names = (node for node in nodes if isinstance(node, ast.Name) and id(node) not in inside)
    return frozenset(name.id for name in names if isinstance(name.ctx, ast.Store))
