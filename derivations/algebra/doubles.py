"""The value of an expression in double precision, with a bound on its rounding error.

SymPy's ``evalf`` takes a hundred times as long. It is still used for an expression that contains
anything other than sums, products, powers and the functions below, or that loses digits by
cancellation.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping

import sympy as sp

EPS = 2.0**-52
LOST = 1e-11
"""Relative rounding error above which no value is returned."""

Number = tuple[complex, float]
"""A value and a bound on its error."""


def in_doubles(expression: sp.Basic, point: Mapping[sp.Basic, complex]) -> complex | None:
    """Return the value of an expression at a point, or None if it must be left to ``evalf``.

    Examples
    --------
    >>> x = sp.Symbol("x")
    >>> round(in_doubles(sp.sqrt(1 + x**2) * sp.exp(x), {x: 0.75}).real, 9)
    2.646250021
    >>> in_doubles(1 - sp.cos(x), {x: 1e-7}) is None  # half of the digits cancel
    True
    """
    try:
        value, error = _number(expression, point)
    except (TypeError, ArithmeticError, ValueError, LookupError):
        return None
    return value if cmath.isfinite(value) and error <= LOST * abs(value) else None


def _number(expression: sp.Basic, point: Mapping[sp.Basic, complex]) -> Number:
    if expression in point:
        given = point[expression]
        value = complex(given)
        return value, 0.0 if isinstance(given, float | complex) else EPS * abs(value)
    if expression is sp.I:
        return 1j, 0.0
    if not expression.args:  # a number; a symbol without a value raises TypeError
        exact = isinstance(expression, sp.Rational)  # the usual case, slow to convert in SymPy
        value = complex(int(expression.p) / int(expression.q) if exact else expression)
        return value, EPS * abs(value)
    combine = _COMBINED[expression.func]
    return combine([_number(part, point) for part in expression.args])


def _sum(terms: list[Number]) -> Number:
    value = sum(term for term, _ in terms)
    size = sum(abs(term) for term, _ in terms)
    return value, sum(error for _, error in terms) + len(terms) * EPS * size


def _product(factors: list[Number]) -> Number:
    value, error = factors[0]
    for factor, bound in factors[1:]:
        error = abs(value) * bound + (abs(factor) + bound) * error + 3 * EPS * abs(value * factor)
        value *= factor
    return value, error


def _power(parts: list[Number]) -> Number:
    (base, bound), (exponent, exponent_bound) = parts
    if (
        exponent_bound <= EPS * abs(exponent)
        and exponent.imag == 0.0
        and exponent.real.is_integer()
    ):
        value, exponent_bound = base ** int(exponent.real), 0.0
        # Python multiplies up to a hundred factors, and uses the polar form for more.
        logarithm = abs(cmath.log(base)) if abs(exponent) > 100.0 else 0.0
    else:
        base = _beside_the_cut(base, bound)
        value, logarithm = base**exponent, abs(cmath.log(base))
    if bound > 1e-6 * abs(base):
        raise ArithmeticError
    size = abs(exponent)
    relative = (size + 1) * bound / abs(base) if bound else 0.0
    relative += logarithm * exponent_bound + EPS * (4 + 3 * size * (1 + logarithm))
    return value, abs(value) * relative


def _beside_the_cut(value: complex, error: float) -> complex:
    """Return a value with a positive zero imaginary part, as on the principal branch."""
    if value.real <= 0.0 and abs(value.imag) <= error and (value.imag or error > LOST * abs(value)):
        raise ArithmeticError
    return complex(value.real, value.imag + 0.0)


def _smooth(
    function: Callable[[complex], complex], slope: Callable[[complex], float]
) -> Callable[[list[Number]], Number]:
    """Return a function of one number whose slope is at most ``slope`` nearby."""

    def combine(parts: list[Number]) -> Number:
        ((inner, bound),) = parts
        if bound > 1e-6:
            raise ArithmeticError
        slope_bound = slope(inner)
        return function(inner), 2 * slope_bound * bound + 4 * EPS * slope_bound

    return combine


def _step(parts: list[Number]) -> Number:
    """Return the step function, 0 or 1, of a real number other than zero."""
    inner, bound = parts[0]
    if inner.imag != 0.0 or abs(inner) <= bound:
        raise ArithmeticError
    return complex(inner.real > 0.0), 0.0


_COMBINED: Mapping[type, Callable[[list[Number]], Number]] = {
    sp.Add: _sum,
    sp.Mul: _product,
    sp.Pow: _power,
    sp.exp: _smooth(cmath.exp, lambda inner: abs(cmath.exp(inner))),
    sp.sin: _smooth(cmath.sin, lambda inner: math.cosh(inner.imag)),
    sp.cos: _smooth(cmath.cos, lambda inner: math.cosh(inner.imag)),
    sp.sinh: _smooth(cmath.sinh, lambda inner: math.cosh(inner.real)),
    sp.cosh: _smooth(cmath.cosh, lambda inner: math.cosh(inner.real)),
    sp.Heaviside: _step,
    sp.Abs: lambda parts: (complex(abs(parts[0][0])), parts[0][1] + EPS * abs(parts[0][0])),
    sp.conjugate: lambda parts: (parts[0][0].conjugate(), parts[0][1]),
}
"""How the numbers of the parts are combined."""
