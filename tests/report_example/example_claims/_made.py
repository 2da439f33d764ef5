"""Made-up claims: the finding is given, and evidence, rule and text only pass it on.

Where EXAMPLE_PLAIN is set they have no pictures, for which each process would import matplotlib.
"""

import os
from collections.abc import Callable
from dataclasses import dataclass, replace

from paper_checks.claim import Claim, Erratum, Formula, Method, Picture, Ruling, Verdict


@dataclass(frozen=True, kw_only=True)
class Made:
    verdict: Verdict
    value: str
    error: str
    tolerance: str
    explanation: str
    because: str = ""
    part: str = ""
    pictures: tuple[Picture, ...] = ()
    formulas: tuple[Formula, ...] = ()
    erratum: Erratum | None = None


def pictures(*drawn: Callable[[], Picture]) -> tuple[Picture, ...]:
    return () if "EXAMPLE_PLAIN" in os.environ else tuple(draw() for draw in drawn)


def rule(e):
    return Ruling(e.verdict, e.because, e.part)


class MadeClaim(Claim):
    """A claim whose pictures come with their captions."""

    def found(self, evidence):
        return replace(super().found(evidence), pictures=evidence.pictures)


def made(
    key, place, quote, *, printed, recorded, command, evidence, methods=("one", "two"), **more
):
    return MadeClaim(
        key=key,
        place=place,
        quote=quote,
        statement=quote,
        printed=printed,
        recorded=recorded,
        command=command,
        evidence=evidence,
        rule=rule,
        methods=tuple(Method(words, "example_claims._made:rule") for words in methods),
        formulas=lambda e: e.formulas,
        erratum=lambda e: e.erratum,
        **more,
    )
