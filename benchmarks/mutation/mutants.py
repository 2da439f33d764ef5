"""The list of changes to one module, one at a time.

In formulas, a sign, a factor, an index or a function is changed. In code that makes decisions, a
comparison is reversed or its boundary included or excluded; a term, a condition, a branch or a
call is dropped; two arguments are swapped; a flag or a default value is changed; a tolerance is
multiplied by a thousand; a stated error is divided by a hundred or made negative. Docstrings,
annotations, messages, everything inside ``raise`` and ``assert``, the limits of parameters, numbers
above 1e4, wall-clock times and the looks of pictures are left unchanged.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import pairwise

from benchmarks.mutation.places import ExpressionPlace, Scope, called, places_of

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
BOUNDARIES: dict[type[ast.cmpop], type[ast.cmpop]] = {
    ast.Lt: ast.LtE,
    ast.LtE: ast.Lt,
    ast.Gt: ast.GtE,
    ast.GtE: ast.Gt,
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
"""Functions, methods and attributes, each with the one that replaces it."""

NEGATED = frozenset({"exp", "expm1", "expj"})
"""Functions whose argument is negated."""

DROPPED = frozenset({"conj", "conjugate", "abs", "sqrt", "log", "log1p", "arcsinh", "asinh"})
"""Functions that are replaced by their argument."""

SYMMETRIC = frozenset(
    {
        "max",
        "min",
        "maximum",
        "minimum",
        "hypot",
        "array_equal",
        "isinstance",
        "getattr",
        "hasattr",
        "has",
        "atoms",
        "as_independent",
        "same_file",
    }
)
"""Functions whose arguments are not swapped: a swap has no effect, or breaks the program."""

LOGS = frozenset({"info", "debug"})
"""Calls that are neither dropped nor changed, since their output only serves debugging."""

LONGEST = 90
"""Number of characters of an expression in the name of a change; a longer one is shortened."""

SMALLEST, LARGEST = 1e-5, 1e4
"""Numbers below the first are treated as tolerances, numbers above the second as limits."""


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
        Line of the change.
    outermost : str
        Qualified name of the outermost function around it; empty outside any.
    change : str
        ``before -> after``. Equal changes of one function are told apart by what surrounds them,
        ``before -> after in statement``, and if this is equal too, by ``#2`` for the second.
    tree, place, changed
        The module as a syntax tree, the place of the change in it, and the new expression.
    """

    module: str
    function: str
    line: int
    outermost: str
    change: str
    tree: ast.Module = field(repr=False, compare=False)
    place: ExpressionPlace = field(repr=False, compare=False)
    changed: ast.AST = field(repr=False, compare=False)

    @property
    def qualified(self) -> str:
        """``module:qualified name`` of the function, which may be nested in another one."""
        return f"{self.module}:{self.function}"

    @property
    def function_at(self) -> str:
        """``module:qualified name`` of the outermost function."""
        return f"{self.module}:{self.outermost}"

    @property
    def of_default(self) -> bool:
        """Whether a default value is changed."""
        return self.change.startswith("default ")

    @property
    def statement(self) -> ast.stmt:
        """The statement of the module that contains the place, in its present form."""
        return next(
            each for each in reversed(self.tree.body)
            if min([each.lineno, *(d.lineno for d in getattr(each, "decorator_list", ()))])
            <= self.line
        )  # fmt: skip

    @property
    def unchanged(self) -> bool:
        """Whether nothing is changed, so that whatever notices it is a fault of the run."""
        return self.changed is self.place.node

    @contextmanager
    def made(self) -> Iterator[ast.Module]:
        """Yield the tree with the change, which is undone when the context ends."""
        self.place.put(self.changed)
        try:
            yield self.tree
        finally:
            self.place.put(self.place.node)

    @property
    def name(self) -> str:
        """``module:function:change``."""
        return f"{self.module}:{self.function}:{self.change}"


