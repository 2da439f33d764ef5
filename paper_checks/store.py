"""Findings kept on disk, so that an interrupted run can be resumed."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import logging
import os
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path

from paper_checks.claim import Erratum, Fault, Finding, Formula, Picture, Verdict
from paper_checks.outcome import Judgement

SOURCES = ("theory", "derivations", "verification", "paper_checks")
"""Packages whose code a finding may depend on."""

logger = logging.getLogger(__name__)


def source_hash(packages: Iterable[str] = SOURCES) -> str:
    """Digest of all Python files of some packages, independent of where they are installed."""
    digest = hashlib.sha256()
    for package in packages:
        spec = importlib.util.find_spec(package)
        for folder in sorted(spec.submodule_search_locations or ()) if spec else ():
            root = Path(folder)
            for path in sorted(root.rglob("*.py")):
                name = f"{package}/{path.relative_to(root).as_posix()}"
                content = path.read_bytes()
                digest.update(f"{name}\0{len(content)}\0".encode())
                digest.update(content)
    return digest.hexdigest()


def write_text(path: Path, text: str) -> None:
    """Write a file so that it is there whole or not at all."""
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        part.write_text(text, encoding="utf-8", newline="\n")
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


@dataclass(frozen=True)
class Store:
    """A folder with one JSON file a claim.

    Attributes
    ----------
    folder : Path
        Where the files are; it exists.
    source : str
        Digest of the code, see `source_hash`.
    versions : mapping
        Versions of Python and of the packages used.
    """

    folder: Path
    source: str
    versions: Mapping[str, str | None]

    def fingerprint(self, key: str) -> str:
        """Digest of all that a stored judgement may depend on."""
        parts = [key, self.source, sorted(self.versions.items())]
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()

    def load(self, key: str) -> Judgement | None:
        """Read the stored judgement of a claim; None if there is none that can be trusted."""
        path = self._path(key)
        try:
            stored = json.loads(path.read_text(encoding="utf-8"))
            if stored["fingerprint"] != self.fingerprint(key):
                logger.info("the stored finding of %s is stale", key)
                return None
            if stored["digest"] != digest_of(stored["judgement"]):
                raise ValueError("digest")
            return judgement_from(stored["judgement"])
        except FileNotFoundError:
            return None
        except (OSError, ValueError, KeyError, TypeError):
            logger.info("the stored finding of %s is damaged and is ignored", key)
            return None

    def save(self, key: str, judgement: Judgement) -> None:
        """Keep a judgement; failed ones are not kept, so that a resumed run tries again."""
        path = self._path(key)
        if judgement.finding is None:
            path.unlink(missing_ok=True)
            return
        record = asdict(judgement)
        stored = {
            "fingerprint": self.fingerprint(key),
            "digest": digest_of(record),
            "judgement": record,
        }
        write_text(path, json.dumps(stored))

    def _path(self, key: str) -> Path:
        return self.folder / f"{key}.json"


def digest_of(record: object) -> str:
    """Return a digest of plain data."""
    return hashlib.sha256(json.dumps(record, sort_keys=True).encode()).hexdigest()


def judgement_from(record: dict[str, object]) -> Judgement:
    """Rebuild a judgement from plain data; it is marked as stored."""
    fields = record["finding"]
    if not isinstance(fields, dict):
        raise TypeError("finding")
    finding = Finding(
        **{
            **fields,
            "verdict": Verdict(fields["verdict"]),
            "methods": tuple(fields["methods"]),
            "remarks": tuple(fields["remarks"]),
            "pictures": tuple(Picture(**picture) for picture in fields["pictures"]),
            "formulas": tuple(Formula(**formula) for formula in fields["formulas"]),
            "erratum": _erratum(fields["erratum"]),
        }
    )
    return Judgement(
        finding,
        None,
        float(str(record["seconds"])),
        str(record["judged"]),
        True,
        shared=float(str(record.get("shared", 0.0))),
    )


def _erratum(fields: dict[str, str] | None) -> Erratum | None:
    if fields is None:
        return None
    rest = {name: text for name, text in fields.items() if name != "fault"}
    return Erratum(Fault(fields["fault"]), **rest)
