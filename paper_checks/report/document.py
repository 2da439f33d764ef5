"""The report of a run: counts, headlines, provenance, and its complete content as JSON."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path

from paper_checks.finding import Erratum, Finding
from paper_checks.outcome import FAILED, JudgedClaim, slug
from paper_checks.report.figure_links import pictures_of
from paper_checks.report.safe_svg import safe_svg
from paper_checks.report.section import Section
from paper_checks.ruling import Verdict
from verification.execution.metadata import now, this_machine
from verification.pictures.figures import NAME

FORMAT = 2
"""Version of the JSON document; raised when a change would break programs that read it."""

PACKAGES = ("numpy", "scipy", "mpmath", "sympy", "numba", "matplotlib", "python-flint")
"""Packages used in producing a finding."""

Json = dict[str, object]


@dataclass(frozen=True)
class Report:
    """The complete content of the report.

    Attributes
    ----------
    outcomes : tuple of JudgedClaim
        One per claim, in order.
    seconds : float
        Wall-clock time of the run.
    available : int
        Total number of claims, whether judged in this run or not.
    versions : mapping
        Versions by package; None for one that is not installed.
    source : str
        Digest of the toolkit's code.
    machine : mapping
        Platform and number of cores.
    created : str
        Time at which the run ended, UTC.
    measurements : tuple of Section
        Stored measurements shown beside the claims.
    """

    outcomes: tuple[JudgedClaim, ...]
    seconds: float
    available: int
    versions: Mapping[str, str | None]
    source: str
    machine: Mapping[str, object]
    created: str
    measurements: tuple[Section, ...] = ()

    @property
    def counts(self) -> dict[str, int]:
        """Number of claims by status, including statuses that do not occur."""
        statuses = [outcome.status for outcome in self.outcomes]
        return {name: statuses.count(name) for name in (*map(slug, Verdict), FAILED)}

    @property
    def changed(self) -> tuple[JudgedClaim, ...]:
        """Outcomes that differ from the record, including failed ones."""
        return tuple(outcome for outcome in self.outcomes if outcome.changed)

    @property
    def stale(self) -> tuple[JudgedClaim, ...]:
        """Outcomes that are stored findings of code other than that of this run."""
        return tuple(outcome for outcome in self.outcomes if outcome.judgement.stale)

    @property
    def shared(self) -> float:
        """Total time, over all processes, of the work shared by several judges of this run."""
        return sum(one.judgement.shared for one in self.outcomes if not one.judgement.stored)

    @cached_property
    def shown_by(self) -> Mapping[str, tuple[str, ...]]:
        """Names of the pictures that show each claim, by its key."""
        return pictures_of(self.outcomes)

    @property
    def confirmed(self) -> tuple[int, int]:
        """Number of claims judged by two methods, and by a single one."""
        judged = [one.claim for one in self.outcomes if one.claim.recorded is not _MUTE]
        two = sum(len(claim.methods) == 2 for claim in judged)
        return two, len(judged) - two

    @cached_property
    def figures(self) -> Mapping[str, tuple[JudgedClaim, ...]]:
        """The claims of each figure of the paper, by module."""
        names = dict.fromkeys(one.entry.group for one in self.outcomes)
        return {
            name: tuple(one for one in self.outcomes if one.entry.group == name)
            for name in names
            if re.fullmatch(r"fig\d+", name)
        }

    @cached_property
    def in_gallery(self) -> Mapping[str, str]:
        """Pictures that represent the figures of the paper in the gallery, with their modules.

        They are those whose caption begins with the number of the figure or, if there is none, the
        first picture.
        """
        found: dict[str, str] = {}
        for group, outcomes in self.figures.items():
            begins = re.compile(rf"Fig\. {int(group[3:])}[a-z]?\b")
            for one in outcomes:
                chosen = [each for each in one.pictures if begins.match(each.caption)]
                if not chosen and group not in found.values():
                    chosen = list(one.pictures[:1])
                found |= {picture.name: group for picture in chosen}
        return found

    @property
    def repeated(self) -> int:
        """Number of sentences that repeat a claim."""
        return sum(len(one.claim.repeats) for one in self.outcomes)

    @property
    def errata(self) -> tuple[tuple[JudgedClaim, Erratum], ...]:
        """Lines that the findings prove to be misprinted, ambiguous or inconsistent."""
        return tuple(
            (outcome, outcome.finding.erratum)
            for outcome in self.outcomes
            if outcome.finding is not None and outcome.finding.erratum is not None
        )

    @property
    def headlines(self) -> tuple[tuple[JudgedClaim, Finding], ...]:
        """The three claims that a reader should see first, with their findings.

        Findings that have a headline come first, followed by those that disagree with the paper, in
        order of the weight of their claims, then of the degree of disagreement, then of the claims.
        As far as possible, each is from a different module.
        """
        found = [(one, one.finding) for one in self.outcomes if one.finding is not None]

        def rank(one: tuple[JudgedClaim, Finding]) -> tuple[bool, bool, int, int]:
            outcome, finding = one
            agrees = finding.verdict is Verdict.REPRODUCED
            severity = _SEVERITY.index(finding.verdict)
            return not finding.headline, agrees, -outcome.claim.weight, severity

        ranked = sorted(found, key=rank)
        groups = [outcome.entry.group for outcome, _ in ranked]
        again = [group in groups[:place] for place, group in enumerate(groups)]
        chosen = sorted(range(len(ranked)), key=lambda place: (again[place], place))[:3]
        return tuple(ranked[place] for place in sorted(chosen))


_MUTE = Verdict.UNTESTABLE

_SEVERITY = (
    Verdict.NOT_REPRODUCED,
    Verdict.PARTIAL,
    Verdict.CORRECTED,
    Verdict.UNTESTABLE,
    Verdict.REPRODUCED,
)


def make_report(
    outcomes: Sequence[JudgedClaim],
    *,
    seconds: float,
    available: int,
    versions: Mapping[str, str | None],
    source: str,
    measurements: Sequence[Section],
) -> Report:
    """Combine the outcomes of a run with its duration and the machine."""
    return Report(
        outcomes=_one_picture_a_name(outcomes),
        seconds=seconds,
        available=available,
        versions=versions,
        source=source,
        machine=this_machine(),
        created=now(),
        measurements=tuple(measurements),
    )


def to_json(report: Report) -> Json:
    """Return the report as a JSON object; its schema is in ``docs/report_schema.md``."""
    return {
        "format": FORMAT,
        "created": report.created,
        "seconds": round(report.seconds, 3),
        "versions": dict(report.versions),
        "source": report.source,
        "machine": dict(report.machine),
        "claims_available": report.available,
        "counts": report.counts,
        "changed": [outcome.claim.key for outcome in report.changed],
        "stale": [outcome.claim.key for outcome in report.stale],
        "headlines": [outcome.claim.key for outcome, _ in report.headlines],
        "errata": [
            {"key": outcome.claim.key, "place": outcome.claim.place, **asdict(erratum)}
            for outcome, erratum in report.errata
        ],
        "claims": [
            _record(outcome, report.shown_by[outcome.claim.key]) for outcome in report.outcomes
        ],
        "measurements": [section.as_dict() for section in report.measurements],
    }


def picture_files(report: Report) -> dict[str, str | bytes]:
    """Return the content of each picture file and data file by file name."""
    files: dict[str, str | bytes] = {}
    for outcome in report.outcomes:
        for picture in outcome.pictures:
            files[f"{picture.name}.svg"] = safe_svg(picture.svg)
            files[f"{picture.name}.csv"] = picture.data
            for kind, content in (("png", picture.png), ("pdf", picture.pdf)):
                if content:
                    files[f"{picture.name}.{kind}"] = base64.b64decode(content)
    return files


def pictures_listed(path: Path) -> set[str]:
    """Return the names of the picture and data files that belong to a written report.

    The set is empty if there is no report, or none that can be read.
    """
    try:
        claims = json.loads(path.read_text(encoding="utf-8"))["claims"]
        names = {one.get(kind) for claim in claims for one in claim["pictures"] for kind in _KINDS}
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return set()
    # A report never writes a name that contains a folder.
    return {name for name in names if isinstance(name, str) and NAME.fullmatch(name)}


_KINDS = ("svg", "png", "pdf", "data")


def _record(outcome: JudgedClaim, shown_by: Sequence[str]) -> Json:
    claim, finding = outcome.claim, outcome.finding
    provenance = outcome.judgement.provenance
    return {
        "key": claim.key,
        "group": outcome.entry.group,
        "place": claim.place,
        "quote": claim.quote,
        "statement": claim.statement,
        "printed": claim.printed,
        "recorded": claim.recorded.value,
        "verdict": finding.verdict.value if finding else None,
        "changed": outcome.changed,
        "because": outcome.because,
        "failure": outcome.judgement.failure,
        "value": finding.value if finding else None,
        "error": finding.error if finding else None,
        "methods": list(finding.methods) if finding else [],
        "tolerance": finding.tolerance if finding else None,
        "explanation": finding.explanation if finding else None,
        "part": finding.part if finding else None,
        "remarks": list(finding.remarks) if finding else [],
        "repeats": [asdict(one) for one in claim.repeats],
        "code": [method.code for method in claim.methods],
        "formulas": [asdict(formula) for formula in finding.formulas] if finding else [],
        "command": claim.command,
        "seconds": round(outcome.judgement.seconds, 3),
        "shared_seconds": round(outcome.judgement.shared, 3),
        "judged": outcome.judgement.judged,
        "stored": outcome.judgement.stored,
        "provenance": asdict(provenance) if provenance else None,
        "pictures": [
            {
                "name": picture.name,
                "caption": picture.caption,
                "svg": f"{picture.name}.svg",
                "data": f"{picture.name}.csv",
                **{kind: f"{picture.name}.{kind}" for kind in ("png", "pdf")},
            }
            for picture in outcome.pictures
        ],
        "shown_by": list(shown_by),
    }


def _one_picture_a_name(outcomes: Sequence[JudgedClaim]) -> tuple[JudgedClaim, ...]:
    """Fail a claim whose picture would overwrite a different one; duplicates are allowed."""
    owners: dict[str, tuple[str, object]] = {}
    checked = []
    for outcome in outcomes:
        failure = None
        for picture in outcome.pictures:
            owner, first = owners.setdefault(picture.name, (outcome.claim.key, picture))
            if first != picture:
                failure = f"its picture '{picture.name}' has the name of another one, of {owner}."
        if failure is not None:
            judgement = replace(outcome.judgement, finding=None, failure=failure)
            outcome = replace(outcome, judgement=judgement)  # noqa: PLW2901
        checked.append(outcome)
    return tuple(checked)