def mutants_of(module: str, source: str) -> list[Mutant]:
    """Return every change of a module, in the order of its lines.

    Examples
    --------
    >>> source = "def f(x): return x - sin(2 * x)"
    >>> for mutant in mutants_of("m.py", source):
    ...     print(mutant.change)
    x - sin(2 * x) -> x + sin(2 * x)
    x - sin(2 * x) -> x
    sin(2 * x) -> cos(2 * x)
    2 * x -> 2 / x
    2 -> 3
    """
    tree = ast.parse(source)
    timed = "perf_counter" in source
    found = []
    for place in places_of(tree, Scope()):
        node, scope = place.node, place.scope
        if timed and "perf_counter()" in ast.unparse(node):
            continue
        old = ""
        for new in _changes(place):
            changed = ast.copy_location(ast.fix_missing_locations(new), node)
            old = old or _short(node)
            text = f"{old} -> {_short(changed)}"
            if scope.default:
                text = f"default {text}"
            where = (scope.function, node.lineno, scope.outermost)
            found.append(Mutant(module, *where, text, tree, place, changed))
    return _told_apart(_told_apart(found, _surroundings(tree)), _number())


def _told_apart(mutants: list[Mutant], mark: Callable[[Mutant], str]) -> list[Mutant]:
    """Return the changes, with a mark added to those whose names are equal."""
    count = Counter(mutant.name for mutant in mutants)
    return [
        replace(mutant, change=mutant.change + mark(mutant)) if count[mutant.name] > 1 else mutant
        for mutant in mutants
    ]


def _surroundings(tree: ast.Module) -> Callable[[Mutant], str]:
    """Return the mark of a change: the largest part of its statement that fits into a name.

    An edit of the statement then gives the change another name, so that an explanation of the old
    one is not taken for its explanation.
    """
    parents = {child: node for node in ast.walk(tree) for child in ast.iter_child_nodes(node)}

    def mark(mutant: Mutant) -> str:
        node: ast.AST = mutant.place.node
        around = []
        while not isinstance(node, ast.stmt | ast.arguments):
            node = parents[node]
            # Of an ``if`` or a loop, the first line.
            around.append(ast.unparse(node).split("\n")[0])
        short = [text for text in around if len(text) <= LONGEST]
        return f" in {short[-1] if short else _short(parents[mutant.place.node])}" if around else ""

    return mark


def _number() -> Callable[[Mutant], str]:
    """Return the mark of a change: nothing for the first of one name, #2 for the second."""
    seen: Counter[str] = Counter()

    def mark(mutant: Mutant) -> str:
        seen[mutant.name] += 1
        return f" #{seen[mutant.name]}" if seen[mutant.name] > 1 else ""

    return mark


def by_statement(mutants: list[Mutant]) -> list[list[Mutant]]:
    r"""Return the changes of one module, grouped by the innermost statement that contains each.

    Examples
    --------
    >>> source = "def f(x):\n    y = 2 * x\n    return y + 1"
    >>> [[mutant.change for mutant in of_one] for of_one in by_statement(mutants_of("m", source))]
    [['2 * x -> 2 / x', '2 -> 3'], ['y + 1 -> y - 1', 'y + 1 -> y', 'y + 1 -> 1', '1 -> 2']]
    """
    found: dict[ast.stmt, list[Mutant]] = {}
    nodes = ast.walk(mutants[0].tree) if mutants else ()  # outer statements come before inner ones
    statements = [node for node in nodes if isinstance(node, ast.stmt)]
    for mutant in mutants:
        around = [q for q in statements if q.lineno <= mutant.line <= (q.end_lineno or 0)]
        found.setdefault(around[-1], []).append(mutant)
    return list(found.values())


def _short(node: ast.AST) -> str:
    text = " ".join(ast.unparse(node).split())
    return text if len(text) <= LONGEST else f"{text[:43]} ... {text[-42:]}"


def _changes(place: ExpressionPlace) -> Iterator[ast.expr | ast.AugAssign]:
    """Yield the replacements of an expression or statement, one after another."""
    node = place.node
    first = _of_a_formula(node)
    if first is not None:
        yield first
    if isinstance(node, ast.expr):
        yield from _of_a_judgement(place, node)


