"""Read a polynomial from text without evaluating any code, and without SymPy.

The grammar consists of numbers, letters, ``+ - * / ** ^`` and brackets, with division only by
numbers and powers only by small whole numbers. Anything else is refused, and so is anything too
long, too deeply nested or too large, before it is expanded.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from derivations.algebra.errors import DerivationInputError

LONGEST = 400
"""Characters."""
DEEPEST = 20
"""Largest depth of nested brackets and signs."""
HIGHEST = 40
"""Largest exponent, and largest degree of the result."""
MAX_TERMS = 500
"""Largest number of terms of any intermediate result."""
RESERVED = frozenset({"I", "E", "pi", "T", "n", "r", "s", "t", "i", "phi", "eps", "epsilon",
                      "omega", "lambda"})  # fmt: skip
"""Names that have a meaning of their own in the results."""

Monomial = tuple[tuple[str, int], ...]
Terms = Mapping[Monomial, Fraction]

_TOKEN = re.compile(
    r"\s*(?:((?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d{1,2}(?!\d))?)"
    r"|([A-Za-z][A-Za-z0-9_]{0,15})|(\*\*|[-+*/^()]))"
)
"""A number, optionally with an exponent of ten of at most two digits; a name; a sign."""


@dataclass
class _TokenReader:
    """The tokens, and the present position."""

    quantity: str
    text: str
    tokens: list[str]
    place: int = 0
    depth: int = 0

    def peek(self) -> str:
        return self.tokens[self.place] if self.place < len(self.tokens) else ""

    def take(self) -> str:
        token = self.peek()
        self.place += 1
        return token

    def refuse(self, why: str) -> DerivationInputError:
        shown = self.text if len(self.text) <= 60 else self.text[:57] + "..."
        return DerivationInputError(
            self.quantity,
            repr(shown),
            "a polynomial such as 1 - a*y**2 + b*y**4",
            f"{why}; use numbers, letters, + - * / ** and brackets only",
        )


def read_polynomial(text: str, quantity: str = "polynomial") -> dict[Monomial, Fraction]:
    """Return the terms of a polynomial.

    Parameters
    ----------
    text : str
        As in ``1 - a*y**2 + b*y**4``.
    quantity : str
        The quantity, for the error message.

    Returns
    -------
    dict
        Coefficient of each monomial; a monomial is a sorted tuple of (name, power).

    Raises
    ------
    DerivationInputError
        If the text is not a polynomial, or is longer, deeper or larger than allowed.

    Examples
    --------
    >>> read_polynomial("1 - 2*y**2/4")
    {(): Fraction(1, 1), (('y', 2),): Fraction(-1, 2)}
    >>> read_polynomial("__import__('os')")
    Traceback (most recent call last):
    ...
    derivations.algebra.errors.DerivationInputError: polynomial = "__import__('os')" is not \
allowed: it must be a polynomial such as 1 - a*y**2 + b*y**4; '_' cannot be read; use numbers, \
letters, + - * / ** and brackets only.
    """
    reader = _TokenReader(quantity, text, [])
    if len(text) > LONGEST:
        raise reader.refuse(f"it is longer than {LONGEST} characters")
    end = 0
    while end < len(text.rstrip()):
        match = _TOKEN.match(text, end)
        if match is None:
            raise reader.refuse(f"'{text[end:].strip()[:1]}' cannot be read")
        reader.tokens.append(match[match.lastindex or 0])
        end = match.end()
    if not reader.tokens:
        raise reader.refuse("it is empty")
    terms = _sum(reader)
    if reader.peek():
        raise reader.refuse(f"'{reader.peek()}' is out of place")
    return {monomial: number for monomial, number in terms.items() if number}


def _sum(reader: _TokenReader) -> dict[Monomial, Fraction]:
    total = _product(reader)
    while reader.peek() in ("+", "-"):
        sign = 1 if reader.take() == "+" else -1
        for monomial, number in _product(reader).items():
            total[monomial] = total.get(monomial, Fraction(0)) + sign * number
    return total


def _product(reader: _TokenReader) -> dict[Monomial, Fraction]:
    total = _signed(reader)
    while reader.peek() in ("*", "/"):
        operation, other = reader.take(), _signed(reader)
        if operation == "/":
            if set(other) != {()} or not other[()]:
                raise reader.refuse("only division by a number other than zero is possible")
            other = {(): 1 / other[()]}
        total = _multiply(reader, total, other)
    return total


def _signed(reader: _TokenReader) -> dict[Monomial, Fraction]:
    if reader.peek() not in ("+", "-"):
        return _power(reader)
    reader.depth += 1
    if reader.depth > DEEPEST:
        raise reader.refuse(f"signs and brackets are nested more than {DEEPEST} deep")
    sign = 1 if reader.take() == "+" else -1
    inner = {monomial: sign * number for monomial, number in _signed(reader).items()}
    reader.depth -= 1
    return inner


def _power(reader: _TokenReader) -> dict[Monomial, Fraction]:
    base = _atom(reader)
    if reader.peek() not in ("**", "^"):
        return base
    reader.take()
    exponent = reader.take()
    if not exponent.isdigit() or len(exponent) > 3 or int(exponent) > HIGHEST:
        raise reader.refuse(f"an exponent must be a whole number from 0 to {HIGHEST}")
    if reader.peek() in ("**", "^"):
        raise reader.refuse("a power of a power needs brackets")
    result: dict[Monomial, Fraction] = {(): Fraction(1)}
    for _ in range(int(exponent)):
        result = _multiply(reader, result, base)
    return result


def _atom(reader: _TokenReader) -> dict[Monomial, Fraction]:
    token = reader.take()
    if token == "(":
        reader.depth += 1
        if reader.depth > DEEPEST:
            raise reader.refuse(f"signs and brackets are nested more than {DEEPEST} deep")
        inner = _sum(reader)
        if reader.take() != ")":
            raise reader.refuse("a bracket is not closed")
        reader.depth -= 1
        return inner
    if token[:1].isdigit() or token[:1] == ".":
        if len(token) > 30:
            raise reader.refuse("a number has more than 30 digits")
        return {(): Fraction(token if token != "." else "0")}
    if token[:1].isalpha():
        if token in RESERVED or token.endswith("_") or "__" in token:
            raise reader.refuse(f"the name '{token}' is taken")
        if reader.peek() == "(":
            raise reader.refuse(f"'{token}(' looks like a call")
        return {((token, 1),): Fraction(1)}
    raise reader.refuse(f"'{token}' is out of place" if token else "it ends too early")


def _multiply(reader: _TokenReader, left: Terms, right: Terms) -> dict[Monomial, Fraction]:
    if len(left) * len(right) > 20 * MAX_TERMS:
        raise reader.refuse(f"it expands to more than {MAX_TERMS} terms")
    total: dict[Monomial, Fraction] = {}
    for first, one in left.items():
        for second, other in right.items():
            powers = dict(first)
            for name, power in second:
                powers[name] = powers.get(name, 0) + power
            if sum(powers.values()) > 2 * HIGHEST:
                raise reader.refuse(f"its degree is above {2 * HIGHEST}")
            key = tuple(sorted(powers.items()))
            number = total.get(key, Fraction(0)) + one * other
            if number.numerator.bit_length() + number.denominator.bit_length() > 4000:
                raise reader.refuse("its numbers are too long")
            total[key] = number
    if len(total) > MAX_TERMS:
        raise reader.refuse(f"it expands to more than {MAX_TERMS} terms")
    return total
