"""Polynomials in y and v = ẏ with named parameters: read from text, evaluated, written as code.

Text is parsed into a syntax tree, in which only numbers, names, sums, products, integer powers and
division by numbers are accepted; no code is ever evaluated. (``derivations`` imports nothing from
here and has a reader of its own; a test compares the two.)
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from typing import Any, TypeAlias

from theory.parameters import ParameterError

VARIABLES = ("y", "v")
"""Displacement and velocity."""

LONGEST, HIGHEST, MAX_TERMS = 400, 20, 200
"""Limits of the number of characters, of the degree, and of the number of intermediate terms."""

Monomial: TypeAlias = tuple[tuple[str, int], ...]
"""Sorted pairs of names and powers."""


@dataclass(frozen=True)
class Polynomial:
    """A polynomial in y, v and named parameters, with exact coefficients.

    Attributes
    ----------
    terms : dict
        Nonzero coefficient of each monomial.

    Examples
    --------
    >>> read_polynomial("1 - a*y**2").at({"a": 4.0})
    {(0, 0): 1.0, (2, 0): -4.0}
    """

    terms: Mapping[Monomial, Fraction]

    def __hash__(self) -> int:
        """Return a hash of the terms."""
        return hash(tuple(self.terms.items()))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, in alphabetical order."""
        found = {name for monomial in self.terms for name, _ in monomial}
        return tuple(sorted(found - set(VARIABLES)))

    def degree(self, variable: str) -> int:
        """Return the highest power of y or v."""
        return max((dict(each).get(variable, 0) for each in self.terms), default=0)

    def at(self, values: Mapping[str, float]) -> dict[tuple[int, int], float]:
        """Return the coefficient of each yⁱvʲ at given values of the parameters."""
        found: dict[tuple[int, int], float] = {}
        for (i, j), part in self._by_powers().items():
            total = 0.0
            for monomial, coefficient in part.items():
                factor = float(coefficient)
                for name, power in monomial:
                    factor *= values[name] ** power
                total += factor
            found[i, j] = total
        return found

    def derivative(self, variable: str) -> Polynomial:
        """Return the derivative by y or v.

        Examples
        --------
        >>> read_polynomial("a*y**3 + v").derivative("y").source()
        'y*y*(3.0*a)'
        """
        found: dict[Monomial, Fraction] = {}
        for monomial, coefficient in self.terms.items():
            powers = dict(monomial)
            power = powers.pop(variable, 0)
            if power:
                if power > 1:
                    powers[variable] = power - 1
                found[tuple(sorted(powers.items()))] = coefficient * power
        return Polynomial(found)

    def times(self, variable: str) -> Polynomial:
        """Return the product with y or v."""
        found = {}
        for monomial, coefficient in self.terms.items():
            powers = dict(monomial)
            powers[variable] = powers.get(variable, 0) + 1
            found[tuple(sorted(powers.items()))] = coefficient
        return Polynomial(found)

    def function(self, values: Mapping[str, float]) -> Callable[..., float]:
        """Return the polynomial as a function of numbers y and, optionally, v."""
        return partial(_value, self.at(values))

    def source(self) -> str:
        """Return the polynomial as a Python expression, by Horner's rule in v and then in y.

        Examples
        --------
        >>> read_polynomial("1 - a*y**2 + b*y**4").source()
        '(1.0) + y*y*((-a) + y*y*(b))'
        """
        columns: dict[int, dict[int, str]] = {}
        for (i, j), part in sorted(self._by_powers().items()):
            columns.setdefault(j, {})[i] = "+".join(_product(*term) for term in part.items())
        return _horner({j: _horner(column, "y") for j, column in columns.items()}, "v")

    def _by_powers(self) -> dict[tuple[int, int], dict[Monomial, Fraction]]:
        """Return, for each power of y and v, its coefficient as a polynomial in the parameters."""
        found: dict[tuple[int, int], dict[Monomial, Fraction]] = {}
        for monomial, coefficient in self.terms.items():
            powers = dict(monomial)
            key = powers.pop("y", 0), powers.pop("v", 0)
            found.setdefault(key, {})[tuple(sorted(powers.items()))] = coefficient
        return dict(sorted(found.items()))