def _of_a_formula(node: ast.expr | ast.AugAssign) -> ast.expr | ast.AugAssign | None:
    """Return the expression with another sign, factor, index, comparison or function."""
    new: ast.expr | ast.AugAssign | None = None
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS and not _holds_text(node):
        new = ast.BinOp(node.left, OPERATORS[type(node.op)](), node.right)
    elif isinstance(node, ast.AugAssign) and type(node.op) in OPERATORS:
        new = ast.AugAssign(node.target, OPERATORS[type(node.op)](), node.value)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not | ast.Invert):
        new = node.operand
    elif isinstance(node, ast.Compare):
        new = _compared(node, COMPARISONS)
    elif isinstance(node, ast.BoolOp):
        op = ast.Or() if isinstance(node.op, ast.And) else ast.And()
        new = ast.BoolOp(op, node.values)
    elif isinstance(node, ast.Constant):
        new = _other_number(node.value)
    elif isinstance(node, ast.Attribute) and node.attr in ("real", "imag"):
        new = ast.Attribute(node.value, FUNCTIONS[node.attr], node.ctx)
    elif isinstance(node, ast.Call):
        new = _other_call(node)
    return new


def _of_a_judgement(place: ExpressionPlace, node: ast.expr) -> Iterator[ast.expr]:
    """Yield the changes of a decision: a boundary, term, condition, branch or call each."""
    if isinstance(node, ast.Compare) and (moved := _compared(node, BOUNDARIES)):
        yield moved
    elif isinstance(node, ast.BinOp) and not _holds_text(node):
        if isinstance(node.op, ast.Add | ast.Sub):
            yield node.left
        if isinstance(node.op, ast.Add):
            yield node.right
    elif isinstance(node, ast.BoolOp):
        for i in range(len(node.values)):
            left = [*node.values[:i], *node.values[i + 1 :]]
            yield left[0] if len(left) == 1 else ast.BoolOp(node.op, left)
    elif isinstance(node, ast.IfExp):
        yield from (node.body, node.orelse)
    elif isinstance(node, ast.Call) and called(node) not in LOGS:
        if isinstance(place.parent, ast.Expr):
            yield ast.Constant(...)
        yield from _swapped(node)
    yield from _of_a_setting(place, node)


def _of_a_setting(place: ExpressionPlace, node: ast.expr) -> Iterator[ast.expr]:
    """Yield the opposite flag, a tolerance times a thousand, a stated error reduced or negative."""
    if isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield ast.Constant(not node.value)
    value = getattr(node, "value", None)
    if isinstance(node, ast.Constant) and isinstance(value, float) and 0 < abs(value) < SMALLEST:
        yield ast.Constant(float(f"{1e3 * value:.15g}"))
    if "error" in place.scope.keyword and isinstance(node, ast.BinOp | ast.Call | ast.Attribute):
        yield ast.BinOp(ast.Constant(0.01), ast.Mult(), node)
        yield ast.UnaryOp(ast.USub(), node)


def _compared(
    node: ast.Compare, other: dict[type[ast.cmpop], type[ast.cmpop]]
) -> ast.Compare | None:
    if len(node.ops) != 1 or type(node.ops[0]) not in other:
        return None
    return ast.Compare(node.left, [other[type(node.ops[0])]()], node.comparators)


def _swapped(node: ast.Call) -> Iterator[ast.Call]:
    """Yield the call with two adjacent arguments swapped."""
    if called(node) in SYMMETRIC:
        return
    for i, (one, other) in enumerate(pairwise(node.args)):
        starred = isinstance(one, ast.Starred) or isinstance(other, ast.Starred)
        if not starred and ast.unparse(one) != ast.unparse(other):
            arguments = [*node.args[:i], other, one, *node.args[i + 2 :]]
            yield ast.Call(node.func, arguments, node.keywords)


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
