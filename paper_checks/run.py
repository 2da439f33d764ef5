"""Judge claims, one after another or in several processes."""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from typing import Protocol

from paper_checks.discover import PACKAGE, Entry, find_entries
from paper_checks.outcome import Judgement, Outcome, judge, now
from paper_checks.shipped import Shipped
from paper_checks.store import Store

DIED = "the process that judged it ended without an answer (killed, or out of memory)."


class Progress(Protocol):
    """Who is told how the run goes."""

    def start(self, key: str) -> None:
        """Note that a claim is about to be judged."""

    def done(self, outcome: Outcome) -> None:
        """Note that a claim has been judged."""


class Silence:
    """Tell nobody."""

    def start(self, key: str) -> None:
        """Ignore."""

    def done(self, outcome: Outcome) -> None:
        """Ignore."""


def run(
    entries: Sequence[Entry],
    *,
    jobs: int = 1,
    package: str | None = None,
    store: Store | None = None,
    resume: bool = False,
    shipped: Shipped | None = None,
    progress: Progress | None = None,
) -> tuple[Outcome, ...]:
    """Judge claims.

    Parameters
    ----------
    entries : sequence of Entry
        The claims.
    jobs : int, optional
        Number of processes; 1 judges in this process. More than one finds each claim again by
        its key in ``package``, since a judge need not be picklable.
    package : str, optional
        Where the claims were found; by default the paper's.
    store : Store, optional
        Keeps each judgement as soon as it is made, also of a run that is interrupted later.
    resume : bool, optional
        Whether judgements in ``store`` are used instead of computed anew.
    shipped : Shipped, optional
        Findings of expensive claims that are used instead of computed anew.
    progress : Progress, optional
        Told of each start and end.

    Returns
    -------
    tuple of Outcome
        In the order of ``entries``, whatever the number of processes.
    """
    progress = progress or Silence()
    judged: dict[str, Judgement] = {}

    def keep(entry: Entry, judgement: Judgement) -> None:
        key = entry.claim.key
        judged[key] = judgement
        if store is not None and not judgement.stored:
            store.save(key, judgement)
        progress.done(Outcome(entry, judgement))

    if store is not None and resume:
        for entry in entries:
            stored = store.load(entry.claim.key)
            if stored is not None:
                keep(entry, stored)
    if shipped is not None:
        for entry in entries:
            found = shipped.load(entry) if entry.claim.key not in judged else None
            if found is not None:
                keep(entry, found)
    left = [e for e in entries if e.claim.key not in judged]
    if jobs == 1:
        for entry in left:
            progress.start(entry.claim.key)
            keep(entry, judge(entry.claim))
    else:
        for entry, judgement in _in_processes(left, jobs, package or PACKAGE, progress):
            keep(entry, judgement)
    return tuple(Outcome(entry, judged[entry.claim.key]) for entry in entries)


def _in_processes(
    entries: Sequence[Entry], jobs: int, package: str, progress: Progress
) -> Iterator[tuple[Entry, Judgement]]:
    lost = []
    for entry, judgement in _pool(entries, jobs, package, progress):
        if judgement is None:
            lost.append(entry)
        else:
            yield entry, judgement
    # One dead worker takes the whole pool with it. Each claim left is judged in a process of its
    # own, so that only the one that kills its worker is failed.
    for entry in lost:
        for _, judgement in _pool([entry], 1, package, progress):
            yield entry, judgement or Judgement(None, DIED, 0.0, now())


def _pool(
    entries: Sequence[Entry], jobs: int, package: str, progress: Progress
) -> Iterator[tuple[Entry, Judgement | None]]:
    """Yield judgements as they come; None for a claim lost with a dead worker."""
    if not entries:
        return
    with _workers(min(jobs, len(entries))) as pool:
        futures: dict[Future[Judgement], Entry] = {}
        for entry in entries:
            progress.start(entry.claim.key)
            try:
                futures[pool.submit(_judge_by_key, package, entry.claim.key)] = entry
            except BrokenProcessPool:
                yield entry, None
        for future in as_completed(futures):
            try:
                yield futures[future], future.result()
            except BrokenProcessPool:
                yield futures[future], None


@contextmanager
def _workers(count: int) -> Iterator[ProcessPoolExecutor]:
    before = set(multiprocessing.active_children())
    # 'spawn' on every system: forking a process that runs compiled threads can hang.
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(count, mp_context=context, initializer=_leave_interrupts_to_parent)
    try:
        yield pool
    except BaseException:
        pool.shutdown(wait=False, cancel_futures=True)
        for child in set(multiprocessing.active_children()) - before:
            child.terminate()
        raise
    pool.shutdown()


def _leave_interrupts_to_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _judge_by_key(package: str, key: str) -> Judgement:
    for entry in find_entries(package):
        if entry.claim.key == key:
            return judge(entry.claim)
    raise LookupError(f"the claim '{key}' is not in {package}.")
