"""The model from which the derivations of part 2 start: a chain of self-excited oscillators."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import sympy as sp

from derivations.algebra.equations import equation
from derivations.algebra.errors import DerivationInputError
from derivations.symbols import a, b, c, epsilon, n, t, y


@dataclass(frozen=True, kw_only=True)
class ChainModel:
    """``y_n'' + y_n + eps c Σ_j w_j (2 y_n - y_{n-j} - y_{n+j}) + eps [y_n' h(y_n) + g(y_n)] = 0``.

    Everything is dimensionless; the linear frequency of a cell is 1. The paper's Eq. (8) is
    ``h = 1 - a y² + b y⁴``, ``g = 0`` and nearest neighbours; see `PAPER`.

    Parameters
    ----------
    damping : mapping of int to Expr
        Coefficient of each power of y in h.
    stiffness : mapping of int to Expr
        Coefficient of each power of y in g; empty for none.
    coupling : Expr
        The coupling; 0 for an isolated cell. The limits and thresholds in c are derived only if it
        is a multiple of the symbol c.
    weights : tuple of Expr
        Weight w_j of the springs to the j-th neighbours, beginning with the nearest.

    Raises
    ------
    DerivationInputError
        If there is no damping, a negative power, or a chain without weights.
    """

    damping: Mapping[int, sp.Expr]
    stiffness: Mapping[int, sp.Expr] = field(default_factory=dict)
    coupling: sp.Expr = c
    weights: tuple[sp.Expr, ...] = (sp.S.One,)

    def __post_init__(self) -> None:
        for quantity in ("damping", "stiffness"):
            given = getattr(self, quantity)
            if any(not isinstance(power, int) or power < 0 for power in given):
                raise DerivationInputError(quantity, given, "a table of whole powers of y",
                                           "use keys 0, 1, 2, ...")  # fmt: skip
            kept = {power: sp.sympify(value) for power, value in sorted(given.items())}
            kept = {power: value for power, value in kept.items() if value != 0}
            object.__setattr__(self, quantity, kept)
        object.__setattr__(self, "coupling", sp.sympify(self.coupling))
        weights = tuple(map(sp.sympify, self.weights))
        object.__setattr__(self, "weights", weights if self.coupling != 0 else ())
        if not self.damping:
            raise DerivationInputError("damping", 0, "other than zero", "give some damping")
        if self.coupling != 0 and not weights:
            raise DerivationInputError("weights", (), "one a neighbour", "give at least (1,)")

    def __hash__(self) -> int:
        tables = (tuple(self.damping.items()), tuple(self.stiffness.items()))
        return hash((*tables, self.coupling, self.weights))

    @property
    def reach(self) -> int:
        """Number of neighbours on either side that are coupled to a site."""
        return len(self.weights)

    @property
    def parameters(self) -> tuple[sp.Symbol, ...]:
        """The symbols in the coefficients, sorted by name."""
        values = [*self.damping.values(), *self.stiffness.values(), self.coupling, *self.weights]
        found = set().union(*(sp.sympify(value).free_symbols for value in values))
        return tuple(sorted(found, key=lambda symbol: symbol.name))

    @property
    def is_scaled_by_c(self) -> bool:
        """Whether the coupling is a multiple of the symbol c."""
        return self.coupling != 0 and not (self.coupling / c).has(c)

    @property
    def nearest_pull(self) -> bool:
        """Whether only nearest neighbours are coupled, by springs that pull a site back."""
        return self.reach == 1 and bool(self.coupling.is_positive)

    @property
    def total_coupling(self) -> sp.Expr:
        """``c Σ_j w_j``: the coupling times the weighted number of springs on one side."""
        return self.coupling * sum(self.weights, sp.S.Zero)

    def damping_of(self, displacement: sp.Expr) -> sp.Expr:
        """``h(y)``."""
        return _polynomial(self.damping, displacement)

    def stiffness_of(self, displacement: sp.Expr) -> sp.Expr:
        """``g(y)``."""
        return _polynomial(self.stiffness, displacement)

    def springs(self, field: sp.Function) -> sp.Expr:
        """``Σ_j w_j (2 f_n - f_{n-j} - f_{n+j})`` of a field f at time t."""
        own = field(n, t)
        return sum(
            (weight * (2 * own - field(n - j, t) - field(n + j, t))
             for j, weight in enumerate(self.weights, start=1)),
            sp.S.Zero,
        )  # fmt: skip

    def equation(self) -> sp.Eq:
        """Eq. (8) of this model, for site n at time t."""
        own = y(n, t)
        force = own.diff(t) * self.damping_of(own) + self.stiffness_of(own)
        left = own.diff(t, 2) + own + epsilon * self.coupling * self.springs(y) + epsilon * force
        return equation(left)

    def with_values(self, put: Mapping[sp.Symbol, sp.Expr]) -> ChainModel:
        """Return the same chain with numbers for some symbols."""
        return ChainModel(
            damping={power: value.subs(put) for power, value in self.damping.items()},
            stiffness={power: value.subs(put) for power, value in self.stiffness.items()},
            coupling=self.coupling.subs(put),
            weights=tuple(weight.subs(put) for weight in self.weights),
        )

    def cell(self) -> ChainModel:
        """Return the isolated cell."""
        return ChainModel(damping=self.damping, stiffness=self.stiffness, coupling=0, weights=())


def _polynomial(powers: Mapping[int, sp.Expr], displacement: sp.Expr) -> sp.Expr:
    return sum((value * displacement**power for power, value in powers.items()), sp.S.Zero)


PAPER = ChainModel(damping={0: 1, 2: -a, 4: b})
"""Eq. (8)."""
