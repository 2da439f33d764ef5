"""The answer of a subcommand: a payload for ``--json`` and a text for readers."""

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
        Those of ``quantity``, ``value``, ``allowed`` and ``remedy`` that are known, for ``--json``.
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
        Printed as one JSON object with ``--json``; contains only finite numbers, strings, lists
        and null.
    text : str
        Printed without ``--json``.
    exit_code : int
        0 unless the command found something that needs attention.
    """

    payload: Mapping[str, object]
    text: str
    exit_code: int = 0
