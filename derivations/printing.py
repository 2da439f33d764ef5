"""The transcription of the paper's displayed equations, as defined by `PrintedEquation`.

Each folder of this package has its own ``printed.py`` with the equations it derives. Each equation
is given once as LaTeX, for display, and once as an expression, for computation; a test reads the
LaTeX and proves the two equal.
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
    """A reading of an ambiguous equation, or what another passage requires of an inconsistent one.

    Attributes
    ----------
    meaning : str
        The reading, in words.
    equation : Basic
        The equation in this reading.
    check : callable or None
        Check for this reading; None for the check of the derived step.
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
        The same as an object: an ``Eq``, an inequality, a ``Tuple`` of these, or an expression.
    verdict : EquationVerdict
        The recorded verdict, which `derivations.judgement.judge` must confirm.
    note : str
        The reason, in a sentence or two.
    affects : str
        What depends on it later in the paper; empty if nothing does.
    readings : tuple of EquationReading
        For an ambiguous equation, its readings. For an inconsistent one: the form that another
        passage implies, which fails, and the form that holds.
    slip : (Basic, Basic, Basic) or None
        For a misprint of one term: the term as printed, the correct term, and the equation with
        only this term changed, which must be the derived one.
    amendments : tuple of (str, str)
        Tokens of the printed LaTeX, each with its replacement.
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
        """The LaTeX with the wrong tokens replaced; None if there are none on record.

        Raises
        ------
        ValueError
            If a token to be replaced does not occur exactly once in print.
        """
        if not self.amendments:
            return None
        line = self.latex
        for wrong, right in self.amendments:
            if line.count(wrong) != 1:
                raise ValueError(f"({self.number}) does not have '{wrong}' once")
            line = line.replace(wrong, right)
        return line
