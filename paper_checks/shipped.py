"""Evidence of expensive claims that comes with the toolkit, for the quick run.

``fronts check --record`` writes what is missing or stale into ``paper_checks/findings``, ``--full
--record`` all of it: one file for each function that computes evidence, for all claims that rest on
it. The rule, the text and the figures of a claim are applied to it anew in every run. It is stale
when the code of the claim's module, or of a module that this imports, has changed. Parameters are
part of that code. Each file carries the command that reproduces it, its date, and the versions
and the machine it was found with, which are shown but make nothing stale.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from paper_checks.discover import Entry
from paper_checks.outcome import Judgement, Provenance, judged_by
from theory.parameters import ParameterError
from verification.execution.digest import digest_of_code
from verification.execution.metadata import Code, Metadata
from verification.execution.record import Record

FOLDER = Path(__file__).parent / "findings"

SHOWN = ("theory.result",)
"""The base of results shows what was found and changes nothing of it; it loads pictures by a name
that it computes, and would bring in all of its package."""

CHEAP = 60.0
"""Seconds. Stale evidence that took less than this is computed anew even in the quick run."""

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Shipped:
    """The folder of shipped evidence.

    Attributes
    ----------
    folder : Path
        One JSON file for each function that computes evidence.
    packages : collection of str
        Top-level packages whose code may matter.
    renew : bool
        Whether everything stale is computed anew, however long it takes.
    """

    folder: Path
    packages: Collection[str]
    renew: bool = False

    def load(self, entry: Entry) -> Judgement | None:
        """Judge an expensive claim by the evidence that is shipped, to be shown as stored.

        Returns
        -------
        Judgement or None
            None if the claim is not expensive, its evidence is missing or damaged, or stale and
            cheap. Its ``provenance`` says whether it is stale.
        """
        claim = entry.claim
        if not claim.expensive or not (path := self.path(claim.evidence)).exists():
            return None
        try:
            record = Record.load(path, "evidence")
            metadata, seconds = record.metadata, float(record.content["seconds"])
            if metadata.parameters["evidence"] != root_of(claim.evidence):
                raise ValueError("evidence")
            stale = metadata.code != self._code(claim.evidence)
            provenance = Provenance(metadata.command, metadata.versions, metadata.machine, stale)
            judgement = judged_by(
                claim, record.content["evidence"], tuple(self.packages), seconds=seconds,
                judged=metadata.date, provenance=provenance,
            )  # fmt: skip
        except (OSError, ParameterError, ValueError, KeyError, TypeError, AttributeError,
                ImportError):  # fmt: skip
            logger.info("the shipped evidence of %s is damaged and is ignored", claim.key)
            return None
        if stale and (self.renew or seconds < CHEAP):
            logger.info("the shipped evidence of %s is stale and is computed anew", claim.key)
            return None
        return judgement

    def record(
        self, entry: Entry, judgement: Judgement, versions: Mapping[str, str | None]
    ) -> Path:
        """Write the evidence of an expensive claim that was computed in this run.

        Raises
        ------
        OSError
            If the folder takes no files, as that of an installed package may not.
        """
        evidence = entry.claim.evidence
        metadata = Metadata(
            command=f"fronts check {entry.claim.key} --full --record",
            parameters={"evidence": root_of(evidence)},
            versions=versions,
            code=self._code(evidence),
            date=judgement.judged,
        )
        content = {"evidence": judgement.evidence, "seconds": judgement.seconds}
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.path(evidence)
        Record(kind="evidence", content=content, metadata=metadata).save(path)
        return path

    def path(self, evidence: Callable[[], Any]) -> Path:
        """Return the file of some evidence, named by the last parts of module and function."""
        return self.folder / f"{root_of(evidence).rpartition('.')[2].replace(':', '.')}.json"

    def _code(self, evidence: Callable[[], Any]) -> Code:
        """Return the code that evidence depends on, as it is now."""
        root = root_of(evidence)
        return Code(modules=(root,), digest=digest_of_code([root], self.packages, SHOWN))


def root_of(evidence: Callable[[], Any]) -> str:
    """Return where evidence is computed, as ``package.module:function``."""
    return f"{evidence.__module__}:{evidence.__qualname__}"
