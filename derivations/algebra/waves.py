"""Operations on travelling waves of a lattice: step functions and the moving frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import sympy as sp
from sympy.core.function import AppliedUndef

from derivations.algebra.equations import equation, on_sides, parts_of
from derivations.algebra.operations import Operation, OperationError, listed, spoken

HALF = sp.Rational(1, 2)


@dataclass(frozen=True)
class WriteWithStep(Operation):
    """Write the right side, of two branches in one quantity, with a step function.

    Attributes
    ----------
    name : Symbol
        What the right side is called.
    """

    name: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = below + (above - below) theta(quantity - threshold)``."""
        (source,) = sources
        (pieces,) = source.rhs.atoms(sp.Piecewise)
        (low, below), (high, above) = pieces.args
        if not (isinstance(below, sp.Lt) and isinstance(above, sp.Gt)) or below.args != above.args:
            raise OperationError("the two branches do not meet at one threshold")
        stepped = low + sp.expand(high - low) * sp.Heaviside(below.lhs - below.rhs, HALF)
        return equation(self.name, sp.expand(source.rhs.xreplace({pieces: stepped})))

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"write the right side of {listed(labels)} with a step function"


@dataclass(frozen=True)
class InsertRightSide(Operation):
    """Give the first equation the right side of the second."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``left of the first = right of the second``."""
        first, second = sources
        return equation(first.lhs, second.rhs)

    def words(self, labels: Sequence[str]) -> str:
        """Name the two."""
        return f"put {labels[1]} on the right of {labels[0]}"


@dataclass(frozen=True)
class EquateRightSides(Operation):
    """Equate the right sides of two equations with the same left side."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``right of the first = right of the second``."""
        first, second = sources
        if first.lhs != second.lhs:
            raise OperationError(f"{first.lhs} is not {second.lhs}")
        return equation(first.rhs, second.rhs)

    def words(self, labels: Sequence[str]) -> str:
        """Name the two."""
        return f"equate {listed(labels)}"


@dataclass(frozen=True)
class EvaluateBranch(Operation):
    """Take the branch of a profile on one side of a point, at that point.

    Attributes
    ----------
    coordinate : Symbol
        What goes to the point.
    point : Expr
        The point.
    side : int
        1 for the branch above it, -1 for the one below.
    """

    coordinate: sp.Symbol
    point: sp.Expr | int = 0
    side: int = 1

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``profile(point) = value of the branch``."""
        (source,) = sources
        near = sp.sympify(self.point) + self.side
        for value, condition in source.rhs.args:
            if condition.subs(self.coordinate, near) == sp.true:
                moved = value.subs(self.coordinate, self.point)
                return equation(source.lhs.subs(self.coordinate, self.point), moved)
        raise OperationError(f"no branch beside {self.point}")

    def words(self, labels: Sequence[str]) -> str:
        """Name the side."""
        side = "⁺" if self.side > 0 else "⁻"
        return f"evaluate {listed(labels)} at {spoken(self.coordinate)} = {self.point}{side}"


@dataclass(frozen=True)
class LocateSteps(Operation):
    """Use an equivalence of two inequalities to say where a step function switches."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the first source with ``theta(p - q)`` as a step in the place."""
        target, condition = sources
        relations = {isinstance(part, sp.Gt): part for part in condition.args}
        over, place = relations[True], relations[False]
        if not isinstance(place, sp.Lt):
            raise OperationError(f"{condition} does not say where the threshold is passed")
        switch = sp.Heaviside(over.lhs - over.rhs, HALF)
        found = on_sides(
            target, lambda side: side.xreplace({switch: sp.Heaviside(place.rhs - place.lhs, HALF)})
        )
        if not found.has(sp.Heaviside) or found == target:
            raise OperationError(f"{target} has no step at that threshold")
        return found

    def words(self, labels: Sequence[str]) -> str:
        """Name the two."""
        return f"let the step in {labels[0]} be where {listed(labels[1:])} says"


@dataclass(frozen=True)
class EnterMovingFrame(Operation):
    """Put a travelling wave into a lattice equation.

    The second source has a part ``field(n, t) = profile(n - v t)``, read for every n, and a part
    ``profile(n - v t) = profile(zeta)``.

    Attributes
    ----------
    site, time, coordinate : Symbol
        n, t and zeta.
    """

    site: sp.Symbol
    time: sp.Symbol
    coordinate: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equation of the profile; derivatives follow by the chain rule."""
        target, wave = sources
        parts = parts_of(wave)
        (moving,) = (q for q in parts if q.lhs.args == (self.site, self.time))
        (named,) = (q for q in parts if q.rhs.args == (self.coordinate,) and q.lhs == moving.rhs)
        (there,) = sp.solve(sp.Eq(named.lhs.args[0], self.coordinate), self.site)
        field, profile = moving.lhs.func, moving.rhs.func

        def put(place: sp.Expr, *when: sp.Expr) -> sp.Expr:
            return moving.rhs.subs(self.site, place) if when else field(place)  # a profile stays

        def moved(side: sp.Expr) -> sp.Expr:
            found = side.replace(field, put).doit().subs(self.site, there).doit()
            return found.replace(
                lambda q: isinstance(q, AppliedUndef) and q.func == profile,
                lambda q: q.func(sp.expand(q.args[0])),
            ).doit()

        result = on_sides(target, moved)
        if result.has(self.time) or result.has(self.site):
            raise OperationError(f"{self.site} or {self.time} is left: not a travelling wave")
        return result

    def words(self, labels: Sequence[str]) -> str:
        """Name the wave."""
        return f"put the travelling wave {listed(labels[1:])} into {labels[0]}"


@dataclass(frozen=True)
class TakeModulus(Operation):
    """Take absolute values on both sides."""

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``|left| = |right|``."""
        (source,) = sources
        return equation(sp.Abs(source.lhs), sp.Abs(source.rhs))

    def words(self, labels: Sequence[str]) -> str:
        """Name the source."""
        return f"take absolute values of {listed(labels)}"
