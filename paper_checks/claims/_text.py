"""A sentence of the text that no computation can judge, and why."""

from __future__ import annotations

from paper_checks.claim import Claim, Finding, Verdict


def untestable(key: str, place: str, statement: str, reason: str) -> Claim:
    """Make a claim whose verdict is that the text does not allow one.

    Parameters
    ----------
    key, place, statement : str
        As in `Claim`.
    reason : str
        What is missing.
    """

    def judge() -> Finding:
        return Finding(
            verdict=Verdict.UNTESTABLE,
            value="no value",
            error="none",
            methods=("reading of the text", "no computation answers it"),
            tolerance="none",
            explanation=reason,
        )

    command = f"fronts check {key}"
    return Claim(key, place, statement, None, Verdict.UNTESTABLE, command, judge, weight=0)
