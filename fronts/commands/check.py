"""``fronts check``: judge the claims of the paper and write the report."""

from __future__ import annotations

import argparse
import json
import logging
import os
import shutil
import tempfile
import time
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

from fronts.answer import Answer, UsageError
from fronts.interrupted import resumable
from paper_checks import discover
from paper_checks.claim import Verdict
from paper_checks.outcome import Outcome, slug
from paper_checks.report.document import (
    PACKAGES,
    Report,
    make_report,
    picture_files,
    pictures_listed,
    to_json,
)
from paper_checks.report.measurements import stored_sections
from paper_checks.report.render import measurements_page, page
from paper_checks.report.table import duration, entries_as_text
from paper_checks.report.terminal import report_as_text
from paper_checks.run import run as judge_all
from paper_checks.shipped import FOLDER, Shipped
from verification.execution.digest import digest_of_packages
from verification.execution.files import write_text
from verification.execution.imports import SOURCES
from verification.execution.metadata import installed_versions
from verification.execution.progress import Progress
from verification.execution.store import Store

EXAMPLE = """\
examples:
  fronts check                           every claim: counts and headlines
  fronts check fig17 --out report        the claims of one module, with report/index.html
  fronts check --verdict not-reproduced  the claims with that verdict on record
  fronts check --out report --resume     go on with an interrupted run
  fronts check --full --jobs 2           compute the expensive claims as well
  fronts check --record --jobs 2         renew the stored findings whose code has changed

exit code: 0 when every verdict is as recorded, 1 when one changed, 2 for unusable input"""

STORE = ".evidence.sqlite"
"""What a run into a folder has judged so far."""
MOST_JOBS = 256
_OF_A_RUN = ("out", "jobs", "resume", "full", "record")
"""Options that say how claims are judged, which ``--list`` does not do."""


