"""The record: a result that is stored to be read later, with its provenance."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from theory.parameters import ParameterError
from verification.execution.digest import digest_of
from verification.execution.files import file_error, write_json
from verification.execution.metadata import Metadata

FORMAT = 3
"""Format of the file; files in another format are refused."""

_METADATA = ("command", "parameters", "versions", "code", "machine", "date")
_OWN = ("kind", "format", "checksum", *_METADATA)


@dataclass(frozen=True, kw_only=True)
class Record:
    """A stored result.

    How to store a new kind of result:

    1. Make it plain: numbers, words, lists and mappings, without NaN. This is the ``content``; its
       keys must not be those of the metadata.
    2. Name its ``kind`` in one word, which is compared with that in the file when it is read.
    3. Give `Metadata` its command and parameters, and `Code.of` the modules it came from.
    4. `save` it; `load` it again, which refuses a file that cannot be used, in one sentence.
       `verification.execution.metadata.staleness` states whether its code is the present one; the
       caller decides what to do if it is not (compute anew, show with a remark, refuse).

    Attributes
    ----------
    kind : str
        What is stored, in one word.
    content : mapping
        The result itself.
    metadata : Metadata
        Its provenance.
    """

    kind: str
    content: Mapping[str, Any]
    metadata: Metadata = field(default_factory=Metadata)

    def to_dict(self) -> dict[str, Any]:
        """Return the record as JSON data, with metadata and content side by side.

        Raises
        ------
        ValueError
            If the content uses a key of the metadata.
        """
        clash = sorted({*self.content} & {*_OWN})
        if clash:
            raise ValueError(f"the content has keys of the metadata: {', '.join(clash)}.")
        written = {"kind": self.kind, "format": FORMAT, **self.metadata.to_dict(), **self.content}
        body: dict[str, Any] = json.loads(json.dumps(written, allow_nan=False))  # as it is read
        return body | {"checksum": digest_of(body)}

    def save(self, path: Path) -> None:
        """Write the record, completely or not at all.

        Raises
        ------
        FileError
            If the file cannot be written.
        """
        write_json(path, self.to_dict())

    @classmethod
    def load(cls, path: Path, kind: str) -> Record:
        """Read a record.

        Raises
        ------
        FileError
            If the file cannot be read.
        ParameterError
            If it is not a record of that kind and format, or has been altered.
        """
        try:
            body = json.loads(path.read_bytes())
        except OSError as error:
            raise file_error(path, error, "read") from None
        except (ValueError, RecursionError):
            body = None
        return cls.from_dict(body, kind, path)

    @classmethod
    def from_dict(cls, body: object, kind: str, source: object = "given") -> Record:
        """Return the record that `to_dict` produced; errors as in `load`."""
        remedy = "remove it, and compute the result again"
        if not isinstance(body, dict) or "kind" not in body:
            raise ParameterError("record", source, "a record written by this toolkit", remedy)
        if body["kind"] != kind or body.get("format") != FORMAT:
            raise ParameterError(
                "record", source, f"of the kind '{kind}' in format {FORMAT}", remedy
            )
        entries = {name: value for name, value in body.items() if name != "checksum"}
        try:
            if digest_of(entries) != body.get("checksum"):
                raise ValueError("checksum")
            metadata = Metadata.from_dict(entries)
        except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
            raise ParameterError("record", source, "as it was written", remedy) from None
        content = {name: value for name, value in entries.items() if name not in _OWN}
        return cls(kind=kind, content=content, metadata=metadata)
