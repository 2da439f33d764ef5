"""Changes that no test need notice, each with its reason, in ``explained.toml``."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from benchmarks.mutation.mutants import Mutant


@dataclass(frozen=True)
class Explained:
    """Forms of names and their reasons; ``...`` at the end of a form stands for anything."""

    reasons: Mapping[str, str]

    def why(self, name: str) -> str | None:
        """Return the reason why a change may go unnoticed; None if there is none."""
        return next((why for form, why in self.reasons.items() if matches(form, name)), None)


def matches(form: str, name: str) -> bool:
    """Return whether a name has the form.

    Examples
    --------
    >>> matches("m.py:f:2 ...", "m.py:f:2 -> 3 #2"), matches("m.py:f:...", "m.py:g:2 -> 3")
    (True, False)
    """
    return name.startswith(form[:-3]) if form.endswith("...") else name == form


def read_explained(path: Path) -> Explained:
    """Read the list: ``[[explained]]`` with ``changes`` (names or forms) and ``why``."""
    content = tomllib.loads(path.read_text(encoding="utf-8"))
    reasons: dict[str, str] = {}
    for entry in content.get("explained", []):
        for form in entry["changes"]:
            reasons[form] = entry["why"]
    return Explained(reasons)


def stale_entries(
    explained: Explained, mutants: Sequence[Mutant], found: Mapping[str, str]
) -> list[str]:
    """Return the entries about these modules that match no change which still goes unnoticed."""
    modules = {mutant.module for mutant in mutants}
    survivors = [name for name, status in found.items() if status == "survived"]
    return [
        form
        for form in explained.reasons
        if form.split(":")[0] in modules and not any(matches(form, name) for name in survivors)
    ]