def configure(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("keys", nargs="*", metavar="KEY", help="a claim or a module of claims")
    parser.add_argument(
        "--verdict",
        type=_verdict,
        metavar="V",
        help="only claims with this verdict on record: " + ", ".join(map(slug, Verdict)),
    )
    parser.add_argument("-o", "--out", type=_folder, metavar="DIR", help="write the report here")
    parser.add_argument(
        "--workers",
        "--jobs",
        dest="jobs",
        type=_jobs,
        metavar="N",
        help="processes (default 1: claims about run times are judged undisturbed)",
    )
    parser.add_argument(
        "--resume",
        action="store_true",
        help="use evidence that an earlier run of the same code kept in DIR",
    )
    parser.add_argument(
        "--full",
        action="store_true",
        help="compute everything: use no finding that comes with the toolkit",
    )
    parser.add_argument(
        "--record",
        action="store_true",
        help="compute the expensive claims whose stored finding is missing or stale, with --full "
        "all of them, and store what is found with the toolkit",
    )
    parser.add_argument("--list", action="store_true", help="list the claims, judge none")


def run(options: argparse.Namespace) -> Answer:
    """Judge the chosen claims; write the report if asked to."""
    if os.environ.get("FRONTS_TRACEBACK"):
        logging.basicConfig(level=logging.INFO)
        logging.getLogger("matplotlib").setLevel(logging.WARNING)
    every = discover.find_entries()
    if not every:
        raise UsageError(f"no claims were found in {discover.PACKAGE}: the installation is broken.")
    entries = _chosen(every, options)
    width = shutil.get_terminal_size((100, 24)).columns
    if options.list:
        return _listing(entries, width, options)
    folder = _checked_folder(options)
    versions, source = installed_versions(PACKAGES), digest_of_packages(_sources())
    shipped = Shipped(FOLDER, _sources(), renew=options.record)

    start = time.perf_counter()
    shown = Progress("claims", steps=len(entries), at_once=options.jobs or 1, quiet=options.json)

    def said() -> str:
        if folder is None:
            return ""
        return (
            f"{shown.finished} of {len(entries)} claims are judged and stored; "
            f"'fronts check --out {folder} --resume' goes on from there"
        )

    identity = {"source": source, "versions": versions}
    with (
        resumable(said),
        # What another code or version has found is computed anew, and not refused.
        Store(folder / STORE, identity, resume=options.resume, replace=True)
        if folder
        else nullcontext() as store,
        shown,
    ):
        outcomes = judge_all(
            entries,
            jobs=options.jobs or 1,
            package=discover.PACKAGE,
            store=store,
            packages=_sources(),
            shipped=None if options.full else shipped,
            progress=_Reporter(shown),
        )
    seconds = time.perf_counter() - start

    measurements = stored_sections() if len(entries) == len(every) else ()
    report = make_report(
        outcomes, seconds=seconds, available=len(every), versions=versions, source=source,
        measurements=measurements,
    )  # fmt: skip
    payload = to_json(report)
    text = report_as_text(report, width)
    if options.record:
        text += "\n\n" + _record(shipped, report)
    if folder:
        text += _written(folder, _write(folder, report, payload))
    return Answer(payload, text, exit_code=1 if report.changed else 0)


def _written(folder: Path, removed: int) -> str:
    text = f"\nThe report is in {folder / 'index.html'}."
    if removed:
        text += (
            f" It replaces an earlier one there; {removed} pictures and data files of that "
            "one, which this one does not have, are removed."
        )
    return text


class _Reporter:
    """Pass the progress of the run on to the terminal."""

    def __init__(self, shown: Progress) -> None:
        self._shown = shown

    def start(self, key: str) -> None:
        self._shown.begin(key)

    def done(self, outcome: Outcome) -> None:
        notes = [duration(outcome.judgement.seconds)]
        if outcome.judgement.stored:
            notes.append("stored, stale" if outcome.judgement.stale else "stored")
        if outcome.changed:
            notes.append("not as recorded")
        computed = not outcome.judgement.stored
        self._shown.end(
            outcome.claim.key, f"{outcome.status} ({', '.join(notes)})", computed=computed
        )


def _chosen(
    every: Sequence[discover.Entry], options: argparse.Namespace
) -> tuple[discover.Entry, ...]:
    try:
        entries = discover.select(every, options.keys)
    except discover.UnknownKeyError as error:
        raise UsageError(str(error)) from None
    if options.verdict is None:
        return entries
    kept = tuple(entry for entry in entries if entry.claim.recorded is options.verdict)
    if not kept:
        where = f"of {', '.join(options.keys)} " if options.keys else ""
        raise UsageError(f"no claim {where}has the verdict '{slug(options.verdict)}' on record.")
    return kept


def _listing(entries: Sequence[discover.Entry], width: int, options: argparse.Namespace) -> Answer:
    given = [name for name in _OF_A_RUN if getattr(options, name) not in (None, False)]
    if given:
        names = " and ".join(f"--{name}" for name in given)
        raise UsageError(f"--list judges nothing: leave out {names}.")
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


def _checked_folder(options: argparse.Namespace) -> Path | None:
    """Make the folder of the report and make sure, before any work, that it takes files."""
    folder: Path | None = options.out
    if folder is None:
        if options.resume:
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
    """Write the report; remove what an earlier report left here, and return how much."""
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
    # Claims that share evidence were judged together, and the first took its time.
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


def _folder(text: str) -> Path:
    if not text.strip():
        raise argparse.ArgumentTypeError("an empty name is no folder: name one, or . for this one")
    return Path(text)


def _verdict(text: str) -> Verdict:
    for verdict in Verdict:
        if text in (slug(verdict), verdict.value, verdict.value.replace(" ", "-")):
            return verdict
    known = ", ".join(map(slug, Verdict))
    raise argparse.ArgumentTypeError(f"'{text}' is not a verdict: choose one of {known}")


def _jobs(text: str) -> int:
    try:
        count = int(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"'{text}' is not a whole number") from None
    if not 1 <= count <= MOST_JOBS:
        raise argparse.ArgumentTypeError(f"{count} processes: it must be from 1 to {MOST_JOBS}")
    return count
