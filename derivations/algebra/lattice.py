"""Operations on a lattice: close a finite chain, write it to first order, insert a plane wave."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from typing import ClassVar

import sympy as sp
from sympy.core.function import AppliedUndef

from derivations.algebra.equations import equation, left_minus_right, parts_of
from derivations.algebra.operations import Operation, OperationError, inline, listed
from derivations.algebra.rearrangement import with_cosines


class LatticeEnds(Enum):
    """How the two ends of a chain of N sites are closed; the value describes it in words."""

    RING = "a ring: site 1 and site N are neighbours"
    FREE = "free ends: a spring without a site at its other end carries no force"


@dataclass(frozen=True)
class CloseChain(Operation):
    """Write the equation of site n for each site of a finite chain.

    Attributes
    ----------
    field : function class
        The displacement, called as ``field(site, time)``.
    index, time : Symbol
        The site and the time in the equation.
    sites : int
        N.
    ends : LatticeEnds
        What lies beyond the ends.
    """

    field: sp.FunctionClass
    index: sp.Symbol
    time: sp.Symbol
    sites: int
    ends: LatticeEnds

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the equations of sites 1 to N."""
        (source,) = sources
        whole = left_minus_right(source)
        return sp.Tuple(*(equation(self._at(whole, site)) for site in range(1, self.sites + 1)))

    def _at(self, whole: sp.Expr, site: int) -> sp.Expr:
        def neighbour(argument: sp.Expr, time: sp.Expr) -> sp.Expr:
            neighbour = int(argument.subs(self.index, site))
            if self.ends is LatticeEnds.RING:
                return self.field((neighbour - 1) % self.sites + 1, time)
            return self.field(neighbour if 1 <= neighbour <= self.sites else site, time)

        return whole.replace(self.field, neighbour).doit()

    def words(self, labels: Sequence[str]) -> str:
        """Name the number of sites and the ends."""
        return (
            f"write {listed(labels)} for sites 1 to N = {self.sites}, closed to {self.ends.value}"
        )


@dataclass(frozen=True)
class WriteFirstOrder(Operation):
    """Write second-order equations as a first-order system for a state vector.

    The first source contains the equations, the second the state, ``X = (displacements,
    velocities)``.

    Attributes
    ----------
    rate : Symbol
        The left side, ``dX/dt``.
    components : tuple of Symbol
        The names of the entries of X.
    time : Symbol
        The time.
    """

    phrase: ClassVar[str] = "write {first} as a first-order system for the state {others}"
    rate: sp.Symbol
    components: tuple[sp.Symbol, ...]
    time: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``dX/dt = f(X)`` in the components."""
        chain, state = sources
        names = dict(zip(state.rhs, self.components, strict=True))
        accelerations = {}
        for part in parts_of(chain):
            whole = sp.expand(left_minus_right(part))
            (acceleration,) = (q for q in whole.atoms(sp.Derivative) if q.derivative_count == 2)
            factor = whole.coeff(acceleration)
            accelerations[acceleration] = -(whole - factor * acceleration) / factor
        rows = [sp.diff(entry, self.time).subs(accelerations) for entry in state.rhs]
        rows = [row.xreplace(names) for row in rows]
        if any(row.has(self.time) for row in rows):
            raise OperationError("the state does not determine its own rate")
        return equation(self.rate, sp.ImmutableMatrix([sp.expand(row) for row in rows]))


@dataclass(frozen=True)
class ReadMatrix(Operation):
    """Extract the matrix of a linear system.

    Attributes
    ----------
    unknowns : tuple of Symbol
        The vector that the matrix multiplies.
    name : Symbol
        Name of the matrix.
    """

    phrase: ClassVar[str] = "read the matrix {name} off {sources}"
    unknowns: tuple[sp.Symbol, ...]
    name: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return ``name = matrix``."""
        (source,) = sources
        entries = [
            [sp.expand(row).coeff(unknown) for unknown in self.unknowns] for row in source.rhs
        ]
        matrix = sp.ImmutableMatrix(entries)
        remainder = sp.ImmutableMatrix(source.rhs) - matrix * sp.ImmutableMatrix(self.unknowns)
        if not remainder.expand().is_zero_matrix:
            raise OperationError("the system is not linear and homogeneous")
        return equation(self.name, matrix)


@dataclass(frozen=True)
class InsertPlaneWave(Operation):
    """Insert ``e^{rate time + i wavenumber n}`` into a linear lattice equation and divide by it.

    Attributes
    ----------
    field : function class
        The field, with arguments site and time.
    rate : Expr
        Factor of the time in the exponent.
    wavenumber : Symbol
        Factor of the site in the exponent.
    """

    field: sp.FunctionClass
    rate: sp.Expr
    wavenumber: sp.Symbol

    def __call__(self, *sources: sp.Basic) -> sp.Basic:
        """Return the characteristic equation, in cosines of the wavenumber."""
        (source,) = sources
        whole = left_minus_right(source)
        site_field = next(iter(sorted(whole.atoms(AppliedUndef), key=str)))
        site, time = (next(iter(site_field.args[position].free_symbols)) for position in (0, 1))

        def wave(position: sp.Expr, when: sp.Expr) -> sp.Expr:
            return sp.exp(self.rate * when + sp.I * self.wavenumber * position)

        found = whole.replace(self.field, wave).doit() / wave(site, time)
        found = sp.powsimp(sp.expand(found), combine="exp")
        return equation(with_cosines(found))

    def words(self, labels: Sequence[str]) -> str:
        """Name the wave."""
        wave = f"e^({inline(self.rate)} t + i {inline(self.wavenumber)} n)"
        return f"insert the plane wave {wave} into {listed(labels)}"
