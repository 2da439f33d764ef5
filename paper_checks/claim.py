"""A claim of the paper, and what we found when we checked it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import StrEnum


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
    """

    verdict: Verdict
    value: str
    error: str
    methods: tuple[str, str]
    tolerance: str
    explanation: str
    pictures: tuple[Picture, ...] = ()


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
        The paper's value where it gives one.
    recorded : Verdict
        The verdict on record; a run that finds another one says so and exits with 1.
    command : str
        A shell command that reproduces the number.
    judge : callable
        Computes the finding.
    weight : int
        Importance to a reader: 0 for a detail, 1 by default, 2 for what the paper rests on.
    """

    key: str
    place: str
    statement: str
    printed: str | None
    recorded: Verdict
    command: str
    judge: Callable[[], Finding] = field(repr=False)
    weight: int = 1
