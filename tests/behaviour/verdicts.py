"""Compare the verdict and value of every claim with those recorded, for people to read.

    python -m tests.behaviour.verdicts                 judge every claim (some minutes), compare
    python -m tests.behaviour.verdicts report.json     compare those of a report
    python -m tests.behaviour.verdicts --record [report.json]

Exit code 1 if a verdict is another one, or a claim is gone. A value that reads differently is only
shown: some are run times.
"""

from __future__ import annotations

import contextlib
import io
import json
import sys
from pathlib import Path

from fronts.cli import main as fronts
from tests.behaviour.replay import VERDICTS, Json, same_sentence

FIELDS = ("verdict", "value", "error")


def _claims(report: str) -> dict[str, Json]:
    claims = json.loads(report)["claims"]
    return {claim["key"]: {field: claim[field] for field in FIELDS} for claim in claims}


def _report(words: list[str]) -> str:
    if words:
        return Path(words[0]).read_text(encoding="utf-8")
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        fronts(["check", "--json"])
    return out.getvalue()


def _compare(before: dict[str, Json], after: dict[str, Json]) -> int:
    """Print every difference; return how many verdicts differ."""
    other = 0
    for key, was in before.items():
        now = after.get(key, dict.fromkeys(FIELDS, "gone"))
        other += was["verdict"] != now["verdict"]
        for field in FIELDS:
            if was[field] != now[field] and not same_sentence(str(was[field]), str(now[field])):
                print(f"{key}, {field}\n  was {was[field]}\n  now {now[field]}")
    for key in after.keys() - before.keys():
        print(f"{key} is new: {after[key]['verdict']}")
    print(f"{len(before)} claims recorded, {other} verdicts differ.")
    return other


def main(words: list[str]) -> int:
    """Compare, or record, and return the exit code."""
    record = "--record" in words
    claims = _claims(_report([word for word in words if word != "--record"]))
    if not record:
        return 1 if _compare(json.loads(VERDICTS.read_text(encoding="utf-8")), claims) else 0
    lines = (
        f"{json.dumps(key)}: {json.dumps(one, ensure_ascii=False)}" for key, one in claims.items()
    )
    VERDICTS.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
