"""The outcome of the changes: noticed, explained in ``explained/``, or open.

Changes for which no test was run, because all tests that enter the changed code exceed the time
limit of a test, are also open. They are counted separately, and call for a higher limit or faster
tests.
"""

from __future__ import annotations

import json
import subprocess
import tomllib
from collections.abc import Collection, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from benchmarks.mutation.mutants import Mutant

KILLED, SURVIVED, UNREACHED = "killed", "survived", "unreached"
"""A test fails; none fails; no test within the time limit enters the changed code."""


EXPLAINED = Path(__file__).with_name("explained")
"""Folder of the explanations; those of a package or of one of its folders are in one file."""


def read_explained() -> dict[str, str]:
    """Return the reasons why changes need not be noticed, by name or by pattern of names."""
    texts = [path.read_text(encoding="utf-8") for path in sorted(EXPLAINED.rglob("*.toml"))]
    entries = [entry for text in texts for entry in tomllib.loads(text)["explained"]]
    return {form: entry["why"] for entry in entries for form in entry["changes"]}


def source_digest(root: Path, module: str) -> str:
    """Return a digest of a module's file."""
    from verification.execution.digest import digest_of_files

    return digest_of_files(root, [root / module])


def still_known(
    record: Mapping[str, Any], mutants: Sequence[Mutant], root: Path, explained: Collection[str]
) -> dict[str, str]:
    """Return the outcomes in an earlier record of changes whose module has not been edited since.

    Changes that were left open, left out or not run, and changes whose explanation has since been
    withdrawn are not included.
    """
    sources = record.get("sources", {})
    same = {
        module
        for module in dict.fromkeys(mutant.module for mutant in mutants)
        if sources.get(module) == source_digest(root, module)
    }
    withdrawn = (n for n in record["explained"] if not any(matches(form, n) for form in explained))
    left = (*record["selection"].get("left_out", ()), *record["not_run"])
    unknown = {*record["open"], *left, *withdrawn}
    return {
        mutant.name: SURVIVED if mutant.name in record["explained"] else KILLED
        for mutant in mutants
        if mutant.module in same and mutant.name not in unknown
    }


def matches(form: str, name: str) -> bool:
    """Return whether a name matches a pattern, in which a final ``...`` stands for anything.

    Examples
    --------
    >>> matches("m.py:f:2 ...", "m.py:f:2 -> 3 #2"), matches("m.py:f:...", "m.py:g:2 -> 3")
    (True, False)
    """
    return name.startswith(form[:-3]) if form.endswith("...") else name == form


class MutationOutcome:
    """The outcome of the chosen changes.

    Parameters
    ----------
    mutants : sequence of Mutant
        The chosen changes.
    found : mapping
        `KILLED`, `SURVIVED` or `UNREACHED`, by the name of each change that was run.
    explained : mapping
        Reasons, by patterns of names.

    Attributes
    ----------
    why : dict
        For each change that no test noticed, the reason why none needs to; None if there is none.
    """

    def __init__(
        self, mutants: Sequence[Mutant], found: Mapping[str, str], explained: Mapping[str, str]
    ) -> None:
        self.mutants, self.found, self._explained = mutants, found, explained
        self.why = {
            m.name: next((explained[form] for form in explained if matches(form, m.name)), None)
            for m in mutants
            if found.get(m.name) in (SURVIVED, UNREACHED)
        }

    @property
    def open(self) -> list[Mutant]:
        """The changes that are neither noticed nor explained."""
        return [m for m in self.mutants if m.name in self.why and self.why[m.name] is None]

    @property
    def unnoticed(self) -> list[Mutant]:
        """The open changes for which tests were run."""
        return [mutant for mutant in self.open if self.found[mutant.name] == SURVIVED]

    @property
    def unreached(self) -> list[Mutant]:
        """The open changes for which no test was run, since all that enter them take too long."""
        return [mutant for mutant in self.open if self.found[mutant.name] == UNREACHED]

    @property
    def stale(self) -> list[str]:
        """The explanations for these modules that match no unnoticed change."""
        modules = {mutant.module for mutant in self.mutants}
        return [
            form
            for form in self._explained
            if form.split(":")[0] in modules and not any(matches(form, name) for name in self.why)
        ]

    def counts(self) -> dict[str, dict[str, int]]:
        """Return the counts for each module and for all together."""
        modules = dict.fromkeys(mutant.module for mutant in self.mutants)
        parts = {module: [m for m in self.mutants if m.module == module] for module in modules}
        return {name: self._count(part) for name, part in {**parts, "all": self.mutants}.items()}

    def _count(self, mutants: Sequence[Mutant]) -> dict[str, int]:
        ran = [mutant.name for mutant in mutants if mutant.name in self.found]
        missed = [name for name in ran if name in self.why]
        left = [name for name in missed if self.why[name] is None]
        return {
            "chosen": len(mutants),
            "run": len(ran),
            "noticed": len(ran) - len(missed),
            "explained": len(missed) - len(left),
            "open": len(left),
            "unreached": sum(self.found[name] == UNREACHED for name in left),
        }

    def __str__(self) -> str:
        """Format the counts, with a line for each module, and list the open changes."""
        lines = [f"{'module':44}" + "".join(f"{word:>10}" for word in self.counts()["all"])]
        for name, row in self.counts().items():
            lines.append(f"{name:44}" + "".join(f"{count:10}" for count in row.values()))
        for m in self.open:
            word = "NOT REACHED" if self.found[m.name] == UNREACHED else "NOT NOTICED"
            lines.append(f"{word} {m.module}:{m.line} {m.function}: {m.change}")
        return "\n".join(lines)

    def write(
        self,
        path: Path,
        root: Path,
        selection: Mapping[str, Any],
        runs: Sequence[Mapping[str, Any]],
    ) -> None:
        """Write the selection, the runs and this outcome to a file as JSON."""
        record = {
            "selection": selection,
            "runs": runs,
            "sources": {m.module: source_digest(root, m.module) for m in self.mutants},
            "counts": self.counts(),
            "explained": {name: why for name, why in self.why.items() if why},
            "open": [mutant.name for mutant in self.open],
            "unreached": [mutant.name for mutant in self.unreached],
            "not_run": [m.name for m in self.mutants if m.name not in self.found],
        }
        path.write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def stamp(root: Path) -> dict[str, str | None]:
    """Return the current time and the commit of the project."""
    git = ["git", "-C", str(root), "describe", "--always", "--dirty", "--abbrev=40"]
    done = subprocess.run(git, capture_output=True, text=True, check=False, timeout=30)
    return {
        "date": datetime.now().isoformat(" ", "minutes"),
        "commit": done.stdout.strip() or None,
    }
