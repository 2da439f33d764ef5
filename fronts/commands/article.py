"""``fronts article``: a replication article of two pages, from the report of a check."""

from __future__ import annotations

import json
from pathlib import Path

from fronts.answer import Answer, UsageError
from fronts.options import Folder

EXAMPLE = """examples:
  fronts article --report report --out article   metadata.yaml, content.tex and the rest

The report must contain all claims, as written by 'fronts check --out report'.

The files are those required by ReScience C; 'pdflatex article.tex' works without its template."""


def article(*, report: Folder = Path("report"), out: Folder = Path("article")) -> Answer:
    """Read the report and write the article.

    Parameters
    ----------
    report : folder, optional
        Folder written by 'fronts check --out'.
    out : folder, optional
        Folder in which the article is written.
    """
    from paper_checks.report.article import article as written_from

    source = report / "report.json"
    if not source.is_file():
        raise UsageError(
            f"{source} is not there: run 'fronts check --out {report}' first.",
            quantity="--report",
            value=report,
        )
    try:
        found = json.loads(source.read_text(encoding="utf-8"))
    except ValueError:
        raise UsageError(f"{source} is not JSON: run 'fronts check --out' again.") from None
    written = written_from(found, out)
    return Answer(
        payload={"files": [str(path) for path in written]},
        text="\n".join(f"written: {path}" for path in written),
    )
