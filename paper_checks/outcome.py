"""The outcome of a claim: the finding of its judge in a run, or the reason why there is none."""

from __future__ import annotations

import logging
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from paper_checks.claim import Claim
from paper_checks.discover import Entry
from paper_checks.finding import Finding
from paper_checks.plain_evidence import evidence_from, plain_evidence
from paper_checks.report.safe_svg import safe_svg
from paper_checks.ruling import Verdict
from verification.execution.metadata import now
from verification.pictures.figures import NAME, Picture

FAILED = "failed"
"""Status of a claim whose judge raised an error."""

logger = logging.getLogger(__name__)


def slug(verdict: Verdict) -> str:
    """Return the short spelling of a verdict, for the command line and for page addresses.

    Examples
    --------
    >>> [slug(verdict) for verdict in Verdict]
    ['reproduced', 'corrected', 'partial', 'not-reproduced', 'untestable']
    """
    return verdict.name.lower().replace("_", "-")


@dataclass(frozen=True)
class Provenance:
    """Origin of a finding that is shipped with the toolkit.

    Attributes
    ----------
    command : str
        Command that computes and records it anew.
    versions : mapping
        Versions by package at that time.
    machine : mapping
        Platform and number of cores at that time.
    stale : bool
        Whether the code on which it depends, including its parameters, has changed since.
    """

    command: str
    versions: Mapping[str, str | None]
    machine: Mapping[str, object]
    stale: bool


@dataclass(frozen=True)
class Judgement:
    """The result of running a judge.

    Attributes
    ----------
    finding : Finding or None
        The finding; None if the judge failed.
    failure : str or None
        One sentence that states how the judge failed.
    seconds : float
        Wall-clock time of the judge, without the work it shares with others.
    judged : str
        Time at which it ended: UTC, ISO 8601, to the second.
    stored : bool
        Whether it was kept from an earlier run instead of being computed in this one.
    provenance : Provenance or None
        Provenance of a finding that is shipped with the toolkit.
    shared : float
        Wall-clock time of the shared work; almost zero if an earlier judge of the same process has
        done it.
    evidence : plain data or None
        The evidence by which the claim was judged, if it was computed in this run.
    """

    finding: Finding | None
    failure: str | None
    seconds: float
    judged: str
    stored: bool = False
    provenance: Provenance | None = None
    shared: float = 0.0
    evidence: Any = None

    @property
    def stale(self) -> bool:
        """Whether it is a stored finding of code other than that of this run."""
        return self.provenance is not None and self.provenance.stale


@dataclass(frozen=True)
class JudgedClaim:
    """A claim together with its judgement."""

    entry: Entry
    judgement: Judgement

    @property
    def claim(self) -> Claim:
        """The claim."""
        return self.entry.claim

    @property
    def finding(self) -> Finding | None:
        """The finding, or None if the judge failed."""
        return self.judgement.finding

    @property
    def pictures(self) -> tuple[Picture, ...]:
        """The pictures of the finding; none if the judge failed."""
        return self.finding.pictures if self.finding else ()

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes beside the verdict: a record that differs, a stored or stale finding."""
        notes = {
            f"on record: {self.claim.recorded}": self.changed,
            "stale": self.judgement.stale,
            "stored": self.judgement.stored,
        }
        return tuple(note for note, holds in notes.items() if holds)

    @property
    def status(self) -> str:
        """The short spelling of the verdict, or ``failed``."""
        return FAILED if self.finding is None else slug(self.finding.verdict)

    @property
    def changed(self) -> bool:
        """Whether the verdict differs from the recorded one; a failure counts as different."""
        return self.finding is None or self.finding.verdict is not self.claim.recorded

    @property
    def because(self) -> str:
        """Why the verdict is what it is; empty for a plain 'reproduced'."""
        return self.finding.because if self.finding else ""

    @property
    def change(self) -> str:
        """One sentence that states the change; empty if there is none."""
        if not self.changed:
            return ""
        if self.finding is None:
            return f"{self.claim.key}: its judge failed: {self.judgement.failure}"
        return (
            f"{self.claim.key}: on record as '{self.claim.recorded}', now '{self.finding.verdict}'."
        )


def judge(claim: Claim) -> Judgement:
    """Run the judge of a claim; an error of the judge results in a failed judgement.

    Examples
    --------
    >>> def broken():
    ...     raise ArithmeticError("no root in the box")
    >>> claim = Claim(
    ...     key="k", place="Eq. 1", quote="It holds.", statement="It holds.",
    ...     recorded=Verdict.REPRODUCED, command="true", evidence=broken, rule=print,
    ...     methods=(),
    ... )
    >>> judge(claim).failure
    'ArithmeticError: no root in the box.'
    """
    start = begin = time.perf_counter()
    finding: Finding | None = None
    failure: str | None = None
    held: Any = None
    try:
        if claim.shared is not None:
            claim.shared()
        begin = time.perf_counter()
        evidence = claim.evidence()
        finding = checked_finding(claim.found(evidence))
        held = plain_evidence(evidence)
    except (Exception, SystemExit) as error:
        logger.info("the judge of %s failed", claim.key, exc_info=True)
        failure = _sentence(error)
    seconds = time.perf_counter() - begin
    return Judgement(finding, failure, seconds, now(), shared=begin - start, evidence=held)


def judged_by(claim: Claim, evidence: Any, packages: Sequence[str], **earlier: Any) -> Judgement:
    """Judge a claim by evidence from an earlier run, with the present rule, text and figures.

    Parameters
    ----------
    claim : Claim
        The claim.
    evidence : plain data
        In the form returned by `plain_evidence`.
    packages : sequence of str
        Packages whose classes it may contain.
    **earlier
        Fields of the judgement: ``seconds``, ``judged`` and so on.

    Raises
    ------
    TypeError, ValueError, KeyError, AttributeError, ImportError
        If it is not evidence, or not that of this claim.
    """
    finding = checked_finding(claim.found(evidence_from(evidence, tuple(packages))))
    return Judgement(finding, None, stored=True, **earlier)


def _sentence(error: BaseException) -> str:
    lines = str(error).strip().splitlines()
    text = f"{type(error).__name__}: {lines[0].strip()}" if lines else type(error).__name__
    return text if text.endswith((".", "!", "?")) else f"{text}."


def checked_finding(finding: Finding) -> Finding:
    """Return a finding after checking the number of its methods, and its pictures.

    Raises
    ------
    ValueError
        If it is not valid; the message is a sentence.
    """
    if len(finding.methods) not in (1, 2):
        raise ValueError("a finding names one method or two.")
    for picture in finding.pictures:
        _check_picture(picture)
    return finding


def _check_picture(picture: Picture) -> None:
    if not NAME.fullmatch(picture.name):
        raise ValueError(
            f"the picture name '{picture.name}' must be lower-case letters, digits, dots, "
            "hyphens or underscores."
        )
    safe_svg(picture.svg)  # which refuses what is not a picture
