"""What the judging of a claim finds, as a report shows it: verdict, numbers, prose and pictures."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

from paper_checks.ruling import Verdict
from verification.pictures.figures import Picture


@dataclass(frozen=True)
class Formula:
    """An equation to be typeset beside a finding: what it is, and its LaTeX without dollar signs.

    Attributes
    ----------
    label : str
        What it is, as in ``As printed``.
    latex : str
        The equation, without dollar signs.
    """

    label: str
    latex: str


class Fault(StrEnum):
    """What can be wrong with a printed line."""

    MISPRINT = "misprint"
    AMBIGUOUS = "ambiguous"
    INCONSISTENT = "inconsistent"


@dataclass(frozen=True)
class Erratum:
    """A line of the paper that should read otherwise, with what proves it.

    Attributes
    ----------
    fault : Fault
        A misprint has one right form; an ambiguous line has several readings; an inconsistent one
        contradicts another place of the paper.
    printed : str
        As printed. Parts between dollar signs are LaTeX, here and in ``corrected``.
    corrected : str
        How it should read.
    reason : str
        What is wrong.
    proof : str
        The derivation step or the failing check that proves it, with what it found in this run.
    affects : str
        What later in the paper hangs on it.
    """

    fault: Fault
    printed: str
    corrected: str
    reason: str
    proof: str
    affects: str


@dataclass(frozen=True)
class Finding:
    """What a check found, in this run.

    Attributes
    ----------
    verdict : Verdict
        The verdict.
    value : str
        Our number or statement, formatted with the digits that are known.
    error : str
        Bound or uncertainty of ``value``, or why it has none.
    methods : tuple of str
        Two methods that share no engine and both led to ``value``; one where there is only one.
    tolerance : str
        What difference would have changed the verdict, and why that much.
    explanation : str
        Where and why the claim holds or fails, in a few plain sentences.
    because : str
        Why the verdict is not a plain 'reproduced', in one sentence; empty if it is.
    part : str
        The words of the paper's sentence that fail, if it holds only in part.
    remarks : tuple of str
        What is so elsewhere, or under another reading; nothing of it touches the verdict.
    pictures : tuple of Picture
        May be empty.
    formulas : tuple of Formula
        Equations shown with the explanation; may be empty.
    erratum : Erratum, optional
        The line of the table of errata that this finding proves.
    headline : str
        The finding in one sentence, if it is one of those to be read first.
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
