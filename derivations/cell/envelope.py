"""The averaged equation of any polynomial oscillator, its limit cycles, and their consequences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import sympy as sp

from derivations.algebra.equations import equation
from derivations.algebra.errors import DerivationInputError
from derivations.algebra.steps import Derivation
from derivations.averaging.cycles import (
    LimitCycle,
    damping_mean,
    limit_cycles,
    ratio_of_cycles,
    shown,
)
from derivations.averaging.symbols import phi, square
from derivations.cell.polynomial_input import Coefficients, coefficients, number, values_of
from derivations.cell.results import CellKineticRelation, Compiled
from derivations.cell.steps import derive, shift_mean
from derivations.chain import ChainModel
from derivations.symbols import epsilon, n, t

r = sp.Symbol("r", positive=True)
r_rate = sp.Symbol("r'", real=True)
PHI = {-1: sp.Symbol(r"\varphi_{n-1}"), 0: sp.Symbol(r"\varphi_{n}"),
       1: sp.Symbol(r"\varphi_{n+1}")}  # fmt: skip
phi_rate = sp.Symbol(r"\varphi_{n}'")


@dataclass(frozen=True)
class Envelope:
    """The averaged equation of an oscillator; returned by `derive_envelope`.

    Attributes
    ----------
    model : ChainModel
        The model that was averaged.
    order : {1, 2}
        The order in epsilon to which it was averaged.
    front : bool
        Whether the front of a bistable cell is derived too, if cells are coupled.
    """

    model: ChainModel
    order: int = 1
    front: bool = True

    def __getstate__(self) -> dict[str, Any]:
        """Return the fields alone: what follows from them is derived anew after unpickling."""
        return {each.name: getattr(self, each.name) for each in fields(self)}

    @cached_property
    def derivation(self) -> Derivation:
        """Its steps, each computed on demand."""
        return derive(self.model, self.order, front=self.front)

    @property
    def symbols(self) -> tuple[sp.Symbol, ...]:
        """The symbols in the coefficients."""
        return self.model.parameters

    @cached_property
    def damping_mean(self) -> sp.Expr:
        """H(s): the amplitude obeys ``r' = -(r/2) H(r^2)``, per unit of ``eps t``."""
        return damping_mean(self.derivation.named("amplitude of the cell").result)

    @cached_property
    def shift_mean(self) -> sp.Expr:
        """Omega(s): the frequency of the isolated cell is ``1 + eps Omega(r^2)``."""
        return shift_mean(self.derivation.named("frequency shift of the cell").result)

    @cached_property
    def equation(self) -> sp.Eq:
        """The averaged equation of the chain, ``y = Im(phi e^{it})``; prime is d/d(eps t)."""
        fields = {phi(n + at, t): symbol for at, symbol in PHI.items()}
        averaged = self.derivation.named("averaged cell in its chain").result
        right = averaged.rhs.xreplace(fields)
        return equation(phi_rate, sp.expand(right / epsilon))

    @property
    def amplitude_equation(self) -> sp.Eq:
        """``r' = -(r/2) H(r^2)``; the prime is d/d(eps t)."""
        return equation(r_rate, -r / 2 * self.damping_mean.subs(square, r**2))

    @cached_property
    def cycles(self) -> tuple[LimitCycle, ...]:
        """All limit cycles from the inner to the outer, with their stability.

        Raises
        ------
        DerivationInputError
            If the coefficients are symbols and the roots have no closed form.
        """
        return limit_cycles(self.damping_mean)

    @cached_property
    def ratio(self) -> sp.Expr:
        """|phi_us| / |phi_s| of a cell with exactly two cycles, the inner one unstable.

        Raises
        ------
        DerivationInputError
            If the cell is not of this kind.
        """
        return ratio_of_cycles(self.damping_mean, self.cycles, self.model.damping)

    def kinetic_relation(self) -> CellKineticRelation:
        """Return the kinetic relation (54) of the simplified model of this cell.

        Raises
        ------
        DerivationInputError
            If the cell does not have exactly two cycles around a stable rest state, or is not
            coupled.
        """
        if self.model.coupling == 0:
            raise DerivationInputError("coupling", 0, "other than zero for a front",
                                       "give a number or a letter")  # fmt: skip
        ratio, rest = self.ratio, self.damping_mean.subs(square, 0)
        neglected = ""
        if self.shift_mean.has(square):
            neglected = "the dependence of the frequency on amplitude is left out"
        relation = self.derivation.named("kinetic relation of the cell").result
        return CellKineticRelation(ratio, rest, relation, neglected)

    def compiled(self, **given: float) -> Compiled:
        """Return fast numerical functions, once every letter has a value.

        Raises
        ------
        DerivationInputError
            If a letter has no value, or a value belongs to no letter.
        """
        numeric = self.with_values(given) if given else self
        left = sorted(symbol.name for symbol in numeric.symbols)
        if left:
            raise DerivationInputError(
                "values",
                ", ".join(given) or "none",
                f"complete ({', '.join(left)} missing)",
                "give them all",
            )
        right = numeric.equation.rhs
        rate = sp.lambdify((PHI[0], PHI[-1], PHI[1]), right, "numpy", cse=True)
        own = sp.lambdify(r, numeric.amplitude_equation.rhs, "numpy", cse=True)
        shift = sp.lambdify(r, numeric.shift_mean.subs(square, r**2), "numpy", cse=True)
        return Compiled(rate, own, shift, tuple(float(q.amplitude) for q in numeric.cycles))

    def with_values(self, given: Mapping[str, float | str]) -> Envelope:
        """Return the same envelope with numbers for some letters, exact for decimal numbers.

        Raises
        ------
        DerivationInputError
            If a value belongs to no letter, or is not a finite number.
        """
        return replace(self, model=self.model.with_values(values_of(given, self.symbols)))


def derive_envelope(
    damping: Coefficients,
    stiffness: Coefficients = None,
    coupling: str | float | sp.Expr = "c",
) -> Envelope:
    """Average ``y_n'' + y_n + eps [y_n' h(y_n) + g(y_n) + c (2 y_n - y_{n-1} - y_{n+1})] = 0``.

    Parameters
    ----------
    damping : str, Expr or mapping of power to coefficient
        h(y), with even powers of y only. Letters other than y denote positive numbers.
    stiffness : str, Expr, mapping or None
        g(y): the restoring force beyond the linear one, without a constant.
    coupling : str, number or Expr
        The coupling c.

    Returns
    -------
    Envelope

    Raises
    ------
    DerivationInputError
        If an input is not a polynomial of this form.

    Examples
    --------
    >>> cell = derive_envelope("1 - a*y**2 + b*y**4")
    >>> cell.damping_mean
    -a*s/4 + b*s**2/8 + 1
    >>> derive_envelope("y**2 - 1").cycles[0].amplitude
    2
    """
    h, g = coefficients(damping, "damping"), coefficients(stiffness, "stiffness")
    if any(power % 2 for power in h):
        raise DerivationInputError("damping", shown(h), "even in y",
                                   "give h(y) with even powers of y only")  # fmt: skip
    if not h:
        raise DerivationInputError("damping", 0, "other than zero", "give some damping")
    if 0 in g:
        raise DerivationInputError("stiffness", shown(g), "without a constant term",
                                   "measure y from the equilibrium")  # fmt: skip
    return Envelope(ChainModel(damping=h, stiffness=g, coupling=number(coupling, "coupling")))
