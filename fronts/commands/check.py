"""``fronts check``: judge the claims of the paper and write the report."""

from __future__ import annotations

import json
import logging
import os
import shutil
import tempfile
import time
from collections.abc import Sequence
from contextlib import nullcontext
from functools import partial
from pathlib import Path

from fronts.answer import Answer, UsageError
from fronts.arguments import check_writable
from fronts.interrupted import resumable
from fronts.options import Folder, refuse_beside
from fronts.output import with_table
from paper_checks import discover
from paper_checks.claim import Verdict
from paper_checks.outcome import JudgedClaim, slug
from paper_checks.report.document import (
    PACKAGES,
    Report,
    make_report,
    picture_files,
    pictures_listed,
    to_json,
)
from paper_checks.report.table import duration, entries_as_text
from paper_checks.report.terminal import report_as_text
from paper_checks.run import run as judge_all
from paper_checks.shipped import FOLDER, Shipped
from theory.parameters import count_within
from verification.execution.digest import digest_of_packages
from verification.execution.files import write_text
from verification.execution.imports import SOURCES
from verification.execution.metadata import installed_versions
from verification.execution.progress import Progress
from verification.execution.store import Store

EXAMPLE = """\
examples:
  fronts check                           all claims: counts and headlines
  fronts check fig17 --out report        the claims of one module, with report/index.html
  fronts check --verdict not-reproduced  the claims with this recorded verdict
  fronts check --out report --resume     continue an interrupted run
  fronts check --full --jobs 2           compute the expensive claims too
  fronts check --record --jobs 2         renew the stored findings whose code has changed

exit code: 0 if every verdict is as recorded, 1 if a verdict has changed, 2 for invalid input"""

STORE = ".evidence.sqlite"
"""File in the folder of a report that stores the evidence found so far."""
MAX_WORKERS = 256
TABLES = (".csv", ".json", ".npz")
"""Endings of files for the verdicts, as an alternative to a folder for the report."""


def check(
    *key: str,
    verdict: str | None = None,
    out: Folder | None = None,
    workers: int | None = None,
    resume: bool = False,
    full: bool = False,
    record: bool = False,
    listing: bool = False,
    quiet: bool,
) -> Answer:
    """Judge the chosen claims, and write the report if requested.

    Parameters
    ----------
    *key : str
        A claim or a module of claims.
    verdict : str, optional
        Only claims with this recorded verdict: reproduced, corrected, partial, not-reproduced,
        untestable.
    out : folder, optional
        Folder for the report; or a file ending in .csv, .json or .npz for the verdicts.
    workers : int, optional
        Number of processes (default 1, so that claims about run times are judged undisturbed).
    resume : bool, optional
        Use the evidence that an earlier run of the same code has stored in DIR.
    full : bool, optional
        Compute everything, without the stored findings that come with the toolkit.
    record : bool, optional
        Compute the expensive claims whose stored finding is missing or stale, or with --full all
        of them, and store the findings in the toolkit.
    listing : bool, optional
        List the claims without judging them.
    quiet : bool, optional
        Outside a terminal, print no line for each claim.
    """
    if os.environ.get("FRONTS_TRACEBACK"):
        logging.basicConfig(level=logging.INFO)
        logging.getLogger("matplotlib").setLevel(logging.WARNING)
    jobs = 1 if workers is None else count_within("--workers", workers, 1, MAX_WORKERS)
    every = discover.find_entries()
    if not every:
        raise UsageError(f"no claims were found in {discover.PACKAGE}: the installation is broken.")
    entries = _chosen(every, key, verdict)
    width = shutil.get_terminal_size((100, 24)).columns
    if listing:
        question = "--list judges nothing"
        refuse_beside(question, out=out, workers=workers, resume=resume, full=full, record=record)
        return _listing(entries, width)
    table = out if out is not None and out.suffix.lower() in TABLES else None
    folder = _checked_folder(None if table else out, resume)
    if table:
        check_writable(table, TABLES)
    shipped = Shipped(FOLDER, _sources(), renew=record)
    used = None if full else shipped
    report = _judged(
        entries, every=every, jobs=jobs, folder=folder, resume=resume, shipped=used, quiet=quiet
    )
    payload = to_json(report)
    text = report_as_text(report, width)
    if record:
        text += "\n\n" + _record(shipped, report)
    if folder:
        text += _written(folder, _write(folder, report, payload))
    answer = Answer(payload, text, exit_code=1 if report.changed else 0)
    return answer if table is None else with_table(answer, "claims", table, {"keys": key})


def _judged(
    entries: Sequence[discover.Entry],
    *,
    every: Sequence[discover.Entry],
    jobs: int,
    folder: Path | None,
    resume: bool,
    shipped: Shipped | None,
    quiet: bool,
) -> Report:
    """Judge claims, storing the evidence of each in the folder, and return the report."""
    versions, source = installed_versions(PACKAGES), digest_of_packages(_sources())
    start = time.perf_counter()
    shown = Progress("claims", steps=len(entries), at_once=jobs, quiet=quiet)

    def message() -> str:
        if folder is None:
            return ""
        return (
            f"{shown.finished} of {len(entries)} claims are judged and stored; "
            f"'fronts check --out {folder} --resume' continues from there"
        )

    identity = {"source": source, "versions": versions}
    with (
        resumable(message),
        # Evidence of another code or version is computed anew instead of being refused.
        Store(folder / STORE, identity, resume=resume, replace=True)
        if folder
        else nullcontext() as store,
        shown,
    ):
        outcomes = judge_all(
            entries,
            jobs=jobs,
            package=discover.PACKAGE,
            store=store,
            packages=_sources(),
            shipped=shipped,
            started=shown.begin,
            done=partial(_tell, shown),
        )
    seconds = time.perf_counter() - start
    # Imported late, since the report imports SymPy and the chains, which judging does not need.
    from paper_checks.report.measurements import stored_sections

    measurements = stored_sections() if len(entries) == len(every) else ()
    return make_report(
        outcomes, seconds=seconds, available=len(every), versions=versions, source=source,
        measurements=measurements,
    )  # fmt: skip


