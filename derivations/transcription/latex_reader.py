r"""Read the printed LaTeX into a SymPy object: a small reader for the notation of the paper.

SymPy's own parsers support neither accents with several indices (``y_{0,\hat t\hat t}^{(1)}``) nor
``cases``, matrices with dots, evaluation bars or sums over a set. This reader attaches no meaning
to names: a `Notation` states what each name stands for, and whether a bracket after it contains
arguments.

Grammar, loosest binding first::

    statements = statement {("," | ";" | new line) statement}
    statement  = relation {("\Leftrightarrow" | "\rightarrow") relation}
    relation   = sum {("=" | "<" | ">" | "\ne" | "\le" | "\approx" | "\equiv" | "\ll") sum}
    sum        = ["+" | "-"] product {("+" | "-") product}
    product    = factor {["/" | "\cdot" | "\times"] factor}
    factor     = primary {"^" exponent}
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import sympy as sp

from derivations.algebra.errors import DerivationInputError
from derivations.transcription.latex_tokens import NEW_LINE, joined, tokens_of

ACCENTS = frozenset((r"\dot", r"\ddot", r"\tilde", r"\hat", r"\bar"))
RELATIONS: dict[str, Callable[[sp.Basic, sp.Basic], sp.Basic]] = {
    "=": lambda x, y: sp.Eq(x, y, evaluate=False),
    r"\approx": lambda x, y: sp.Eq(x, y, evaluate=False),
    r"\equiv": lambda x, y: sp.Eq(x, y, evaluate=False),
    r"\ne": lambda x, y: sp.Ne(x, y, evaluate=False),
    "<": lambda x, y: sp.Lt(x, y, evaluate=False),
    ">": lambda x, y: sp.Gt(x, y, evaluate=False),
    r"\le": lambda x, y: sp.Le(x, y, evaluate=False),
    r"\ge": lambda x, y: sp.Ge(x, y, evaluate=False),
}
ORDER_OF_MAGNITUDE = r"\ll"
"""A remark on magnitudes, which is read and dropped, since it is not an equation."""
CONNECTIVES: dict[str, Callable[[sp.Basic, sp.Basic], sp.Basic]] = {
    r"\Leftrightarrow": lambda x, y: sp.Equivalent(x, y, evaluate=False),
    r"\rightarrow": sp.Tuple,
}
OPERATORS: dict[str, Callable[[sp.Expr], sp.Expr]] = {
    r"\sin": sp.sin, r"\cos": sp.cos, r"\exp": sp.exp, r"\ln": sp.log, r"\sgn": sp.sign,
    r"\Im": sp.im,
}  # fmt: skip
SEPARATORS = frozenset((",", ";", NEW_LINE))
BLANK = sp.Symbol("blank")
"""An empty cell of a matrix."""
DOTS = {r"\vdots": sp.Symbol(r"\vdots"), r"\ddots": sp.Symbol(r"\ddots")}
"""Entries that stand for a continuation of their neighbours."""
_CLOSING = frozenset((")", "]", "}", r"\}", "|", "&", ""))
_MATRICES = ("pmatrix", "bmatrix")


@dataclass(frozen=True, kw_only=True)
class Notation:
    r"""The meaning of the names in a set of formulas.

    Attributes
    ----------
    names : mapping of str to Basic
        Objects by name, with its accents, primes and indices. An index is written in braces without
        spaces: ``y_{n+1}``, ``\dot{\varphi}_{n}``, ``y_{0}^{(1)}``.
    functions : mapping of str to callable
        Names after which a bracket contains arguments, with the functions that receive these.
    sum_over : callable or None
        Makes the sum of a term over a variable in a set.
    """

    names: Mapping[str, sp.Basic]
    functions: Mapping[str, Callable[..., sp.Basic]] = field(default_factory=dict)
    sum_over: Callable[[sp.Expr, sp.Basic, sp.Basic], sp.Expr] | None = None


def read(latex: str, notation: Notation) -> sp.Basic:
    r"""Return the object that a printed formula represents.

    Parameters
    ----------
    latex : str
        The formula, without dollar signs.
    notation : Notation
        Meaning of its names.

    Returns
    -------
    Basic
        A relation, an expression if no relation is printed, or a ``Tuple`` of several statements.

    Raises
    ------
    DerivationInputError
        If the formula contains a name or sign that the reader or the notation does not know.

    Examples
    --------
    >>> x, k = sp.symbols("x k_1")
    >>> read(r"\frac{1}{2}e^{2k_1}x = 3", Notation(names={"x": x, "k_{1}": k}))
    Eq(x*exp(2*k_1)/2, 3)
    """
    reader = _Reader(tokens_of(latex), notation)
    found = reader.statements()
    if reader.token:
        raise reader.unexpected("the end of the formula")
    return found[0] if len(found) == 1 else sp.Tuple(*found)


class _Reader:
    """A position in the tokens; each method reads one rule of the grammar and advances."""

    def __init__(self, tokens: tuple[str, ...], notation: Notation) -> None:
        self.tokens = tokens
        self.notation = notation
        self.position = 0
        self.inside_bars = False

    @property
    def token(self) -> str:
        return self.tokens[self.position] if self.position < len(self.tokens) else ""

    def take(self, expected: str | None = None) -> str:
        found = self.token
        if not found or (expected is not None and found != expected):
            raise self.unexpected(expected or "more of the formula")
        self.position += 1
        return found

    def unexpected(self, allowed: str) -> DerivationInputError:
        read = joined(self.tokens[max(self.position - 12, 0) : self.position])
        return DerivationInputError(
            "LaTeX", f"'{self.token}' after '{read}'", allowed,
            "write the formula in the notation of the paper",
        )  # fmt: skip

    def statements(self) -> list[sp.Basic]:
        found: list[sp.Basic] = []
        while self.token not in ("", r"\}"):
            found += self.statement()
            while self.token in SEPARATORS:
                self.take()
        return found

    def statement(self) -> list[sp.Basic]:
        """Read one statement; ``a = b = c`` yields two."""
        if self.token == r"\begin{cases}":
            after = self._after_environment()
            if after in SEPARATORS or after in _CLOSING:
                return [cell for row in self.rows() for cell in row]
        found = self.relations()
        while self.token in CONNECTIVES:
            connective = CONNECTIVES[self.take()]
            right = self.relations()
            found = [connective(found[0], right[0])]
        return found

    def relations(self) -> list[sp.Basic]:
        sides, signs = [self.sum()], []
        while self.token in RELATIONS:
            signs.append(self.take())
            sides.append(self.sum())
        if self.token == ORDER_OF_MAGNITUDE:
            self.take()
            self.sum()
            return []
        if not signs:
            return [sides[0]]
        return [RELATIONS[sign](*pair) for sign, pair in zip(signs, pairwise(sides), strict=True)]

    def sum(self) -> sp.Expr:
        total = None
        while total is None or self.token in ("+", "-"):
            sign = -1 if self.token == "-" else 1
            if self.token in ("+", "-"):
                self.take()
            term = self.product()
            # SymPy would multiply out a plain number times a sum.
            signed = term if sign == 1 else sp.Mul(sp.Integer(-1), term, evaluate=term.is_Matrix)
            total = signed if total is None else total + signed
        return total

    def product(self) -> sp.Expr:
        total = self.factor()
        while True:
            if self.token in (r"\cdot", r"\times"):
                self.take()
                total = total * self.factor()
            elif self.token == "/":
                self.take()
                total = total / self.factor()
            elif self._starts_factor():
                total = total * self.factor()
            else:
                return total

    def _starts_factor(self) -> bool:
        token = self.token
        if token == "|":
            return not self.inside_bars
        if token in ("+", "-", "/") or token in _CLOSING or token in SEPARATORS:
            return False
        if (
            token in RELATIONS
            or token in CONNECTIVES
            or token in (ORDER_OF_MAGNITUDE, r"\in", ":", "'", "^", "_")
        ):
            return False
        return not token.startswith(r"\end")

    def factor(self) -> sp.Expr:
        base = self.primary()
        while self.token == "^":
            exponent = self._exponent()
            base = sp.conjugate(base) if exponent is None else base**exponent
        return base

    def _exponent(self) -> sp.Expr | None:
        """Read ``^...``; return None for the star of a complex conjugate."""
        raw = self._raw_after("^")
        if raw in (("*",), ("(", "*", ")")):
            return None
        return self._inner(raw)

    def _inner(self, tokens: tuple[str, ...]) -> sp.Expr:
        reader = _Reader(tokens, self.notation)
        found = reader.sum()
        if reader.token:
            raise reader.unexpected("the end of an exponent or index")
        return found

    def _raw_after(self, mark: str) -> tuple[str, ...]:
        """Return the tokens of the group, or the single token, after ``^``, ``_`` or an accent."""
        self.take(mark)
        if self.token != "{":
            if self.token in ACCENTS:
                return (self.take(), *self._raw_after_here())
            return (self.take(),)
        return self._group()

    def _raw_after_here(self) -> tuple[str, ...]:
        return ("{", *self._group(), "}") if self.token == "{" else (self.take(),)

    def _group(self) -> tuple[str, ...]:
        self.take("{")
        start, depth = self.position, 1
        while depth:
            depth += {"{": 1, "}": -1}.get(self.take(), 0)
        return self.tokens[start : self.position - 1]

    def primary(self) -> sp.Expr:
        token = self.token
        if token[:1].isdigit():
            return self._number_or_block()
        if token in ("(", "[", "{"):
            return self._bracket({"(": ")", "[": "]", "{": "}"}[token])
        if token == "|":
            return sp.Abs(self._bracket("|"))
        if token == r"\frac":
            self.take()
            top, bottom = (self._inner(self._braced()) for _ in range(2))
            return top / bottom
        if token == r"\sqrt":
            self.take()
            return sp.sqrt(self._inner(self._braced()))
        if token in OPERATORS:
            return self._operator()
        if token == r"\sum":
            return self._sum_over()
        if token == r"\{":
            return self._set()
        if token.startswith(r"\begin"):
            return self._environment()
        if token in DOTS:
            return DOTS[self.take()]
        return self._name()

    def _braced(self) -> tuple[str, ...]:
        return self._group() if self.token == "{" else (self.take(),)

    def _number_or_block(self) -> sp.Expr:
        digits = self.take()
        while "." not in digits and self.token.isdigit():
            digits += self.take()
        if self.token == "_":  # a block of zeros, 0_{N x N}
            return self._looked_up(f"{digits}_{{{self._index()}}}")
        return sp.Rational(digits)

    def _bracket(self, closing: str) -> sp.Expr:
        self.take()
        before, self.inside_bars = self.inside_bars, closing == "|"
        found = self.sum()
        self.inside_bars = before
        self.take(closing)
        return found

    def _operator(self) -> sp.Expr:
        operator = OPERATORS[self.take()]
        power = self._exponent() if self.token == "^" else None
        found = operator(self.factor())
        return found if power is None else found**power

    def _sum_over(self) -> sp.Expr:
        self.take()
        inside = _Reader(self._raw_after("_"), self.notation)
        variable = inside._name()
        inside.take(r"\in")
        members = inside._name()
        if self.notation.sum_over is None:
            raise self.unexpected("a sum that the notation knows")
        return self.notation.sum_over(self.product(), variable, members)

    def _set(self) -> sp.Basic:
        self.take(r"\{")
        variable = self._name()
        self.take(":")
        conditions = self.statements()
        self.take(r"\}")
        return sp.ConditionSet(variable, sp.And(*conditions, evaluate=False), sp.S.Complexes)

    def _after_environment(self) -> str:
        depth = 0
        for position in range(self.position, len(self.tokens)):
            depth += self.tokens[position].startswith(r"\begin")
            depth -= self.tokens[position].startswith(r"\end")
            if depth == 0:
                return self.tokens[position + 1] if position + 1 < len(self.tokens) else ""
        return ""

    def rows(self) -> list[list[sp.Basic]]:
        """Read the cells of an environment, row by row."""
        end = self.take().replace(r"\begin", r"\end")
        rows: list[list[sp.Basic]] = [[]]
        while True:
            empty = self.token in ("&", NEW_LINE, end)
            rows[-1].append(BLANK if empty else self._cell())
            mark = self.take()
            if mark == end:
                return rows
            if mark == NEW_LINE:
                rows.append([])
            elif mark != "&":
                raise self.unexpected("the end of a cell")

    def _cell(self) -> sp.Basic:
        found = self.relations()
        if self.token in (",", ";"):  # punctuation in print
            self.take()
        return found[0]

    def _environment(self) -> sp.Basic:
        name = self.token[7:-1]
        rows = self.rows()
        if name == "cases":
            return sp.Piecewise(*((row[0], row[1]) for row in rows), evaluate=False)
        if name in _MATRICES:
            return sp.ImmutableDenseMatrix(rows)
        raise DerivationInputError(
            "LaTeX environment", name, "cases, pmatrix or bmatrix", "use one of these"
        )

    def _name(self) -> sp.Basic:
        """Read a name with accents, primes, indices and markers; apply it if it is a function."""
        name = self._accented()
        while True:
            if self.token == "'":
                name += self.take()
            elif self.token == "_":
                name += f"_{{{self._index()}}}"
            elif self.token in (r"\big", r"\Big"):
                self.take()
                self.take("|")
                name += rf"\big|_{{{_Reader(self._raw_after('_'), self.notation)._flat()}}}"
            elif self.token == "^" and self._marker():
                name += f"^{{{self._marker()}}}"
                self._raw_after("^")
            else:
                break
        if name in self.notation.functions and self.token == "(":
            found = self.notation.functions[name](*self._arguments())
        elif name == "e" and self.token == "^" and "e" not in self.notation.names:
            found = sp.exp(self._exponent())
        elif name == "i" and "i" not in self.notation.names:
            found = sp.I
        else:
            found = self._looked_up(name)
        return found

    def _looked_up(self, name: str) -> sp.Basic:
        if name not in self.notation.names:
            raise DerivationInputError(
                "LaTeX name", name, "a name of the notation", "add it to the notation"
            )
        return self.notation.names[name]

    def _accented(self) -> str:
        token = self.take()
        if token in ACCENTS:
            if self.token == "{":
                inner = _Reader(self._group(), self.notation)._flat()
            else:
                inner = self._accented()
            return f"{token}{{{inner}}}"
        plain = token.isalpha() or (token.startswith("\\") and token[1:].isalpha())
        if not plain and token not in (r"\ldots",):
            self.position -= 1
            raise self.unexpected("a number, a name or a bracket")
        return token

    def _index(self) -> str:
        return _Reader(self._raw_after("_"), self.notation)._flat()

    def _flat(self) -> str:
        """Write out all tokens, with every accent in braces."""
        text = ""
        while self.token:
            text += self._accented() if self.token in ACCENTS else self.take()
        return text

    def _marker(self) -> str:
        """Return ``+``, ``-`` or ``(1)`` if an exponent is only a mark of the name."""
        position = self.position
        raw = self._raw_after("^")
        self.position = position
        text = "".join(raw)
        if text in ("+", "-", "\\pm") or (
            raw[0] == "(" and raw[-1] == ")" and text[1:-1].isdigit()
        ):
            return text
        return ""

    def _arguments(self) -> list[sp.Basic]:
        self.take("(")
        found = [self.sum()]
        while self.token == ",":
            self.take()
            found.append(self.sum())
        self.take(")")
        return found
