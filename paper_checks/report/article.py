"""A two-page replication article, as required by ReScience C, written from ``report.json``.

``metadata.yaml``, ``content.tex`` and ``bibliography.bib`` are the input of the journal's template;
``article.tex`` typesets the same text independently. Counts, verdicts, reasons and errata are taken
from the report; no result of a run is typed here.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined, UndefinedError

from paper_checks.claim import Fault, Verdict
from paper_checks.report.inline_math import in_latex
from theory.parameters import ParameterError
from verification.execution.files import write_text

FILES = ("metadata.yaml", "content.tex", "bibliography.bib", "article.tex")
"""Files that are written; a template of each is next to this module."""

MAX_ROWS = 12
"""Largest number of rows of a table, so that the article fits on two pages."""


_WRITTEN = "a report.json written by 'fronts check --out'"
_REMEDY = "run 'fronts check --out report'"


def article(report: Mapping[str, Any], folder: Path) -> tuple[Path, ...]:
    """Write the article of a report.

    Parameters
    ----------
    report : mapping
        The content of ``report.json`` from a run of all claims.
    folder : Path
        Folder for the files; created if it does not exist.

    Returns
    -------
    tuple of Path
        The files written.

    Raises
    ------
    ParameterError
        If claims are missing from the report, or it has another content.
    FileError
        If a file cannot be written.
    """
    try:
        judged, available = len(report["claims"]), int(report["claims_available"])
        known = _content(report)
        texts = {name: _text(name, known) for name in FILES}
    except (KeyError, TypeError, ValueError, UndefinedError):
        raise ParameterError("report", "a file of another content", _WRITTEN, _REMEDY) from None
    if judged < available:
        raise ParameterError("claims of the report", judged, f"all {available}", _REMEDY)
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in texts.items():
        write_text(folder / name, text)
    return tuple(folder / name for name in texts)


def _text(name: str, known: Mapping[str, Any]) -> str:
    template = files(__package__).joinpath(f"{name}.j2").read_text(encoding="utf-8")
    return _templates().from_string(template).render(known)


def _content(report: Mapping[str, Any]) -> dict[str, Any]:
    claims = report["claims"]
    others = {Verdict.REPRODUCED, Verdict.CORRECTED, Verdict.UNTESTABLE}
    differ = [each for each in claims if each["verdict"] not in others]
    differ.sort(key=lambda each: each["verdict"] != Verdict.NOT_REPRODUCED)
    return {
        "counts": report["counts"],
        "claims": len(claims),
        "equations": sum(each["group"] == "equations" for each in claims),
        "two": sum(len(each["methods"]) == 2 for each in claims),
        "differ": differ,
        "shown": differ[:MAX_ROWS],
        "errata": [each for each in report["errata"] if each["fault"] == Fault.MISPRINT],
        "errata_of_all": len(report["errata"]),
        "versions": report["versions"],
        "machine": report["machine"],
        "date": report["created"][:10],
        "source": report["source"][:12],
    }


def _templates() -> Environment:
    """Return an environment whose delimiters do not clash with those of LaTeX."""
    made = Environment(
        variable_start_string="<<",
        variable_end_string=">>",
        block_start_string="<%",
        block_end_string="%>",
        comment_start_string="<#",
        comment_end_string="#>",
        trim_blocks=True,
        undefined=StrictUndefined,
        autoescape=False,  # LaTeX and YAML; the filter escapes
    )
    made.filters["tex"] = in_latex
    return made