def _written(folder: Path, removed: int) -> str:
    text = f"\nThe report is in {folder / 'index.html'}."
    if removed:
        text += (
            f" It replaces an earlier one there; {removed} pictures and data files of that "
            "one, which this one does not have, are removed."
        )
    return text


def _tell(shown: Progress, outcome: JudgedClaim) -> None:
    """Tell the terminal that a claim has been judged."""
    notes = [duration(outcome.judgement.seconds)]
    if outcome.judgement.stored:
        notes.append("stored, stale" if outcome.judgement.stale else "stored")
    if outcome.changed:
        notes.append("not as recorded")
    computed = not outcome.judgement.stored
    shown.end(outcome.claim.key, f"{outcome.status} ({', '.join(notes)})", computed=computed)


def _chosen(
    every: Sequence[discover.Entry], keys: Sequence[str], verdict: str | None
) -> tuple[discover.Entry, ...]:
    try:
        entries = discover.select(every, keys)
    except discover.UnknownKeyError as error:
        raise UsageError(str(error)) from None
    if verdict is None:
        return entries
    recorded = _verdict(verdict)
    kept = tuple(entry for entry in entries if entry.claim.recorded is recorded)
    if not kept:
        where = f"of {', '.join(keys)} " if keys else ""
        raise UsageError(f"no claim {where}has the verdict '{slug(recorded)}' on record.")
    return kept


def _listing(entries: Sequence[discover.Entry], width: int) -> Answer:
    claims = [
        {
            "key": entry.claim.key,
            "group": entry.group,
            "place": entry.claim.place,
            "quote": entry.claim.quote,
            "statement": entry.claim.statement,
            "printed": entry.claim.printed,
            "recorded": entry.claim.recorded.value,
            "command": entry.claim.command,
        }
        for entry in entries
    ]
    return Answer({"claims": claims}, entries_as_text(entries, width))


def _checked_folder(folder: Path | None, resume: bool) -> Path | None:
    """Create the folder of the report and check, before any work, that files can be written."""
    if folder is None:
        if resume:
            raise UsageError("--resume needs --out DIR, the folder of the interrupted run.")
        return None
    if folder.exists() and not folder.is_dir():
        raise UsageError(f"--out {folder} is a file: name a folder.")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise UsageError(f"--out {folder} cannot be written: {error.strerror}.") from None
    return folder


def _write(folder: Path, report: Report, payload: dict[str, object]) -> int:
    """Write the report, remove files of an earlier report, and return the number removed."""
    from paper_checks.report.render import measurements_page, page

    document = json.dumps(payload, indent=2, ensure_ascii=False, allow_nan=False)
    files: dict[str, str | bytes] = {
        **picture_files(report),
        "report.json": document + "\n",
        "index.html": page(report),
        "methods.html": measurements_page(report),
    }
    foreign = pictures_listed(folder / "report.json") - set(files)
    try:
        for name, content in files.items():
            if isinstance(content, bytes):
                (folder / name).write_bytes(content)
            else:
                write_text(folder / name, content)
        there = [folder / name for name in sorted(foreign) if (folder / name).is_file()]
        for path in there:
            path.unlink()
    except OSError as error:
        raise UsageError(f"the report in {folder} cannot be written: {error.strerror}.") from None
    return len(there)


def _record(shipped: Shipped, report: Report) -> str:
    found = [
        outcome
        for outcome in report.outcomes
        if outcome.claim.expensive and outcome.finding and not outcome.judgement.stored
    ]
    # Claims with common evidence were judged together; the time is recorded with the first.
    first = {shipped.path(each.claim.evidence): each for each in reversed(found)}
    try:
        for outcome in first.values():
            shipped.record(outcome.entry, outcome.judgement, report.versions)
    except OSError as error:
        raise UsageError(
            f"the findings in {shipped.folder} cannot be written: {error.strerror}. "
            "Work in a checkout of the source."
        ) from None
    names = (
        ", ".join(outcome.claim.key for outcome in found) or "none: no expensive claim was asked"
    )
    return f"Recorded in {shipped.folder}: {names}."


def _sources() -> tuple[str, ...]:
    home = discover.PACKAGE.partition(".")[0]
    return SOURCES if home in SOURCES else (*SOURCES, home)


def _verdict(text: str) -> Verdict:
    for verdict in Verdict:
        if text in (slug(verdict), verdict.value, verdict.value.replace(" ", "-")):
            return verdict
    known = ", ".join(map(slug, Verdict))
    raise UsageError(f"--verdict '{text}' is not a verdict: choose one of {known}.")
