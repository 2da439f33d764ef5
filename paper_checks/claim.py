"""A claim of the paper: evidence, rule, figure and text, and what comes of them in a run.

A claim is four short things in one place. Its *evidence* computes and returns a frozen dataclass;
its *rule* reads a verdict from evidence, in a few lines that the tests hold against made-up
evidence; its *figure* draws evidence; its *text* is a template of plain prose beside the code
(``paper_checks.prose``). `Claim.judge` puts the four together. The rules of judging are in
``paper_checks.ruling``.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum
from typing import Any

from paper_checks.ruling import Ruling, Verdict

__all__ = ["Claim", "Erratum", "Fault", "Finding", "Formula", "Method", "Picture", "Repeat",
           "Ruling", "Verdict"]  # fmt: skip

NAME = re.compile(r"[a-z0-9][a-z0-9._-]*")
"""Form of a claim's key and of a picture's name: both become file names and page anchors."""


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
    png, pdf : str
        The same picture in these formats, as base64; may be empty.
    """

    name: str
    caption: str
    svg: str = field(repr=False)
    data: str = field(repr=False)
    png: str = field(default="", repr=False)
    pdf: str = field(default="", repr=False)


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
class Method:
    """A way to the result, with the code that goes it.

    Attributes
    ----------
    words : str
        What is done, in the field's words.
    code : str
        Where, as ``package.module:function``. The methods of one claim share no engine; see
        ``paper_checks.independence``.
    covers : str
        The part of the evidence that it covers; empty for all of it.
    """

    words: str
    code: str
    covers: str = ""

    @property
    def module(self) -> str:
        """Dotted name of the module."""
        return self.code.partition(":")[0]

    def __str__(self) -> str:
        return f"{self.words} (this covers {self.covers})" if self.covers else self.words


@dataclass(frozen=True)
class Repeat:
    """Another place of the paper that says the same; listed under the claim, not counted again.

    Attributes
    ----------
    place, quote : str
        Where, and the words.
    """

    place: str
    quote: str


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


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One claim of the paper and the computation that judges it.

    Attributes
    ----------
    key : str
        Short unique name, as in ``fronts check KEY``.
    place : str
        Where in the paper: equation, figure, section.
    quote : str
        The few words of the paper that are judged, mathematics between dollar signs. For a
        displayed equation the equation itself is shown.
    statement : str
        The claim in one short sentence, which adds nothing to the quote.
    printed : str or None
        The paper's value where it gives one; the parameters of a figure as ``at a = 4, …``.
    recorded : Verdict
        The verdict on record; a run that finds another one says so and exits with 1.
    command : str
        A shell command that reproduces the number.
    evidence : callable
        Computes what the verdict is read from, and returns it as a frozen dataclass.
    rule : callable
        Reads the ruling from the evidence.
    text : str
        The template of the prose, as ``package.module``: the file beside that module with the
        suffix ``.md``, in it the section of the claim's key.
    methods : tuple of Method
        One or two.
    figure : callable, optional
        Draws the evidence: pictures whose captions come from the template.
    formulas, erratum : callable, optional
        For equations: what is typeset, and the line of the errata where no template gives it.
    repeats : tuple of Repeat
        Other places that say the same.
    weight : int
        Importance to a reader: 0 for a detail, 1 by default, 2 for what the paper rests on.
    expensive : bool
        Whether the quick run may show a finding shipped with the toolkit; for claims that take
        more than about five seconds. See ``paper_checks.shipped``.
    shared : callable, optional
        Work that it shares with other claims and that is kept after the first call, as a
        derivation is. It is called first and its time is stated apart, so that the first claim
        judged does not seem to take it all.
    """

    key: str
    place: str
    quote: str
    statement: str
    recorded: Verdict
    command: str
    evidence: Callable[[], Any] = field(repr=False)
    rule: Callable[[Any], Ruling] = field(repr=False)
    text: str
    methods: tuple[Method, ...]
    printed: str | None = None
    figure: Callable[[Any], tuple[Picture, ...]] | None = field(default=None, repr=False)
    formulas: Callable[[Any], tuple[Formula, ...]] | None = field(default=None, repr=False)
    erratum: Callable[[Any], Erratum | None] | None = field(default=None, repr=False)
    repeats: tuple[Repeat, ...] = ()
    weight: int = 1
    expensive: bool = False
    shared: Callable[[], object] | None = field(default=None, repr=False)

    def judge(self) -> Finding:
        """Compute the evidence, rule on it, draw it and write it down."""
        return self.found(self.evidence())

    def found(self, evidence: Any) -> Finding:
        """Return the finding that some evidence leads to.

        Raises
        ------
        ValueError
            If the ruling names a part that is not in the quote, or the template lacks something.
        """
        from paper_checks.prose import written

        ruling = self.rule(evidence)
        if ruling.part and plain(ruling.part) not in plain(self.quote):
            raise ValueError(f"{self.key}: '{ruling.part}' is not a part of the quote.")
        prose = written(self.text, self.key, evidence)
        pictures = tuple(
            replace(each, caption=prose.caption(each.name))
            for each in (self.figure(evidence) if self.figure else ())
        )
        erratum = self.erratum(evidence) if self.erratum else prose.erratum()
        return Finding(
            verdict=ruling.verdict,
            value=prose.value,
            error=prose.error,
            methods=tuple(map(str, self.methods)),
            tolerance=prose.tolerance,
            explanation=prose.explanation,
            because=ruling.because,
            part=ruling.part,
            remarks=prose.remarks,
            pictures=pictures,
            formulas=self.formulas(evidence) if self.formulas else (),
            erratum=erratum,
            headline=prose.headline,
        )


def plain(words: str) -> str:
    """Return words without mathematics' dollar signs and extra spaces, for comparison.

    Examples
    --------
    >>> plain("at  $c = 0.195$")
    'at c = 0.195'
    """
    return " ".join(words.replace("$", "").split())
