"""Limit cycles of an averaged cell: all of them, their stability, and the ratio of two."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache

import sympy as sp

from derivations.algebra.errors import DerivationInputError
from derivations.averaging.symbols import square


@dataclass(frozen=True, kw_only=True)
class LimitCycle:
    """A cycle of the averaged cell.

    Attributes
    ----------
    amplitude : Expr
        Amplitude of y (dimensionless).
    exponent : Expr
        Growth rate of a small change of the amplitude, a unit of ``eps t``.
    stability : str or None
        ``stable``, ``unstable`` or ``half-stable``; None where it hangs on symbols.
    multiplicity : int
        Of the root; above 1 the cycle sits on a fold.
    """

    amplitude: sp.Expr
    exponent: sp.Expr
    stability: str | None
    multiplicity: int = 1


@lru_cache(maxsize=32)
def limit_cycles(damping_mean: sp.Expr) -> tuple[LimitCycle, ...]:
    """Return all limit cycles, inner to outer, with their stability.

    Parameters
    ----------
    damping_mean : Expr
        H(s) of ``r' = -(r/2) H(r^2)``.

    Raises
    ------
    DerivationInputError
        If the coefficients are symbols and the roots have no closed form.
    """
    if damping_mean.free_symbols - {square}:
        return _symbolic_cycles(damping_mean)
    polynomial = sp.Poly(damping_mean, square)
    roots = [(root, int(times)) for root, times in polynomial.real_roots(multiple=False)
             if root.is_positive]  # fmt: skip
    found = []
    for place, (root, times) in enumerate(roots):
        low = roots[place - 1][0] if place else sp.Integer(0)
        high = roots[place + 1][0] if place + 1 < len(roots) else 2 * root + 1
        before, after = (_sign_between(polynomial, *ends) for ends in ((low, root), (root, high)))
        kind = {(-1, 1): "stable", (1, -1): "unstable"}.get((before, after), "half-stable")
        found.append(LimitCycle(amplitude=sp.sqrt(root), exponent=_exponent(damping_mean, root),
                                stability=kind, multiplicity=times))  # fmt: skip
    return tuple(found)


def _symbolic_cycles(damping_mean: sp.Expr) -> tuple[LimitCycle, ...]:
    polynomial = sp.Poly(damping_mean, square)
    if polynomial.degree() > 2:
        raise DerivationInputError(
            "averaged damping", damping_mean, "of degree at most 2 in s with letters in it",
            "give numbers for the letters, as in --value a=4",
        )  # fmt: skip
    if polynomial.degree() == 2:
        top, middle, low = polynomial.all_coeffs()
        # Positive top coefficient: the minus sign belongs to the inner cycle.
        spread = sp.sqrt(sp.factor(middle**2 - 4 * top * low))
        roots = [(-middle + sign * spread) / (2 * top) for sign in (-1, 1)]
    else:
        roots = list(sp.roots(polynomial))
    return tuple(
        LimitCycle(amplitude=sp.sqrt(root), stability=None,
                   exponent=sp.simplify(_exponent(damping_mean, root)))
        for root in map(sp.simplify, roots)
        if not root.is_nonpositive
    )  # fmt: skip


def _exponent(damping_mean: sp.Expr, root: sp.Expr) -> sp.Expr:
    return -root * sp.diff(damping_mean, square).subs(square, root)


def ratio_of_cycles(
    damping_mean: sp.Expr, cycles: tuple[LimitCycle, ...], damping: Mapping[int, sp.Expr]
) -> sp.Expr:
    """Return |phi_us| / |phi_s| of a cell with exactly two cycles, the inner one unstable.

    Parameters
    ----------
    damping_mean : Expr
        H(s).
    cycles : tuple of LimitCycle
        Its zeros.
    damping : mapping of int to Expr
        h(y), for the message.

    Raises
    ------
    DerivationInputError
        If the cell is not of that kind.
    """
    if len(cycles) != 2:
        raise _not_bistable(
            damping, f"this one has {len(cycles)} limit cycle{'s' * (len(cycles) != 1)}"
        )
    if any(cycle.stability is None for cycle in cycles):
        top, middle, low = sp.Poly(damping_mean, square).all_coeffs()
        if not (top.is_positive and middle.is_negative and low.is_positive):
            raise _not_bistable(damping, "the signs of its terms do not allow two cycles")
        spread = sp.sqrt(sp.factor(1 - 4 * top * low / middle**2))
        return sp.sqrt((1 - spread) / (1 + spread))
    stable = [cycle.stability for cycle in cycles] == ["unstable", "stable"]
    if not damping_mean.subs(square, 0) > 0 or not stable:
        raise _not_bistable(damping, "its rest state or its outer cycle is not stable")
    return sp.simplify(cycles[0].amplitude / cycles[1].amplitude)


def _not_bistable(damping: Mapping[int, sp.Expr], why: str) -> DerivationInputError:
    return DerivationInputError(
        "damping", shown(damping), "that of a cell with exactly two cycles around a stable rest "
        "state", f"{why}, so the simplified model of the front does not apply",
    )  # fmt: skip


def _sign_between(polynomial: sp.Poly, low: sp.Expr, high: sp.Expr) -> int:
    """Return the sign of the polynomial between two neighbouring roots."""
    digits = 30
    while True:
        middle = sp.Rational(str(((low + high) / 2).evalf(digits)))
        if low < middle < high:
            return int(sp.sign(polynomial.eval(middle)))
        digits *= 2


def shown(powers: Mapping[int, sp.Expr]) -> str:
    """Return a polynomial in y, given by the coefficient of each power, as text."""
    y = sp.Symbol("y")
    return str(sum((value * y**power for power, value in powers.items()), sp.Integer(0)))
