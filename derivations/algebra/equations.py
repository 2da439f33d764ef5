"""Equations as objects: an ``Eq`` that stays an equation, a ``Tuple`` of them for a system."""

from __future__ import annotations

import random
from collections.abc import Callable

import sympy as sp
from sympy.core.function import AppliedUndef


def equation(left: sp.Expr | int, right: sp.Expr | int = 0) -> sp.Eq:
    """Return ``left = right``, never collapsed to true or false."""
    return sp.Eq(sp.sympify(left), sp.sympify(right), evaluate=False)


def parts_of(whole: sp.Basic) -> tuple[sp.Basic, ...]:
    """Return the equations of a system, or the equation alone."""
    return tuple(whole.args) if isinstance(whole, sp.Tuple) else (whole,)


def system(parts: tuple[sp.Basic, ...]) -> sp.Basic:
    """Return a single equation as it is, several as a ``Tuple``: the inverse of `parts_of`."""
    return parts[0] if len(parts) == 1 else sp.Tuple(*parts)


def left_minus_right(part: sp.Basic) -> sp.Expr:
    """Return the left side minus the right side, or the expression if there is no equation.

    Raises
    ------
    TypeError
        If ``part`` is a system or an inequality.
    """
    if isinstance(part, sp.Equality):
        return part.lhs - part.rhs
    if not isinstance(part, sp.Expr):
        raise TypeError(f"one equation or expression is needed, not {part}")
    return part


def on_sides(whole: sp.Basic, change: Callable[[sp.Expr], sp.Expr]) -> sp.Basic:
    """Return the system with ``change`` applied to both sides of each of its parts."""
    changed = []
    for part in parts_of(whole):
        if isinstance(part, sp.core.relational.Relational):
            changed.append(part.func(change(part.lhs), change(part.rhs), evaluate=False))
        else:
            changed.append(change(part))
    return system(tuple(changed))


def is_zero(expression: sp.Expr) -> bool:
    """Whether an expression simplifies to zero under the assumptions of its symbols."""
    plain = without_modulus(sp.sympify(expression))
    differs = _differs_from_zero(plain)
    if differs:
        return False
    expanded = sp.expand(plain)
    if differs is None:  # conditions between complex numbers cannot be simplified
        return bool(expanded == 0)
    if expanded == 0:
        return True
    combined = sp.cancel(sp.together(sp.powsimp(sp.expand(expanded.rewrite(sp.exp)))))
    if sp.expand(combined) == 0:
        return True
    return bool(sp.simplify(combined) == 0)


def _differs_from_zero(expression: sp.Expr) -> bool | None:
    """Whether the value at a point shows that the expression is not zero; False proves nothing.

    None if it has no value there because it depends on an order of complex numbers.
    """
    rng = random.Random(7)
    plain = expression.xreplace({
        atom: sp.Dummy(real=atom.is_real)
        for atom in sorted(expression.atoms(sp.Derivative), key=sp.default_sort_key)
    })  # fmt: skip
    plain = plain.xreplace({
        atom: sp.Dummy(real=atom.is_real)
        for atom in sorted(plain.atoms(AppliedUndef), key=sp.default_sort_key)
    })  # fmt: skip
    point = {}
    for symbol in sorted(plain.free_symbols, key=sp.default_sort_key):
        real = sp.Float(rng.uniform(0.3, 1.2), 30)
        if symbol.is_integer:
            real = sp.Integer(rng.randrange(1, 4))
        imaginary = sp.I * sp.Float(rng.uniform(-0.8, 0.8), 30)
        point[symbol] = real if symbol.is_real else real + imaginary
    try:
        found = plain.xreplace(point).evalf(30)
        if not found.is_number or not found.is_finite:
            return False
        size = max((abs(complex(q.xreplace(point).evalf(30))) for q in sp.Add.make_args(plain)),
                   default=0.0)  # fmt: skip
    except (TypeError, ValueError):
        return None
    return bool(abs(complex(found)) > 1e-12 * (size + 1e-30))


def without_modulus(expression: sp.Expr) -> sp.Expr:
    """Return the expression with even powers of a modulus written ``z z*``."""
    found = {}
    for power in expression.atoms(sp.Pow, sp.Abs):
        base, exponent = power.as_base_exp()
        if isinstance(base, sp.Abs) and exponent.is_Integer and exponent % 2 == 0:
            inner = base.args[0]
            found[power] = (inner * sp.conjugate(inner)) ** (exponent // 2)
    return expression.xreplace(found)


def same(one: sp.Basic, other: sp.Basic) -> bool:
    """Whether two equations or systems are the same: left minus right agrees, part by part.

    An equation is not the same as a multiple of it; matrices are compared entry by entry, and an
    inequality must also have the same sign.
    """
    ours, theirs = parts_of(one), parts_of(other)
    return len(ours) == len(theirs) and all(map(_same_part, ours, theirs))


def _same_part(one: sp.Basic, other: sp.Basic) -> bool:
    if one == other:
        return True
    if isinstance(one, sp.core.relational.Relational):
        if one.func != other.func:
            return False
        if getattr(one.rhs, "shape", None) != getattr(other.rhs, "shape", None):
            return False
        left, right = one.lhs - other.lhs, one.rhs - other.rhs
        if isinstance(one.rhs, sp.MatrixBase):
            return _vanishes(left) and _vanishes(right)
        return is_zero(left - right)
    if isinstance(one, sp.Expr) and isinstance(other, sp.Expr):
        return is_zero(one - other)
    return False


def _vanishes(difference: sp.Basic) -> bool:
    entries = difference if isinstance(difference, sp.MatrixBase) else [difference]
    return all(is_zero(entry) for entry in entries)
