"""Findings of expensive claims that come with the toolkit, for the quick run.

``fronts check --record`` writes those that are missing or stale into ``paper_checks/findings``,
``--full --record`` all of them. Each carries the
command that reproduces it, the versions and the machine it was found with, its date, and a
fingerprint of the code it depends on: the files that the claim's module imports, directly or
through others. Parameters are part of that code. Versions of other packages are shown but not
part of the fingerprint. A finding whose fingerprint no longer fits is stale.
"""

from __future__ import annotations

import logging
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from paper_checks.discover import Entry
from paper_checks.outcome import Judgement, Provenance
from paper_checks.stored_judgement import judgement_from, plain_judgement
from theory.parameters import ParameterError
from verification.execution.digest import digest_of_code
from verification.execution.metadata import Code, Metadata
from verification.execution.record import Record

FOLDER = Path(__file__).parent / "findings"

SHOWN = (
    "theory.result", "paper_checks.report.pictures", "paper_checks.report.data_table",
    "paper_checks.report.state_picture", "paper_checks.report.velocity_plot",
)  # fmt: skip
"""Modules that show what was found and change nothing of it: they do not make a finding stale.

The base of results is one: it loads pictures by name, and would bring in all of its package."""

CHEAP = 60.0
"""Seconds. A stale finding that took less than this is computed anew even in the quick run."""

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Shipped:
    """The folder of shipped findings.

    Attributes
    ----------
    folder : Path
        One JSON file a claim.
    package : str
        Dotted name of the package that holds the claims.
    packages : collection of str
        Top-level packages whose code may matter.
    renew : bool
        Whether every stale finding is computed anew, however long it takes.
    """

    folder: Path
    package: str
    packages: Collection[str]
    renew: bool = False

    def load(self, entry: Entry) -> Judgement | None:
        """Return the shipped judgement of an expensive claim, to be shown as stored.

        Returns
        -------
        Judgement or None
            None if the claim is not expensive, there is no finding or it is damaged, or it is
            stale and cheap. Its ``provenance`` says whether it is stale.
        """
        key = entry.claim.key
        path = self.folder / f"{key}.json"
        if not entry.claim.expensive or not path.exists():
            return None
        try:
            record = Record.load(path, "finding")
            if record.metadata.parameters["claim"] != key:
                raise ValueError("claim")
            judgement = judgement_from(record.content["judgement"])
        except (OSError, ParameterError, ValueError, KeyError, TypeError):
            logger.info("the shipped finding of %s is damaged and is ignored", key)
            return None
        metadata = record.metadata
        stale = metadata.code != self._code(entry)
        if stale and (self.renew or judgement.seconds < CHEAP):
            logger.info("the shipped finding of %s is stale and is computed anew", key)
            return None
        provenance = Provenance(metadata.command, metadata.versions, metadata.machine, stale)
        return replace(judgement, provenance=provenance)

    def record(
        self, entry: Entry, judgement: Judgement, versions: Mapping[str, str | None]
    ) -> Path:
        """Write the judgement of an expensive claim that was computed in this run.

        Raises
        ------
        OSError
            If the folder takes no files, as that of an installed package may not.
        """
        key = entry.claim.key
        metadata = Metadata(
            command=f"fronts check {key} --full --record",
            parameters={"claim": key},
            versions=versions,
            code=self._code(entry),
        )
        content = {"judgement": plain_judgement(judgement)}
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.folder / f"{key}.json"
        Record(kind="finding", content=content, metadata=metadata).save(path)
        return path

    def _code(self, entry: Entry) -> Code:
        """Return the code that a finding depends on, as it is now."""
        module = f"{self.package}.{entry.group}"
        return Code(modules=(module,), digest=digest_of_code([module], self.packages, SHOWN))
