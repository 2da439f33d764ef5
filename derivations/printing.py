"""The transcription of the paper's displayed equations: what a `PrintedEquation` is.

Each folder of this package has its own ``printed.py`` with the equations it derives. An equation
stands there once as LaTeX, which is shown to people, and once as an expression, which is computed
with; a test reads the LaTeX and proves the two equal.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum

import sympy as sp

from derivations.algebra.steps import Check


class EquationVerdict(StrEnum):
    """The possible verdicts on a printed equation."""

    HOLDS = "holds"
    MISPRINT = "misprint"
    AMBIGUOUS = "ambiguous"
    INCONSISTENT = "inconsistent"
    DEFINITION = "definition"
    ASSUMPTION = "assumption"


@dataclass(frozen=True)
class EquationReading:
    """One way to read an ambiguous equation, or what another place asks of an inconsistent one.

    Attributes
    ----------
    meaning : str
        The reading, in words.
    equation : Basic
        The equation in this reading.
    check : callable or None
        Judges it; None for the check of the derived step.
    holds : bool
        Whether it is expected to pass.
    implies : str
        What follows from it.
    """

    meaning: str
    equation: sp.Basic
    holds: bool
    implies: str
    check: Check | None = field(default=None, repr=False)


@dataclass(frozen=True)
class PrintedEquation:
    """A displayed equation of the paper.

    Attributes
    ----------
    number : int
        1 to 54.
    latex : str
        As printed.
    expression : Basic
        The same as a live object: an ``Eq``, an inequality, a ``Tuple`` of them, or an expression.
    verdict : EquationVerdict
        On record; `derivations.judgement.judge` must find it again.
    note : str
        Why, in a sentence or two.
    affects : str
        What later in the paper hangs on it; empty for nothing.
    readings : tuple of EquationReading
        For an ambiguous equation. For an inconsistent one: what another place makes of it, which
        fails, and the form that does not.
    slip : (Basic, Basic, Basic) or None
        For a misprint of one term: as printed, as it should be, and the equation with that change
        alone, which must be the derived one.
    amendments : tuple of (str, str)
        Tokens of the LaTeX as printed, each with what must stand in its place.
    """

    number: int
    latex: str
    expression: sp.Basic
    verdict: EquationVerdict
    note: str
    affects: str = ""
    readings: tuple[EquationReading, ...] = ()
    slip: tuple[sp.Basic, sp.Basic, sp.Basic] | None = None
    amendments: tuple[tuple[str, str], ...] = ()

    @property
    def amended_latex(self) -> str | None:
        """The LaTeX with the wrong tokens exchanged; None where no token is on record.

        Raises
        ------
        ValueError
            If print does not have exactly once what is to be exchanged.
        """
        if not self.amendments:
            return None
        line = self.latex
        for wrong, right in self.amendments:
            if line.count(wrong) != 1:
                raise ValueError(f"({self.number}) does not have '{wrong}' once")
            line = line.replace(wrong, right)
        return line
