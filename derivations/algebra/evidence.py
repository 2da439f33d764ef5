"""The kinds of evidence: values at random points, a predicted order, an exact list.

A check receives an equation and numbers from elsewhere (a direct average, a numerical
derivative, an integration). It never looks at how the equation was derived.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import mpmath
import numpy as np
import sympy as sp

from derivations.algebra.steps import Check, Evidence

Point = Mapping[sp.Basic, Any]
"""Values for symbols, functions or derivatives that occur in an equation."""

POINTS = 3
"""Random points a check: one finds a wrong coefficient almost surely; three for safety."""
TOLERANCE = 1e-9
"""Relative to the size of the terms: far above rounding, far below any wrong coefficient."""


def parts_of(equation: sp.Basic) -> tuple[sp.Basic, ...]:
    """Return the equations of a system, or the equation alone."""
    return tuple(equation.args) if isinstance(equation, sp.Tuple) else (equation,)


def value(expression: sp.Basic, point: Point, digits: int = 15) -> Any:
    """Return a number: the expression with everything in ``point`` put in.

    Raises
    ------
    ValueError
        If something is left without a value.
    """
    numbers = {atom: _number(given, digits) for atom, given in point.items()}
    result = sp.sympify(expression).xreplace(numbers).evalf(digits)
    if result.free_symbols or not result.is_number:
        raise ValueError(f"no value for {sorted(map(str, result.free_symbols))}")
    if not result.is_finite:
        raise ValueError("a value is not finite")
    return mpmath.mpmathify(result) if digits > 15 else complex(result)


def residual(part: sp.Basic, point: Point, digits: int = 15) -> tuple[Any, float]:
    """Left side minus right side, and the size of the terms, at a point."""
    if not isinstance(part, sp.Equality):
        raise TypeError("an expression, not an equation")
    left, right = part.args
    terms = [value(term, point, digits) for term in sp.Add.make_args(left)]
    terms += [-value(term, point, digits) for term in sp.Add.make_args(right)]
    return sum(terms), float(sum(abs(term) for term in terms))


def solved_for(candidate: sp.Basic, symbol: sp.Basic, point: Point, digits: int = 15) -> Any:
    """Return the value that an equation gives to a symbol in which it is affine.

    Raises
    ------
    ValueError
        If the equation does not determine the symbol.
    """
    if not isinstance(candidate, sp.Equality):
        raise TypeError("an expression, not an equation")
    left, right = candidate.args
    zero, one, two = (
        value(left, {**point, symbol: given}, digits)
        - value(right, {**point, symbol: given}, digits)
        for given in (0, 1, 2)
    )
    if one == zero or abs(two - 2 * one + zero) > 1e-9 * (abs(one) + abs(zero)):
        raise ValueError(f"it does not determine {symbol}")
    return -zero / (one - zero)


def vanishes_at(
    draw: Callable[[random.Random], Point],
    what: str,
    *,
    count: int = POINTS,
    tolerance: float = TOLERANCE,
    parts: int | None = None,
) -> Check:
    """Check that each part of the equation is satisfied at points found without it."""
    return equals(
        lambda rng: (draw(rng), None), what, count=count, tolerance=tolerance, parts=parts
    )


def equals(
    draw: Callable[[random.Random], tuple[Point, Sequence[complex] | None]],
    what: str,
    *,
    count: int = POINTS,
    tolerance: float = TOLERANCE,
    parts: int | None = None,
    floor: float = 0.0,
) -> Check:
    """Check that left minus right of each part equals a reference number at random points.

    Parameters
    ----------
    draw : callable
        From a random generator, a point and one reference a part (None for zeros).
    what : str
        What the reference is, for the statement.
    count : int
        Number of points.
    tolerance : float
        Allowed difference relative to the size of the terms.
    parts : int or None
        Number of parts the equation must have, where that is fixed.
    floor : float
        Least size of the terms, for an equation that says that something is zero.
    """

    def check(equation: sp.Basic) -> Evidence:
        rng = random.Random(20)
        pieces = parts_of(equation)
        if parts is not None and len(pieces) != parts:
            return Evidence(False, f"{len(pieces)} equations where {parts} are expected")
        worst = 0.0
        for _ in range(count):
            point, references = draw(rng)
            if references is not None and len(references) != len(pieces):
                return Evidence(False, f"{len(pieces)} equations, {len(references)} references")
            for place, piece in enumerate(pieces):
                found, scale = residual(piece, point)
                expected = 0 if references is None else references[place]
                size = max(scale + abs(expected), floor)
                worst = max(worst, abs(found - expected) / size if size else 0.0)
        verb = "agrees with" if worst <= tolerance else "differs from"
        return Evidence(
            worst <= tolerance,
            f"{verb} {what} at {count} random points (largest relative difference {worst:.1e})",
        )

    return check


def has_order(
    error: Callable[[sp.Basic, Any], Any],
    order: int,
    what: str,
    *,
    steps: tuple[float, float] = (1e-4, 1e-5),
    slack: float = 0.1,
) -> Check:
    """Check that an error falls like ``eps**order``, from two values of eps.

    The slope between the two differs from the order by O(eps) only; ``slack`` is far above that
    and far below one. Computed with 40 digits, so cancellation plays no part.
    """

    def check(equation: sp.Basic) -> Evidence:
        with mpmath.workdps(40):
            large, small = (abs(error(equation, mpmath.mpf(step))) for step in steps)
            if small == 0 or large == 0:
                return Evidence(False, f"{what}: the error is exactly zero, so nothing was tested")
            slope = float(mpmath.log(large / small) / mpmath.log(mpmath.mpf(steps[0]) / steps[1]))
        return Evidence(
            abs(slope - order) < slack, f"{what}: slope {slope:.3f} in eps, predicted {order}"
        )

    return check


def all_of(*checks: Check) -> Check:
    """Check several things; the first failure speaks."""

    def check(equation: sp.Basic) -> Evidence:
        found = []
        for each in checks:
            evidence = each(equation)
            if not evidence.holds:
                return evidence
            found.append(evidence.statement)
        return Evidence(True, "; ".join(found))

    return check


def predicate(test: Callable[[sp.Basic], bool], what: str) -> Check:
    """Check a property that is true or false."""

    def check(equation: sp.Basic) -> Evidence:
        holds = bool(test(equation))
        return Evidence(holds, what if holds else f"not true: {what}")

    return check


def fast_average(function: Callable[[Any], Any], harmonic: int = 0, samples: int = 64) -> complex:
    """Return the mean of ``function(t) e^{-i harmonic t}`` over a period 2 pi, by equal samples.

    Exact to rounding for trigonometric polynomials of degree below ``samples``.
    """
    t = 2 * np.pi * np.arange(samples) / samples
    return complex(np.mean(function(t) * np.exp(-1j * harmonic * t)))


def _number(given: Any, digits: int) -> sp.Expr:
    if isinstance(given, sp.Basic):
        return given
    if isinstance(given, (mpmath.mpf, mpmath.mpc)):
        return sp.Float(given.real, digits) + sp.I * sp.Float(given.imag, digits)
    number = complex(given)
    real = sp.Float(number.real, digits)
    return real + sp.I * sp.Float(number.imag, digits) if number.imag else real
