"""Judge claims, one after another or in several processes."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Protocol

from paper_checks.discover import PACKAGE, Entry, find_entries
from paper_checks.following import judgement_by_following
from paper_checks.outcome import Judgement, Outcome, judge
from paper_checks.shipped import Shipped
from paper_checks.stored_judgement import judgement_from, plain_judgement
from verification.execution.interruption import terminated_as_interrupted
from verification.execution.metadata import now
from verification.execution.pool import answers
from verification.execution.store import Store

logger = logging.getLogger(__name__)


class Progress(Protocol):
    """Who is called as the run goes on."""

    def start(self, key: str) -> None:
        """Note that a claim is about to be judged."""

    def done(self, outcome: Outcome) -> None:
        """Note that a claim has been judged."""


class Silence:
    """Report nothing."""

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
    shipped: Shipped | None = None,
    progress: Progress | None = None,
) -> tuple[Outcome, ...]:
    """Judge claims.

    Parameters
    ----------
    entries : sequence of Entry
        The claims, those that others of them follow included.
    jobs : int, optional
        Number of processes; 1 judges in this process. More than one finds each claim again by
        its key in ``package``, since a judge need not be picklable.
    package : str, optional
        Where the claims were found; by default the paper's.
    store : Store, optional
        Judgements in it are used instead of computed anew; each new one is added as soon as it is
        made. Those that failed are not, so that a resumed run tries again.
    shipped : Shipped, optional
        Findings of expensive claims that are used instead of computed anew.
    progress : Progress, optional
        Called at each start and end.

    Returns
    -------
    tuple of Outcome
        In the order of ``entries``, whatever the number of processes.
    """
    progress = progress or Silence()
    judged: dict[str, Judgement] = {}

    def note(entry: Entry, judgement: Judgement) -> None:
        key = entry.claim.key
        judged[key] = judgement
        if store is not None and judgement.finding is not None and not judgement.stored:
            store.add(key, plain_judgement(judgement))
        progress.done(Outcome(entry, judgement))

    for entry in entries:
        found = _stored(store, entry) or (shipped.load(entry) if shipped else None)
        if found is not None:
            note(entry, found)
    left = [e for e in entries if e.claim.key not in judged and not e.claim.follows]
    judges = _Here(tuple(left)) if jobs == 1 else _ByKey(package or PACKAGE)
    keys = [entry.claim.key for entry in left]
    # Closed at once on an interrupt, and not when the collector finds it: it owns the workers.
    with (
        terminated_as_interrupted(),
        closing(
            answers(judges, keys, workers=jobs, begun=lambda index: progress.start(keys[index]))
        ) as coming,
    ):
        for index, answer in coming:
            if isinstance(answer, Exception):
                answer = Judgement(None, str(answer), 0.0, now())  # noqa: PLW2901
            note(left[index], answer)
    for entry in entries:
        # They take no time and are never stored: what they follow may have another verdict now.
        if entry.claim.follows:
            judged[entry.claim.key] = judgement_by_following(entry, entries, judged)
            progress.done(Outcome(entry, judged[entry.claim.key]))
    return tuple(Outcome(entry, judged[entry.claim.key]) for entry in entries)


def _stored(store: Store | None, entry: Entry) -> Judgement | None:
    """Return the judgement of a claim in the store; None if there is none that can be used."""
    key = entry.claim.key
    if store is None or key not in store.results:
        return None
    try:
        return judgement_from(store.results[key])
    except (KeyError, TypeError, ValueError, AttributeError):
        logger.info("the stored finding of %s is damaged and is computed again", key)
        return None


@dataclass(frozen=True)
class _Here:
    """Judge a claim in this process."""

    entries: tuple[Entry, ...]

    def __call__(self, key: str) -> Judgement:
        (entry,) = (entry for entry in self.entries if entry.claim.key == key)
        return judge(entry.claim)


@dataclass(frozen=True)
class _ByKey:
    """Judge a claim in another process, which finds it by its key."""

    package: str

    def __call__(self, key: str) -> Judgement:
        for entry in find_entries(self.package):
            if entry.claim.key == key:
                return judge(entry.claim)
        raise LookupError(f"the claim '{key}' is not in {self.package}.")
