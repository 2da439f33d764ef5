"""What a run of the changes found, as a file: counts by module, and what no test noticed."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from benchmarks.mutation.mutants import Mutant


def counts(
    mutants: Sequence[Mutant], found: Mapping[str, str], reasons: Mapping[str, str | None]
) -> dict[str, int]:
    """Count the changes chosen, run, noticed, explained and left open.

    Examples
    --------
    >>> from benchmarks.mutation.mutants import mutants_of
    >>> some = mutants_of("m.py", "def f(x): return 3 * x + 1")
    >>> found = {some[0].name: "killed", some[1].name: "survived"}
    >>> counts(some, found, {some[1].name: None})
    {'chosen': 6, 'run': 2, 'noticed': 1, 'explained': 0, 'open': 1, 'not_run': 4}
    """
    ran = [mutant.name for mutant in mutants if mutant.name in found]
    missed = [name for name in ran if found[name] == "survived"]
    open_ = sum(reasons[name] is None for name in missed)
    return {
        "chosen": len(mutants),
        "run": len(ran),
        "noticed": len(ran) - len(missed),
        "explained": len(missed) - open_,
        "open": open_,
        "not_run": len(mutants) - len(ran),
    }


def write_record(
    path: Path,
    root: Path,
    *,
    command: str,
    mutants: Sequence[Mutant],
    found: Mapping[str, str],
    reasons: Mapping[str, str | None],
) -> None:
    """Write the outcome whole: command, date, commit, counts, and each change not noticed."""
    by_module = {
        module: counts([m for m in mutants if m.module == module], found, reasons)
        for module in dict.fromkeys(mutant.module for mutant in mutants)
    }
    missed = [m.name for m in mutants if found.get(m.name) == "survived"]
    record: dict[str, Any] = {
        "command": command,
        "date": datetime.now().isoformat(" ", "minutes"),
        "commit": _git(root, "rev-parse", "HEAD"),
        "uncommitted": bool(_git(root, "status", "--porcelain", "--untracked-files=no")),
        "total": counts(mutants, found, reasons),
        "modules": by_module,
        "explained": {name: reasons[name] for name in missed if reasons[name] is not None},
        "open": [name for name in missed if reasons[name] is None],
    }
    from verification.execution.files import write_text

    write_text(path, json.dumps(record, indent=1, ensure_ascii=False) + "\n")


def _git(root: Path, *words: str) -> str | None:
    done = subprocess.run(
        ["git", *words], cwd=root, capture_output=True, text=True, check=False, timeout=30
    )
    return done.stdout.strip() if done.returncode == 0 else None
