"""Conversion of text, expressions or tables to exact coefficients, and to a chain."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TypeAlias

import sympy as sp

from derivations.algebra.errors import DerivationInputError
from derivations.cell.polynomial_text import HIGHEST, Monomial, read_polynomial
from derivations.chain import PAPER, ChainModel

Coefficients: TypeAlias = str | sp.Expr | Mapping[int, float | str | sp.Expr] | None

VARIABLE, VELOCITY = "y", "v"
MAX_REACH = 3
"""Largest number of neighbours on a side; beyond it the second order takes minutes."""


def coefficients(given: Coefficients, quantity: str) -> dict[int, sp.Expr]:
    """Return the coefficient of each power of y, exact and without zeros.

    Only a stiffness may be absent; None is then no polynomial.

    Raises
    ------
    DerivationInputError
        If ``given`` is not a polynomial in y or contains v, or its degree is above the limit.
    """
    if given is None and quantity == "stiffness":
        return {}
    if isinstance(given, str):
        found: dict[int, sp.Expr] = {}
        for monomial, value in read_polynomial(given, quantity).items():
            power = dict(monomial).get(VARIABLE, 0)
            found[power] = found.get(power, sp.Integer(0)) + _term(monomial, value)
    elif isinstance(given, sp.Expr):
        found = _from_expression(given, quantity)
    elif isinstance(given, Mapping):
        found = {_power(power, quantity): number(value, quantity) for power, value in given.items()}
    else:
        raise DerivationInputError(quantity, repr(given), "text, an expression or a table",
                                   "give for example '1 - a*y**2 + b*y**4'")  # fmt: skip
    found = {power: value for power, value in sorted(found.items()) if value != 0}
    if any(symbol.name == VELOCITY for value in found.values() for symbol in value.free_symbols):
        raise DerivationInputError(
            quantity, given, "a polynomial in y, and not in the velocity v",
            "use another letter if a constant is meant",
        )  # fmt: skip
    if max(found, default=0) > HIGHEST:
        raise DerivationInputError(quantity, f"degree {max(found)}", f"of degree {HIGHEST} at most",
                                   "use a lower degree")  # fmt: skip
    return found


def number(given: object, quantity: str) -> sp.Expr:
    """Return a coefficient: a finite real number, or a polynomial in letters other than y.

    Raises
    ------
    DerivationInputError
        If it is none of these.
    """
    refused = DerivationInputError(quantity, given, "a finite number or a letter",
                                   "give for example 0.3 or c")  # fmt: skip
    if isinstance(given, sp.Expr):
        allowed = given.is_polynomial() and not given.has(sp.I, sp.oo, sp.nan)
        if not allowed or any(symbol.name == VARIABLE for symbol in given.free_symbols):
            raise refused
        return _exact(given)
    if isinstance(given, str):
        terms = read_polynomial(given, quantity)
        if any(VARIABLE in dict(monomial) for monomial in terms):
            raise refused
        return sp.Add(*(_term(monomial, value) for monomial, value in terms.items()))
    if isinstance(given, bool) or not isinstance(given, (int, float, Fraction)):
        raise refused
    if isinstance(given, float) and not math.isfinite(given):
        raise refused
    return sp.Rational(str(given))


def values_of(
    given: Mapping[str, float | str], symbols: Sequence[sp.Symbol]
) -> dict[sp.Symbol, sp.Expr]:
    """Return exact numbers for letters.

    Raises
    ------
    DerivationInputError
        If a name is not one of the letters, or its value is not a number.
    """
    names = {symbol.name: symbol for symbol in symbols}
    put = {}
    for name, value in given.items():
        if name not in names:
            letters = ", ".join(names) or "(none)"
            raise DerivationInputError(
                "value", name, f"one of the letters {letters}", "leave it out"
            )
        exact = number(value, name)
        if not exact.is_Rational:
            raise DerivationInputError(name, value, "a number", "give for example 0.3")
        put[names[name]] = exact
    return put


def _term(monomial: Monomial, value: Fraction) -> sp.Expr:
    term: sp.Expr = sp.Rational(value.numerator, value.denominator)
    for name, power in monomial:
        if name != VARIABLE:
            term *= sp.Symbol(name, positive=True) ** power
    return term


def _power(given: object, quantity: str) -> int:
    if isinstance(given, bool) or not isinstance(given, int) or given < 0:
        raise DerivationInputError(quantity, given, "a table of whole powers of y",
                                   "use keys 0, 2, 4, ...")  # fmt: skip
    return given


def _exact(given: sp.Expr) -> sp.Expr:
    return sp.nsimplify(given, rational=True)


def _from_expression(given: sp.Expr, quantity: str) -> dict[int, sp.Expr]:
    names = [symbol for symbol in given.free_symbols if symbol.name == VARIABLE]
    variable = names[0] if names else sp.Symbol(VARIABLE)
    if len(names) > 1 or not given.is_polynomial() or given.has(sp.I, sp.oo, sp.nan):
        raise DerivationInputError(quantity, given, "a polynomial in y with real coefficients",
                                   "use powers, sums and products only")  # fmt: skip
    polynomial = sp.Poly(_exact(given), variable)
    return {int(powers[0]): value for powers, value in polynomial.terms()}


def chain_of(
    damping: Coefficients,
    stiffness: Coefficients = None,
    coupling: str | None = None,
    weights: str | None = None,
    values: Mapping[str, float | str] | None = None,
) -> ChainModel:
    """Return a chain from text; anything omitted is as in Eq. (8).

    Parameters
    ----------
    damping, stiffness : str, Expr, mapping or None
        h(y) and g(y). Letters other than y denote positive numbers.
    coupling : str or None
        A number or letter.
    weights : str or None
        Weights of the springs to the nearest, second … neighbours, separated by commas.
    values : mapping of str to number, or None
        Numbers for letters, exact for decimal numbers.

    Raises
    ------
    DerivationInputError
        If an input is not of this form, or the chain is not coupled.

    Examples
    --------
    >>> chain_of("1 - 2*y**2", weights="1, w").reach
    2
    """
    h = dict(PAPER.damping) if damping is None else coefficients(damping, "damping")
    g = coefficients(stiffness, "stiffness")
    if 0 in g:
        raise DerivationInputError("stiffness", stiffness, "without a constant term",
                                   "measure y from the equilibrium")  # fmt: skip
    spring = PAPER.coupling if coupling is None else number(coupling, "coupling")
    if spring == 0:
        raise DerivationInputError("coupling", coupling, "other than zero",
                                   "use 'cell --no-front' for an isolated cell")  # fmt: skip
    row = tuple(number(part.strip(), "weights") for part in (weights or "1").split(","))
    if len(row) > MAX_REACH or row[0] == 0 or row[-1] == 0:
        raise DerivationInputError("weights", weights, f"1 to {MAX_REACH} numbers or letters, the "
                                   "first and the last other than zero",
                                   "give for example '1, w'")  # fmt: skip
    model = ChainModel(damping=h, stiffness=g, coupling=spring, weights=row)
    return model.with_values(values_of(values or {}, model.parameters))
