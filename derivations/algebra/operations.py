"""The contract of an operation, and how it describes what it did.

An operation is a small frozen object: its fields are its parameters (a symbol, an order); calling
it with the source equations returns the result; and `Operation.words` describes what was done in
standard terms. No operation knows for which equation of the paper it is used.
"""

from __future__ import annotations

import re
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any, ClassVar

import sympy as sp

from derivations.algebra.notation import Script, displayed, raised


class OperationError(ArithmeticError):
    """An operation cannot be carried out on the given equations."""


class Operation(ABC):
    """An operation on equations.

    To write a new one, define a frozen dataclass whose fields are the parameters. ``__call__``
    computes the result from the sources and from nothing else, and raises `OperationError` if it
    cannot be carried out. ``phrase`` is an imperative clause without a full stop, in which
    ``{sources}`` stands for the sources, ``{first}`` and ``{others}`` for the first and the further
    ones, and the name of a field for its value.
    """

    phrase: ClassVar[str] = ""

    @abstractmethod
    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the result of the operation on the source equations."""

    def words(self, labels: Sequence[str]) -> str:
        """Describe what is done, given the names of the sources."""
        shown = {each.name: in_words(getattr(self, each.name)) for each in fields(self)}  # type: ignore[arg-type]
        return self.phrase.format(
            sources=listed(labels), first=labels[0], others=listed(labels[1:]), **shown
        )


def in_words(value: Any) -> str:
    """Return a parameter of an operation in words: an expression, several, or a table of values.

    Examples
    --------
    >>> u, v = sp.symbols("u v")
    >>> in_words((u, v)), in_words({u: 0, v: 2 * v}), in_words({u: u})
    ('u and v', 'u = 0 and v → 2⋅v', 'u constant')
    """
    if isinstance(value, Mapping):
        return listed([_pair(old, new) for old, new in value.items()])
    if isinstance(value, tuple):
        return listed([in_words(each) for each in value])
    if isinstance(value, sp.FunctionClass):
        return str(value.__name__)
    return inline(value) if isinstance(value, sp.Basic) else str(value)


def _pair(old: Any, new: Any) -> str:
    """Return an equation; with an arrow if the old is part of the new, with a word if constant."""
    before, after = in_words(old), in_words(new)
    if before == after:
        return f"{before} constant"
    return f"{before} {'→' if _holds(new, old) else '='} {after}"


def _holds(new: Any, old: Any) -> bool:
    return isinstance(new, sp.Basic) and old in new.free_symbols


def inline(expression: sp.Basic) -> str:
    """Return a short expression on one line, with Greek letters.

    Examples
    --------
    >>> inline(4 * sp.Symbol("omega_1") ** 2)
    '4 ω₁²'
    >>> inline(sp.exp(sp.I * sp.Symbol("theta")))
    'exp(i θ)'
    >>> inline(abs(sp.Symbol("v")))
    '|v|'
    """
    shown = displayed(sp.sympify(expression), Script.UNICODE)
    text = str(sp.pretty(shown, use_unicode=True, wrap_line=False))
    if "\n" not in text:
        return text.replace("│", "|")  # a box-drawing character, which LaTeX does not know
    letters = {q: sp.Symbol(str(sp.pretty(q, use_unicode=True))) for q in shown.atoms(sp.Symbol)}
    text = _POWER.sub(lambda power: raised(power[1]), str(sp.sstr(shown.xreplace(letters))))
    text = _ROOT.sub(r"√\1", _PI.sub("π", text))
    return _UNIT.sub("i", text.replace("*", " "))


_POWER = re.compile(r"\*\*(\d+)")
_UNIT = re.compile(r"\bI\b")
_PI = re.compile(r"\bpi\b")
_ROOT = re.compile(r"\bsqrt\((\w+)\)")


def listed(labels: Sequence[str]) -> str:
    """Return labels as an enumeration for a sentence.

    Examples
    --------
    >>> listed(["a", "b"]), listed(["a", "b", "c"])
    ('a and b', 'a, b and c')
    """
    if len(labels) < 2:
        return "".join(labels)
    return ", ".join(labels[:-1]) + " and " + labels[-1]