def _value(terms: Mapping[tuple[int, int], float], y: float, v: float = 0.0) -> float:
    return sum(each * y**i * v**j for (i, j), each in terms.items())


def _product(monomial: Monomial, coefficient: Fraction) -> str:
    names = [name for name, power in monomial for _ in range(power)]
    if abs(coefficient) != 1 or not names:
        return "*".join([repr(float(coefficient)), *names])
    return ("-" if coefficient < 0 else "") + "*".join(names)


def _horner(coefficients: Mapping[int, str], variable: str) -> str:
    """Return Σ c_k xᵏ as nested products, the lowest power outside."""
    text, above = "", 0
    for power in sorted(coefficients, reverse=True):
        inner = coefficients[power]
        text = f"({inner}) + {_times(variable, above - power, text)}" if text else inner
        above = power
    return _times(variable, above, text) if text else "0.0"


def _times(variable: str, power: int, text: str) -> str:
    return "*".join([*[variable] * power, f"({text})"]) if power else text


def read_polynomial(text: str, quantity: str = "polynomial") -> Polynomial:
    """Read a polynomial without evaluating any code.

    Parameters
    ----------
    text : str
        The polynomial, such as ``1 - a*y**2 + b*y**4``; ``^`` also denotes a power.
    quantity : str
        Name of the quantity, for error messages.

    Raises
    ------
    ParameterError
        If the text is not a polynomial, or is too long or of too high a degree.

    Examples
    --------
    >>> read_polynomial("(1 - y)^2/4").terms
    {(): Fraction(1, 4), (('y', 1),): Fraction(-1, 2), (('y', 2),): Fraction(1, 4)}
    >>> read_polynomial("sin(y)")
    Traceback (most recent call last):
    ...
    theory.parameters.ParameterError: polynomial = 'sin(y)' is not allowed: it must be a \
polynomial in y and v = dy/dt such as 1 - a*y**2 + b*y**4; 'sin(y)' is not allowed in one: use \
numbers, names, + - * / ** and brackets only.
    """

    def refuse(why: str) -> ParameterError:
        shown = text if len(text) <= 60 else f"{text[:57]}..."
        return ParameterError(
            quantity, repr(shown), "a polynomial in y and v = dy/dt such as 1 - a*y**2 + b*y**4",
            f"{why}: use numbers, names, + - * / ** and brackets only",
        )  # fmt: skip

    if not text.strip():
        raise refuse("it is empty")
    if len(text) > LONGEST:
        raise refuse(f"it has more than {LONGEST} characters")
    plain = text.strip().replace("^", "**")
    try:
        tree = ast.parse(plain, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise refuse("it cannot be read") from None
    reader = _TermReader(plain)
    try:
        terms = reader.terms(tree)
    except _NotPolynomialError as error:
        raise refuse(str(error)) from None
    except RecursionError:
        raise refuse("its brackets are nested too deep") from None
    return Polynomial({key: value for key, value in sorted(terms.items()) if value})


class _NotPolynomialError(ValueError):
    """Raised for a part of a text that is not a polynomial."""


@dataclass(frozen=True)
class _TermReader:
    """Translates a syntax tree into terms."""

    text: str

    def terms(self, node: ast.expr) -> dict[Monomial, Fraction]:
        """Return the terms of an expression."""
        match node:
            case ast.Constant(value=int() | float() as value) if not isinstance(value, bool):
                if not abs(value) <= 1e100:
                    raise _NotPolynomialError("a number is above 1e100")
                return {(): Fraction(repr(value))}
            case ast.Name(id=name) if name.isascii() and not name.startswith("_"):
                return {((name, 1),): Fraction(1)}
            case ast.UnaryOp(op=ast.UAdd(), operand=inner):
                return self.terms(inner)
            case ast.UnaryOp(op=ast.USub(), operand=inner):
                return _scaled(self.terms(inner), Fraction(-1))
            case ast.BinOp(left=left, op=ast.Add(), right=right):
                return _added(self.terms(left), self.terms(right))
            case ast.BinOp(left=left, op=ast.Sub(), right=right):
                return _added(self.terms(left), _scaled(self.terms(right), Fraction(-1)))
            case ast.BinOp(left=left, op=ast.Mult(), right=right):
                return _multiplied(self.terms(left), self.terms(right))
            case ast.BinOp(left=left, op=ast.Div(), right=right):
                divisor = {key: each for key, each in self.terms(right).items() if each}
                if set(divisor) != {()}:
                    raise _NotPolynomialError("it may be divided only by a number other than zero")
                return _scaled(self.terms(left), 1 / divisor[()])
            case ast.BinOp(left=left, op=ast.Pow(), right=ast.Constant(value=int() as power)) if (
                not isinstance(power, bool)
            ):
                if not 0 <= power <= HIGHEST:
                    raise _NotPolynomialError(f"its powers must be from 0 to {HIGHEST}")
                found: dict[Monomial, Fraction] = {(): Fraction(1)}
                base = self.terms(left)
                for _ in range(power):
                    found = _multiplied(found, base)
                return found
        part = ast.get_source_segment(self.text, node) or "a part of it"
        raise _NotPolynomialError(f"'{part[:40]}' is not allowed in one")


def _scaled(terms: Mapping[Monomial, Fraction], by: Fraction) -> dict[Monomial, Fraction]:
    return {key: by * value for key, value in terms.items()}


def _added(
    first: Mapping[Monomial, Fraction], second: Mapping[Monomial, Fraction]
) -> dict[Monomial, Fraction]:
    total = dict(first)
    for key, value in second.items():
        total[key] = total.get(key, Fraction(0)) + value
    return total


def _multiplied(
    first: Mapping[Monomial, Fraction], second: Mapping[Monomial, Fraction]
) -> dict[Monomial, Fraction]:
    if len(first) * len(second) > 20 * MAX_TERMS:
        raise _NotPolynomialError(f"it expands to more than {MAX_TERMS} terms")
    total: dict[Monomial, Fraction] = {}
    for one, factor in first.items():
        for other, by in second.items():
            key = _merged(one, other)
            total[key] = total.get(key, Fraction(0)) + factor * by
    if len(total) > MAX_TERMS:
        raise _NotPolynomialError(f"it expands to more than {MAX_TERMS} terms")
    return total


def _merged(one: Iterable[tuple[str, int]], other: Iterable[tuple[str, int]]) -> Monomial:
    powers: dict[str, int] = dict(one)
    for name, power in other:
        powers[name] = powers.get(name, 0) + power
    if sum(powers.values()) > 2 * HIGHEST or any(powers.get(name, 0) > HIGHEST for name in "yv"):
        raise _NotPolynomialError(f"its degree is above {HIGHEST}")
    return tuple(sorted(powers.items()))


def as_polynomial(given: Any, quantity: str) -> Polynomial:
    """Return a polynomial, given as text, a number, or a SymPy expression (read from its text).

    Raises
    ------
    ParameterError
        If the polynomial is given in none of these forms.
    """
    if isinstance(given, Polynomial):
        return given
    if isinstance(given, str):
        return read_polynomial(given, quantity)
    if hasattr(given, "free_symbols") or (
        isinstance(given, (int, float)) and not isinstance(given, bool)
    ):
        return read_polynomial(str(given), quantity)
    raise ParameterError(
        quantity, type(given).__name__, "a polynomial in y and v = dy/dt: text, a number or an "
        "expression of SymPy", "give for example '1 - a*y**2 + b*y**4'",
    )  # fmt: skip
