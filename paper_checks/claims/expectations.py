"""Sentences that cannot be judged by a computation of these two models, and why."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

from paper_checks.claim import Claim, Ruling
from paper_checks.ruling import untestable


@dataclass(frozen=True, kw_only=True)
class Missing:
    """What the text would have to state in order to be testable."""

    reason: str
    remark: str = ""


def rule(e: Missing) -> Ruling:
    """Rule: nothing was computed, so the verdict is that of the stated reason."""
    return untestable(e.reason)


def _claim(key: str, reason: str, remark: str = "") -> Claim:
    evidence = partial(Missing, reason=reason, remark=remark)
    return Claim.beside(key, evidence=evidence, rule=rule, weight=0)


CLAIMS = (
    _claim("expect-others", "it is an expectation about models that are not named."),
    _claim(
        "expect-origin",
        "a cause is named, and no experiment that could separate it from others, such as "
        "the common coupling and ends.",
    ),
    _claim(
        "expect-equivalence",
        "what equivalence in terms of dynamical behavior means is not said.",
        "One of the two similarities does not hold (fig17-linear), the other does (fig18-alike).",
    ),
    _claim(
        "expect-experiments",
        "this is about experiments of others, and neither model is calibrated to them.",
    ),
    _claim(
        "expect-irregular",
        "it is about the model of [18], whose parameters and starts are not repeated here.",
    ),
    _claim(
        "expect-two-dimensions",
        "it is about a model of others, and neither model of the paper has two dimensions.",
    ),
    _claim(
        "expect-difficult",
        "it is a judgement of difficulty.",
        "Parts of the friction cell have closed forms, such as the velocity at which steady "
        "sliding becomes stable (fig02-regions).",
    ),
    _claim(
        "expect-starts",
        "how close is not said, and the initial displacements are missing.",
        "Each of our thresholds names its start: the upper turning point of the cycle, at rest.",
    ),
    _claim("expect-simplest", "what counts as simple is not said."),
    _claim("expect-procedure", "it is said to be possible and not carried out."),
    _claim(
        "expect-forcing",
        "the sense is not given.",
        "What can be compared, the two maps, is judged under fig15-alike.",
    ),
    _claim(
        "expect-resembles",
        "how much alike is not said.",
        "(44) is of first order in time and complex, and has no energy; the chains cited "
        "are of second order and real.",
    ),
)
