"""The result of judging a claim, as shown in a report: verdict, numbers, prose and pictures."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from paper_checks.ruling import Verdict
from verification.pictures.figures import Picture


@dataclass(frozen=True)
class Formula:
    """An equation to be typeset with a finding: its label, and its LaTeX without dollar signs.

    Attributes
    ----------
    label : str
        Its label, as in ``As printed``.
    latex : str
        The equation, without dollar signs.
    """

    label: str
    latex: str


class Fault(StrEnum):
    """The kinds of faults of a printed line."""

    MISPRINT = "misprint"
    AMBIGUOUS = "ambiguous"
    INCONSISTENT = "inconsistent"


@dataclass(frozen=True)
class Erratum:
    """A line of the paper that should read differently, with a proof.

    Attributes
    ----------
    fault : Fault
        A misprint has one correct form; an ambiguous line has several readings; an inconsistent one
        contradicts another passage of the paper.
    printed : str
        As printed. Parts between dollar signs are LaTeX, here and in ``corrected``.
    corrected : str
        How it should read.
    reason : str
        What is wrong.
    proof : str
        The derivation step or the failing check that proves it, with its result in this run.
    affects : str
        What depends on it later in the paper.
    """

    fault: Fault
    printed: str
    corrected: str
    reason: str
    proof: str
    affects: str


@dataclass(frozen=True)
class Finding:
    """The result of a check in this run.

    Attributes
    ----------
    verdict : Verdict
        The verdict.
    value : str
        Our number or statement, with the digits that are known.
    error : str
        Bound or uncertainty of ``value``, or the reason why it has none.
    methods : tuple of str
        Two independent methods that both led to ``value``, or a single one.
    tolerance : str
        The difference that would have changed the verdict, and the reason for its size.
    explanation : str
        Where and why the claim holds or fails, in a few plain sentences.
    because : str
        Why the verdict is not a plain 'reproduced', in one sentence; empty if it is.
    part : str
        The words of the paper's sentence that fail, if it holds only in part.
    remarks : tuple of str
        What holds elsewhere, or under another reading; it does not affect the verdict.
    pictures : tuple of Picture
        Pictures; may be empty.
    formulas : tuple of Formula
        Equations shown with the explanation; may be empty.
    erratum : Erratum, optional
        The erratum that this finding proves.
    headline : str
        The finding in one sentence, if it is among those to be read first.
    """

    verdict: Verdict
    value: str
    error: str
    methods: tuple[str, ...]
    tolerance: str
    explanation: str
    because: str = ""
    part: str = ""
    remarks: tuple[str, ...] = ()
    pictures: tuple[Picture, ...] = ()
    formulas: tuple[Formula, ...] = ()
    erratum: Erratum | None = None
    headline: str = ""
