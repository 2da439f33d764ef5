"""The corrected lines of the errata, in the paper's notation, are the derived equations.

Their LaTeX is evaluated at a random point by a small reader of its own.
"""

from __future__ import annotations

import cmath
import random
import re
from typing import Any

import pytest
import sympy as sp

from derivations.judgement import Judgement, report
from paper_checks.equation_errata import AMENDED, amended

TOKEN = re.compile(r"\\[A-Za-z]+|\\.|\d+|\S")
ENDS = frozenset({"}", ")", "\\right", ",", "=", "\\\\", "+", "-"})


class Reader:
    """Evaluates LaTeX with the values of its letters."""

    def __init__(self, values: dict[str, complex]) -> None:
        self.values = values
        self.left: list[str] = []
        self.closes = [""]

    def value(self, latex: str) -> complex:
        self.left = TOKEN.findall(latex)
        found = self.sum()
        assert not self.left, self.left
        return found

    def sum(self) -> complex:
        total = 0j
        sign = 1
        if self.left[0] == "-":
            self.left.pop(0)
            sign = -1
        while True:
            total += sign * self.product()
            if not self.left or self.left[0] not in "+-":
                return total
            sign = 1 if self.left.pop(0) == "+" else -1

    def product(self) -> complex:
        result = self.power()
        while self.left and self.left[0] not in ENDS and self.left[0] != self.closes[-1]:
            if self.left[0] == "/":
                self.left.pop(0)
                result /= self.power()
            else:
                result *= self.power()
        return result

    def power(self) -> complex:
        base = self.atom()
        while self.left and self.left[0] == "^":
            self.left.pop(0)
            if self.left[0] == "*":
                self.left.pop(0)
                base = base.conjugate()
            else:
                base = base ** self.argument()
        return base

    def group(self, end: str) -> complex:
        self.closes.append(end)
        found = self.sum()
        assert self.left.pop(0) == self.closes.pop()
        return found

    def argument(self) -> complex:
        """Read one token or group; of a number its first digit, as LaTeX does."""
        token = self.left[0]
        if token.isdigit() and len(token) > 1:
            self.left[:1] = [token[0], token[1:]]
        return self.atom()

    def atom(self) -> complex:
        token = self.left.pop(0)
        if token == "{":
            return self.group("}")
        if token == "(":
            return self.group(")")
        if token == "|":
            return complex(abs(self.group("|")))
        if token == "\\left":
            self.left.pop(0)
            found = self.group("\\right")
            self.left.pop(0)
            return found
        if token == "\\frac":
            above = self.argument()
            return above / self.argument()
        if token == "\\sqrt":
            return cmath.sqrt(self.atom())
        if token.isdigit():
            return complex(int(token))
        if token == "\\dot":
            token += self.left.pop(0)
        if self.left and self.left[0] == "_":
            self.left.pop(0)
            below = self.left.pop(0)
            while below.count("{") > below.count("}"):
                below += self.left.pop(0)
            token += "_" + below.strip("{}")
        # What the derived equation does not have must drop out of the line, and does not of print.
        return self.values.get(token, 1.7 + 0j)


@pytest.fixture(scope="module")
def judgements() -> dict[int, Judgement]:
    return {found.printed.number: found for found in report().judgements}


def drawn(expression: sp.Basic, real: bool) -> tuple[dict[sp.Symbol, complex], dict[str, complex]]:
    """Draw values for the symbols, and give them under the names that the LaTeX has."""
    draw = random.Random(20260)
    values, named = {}, {"e": complex(cmath.e), "i": 1j, "\\pi": complex(cmath.pi)}
    for symbol in sorted(expression.free_symbols, key=str):
        complex_one = not real and "varphi" in str(symbol)
        value = complex(draw.uniform(0.2, 1.5), draw.uniform(0.2, 1.0) if complex_one else 0.0)
        values[symbol] = value
        name = str(symbol).replace("{\\varphi}", "\\varphi").replace("{", "").replace("}", "")
        name = re.sub(r"^(mu|alpha|omega|xi)", r"\\\1", name)
        named["\\varepsilon" if name == "epsilon" else name] = value
    return values, named


def agree(latex: str, expression: sp.Basic, real: bool = True, **names: str) -> bool:
    values, named = drawn(expression, real)
    for name, old in names.items():
        named[name] = named.get(old, 1.7 + 0j)
    expected = complex(sp.N(expression.subs(values)))
    return abs(Reader(named).value(latex) - expected) < 1e-12 * max(1.0, abs(expected))


def side(equation: Any) -> sp.Expr:
    return equation.args[0] - equation.args[1]


def cases(judgements: dict[int, Judgement]) -> dict[str, tuple[int, str, sp.Basic, Any]]:
    """Give, by name, the equation, what finds its formula in the line, and what it must be."""
    step = {number: found.step.equation for number, found in judgements.items()}
    first = judgements[37].printed.readings[1].equation
    free = judgements[40].printed.readings[1].equation.rhs
    ring = {"x_n": "x_1", "x_N+n": "x_5"}
    ends = {"x_N": "x_4", "x_N-1": "x_3", "x_N+1": "x_5", "x_2N": "x_8"}
    return {
        "2": (2, r"= (.*)", step[2].rhs, {}),
        "4": (4, r"\\xi = (.*?),", step[4][3].rhs, {}),
        "33": (33, r"(.*) = 0", side(step[33]), {}),
        "37": (37, r"(.*?) = -1", first[0].lhs, {}),
        "40 first": (40, r"(-x_1 - .*?) \\\\", free[4], ends),
        "40 last": (40, r"(-x_N - .*?)\\end", free[7], ends),
        "42": (42, r"A_\{nn\} = (.*?),\\ A", step[42].rhs[4, 0], ring),
    }


@pytest.mark.parametrize("name", ["2", "4", "33", "37", "40 first", "40 last", "42"])
def test_the_amended_line_is_the_derived_equation_and_print_is_not(
    name: str, judgements: dict[int, Judgement]
) -> None:
    number, pattern, expected, names = cases(judgements)[name]
    printed = judgements[number].printed.latex
    line = amended(number, printed)
    assert line is not None
    found = re.search(pattern, line)
    assert found is not None
    real = number != 33
    assert agree(found[1], expected, real, **names)
    if number != 37:  # its n is left open in print, and has no value here
        before = re.search(pattern, printed)
        assert before is not None
        if "dm" not in before[1]:
            assert not agree(before[1], expected, real, **names)


def test_every_amendment_fits_print_once_and_is_of_an_erratum(
    judgements: dict[int, Judgement],
) -> None:
    for number in AMENDED:
        printed = judgements[number].printed
        assert printed.verdict.value in ("misprint", "ambiguous", "inconsistent")
        assert amended(number, printed.latex) != printed.latex
    assert amended(1, "x") is None
    with pytest.raises(ValueError, match="once"):
        amended(33, "x = 0")


def test_the_amended_32_is_print_set_to_zero(judgements: dict[int, Judgement]) -> None:
    printed = judgements[32].printed
    assert amended(32, printed.latex) == f"{printed.latex} = 0"
    assert sp.expand(printed.equation - side(judgements[32].step.equation)) == 0
