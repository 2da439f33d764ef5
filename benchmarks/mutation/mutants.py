"""The list of changes to one module: one sign, factor, index, comparison or function each.

Only what computes is changed. Left alone are docstrings, annotations, default values, messages,
everything inside ``raise`` and ``assert``, checks of parameters, and numbers below 1e-5 or above
1e4, which are tolerances and limits, and wall-clock times. A comparison is reversed, not moved by
its own boundary.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

OPERATORS: dict[type[ast.operator], type[ast.operator]] = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
}
COMPARISONS: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.GtE,
    ast.GtE: ast.Lt,
    ast.Gt: ast.LtE,
    ast.LtE: ast.Gt,
    ast.Eq: ast.NotEq,
    ast.NotEq: ast.Eq,
}
FUNCTIONS = {
    "sin": "cos",
    "cos": "sin",
    "tan": "sin",
    "sinh": "cosh",
    "cosh": "sinh",
    "tanh": "sinh",
    "max": "min",
    "min": "max",
    "maximum": "minimum",
    "minimum": "maximum",
    "argmin": "argmax",
    "argmax": "argmin",
    "ceil": "floor",
    "floor": "ceil",
    "real": "imag",
    "imag": "real",
    "any": "all",
    "all": "any",
}
"""A function, method or attribute, and what takes its place."""

NEGATED = frozenset({"exp", "expm1", "expj"})
"""Functions whose argument changes its sign."""

DROPPED = frozenset({"conj", "conjugate", "abs", "sqrt", "log", "log1p", "arcsinh", "asinh"})
"""Functions that are replaced by their argument."""

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

SMALLEST, LARGEST = 1e-5, 1e4

STATEMENTS = (ast.Assign, ast.AnnAssign, ast.AugAssign, ast.Return, ast.Expr)
"""Statements that may hold a formula."""

EQUATIONS = frozenset({"equation", "Eq", "Printed"})
"""Calls each of which is a formula by itself, within the list that holds it."""

RATIONALS = frozenset({"Rational", "Integer", "mpf", "mpc"})
"""Calls whose arguments are numbers of a formula."""


@dataclass(frozen=True)
class Mutant:
    """One change.

    Attributes
    ----------
    module : str
        Path of the module from the root of the project.
    function : str
        Qualified name of the function; ``<module>`` outside any.
    line : int
        Where.
    first_line : int
        Line of the outermost ``def`` or decorator of the function; 0 outside any.
    change : str
        ``before -> after``, with ``#2`` for the second equal change in the function.
    source : str
        The whole module with the change.
    formula : int
        Number of the formula in the module: a simple statement, or an equation within one; 0
        outside any, as in a condition.
    kind : str
        ``sign``, ``factor`` or ``index`` (of a subscript, or an exponent); empty for the rest.
    """

    module: str
    function: str
    line: int
    first_line: int
    change: str
    source: str
    formula: int = 0
    kind: str = ""

    @property
    def name(self) -> str:
        """``module:function:change``."""
        return f"{self.module}:{self.function}:{self.change}"


def mutants_of(module: str, source: str) -> list[Mutant]:
    """Return every change of a module, in the order of its lines.

    Examples
    --------
    >>> source = "def f(x): return x - sin(2 * x)"
    >>> [mutant.change for mutant in mutants_of("m.py", source)]
    ['x - sin(2 * x) -> x + sin(2 * x)', 'sin(2 * x) -> cos(2 * x)', '2 * x -> 2 / x', '2 -> 3']
    """
    tree = ast.parse(source)
    found = []
    seen: Counter[tuple[str, str]] = Counter()
    for place in _places(tree, Scope()):
        node, scope = place.node, place.scope
        changed = _change(node)
        if changed is None:
            continue
        text = f"{_short(node)} -> {_short(changed)}"
        seen[scope.function, text] += 1
        if seen[scope.function, text] > 1:
            text += f" #{seen[scope.function, text]}"
        _put(place, changed)
        source = ast.unparse(tree)
        _put(place, node)
        kind = _kind(place) if scope.formula else ""
        where = (scope.function, node.lineno, scope.first_line)
        found.append(Mutant(module, *where, text, source, scope.formula, kind))
    return found


@dataclass(frozen=True)
class Scope:
    """What surrounds a place: the function, the classes and functions, the formula, an index."""

    function: str = "<module>"
    first_line: int = 0
    within: str = ""
    formula: int = 0
    index: bool = False


@dataclass(frozen=True)
class Place:
    """Where an expression, or a statement like ``x += 1``, hangs."""

    parent: ast.AST
    field: str
    position: int | None
    node: ast.expr | ast.AugAssign
    scope: Scope


def _short(node: ast.AST) -> str:
    text = " ".join(ast.unparse(node).split())
    return text if len(text) <= 90 else f"{text[:43]} ... {text[-42:]}"


def _put(place: Place, node: ast.AST) -> None:
    if place.position is None:
        setattr(place.parent, place.field, node)
    else:
        getattr(place.parent, place.field)[place.position] = node


def _places(tree: ast.AST, scope: Scope) -> Iterator[Place]:
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
            yield from _places(node, inner)


def _inner(tree: ast.AST, field: str, node: ast.AST, scope: Scope) -> Scope:
    """Return what surrounds a node and all below it."""
    if isinstance(node, ast.ClassDef):
        return replace(scope, within=f"{scope.within}{node.name}.")
    if isinstance(node, ast.FunctionDef):
        name = f"{scope.within}{node.name}"
        start = min([node.lineno, *(decorator.lineno for decorator in node.decorator_list)])
        return Scope(name, scope.first_line or start, f"{name}.")
    if isinstance(node, STATEMENTS) or (
        isinstance(node, ast.Call) and scope.formula and _called(node) in EQUATIONS
    ):
        return replace(scope, formula=10_000 * node.lineno + node.col_offset)
    if (isinstance(tree, ast.Subscript) and field == "slice") or (
        isinstance(tree, ast.BinOp) and isinstance(tree.op, ast.Pow) and field == "right"
    ):
        return replace(scope, index=True)
    return scope


def _kind(place: Place) -> str:
    node = place.node
    if place.scope.index and isinstance(node, ast.BinOp | ast.UnaryOp | ast.Constant):
        return "index"
    if isinstance(node, ast.BinOp | ast.AugAssign):
        return "sign" if isinstance(node.op, ast.Add | ast.Sub) else "factor"
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return "sign"
    if isinstance(node, ast.Call) and _called(node) in NEGATED:
        return "sign"
    if isinstance(node, ast.Constant):
        if isinstance(node.value, complex):
            return "sign"
        if isinstance(place.parent, ast.BinOp) or (
            isinstance(place.parent, ast.Call) and _called(place.parent) in RATIONALS
        ):
            return "factor"
    return ""


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
        return _called(tree) in UNCHANGED_CALLS
    return False


def _called(node: ast.Call) -> str:
    if isinstance(node.func, ast.Attribute):
        return node.func.attr
    return node.func.id if isinstance(node.func, ast.Name) else ""


def _change(node: ast.expr | ast.AugAssign) -> ast.expr | ast.AugAssign | None:
    """Return what takes the place of this expression or statement."""
    new: ast.expr | ast.AugAssign | None = None
    if "perf_counter()" in ast.unparse(node):
        return None
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS and not _holds_text(node):
        new = ast.BinOp(node.left, OPERATORS[type(node.op)](), node.right)
    elif isinstance(node, ast.AugAssign) and type(node.op) in OPERATORS:
        new = ast.AugAssign(node.target, OPERATORS[type(node.op)](), node.value)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not | ast.Invert):
        new = node.operand
    elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in COMPARISONS:
        new = ast.Compare(node.left, [COMPARISONS[type(node.ops[0])]()], node.comparators)
    elif isinstance(node, ast.BoolOp):
        op = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        new = ast.BoolOp(op, node.values)
    elif isinstance(node, ast.Constant):
        new = _other_number(node.value)
    elif isinstance(node, ast.Attribute) and node.attr in ("real", "imag"):
        new = ast.Attribute(node.value, FUNCTIONS[node.attr], node.ctx)
    elif isinstance(node, ast.Call):
        new = _other_call(node)
    return None if new is None else ast.copy_location(ast.fix_missing_locations(new), node)


def _other_number(value: object) -> ast.expr | None:
    if isinstance(value, bool) or not isinstance(value, int | float | complex):
        return None
    if isinstance(value, complex):
        return ast.UnaryOp(ast.USub(), ast.Constant(value))
    if value and not SMALLEST <= abs(value) <= LARGEST:
        return None
    if isinstance(value, int):
        return ast.Constant(value + 1)
    return ast.Constant(2.0 * value if value else 1.0)


def _other_call(node: ast.Call) -> ast.expr | None:
    name = _called(node)
    if name in FUNCTIONS:
        if isinstance(node.func, ast.Attribute):
            func: ast.expr = ast.Attribute(node.func.value, FUNCTIONS[name], ast.Load())
        else:
            func = ast.Name(FUNCTIONS[name], ast.Load())
        return ast.Call(func, node.args, node.keywords)
    if name in NEGATED and len(node.args) == 1:
        return ast.Call(node.func, [ast.UnaryOp(ast.USub(), node.args[0])], node.keywords)
    if name in DROPPED:
        if len(node.args) == 1:
            return node.args[0]
        if not node.args and isinstance(node.func, ast.Attribute):
            return node.func.value
    return None


def _holds_text(node: ast.BinOp) -> bool:
    return any(
        isinstance(part, ast.JoinedStr)
        or (isinstance(part, ast.Constant) and isinstance(part.value, str))
        for part in ast.walk(node)
    )
