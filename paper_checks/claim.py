"""A claim of the paper, and what we found when we checked it."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum

NAME = re.compile(r"[a-z0-9][a-z0-9._-]*")
"""Form of a claim's key and of a picture's name: both become file names and page anchors."""


class Verdict(StrEnum):
    """The five possible verdicts on a claim."""

    REPRODUCED = "reproduced"
    CORRECTED = "reproduced with a correction"
    PARTIAL = "holds only in part"
    NOT_REPRODUCED = "not reproduced"
    UNTESTABLE = "cannot be tested from the text"


@dataclass(frozen=True)
class Picture:
    """A figure of the report.

    Attributes
    ----------
    name : str
        File name without suffix; unique in the report.
    caption : str
        What is seen, in a sentence or two; also the alternative text.
    svg : str
        The picture, as an SVG document.
    data : str
        The numbers behind it, as CSV with a header line.
    """

    name: str
    caption: str
    svg: str = field(repr=False)
    data: str = field(repr=False)


@dataclass(frozen=True)
class Formula:
    """An equation to be typeset beside a finding.

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
        Two methods that share no code and both led to ``value``.
    tolerance : str
        What difference would have changed the verdict, and why that much.
    explanation : str
        Where and why the claim holds or fails, in a few plain sentences.
    pictures : tuple of Picture
        May be empty.
    formulas : tuple of Formula
        Equations shown with the explanation; may be empty.
    erratum : Erratum, optional
        The line of the table of errata that this finding proves.
    """

    verdict: Verdict
    value: str
    error: str
    methods: tuple[str, str]
    tolerance: str
    explanation: str
    pictures: tuple[Picture, ...] = ()
    formulas: tuple[Formula, ...] = ()
    erratum: Erratum | None = None


@dataclass(frozen=True)
class Claim:
    """One claim of the paper and the computation that judges it.

    Attributes
    ----------
    key : str
        Short unique name, as in ``fronts check KEY``.
    place : str
        Where in the paper: equation, figure, section.
    statement : str
        The claim in one short sentence.
    printed : str or None
        The paper's value where it gives one; the parameters of a figure as ``at a = 4, …``.
    recorded : Verdict
        The verdict on record; a run that finds another one says so and exits with 1.
    command : str
        A shell command that reproduces the number.
    judge : callable
        Computes the finding.
    weight : int
        Importance to a reader: 0 for a detail, 1 by default, 2 for what the paper rests on.
    expensive : bool
        Whether the quick run may show a finding shipped with the toolkit; for judges that take
        more than about five seconds. See ``paper_checks.shipped``.
    shared : callable, optional
        Work of the judge that it shares with other judges and that is kept after the first call,
        as a derivation is. It is called before the judge and its time is told apart, so that the
        first claim judged does not seem to take it all.
    because : str
        Why the verdict on record is not a plain 'reproduced', in one line without numbers; shown
        only while the verdict found is the one on record.
    follows : tuple of str
        Keys of the claims, or names of their modules, that judge the substance of this one. If
        there are any, ``judge`` is not called; see ``paper_checks.following``.
    """

    key: str
    place: str
    statement: str
    printed: str | None
    recorded: Verdict
    command: str
    judge: Callable[[], Finding] = field(repr=False)
    weight: int = 1
    expensive: bool = False
    follows: tuple[str, ...] = ()
    shared: Callable[[], object] | None = field(default=None, repr=False)
    because: str = ""
