"""Kinds of evidence: an equation evaluated at points, with reference values for left minus right.

A check receives an equation, and numbers from another source (a direct average, a numerical
derivative, an integration). It never uses the derivation of the equation.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import wraps
from typing import Any

import mpmath
import numpy as np
import sympy as sp

from derivations.algebra.doubles import in_doubles
from derivations.algebra.equations import parts_of
from derivations.algebra.steps import Evidence

Point = Mapping[sp.Basic, Any]
"""Values of the symbols, functions or derivatives that occur in an equation."""
Drawn = Point | tuple[Point, Sequence[complex] | None]
Points = Iterator[tuple[Point, Sequence[complex] | None]]
"""Points, each with one reference number per part, or None if the equation must hold."""

POINTS = 3
"""Random points per check: one detects a wrong coefficient almost surely; three for safety."""
TOLERANCE = 1e-9
"""Tolerance relative to the size of the terms: far above rounding, far below any wrong
coefficient."""
_GUARD = 25
"""Further digits with which numbers are inserted, since terms may cancel."""
_DOUBLE = 15
"""Digits of double precision."""


def value(expression: sp.Basic, point: Point) -> Any:
    """Return the value of an expression with everything in ``point`` inserted.

    Raises
    ------
    ValueError
        If something remains without a value.
    """
    return _evaluated(expression, point, _DOUBLE)


def _evaluated(expression: sp.Basic, point: Point, digits: int) -> Any:
    expression = sp.sympify(expression)
    in_double_precision = in_doubles(expression, point) if digits <= _DOUBLE else None
    if in_double_precision is not None:
        return in_double_precision
    numbers = {atom: _number(given, digits + _GUARD) for atom, given in point.items()}
    result = expression.xreplace(numbers).evalf(digits)
    if result.free_symbols or not result.is_number:
        raise ValueError(f"no value for {sorted(map(str, result.free_symbols))}")
    if not result.is_finite:
        raise ValueError("a value is not finite")
    return mpmath.mpmathify(result) if digits > _DOUBLE else complex(result)


def residual(part: sp.Basic, point: Point, digits: int = _DOUBLE) -> tuple[Any, float]:
    """Return left side minus right side, and the size of the terms, at a point."""
    if not isinstance(part, sp.Equality):
        raise TypeError("an expression, not an equation")
    left, right = part.args
    terms = [_evaluated(term, point, digits) for term in sp.Add.make_args(left)]
    terms += [-_evaluated(term, point, digits) for term in sp.Add.make_args(right)]
    return sum(terms), float(sum(abs(term) for term in terms))


def solved_for(candidate: sp.Basic, symbol: sp.Basic, point: Point, unit: float = 1.0) -> Any:
    """Return the value that an equation gives to a symbol in which it is affine.

    Parameters
    ----------
    candidate : Basic
        The equation.
    symbol : Basic
        The symbol.
    point : mapping
        Values of everything else.
    unit : float
        The order of magnitude of the value: the equation is evaluated at 0, 1 and 2 of these units.

    Raises
    ------
    ValueError
        If the equation does not determine the symbol.
    """
    if not isinstance(candidate, sp.Equality):
        raise TypeError("an expression, not an equation")
    left, right = candidate.args
    zero, one, two = (
        value(left, {**point, symbol: given}) - value(right, {**point, symbol: given})
        for given in (0.0, unit, 2 * unit)
    )
    if one == zero or abs(two - 2 * one + zero) > 1e-9 * (abs(one) + abs(zero)):
        raise ValueError(f"it does not determine {symbol}")
    return -zero / (one - zero) * unit


def equals(
    what: str, *, count: int = POINTS, tolerance: float = TOLERANCE, parts: int | None = None,
    floor: float = 0.0,
) -> Callable[[Callable[..., Drawn]], Callable[..., Evidence]]:  # fmt: skip
    """Make a check from a random draw: left minus right of each part equals a reference number.

    Parameters
    ----------
    what : str
        Description of the reference, for the statement.
    count : int
        Number of points drawn.
    tolerance : float
        Allowed difference relative to the size of the terms.
    parts : int or None
        Number of parts that the equation must have, if this is fixed.
    floor : float
        Smallest size of the terms, for an equation stating that something is zero.

    Returns
    -------
    callable
        Decorates a function or method of a random generator that returns a point and one reference
        per part, or only a point at which the equation holds.
    """

    def made(draw: Callable[..., Drawn]) -> Callable[..., Evidence]:
        @wraps(draw)
        def points(*owner: Any) -> Points:
            rng = random.Random(20)
            for _ in range(count):
                drawn = draw(*owner, rng)
                yield (drawn, None) if isinstance(drawn, Mapping) else drawn

        return at_points(what, tolerance=tolerance, parts=parts, floor=floor)(points)

    return made


def at_points(
    what: str, *, tolerance: float = TOLERANCE, parts: int | None = None, floor: float = 0.0
) -> Callable[[Callable[..., Points]], Callable[..., Evidence]]:
    """Make a check from a generator of points and references, as `equals` does from a draw."""

    def made(points: Callable[..., Points]) -> Callable[..., Evidence]:
        @wraps(points)
        def check(*arguments: Any) -> Evidence:
            *owner, candidate = arguments
            pieces, worst, count = parts_of(candidate), 0.0, 0
            if not pieces:
                return Evidence(False, "not an equation: it has no content")
            if parts is not None and len(pieces) != parts:
                return Evidence(False, f"{len(pieces)} equations where {parts} are expected")
            for count, (point, references) in enumerate(points(*owner), start=1):
                expected = (0,) * len(pieces) if references is None else references
                if len(expected) != len(pieces):
                    return Evidence(False, f"{len(pieces)} equations where {len(expected)} are due")
                for piece, reference in zip(pieces, expected, strict=True):
                    found, scale = residual(piece, point)
                    size = max(scale + abs(reference), floor)
                    worst = max(worst, abs(found - reference) / size if size else 0.0)
                    if count == 1 and reference == 0 and holds_anywhere(piece, point):
                        return Evidence(
                            False, "it holds for other numbers as well, so it has no content"
                        )
            verb = "agrees with" if worst <= tolerance else "differs from"
            return Evidence(
                worst <= tolerance,
                f"{verb} {what} at {count} point{'s' * (count != 1)} "
                f"(largest relative difference {worst:.1e})",
            )

        return check

    return made


def holds_anywhere(piece: sp.Basic, point: Point) -> bool:
    """Whether an equation also holds with all values changed, which makes its check void."""
    rng = random.Random(3)
    perturbed = {atom: given + rng.uniform(0.05, 0.15) * (1 + abs(given))
             for atom, given in point.items()}  # fmt: skip
    found, scale = residual(piece, perturbed)
    return bool(abs(found) <= TOLERANCE * scale)


def fast_average(function: Callable[[Any], Any], harmonic: int = 0, samples: int = 64) -> complex:
    """Return the mean of ``function(t) e^{-i harmonic t}`` over a period 2 pi, by equal samples.

    Exact to rounding for trigonometric polynomials of degree below ``samples``.
    """
    t = 2 * np.pi * np.arange(samples) / samples
    return complex(np.mean(function(t) * np.exp(-1j * harmonic * t)))


def slope_of(function: Callable[[Any], Any], at: Any = 0.0, step: float = 1e-3) -> Any:
    """Return the derivative of a function by central differences of fourth order."""
    outer, inner = (function(at + h) - function(at - h) for h in (2 * step, step))
    return (8 * inner - outer) / (12 * step)


def _number(given: Any, digits: int) -> sp.Expr:
    if isinstance(given, sp.Basic):
        return given
    if isinstance(given, (mpmath.mpf, mpmath.mpc)):
        return sp.Float(given.real, digits) + sp.I * sp.Float(given.imag, digits)
    number = complex(given)
    real = sp.Float(number.real, digits)
    return real + sp.I * sp.Float(number.imag, digits) if number.imag else real
