"""Claims that repeat what other claims judge: they take their verdict from those.

The abstract, the introduction, the text about a figure and the conclusions say the same things
several times. Each such sentence is a claim of its own, but only one of them is computed; the
others *follow* it, in the same run, whatever its verdict turns out to be.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from paper_checks.claim import Claim, Finding, Verdict
from paper_checks.discover import Entry
from paper_checks.outcome import Judgement, Outcome
from verification.execution.metadata import now


def following(
    key: str,
    place: str,
    statement: str,
    *follows: str,
    printed: str | None = None,
    weight: int = 0,
) -> Claim:
    """Make a claim that takes its verdict from others.

    Parameters
    ----------
    key, place, statement, printed, weight
        As in `Claim`.
    *follows : str
        Keys of claims, or names of modules for all claims in them: those that carry the sentence
        and no others. The verdict is `combined` from theirs; that on record is found in the same
        way, by `resolved`.

    Examples
    --------
    >>> following("text-a", "Abstract", "Fronts run.", "fig12").command
    'fronts check text-a'
    """
    return Claim(
        key,
        place,
        statement,
        printed,
        Verdict.UNTESTABLE,
        f"fronts check {key}",
        _never,
        weight,
        follows=follows,
    )


_HOLDS = {Verdict.REPRODUCED, Verdict.CORRECTED, Verdict.PARTIAL}


def combined(verdicts: Iterable[Verdict]) -> Verdict:
    """Return the verdict on a statement that says several things at once.

    Where all have one verdict, it is that. Reproduced beside reproduced with a correction is the
    latter. Where some hold, if only in part, and others do not, the statement holds only in part:
    the finding names which. Where nothing holds and one is not reproduced, neither is it.

    So a sentence follows only what it needs: any fault in a claim it follows is a fault in it.

    Examples
    --------
    >>> [combined(pair).name for pair in (
    ...     ("reproduced", "reproduced with a correction"),
    ...     ("reproduced", "not reproduced"),
    ...     ("not reproduced", "cannot be tested from the text"),
    ... ) for pair in [map(Verdict, pair)]]
    ['CORRECTED', 'PARTIAL', 'NOT_REPRODUCED']
    """
    found = set(verdicts)
    if len(found) == 1:
        return found.pop()
    if found == {Verdict.REPRODUCED, Verdict.CORRECTED}:
        return Verdict.CORRECTED
    return Verdict.PARTIAL if found & _HOLDS else Verdict.NOT_REPRODUCED


def followed(claim: Claim, entries: Sequence[Entry]) -> tuple[Entry, ...]:
    """Return the entries that a claim follows, in their own order.

    Raises
    ------
    LookupError
        If one of them is not there, or follows others itself.
    """
    for name in claim.follows:
        if not any(name in (entry.group, entry.claim.key) for entry in entries):
            raise LookupError(f"it follows '{name}', and there is no such claim or module.")
    found = tuple(entry for entry in entries if {entry.group, entry.claim.key} & set(claim.follows))
    for entry in found:
        if entry.claim.follows:
            raise LookupError(f"it follows '{entry.claim.key}', which follows others itself.")
    return found


def missing(entries: Sequence[Entry]) -> dict[str, str]:
    """Return why, by key, for each claim whose followed claims are not to be had."""
    found = {}
    for entry in entries:
        try:
            followed(entry.claim, entries)
        except LookupError as error:
            found[entry.claim.key] = str(error)
    return found


def resolved(entries: Sequence[Entry]) -> tuple[Entry, ...]:
    """Give each claim that follows others the verdict on record that theirs lead to.

    One that follows a claim that is not there keeps 'cannot be tested from the text'.
    """

    def one(entry: Entry) -> Entry:
        try:
            found = followed(entry.claim, entries)
        except LookupError:
            return entry
        if not found:
            return entry
        recorded = combined(other.claim.recorded for other in found)
        return replace(entry, claim=replace(entry.claim, recorded=recorded))

    return tuple(one(entry) for entry in entries)


def with_followed(chosen: Sequence[Entry], entries: Sequence[Entry]) -> tuple[Entry, ...]:
    """Return the chosen entries and those they follow, in the order of all entries."""
    keys = {entry.claim.key for entry in chosen}
    for entry in chosen:
        names = set(entry.claim.follows)
        keys |= {one.claim.key for one in entries if {one.group, one.claim.key} & names}
    return tuple(entry for entry in entries if entry.claim.key in keys)


def judgement_by_following(
    entry: Entry, entries: Sequence[Entry], judged: Mapping[str, Judgement]
) -> Judgement:
    """Return the judgement that the judgements of the followed claims lead to."""
    try:
        others = [Outcome(one, judged[one.claim.key]) for one in followed(entry.claim, entries)]
    except LookupError as error:
        return Judgement(None, str(error), 0.0, now())
    findings: list[Finding] = []
    for outcome in others:
        if outcome.finding is None:
            failure = f"the judge of {outcome.claim.key}, which it follows, failed."
            return Judgement(None, failure, 0.0, now())
        findings.append(outcome.finding)
    keys = tuple(outcome.claim.key for outcome in others)
    names = ", ".join(keys)
    verdict = combined(finding.verdict for finding in findings)
    lines = ["This repeats what is judged elsewhere, and takes its verdict from there."]
    lines += [
        f"{outcome.claim.statement} ({outcome.claim.place}): {finding.verdict}. "
        f"Ours: {finding.value}."
        for outcome, finding in zip(others, findings, strict=True)
    ]
    single = findings[0] if len(findings) == 1 else None
    finding = Finding(
        verdict=verdict,
        value=single.value if single else f"as judged under {names}",
        error=single.error if single else "see there",
        methods=single.methods if single else _methods(keys, findings),
        tolerance="that of the claims it follows; 'in part' if some of them hold and others do not",
        explanation="\n\n".join(lines),
    )
    stored = any(outcome.judgement.stored for outcome in others)
    return Judgement(finding, None, 0.0, now(), stored, followed=keys)


def _methods(keys: Sequence[str], findings: Sequence[Finding]) -> tuple[str, str]:
    """Name the methods of each followed claim."""
    first, second = (
        "; ".join(
            f"{key}: {finding.methods[place]}" for key, finding in zip(keys, findings, strict=True)
        )
        for place in (0, 1)
    )
    return first, second


def _never() -> Finding:
    raise AssertionError("a claim that follows others is not judged by itself.")
