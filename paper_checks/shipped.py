"""Evidence of expensive claims that is shipped with the toolkit, for the quick run.

``fronts check --record`` writes what is missing or stale into ``paper_checks/findings``, and
``--full --record`` writes all of it: one file for each function that computes evidence, for all
claims based on it. The rule, the text and the figures of a claim are applied to it anew in every
run. Evidence is stale if the code of the claim's module, or of a module that it imports, has
changed; parameters are part of that code. Each file contains the command that reproduces it, the
date, and the versions and machine used, which are shown but make nothing stale.
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
"""Modules that only display results and do not change them; this one loads pictures by a computed
name, which would include its whole package."""

CHEAP = 60.0
"""Run time in seconds below which stale evidence is computed anew even in the quick run."""

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Shipped:
    """The folder of shipped evidence.

    Attributes
    ----------
    folder : Path
        Folder with one JSON file for each function that computes evidence.
    packages : collection of str
        Top-level packages whose code counts.
    renew : bool
        Whether all stale evidence is computed anew, however long this takes.
    """

    folder: Path
    packages: Collection[str]
    renew: bool = False

    def load(self, entry: Entry) -> Judgement | None:
        """Judge an expensive claim by the shipped evidence, to be shown as stored.

        Returns
        -------
        Judgement or None
            None if the claim is not expensive, or its evidence is missing, damaged, or both stale
            and cheap. Its ``provenance`` states whether it is stale.
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
            If the folder is not writable, as may be the case for an installed package.
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
        """Return the file for some evidence, named by the last parts of module and function."""
        return self.folder / f"{root_of(evidence).rpartition('.')[2].replace(':', '.')}.json"

    def _code(self, evidence: Callable[[], Any]) -> Code:
        """Return the present code on which evidence depends."""
        root = root_of(evidence)
        return Code(modules=(root,), digest=digest_of_code([root], self.packages, SHOWN))


def root_of(evidence: Callable[[], Any]) -> str:
    """Return where evidence is computed, as ``package.module:function``."""
    return f"{evidence.__module__}:{evidence.__qualname__}"
