"""What a subcommand returns: one payload for ``--json``, one text for people."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass


class UsageError(ValueError):
    """A command line that cannot be carried out.

    Parameters
    ----------
    message : str
        One sentence.
    details : object
        Of ``quantity``, ``value``, ``allowed``, ``remedy`` those that are known, for ``--json``.
    """

    def __init__(self, message: str, **details: object) -> None:
        self.details = {name: str(value) for name, value in details.items()}
        super().__init__(message)


@dataclass(frozen=True)
class Answer:
    """The result of a subcommand.

    Attributes
    ----------
    payload : mapping
        Printed as one JSON object with ``--json``; finite numbers, strings, lists, null only.
    text : str
        Printed otherwise.
    exit_code : int
        0 unless the command found something that the caller must notice.
    """

    payload: Mapping[str, object]
    text: str
    exit_code: int = 0
