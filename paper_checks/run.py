"""Judge claims, one after another or in several processes."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from functools import partial

from paper_checks.discover import PACKAGE, Entry, find_entries
from paper_checks.outcome import JudgedClaim, Judgement, judge, judged_by
from paper_checks.shipped import Shipped
from verification.execution.imports import SOURCES
from verification.execution.interruption import terminated_as_interrupted
from verification.execution.metadata import now
from verification.execution.pool import answers
from verification.execution.store import Store

KEPT = ("evidence", "seconds", "judged", "shared")
"""Fields of a judgement that are stored for a resumed run."""

Judges = Callable[[tuple[str, ...]], tuple[Judgement, ...]]
"""What judges the claims of some keys."""

logger = logging.getLogger(__name__)


def run(
    entries: Sequence[Entry],
    *,
    jobs: int = 1,
    package: str | None = None,
    store: Store | None = None,
    packages: Sequence[str] = SOURCES,
    shipped: Shipped | None = None,
    started: Callable[[str], object] | None = None,
    done: Callable[[JudgedClaim], object] | None = None,
) -> tuple[JudgedClaim, ...]:
    """Judge claims.

    Parameters
    ----------
    entries : sequence of Entry
        The claims.
    jobs : int, optional
        Number of processes; 1 judges in this process. With more than one, each claim is looked up
        by its key in ``package``, since a judge need not be picklable; claims that share evidence
        or work are judged in one process.
    package : str, optional
        Package in which the claims were found; by default that of the paper.
    store : Store, optional
        Evidence that it contains is used instead of being computed anew; that of each claim is
        added as soon as it is judged. A claim that failed leaves none, so that a resumed run tries
        again.
    packages : sequence of str, optional
        Packages whose classes stored evidence may contain.
    shipped : Shipped, optional
        Findings of expensive claims that are used instead of being computed anew.
    started, done : callable, optional
        Called with the key of each claim that is about to be judged, and with each judged claim.

    Returns
    -------
    tuple of JudgedClaim
        The judged claims in the order of ``entries``, whatever the number of processes.
    """
    judged: dict[str, Judgement] = {}

    def note(entry: Entry, judgement: Judgement) -> None:
        key = entry.claim.key
        judged[key] = judgement
        if store is not None and judgement.evidence is not None:
            store.add(key, {name: getattr(judgement, name) for name in KEPT})
        if done is not None:
            done(JudgedClaim(entry, judgement))

    for entry in entries:
        found = _stored(store, entry, packages) or (shipped.load(entry) if shipped else None)
        if found is not None:
            note(entry, found)
    left = tuple(e for e in entries if e.claim.key not in judged)
    judges = partial(_judgements, left if jobs == 1 else package or PACKAGE)
    groups = [(entry,) for entry in left] if jobs == 1 else sharing(left)
    for entry, judgement in _computed(groups, judges, jobs, started):
        note(entry, judgement)
    return tuple(JudgedClaim(entry, judged[entry.claim.key]) for entry in entries)


def sharing(entries: Sequence[Entry]) -> list[tuple[Entry, ...]]:
    """Return groups of claims that have evidence or shared work in common, each in order.

    A group is judged in one process, so that what its claims share is computed once.
    """
    found: dict[Callable[[], object], list[Entry]] = {}
    for entry in entries:
        found.setdefault(entry.claim.shared or entry.claim.evidence, []).append(entry)
    return [tuple(group) for group in found.values()]


def _computed(
    groups: Sequence[tuple[Entry, ...]],
    judges: Judges,
    jobs: int,
    started: Callable[[str], object] | None,
) -> Iterator[tuple[Entry, Judgement]]:
    """Judge claims group by group and yield each judgement as it arrives.

    If a process dies, the claims of its group are judged again, one by one.
    """
    keys = [tuple(entry.claim.key for entry in group) for group in groups]
    failed: list[Entry] = []

    def begun(index: int) -> None:
        if started is not None:
            for key in keys[index]:
                started(key)

    # Closed at once on an interrupt, rather than by the garbage collector: it owns the workers.
    with (
        terminated_as_interrupted(),
        closing(answers(judges, keys, workers=jobs, begun=begun)) as coming,
    ):
        for index, answer in coming:
            group = groups[index]
            if not isinstance(answer, Exception):
                yield from zip(group, answer, strict=True)
            elif len(group) > 1:
                failed += group
            else:
                yield group[0], Judgement(None, str(answer), 0.0, now())
    if failed:
        yield from _computed([(entry,) for entry in failed], judges, jobs, started)


def _stored(store: Store | None, entry: Entry, packages: Sequence[str]) -> Judgement | None:
    """Judge a claim by its evidence in the store; None if there is none that can be used."""
    key = entry.claim.key
    held = None if store is None else store.results.get(key)
    if held is None:
        return None
    try:
        return judged_by(entry.claim, packages=packages, **held)
    except (KeyError, TypeError, ValueError, AttributeError, ImportError):
        logger.info("the stored evidence of %s is damaged and is computed again", key)
        return None


def _judgements(entries: Sequence[Entry] | str, keys: tuple[str, ...]) -> tuple[Judgement, ...]:
    """Judge the claims with these keys.

    Another process looks them up in a package, which is given by name, since entries need not be
    picklable.
    """
    if isinstance(entries, str):
        entries = find_entries(entries)
    claims = {entry.claim.key: entry.claim for entry in entries}
    return tuple(judge(claims[key]) for key in keys)
