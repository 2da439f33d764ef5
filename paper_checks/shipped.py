"""Findings of expensive claims that come with the toolkit, for the quick run.

``fronts check --full --record`` writes them into ``paper_checks/findings``. Each carries the
command that reproduces it, the versions and the machine it was found with, its date, and a
fingerprint of the code it depends on: the files that the claim's module imports, directly or
through others. Parameters are part of that code. Versions of other packages are shown but not
part of the fingerprint. A finding whose fingerprint no longer fits is stale.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Collection, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from paper_checks.discover import Entry
from paper_checks.imports import digest
from paper_checks.outcome import Judgement, Provenance
from paper_checks.store import digest_of, judgement_from, write_text

FOLDER = Path(__file__).parent / "findings"

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
    """

    folder: Path
    package: str
    packages: Collection[str]

    def fingerprint(self, entry: Entry) -> str:
        """Return a digest of the claim's key and of the code its module depends on."""
        return digest_of(
            [entry.claim.key, digest([f"{self.package}.{entry.group}"], self.packages)]
        )

    def load(self, entry: Entry) -> Judgement | None:
        """Return the shipped judgement of an expensive claim, to be shown as stored.

        Returns
        -------
        Judgement or None
            None if the claim is not expensive, there is no finding or it is damaged, or it is
            stale and cheap. Its ``provenance`` says whether it is stale.
        """
        if not entry.claim.expensive:
            return None
        key = entry.claim.key
        try:
            held = json.loads((self.folder / f"{key}.json").read_text(encoding="utf-8"))
            if held["digest"] != digest_of(held["judgement"]):
                raise ValueError("digest")
            judgement = judgement_from(held["judgement"])
            stale = held["fingerprint"] != self.fingerprint(entry)
            provenance = Provenance(held["command"], held["versions"], held["machine"], stale)
        except FileNotFoundError:
            return None
        except (OSError, ValueError, KeyError, TypeError):
            logger.info("the shipped finding of %s is damaged and is ignored", key)
            return None
        if stale and judgement.seconds < CHEAP:
            logger.info("the shipped finding of %s is stale and is computed anew", key)
            return None
        return replace(judgement, provenance=provenance)

    def record(
        self,
        entry: Entry,
        judgement: Judgement,
        versions: Mapping[str, str | None],
        machine: Mapping[str, object],
    ) -> Path:
        """Write the judgement of an expensive claim that was computed in this run.

        Raises
        ------
        OSError
            If the folder takes no files, as that of an installed package may not.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        record = asdict(replace(judgement, stored=False, provenance=None))
        held = {
            "command": f"fronts check {entry.claim.key} --full --record",
            "versions": dict(versions),
            "machine": dict(machine),
            "fingerprint": self.fingerprint(entry),
            "digest": digest_of(record),
            "judgement": record,
        }
        path = self.folder / f"{entry.claim.key}.json"
        write_text(path, json.dumps(held, indent=1, ensure_ascii=False) + "\n")
        return path
