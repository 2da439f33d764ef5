"""The list of changes to one module: one sign, factor, index, comparison or function each.

Only what computes is changed. Left alone are docstrings, annotations, default values, messages,
everything inside ``raise`` and ``assert``, checks of parameters, and numbers below 1e-5 or above
1e4, which are tolerances and limits, and wall-clock times. A comparison is reversed, not moved by
its own boundary.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial

from benchmarks.mutation.places import Place, Scope, called, places_of

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

SMALLEST, LARGEST = 1e-5, 1e4

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
    render : callable
        Writes ``source``, the whole module with the change.
    formula : int
        Number of the formula in the module: a simple statement, or an equation within one; 0
        outside any, as in a condition.
    kind : str
        ``sign``, ``factor`` or ``index`` (of a subscript, or an exponent); empty for the rest.
    stated : bool
        Whether the docstring of the function or its class states an equation, or names one by its
        number.
    """

    module: str
    function: str
    line: int
    first_line: int
    change: str
    render: Callable[[], str] = field(repr=False, compare=False)
    formula: int = 0
    kind: str = ""
    stated: bool = False

    @cached_property
    def source(self) -> str:
        """The whole module with the change."""
        return self.render()

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
    for place in places_of(tree, Scope()):
        node, scope = place.node, place.scope
        changed = _change(node)
        if changed is None:
            continue
        text = f"{_short(node)} -> {_short(changed)}"
        seen[scope.function, text] += 1
        if seen[scope.function, text] > 1:
            text += f" #{seen[scope.function, text]}"
        kind = _kind(place) if scope.formula else ""
        where = (scope.function, node.lineno, scope.first_line)
        write = partial(_rendered, tree, place, changed)
        found.append(Mutant(module, *where, text, write, scope.formula, kind, scope.stated))
    return found


def _rendered(tree: ast.AST, place: Place, changed: ast.AST) -> str:
    _put(place, changed)
    source = ast.unparse(tree)
    _put(place, place.node)
    return source


def _short(node: ast.AST) -> str:
    text = " ".join(ast.unparse(node).split())
    return text if len(text) <= 90 else f"{text[:43]} ... {text[-42:]}"


def _put(place: Place, node: ast.AST) -> None:
    if place.position is None:
        setattr(place.parent, place.field, node)
    else:
        getattr(place.parent, place.field)[place.position] = node


def _kind(place: Place) -> str:
    node = place.node
    if place.scope.index and isinstance(node, ast.BinOp | ast.UnaryOp | ast.Constant):
        return "index"
    if isinstance(node, ast.BinOp | ast.AugAssign):
        return "sign" if isinstance(node.op, ast.Add | ast.Sub) else "factor"
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return "sign"
    if isinstance(node, ast.Call) and called(node) in NEGATED:
        return "sign"
    if isinstance(node, ast.Constant):
        if isinstance(node.value, complex):
            return "sign"
        if isinstance(place.parent, ast.BinOp) or (
            isinstance(place.parent, ast.Call) and called(place.parent) in RATIONALS
        ):
            return "factor"
    return ""


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
    name = called(node)
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
