"""Read a polynomial from text without evaluating any code, and without SymPy.

The text is parsed into a syntax tree, in which only numbers, letters, ``+ - * / ** ^`` and brackets
are accepted, with division only by numbers and powers only by small whole numbers. Anything else is
refused, and so is anything too long or too large, before it is expanded. (``theory`` has a reader
of its own, with other limits; a test compares the two.)
"""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from fractions import Fraction

from derivations.algebra.errors import DerivationInputError

LONGEST = 400
"""Characters."""
HIGHEST = 40
"""Largest exponent, and largest degree of the result."""
MAX_TERMS = 500
"""Largest number of terms of any intermediate result."""
RESERVED = frozenset({"I", "E", "pi", "T", "n", "r", "s", "t", "i", "phi", "eps", "epsilon",
                      "omega", "lambda"})  # fmt: skip
"""Names that have a meaning of their own in the results."""

Monomial = tuple[tuple[str, int], ...]
Terms = Mapping[Monomial, Fraction]

_FOREIGN = re.compile(r"[^A-Za-z0-9_ .+*/()-]")
_NUMBER = re.compile(r"(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d{1,2})?")
_ZEROS = re.compile(r"(?<![\w.])0+(?=\d)")
"""Leading zeros, which a syntax tree does not accept."""
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,15}")


class _NotPolynomialError(ValueError):
    """Raised for a part of a text that is not a polynomial."""


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
allowed: it must be a polynomial such as 1 - a*y**2 + b*y**4; ''' cannot be read; use numbers, \
letters, + - * / ** and brackets only.
    """

    def refuse(why: str) -> DerivationInputError:
        shown = text if len(text) <= 60 else text[:57] + "..."
        return DerivationInputError(
            quantity, repr(shown), "a polynomial such as 1 - a*y**2 + b*y**4",
            f"{why}; use numbers, letters, + - * / ** and brackets only",
        )  # fmt: skip

    if len(text) > LONGEST:
        raise refuse(f"it is longer than {LONGEST} characters")
    plain = _ZEROS.sub("", " ".join(text.split()).replace("^", "**"))
    if not plain:
        raise refuse("it is empty")
    if found := _FOREIGN.search(plain):
        raise refuse(f"'{found[0]}' cannot be read")
    try:
        terms = _terms(ast.parse(plain, mode="eval").body, plain)
    except _NotPolynomialError as error:
        raise refuse(str(error)) from None
    except SyntaxError as error:
        raise refuse(f"it cannot be read ({error.msg})") from None
    except (RecursionError, MemoryError):
        raise refuse("it is nested too deep") from None
    return {monomial: number for monomial, number in terms.items() if number}


def _terms(node: ast.expr, text: str) -> dict[Monomial, Fraction]:
    """Return the terms of a part of the text."""
    part = ast.get_source_segment(text, node) or ""
    match node:
        case ast.Constant() if _NUMBER.fullmatch(part):
            if len(part) > 30:
                raise _NotPolynomialError("a number has more than 30 digits")
            return {(): Fraction(part)}
        case ast.Name(id=name) if _NAME.fullmatch(name):
            if name in RESERVED or name.endswith("_") or "__" in name:
                raise _NotPolynomialError(f"the name '{name}' is taken")
            return {((name, 1),): Fraction(1)}
        case ast.UnaryOp(op=ast.UAdd() | ast.USub() as sign, operand=inner):
            return _multiply({(): _SIGN[type(sign)]}, _terms(inner, text))
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub() as sign, right=right):
            total = _terms(left, text)
            for monomial, number in _terms(right, text).items():
                total[monomial] = total.get(monomial, Fraction(0)) + _SIGN[type(sign)] * number
            return total
        case ast.BinOp(left=left, op=ast.Mult(), right=right):
            return _multiply(_terms(left, text), _terms(right, text))
        case ast.BinOp(left=left, op=ast.Div(), right=right):
            return _multiply(_terms(left, text), _inverse(_terms(right, text)))
        case ast.BinOp(left=left, op=ast.Pow(), right=right):
            return _power(_terms(left, text), ast.get_source_segment(text, right) or "")
        case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
            raise _NotPolynomialError(
                f"the number '{part[:40]}' is not a decimal whose exponent has at most two digits"
            )
    raise _NotPolynomialError(f"'{part[:40]}' is not allowed in one")


_SIGN = {ast.UAdd: Fraction(1), ast.Add: Fraction(1), ast.USub: Fraction(-1), ast.Sub: Fraction(-1)}


def _inverse(terms: Terms) -> dict[Monomial, Fraction]:
    if {monomial for monomial, number in terms.items() if number} != {()}:
        raise _NotPolynomialError("only division by a number other than zero is possible")
    return {(): 1 / terms[()]}


def _power(base: Terms, exponent: str) -> dict[Monomial, Fraction]:
    if not exponent.isdecimal() or int(exponent) > HIGHEST:
        raise _NotPolynomialError(f"an exponent must be a whole number from 0 to {HIGHEST}")
    result: dict[Monomial, Fraction] = {(): Fraction(1)}
    for _ in range(int(exponent)):
        result = _multiply(result, base)
    return result


def _multiply(left: Terms, right: Terms) -> dict[Monomial, Fraction]:
    if len(left) * len(right) > 20 * MAX_TERMS:
        raise _NotPolynomialError(f"it expands to more than {MAX_TERMS} terms")
    total: dict[Monomial, Fraction] = {}
    for first, one in left.items():
        for second, other in right.items():
            powers = dict(first)
            for name, power in second:
                powers[name] = powers.get(name, 0) + power
            if sum(powers.values()) > 2 * HIGHEST:
                raise _NotPolynomialError(f"its degree is above {2 * HIGHEST}")
            key = tuple(sorted(powers.items()))
            number = total.get(key, Fraction(0)) + one * other
            if number.numerator.bit_length() + number.denominator.bit_length() > 4000:
                raise _NotPolynomialError("its numbers are too long")
            total[key] = number
    if len(total) > MAX_TERMS:
        raise _NotPolynomialError(f"it expands to more than {MAX_TERMS} terms")
    return total
