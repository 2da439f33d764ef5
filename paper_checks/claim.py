"""A claim of the paper: evidence, rule, figure and text, and the finding they lead to in a run.

A claim consists of four short parts. Its *evidence* is computed and returned as a frozen dataclass.
Its *rule*, a few lines that the tests check with artificial evidence, derives a verdict from the
evidence. Its *figure* draws the evidence. Its *text*, in a file next to the code, contains the
words of the paper and a template of what we found (``paper_checks.prose``). `Claim.beside` reads a
claim from its text, and `Claim.found` applies rule, figure and text to evidence. The rules of
judging are in ``paper_checks.ruling``.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Self

from paper_checks.finding import Erratum, Fault, Finding, Formula
from paper_checks.prose import words, written
from paper_checks.ruling import Ruling, Verdict
from verification.pictures.figures import Picture

__all__ = ["Claim", "Erratum", "Fault", "Finding", "Formula", "Method", "Picture", "Repeat",
           "Ruling", "Verdict"]  # fmt: skip


_METHOD = re.compile(r"(?P<words>[^\[]+) \[(?P<code>[\w.]+:\w+)\](?:, for (?P<covers>.+))?")


@dataclass(frozen=True)
class Method:
    """A method that leads to the result, with a reference to its code.

    Attributes
    ----------
    words : str
        What is done, in standard terms.
    code : str
        Reference to its code, as ``package.module:function``. The methods of one claim share no
        stepper, solver, sum or search; see ``tests/independence.py``.
    covers : str
        The part of the evidence that the method covers; empty for all of it.
    """

    words: str
    code: str
    covers: str = ""

    @classmethod
    def of(cls, text: str) -> Self:
        """Return the method described as ``WORDS [CODE]`` or ``WORDS [CODE], for PART``.

        Raises
        ------
        ValueError
            If the description has another form.

        Examples
        --------
        >>> Method.of("runs [verification.runs.simulate:simulate], for one coupling").covers
        'one coupling'
        """
        found = _METHOD.fullmatch(text)
        if found is None:
            raise ValueError(f"'{text}' is no method: write it as WORDS [CODE].")
        return cls(found["words"], found["code"], found["covers"] or "")

    @property
    def module(self) -> str:
        """Dotted name of the module."""
        return self.code.partition(":")[0]

    def __str__(self) -> str:
        return f"{self.words} (this covers {self.covers})" if self.covers else self.words


@dataclass(frozen=True)
class Repeat:
    """Another passage of the paper that says the same; listed under the claim, not counted again.

    Attributes
    ----------
    place, quote : str
        The place and the words.
    """

    place: str
    quote: str


_FIELDS = {"place", "quote", "statement", "recorded", "command"}
"""Fields of a claim that every text contains."""


@dataclass(frozen=True, kw_only=True)
class Claim:
    """One claim of the paper and the computation that judges it.

    Attributes
    ----------
    key : str
        Short unique name, as in ``fronts check KEY``.
    place : str
        Place in the paper: equation, figure, section.
    quote : str
        The few words of the paper that are judged, with mathematics between dollar signs. For a
        displayed equation the equation itself is shown.
    statement : str
        The claim in one short sentence that adds nothing to the quote.
    printed : str or None
        The paper's value, if it gives one; the parameters of a figure as ``at a = 4, …``.
    recorded : Verdict
        The recorded verdict; a run that arrives at another one says so and exits with code 1.
    command : str
        A shell command that reproduces the number.
    evidence : callable
        Computes the evidence for the verdict, and returns it as a frozen dataclass.
    rule : callable
        Derives the ruling from the evidence. The template of the prose is the section with the
        claim's key in the file beside its module with the suffix ``.md``.
    methods : tuple of Method
        One or two.
    figure : callable, optional
        Draws the evidence; the captions of the pictures come from the template.
    formulas, erratum : callable, optional
        For equations: what is typeset, and the erratum if no template provides it.
    repeats : tuple of Repeat
        Other passages that say the same.
    weight : int
        Importance to a reader: 0 for a detail, 1 by default, 2 for a foundation of the paper.
    expensive : bool
        Whether the quick run may show a finding shipped with the toolkit; for claims that take more
        than about five seconds. See ``paper_checks.shipped``.
    shared : callable, optional
        Work that it shares with other claims and that is cached after the first call, such as a
        derivation. It is called first, and its time is stated separately, so that it is not
        attributed to the first claim judged.
    """

    key: str
    place: str
    quote: str
    statement: str
    recorded: Verdict
    command: str
    evidence: Callable[[], Any] = field(repr=False)
    rule: Callable[[Any], Ruling] = field(repr=False)
    methods: tuple[Method, ...]
    printed: str | None = None
    figure: Callable[[Any], tuple[Picture, ...]] | None = field(default=None, repr=False)
    formulas: Callable[[Any], tuple[Formula, ...]] | None = field(default=None, repr=False)
    erratum: Callable[[Any], Erratum | None] | None = field(default=None, repr=False)
    repeats: tuple[Repeat, ...] = ()
    weight: int = 1
    expensive: bool = False
    shared: Callable[[], object] | None = field(default=None, repr=False)

    @classmethod
    def beside(cls, key: str, *, rule: Callable[[Any], Ruling], **judging: Any) -> Self:
        """Return the claim whose words are in the text beside the module of its rule.

        Parameters
        ----------
        key : str
            Its key, which is also the heading of its section in the text.
        rule, **judging
            The fields that are code: evidence, figure, weight and so on.

        Raises
        ------
        ValueError
            If a field is missing in the text, or is there but does not exist in a claim.
        """
        fields = words(rule.__module__, key)
        given = {name: value for name, value in fields if name not in ("by", "also")}
        if not _FIELDS <= set(given) <= {*_FIELDS, "printed"}:
            raise ValueError(f"the text of {key} has {', '.join(given)}: it needs {_FIELDS}.")
        repeats = (value.partition(": ") for name, value in fields if name == "also")
        return cls(
            key=key,
            rule=rule,
            place=given["place"],
            quote=given["quote"],
            statement=given["statement"],
            printed=given.get("printed"),
            recorded=Verdict(given["recorded"]),
            command=given["command"],
            methods=tuple(Method.of(value) for name, value in fields if name == "by"),
            repeats=tuple(Repeat(place, quote) for place, _, quote in repeats),
            **judging,
        )

    def found(self, evidence: Any) -> Finding:
        """Return the finding that the given evidence leads to.

        Raises
        ------
        ValueError
            If the ruling names a part that is not in the quote, or the template is incomplete.
        """
        ruling = self.rule(evidence)
        if plain(ruling.part) not in plain(self.quote):  # an empty part is always contained
            raise ValueError(f"{self.key}: '{ruling.part}' is not a part of the quote.")
        prose = written(self.rule.__module__, self.key, evidence)
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


def plain(text: str) -> str:
    """Return text without the dollar signs of mathematics and extra spaces, for comparison.

    Examples
    --------
    >>> plain("at  $c = 0.195$")
    'at c = 0.195'
    """
    return " ".join(text.replace("$", "").split())
