"""The printed LaTeX of every equation as a SymPy object, and the changes made by a correction."""

from __future__ import annotations

import importlib
from functools import lru_cache

import sympy as sp

from derivations import catalogue
from derivations.printing import PrintedEquation
from derivations.transcription.latex_reader import Notation, read
from derivations.transcription.latex_tokens import changed_tokens


def notation_of(number: int) -> Notation:
    """Return the meaning of the names in an equation.

    Parameters
    ----------
    number : int
        1 to 54.
    """
    folder = _folder(number)
    if folder in ("multiple_scales", "averaging"):
        found: Notation = importlib.import_module(f"derivations.{folder}.notation").notation(number)
        return found
    held: Notation = importlib.import_module(f"derivations.{folder}.symbols").NOTATION
    return held


def _folder(number: int) -> str:
    return catalogue.LISTING[catalogue.owner(number)][0].partition(".")[0]


@lru_cache(maxsize=256)
def as_object(number: int, latex: str) -> sp.Basic:
    """Return a LaTeX line read as equation ``number``, written in full where print has dots.

    Parameters
    ----------
    number : int
        1 to 54.
    latex : str
        The printed line, or a corrected one.

    Raises
    ------
    DerivationInputError
        If the reader does not understand it.
    """
    found = read(latex, notation_of(number))
    if _folder(number) != "linearisation":
        return found
    from derivations.linearisation.printed import EQUATIONS, written_out

    field = next(entry for entry in EQUATIONS if entry.number == 40)
    return written_out(number, found, read(field.latex, notation_of(40)))


def read_correction(entry: PrintedEquation) -> sp.Basic | None:
    """Return the corrected equation, read from its LaTeX; None if no token is on record."""
    corrected = entry.amended_latex
    return None if corrected is None else as_object(entry.number, corrected)


def stated_changes(entry: PrintedEquation) -> tuple[tuple[str, str], ...]:
    """Return the tokens that a correction is stated to change, one pair for each amendment."""
    return tuple(pair for one in entry.amendments for pair in changed_tokens(*one))


def found_changes(entry: PrintedEquation) -> tuple[tuple[str, str], ...]:
    """Return the tokens in which the corrected line differs from print."""
    corrected = entry.amended_latex
    return () if corrected is None else changed_tokens(entry.latex, corrected)
