"""``fronts article``: the replication article of two pages, from the report of a run."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from fronts.answer import Answer, UsageError

EXAMPLE = """examples:
  fronts article --report report --out article   metadata.yaml, content.tex and the rest

The report is that of all claims, as 'fronts check --out report' writes it.

The files are those of ReScience C; 'pdflatex article.tex' sets them without its template."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options of ``fronts article``."""
    parser.add_argument(
        "--report", type=Path, default=Path("report"), metavar="DIR",
        help="folder that 'fronts check --out' has written (default report)",
    )  # fmt: skip
    parser.add_argument(
        "-o", "--out", type=Path, default=Path("article"), metavar="DIR",
        help="folder of the article (default article)",
    )  # fmt: skip


def run(options: argparse.Namespace) -> Answer:
    """Read the report and write the article."""
    from paper_checks.report.article import article

    source = options.report / "report.json"
    if not source.is_file():
        raise UsageError(
            f"{source} is not there: run 'fronts check --out {options.report}' first.",
            quantity="--report",
            value=options.report,
        )
    try:
        report = json.loads(source.read_text(encoding="utf-8"))
    except ValueError:
        raise UsageError(f"{source} is not JSON: run 'fronts check --out' again.") from None
    written = article(report, options.out)
    return Answer(
        payload={"files": [str(path) for path in written]},
        text="\n".join(f"written: {path}" for path in written),
    )
