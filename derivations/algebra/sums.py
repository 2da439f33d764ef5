"""A sum over a named set of roots, kept unevaluated."""

from __future__ import annotations

from typing import Any

import sympy as sp
from sympy.printing.pretty.stringpict import prettyForm


class SumOver(sp.Expr):  # type: ignore[misc]
    """``sum of term over k in roots``; args are the term, k, and the name of the set."""

    def __new__(cls, term: Any, variable: Any, roots: Any) -> SumOver:
        """Keep the three parts unevaluated."""
        made = sp.Expr.__new__(cls, sp.sympify(term), variable, roots)
        return made  # type: ignore[no-any-return]

    @property
    def free_symbols(self) -> set[sp.Basic]:
        """The free symbols without the summation variable."""
        return set(self.args[0].free_symbols - {self.args[1]} | {self.args[2]})

    def _latex(self, printer: Any) -> str:
        term, variable, roots = (printer._print(part) for part in self.args)
        return rf"\sum_{{{variable} \in {roots}}} {term}"

    def _sympystr(self, printer: Any) -> str:
        term, variable, roots = (printer._print(part) for part in self.args)
        return f"Σ({term}, {variable} ∈ {roots})"

    def _pretty(self, printer: Any) -> Any:
        term, variable, roots = self.args
        where = (f", {printer._print(variable)} ∈ ", printer._print(roots))
        inner = prettyForm(*printer._print(term).right(*where))
        return prettyForm(*prettyForm(*inner.parens()).left("Σ"))
